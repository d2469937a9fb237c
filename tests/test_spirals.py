"""Logarithmic spirals against their closed forms, flown; and thrust along the Sun line. Units: mu = r0 = 1."""

from __future__ import annotations

import numpy as np
import pytest

import sailviz
from sailviz import steering as law
from sailviz.constants import AU, GRAVITY_AT_1_AU, MU_SUN
from sailviz.design import spirals
from sailviz.propagate import dop853, dynamics
from sailviz.propagate.events import APSIS, ENERGY, RECORD, STOP
from sailviz.propulsion.solar_sail import FILMS

DEG = np.pi / 180
BEST = np.arctan(2**-0.5)  # the pitch of the largest transverse force of an ideal sail

# Re-derived and integrated by an independent program to ten digits: film, lightness number, pitch, tan(gamma),
# v_theta^2 r / mu, v0, e, true anomaly deg; then final radius, flight time, swept angle.
TABLE = [
    (("ideal", 0.05, BEST, 0.0395979127, 0.9720213851, 0.9866840981, 0.04758449718, 126.0136182),
     (1.523679, 15.0407929542, 10.6351011074)),
    (("ideal", 0.1, BEST, 0.08168311176, 0.9424229102, 0.9740179049, 0.09613036565, 126.7945905),
     (1.523679, 7.4050116311, 5.1556288210)),
    (("ideal", 0.1, -BEST, -0.08168311176, 0.9424229102, 0.9740179049, 0.09613036565, -126.7945905),
     (0.723332, 3.2352235424, 3.9651643709)),
    (("jpl-1978", 0.1, BEST, 0.07395277247, 0.9404797569, 0.9724316184, 0.09154241, 130.5561622),
     (1.523679, 8.1875082457, 5.6945506046)),
    (("jpl-1978", 0.05, 50 * DEG, 0.02898070761, 0.9845575958, 0.9926653552, 0.03244395122, 118.4226395),
     (1.523679, 20.4197954743, 14.5313154811)),
    (("jpl-2015", 0.3, -BEST, -0.2651531762, 0.802234727, 0.926626574, 0.290445883, -132.9141931),
     (0.723332, 1.0802192770, 1.2215088994)),
]  # fmt: skip
IDS = [f"{film}, {lightness}, {pitch / DEG:.2f} deg" for (film, lightness, pitch, *_), _ in TABLE]


@pytest.mark.parametrize("row", TABLE, ids=IDS)
def test_spiral_has_the_slope_speed_and_osculating_orbit_of_the_table(row):
    (film, lightness, pitch, slope, factor, speed, e, anomaly), (final, time, angle) = row
    found = spirals.logarithmic(lightness, pitch, film)
    assert found.feasible
    assert (found.slope, found.speed_factor, found.eccentricity) == pytest.approx((slope, factor, e), abs=5e-9)
    assert np.tan(found.flight_path_angle) == pytest.approx(slope, abs=5e-9)
    assert found.true_anomaly / DEG == pytest.approx(anomaly, abs=1e-6)
    assert np.linalg.norm(found.state(1.0, 0.0, 1.0)[1]) == pytest.approx(speed, abs=1e-9)
    assert found.time(1.0, final, 1.0) == pytest.approx(time, rel=1e-9)
    assert found.angle(1.0, final) == pytest.approx(angle, rel=1e-9)


@pytest.mark.parametrize("row", TABLE, ids=IDS)
def test_sail_flies_its_spiral(fly, row):
    """ln r - theta tan(gamma) stays constant to 1e-10, and the final radius is reached on time."""
    (name, lightness, pitch, *_), (final, time, angle) = row
    film, design = FILMS[name], spirals.logarithmic(lightness, pitch, name)
    model = dynamics.model(
        1.0,
        device=dynamics.SOLAR_SAIL,
        device_parameters=(lightness / film.total, film.b1, film.b2, film.b3),
        steering=law.ORBITAL,
        steering_parameters=law.direction_parameters(pitch, np.pi / 2),
    )
    flight = fly(model, *design.state(1.0, 0.0, 1.0), np.linspace(0, time, 801))
    theta = np.unwrap(np.arctan2(flight.states[1], flight.states[0]))
    radius = np.linalg.norm(flight.position, axis=1)
    assert np.ptp(np.log(radius) - theta * design.slope) < 1e-10
    assert (radius[-1], theta[-1]) == pytest.approx((final, angle), rel=1e-9)


@pytest.mark.parametrize("row", TABLE, ids=IDS)
def test_slope_solves_mcinnes_equation(row):
    """sin(gamma) cos(gamma) / (2 - sin^2(gamma)) = eps_t / (1 - eps_r)."""
    name, lightness, pitch, *_ = row[0]
    radial, transverse = (lightness * k for k in FILMS[name].components(pitch))
    gamma = spirals.logarithmic(lightness, pitch, name).flight_path_angle
    assert np.sin(gamma) * np.cos(gamma) / (2 - np.sin(gamma) ** 2) == pytest.approx(
        transverse / (1 - radial), rel=1e-13
    )


@pytest.mark.parametrize(
    ("film", "largest"),
    [
        ("ideal", (0.593829, 0.612372, 0.861465)),
        ("jpl-1978", (0.620148, 0.643879, 0.902837)),
        ("jpl-2015", (0.615217, 0.637770, 0.894281)),
    ],
)
def test_too_light_a_sail_has_no_spiral(film, largest):
    """Feasible up to |eps_t| / (1 - eps_r) = 1 / (2 sqrt 2), a flight-path angle of 54.7 deg."""
    for pitch, limit in zip((20 * DEG, BEST, 50 * DEG), largest, strict=True):
        assert spirals.logarithmic(limit * (1 - 2e-6), pitch, film).feasible
        beyond = spirals.logarithmic(limit * (1 + 2e-6), pitch, film)
        assert not beyond.feasible
        assert np.isnan(beyond.slope)
        assert f"{limit:.4f}"[:5] in beyond.reason
    assert spirals.logarithmic(largest[0] * (1 - 1e-6), 20 * DEG, film).slope == pytest.approx(np.sqrt(2), abs=5e-3)


def test_without_transverse_thrust_there_is_no_spiral():
    assert "conic" in spirals.logarithmic(0.1, 0.0).reason


def test_an_imperfect_sail_spirals_as_an_ideal_one_of_less_lightness():
    imperfect, ideal = spirals.logarithmic(0.1, BEST, "eta-perfect"), spirals.logarithmic(0.085, BEST)
    assert (imperfect.slope, imperfect.speed_factor) == pytest.approx((ideal.slope, ideal.speed_factor), rel=1e-14)


def test_arrays_broadcast():
    found = spirals.logarithmic(np.array([0.05, 0.1, 0.7]), BEST)
    assert found.slope[:2] == pytest.approx([0.0395979127, 0.08168311176], abs=1e-9)
    assert list(found.feasible) == [True, True, False]


def test_spiral_times_are_in_seconds_when_mu_is_in_si():
    """One unit of time is sqrt(au^3 / mu) = 58.13244 d."""
    days = spirals.logarithmic(0.1, BEST).time(AU, 1.523679 * AU, MU_SUN) / 86400
    assert days == pytest.approx(7.4050116311 * 58.132441, rel=1e-7)


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
    model = dynamics.model(1.0, device=dynamics.THRUSTER, device_parameters=(a, 0, 0), steering=law.RADIAL)
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
