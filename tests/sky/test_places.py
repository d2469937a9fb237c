"""Where bodies stand: against JPL's DE421, published examples and what the Earth and the Moon do to each other."""

import numpy as np
import pytest

from sailviz.constants import AU, DAY, YEAR
from sailviz.sky import BODIES, Sky
from sailviz.sky.bodies import sphere_of_influence
from sailviz.sky.kernels import Kernel, kernel_file
from sailviz.sky.moon_series import moon_of_date
from sailviz.sky.places import tdb_ahead

EPOCH = np.datetime64("2026-03-20T00:00:00", "ns")


@pytest.fixture
def de421():
    pytest.importorskip("jplephem")
    pytest.importorskip("skyfield_data")


def test_the_moon_of_the_printed_example():
    """Meeus, example 47.a: 1992 April 12.0 TD."""
    longitude, latitude, distance = moon_of_date((2_448_724.5 - 2_451_545.0) / 36_525)
    assert np.degrees(longitude[0]) % 360 == pytest.approx(133.162655, abs=1e-6)
    assert np.degrees(latitude[0]) == pytest.approx(-3.229126, abs=1e-6)
    assert distance[0] == pytest.approx(368_409.7e3, abs=50)


@pytest.mark.usefixtures("de421")
@pytest.mark.parametrize(
    ("body", "frame", "place"),
    [
        ("sun", "icrf", (148940181496.0, -2322767105.5, -1007535310.4)),
        ("moon", "icrf", (362541915.73, 59535301.59, 45829302.61)),
        ("sun", "equator-of-date", (148953321355.6, -1449650930.4, -628178163.0)),
        ("moon", "equator-of-date", (362068799.66, 61659113.61, 46752067.36)),
    ],
)
def test_places_seen_from_the_earth_are_those_of_the_kernel(body, frame, place):
    found = Sky(EPOCH, frame, "de421").position(body, "earth", 0.0)[0]
    assert found == pytest.approx(place, abs=0.2 if body == "sun" else 0.006)


@pytest.mark.usefixtures("de421")
@pytest.mark.parametrize(
    ("body", "centre", "most"),
    [("moon", "earth", 28e3), ("sun", "earth", 15_000e3), ("venus", "sun", 15_750e3), ("mercury", "sun", 10_300e3)],
)
def test_the_series_are_as_good_as_they_are_said_to_be(body, centre, most):
    time = np.linspace(0.0, 9.75 * YEAR, 6001)
    series, kernel = Sky(EPOCH), Sky(EPOCH, source="de421")
    off = np.linalg.norm(series.position(body, centre, time) - kernel.position(body, centre, time), axis=1)
    assert off.max() < most
    assert off.max() > 0.3 * most  # or the sentence says too little


def test_the_earth_swings_about_the_barycentre_that_it_shares_with_the_moon():
    sky, time = Sky(EPOCH), np.linspace(0.0, 30 * DAY, 61)
    earth, moon = (sky.position(name, "earth-moon", time) for name in ("earth", "moon"))
    assert np.allclose(BODIES["earth"].mu * earth + BODIES["moon"].mu * moon, 0.0, atol=1e-6 * BODIES["moon"].mu * 4e8)
    assert np.linalg.norm(earth, axis=1).min() > 4.3e6
    assert np.linalg.norm(earth, axis=1).max() < 5.0e6


def test_a_place_seen_from_there_is_the_way_back():
    sky = Sky(EPOCH, "equator-of-date")
    time = np.array([0.0, 17.3 * DAY])
    assert np.array_equal(sky.position("mars", "moon", time), -sky.position("moon", "mars", time))


@pytest.mark.parametrize(
    ("date", "ahead"), [("1999-06-01", 64.184), ("2008-12-31", 65.184), ("2016-12-31", 68.184), ("2031-01-01", 69.184)]
)
def test_dynamical_time_is_ahead_by_the_leap_seconds_of_the_date(date, ahead):
    assert tdb_ahead(np.datetime64(date, "ns")) == pytest.approx(ahead, abs=1e-9)


@pytest.mark.usefixtures("de421")
def test_a_kernel_says_what_it_does_not_hold(tmp_path):
    with pytest.raises(ValueError, match="does not reach"):
        Sky(np.datetime64("2060-01-01", "ns"), source="de421").position("moon", "earth", 0.0)
    kernel = Kernel(kernel_file("de421"), "DE421")
    with pytest.raises(ValueError, match="NAIF's number 2000433"):
        kernel.position(2_000_433, np.zeros(1))
    first, last = kernel.reach(301)
    assert first / 365.25 == pytest.approx(-100.4, abs=0.1)
    assert last / 365.25 == pytest.approx(53.8, abs=0.1)
    foreign = tmp_path / "mine.bsp"
    foreign.write_text("no kernel")
    with pytest.raises(ValueError, match="no kernel that can be read"):
        Sky(EPOCH, source=str(foreign)).position("moon", "earth", 0.0)


@pytest.mark.usefixtures("de421")
def test_a_kernel_by_its_path_is_the_same_as_by_its_name():
    named, own = Sky(EPOCH, source="de421"), Sky(EPOCH, source=str(kernel_file("de421")))
    assert np.array_equal(named.position("saturn", "venus", 1e6), own.position("saturn", "venus", 1e6))


def test_spheres_of_influence_are_those_of_the_textbooks():
    """R. R. Bate et al., Fundamentals of Astrodynamics: 66,300 km about the Moon, 0.925 million km about the Earth."""
    moon, earth, sun = (BODIES[word].mu for word in ("moon", "earth", "sun"))
    assert sphere_of_influence(moon, earth, 384_400e3) == pytest.approx(66_300e3, rel=0.005)
    assert sphere_of_influence(earth, sun, AU) == pytest.approx(925_000e3, rel=0.005)
