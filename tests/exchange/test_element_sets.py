"""Element sets: SGP4's own verification row, a made-up satellite, four spellings of one message, and faults.

States in TEME: the published verification of SGP4 (AIAA 2006-6753, satellite 5) and, for the made-up set, two
implementations of SGP4 that agree to 1e-7 km.
"""

import json
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("sgp4")

from sailviz.exchange import element_sets
from sailviz.exchange.element_sets import named, of_lines, read_element_sets

FOREIGN = Path(__file__).parents[1] / "data" / "foreign"
VANGUARD = (
    "1 00005U 58002B   00179.78495062  .00000023  00000-0  28098-4 0  4753",
    "2 00005  34.2682 348.7242 1859667 331.7664  19.3264 10.82419157413667",
)


def test_the_first_verification_row_of_sgp4():
    found = of_lines(*VANGUARD)
    position, velocity = found.state(found.epoch)
    np.testing.assert_allclose(position, np.multiply(1e3, (7022.46529266, -1400.08296755, 0.03995155)), atol=1e-4)
    np.testing.assert_allclose(velocity, np.multiply(1e3, (1.893841015, 6.405893759, 4.534807250)), atol=1e-6)
    assert found.epoch == datetime(2000, 6, 27, 18, 50, 19, 733568)


def test_a_made_up_satellite_at_its_epoch_and_a_day_later():
    (found,) = read_element_sets(FOREIGN / "tle_made_up.txt")
    assert (found.name, found.epoch) == ("MADE UP", datetime(2026, 4, 30, 12))
    position, velocity = found.state(found.epoch)
    np.testing.assert_allclose(position, np.multiply(1e3, (-5976.293537918, -3467.914868411, -2.081082800)), atol=1e-3)
    np.testing.assert_allclose(velocity, np.multiply(1e3, (-0.484191070525, 0.864781888214, 7.532522135531)), atol=1e-6)
    position, velocity = found.state(found.epoch + timedelta(days=1))
    np.testing.assert_allclose(
        position, np.multiply(1e3, (-4758.342930075, -2179.803794674, 4492.607177877)), atol=1e-3
    )
    np.testing.assert_allclose(velocity, np.multiply(1e3, (3.902878328710, 3.226929722047, 5.675256963905)), atol=1e-6)


MESSAGE = {
    "CCSDS_OMM_VERS": "2.0",
    "OBJECT_NAME": "MADE UP",
    "OBJECT_ID": "2026-001A",
    "CENTER_NAME": "EARTH",
    "REF_FRAME": "TEME",
    "TIME_SYSTEM": "UTC",
    "MEAN_ELEMENT_THEORY": "SGP4",
    "EPOCH": "2026-04-30T12:00:00.000000",
    "MEAN_MOTION": "15.12345678",
    "ECCENTRICITY": ".0012345",
    "INCLINATION": "97.5",
    "RA_OF_ASC_NODE": "210.1234",
    "ARG_OF_PERICENTER": "85.6789",
    "MEAN_ANOMALY": "274.5678",
    "EPHEMERIS_TYPE": "0",
    "CLASSIFICATION_TYPE": "U",
    "NORAD_CAT_ID": "99001",
    "ELEMENT_SET_NO": "999",
    "REV_AT_EPOCH": "1",
    "BSTAR": ".56789E-4",
    "MEAN_MOTION_DOT": ".1234E-4",
    "MEAN_MOTION_DDOT": "0",
}


def _spelled(form, message):
    if form == "json":
        return json.dumps([message])
    if form == "csv":
        return ",".join(message) + "\n" + ",".join(message.values()) + "\n"
    if form == "kvn":
        return "".join(f"{key:20} = {value}\n" for key, value in message.items())
    inner = "".join(f"<{key}>{value}</{key}>" for key, value in message.items() if key != "CCSDS_OMM_VERS")
    return f'<?xml version="1.0"?><ndm><omm><body><segment><metadata>{inner}</metadata></segment></body></omm></ndm>'


@pytest.mark.parametrize("form", ["json", "csv", "kvn", "xml"])
def test_a_message_says_what_its_two_lines_say(tmp_path, form):
    path = tmp_path / f"made_up.{form}"
    message = MESSAGE if form != "csv" else {key: MESSAGE[key] for key in MESSAGE if key != "CCSDS_OMM_VERS"}
    path.write_text(_spelled(form, message))
    (found,) = read_element_sets(path)
    (lines,) = read_element_sets(FOREIGN / "tle_made_up.txt")
    assert (found.name, found.epoch) == (lines.name, lines.epoch)
    for minutes in (0.0, 1440.0, -3000.0):
        date = found.epoch + timedelta(minutes=minutes)
        np.testing.assert_allclose(np.ravel(found.state(date)), np.ravel(lines.state(date)), atol=1e-3)


def test_units_and_a_terse_message_are_taken(tmp_path):
    terse = {key: MESSAGE[key] for key in ("CCSDS_OMM_VERS", "EPOCH", *element_sets._NUMBERS)}
    terse["MEAN_MOTION"] += " [rev/day]"
    terse["EPOCH"] = "2026-120T12:00:00"
    (tmp_path / "a.omm").write_text(_spelled("kvn", terse))
    (found,) = read_element_sets(tmp_path / "a.omm")
    assert found.epoch == datetime(2026, 4, 30, 12)
    assert np.isfinite(np.ravel(found.state(found.epoch))).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"REF_FRAME": "EME2000"}, "message 1, MADE UP: REF_FRAME is EME2000; SGP4 wants TEME"),
        ({"MEAN_ELEMENT_THEORY": "DSST"}, "MEAN_ELEMENT_THEORY is DSST"),
        ({"MEAN_MOTION": ""}, "MEAN_MOTION is lacking"),
        ({"INCLINATION": "steep"}, "INCLINATION is no number: 'steep'"),
        ({"BSTAR": "nan"}, "BSTAR is no number"),
        ({"ECCENTRICITY": "1.2"}, "this is no orbit round the Earth"),
        ({"EPOCH": "2026-02-30T00:00:00"}, "there is no such day"),
    ],
)
def test_a_message_that_is_wrong_is_told(tmp_path, change, message):
    path = tmp_path / "a.json"
    path.write_text(_spelled("json", MESSAGE | change))
    with pytest.raises(ValueError, match=message.replace("(", r"\(")):
        read_element_sets(path)


def _with(number, begin, text):
    line = VANGUARD[number - 1]
    line = line[:begin] + text + line[begin + len(text) :]
    return line[:68] + str(element_sets.check_digit(line))


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ((VANGUARD[0][:-1] + "4", VANGUARD[1]), "the check digit of line 1 is '4', .*its digits make 3"),
        ((VANGUARD[0], VANGUARD[1][:-1] + "8"), "the check digit of line 2 is '8'"),
        ((VANGUARD[0][:-2], VANGUARD[1]), "line 1 of an element set has 69 characters, not 67"),
        ((VANGUARD[1], VANGUARD[0]), "line 1 of an element set begins with '1', not '2 '"),
        ((VANGUARD[0], _with(2, 2, "00006")), "the two lines are of different satellites: 00005 and 00006"),
        ((_with(1, 20, "400.00000000"), VANGUARD[1]), "no day of a year"),
        ((VANGUARD[0], _with(2, 26, "18596A7")), "the eccentricity in line 2 is no number"),
        ((VANGUARD[0], _with(2, 8, " 34.26x2")), "the inclination in line 2 is no number"),
        ((VANGUARD[0], _with(2, 52, "           ")), "the mean motion in line 2 is no number"),
    ],
)
def test_lines_that_are_wrong_are_told(lines, message):
    with pytest.raises(ValueError, match=message):
        of_lines(*lines)


def test_a_file_of_many_sets_is_asked_by_name_and_gives_the_latest(tmp_path):
    one = (FOREIGN / "tle_made_up.txt").read_text()
    path = tmp_path / "many.txt"
    path.write_text(one + "VANGUARD 1\n" + "\n".join(VANGUARD) + "\n")
    sets = read_element_sets(path)
    assert named(sets, "vanguard 1").epoch.year == 2000
    with pytest.raises(ValueError, match="say the name of one"):
        named(sets, None)
    with pytest.raises(ValueError, match="VANGUARD 1"):
        named(sets, "VANGARD 1")
    later = [element_sets.ElementSet("X", datetime(2026, 1, day), VANGUARD) for day in (1, 3, 2)]
    assert named(later, "x").epoch.day == 3


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no element sets in this file"),
        ("hello\nworld\n", "no element sets in this file"),
        (VANGUARD[0] + "\n", "line 1: the second line of this element set is lacking"),
        (
            "A\n" + VANGUARD[0] + "\n" + VANGUARD[1][:50] + "\n",
            "line 2: line 2 of an element set has 69 characters, not 50",
        ),
        ("[1, 2]", "this JSON holds no messages"),
        ("{", "this is no JSON"),
        ("<a>", "this is no XML"),
        ('<!DOCTYPE x [<!ENTITY a "b">]><x/>', "no document type"),
        ("<ndm></ndm>", "no messages in this file"),
    ],
)
def test_files_that_are_none_are_told(tmp_path, text, message):
    path = tmp_path / "a.txt"
    path.write_text(text)
    with pytest.raises(ValueError, match=message):
        read_element_sets(path)


def test_a_set_is_not_carried_for_years_and_a_decayed_one_says_so():
    found = of_lines(*VANGUARD)
    with pytest.raises(ValueError, match="is 31 d away, more than 30"):
        found.state(found.epoch + timedelta(days=31))
    low = list(VANGUARD)
    low[1] = _with(2, 52, "17.95000000")
    with pytest.raises(ValueError, match=r"SGP4 finds no state: it has decayed|lies below the surface"):
        of_lines(*low).state(found.epoch)


def test_every_digit_of_a_line_is_guarded_but_those_that_stay_numbers():
    """A letter put anywhere is refused or changes nothing that is read."""
    rng = np.random.default_rng(5)
    for _ in range(3000):
        number, at = int(rng.integers(1, 3)), int(rng.integers(0, 69))
        lines = list(VANGUARD)
        lines[number - 1] = lines[number - 1][:at] + chr(int(rng.integers(33, 127))) + lines[number - 1][at + 1 :]
        try:
            found = of_lines(*lines)
            state = found.state(found.epoch)
        except ValueError:
            continue
        assert np.isfinite(np.ravel(state)).all()
