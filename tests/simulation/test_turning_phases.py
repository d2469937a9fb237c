"""Craft that turn, in phases: let go and held again, by other controllers, their motion handed on."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz import frames
from sailviz.errors import SceneError
from sailviz.run.quantities import VALUES
from sailviz.scene.loading import load_scene
from sailviz.simulation import simulate

WHEELS = {"kind": "wheels", "torque_mN_m": 2, "storage_mN_m_s": 900}
SLIDE = {"kind": "sliding-mass", "mass_kg": 6, "travel_m": 0.2, "speed_m_s": 0.001}
HELD = {"kind": "pd", "frequency_rad_s": 5e-3}


def scene(phases, *actuators, **attitude):
    return {
        "title": "held, let go, held again",
        "start": {"kind": "circular", "radius_au": 1},
        "device": {
            "kind": "solar-sail",
            "mass_kg": 14,
            "film": "jpl-2015",
            "back": "same",
            "shape": {"kind": "square", "side_m": 9, "cells": 2},
        },
        "steering": {"kind": "orbital", "pitch_deg": 20, "clock_deg": 90},
        "attitude": {
            "kind": "controlled",
            "inertia_kg_m2": [60, 62, 115],
            "centre_of_mass_m": [0.02, -0.01, 0.3],
            "control": HELD,
            "actuators": list(actuators) or [WHEELS],
        }
        | attitude,
        "propagation": {"duration_h": 2, "outputs": 61, "tolerance": 1e-11},
        "phase": phases,
    }


@pytest.fixture(scope="module")
def flown():
    """Held for 40 min, let go for 40, then held harder towards the Sun."""
    again = {"kind": "controlled", "control": {"kind": "pd", "frequency_rad_s": 1e-2, "damping": 0.7}}
    phases = [
        {"name": "held", "until": {"duration_min": 40}},
        {"name": "let go", "until": {"duration_min": 40}, "attitude": {"kind": "free"}},
        {"name": "held again", "attitude": again, "steering": {"kind": "orbital", "pitch_deg": 0}},
    ]
    return simulate(scene(phases))


def test_what_is_let_go_drifts_by_what_turns_it_and_its_wheels_keep_their_momentum(flown):
    """The momentum that is recorded, wheels among it, changes by the torques that are recorded, Simpson's rule; while
    it is let go those of light and gravity alone."""
    free = (flown.time >= 2400) & (flown.time < 4800)
    rows = np.flatnonzero(free)[: 2 * (free.sum() // 2) - 1]
    wheels = flown.attitude.motion["wheels_N_m_s"]
    assert np.abs(wheels[rows] - wheels[rows[0]]).max() < 1e-15
    assert np.linalg.norm(wheels[rows[0]]) > 0.02
    axes = frames.rotation(flown.attitude.quaternion[rows])
    torque = sum(
        np.stack([flown.environment[f"{kind}_torque_{axis}_N_m"][rows] for axis in "xyz"], -1)
        for kind in ("light", "gravity")
    )
    inertial, h = frames.from_frame(axes, torque), flown.time[rows[1]] - flown.time[rows[0]]
    whole = h / 3 * (inertial[0] + 4 * inertial[1:-1:2].sum(0) + 2 * inertial[2:-1:2].sum(0) + inertial[-1])
    momentum = flown.attitude.motion["angular_momentum_N_m_s"][rows]
    assert momentum[-1] - momentum[0] == pytest.approx(whole, abs=1e-4 * np.linalg.norm(whole))
    body = flown.attitude.motion["rate_rad_s"][rows] * [60, 62, 115] + wheels[rows]
    assert frames.from_frame(axes, body) == pytest.approx(momentum, abs=1e-14)
    assert np.isnan(flown.environment["control_torque_y_N_m"][rows]).all()
    assert np.degrees(flown.attitude.pitch[rows[-1]]) > 30  # from the 20 deg that it was held at


def test_each_phase_follows_its_own_steering_by_its_own_controller(flown):
    held, again = np.searchsorted(flown.time, [2399, 7199])
    assert np.degrees(flown.attitude.pitch[held]) == pytest.approx(20, abs=2)
    assert np.degrees(flown.attitude.pitch[again]) == pytest.approx(0, abs=1)
    assert [event.name for event in flown.events if "end" in event.name] == ["end of held", "end of let go"]


def test_phases_that_change_nothing_fly_as_one_flight_does():
    whole = simulate(scene([]))
    parts = simulate(scene([{"name": "one", "until": {"duration_min": 37}}, {"name": "two"}]))
    there = np.isin(parts.time, whole.time)
    assert parts.time[there] == pytest.approx(whole.time)
    for value in ("pitch", "body_rate", "wheel_momentum"):
        a, b = VALUES[value](whole), VALUES[value](parts)[there]
        assert b == pytest.approx(a, abs=1e-9 * np.abs(a).max())
    turned = np.abs(np.sum(whole.attitude.quaternion * parts.attitude.quaternion[there], axis=1))
    assert turned.min() > 1 - 1e-14


def test_a_mass_that_nothing_slides_any_more_stays_where_it_was():
    phases = [{"name": "trimmed", "until": {"duration_min": 50}}, {"name": "let go", "attitude": {"kind": "free"}}]
    run = simulate(scene(phases, SLIDE, centre_of_mass_m=[0.02, 0, -0.3]))
    later = run.time >= 3000
    slid = np.stack([run.environment[f"slide_{axis}_m"] for axis in "xy"], -1)
    assert np.abs(slid[later] - slid[later][0]).max() < 1e-15
    assert np.linalg.norm(slid[later][0]) > 0.01
    row = np.flatnonzero(later)[3]
    axes = frames.rotation(run.attitude.quaternion[row])
    force = 14 * axes.T @ run.thrust.acceleration[row]
    centre = np.array([0.02, 0, -0.3]) + 6 / 14 * np.array([*slid[row], 0])
    torque = [run.environment[f"light_torque_{axis}_N_m"][row] for axis in "xyz"]
    assert torque == pytest.approx(-np.cross(centre, force), abs=1e-12)


@pytest.mark.parametrize(
    ("phase", "place", "words"),
    [
        ({"attitude": {"kind": "free"}, "steering": {"kind": "sun-facing"}}, "phase[1].steering.kind", "nothing foll"),
        ({"attitude": {"kind": "free", "control": HELD}}, "phase[1].attitude", "belong to kind"),
        ({"attitude": {"kind": "controlled", "control": {"kind": "spin-axis"}}}, "phase[1].attitude", "spin-axis"),
    ],
)
def test_a_phase_that_turns_nothing_is_refused_where_it_says_so(phase, place, words):
    with pytest.raises(SceneError) as caught:
        load_scene(scene([{"name": "held", "until": {"duration_min": 40}}, {"name": "then"} | phase]))
    assert [fault.where for fault in caught.value.faults] == [place]
    assert words in caught.value.faults[0].what


def test_vanes_are_not_let_go_and_a_craft_that_its_steering_holds_is_not_either():
    vane = {"kind": "vane", "position_m": [5, 0, 0], "area_m2": 1}
    phases = [{"name": "held", "until": {"duration_min": 40}}, {"name": "let go", "attitude": {"kind": "free"}}]
    with pytest.raises(SceneError, match="vane"):
        load_scene(scene(phases, WHEELS, vane))
    given = scene(phases)
    given["attitude"] = {"kind": "prescribed", "inertia_kg_m2": [60, 62, 115]}
    with pytest.raises(SceneError, match="stands as its steering says"):
        load_scene(given)
