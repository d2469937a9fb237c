"""Phases that do not follow each other, end nowhere or do not go together with the rest of the scene."""

from __future__ import annotations

import pytest

from sailviz.scene.loading import load_scene
from sailviz.scene.phases import scene_of
from tests.scene.small import SMALL, faults

SAIL = {
    **SMALL,
    "device": {"kind": "solar-sail", "lightness_number": 0.02},
    "propagation": {"duration_yr": 2, "outputs": 10},
}
LAST = {"name": "b"}


def first(**more):
    return {"name": "a", "until": "radius_au = 0.9", **more}


@pytest.mark.parametrize(
    ("until", "place", "words"),
    [
        ("radus_au = 1", "until", 'unknown quantity "radus_au". Did you mean "radius_au"?'),
        ("radius = 1", "until", "radius needs its unit: write one of radius_m, radius_km, radius_au"),
        ("radius_au = near", "until", '"near" is no number'),
        ("radius_au = -1", "until", "greater than 0"),
        ("saturated = 1", "until", "no function of state and time"),
        ("sunlit = 1", "until", "watch sunlit_fraction = 0.5"),
        ("time_d = 3000", "until", "not before the end of the run"),
        ("mass_kg = 3", "until", "the device gives no mass"),
        ("plasma_force_nN_m = 3", "until", "only a plasma brake has it"),
        ("halfway", "until", "no event of this scene, nor a quantity and its value"),
        ({"radius_au": 1, "speed_km_s": 3}, "until", "has radius and speed"),
        ({}, "until", "needs one quantity and its value, or duration"),
        ({"radius_au": 1, "duration_d": 3}, "until", "has radius and duration"),
        ({"radius_parsec": 1}, "until.radius_parsec", "Allowed units: radius_m"),
        ({"time_d": 3000}, "until.time_d", "not before the end of the run"),
        (3, "until", "must be text"),
    ],
)
def test_an_end_that_no_phase_can_have_is_told_at_its_place(until, place, words):
    found = faults({**SAIL, "phase": [first(until=until), LAST]})
    assert list(found) == [f"phase[0].{place}"]
    assert words in found[f"phase[0].{place}"]


@pytest.mark.parametrize(
    ("more", "place", "words"),
    [
        ({"phase": [{"name": "a"}, LAST]}, "phase[0].until", "is missing"),
        ({"phase": [first(), first(name="b")]}, "phase[1].until", "the last phase lasts until the end"),
        ({"phase": [first(), {"name": "A"}]}, "phase[1].name", 'another phase is called "A" already'),
        (
            {"phase": [first(until="time_d = 9"), first(name="c", until="time_d = 8"), LAST]},
            "phase[1].until",
            "not after",
        ),
        ({"phase": [first(device={"throttle": 2}), LAST]}, "phase[0].device.throttle", "at most 1"),
        ({"phase": [first(device={"voltage_kV": 2}), LAST]}, "phase[0].device.voltage_kV", "has no voltage"),
        ({"phase": [first(device={"onn": True}), LAST]}, "phase[0].device.onn", 'Did you mean "on"?'),
        ({"phase": [first(steering={"kind": "orbtal"}), LAST]}, "phase[0].steering.kind", 'Did you mean "orbital"?'),
        ({"phase": [first(steering={"kind": "tangential"}), LAST]}, "phase[0].steering.kind", "a thruster's law"),
        (
            {"phase": [first(steering={"kind": "spinning", "plane": "along-track"}), LAST]},
            "phase[0].steering.kind",
            "plasma-brake tether",
        ),
        (
            {"phase": [first(propagation={"outputs": 9, "output_interval_d": 1}), LAST]},
            "phase[0].propagation",
            "not both",
        ),
        (
            {"phase": [first(propagation={"output_interval_s": 0.1}), LAST]},
            "phase[0].propagation.output_interval_s",
            "limits.rows allows",
        ),
        (
            {"phase": [first(until="stop"), LAST], "event": [{"name": "stop", "kind": "node", "stop": True}]},
            "phase[0].until",
            "stops the run",
        ),
        (
            {
                "phase": [first(), LAST],
                "expect": [{"quantity": "radius_au", "at": "end of b", "value": 1, "within": 1}],
            },
            "expect[0].at",
            'Did you mean "end of a"?',
        ),
        (
            {"phase": [first(), LAST], "approximation": [{"kind": "first-order"}]},
            "approximation[0]",
            "goes with no [[phase]]",
        ),
        (
            {
                "phase": [first(), LAST],
                "environment": {"irradiance": {"kind": "cycle", "seed": 1}},
                "ensemble": [{"name": "many"}],
            },
            "ensemble[0]",
            "fly scenes without [[phase]]",
        ),
        (
            {
                "phase": [first(), LAST],
                "device": {
                    "kind": "electric-sail",
                    "characteristic_acceleration_mm_s2": 1,
                    "control": {"kind": "pressure"},
                },
                "environment": {"solar_wind": {"kind": "gamma", "shape": 2, "scale_nPa": 1, "seed": 1}},
            },
            "device.control",
            "no phase hands on",
        ),
    ],
)
def test_what_goes_with_no_phase_is_told_at_its_place(more, place, words):
    found = faults({**SAIL, **more})
    assert place in found, found
    assert words in found[place]


def test_values_of_a_phase_can_be_put_over_those_of_the_file():
    scene = load_scene({**SAIL, "phase": [first(steering={"kind": "orbital", "pitch_deg": 35}), LAST]})
    other = load_scene(scene, {"phase.0.steering.pitch_deg": 20, "phase.0.until": {"time_d": 9}})
    assert other.phase[0].steering.pitch == pytest.approx(0.3490658503988659)
    assert other.phase[0].until.time == 9 * 86400
    assert other.identity() != scene.identity()


def test_a_scene_without_phases_is_what_it_was():
    assert "phase" not in load_scene(SAIL).resolved()


def test_a_phase_without_steering_flies_that_of_the_scene():
    steering = {"kind": "orbital", "pitch_deg": 35}
    scene = load_scene({**SAIL, "steering": steering, "phase": [first(steering={"kind": "radial"}), LAST]})
    assert [scene_of(scene, phase).steering.kind for phase in scene.phase] == ["radial", "orbital"]


def test_a_fault_in_a_later_table_stands_at_its_line():
    text = """title = "lines"
[start]
kind = "circular"
radius_au = 1
[device]
kind = "solar-sail"
lightness_number = 0.02
[propagation]
duration_d = 9
[[phase]]
name = "a"
until = "radius_au = 0.9"
[[phase]]
name = "b"
[phase.steering]
kind = "orbital"
pitch_deg = 200
"""
    import tomllib

    from sailviz.errors import SceneError
    from sailviz.scene.loading import build_scene

    with pytest.raises(SceneError) as caught:
        build_scene(tomllib.loads(text), {}, text, "lines")
    assert [(fault.where, fault.line) for fault in caught.value.faults] == [("phase[1].steering.pitch_deg", 17)]
