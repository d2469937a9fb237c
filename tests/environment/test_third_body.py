"""A planet on a circular orbit pulls the craft, and the central body from which the craft's place is measured."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import sailviz
from sailviz.constants import AU, MU_EARTH, MU_SUN, YEAR
from sailviz.design import displaced
from sailviz.environment.third_body import Parameters, circular_rate, third_body_gravity

JUPITER, JUPITER_RADIUS = 1.26686534e17, 5.2044 * AU
PLANETS = {"Jupiter": (JUPITER, JUPITER_RADIUS), "Earth": (MU_EARTH, AU)}


def scene(position, velocity, planet, years, azimuth=0.0, outputs=200, **values):
    mu, radius = planet
    third = {"mu_m3_s2": mu, "radius_m": radius, "azimuth_rad": azimuth}
    start = {"kind": "cartesian", "position_m": list(map(float, position)), "velocity_m_s": list(map(float, velocity))}
    return sailviz.load_scene(
        {
            "title": "beside a planet",
            "start": start,
            "device": {"kind": "none"},
            "environment": {"third_body": third},
            "propagation": {"duration_yr": years, "outputs": outputs, "tolerance": 1e-13},
        }
        | values
    )


def bracket(r, planet, d):
    """The planet's pull on the craft less that on the central body, as it is defined."""
    return planet * ((d - r) / np.linalg.norm(d - r) ** 3 - d / np.linalg.norm(d) ** 3)


def independent(position, velocity, planet, azimuth, times):
    """Position (n, 3) by SciPy, with the plain form of the force."""
    mu, radius = planet
    w = np.sqrt((MU_SUN + mu) / radius**3)

    def rhs(t, y):
        r = y[:3]
        d = radius * np.array([np.cos(azimuth + w * t), np.sin(azimuth + w * t), 0.0])
        return [*y[3:], *(-MU_SUN * r / np.linalg.norm(r) ** 3 + bracket(r, mu, d))]

    y0 = [*position, *velocity]
    atol = 1e-12 * np.repeat([np.linalg.norm(position), np.linalg.norm(velocity)], 3)
    return solve_ivp(rhs, (0, times[-1]), y0, "DOP853", times, rtol=1e-12, atol=atol).y[:3].T


def turned_back(run, rate):
    """Positions (n, 3) in the frame that turns with the planet."""
    c, s = np.cos(rate * run.time), np.sin(rate * run.time)
    x, y, z = run.position.T
    return np.column_stack([c * x + s * y, c * y - s * x, z])


# ---------------------------------------------------------------- equilibria
@pytest.mark.parametrize("planet", PLANETS.values(), ids=PLANETS)
@pytest.mark.parametrize("side", [1, -1], ids=["L4", "L5"])
def test_a_craft_at_the_corner_of_lagranges_triangle_stays_there_for_a_century(planet, side):
    mu, radius = planet
    rate = circular_rate(MU_SUN, mu, radius)
    corner = np.array([np.cos(np.pi / 3), side * np.sin(np.pi / 3), 0.0])
    velocity = rate * radius * np.array([-corner[1], corner[0], 0.0])
    run = sailviz.simulate(scene(radius * corner, velocity, planet, 100))
    seen = turned_back(run, rate)
    drift = np.degrees(np.abs(np.arctan2(seen[:, 1], seen[:, 0]) - side * np.pi / 3).max())
    assert drift < 1e-6  # deg: rounding; 64 deg where the Sun is held fast
    assert np.abs(np.linalg.norm(seen, axis=1) / radius - 1).max() < 1e-8


def in_line(mu, radius):
    """Distances, m, of L1, L2 and L3 (negative: beyond the Sun) by their definition."""
    rate2 = (MU_SUN + mu) / radius**3

    def rest(x):
        return rate2 * x - MU_SUN * x / abs(x) ** 3 + mu * ((radius - x) / abs(radius - x) ** 3 - 1 / radius**2)

    hill = radius * np.cbrt(mu / (3 * MU_SUN))
    spans = [
        (radius - 2 * hill, radius - hill / 2),
        (radius + hill / 2, radius + 2 * hill),
        (-1.1 * radius, -0.9 * radius),
    ]
    return [brentq(rest, *span, xtol=1e-9, rtol=8.9e-16) for span in spans]


def test_the_in_line_points_of_the_earth_lie_where_they_are_known_to_lie():
    first, second, third = (x / AU for x in in_line(*PLANETS["Earth"]))
    assert first == pytest.approx(0.990029597298, abs=1e-12)
    assert second == pytest.approx(1.010037119956, abs=1e-12)
    assert third == pytest.approx(-1 - 5 / 12 * MU_EARTH / MU_SUN + MU_EARTH / MU_SUN, abs=1e-8)  # from the Sun


@pytest.mark.parametrize("planet", PLANETS.values(), ids=PLANETS)
@pytest.mark.parametrize("point", [0, 1, 2], ids=["L1", "L2", "L3"])
def test_nothing_pushes_a_craft_off_an_in_line_point(planet, point):
    mu, radius = planet
    rate = circular_rate(MU_SUN, mu, radius)
    x = in_line(mu, radius)[point]
    p = Parameters(mu, radius, rate, 0.7)
    time = 0.3 * 2 * np.pi / rate
    angle = 0.7 + rate * time
    r = x * np.array([np.cos(angle), np.sin(angle), 0.0])
    pull = np.array(third_body_gravity.py_func(time, *r, p))
    weight = MU_SUN * r / np.linalg.norm(r) ** 3
    assert np.linalg.norm(pull - weight + rate**2 * r) < 1e-13 * np.linalg.norm(weight)
    years = 0.25 * 2 * np.pi / rate / YEAR  # of instability a factor of 100 at most
    start = [x, 0.0, 0.0], [0.0, rate * x, 0.0]
    seen = turned_back(sailviz.simulate(scene(*start, planet, years)), rate)
    assert np.linalg.norm(seen - [x, 0.0, 0.0], axis=1).max() < 1e-10 * radius


def test_an_artificial_in_line_point_is_held_by_what_the_condition_of_rest_asks_for():
    """mu / r^2 (1 - beta) - mu' / (R - r)^2 + mu' / R^2 = w^2 r; sail in mm/s2 at 1 au."""
    found = displaced.lagrange_point(np.array([0.98, 0.985]) * AU, "ideal", planet_mu=MU_EARTH)
    assert found.characteristic_acceleration * 1e3 == pytest.approx([0.305972616, 0.186068453], abs=1e-9)
    zero = np.array(in_line(MU_EARTH, AU)[:1])
    gone = displaced.lagrange_point(zero * (1 - 1e-12), "ideal", planet_mu=MU_EARTH)
    assert gone.acceleration < 2e-11 * MU_SUN / AU**2  # it grows by nine times the way off the point


def test_a_sail_stays_on_the_sunward_line_of_a_heavy_planet():
    """Jupiter's fall of the Sun is 1 part in 1000 of what a sail holds here; left out, the craft is lost at once."""
    third = {"mu_m3_s2": JUPITER, "radius_m": JUPITER_RADIUS, "azimuth_rad": 0.4}
    run = sailviz.simulate(
        {
            "title": "sunward of Jupiter",
            "start": {"kind": "lagrange-point", "radius_m": 0.9 * JUPITER_RADIUS},
            "device": {"kind": "solar-sail", "characteristic_acceleration": "as designed"},
            "environment": {"third_body": third},
            "propagation": {"duration_yr": 3, "outputs": 50, "tolerance": 1e-13},
        }
    )
    rate = circular_rate(MU_SUN, JUPITER, JUPITER_RADIUS)
    assert np.linalg.norm(run.position, axis=1) / JUPITER_RADIUS == pytest.approx(0.9, abs=1e-10)
    angle = np.unwrap(np.arctan2(run.position[:, 1], run.position[:, 0]))
    assert angle == pytest.approx(0.4 + rate * run.time, abs=1e-10)


# ---------------------------------------------------------------- flights
def test_jupiter_moves_a_coasting_craft_as_two_independent_codes_say():
    """Craft from 1 au at +x, planet 90 deg ahead, 5 years; both codes agree to 0.4 m."""
    speed = [0.0, np.sqrt(MU_SUN / AU), 0.0]
    end = sailviz.simulate(scene([AU, 0, 0], speed, PLANETS["Jupiter"], 5, np.pi / 2)).position[-1]
    assert np.linalg.norm(end - [149595876382.5, -210867648.9, 0.0]) < 1.0  # m, of a perturbation of 122,122 km
    alone = sailviz.simulate(scene([AU, 0, 0], speed, (1.0, JUPITER_RADIUS), 5)).position[-1]
    assert np.linalg.norm(end - alone) / 1e3 == pytest.approx(122_122, abs=1)


OUT_OF_PLANE = [0.6 * AU, -0.7 * AU, 0.35 * AU], [18e3, 17e3, -9e3]


@pytest.mark.parametrize("planet", PLANETS.values(), ids=PLANETS)
def test_a_flight_out_of_the_plane_is_that_of_an_independent_integration(planet):
    run = sailviz.simulate(scene(*OUT_OF_PLANE, planet, 5, 0.8))
    truth = independent(*OUT_OF_PLANE, planet, 0.8, run.time)
    assert np.abs(run.position[:, 2]).max() > 0.3 * AU
    assert np.linalg.norm(run.position - truth, axis=1).max() < 1e-9 * AU  # SciPy at 1e-12; the force itself: 1e-3 au


def test_a_flight_measured_from_the_sun_is_that_of_three_bodies_measured_from_their_centre():
    """heyoka flies Sun, planet and a massless craft about their common centre: no term of relative motion there."""
    hy = pytest.importorskip("heyoka")
    mu, radius = PLANETS["Jupiter"]
    rate = circular_rate(MU_SUN, mu, radius)
    planet = np.array([np.cos(0.8), np.sin(0.8), 0.0]), np.array([-np.sin(0.8), np.cos(0.8), 0.0])
    places = np.array([np.zeros(3), radius * planet[0], OUT_OF_PLANE[0]])
    speeds = np.array([np.zeros(3), rate * radius * planet[1], OUT_OF_PLANE[1]])
    share = mu / (MU_SUN + mu)
    places, speeds = places - share * places[1], speeds - share * speeds[1]
    system = hy.model.nbody(3, masses=[MU_SUN, mu, 0.0], Gconst=1.0)
    integrator = hy.taylor_adaptive(system, np.hstack([places, speeds]).ravel(), tol=1e-16)
    run = sailviz.simulate(scene(*OUT_OF_PLANE, (mu, radius), 5, 0.8, outputs=50))
    grid = integrator.propagate_grid(run.time)[-1].reshape(-1, 3, 6)
    truth = grid[:, 2, :3] - grid[:, 0, :3]
    assert np.linalg.norm(run.position - truth, axis=1).max() < 100.0  # m


# ---------------------------------------------------------------- the form that loses no digits
@pytest.mark.parametrize("size", [1e-9, 1e-6, 1e-3, 0.3, 0.99, 1.7, 1e3])
def test_no_digits_are_lost_wherever_the_craft_is(size):
    from fractions import Fraction
    from math import isqrt

    def exact(value):  # square root of a fraction to 60 digits
        scale = 10**60
        return Fraction(isqrt(value.numerator * scale * scale // value.denominator), scale)

    p = Parameters(2e-3, 1.0, 0.0, 0.0)
    r = [Fraction(float(size * x)) for x in (0.6, -0.64, 0.48)]
    away = [1 - r[0], -r[1], -r[2]]
    d3 = exact(sum(x * x for x in away)) ** 3
    truth = [Fraction(2e-3) * (a / d3 - b) for a, b in zip(away, (1, 0, 0), strict=True)]
    found = third_body_gravity.py_func(0.0, *map(float, r), p)
    miss = np.array([float(Fraction(float(f)) - t) for f, t in zip(found, truth, strict=True)])
    assert np.linalg.norm(miss) < 2e-14 * np.linalg.norm([float(t) for t in truth])
