"""Rows are spread over what was flown, however the run ends, and an event that holds at the start does not happen."""

from __future__ import annotations

import numpy as np
import pytest

import sailviz
from sailviz.constants import AU, DAY
from sailviz.run.arrays import join
from sailviz.scene import load_scene
from sailviz.simulation.loop import simulate_blocks

DESCENT = {  # over in a small part of what was planned
    "title": "a descent",
    "body": "earth",
    "start": {"kind": "circular", "altitude_km": 400, "inclination_deg": 60},
    "device": {"kind": "none", "mass_kg": 1.0, "drag_area_m2": 1.0, "drag_coefficient": 2.2},
    "environment": {
        "atmosphere": {
            "kind": "exponential",
            "reference_altitude_km": 400,
            "density_kg_m3": 3e-12,
            "scale_height_km": 58,
        },
    },
    "propagation": {"duration_d": 3650, "outputs": 500},
}
OUTWARDS = {
    "title": "outwards",
    "start": {"kind": "circular", "radius_au": 1.0},
    "device": {"kind": "solar-sail", "lightness_number": 0.1},
    "steering": {"kind": "orbital", "pitch_deg": 35, "clock_deg": 90},
    "event": [{"kind": "radius", "radius_au": 1.2, "stop": True}],
    "propagation": {"duration_d": 3000, "outputs": 300},
}


@pytest.mark.parametrize("scene", [DESCENT, OUTWARDS])
def test_rows_are_spread_evenly_over_what_was_flown(scene):
    run = sailviz.simulate(scene)
    assert run.ended
    assert run.time[-1] < 0.3 * load_scene(scene).propagation.duration
    assert len(run) == scene["propagation"]["outputs"] == run.setting.rows
    assert np.diff(run.time) == pytest.approx(run.time[-1] / (len(run) - 1), rel=1e-9)
    assert run.setting.duration == run.time[-1]


@pytest.mark.parametrize("scene", [DESCENT, OUTWARDS])
def test_last_row_is_the_event_exactly(scene):
    run = sailviz.simulate(scene)
    assert run.time[-1] == run.events[-1].time
    assert np.array_equal(run.position[-1], run.events[-1].state[:3])
    assert np.array_equal(run.velocity[-1], run.events[-1].state[3:6])


def test_descent_lies_on_the_surface_in_its_last_row():
    run = sailviz.simulate(DESCENT)
    assert np.linalg.norm(run.position[-1]) == pytest.approx(run.setting.body.radius, abs=1e-3)


@pytest.mark.parametrize("scene", [DESCENT, OUTWARDS])
@pytest.mark.parametrize("block_rows", [7, 128, 299, 300, 1000])
def test_rows_do_not_depend_on_blocks(scene, block_rows):
    whole, blocks = sailviz.simulate(scene), list(simulate_blocks(load_scene(scene), block_rows=block_rows))
    assert max(map(len, blocks)) <= block_rows
    parts = join(blocks)
    for name in ("time", "position", "velocity"):
        assert np.array_equal(getattr(whole, name), getattr(parts, name))
    assert [event.time for event in whole.events] == [event.time for event in parts.events]


def test_rows_lie_on_the_trajectory_of_a_run_with_an_interval_of_its_own():
    spread = sailviz.simulate(OUTWARDS)
    interval = {**OUTWARDS, "propagation": {"duration_d": 3000, "output_interval_s": float(spread.time[1])}}
    own = sailviz.simulate(interval)
    assert own.time[-1] == spread.time[-1]
    shared = len(own) - 2  # the interval is not quite that of the spread
    away = np.linalg.norm(own.position[:shared] - spread.position[:shared], axis=1)
    assert away.max() < 1e-3  # m


def test_interval_that_a_scene_chooses_is_kept():
    run = sailviz.simulate({**OUTWARDS, "propagation": {"duration_d": 3000, "output_interval_d": 10}})
    assert np.diff(run.time[:-1]) == pytest.approx(10 * DAY)
    assert run.time[-1] == run.events[-1].time


def test_dense_windows_keep_their_interval():
    dense = [
        {"start_d": 10, "end_d": 12, "output_interval_d": 0.1},
        {"start_d": 2900, "end_d": 2950, "output_interval_d": 1},
    ]
    run = sailviz.simulate({**OUTWARDS, "propagation": {**OUTWARDS["propagation"], "dense": dense}})
    assert np.sum((run.time >= 10 * DAY) & (run.time <= 12 * DAY + 1)) >= 21
    assert run.time[-1] == run.events[-1].time
    assert len(run) < 300 + 25


def test_run_that_nothing_ends_keeps_its_rows():
    scene = {**OUTWARDS, "event": [{"kind": "radius", "radius_au": 50.0, "stop": True}]}
    run = sailviz.simulate(scene)
    assert run.time == pytest.approx(np.linspace(0, 3000 * DAY, 300), rel=1e-12)


@pytest.mark.parametrize(
    "event",
    [
        {"kind": "radius", "radius_au": 1.0},
        {"kind": "node"},
        {"kind": "periapsis"},
        {"kind": "apoapsis"},
    ],
)
@pytest.mark.parametrize("argument", [0.0, 0.3, 1.1, 2.0, 3.9, 5.5])
def test_stop_event_that_holds_at_the_start_does_not_fire_on_rounding(event, argument):
    """A coasting circle, and one turned in space so that its numbers are round nowhere."""
    start = {"kind": "elements", "semi_major_axis_au": 1.0, "eccentricity": 0.0, "inclination_deg": 0.0}
    start |= {"true_anomaly_rad": argument}
    if event["kind"] != "node":
        start |= {"inclination_deg": 33.0, "raan_rad": argument}
    scene = {
        "title": "t", "start": start, "device": {"kind": "none"}, "event": [{**event, "stop": True}],
        "propagation": {"duration_yr": 1, "outputs": 50},
    }  # fmt: skip
    run = sailviz.simulate(scene)
    assert run.ended == ""
    assert not run.events


def test_event_that_held_at_the_start_happens_when_it_comes_again():
    """An ellipse from its periapsis on: not the first, but the second ends the run, after a year."""
    start = {"kind": "elements", "semi_major_axis_au": 1.0, "eccentricity": 0.2, "true_anomaly_rad": 0.0}
    scene = {
        "title": "t", "start": start, "device": {"kind": "none"}, "event": [{"kind": "periapsis", "stop": True}],
        "propagation": {"duration_yr": 3, "outputs": 50},
    }  # fmt: skip
    run = sailviz.simulate(scene)
    turn = 2 * np.pi * np.sqrt(AU**3 / run.setting.body.mu)
    assert run.ended == "periapsis"
    assert run.time[-1] == pytest.approx(turn, rel=1e-9)
