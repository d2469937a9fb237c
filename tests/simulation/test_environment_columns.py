"""What is recorded of the surroundings says what acted."""

from __future__ import annotations

import numpy as np
import pytest

import sailviz
from sailviz.constants import AU, RADIUS_EARTH

RADIUS_SUN = 695.7e6
SHADED = {
    "title": "through the shadow",
    "body": "earth",
    "start": {"kind": "circular", "altitude_km": 20000, "inclination_deg": 10},
    "device": {"kind": "none"},
    "environment": {"shadow": "cone", "sun_right_ascension_deg": 0},
    "propagation": {"duration_h": 12, "output_interval_s": 5},
}


def seen_by_squares(position, sun):
    """Share of the Sun's disc that is seen, by counting 4 million little squares of it; flat discs."""
    to_sun = sun * AU - position
    a, b = np.arcsin(RADIUS_SUN / np.linalg.norm(to_sun)), np.arcsin(RADIUS_EARTH / np.linalg.norm(position))
    u, w = to_sun / np.linalg.norm(to_sun), -position / np.linalg.norm(position)
    apart = np.arctan2(np.linalg.norm(np.cross(u, w)), u @ w)
    x = (np.arange(2000) + 0.5) / 1000 - 1
    x, y = np.meshgrid(a * x, a * x)
    disc = x * x + y * y < a * a
    return 1 - np.mean(((x - apart) ** 2 + y * y < b * b)[disc])


def test_a_conical_shadow_records_the_share_of_the_sun_that_is_seen():
    run = sailviz.simulate(SHADED)
    lit, fraction = run.environment["sunlit"], run.environment["sunlit_fraction"]
    assert lit.dtype == bool
    assert np.array_equal(lit, fraction > 0.5)
    assert fraction.min() == 0.0
    assert fraction.max() == 1.0
    half = np.flatnonzero((fraction > 0) & (fraction < 1))
    assert len(half) > 15  # some ten seconds at each side
    tilt = np.radians(23.439)
    for row in half[::4]:
        longitude = 2 * np.pi * run.time[row] / (365.25 * 86400)
        sun = np.array([np.cos(longitude), np.sin(longitude) * np.cos(tilt), np.sin(longitude) * np.sin(tilt)])
        assert fraction[row] == pytest.approx(seen_by_squares(run.position[row], sun), abs=2e-3)


def test_a_cylinder_has_no_share():
    around = SHADED["environment"] | {"shadow": "cylinder"}
    assert "sunlit_fraction" not in sailviz.simulate(SHADED | {"environment": around}).environment


def test_the_share_of_the_sun_is_a_quantity_that_can_be_expected():
    asked = {"quantity": "sunlit_fraction", "at": "min", "value": 0.0, "within": 1e-12}
    scene = sailviz.load_scene(SHADED | {"expect": [asked]})
    from sailviz.checks.expectations import check

    assert all(verdict.passed for verdict in check(scene, sailviz.simulate(scene)))
