"""Lanes of light and shadow."""

from sailviz.recording import read
from sailviz.recording.drawing.curves import Curves
from sailviz.recording.drawing.devices import CRAFT
from sailviz.recording.drawing.samples import Frame


def test_light_and_shadow_are_unknown_between_rows_far_apart(years):
    run, path = years
    lane = read(path)["/phase/sunlit"]
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
    assert curves.changes["sunlit"] == 0
    assert curves.changes["force_law_valid"] > 0


class Silent:
    """A picture that writes nothing."""

    def log_static(self, *_):
        pass

    log_columns = log_static
