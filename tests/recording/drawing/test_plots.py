"""Which curves a run has, and their ranges."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sailviz.recording.drawing.devices import CRAFT
from sailviz.recording.drawing.plots import nice_range, plots_of
from sailviz.recording.drawing.samples import Frame


@given(st.floats(-1e6, 1e6), st.floats(1e-9, 1e6), st.floats(2, 12))
def test_a_range_holds_its_data_and_leaves_no_more_than_half_empty(low, span, numbers):
    bottom, top = nice_range(low, low + span, numbers)
    assert bottom < low
    assert low + span < top
    if span > 1e-2 * max(abs(low), abs(low + span)):
        assert top - bottom < 5 * span


def test_altitudes_of_perigee_and_apogee_and_the_analytic_decay_share_a_plot(years):
    run, _ = years
    (plot,) = (p for p in plots_of(run, Frame.of(run), CRAFT[run.setting.craft.kind]) if p.path == "/plots/altitude")
    assert plot.names == ("perigee", "apogee", "mean", "analytic decay")
    perigee, apogee, mean, analytic = plot.values(run).T
    e = run.elements
    assert np.allclose(0.5 * (perigee + apogee), mean)
    assert np.allclose(apogee - perigee, 2e-3 * e.semi_major_axis * e.eccentricity, atol=1e-9)
    assert np.allclose(analytic - mean, 2.0)
    paths = {p.path for p in plots_of(run, Frame.of(run), CRAFT[run.setting.craft.kind])}
    assert not paths & {"/plots/primer_direction", "/plots/earth_rotation_rad", "/plots/sunlit"}
