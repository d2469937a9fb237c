"""Lanes of light and shadow, and bands of what swings within a revolution."""

from dataclasses import replace

import numpy as np

from sailviz.recording import read, record
from sailviz.recording.drawing.curves import Curves, Swing
from sailviz.recording.drawing.devices import CRAFT
from sailviz.recording.drawing.samples import Frame
from sailviz.recording.timelines import take


def test_light_and_shadow_are_unknown_between_rows_far_apart(years, tmp_path):
    whole, _ = years
    run = take(whole, slice(380, 460))  # into the dense window
    run = replace(run, setting=replace(whole.setting, rows=len(run)))
    record(run, tmp_path / "part.rrd")
    lane = read(tmp_path / "part.rrd")["/light"]
    states, step = lane["state"], lane.timeline("step")
    for state, row in zip(states, step, strict=True):
        gap = run.time[row] - run.time[max(row - 1, 0)]
        known = "on" if run.environment["sunlit"][row] else "off"
        assert state == ("unknown" if gap > 3600 else known)
    assert {"on", "off", "unknown"} == set(states)


def test_a_lane_of_light_is_left_out_where_all_rows_are_far_apart(runs, low_orbit):
    run = low_orbit.with_everything(runs.descent(rows=200, days=300.0))
    curves = Curves(Silent(), run, Frame.of(run), CRAFT[run.setting.craft.kind])
    curves.add(run)
    lanes = curves.write_lanes()
    assert "/light" not in lanes
    assert "/force_law_valid" in lanes


def test_a_band_does_not_depend_on_the_blocks_in_which_its_values_came():
    values = np.random.default_rng(4).normal(size=(1000, 2))
    values[::7, 1] = np.nan
    place = np.minimum(np.arange(1000) // 30, 31)
    whole, pieces = Swing.of(32, 2), Swing.of(32, 2)
    whole.add(place, values)
    for start in range(0, 1000, 77):
        pieces.add(place[start : start + 77], values[start : start + 77])
    assert np.array_equal(whole.low, pieces.low)
    assert np.array_equal(whole.high, pieces.high)
    assert np.array_equal(whole.count, pieces.count)
    assert np.allclose(whole.total, pieces.total, rtol=1e-13)
    assert whole.low[3, 0] == values[place == 3, 0].min()
    assert whole.high[5, 1] == np.nanmax(values[place == 5, 1])


class Silent:
    """A picture that writes nothing."""

    def log_static(self, *_):
        pass

    log_columns = log_static


def test_of_a_vector_that_is_asked_for_what_is_rounding_is_not_shown(runs, tmp_path):
    run = runs.displaced(rows=60)
    turn = np.linspace(0.0, 20.0, 60)
    columns = {"light_torque_x_N_m": 1e-19 * np.sin(turn), "light_torque_y_N_m": 1e-6 * np.cos(turn)}
    setting = replace(run.setting, plots=("light_torque",))
    record(replace(run, environment=columns, setting=setting), tmp_path / "torques.rrd")
    shown = [name for name in read(tmp_path / "torques.rrd").entities if name.startswith("/plots/light_torque")]
    assert shown == ["/plots/light_torque_y_N_m"]
