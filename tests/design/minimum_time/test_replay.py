"""Solved flights flown again from their data, by integrators that know nothing of costates."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline

from sailviz.constants import AU, DAY, MU_SUN
from sailviz.design.minimum_time import costates, replay
from sailviz.design.minimum_time.state_costate import SPEED_UNIT, TIME_UNIT, canonical_sail
from sailviz.propagate import dop853, dynamics
from sailviz.propagate.events import watch
from sailviz.propulsion import electric_sail, solar_sail
from sailviz.propulsion.devices import sail
from sailviz.steering import attitude
from sailviz.steering.optimal import optimal_pitch

# flight times in days and initial costates: one without a switch, two with two
ROWS = {
    "ideal": (1.0, 204.7555, (-18.3092424, -4.5689608, -21.1186219)),
    "jpl-2015": (2.0, 173.1621, (-13.7494057, -4.9143243, -14.8576625)),
    "electric-sail": (1.0, 287.6067, (-26.3519048, -2.6545242, -31.5725110)),
}
TILT = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]


def solved(device, tilted=True):
    strength, days, (lr, lu, lv) = ROWS[device]
    y = np.array([[1.0, 0, 0], [0, 1.0, 0], [lr, lu, 0], [lu, lv, 0]])
    r, v, lam_r, lam_v = y @ TILT.T if tilted else y
    lam = np.concatenate([lam_r, lam_v])
    return replay.Solved(r * AU, v * SPEED_UNIT, lam, days * DAY, device, strength * 1e-3)


def end(flight):
    """Where the costates themselves lead."""
    y = np.concatenate([flight.position / AU, flight.velocity / SPEED_UNIT, flight.costates])
    model = canonical_sail(flight.device, flight.characteristic_acceleration)
    return costates.propagate(y, flight.time / TIME_UNIT, model).end[:6]


def canonical(position, velocity):
    return np.concatenate([position / AU, velocity / SPEED_UNIT])


@pytest.mark.parametrize("device", ROWS)
def test_primer_alone_repeats_the_flight(device):
    flight = solved(device)
    history = replay.primer_history(flight)
    assert history.error <= 1e-10
    primer = CubicHermiteSpline(history.time, history.primer, history.rate)

    def thrust(r, direction):
        u = r / np.linalg.norm(r)
        side = direction - (direction @ u) * u
        angle = np.arctan2(np.linalg.norm(side), direction @ u)
        held = optimal_pitch(angle, device)
        if not held.on:
            return np.zeros(3)
        n = np.cos(held.pitch) * u + np.sin(held.pitch) * side / np.linalg.norm(side)
        force = electric_sail if device.startswith("electric") else solar_sail
        model = {"film": device} if force is solar_sail else {}
        return force.acceleration(r, n, flight.characteristic_acceleration, **model)

    def rates(t, y):
        r = y[:3]
        return np.concatenate([y[3:], -MU_SUN * r / np.linalg.norm(r) ** 3 + thrust(r, primer(t))])

    y, bounds = np.concatenate([history.position, history.velocity]), [0.0, *history.switches, flight.time]
    for leg in pairwise(bounds):
        y = solve_ivp(rates, leg, y, method="DOP853", rtol=1e-11, atol=1e-3).y[:, -1]
    assert canonical(y[:3], y[3:]) == pytest.approx(end(flight), abs=1e-8)


@pytest.mark.parametrize("device", ROWS)
def test_table_of_attitudes_repeats_the_flight(device):
    flight = solved(device)
    table = replay.steering_table(flight)
    assert table.error <= 1e-6
    kind, parameters = sail(device, flight.characteristic_acceleration)
    rows = attitude.table(table.time, table.pitch, table.clock, table.throttle)
    model = dynamics.model(
        MU_SUN, device=kind, device_parameters=parameters, steering=attitude.TABLE_ORBITAL, table=rows,
        interpolation=attitude.LINEAR,
    )  # fmt: skip
    breaks = np.unique(table.time)
    s, out = dop853.start(0.0, table.position, table.velocity, 1.0), np.empty((6, 1))
    dop853.advance(
        s, model, breaks, np.ones(len(breaks)), watch([]), np.array([flight.time]), out, flight.time, 1e-11, np.inf
    )
    assert canonical(out[:3, 0], out[3:, 0]) == pytest.approx(end(flight), abs=1e-5)


def test_table_has_two_rows_at_a_switch():
    table = replay.steering_table(solved("electric-sail"))
    assert len(table.switches) == 2
    for at in table.switches:
        pair = np.flatnonzero(table.time == at)
        assert len(pair) == 2
        assert sorted(table.throttle[pair]) == [0, 1]
    assert set(table.throttle) == {0, 1}
    film = replay.steering_table(solved("jpl-2015"))
    before, after = np.flatnonzero(film.time == film.switches[0])
    jump = sorted(np.degrees(np.abs(film.pitch[[before, after]])))
    assert jump == pytest.approx([74.2160, 90.0], abs=1e-3)  # the pitch at the jump
    assert np.all(np.diff(film.time) >= 0)


def test_primer_of_a_planar_flight_is_that_of_any_unit_of_length():
    radius = 1.3 * AU
    strength, _, (lr, lu, lv) = ROWS["ideal"]
    start = np.array([1.0, 0, 0, 0, 1.0, 0, lr, lu, 0, lu, lv, 0])
    near = solved("ideal", tilted=False)
    unit = 1.3**1.5
    # the ideal sail's thrust and the Sun's pull fall alike: the same flight on another scale, r^1.5 slower
    far = replay.from_planar(start, radius, near.time * unit, "ideal", strength * 1e-3)
    a, b = (replay.primer_history(x, error=1e-6) for x in (near, far))
    assert b.primer / 1.3**2 == pytest.approx(a.primer, rel=1e-9, abs=1e-9 * np.abs(a.primer).max())
    assert end(far)[:3] / 1.3 == pytest.approx(end(near)[:3], abs=1e-10)


def test_costates_that_fall_into_the_sun_are_refused():
    flight = replay.Solved(np.array([AU, 0, 0]), np.zeros(3), np.array([1.0, 0, 0, 1, 0, 0]), 300 * DAY, "ideal", 1e-4)
    with pytest.raises(ValueError, match="cannot be flown"):
        replay.primer_history(flight)
