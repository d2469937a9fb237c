"""Error and time of sailviz and heyoka over their tolerances, as the figure `speed` draws them.

    PYTHONPATH=. python tests/bench/speed_table.py assets/speed.csv

measures anew the problems of test_heyoka.py and test_heyoka_leo.py, in some minutes. Both take turns; the least of the
thread's own CPU times counts.
"""

from __future__ import annotations

import csv
import platform
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import llvmlite.binding
import numpy as np
import test_heyoka as sails
import test_heyoka_leo as low

Run = Callable[[], np.ndarray]
SAIL_TOLERANCES, LOW_TOLERANCES = 10.0 ** -np.arange(4.0, 13.0), 10.0 ** -np.arange(7.0, 12.5, 0.5)
SAIL_THEIRS, LOW_THEIRS = 10.0 ** -np.arange(4.0, 14.0), 10.0 ** -np.arange(13.0, 18.5, 0.5)
TURNS = {"sail": 1000, "low": 5}


def problems() -> Iterator[tuple[str, np.ndarray, list[tuple[str, float, Run]], int]]:
    """(name, reference (6, n), [(integrator, tolerance, run)], how often each is timed)."""
    for sail in sails.PITCH:
        mine, other = sails.ours(sail), sails.theirs(sail)
        runs = [("sailviz", t, mine(t)) for t in SAIL_TOLERANCES] + [("heyoka", t, other(t)) for t in SAIL_THEIRS]
        yield f"{sail}, ten years", other(1e-18)(), runs, TURNS["sail"]
    for name, orbit in low.ORBITS.items():
        runs = [("sailviz", t, low.ours(orbit, t)) for t in LOW_TOLERANCES]
        runs += [("heyoka", t, low.theirs(orbit, t)) for t in LOW_THEIRS]
        yield f"{name}, one year", low.theirs(orbit, 1e-20, np.longdouble)().astype(float), runs, TURNS["low"]


def processor() -> str:
    """Its name, as far as the system tells."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").splitlines() if info.is_file() else []
    named = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return f"{(named or [platform.processor() or platform.machine()])[0]} ({llvmlite.binding.get_host_cpu_name()})"


def main(path: Path) -> None:
    wide = llvmlite.binding.get_host_cpu_features().get("avx512f", False)
    machine = processor(), 8 if wide else 4
    with open(path, "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file, lineterminator="\n")
        names = "problem", "integrator", "tolerance", "error", "cpu_s", "processor", "doubles_in_a_vector"
        out.writerow(names)
        for name, reference, runs, turns in problems():
            size = np.linalg.norm(reference[:3], axis=0)
            errors = [float((np.linalg.norm((run() - reference)[:3], axis=0) / size).max()) for _, _, run in runs]
            times = np.array([[low.seconds(run) for _, _, run in runs] for _ in range(turns)]).min(axis=0)
            for (integrator, tolerance, _), error, seconds in zip(runs, errors, times.tolist(), strict=True):
                out.writerow((name, integrator, f"{tolerance:.3g}", f"{error:.3g}", f"{seconds:.4g}", *machine))
            file.flush()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
