"""Steps that keep to one cell of the tables and to one side of the shadow's edge, and end where these are left."""

from __future__ import annotations

import numpy as np
import pytest

import sailviz
from sailviz.compiled import compiled
from sailviz.environment import grid, ionosphere
from sailviz.environment.grid import beyond, cell, cell_at, held_cell, quantity
from sailviz.propagate import dop853
from sailviz.propagate.edges_callback import arc
from sailviz.propagate.events import watch
from sailviz.propagate.low_orbit_callback import ALTITUDE, LATITUDE, LOCAL_TIME, observe_low_orbit
from sailviz.simulation.plan import plan


@compiled
def looked_up(p, where, f107, held):
    """ln of the density (n,) at places (3, n), each in its own cell or all in that of the first."""
    out = np.empty(where.shape[1])
    i, j, k = cell_at(p, 0, where[0, 0], where[1, 0], where[2, 0])
    for n in range(len(out)):
        place = cell(p, 0, where[0, n], where[1, n], where[2, n], f107, 2)
        if held:
            place = held_cell(p, 0, where[0, n], where[1, n], where[2, n], f107, 2, i, j, k)
        out[n] = quantity(p, place, 0, 2)
    return out


@compiled
def how_far(p, place, first):
    """How far a place lies outside the cell of the first."""
    i, j, k = cell_at(p, 0, first[0], first[1], first[2])
    return beyond(p, 0, place[0], place[1], place[2], i, j, k)


@compiled
def along(dt, y):
    return arc(dt, y)


def test_a_held_cell_says_inside_what_the_table_says():
    table, rng = ionosphere.table(), np.random.default_rng(3)
    for f107 in (70.0, 110.0, 193.0):
        for _ in range(50):
            where = np.array([rng.uniform(-1.57, 1.57), rng.uniform(-20, 20), rng.uniform(1e5, 16e5)])[:, None]
            assert looked_up(table, where, f107, True) == pytest.approx(looked_up(table, where, f107, False), abs=1e-11)
            assert how_far(table, where[:, 0], where[:, 0]) <= 1e-12


@pytest.mark.parametrize("step", [(np.radians(10), 0, 0), (0, np.pi / 4, 0), (0, 0, 25e3)])
def test_a_held_cell_goes_on_straight_beyond_each_face_and_round_midnight(step):
    table = ionosphere.table(145.0)
    corner = np.array([np.radians(20), 7 * np.pi / 4, 700e3])  # the last cell of the day
    inside = corner + 0.5 * np.array([np.radians(10), np.pi / 4, 25e3])
    where = inside + np.array([0, 0.2, 0.4, 0.7, 0.9])[:, None] * np.array(step)
    line = looked_up(table, np.ascontiguousarray(where.T), 145.0, True)
    assert np.ptp(np.diff(line) / np.diff([0, 0.2, 0.4, 0.7, 0.9])) < 1e-9
    free = looked_up(table, np.ascontiguousarray(where.T), 145.0, False)
    assert line[:3] == pytest.approx(free[:3], abs=1e-11)
    assert abs(line[4] - free[4]) > 1e-4  # where the kink is
    assert how_far(table, where[4], inside) == pytest.approx(0.4, abs=1e-9)
    far = np.ascontiguousarray(np.array([inside, inside + 3 * np.array(step)]).T)
    last = inside + (0.5 + grid.FARTHEST) * np.array(step)
    assert looked_up(table, far, 145.0, True)[1] == pytest.approx(
        looked_up(table, np.ascontiguousarray(np.array([inside, last]).T), 145.0, True)[1], abs=1e-11
    )


def test_below_and_above_the_table_is_a_cell_of_its_own():
    table = ionosphere.table(145.0)
    for first, other in ((150e3, 199e3), (1501e3, 3000e3)):
        where = np.array([[0.1, 0.1], [1.0, 1.0], [first, other]])
        held = looked_up(table, where, 145.0, True)
        assert held[0] == held[1]
        assert how_far(table, where[:, 1], where[:, 0]) <= 0.0


@pytest.mark.parametrize("dt", [1.0, 30.0, 200.0, 270.0])
def test_an_arc_is_foreseen_to_a_hundredth_of_a_second(dt):
    """At 7.5 km/s. What is missed is the change of J2's pull, with the cube of the time."""
    p = plan(sailviz.load_scene("deorbit/estcube-2-maximum"))
    s, out = dop853.start(0.0, p.position, p.velocity, p.seventh), np.empty((6, 1))
    arguments = (p.schedule.breaks, p.schedule.factors.copy(), watch([]), np.array([dt]), out)
    dop853.advance(s, p.model, *arguments, dt, 1e-13, np.inf)
    first = dop853.start(0.0, p.position, p.velocity, p.seventh)
    dop853.advance(first, p.model, *arguments[:3], np.zeros(1), np.empty((6, 1)), dt, 1e-13, np.inf)
    state = np.concatenate([p.position, p.velocity, [p.seventh], first.work[0, 3:6]])
    missed = np.linalg.norm(np.array(along(dt, state)) - out[:3, 0])
    assert missed < 75.0 * (dt / 270.0) ** 3 + 1e-8


def flight(name, rows, tolerance=1e-10):
    """Plan, integration and states (7, n) of the first quarter of a day, and of all its steps."""
    p = plan(sailviz.load_scene(name))
    s, ends = dop853.start(0.0, p.position, p.velocity, p.seventh), []
    times = np.linspace(0.0, 21_600.0, rows)
    out = np.empty((6, rows))
    for i in range(rows):
        dop853.advance(
            s, p.model, p.schedule.breaks, p.schedule.factors.copy(), watch([]), times[i : i + 1],
            out[:, i : i + 1], 21_600.0, tolerance, np.inf,
        )  # fmt: skip
        ends.append(dop853.time(s))
    return p, s, np.vstack([out, np.full(rows, p.seventh)]), times, np.unique(ends)


def test_no_step_crosses_a_face_of_the_table():
    """Between the ends of steps the place stays in one cell, but for what was foreseen wrongly: 0.05 s."""
    p, s, states, times, ends = flight("deorbit/estcube-2-maximum", 21_601)
    assert dop853.statistics(s)[1] == 0
    seen = observe_low_orbit(times, states, np.ones(len(times)), p.model.parameters)
    nodes = np.array([
        (seen[LATITUDE] / np.pi + 0.5) * 18, seen[LOCAL_TIME] / (np.pi / 4), (seen[ALTITUDE] - 200e3) / 25e3
    ])  # fmt: skip
    changes = np.any(np.diff(np.floor(nodes), axis=1) != 0, axis=0)
    crossed = 0.5 * (times[:-1] + times[1:])[changes]
    assert len(crossed) > 100
    nearest = np.abs(crossed[:, None] - ends).min(axis=1)
    assert nearest.max() < 0.6  # rows stand a second apart


def test_the_model_is_left_as_it_was():
    """Whoever reads the air at another place afterwards finds it there."""
    p, *_ = flight("deorbit/estcube-2-maximum", 50)
    assert p.model.named.held.active == 0


@pytest.mark.parametrize("name", ["deorbit/sunlit-only", "deorbit/power-limited"])
def test_the_edge_of_the_shadow_costs_no_rejected_step(name):
    _, s, _, _, _ = flight(name, 100)
    assert dop853.statistics(s)[1] == 0


def test_blocks_of_any_size_give_the_same_bits():
    scene = sailviz.load_scene("deorbit/power-limited").with_values({"propagation.duration_d": 0.2, "expect": []})
    whole = sailviz.simulate(scene)
    parts = list(sailviz.simulate_blocks(scene, block_rows=7))
    assert np.array_equal(np.concatenate([part.position for part in parts]), whole.position)


def test_a_wide_tolerance_is_not_charged_for_what_it_does_not_ask_for():
    """At 1e-9 as many steps as a smooth force takes."""
    _, wide, _, _, _ = flight("deorbit/estcube-2-maximum", 40, 1e-9)
    _, narrow, _, _, _ = flight("deorbit/estcube-2-maximum", 40, 0.99e-9)
    assert dop853.statistics(narrow)[0] > 1.5 * dop853.statistics(wide)[0]
