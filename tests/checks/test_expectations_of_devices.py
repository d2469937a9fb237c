"""What is expected of one device in a list."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import sailviz
from sailviz.checks import check
from sailviz.constants import AU
from sailviz.errors import SceneError
from sailviz.recording.views.info import expectation

SAIL = {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 0.5}
DRIVE = {"kind": "thruster", "name": "drive", "acceleration_mm_s2": 0.2, "active_d": [[10, 60]]}


def expected(**more: Any) -> dict[str, Any]:
    return {"quantity": "thrust_acceleration_mm_s2", "at": "end", "value": 0.5, "within": 1e-9} | more


def scene(*expect: dict[str, Any], devices: int = 2) -> dict[str, Any]:
    listed: Any = [SAIL, {**DRIVE, "steering": {"kind": "tangential"}}]
    return {
        "title": "a sail and a drive",
        "start": {"kind": "circular", "radius_au": 1.0},
        "device": listed if devices == 2 else SAIL,
        "propagation": {"duration_d": 100, "outputs": 101},
        "expect": list(expect),
    }


def test_each_device_is_held_to_its_own_share() -> None:
    loaded = sailviz.load_scene(
        scene(
            expected(device="solar-sail", at="start"),
            expected(device="drive", at="start", value=0.0),
            expected(device="drive", at="max", value=0.2),
            {k: v for k, v in expected(device="drive", at_time_d=30, value=0.2).items() if k != "at"},
            expected(device="drive", at="drive on", value=0.2),
            expected(at="start"),
        )
    )
    run = sailviz.simulate(loaded)
    verdicts = check(loaded, run)
    assert [verdict.passed for verdict in verdicts] == [True] * 6
    assert verdicts[1].quantity == "thrust_acceleration_mm_s2 of drive"
    wrong = sailviz.load_scene(scene(expected(device="drive", at="max", value=0.5)))
    (verdict,) = check(wrong, run)
    assert not verdict.passed
    assert verdict.measured == pytest.approx(0.2, rel=1e-12)
    whole = run.thrust.magnitude
    assert not np.allclose(whole, 0.5e-3 * (AU / np.linalg.norm(run.position, axis=1)) ** 2)


def test_what_is_expected_of_a_device_is_told_of_the_recording() -> None:
    told = sailviz.load_scene(scene(expected(device="drive"))).resolved()["expect"][0]
    assert expectation(told) == "thrust_acceleration_mm_s2 of drive at end: 0.5 within 1e-09"
    assert "device" not in sailviz.load_scene(scene(expected())).resolved()["expect"][0]


@pytest.mark.parametrize(
    ("raw", "words"),
    [
        (scene(expected(device="drvie")), 'no such device "drvie". Did you mean "drive"?'),
        (scene(expected(device="drive", quantity="radius_au")), "of one device is known: thrust_acceleration"),
        (scene(expected(device="solar-sail"), devices=1), "names one of a list of devices"),
    ],
)
def test_a_share_of_what_is_not_there_is_refused(raw: dict[str, Any], words: str) -> None:
    with pytest.raises(SceneError) as error:
        sailviz.load_scene(raw)
    assert words in str(error.value)
