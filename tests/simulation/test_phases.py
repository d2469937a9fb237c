"""A flight in phases against the same flight chained by hand: each phase a scene of its own, begun where the one before
had ended."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.checks.expectations import check
from sailviz.constants import AU, DAY
from sailviz.scene.loading import load_scene
from sailviz.simulation.loop import simulate, simulate_blocks

INWARDS = {"kind": "locally-optimal", "goal": "energy", "sense": "decrease"}
CRANK = {"kind": "locally-optimal", "goal": "inclination"}
SAIL = {
    "title": "inwards, then up",
    "start": {"kind": "circular", "radius_au": 1, "inclination_deg": 2},
    "device": {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 1.0},
    "propagation": {"duration_d": 500, "outputs": 50, "tolerance": 1e-12},
    "phase": [
        {"name": "in", "until": "radius_au = 0.48", "steering": INWARDS},
        {"name": "crank", "until": {"inclination_deg": 12, "sense": "up"}, "steering": CRANK},
        {"name": "rest", "device": {"on": False}},
    ],
}


def without_phases(**more):
    return {**{name: value for name, value in SAIL.items() if name != "phase"}, **more}


def begun_at(state):
    return {"kind": "cartesian", "position_m": state[:3].tolist(), "velocity_m_s": state[3:6].tolist()}


def chained():
    """(end time s, state (6,)) of each phase, flown by itself."""
    start, time, found = SAIL["start"], 0.0, []
    for steering, event, device in (
        (INWARDS, {"radius_au": 0.48}, {}),
        (CRANK, {"inclination_deg": 12, "sense": "up"}, {}),
        ({"kind": "sun-facing"}, {"time_d": 1e4}, {"active_d": [[4000, 4001]]}),
    ):
        left = SAIL["propagation"]["duration_d"] - time / DAY
        scene = without_phases(
            start=start,
            steering=steering,
            device={**SAIL["device"], **device},
            event=[{**event, "stop": True, "name": "over"}],
            propagation={**SAIL["propagation"], "duration_d": left},
        )
        run = simulate(scene)
        time += run.time[-1]
        state = np.concatenate([run.position[-1], run.velocity[-1]])
        found.append((time, state))
        start = begun_at(state)
    return found


@pytest.fixture(scope="module")
def flight():
    return simulate(SAIL)


def test_phases_fly_as_flights_that_take_over_from_each_other(flight):
    """To 1e-10 of the distance, in time and place, at both switches and at the end."""
    by_hand = chained()
    events = {event.name: event for event in flight.events}
    for name, (time, state) in zip(("end of in", "end of crank"), by_hand, strict=False):
        assert events[name].time == pytest.approx(time, rel=1e-10)
        assert np.allclose(events[name].state[:3], state[:3], rtol=0, atol=1e-10 * AU)
    assert flight.time[-1] == pytest.approx(by_hand[-1][0], rel=1e-12)
    assert np.allclose(flight.position[-1], by_hand[-1][1][:3], rtol=0, atol=1e-10 * AU)
    assert np.allclose(flight.velocity[-1], by_hand[-1][1][3:], rtol=1e-10, atol=1e-6)


def test_a_phase_ends_exactly_at_its_value_and_its_row_is_the_first_of_the_next(flight):
    first, second, third = flight.setting.phases
    assert (first.start, second.start, third.start) == (0.0, first.end, second.end)
    assert third.end == flight.time[-1]
    for phase, value, quantity in (
        (second, 0.48 * AU, lambda i: np.linalg.norm(flight.position[i])),
        (third, np.radians(12), lambda i: flight.elements.inclination[i]),
    ):
        row = int(np.searchsorted(flight.time, phase.start))
        assert flight.time[row] == phase.start
        assert quantity(row) == pytest.approx(value, rel=1e-11)
    numbers = flight.setting.phase_of(flight.time)
    assert np.array_equal(numbers, np.searchsorted([second.start, third.start], flight.time, side="right"))
    assert np.array_equal(flight.thrust.on, numbers < 2)
    assert [event.name for event in flight.events] == ["end of in", "end of crank", "thrust off"]


@pytest.mark.parametrize("block_rows", [1, 7, 1000])
def test_rows_do_not_depend_on_the_blocks(flight, block_rows):
    blocks = list(simulate_blocks(SAIL, block_rows=block_rows))
    assert [block.first for block in blocks] == np.cumsum([0] + [len(block) for block in blocks[:-1]]).tolist()
    assert max(len(block) for block in blocks) <= block_rows
    assert np.array_equal(np.concatenate([block.time for block in blocks]), flight.time)
    assert np.array_equal(np.concatenate([block.position for block in blocks]), flight.position)
    assert [(e.name, e.time) for b in blocks for e in b.events] == [(e.name, e.time) for e in flight.events]
    names = {tuple(block.environment) for block in blocks}
    assert len(names) == 1


def test_times_and_durations_end_phases_on_the_dot():
    phases = [
        {"name": "a", "until": {"time_d": 30}},
        {"name": "b", "until": {"duration_d": 12.5}, "device": {"throttle": 0.5}},
        {"name": "c", "until": "time_d = 60", "device": {"on": False}},
        {"name": "d"},
    ]
    run = simulate({**SAIL, "phase": phases})
    assert [phase.start / DAY for phase in run.setting.phases] == pytest.approx([0, 30, 42.5, 60], rel=1e-15)
    by_hand = simulate(without_phases(device={**SAIL["device"], "active_d": [[0, 30], [60, 500]]}))
    assert np.linalg.norm(run.position[-1] - by_hand.position[-1]) > 1e-3 * AU  # half the thrust did something
    factor = np.array([1.0, 0.5, 0.0, 1.0])[run.setting.phase_of(run.time)]
    assert np.array_equal(run.environment["thrust_factor"], factor)
    full = simulate(without_phases(propagation={"duration_d": 1, "outputs": 2})).thrust.magnitude[0] * AU**2
    expected = factor * full / np.sum(run.position**2, axis=1)
    assert np.allclose(run.thrust.magnitude, expected, rtol=1e-9, atol=0)


def test_a_table_counts_from_the_beginning_of_its_phase():
    table = {"kind": "table", "time_d": [0, 20, 40], "pitch_deg": [0, 30, 10], "clock_deg": [90, 90, 90]}
    run = simulate({**SAIL, "phase": [{"name": "wait", "until": {"time_d": 100}}, {"name": "turn", "steering": table}]})
    after = run.time >= 100 * DAY
    expected = np.interp(run.time[after] / DAY - 100, table["time_d"], table["pitch_deg"])
    assert np.allclose(np.degrees(run.attitude.pitch[after]), expected, rtol=0, atol=1e-9)
    assert np.allclose(run.attitude.pitch[~after], 0, atol=1e-9)


def test_a_phase_has_rows_and_tolerance_of_its_own():
    phases = [
        {"name": "a", "until": "radius_au = 0.9", "steering": INWARDS, "propagation": {"outputs": 11}},
        {"name": "b", "until": {"duration_d": 10}, "propagation": {"output_interval_d": 0.25, "tolerance": 1e-9}},
        {"name": "c"},
    ]
    run = simulate({**SAIL, "phase": phases})
    number = run.setting.phase_of(run.time)
    assert np.count_nonzero(number == 0) == 10  # the eleventh is the first of the next
    assert np.count_nonzero(number == 1) == 40
    assert np.ptp(np.diff(run.time[number <= 0])) < 1e-3
    assert "1e-09" in run.setting.accuracy or "1e-9" in run.setting.accuracy


def test_an_event_ends_a_phase_and_happens_itself():
    scene = {
        **SAIL,
        "event": [{"name": "close", "radius_au": 0.48}],
        "phase": [{"name": "in", "until": "close", "steering": INWARDS}, {"name": "rest", "device": {"on": False}}],
    }
    run = simulate(scene)
    assert [event.name for event in run.events][:3] == ["close", "end of in", "thrust off"]
    assert run.events[0].time == run.events[1].time == run.setting.phases[1].start


def test_what_ends_the_run_ends_it_in_any_phase_and_later_ones_are_told():
    run = simulate({**SAIL, "event": [{"name": "enough", "radius_au": 0.6, "stop": True}]})
    assert run.ended == "enough"
    assert [phase.reached for phase in run.setting.phases] == [True, False, False]
    assert run.time[-1] == run.setting.phases[0].end == run.setting.duration


def test_expectations_know_the_end_of_a_phase(flight):
    expected = [
        {"quantity": "radius_au", "at": "end of in", "value": 0.48, "within": 1e-9},
        {"quantity": "inclination_deg", "at": "end of crank", "value": 12, "within": 1e-8},
    ]
    assert all(verdict.passed for verdict in check(load_scene({**SAIL, "expect": expected}), flight))


def test_a_brake_changes_its_voltage_and_its_mass_goes_on():
    base = {
        "title": "a brake",
        "body": "earth",
        "start": {"kind": "circular", "altitude_km": 600, "inclination_deg": 98},
        "device": {"kind": "plasma-brake", "tether_length_m": 500, "mass_kg": 10, "voltage_V": 1000},
        "environment": {
            "ionosphere": {
                "kind": "exponential-density",
                "density_per_m3": 2e11,
                "ion_mass_u": 16,
                "reference_altitude_km": 600,
                "scale_height_km": 100,
            }
        },
        "propagation": {"duration_d": 2, "outputs": 40},
    }
    phases = [
        {"name": "off", "until": {"duration_h": 10}, "device": {"on": False}},
        {"name": "weak", "until": {"duration_h": 10}, "device": {"voltage_V": 300}},
        {"name": "full"},
    ]
    run = simulate({**base, "phase": phases})
    number = run.setting.phase_of(run.time)
    assert np.all(run.mass == 10)
    volts = run.environment["tether_voltage_V"]
    assert [set(volts[number == i]) for i in range(3)] == [{0.0}, {-300.0}, {-1000.0}]
    assert [event.name for event in run.events] == ["end of off", "thrust on", "end of weak"]
    energy = np.sum(run.velocity**2, axis=1) / 2 - run.setting.body.mu / np.linalg.norm(run.position, axis=1)
    assert np.ptp(energy[number == 0]) < 1e-9 * abs(energy[0])
    rates = [-np.polyfit(run.time[number == i], energy[number == i], 1)[0] for i in (1, 2)]
    assert rates[1] > 1.5 * rates[0] > 0


def test_a_thruster_s_mass_is_handed_on():
    scene = {
        **SAIL,
        "device": {"kind": "thruster", "thrust_mN": 100, "mass_kg": 500, "specific_impulse_s": 3000},
        "steering": {"kind": "tangential"},
        "phase": [
            {"name": "a", "until": "mass_kg = 498"},
            {"name": "b", "until": {"duration_d": 20}, "device": {"on": False}},
            {"name": "c", "steering": {"kind": "radial"}},
        ],
    }
    run = simulate(scene)
    first, second, third = run.setting.phases
    rate = 0.1 / (9.80665 * 3000)
    assert first.end == pytest.approx(2 / rate, rel=1e-10)
    expected = 500 - rate * (np.minimum(run.time, first.end) + np.maximum(run.time - third.start, 0.0))
    assert np.allclose(run.mass, expected, rtol=1e-12)
    assert second.end - second.start == pytest.approx(20 * DAY, rel=1e-12)


def test_your_own_steering_flies_every_phase():
    import numba

    @numba.njit
    def law(t, x, y, z, vx, vy, vz, m):
        return x, y, z

    phases = [{"name": "a", "until": {"time_d": 30}}, {"name": "b", "device": {"throttle": 0.5}}]
    run = simulate({**SAIL, "phase": phases}, steering=law)
    plain = simulate({**SAIL, "phase": phases})
    assert np.allclose(run.position, plain.position, rtol=0, atol=1e-9 * AU)
