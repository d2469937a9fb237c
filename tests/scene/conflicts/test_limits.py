"""What would fill memory or disk is counted and refused before it is asked for, and a key of [limits] allows it."""

from __future__ import annotations

import pytest

from sailviz.errors import SceneError
from sailviz.scene.loading import load_scene

BASE = {
    "title": "t",
    "start": {"kind": "circular", "radius_au": 1},
    "device": {"kind": "electric-sail", "characteristic_acceleration_mm_s2": 1},
    "propagation": {"duration_d": 100, "outputs": 10},
}
SAIL = {"kind": "solar-sail", "lightness_number": 0.05}
GAMMA = {"kind": "gamma", "shape": 2.0, "scale_nPa": 1.0, "seed": 3}
CONSTANT = {**GAMMA, "variation": "constant"}
DENSE = [{"start_d": 1, "end_d": 50, "output_interval_s": 1e-7}]
TRACK = {
    "start": {"kind": "planet-following", "semi_major_axis_au": 0.01, "eccentricity": 0, "elevation_deg": 2},
    "device": {"kind": "electric-sail", "characteristic_acceleration": "as designed"},
    "steering": {"kind": "as designed"},
    "propagation": {"duration_yr": 290},
}
SMOOTHED = {"kind": "smoothed-transfer", "radius_au": 1.5, "costates": [1, 0.1, 1], "hold_s": 1e-3}
DRAWN = {"solar_wind": {**GAMMA, "redraw_s": 0.1}}
CONTROLLED = {"name": "m", "flights": 1_000_000, "control": {"kind": "pressure"}}
EXPANDED = {"name": "m", "order": 5, "control": {"kind": "pressure", "interval_s": 0.01}}
OFTEN = {"duration_d": 1, "output_interval_s": 1e-4}
ASKED = [  # scene, place, number, key of [limits]
    ({"propagation": OFTEN}, "propagation.output_interval_s", 864_000_001, "rows"),
    ({"propagation": {"duration_d": 1, "outputs": 20_000_000}}, "propagation.outputs", 20_000_000, "rows"),
    ({"propagation": {"duration_d": 100, "dense": DENSE}}, "propagation.dense", 42_336_000_000_001, "rows"),
    ({"environment": DRAWN}, "environment.solar_wind.redraw_s", 86_400_000, "draws"),
    (
        {"device": SAIL, "environment": {"irradiance": {"kind": "cycle", "redraw_s": 0.1}}},
        "environment.irradiance.redraw_s",
        86_400_000,
        "draws",
    ),
    (
        {"device": {**BASE["device"], "control": {"kind": "pressure", "interval_s": 0.1}}},
        "device.control.interval_s",
        86_400_000,
        "draws",
    ),
    (
        {"environment": {"solar_wind": GAMMA}, "ensemble": [CONTROLLED]},
        "ensemble[0]",
        2_400_000_000,
        "changes",
    ),
    (
        {"environment": {"solar_wind": CONSTANT}, "chaos": [EXPANDED]},
        "chaos[0]",
        5_184_000_000,
        "changes",
    ),
    ({"steering": SMOOTHED}, "steering.hold_s", 8_640_000_000, "steps"),
    (
        {"approximation": [{"kind": "first-order", "leg_deg": 1e-6}]},
        "approximation[0].leg_deg",
        98_560_000,
        "steps",
    ),
    (TRACK, "propagation.duration_yr", 208_800_000, "steps"),
]  # fmt: skip


@pytest.mark.parametrize(("parts", "place", "number", "limit"), ASKED, ids=[f"{ask[1]}" for ask in ASKED])
def test_too_much_is_refused_with_its_number_and_allowed_by_its_limit(parts, place, number, limit):
    with pytest.raises(SceneError) as caught:
        load_scene({**BASE, **parts})
    (what,) = [fault.what for fault in caught.value.faults if f"limits.{limit} allows" in fault.what]
    assert [fault.where for fault in caught.value.faults] == [place]
    told = float(what.split("asks for ")[1].split(" ")[0].replace(",", ""))
    assert told == pytest.approx(number, rel=1e-3)
    if number < 1e9 or limit == "changes":
        assert load_scene({**BASE, **parts, "limits": {limit: int(number * 1.1)}}).limits


def test_dense_windows_count_together():
    """Six of two million rows each are twelve."""
    window = {"start_d": 0, "end_d": 2, "output_interval_s": 0.0864}
    with pytest.raises(SceneError, match="12,000,0"):
        load_scene({**BASE, "propagation": {"duration_d": 100, "dense": [window] * 6}})
    assert load_scene({**BASE, "propagation": {"duration_d": 100, "dense": [window] * 4}})


def test_limits_are_no_part_of_what_is_flown():
    one, other = load_scene(BASE), load_scene({**BASE, "limits": {"rows": 77}})
    assert one.identity() == other.identity()
    assert "limits" not in one.resolved()


def test_more_than_numbers_can_hold_is_endlessly_many():
    with pytest.raises(SceneError, match="endlessly many rows"):
        load_scene({**BASE, "propagation": {"duration_yr": 200, "output_interval_s": 5e-324}})
