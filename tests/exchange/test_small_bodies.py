"""Small bodies: three made-up orbits in the layouts of JPL and the Minor Planet Center, and files that are none.

Reference states, ecliptic of J2000: a closed form and an independent toolkit's conics agree to the printed digits.
"""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from sailviz import two_body
from sailviz.constants import AU, MU_SUN
from sailviz.exchange.small_bodies import SmallBody, by_anomaly, julian_day, read_small_body

FOREIGN = Path(__file__).parents[1] / "data" / "foreign"
MU_DE440 = 1.3271244004127942e20  # m3/s2, with which the references were made: 1.8e-10 off the product's


def _state(body, day):
    position, velocity = body.at_perihelion()
    place, speed = two_body.advance([position], [velocity], [(day - body.passage) * 86_400.0], MU_SUN)
    return np.concatenate([place[0], speed[0]]) / 1e3


ASTEROID = (
    (2461000.5, (43239281.07724, 210681763.2581, -17786094.53628, -22.780246016, 10.035261848, 1.377763902)),
    (2461200.5, (-251964168.1442, 72356420.25040, 17790675.36222, -4.975831910, -19.341109321, 1.722949346)),
)


@pytest.mark.parametrize("name", ["sbdb_made_up.json", "mpcorb_made_up.dat"])
@pytest.mark.parametrize(("day", "wanted"), ASTEROID)
def test_an_asteroid(name, day, wanted):
    found = _state(read_small_body(FOREIGN / name), day)
    assert np.abs(found[:3] - wanted[:3]).max() < 0.2  # km: the two values of mu
    assert np.abs(found[3:] - wanted[3:]).max() < 1e-8


def test_a_hyperbolic_comet():
    body = read_small_body(FOREIGN / "comet_made_up.txt", "made up")
    assert body.name == "C/2027 A1 (Made Up)"
    found = _state(body, 2461400.5)
    wanted = (-255931253.2955, -154978805.1146, 53541544.80272, 7.583910865, 20.075771304, -23.515339672)
    assert np.abs(found[:3] - wanted[:3]).max() < 0.5
    assert np.abs(found[3:] - wanted[3:]).max() < 1e-8


def test_a_parabola():
    body = SmallBody("", 0.9 * AU, 1.0, math.radians(45), math.radians(100), math.radians(200), 2461500.25)
    wanted = (-171831289.7201, -116564020.4371, 189461916.0568, 21.555785177, -9.977486109, -19.495732084)
    found = _state(body, 2461400.5)
    assert np.abs(found[:3] - wanted[:3]).max() < 0.5
    assert np.abs(found[3:] - wanted[3:]).max() < 1e-8


def test_a_nearly_parabolic_orbit_is_told_by_its_perihelion(tmp_path):
    answer = json.loads((FOREIGN / "sbdb_made_up.json").read_text())
    values = {"e": "0.99", "q": "1.1", "tp": "2461000.5", "a": "110", "ma": "99"}
    for item in answer["orbit"]["elements"]:
        item["value"] = values.get(item["name"], item["value"])
    (tmp_path / "a.json").write_text(json.dumps(answer))
    body = read_small_body(tmp_path / "a.json")
    assert (body.perihelion, body.passage) == (1.1 * AU, 2461000.5)


def test_an_orbit_by_its_anomaly_is_where_the_anomaly_says():
    rng = np.random.default_rng(3)
    for _ in range(50):
        e = rng.uniform(0, 2)
        if abs(e - 1) < 0.02:
            continue
        axis = AU * (1 if e < 1 else -1) * rng.uniform(0.3, 3)
        mean = rng.uniform(-3, 3)
        body = by_anomaly("", axis, e, 0.3, 1.0, 2.0, mean, 2_461_000.5)
        position, velocity = body.at_perihelion()
        span = (2_461_000.5 - body.passage) * 86_400.0
        r, v = two_body.advance([position], [velocity], [span], MU_SUN)
        size, radial = np.linalg.norm(r[0]), float(r[0] @ v[0])
        if e < 1:
            x = math.atan2(radial / math.sqrt(MU_SUN * axis), 1 - size / axis)
            assert math.remainder(x - e * math.sin(x) - mean, 2 * math.pi) == pytest.approx(0.0, abs=1e-8)
        else:
            x = math.asinh(radial / math.sqrt(-MU_SUN * axis) / e)
            assert e * math.sinh(x) - x == pytest.approx(mean, rel=1e-7, abs=1e-8)


def test_many_orbits_are_asked_by_name(tmp_path):
    line = (FOREIGN / "mpcorb_made_up.dat").read_text().splitlines()[-1]
    other = line.replace("(99001) Made Up", "(99002) Other  ").replace("99001", "99002", 1)
    (tmp_path / "a.dat").write_text(line + "\n" + other + "\n")
    assert read_small_body(tmp_path / "a.dat", "other").name == "(99002) Other"
    assert read_small_body(tmp_path / "a.dat", "99001").name == "(99001) Made Up"
    for name, message in ((None, "say the name of one"), ("9900", "2 orbits have 9900"), ("Othr", "Other")):
        with pytest.raises(ValueError, match=message):
            read_small_body(tmp_path / "a.dat", name)


@pytest.mark.parametrize(
    ("name", "old", "new", "message"),
    [
        ("sbdb_made_up.json", '".2056"', '"much"', "the element e is no number: 'much'"),
        ("sbdb_made_up.json", '".2056"', "null", "the element e is lacking"),
        ("sbdb_made_up.json", '"6.35"', '"200"', "inclination must lie between 0 and 180 deg"),
        ("sbdb_made_up.json", '"1.4582"', '"-1.4582"', "an ellipse has"),
        ("sbdb_made_up.json", '"orbit"', '"orbits"', "no answer of the Small-Body Database"),
        ("mpcorb_made_up.dat", "0.2056000", "0.2o56000", "line 4: the eccentricity is no number"),
        ("mpcorb_made_up.dat", "K25BL", "K25DL", "no orbits of small bodies in this file"),
        ("mpcorb_made_up.dat", "K25BL", "K252V", "line 4: there is no day 2025-02-31"),
        ("comet_made_up.txt", "1.234500", "-1.23450", "the perihelion distance must be positive"),
        ("comet_made_up.txt", "2027 04", "2027 14", "line 1: there is no day 2027-14"),
    ],
)
def test_orbits_that_are_wrong_are_told(tmp_path, name, old, new, message):
    text = (FOREIGN / name).read_text()
    assert old in text
    (tmp_path / name).write_text(text.replace(old, new, 1))
    with pytest.raises(ValueError, match=message):
        read_small_body(tmp_path / name)


def test_julian_days():
    assert julian_day(2000, 1, 1.5) == 2_451_545.0
    assert julian_day(1858, 11, 17.0) == 2_400_000.5
