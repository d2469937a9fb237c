"""How fast a replay runs, and what the cameras see."""

from dataclasses import replace

import numpy as np
import pytest

from sailviz.frames import unit
from sailviz.recording import record
from sailviz.recording.drawing import cameras, drawing
from sailviz.recording.drawing.blueprint import blueprint


@pytest.mark.parametrize("asked", [25.0, None])
@pytest.mark.parametrize("end", [1.0, 0.4])
def test_a_replay_lasts_as_long_as_asked_for_or_as_the_guide_says(runs, end, asked, tmp_path, monkeypatch, low_orbit):
    shown = []
    monkeypatch.setattr(drawing, "blueprint", lambda given: shown.append(given) or blueprint(given))
    run = runs.descent(time=low_orbit.uneven(days=100.0, far=100, close=100))
    run = replace(run, setting=replace(run.setting, duration=run.time[-1] / end, play_duration=asked))
    record(run, tmp_path / "run.rrd")
    assert run.time[-1] / shown[-1].speed == pytest.approx(asked or 40.0)


def flight_round(turns, lean, count=200):
    """Normals, thrusts, places and shares of a flat film leaning `lean` rad off the ray."""
    angle = np.linspace(0, 2 * np.pi * turns, count)
    places = np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    ahead = np.stack([-np.sin(angle), np.cos(angle), 0 * angle], 1)
    normals = np.cos(lean) * places + np.sin(lean) * ahead
    return normals, places, np.linspace(0, 1, count)


@pytest.mark.parametrize("lean", np.radians([-60, -35, 20, 35, 50]))
@pytest.mark.parametrize("turns", [0.6, 0.9, 1.2])
def test_a_slow_sweep_sees_the_gold_side_of_a_film_three_quarters_of_the_time(turns, lean):
    normals, places, shares = flight_round(turns, lean)
    moments = cameras.Moments(normals, normals, places, shares, np.ones(len(shares)))
    going = cameras.sweep(moments, True, 38.0)
    azimuth = np.arctan2(going.eye[1], going.eye[0]) + going.turn * shares
    eyes = cameras.direction(azimuth, np.radians(38.0))
    gold = -np.sum(eyes * normals, 1) > 0.3
    assert gold.mean() >= 0.75
    assert abs(going.turn) <= np.radians(440.1)


def test_everything_fits_into_a_view_and_fills_it():
    places = np.random.default_rng(3).normal(size=(50, 3))
    eye = unit(np.array([0.1, -0.9, 0.4]))
    at, target = cameras.fit(places, eye, 1.7, 0.9)
    camera = cameras.Camera("Flight", "/", tuple(at), tuple(target))
    seen = np.abs(cameras.on_screen(places, camera, 1.7))
    assert seen.max() == pytest.approx(0.9, rel=1e-6)
    assert np.allclose(unit(at - target), eye)


def test_names_of_things_in_one_line_of_sight_are_kept_apart():
    spots = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    up = np.array([[0.0, 0.0, 1.0]])
    eye = cameras.fixed_eye(up, up, np.ones(1), False, (4.0,), spots=spots)
    assert abs(eye[0]) < np.cos(np.radians(14.0))
