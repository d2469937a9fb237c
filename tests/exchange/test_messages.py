"""Orbit parameter, mean-elements and attitude messages: written and read back, in the dialects there are, or refused in
one sentence with the line."""

from pathlib import Path

import numpy as np
import pytest

import sailviz
from sailviz.calendar import tai
from sailviz.errors import RecordingError
from sailviz.exchange.aem import AttitudeRows, read_aem, write_aem
from sailviz.exchange.element_sets import read_element_sets
from sailviz.exchange.omm import write_omm
from sailviz.exchange.opm import read_opm, write_opm
from sailviz.simulation.plan import plan

FOREIGN = Path(__file__).parents[1] / "data" / "foreign"
OPM = """CCSDS_OPM_VERS = 2.0
CREATION_DATE = 2026-01-01T00:00:00
ORIGINATOR = SOMEBODY
COMMENT a made-up state
OBJECT_NAME = CRAFT
OBJECT_ID = 2026-001A
CENTER_NAME = Earth
REF_FRAME = EME2000
TIME_SYSTEM = UTC
EPOCH = 2026-091T12:00:00.5
X = 6503.514000 [km]
Y = 1239.647000 [km]
Z = -717.490000 [km]
X_DOT = -0.873160 [km/s]
Y_DOT = 8.740420 [km/s]
Z_DOT = -4.191076 [km/s]
MASS = 3000.0 [kg]
SOLAR_RAD_AREA = 18.77 [m**2]
DRAG_COEFF = 2.5
"""


def _file(tmp_path, text, name="message"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def test_a_state_is_read_in_si_and_written_to_its_digits(tmp_path):
    found = read_opm(_file(tmp_path, OPM))
    assert found.position == pytest.approx((6503514.0, 1239647.0, -717490.0), rel=1e-15)
    assert found.velocity == pytest.approx((-873.160, 8740.420, -4191.076), rel=1e-15)
    assert found.instant == tai("2026-04-01T12:00:00.5", "UTC")
    assert (found.center, found.mass, found.solar_area, found.drag_coefficient) == ("EARTH", 3000.0, 18.77, 2.5)
    again = read_opm(write_opm(tmp_path / "again.opm", found))
    assert again.position == pytest.approx(found.position, rel=1e-15)
    assert again.instant == found.instant
    assert again.mass == found.mass


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("MASS = 3000.0 [kg]", "MAN_EPOCH_IGNITION = 2026-091T13:00:00", "manoeuvres"),
        ("X = 6503.514000 [km]", "X = 6503514.0 [m]", r"line 11: X is in \[m\]"),
        ("X = 6503.514000 [km]", "X = nan [km]", "line 11: X is no finite number"),
        ("X = 6503.514000 [km]", "X = 6.5D3 [km]", "line 11: X is no finite number"),
        ("X = 6503.514000 [km]\n", "", "has no X"),
        ("EPOCH = 2026-091", "EPOCH = 2026-400", "line 10"),
        ("TIME_SYSTEM = UTC", "TIME_SYSTEM = MRT", "MRT"),
        ("REF_FRAME = EME2000", "REF_FRAME = EME2000\nREF_FRAME_EPOCH = 2000-01-01", "REF_FRAME_EPOCH"),
        ("MASS = 3000.0", "MASSE = 3000.0", "MASSE is no keyword"),
        ("MASS = 3000.0", "MASS = -3000.0", "negative"),
        ("DRAG_COEFF", "MASS = 1\nDRAG_COEFF", "twice"),
        ("CCSDS_OPM_VERS = 2.0", "CCSDS_OEM_VERS = 2.0", "not an OPM"),
        ("CCSDS_OPM_VERS = 2.0", "<opm>", "XML"),
    ],
)
def test_a_state_that_is_none_is_refused_in_one_sentence(tmp_path, old, new, words):
    assert old in OPM
    with pytest.raises(RecordingError, match=words) as told:
        read_opm(_file(tmp_path, OPM.replace(old, new)))
    assert "\n" not in str(told.value)


def test_a_scene_begins_at_the_state_of_a_message(tmp_path, monkeypatch):
    scene = {
        "title": "from a message",
        "family": "deorbit",
        "body": "earth",
        "frame": "icrf",
        "start": {"kind": "oem", "file": "state.opm"},
        "device": {"kind": "none"},
        "propagation": {"duration_d": 0.01, "outputs": 5},
    }
    _file(tmp_path, OPM, "state.opm")
    monkeypatch.chdir(tmp_path)
    planned = plan(sailviz.load_scene(scene))
    assert planned.position == pytest.approx((6503514.0, 1239647.0, -717490.0), rel=1e-12)


def test_an_element_set_written_as_a_message_is_the_same_set(tmp_path):
    pytest.importorskip("sgp4")
    (known,) = read_element_sets(FOREIGN / "tle_made_up.txt")
    (found,) = read_element_sets(write_omm(tmp_path / "set.omm", known))
    assert found.epoch == known.epoch
    assert np.array(found.state(known.epoch)[0]) == pytest.approx(known.state(known.epoch)[0], abs=1e-3)  # m
    (again,) = read_element_sets(write_omm(tmp_path / "again.omm", found))
    assert again.state(known.epoch) == found.state(known.epoch)


AEM = """CCSDS_AEM_VERS = 2.0
CREATION_DATE = 2026-01-01T00:00:00
ORIGINATOR = SOMEBODY
META_START
OBJECT_NAME = CRAFT
OBJECT_ID = 2026-001A
REF_FRAME_A = EME2000
REF_FRAME_B = SC_BODY_1
TIME_SYSTEM = UTC
START_TIME = 2026-04-01T00:00:00
STOP_TIME = 2026-04-01T00:02:00
ATTITUDE_TYPE = QUATERNION
META_STOP
DATA_START
2026-04-01T00:00:00 0.0 0.0 0.6 0.8
2026-04-01T00:01:00 0.0 0.0 -0.8 -0.6
DATA_STOP
"""


def test_quaternions_have_their_scalar_last_and_one_sign(tmp_path):
    found = read_aem(_file(tmp_path, AEM))
    assert found.frame == "EME2000"
    assert found.quaternion.tolist() == [[0, 0, 0.6, 0.8], [0, 0, 0.8, 0.6]]
    assert np.diff(found.instants).tolist() == [60 * 10**9]


@pytest.mark.parametrize(
    ("version", "a", "b", "way", "sign"),
    [
        ("2.0", "EME2000", "SC_BODY_1", "", 1), ("2.0", "SC_BODY_1", "EME2000", "", -1),
        ("1.0", "EME2000", "SC_BODY_1", "ATTITUDE_DIR = A2B", 1),
        ("1.0", "EME2000", "SC_BODY_1", "ATTITUDE_DIR = B2A", -1),
        ("1.0", "SC_BODY_1", "EME2000", "ATTITUDE_DIR = B2A", 1),
    ],
)  # fmt: skip
def test_the_direction_of_a_quaternion_is_that_of_its_version(tmp_path, version, a, b, way, sign):
    text = AEM.replace("VERS = 2.0", f"VERS = {version}").replace("ATTITUDE_TYPE", f"{way}\nATTITUDE_TYPE")
    text = text.replace("A = EME2000", f"A = {a}").replace("B = SC_BODY_1", f"B = {b}")
    found = read_aem(_file(tmp_path, text))
    assert found.quaternion[0].tolist() == [0, 0, sign * 0.6, 0.8]


def test_version_one_says_where_the_scalar_is(tmp_path):
    text = AEM.replace("VERS = 2.0", "VERS = 1.0").replace("META_STOP", "QUATERNION_TYPE = FIRST\nMETA_STOP")
    assert read_aem(_file(tmp_path, text)).quaternion[0].tolist() == [0, 0.6, 0.8, 0]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("ATTITUDE_TYPE = QUATERNION", "ATTITUDE_TYPE = EULER_ANGLE", "EULER_ANGLE"),
        (" 0.6 0.8", " 0.6 0.9", "line 15: a quaternion of length 1.08"),
        (" 0.6 0.8", " 0.6", "line 15: an epoch and 4 numbers"),
        (" 0.6 0.8", " 0.6 nan", "line 15: an attitude is no finite number"),
        ("2026-04-01T00:01:00", "2026-04-01T00:00:00", "line 16: epochs must increase"),
        ("B = SC_BODY_1", "B = ICRF", "SC_BODY"),
        ("REF_FRAME_A = EME2000\n", "", "has no REF_FRAME_A"),
        ("VERS = 2.0", "VERS = 3.0", "version 3"),
        ("DATA_START", "", "outside of a block"),
    ],
)
def test_an_attitude_that_is_none_is_refused_in_one_sentence(tmp_path, old, new, words):
    assert old in AEM
    with pytest.raises(RecordingError, match=words) as told:
        read_aem(_file(tmp_path, AEM.replace(old, new, 1)))
    assert "\n" not in str(told.value)


def test_a_length_a_little_off_one_is_mended_and_said(tmp_path):
    found = read_aem(_file(tmp_path, AEM.replace("0.6 0.8", "0.6001 0.8001")))
    assert np.linalg.norm(found.quaternion, axis=1) == pytest.approx([1, 1], abs=1e-15)
    assert "length 1" in found.notes[0]


def test_attitudes_come_back_as_they_were_written(tmp_path):
    generator = np.random.default_rng(3)
    q = generator.normal(size=(9, 4))
    instants = tai("2026-04-01T00:00:00", "TT") + np.arange(9) * 10**9
    epochs = [f"2026-04-01T00:00:0{k}" for k in range(9)]
    rows = AttitudeRows("CRAFT", "X", "EME2000", "TT", instants, q, (0, 5))
    found = read_aem(write_aem(tmp_path / "a.aem", rows, epochs))
    assert found.begins == (0, 5)
    assert np.array_equal(found.instants, instants)
    q = q / np.linalg.norm(q, axis=1, keepdims=True)
    assert np.abs(np.abs(np.sum(found.quaternion * q, axis=1)) - 1).max() < 1e-15
    assert np.all(np.sum(found.quaternion[1:] * found.quaternion[:-1], axis=1) >= 0)


def test_an_exported_attitude_turns_the_third_axis_to_the_normal_of_the_sail(tmp_path):
    run = sailviz.simulate(
        sailviz.load_scene("displaced/mars-following").with_values(
            {"propagation.outputs": 40, "epoch": "2031-04-01", "expect": []}
        )
    )
    path = tmp_path / "a.aem"
    sailviz.export(run, path, frame="ECLIPJ2000")
    found = read_aem(path)
    assert found.frame == "ECLIPJ2000"
    x, y, z, w = found.quaternion.T
    third = np.stack([2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)], 1)  # C^T (0, 0, 1)
    assert np.abs(third - run.attitude.normal).max() < 1e-14
    sailviz.export(run, path)
    x, y, z, w = read_aem(path).quaternion.T
    turned = np.stack([2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)], 1)
    tilt = np.radians(84381.448 / 3600)
    c, s = np.cos(tilt), np.sin(tilt)
    assert np.abs(turned - run.attitude.normal @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]).T).max() < 1e-12


@pytest.mark.parametrize("text", [OPM, AEM])
def test_a_damaged_message_is_read_or_refused_in_one_sentence(tmp_path, text):
    read = read_opm if text is OPM else read_aem
    generator = np.random.default_rng(11)
    refused = 0
    for _ in range(150):
        letters = bytearray(text.encode())
        for place in generator.integers(0, len(letters), 3):
            letters[place] = int(generator.integers(0, 256))
        path = tmp_path / "damaged"
        path.write_bytes(letters[: generator.integers(1, len(letters))] if generator.integers(2) else letters)
        try:
            read(path)
        except RecordingError as error:
            refused += "\n" not in str(error)
    assert refused > 75
