"""Orbit ephemeris messages (CCSDS 502.0-B, keyword = value form): the file in which missions exchange trajectories.

Written and read here because the maintained reader, `oem`, holds one astropy object per row and rounds epochs to
microseconds, which is centimetres on the way round the Sun; the tests let it judge what is written.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from datetime import UTC, datetime
from math import cos, pi, sin
from pathlib import Path

import numpy as np

from sailviz.errors import RecordingError

OBLIQUITY = 84_381.448 / 3600 * pi / 180  # rad, of the ecliptic of J2000: IAU 1976, as in JPL's ECLIPJ2000
EQUATOR_FROM_ECLIPTIC = np.array(
    [[1.0, 0.0, 0.0], [0.0, cos(OBLIQUITY), -sin(OBLIQUITY)], [0.0, sin(OBLIQUITY), cos(OBLIQUITY)]]
)
ECLIPTIC = "ECLIPJ2000"
EQUATOR = "EME2000"
BEHIND = {"UTC": 0.0, "GPS": 18.0, "TAI": 37.0, "TT": 69.184, "TDB": 69.184}  # s of UTC behind, since 2017
REQUIRED = ("OBJECT_NAME", "CENTER_NAME", "REF_FRAME", "TIME_SYSTEM")


@dataclass(frozen=True)
class Ephemeris:
    """A trajectory as an OEM holds it, in SI. time (n,) s since `epoch`, position (n, 3) m, velocity (n, 3) m/s."""

    name: str
    identity: str
    center: str  # "SUN", "EARTH", ...
    frame: str  # "EME2000", "ICRF", ...
    time_system: str
    epoch: np.datetime64  # of the first row, in time_system
    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray

    @property
    def utc(self) -> np.datetime64:
        """The epoch in UTC, with the leap seconds that hold since 2017 (up to 5 s off between 1999 and then).

        RecordingError for a time system whose distance from UTC is not known here.
        """
        if self.time_system not in BEHIND:
            raise RecordingError(f"the time system {self.time_system} is not known here; known: {', '.join(BEHIND)}")
        return self.epoch - np.timedelta64(round(BEHIND[self.time_system] * 1e9), "ns")

    def in_ecliptic(self) -> Ephemeris:
        """The same trajectory in the ecliptic of J2000, where sailviz keeps what circles the Sun.

        ICRF and GCRF count as EME2000, 0.02 arcsec away. RecordingError for other frames.
        """
        from dataclasses import replace

        if self.frame == ECLIPTIC:
            return self
        if self.frame not in (EQUATOR, "ICRF", "GCRF"):
            raise RecordingError(f"how the frame {self.frame} lies in the ecliptic is not known here")
        turned = (vectors @ EQUATOR_FROM_ECLIPTIC for vectors in (self.position, self.velocity))
        return replace(self, frame=ECLIPTIC, **dict(zip(("position", "velocity"), turned, strict=True)))


def write_oem(path, ephemeris: Ephemeris, comments=()) -> Path:
    """Write an OEM, version 2.0, and read it back. km and km/s with the 16 digits that the standard allows, epochs to
    the nanosecond. RecordingError where the file cannot be written or does not say what it should.
    """
    path = Path(path)
    e = ephemeris
    ns = np.round(e.time * 1e9).astype(np.int64)
    if np.any(np.diff(ns) <= 0):
        raise RecordingError("an OEM needs rows at least a nanosecond apart, in order of time")
    epochs = np.datetime_as_string(e.epoch.astype("datetime64[ns]") + ns.astype("timedelta64[ns]"), unit="ns")
    stamp = os.environ.get("SOURCE_DATE_EPOCH")
    now = datetime.fromtimestamp(int(stamp), UTC) if stamp else datetime.now(UTC)
    head = [
        "CCSDS_OEM_VERS = 2.0",
        f"CREATION_DATE = {now:%Y-%m-%dT%H:%M:%S}",
        "ORIGINATOR = SAILVIZ",
        "",
        "META_START",
        *(f"COMMENT {line}" for line in comments),
        f"OBJECT_NAME = {e.name}",
        f"OBJECT_ID = {e.identity}",
        f"CENTER_NAME = {e.center}",
        f"REF_FRAME = {e.frame}",
        f"TIME_SYSTEM = {e.time_system}",
        f"START_TIME = {epochs[0]}",
        f"STOP_TIME = {epochs[-1]}",
        "META_STOP",
        "",
    ]
    states = np.hstack([e.position, e.velocity]) / 1e3
    line = "%s" + " % .15e" * 6
    rows = [line % (epoch, *state) for epoch, state in zip(epochs.tolist(), states.tolist(), strict=True)]
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        part.write_text("\n".join([*head, *rows, ""]), encoding="ascii", errors="replace")
        back = read_oem(part)
        scale = np.abs(e.position).max(), np.abs(e.velocity).max()
        if (
            len(back.time) != len(e.time)
            or np.any(np.abs(back.time - (ns - ns[0]) / 1e9) > 1e-9)
            or np.any(np.abs(back.position - e.position) > 1e-15 * scale[0])
            or np.any(np.abs(back.velocity - e.velocity) > 1e-15 * scale[1])
        ):
            raise RecordingError(f"{path} did not come back as it was written")
        os.replace(part, path)
    except OSError as error:
        raise RecordingError(f"cannot write {path}: {(error.strerror or str(error)).lower()}") from None
    finally:
        part.unlink(missing_ok=True)
    return path


def read_oem(path) -> Ephemeris:
    """Read an OEM in keyword = value form, versions 1 to 3, all segments as one trajectory.

    Accelerations and covariances are passed over. Where one segment begins at the epoch at which another ends, the
    later one counts. RecordingError, in one sentence, for what is no OEM, is malformed, or changes its frame.
    """
    try:
        lines = Path(path).read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise RecordingError(f"{path} is not an OEM: it is not text") from None
    except OSError as error:
        raise RecordingError(f"cannot read {path}: {(error.strerror or str(error)).lower()}") from None
    first = next((line.strip() for line in lines if line.strip()), "")
    if first.startswith("<"):
        raise RecordingError(f"{path} is an OEM in XML; only the keyword = value form is read here")
    if not first.startswith("CCSDS_OEM_VERS"):
        raise RecordingError(f"{path} is not an OEM: it does not begin with CCSDS_OEM_VERS")
    meta: dict[str, str] = {}
    segments, epochs, rows, section = [], [], [], "header"
    for number, line in enumerate(lines, 1):
        text = line.strip()
        if not text or text.startswith("COMMENT"):
            continue
        if text in ("META_START", "META_STOP", "COVARIANCE_START", "COVARIANCE_STOP"):
            if text == "META_START":
                meta = {}
                segments.append(meta)
            section = {"META_START": "meta", "COVARIANCE_START": "covariance"}.get(text, "data")
        elif section == "meta" or (section == "header" and "=" in text):
            key, _, value = text.partition("=")
            meta[key.strip()] = value.strip()
        elif section == "data":
            epoch, *values = text.split()
            try:
                if len(values) not in (6, 9):
                    raise ValueError
                rows.append([float(value) for value in values[:6]])
            except ValueError:
                raise RecordingError(
                    f"{path}, line {number}: an epoch and six numbers were due, not {text!r}"
                ) from None
            epochs.append(epoch)
    if not rows or not segments:
        raise RecordingError(f"{path} holds no states")
    for key in REQUIRED:
        values = {segment.get(key, "") for segment in segments}
        if len(values) > 1 or "" in values:
            wrong = f"has no {key}" if "" in values else f"changes its {key}: {', '.join(sorted(values))}"
            raise RecordingError(f"{path} {wrong}")
    stamps = _epochs(epochs, path)
    states = np.array(rows) * 1e3
    later = np.append(np.diff(stamps.astype(np.int64)) != 0, True)
    stamps, states = stamps[later], states[later]
    if np.any(np.diff(stamps.astype(np.int64)) <= 0):
        raise RecordingError(f"{path}: the epochs do not increase")
    return Ephemeris(
        segments[0]["OBJECT_NAME"],
        segments[0].get("OBJECT_ID", ""),
        segments[0]["CENTER_NAME"].upper(),
        segments[0]["REF_FRAME"].upper(),
        segments[0]["TIME_SYSTEM"].upper(),
        stamps[0],
        (stamps - stamps[0]).astype(np.int64) / 1e9,
        states[:, :3],
        states[:, 3:],
    )


def _epochs(texts, path) -> np.ndarray:
    """Calendar (2030-01-31T...) or ordinal (2030-031T...) epochs as datetime64[ns]."""
    texts = [text.removesuffix("Z") for text in texts]
    try:
        if all(text[7:8] == "-" for text in texts):
            return np.array(texts, "datetime64[ns]")
        found = []
        for text in texts:
            if text[7:8] != "-":
                day = np.datetime64(f"{text[:4]}-01-01") + np.timedelta64(int(text[5:8]) - 1, "D")
                text = f"{day}{text[8:]}"
            found.append(np.datetime64(text, "ns"))
        return np.array(found)
    except ValueError as error:
        raise RecordingError(f"{path}: an epoch cannot be read: {error}") from None
