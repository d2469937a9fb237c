"""Orbits of asteroids and comets: from JPL's Small-Body Database (JSON) and the Minor Planet Center's files.

Elements are osculating, heliocentric, ecliptic and equinox of J2000; times TDB (the Minor Planet Center's TT is
the same to 2 ms). A body is carried along its conic: the planets' pull moves it off by 1e-4 to 1e-3 au in some years.
Sources: SBDB API 1.3; Minor Planet Center, "Export format for minor-planet orbits" and "for comet orbits".
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator
from datetime import date
from pathlib import Path
from typing import Any, NamedTuple

from sailviz.constants import AU, DAY, MU_SUN
from sailviz.words import nearest

LONGEST_FILE = 512_000_000  # bytes; all minor planets are 300 million
NEARLY_PARABOLIC = 0.98  # eccentricity from which on the passage of perihelion says more than the mean anomaly
J2000 = 2_451_545.0  # JD TDB
MPC_PLANET = {  # columns from 0, ends open
    "mean anomaly": (26, 35), "argument": (37, 46), "node": (48, 57), "inclination": (59, 68),
    "eccentricity": (70, 79), "semi-major axis": (92, 103),
}  # fmt: skip
MPC_COMET = {
    "perihelion distance": (30, 39), "eccentricity": (41, 49), "argument": (51, 59), "node": (61, 69),
    "inclination": (71, 79),
}  # fmt: skip


class SmallBody(NamedTuple):
    """An orbit by its perihelion. perihelion distance m; angles rad; passage : JD TDB of the perihelion; epoch : JD TDB
    of the elements, where it is told."""

    name: str
    perihelion: float
    eccentricity: float
    inclination: float
    node: float
    argument: float
    passage: float
    epoch: float | None = None

    def at_perihelion(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """Position, m, and velocity, m/s, ecliptic of J2000, at the passage."""
        co, so = math.cos(self.node), math.sin(self.node)
        ci, si = math.cos(self.inclination), math.sin(self.inclination)
        cw, sw = math.cos(self.argument), math.sin(self.argument)
        q, v = self.perihelion, math.sqrt(MU_SUN * (1.0 + self.eccentricity) / self.perihelion)
        towards = (co * cw - so * sw * ci, so * cw + co * sw * ci, sw * si)
        along = (-co * sw - so * cw * ci, -so * sw + co * cw * ci, cw * si)
        return (q * towards[0], q * towards[1], q * towards[2]), (v * along[0], v * along[1], v * along[2])


def by_anomaly(
    name: str, axis: float, e: float, inclination: float, node: float, argument: float, anomaly: float, day: float
) -> SmallBody:
    """A body by its semi-major axis, m, and its mean anomaly, rad, on a day, JD TDB. ValueError for no ellipse or
    hyperbola."""
    if not axis * (1.0 - e) > 0.0:
        raise ValueError("an ellipse has eccentricity < 1 and semi-major axis > 0, a hyperbola > 1 and < 0")
    rate = math.sqrt(MU_SUN / abs(axis) ** 3)
    if e < 1.0:
        anomaly = math.remainder(anomaly, 2 * math.pi)
    return SmallBody(name, axis * (1.0 - e), e, inclination, node, argument, day - anomaly / rate / DAY, day)


def read_small_body(path: str | Path, name: str | None = None) -> SmallBody:
    """One body of a file: the JSON that the Small-Body Database answers, or lines of the Minor Planet Center, of minor
    planets (MPCORB.DAT) or of comets (CometEls.txt).

    name : a part of its name or designation, letter case aside; may be left out where there is one body only.
    ValueError, in one sentence, with the line or the nearest name.
    """
    if Path(path).stat().st_size > LONGEST_FILE:
        raise ValueError("this file is too large for orbits of small bodies")
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError("this is no text, and so holds no orbits of small bodies") from None
    if text.lstrip().startswith("{"):
        return _of_database(text, name)
    return _chosen(list(_lines(text)), name)


def _of_database(text: str, name: str | None) -> SmallBody:
    try:
        answer = json.loads(text)
        about, orbit = answer["object"], answer["orbit"]
        values: dict[str, Any] = {item["name"]: item["value"] for item in orbit["elements"]}
    except (ValueError, KeyError, TypeError, RecursionError):
        raise ValueError(
            "this JSON is no answer of the Small-Body Database: object and orbit.elements are due"
        ) from None
    full = str(about.get("fullname") or about.get("des") or "")
    known = [str(about.get(key) or "") for key in ("fullname", "shortname", "des", "spkid")]
    if name is not None and not any(name.strip().casefold() in word.casefold() for word in known):
        raise ValueError(f"this is the orbit of {full}, not of {name}")

    def number(key: str) -> float | None:
        value = values.get(key)
        if value is None:
            return None
        return _number(str(value), f"the element {key}")

    def needed(key: str) -> float:
        found = number(key)
        if found is None:
            raise ValueError(f"the element {key} is lacking")
        return found

    e, inclination, node, argument = needed("e"), *(math.radians(needed(key)) for key in ("i", "om", "w"))
    anomaly, axis, day = number("ma"), number("a"), _number(str(orbit.get("epoch")), "the epoch")
    if e >= NEARLY_PARABOLIC or anomaly is None or axis is None:
        return _checked(SmallBody(full, needed("q") * AU, e, inclination, node, argument, needed("tp"), day))
    return _checked(by_anomaly(full, axis * AU, e, inclination, node, argument, math.radians(anomaly), day))


def _lines(text: str) -> Iterator[tuple[int, str, bool]]:
    """(line number, line, whether it is a comet's) of the lines that are orbits."""
    for number, line in enumerate(text.splitlines(), 1):
        if re.fullmatch(r"[IJK]\d\d[1-9A-C][1-9A-V]", line[20:25]):
            yield number, line, False
        elif re.fullmatch(r"\d{4}", line[14:18]) and re.fullmatch(r"[ \d]\d", line[19:21]):
            yield number, line, True


def _name(line: str, comet: bool) -> str:
    return (line[102:158] if comet else line[166:194] or line[:7]).strip()


def _is_called(line: str, comet: bool, word: str) -> bool:
    return word in _name(line, comet).casefold() or word == line[:7].strip().casefold()


def _chosen(lines: list[tuple[int, str, bool]], name: str | None) -> SmallBody:
    if not lines:
        raise ValueError(
            "there are no orbits of small bodies in this file: it is no answer of the Small-Body Database, and no line "
            "has the columns of the Minor Planet Center"
        )
    if name is None and len(lines) > 1:
        raise ValueError(f"the file has {len(lines)} orbits: say the name of one")
    wanted = "" if name is None else name.strip().casefold()
    found = [item for item in lines if _is_called(item[1], item[2], wanted)]
    if not found:
        known = [_name(line, comet) for _, line, comet in lines[:20_000]]
        raise ValueError(f"there is no orbit of {name} in this file. {nearest(name or '', known)}")
    exact = [item for item in found if _name(item[1], item[2]).casefold() == wanted]
    if len(found) > 1 and len(exact) != 1:
        some = ", ".join(_name(line, comet) for _, line, comet in found[:4])
        raise ValueError(f"{len(found)} orbits have {name} in their name: {some}")
    number, line, comet = exact[0] if len(exact) == 1 else found[0]
    try:
        return _of_comet(line) if comet else _of_planet(line)
    except ValueError as error:
        raise ValueError(f"line {number}: {error}") from None


def _columns(line: str, columns: dict[str, tuple[int, int]]) -> dict[str, float]:
    return {what: _number(line[begin:end], f"the {what}") for what, (begin, end) in columns.items()}


def _of_planet(line: str) -> SmallBody:
    of, word = _columns(line, MPC_PLANET), line[20:25]
    year, month, day = 100 * ("IJK".index(word[0]) + 18) + int(word[1:3]), int(word[3], 36), int(word[4], 36)
    inclination, node, argument, anomaly = (
        math.radians(of[what]) for what in ("inclination", "node", "argument", "mean anomaly")
    )
    epoch, axis, e = julian_day(year, month, float(day)), of["semi-major axis"] * AU, of["eccentricity"]
    return _checked(by_anomaly(_name(line, False), axis, e, inclination, node, argument, anomaly, epoch))


def _of_comet(line: str) -> SmallBody:
    of = _columns(line, MPC_COMET)
    passage = julian_day(int(line[14:18]), int(line[19:21]), _number(line[22:29], "the day of perihelion"))
    inclination, node, argument = (math.radians(of[what]) for what in ("inclination", "node", "argument"))
    q, e = of["perihelion distance"] * AU, of["eccentricity"]
    return _checked(SmallBody(_name(line, True), q, e, inclination, node, argument, passage))


def _number(word: str, what: str) -> float:
    try:
        value = float(word)
    except ValueError:
        raise ValueError(f"{what} is no number: {word.strip()!r}") from None
    if not math.isfinite(value):
        raise ValueError(f"{what} is not finite")
    return value


def _checked(body: SmallBody) -> SmallBody:
    if not (body.perihelion > 0.0 and body.eccentricity >= 0.0):
        raise ValueError("the perihelion distance must be positive and the eccentricity not negative")
    if not 0.0 <= body.inclination <= math.pi:
        raise ValueError("the inclination must lie between 0 and 180 deg")
    return body


def julian_day(year: int, month: int, day: float) -> float:
    """Julian date of a day of the calendar, with its fraction. ValueError for what is no day."""
    try:
        return date(year, month, int(day)).toordinal() + 1_721_424.5 + day % 1.0
    except ValueError:
        raise ValueError(f"there is no day {year}-{month:02}-{day:g}") from None
