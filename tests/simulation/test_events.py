"""Events on quantities against an independent flight: SciPy's DOP853 at 1e-13, the values of the rows of a run, and the
roots of them found one by one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from sailviz import frames
from sailviz.constants import AU, DAY, MU_SUN, YEAR
from sailviz.elements import elements
from sailviz.propagate import quantity_callback
from sailviz.run import formulas
from sailviz.run.arrays import Attitude, Thrust
from sailviz.run.quantities import VALUES
from sailviz.scene.events import Crossing
from sailviz.scene.quantities import DIMENSIONS, ON_A_CIRCLE
from sailviz.simulation.environment_columns import observe
from sailviz.simulation.loop import simulate
from sailviz.simulation.plan import plan

SPAN, LIGHTNESS = 1.9 * YEAR, 0.03
PITCH, CLOCK = np.radians([12.0, 55.0]), np.radians([25.0, 400.0])  # over the flight; the clock goes all round
SAIL = {
    "title": "a sail whose every quantity changes",
    "start": {
        "kind": "elements",
        "semi_major_axis_au": 1,
        "eccentricity": 0.35,
        "inclination_deg": 25,
        "raan_deg": 40,
        "argument_deg": 70,
        "true_anomaly_deg": 100,
    },
    "device": {"kind": "solar-sail", "lightness_number": LIGHTNESS},
    "steering": {
        "kind": "table",
        "time_s": [0, SPAN],
        "pitch_rad": PITCH.tolist(),
        "clock_rad": CLOCK.tolist(),
    },
    "propagation": {"duration_s": SPAN, "outputs": 3, "tolerance": 1e-12},
}
WATCHED = (*quantity_callback.OF_STATE, *quantity_callback.OF_CRAFT)
SAILS = [stem for stem in WATCHED if stem not in ("mass", "thrust_factor", "time")]
CIRCLE = (*ON_A_CIRCLE, "longitude")


def si(stem: str) -> str:
    """The key of a quantity in SI."""
    units = {"length": "m", "angle": "rad", "speed": "m_s", "acceleration": "m_s2", "none": ""}
    units |= {"specific_energy": "J_kg", "specific_angular_momentum": "m2_s", "time": "s", "mass": "kg"}
    unit = units[DIMENSIONS[stem]]
    return f"{stem}_{unit}" if unit else stem


def derivative(t, y):
    """An ideal sail, its pitch and clock straight lines over time: the equations of motion, written down once more."""
    r, v = y[:3], y[3:]
    d = np.linalg.norm(r)
    r_hat, h = r / d, np.cross(r, v)
    h_hat = h / np.linalg.norm(h)
    t_hat = np.cross(h_hat, r_hat)
    pitch, clock = np.interp(t, [0, SPAN], PITCH), np.interp(t, [0, SPAN], CLOCK)
    n = np.cos(pitch) * r_hat + np.sin(pitch) * (np.cos(clock) * h_hat + np.sin(clock) * t_hat)
    return np.concatenate([v, MU_SUN / d**2 * (LIGHTNESS * np.cos(pitch) ** 2 * n - r_hat)])


@pytest.fixture(scope="module")
def flight():
    """Times (n,) s -> a run there, flown by SciPy, with the columns that quantities are made of."""
    start = simulate(SAIL)
    y0 = np.concatenate([start.position[0], start.velocity[0]])
    sol = solve_ivp(derivative, (0, SPAN), y0, method="DOP853", rtol=1e-13, atol=1e-3, dense_output=True).sol
    body = start.setting.body

    def at(time):
        time = np.atleast_1d(time)
        position, velocity = sol(time)[:3].T, sol(time)[3:].T
        axes = frames.rtn(position, velocity)
        pitch, clock = np.interp(time, [0, SPAN], PITCH), np.interp(time, [0, SPAN], CLOCK) % (2 * np.pi)
        parts = np.stack([np.cos(pitch), np.sin(pitch) * np.sin(clock), np.sin(pitch) * np.cos(clock)], axis=1)
        normal = frames.from_frame(axes, parts)
        size = LIGHTNESS * MU_SUN / np.sum(position**2, axis=1) * np.cos(pitch) ** 2
        attitude = Attitude(pitch, pitch, clock, normal, np.zeros((len(time), 4)))
        thrust = Thrust(size[:, None] * normal, size[:, None] * parts, size, np.ones(len(time), bool))
        orbit = elements(position, velocity, body.mu)
        return replace(
            start, time=time, position=position, velocity=velocity, attitude=attitude, thrust=thrust, elements=orbit,
            mass=np.full(len(time), np.nan), environment={}, bodies={},
        )  # fmt: skip

    return at


def roots(flight, stem, level):
    """(time s, 1 rising or -1 falling) of every crossing, one by one."""

    def off(time):
        value = VALUES[stem](flight(time))
        away = value - level
        return away - 2 * np.pi * np.round(away / (2 * np.pi)) if stem in CIRCLE else away

    times = np.linspace(0, SPAN, 40_001)
    values = off(times)
    found = []
    for i in np.nonzero(np.sign(values[1:]) * np.sign(values[:-1]) < 0)[0]:
        if abs(values[i + 1] - values[i]) < (np.pi if stem in CIRCLE else np.inf):
            moment = brentq(lambda t: float(off(t)[0]), times[i], times[i + 1], xtol=1e-6, rtol=1e-15)
            found.append((moment, int(np.sign(values[i + 1] - values[i]))))
    return found


def level_of(flight, stem):
    """A value that the quantity comes by more than once, but not at the start."""
    values = VALUES[stem](flight(np.linspace(0, SPAN, 2001)))
    return float(np.quantile(values % (2 * np.pi) if stem in CIRCLE else values, 0.37031))


@pytest.mark.parametrize("stem", SAILS)
def test_every_crossing_of_a_quantity_is_found_where_an_independent_flight_has_it(flight, stem):
    """Either way and each way alone, to 1e-9 of the first orbit's period, which is a year: 0.03 s."""
    level = level_of(flight, stem)
    expected = roots(flight, stem, level)
    assert expected
    events = [{si(stem): level, "sense": sense, "name": sense} for sense in ("both", "up", "down")]
    for integrator in ("dop853", "collocation"):
        propagation = {**SAIL["propagation"], "integrator": integrator}
        found = simulate({**SAIL, "event": events, "propagation": propagation}).events
        for sense, ways in (("both", (1, -1)), ("up", (1,)), ("down", (-1,))):
            times = [event.time for event in found if event.name == sense]
            wanted = [moment for moment, way in expected if way in ways]
            assert len(times) == len(wanted), (integrator, sense, times, wanted)
            assert np.allclose(times, wanted, rtol=0, atol=1e-9 * YEAR), np.subtract(times, wanted)


@pytest.mark.parametrize("integrator", ["dop853", "collocation"])
def test_a_run_that_a_quantity_ends_does_not_overrun_it(flight, integrator):
    level = level_of(flight, "flight_path_angle")
    when = roots(flight, "flight_path_angle", level)[1][0]
    first = roots(flight, "flight_path_angle", level)[0][0]
    sense = dict(roots(flight, "flight_path_angle", level))[when]
    event = {"flight_path_angle_rad": level, "sense": "up" if sense > 0 else "down", "stop": True, "name": "there"}
    run = simulate({**SAIL, "event": [event], "propagation": {**SAIL["propagation"], "integrator": integrator}})
    assert run.ended == "there"
    assert first < run.time[-1]
    assert run.time[-1] == pytest.approx(when, abs=1e-9 * YEAR)
    assert VALUES["flight_path_angle"](run)[-1] == pytest.approx(level, abs=1e-10)
    assert [event.name for event in run.events] == ["there"]


@pytest.mark.parametrize("integrator", ["dop853", "collocation"])
@pytest.mark.parametrize("depth", [1e-4, 1e-8])
def test_two_crossings_within_one_step_are_both_found(integrator, depth):
    """A radius a little above the perihelion is passed twice in a few hours or minutes, of steps that take weeks."""
    e = 0.2
    scene = {
        "title": "ellipse",
        "start": {"kind": "elements", "semi_major_axis_au": 1, "eccentricity": e, "true_anomaly_deg": 180},
        "device": {"kind": "none"},
        "propagation": {"duration_yr": 1, "outputs": 2, "integrator": integrator, "tolerance": 1e-12},
        "event": [{"radius_au": (1 - e) * (1 + depth), "name": "low"}],
    }
    anomaly = np.arccos((1 - (1 - e) * (1 + depth)) / e)  # eccentric
    away = (anomaly - e * np.sin(anomaly)) * np.sqrt(AU**3 / MU_SUN)
    middle = np.pi * np.sqrt(AU**3 / MU_SUN)
    times = [event.time for event in simulate(scene).events]
    # how well the perihelion's distance is known decides on the time near it: to 1e-11 of it
    atol = 1e-11 / depth * away + 1e-9 * YEAR
    assert np.allclose(times, [middle - away, middle + away], rtol=0, atol=atol)


def test_an_angle_fires_at_its_value_and_nowhere_else_on_its_circle():
    """Once in each of ten turns, whatever the value, those at the wrap and just beside it included."""
    base = {
        "title": "ten turns",
        "start": {"kind": "elements", "semi_major_axis_au": 1, "eccentricity": 0.1, "true_anomaly_deg": 77},
        "device": {"kind": "none"},
        "propagation": {"duration_yr": 10.0, "outputs": 2},
    }
    levels = [-180.0, -179.999, -90.0, -1e-3, 0.0, 1e-3, 90.0, 179.999, 180.0, 270.0, 359.999]
    for stem in ("true_anomaly", "longitude"):
        events = [{f"{stem}_deg": level, "name": f"{i}"} for i, level in enumerate(levels)]
        found = [event.name for event in simulate({**base, "event": events}).events]
        assert all(found.count(f"{i}") == 10 for i in range(len(levels))), found


def test_a_semi_major_axis_is_passed_once_on_the_way_to_escape():
    """It becomes infinite and comes back from minus infinity, which is no crossing; nor is that of the apoapsis."""
    scene = {
        "title": "escape",
        "start": {"kind": "circular", "radius_au": 1},
        "device": {"kind": "thruster", "acceleration_mm_s2": 1.0},
        "steering": {"kind": "tangential"},
        "propagation": {"duration_yr": 2, "outputs": 2},
        "event": [
            {"semi_major_axis_au": 3, "name": "axis"},
            {"apoapsis_au": 5, "name": "far"},
            {"semi_major_axis_au": -3, "name": "open"},
            {"energy_J_kg": 0.0, "name": "free"},
            {"eccentricity": 1.0, "name": "parabola"},
        ],
    }
    found = {event.name: event for event in simulate(scene).events}
    assert [event.name for event in simulate(scene).events].count("axis") == 1
    assert set(found) == {"axis", "far", "open", "free", "parabola"}
    for name, value in (("axis", 3 * AU), ("open", -3 * AU)):
        state = found[name].state
        orbit = elements(state[:3], state[3:6], MU_SUN)
        assert orbit.semi_major_axis == pytest.approx(value, rel=1e-10)
    assert found["free"].time == pytest.approx(found["parabola"].time, abs=1.0)
    assert found["axis"].time < found["free"].time < found["open"].time


def test_mass_and_time_and_thrust_factor_are_watched():
    scene = {
        "title": "burns",
        "start": {"kind": "circular", "radius_au": 1},
        "device": {
            "kind": "thruster",
            "thrust_mN": 100,
            "mass_kg": 500,
            "specific_impulse_s": 3000,
            "active_d": [[10, 200], [250, 300]],
        },
        "steering": {"kind": "tangential"},
        "propagation": {"duration_yr": 1, "outputs": 2},
        "event": [
            {"mass_kg": 495, "name": "mass"},
            {"time_d": 123.25, "name": "time"},
            {"thrust_factor": 0.5, "name": "factor"},
        ],
    }
    found = [(event.name, event.time) for event in simulate(scene).events if not event.name.startswith("thrust")]
    rate = 0.1 / (9.80665 * 3000)
    expected = [("factor", 10.0), ("mass", 10 + 5 / rate / DAY), ("time", 123.25)]
    expected += [("factor", 200.0), ("factor", 250.0), ("factor", 300.0)]
    expected.sort(key=lambda item: item[1])
    assert [name for name, _ in found] == [name for name, _ in expected]
    assert np.allclose([time / DAY for _, time in found], [time for _, time in expected], rtol=0, atol=1e-8)


BRAKE = {
    "title": "a brake",
    "body": "earth",
    "epoch": "2031-03-03",
    "start": {"kind": "circular", "altitude_km": 700, "inclination_deg": 60},
    "device": {
        "kind": "plasma-brake",
        "tether_length_m": 1000,
        "mass_kg": 50,
        "tip_mass_kg": 1,
        "drag_area_m2": 1,
        "power_W": 0.02,
        "eclipse": "limited",
        "eclipse_power_W": 0.005,
    },
    "steering": {"kind": "gravity-gradient"},
    "environment": {
        "j2": True,
        "corotation": True,
        "shadow": "cone",
        "solar_flux_sfu": 120,
        "ionosphere": {"kind": "iri-2020"},
        "atmosphere": {"kind": "nrlmsis-2.1"},
    },
    "propagation": {"duration_h": 8, "outputs": 5000},
}
IN_LOW_ORBIT = {
    "sunlit_fraction": "",
    "air_drag": "N",
    "plasma_density": "per_m3",
    "plasma_force": "N_m",
    "tether_voltage": "V",
    "tether_current": "A",
    "tether_power": "W",
    "tether_tilt": "rad",
    "mean_altitude": "m",
    "perigee_altitude": "m",
    "apogee_altitude": "m",
    "altitude": "m",
    "pitch": "rad",
    "cone": "rad",
    "thrust_acceleration": "m_s2",
}


@pytest.fixture(scope="module")
def orbit():
    return simulate(BRAKE)


@pytest.mark.parametrize("stem", IN_LOW_ORBIT)
def test_what_surrounds_a_brake_is_watched_as_its_rows_have_it(orbit, stem):
    """As many crossings as the rows show, each within a row's distance of theirs; and there the recorded value is the
    one that was asked for. A jump, of the power at the edge of the shadow, is where it is, not at the value."""
    values = VALUES[stem](orbit)
    level = float(np.nanmin(values) + 0.43 * np.ptp(values)) if stem != "sunlit_fraction" else 0.5
    key = f"{stem}_{IN_LOW_ORBIT[stem]}".rstrip("_")
    scene = {**BRAKE, "event": [{key: level, "name": "there"}]}
    found = [event for event in simulate(scene).events if event.name == "there"]
    rows = np.nonzero(np.sign(values[1:] - level) * np.sign(values[:-1] - level) < 0)[0]
    assert len(found) == len(rows) > 0
    p = plan(simulate_scene(scene))
    for event, row in zip(found, rows, strict=True):
        assert orbit.time[row] - 1e-6 <= event.time <= orbit.time[row + 1] + 1e-6
        run = one_row(orbit, p, event)
        jumps = abs(values[row + 1] - values[row]) > 50 * np.median(np.abs(np.diff(values)))
        if not jumps:
            assert VALUES[stem](run)[0] == pytest.approx(level, rel=1e-6, abs=1e-9)


def simulate_scene(scene):
    from sailviz.scene.loading import load_scene

    return load_scene(scene)


def one_row(run, p, event):
    """A run of one row at an event, its columns observed anew."""
    time, states = np.array([event.time]), event.state[:, None].copy()
    normal, acceleration, throttle, columns = observe(p, time, states, np.ones(1))
    position, velocity = event.state[None, :3], event.state[None, 3:6]
    axes = frames.rtn(position, velocity)
    pitch, cone, clock = frames.pitch_cone_clock(axes, normal, acceleration)
    return replace(
        run,
        time=time,
        position=position,
        velocity=velocity,
        elements=elements(position, velocity, run.setting.body.mu),
        attitude=Attitude(pitch, cone, clock, normal, np.zeros((1, 4))),
        thrust=Thrust(acceleration, acceleration, np.linalg.norm(acceleration, axis=1), throttle > 0),
        environment=columns,
        bodies={},
    )


def test_every_quantity_that_a_scene_may_expect_is_watched_or_says_why_not():
    watched = set(Crossing.model_fields) - {"sense"}
    assert watched == set(quantity_callback.QUANTITIES)
    assert watched | set(Crossing.why_not) == set(DIMENSIONS)
    assert not watched & set(Crossing.why_not)


def test_formulas_of_an_orbit_are_the_elements():
    """The scalar twins against the columns, on orbits of every kind."""
    rng = np.random.default_rng(5)
    for _ in range(300):
        r, v = rng.normal(size=3), rng.normal(size=3) * rng.uniform(0.2, 2)
        orbit = elements(r, v, 1.0)
        assert 1 / formulas.inverse_axis(*r, *v, 1.0) == pytest.approx(orbit.semi_major_axis, rel=1e-10)
        assert formulas.eccentricity(*r, *v, 1.0) == pytest.approx(orbit.eccentricity, rel=1e-10)
        assert formulas.inclination(*r, *v) == pytest.approx(orbit.inclination, rel=1e-12)
        assert formulas.raan(*r, *v) % (2 * np.pi) == pytest.approx(orbit.raan, rel=1e-11)
        assert formulas.true_anomaly(*r, *v, 1.0) % (2 * np.pi) == pytest.approx(orbit.true_anomaly, abs=1e-8)
        q = orbit.semi_major_axis * (1 - orbit.eccentricity)
        assert formulas.periapsis(*r, *v, 1.0) == pytest.approx(q, rel=1e-8)
        far = orbit.semi_major_axis * (1 + orbit.eccentricity)
        assert 1 / formulas.inverse_apoapsis(*r, *v, 1.0) == pytest.approx(far, rel=1e-8)
