"""Starts that are looked up in files: what they say is read when a scene is loaded, so that all its faults are told at
once, and so that a start with a date of its own gives the scene its epoch.

What reads the files is imported by the scenes that name some: `check` answers at once.
"""

from __future__ import annotations

from datetime import UTC, date, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.known_starts import OemStart, PlanetStart, SmallBodyStart, TleStart
from sailviz.scene.named_files import folder_of, outside, unreadable
from sailviz.scene.start import CartesianStart
from sailviz.words import shown

if TYPE_CHECKING:
    from sailviz.exchange.element_sets import ElementSet
    from sailviz.exchange.small_bodies import SmallBody
    from sailviz.run.oem import Ephemeris
    from sailviz.scene.loading import Scene

DAY = 86_400.0


def _unreadable(scene: Scene, name: str) -> str:
    folder = folder_of(scene)
    return outside(folder, name) or unreadable(folder, name)


def element_set_of(scene: Scene, start: TleStart) -> ElementSet:
    """The set that a start means. ValueError, in one sentence, where there is none."""
    from sailviz.exchange import element_sets

    if start.line1 is not None and start.line2 is not None:
        return element_sets.of_lines(start.line1, start.line2)
    assert start.file is not None  # or the section would not have been accepted
    if problem := _unreadable(scene, start.file):
        raise ValueError(problem)
    return element_sets.named(element_sets.read_element_sets(folder_of(scene) / start.file), start.name)


def small_body_of(scene: Scene, start: SmallBodyStart) -> SmallBody:
    """The body that a start means. ValueError, in one sentence, where there is none."""
    from sailviz.exchange import small_bodies
    from sailviz.exchange.small_bodies import SmallBody

    if start.file is not None:
        if problem := _unreadable(scene, start.file):
            raise ValueError(problem)
        return small_bodies.read_small_body(folder_of(scene) / start.file, start.name)
    e, angles = start.eccentricity or 0.0, (start.inclination or 0.0, start.raan or 0.0, start.argument or 0.0)
    if start.perihelion_date is not None and start.perihelion_distance is not None:
        return SmallBody("", start.perihelion_distance, e, *angles, julian_date(start.perihelion_date))
    assert start.semi_major_axis is not None
    assert start.elements_date is not None
    day = julian_date(start.elements_date)
    return small_bodies.by_anomaly("", start.semi_major_axis, e, *angles, start.mean_anomaly or 0.0, day)


def julian_date(moment: date) -> float:
    """JD of a date or a datetime, in whatever time system it is told."""
    day = moment.toordinal() + 1_721_424.5
    if not isinstance(moment, datetime):
        return day
    return day + (moment.hour * 3600 + moment.minute * 60 + moment.second + moment.microsecond * 1e-6) / DAY


def dated(scene: Scene) -> tuple[Scene, Faults]:
    """The scene with the epoch that its start brings along, where it gives none itself."""
    start = scene.start
    if scene.epoch is not None or not isinstance(start, (TleStart, OemStart)):
        return scene, []
    try:
        if isinstance(start, TleStart):
            epoch = _as_utc(element_set_of(scene, start).epoch)
        elif start.at is not None:
            return scene.model_copy(update={"epoch": start.at}), []
        else:
            if problem := _unreadable(scene, start.file):
                return scene, [("start.file", problem)]
            epoch = _first_row(scene, start)
    except ValueError as error:
        return scene, [(_place(start), str(error))]
    return scene.model_copy(update={"epoch": epoch}), []


def _first_row(scene: Scene, start: OemStart) -> datetime:
    from sailviz.errors import RecordingError

    try:
        date = read_states(folder_of(scene) / start.file).utc.astype("datetime64[us]").item()
    except RecordingError as error:
        raise ValueError(str(error).rstrip(".")) from None
    return _as_utc(date)


def read_states(path: Path) -> Ephemeris:
    """What a message has: the rows of an OEM, or the one state of an OPM. RecordingError, in one sentence."""
    from sailviz import ndm
    from sailviz.exchange.opm import read_opm
    from sailviz.run.oem import of_one_state, read_oem

    if ndm.kind_of(path) != "OPM":
        return read_oem(path)
    found = read_opm(path)
    about = found.name, found.identity, found.center, found.frame, found.time_system
    return of_one_state(about, found.instant, found.position, found.velocity, found.notes)


def _as_utc(date: datetime) -> datetime:
    """A naive UTC date with its zone, as scenes keep them."""
    return date.replace(tzinfo=UTC)


def _place(start: TleStart | OemStart | SmallBodyStart) -> str:
    return "start.file" if start.file is not None else "start"


def element_set(scene: Scene, start: TleStart) -> Faults:
    """A set that can be read, not too far from the epoch, round the Earth. Whether SGP4 is installed is told when it is
    flown: the file is the same everywhere."""
    from sailviz.exchange.element_sets import FARTHEST

    found: Faults = []
    if scene.body != "earth":
        found.append(("body", 'element sets are of satellites of the Earth: body = "earth"'))
    try:
        elements = element_set_of(scene, start)
    except ValueError as error:
        return [*found, (_place(start), str(error))]
    if scene.epoch_utc is not None:
        days = (scene.epoch_utc - elements.epoch).total_seconds() / DAY
        if abs(days) > FARTHEST:
            words = (
                f"lies {abs(days):,.4g} d from that of the element set, {elements.epoch.isoformat()}; SGP4 is carried"
            )
            found.append(("epoch", f"{words} {FARTHEST:g} d at most"))
    return found


def message(scene: Scene, start: OemStart) -> Faults:
    """A message that is there; what it holds is looked at when the scene is planned."""
    if start.at is not None and scene.epoch is not None and start.at != scene.epoch:
        return [("start.at", "the scene has an epoch: leave one of them out")]
    problem = _unreadable(scene, start.file)
    return [("start.file", problem)] if problem else []


def planet(scene: Scene, start: PlanetStart) -> Faults:
    """At a planet of the Sun, on a date."""
    found = _round_the_sun(scene, "a planet")
    pulling = {"earth-moon": "earth"}
    if start.planet in [pulling.get(word, word) for word in scene.environment.gravity_of_bodies] and not start.distance:
        words = f"{start.planet} pulls: say how far from its centre the flight begins, distance_km"
        found.append(("start.distance", words))
    return found


def small_body(scene: Scene, start: SmallBodyStart) -> Faults:
    """A body that can be read, on a date."""
    found = _round_the_sun(scene, "a small body")
    try:
        small_body_of(scene, start)
    except ValueError as error:
        found.append((_place(start), str(error)))
    return found


def _round_the_sun(scene: Scene, what: str) -> Faults:
    found: Faults = []
    if scene.body != "sun":
        found.append(("body", f'a flight that begins at {what} is one round the Sun: body = "sun"'))
    if scene.epoch is None:
        found.append(("epoch", f"where {what} stands needs a date"))
    return found


def cartesian(scene: Scene, start: CartesianStart) -> Faults:
    """A frame that is known where the scene is flown."""
    if start.frame is None:
        return []
    found: Faults = []
    of_date = start.frame in ("equator-of-date", "teme")
    if of_date and scene.body != "earth":
        found.append(("start.frame", f'{shown(start.frame)} is a frame of the Earth: body = "earth"'))
    if scene.epoch is None and (of_date or scene.body == "earth"):
        found.append(("epoch", "how the frame of the start is turned needs a date"))
    return found
