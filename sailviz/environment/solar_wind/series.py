"""A measured solar wind: read from files, checked, its gaps filled and counted.

Nothing is changed without a count in `Series.repairs`; what cannot be repaired is refused in a sentence.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sailviz.constants import DAY
from sailviz.units import UNITS

FEWEST_VALUES = 48
MOST_ROWS = 10_000_000  # with the gaps; a millennium of hours
LONGEST_GAP = 5 * DAY  # s; the longest of OMNI2 1998-2018 is 73 h
USUAL = {  # of a median at 1 au, SI; years and solar minima stay far inside, a wrong unit falls far outside
    "pressure": (2e-10, 2e-8, "Pa"),
    "speed": (1.5e5, 1.5e6, "m/s"),
    "density": (2e5, 2e8, "1/m3"),
}
DIMENSIONS = {"pressure": "pressure", "speed": "speed", "density": "number_density"}

# NASA OMNI2, hourly: https://omniweb.gsfc.nasa.gov/html/ow_data.html; words from 1, and their fill values
OMNI_WORDS = {"density": (24, 999.9, 1e6), "speed": (25, 9999.0, 1e3), "pressure": (29, 99.99, 1e-9)}


@dataclass(frozen=True)
class Repairs:
    """What was done to a series before use."""

    filled: int = 0  # pressures that were missing, from neighbours linearly in time on ln p
    gaps: int = 0
    longest_gap: float = 0.0  # s
    filled_speed: int = 0  # speeds or densities, likewise
    refused: int = 0  # values that were zero, negative or infinite, taken as missing
    reordered: int = 0  # rows that stood before an earlier one
    repeated: int = 0  # rows of a time that was there before, left out
    trimmed: int = 0  # missing pressures before the first and after the last one

    def __str__(self):
        words = (
            (self.filled, f"missing pressures filled in {self.gaps} gaps, the longest {self.longest_gap / 3600:g} h"),
            (self.filled_speed, "missing speeds and densities filled"),
            (self.refused, "values that were not positive taken as missing"),
            (self.reordered, "rows sorted"),
            (self.repeated, "repeated rows left out"),
            (self.trimmed, "missing rows at the ends cut off"),
        )
        return "; ".join(f"{count} {what}" for count, what in words if count) or "nothing to repair"


@dataclass(frozen=True)
class Series:
    """Solar wind at 1 au in equal steps, each value holding until the next.

    start : UTC of the first value, or None. step : s. pressure (n,) Pa; measured (n,) bool, False where it was filled;
    speed (n,) m/s and density (n,) 1/m3, or None.
    """

    start: np.datetime64 | None
    step: float
    pressure: np.ndarray
    measured: np.ndarray
    speed: np.ndarray | None
    density: np.ndarray | None
    repairs: Repairs

    @property
    def duration(self) -> float:
        return self.step * len(self.pressure)

    def reference_pressure(self, unbiased=False) -> float:
        """Mean pressure, Pa, or (E sqrt p)^2, with which the mean thrust is nominal; filled values do not count."""
        p = self.pressure[self.measured]
        return float(np.sqrt(p).mean() ** 2 if unbiased else p.mean())

    def index(self, start) -> int:
        """Index of the value that holds at a time (datetime64 or ISO text), or an index checked. ValueError outside."""
        if isinstance(start, (int, np.integer)):
            at = int(start)
        elif self.start is None:
            raise ValueError("the series has no dates: name the start of a replay by its index")
        else:
            try:
                ahead = np.datetime64(start, "ns") - self.start.astype("datetime64[ns]")
            except ValueError:
                raise ValueError(f"{start!r} is no date like 2003-01-01") from None
            at = int(np.floor(ahead / np.timedelta64(1, "ns") * 1e-9 / self.step))
        if not 0 <= at < len(self.pressure):
            raise ValueError(f"{start} lies outside the series, which {self._reach()}")
        return at

    def _reach(self):
        if self.start is None:
            return f"has {len(self.pressure)} values"
        end = self.start + np.timedelta64(round(self.duration * 1e3), "ms")
        return f"runs from {self.start.astype('datetime64[h]')} to {end.astype('datetime64[h]')}"


def _repeated(seconds, pressure, repair):
    """Which of increasing times repeat the one before. ValueError where the pressures differ, unless told to repair."""
    again = np.diff(seconds, prepend=-np.inf) == 0
    if again.any() and not repair:
        before = np.roll(pressure, 1)
        clash = again & (pressure != before) & ~(np.isnan(pressure) & np.isnan(before))
        if clash.any():
            raise ValueError(f"{clash.sum()} times come twice with different pressures (repair=True takes the first)")
    return again


def _on_even_steps(seconds, columns, most_rows):
    """(usual step s, columns with NaN at the times that were left out). ValueError for irregular times."""
    step = float(np.median(np.diff(seconds)))
    rows = (seconds[-1] - seconds[0]) / step + 1
    if not rows <= most_rows:
        raise ValueError(
            f"{len(seconds):,} rows in steps of {step:g} s span {rows:,.12g} of them with their gaps (some "
            f"{8 * len(columns) * rows / 1e9:,.3g} GB), more than the {most_rows:,} "
            "that most_rows (limits.draws of a scene) allows"
        )
    place = np.rint((seconds - seconds[0]) / step).astype(int)
    off = np.abs(seconds - seconds[0] - place * step) / step
    if off.max() > 0.01 or (np.diff(place) == 0).any():
        raise ValueError(
            f"times are not spaced evenly: the usual step is {step:g} s, some lie {off.max():.2g} steps off"
        )
    full = {name: np.full(place[-1] + 1, np.nan) for name in columns}
    for name, x in columns.items():
        full[name][place] = x
    return step, full


def series(
    time, pressure, speed=None, density=None, *, longest_gap=LONGEST_GAP, repair=False, most_rows=MOST_ROWS
) -> Series:
    """A Series from columns (n,): time as datetime64 or s, pressure Pa, speed m/s, density 1/m3; NaN is missing.

    Times may leave rows out, stand in the wrong order or repeat themselves; gaps are filled linearly in time on the
    logarithm. repair : take values that are not positive and finite as missing, and the first of two different values
    of one time. ValueError for those without it, for a gap above longest_gap (s), a wrong unit (by the median),
    irregular times, fewer than 48 values and, gaps included, more than most_rows.
    """
    columns = {"pressure": pressure, "speed": speed, "density": density}
    columns = {name: np.array(x, dtype=float) for name, x in columns.items() if x is not None}
    time = np.asarray(time)
    for name, x in columns.items():
        if x.shape != time.shape or x.ndim != 1:
            raise ValueError(f"{name} has the shape {x.shape}, the times {time.shape}; both must be (n,)")
    dated = np.issubdtype(time.dtype, np.datetime64)
    seconds = (time - time[:1]) / np.timedelta64(1, "ms") * 1e-3 if dated else time.astype(float)
    if not np.isfinite(seconds).all():
        raise ValueError(f"{np.sum(~np.isfinite(seconds))} times are missing")
    refused = _without_impossible(columns, repair)
    if len(time) < FEWEST_VALUES or np.isfinite(columns["pressure"]).sum() < FEWEST_VALUES:
        valid = int(np.isfinite(columns["pressure"]).sum())
        raise ValueError(f"the series has {valid} pressures; {FEWEST_VALUES} are needed")
    for name, x in columns.items():
        _in_unit(name, x)

    reordered = int(np.sum(seconds < np.maximum.accumulate(seconds)))
    order = np.argsort(seconds, kind="stable")
    sorted_columns = {name: x[order] for name, x in columns.items()}
    again = _repeated(seconds[order], sorted_columns["pressure"], repair)
    if np.sum(~again) < FEWEST_VALUES:
        raise ValueError(f"the series has {np.sum(~again)} different times; {FEWEST_VALUES} are needed")
    kept = {name: x[~again] for name, x in sorted_columns.items()}
    step, full = _on_even_steps(seconds[order][~again], kept, most_rows)

    measured = np.isfinite(full["pressure"])
    first, end = np.flatnonzero(measured)[[0, -1]] + (0, 1)
    trimmed = len(measured) - (end - first)
    full, measured = {name: x[first:end] for name, x in full.items()}, measured[first:end]
    gaps = _gaps(measured)
    longest = step * max(gaps, default=0)
    if longest > longest_gap:
        raise ValueError(
            f"the longest gap lasts {longest / 3600:g} h, up to {longest_gap / 3600:g} h are filled; "
            f"{int(np.sum(~measured))} of {len(measured)} pressures are missing"
        )
    others = _missing(full)
    full = {name: _filled(x) for name, x in full.items()}
    first_kept = np.timedelta64(round(1e3 * first * step), "ms")
    start = time[order[0]].astype("datetime64[ms]") + first_kept if dated else None
    filled = int(np.sum(~measured))
    repairs = Repairs(filled, len(gaps), longest, others, refused, reordered, int(again.sum()), int(trimmed))
    return Series(start, step, full["pressure"], measured, full.get("speed"), full.get("density"), repairs)


def _missing(full) -> int:
    """How many speeds and densities are missing. ValueError where all of one are."""
    others = {name: full[name] for name in ("speed", "density") if name in full}
    for name, values in others.items():
        if not np.isfinite(values).any():
            raise ValueError(f"the {name} is missing throughout")
    return sum(int(np.sum(~np.isfinite(values))) for values in others.values())


def _without_impossible(columns, repair):
    """Count of values that cannot be, which become missing in place if that is allowed."""
    count = 0
    for name, x in columns.items():
        bad = ~np.isnan(x) & ~((x > 0) & (x < np.inf))
        if bad.any() and not repair:
            raise ValueError(
                f"{bad.sum()} values of {name} are zero, negative or infinite, the first {x[bad][0]:g} in row "
                f"{int(np.argmax(bad))} (repair=True takes them as missing)"
            )
        x[bad] = np.nan
        count += int(bad.sum())
    return count


def _in_unit(name, x):
    """ValueError if the median cannot be the solar wind's at 1 au."""
    known = x[np.isfinite(x)]
    low, high, unit = USUAL[name]
    if not len(known) or low <= np.median(known) <= high:
        return
    median = float(np.median(known))
    guess = ""
    for spelling, factor in UNITS[DIMENSIONS[name]].items():
        if factor != 1 and low <= median * factor <= high:
            guess = f"; the numbers look like {spelling} taken for {unit}"
        elif factor != 1 and low <= median / factor <= high:
            guess = f"; the numbers look like {unit} taken for {spelling}"
    raise ValueError(f"the median {name} is {median:.4g} {unit}, usual are {low:g} to {high:g}{guess}")


def check_pressures(pressure) -> tuple[np.ndarray, int]:
    """(the pressures that are there (n,) Pa, the number of NaN left out) for a fit; ValueError as in `series`."""
    x = np.array(pressure, dtype=float).ravel()
    _without_impossible({"pressure": x}, False)
    known = x[~np.isnan(x)]
    if len(known) < FEWEST_VALUES:
        raise ValueError(f"the series has {len(known)} pressures; {FEWEST_VALUES} are needed")
    _in_unit("pressure", known)
    return known, len(x) - len(known)


def _gaps(measured):
    """Lengths of the stretches that are False."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], ~measured, [0]]).astype(int)))
    return np.diff(edges)[::2].tolist()


def _filled(x):
    known = np.flatnonzero(np.isfinite(x))
    if len(known) == len(x):
        return x
    out = x.copy()
    missing = np.flatnonzero(~np.isfinite(x))
    out[missing] = np.exp(np.interp(missing, known, np.log(x[known])))
    return out


def read_omni(path, **options) -> Series:
    """The hourly OMNI2 text files of NASA (omni2_YYYY.dat): one file, several, or a folder of them.

    Words 24 (protons per cm3), 25 (km/s) and 29 (flow pressure, nPa, alpha particles included), fill values 999.9,
    9999. and 99.99 taken as missing. options : those of `series`. ValueError names file and line of what is no such
    row.
    """
    files = [Path(file) for file in ([path] if isinstance(path, (str, Path)) else path)]
    if len(files) == 1 and files[0].is_dir():
        files = sorted(files[0].glob("omni2_*.dat"))
    if not files:
        raise ValueError(f"{path}: no omni2_YYYY.dat in this folder")
    hours, rows = [], []
    for file in files:
        if file.exists() and not file.is_file():  # a pipe or a device may never end
            raise ValueError(f"{file}: not a regular file")
        with open(file, encoding="ascii", errors="replace") as lines:
            for number, line in enumerate(lines, 1):
                words = line.split()
                if not words:
                    continue
                try:
                    year, day, hour = int(words[0]), int(words[1]), int(words[2])
                    row = [float(words[word - 1]) for word, _, _ in OMNI_WORDS.values()]
                    if not (1963 <= year <= 2200 and 1 <= day <= 366 and 0 <= hour <= 23):
                        raise ValueError
                except (ValueError, IndexError):
                    raise ValueError(
                        f"{file}, line {number}: no hourly OMNI2 row (year, day, hour, 29 words or more)"
                    ) from None
                hours.append(((year - 1970), (day - 1) * 24 + hour))
                rows.append(row)
    year_hour = np.array(hours, dtype=int).reshape(-1, 2)
    time = year_hour[:, 0].astype("datetime64[Y]").astype("datetime64[h]") + year_hour[:, 1]
    values = np.array(rows).reshape(-1, len(OMNI_WORDS)).T
    columns = {}
    for (name, (_, fill, factor)), x in zip(OMNI_WORDS.items(), values, strict=True):
        columns[name] = np.where(x == fill, np.nan, x) * factor
    return _named(files[0] if len(files) == 1 else files[0].parent, time, columns, options)


def read_series(path, columns=None, **options) -> Series:
    """A Series from .csv (with a header), .npz or .parquet, or an OMNI2 text file for any other ending.

    Columns carry their unit: pressure_nPa or pressure_Pa, and if there, speed_km_s or speed_m_s, density_per_cm3 or
    density_per_m3; time is utc (ISO) or time_s, time_min, time_h, time_d, time_yr. columns : {our name: the name in the
    file}. Empty cells and NaN are missing. options : those of `series`.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in (".csv", ".npz", ".parquet"):
        return read_omni(path, **options)
    if path.exists() and not path.is_file():
        raise ValueError(f"{path}: not a regular file")
    table = {".csv": _csv, ".npz": _npz, ".parquet": _parquet}[ending](path)
    ours = {theirs: name for name, theirs in (columns or {}).items()}
    lost = sorted(set(ours) - set(table))
    if lost:
        raise ValueError(f"{path}: there is no column {', '.join(lost)}, only {', '.join(table)}")
    table = {ours.get(name, name): column for name, column in table.items()}
    found = {}
    for name, dimension in DIMENSIONS.items():
        for unit, factor in UNITS[dimension].items():
            if f"{name}_{unit}" in table:
                found[name] = factor * _numbers(path, f"{name}_{unit}", table[f"{name}_{unit}"])
    if "pressure" not in found:
        raise ValueError(f"{path}: no column pressure_nPa or pressure_Pa; there are {', '.join(table)}")
    time = None
    if "utc" in table:
        try:
            time = np.asarray(table["utc"]).astype("datetime64[ms]")
        except ValueError:
            raise ValueError(f"{path}: the column utc holds something else than ISO dates") from None
    for unit, factor in UNITS["time"].items():
        if f"time_{unit}" in table:
            time = factor * _numbers(path, f"time_{unit}", table[f"time_{unit}"])
    if time is None:
        raise ValueError(f"{path}: no column utc or time_h (or another unit); there are {', '.join(table)}")
    return _named(path, time, found, options)


def _named(path, time, columns, options):
    try:
        return series(time, **columns, **options)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def _numbers(path, name, column):
    if isinstance(column, list):
        column = [cell.strip() or "nan" for cell in column]
    try:
        return np.asarray(column, dtype=float)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{path}: column {name} is not made of numbers ({error})") from None


def _csv(path):
    import csv

    def read():
        with open(path, newline="", encoding="utf-8-sig") as file:
            return [row for row in csv.reader(file) if row]

    rows = _decoded(path, read, "table of text in UTF-8")
    if not rows:
        raise ValueError(f"{path}: the file is empty")
    head = [name.strip() for name in rows[0]]
    for number, row in enumerate(rows[1:], 2):
        if len(row) != len(head):
            raise ValueError(f"{path}, row {number}: {len(row)} cells under {len(head)} names")
    return {name: [row[i] for row in rows[1:]] for i, name in enumerate(head)}


def _npz(path):
    def columns():
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as archive:
            return {name: archive[name] for name in archive.files}

    return _decoded(path, columns, "npz file of plain arrays")


def _parquet(path):
    from pyarrow import parquet

    def columns():
        table = parquet.ParquetFile(path, page_checksum_verification=True).read()
        table.validate(full=True)
        return {name: table[name].to_numpy() for name in table.column_names}

    return _decoded(path, columns, "parquet file that can be read")


def _decoded(path, columns, what):
    """What `columns` reads of a file. ValueError for damage, which shows in whatever way it meets the decoder."""
    try:
        return columns()
    except FileNotFoundError:
        raise
    except Exception as error:
        why = (str(error).splitlines() or [""])[0][:160] or type(error).__name__
        raise ValueError(f"{path}: no {what} ({why})") from None
