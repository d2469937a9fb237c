"""Every vector law of the right-hand side at places and speeds of which no component is zero.

The formulae stand here a second time, as vectors, from the definitions alone. Both sides are a handful of operations
in doubles: 1e-12 of the vector is a hundred times what rounding does to them.
"""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.environment import eclipse, sun
from sailviz.environment.third_body import Parameters as Planet
from sailviz.propagate import dynamics
from sailviz.propagate.low_orbit_callback import FORCE_X, LIGHT, TETHER_X, low_orbit_forces, observe_low_orbit
from sailviz.propulsion import plasma_brake
from sailviz.steering import attitude

SAME = 1e-12
POLE = np.array([0.0, 0.0, 1.0])
PITCH, CLOCK = 0.6, 2.2
MU, RADIUS = 398600.4418e9, 6378137.0  # of the Earth, m3/s2 and m
AU = 149_597_870_700.0
R, V, MASS = np.array([4.1e6, -3.9e6, 4.6e6]), np.array([3.1e3, 6.2e3, 2.3e3]), 7.0
FAR, FAST = np.array([0.7, -0.5, 0.4]), np.array([0.3, 0.9, -0.6])  # au and canonical speeds


def unit(v):
    return v / np.sqrt(v @ v)


def derivative(model, position, velocity, time=0.0, mass=MASS):
    """Acceleration (3,) and mass flow of the right-hand side."""
    out = np.empty(7)
    dynamics.derivative(time, np.array([*position, *velocity, mass]), 1.0, model.parameters[0], out)
    assert np.array_equal(out[:3], velocity)
    return out[3:6], out[6]


def gravity(position, mu):
    return -mu * position / np.linalg.norm(position) ** 3


def check(found, expected):
    assert np.abs(expected).min() > 0.02 * np.abs(expected).max()  # no component may hide
    np.testing.assert_allclose(found, expected, rtol=0, atol=SAME * np.linalg.norm(expected))


# ---------------------------------------------------------------- gravity
def test_a_third_body_pulls_towards_where_it_is_and_takes_the_central_body_along():
    planet = Planet(mu=2e-3, radius=1.3, rate=0.4, azimuth=0.9)
    time = 2.5
    angle = 0.9 + 0.4 * time
    towards = 1.3 * np.array([np.cos(angle), np.sin(angle), 0.0]) - FAR
    own = 2e-3 / 1.3**2 * np.array([np.cos(angle), np.sin(angle), 0.0])  # the fall of the central body
    expected = 2e-3 * towards / np.linalg.norm(towards) ** 3 - own
    found, _ = derivative(dynamics.model(1.0, third_body=planet), FAR, FAST, time)
    # of a pull of 1e-3 beside gravity's 1, from which it is taken: rounding of the sum
    np.testing.assert_allclose(found - gravity(FAR, 1.0), expected, rtol=0, atol=1e-15 * 10)
    assert np.abs(expected).min() > 1e-5


def test_zonal_harmonics_pull_down_the_slope_of_their_potential():
    """Spherical form: a = -mu/r2 [ (1 - sum (n+1) J_n (R/r)^n P_n) r_hat + sum J_n (R/r)^n P_n' cos(lat) north ]."""
    j = {2: 1.08e-3, 3: -2.5e-6, 4: -1.6e-6}
    strengths = (1.5 * j[2] * MU * RADIUS**2, 0.5 * j[3] * MU * RADIUS**3, 0.125 * j[4] * MU * RADIUS**4)
    model = dynamics.model(MU, j2_strength=strengths[0], zonal=strengths[1:])
    r = np.linalg.norm(R)
    up, u = R / r, R[2] / r
    north = unit(POLE - u * up)
    polynomials = {
        2: ((3 * u**2 - 1) / 2, 3 * u),
        3: ((5 * u**3 - 3 * u) / 2, (15 * u**2 - 3) / 2),
        4: ((35 * u**4 - 30 * u**2 + 3) / 8, (35 * u**3 - 15 * u) / 2),
    }
    radial = 1 - sum((n + 1) * j[n] * (RADIUS / r) ** n * p for n, (p, _) in polynomials.items())
    across = sum(j[n] * (RADIUS / r) ** n * slope for n, (_, slope) in polynomials.items()) * np.sqrt(1 - u * u)
    found, _ = derivative(model, R, V)
    check(found, -MU / r**2 * (radial * up + across * north))
    # and each alone: J3 and J4 are 1e-6 of the whole, above SAME but not by their own share
    for n, kept in ((3, (strengths[1], 0.0)), (4, (0.0, strengths[2]))):
        one, _ = derivative(dynamics.model(MU, j2_strength=strengths[0], zonal=kept), R, V)
        two, _ = derivative(dynamics.model(MU, j2_strength=strengths[0]), R, V)
        p, slope = polynomials[n]
        share = j[n] * (RADIUS / r) ** n
        expected = -MU / r**2 * share * (-(n + 1) * p * up + slope * np.sqrt(1 - u * u) * north)
        np.testing.assert_allclose(one - two, expected, rtol=0, atol=1e-14)  # rounding of 8 m/s2; J4 makes 1e-5


# ---------------------------------------------------------------- air, plasma, shadow
def test_air_that_turns_with_the_earth_drags_against_the_wind_that_the_craft_feels():
    spin, area, density, height = 7.292e-5, 11.0, 3e-13, 60e3
    r0 = RADIUS + 700e3
    model = dynamics.model(MU, rotation=spin, air=(1, area, r0, density, height))
    felt = V - np.cross(spin * POLE, R)
    rho = density * np.exp((r0 - np.linalg.norm(R)) / height)
    expected = -0.5 * rho * area / MASS * np.linalg.norm(felt) * felt
    still = -0.5 * rho * area / MASS * np.linalg.norm(V) * V
    found, _ = derivative(model, R, V)
    drag = found - gravity(R, MU)
    assert np.linalg.norm(expected - still) > 0.05 * np.linalg.norm(expected)
    # 1e-15 of gravity's 8 m/s2 beside a drag of 1e-5 m/s2
    np.testing.assert_allclose(drag, expected, rtol=0, atol=1e-14)


BRAKE = {"length": 5e3, "voltage": 1e3, "wire_radius": 1e-3, "tip_mass": 0.4}
FORCE = 5e-8  # N/m at the craft
SPIN = 7.292e-5


def brake(**more):
    """A model with a brake in a plasma of constant drag per length (the scale height is huge)."""
    numbers = plasma_brake.Parameters(**(BRAKE | more))
    plasma = (0, 700e3, FORCE, 1e30, 0.0, RADIUS)
    keywords = {"device": dynamics.PLASMA_BRAKE, "device_parameters": numbers, "plasma": plasma}
    return dynamics.model(MU, rotation=SPIN, surface_radius=RADIUS, forces=(low_orbit_forces(),), **keywords)


def brake_force(axis):
    """Force of FORCE a metre on a tether along a unit vector, N: against the plasma's flow across it."""
    flow = V - np.cross(SPIN * POLE, R)
    across = flow - (flow @ axis) * axis
    return -FORCE * BRAKE["length"] * unit(across)


def seen(model):
    states = np.array([*R, *V, MASS])[:, None]
    return observe_low_orbit(np.zeros(1), states, np.ones(1), model.parameters)[:, 0]


@pytest.mark.parametrize("lying", [plasma_brake.VERTICAL, plasma_brake.TILTED, plasma_brake.SPINNING])
def test_a_brake_is_dragged_against_the_plasma_that_flows_across_it(lying):
    model = brake(attitude=lying, spin_factor=0.7)
    up = unit(R)
    flow = V - np.cross(SPIN * POLE, R)
    axis, expected = up, brake_force(up)
    if lying == plasma_brake.TILTED:  # until the drag's moment is that of the gravity gradient
        across = unit(flow - (flow @ up) * up)
        lean = np.arctan(FORCE * np.linalg.norm(R) ** 3 / (6 * 3.986004418e14 * BRAKE["tip_mass"]))
        axis = np.cos(lean) * up + np.sin(lean) * across  # its tip, below, trails
        expected = brake_force(axis)
    if lying == plasma_brake.SPINNING:
        expected = -0.7 * FORCE * BRAKE["length"] * unit(flow)
    row = seen(model)
    check(row[FORCE_X : FORCE_X + 3], expected)
    np.testing.assert_allclose(row[TETHER_X : TETHER_X + 3], axis, rtol=0, atol=SAME)
    found, _ = derivative(model, R, V)
    # 1e-15 of gravity's 8 m/s2 beside a drag of 4e-5 m/s2
    np.testing.assert_allclose(found - gravity(R, MU), expected / MASS, rtol=0, atol=1e-14)


def test_the_sun_stands_on_the_ecliptic_and_the_shadow_lies_behind_the_earth():
    """An even Sun 2 rad after the equinox; the craft a little to either side of the shadow's edge."""
    longitude, tilt = 2.0, np.radians(23.439)
    to_sun = np.array([np.cos(longitude), np.cos(tilt) * np.sin(longitude), np.sin(tilt) * np.sin(longitude)])
    numbers = sun.sun_parameters(None, longitude)
    found = sun.direction.py_func(0.0, numbers)
    check(np.array(found), to_sun)
    model = dynamics.model(MU, surface_radius=RADIUS, sun=numbers, shadow=eclipse.CYLINDER)
    side = unit(np.cross(to_sun, [0.3, -0.5, 0.8]))
    for turn in range(4):
        off = np.cos(turn) * side + np.sin(turn) * np.cross(to_sun, side)
        for share, light in ((0.999, 0.0), (1.001, 1.0)):
            for behind, expected in ((4e6, light), (-4e6, 1.0)):
                place = -behind * to_sun + share * RADIUS * off
                states = np.array([*place, *V, MASS])[:, None]
                row = observe_low_orbit(np.zeros(1), states, np.ones(1), model.parameters)[:, 0]
                assert row[LIGHT] == expected


# ---------------------------------------------------------------- steering frames
def orbital_axes(position, velocity):
    up, normal = unit(position), unit(np.cross(position, velocity))
    return up, np.cross(normal, up), normal


def meridian_axes(position):
    east = unit(np.cross(POLE, position))
    return unit(position), east, np.cross(unit(position), east)


def turned(axes, pitch=PITCH, clock=CLOCK):
    """Clock counts from the third axis towards the second."""
    up, second, third = axes
    return np.cos(pitch) * up + np.sin(pitch) * (np.sin(clock) * second + np.cos(clock) * third)


TABLE = attitude.table([0.0, 2.0], [0.4, 0.8], [2.0, 2.4])  # PITCH and CLOCK at 1 s
ANGLES = attitude.direction_parameters(PITCH, CLOCK)
FIXED = unit(np.array([0.5, -0.7, 0.4]))
UP, ALONG, NORMAL = orbital_axes(FAR, FAST)
LAWS = {
    "radial": (attitude.RADIAL, {}, UP),
    "orbital": (attitude.ORBITAL, {"steering_parameters": ANGLES}, turned((UP, ALONG, NORMAL))),
    "meridian": (attitude.MERIDIAN, {"steering_parameters": ANGLES}, turned(meridian_axes(FAR))),
    "circumferential": (attitude.TRANSVERSE, {}, ALONG),
    "tangential": (attitude.TANGENTIAL, {}, unit(FAST)),
    "inertial": (attitude.INERTIAL, {"steering_parameters": FIXED}, FIXED),
    "table, orbital": (attitude.TABLE_ORBITAL, {"table": TABLE}, turned((UP, ALONG, NORMAL))),
    "table, meridian": (attitude.TABLE_MERIDIAN, {"table": TABLE}, turned(meridian_axes(FAR))),
}


@pytest.mark.parametrize("law", LAWS)
def test_a_law_points_a_thruster_where_its_definition_says(law):
    kind, numbers, expected = LAWS[law]
    size, exhaust = 0.3, 0.7  # N, and 1 / (g0 Isp) in s/m
    model = dynamics.model(
        1.0, device=dynamics.THRUSTER, device_parameters=(size, 1.0, exhaust), steering=kind, **numbers
    )
    states = np.array([*FAR, *FAST, MASS])[:, None]
    normal, acceleration, _ = dynamics.observe(np.ones(1), states, np.ones(1), model)
    check(normal[0], expected)
    check(acceleration[0], size / MASS * expected)
    found, flow = derivative(model, FAR, FAST, 1.0)
    np.testing.assert_allclose(found, gravity(FAR, 1.0) + size / MASS * expected, rtol=0, atol=SAME)
    assert flow == pytest.approx(-size * exhaust, rel=1e-14)


# ---------------------------------------------------------------- sails
def test_a_solar_sail_is_pushed_along_the_light_and_along_its_normal():
    """(3.17): (k / r2) cos(alpha) [b1 r_hat + (b2 cos(alpha) + b3) n_hat]."""
    k, b1, b2, b3 = 0.05, 0.08, 0.83, -0.005
    n = LAWS["orbital"][2]
    c, r = n @ UP, np.linalg.norm(FAR)
    expected = k / r**2 * c * (b1 * UP + (b2 * c + b3) * n)
    model = dynamics.model(
        1.0,
        device=dynamics.SOLAR_SAIL,
        device_parameters=(k, b1, b2, b3),
        steering=attitude.ORBITAL,
        steering_parameters=ANGLES,
    )
    found, _ = derivative(model, FAR, FAST)
    np.testing.assert_allclose(found, gravity(FAR, 1.0) + expected, rtol=0, atol=SAME)
    assert np.abs(expected).min() > 1e-4


def test_an_electric_sail_is_pushed_between_the_wind_and_its_normal():
    """(3.39): (a_c / 2) (r_E / r) [r_hat + cos(alpha) n_hat]."""
    ac, place = 1e-3, FAR * AU
    n = LAWS["orbital"][2]
    expected = ac / 2 * AU / np.linalg.norm(place) * (UP + (n @ UP) * n)
    model = dynamics.model(
        1.0,
        device=dynamics.ELECTRIC_SAIL,
        device_parameters=(ac, 0, 1.2),
        steering=attitude.ORBITAL,
        steering_parameters=ANGLES,
    )
    found, _ = derivative(model, place, FAST * 1e4)
    np.testing.assert_allclose(found, expected, rtol=0, atol=SAME * ac)  # gravity of mu = 1 m3/s2 is nothing here
