"""Starts that are looked up, as states in the frame of the scene."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sailviz import frames, two_body
from sailviz.constants import DAY, MU_SUN
from sailviz.ephemeris import seconds_since_j2000
from sailviz.errors import Fault, RecordingError, SceneError
from sailviz.exchange.earth_frames import known_frame, to_gcrf
from sailviz.exchange.small_bodies import J2000
from sailviz.run import dates
from sailviz.run.resample import at as resampled
from sailviz.scene.conflicts.known_starts import element_set_of, read_states, small_body_of
from sailviz.scene.known_starts import OemStart, PlanetStart, SmallBodyStart, TleStart
from sailviz.scene.named_files import folder_of
from sailviz.scene.sky import frame_of
from sailviz.scene.start import CartesianStart
from sailviz.simulation.bodies import epoch_of
from sailviz.sky.bodies import BODIES
from sailviz.sky.nutation import mean_to_true, teme_to_mean
from sailviz.sky.places import Sky, tdb_ahead
from sailviz.words import length

if TYPE_CHECKING:
    from sailviz.run.arrays import Body
    from sailviz.run.oem import Ephemeris
    from sailviz.scene.loading import Scene

    State = tuple[np.ndarray, np.ndarray]
    Rows = list[tuple[str, str]]

HALF_AN_HOUR = 1800.0  # s between places of a planet of which its velocity is made: 1e-7 m/s
NEIGHBOURS = 4  # rows before and after a moment that are turned for it
SAME_INSTANT = 1e-6  # s, by which a date may lie outside a message


@contextmanager
def _told(scene: Scene, place: str) -> Iterator[None]:
    """What cannot be looked up becomes a fault of the scene."""
    try:
        yield
    except (ValueError, ModuleNotFoundError, RecordingError) as error:
        raise SceneError([Fault(place, f"{str(error).rstrip('.')}.")], scene.source) from None


def _epoch(scene: Scene) -> np.datetime64:
    epoch = epoch_of(scene)
    assert epoch is not None  # or the scene would not have been accepted
    return epoch


def to_scene(scene: Scene, frame: str) -> np.ndarray:
    """R (3, 3) that takes vectors of a frame, one of frames.FRAMES or "teme", at the epoch to the scene's own."""
    sky = Sky(_epoch(scene), frame_of(scene)) if scene.epoch is not None else None
    centuries = 0.0 if sky is None else sky.centuries
    own = frames.icrf_to(frame_of(scene), centuries)
    if frame in ("teme", "tod"):
        turn = teme_to_mean(centuries) if frame == "teme" else mean_to_true(centuries).T
        to_icrf = frames.icrf_to("equator-of-date", centuries).T @ turn
    else:
        to_icrf = frames.icrf_to(frame, centuries).T
    turned: np.ndarray = own @ to_icrf
    return turned


def cartesian(scene: Scene, start: CartesianStart, body: Body, design: None) -> State:
    """As given, in the scene's frame or turned into it."""
    position, velocity = np.array(start.position), np.array(start.velocity)
    if start.frame is None or start.frame == frame_of(scene):
        return position, velocity
    turn = to_scene(scene, start.frame)
    return turn @ position, turn @ velocity


def element_set(scene: Scene, start: TleStart, body: Body, design: None) -> State:
    """By SGP4, from TEME."""
    assert scene.epoch_utc is not None
    with _told(scene, "start"):
        position, velocity = element_set_of(scene, start).state(scene.epoch_utc)
    turn = to_scene(scene, "teme")
    return turn @ np.array(position), turn @ np.array(velocity)


def element_set_words(start: TleStart, design: None) -> Rows:
    """Where the elements are from."""
    return [("start", "mean elements carried by SGP4: some kilometres at their epoch, 1 to 3 km more a day")]


OEM_FRAMES = {"EME2000": "icrf", "ICRF": "icrf", "GCRF": "icrf", "ECLIPJ2000": "ecliptic-j2000",
              "MOD": "equator-of-date", "TEME": "teme", "TOD": "tod"}  # fmt: skip


def message(scene: Scene, start: OemStart, body: Body, design: None) -> State:
    """Between the rows around the epoch."""
    with _told(scene, "start.file"):
        found = read_states(folder_of(scene) / start.file)
        if found.center != body.name.upper():
            raise ValueError(f"this flight is round {found.center.capitalize()}, and the scene is round {body.name}")
        if found.frame not in OEM_FRAMES:
            known_frame(found.frame)
            if scene.body != "earth":
                raise ValueError(f"{found.frame} is a frame of the Earth")
        if found.frame in ("MOD", "TEME", "TOD") and scene.body != "earth":
            raise ValueError(f"{found.frame} is a frame of the Earth")
        seconds = float((_epoch(scene) - found.utc) / np.timedelta64(1, "ns")) * 1e-9
        seconds += tdb_ahead(_epoch(scene)) - tdb_ahead(found.utc)  # leap seconds between
        last = float(found.time[-1])
        if not -SAME_INSTANT <= seconds <= last + SAME_INSTANT:
            end = found.utc + np.timedelta64(round(last * 1e9), "ns")
            first, final = (str(moment.astype("datetime64[ms]")) for moment in (found.utc, end))
            raise ValueError(f"the message reaches from {first} to {final} UTC")
        gap = next((gap for gap in found.without_data if gap[0] < seconds < gap[1]), None)
        if gap is not None:
            raise ValueError(f"at this date, between {gap[0]:g} and {gap[1]:g} s after its first row, it has no data")
        if found.frame not in OEM_FRAMES:
            found = _in_gcrf(found, seconds)
    turn = to_scene(scene, OEM_FRAMES[found.frame])
    if len(found.time) == 1:
        return turn @ found.position[0], turn @ found.velocity[0]
    when = np.array([min(max(seconds, 0.0), last)])
    siblings = {"velocity_m_s": found.velocity}
    position = resampled(when, "position_m", found.time, found.position, siblings)[0]
    velocity = resampled(when, "velocity_m_s", found.time, found.velocity)[0]
    return turn @ position, turn @ velocity


def _in_gcrf(found: Ephemeris, seconds: float) -> Ephemeris:
    """The rows about a moment, s after the first one, of a message in a frame that turns with the Earth, in GCRF by
    ERFA. ValueError and ModuleNotFoundError where the extra `frames`, or the Earth's orientation, is lacking."""
    row = int(np.searchsorted(found.time, seconds))
    near = slice(max(row - NEIGHBOURS, 0), row + NEIGHBOURS)
    time = found.time[near]
    instants = dates.instant_of(found.epoch, found.time_system) + np.round(time * 1e9).astype(np.int64)
    position, velocity = to_gcrf(found.frame, instants, found.position[near], found.velocity[near])
    return replace(found, frame="GCRF", time=time, position=position, velocity=velocity, gaps=())


def planet(scene: Scene, start: PlanetStart, body: Body, design: None) -> State:
    """At the planet, or on the way from it, with what is left of the excess speed there."""
    sky = Sky(_epoch(scene), frame_of(scene), scene.ephemeris)
    with _told(scene, "ephemeris"):
        steps = HALF_AN_HOUR * np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
        places = sky.position(start.planet, "sun", steps)
    here, speed = places[2], (places[0] - 8 * places[1] + 8 * places[3] - places[4]) / (12 * HALF_AN_HOUR)
    towards = _towards(start.towards, here, speed, to_scene(scene, "ecliptic-j2000") @ [0.0, 0.0, 1.0])
    pull = 2.0 * BODIES[start.planet].mu / start.distance if start.distance > 0.0 else 0.0
    return here + start.distance * towards, speed + np.sqrt(start.c3 + pull) * towards


def _towards(word: str | list[float], place: np.ndarray, speed: np.ndarray, north: np.ndarray) -> np.ndarray:
    if not isinstance(word, str):
        return frames.unit(word)
    axes = {"along": speed, "against": -speed, "outward": place, "inward": -place, "north": north, "south": -north}
    return frames.unit(axes[word])


def planet_words(start: PlanetStart, design: None) -> Rows:
    """How it is left."""
    rows = [("start", f"at {start.planet.capitalize()}")]
    if start.c3 > 0.0:
        where = start.towards if isinstance(start.towards, str) else "as said"
        rows.append(("C3", f"{start.c3 * 1e-6:.6g} km²/s², {where}"))
    if start.distance > 0.0:
        rows.append(("distance from its centre", length(start.distance)))
    return rows


def small_body(scene: Scene, start: SmallBodyStart, body: Body, design: None) -> State:
    """Along its conic from the perihelion."""
    with _told(scene, "start"):
        found = small_body_of(scene, start)
    position, velocity = found.at_perihelion()
    now = seconds_since_j2000(_epoch(scene)) + tdb_ahead(_epoch(scene))
    span = now - (found.passage - J2000) * DAY
    place, speed = two_body.advance([position], [velocity], [span], MU_SUN)
    turn = to_scene(scene, "ecliptic-j2000")
    return turn @ place[0], turn @ speed[0]


def small_body_words(start: SmallBodyStart, design: None) -> Rows:
    """Which body."""
    return [("start", start.name or start.file or "at a small body")]
