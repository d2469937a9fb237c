"""A list of devices: what goes together on one craft, where each fault stands, and what is written by its place."""

from __future__ import annotations

from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest

from sailviz.errors import SceneError
from sailviz.scene.loading import load_scene, schema
from sailviz.scene.show import resolved_lines

SAIL: dict[str, Any] = {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 0.5}
THRUSTER: dict[str, Any] = {"kind": "thruster", "acceleration_mm_s2": 0.1, "steering": {"kind": "tangential"}}


def scene(*devices: Any, **more: Any) -> dict[str, Any]:
    return deepcopy(
        {
            "title": "several devices",
            "start": {"kind": "circular", "radius_au": 1.0},
            "device": list(devices),
            "propagation": {"duration_d": 100, "outputs": 11},
        }
        | more
    )


def faults(raw: dict[str, Any], **values: Any) -> list[str]:
    with pytest.raises(SceneError) as error:
        load_scene(raw, values)
    return [f"{fault.where}: {fault.what}" for fault in error.value.faults]


def test_a_list_of_devices_is_accepted_in_any_order() -> None:
    for devices in ((SAIL, THRUSTER), (THRUSTER, SAIL)):
        found = load_scene(scene(*devices))
        assert found.device.kind == "solar-sail"
        assert [device.kind for device in found.devices] == [device["kind"] for device in devices]
        assert [device["kind"] for device in found.resolved()["device"]] == [device["kind"] for device in devices]


BRAKE = {"kind": "plasma-brake", "mass_kg": 10, "tether_length_m": 100}
OWN = {"kind": "tangential"}
WRONG = [
    (scene(SAIL, BRAKE), "device[1].kind: a brake stands alone: no other device goes with it"),
    (scene(BRAKE, SAIL), "device[0].kind: a brake stands alone: no other device goes with it"),
    (scene(SAIL, {"kind": "none"}), 'device[1].kind: "none" is no device beside others: leave it out'),
    (scene(SAIL, SAIL), "device[1]: needs a steering of its own"),
    (scene({**THRUSTER, "thrust_N": -1}, SAIL), "device[0].thrust_N: must be greater than 0 N, is -1."),
    (scene(SAIL, {**THRUSTER, "acceleration": 1}), "device[1].acceleration: needs its unit in the key."),
    (scene(SAIL, {**THRUSTER, "speed": 1}), "device[1].speed: unknown key."),
    (scene({"kind": "rocket"}, SAIL), 'device[0].kind: "rocket" is not a kind of device[0].'),
    (scene(SAIL, {**THRUSTER, "name": "solar sail"}), 'device[1].name: another device is called "solar sail" already'),
    (scene({**SAIL, "mass_kg": 5}, {**THRUSTER, "mass_g": 5}), "device[1].mass_g: a craft has one mass"),
    (scene(SAIL, {**THRUSTER, "drag_area_m2": 5}), "device[1].drag_area_m2: the whole craft has one drag_area"),
    (
        scene(SAIL, {**THRUSTER, "steering": {"kind": "locally-optimal", "goal": "energy"}}),
        'device[1].steering.kind: "locally-optimal" steers the first sail only',
    ),
    (
        scene(SAIL, {**THRUSTER, "steering": {"kind": "tangent"}}),
        'device[1].steering.kind: "tangent" is not a kind of device[1].steering.',
    ),
    (scene(SAIL, {**SAIL, "steering": OWN}), 'device[1].steering.kind: "tangential" is a thruster\'s law'),
    (
        scene(THRUSTER, {**THRUSTER, "steering": {"kind": "sun-facing"}}),
        "device[1].steering.kind: a thruster needs a d",
    ),
    (
        scene(SAIL, {**SAIL, "steering": {"kind": "sun-facing", "in_shadow": "hold"}}),
        "device[1].steering.in_shadow: belongs to the first sail",
    ),
    (
        scene({**SAIL, "steering": {"kind": "sun-facing"}}, THRUSTER, steering={"kind": "sun-facing"}),
        "steering: device[0] has a steering of its own",
    ),
    (scene(SAIL, THRUSTER, ensemble=[{"name": "a"}]), "ensemble[0]: an ensemble flies one device"),
    (
        scene(SAIL, THRUSTER, approximation=[{"kind": "first-order"}]),
        "approximation[0]: an analytic solution knows one device",
    ),
    (
        scene(SAIL, THRUSTER, start={"kind": "displaced", "radius_au": 0.9, "elevation_deg": 10, "rate_ratio": 1}),
        "start.kind: displaced",
    ),
    (
        scene({**SAIL, "characteristic_acceleration": "as designed"} | {}, THRUSTER),
        "device[0].characteristic_acceleration",
    ),
    (scene(SAIL, THRUSTER, propagation={"duration_d": 9, "integrator": "gauss-jackson"}), ""),
    (scene(), "device: lists no device"),
    (scene(SAIL, 7), "device[1]: must be a table"),
    (scene(SAIL, THRUSTER) | {"beside": []}, "beside: unknown key."),
]
WRONG = [(raw, words) for raw, words in WRONG if words]  # the integrator is the plan's business


@pytest.mark.parametrize(("raw", "words"), WRONG, ids=[words[:40] for _, words in WRONG])
def test_what_does_not_go_together_is_told_where_it_stands(raw: dict[str, Any], words: str) -> None:
    if words.startswith("device[0].characteristic"):
        del raw["device"][0]["characteristic_acceleration_mm_s2"]
    assert any(fault.startswith(words) for fault in faults(raw)), faults(raw)


def test_all_thrusters_together_may_not_burn_the_whole_mass() -> None:
    thruster = {"kind": "thruster", "thrust_N": 1, "specific_impulse_s": 300, "mass_kg": 2800}
    pair = scene({**thruster}, {**thruster, "steering": OWN}, steering=OWN)
    del pair["device"][1]["mass_kg"]
    told = faults(pair)
    assert len(told) == 1
    assert "burn the whole mass in 47." in told[0]  # days: m g0 Isp / 2 N
    load_scene(pair, {"propagation.duration_d": 47})
    load_scene(pair, {"device.1.active_d": [[0, 20]], "propagation.duration_d": 70})
    assert faults(pair, **{"device.1.active_d": [[0, 20]], "propagation.duration_d": 80})


def test_thrusters_that_a_phase_switches_off_burn_nothing_in_it() -> None:
    thruster = {"kind": "thruster", "thrust_N": 1, "specific_impulse_s": 300, "mass_kg": 2800}
    pair = scene(thruster, {**thruster, "steering": OWN}, steering=OWN)
    del pair["device"][1]["mass_kg"]
    off = [{"name": "thruster 2", "on": False}]
    first, last = {"name": "both", "until": "duration_d = 20"}, {"name": "one", "device": off}
    load_scene({**pair, "phase": [first, last]}, {"propagation.duration_d": 74})  # 20 d of both and 55.3 of one are all
    assert "burn the whole mass in 75." in faults({**pair, "phase": [first, last]})[0]
    load_scene({**pair, "phase": [{**first, "until": "radius_au = 2"}, last]}, {"propagation.duration_d": 94})


def test_the_mass_is_that_of_the_craft_whoever_gives_it() -> None:
    sail = {"kind": "solar-sail", "area_m2": 1000}
    found = load_scene(scene(sail, {**sail, "steering": {"kind": "sun-facing"}}, {**THRUSTER, "mass_kg": 90}))
    assert [device.mass for device in found.devices] == [90.0] * 3
    assert [device.name for device in found.devices] == ["solar-sail", "solar-sail 2", "thruster"]


def test_values_are_set_by_the_place_in_the_list() -> None:
    found = load_scene(scene(THRUSTER, SAIL), {"device.0.acceleration_mm_s2": 3, "device.1.active_d": [[1, 2]]})
    assert found.devices[0].acceleration == pytest.approx(3e-3)
    assert found.device.active == [[86400.0, 172800.0]]
    assert found.with_values({"device.0.acceleration_mm_s2": 4}).devices[0].acceleration == pytest.approx(4e-3)
    assert faults(scene(THRUSTER, SAIL), **{"device.2.thrust_N": 3}) == [
        "device.2.thrust_N: no such place in the scene"
    ]


def test_faults_have_the_lines_of_their_own_tables(tmp_path: Path) -> None:
    text = """title = "lines"
propagation = {duration_d = 10}
start = {kind = "circular", radius_au = 1}
[[device]]
kind = "thruster"
acceleration_mm_s2 = 0.1
[device.steering]
kind = "inertial"
direction = [0, 0, 0]
[[device]]
kind = "solar-sail"
lightness_number = -1
"""
    (tmp_path / "s.toml").write_text(text)
    with pytest.raises(SceneError) as error:
        load_scene(tmp_path / "s.toml")
    assert [(fault.where, fault.line) for fault in error.value.faults] == [
        ("device[1].lightness_number", 12),
        ("device[0].steering", 7),
    ]


def test_every_device_is_shown_at_its_place() -> None:
    lines = resolved_lines(load_scene(scene(THRUSTER, SAIL)))
    assert "device[0].steering.kind = 'tangential'" in lines
    assert any(line.startswith("device[1].characteristic_acceleration = 0.0005") for line in lines)
    assert not any(line.startswith("device.") for line in lines)


def test_the_schema_takes_a_table_or_a_list() -> None:
    device = schema()["properties"]["device"]["anyOf"]
    assert device[1]["type"] == "array"
    assert device[1]["items"] == device[0]


def test_identities_of_scenes_with_one_device_know_nothing_of_lists() -> None:
    one = load_scene("displaced/circular")
    assert one.place is None
    assert "name" not in one.resolved()["device"]


@pytest.mark.parametrize("event", [{"cone_deg": 20}, {"thrust_acceleration_mm_s2": 1}])
def test_no_event_watches_the_first_device_alone_in_the_name_of_all(event) -> None:
    told = faults({**scene(SAIL, THRUSTER), "event": [{"radius_au": 1.1}, event]})
    assert len(told) == 1
    assert told[0].startswith(f"event[1].{next(iter(event))}: ")
    assert "of all devices together" in told[0]
    load_scene({**scene(SAIL, THRUSTER), "event": [{"pitch_deg": 20}]})
