"""CK kernels: the file in which SPICE and Cosmographia exchange attitudes, with the two text kernels that it needs.

Written are segments of type 3: quaternions and rates on rows of any spacing, between which SPICE turns the craft
evenly, within intervals that say where it may. Dates are ticks of a clock (SCLK) of 1 us, which begins at J2000, or 100
years before it; a frame kernel names the craft's axes. Source: NAIF, "CK Required Reading", "SCLK Required Reading",
"Frames Required Reading" (arrays and keywords; read); tests hold what is written to CSPICE.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sailviz import files
from sailviz.errors import RecordingError
from sailviz.exchange import daf, spk

KIND = 3
NUMBERS = 7  # of a row: quaternion and rates
DIRECTORY = 100  # rows or intervals between those that a directory repeats
TICKS = 1e6  # in a second
EARLY = -36_525 * 86_400.0  # s of TDB after J2000, where the clock of a flight begins that is before J2000
LATEST = 2.0**53 / TICKS  # s after its beginning, until which a float64 counts the ticks
LARGEST_ID = 2_147_483  # of a craft, whose instruments have a thousand times its number
OWN_FRAMES = range(400_000, 1_000_000)  # of craft whose axes have a number that NAIF leaves to everybody
UNIT_LENGTH = 1e-2  # by which a quaternion's length may be off 1


@dataclass(frozen=True)
class Pointing:
    """An unbroken stretch of attitude. et (n,) s of TDB after J2000, increasing; quaternion (n, 4) x y z w, from the
    craft's axes to those of the frame."""

    et: np.ndarray
    quaternion: np.ndarray


@dataclass(frozen=True)
class Attitudes:
    """A segment as a kernel has it. ticks (n,); quaternion (n, 4) as above; rates (n, 3) rad/s in the frame; begins :
    rows with which intervals begin; frame : NAIF's word, or its number where that has none here."""

    name: str
    instrument: int
    frame: str
    ticks: np.ndarray
    quaternion: np.ndarray
    rates: np.ndarray
    begins: tuple[int, ...]


def instrument(craft: int) -> int:
    """NAIF's number of a craft's own axes. RecordingError for what is no craft's id."""
    if not -LARGEST_ID <= craft < 0:
        raise RecordingError(f"the NAIF id of a craft with an attitude lies from -1 to {-LARGEST_ID}, and is {craft}")
    return 1000 * craft


def frame_name(craft: int) -> str:
    """What a frame kernel calls the craft's axes: SAIL_BODY, with the number of a craft that has one of its own."""
    return "SAIL_BODY" if craft == spk.CRAFT else f"SAIL_{-craft}_BODY"


def clock_start(first: float) -> float:
    """s of TDB after J2000, when the clock of a flight begins whose first row is at such a time."""
    return 0.0 if first >= 0.0 else EARLY


def rates(et: np.ndarray, quaternion: np.ndarray) -> np.ndarray:
    """Rates of turning (n, 3) rad/s, in the frame, of attitudes (n, 4) x y z w at times (n,) s: those of the parabola
    through each row and its neighbours; of a single row none."""
    count = len(et)
    if count < 2:
        return np.zeros((count, 3))
    u, p = quaternion[1:, :3], quaternion[1:, 3:]
    v, q = -quaternion[:-1, :3], quaternion[:-1, 3:]
    vector = p * v + q * u + np.cross(u, v)  # of what turns each row into the next one, about axes of the frame
    scalar = (p * q)[:, 0] - np.sum(u * v, axis=1)
    size = np.linalg.norm(vector, axis=1)
    turned = 2.0 * np.arctan2(size, np.abs(scalar)) * np.where(scalar < 0.0, -1.0, 1.0)
    with np.errstate(invalid="ignore"):
        along = np.where(size[:, None] > 0.0, vector / size[:, None], 0.0)
    step = np.diff(et)
    mean = along * (turned / step)[:, None]
    if count == 2:
        return np.repeat(mean, 2, axis=0)
    h, k = step[:-1, None], step[1:, None]
    inner = (mean[:-1] * k + mean[1:] * h) / (h + k)
    return np.concatenate([2.0 * mean[:1] - inner[:1], inner, 2.0 * mean[-1:] - inner[-1:]])


def write_ck(
    path: str | Path,
    pointings: Sequence[Pointing],
    *,
    frame: str = "J2000",
    craft: int = spk.CRAFT,
    name: str = "",
    comments: Sequence[str] = (),
) -> Path:
    """Write a kernel, one segment with an interval for each pointing, on the clock of `write_clock`. frame : of
    spk.FRAMES. RecordingError where rows are no attitudes, do not increase in time, or lie beyond the clock's reach."""
    if frame not in spk.FRAMES:
        raise RecordingError(f"a CK is written in {' or '.join(spk.FRAMES)}, not in {frame}")
    if not pointings or any(not len(one.et) for one in pointings):
        raise RecordingError("a CK needs a row of attitude")
    et = np.concatenate([one.et for one in pointings])
    quaternion = np.concatenate([one.quaternion for one in pointings])
    length = np.linalg.norm(quaternion, axis=1, keepdims=True)
    if not (np.isfinite(et).all() and np.isfinite(quaternion).all() and np.all(np.abs(length - 1.0) < UNIT_LENGTH)):
        raise RecordingError("a CK holds times and quaternions of length 1 only")
    start = clock_start(float(et[0]))
    ticks = (et - start) * TICKS
    if np.any(np.diff(ticks) <= 0.0):
        raise RecordingError("the rows of a CK increase in time")
    if not 0.0 <= ticks[0] <= ticks[-1] <= LATEST * TICKS:
        raise RecordingError("a CK's clock of microseconds reaches from 1900 to 2185, or from 2000 to 2285")
    quaternion = quaternion / length
    turning = np.concatenate([rates(one.et, one.quaternion) for one in pointings])
    scalar_first = np.column_stack([quaternion[:, 3], -quaternion[:, :3]])  # SPICE's: from the frame to the craft
    begins = ticks[np.cumsum([0, *(len(one.et) for one in pointings[:-1])])]
    values = [np.hstack([scalar_first, turning]).ravel(), ticks, ticks[DIRECTORY - 1 : -1 : DIRECTORY]]
    values += [begins, begins[DIRECTORY - 1 : -1 : DIRECTORY], np.array([len(begins), len(ticks)], float)]
    numbers = (instrument(craft), spk.FRAMES[frame], KIND, 1)
    array = daf.Array(name, (float(ticks[0]), float(ticks[-1])), numbers, np.concatenate(values))
    return daf.write(path, "CK", [array], name, comments)


def write_clock(path: str | Path, craft: int, start: float) -> Path:
    """Write the text kernel of a craft's clock, which ticks once in a microsecond of TDB. start : `clock_start`."""
    instrument(craft)
    number = -craft
    lines = [
        "KPL/SCLK",
        "",
        "The clock of a kernel of attitudes: one tick is a microsecond of TDB.",
        "",
        "\\begindata",
        "SCLK_KERNEL_ID             = ( @2000-JAN-01 )",
        f"SCLK_DATA_TYPE_{number}        = ( 1 )",
        f"SCLK01_TIME_SYSTEM_{number}    = ( 1 )",
        f"SCLK01_N_FIELDS_{number}       = ( 2 )",
        f"SCLK01_MODULI_{number}         = ( 10000000000 1000000 )",
        f"SCLK01_OFFSETS_{number}        = ( 0 0 )",
        f"SCLK01_OUTPUT_DELIM_{number}   = ( 1 )",
        f"SCLK_PARTITION_START_{number}  = ( 0.0 )",
        f"SCLK_PARTITION_END_{number}    = ( {LATEST * TICKS:.1f} )",
        f"SCLK01_COEFFICIENTS_{number}   = ( 0.0 {start:.1f} 1.0 )",
        "\\begintext",
        "",
    ]
    files.write_text(path, "\n".join(lines), "kernel")
    return Path(path)


def write_frame(path: str | Path, craft: int) -> Path:
    """Write the text kernel that names the axes of a craft, whose attitude a CK has."""
    own, name = instrument(craft), frame_name(craft)
    number = 1_000_000 - craft if -craft in OWN_FRAMES else own
    keywords = {
        f"FRAME_{name}": str(number),
        f"FRAME_{number}_NAME": f"'{name}'",
        f"FRAME_{number}_CLASS": "3",
        f"FRAME_{number}_CLASS_ID": str(own),
        f"FRAME_{number}_CENTER": str(craft),
        f"CK_{own}_SCLK": str(craft),
        f"CK_{own}_SPK": str(craft),
    }
    lines = ["KPL/FK", "", "The axes of the craft: z is the normal of a sail, or the direction of its thrust.", ""]
    lines += ["\\begindata", *(f"{key:<28} = ( {value} )" for key, value in keywords.items()), "\\begintext", ""]
    files.write_text(path, "\n".join(lines), "kernel")
    return Path(path)


def read_ck(path: str | Path) -> tuple[Attitudes, ...]:
    """The segments of type 3 of a kernel. RecordingError, in one sentence, for what is no CK, is cut or damaged, or
    holds no such segment."""
    found = daf.read(path)
    if found.kind != "CK":
        raise RecordingError(f"{path} is a {found.kind or 'nameless'} kernel, not a CK")
    rows = [array for array in found.arrays if array.numbers[2] == KIND]
    if not rows:
        kinds = ", ".join(map(str, sorted({array.numbers[2] for array in found.arrays}))) or "none"
        raise RecordingError(f"{path} holds no segment of type {KIND}, whose rows are read here; it has: {kinds}")
    return tuple(_segment(array, path) for array in rows)


def _segment(array: daf.Array, path: str | Path) -> Attitudes:
    number, frame, _, with_rates = array.numbers
    width, values, size = (NUMBERS if with_rates else 4), array.values, len(array.values)
    intervals, count = (int(one) if size > 2 and 1.0 <= one <= size / 2 else 0 for one in values[-2:])
    ends = np.cumsum([width * count, count, (count - 1) // DIRECTORY, intervals, (intervals - 1) // DIRECTORY, 2])
    if not (count and intervals and ends[-1] == size):
        raise RecordingError(f"{path} is damaged: its segment {array.name or KIND!r} is not one of type {KIND}")
    rows, ticks, begins = values[: ends[0]].reshape(count, width), values[ends[0] : ends[1]], values[ends[2] : ends[3]]
    with np.errstate(over="ignore", invalid="ignore"):  # damage may have left any number
        length = np.linalg.norm(rows[:, :4], axis=1, keepdims=True)
    at = np.searchsorted(ticks, begins)
    whole = np.isfinite(rows).all() and np.all(np.diff(ticks) > 0) and np.all(np.abs(length - 1.0) < UNIT_LENGTH)
    ordered = at[0] == 0 and np.all(np.diff(at) > 0) and np.array_equal(ticks[np.minimum(at, count - 1)], begins)
    if not (whole and ordered):
        raise RecordingError(f"{path} is damaged: its segment {array.name or KIND!r} holds no attitudes in order")
    names = {number: word for word, number in spk.FRAMES.items()}
    q = rows[:, :4] / length
    quaternion = np.column_stack([-q[:, 1:], q[:, 0]])
    turning = rows[:, 4:] if with_rates else np.zeros((count, 3))
    return Attitudes(array.name, number, names.get(frame, str(frame)), ticks, quaternion, turning, tuple(at.tolist()))
