"""Kernels of which SPICE alone can make places: Chebyshev polynomials, difference lines and the like (extra `spice`).

They hold no rows, so rows are made: as many in a revolution as a trail needs, at equal steps within each segment.
"""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import numpy as np

from sailviz.errors import RecordingError
from sailviz.exchange import daf, spk

IN_A_TURN = 120
FEWEST, MOST = 200, 20_000  # rows of a segment
LOOKED_AT = 64  # moments at which the pace of a segment is asked for
INSIDE = 1e-6  # s from the ends of a segment, as SPICE reads them rounded


def read_segments(path: str | Path) -> tuple[spk.Segment, ...]:
    """The segments of an SPK: their rows, or where none has any those that SPICE makes. RecordingError, in one
    sentence, where neither can be."""
    found = daf.read(path)
    if found.kind != "SPK" or not found.arrays or any(one.numbers[3] in spk.WITH_ROWS for one in found.arrays):
        return spk.read_spk(path)
    return sampled(path, found)


def sampled(path: str | Path, found: daf.ArrayFile) -> tuple[spk.Segment, ...]:
    """The segments of an SPK as rows that SPICE makes of them. RecordingError, in one sentence, without the extra, for
    frames that are not J2000 or ECLIPJ2000, and for what SPICE does not read."""
    kinds = ", ".join(map(str, sorted({array.numbers[3] for array in found.arrays}))) or "none"
    try:
        import spiceypy
    except ModuleNotFoundError:
        raise RecordingError(f"{path} holds no rows but segments of type {kinds}, which SPICE reads: "
                             'pip install "sailviz[spice]"') from None  # fmt: skip
    names = {number: word for word, number in spk.FRAMES.items()}
    strange = next((one.numbers[2] for one in found.arrays if one.numbers[2] not in names), None)
    if strange is not None:
        raise RecordingError(f"{path} is in the frame {strange} of NAIF, and {' or '.join(names.values())} is known")
    try:
        handle = spiceypy.spklef(str(path))
        try:
            return tuple(_segment(spiceypy, path, array, names[array.numbers[2]]) for array in found.arrays)
        finally:
            spiceypy.spkuef(handle)
    except spiceypy.utils.exceptions.SpiceyError as error:
        words = " ".join(str(getattr(error, "short", "") or error).split())[:160]
        raise RecordingError(f"{path}: SPICE reads no places from its segments of type {kinds}: {words}") from None


def _segment(spice: ModuleType, path: str | Path, array: daf.Array, frame: str) -> spk.Segment:
    target, centre, _, kind = array.numbers
    begin, end = array.span[0] + INSIDE, array.span[1] - INSIDE
    if not end > begin:
        raise RecordingError(f"{path} is damaged: a segment of type {kind} has no length in time")

    def states(et: np.ndarray) -> np.ndarray:
        return np.array([spice.spkgeo(target, float(one), frame, centre)[0] for one in et]) * 1e3

    with np.errstate(all="ignore"):  # damage may have left any number
        looked = states(np.linspace(begin, end, LOOKED_AT))
        turns = (end - begin) * np.linalg.norm(looked[:, 3:], axis=1) / np.linalg.norm(looked[:, :3], axis=1)
        fastest = float(np.max(turns)) / (2 * np.pi)
        count = int(np.clip(fastest * IN_A_TURN, FEWEST, MOST)) if np.isfinite(fastest) else FEWEST
        et = np.linspace(begin, end, count)
        rows = states(et)
    if not (np.all(np.abs(rows) < spk.LARGEST) and np.all(np.diff(et) > 0)):
        raise RecordingError(f"{path} is damaged: SPICE makes places of it that are none")
    return spk.Segment(et, rows[:, :3], rows[:, 3:], array.name, target, centre, frame, kind)
