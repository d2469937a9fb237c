"""Measured and predicted space weather by day, read from the files of CelesTrak, CSSI and GFZ, and what the air's model
NRLMSIS is given of it.

F10.7 is the radio flux of the Sun at the Earth ("observed", not adjusted to 1 au), sfu; ap the geomagnetic index of
three hours, Ap its mean over a day. Nothing is filled or continued without being counted in `SpaceWeather.kind`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sailviz.constants import YEAR
from sailviz.environment import solar_level
from sailviz.ephemeris import decimal_year

OBSERVED, INTERPOLATED, PREDICTED, CONTINUED = "observed", "interpolated", "predicted", "continued"
KINDS = (OBSERVED, INTERPOLATED, PREDICTED, CONTINUED)
A_DAY = 8  # values of ap
WINDOW = 81  # days of the mean flux, the day itself in the middle
HIGHEST_FLUX = 400.0  # sfu; above, a radio burst of the Sun and no measure of its ultraviolet light
HIGHEST_AP = 400.0
DAYS_BEFORE = 3  # that NRLMSIS looks back from a day: its ap of 57 h ago
ELEVEN_YEARS = 4018  # d
LONGEST_FILE = 64_000_000  # bytes; all days since 1932 are 5 million

CELESTRAK = {"DATE": 0, "AP1": 12, "AP_AVG": 20, "F10.7_OBS": 24, "F10.7_DATA_TYPE": 26, "F10.7_OBS_CENTER81": 27}
CELESTRAK_KINDS = {"OBS": OBSERVED, "INT": INTERPOLATED, "PRD": PREDICTED}
# columns of FORMAT(I4,I3,I3,I5,I3,8I3,I4,8I4,I4,F4.1,I2,I4,F6.1,I2,5F6.1), CSSI's, from 0, ends open
CSSI_AP, CSSI_MEAN_AP, CSSI_QUALIFIER, CSSI_FLUX, CSSI_MEAN_FLUX = 46, (78, 82), (98, 100), (112, 118), (118, 124)
CSSI_SECTIONS = {"OBSERVED": OBSERVED, "DAILY_PREDICTED": PREDICTED, "MONTHLY_PREDICTED": None}
CSSI_INTERPOLATED = 4
GFZ_COLUMNS, GFZ_AP, GFZ_MEAN_AP, GFZ_FLUX = 28, 15, 23, 25

Row = tuple[np.datetime64, str, list[float], float, float, float]  # day, kind, ap (8), Ap, F10.7, its mean or NaN


@dataclass(frozen=True)
class SpaceWeather:
    """Consecutive days. first : datetime64[D]; kind (n,) of KINDS; ap (n, 8) from 00 UTC on; mean_ap (n,); flux (n,)
    observed F10.7, sfu, and mean_flux (n,), its mean over 81 days centred on the day; short (n,) bool: where fewer days
    than that went into the mean."""

    first: np.datetime64
    kind: np.ndarray
    ap: np.ndarray
    mean_ap: np.ndarray
    flux: np.ndarray
    mean_flux: np.ndarray
    short: np.ndarray

    @property
    def last(self) -> np.datetime64:
        """The last day."""
        return self.first + (len(self.flux) - 1)

    def counts(self, start: np.datetime64, duration: float) -> dict[str, int]:
        """How many days of a run, from its date (UTC) on and s long, are of each kind; kinds of no day left out."""
        kind = self.kind[self._places(_days(start, duration))]
        return {word: int(np.count_nonzero(kind == word)) for word in KINDS if word in kind}

    def short_means(self, start: np.datetime64, duration: float) -> int:
        """How many days of a run have a mean flux of fewer than 81 days."""
        return int(np.count_nonzero(self.short[self._places(_days(start, duration))]))

    def _places(self, days: np.ndarray) -> np.ndarray:
        place: np.ndarray = (days - self.first) // np.timedelta64(1, "D")
        if place.min() < 0 or place.max() >= len(self.flux):
            raise ValueError(f"the days run from {self.first} to {self.last}, not from {days.min()} to {days.max()}")
        return place

    def given(self, dates: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """What NRLMSIS takes at dates (k,) UTC: F10.7 of the day before (k,), its mean centred on the day (k,), and
        (k, 7) the day's Ap, then ap of these three hours and of those 3, 6 and 9 h before, and the means of eight
        values from 12 to 33 h and from 36 to 57 h before. ValueError for dates beyond the days."""
        dates = np.asarray(dates, "datetime64[s]")
        days = dates.astype("datetime64[D]")
        place = self._places(days)
        self._places(days.min() - np.arange(DAYS_BEFORE + 1))
        now = place * A_DAY + ((dates - days) // np.timedelta64(3, "h")).astype(int)
        ap = self.ap.ravel()
        columns = [self.mean_ap[place], *(ap[now - back] for back in range(4))]
        columns += [ap[now[:, None] - np.arange(first, first + 8)].mean(axis=1) for first in (4, 12)]
        return self.flux[place - 1], self.mean_flux[place], np.column_stack(columns)

    def continued(
        self, until: np.datetime64, flux_of: Callable[[np.ndarray], np.ndarray] | None, ap: float
    ) -> SpaceWeather:
        """The same, the days after the last up to `until` (datetime64[D]) filled: by a flux, days (k,) -> sfu, and a
        constant ap; or, without flux_of, by the days 11 years earlier. ValueError where those are lacking too."""
        lacking = int((until - self.last) // np.timedelta64(1, "D"))
        if lacking <= 0:
            return self
        days = self.last + 1 + np.arange(lacking)
        found = self
        if flux_of is not None:
            flux = flux_of(days)
            return self._longer(
                np.full((lacking, A_DAY), ap), np.full(lacking, ap), flux, flux, np.zeros(lacking, bool)
            )
        while len(days := found.last + 1 + np.arange(int((until - found.last) // np.timedelta64(1, "D")))):
            days = days[:ELEVEN_YEARS]
            if days[0] - ELEVEN_YEARS < found.first:
                raise ValueError(f"11 years before {days[0]} there are no days either: they begin on {found.first}")
            place = found._places(days - ELEVEN_YEARS)
            parts = (found.ap[place], found.mean_ap[place], found.flux[place], found.mean_flux[place])
            found = found._longer(*parts, found.short[place])
        return found

    def _longer(self, ap, mean_ap, flux, mean_flux, short) -> SpaceWeather:
        join = np.concatenate
        return SpaceWeather(
            self.first,
            join([self.kind, np.full(len(flux), CONTINUED)]),
            join([self.ap, ap]),
            join([self.mean_ap, mean_ap]),
            join([self.flux, flux]),
            join([self.mean_flux, mean_flux]),
            join([self.short, short]),
        )


def cycle_flux(days: np.ndarray) -> np.ndarray:
    """F10.7, sfu, of the smooth solar cycle (`solar_level.cycle`) on days (k,)."""
    start = days[0].astype("datetime64[s]")
    seconds = (days - days[0]) / np.timedelta64(1, "s")
    p = solar_level.cycle(decimal_year(start))
    values: np.ndarray = p.mean - p.swing * np.cos(p.phase + 2 * np.pi / (solar_level.PERIOD * YEAR) * seconds)
    return values


def _days(start: np.datetime64, duration: float) -> np.ndarray:
    """The days (k,) of UTC that a run touches."""
    first = start.astype("datetime64[D]")
    last = (start.astype("datetime64[ms]") + np.timedelta64(round(duration * 1e3), "ms")).astype("datetime64[D]")
    return np.arange(first, last + 1)


def read(path: str | Path) -> SpaceWeather:
    """The days of a file: CelesTrak's CSV (SW-All.csv), CSSI's text (SpaceWeather-All-v1.2.txt), or the table of GFZ
    (Kp_ap_Ap_SN_F107_since_1932.txt), told by their content.

    Monthly predictions are left out, since they have no ap. A flux that is missing, not positive or above 400 sfu (a
    radio burst) becomes the mean of its 81 days and counts as interpolated. GFZ has no such mean: it is made of the
    observed days, fewer at the ends. ValueError, naming the line, for what is no such file, for days that are missing
    or come twice, and for values that cannot be.
    """
    size = Path(path).stat().st_size
    if size > LONGEST_FILE:
        raise ValueError(f"{size / 1e6:,.0f} MB are too much for a file of space weather")
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError("this is no text, and so no file of space weather") from None
    lines = text.splitlines()
    begin = next((line for line in lines if line.strip()), "")
    if begin.startswith("DATE,"):
        rows = _celestrak(lines)
    elif "BEGIN OBSERVED" in text:
        rows = _cssi(lines)
    elif any(len(line.split()) == GFZ_COLUMNS for line in lines if line.strip() and not line.startswith("#")):
        rows = _gfz(lines)
    else:
        raise ValueError(
            "this is no file of space weather that is known: CelesTrak's CSV begins with DATE, CSSI's text has a line "
            f"BEGIN OBSERVED, and the rows of GFZ have {GFZ_COLUMNS} numbers"
        )
    return _consecutive(list(rows))


def _numbered(lines: list[str]) -> Iterator[tuple[int, str]]:
    return ((number, line) for number, line in enumerate(lines, 1) if line.strip())


def _celestrak(lines: list[str]) -> Iterator[tuple[int, Row]]:
    header: list[str] | None = None
    for number, line in _numbered(lines):
        words = line.split(",")
        if header is None:
            header = words
            missing = [name for name, at in CELESTRAK.items() if len(words) <= at or words[at].strip() != name]
            if missing:
                raise ValueError(f"line {number}: column {CELESTRAK[missing[0]]} is not {missing[0]}")
            continue
        if len(words) != len(header):
            raise ValueError(f"line {number} has {len(words)} columns, not {len(header)}: the file may be cut")
        word = words[CELESTRAK["F10.7_DATA_TYPE"]].strip()
        if word == "PRM":
            continue
        if word not in CELESTRAK_KINDS:
            raise ValueError(f"line {number}: the flux is of the type {word!r}, not OBS, INT, PRD or PRM")
        at = CELESTRAK["AP1"]
        named = [words[CELESTRAK[name]] for name in ("AP_AVG", "F10.7_OBS", "F10.7_OBS_CENTER81")]
        yield number, _row(number, words[0].strip(), CELESTRAK_KINDS[word], words[at : at + A_DAY], *named)


def _cssi(lines: list[str]) -> Iterator[tuple[int, Row]]:
    section, ended = "", False
    for number, line in _numbered(lines):
        if line.startswith("BEGIN "):
            section = line[6:].strip()
            if section not in CSSI_SECTIONS:
                raise ValueError(f"line {number}: there is no section {section!r} in such a file")
            continue
        if line.startswith("END "):
            section, ended = "", ended or line[4:].strip() == "OBSERVED"
            continue
        kind = CSSI_SECTIONS.get(section)
        if kind is None or line.startswith("#"):
            continue
        if len(line.rstrip()) < CSSI_MEAN_FLUX[1]:
            raise ValueError(f"line {number} has {len(line.rstrip())} characters, fewer than {CSSI_MEAN_FLUX[1]}")
        if kind == OBSERVED and line[slice(*CSSI_QUALIFIER)].strip() == str(CSSI_INTERPOLATED):
            kind = INTERPOLATED
        day = "-".join((line[:4], line[4:7].strip().zfill(2), line[7:10].strip().zfill(2)))
        ap = [line[CSSI_AP + 4 * k : CSSI_AP + 4 * k + 4] for k in range(A_DAY)]
        rest = (line[slice(*place)] for place in (CSSI_MEAN_AP, CSSI_FLUX, CSSI_MEAN_FLUX))
        yield number, _row(number, day, kind, ap, *rest)
    if section or not ended:
        raise ValueError(f"the section {section or 'OBSERVED'} has no end: the file is cut")


def _gfz(lines: list[str]) -> Iterator[tuple[int, Row]]:
    for number, line in _numbered(lines):
        if line.startswith("#"):
            continue
        words = line.split()
        if len(words) != GFZ_COLUMNS:
            raise ValueError(f"line {number} has {len(words)} columns, not {GFZ_COLUMNS}: the file may be cut")
        day = "-".join(words[:3])
        given = words[GFZ_AP : GFZ_AP + A_DAY], words[GFZ_MEAN_AP], words[GFZ_FLUX], "nan"
        if any(word.startswith("-1") for word in (*given[0], given[1])):
            return  # the current day, whose hours are not over
        yield number, _row(number, day, OBSERVED, *given)


def _row(number: int, day: str, kind: str, ap: list[str], mean_ap: str, flux: str, mean_flux: str) -> Row:
    """One day from its words. ValueError, with the line, for what are no numbers or cannot be."""
    try:
        if len(day) != 10:
            raise ValueError
        date = np.datetime64(day, "D")
    except ValueError:
        raise ValueError(f"line {number}: {day!r} is no day") from None
    try:
        indices, rest = [float(word) for word in ap], [float(word) for word in (mean_ap, flux, mean_flux)]
    except ValueError:
        raise ValueError(f"line {number}, {day}: a number is missing or is none") from None
    if not all(0 <= value <= HIGHEST_AP for value in (*indices, rest[0])):
        raise ValueError(f"line {number}, {day}: ap must lie between 0 and {HIGHEST_AP:g}")
    if np.isinf(rest[1]) or rest[2] <= 0 or rest[2] > HIGHEST_FLUX:
        raise ValueError(f"line {number}, {day}: the mean flux must lie between 0 and {HIGHEST_FLUX:g} sfu")
    return date, kind, indices, rest[0], rest[1], rest[2]


def _consecutive(rows: list[tuple[int, Row]]) -> SpaceWeather:
    if not rows:
        raise ValueError("there are no days in this file")
    numbers, days = [number for number, _ in rows], np.array([row[0] for _, row in rows])
    steps = np.diff(days).astype(int)
    if len(steps) and (steps != 1).any():
        i = int(np.argmax(steps != 1))
        what = "days are missing" if steps[i] > 1 else "the days do not follow each other"
        raise ValueError(f"line {numbers[i + 1]}: {what} between {days[i]} and {days[i + 1]}")
    kind = np.array([row[1] for _, row in rows], dtype=f"U{max(map(len, KINDS))}")
    ap = np.array([row[2] for _, row in rows])
    mean_ap, flux, mean_flux = (np.array([row[at] for _, row in rows]) for at in (3, 4, 5))
    bad = ~((flux > 0) & (flux <= HIGHEST_FLUX))
    short = np.zeros(len(rows), dtype=bool)
    if np.isnan(mean_flux).any():
        mean_flux, short = _means(np.where(bad, np.nan, flux), mean_flux)
    kind[bad & (kind == OBSERVED)] = INTERPOLATED
    flux = np.where(bad, mean_flux, flux)
    if np.isnan(flux).any():
        raise ValueError(f"on {days[np.argmax(np.isnan(flux))]} and around it there is no flux")
    return SpaceWeather(days[0], kind, ap, mean_ap, flux, mean_flux, short)


def _means(flux: np.ndarray, known: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(mean of the flux over 81 days, centred, where it is not known, and where days are lacking for it)."""
    half = WINDOW // 2
    there = ~np.isnan(flux)
    totals = np.concatenate([[0.0], np.cumsum(np.where(there, flux, 0.0))])
    counts = np.concatenate([[0], np.cumsum(there)])
    low = np.maximum(np.arange(len(flux)) - half, 0)
    high = np.minimum(np.arange(len(flux)) + half + 1, len(flux))
    found = counts[high] - counts[low]
    with np.errstate(invalid="ignore"):
        mean = np.where(found > 0, (totals[high] - totals[low]) / np.maximum(found, 1), np.nan)
    return np.where(np.isnan(known), mean, known), np.isnan(known) & (high - low < WINDOW)
