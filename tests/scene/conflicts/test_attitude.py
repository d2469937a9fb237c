"""What an attitude does not go together with is told where it stands, all faults at once."""

from __future__ import annotations

import copy

import pytest

from sailviz.errors import SceneError
from sailviz.scene.loading import load_scene

SAIL = {
    "title": "turns",
    "start": {"kind": "circular", "radius_au": 1},
    "device": {
        "kind": "solar-sail",
        "mass_kg": 14,
        "film": "jpl-2015",
        "back": "same",
        "shape": {"kind": "square", "side_m": 9},
    },
    "attitude": {"kind": "free", "inertia_kg_m2": [60, 62, 115]},
    "propagation": {"duration_h": 1},
}
WHEELS = {"kind": "wheels", "torque_mN_m": 1, "storage_mN_m_s": 15}
HELD = {
    "kind": "controlled",
    "inertia_kg_m2": [60, 62, 115],
    "control": {"kind": "pd", "frequency_rad_s": 2e-3},
    "actuators": [WHEELS],
}


def scene(**parts):
    made = copy.deepcopy(SAIL)
    for name, part in parts.items():
        made[name] = {**made.get(name, {}), **part} if isinstance(part, dict) and name != "attitude" else part
    return made


def faults(given):
    with pytest.raises(SceneError) as told:
        load_scene(given)
    return {fault.where: f"{fault.what} {fault.hint}" for fault in told.value.faults}


def attitude(**parts):
    return {**SAIL["attitude"], **parts}


@pytest.mark.parametrize(
    ("given", "place", "words"),
    [
        ({"attitude": attitude(kind="freee")}, "attitude.kind", "not a kind"),
        ({"attitude": attitude(inertia_kg_m2=[1, 2, 4])}, "attitude", "one moment is larger than the two others"),
        ({"attitude": attitude(inertia_kg_m2=[0, 2, 2])}, "attitude", "positive moments"),
        ({"attitude": attitude(inertia_kg_m2=[1, 2])}, "attitude", "three principal moments"),
        ({"attitude": attitude(inertia_kg_m2=[[3, 1, 0], [0, 3, 0], [0, 0, 3]])}, "attitude", "symmetric"),
        ({"attitude": attitude(inertia_kg_m2=[[1, 0, 0], [0, 1, 0], [0, 0, 3]])}, "attitude", "of no body"),
        ({"attitude": {"kind": "free"}}, "attitude", "exactly one of inertia or film_mass"),
        ({"attitude": attitude(film_mass_kg=2)}, "attitude", "exactly one of inertia or film_mass"),
        ({"attitude": {"kind": "free", "film_mass_kg": 20}}, "attitude.film_mass_kg", "more than the whole"),
        ({"attitude": attitude(quaternion=[0, 0, 0, 0])}, "attitude", "must not be zero"),
        ({"attitude": attitude(quaternion=[0, 0, 0, 1], pitch_deg=3)}, "attitude", "leave pitch out"),
        ({"attitude": attitude(kind="spin-averaged", spin_rpm=0)}, "attitude", "must not be 0"),
        (
            {"attitude": {"kind": "spin-averaged", "inertia_kg_m2": [60, 70, 115], "spin_rpm": 1}},
            "attitude",
            "differ by more than 5 %",
        ),
        ({"steering": {"kind": "sun-facing"}}, "steering.kind", "nothing follows it"),
        ({"attitude": HELD}, "attitude.control", "follows a steering"),
        (
            {"attitude": {**HELD, "actuators": []}, "steering": {"kind": "sun-facing"}},
            "attitude.actuators",
            "needs 1 or more",
        ),
        (
            {"attitude": {**HELD, "actuators": [WHEELS, WHEELS]}, "steering": {"kind": "sun-facing"}},
            "attitude",
            "several of kind wheels",
        ),
        (
            {"attitude": {**HELD, "control": {"kind": "spin-axis"}}, "steering": {"kind": "sun-facing"}},
            "attitude",
            "that of switched reflectivity",
        ),
        ({"device": {"roll_deg": 3}}, "device.roll_deg", "attitude.roll"),
        ({"device": {"drag_area": "attitude"}}, "device.drag_area", "give an area"),
        ({"propagation": {"integrator": "collocation"}}, "propagation.integrator", "dop853"),
        ({"approximation": [{"kind": "first-order"}]}, "approximation[0]", "an analytic solution knows"),
        (
            {"phase": [{"name": "a", "until": "time_d = 0.01"}, {"name": "b", "attitude": {"kind": "controlled"}}]},
            "phase[1].attitude",
            "needs control",
        ),
        ({"expect": [{"quantity": "wheel_momentum_N_m_s", "at": "end", "value": 1, "within": 1}]}, "expect[0].quantity",
         "belongs to actuators"),
        ({"expect": [{"quantity": "air_torque_N_m", "at": "max", "value": 1, "within": 1}]}, "expect[0].quantity",
         "whose shape air pushes"),
    ],
)  # fmt: skip
def test_what_an_attitude_does_not_go_together_with_is_said_where_it_stands(given, place, words):
    found = faults(scene(**given))
    assert words in found.get(place, ""), found


def test_all_faults_are_told_at_once():
    other = {"integrator": "collocation"}
    found = faults(scene(steering={"kind": "sun-facing"}, propagation=other, device={"roll_deg": 1}))
    assert {"steering.kind", "propagation.integrator", "device.roll_deg"} <= set(found)


def test_a_sail_that_turns_needs_a_shape_and_a_tether_has_none():
    flat = scene()
    flat["device"] = {"kind": "solar-sail", "mass_kg": 14, "area_m2": 86, "film": "jpl-2015"}
    assert "also of a flat sail" in faults(flat)["device.shape"]
    thruster = scene(steering={"kind": "tangential"})
    thruster["device"] = {"kind": "thruster", "acceleration_mm_s2": 1}
    assert "solar sail with a shape" in faults(thruster)["device.kind"]
    listed = scene()
    sail = {"name": "sail", "kind": "solar-sail", "mass_kg": 14, "area_m2": 86, "steering": {"kind": "sun-facing"}}
    engine = {"name": "engine", "kind": "thruster", "acceleration_mm_s2": 1, "steering": {"kind": "tangential"}}
    listed["device"] = [sail, engine]
    assert "in no list of several" in faults(listed)["attitude.kind"]


def test_only_a_craft_that_turns_has_a_body_rate():
    leans = {"quantity": "nutation_deg", "at": "end", "value": 0, "within": 1}
    still = scene(event=[{"body_rate_deg_s": 1}], expect=[leans])
    del still["attitude"]
    found = faults(still)
    assert "belongs to a craft that turns" in found["event[0].body_rate_deg_s"]
    assert "belongs to a craft that turns" in found["expect[0].quantity"]


def test_an_attitude_that_is_not_said_leaves_identities_as_they_were():
    still = scene()
    del still["attitude"]
    assert "attitude" not in load_scene(still).resolved()
    assert load_scene(still).identity() != load_scene(scene()).identity()
