"""Bodies that pull and are passed closely: what collocation and DOP853 miss there, and that the better is chosen."""

from __future__ import annotations

import numpy as np
import pytest
from independent.under_sky import DE421

import sailviz

# Begun so that the nearest point is 5,000 km from the Moon's centre on day 3.2 of 6.5, at 900 m/s far away, and 10,000
# km from that of Venus on day 40 of 80, at 4 km/s
MOON = {
    "body": "earth",
    "frame": "icrf",
    "start": {
        "kind": "cartesian",
        "position_m": [-2198187.6361306403, -13744754.435910005, -6473329.158955502],
        "velocity_m_s": [6786.63419419457, -2018.1351294140845, 139.34528942551376],
    },
    "environment": {"gravity_of": ["moon", "sun"]},
}
VENUS = {
    "body": "sun",
    "start": {
        "kind": "cartesian",
        "position_m": [72762796902.1144, 52807125165.48575, -2515290148.3501306],
        "velocity_m_s": [-17349.208963544515, 35039.839184518845, 1400.854855066445],
    },
    "environment": {"gravity_of": ["venus", "earth"]},
}


def fly(scene, days, middle, integrator, tolerance):
    run = {"duration_d": days, "outputs": 60, "tolerance": tolerance, "integrator": integrator}
    run["dense"] = [{"start_d": middle - 0.05, "end_d": middle + 0.05, "output_interval_min": 1}]
    given = {"title": "a close pass", "device": {"kind": "none"}, **scene, **DE421, "propagation": run}
    return sailviz.simulate(given)


@pytest.mark.parametrize(
    ("scene", "name", "days", "middle", "nearest"), [(MOON, "Moon", 6.5, 3.2, 5000), (VENUS, "Venus", 80, 40, 10_000)]
)
def test_collocation_passes_bodies_as_closely_as_its_tolerance_says_and_is_chosen(scene, name, days, middle, nearest):
    """Against DOP853 at 1e-13, which errs by 50 m after Venus: rounding of places counted from the Sun, which the pass
    magnifies. DOP853 errs twice as much as collocation at equal tolerance, or more."""
    pytest.importorskip("jplephem")
    pytest.importorskip("skyfield_data")
    truth = fly(scene, days, middle, "dop853", 1e-13)
    away = np.linalg.norm(truth.position - truth.bodies[name], axis=1).min()
    assert away / 1e3 == pytest.approx(nearest, rel=1e-3)

    def error(integrator, tolerance):
        found = fly(scene, days, middle, integrator, tolerance)
        return (np.linalg.norm(found.position - truth.position, axis=1) / np.linalg.norm(truth.position, axis=1)).max()

    assert error("collocation", 1e-10) < 1e-9
    for tolerance in (1e-9, 1e-10):
        assert error("collocation", tolerance) < 0.5 * error("dop853", tolerance)
    chosen = fly(scene, days, middle, "auto", 1e-10)
    assert "collocation" in chosen.setting.accuracy
    assert np.array_equal(chosen.position, fly(scene, days, middle, "collocation", 1e-10).position)
