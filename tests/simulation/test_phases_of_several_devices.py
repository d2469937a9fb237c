"""Phases that switch and turn the devices of a list, against the same flight by SciPy."""

from __future__ import annotations

from copy import deepcopy
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz.constants import AU, DAY, MU_SUN, STANDARD_GRAVITY
from sailviz.errors import SceneError
from sailviz.scene.loading import load_scene
from sailviz.simulation.loop import simulate, simulate_blocks

A_C, MASS, THRUST, EXHAUST = 0.6e-3, 300.0, 0.09, STANDARD_GRAVITY * 2000
HYBRID: dict[str, Any] = {
    "title": "engine first, then the sail, then both",
    "start": {"kind": "circular", "radius_au": 1, "inclination_deg": 2},
    "device": [
        {"kind": "thruster", "name": "engine", "thrust_N": THRUST, "specific_impulse_s": 2000,
         "steering": {"kind": "tangential"}},
        {"kind": "solar-sail", "name": "sail", "area_m2": A_C * MASS / (2 * 4.563e-6), "mass_kg": MASS},
    ],
    "propagation": {"duration_d": 200, "outputs": 41, "tolerance": 1e-13},
    "phase": [
        {"name": "push off", "until": {"duration_d": 60}, "device": [{"name": "sail", "on": False}]},
        {
            "name": "sail out",
            "until": "time_d = 130",
            "steering": {"kind": "orbital", "pitch_deg": 30, "clock_deg": 90},
            "device": [{"name": "engine", "on": False}],
        },
        {
            "name": "both",
            "device": [
                {"name": "engine", "throttle": 0.5, "steering": {"kind": "inertial", "direction": [0, 0, 1]}},
                {"name": "sail", "steering": {"kind": "orbital", "pitch_deg": 20, "clock_deg": 0}},
            ],
        },
    ],
}  # fmt: skip


def sail_push(r, v, m, pitch, clock):
    """An ideal sail by its area, over the mass of the moment."""
    u = r / np.linalg.norm(r)
    h = np.cross(r, v)
    h = h / np.linalg.norm(h)
    n = np.cos(pitch) * u + np.sin(pitch) * (np.sin(clock) * np.cross(h, u) + np.cos(clock) * h)
    return A_C * MASS / m * (AU / np.linalg.norm(r)) ** 2 * np.cos(pitch) ** 2 * n


def engine_and_sail(phase, r, v, m):
    """(engine, sail) m/s2, (engine's share) in each of the three phases."""
    if phase == 0:
        return THRUST / m * v / np.linalg.norm(v), np.zeros(3), 1.0
    if phase == 1:
        return np.zeros(3), sail_push(r, v, m, np.radians(30), np.pi / 2), 0.0
    return 0.5 * THRUST / m * np.array([0.0, 0.0, 1.0]), sail_push(r, v, m, np.radians(20), 0.0), 0.5


def test_each_phase_switches_and_turns_each_device_by_its_name():
    run = simulate(deepcopy(HYBRID))
    days = run.time / DAY
    y, miss = np.concatenate([run.position[0], run.velocity[0], [MASS]]), 0.0
    for phase, (begin, end) in enumerate([(0.0, 60.0), (60.0, 130.0), (130.0, 200.0)]):

        def slope(t, y, phase=phase):
            engine, sail, share = engine_and_sail(phase, y[:3], y[3:6], y[6])
            pull = -MU_SUN * y[:3] / np.linalg.norm(y[:3]) ** 3
            return np.concatenate([y[3:6], pull + engine + sail, [-share * THRUST / EXHAUST]])

        rows = np.flatnonzero((days >= begin) & (days < end if end < 200 else days <= end))
        found = solve_ivp(
            slope, (begin * DAY, end * DAY), y, "DOP853", rtol=1e-13,
            atol=[1e-3] * 3 + [1e-10] * 3 + [1e-12], dense_output=True,
        )  # fmt: skip
        states, y = found.sol(run.time[rows]).T, found.y[:, -1]
        miss = max(miss, float(np.max(np.linalg.norm(run.position[rows] - states[:, :3], axis=1)) / AU))
        np.testing.assert_allclose(run.mass[rows], states[:, 6], rtol=1e-12)
        for row in rows:
            engine, sail, _ = engine_and_sail(phase, run.position[row], run.velocity[row], run.mass[row])
            np.testing.assert_allclose(run.devices["engine"].acceleration[row], engine, rtol=1e-11, atol=1e-18)
            np.testing.assert_allclose(run.devices["sail"].acceleration[row], sail, rtol=1e-11, atol=1e-18)
            np.testing.assert_allclose(run.thrust.acceleration[row], engine + sail, rtol=1e-11, atol=1e-18)
    assert miss < 1e-10
    np.testing.assert_array_equal(run.devices["sail"].on, days >= 60)
    np.testing.assert_array_equal(run.devices["engine"].on, (days < 60) | (days >= 130))
    assert list(run.devices) == ["engine", "sail"]


def test_events_and_phases_tell_which_device_is_switched():
    run = simulate(deepcopy(HYBRID))
    told = [(event.name, round(event.time / DAY, 6)) for event in run.events]
    assert told == [
        ("end of push off", 60.0), ("engine off", 60.0), ("sail on", 60.0),
        ("end of sail out", 130.0), ("engine on", 130.0),
    ]  # fmt: skip
    assert [phase.words for phase in run.setting.phases] == [
        "sail off",
        "orbital, engine off",
        "orbital, engine at 50 %",
    ]


def test_a_phase_of_several_devices_does_not_depend_on_blocks():
    whole = simulate(deepcopy(HYBRID))
    parts = list(simulate_blocks(deepcopy(HYBRID), block_rows=7))
    for name, told in whole.devices.items():
        np.testing.assert_array_equal(
            np.concatenate([part.devices[name].acceleration for part in parts]), told.acceleration
        )


def changed(**phase: Any) -> dict[str, Any]:
    raw = deepcopy(HYBRID)
    raw["phase"][1] |= phase
    return raw


ALONE = {**deepcopy(HYBRID), "device": {"kind": "solar-sail", "lightness_number": 0.1}}
TURN = {"kind": "orbital", "pitch_deg": 30, "clock_deg": 90}
WRONG = [
    (changed(device={"on": False}), "phase[1].device: the devices of a list are set each by its name"),
    (changed(device=[{"name": "engin"}]), 'phase[1].device[0].name: no such device "engin". Did you mean "engine"?'),
    (changed(device=[{"on": False}]), "phase[1].device[0].name: is missing."),
    (changed(device=[{"name": "sail", "throttle": 2}]), "phase[1].device[0].throttle: must be at most 1, is 2."),
    (changed(device=[{"name": "sail", "onn": True}]), "phase[1].device[0].onn: unknown key."),
    (changed(device=[{"name": "sail"}, {"name": "sail"}]), "phase[1].device[1].name: this phase says already"),
    (changed(device=[{"name": "engine", "voltage_kV": 3}]), "phase[1].device[0].voltage_kV: a thruster has no voltage"),
    (changed(device=[{"name": "sail", "steering": TURN}]), "phase[1].device[0].steering: phase[1].steering steers"),
    (
        changed(device=[{"name": "engine", "steering": {"kind": "sun-facing"}}]),
        "phase[1].device[0].steering.kind: a thruster needs a d",
    ),
    (
        changed(device=[{"name": "engine", "steering": {"kind": "locally-optimal", "goal": "energy"}}]),
        'phase[1].device[0].steering.kind: "locally-optimal" steers the first sail only',
    ),
    (changed(until={"cone_deg": 20}), "phase[1].until: cone is that of all devices together"),
    (ALONE, "phase[0].device: this scene has one device, no list [[device]]"),
]  # fmt: skip


@pytest.mark.parametrize(("raw", "words"), WRONG, ids=[words[:50] for _, words in WRONG])
def test_what_a_phase_cannot_say_of_a_device_is_told_where_it_stands(raw, words):
    with pytest.raises(SceneError) as error:
        load_scene(raw)
    told = [
        f"{fault.where}: {fault.what}" + (f" {fault.hint}" if getattr(fault, "hint", "") else "")
        for fault in error.value.faults
    ]
    assert any(one.startswith(words) for one in told), told
    assert not any("must be a table" in one for one in told)


def test_a_list_in_phases_keeps_the_identity_of_scenes_without():
    one = {
        **deepcopy(HYBRID),
        "device": {"kind": "thruster", "acceleration_mm_s2": 0.1},
        "steering": {"kind": "radial"},
    }
    one["phase"] = [{"name": "a", "until": {"duration_d": 3}, "device": {"on": False}}, {"name": "b"}]
    assert load_scene(one).resolved()["phase"][0]["device"] == {"on": False, "throttle": 1.0, "voltage": None}
