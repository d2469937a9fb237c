"""README's sentence on accuracy, scene by scene: at the settings that a scene is shipped with."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sailviz
from sailviz.propagate import dop853, stepping
from sailviz.shipped import shipped_scenes
from sailviz.simulation.integration import INTEGRATORS, begun
from sailviz.simulation.plan import plan

TURNS = 20


def span(p):
    """Twenty revolutions of the orbit at the start, or the whole flight, s."""
    a = 1 / (2 / np.linalg.norm(p.position) - p.velocity @ p.velocity / p.body.mu)
    whole = p.scene.propagation.duration
    return min(whole, TURNS * 2 * np.pi * np.sqrt(a**3 / p.body.mu)) if a > 0 else whole


def fly(p, times, tolerance, largest_step, integrator):
    """Positions (3, n) at times (n,) as far as the flight goes."""
    method = INTEGRATORS[integrator]
    s = (
        begun(p)
        if integrator == p.choice.integrator
        else dop853.start(0.0, p.position, p.velocity, p.seventh, len(p.names))
    )
    out, factors = np.full((6, len(times)), np.nan), p.schedule.factors.copy()
    arguments = (p.schedule.breaks, factors, p.watch, times, out, p.scene.propagation.duration)
    while method.advance(s, p.model, *arguments, tolerance, largest_step) == stepping.EVENTS_FULL:
        stepping.drain_events(s)
    return out[:3, : stepping.rows_done(s)]


@pytest.mark.parametrize("name", sorted(shipped_scenes()))
def test_twenty_revolutions_are_within_1e_8_of_far_finer_steps(name):
    """Of the distance, where a scene ends earlier over all of it. The fine flight of a low orbit takes steps of 2 s
    and knows nothing of cells and shadows."""
    p = plan(sailviz.load_scene(name))
    run, last = p.scene.propagation, span(p)
    times = np.linspace(0.0, last, 501)
    flown = fly(p, times, run.tolerance, run.largest_step or np.inf, p.choice.integrator)
    parameters = p.model.parameters.copy()
    parameters["callbacks"]["edges"] = 0
    fine = replace(p, model=p.model._replace(parameters=parameters))
    independent = "dop853" if p.turning is None else "turning"  # a craft that turns is flown with its attitude
    exact = fly(fine, times, 1e-14, 2.0 if p.scene.body == "earth" else last / 20_000, independent)
    rows = min(flown.shape[1], exact.shape[1])
    assert rows > 50  # a mission in phases ends with the first of them
    away = np.linalg.norm(flown[:, :rows] - exact[:, :rows], axis=0) / np.linalg.norm(exact[:, :rows], axis=0)
    assert away.max() < 1e-8
