"""What a sky costs: one right-hand side with Moon and Sun, and a year round the Earth with all that there is.

The least of several, in time of the thread's own CPU."""

from __future__ import annotations

from time import thread_time

import numpy as np
import pytest
from numba import njit

import sailviz
from sailviz.propagate import dynamics, stepping
from sailviz.simulation.integration import INTEGRATORS, begun
from sailviz.simulation.plan import plan

CALLS = 200_000


@njit
def evaluated(times, y, p, out):
    for i in range(len(times)):
        dynamics.derivative(times[i], y, 1.0, p[0], out)
    return out[3]


def scene(altitude, days, sail=True, **environment):
    pushed = {
        "device": {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 0.05},
        "steering": {"kind": "sun-facing"},
    }
    return sailviz.load_scene(
        (pushed if sail else {"device": {"kind": "none"}})
        | {
            "title": "under the whole sky",
            "body": "earth",
            "epoch": "2026-03-20",
            "start": {"kind": "circular", "altitude_km": altitude, "inclination_deg": 20},
            "environment": {"j2": True, **environment},
            "propagation": {"duration_d": days, "outputs": 2, "tolerance": 1e-9},
        }
    )


def one_call(p):
    """s a right-hand side takes, each at a time of its own, so that all bodies move."""
    times = np.linspace(0.0, 0.9 * p.scene.propagation.duration, CALLS)
    y, out = np.array([*p.position, *p.velocity, 1.0]), np.empty(7)
    evaluated(times[:2], y, p.model.parameters, out)
    best = np.inf
    for _ in range(7):
        begin = thread_time()
        evaluated(times, y, p.model.parameters, out)
        best = min(best, thread_time() - begin)
    return best / CALLS


def test_moon_and_sun_cost_less_than_a_third_of_a_microsecond_a_call():
    """Moon, Sun, and a sail in the Sun's light, over a craft that only the oblate Earth pulls."""
    alone = plan(scene(35_786, 30, sail=False))
    both = plan(scene(35_786, 30, shadow_of=[], gravity_of=["moon", "sun"]))
    more = one_call(both) - one_call(alone)
    print(f"\n{more * 1e9:.0f} ns more")
    assert 0.0 < more < 0.35e-6


def flown(p):
    """s of a whole flight."""
    times, out, method = (
        np.array([0.0, p.scene.propagation.duration]),
        np.empty((6, 2)),
        INTEGRATORS[p.choice.integrator],
    )
    s, begin = begun(p), thread_time()
    arguments = p.model, p.schedule.breaks, p.schedule.factors.copy(), p.watch, times, out, times[-1], 1e-9, np.inf
    while method.advance(s, *arguments) == stepping.EVENTS_FULL:
        method.drain_events(s)
    return thread_time() - begin


@pytest.mark.parametrize("altitude", [35_786, 800])
def test_a_year_under_moon_sun_oblateness_shadow_and_light_takes_less_than_a_second(altitude):
    """At 1e-9, in penumbra and umbra; at 800 km 5,200 revolutions with four edges in each."""
    p = plan(scene(altitude, 365.25, shadow="cone", gravity_of=["moon", "sun"]))
    flown(plan(scene(altitude, 5, shadow="cone", gravity_of=["moon", "sun"])))
    best = min(flown(p) for _ in range(4))
    print(f"\n{altitude} km: {best:.2f} s")
    assert best < 1.0
