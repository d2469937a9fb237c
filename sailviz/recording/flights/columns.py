"""Tables of a flight whose column names say what they are and in which unit; nothing else is guessed.

time_s or utc; x_km y_km z_km; vx_km_s vy_km_s vz_km_s          also x [km], "vx (km/s)", position_m.x, r_x_au
thrust: ax_m_s2 ...; normal: nx ny nz                            as an archive also time_s, position_km (n, 3) ...
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sailviz import files
from sailviz.constants import AU, DAY, YEAR
from sailviz.errors import RecordingError

LENGTHS = {"m": 1.0, "km": 1e3, "au": AU}
TIMES = {"s": 1.0, "sec": 1.0, "min": 60.0, "h": 3600.0, "d": DAY, "day": DAY, "days": DAY, "yr": YEAR}
SPEEDS = {f"{far}_{long}": LENGTHS[far] / TIMES[long] for far in LENGTHS for long in ("s", "h", "d", "day")}
PUSHES = {"m_s2": 1.0, "mm_s2": 1e-3, "km_s2": 1e3}
UNITS: dict[str, dict[str, float]] = {"time": TIMES, "position": LENGTHS, "velocity": SPEEDS, "thrust": PUSHES}
NONE: dict[str, float] = {"": 1.0}
NAMES = {  # of a column, without unit and signs -> what it is
    "time": ("time", "t", "statetime", "elapsed", "elapsedtime", "met"),
    "date": ("utc", "epoch", "date", "epochutc", "utcgregorian", "stateutc"),
    "position": ("position", "pos", "r", "stateposition"),
    "velocity": ("velocity", "vel", "v", "statevelocity"),
    "thrust": ("thrust", "a", "acceleration", "thrustacceleration"),
    "normal": ("normal", "n", "attitudenormal"),
}
CENTRES = {  # words of a column's name that say about which body its rows are -> its word
    **{
        word: word
        for word in ("sun", "mercury", "venus", "earth", "moon", "mars", "jupiter", "saturn", "uranus", "neptune")
    },
    "heliocentric": "sun",
    "geocentric": "earth",
    "selenocentric": "moon",
    "areocentric": "mars",
}
LONGEST_FILE = 4_000_000_000  # bytes
LARGEST = 1e28  # m, m/s, s: beyond everything
AXES = "xyz"


class Columns(NamedTuple):
    """A flight's columns. time (n,) s, or datetime64; epoch of time 0 where a file says it; position m, velocity m/s,
    thrust m/s2, normal (n, 3); centre : the body that the header names, "" for none."""

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    epoch: np.datetime64 | None = None
    thrust: np.ndarray | None = None
    normal: np.ndarray | None = None
    centre: str = ""


def read_columns(path: str | Path) -> Columns:
    """The columns of a table or an archive. RecordingError, in one sentence, where columns or units are lacking."""
    path = Path(path)
    if path.exists() and not path.is_file():
        raise RecordingError(f"cannot read {path}: it is not a regular file")
    try:
        if path.stat().st_size > LONGEST_FILE:
            raise RecordingError(f"{path} is too large for a table")
        raw = _archive(path) if path.suffix.lower() == ".npz" else _table(path)
    except OSError as error:
        raise RecordingError(f"cannot read {path}: {files.reason(error)}") from None
    centre, raw = _centre(raw, path)
    found = _sorted(raw, path)
    rows = {len(values) for values in found.values()}
    if len(rows) > 1:
        raise RecordingError(f"{path}: its columns have different lengths, {', '.join(map(str, sorted(rows)))}")
    lacking = [what for what in ("position", "velocity") if what not in found]
    if "time" not in found and "date" not in found:
        lacking.insert(0, "time")
    if lacking:
        raise RecordingError(f"{path} has no {' and no '.join(lacking)}: columns such as time_s, x_km, vx_km_s are due")
    time = found["time"] if "time" in found else found["date"]
    epoch = found["date"][0] - _shift(found["time"][0]) if {"time", "date"} <= set(found) and rows != {0} else None
    states = time, found["position"], found["velocity"], epoch
    return Columns(*states, found.get("thrust"), found.get("normal"), centre)


def _centre(raw: Mapping[str, np.ndarray], path: Path) -> tuple[str, dict[str, np.ndarray]]:
    """The body that names of columns say (x_earth_km, heliocentric_x [au]), "" for none, and the columns by their names
    without it. RecordingError where they say two."""
    found: dict[str, str] = {}
    named = {}
    for name, values in raw.items():
        words = re.split(r"([\s_.-]+)", name)
        bodies = [k for k, word in enumerate(words) if word.lower() in CENTRES]
        if len(bodies) == 1 and len(words) > 1:
            at = bodies[0]
            plain = "".join(words[:at] + words[at + 2 :]) if at + 2 < len(words) else "".join(words[: at - 1])
            if plain and _meaning(plain) is not None and plain not in raw:
                found.setdefault(CENTRES[words[at].lower()], name)
                name = plain
        named[name] = values
    if len(found) > 1:
        told = " and ".join(repr(name[:60]) for name in list(found.values())[:2])
        raise RecordingError(f"{path}: its columns {told} are about different bodies")
    return next(iter(found), ""), named


def _shift(seconds: float) -> np.timedelta64:
    return np.timedelta64(round(float(seconds) * 1e9), "ns")


def _archive(path: Path) -> Mapping[str, np.ndarray]:
    try:
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as stored:
            return {name: stored[name] for name in stored.files}
    except OSError:
        raise
    except Exception:  # damage shows in whatever way it meets numpy, zipfile or zlib
        raise RecordingError(f"{path} is not a table of numpy arrays, or is damaged or cut off") from None


def _table(path: Path) -> Mapping[str, np.ndarray]:
    import pyarrow as pa
    import pyarrow.csv
    import pyarrow.parquet

    try:
        table = (
            pa.csv.read_csv(path)
            if path.suffix.lower() == ".csv" and not _is_parquet(path)
            else pyarrow.parquet.read_table(path)
        )
        if len(set(table.column_names)) < len(table.column_names):
            raise RecordingError(f"{path}: two columns have one name")
        return {name.strip(): table[name].to_numpy() for name in table.column_names}
    except (pa.ArrowException, UnicodeDecodeError, ValueError, OSError) as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise
        words = " ".join(str(error).split())[:160]
        raise RecordingError(f"{path} is no table that can be read: {words}") from None


def _is_parquet(path: Path) -> bool:
    with open(path, "rb") as file:
        return file.read(4) == b"PAR1"


def _sorted(raw: Mapping[str, np.ndarray], path: Path) -> dict[str, np.ndarray]:
    """What the columns are -> their values in SI."""
    found: dict[str, np.ndarray] = {}
    parts: dict[str, dict[str, np.ndarray]] = {}
    for name, values in raw.items():
        meant = _meaning(name)
        if meant is None:
            continue
        what, axis, unit = meant
        if what == "date":
            found[what] = _dates(values, name, path)
            continue
        units = UNITS.get(what, NONE)
        if unit not in units:
            wanted = ", ".join(list(units)[:4])
            said = f"the unit {unit}" if unit else "no unit"
            raise RecordingError(f"{path}: the column {name[:60]!r} has {said}; its name ends in one such as {wanted}")
        with np.errstate(over="ignore", invalid="ignore"):  # what overflows is refused as no finite number
            numbers = _numbers(values, name, path) * units[unit]
            wild = np.isfinite(numbers) & (np.abs(numbers) > LARGEST)
        if wild.any():
            raise RecordingError(
                f"{path}: the column {name[:60]!r} holds {numbers[wild][0]:.3g} in SI, out of all bounds"
            )
        if axis:
            parts.setdefault(what, {})[axis] = numbers
        elif numbers.shape[1:] == (() if what == "time" else (3,)):
            found[what] = numbers
        else:
            raise RecordingError(f"{path}: the column {name[:60]!r} has the shape {numbers.shape}")
    for what, axes in parts.items():
        lacking = [axis for axis in AXES if axis not in axes]
        if lacking:
            raise RecordingError(f"{path}: of the {what} the {', '.join(lacking)} is lacking")
        if len({len(values) for values in axes.values()}) > 1:
            raise RecordingError(f"{path}: the columns of the {what} have different lengths")
        found[what] = np.stack([axes[axis] for axis in AXES], 1)
    return found


def _meaning(name: str) -> tuple[str, str, str] | None:
    """(what, axis, unit) that a column's name says, None for one that is none of ours. x_km, x [km], position_m.x."""
    text = name.strip().lower()
    bracket = re.search(r"[\[(]([^\])]*)[\])]\s*$", text)
    unit = re.sub(r"\W+", "_", bracket.group(1).replace("^", "").replace("**", "")).strip("_") if bracket else ""
    text = text[: bracket.start()] if bracket else text
    own = re.fullmatch(r"(.*)\.([xyz])", text.strip())
    axis, text = (own.group(2), own.group(1)) if own else ("", text)
    for what, words in NAMES.items():
        units = sorted(UNITS.get(what, NONE), key=len, reverse=True)
        for word in [unit] if bracket else [*units, ""]:
            stem = text.strip().removesuffix(word).rstrip("_ .-") if word and not bracket else text.strip()
            if word and not bracket and not re.search(rf"[_ .-]{re.escape(word)}$", text.strip()):
                continue
            plain = re.sub(r"[\W_]+", "", stem)
            if axis and plain in words:
                return what, axis, word
            if not axis and plain in words:
                return what, "", word
            found = _axis_of(plain, what, words)
            if not axis and found:
                return what, found, word
    return None


def _axis_of(plain: str, what: str, words: tuple[str, ...]) -> str:
    """The axis that a word ends in: rx, posx, velocityx, xdot; x alone is a place."""
    if what in ("time", "date"):
        return ""
    if what == "position" and plain in AXES:
        return plain
    if what == "velocity" and plain in ("xdot", "ydot", "zdot"):
        return plain[0]
    return plain[-1:] if plain[:-1] in words and plain[-1:] in AXES and plain else ""


def _numbers(values: np.ndarray, name: str, path: Path) -> np.ndarray:
    try:
        return np.asarray(values).astype(float)
    except (TypeError, ValueError):
        raise RecordingError(f"{path}: the column {name[:60]!r} holds no numbers") from None


def _dates(values: np.ndarray, name: str, path: Path) -> np.ndarray:
    try:
        found = np.asarray(values).astype("datetime64[ns]")
    except (TypeError, ValueError, OverflowError):
        raise RecordingError(f"{path}: the column {name[:60]!r} holds no dates") from None
    if found.ndim != 1 or np.isnat(found).any():
        raise RecordingError(f"{path}: the column {name[:60]!r} holds what is no date")
    return found
