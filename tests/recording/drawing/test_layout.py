"""How fast a replay runs, and what the cameras see."""

from dataclasses import replace

import numpy as np
import pytest

from sailviz.frames import unit
from sailviz.recording import record
from sailviz.recording.drawing import drawing, layout
from sailviz.recording.drawing.blueprint import blueprint
from sailviz.recording.drawing.devices import CRAFT
from sailviz.recording.drawing.samples import Frame, Samples


@pytest.mark.parametrize("end", [1.0, 0.4])
def test_a_replay_lasts_as_long_as_asked_for(runs, end, tmp_path, monkeypatch, low_orbit):
    shown = []
    monkeypatch.setattr(drawing, "blueprint", lambda given: shown.append(given) or blueprint(given))
    run = runs.descent(time=low_orbit.uneven(days=100.0, far=100, close=100))
    run = replace(run, setting=replace(run.setting, duration=run.time[-1] / end, play_duration=25.0))
    record(run, tmp_path / "run.rrd")
    assert run.time[-1] / shown[-1].speed == pytest.approx(25.0)


@pytest.mark.parametrize("pitch", np.radians([-60, -35, 0, 20, 35, 50]))
def test_the_view_along_with_a_sail_sees_its_sunward_side(runs, pitch):
    run = runs.spiral(rows=3, pitch=pitch)
    eye = unit(layout.follow_eye(Samples.of(run, np.arange(3), Frame.of(run)), CRAFT["solar-sail"]))
    normal = np.array([np.cos(pitch), -np.sin(pitch), 0.0])
    assert -(eye @ normal) > 0.3


def test_the_ends_of_arrows_are_in_sight():
    places = np.random.default_rng(3).normal(size=(50, 3))
    target, direction = np.array([0.1, -0.2, 0.0]), unit(np.array([0.1, -0.9, 0.4]))
    distance = layout.distance_to_see(places, target, direction)
    right = unit(np.cross([0, 0, 1.0], direction))
    up = np.cross(direction, right)
    depth = distance - (places - target) @ direction
    seen = np.maximum(np.abs((places - target) @ up) / 0.47, np.abs((places - target) @ right) / 0.95) / depth
    assert seen.max() == pytest.approx(1.0)
