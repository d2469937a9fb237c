"""State and costates of minimum-time flights: Hamilton's equations, against differences, SciPy and tabled transfers."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz.constants import DAY
from sailviz.design.minimum_time import costates, state_costate
from sailviz.design.minimum_time.state_costate import TIME_UNIT, canonical_sail

SAILS = ("ideal", "jpl-1978", "jpl-2015", "eta-perfect", "electric-sail")
SAILS += ("electric-sail-original", "electric-sail-updated", "electric-sail-polynomial")
J = np.block([[np.zeros((6, 6)), np.eye(6)], [-np.eye(6), np.zeros((6, 6))]])

# flight times in days, initial costates (lam_r, lam_u, lam_v) with H = 1 and target radii
NAMES = {"ideal": "ideal", "JPL2015": "jpl-2015", "JPL1978": "jpl-1978", "Huo": "electric-sail"}
NAMES["Orig30"] = "electric-sail-updated"
RADII = {"Mars": 1.52366231, "Venus": 0.72333199, "Mercury": 0.38709893}
TABLE = json.loads((Path(__file__).parent / "reference_transfers.json").read_text())


def start(rng):
    """A state on a slanted ellipse-like orbit, and costates of any direction."""
    r = rng.normal(size=3)
    r *= rng.uniform(0.5, 1.5) / np.linalg.norm(r)
    v = np.cross(rng.normal(size=3), r)
    v *= rng.uniform(0.95, 1.2) / np.linalg.norm(v) / np.sqrt(np.linalg.norm(r))
    return np.concatenate([r, v, rng.normal(size=6)])


def planar(row):
    lam_r, lam_u, lam_v = row["lam0"]
    return np.array([1.0, 0, 0, 0, 1.0, 0, lam_r, lam_u, 0, lam_u, lam_v, 0])


def hamiltonian(y, sail, smoothing=0.0):
    return costates.propagate(y, 0.0, sail, smoothing=smoothing).hamiltonian


def gradient(function, y, h=1e-5):
    def difference(step):
        return np.array([function(y + d) - function(y - d) for d in step * np.eye(12)]) / (2 * step)

    return (4 * difference(h / 2) - difference(h)) / 3


@pytest.mark.parametrize("device", SAILS)
@pytest.mark.parametrize("smoothing", [0.0, 0.05])
def test_rates_are_the_gradient_of_the_hamiltonian(device, smoothing):
    if smoothing and not device.startswith("electric"):
        pytest.skip("films are not rounded off")
    sail, rng, checked = canonical_sail(device, 3e-3), np.random.default_rng(6), 0
    for _ in range(30):
        y, rates = start(rng), np.empty(12)
        g, h = state_costate.right_hand_side(y, sail.kind, sail.parameters, smoothing, rates)
        assert h == pytest.approx(hamiltonian(y, sail, smoothing), rel=1e-14)
        if abs(g) < 1e-3:  # differences across the switch mean nothing
            continue
        expected = J @ gradient(lambda x: hamiltonian(x, sail, smoothing), y)
        # rounding over the difference's step, 1e-11, and its fifth-order rest
        assert rates == pytest.approx(expected, abs=2e-9 * np.abs(expected).max())
        checked += 1
    assert checked > 20


@pytest.mark.parametrize("device", SAILS)
def test_hamiltonian_stays_through_switches(device):
    sail, rng, switches = canonical_sail(device, 1e-3), np.random.default_rng(7), 0
    for _ in range(6):
        flight = costates.propagate(start(rng), 3.0, sail)
        assert flight.reason == ""
        scale = np.linalg.norm(flight.end[6:]) + abs(flight.hamiltonian)
        assert flight.drift < 1e-10 * scale  # 1e-13 a step, some hundred steps
        switches += len(flight.switches)
    if sail.switches:
        assert switches > 0


def e_sail_rates(t, y, strength, on):
    """The final E-sail model by its vector law: thrust strength / 4 / r (3 r_hat + primer), from the thesis' (3.39)."""
    r, v, lr, lv = y.reshape(4, 3)
    d = np.linalg.norm(r)
    u, size = r / d, np.linalg.norm(lv)
    q = strength / 4 / d * on
    # H_thrust = q (3 u . lv + |lv|): its gradient over r
    across = lv - (lv @ u) * u
    push = -q / d * (3 * (u @ lv) + size) * u + 3 * q / d * across
    lr_rate = lv / d**3 - 3 * (lv @ r) * r / d**5 - push
    return np.concatenate([v, -r / d**3 + q * (3 * u + lv / size), lr_rate, -lr])


def test_flight_of_an_electric_sail_is_scipys():
    row = next(q for q in TABLE if (q["model"], q["target"], q["ac"]) == ("Huo", "Mercury", 2))
    y, sail, span = planar(row), canonical_sail("electric-sail", 2e-3), row["tf"] * DAY / TIME_UNIT
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    y = (y.reshape(4, 3) @ turn.T).ravel()
    flight = costates.propagate(y, span, sail)

    def angle(t, y, strength, on):
        return y[:3] @ y[9:] / np.linalg.norm(y[:3]) / np.linalg.norm(y[9:]) + 1 / 3

    angle.terminal = True
    t, on, switches = 0.0, float(angle(0, y, 0, 0) > 0), []
    options = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-13, "args": None}
    while t < span:
        options["args"] = (sail.parameters[1], on)
        angle.direction = -1 if on else 1
        leg = solve_ivp(e_sail_rates, (t, span), y, events=angle, **options)
        t, y, on = leg.t[-1], leg.y[:, -1], 1 - on
        switches += [t] if leg.status == 1 else []
    assert len(switches) == 2
    assert flight.switches == pytest.approx(switches, abs=1e-10)
    # both err by 1e-13 a step, and fourfold growth of errors over the flight
    assert flight.end == pytest.approx(y, abs=1e-10 * np.abs(y).max())


def test_dense_output_is_the_end_of_shorter_flights():
    row = TABLE[0]
    y, sail, span = planar(row), canonical_sail(NAMES[row["model"]], row["ac"] * 1e-3), row["tf"] * DAY / TIME_UNIT
    times = np.linspace(0, span, 9)
    rows = costates.propagate(y, span, sail, times=times).rows
    scale = np.abs(rows).max(axis=0) + 1
    for t, found in zip(times, rows, strict=True):
        end = costates.propagate(y, t, sail).end
        assert found / scale == pytest.approx(end / scale, abs=3e-11)
    assert rows[0] == pytest.approx(y, abs=0)
    with pytest.raises(ValueError, match="increase"):
        costates.propagate(y, span, sail, times=[1.0, 0.5])


@pytest.mark.parametrize("row", TABLE, ids=lambda q: f"{q['model']}-{q['target']}-{q['ac']}")
def test_tabled_costates_reach_the_target_circle(row):
    sail, span = canonical_sail(NAMES[row["model"]], row["ac"] * 1e-3), row["tf"] * DAY / TIME_UNIT
    flight = costates.propagate(planar(row), span, sail)
    r, v = flight.end[:3], flight.end[3:6]
    radius = np.linalg.norm(r)
    # the table's own misses reach 5e-10, its flight times have 1e-12
    assert [radius, r @ v, np.cross(r, v)[2]] == pytest.approx(
        [RADII[row["target"]], 0, np.sqrt(RADII[row["target"]])], abs=1e-9
    )
    assert flight.hamiltonian == pytest.approx(1, abs=1e-10)
    assert flight.drift < 1e-10
    assert np.all(flight.end[2::3] == 0)


def test_space_has_no_preferred_direction():
    row = next(q for q in TABLE if (q["model"], q["target"], q["ac"]) == ("JPL2015", "Mars", 1))
    sail, span = canonical_sail("jpl-2015", 1e-3), row["tf"] * DAY / TIME_UNIT
    turn = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    flat, tilted = planar(row), (planar(row).reshape(4, 3) @ turn.T).ravel()
    ends = [costates.propagate(y, span, sail).end.reshape(4, 3) for y in (flat, tilted)]
    assert ends[1] == pytest.approx(ends[0] @ turn.T, abs=1e-10)


def test_optical_film_without_absorption_is_the_ideal_one():
    from sailviz.propulsion.solar_sail import Film

    row = next(q for q in TABLE if (q["model"], q["target"], q["ac"]) == ("ideal", "Venus", 1))
    span = row["tf"] * DAY / TIME_UNIT
    ideal, nearly = (canonical_sail(f, 1e-3) for f in ("ideal", Film(1e-9, 1.0, -1e-9)))
    ends = [costates.propagate(planar(row), span, sail).end for sail in (ideal, nearly)]
    assert ends[1] == pytest.approx(ends[0], abs=1e-7)


def test_failed_flights_say_why():
    sail = canonical_sail("ideal", 1e-3)
    falling = np.array([1.0, 0, 0, 0, 0, 0, 1.0, 0, 0, 1.0, 0, 0])  # straight into the Sun
    flight = costates.propagate(falling, 5.0, sail)
    assert flight.reason
    assert flight.time < 5
    assert np.all(np.isnan(costates.fly_all(falling[None], [5.0], sail)))
