"""Every row of the reference transfers from a cold start: flight time to 1e-6, residual under 1e-9, and how long it
takes. `pytest tests/bench/test_minimum_time.py -s` prints the table."""

from __future__ import annotations

import json
import time
from pathlib import Path

import numpy as np
import pytest

from sailviz.constants import AU, DAY
from sailviz.design.minimum_time.circles import circle_to_circle

ROWS = json.loads((Path(__file__).parents[1] / "design" / "minimum_time" / "reference_transfers.json").read_text())
DEVICES = {
    "ideal": "ideal",
    "JPL2015": "jpl-2015",
    "JPL1978": "jpl-1978",
    "Huo": "electric-sail",
    "Orig30": "electric-sail-updated",
}
RADII = {"Mars": 1.52366231, "Venus": 0.72333199, "Mercury": 0.38709893}


@pytest.fixture(scope="module", autouse=True)
def _compiled():
    circle_to_circle(AU, 1.2 * AU, "ideal", 2e-3)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row['model']}-{row['target']}-{row['ac']}")
def test_cold_start_finds_the_reference_flight_time(row):
    begin, begin_wall = time.process_time(), time.perf_counter()
    found = circle_to_circle(AU, RADII[row["target"]] * AU, DEVICES[row["model"]], row["ac"] * 1e-3)
    cpu, wall = time.process_time() - begin, time.perf_counter() - begin_wall
    print(
        f"{row['model']:8s} {row['target']:8s} {row['ac']:5} {found.time / DAY:12.4f} d "
        f"{found.time / DAY / row['tf'] - 1:9.1e} residual {found.residual:.0e} drift {found.hamiltonian_drift:.0e} "
        f"{found.converged:3d} of {found.starts:3d}, {found.solutions} distinct  {cpu:6.2f} s cpu {wall:6.2f} s wall"
    )
    assert found.time / DAY == pytest.approx(row["tf"], rel=1e-6)
    assert found.revolutions == pytest.approx(row["rev"], rel=1e-6)
    assert found.residual <= 1e-9
    assert found.costates == pytest.approx(np.array(row["lam0"]), rel=1e-5, abs=1e-4)
    assert cpu < 3
