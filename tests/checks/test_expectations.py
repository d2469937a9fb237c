"""What a scene expects of its run is judged at the right moment, in the right unit, whole or in blocks."""

from __future__ import annotations

import numpy as np
import pytest

import sailviz
from sailviz.checks.expectations import Judge, Verdict, check
from sailviz.errors import SceneError
from sailviz.run.quantities import circular_mean
from sailviz.simulation.loop import simulate, simulate_blocks

ELLIPSE = {  # a = 1 m around mu = 1 m3/s2: aphelion 1.3 at pi, perihelion 0.7 at 2 pi
    "title": "ellipse",
    "body": {"mu_m3_s2": 1.0},
    "start": {"kind": "elements", "semi_major_axis_m": 1, "eccentricity": 0.3},
    "device": {"kind": "none", "mass_kg": 7},
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
    {"quantity": "mass_kg", "at": "end", "value": 7, "within": 1e-12},
]
IDS = [f"{item['quantity']} at {item.get('at', 'time')}" for item in MET]


def test_a_mass_that_nobody_gave_cannot_be_expected():
    asked = [{"quantity": "mass_kg", "at": "end", "value": 1, "within": 1e-12}]
    with pytest.raises(SceneError, match="the device gives no mass"):
        sailviz.load_scene({**ELLIPSE, "device": {"kind": "none"}, "expect": asked})


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


# ---------------------------------------------------------------- angles on a circle
TILTED = {"start": {**ELLIPSE["start"], "inclination_deg": 20, "raan_deg": 359.99, "argument_deg": 75}}


def measured(quantity, at, value=0.0, within=1.0, **parts):
    when = {"at": at} if isinstance(at, str) else {"at_time_s": at}
    (verdict,) = verdicts([{"quantity": quantity, **when, "value": value, "within": within}], **parts)
    return verdict


@pytest.mark.parametrize("value", [-0.01, 359.99, 719.99, -360.01])
def test_an_expected_angle_counts_modulo_a_turn(value):
    verdict = measured("raan_deg", "end", value, 1e-6, **TILTED)
    assert verdict.passed, str(verdict)
    assert abs(verdict.off) < 1e-6


def test_an_angle_just_short_of_a_turn_is_close_to_zero_and_off_by_the_short_way():
    verdict = measured("true_anomaly_deg", "start", 0.0, 0.05, start={**ELLIPSE["start"], "true_anomaly_deg": 359.9916})
    assert verdict.passed
    assert verdict.off == pytest.approx(-0.0084, abs=1e-9)
    assert "off by -0.0084" in str(verdict)
    far = measured("true_anomaly_deg", "start", 180.0, 0.05, start={**ELLIPSE["start"], "true_anomaly_deg": 359.0})
    assert not far.passed
    assert abs(far.off) == pytest.approx(179.0)


def test_longitude_counts_revolutions_and_is_on_no_circle():
    assert not measured("longitude_deg", "end", 0.0, 1.0).passed


def past_periapsis(degrees, outputs=1001):
    """The ellipse from as long before its periapsis as after it, a true anomaly of so many degrees at either end."""
    eccentric = 2 * np.arctan(np.sqrt(0.7 / 1.3) * np.tan(np.radians(degrees) / 2))
    span = 2 * (eccentric - 0.3 * np.sin(eccentric))
    return {
        "start": {**ELLIPSE["start"], "true_anomaly_deg": 360 - degrees},
        "propagation": {"duration_s": span, "outputs": outputs, "tolerance": 1e-13},
    }


def test_the_mean_of_an_angle_is_that_of_its_directions():
    """Equal times on either side of periapsis average to periapsis, 0 and not 180 deg; over a whole revolution the
    mean unit vector has the length e and points to apoapsis."""
    verdict = measured("true_anomaly_deg", "mean", 0.0, 1e-5, **past_periapsis(90))
    assert verdict.passed, str(verdict)
    turn = {"duration_s": 2 * np.pi, "outputs": 1001, "tolerance": 1e-13}
    apoapsis = measured("true_anomaly_deg", "mean", 180.0, 1e-4, propagation=turn)
    assert apoapsis.passed, str(apoapsis)


def test_angles_that_go_all_round_have_no_mean():
    assert np.isnan(circular_mean(1e-9, -1e-9, 360.0))
    assert circular_mean(0.0, -0.5, 360.0) == 270.0
    assert "all round" in str(Verdict("true_anomaly_deg", "mean", 0.0, 1.0, np.nan, 360.0))


@pytest.mark.parametrize("blocks", [None, 7])
def test_the_drift_of_an_angle_is_its_largest_arc_whatever_it_starts_from(blocks):
    """From 340 deg over 0 to 20 deg are 40 deg; in blocks as in one piece."""
    expected = [{"quantity": "true_anomaly_deg", "at": "drift", "value": 40, "within": 1e-6}]
    (verdict,) = verdicts(expected, blocks, **past_periapsis(20, outputs=101))
    assert verdict.passed, str(verdict)


def test_an_angle_between_two_rows_is_interpolated_the_short_way():
    """Rows at 350 and 10 deg: 0 deg between them, not 180."""
    parts = past_periapsis(10, outputs=2)
    verdict = measured("true_anomaly_deg", parts["propagation"]["duration_s"] / 2, 0.0, 1e-6, **parts)
    assert verdict.passed, str(verdict)


def test_a_steering_clock_of_minus_90_deg_is_one_of_270_deg():
    scene = {
        "title": "t",
        "start": {"kind": "circular", "radius_au": 1},
        "device": {"kind": "solar-sail", "lightness_number": 0.05},
        "steering": {"kind": "orbital", "pitch_deg": 35, "clock_deg": -90},
        "propagation": {"duration_d": 10, "outputs": 5},
        "expect": [{"quantity": "clock_deg", "at": at, "value": -90, "within": 1e-6} for at in ("end", "mean", "max")],
    }
    loaded = sailviz.load_scene(scene)
    assert all(verdict.passed for verdict in check(loaded, simulate(loaded)))
