"""Orbit mean-elements messages, written (CCSDS 502.0-B-3, keyword = value form); read in element_sets.py.

The elements are means in SGP4's own sense, in TEME: no state is made of them here, and none of a state.
"""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path

from sailviz import files
from sailviz.errors import RecordingError
from sailviz.exchange.element_sets import ElementSet, read_element_sets
from sailviz.exchange.opm import plain

META = {"CENTER_NAME": "EARTH", "REF_FRAME": "TEME", "TIME_SYSTEM": "UTC", "MEAN_ELEMENT_THEORY": "SGP4"}
ELEMENTS = {  # keyword: unit
    "MEAN_MOTION": "rev/day", "ECCENTRICITY": "", "INCLINATION": "deg", "RA_OF_ASC_NODE": "deg",
    "ARG_OF_PERICENTER": "deg", "MEAN_ANOMALY": "deg",
}  # fmt: skip
FURTHER = ("EPHEMERIS_TYPE", "CLASSIFICATION_TYPE", "NORAD_CAT_ID", "ELEMENT_SET_NO", "REV_AT_EPOCH", "BSTAR",
           "MEAN_MOTION_DOT", "MEAN_MOTION_DDOT")  # fmt: skip
SAME = 1.0  # m, within which a written set leads to the same state at its epoch


def write_omm(path: str | Path, elements: ElementSet) -> Path:
    """Write an element set as an OMM, version 2.0, and read it back: SGP4 makes the same state of both. RecordingError
    where it cannot be written, ModuleNotFoundError without the extra `tle`."""
    fields = _fields(elements)
    lines = [
        "CCSDS_OMM_VERS = 2.0",
        f"CREATION_DATE = {datetime.now(UTC):%Y-%m-%dT%H:%M:%S}",
        "ORIGINATOR = SAILVIZ",
        f"OBJECT_NAME = {plain(elements.name) or 'UNKNOWN'}",
        f"OBJECT_ID = {plain(fields.get('OBJECT_ID', '')) or 'UNKNOWN'}",
        *(f"{key} = {value}" for key, value in META.items()),
        f"EPOCH = {elements.epoch.isoformat(timespec='microseconds')}",
        *(f"{key} = {fields[key]}" + (f" [{unit}]" if unit else "") for key, unit in ELEMENTS.items()),
        *(f"{key} = {fields[key]}" for key in FURTHER if fields.get(key)),
    ]

    def check(part: Path) -> None:
        try:
            (back,) = read_element_sets(part)
            pairs = zip(back.state(elements.epoch)[0], elements.state(elements.epoch)[0], strict=True)
            same = all(abs(a - b) < SAME for a, b in pairs)
        except ValueError as error:
            raise RecordingError(f"{path} did not come back as it was written: {error}") from None
        if not same or back.epoch != elements.epoch:
            raise RecordingError(f"{path} did not come back as it was written")

    with files.writing(path, "message", check) as part:
        part.write_text("\n".join([*lines, ""]), encoding="ascii")
    return Path(path)


def _fields(elements: ElementSet) -> dict[str, str]:
    """The keywords of a set, of whichever kind it is."""
    if elements.fields is not None:
        return {key: str(value) for key, value in elements.fields.items()}
    try:
        from sgp4.exporter import export_omm
    except ModuleNotFoundError:
        raise ModuleNotFoundError('element sets need the extra "tle": pip install "sailviz[tle]"') from None
    return {key: str(value) for key, value in export_omm(elements._satellite(), elements.name).items()}
