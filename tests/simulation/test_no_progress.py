"""Flights that do not get on end with a sentence; laws that lead to a place where their thrust jumps fly past it."""

from __future__ import annotations

from time import perf_counter

import numba
import numpy as np
import pytest
from independent.integration import integrate

import sailviz
from sailviz.constants import AU, DAY
from sailviz.errors import PropagationError, SceneError, TimeLimitError
from sailviz.scene import load_scene
from sailviz.simulation.loop import simulate_blocks

ROUND_A_POINT = {  # as heavy as the Sun, at 7,000 km: twelve seconds a turn
    "title": "Bound to a point",
    "start": {"kind": "cartesian", "position_km": [149604870.7, 0.0, 0.0], "velocity_km_s": [0.0, 3809.0, 0.0]},
    "device": {"kind": "none"},
    "environment": {"third_body": {"mu_km3_s2": 1e11, "radius_au": 1.0}},
    "propagation": {"duration_yr": 5},
}
PATIENT = {**ROUND_A_POINT, "limits": {"integration_steps": 10**12}}
TO_A_STEEP_CIRCLE = {  # whose size the law sees to last: it holds the sail where two misses cancel each other
    "title": "Lyapunov",
    "start": {"kind": "circular", "radius_au": 1.0},
    "device": {"kind": "solar-sail", "film": "jpl-2015", "characteristic_acceleration_mm_s2": 0.5},
    "steering": {"kind": "lyapunov", "semi_major_axis_au": 0.48, "inclination_deg": 75},
    "propagation": {"duration_yr": 12, "outputs": 4384},
}
ELLIPSE = {"kind": "elements", "semi_major_axis_au": 1.0, "eccentricity": 0.1, "inclination_deg": 5.0}


def test_flight_round_a_point_ends_and_names_the_body_the_time_and_the_step():
    began = perf_counter()
    with pytest.raises(PropagationError) as caught:
        sailviz.simulate(ROUND_A_POINT)
    assert perf_counter() - began < 60  # compiling included
    words = str(caught.value)
    for part in ("does not get on", "s on average", "limits.integration_steps", "Earth", "pulls", "stop the run"):
        assert part in words
    assert 0 < caught.value.time < 30 * DAY


def rows_until(error, scene, **options):
    """(rows that were yielded, the error that came after them)."""
    rows = 0
    try:
        for block in simulate_blocks(scene, **options):
            rows += len(block)
    except error as caught:
        return rows, caught
    raise AssertionError("no error came")


def test_rows_up_to_where_a_flight_does_not_get_on_are_kept():
    rows, caught = rows_until(PropagationError, load_scene(ROUND_A_POINT, {"propagation.output_interval_s": 3600.0}))
    assert rows - 1 <= caught.time / 3600 <= rows + 0.01  # the last step, of a second or so, may pass a row


def test_chattering_law_is_named():
    """A law of one's own that looks to and fro with every metre."""

    @numba.njit
    def law(t, x, y, z, vx, vy, vz, m):
        r = np.sqrt(x * x + y * y + z * z)
        s = 0.6 if np.sin(r) > 0 else -0.6
        return (0.8 * x - s * y) / r, (0.8 * y + s * x) / r, 0.0

    scene = {**TO_A_STEEP_CIRCLE, "steering": {"kind": "sun-facing"}, "propagation": {"duration_yr": 12}}
    with pytest.raises(PropagationError, match=r"Your own steering chatters: it turned the sail \d+ times"):
        sailviz.simulate(scene, steering=law)


def test_steps_have_a_budget():
    with pytest.raises(PropagationError, match=r"took the 5,000 steps that limits\.integration_steps allows"):
        sailviz.simulate({**ROUND_A_POINT, "limits": {"integration_steps": 5000}})


def test_steps_that_a_scene_asks_for_are_counted_before_it_flies():
    with pytest.raises(SceneError, match=r"propagation\.largest_step.*limits\.integration_steps"):
        load_scene({**ROUND_A_POINT, "propagation": {"duration_yr": 5, "largest_step_s": 0.1}})


@pytest.mark.parametrize("seconds", [0.3, 1e-9])
def test_time_limit_ends_a_flight_with_what_there_is(seconds):
    sailviz.simulate({**ROUND_A_POINT, "propagation": {"duration_d": 1e-3}})  # compiled before the clock runs
    began = perf_counter()
    rows, caught = rows_until(TimeLimitError, load_scene(PATIENT), time_limit=seconds)
    assert perf_counter() - began < 5
    assert f"the time limit of {seconds:g} s is over: the flight had reached" in str(caught)
    assert 1 <= rows < 100  # of the thousand, the start's at least


def test_time_limit_that_is_long_enough_changes_nothing():
    scene = {**TO_A_STEEP_CIRCLE, "propagation": {"duration_d": 100}}
    free, bound = sailviz.simulate(scene), sailviz.simulate(scene, time_limit=3600.0)
    assert np.array_equal(free.position, bound.position)


def test_lyapunov_law_flies_to_its_end_and_independent_physics_agrees():
    """Where it used to be thrown to and fro, from the day 1,880 on; 1e-7 of the distance, over 80 days there."""
    run = sailviz.simulate(TO_A_STEEP_CIRCLE)
    assert run.time[-1] == run.setting.duration
    assert run.elements.inclination[-1] == pytest.approx(np.radians(75), abs=1e-4)
    assert abs(run.elements.semi_major_axis[-1] / AU - 0.48) < 0.02 * 0.48  # within 0.02 of the target, in all
    assert not run.thrust.on[-1]
    first, last = 1860, 1940
    state = np.concatenate([run.position[first], run.velocity[first], [1.0]])
    times = run.time[first + 1 : last] - run.time[first]
    wanted = integrate(load_scene(TO_A_STEEP_CIRCLE), state, times)[1:]
    away = np.linalg.norm(run.position[first + 1 : last] - wanted, axis=1) / np.linalg.norm(wanted, axis=1)
    assert away.max() < 1e-7


@pytest.mark.parametrize("device", ["solar-sail", "electric-sail"])
@pytest.mark.parametrize("goal", ["eccentricity", "inclination", "argument", "raan", "semi-major-axis"])
@pytest.mark.parametrize("sense", ["increase", "decrease"])
def test_locally_optimal_laws_fly_twelve_years_in_few_steps(device, goal, sense):
    """Each of them, where it has arrived, too: within the steps of some hundred turns."""
    scene = {
        "title": "locally optimal",
        "start": ELLIPSE,
        "device": {"kind": device, "characteristic_acceleration_mm_s2": 0.5},
        "steering": {"kind": "locally-optimal", "goal": goal, "sense": sense},
        "event": [{"kind": "radius", "radius_au": 0.1, "stop": True}],
        "propagation": {"duration_yr": 12},
        "limits": {"integration_steps": 30_000},
    }
    run = sailviz.simulate(scene)
    assert run.ended == "radius" or run.time[-1] == run.setting.duration
