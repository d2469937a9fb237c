"""A light that is not at the centre of a flight from elsewhere: angles count from it, and it is drawn where it is."""

import numpy as np
import pytest

import sailviz
from sailviz.constants import AU, MU_EARTH
from sailviz.run.from_arrays import TrajectoryError, trajectory

MU_MARS = 4.2828375816e13
N = 40
ANGLE = np.linspace(0, 4.0, N)
RADIUS = 9e6
TIME = ANGLE * np.sqrt(RADIUS**3 / MU_MARS)
PLACE = RADIUS * np.stack([np.cos(ANGLE), np.sin(ANGLE), 0 * ANGLE], 1)
SPEED = np.sqrt(MU_MARS / RADIUS) * np.stack([-np.sin(ANGLE), np.cos(ANGLE), 0 * ANGLE], 1)
TOWARDS = np.array([0.48, 0.6, -0.64])


def flown(**options):
    given = {"mu": MU_MARS, "body": "Mars", "radius": 3396.19e3, "device": "solar-sail", **options}
    return trajectory(TIME, PLACE, SPEED, **given)


def test_a_direction_is_a_light_an_au_away_and_a_sail_faces_it_by_itself():
    run = flown(light=3.7 * TOWARDS)
    assert run.bodies["Sun"] == pytest.approx(np.tile(AU * TOWARDS, (N, 1)), rel=1e-12)
    assert run.attitude.pitch == pytest.approx(0.0, abs=1e-7)
    assert run.attitude.normal == pytest.approx(np.tile(-TOWARDS, (N, 1)), abs=1e-4)
    assert dict(run.setting.parameters)["light"] == "the Sun"


def test_angles_count_from_places_of_the_light_and_from_the_north_of_the_ecliptic():
    """The normal leans by 0.5 rad towards east, seen from the light with north up: a clock of 90 deg."""
    light = AU * np.stack([np.cos(0.1 * ANGLE), np.sin(0.1 * ANGLE), 0 * ANGLE], 1)
    u = (PLACE - light) / np.linalg.norm(PLACE - light, axis=1)[:, None]
    east = np.cross([0.0, 0.0, 1.0], u)
    east /= np.linalg.norm(east, axis=1)[:, None]
    run = flown(light=light, normal=np.cos(0.5) * u + np.sin(0.5) * east)
    assert run.attitude.pitch == pytest.approx(0.5, abs=1e-9)
    assert run.attitude.clock == pytest.approx(np.pi / 2, abs=1e-9)
    assert flown(light=light).setting.identity != flown(light=light + 1e6).setting.identity


def test_a_star_of_ones_own_takes_the_place_of_the_sun():
    run = trajectory(TIME, PLACE, SPEED, mu=MU_EARTH, epoch="2030-01-01", light=TOWARDS, star="Altaira")
    assert "Sun" not in run.bodies
    assert run.bodies["light"][0] == pytest.approx(AU * TOWARDS)
    assert dict(run.setting.parameters)["light"] == "Altaira"


def test_rows_without_data_take_their_light_with_them():
    holes = PLACE.copy()
    holes[7:9] = np.nan
    light = AU * TOWARDS + np.outer(ANGLE, [1e9, 0, 0])
    run = trajectory(TIME, holes, np.where(np.isnan(holes), np.nan, SPEED), mu=MU_MARS, body="Mars", light=light)
    assert run.bodies["Sun"] == pytest.approx(np.delete(light, [7, 8], axis=0))


def test_the_night_is_drawn_away_from_the_light(tmp_path):
    sailviz.record(flown(light=TOWARDS), tmp_path / "mars.rrd")
    found = sailviz.read(tmp_path / "mars.rrd")
    assert found["/attitude"]["pitch_rad"] == pytest.approx(0.0, abs=1e-7)
    x, y, z, w = np.asarray(found["/world/night"]["quaternion"], float).reshape(-1, 4).T
    away = np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], 1)  # its z axis
    assert away == pytest.approx(np.tile(-TOWARDS, (len(away), 1)), abs=1e-6)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"light": [0, 0, 0]}, "light"),
        ({"light": [1, 0]}, "light: shape"),
        ({"light": np.ones((3, N))}, "transpose it"),
        ({"light": PLACE}, "the craft is where the light is"),
        ({"star": "Altaira"}, "star: it is the name of a light, and none is given"),
        ({"light": [1, 0, 0], "body": "Sun", "mu": 1.32712440018e20, "radius": 695_700e3}, "shines there"),
    ],
)
def test_a_light_that_says_nothing_is_refused(options, words):
    with pytest.raises(TrajectoryError, match=words):
        flown(**options)
