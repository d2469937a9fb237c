"""Cost of the first-order solution against the numerical propagator: end state only, 1e-4 relative error in r.

Both sides are called as compiled code, with as little Python as can be (1-2 us); each at the loosest setting that keeps
the error. A second table gives the cost of one point more where many are asked for.
`pytest tests/bench/test_asymptotic.py -s` prints the table; with --benchmark-group-by=param:case pytest-benchmark
compares them case by case. The propagator is given the final time, the analytic solution the final angle.
"""

from __future__ import annotations

import json
from functools import partial
from itertools import product
from pathlib import Path
from time import process_time_ns

import numpy as np
import pytest

from sailviz.constants import AU, MU_SUN
from sailviz.design import asymptotic
from sailviz.design.asymptotic import legs
from sailviz.propagate import dop853, dynamics
from sailviz.propagate.events import watch
from sailviz.steering import attitude

ACCURACY = 1e-4
FILE = Path(__file__).parents[1] / "design" / "asymptotic" / "reference_asymptotic.json"
CASES = {case["id"]: case for case in json.loads(FILE.read_text())}
NAMES = ("A2", "A4", "A8", "A11", "A17", "A21", "A22", "A26", "A29", "A33", "A37", "A40")
NOTHING, NO_BREAKS, FULL = watch([]), np.zeros(1), np.ones(1)
LEGS = [None, *(2 * np.pi / k for k in (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64))]


def analytic(case, leg, scheme, clock):
    """A call without arguments that returns (r, t) at the end of the arc."""
    q, theta = np.array(case["q0"]), np.array([case["th1"]])
    out, time, mass = np.empty((1, 3)), np.empty(1), np.empty(1)
    length = case["th1"] if leg is None else leg
    rest = (
        case["n"],
        case["er"],
        case["et"],
        asymptotic.CLOCKS[clock],
        asymptotic.SCHEMES[scheme],
        0.0,
        out,
        time,
        mass,
    )

    def call():
        status = legs.march(q, 0.0, theta, length, *rest)[0]
        h = out[0, 2]
        return 1 / (h * (h + out[0, 0] * np.cos(theta[0]) + out[0, 1] * np.sin(theta[0]))), time[0], status

    return call


def numeric(case, tolerance, points=1):
    """The same by DOP853 in the plane of the orbit, canonical but for the electric sail, whose law knows the au."""
    q1, _, q3 = case["q0"]
    unit, speed = (AU, np.sqrt(MU_SUN / AU)) if case["n"] == 1 else (1.0, 1.0)
    mu = MU_SUN if case["n"] == 1 else 1.0
    size, angle = np.hypot(case["er"], case["et"]), np.arctan2(case["et"], case["er"])
    if case["n"] == 0:
        model = dynamics.model(
            mu, device=dynamics.THRUSTER, device_parameters=(case["et"], 0.0, 0.0), steering=attitude.TRANSVERSE
        )
    elif case["n"] == 2:  # an ideal sail: cone and pitch are one
        direction = attitude.direction_parameters(angle, np.pi / 2)
        strength = size / np.cos(angle) ** 2
        model = dynamics.model(
            mu,
            device=dynamics.SOLAR_SAIL,
            device_parameters=(strength, 0.0, 1.0, 0.0),
            steering=attitude.ORBITAL,
            steering_parameters=direction,
        )
    else:
        from sailviz.propulsion import electric_sail

        pitch = np.arccos(3**-0.5) if "54.74" in case["case"] else float(electric_sail.pitch_angle(angle))
        if "a=45" in case["case"]:
            pitch = np.pi / 4
        ac = size / electric_sail.dimensionless_acceleration(pitch) * MU_SUN / AU**2
        model = dynamics.model(
            mu,
            device=dynamics.ELECTRIC_SAIL,
            device_parameters=(ac, 0, np.pi / 2),
            steering=attitude.ORBITAL,
            steering_parameters=attitude.direction_parameters(pitch, np.pi / 2),
        )
    s = q3 + q1
    end = np.linspace(0, case["ref"]["t"] * unit / speed, points + 1)[1:]
    out = np.empty((6, points))
    start = (unit / (q3 * s), 0.0, 0.0), (0.0, s * speed, 0.0)

    def call():
        run = dop853.start(0.0, *start, 1.0)
        status = dop853.advance(run, model, NO_BREAKS, FULL, NOTHING, end, out, end[-1], tolerance, np.inf)
        return np.sqrt(out[0, -1] ** 2 + out[1, -1] ** 2 + out[2, -1] ** 2) / unit, out, status

    return call


def cost(call, seconds=0.03):
    """ns of processor time for one call, the best of many rounds."""
    call()
    best, count = np.inf, 1
    end = process_time_ns() + seconds * 1e9
    while process_time_ns() < end:
        begin = process_time_ns()
        for _ in range(count):
            call()
        took = (process_time_ns() - begin) / count
        best = min(best, took)
        count = max(1, int(1e6 / max(took, 1)))
    return best


def cheapest_analytic(case, clock):
    """(ns, leg, scheme, clock) of the cheapest setting within the accuracy."""
    found = []
    for leg, scheme in product(LEGS, ("plain", "midpoint")):
        if clock == "closed" and scheme == "midpoint":
            continue
        call = analytic(case, leg, scheme, clock)
        r, t, status = call()
        good = status == legs.OK and abs(r / case["ref"]["r"] - 1) < ACCURACY
        if good and (clock is None or abs(t / case["ref"]["t"] - 1) < ACCURACY):
            found.append((cost(call, 0.005), leg, scheme, clock))
    return min(found, key=lambda x: x[0]) if found else None


def loosest_numeric(case):
    for tolerance in 10.0 ** -np.arange(1.0, 13.1, 0.5):
        r, _, status = numeric(case, tolerance)()
        tighter = numeric(case, tolerance / 10**0.5)()[0]  # no lucky hits
        if status == dop853.DONE and max(abs(r / case["ref"]["r"] - 1), abs(tighter / case["ref"]["r"] - 1)) < ACCURACY:
            return tolerance
    raise AssertionError("the propagator does not reach the accuracy")


def test_table_of_costs():
    """Prints the table. The analytic solution without time must win on every short arc."""
    print(f"\n{'case':>4} {'rev':>4}  {'r only':>9} {'r and t':>9} {'DOP853':>9} us   ratio  settings")
    ratios = []
    for name in NAMES:
        case = CASES[name]
        shape, timed = cheapest_analytic(case, None), cheapest_analytic(case, "quadrature")
        closed = cheapest_analytic(case, "closed")
        if closed and timed and closed[0] < timed[0]:
            timed = closed
        tolerance = loosest_numeric(case)
        number = cost(numeric(case, tolerance))
        ratios.append(number / shape[0])
        leg = "one leg" if timed[1] is None else f"{2 * np.pi / timed[1]:.0f} legs/rev"
        print(
            f"{name:>4} {case['th1'] / 2 / np.pi:4.0f}  {shape[0] / 1e3:9.2f} {timed[0] / 1e3:9.2f} {number / 1e3:9.2f}"
            f"      {number / shape[0]:4.1f} {number / timed[0]:4.1f}  {timed[2]} {leg} {timed[3]}; {tolerance:.0e}"
        )
    assert min(ratios) > 0.2  # a guard against a collapse, not a claim


def test_table_of_costs_per_point():
    """Prints ns per point for 10,000 points on the arc, time included, at the settings of the other table."""
    print(f"\n{'case':>4}  {'analytic':>9} {'no time':>9} {'DOP853':>9} ns a point")
    for name in ("A2", "A11", "A21", "A37"):
        case = CASES[name]
        _, leg, scheme, _ = cheapest_analytic(case, "quadrature")
        theta = np.linspace(0, case["th1"], 10_001)[1:]
        out, time, mass = np.empty((len(theta), 3)), np.empty(len(theta)), np.empty(len(theta))
        thrust = (leg or case["th1"], case["n"], case["er"], case["et"])

        def march(clock, case=case, theta=theta, thrust=thrust, scheme=scheme, out=(out, time, mass)):
            legs.march(np.array(case["q0"]), 0.0, theta, *thrust, clock, asymptotic.SCHEMES[scheme], 0.0, *out)

        costs = [cost(partial(march, clock), 0.05) for clock in (legs.QUADRATURE, legs.NONE)]
        few, many = (cost(numeric(case, loosest_numeric(case), points), 0.05) for points in (1, 10_000))
        print(f"{name:>4}  {costs[0] / 1e4:9.1f} {costs[1] / 1e4:9.1f} {(many - few) / 1e4:9.1f}")


@pytest.mark.parametrize("method", ["analytic", "numeric"])
@pytest.mark.parametrize("case", ["A2", "A4", "A26", "A33"])
def test_cost_of_the_end_state(benchmark, case, method):
    if method == "numeric":
        benchmark(numeric(CASES[case], loosest_numeric(CASES[case])))
    else:
        benchmark(analytic(CASES[case], *cheapest_analytic(CASES[case], "quadrature")[1:]))
