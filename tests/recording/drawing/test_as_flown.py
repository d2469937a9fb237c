"""A flight that leaves, or spirals out, is drawn row by row: it goes round less than its first orbit promised."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sailviz.constants import MU_EARTH, RADIUS_EARTH
from sailviz.recording.drawing.samples import LEAVES, TURNS, Frame, as_flown
from sailviz.run.from_arrays import trajectory

START = 7e6


def spiral(last, rows=400, days=40.0):
    """Rows of a craft on circles that grow from START to `last`, m, evenly in time; each row where Kepler has it."""
    time = np.linspace(0, days * 86400, rows)
    radius = np.linspace(START, last, rows)
    rate = np.sqrt(MU_EARTH / radius**3)
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time))])
    towards = np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    ahead = np.stack([-np.sin(angle), np.cos(angle), 0 * angle], 1)
    speed = np.sqrt(MU_EARTH / radius)[:, None] * ahead
    return trajectory(time, radius[:, None] * towards, speed, mu=MU_EARTH, body="Earth", radius=RADIUS_EARTH), angle


def test_a_craft_that_stays_is_drawn_on_a_slowed_orbit():
    run, angle = spiral(START)
    frame = Frame.of(run)
    assert frame.sparse
    assert angle[-1] / (2 * np.pi) > TURNS
    assert as_flown(frame, run) is frame


@pytest.mark.parametrize(("last", "leaves"), [(1.2 * START, False), (4 * START, True), (60 * START, True)])
def test_a_craft_that_spirals_out_is_drawn_where_it_was_once_it_makes_half_of_the_promised_turns(last, leaves):
    """The pace of the first orbit goes on over the run; what was flown is the sum of the paces of its rows."""
    run, angle = spiral(last)
    frame = Frame.of(run)
    assert frame.sparse
    flown = as_flown(frame, run)
    assert (angle[-1] / (2 * np.pi) < LEAVES * frame.turns) == leaves
    assert flown.sparse is not leaves
    if leaves:
        assert flown.slowed == frame.slowed  # all else stays


def test_rows_on_an_open_orbit_make_no_turns():
    run, _ = spiral(START)
    frame = Frame.of(run)
    rows = len(run.time)
    axis = np.where(np.arange(rows) < rows // 3, run.elements.semi_major_axis, -1e9)
    assert not as_flown(frame, replace(run, elements=replace(run.elements, semi_major_axis=axis))).sparse
