"""Places from JPL's kernels: DE421, which the extra `ephemeris` carries, and any other file of the kind `.bsp`.

Read by jplephem: Chebyshev polynomials of positions (SPK type 2, or 3 with velocities).
"""

from __future__ import annotations

from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

J2000_DAY = 2_451_545.0  # Julian date
NEEDS_EXTRA = 'needs the extra "ephemeris": pip install "sailviz[ephemeris]"'
BARYCENTRE = 0  # NAIF's number of the solar system's
OTHER_NUMBERS = {1: 199, 2: 299, 4: 499, 5: 599, 6: 699}  # of a planet alone, where its system's is not there


def has_extra() -> bool:
    """Whether DE421 and what reads it are installed."""
    return find_spec("skyfield_data") is not None and find_spec("jplephem") is not None


def kernel_file(source: str) -> Path:
    """The file of a source: "de421", or a path of one's own. ModuleNotFoundError without the extra."""
    if find_spec("jplephem") is None:
        raise ModuleNotFoundError(f"the ephemeris {source} {NEEDS_EXTRA}")
    if source != "de421":
        return Path(source)
    home = find_spec("skyfield_data")
    if home is None or home.origin is None:
        raise ModuleNotFoundError(f"the ephemeris DE421 {NEEDS_EXTRA}")
    return Path(home.origin).parent / "data" / "de421.bsp"


class Kernel:
    """An open kernel: chains of its segments from the solar system's barycentre to a body."""

    def __init__(self, path: Path, name: str):
        from jplephem.spk import SPK

        self.name = name
        try:
            self._spk: Any = SPK.open(str(path))
        except (ValueError, OSError) as error:
            raise ValueError(f"{name} is no kernel that can be read: {error}") from None
        self._by_target: dict[int, list[Any]] = {}
        for segment in self._spk.segments:
            if segment.data_type in (2, 3):
                self._by_target.setdefault(segment.target, []).append(segment)

    def reach(self, number: int) -> tuple[float, float]:
        """Days of TDB after J2000 between which a body's place is known; ValueError where it is not at all."""
        first, last = -np.inf, np.inf
        while number != BARYCENTRE:
            segments = self._segments(number)
            first = max(first, min(one.start_jd for one in segments) - J2000_DAY)
            last = min(last, max(one.end_jd for one in segments) - J2000_DAY)
            number = segments[0].center
        return first, last

    def position(self, number: int, days: np.ndarray) -> np.ndarray:
        """From the barycentre of the solar system (n, 3) m, ICRF, at days (n,) of TDB after J2000; ValueError for dates
        beyond."""
        found = np.zeros((len(days), 3))
        while number != BARYCENTRE:
            segments = self._segments(number)
            found += self._along(segments, days)
            number = segments[0].center
        return found

    def _segments(self, number: int) -> list[Any]:
        segments = self._by_target.get(number) or self._by_target.get(OTHER_NUMBERS.get(number, -1))
        if not segments:
            raise ValueError(f"{self.name} does not hold the body of NAIF's number {number}")
        return segments

    def _along(self, segments: list[Any], days: np.ndarray) -> np.ndarray:
        """(n, 3) m from the segments of one body that hold the days."""
        found = np.full((len(days), 3), np.nan)
        for segment in segments:
            held = (days >= segment.start_jd - J2000_DAY) & (days <= segment.end_jd - J2000_DAY)
            if held.any():  # two numbers for a date: one alone would round to 40 microseconds, a metre of Earth's way
                found[held] = 1e3 * segment.compute(J2000_DAY, days[held])[:3].T
        if np.isnan(found).any():
            raise ValueError(f"{self.name} does not reach over this run")
        return found


@lru_cache(maxsize=4)
def kernel(source: str) -> Kernel:
    """The kernel of a source: "de421" or a path. ModuleNotFoundError without the extra, ValueError for another file."""
    name = "DE421" if source == "de421" else Path(source).name
    return Kernel(kernel_file(source), name)
