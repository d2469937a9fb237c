"""From scene to Run: blocks, events, schedules, ends and failures; what the rows say is what acted."""

from __future__ import annotations

import numba
import numpy as np
import pytest

import sailviz
from sailviz.constants import AU, DAY, MU_SUN
from sailviz.errors import PropagationError, SceneError
from sailviz.propagate.callbacks import USER_SIGNATURE
from sailviz.run.arrays import join
from sailviz.simulation.loop import simulate, simulate_blocks

COLUMNS = ("time", "position", "velocity", "mass")
SPIRALLING = {
    "title": "a sail spiralling outwards, switched twice",
    "start": {"kind": "elements", "semi_major_axis_au": 1, "eccentricity": 0.1, "inclination_deg": 5},
    "device": {"kind": "solar-sail", "lightness_number": 0.1, "active_d": [[50, 120], [200, 1000]]},
    "steering": {"kind": "orbital", "pitch_deg": 35, "clock_deg": 70},
    "event": [{"kind": "periapsis"}, {"kind": "apoapsis"}, {"kind": "node"}],
    "propagation": {"duration_d": 700, "outputs": 1000},
}
POINT_MASS = {
    "title": "around a point mass",
    "body": {"mu_m3_s2": 1.0},
    "start": {"kind": "cartesian", "position_m": [1, 0, 0], "velocity_m_s": [0, 1, 0]},
    "device": {"kind": "none"},
    "propagation": {"duration_s": 10, "outputs": 101, "tolerance": 1e-13},
}


def scene(base, **values):
    return sailviz.load_scene(base, set={key.replace("__", "."): value for key, value in values.items()})


@pytest.fixture(scope="module")
def spiral():
    return simulate(sailviz.load_scene(SPIRALLING))


# ---------------------------------------------------------------- blocks and rows
@pytest.mark.parametrize("rows", [1, 37, 500, 999, 5000])
def test_blocks_joined_are_the_whole_run(spiral, rows):
    blocks = list(simulate_blocks(sailviz.load_scene(SPIRALLING), block_rows=rows))
    assert [len(block) for block in blocks[:-1]] == [rows] * (len(blocks) - 1)
    assert [block.first for block in blocks] == [rows * i for i in range(len(blocks))]
    joined = join(blocks)
    for name in COLUMNS:
        assert np.array_equal(getattr(joined, name), getattr(spiral, name), equal_nan=True)
    assert np.array_equal(joined.thrust.acceleration, spiral.thrust.acceleration)
    assert np.array_equal(joined.elements.argument, spiral.elements.argument)
    assert [(e.name, e.time) for e in joined.events] == [(e.name, e.time) for e in spiral.events]


def test_rows_are_evenly_spaced_and_reach_the_end(spiral):
    assert len(spiral) == 1000
    assert spiral.time[0] == 0
    assert spiral.time[-1] == 700 * DAY
    assert np.diff(spiral.time) == pytest.approx(np.full(999, 700 * DAY / 999), rel=1e-9)


def test_an_output_interval_that_does_not_divide_the_duration_ends_before_it():
    run = simulate(scene(POINT_MASS, propagation={"duration_s": 10, "output_interval_s": 3}))
    assert list(run.time) == [0, 3, 6, 9]
    exact = simulate(scene(POINT_MASS, propagation={"duration_s": 0.3, "output_interval_s": 0.1}))
    assert exact.time == pytest.approx([0, 0.1, 0.2, 0.3], abs=1e-15)


def test_progress_rises_to_one():
    seen = []
    list(simulate_blocks(sailviz.load_scene(SPIRALLING), block_rows=100, progress=seen.append))
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    assert len(seen) > 20


# ---------------------------------------------------------------- events
def test_events_come_in_order_of_time_with_their_names(spiral):
    times = [event.time for event in spiral.events]
    assert times == sorted(times)
    assert {event.name for event in spiral.events} == {"periapsis", "apoapsis", "node", "thrust on", "thrust off"}
    for event in spiral.events:
        r, v = event.state[:3], event.state[3:6]
        across = abs(r @ v) / np.linalg.norm(r) / np.linalg.norm(v)
        if event.name in ("periapsis", "apoapsis"):
            assert across < 1e-12
        if event.name == "node":
            assert abs(r[2]) < 1e-12 * AU


def test_thrust_switches_at_the_very_times_of_the_scene(spiral):
    switches = [(event.name, event.time / DAY) for event in spiral.events if event.name.startswith("thrust")]
    assert switches == [("thrust on", 50), ("thrust off", 120), ("thrust on", 200)]
    inside = (spiral.time >= 50 * DAY) & (spiral.time < 120 * DAY) | (spiral.time >= 200 * DAY)
    assert np.array_equal(spiral.thrust.on, inside)
    assert np.array_equal(spiral.thrust.magnitude > 0, inside)
    assert np.array_equal(spiral.environment["thrust_factor"], inside.astype(float))


def test_between_burns_the_orbit_stays(spiral):
    """Two-body energy over 80 days without thrust: 1e-10 per step and 15 steps."""
    coasting = (spiral.time >= 120 * DAY) & (spiral.time < 200 * DAY)
    a = spiral.elements.semi_major_axis[coasting]
    assert np.ptp(a) < 1e-9 * AU


def test_a_stop_leaves_the_state_at_the_event_as_last_row():
    stopping = scene(SPIRALLING, event=[{"kind": "radius", "name": "far", "radius_au": 1.2, "stop": True}])
    run = simulate(stopping)
    (far,) = [event for event in run.events if event.name == "far"]
    assert run.ended == "far"
    assert run.time[-1] == far.time
    assert np.linalg.norm(run.position[-1]) == pytest.approx(1.2 * AU, rel=1e-12)
    assert np.array_equal(run.position[-1], far.state[:3])
    assert run.time[-2] < far.time < 700 * DAY
    assert all(event.time <= far.time for event in run.events)
    for rows in (1, 7, 10_000):
        blocks = list(simulate_blocks(stopping, block_rows=rows))
        assert np.array_equal(join(blocks).time, run.time)
        assert blocks[-1].ended == "far"


def test_a_fall_onto_the_sun_ends_in_an_impact():
    run = simulate(
        sailviz.load_scene(
            {
                "title": "fall",
                "start": {"kind": "cartesian", "position_au": [0.1, 0, 0], "velocity_m_s": [0, 0, 0]},
                "device": {"kind": "none"},
                "propagation": {"duration_d": 30, "outputs": 301},
            }
        )
    )
    assert run.ended == "impact"
    assert np.linalg.norm(run.position[-1]) == pytest.approx(695_700e3, rel=1e-10)
    x = 695_700e3 / (0.1 * AU)
    fall = np.sqrt((0.1 * AU) ** 3 / (2 * MU_SUN)) * (np.arccos(np.sqrt(x)) + np.sqrt(x * (1 - x)))
    assert run.time[-1] == pytest.approx(fall, rel=1e-9)


def test_a_brake_out_of_its_altitude_is_off_for_good():
    brake = {
        "title": "brake",
        "body": "earth",
        "start": {"kind": "circular", "altitude_km": 420},
        "device": {"kind": "plasma-brake", "mass_kg": 1, "tether_length_km": 5, "off_below_km": 400},
        "environment": {
            "ionosphere": {"kind": "exponential-force", "force_per_length_nN_m": 2000, "scale_height_km": 200}
        },
        "propagation": {"duration_d": 1, "outputs": 500},
    }
    run = simulate(sailviz.load_scene(brake))
    (off,) = [event for event in run.events if event.name == "brake off"]
    assert np.linalg.norm(off.state[:3]) == pytest.approx(6_378_137 + 400e3, abs=1e-3)
    assert np.array_equal(run.thrust.on, run.time < off.time)
    after = run.elements.semi_major_axis[run.time > off.time]
    assert len(after) > 100
    assert np.ptp(after) < 0.01  # m


# ---------------------------------------------------------------- ends that are failures
def test_a_fall_into_a_point_mass_is_a_propagation_error_with_time_and_state():
    falling = scene(POINT_MASS, start__velocity_m_s=[0, 0, 0])
    blocks = []
    with pytest.raises(PropagationError, match="position") as caught:
        blocks.extend(simulate_blocks(falling, block_rows=10))
    assert caught.value.time == pytest.approx(np.pi / np.sqrt(8), abs=1e-6)
    assert abs(caught.value.state[0]) < 1e-3
    assert join(blocks).time[-1] == pytest.approx(1.1, abs=1e-9)  # the rows before it were delivered
    assert "t = 1.11072 s" in str(caught.value)


def test_no_acceleration_beyond_a_models_range_passes_for_a_number():
    """The original E-sail model says nothing beyond its pitch limit: a user's law that goes there is stopped."""

    @numba.njit
    def edge_on(t, x, y, z, vx, vy, vz, m):
        return 0.0, 0.0, 1.0

    sail = {"kind": "electric-sail", "model": "original", "characteristic_acceleration_mm_s2": 1}
    sailing = sailviz.load_scene({**SPIRALLING, "device": sail})
    with pytest.raises(PropagationError, match="not a finite number"):
        simulate(sailing, steering=edge_on)


def test_an_infeasible_orbit_is_a_scene_error_with_its_reason():
    asked = sailviz.load_scene("displaced/circular", set={"start.rate_ratio": 0.9})
    with pytest.raises(SceneError, match=r"19\.47 deg"):
        simulate(asked)


def test_a_start_below_the_surface_is_a_scene_error():
    with pytest.raises(SceneError, match="surface"):
        simulate(scene(SPIRALLING, start={"kind": "circular", "radius_km": 1000}))


# ---------------------------------------------------------------- a user's own functions
@numba.njit
def ahead(t, x, y, z, vx, vy, vz, m):
    """35 deg from the Sun line towards the motion, in the orbit plane."""
    r = np.sqrt(x * x + y * y + z * z)
    ux, uy, uz = x / r, y / r, z / r
    hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    h = np.sqrt(hx * hx + hy * hy + hz * hz)
    hx, hy, hz = hx / h, hy / h, hz / h
    tx, ty, tz = hy * uz - hz * uy, hz * ux - hx * uz, hx * uy - hy * ux
    c, s = np.cos(np.radians(35.0)), np.sin(np.radians(35.0))
    return c * ux + s * tx, c * uy + s * ty, c * uz + s * tz


@numba.njit
def ahead_at_length(t, x, y, z, vx, vy, vz, m):
    """The same, 2.5 long before 300 days and 1e-200 long after them."""
    a, b, c = ahead(t, x, y, z, vx, vy, vz, m)
    k = 2.5 if t < 300 * 86400.0 else 1e-200
    return k * a, k * b, k * c


@numba.njit
def stowed_at_last(t, x, y, z, vx, vy, vz, m):
    """The same for 300 days, and then nothing."""
    a, b, c = ahead(t, x, y, z, vx, vy, vz, m)
    k = 1.0 if t < 300 * 86400.0 else 0.0
    return k * a, k * b, k * c


AHEAD = {
    "title": "ahead",
    "start": {"kind": "circular", "radius_au": 1},
    "steering": {"kind": "orbital", "pitch_deg": 35, "clock_deg": 90},
    "propagation": {"duration_d": 400, "outputs": 401, "tolerance": 1e-12},
}
DEVICES = {
    "solar sail": {"kind": "solar-sail", "lightness_number": 0.05},
    "electric sail": {"kind": "electric-sail", "characteristic_acceleration_mm_s2": 0.5},
    "thruster": {"kind": "thruster", "thrust_mN": 50, "mass_kg": 500, "specific_impulse_s": 3000},
}


@pytest.mark.parametrize("device", DEVICES.values(), ids=DEVICES)
def test_a_users_direction_of_any_length_gives_the_thrust_of_a_unit_vector(device):
    sailing = sailviz.load_scene(AHEAD | {"device": device})
    long, known = simulate(sailing, steering=ahead_at_length), simulate(sailing)
    assert np.linalg.norm(long.attitude.normal, axis=1) == pytest.approx(1, abs=1e-14)
    assert np.linalg.norm(long.position - known.position, axis=1).max() < 1e-9 * AU
    assert long.mass == pytest.approx(known.mass, rel=1e-11, nan_ok=True)


@pytest.mark.parametrize("device", DEVICES.values(), ids=DEVICES)
def test_a_users_zero_vector_is_a_stowed_sail(device):
    sailing = sailviz.load_scene(AHEAD | {"device": device})
    run = simulate(sailing, steering=stowed_at_last)
    off = run.time > 301 * DAY
    assert not run.thrust.acceleration[off].any()
    assert run.thrust.acceleration[run.time < 299 * DAY].any(axis=1).all()
    assert not run.attitude.normal[off].any()
    assert np.isnan(run.attitude.pitch[off]).all() == (run.setting.craft.kind in ("solar-sail", "electric-sail"))
    assert np.linalg.norm(run.attitude.quaternion, axis=1) == pytest.approx(1, abs=1e-12)
    assert run.mass[off] == pytest.approx(np.full(off.sum(), run.mass[-1]), rel=1e-15, nan_ok=True)
    energy = np.sum(run.velocity**2, axis=1) / 2 - MU_SUN / np.linalg.norm(run.position, axis=1)
    assert np.ptp(energy[off]) < 1e-9 * abs(energy[-1])


def test_a_mass_that_nobody_gave_is_no_fact():
    """One kilogram flies, so that forces are accelerations; rows and events say that the mass is unknown."""
    run = simulate(scene(SPIRALLING))
    assert np.isnan(run.mass).all()
    assert run.events
    assert all(np.isnan(event.state[6]) and np.isfinite(event.state[:6]).all() for event in run.events)
    heavy = simulate(scene(SPIRALLING, device__mass_kg=300))
    assert (heavy.mass == 300).all()
    assert all(event.state[6] == 300 for event in heavy.events)
    assert np.array_equal(heavy.position, run.position)


@numba.cfunc(USER_SIGNATURE)
def ahead_in_c(t, state, out):
    y, n = numba.carray(state, (7,)), numba.carray(out, (3,))
    n[0], n[1], n[2] = ahead(t, y[0], y[1], y[2], y[3], y[4], y[5], y[6])


@pytest.mark.parametrize("law", [ahead, ahead_in_c], ids=["njit", "cfunc"])
def test_a_users_law_flies_as_the_built_in_one(law):
    sailing = scene(SPIRALLING, steering__clock_deg=90, propagation__integrator="dop853")  # as for any law of one's own
    own, built_in = simulate(sailing, steering=law), simulate(sailing)
    assert np.abs(own.position - built_in.position).max() < 1e-11 * AU
    assert own.attitude.normal == pytest.approx(built_in.attitude.normal, abs=1e-11)


def test_a_users_force_adds_to_gravity():
    """A constant push outwards: Tsien's problem, (2.15), escape at r = 1 + 1 / (2a)."""
    run = simulate(scene(POINT_MASS, event=[{"kind": "escape", "stop": True}]), force=push(0.25))
    assert np.linalg.norm(run.position[-1]) == pytest.approx(3.0, abs=1e-10)
    assert run.thrust.magnitude == pytest.approx(np.full(len(run), 0.25), abs=1e-15)


def test_what_is_no_compiled_function_is_refused():
    with pytest.raises(TypeError, match="numba"):
        simulate(sailviz.load_scene(POINT_MASS), force=lambda *state: (0, 0, 0))

    @numba.njit
    def too_few(t, x, y, z, vx, vy, vz, m):
        return x, y

    with pytest.raises(TypeError, match="compile"):
        simulate(sailviz.load_scene(POINT_MASS), force=too_few)


# ---------------------------------------------------------------- wind, mass, identity
def test_the_seed_is_the_wind():
    wind = {"kind": "gamma", "shape": 2.6, "scale_nPa": 0.78, "redraw_d": 1, "seed": 7}
    base = {
        **SPIRALLING,
        "device": {"kind": "electric-sail", "characteristic_acceleration_mm_s2": 1},
        "environment": {"solar_wind": wind},
    }
    run, again = (simulate(sailviz.load_scene(base)) for _ in range(2))
    other = simulate(scene(base, environment__solar_wind__seed=8))
    assert np.array_equal(run.position, again.position)
    assert np.linalg.norm(run.position[-1] - other.position[-1]) > 1e-3 * AU
    pressure = np.random.Generator(np.random.PCG64(7)).gamma(2.6, 0.78e-9, 700)
    day = (run.time / DAY).astype(int).clip(max=699)
    assert run.environment["solar_wind_pressure_Pa"] == pytest.approx(pressure[day], rel=1e-15)
    assert run.environment["thrust_factor"] == pytest.approx(np.sqrt(pressure[day] / (2.6 * 0.78e-9)), rel=1e-14)
    steady = 1e-3 * AU / np.linalg.norm(run.position, axis=1) * np.sqrt(1 + 3 * np.cos(np.radians(35)) ** 2) / 2
    assert run.thrust.magnitude == pytest.approx(steady * run.environment["thrust_factor"], rel=1e-12)


def test_propellant_follows_the_rocket_equation():
    burning = {
        **SPIRALLING,
        "device": {
            "kind": "thruster",
            "thrust_mN": 50,
            "mass_kg": 300,
            "specific_impulse_s": 3000,
            "active_d": [[10, 110]],
        },
        "steering": {"kind": "tangential"},
    }
    run = simulate(sailviz.load_scene(burning))
    burnt = 0.05 / (9.80665 * 3000) * np.clip(run.time - 10 * DAY, 0, 100 * DAY)
    assert run.mass == pytest.approx(300 - burnt, rel=1e-13)
    assert run.thrust.magnitude[run.thrust.on] == pytest.approx(0.05 / run.mass[run.thrust.on], rel=1e-13)


def push(size):
    """A radial push; functions that differ in what they take from around them only."""

    @numba.njit
    def force(t, x, y, z, vx, vy, vz, m):
        r = np.sqrt(x * x + y * y + z * z)
        return size * x / r, size * y / r, size * z / r

    return force


def test_equal_scenes_have_one_identity_and_any_value_another():
    identity = simulate(sailviz.load_scene(POINT_MASS)).setting.identity
    assert identity == simulate(sailviz.load_scene(POINT_MASS)).setting.identity
    spelled = scene(POINT_MASS, propagation={"duration_min": 1 / 6, "outputs": 101, "tolerance": 1e-13})
    assert simulate(spelled).setting.identity == identity
    pushes = [simulate(sailviz.load_scene(POINT_MASS), force=push(size)).setting.identity for size in (0.1, 0.1, 0.2)]
    assert pushes[0] == pushes[1]
    others = [
        *pushes[1:],
        simulate(scene(POINT_MASS, propagation__duration_s=11)).setting.identity,
        simulate(scene(POINT_MASS, title="another")).setting.identity,
        simulate(sailviz.load_scene(POINT_MASS), force=ahead).setting.identity,
        simulate(sailviz.load_scene(POINT_MASS), steering=ahead).setting.identity,
    ]
    assert len({identity, *others}) == 7


def test_rows_say_what_acted(spiral):
    """Thrust in both frames, angles of the normal and osculating elements belong to the same row."""
    on = spiral.thrust.on
    assert spiral.attitude.pitch == pytest.approx(np.full(1000, np.radians(35)), abs=1e-12)
    assert spiral.attitude.clock == pytest.approx(np.full(1000, np.radians(70)), abs=1e-12)
    assert spiral.attitude.cone[on] == pytest.approx(np.full(on.sum(), np.radians(35)), abs=1e-12)
    r = np.linalg.norm(spiral.position, axis=1)
    expected = 0.1 * MU_SUN / r**2 * np.cos(np.radians(35)) ** 2
    assert spiral.thrust.magnitude[on] == pytest.approx(expected[on], rel=1e-12)
    assert spiral.thrust.acceleration_rtn[on, 0] == pytest.approx(expected[on] * np.cos(np.radians(35)), rel=1e-12)
    assert np.linalg.norm(spiral.attitude.quaternion, axis=1) == pytest.approx(np.ones(1000), abs=1e-14)
    energy = np.sum(spiral.velocity**2, axis=1) / 2 - MU_SUN / r
    assert spiral.elements.semi_major_axis == pytest.approx(-MU_SUN / (2 * energy), rel=1e-12)
