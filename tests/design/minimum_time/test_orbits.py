"""Fastest flights in space: orbit to orbit with free anomalies, and rendezvous with a planet on a date."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from sailviz import ephemeris
from sailviz.constants import AU, DAY, MU_SUN
from sailviz.design.minimum_time import circle_to_circle, costates, orbit_to_orbit, rendezvous
from sailviz.design.minimum_time.effort import FOUND, IMPOSSIBLE, NOT_FOUND, TIME_LIMIT, Effort
from sailviz.design.minimum_time.moving_bodies import planet_state
from sailviz.design.minimum_time.state_costate import SPEED_UNIT, TIME_UNIT, canonical_sail
from sailviz.elements import Elements, elements
from sailviz.propulsion.solar_sail import Film


def orbit(a, e, i, node, perihelion):
    """Elements from au and degrees, with the longitude of the perihelion."""
    i, node, perihelion = np.radians([i, node, perihelion])
    return Elements(a * AU, e, i, node, perihelion - node, 0.0)


EARTH = orbit(1.00000011, 0.01671022, 0.00005, -11.26064, 102.94719)  # mean elements of J2000
VENUS = orbit(0.72333199, 0.00677323, 3.39471, 76.68069, 131.53298)
MARS = orbit(1.52366231, 0.09341233, 1.85061, 49.57854, 336.04084)


def flown(found):
    """State and costates at the end, and the largest change of H, by the costates alone."""
    y = np.concatenate([found.position / AU, found.velocity / SPEED_UNIT, found.costates])
    sail = canonical_sail(found.device, found.characteristic_acceleration)
    return costates.propagate(y, found.time / TIME_UNIT, sail)


def angle_between(a, b):
    return abs(np.remainder(a - b + np.pi, 2 * np.pi) - np.pi)


# best found by an independent search: flight time in days, departure anomaly in degrees
@pytest.mark.parametrize(
    ("device", "strength", "target", "days", "anomaly"),
    [
        ("ideal", 1.0, MARS, 355.5301, 130.38),
        ("ideal", 0.5, VENUS, 279.3358, 253.84),  # three others within 6 d
        ("jpl-2015", 1.0, VENUS, 214.1701, 186.36),
        ("electric-sail", 1.0, VENUS, 295.5883, 278.92),
    ],
)
def test_flight_between_planets_orbits_is_the_tabled_best(device, strength, target, days, anomaly):
    shares = []
    found = orbit_to_orbit(
        EARTH, target, device, strength * 1e-3, starts=12, progress=lambda share, words: shares.append(share)
    )
    assert found.feasible
    assert found.time / DAY == pytest.approx(days, rel=1e-6)
    assert np.degrees(found.departure_anomaly) == pytest.approx(anomaly, abs=0.02)
    assert found.residual < 1e-9
    assert found.hamiltonian_drift < 1e-10
    assert "best found" in found.claim
    assert shares[-1] == 1
    assert shares == sorted(shares)

    flight = flown(found)
    assert flight.hamiltonian == pytest.approx(1, abs=1e-11)
    there = elements(flight.end[:3] * AU, flight.end[3:6] * SPEED_UNIT, MU_SUN)
    assert there.semi_major_axis / AU == pytest.approx(target.semi_major_axis / AU, abs=1e-9)
    assert [there.eccentricity, there.inclination] == pytest.approx([target.eccentricity, target.inclination], abs=1e-9)
    assert angle_between(there.raan, target.raan) < 1e-8
    assert angle_between(there.argument, target.argument) < 1e-6  # Venus' orbit is nearly round
    assert angle_between(there.true_anomaly, found.arrival_anomaly) < 1e-6
    for y in (np.concatenate([found.position / AU, found.velocity / SPEED_UNIT, found.costates]), flight.end):
        r, v, lam_r, lam_v = y.reshape(4, 3)
        along = lam_r @ v - lam_v @ r / np.linalg.norm(r) ** 3
        assert abs(along) < 1e-9 * np.linalg.norm(y[6:])  # no gain from another departure or arrival point


def test_flight_between_coplanar_circles_is_the_planar_one():
    circle = orbit(1.0, 0.0, 0.0, 0.0, 0.0)
    target = orbit(0.72333199, 0.0, 0.0, 0.0, 0.0)
    tilt = {"inclination": 1.1, "raan": 0.4}
    flat = circle_to_circle(AU, 0.72333199 * AU, "ideal", 1e-3)
    for a, b in ((circle, target), (replace(circle, **tilt), replace(target, **tilt))):
        found = orbit_to_orbit(a, b, "ideal", 1e-3, starts=3)
        assert found.time == pytest.approx(flat.time, rel=1e-9)
        assert found.revolutions == pytest.approx(flat.revolutions, abs=1e-4)


def test_ideal_sail_takes_r_to_the_one_and_a_half_longer_on_a_larger_scale():
    near = orbit_to_orbit(EARTH, VENUS, "ideal", 1e-3, starts=12)
    larger = (replace(x, semi_major_axis=2 * x.semi_major_axis) for x in (EARTH, VENUS))
    far = orbit_to_orbit(*larger, "ideal", 1e-3, starts=12)
    assert far.time / near.time == pytest.approx(2**1.5, rel=1e-9)
    assert far.costates[3:] == pytest.approx(near.costates[3:] * 4, rel=1e-6, abs=1e-6)


def test_costates_are_what_an_earlier_start_would_save():
    found = rendezvous("Venus", "2030-06-01", "ideal", 1e-3)
    assert found.feasible
    assert found.residual < 1e-9
    end = flown(found).end
    r, v = planet_state("Venus", found.departure, found.time)
    assert end[:3] * AU == pytest.approx(r[0], abs=1e-9 * AU)
    assert end[3:6] * SPEED_UNIT == pytest.approx(v[0], abs=1e-9 * SPEED_UNIT)
    at_start = planet_state("Earth", found.departure, 0.0)
    assert found.position == pytest.approx(at_start[0][0], rel=1e-12)
    assert found.velocity == pytest.approx(at_start[1][0], rel=1e-9)

    # six hours earlier and later: the Earth is elsewhere, and so is Venus, which the costates know through the arrival
    sides = [rendezvous("Venus", f"2030-{day}", "ideal", 1e-3) for day in ("05-31T18:00", "06-01T06:00")]
    moved = np.concatenate([sides[1].position - sides[0].position, sides[1].velocity - sides[0].velocity])
    moved /= np.repeat([AU, SPEED_UNIT], 3)
    hours = 12 * 3600 / TIME_UNIT
    around = [np.concatenate(planet_state("Venus", found.arrival, t), axis=1)[0] for t in (-21600.0, 21600.0)]
    motion = (around[1] - around[0]) / np.repeat([AU, SPEED_UNIT], 3) / hours
    expected = -(found.costates @ moved) + end[6:] @ motion * hours
    # six hours squared against the year, times the curvature of the launch window
    assert (sides[1].time - sides[0].time) / TIME_UNIT == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("planet", ephemeris.PLANETS)
def test_velocity_of_a_planet_is_how_fast_its_place_changes(planet):
    time, epoch, h = np.array([0.0, 1e7, 3e8, -7e8]), np.datetime64("2030-01-01"), 6000.0
    r, v = planet_state(planet, epoch, time)
    assert r == pytest.approx(ephemeris.planet_position(planet, epoch, time), abs=1e-12 * np.abs(r).max())
    near, far = (
        (ephemeris.planet_position(planet, epoch, time + d) - ephemeris.planet_position(planet, epoch, time - d)) / d
        for d in (h, 2 * h)
    )
    # times rounded to 1e-7 s over a difference's step: 3e-11
    assert v == pytest.approx((4 * near - far) / 6, abs=3e-10 * np.abs(v).max())


def test_velocity_of_a_planet_is_that_of_its_mean_orbit():
    time = np.array([0.0, 1e7])
    epoch = np.datetime64("2030-01-01")
    r, v = planet_state("Mars", epoch, time)
    assert r == pytest.approx(ephemeris.planet_position("Mars", epoch, time))
    a = elements(r, v, MU_SUN).semi_major_axis / AU
    assert a == pytest.approx([1.52371, 1.52371], abs=2e-4)  # Standish's mean motion is not quite Kepler's


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: orbit_to_orbit(EARTH, replace(MARS, eccentricity=1.2), "ideal", 1e-3), "ellipses"),
        (lambda: orbit_to_orbit(EARTH, MARS, "ideal", 0.0), "positive"),
        (lambda: orbit_to_orbit(EARTH, MARS, "paper", 1e-3), "no sail"),
        (lambda: rendezvous("Pluto", "2030-01-01"), "Pluto"),
        (lambda: rendezvous("Earth", "2030-01-01"), "itself"),
        (lambda: rendezvous("Mars", ("2031-01-01", "2030-01-01")), "before it begins"),
    ],
)
def test_impossible_requests_say_why(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def test_flight_that_is_not_found_says_so():
    inside = orbit(0.003, 0.0, 0.0, 0.0, 0.0)  # within the Sun
    found = orbit_to_orbit(EARTH, inside, "ideal", 1e-3)
    assert not found.feasible
    assert "inside the Sun" in found.reason
    assert np.isnan(found.time)


def test_a_film_that_reflects_nothing_keeps_its_angular_momentum_and_so_its_orbit():
    found = orbit_to_orbit(EARTH, MARS, Film(0.5, 0.0, 0.0), 1e-3)
    assert found.ending.outcome == IMPOSSIBLE
    assert "along the Sun line only" in found.reason


def test_a_search_out_of_time_has_a_minimum_with_a_mark_or_tells_of_a_true_flight(monkeypatch):
    """From six departure points an ideal sail's flights to Venus are known first, their minimum a moment later."""
    whole = orbit_to_orbit(EARTH, VENUS, "ideal", 1e-3, starts=6)
    early, late = Effort(), Effort()
    monkeypatch.setattr(early, "count", lambda what, n=1: early.end(TIME_LIMIT) if "departure" in what else None)
    found = orbit_to_orbit(EARTH, VENUS, "ideal", 1e-3, starts=6, effort=early)
    assert (found.ending.outcome, found.ending.stopped) == (NOT_FOUND, TIME_LIMIT)
    (days,) = re.search(r"from a true anomaly of .* deg, not the best, it takes (.*) d", found.reason).groups()
    assert whole.time / DAY < float(days) < 1.1 * whole.time / DAY
    monkeypatch.setattr("sailviz.design.minimum_time.orbits.distinct", lambda minima: late.end(TIME_LIMIT) or minima)
    found = orbit_to_orbit(EARTH, VENUS, "ideal", 1e-3, starts=6, effort=late)
    assert (found.ending.outcome, found.ending.stopped) == (FOUND, TIME_LIMIT)
    assert found.time == whole.time
    assert "stopped by its time limit" in found.claim
