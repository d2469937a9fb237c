"""Collocation in steps of one length, which it makes on long flights of orbits that are nearly circular, against closed
forms, conservation laws and the other two integrators. Earth's units: m, s, kg."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import DAY, J2_EARTH, MU_EARTH, RADIUS_EARTH
from sailviz.elements import state as state_on_orbit
from sailviz.propagate import choice, collocation, dop853, dynamics, gauss_jackson, stepping
from sailviz.propagate.events import APSIS, END_OF_USE, NODE, RADIUS, RECORD, STOP, watch
from sailviz.steering import attitude

R0 = RADIUS_EARTH + 700e3
J2_STRENGTH = 1.5 * J2_EARTH * MU_EARTH * RADIUS_EARTH**2
AIR = (1, 4e-14, R0, 1.0, 60e3)  # drag of 1.1e-6 m/s2 at 700 km, that of a large sail; mass 1 kg
PUSH = {"device": dynamics.THRUSTER, "steering": attitude.TANGENTIAL}


def earth(**parts):
    return dynamics.model(MU_EARTH, **({"j2_strength": J2_STRENGTH} | parts))


def orbit(altitude, e=0.0, inclination=1.0):
    """Position, velocity at the perigee of this altitude."""
    return state_on_orbit((RADIUS_EARTH + altitude) / (1 - e), e, inclination, 0.3, 0.5, 0.0, MU_EARTH)


def fly(method, model, start, times, *, events=(), breaks=(0.0,), factors=(1.0,), block=None, tolerance=1e-11):
    """(states (6, n), events, status, integration), in blocks of so many rows."""
    s = method.start(0.0, *start, 1.0, events=len(events))
    out, found, status, done = np.full((6, len(times)), np.nan), [], method.DONE, 0
    size = block or len(times)
    for first in range(0, len(times), size):
        part = times[first : first + size]
        chunk = np.empty((6, len(part)))
        arguments = (np.asarray(breaks, float), np.asarray(factors, float), watch(events), part, chunk, times[-1])
        status = method.EVENTS_FULL
        while status == method.EVENTS_FULL:
            status = method.advance(s, model, *arguments, tolerance, np.inf)
            found += method.drain_events(s)
        done = first + method.rows_done(s)
        out[:, first:done] = chunk[:, : done - first]
        if status != method.DONE:
            break
    return out[:, :done], found, status, s


def apart(states, others):
    """Largest distance over the radius."""
    n = min(states.shape[1], others.shape[1])
    d = states[:3, :n] - others[:3, :n]
    return (np.linalg.norm(d, axis=0) / np.linalg.norm(others[:3, :n], axis=0)).max()


def kepler(altitude, e, times):
    """Positions (3, n) on the unperturbed orbit, since perigee, by Kepler's equation in extended precision."""
    a = np.longdouble((RADIUS_EARTH + altitude) / (1 - e))
    mean = np.sqrt(np.longdouble(MU_EARTH) / a**3) * times.astype(np.longdouble)
    anomaly = mean + e * np.sin(mean)
    for _ in range(12):
        anomaly = anomaly - (anomaly - e * np.sin(anomaly) - mean) / (1 - e * np.cos(anomaly))
    nu = 2 * np.arctan2(np.sqrt(1 + e) * np.sin(anomaly / 2), np.sqrt(1 - e) * np.cos(anomaly / 2))
    return np.transpose(state_on_orbit(float(a), e, 1.0, 0.3, 0.5, nu.astype(float), MU_EARTH)[0])


@pytest.mark.parametrize("tolerance", [1e-8, 1e-10])
@pytest.mark.parametrize("e", [0.0, 0.024, 0.1, 0.14])
def test_a_thousand_revolutions_follow_keplers_equation(e, tolerance):
    """At times that hit no step."""
    times = np.linspace(0, 1000 * 5930.0, 20011)
    states, _, _, s = fly(collocation, dynamics.model(MU_EARTH), orbit(700e3, e), times, tolerance=tolerance)
    assert apart(states, kepler(700e3, e, times)) < tolerance
    accepted, rejected = collocation.statistics(s)
    assert rejected < 0.01 * accepted


def test_an_oblate_planet_keeps_energy_and_the_axial_angular_momentum():
    """Energy with the potential mu J2 R^2 (3 sin^2 phi - 1) / (2 r^3), for half a year."""
    times = np.linspace(0, 180 * DAY, 3001)
    states, *_ = fly(collocation, earth(), orbit(600e3, 0.01), times)
    r, v = states[:3].T, states[3:].T
    size = np.linalg.norm(r, axis=1)
    oblate = MU_EARTH * J2_EARTH * RADIUS_EARTH**2 * (3 * (r[:, 2] / size) ** 2 - 1) / (2 * size**3)
    energy = np.sum(v * v, axis=1) / 2 - MU_EARTH / size + oblate
    momentum = np.cross(r, v)[:, 2]
    assert np.ptp(energy) / abs(energy[0]) < 1e-11
    assert np.ptp(momentum) / abs(momentum[0]) < 1e-11


def test_half_a_year_of_decay_agrees_with_the_multistep_method():
    times = np.linspace(0, 180 * DAY, 5003)
    model, start = earth(air=AIR), orbit(700e3, 0.01)
    states, *_ = fly(collocation, model, start, times, tolerance=1e-10)
    reference, *_ = fly(gauss_jackson, model, start, times, tolerance=1e-13)
    assert states.shape == reference.shape
    assert apart(states, reference) < 5e-10


def test_rows_and_events_do_not_depend_on_the_block_size():
    times = np.linspace(0, 15 * DAY, 2000)
    events = [(APSIS, 0, 0, RECORD), (NODE, 0, 1, RECORD)]
    breaks, factors = np.arange(0, 15 * DAY, 90_000.0), np.arange(15) % 2
    arguments = (collocation, earth(air=AIR, device_parameters=(1e-5, 0, 0), **PUSH), orbit(700e3, 0.01), times)
    whole = fly(*arguments, events=events, breaks=breaks, factors=factors)
    for block in (7, 999):
        pieces = fly(*arguments, events=events, breaks=breaks, factors=factors, block=block)
        assert np.array_equal(pieces[0], whole[0])
        assert [event[:2] for event in pieces[1]] == [event[:2] for event in whole[1]]


def test_state_at_a_time_does_not_depend_on_what_else_is_asked_for():
    coarse, fine = np.arange(0, 15 * DAY + 1, 600.0), np.arange(0, 15 * DAY + 1, 60.0)
    few = fly(collocation, earth(), orbit(700e3), coarse)[0]
    many = fly(collocation, earth(), orbit(700e3), fine, events=[(NODE, 0, 0, RECORD)])[0]
    assert np.array_equal(many[:, ::10], few)


def test_switched_thrust_agrees_with_dop853():
    breaks = np.arange(0, 15 * DAY, 5_000.0)
    factors = np.cos(np.arange(len(breaks))) ** 2
    arguments = (earth(device_parameters=(1e-4, 0, 0), **PUSH), orbit(700e3), np.linspace(0, 15 * DAY, 1001))
    states, *_ = fly(collocation, *arguments, breaks=breaks, factors=factors)
    reference, *_ = fly(dop853, *arguments, breaks=breaks, factors=factors, tolerance=1e-14)
    assert apart(states, reference) < 1e-9  # of DOP853


def test_events_are_those_of_dop853():
    model, start, times = earth(air=AIR), orbit(600e3, 0.005), np.linspace(0, 15 * DAY, 11)
    events = [(NODE, 0, 1, RECORD), (APSIS, 0, 0, RECORD), (RADIUS, RADIUS_EARTH + 610e3, 0, RECORD)]
    ours = fly(collocation, model, start, times, events=events)[1]
    theirs = fly(dop853, model, start, times, events=events, tolerance=1e-14)[1]
    assert len(ours) > 900
    assert [i for i, _, _ in ours] == [i for i, _, _ in theirs]
    assert np.array([t for _, t, _ in ours]) == pytest.approx([t for _, t, _ in theirs], abs=1e-4)
    assert [t for _, t, _ in ours] == sorted(t for _, t, _ in ours)


def test_stop_and_end_of_use_happen_where_the_multistep_method_has_them():
    model = earth(air=AIR, surface_radius=RADIUS_EARTH, device_parameters=(-3e-4, 0, 0), **PUSH)
    times = np.linspace(0, 20 * DAY, 4001)
    events = [(RADIUS, RADIUS_EARTH + 500e3, -1, END_OF_USE), (RADIUS, RADIUS_EARTH + 495e3, -1, STOP)]
    (a, first, status, s), (b, second, *_) = (
        fly(method, model, orbit(600e3), times, events=events) for method in (collocation, gauss_jackson)
    )
    assert status == stepping.STOPPED
    assert [i for i, _, _ in first] == [0, 1]
    assert np.array_equal(stepping.state(s), first[1][2])
    assert stepping.time(s) == first[1][1]
    assert a.shape == b.shape
    assert apart(a, b) < 1e-10
    assert [t for _, t, _ in first] == pytest.approx([t for _, t, _ in second], abs=1e-5)


def test_contact_with_the_surface_is_met_at_perigee():
    """The surface stands for the ground of a body without air below 150 km."""
    surface = RADIUS_EARTH + 150e3
    model, times = earth(air=AIR, surface_radius=surface), np.linspace(0, 200 * DAY, 2001)
    (_, found, status, s), (_, theirs, *_) = (
        fly(method, model, orbit(250e3, 0.004), times) for method in (collocation, gauss_jackson)
    )
    assert status == stepping.SURFACE
    assert found[0][0] == -1
    assert np.linalg.norm(stepping.state(s)[:3]) == pytest.approx(surface, abs=1e-3)
    assert found[0][1] == pytest.approx(theirs[0][1], abs=1e-3)


def test_decay_over_the_poles_into_the_last_turns_agrees_with_dop853():
    """From 400 km down to 120 km, where drag is no small force any more."""
    times = np.linspace(0, 60 * DAY, 5001)
    events = [(RADIUS, RADIUS_EARTH + 200e3, -1, RECORD), (RADIUS, RADIUS_EARTH + 120e3, -1, STOP)]
    model, start = earth(air=(1, 2e-13, *AIR[2:])), orbit(400e3, inclination=np.pi / 2)
    ours, found, status, s = fly(collocation, model, start, times, events=events)
    theirs, expected, *_ = fly(dop853, model, start, times, events=events, tolerance=1e-14)
    assert status == stepping.STOPPED
    assert [i for i, _, _ in found] == [i for i, _, _ in expected]
    assert [t for _, t, _ in found] == pytest.approx([t for _, t, _ in expected], abs=1e-2)
    assert ours.shape == theirs.shape
    assert apart(ours, theirs) < 1e-9
    accepted, rejected = collocation.statistics(s)
    assert rejected < 0.05 * accepted


def test_low_orbits_whose_forces_fit_eight_lanes_are_left_to_collocation():
    air, brake = earth(air=AIR, surface_radius=RADIUS_EARTH), earth(user_force=1, surface_radius=RADIUS_EARTH)
    found = [choice.choose(model, *orbit(700e3, 0.02), 365 * DAY) for model in (air, brake)]
    assert [one.integrator for one in found] == ["collocation", "gauss-jackson"]
    assert "eight places at once" in found[0].reason
    assert choice.choose(air, *orbit(700e3, 0.02), 365 * DAY, wanted="gauss-jackson").integrator == "gauss-jackson"
