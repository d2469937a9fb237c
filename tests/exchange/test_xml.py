"""Messages in XML say what the same messages say as keywords, by the same rules; what could explode is not let in."""

import re

import numpy as np
import pytest
from click.testing import CliRunner

from sailviz import ndm
from sailviz.cli.entry import main
from sailviz.errors import RecordingError
from sailviz.exchange.aem import AttitudeRows, read_aem
from sailviz.exchange.apm import read_apm, write_apm
from sailviz.exchange.element_sets import read_element_sets
from sailviz.exchange.opm import read_opm
from sailviz.recording.flights import is_flight, read_flight
from sailviz.run.oem import read_oem

HEADER = "<header><CREATION_DATE>2026-01-01T00:00:00</CREATION_DATE><ORIGINATOR>X</ORIGINATOR></header>"


def xml(kind, *segments, wrap=False):
    """A message of segments, each (metadata, data)."""
    inner = "\n".join(
        f"<segment>\n<metadata>\n{_leaves(meta)}</metadata>\n<data>\n{data}</data>\n</segment>"
        for meta, data in segments
    )
    text = f'<{kind} id="CCSDS_{kind.upper()}_VERS" version="2.0">\n{HEADER}\n<body>\n{inner}\n</body>\n</{kind}>\n'
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + (f"<ndm>\n{text}</ndm>\n" if wrap else text)


def _leaves(values):
    return "".join(f"<{key}>{value}</{key}>\n" for key, value in values.items())


def keywords(kind, *segments):
    lines = [f"CCSDS_{kind.upper()}_VERS = 2.0"]
    for meta, rows in segments:
        lines += ["META_START", *(f"{key} = {value}" for key, value in meta.items()), "META_STOP", *rows]
    return "\n".join(lines) + "\n"


META = {"OBJECT_NAME": "CRAFT", "OBJECT_ID": "2026-001A", "CENTER_NAME": "EARTH", "REF_FRAME": "EME2000",
        "TIME_SYSTEM": "UTC", "START_TIME": "2026-04-01T00:00:00", "STOP_TIME": "2026-04-01T01:00:00"}  # fmt: skip
KEYS = ("EPOCH", "X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT")
RATE = np.sqrt(398600.4415 / 7000.0**3)


def rows(start=0.0, count=8, step=60.0, kick=0.0):
    """Lines of an OEM on a circle of 7000 km."""
    found = []
    for k in range(count):
        t = start + step * k
        c, s = np.cos(RATE * t), np.sin(RATE * t)
        minutes, seconds = divmod(t, 60.0)
        state = (7000 * c, 7000 * s, 0.0, -7000 * RATE * s * (1 + kick), 7000 * RATE * c * (1 + kick), 0.0)
        epoch = f"2026-04-01T{int(minutes // 60):02d}:{int(minutes % 60):02d}:{seconds:06.3f}"
        found.append(" ".join([epoch, *(f"{one:.12f}" for one in state)]))
    return found


def vectors(lines, units=True):
    words = {"X": "km", "Y": "km", "Z": "km", "X_DOT": "km/s", "Y_DOT": "km/s", "Z_DOT": "km/s"} if units else {}
    text = ""
    for line in lines:
        leaves = (
            f"<{key}{f' units={words[key]!r}' if key in words else ''}>{value}</{key}>\n"
            for key, value in zip(KEYS, line.split(), strict=True)
        )
        text += f"<stateVector>\n{''.join(leaves)}</stateVector>\n"
    return text


def both(tmp_path, segments, **more):
    """The same OEM read from XML and from keywords."""
    (tmp_path / "a.xml").write_text(xml("oem", *((meta, vectors(lines)) for meta, lines in segments), **more))
    (tmp_path / "a.oem").write_text(keywords("oem", *segments))
    return tmp_path / "a.xml", tmp_path / "a.oem"


@pytest.mark.parametrize("wrap", [False, True])
@pytest.mark.parametrize(
    "segments",
    [
        [(META, rows())],
        [(META, rows()), (META, rows(420.0))],  # touching
        [(META, rows()), (META, rows(420.0, kick=0.01))],  # a jump
        [(META, rows()), (META, rows(1800.0))],  # a gap
        [(META | {"USEABLE_STOP_TIME": "2026-04-01T00:05:00"}, rows()), (META, rows(300.0))],  # useable spans
        [(META | {"CENTER_NAME": "Earth", "TIME_SYSTEM": "utc", "REF_FRAME": "J2000"}, rows())],
        [(META, [*rows(), rows()[-1]])],  # a row twice
    ],
)
def test_a_flight_in_xml_is_the_flight_in_keywords(tmp_path, segments, wrap):
    one, other = (read_oem(path) for path in both(tmp_path, segments, wrap=wrap))
    for name in ("time", "position", "velocity"):
        assert np.array_equal(getattr(one, name), getattr(other, name))
    assert (one.epoch, one.gaps, one.frame, one.center) == (other.epoch, other.gaps, other.frame, other.center)
    assert len(one.notes) == len(other.notes)


@pytest.mark.parametrize(
    "segments",
    [
        [(META, rows()), (META | {"REF_FRAME": "ICRF"}, rows(600.0))],
        [(META, rows()), (META | {"CENTER_NAME": "MARS"}, rows(600.0))],
        [(META, [line.replace("2026-04-01", "2026-366") for line in rows()])],
        [(META, [line.replace("00:00:00", "00:00:60") for line in rows()])],
        [(META, [*rows(), rows(kick=0.1)[-1]])],
        [(META, [line.replace("7000.0", "7D3.0", 1) for line in rows()])],
        [
            (META, rows()),
            (META, rows(300.0, kick=0.0)),
            (META, [line.replace("04-01", "04-02") for line in rows()][::-1]),
        ],
        [(META | {"REF_FRAME_EPOCH": "2000-01-01T00:00:00"}, rows())],
        [(META | {"TIME_SYSTEM": "MRT"}, rows())],
        [({key: value for key, value in META.items() if key != "REF_FRAME"}, rows())],
    ],
)
def test_what_keywords_are_refused_for_xml_is_refused_for(tmp_path, segments):
    told = []
    for path in both(tmp_path, segments):
        with pytest.raises(RecordingError) as error:
            read_oem(path)
        told.append(re.sub(r"\S*a\.(xml|oem)|lines? \d+( and \d+)?", "", str(error.value)))
    assert told[0] == told[1]
    assert "\n" not in told[0]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("<X units='km'>", "<X units='m'>", r"line 18: X is in \[m\], and \[km\] is due"),
        ("<Y_DOT units='km/s'>", "<Y_DOT units='m/s'>", r"Y_DOT is in \[m/s\]"),
        ("<Z units='km'>0.000000000000</Z>", "", "line 16: of this row Z is lacking"),
        ("<Z units='km'>", "<X units='km'>1</X><Z units='km'>", "X is there twice"),
        ("<oem ", "<!DOCTYPE oem [<!ENTITY a 'b'>]><oem ", "no document type"),
        ("CRAFT", "&bomb;", "this is no XML: undefined entity"),
        ("</body>", "", "this is no XML: mismatched tag"),
        ("<body>", "<body>" + "<a>" * 60, "without end"),
        ("oem", "oam", "not an OEM: it is XML with no message"),
        ("<oem", "<opm/><oem", "this is no XML: junk"),
    ],
)
def test_xml_that_is_no_message_is_refused_in_one_sentence(tmp_path, old, new, words):
    text = xml("oem", (META, vectors(rows())))
    assert old in text
    (tmp_path / "a.oem").write_text(text.replace(old, new) if old == "oem" else text.replace(old, new, 1))
    with pytest.raises(RecordingError, match=words) as told:
        read_oem(tmp_path / "a.oem")
    assert "\n" not in str(told.value)


def test_entities_do_not_grow(tmp_path):
    """A billion laughs are refused before the first."""
    bomb = "<!DOCTYPE x [<!ENTITY a 'ha'>" + "".join(
        f"<!ENTITY {b} '{f'&{a};' * 10}'>" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
    )
    for kind, read in (("oem", read_oem), ("opm", read_opm), ("aem", read_aem), ("apm", read_apm)):
        path = tmp_path / f"a.{kind}"
        path.write_text(f"{bomb}]><{kind}>&i;</{kind}>")
        with pytest.raises(RecordingError, match="no document type"):
            read(path)
    path.write_text(f"{bomb}]><omm>&i;</omm>")
    with pytest.raises(ValueError, match="no document type"):
        read_element_sets(path)


def test_covariances_accelerations_and_comments_are_passed_over(tmp_path):
    data = vectors(rows(), units=False).replace(
        "</stateVector>", "".join(f"<{k}_DDOT>0</{k}_DDOT>" for k in "XYZ") + "</stateVector>"
    )
    data += "<covarianceMatrix><EPOCH>2026-04-01T00:00:00</EPOCH><CX_X>1</CX_X></covarianceMatrix>\n"
    data += "<COMMENT>META_START</COMMENT>"
    (tmp_path / "a.xml").write_text(xml("oem", (META, data)))
    found = read_oem(tmp_path / "a.xml")
    assert len(found.time) == 8
    assert sorted(found.notes) == ["accelerations are passed over", "covariances are passed over"]


STATE = "".join(f"<{key}>{value}</{key}>\n" for key, value in zip(KEYS, rows()[3].split(), strict=True))
OPM_META = {key: META[key] for key in ("OBJECT_NAME", "OBJECT_ID", "CENTER_NAME", "REF_FRAME", "TIME_SYSTEM")}


def test_one_state_in_xml(tmp_path):
    craft = (
        '<spacecraftParameters><MASS units="kg">12.5</MASS><DRAG_AREA units="m**2">3</DRAG_AREA></spacecraftParameters>'
    )
    users = '<userDefinedParameters><USER_DEFINED parameter="X">1</USER_DEFINED></userDefinedParameters>'
    path = tmp_path / "a.xml"
    path.write_text(xml("opm", (OPM_META, f"<stateVector>{STATE}</stateVector>{craft}{users}"), wrap=True))
    found = read_opm(path)
    assert found.position == pytest.approx([1e3 * float(one) for one in rows()[3].split()[1:4]], rel=1e-15)
    assert (found.mass, found.drag_area, found.center) == (12.5, 3.0, "EARTH")
    assert found.notes == ("what users have defined is passed over",)
    path.write_text(xml("opm", (OPM_META, f"<stateVector>{STATE}</stateVector>{craft.replace('kg', 'g')}")))
    with pytest.raises(RecordingError, match=r"MASS is in \[g\]"):
        read_opm(path)
    burn = "<maneuverParameters><MAN_EPOCH_IGNITION>2026-04-01T00:00:00</MAN_EPOCH_IGNITION></maneuverParameters>"
    path.write_text(xml("opm", (OPM_META, f"<stateVector>{STATE}</stateVector>{burn}")))
    with pytest.raises(RecordingError, match="manoeuvres"):
        read_opm(path)


ATTITUDE = {"OBJECT_NAME": "CRAFT", "OBJECT_ID": "X", "REF_FRAME_A": "EME2000", "REF_FRAME_B": "SC_BODY_1",
            "TIME_SYSTEM": "UTC", "START_TIME": "2026-04-01T00:00:00", "STOP_TIME": "2026-04-01T00:01:00"}  # fmt: skip


def test_attitudes_in_xml_have_their_numbers_by_name(tmp_path):
    """Whatever their order, with rates and without; of version 1 too."""

    def state(minute, tail=""):
        quaternion = "<quaternion><QC>0.8</QC><Q1>0</Q1><Q2>0</Q2><Q3>0.6</Q3></quaternion>"
        return f"<attitudeState><x><EPOCH>2026-04-01T00:0{minute}:00</EPOCH>{quaternion}{tail}</x></attitudeState>"

    path = tmp_path / "a.xml"
    spin = "<angVel>" + "".join(f'<ANGVEL_{k} units="deg/s">1</ANGVEL_{k}>' for k in "XYZ") + "</angVel>"
    for kind, tail in (("QUATERNION", ""), ("QUATERNION/ANGVEL", spin)):
        path.write_text(xml("aem", (ATTITUDE | {"ATTITUDE_TYPE": kind}, state(0, tail) + state(1, tail))))
        found = read_aem(path)
        assert found.quaternion.tolist() == [[0, 0, 0.6, 0.8]] * 2
        assert np.diff(found.instants).tolist() == [60 * 10**9]
    first = ATTITUDE | {"ATTITUDE_TYPE": "QUATERNION", "QUATERNION_TYPE": "FIRST"}
    path.write_text(xml("aem", (first, state(0))).replace('version="2.0"', 'version="1.0"'))
    assert read_aem(path).quaternion.tolist() == [[0, 0, 0.6, 0.8]]
    path.write_text(path.read_text().replace("<Q2>0</Q2>", ""))
    with pytest.raises(RecordingError, match="Q2 is lacking"):
        read_aem(path)
    path.write_text(xml("aem", (ATTITUDE | {"ATTITUDE_TYPE": "EULER_ANGLE"}, state(0))))
    with pytest.raises(RecordingError, match="EULER_ANGLE is not read"):
        read_aem(path)


def test_element_sets_in_xml_are_in_their_units(tmp_path):
    meta = {"OBJECT_NAME": "A", "OBJECT_ID": "2026-001A", "CENTER_NAME": "EARTH", "REF_FRAME": "TEME",
            "TIME_SYSTEM": "UTC", "MEAN_ELEMENT_THEORY": "SGP4"}  # fmt: skip
    values = {"EPOCH": "2026-04-01T00:00:00", "MEAN_MOTION": 15.1, "ECCENTRICITY": 0.001, "INCLINATION": 97.5,
              "RA_OF_ASC_NODE": 1, "ARG_OF_PERICENTER": 2, "MEAN_ANOMALY": 3}  # fmt: skip
    text = xml("omm", (meta, f"<meanElements>{_leaves(values)}</meanElements>"), wrap=True)
    (tmp_path / "a.xml").write_text(text)
    (found,) = read_element_sets(tmp_path / "a.xml")
    assert (found.name, float(found.fields["INCLINATION"])) == ("A", 97.5)
    (tmp_path / "a.xml").write_text(text.replace("<INCLINATION>", '<INCLINATION units="rad">'))
    with pytest.raises(ValueError, match=r"INCLINATION is in \[rad\], and \[deg\] is due"):
        read_element_sets(tmp_path / "a.xml")


APM = """CCSDS_APM_VERS = 2.0
CREATION_DATE = 2026-01-01T00:00:00
ORIGINATOR = X
META_START
OBJECT_NAME = CRAFT
OBJECT_ID = 2026-001A
TIME_SYSTEM = UTC
META_STOP
EPOCH = 2026-04-01T00:00:00
QUAT_START
REF_FRAME_A = EME2000
REF_FRAME_B = SC_BODY_1
Q1 = 0.0
Q2 = 0.0
Q3 = 0.6
QC = 0.8
QUAT_STOP
INERTIA_START
IXX = 1.0 [kg*m**2]
INERTIA_STOP
"""
APM_1 = """CCSDS_APM_VERS = 1.0
OBJECT_NAME = CRAFT
OBJECT_ID = 2026-001A
TIME_SYSTEM = UTC
EPOCH = 2026-04-01T00:00:00
Q_FRAME_A = SC_BODY_1
Q_FRAME_B = EME2000
Q_DIR = A2B
Q1 = 0.0
Q2 = 0.0
Q3 = 0.6
QC = 0.8
"""


def test_one_attitude_is_read_and_written(tmp_path):
    path = tmp_path / "a.apm"
    path.write_text(APM)
    found = read_apm(path)
    assert found.quaternion.tolist() == [[0, 0, 0.6, 0.8]]
    assert (found.frame, found.notes) == ("EME2000", ("inertia is passed over",))
    path.write_text(APM_1)
    assert read_apm(path).quaternion.tolist() == [[0, 0, -0.6, 0.8]]
    quaternion = "<quaternion><QC>0.8</QC><Q1>0</Q1><Q2>0</Q2><Q3>0.6</Q3></quaternion>"
    frames = "<REF_FRAME_A>EME2000</REF_FRAME_A><REF_FRAME_B>SC_BODY_1</REF_FRAME_B>"
    meta = {key: META[key] for key in ("OBJECT_NAME", "OBJECT_ID", "TIME_SYSTEM")}
    state = f"<EPOCH>2026-04-01T00:00:00</EPOCH><quaternionState>{frames}{quaternion}</quaternionState>"
    path.write_text(xml("apm", (meta, state)))
    assert read_apm(path).quaternion.tolist() == [[0, 0, 0.6, 0.8]]
    q = np.random.default_rng(2).normal(size=4)
    rows = AttitudeRows("CRAFT", "X", "EME2000", "UTC", found.instants, q[None])
    again = read_apm(write_apm(path, rows, "2026-04-01T00:00:00", "EARTH"))
    assert np.abs(again.quaternion[0] - q / np.linalg.norm(q)).max() < 2e-15
    assert again.instants == found.instants


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("QUAT_STOP", "QUAT_STOP\nMAN_START", "manoeuvres"),
        ("Q3 = 0.6", "Q3 = 0.9", "line 13: a quaternion of length"),
        ("Q3 = 0.6", "Q3 = nan", "line 15: Q3 is no finite number"),
        ("Q3 = 0.6\n", "", "has no Q3"),
        ("B = SC_BODY_1", "B = ICRF", "SC_BODY"),
        ("2.0", "3.0", "version 3"),
        ("TIME_SYSTEM = UTC", "TIME_SYSTEM = MRT", "MRT"),
        ("Q3 = 0.6", "Q4 = 0.6", "Q4 is no keyword"),
        ("Q3 = 0.6", "Q3 = 0.6 [deg]", r"Q3 is in \[deg\]"),
        (APM[APM.index("Q1") : APM.index("QUAT_STOP")], "", "has no quaternion"),
    ],
)
def test_an_attitude_that_is_none_is_refused_in_one_sentence(tmp_path, old, new, words):
    assert old in APM
    (tmp_path / "a.apm").write_text(APM.replace(old, new, 1))
    with pytest.raises(RecordingError, match=words) as told:
        read_apm(tmp_path / "a.apm")
    assert "\n" not in str(told.value)


def test_a_flight_is_known_by_what_its_file_holds(tmp_path):
    """Under any name; a message of another kind is told as what it is."""
    segments = [(META, rows(count=40))]
    one, other = both(tmp_path, segments)
    for path in (one, other):
        strange = path.rename(tmp_path / f"{path.suffix[1:]}.dat")
        assert is_flight(strange)
        assert len(read_flight(strange)) == 40
    (tmp_path / "a.csv").write_text(keywords("oem", *segments))
    assert len(read_flight(tmp_path / "a.csv")) == 40
    (tmp_path / "a.apm").write_text(APM)
    assert ndm.kind_of(tmp_path / "a.apm") == "APM"
    assert ndm.kind_of(tmp_path) == ndm.kind_of(tmp_path / "none") == ""
    said = CliRunner().invoke(main, ["view", str(tmp_path / "a.apm")])
    assert (said.exit_code, said.output) == (2, f"{tmp_path / 'a.apm'} is an APM, one attitude, and no flight\n")
