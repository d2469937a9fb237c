"""Costates fitted to flights whose costates are known from the indirect method."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import AU, DAY
from sailviz.design.direct.costate_fit import fit
from sailviz.design.minimum_time.boundary_conditions import PolarState, ToCircle
from sailviz.design.minimum_time.costates import propagate
from sailviz.design.minimum_time.state_costate import LAM_V, POSITION, TIME_UNIT, canonical_sail
from sailviz.steering.optimal import optimal_pitch

# radius au, days, costates of r, u and v: fastest flights from one au at 1 mm/s2, two codes
FLIGHTS = {
    "ideal": (5.2026, 3779.827616, (9.6237487, 3.7526825, 9.0345734)),
    "electric-sail": (1.6, 571.701024, (11.9610085, 3.5541107, 12.5650196)),
}


@pytest.mark.parametrize("device", FLIGHTS)
def test_costates_of_a_fastest_flight_are_found_from_its_path_and_attitude(device):
    radius, days, lam = FLIGHTS[device]
    sail = canonical_sail(device, 1e-3)
    problem = ToCircle(sail, PolarState(1.0, 0.0, 1.0), radius)
    unit = np.array(lam) / np.linalg.norm(lam)
    span = days * DAY / TIME_UNIT
    start = problem.starts(np.array([[*unit, span]]))[0]
    times = np.linspace(0.0, span, 2001)
    rows = propagate(start, span, sail, times=times).rows
    outward = rows[:, POSITION] / np.linalg.norm(rows[:, POSITION], axis=1)[:, None]
    primer = rows[:, LAM_V] / np.linalg.norm(rows[:, LAM_V], axis=1)[:, None]
    c = np.sum(outward * primer, axis=1)
    side = primer - c[:, None] * outward
    side /= np.linalg.norm(side, axis=1)[:, None]
    steered = optimal_pitch(np.arccos(c), device)
    normal = np.cos(steered.pitch)[:, None] * outward + np.sin(steered.pitch)[:, None] * side
    found = fit(times * TIME_UNIT, rows[:, POSITION] * AU, normal, steered.on.astype(float), device, 1e-3)
    # an electric sail's table has its throttle at the rows only, and its switches lie between them
    assert found.costates[[0, 3, 4]] == pytest.approx(unit * np.linalg.norm(found.costates[[0, 3, 4]]), abs=3e-3)
    assert found.costates @ start[6:] / np.linalg.norm(start[6:]) == pytest.approx(1.0, abs=1e-6)
    assert found.miss < 1e-3
