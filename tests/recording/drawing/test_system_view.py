"""Trail and arrows of the system view."""

from dataclasses import replace

import numpy as np

from sailviz.constants import DAY
from sailviz.frames import rtn, unit
from sailviz.recording import read, record
from sailviz.recording.drawing.samples import Frame


def test_a_trail_over_a_gap_follows_the_orbit_and_not_a_chord(runs, tmp_path, low_orbit):
    close = np.arange(600) * 60.0
    time = np.concatenate([close, close[-1] + 2400 + close, close[-1] + 40 * DAY + close])
    run = runs.descent(time=time)
    run = replace(run, setting=replace(run.setting, duration=2 * DAY))  # so that it counts as close rows
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
    recording = read(tmp_path / "still.rrd")
    assert np.abs(np.asarray(recording["/world/craft/velocity/arrow"]["vectors"], float)).max() == 0
    assert all(len(place) == 0 for place in recording["/sail/velocity/name"]["positions"])


def test_a_primer_vector_is_an_arrow_of_its_own(runs, tmp_path):
    run = runs.spiral(rows=40)
    primer = unit(run.velocity + 0.3 * unit(run.position) * np.linalg.norm(run.velocity, axis=1, keepdims=True))
    record(replace(run, environment={"primer_direction": primer}), tmp_path / "run.rrd")
    recording = read(tmp_path / "run.rrd")
    drawn = np.asarray(recording["/world/craft/primer/arrow"]["vectors"], float)
    assert np.abs(drawn - primer).max() < 1e-6
    near = np.asarray(recording["/sail/primer"]["vectors"], float)
    in_frame = np.einsum("nji,nj->ni", rtn(run.position, run.velocity), primer)
    assert np.abs(unit(near) - in_frame).max() < 1e-6
