"""What a scene expects of its run is judged at the right moment, in the right unit, whole or in blocks."""

from __future__ import annotations

import numpy as np
import pytest

import sailviz
from sailviz.checks.expectations import Judge, check
from sailviz.simulation.loop import simulate, simulate_blocks

ELLIPSE = {  # a = 1 m around mu = 1 m3/s2: aphelion 1.3 at pi, perihelion 0.7 at 2 pi
    "title": "ellipse",
    "body": {"mu_m3_s2": 1.0},
    "start": {"kind": "elements", "semi_major_axis_m": 1, "eccentricity": 0.3},
    "device": {"kind": "none"},
    "event": [{"kind": "apoapsis"}, {"kind": "radius", "name": "one metre", "radius_m": 1, "sense": "up"}],
    "propagation": {"duration_s": 4 * np.pi, "outputs": 4001, "tolerance": 1e-13},
}


def verdicts(expected, blocks=None, **parts):
    scene = sailviz.load_scene({**ELLIPSE, **parts, "expect": expected})
    if blocks is None:
        return check(scene, simulate(scene))
    judge = Judge(scene)
    for block in simulate_blocks(scene, block_rows=blocks):
        judge.add(block)
    return judge.verdicts()


MET = [
    {"quantity": "radius_m", "at": "start", "value": 0.7, "within": 1e-12},
    {"quantity": "radius_m", "at": "min", "value": 0.7, "within": 1e-9},
    {"quantity": "radius_km", "at": "max", "value": 1.3e-3, "within_percent": 1e-6},
    {"quantity": "longitude_deg", "at": "end", "value": 720, "within": 1e-9},
    {"quantity": "longitude_rad", "at": "max", "value": 4 * np.pi, "within": 1e-11},
    {"quantity": "radius_m", "at_time_s": np.pi, "value": 1.3, "within": 1e-6},
    {"quantity": "time_s", "at": "apoapsis", "value": np.pi, "within": 1e-11},
    {"quantity": "radius_m", "at": "apoapsis", "value": 1.3, "within": 1e-12},
    {"quantity": "speed_m_s", "at": "apoapsis", "value": np.sqrt(0.7 / 1.3), "within": 1e-12},
    {"quantity": "time_s", "at": "one metre", "value": np.pi / 2 - 0.3, "within": 1e-11},
    {"quantity": "true_anomaly_deg", "at": "apoapsis", "value": 180, "within": 1e-8},
    {"quantity": "eccentricity", "at": "end", "value": 0.3, "within": 1e-11},
    {"quantity": "periapsis_m", "at": "end", "value": 0.7, "within": 1e-11},
    {"quantity": "apoapsis_m", "at": "end", "value": 1.3, "within": 1e-11},
    {"quantity": "energy_J_kg", "at": "max", "value": -0.5, "within": 1e-12},
    {"quantity": "angular_momentum_m2_s", "at": "end", "value": np.sqrt(0.91), "within": 1e-12},
    {"quantity": "flight_path_angle_deg", "at": "max", "value": np.degrees(np.arcsin(0.3)), "within": 2e-4},
    {"quantity": "elevation_deg", "at": "max", "value": 0, "within": 1e-12},
    {"quantity": "mass_kg", "at": "end", "value": 1, "within": 1e-12},
]
IDS = [f"{item['quantity']} at {item.get('at', 'time')}" for item in MET]


@pytest.mark.parametrize("expected", MET, ids=IDS)
def test_expectation_is_met_and_a_little_off_it_fails(expected):
    """Moving the value by more than its tolerance turns the verdict."""
    tolerance = expected.get("within") or abs(expected["value"]) * expected["within_percent"] / 100
    good, bad = verdicts([expected, expected | {"value": expected["value"] + 3 * tolerance}])
    assert good.passed, str(good)
    assert not bad.passed
    assert str(good).startswith("ok")
    assert str(bad).startswith("FAIL")


@pytest.mark.parametrize("rows", [7, 64, 1000])
def test_blocks_are_judged_as_the_whole(rows):
    """But for the interpolated time, whose neighbours may lie in two blocks."""
    expected = [item for item in MET if "at_time_s" not in item]
    whole, pieces = verdicts(expected), verdicts(expected, blocks=rows)
    assert [v.measured for v in pieces] == pytest.approx([v.measured for v in whole], rel=1e-13, abs=1e-13)


@pytest.mark.parametrize("rows", [10, 50, 100])
def test_a_time_between_two_blocks_is_found(rows):
    (verdict,) = verdicts(
        [{"quantity": "radius_m", "at_time_s": 4 * np.pi * 99.5 / 4000, "value": 0.7, "within": 0.1}], blocks=rows
    )
    assert verdict.passed, str(verdict)


def test_a_moment_that_never_came_fails_and_says_so():
    (verdict,) = verdicts(
        [{"quantity": "radius_m", "at": "far", "value": 5, "within": 1}],
        event=[{"kind": "radius", "name": "far", "radius_m": 5}],
    )
    assert not verdict.passed
    assert "never came" in str(verdict)


def test_the_first_of_several_events_counts_and_the_last_row_is_the_end():
    first, end = verdicts(
        [
            {"quantity": "time_s", "at": "apoapsis", "value": np.pi, "within": 1e-10},
            {"quantity": "time_s", "at": "end", "value": 4 * np.pi, "within": 1e-10},
        ],
        blocks=500,
    )
    assert first.passed
    assert end.passed


def test_a_tolerance_in_percent_is_of_the_value():
    verdict, other = verdicts(
        [
            {"quantity": "radius_m", "at": "max", "value": 1.287, "within_percent": 1.1},
            {"quantity": "radius_m", "at": "max", "value": 1.287, "within_percent": 1.0},
        ]
    )
    assert verdict.tolerance == pytest.approx(0.014157)
    assert verdict.passed
    assert not other.passed


def test_every_quantity_has_a_dimension_and_a_value():
    from sailviz.run.quantities import VALUES
    from sailviz.scene.quantities import DIMENSIONS

    assert list(DIMENSIONS) == list(VALUES)
