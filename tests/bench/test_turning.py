"""A craft that turns: what one look at everything costs, and a hundred days of a free sail. Thread CPU time."""

import time

import numpy as np

from sailviz.compiled import entry
from sailviz.propagate.body_motion import SIZE
from sailviz.propagate.body_steps import advance, body_derivative
from sailviz.propagate.parameters import PARAMETERS
from sailviz.scene.loading import load_scene
from sailviz.simulation.integration import begun
from sailviz.simulation.plan import plan

SAIL = {
    "title": "free",
    "start": {"kind": "circular", "radius_au": 1},
    "device": {
        "kind": "solar-sail",
        "mass_kg": 14,
        "film": "jpl-2015",
        "back": "black",
        "shape": {
            "kind": "square",
            "side_m": 9.27,
            "cone_deg": 3,
            "sag": 0.03,
            "bus": {"size_m": [0.6, 0.6, 1], "centre_m": [0, 0, -0.7]},
            "shadow": False,
        },
    },
    "attitude": {
        "kind": "free",
        "inertia_kg_m2": [60, 62, 115],
        "centre_of_mass_m": [0.01, 0, -0.3],
        "pitch_deg": 20,
    },
    "propagation": {"duration_d": 100, "outputs": 1000},
}


@entry("d2 r1 D1", PARAMETERS)
def _looks(states, parameters, out):
    """The right-hand side at many states (n, SIZE)."""
    p = parameters[0]
    for i in range(len(states)):
        body_derivative(0.0, states[i], 1.0, p, out)
    return 0


def test_a_right_hand_side_of_thirteen_states_takes_less_than_250_nanoseconds():
    """Light by tensors and table, gravity and its torque, at random attitudes."""
    p = plan(load_scene(SAIL))
    states = np.zeros((100_000, SIZE))
    states[:, :6], states[:, 6] = (*p.position, *p.velocity), 14.0
    states[:, 7:11] = np.random.default_rng(1).normal(size=(len(states), 4))
    out, best = np.empty(SIZE), np.inf
    for _ in range(20):
        begin = time.thread_time()
        _looks(states, p.model.parameters, out)
        best = min(best, time.thread_time() - begin)
    print(f"{best / len(states) * 1e9:.0f} ns")
    assert best / len(states) < 250e-9


def test_a_hundred_days_of_a_free_sail_take_less_than_five_seconds():
    """It turns its back to the Sun within days and goes on tumbling: a million steps are tried."""
    p = plan(load_scene(SAIL))
    state, times = begun(p), np.linspace(0, p.limit, 1000)
    out = np.empty((SIZE, len(times)))
    given = p.schedule.breaks, p.schedule.factors, p.watch, times, out, p.limit, 1e-10, np.inf
    short = p.schedule.breaks, p.schedule.factors, p.watch, times[:1], out, 1.0, 1e-10, np.inf
    assert advance(begun(p), p.model, *short) == 0  # which compiles it, where it is not yet
    begin = time.thread_time()
    assert advance(state, p.model, *given) == 0
    took = time.thread_time() - begin
    print(f"{took:.2f} s, {state.counter[4]} steps and {state.counter[5]} tried again")
    assert took < 5
