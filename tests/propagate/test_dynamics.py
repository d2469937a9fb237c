"""Orbits that the design's closed forms promise, flown: by whole scenes in SI, and in units of mu = r0 = 1."""

from __future__ import annotations

import numpy as np
import pytest

import sailviz
from sailviz.constants import AU, GRAVITY_AT_1_AU, MU_SUN
from sailviz.design import spirals
from sailviz.design.displaced import orbits as displaced
from sailviz.propagate import dop853, dynamics
from sailviz.propagate.events import APSIS, ENERGY, RECORD, STOP
from sailviz.propulsion import electric_sail, solar_sail
from sailviz.propulsion.solar_sail import FILMS
from sailviz.steering import attitude

DEG = np.pi / 180
BEST = np.arctan(2**-0.5)  # the pitch of the largest transverse force of an ideal sail


# ---------------------------------------------------------------- displaced orbits
def rate(radius):
    """Omega_K, rad/s, at a distance from the Sun in m."""
    return np.sqrt(MU_SUN / radius**3)


@pytest.mark.parametrize("device", ["electric-sail", "ideal", "jpl-1978", "jpl-2015", "eta-perfect"])
@pytest.mark.parametrize(("elevation", "ratio"), [(10, 0.7), (-10, 0.7), (30, 0.3), (80, 1.0), (0, 0.5)])
def test_designed_thrust_makes_up_for_gravity_and_circling(device, elevation, ratio):
    """Force balance in the meridian plane, with the force law of the device itself."""
    psi, r = elevation * DEG, 0.9 * AU
    found = displaced.circular(r, psi, ratio, device)
    position, velocity = displaced.state(r, psi, ratio, 0.3)
    pole, r_hat = np.array([0, 0, 1.0]), position / r
    north = pole - r_hat[2] * r_hat
    # the clock angle counts from the orbit's normal, which leans from the Sun line as much as north does
    side = north / np.linalg.norm(north) * np.cos(found.clock)
    normal = np.cos(found.pitch) * r_hat + np.sin(found.pitch) * side
    if device == "electric-sail":
        thrust = electric_sail.acceleration(position, normal, found.characteristic_acceleration)
    else:
        thrust = solar_sail.acceleration(position, normal, found.characteristic_acceleration, device)
    needed = MU_SUN * position / r**3 - (ratio * rate(r)) ** 2 * position * [1, 1, 0]
    assert np.linalg.norm(thrust - needed) < 1e-12 * GRAVITY_AT_1_AU
    assert np.linalg.norm(position) == pytest.approx(r, rel=1e-15)
    assert np.cross(position, velocity) @ pole == pytest.approx(ratio * rate(r) * (r * np.cos(psi)) ** 2, rel=1e-14)


def orbit(elevation, ratio, periods, device="electric-sail", offset=0.0):
    """Scene of a displaced orbit at 1 au; offset displaces the start radially, m."""
    design = displaced.circular(AU, elevation * DEG, ratio, device)
    position, velocity = displaced.state(AU, elevation * DEG, ratio)
    period = 2 * np.pi / (ratio * rate(AU))
    kind = {"kind": "electric-sail"} if device == "electric-sail" else {"kind": "solar-sail", "film": device}
    return sailviz.load_scene(
        {
            "title": "displaced",
            "start": {
                "kind": "cartesian",
                "position_m": list(position * (1 + offset / AU)),
                "velocity_m_s": list(velocity / (1 + offset / AU)),  # the same angular momentum
            },
            "device": kind | {"characteristic_acceleration_m_s2": float(design.characteristic_acceleration)},
            "steering": {"kind": "orbital", "pitch_rad": float(design.pitch), "clock_rad": float(design.clock)},
            "propagation": {"duration_s": periods * period, "outputs": 361, "tolerance": 1e-13},
        }
    )


@pytest.mark.parametrize(
    ("elevation", "ratio", "device"),
    [
        (10, 0.8, "electric-sail"),
        (-10, 0.8, "electric-sail"),
        (15, 0.77, "electric-sail"),
        (30, 0.5, "jpl-2015"),
        (45, 0.6, "ideal"),
    ],
)
def test_displaced_orbit_closes_on_itself(elevation, ratio, device):
    """Within 1e-8 of its radius after a period, and on its ring all the way."""
    run = sailviz.simulate(orbit(elevation, ratio, 1, device=device))
    assert np.linalg.norm(run.position[-1] - run.position[0]) < 1e-8 * AU
    assert np.abs(run.position[:, 2] - AU * np.sin(elevation * DEG)).max() < 1e-8 * AU
    assert np.abs(np.linalg.norm(run.position, axis=1) - AU).max() < 1e-8 * AU


def growth_exponents(elevation, ratio, exponent=1):
    """lambda^2 in units of Omega_K^2 with pitch and clock fixed in the orbital frame: linearising r'' = h^2 / r^3 - ...
    with |h| conserved gives (2 - k) - (3 - k) w cos^2(psi), thrust ~ r^-k, and -w for the plane's nutation."""
    w = ratio**2
    return (2 - exponent) - (3 - exponent) * w * np.cos(elevation * DEG) ** 2, -w


def test_a_type_ii_orbit_is_left_440_fold_a_period():
    """lambda = 0.969 Omega: a radial displacement at equal angular momentum grows as cosh(lambda t)."""
    growth = np.sqrt(growth_exponents(80, 1.0)[0])
    assert np.exp(growth * 2 * np.pi) == pytest.approx(440, abs=5)
    start = 1e-7 * AU
    run = sailviz.simulate(orbit(80, 1.0, 1, offset=start))
    grown = np.linalg.norm(run.position, axis=1) - AU
    # second-order terms: the displacement reaches 2e-5 of the radius
    assert grown[-1] / start == pytest.approx(np.cosh(growth * 2 * np.pi), rel=1e-3)


def test_a_stable_displaced_orbit_swings_at_the_rate_of_the_closed_form():
    """10 deg above at 0.8 of the Keplerian rate: lambda^2 = 1 - 2 w cos^2(psi) < 0, a swing of r about 1 au."""
    square, _ = growth_exponents(10, 0.8)
    assert square == pytest.approx(-0.2414, abs=5e-5)
    start = 1e-6 * AU
    run = sailviz.simulate(orbit(10, 0.8, 3, offset=start))
    swing = np.cos(np.sqrt(-square) * rate(AU) * run.time)
    assert np.abs((np.linalg.norm(run.position, axis=1) - AU) / start - swing).max() < 1e-4


# ---------------------------------------------------------------- logarithmic spirals
# Re-derived and integrated by an independent program to ten digits: film, lightness number, pitch; then final radius,
# flight time, swept angle.
TABLE = [
    ("ideal", 0.05, BEST, 1.523679, 15.0407929542, 10.6351011074),
    ("ideal", 0.1, BEST, 1.523679, 7.4050116311, 5.1556288210),
    ("ideal", 0.1, -BEST, 0.723332, 3.2352235424, 3.9651643709),
    ("jpl-1978", 0.1, BEST, 1.523679, 8.1875082457, 5.6945506046),
    ("jpl-1978", 0.05, 50 * DEG, 1.523679, 20.4197954743, 14.5313154811),
    ("jpl-2015", 0.3, -BEST, 0.723332, 1.0802192770, 1.2215088994),
]
IDS = [f"{film}, {lightness}, {pitch / DEG:.2f} deg" for film, lightness, pitch, *_ in TABLE]


@pytest.mark.parametrize(("name", "lightness", "pitch", "final", "time", "angle"), TABLE, ids=IDS)
def test_sail_flies_its_spiral(fly, name, lightness, pitch, final, time, angle):
    """ln r - theta tan(gamma) stays constant to 1e-10, and the final radius is reached on time."""
    film, design = FILMS[name], spirals.logarithmic(lightness, pitch, name)
    model = dynamics.model(
        1.0,
        device=dynamics.SOLAR_SAIL,
        device_parameters=(lightness / film.total, film.b1, film.b2, film.b3),
        steering=attitude.ORBITAL,
        steering_parameters=attitude.direction_parameters(pitch, np.pi / 2),
    )
    flight = fly(model, *design.state(1.0, 0.0, 1.0), np.linspace(0, time, 801))
    theta = np.unwrap(np.arctan2(flight.states[1], flight.states[0]))
    radius = np.linalg.norm(flight.position, axis=1)
    assert np.ptp(np.log(radius) - theta * design.slope) < 1e-10
    assert (radius[-1], theta[-1]) == pytest.approx((final, angle), rel=1e-9)


def test_a_spiral_scene_starts_with_the_velocity_of_its_spiral():
    scene = sailviz.load_scene(
        {
            "title": "spiral",
            "start": {"kind": "spiral", "radius_au": 0.8, "azimuth_deg": 40},
            "device": {"kind": "solar-sail", "film": "jpl-2015", "lightness_number": 0.08},
            "steering": {"kind": "orbital", "pitch_deg": 40, "clock_deg": 90},
            "propagation": {"duration_d": 200, "outputs": 201, "tolerance": 1e-13},
        }
    )
    design = spirals.logarithmic(0.08, 40 * DEG, "jpl-2015")
    run = sailviz.simulate(scene)
    theta = np.unwrap(np.arctan2(run.position[:, 1], run.position[:, 0]))
    assert theta[0] == pytest.approx(40 * DEG, abs=1e-15)
    assert np.ptp(np.log(np.linalg.norm(run.position, axis=1)) - theta * design.slope) < 1e-10
    assert run.elements.eccentricity == pytest.approx(np.full(201, design.eccentricity), abs=1e-11)
    assert run.thrust.magnitude[0] == pytest.approx(
        0.08 * GRAVITY_AT_1_AU / 0.64 * np.hypot(*FILMS["jpl-2015"].components(40 * DEG)), rel=1e-12
    )


# ---------------------------------------------------------------- thrust along the Sun line
@pytest.mark.parametrize("lightness", [0.1, 0.5, 0.9])
def test_sun_facing_sail_moves_as_under_reduced_gravity(fly, lightness):
    """Kepler's ellipse or hyperbola of mu (1 - beta); for beta = 0.5 the circular start becomes a parabola."""
    model = dynamics.model(1.0, device=dynamics.SOLAR_SAIL, device_parameters=(lightness, 0, 1, 0))
    times = np.linspace(0, 30, 301)
    sail = fly(model, (1, 0, 0), (0, 0.9, 0.3), times)
    stone = fly(dynamics.model(1 - lightness), (1, 0, 0), (0, 0.9, 0.3), times)
    size = np.linalg.norm(stone.position, axis=1)
    assert (np.linalg.norm(sail.position - stone.position, axis=1) / size).max() < 1e-11
    h = np.cross(stone.position, stone.velocity)
    e = np.cross(sail.velocity, h) / (1 - lightness) - sail.position / size[:, None]
    assert np.abs(e - e[0]).max() < 1e-10  # the apse line of the weaker Sun stays


def radial(fly, a, events, duration=200.0):
    model = dynamics.model(1.0, device=dynamics.THRUSTER, device_parameters=(a, 0, 0), steering=attitude.RADIAL)
    return fly(model, times=[duration], events=events)


def test_radial_thrust_just_above_an_eighth_escapes(fly):
    """(2.14)-(2.15): a >= mu / (8 r0^2); energy turns positive at 1 + 1/(2a), just under 5."""
    flight = radial(fly, 0.125 * (1 + 1e-6), [(ENERGY, 0, 1, STOP), (APSIS, 0, -1, STOP)])
    assert flight.status == dop853.STOPPED
    assert flight.events[-1][0] == 0
    assert np.linalg.norm(flight.events[-1][2][:3]) == pytest.approx(1 + 1 / (2 * 0.125 * (1 + 1e-6)), abs=1e-9)


def test_radial_thrust_just_below_an_eighth_turns_back(fly):
    """At r = (1 - sqrt(1 - 8a)) / (4a), which tends to 2."""
    a = 0.125 * (1 - 1e-6)
    flight = radial(fly, a, [(ENERGY, 0, 1, STOP), (APSIS, 0, -1, STOP)])
    assert flight.events[-1][0] == 1
    # the turning radius goes with the square root of 1 - 8a: rounding of 1e-13 counts a thousandfold
    assert np.linalg.norm(flight.events[-1][2][:3]) == pytest.approx((1 - np.sqrt(1 - 8 * a)) / (4 * a), abs=1e-9)


# re-derived: turning radius and time between two passages of r = 1 (the radial period)
@pytest.mark.parametrize(
    ("a", "turn", "period"),
    [
        (0.05, 1.127016654, 7.562544652),
        (0.1, 1.381966011, 10.787154025),
        (0.12, 1.666666667, 16.380085546),
        (-0.05, 0.916079783, 5.523914691),
        (-0.5, 0.618033989, 3.251461343),
    ],
)
def test_weak_radial_thrust_makes_the_radius_swing(fly, a, turn, period):
    flight = radial(fly, a, [(APSIS, 0, 0, RECORD)], duration=2.2 * period)
    far, near, *_ = flight.events
    assert np.linalg.norm(far[2][:3]) == pytest.approx(turn, abs=1e-9)
    assert np.linalg.norm(far[2][:3]) == pytest.approx((1 - np.sqrt(1 - 8 * a)) / (4 * a), abs=1e-11)
    assert (far[1], near[1]) == pytest.approx((period / 2, period), abs=2e-9)
    assert np.linalg.norm(near[2][:3]) == pytest.approx(1, abs=1e-10)
