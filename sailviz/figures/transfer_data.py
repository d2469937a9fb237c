"""Flight times that take minutes to find, shipped as tables for the figures that draw them.

    python -m sailviz.figures.transfer_data FOLDER

computes them anew, transfer_times.csv, launch_windows.csv and photonic_assist.csv, and says how long: of the windows
about five minutes on one core, of the flight times about fifteen, of the assists about one. `python -m
sailviz.figures.transfer_data FOLDER windows` does the windows alone, `... FOLDER assists` the assists, `... FOLDER
times mercury electric-sail` the flight times to one target with one device, and leaves the others as they are.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from pathlib import Path
from time import perf_counter

import numpy as np

from sailviz import files, transfers
from sailviz.constants import AU, DAY
from sailviz.design.minimum_time import Rendezvous
from sailviz.design.minimum_time.assists import assists
from sailviz.shipped import shipped_folder

TARGETS = ("mercury", "venus", "mars", "ceres")
OVER_ACCELERATION = ("ideal", "jpl-2015", "electric-sail")
ACCELERATIONS = (2.0, 1.5, 1.0, 0.75, 0.5, 0.35, 0.25)  # mm/s2
COMPARED = (
    "ideal", "jpl-2015", "jpl-1978", "electric-sail", "electric-sail-updated", "electric-sail-polynomial",
    "electric-sail-original",
)  # fmt: skip
WINDOWS = {
    "mars": ("2029-01-01", "2033-01-01", 49),
    "venus": ("2029-01-01", "2031-06-01", 49),
    "apophis": ("2025-01-01", "2027-01-01", 49),
    "kamooalewa": ("2025-01-01", "2027-01-01", 49),
}
WINDOW_DEVICE, WINDOW_ACCELERATION = "ideal", 1.0  # mm/s2
ASSIST_LIGHTNESS = (0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7)
ASSIST_LIMITS = (0.2, 0.25, 0.3, 0.4, 0.5)  # au
ASSIST_BASES = ((0.3, 0.3), (0.25, 0.4))  # lightness and limit of the flights that are sought
ASSIST_RADIUS = 30.0  # au
TIMES, WINDOW_FILE, ASSISTS = "transfer_times.csv", "launch_windows.csv", "photonic_assist.csv"


def flight_times() -> dict[tuple[str, str], np.ndarray]:
    """(target, device) -> rows (n, 3): acceleration mm/s2, flight time d (NaN where none was found), revolutions;
    from the Earth, between circles."""
    found: dict[tuple[str, str], list[list[float]]] = {}
    for row in _rows(TIMES):
        numbers = [float(row[name]) for name in ("acceleration_mm_s2", "time_d", "revolutions")]
        found.setdefault((row["target"], row["device"]), []).append(numbers)
    return {key: np.array(sorted(rows)) for key, rows in found.items()}


def launch_windows() -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Target -> departures (n,) datetime64 and flight times (n,) d, NaN where none was found."""
    found: dict[str, list[tuple[np.datetime64, float]]] = {}
    for row in _rows(WINDOW_FILE):
        found.setdefault(row["target"], []).append((np.datetime64(row["departure"], "s"), float(row["time_d"])))
    return {
        key: (np.array([d for d, _ in rows]), np.array([t for _, t in rows], dtype=float))
        for key, rows in found.items()
    }


def photonic_assists() -> np.ndarray:
    """(n, 5): lightness, perihelion limit au, flight time d to ASSIST_RADIUS, closest au, revolutions; the last three
    NaN where no flight was found."""
    names = ("lightness", "limit_au", "time_d", "closest_au", "revolutions")
    return np.array([[float(row[name]) for name in names] for row in _rows(ASSISTS)])


def _rows(name: str) -> Iterator[dict[str, str]]:
    with open(shipped_folder("assets") / name, newline="", encoding="utf-8") as file:
        yield from csv.DictReader(file)


def compute_times(path: Path, target: str = "", device: str = "") -> None:
    """Search every flight anew, or those to one target with one device."""
    wanted = {(t, d, a) for t in TARGETS for d in OVER_ACCELERATION for a in ACCELERATIONS}
    wanted |= {(t, d, 1.0) for t in TARGETS[:3] for d in COMPARED}
    rows: dict[tuple[str, str, float], str] = {}
    if target:
        wanted = {key for key in wanted if key[:2] == (target, device)}
        if not wanted:
            raise ValueError(f"the table has no flights to {target!r} with {device!r}")
        rows = {key: row for key, row in _shipped_times().items() if key not in wanted}
    for key in sorted(wanted, key=_order):
        begun = perf_counter()
        flight = transfers.find("earth", key[0], key[1], key[2] * 1e-3).flight
        _say(f"{key[0]}, {key[1]}, {key[2]:g} mm/s²", begun)
        rows[key] = f"{flight.time / DAY:.4f},{flight.revolutions:.4f}"
    with files.writing(path, "table") as part, open(part, "w", newline="", encoding="utf-8") as file:
        file.write("target,device,acceleration_mm_s2,time_d,revolutions\n")
        for key in sorted(rows, key=_order):
            file.write(f"{key[0]},{key[1]},{key[2]:g},{rows[key]}\n")


def _order(key: tuple[str, str, float]) -> tuple[int, str, float]:
    return TARGETS.index(key[0]), key[1], -key[2]


def _shipped_times() -> dict[tuple[str, str, float], str]:
    """(target, device, mm/s2) -> flight time d and revolutions as they are written."""
    return {
        (row["target"], row["device"], float(row["acceleration_mm_s2"])): f"{row['time_d']},{row['revolutions']}"
        for row in _rows(TIMES)
    }


def compute_windows(path: Path) -> None:
    """Search every departure anew."""
    with files.writing(path, "table") as part, open(part, "w", newline="", encoding="utf-8") as file:
        file.write("target,departure,time_d\n")
        for target, (first, last, dates) in WINDOWS.items():
            begun = perf_counter()
            flight = transfers.find(
                "earth", target, WINDOW_DEVICE, WINDOW_ACCELERATION * 1e-3, departure=(first, last), dates=dates
            ).flight
            if not isinstance(flight, Rendezvous) or flight.window is None:
                raise RuntimeError(f"no flight to {target} was found between {first} and {last}")
            _say(f"window of {target}", begun)
            curve = flight.window
            departures = np.append(curve.departures, flight.departure).astype("datetime64[s]")
            times = np.append(curve.times, flight.time) / DAY
            for i in np.argsort(departures):
                file.write(f"{target},{departures[i]},{times[i]:.4f}\n")


def compute_assists(path: Path) -> None:
    """Search and follow every assist anew."""
    begun = perf_counter()
    bases = np.array(ASSIST_BASES) * [1.0, AU]
    found = assists(AU, ASSIST_RADIUS * AU, "ideal", ASSIST_LIGHTNESS, np.array(ASSIST_LIMITS) * AU, bases)
    with files.writing(path, "table") as part, open(part, "w", newline="", encoding="utf-8") as file:
        file.write("lightness,limit_au,time_d,closest_au,revolutions\n")
        for i, lightness in enumerate(ASSIST_LIGHTNESS):
            for k, limit in enumerate(ASSIST_LIMITS):
                days, near, turns = found.time[i, k] / DAY, found.closest[i, k] / AU, found.revolutions[i, k]
                file.write(f"{lightness:g},{limit:g},{days:.4f},{near:.5f},{turns:.4f}\n")
    _say("assists", begun)


def _say(what: str, begun: float) -> None:
    """How long a search took, beside the tables."""
    print(f"{what}: {perf_counter() - begun:.1f} s", file=sys.stderr, flush=True)


if __name__ == "__main__":
    folder, only = Path(sys.argv[1]), sys.argv[2:]
    at_first = perf_counter()
    if only[:1] in ([], ["times"]):
        compute_times(folder / TIMES, *only[1:])
    if only in ([], ["windows"]):
        compute_windows(folder / WINDOW_FILE)
    if only in ([], ["assists"]):
        compute_assists(folder / ASSISTS)
    _say("all of them", at_first)
