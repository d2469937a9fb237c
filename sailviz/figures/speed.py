"""The figure of what an error costs: sailviz and heyoka over their tolerances."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sailviz.shipped import shipped_folder

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from sailviz.figures.page import Pen

TABLE = "speed.csv"  # made by tests/bench/speed_table.py
PANELS = {  # problem of the table -> title
    "ideal sail, ten years": "solar sail, ten years, 3,650 rows",
    "electric sail, ten years": "electric sail, ten years, 3,650 rows",
    "800 km, one year": "low orbit at 800 km, a year, 52,560 rows",
}
TICKS = tuple(digit * 10.0**power for power in range(-3, 4) for digit in (1, 2, 5))  # ms
INTEGRATORS = "sailviz", "heyoka"


class Speed(NamedTuple):
    """What was measured of one integrator on one problem, each (n,), from the loosest tolerance on."""

    tolerance: np.ndarray
    error: np.ndarray  # largest of the positions, over the distance
    seconds: np.ndarray  # CPU time


def measured() -> tuple[dict[tuple[str, str], Speed], str]:
    """((problem, integrator) -> Speed, the machine in words)."""
    rows: dict[tuple[str, str], list[tuple[float, float, float]]] = {}
    machine = ""
    with open(shipped_folder("assets") / TABLE, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            numbers = float(row["tolerance"]), float(row["error"]), float(row["cpu_s"])
            rows.setdefault((row["problem"], row["integrator"]), []).append(numbers)
            machine = f"{row['processor']}, vectors of {row['doubles_in_a_vector']} doubles"
    return {key: Speed(*np.array(sorted(found, reverse=True)).T) for key, found in rows.items()}, machine


def frontier(found: Speed) -> tuple[np.ndarray, np.ndarray]:
    """(error, seconds) of what nothing else beats in both, from the largest error on."""
    best = [i for i, e in enumerate(found.error) if not np.any((found.error <= e) & (found.seconds < found.seconds[i]))]
    order = sorted(best, key=lambda i: -found.error[i])
    return found.error[order], found.seconds[order]


def speed(pen: Pen, *panels: Axes) -> None:
    """CPU time over the error of the rows, a panel for each problem."""
    found, machine = measured()
    for panel, (problem, title) in zip(panels, PANELS.items(), strict=True):
        for integrator, color in zip(INTEGRATORS, pen.style.series, strict=False):
            one = found[problem, integrator]
            panel.plot(one.error, one.seconds * 1e3, color=color, linestyle="", marker="o", markersize=3, alpha=0.5)
            error, seconds = frontier(one)
            panel.plot(error, seconds * 1e3, color=color, marker="o", markersize=4.5, label=integrator)
        panel.set(xscale="log", yscale="log", xlabel="largest error of a position, over the distance")
        panel.invert_xaxis()
        low, high = panel.get_ylim()
        panel.set_ylim(low / 1.8, high * 1.2)  # room for the machine's name
        ticks = [t for t in TICKS if low / 1.8 < t < high * 1.2]
        panel.set_yticks(ticks, [f"{t:g}" for t in ticks])
        panel.set_yticks([], minor=True)
        panel.set_title(title)
    panels[0].set_ylabel("CPU time [ms]")
    panels[0].legend(loc="center right")
    panels[-1].annotate(
        f"measured on {machine}", (1, 0.02), xycoords="axes fraction", ha="right", fontsize=8.5, color=pen.style.quiet
    )
