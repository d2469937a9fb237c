"""Two-line element sets and orbit mean-elements messages: checked here, turned into states by SGP4 (extra `tle`).

Their elements are means in SGP4's own sense, not osculating ones: only SGP4 makes a state of them, in TEME, the true
equator and mean equinox of date. A set is good to some kilometres at its epoch, and to one to three more each day.
Sources: D. A. Vallado et al., "Revisiting Spacetrack Report #3", AIAA 2006-6753 (columns, check digits, constants WGS
72); CCSDS 502.0-B-3 (the message).
"""

from __future__ import annotations

import json
import re
from datetime import datetime, timedelta
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

from sailviz import ndm
from sailviz.calendar import DateError, label
from sailviz.words import nearest

LENGTH = 69  # of a line, the check digit its last
FIRST_YEAR = 57  # of the two digits of a year that stand for 19xx; below it, 20xx
FARTHEST = 30.0  # d from its epoch to which a set is carried
NOTICED = 7.0  # d from its epoch beyond which it is told how far it was carried
LONGEST_FILE = 64_000_000  # bytes
ERRORS = {  # of SGP4
    1: "its eccentricity leaves 0 to 1",
    2: "its mean motion is not positive",
    3: "its perturbed eccentricity leaves 0 to 1",
    4: "its orbit shrinks to a line",
    5: "its orbit lies below the surface",
    6: "it has decayed",
}
_FIELDS = {  # what is read of a line: first and last column from 0, ends open, and what it is called
    "1": {
        "epoch year": (18, 20),
        "epoch day": (20, 32),
        "rate of the mean motion": (33, 43),
        "its second rate": (44, 52),
        "drag term": (53, 61),
    },
    "2": {
        "inclination": (8, 16),
        "node": (17, 25),
        "eccentricity": (26, 33),
        "argument": (34, 42),
        "mean anomaly": (43, 51),
        "mean motion": (52, 63),
    },
}
_POWER = r"[-+]?\.?\d+([-+]\d)?"
_PATTERNS = {  # of what is written in another way than 12.34
    "epoch year": r"\d\d",
    "eccentricity": r"\d+",
    "rate of the mean motion": r"[-+]?\d*\.?\d+",
    "its second rate": _POWER,
    "drag term": _POWER,
}
_NUMBERS = ("MEAN_MOTION", "ECCENTRICITY", "INCLINATION", "RA_OF_ASC_NODE", "ARG_OF_PERICENTER", "MEAN_ANOMALY")
_UNITS = dict.fromkeys(_NUMBERS, "deg") | {"MEAN_MOTION": "rev/day", "ECCENTRICITY": ""}
_REQUIRED = ("EPOCH", *_NUMBERS)
_DEFAULTS = {  # of what a message may leave out and SGP4 does without
    "OBJECT_NAME": "",
    "OBJECT_ID": "",
    "CLASSIFICATION_TYPE": "U",
    "NORAD_CAT_ID": "0",
    "EPHEMERIS_TYPE": "0",
    "ELEMENT_SET_NO": "0",
    "REV_AT_EPOCH": "0",
    "BSTAR": "0",
    "MEAN_MOTION_DOT": "0",
    "MEAN_MOTION_DDOT": "0",
}
_KNOWN = {"REF_FRAME": "TEME", "TIME_SYSTEM": "UTC", "CENTER_NAME": "EARTH", "MEAN_ELEMENT_THEORY": "SGP4"}


class ElementSet(NamedTuple):
    """One satellite's mean elements. name : "" where none is given; epoch : UTC, naive; lines : the two, or None;
    fields : of a message, or None."""

    name: str
    epoch: datetime
    lines: tuple[str, str] | None = None
    fields: dict[str, str] | None = None

    def state(self, date: datetime) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Position, m, and velocity, m/s, in TEME at a date (UTC, naive). ValueError where SGP4 finds none or the date
        lies farther than 30 d from the epoch, ModuleNotFoundError without the extra."""
        days = (date - self.epoch) / timedelta(days=1)
        if abs(days) > FARTHEST:
            raise ValueError(f"its epoch, {self.epoch.isoformat()}, is {abs(days):.3g} d away, more than {FARTHEST:g}")
        satellite = self._satellite()
        error, position, velocity = satellite.sgp4_tsince(days * 1440.0)
        if error:
            raise ValueError(f"SGP4 finds no state: {ERRORS.get(error, f'error {error}')}")
        if not all(map(isfinite, (*position, *velocity))):
            raise ValueError("SGP4 finds no state: its elements are those of no orbit")
        x, y, z = (1e3 * value for value in position)
        vx, vy, vz = (1e3 * value for value in velocity)
        return (x, y, z), (vx, vy, vz)

    def _satellite(self) -> Any:
        try:
            from sgp4 import omm
            from sgp4.api import WGS72, Satrec
        except ModuleNotFoundError:
            raise ModuleNotFoundError('element sets need the extra "tle": pip install "sailviz[tle]"') from None
        if self.lines is not None:
            return Satrec.twoline2rv(*self.lines, WGS72)
        assert self.fields is not None
        satellite = Satrec()
        omm.initialize(satellite, self.fields, WGS72)
        return satellite


def check_digit(line: str) -> int:
    """The last digit that a line should have: the sum of its digits, minus signs counting 1, modulo 10."""
    return sum(int(letter) if letter.isdigit() else letter == "-" for letter in line[: LENGTH - 1]) % 10


def of_lines(line1: str, line2: str, name: str = "") -> ElementSet:
    """A set of its two lines. ValueError, in one sentence, for what is none."""
    given = line1.rstrip(), line2.rstrip()
    for number, line in zip("12", given, strict=True):
        if len(line) != LENGTH or not line.isascii():
            raise ValueError(f"line {number} of an element set has {LENGTH} characters, not {len(line)}")
        if not line.startswith(f"{number} "):
            raise ValueError(f"line {number} of an element set begins with {number!r}, not {line[:2]!r}")
        if line[-1] != str(check_digit(line)):
            raise ValueError(
                f"the check digit of line {number} is {line[-1]!r}, and its digits make {check_digit(line)}"
            )
        for what, (begin, end) in _FIELDS[number].items():
            word = line[begin:end].strip()
            if not re.fullmatch(_PATTERNS.get(what, r"\d*\.?\d+"), word, re.ASCII):
                raise ValueError(f"the {what} in line {number} is no number: {line[begin:end]!r}")
    numbers = [line[2:7].strip() for line in given]
    if numbers[0] != numbers[1]:
        raise ValueError(f"the two lines are of different satellites: {numbers[0]} and {numbers[1]}")
    year, day = int(line1[18:20]), float(line1[20:32])
    year += 1900 if year >= FIRST_YEAR else 2000
    if not 1.0 <= day < 367.0:
        raise ValueError(f"the epoch in line 1 is no day of a year: {line1[20:32].strip()}")
    # eight decimals of a day are 864 us; a datetime holds whole ones
    return ElementSet(name.strip(), datetime(year, 1, 1) + timedelta(days=day - 1.0), given)


def read_element_sets(path: str | Path) -> list[ElementSet]:
    """All sets of a file: two lines each, with or without a line of the name before them, or orbit mean-elements
    messages as text (keyword = value), XML, JSON or CSV. ValueError, in one sentence, for what is none of them."""
    try:
        if Path(path).stat().st_size > LONGEST_FILE:
            raise ValueError("this file is too large for element sets")
        text = Path(path).read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError("this is no text, and so holds no element sets") from None
    begin = text.lstrip()[:400]
    if re.match(r"[\[{]", begin):
        return _of_messages(_json(text))
    if begin.startswith("<"):
        return _of_messages(_keywords(_xml(text)))
    if begin.upper().startswith("CCSDS_OMM_VERS"):
        return _of_messages(_keywords(text.splitlines()))
    if "MEAN_MOTION" in begin.splitlines()[0] if begin else False:
        import csv

        return _of_messages(list(csv.DictReader(text.lstrip().splitlines())))
    return _two_lines(text)


def _two_lines(text: str) -> list[ElementSet]:
    found: list[ElementSet] = []
    name, first, first_line = "", "", 0
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        if first:
            try:
                found.append(of_lines(first, line, name))
            except ValueError as error:
                raise ValueError(f"line {first_line}: {error}") from None
            name, first = "", ""
        elif re.match(r"1 [ 0-9A-Z]", line):
            first, first_line = line, number
        else:
            name = line.removeprefix("0 ")
    if first:
        raise ValueError(f"line {first_line}: the second line of this element set is lacking")
    if not found:
        raise ValueError("there are no element sets in this file: lines that begin with 1 and 2, or a message (OMM)")
    return found


def _json(text: str) -> list[dict[str, Any]]:
    try:
        found = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"this is no JSON: {error}") from None
    found = found if isinstance(found, list) else [found]
    if not all(isinstance(item, dict) for item in found):
        raise ValueError("this JSON holds no messages")
    return found


def _xml(text: str) -> list[str]:
    """The lines of all mean-elements messages of an XML document."""
    return [line for message in ndm.xml_messages(text) if message.kind == "OMM" for _, line in message.lines]


def _keywords(lines: list[str]) -> list[dict[str, Any]]:
    fields: list[dict[str, Any]] = []
    for line in lines:
        key, equals, value = line.partition("=")
        key = key.strip().upper()
        if key == "CCSDS_OMM_VERS":
            fields.append({})
        elif equals and fields:
            unit = re.search(r"\s*\[([^\]]*)\]\s*$", value)
            if unit and key in _UNITS and unit.group(1).strip().lower() != _UNITS[key]:
                raise ValueError(f"{key} is in [{unit.group(1).strip()[:20]}], and [{_UNITS[key]}] is due")
            fields[-1][key] = value[: unit.start()].strip() if unit else value.strip()
    return fields


def _of_messages(messages: list[dict[str, Any]]) -> list[ElementSet]:
    found = []
    for number, message in enumerate(messages, 1):
        fields = {str(key).upper(): str(value).strip() for key, value in message.items() if value is not None}
        name = fields.get("OBJECT_NAME", "")
        where = f"message {number}" + (f", {name}" if name else "")
        missing = [key for key in _REQUIRED if not fields.get(key)]
        if missing:
            raise ValueError(f"{where}: {missing[0]} is lacking")
        for key, wanted in _KNOWN.items():
            if fields.get(key, wanted).upper() not in (wanted, "SGP/SGP4"):
                raise ValueError(f"{where}: {key} is {fields[key]}; SGP4 wants {wanted}")
        fields = _DEFAULTS | {key: value for key, value in fields.items() if value}
        for key in (*_NUMBERS, "BSTAR", "MEAN_MOTION_DOT", "MEAN_MOTION_DDOT"):
            try:
                number_of(fields[key])
            except ValueError:
                raise ValueError(f"{where}: {key} is no number: {fields[key]!r}") from None
        if not 0.0 <= float(fields["ECCENTRICITY"]) < 1.0 or not float(fields["MEAN_MOTION"]) > 0.0:
            raise ValueError(f"{where}: this is no orbit round the Earth")
        try:
            day, ns = label(fields["EPOCH"])
        except DateError as error:
            raise ValueError(f"{where}: {error}") from None
        epoch = datetime(day.year, day.month, day.day) + timedelta(microseconds=round(ns / 1000))
        fields["EPOCH"] = epoch.isoformat(timespec="microseconds")
        fields["NORAD_CAT_ID"] = re.sub(r"\D", "", fields["NORAD_CAT_ID"]) or "0"
        if len(fields["OBJECT_ID"]) < 3:
            fields["OBJECT_ID"] = "0000-000"
        found.append(ElementSet(name, epoch, None, fields))
    if not found:
        raise ValueError("there are no messages in this file")
    return found


def number_of(word: str) -> float:
    """A finite number. ValueError for another word."""
    value = float(word)
    if not isfinite(value):
        raise ValueError(word)
    return value


def named(sets: list[ElementSet], name: str | None) -> ElementSet:
    """The set of a name, letter case aside, the latest of several; without a name the only one. ValueError, with the
    nearest name, where there is none or the choice is open."""
    if name is None:
        if len({(item.name, item.lines and item.lines[0][2:7]) for item in sets}) > 1:
            some = ", ".join(dict.fromkeys(item.name or "without a name" for item in sets[:5]))
            raise ValueError(f"the file has {len(sets)} element sets: say the name of one ({some} ...)")
        return max(sets, key=lambda item: item.epoch)
    same = [item for item in sets if item.name.casefold() == name.strip().casefold()]
    if not same:
        raise ValueError(f"there is no element set of this name. {nearest(name, [item.name for item in sets])}")
    return max(same, key=lambda item: item.epoch)
