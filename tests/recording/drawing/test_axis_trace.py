"""The sphere of directions of craft that turn: when it is there, and what it claims between rows."""

import numpy as np
import pytest

import sailviz
from sailviz.frames import rotation, unit
from sailviz.recording.drawing import axis_trace
from tests.recording.truth.picture import Picture

RATES = "attitude.rates_deg_s"


def recorded(folder, **changes):
    given = {"propagation.outputs": 41, "propagation.duration_h": 4} | changes
    run = sailviz.simulate(sailviz.load_scene("body/swinging-pyramid", given))
    sailviz.record(run, folder / "turns.rrd")
    return run, Picture(folder / "turns.rrd")


def test_between_rows_in_which_a_craft_has_turned_over_no_way_of_its_axis_is_made_up(tmp_path):
    run, picture = recorded(tmp_path, **{RATES: [3.0, 2.0, 1.0]})
    axis = rotation(run.attitude.quaternion)[..., 2]
    assert picture.archetypes("/axis/trace/past") == {"Points3D"}
    steps, dots = picture.rows("/axis/trace/past", "Points3D:positions")
    assert np.concatenate(dots) == pytest.approx(axis, abs=1e-6)
    assert steps[-1] == len(run) - 1


def test_an_axis_that_stays_has_no_sphere(tmp_path):
    _, picture = recorded(tmp_path, **{"attitude.pitch_deg": 0.2})
    assert not any(entity.startswith("/axis") for entity in picture.entities)


def test_the_sphere_is_in_front_of_a_flight_of_hours_alone(tmp_path):
    _, picture = recorded(tmp_path)
    first = [view.name for view in picture.views if view.kind == "3D"]
    assert axis_trace.WORD in first
    assert "Flight" in first


def test_an_arc_between_two_directions_is_the_short_one_and_ends_at_both():
    ends = unit(np.array([[1.0, 0.2, 0.1], [-0.3, 1.0, 0.5]]))
    arc = axis_trace.arcs(ends)
    assert arc[[0, -1]] == pytest.approx(ends, abs=1e-15)
    assert np.linalg.norm(arc, axis=1) == pytest.approx(1.0, abs=1e-15)
    steps = np.arccos(np.sum(arc[1:] * arc[:-1], axis=1))
    assert steps.sum() == pytest.approx(np.arccos(ends[0] @ ends[1]), rel=1e-12)
