"""Somebody's flight, whatever file it is in, as a Run.

oem                 an orbit ephemeris message, as keywords or XML; messages and kernels are known under any name
bsp                 a kernel of SPICE whose segments hold rows
csv, parquet, npz   columns whose names say what they are and in which unit (columns.py)

Nothing is propagated. Round the Sun a flight is turned to the ecliptic of J2000, round the Earth to the mean equator of
its first date, by ERFA where that is installed (extra `frames`).
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sailviz import frames, ndm
from sailviz.calendar import DateError, tai
from sailviz.errors import RecordingError
from sailviz.exchange import earth_frames, spk
from sailviz.exchange.spice import read_segments
from sailviz.recording.flights.centre import body_of, centre_of, check_named
from sailviz.recording.flights.columns import Columns, read_columns
from sailviz.run import dates
from sailviz.run.array_checks import TrajectoryError
from sailviz.run.arrays import Run
from sailviz.run.from_arrays import trajectory
from sailviz.run.oem import OF_DATE, Ephemeris, read_oem
from sailviz.sky.bodies import BODIES

TABLES = (".csv", ".parquet", ".npz")
ENDINGS = (".oem", ".bsp", *TABLES)
OTHERS = {  # messages that hold no flight
    "OPM": "one state, where a scene may start (kind oem)",
    "OMM": "mean elements, by which a scene may start (kind tle)",
    "AEM": "an attitude without places",
    "APM": "one attitude",
}
J2000 = "2000-01-01T12:00:00"
LONG_STEP, PART_OF_TURN = 5.0, 1 / 20  # a step so many times the usual one, and so long, is a gap
LONG_PAUSE = 2.0  # row steps between two segments of a kernel from which rows are missing


class Look(NamedTuple):
    """A mesh of one's own, as `trajectory` takes it."""

    mesh: str | Path | None = None
    unit: str | None = None
    front: str | None = None


NO_MESH = Look()


def is_flight(path: object) -> bool:
    """Whether a path is meant as somebody's flight: by its ending, or since it begins as a message or a kernel does; an
    archive of our own export counts as one too."""
    if not isinstance(path, str | Path):
        return False
    return Path(path).suffix.lower() in ENDINGS or ending_by_content(path) in (".oem", ".bsp")


def ending_by_content(path: str | Path) -> str:
    """The one of ENDINGS that a file's first bytes speak of, "" where they speak of none. Every message counts as
    .oem, so that one of another kind is told as what it is."""
    try:
        if not Path(path).is_file():
            return ""
        with open(path, "rb") as file:
            head = file.read(8)
    except (OSError, ValueError):
        return ""
    if head.startswith((b"DAF/", b"NAIF/DAF")):
        return ".bsp"
    if head.startswith(b"PAR1"):
        return ".parquet"
    return ".oem" if ndm.kind_of(path) else ""


def read_flight(path: str | Path, body: str = "", look: Look = NO_MESH) -> Run:
    """A flight as a Run. body : about which it is, for a table that does not say so, one of sky.BODIES; look : what the
    craft looks like. RecordingError, in one sentence, for what is none, is cut or damaged, has no unit where one is
    due, or says itself that it is in others or about another body."""
    if body:
        body_of(body)
    ending = ending_by_content(path) or Path(path).suffix.lower()
    if ending not in ENDINGS:
        raise RecordingError(f"{path} is no flight that is read here: its name must end in {', '.join(ENDINGS)}")
    kind = ndm.kind_of(path)
    if ending == ".oem" and kind in OTHERS:
        raise RecordingError(f"{path} is an {kind}, {OTHERS[kind]}, and no flight")
    if ending in TABLES:
        return _of_columns(read_columns(path), path, body, look)
    return _of_ephemeris(read_oem(path) if ending == ".oem" else _of_kernel(path), path, body, look)


def _of_ephemeris(given: Ephemeris, path: str | Path, said: str, look: Look) -> Run:
    body = next((one for word, one in BODIES.items() if given.center.upper() in (word.upper(), one.name.upper())), None)
    if body is not None:
        check_named(said, body.name, path)
    else:
        known = ", ".join(one.name for one in BODIES.values())
        raise RecordingError(f"{path} is about {given.center}, whose gravity is not known here; known: {known}")
    told = [f"Read from {Path(path).name}, frame {given.frame}."]
    if body.name == "Sun":
        turned = given.in_ecliptic()
    elif body.name == "Earth":
        turned, words = _in_equator_of_date(given)
        told.append(words)
    elif given.frame in earth_frames.ROUND_THE_SUN:
        turned = given
    else:
        raise RecordingError(
            f"{path}: the frame {given.frame} is one of the Earth, and the flight is about {body.name}"
        )
    told += [f"{note[0].upper()}{note[1:]}." for note in given.notes]
    title = given.name or Path(path).stem
    return _run(
        path, turned.time, turned.position, turned.velocity, mu=body.mu, body=body.name, radius=body.radius,
        epoch=given.utc, gaps=turned.without_data, title=title, accuracy=" ".join(filter(None, told)),
        **look._asdict(),
    )  # fmt: skip


def _in_equator_of_date(given: Ephemeris) -> tuple[Ephemeris, str]:
    """A flight round the Earth in the frame in which such are kept, and how it came there."""
    instants = dates.instant_of(given.epoch, given.time_system) + np.round(given.time * 1e9).astype(np.int64)
    try:
        place, speed = earth_frames.to_gcrf(given.frame, instants, given.position, given.velocity)
    except ModuleNotFoundError:
        return given.in_equator_of_date(), "Turned without ERFA: nutation is neglected, up to 0.6 km at 7000 km."
    except ValueError as error:
        raise RecordingError(str(error)) from None
    turn = frames.icrf_to("equator-of-date", frames.centuries_since_j2000(given.utc))
    how = f"Turned by the {earth_frames.MODEL}." if given.frame != "GCRF" else ""
    return replace(given, frame=OF_DATE, position=place @ turn.T, velocity=speed @ turn.T), how


def _of_kernel(path: str | Path) -> Ephemeris:
    """The segments of one craft about one body in one frame, as one trajectory."""
    segments = read_segments(path)
    about = {(one.target, one.centre, one.frame) for one in segments}
    if len(about) > 1:
        told = "; ".join(f"{target} about {centre} in {frame}" for target, centre, frame in sorted(about)[:4])
        raise RecordingError(f"{path} holds several flights, and one is due: {told}")
    target, centre, frame = about.pop()
    body = next((one for one in BODIES.values() if one.number == centre), None)
    if body is None:
        raise RecordingError(f"{path} is about the body {centre} of NAIF, whose gravity is not known here")
    if frame not in ("J2000", "ECLIPJ2000"):
        raise RecordingError(f"{path} is in the frame {frame}, and J2000 or ECLIPJ2000 is known")
    parts: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    gaps: list[tuple[int, float]] = []
    rows = 0
    for segment in sorted(segments, key=lambda one: float(one.et[0])):
        if parts:
            before = parts[-1]
            kept = before[0] <= segment.et[0]
            rows -= int(np.count_nonzero(~kept))
            parts[-1] = before[0][kept], before[1][kept], before[2][kept]
            usual = max(float(np.median(np.diff(one))) for one in (before[0], segment.et) if len(one) > 1)
            pause = float(segment.et[0] - parts[-1][0][-1])
            if pause > LONG_PAUSE * usual:
                gaps.append((rows - 1, pause))
        parts.append((segment.et, segment.position, segment.velocity))
        rows += len(segment.et)
    et, position, velocity = (np.concatenate(values) for values in zip(*parts, strict=True))
    kept = np.concatenate([[True], (np.diff(et) > 0) | (np.linalg.norm(np.diff(velocity, axis=0), axis=1) > 0)])
    row_of = np.cumsum(kept) - 1
    first = tai(J2000, "TT") + round((float(et[0]) - spk.tdb_less_tt(float(et[0]))) * 1e9)
    return Ephemeris(
        segments[0].name or f"craft {target}", str(target), body.name.upper(),
        "EME2000" if frame == "J2000" else frame, "UTC", dates.label_of(first, "UTC"), (et - et[0])[kept],
        position[kept], velocity[kept], tuple((int(row_of[row]), pause) for row, pause in gaps),
    )  # fmt: skip


def _of_columns(given: Columns, path: str | Path, said: str, look: Look) -> Run:
    body = centre_of(given, path, said)
    axes = {"Sun": ", in the ecliptic of J2000", "Earth": ", in the mean equator of date"}.get(body.name, "")
    how = f"Read from columns, round the {body.name}{axes}."
    try:
        time, epoch = dates.seconds_of(given.time, None)
    except DateError as error:
        raise RecordingError(f"{path}: time {error}") from None
    return _run(
        path, time, given.position, given.velocity, mu=body.mu, body=body.name, radius=body.radius,
        epoch=given.epoch if epoch is None else epoch, title=Path(path).stem,
        accuracy=f"{how} Nothing was propagated.", gaps=_long_steps(time, given, body.mu),
        thrust=given.thrust, normal=given.normal, **look._asdict(),
    )  # fmt: skip


def _long_steps(time: np.ndarray, given: Columns, mu: float) -> tuple[tuple[float, float], ...]:
    """Steps over which there is no data: far longer than their neighbours, and a good part of a revolution."""
    usable = np.flatnonzero(np.isfinite(given.position).all(axis=1) & np.isfinite(given.velocity).all(axis=1))
    at = time[usable]
    step = np.diff(at)
    if len(step) < 3 or np.any(step < 0):
        return ()
    around = np.array([np.median(np.delete(step, k)[max(k - 3, 0) : k + 3]) for k in range(len(step))])
    r, v2 = np.linalg.norm(given.position[usable], axis=1), np.sum(given.velocity[usable] ** 2, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        axis = 1 / (2 / r - v2 / mu)
        turn = np.where(axis > 0, 2 * np.pi * np.sqrt(np.abs(axis) ** 3 / mu), np.inf)
    long = (step > LONG_STEP * around) & (step > PART_OF_TURN * turn[:-1])
    whole = usable[1:] - usable[:-1] == 1  # rows of NaN are gaps already
    return tuple((float(at[k]), float(at[k + 1])) for k in np.flatnonzero(long & whole))


def _run(path: str | Path, time: np.ndarray, position: np.ndarray, velocity: np.ndarray, **options: object) -> Run:
    try:
        about = f"A flight of {len(time):,} rows, shown as they are in its file: nothing was propagated."
        return trajectory(time, position, velocity, family="flights", about=about, **options)  # type: ignore[arg-type]
    except TrajectoryError as error:
        words = "; ".join(line.strip() for line in str(error).splitlines() if line.strip())
        raise RecordingError(f"{path}: {words}") from None
