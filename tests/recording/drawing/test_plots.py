"""Which curves a run has, which of them are shown, and their ranges."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailviz.recording.drawing.devices import CRAFT
from sailviz.recording.drawing.plot_column import corner, merged, multiples, nice_range, score
from sailviz.recording.drawing.plots import plots_of
from sailviz.recording.drawing.samples import Frame


@given(st.floats(-1e6, 1e6), st.floats(1e-9, 1e6), st.integers(3, 12))
def test_a_range_holds_its_data_and_has_two_to_so_many_numbers_on_its_axis(low, span, most):
    bottom, top = nice_range(low, low + span, most)
    assert bottom < low
    assert low + span < top
    if span > 1e-2 * max(abs(low), abs(low + span)):
        counts = [multiples(bottom, top, 10.0**power) for power in range(-12, 9)]
        assert any(2 <= count <= most + 1 for count in counts)
        assert top - bottom < 25 * span


def test_altitudes_of_perigee_and_apogee_and_the_analytic_decay_share_a_plot(years):
    run, _ = years
    (plot,) = (p for p in plots_of(run, Frame.of(run), CRAFT[run.setting.craft.kind]) if p.path == "/plots/altitude")
    assert plot.names == ("altitude", "lowest", "highest", "closed form")
    mean, perigee, apogee, analytic = plot.values(run).T
    e = run.elements
    assert np.allclose(0.5 * (perigee + apogee), mean)
    assert np.allclose(apogee - perigee, 2e-3 * e.semi_major_axis * e.eccentricity, atol=1e-9)
    assert np.allclose(analytic - mean, 2.0)
    paths = {p.path for p in plots_of(run, Frame.of(run), CRAFT[run.setting.craft.kind])}
    assert not paths & {"/plots/primer_direction", "/plots/earth_rotation_rad", "/plots/sunlit"}


def test_what_is_flat_to_two_per_cent_is_not_worth_a_plot():
    wave = np.sin(np.linspace(0, 20, 500))
    assert score(1.0 + 0.009 * wave, natural=-0.5, bonus=1.3) == 0
    assert score(1.0 + 0.02 * wave, natural=-0.5, bonus=1.3) > 0
    assert score(np.full(9, np.nan), natural=1.0, bonus=1.0) == 0
    assert score(10 * wave, natural=40.0, bonus=1.0) == pytest.approx(0.5, rel=0.01)


def test_curves_that_coincide_are_one_with_a_joint_name():
    time = np.linspace(0, 1, 200)
    values = np.stack([time, time + 0.014, time**2, np.full(200, np.nan)], 1)
    assert merged(("a", "b", "c", "d"), values) == [("a = b", 0), ("c", 2)]


def test_the_legend_stands_where_no_curve_comes():
    rising, falling = np.linspace(0, 1, 100), np.linspace(1, 0, 100)
    assert corner([rising], 0, 1) in ("LeftTop", "RightBottom")
    assert corner([falling], 0, 1) in ("RightTop", "LeftBottom")
