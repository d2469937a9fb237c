"""Spans without data: between which rows they lie, and that nothing is read off inside."""

import numpy as np

from sailviz.run import gaps
from sailviz.run.resample import at, cost

TIME = np.array([0.0, 1, 2, 3, 7, 8, 9, 10, 11, 12, 13, 14])
SILENCE = ((3.5, 6.0),)


def test_a_gap_lies_after_the_last_row_before_it_also_where_rows_are_left_out():
    assert gaps.last_rows(TIME, SILENCE).tolist() == [3]
    assert gaps.last_rows(TIME[::2], SILENCE).tolist() == [1]
    assert gaps.last_rows(TIME[4:], SILENCE).tolist() == []
    assert gaps.last_rows(TIME, ()).tolist() == []
    assert gaps.pieces(TIME, SILENCE) == [slice(0, 4), slice(4, 12)]
    assert gaps.inside(np.array([3.5, 5.0, 6.0]), SILENCE).tolist() == [False, True, False]


def test_nothing_is_read_off_across_a_gap_and_each_side_by_its_own_rows():
    values = np.where(TIME < 5, TIME**3, -5.0)  # another flight after the gap
    times = np.array([2.5, 3.0, 4.0, 6.9, 7.0, 7.5])
    found = at(times, "speed_m_s", TIME, values, {}, SILENCE)
    assert np.array_equal(np.isnan(found), [False, False, True, True, False, False])
    assert found[0] == 17.5
    assert found[-1] == -5.0
    smooth = at(np.array([2.5, 7.5]), "velocity_m_s", TIME, values, {}, SILENCE)
    assert smooth[0] == 2.5**3
    assert abs(smooth[1] + 5) < 1e-12
    assert at(np.array([4.0]), "sunlit", TIME, TIME < 5, {}, SILENCE)[0]


def test_the_cost_of_interpolation_is_not_that_of_a_gap():
    values = np.where(TIME < 5, TIME, TIME + 1e6)
    assert cost("height_m", TIME, values) > 1e3
    assert cost("height_m", TIME, values, None, SILENCE) < 1e-9
