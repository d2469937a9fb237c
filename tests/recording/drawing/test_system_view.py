"""Trail, arrows and what is left out where it would say nothing."""

from dataclasses import replace

import numpy as np

from sailviz.constants import DAY
from sailviz.frames import rtn, unit
from sailviz.recording import read, record
from sailviz.recording.drawing.samples import Frame


def test_a_trail_over_a_gap_follows_the_orbit_and_not_a_chord(runs, tmp_path, low_orbit):
    close = np.arange(600) * 600.0
    time = np.concatenate([close, close[-1] + 24_000 + close, close[-1] + 400 * DAY + close])
    run = runs.descent(time=time, high=22e6, low=20e6)
    run = replace(run, setting=replace(run.setting, duration=20 * DAY))  # so that it counts as close rows
    assert not Frame.of(run).sparse
    record(run, tmp_path / "gap.rrd")
    strips = read(tmp_path / "gap.rrd")["/world/trail/recent"]["strips"]
    nearest = np.inf
    for row in strips:
        for strip in row if np.ndim(row[0]) > 1 else [row]:
            points = np.array([np.asarray(point, float) for point in strip])
            middle = 0.5 * (points[1:] + points[:-1])
            nearest = min(nearest, np.linalg.norm(middle, axis=1).min())
    lowest = np.linalg.norm(run.position, axis=1).min() / low_orbit.RADIUS
    assert nearest > lowest * np.cos(np.radians(2.6))  # the middle of a chord of 5 degrees and no longer


def test_a_craft_that_stands_still_has_no_arrow_of_velocity(runs, tmp_path):
    run = runs.displaced(rows=30)
    still = replace(run, velocity=1e-6 * run.velocity / np.linalg.norm(run.velocity, axis=1, keepdims=True))
    record(still, tmp_path / "still.rrd")
    assert not {"/sail/velocity", "/sail/velocity_name"} & set(read(tmp_path / "still.rrd").entities)


def test_nothing_of_a_push_is_drawn_where_nothing_pushes(runs, tmp_path):
    run = runs.displaced(rows=60)
    zero = np.zeros_like(run.thrust.acceleration)
    thrust = replace(run.thrust, acceleration=zero, acceleration_rtn=zero, magnitude=zero[:, 0], on=np.zeros(60, bool))
    record(replace(run, thrust=thrust), tmp_path / "run.rrd")
    entities = read(tmp_path / "run.rrd").entities
    assert not [name for name in entities if "push" in name.split("/")[1:3] or name.startswith("/world/fence")]
    assert "/plots/push" not in entities


def test_a_primer_vector_is_an_arrow_only_where_the_scene_is_about_it(runs, tmp_path):
    run = runs.spiral(rows=40)
    primer = unit(run.velocity + 0.3 * unit(run.position) * np.linalg.norm(run.velocity, axis=1, keepdims=True))
    run = replace(run, environment={"primer_direction": primer})
    record(run, tmp_path / "run.rrd")
    assert "/sail/primer" not in read(tmp_path / "run.rrd").entities
    record(replace(run, setting=replace(run.setting, about="What the primer says.")), tmp_path / "about.rrd")
    near = np.asarray(read(tmp_path / "about.rrd")["/sail/primer"]["vectors"], float)
    in_frame = np.einsum("nji,nj->ni", rtn(run.position, run.velocity), primer)
    assert np.abs(unit(near) - in_frame).max() < 1e-6
