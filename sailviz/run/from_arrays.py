"""Anybody's arrays as a Run: a trajectory from elsewhere, with angles, elements and frames derived from it.

    import sailviz
    sailviz.record_trajectory(time, position, velocity, "mine.rrd", thrust=acceleration, epoch="2031-04-01")

Nothing is propagated and nothing is corrected: what is missing in the arrays is missing in the picture.
"""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz import ephemeris, frames
from sailviz.constants import MU_SUN
from sailviz.elements import elements
from sailviz.run.array_checks import ArrayChecks, TrajectoryError
from sailviz.run.arrays import Attitude, Body, Craft, Event, Reference, Run, Setting, Thrust
from sailviz.run.devices import LABELS, SAILS
from sailviz.version import __version__

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from sailviz.run.array_checks import Curves, Epoch, Events, Missing

__all__ = ["TrajectoryError", "trajectory"]


def trajectory(
    time: ArrayLike,
    position: ArrayLike,
    velocity: ArrayLike,
    *,
    normal: ArrayLike | None = None,
    attitude: ArrayLike | None = None,
    scalar: str | None = None,
    direction: str | None = None,
    thrust: ArrayLike | None = None,
    mu: float = MU_SUN,
    body: str | None = None,
    radius: float | None = None,
    epoch: Epoch | None = None,
    mass: ArrayLike | None = None,
    device: str | None = None,
    side: float | None = None,
    tethers: int | None = None,
    tether_length: float | None = None,
    title: str = "Trajectory",
    about: str = "",
    look_for: Iterable[str] = (),
    family: str = "trajectories",
    events: Events = (),
    references: Curves = (),
    environment: Mapping[str, ArrayLike] | None = None,
    gaps: Missing = (),
    planets: bool = True,
    accuracy: str = "Given as arrays; nothing was propagated.",
    play_duration: float | None = None,
) -> Run:
    """A Run from arrays. SI; vectors inertial: in the ecliptic of J2000 round the Sun, in the equator round the Earth.

    A row whose position and velocity are all NaN holds no data: it is left out, and between its neighbours is a gap.

    normal : (n, 3) of a sail, away from the Sun; by default the thrust's direction, without thrust the direction away
        from the central body. Zero where a sail is stowed, which then has no angles and must have no thrust
    attitude : (n, 4) quaternions instead of a normal, which then is the body's z axis. scalar : where its scalar
        stands, "first" or "last"; direction : "body_to_world" or "world_to_body". Both must be said
    thrust : (n, 3) acceleration m/s2; zero rows count as switched off
    mu m3/s2, body's name, radius m : the Sun's by default, the Earth's where mu is hers
    epoch : UTC of time 0, a datetime64, datetime or text. mass : kg, a number or (n,); NaN is
        recorded where none is given
    device : "solar-sail", "electric-sail", "plasma-brake", "thruster" or "none", for the mesh; by default what thrust
        and normal suggest. side m of a sail, tethers, tether_length m : for scale and labels
    events : (name, time s) pairs or Events. references : name -> (k, 3) m, or References
    environment : name with unit -> (n,) numbers or truth values, or (n, 3)
    gaps : (start, end) pairs, s or dates, of spans without data, within the run and between rows: nothing is drawn or
        read off there. planets : draw their orbits round the Sun,
        and with an epoch where they are; round the Earth an epoch turns the globe
    Raises TrajectoryError (a ValueError) with every fault at once.
    """
    check = ArrayChecks()
    for name, size in (("side", side), ("tether_length", tether_length), ("play_duration", play_duration)):
        check.size(name, size)
    check.size("tethers", tethers, whole=True)
    lines = check.lines("look_for", look_for)
    given = _checked(
        check, time, position, velocity, normal, (attitude, scalar, direction), thrust, mass, (body, mu, radius), epoch,
        device, environment, references, events, gaps,
    )  # fmt: skip
    known_planets = planets and given.body.name == "Sun"
    setting = Setting(
        title=str(title),
        family=str(family),
        about=str(about),
        look_for=lines,
        thesis="",
        body=given.body,
        craft=Craft(given.device, LABELS[given.device], side, tethers, tether_length),
        duration=float(given.time[-1] - given.time[0]) if len(given.time) > 1 else 1.0,
        rows=len(given.time),
        epoch=given.epoch,
        references=(*given.references, *(_planet_orbits(given.position, given.epoch) if known_planets else ())),
        parameters=(("rows", f"{len(given.time):,}"),),
        text="",
        resolved={
            "kind": "trajectory",
            "title": str(title),
            "body": given.body.name,
            "mu": given.body.mu,
            "device": given.device,
        }
        | ({} if given.quaternion is None else {"attitude": "given"}),
        versions={"sailviz": __version__, "python": platform.python_version(), "numpy": np.__version__},
        accuracy=f"{accuracy} {given.note[0].upper()}{given.note[1:]}." if given.note else accuracy,
        identity="",
        play_duration=None if play_duration is None else float(play_duration),
        gaps=given.gaps,
    )
    run = _derived(given, setting, _bodies(given.body, given.epoch, given.time, planets))
    return replace(run, setting=replace(setting, identity=_identity(run)))


@dataclass(frozen=True)
class _Given:
    """Arguments that make a trajectory: float64 arrays of one length n, copies of their own."""

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    normal: np.ndarray | None
    thrust: np.ndarray
    mass: np.ndarray
    body: Body
    epoch: np.datetime64 | None
    device: str
    environment: dict[str, np.ndarray]
    references: tuple[Reference, ...]
    events: tuple[Event, ...]
    gaps: tuple[tuple[float, float], ...]
    quaternion: np.ndarray | None  # (n, 4) x y z w, body to world
    note: str  # what is strange about the rows though it may be so


def _checked(
    check: ArrayChecks,
    time: object,
    position: ArrayLike,
    velocity: ArrayLike,
    normal: ArrayLike | None,
    turned: tuple[ArrayLike | None, str | None, str | None],
    thrust: ArrayLike | None,
    mass: ArrayLike | None,
    body: tuple[str | None, float, float | None],
    epoch: Epoch | None,
    device: str | None,
    environment: Mapping[str, ArrayLike] | None,
    references: Curves,
    events: Events,
    gaps: Missing,
) -> _Given:
    """TrajectoryError with everything that is wrong, in the order of the arguments."""
    moment = check.epoch(epoch)
    attitude, scalar, direction = turned
    kept = check.with_data(position, velocity)
    if kept is not None:
        count = len(np.ma.asarray(position))
        time, position, velocity, normal, attitude, thrust, mass = (
            _rows(values, kept, count) for values in (time, position, velocity, normal, attitude, thrust, mass)
        )
        if isinstance(environment, Mapping):
            environment = {name: _rows(values, kept, count) for name, values in environment.items()}
    times, moment = check.times(time, moment)
    rows = len(times) or None
    places, velocities = check.vectors("position", position, rows), check.vectors("velocity", velocity, rows)
    normals = None if normal is None else check.vectors("normal", normal, rows)
    quaternions = None if attitude is None else check.attitude(attitude, scalar, direction, rows)
    if quaternions is not None and normals is not None:
        check.say("normal: an attitude is given, whose z axis is the normal: leave one of them out")
    elif quaternions is not None and check.good:
        normals = frames.rotation(quaternions)[..., 2]
    pushes = np.zeros((rows or 0, 3)) if thrust is None else check.vectors("thrust", thrust, rows)
    masses, centre = check.mass(mass, rows), check.body(*body)
    kind = check.device(_suggested(normal if attitude is None else attitude, thrust) if device is None else device)
    columns, curves = check.environment({} if environment is None else environment, rows), check.references(references)
    if check.good:
        check.order(times, places)
    strange = check.units(times, places, velocities, centre) if check.good else ""
    if check.good:
        check.reach(times, moment)
    without = check.gaps(gaps, times, moment) if check.good else ()
    marks = check.events(events, times, places, velocities, masses, without) if check.good else ()
    if check.good and normals is not None:
        check.stowed(normals, pushes) if kind in SAILS else check.no_zeros("normal", normals)
    check.finish()
    marks = _with_jumps(marks, times, places, velocities, masses)
    note = "" if pushes.any() else strange  # thrust explains what gravity does not
    return _Given(
        times, places, velocities, normals, pushes, masses, centre, moment, kind, columns, curves, marks, without,
        quaternions, note
    )  # fmt: skip


def _suggested(normal: ArrayLike | None, thrust: ArrayLike | None) -> str:
    """The device that the arrays which were given suggest."""
    return "solar-sail" if normal is not None else "thruster" if thrust is not None else "none"


def _rows(values: Any, kept: np.ndarray, count: int) -> Any:
    """Of what has as many rows as the trajectory was given with, those that hold data; anything else as it is."""
    if isinstance(values, np.ma.MaskedArray):
        found: np.ndarray = values
    else:
        try:
            found = np.asarray(values)
        except (TypeError, ValueError):  # rows of different lengths: said elsewhere
            return values
    return found[kept] if found.ndim and len(found) == count else values


def _with_jumps(
    events: tuple[Event, ...], time: np.ndarray, position: np.ndarray, velocity: np.ndarray, mass: np.ndarray
) -> tuple[Event, ...]:
    """The events, and one wherever two rows have one time: there the velocity jumps."""
    states = np.column_stack([position, velocity, mass])
    jumps = [Event("velocity jumps", float(time[row]), states[row + 1]) for row in np.flatnonzero(np.diff(time) == 0)]
    return tuple(sorted([*events, *jumps], key=lambda event: event.time))


def _derived(given: _Given, setting: Setting, bodies: dict[str, np.ndarray]) -> Run:
    """The Run of arrays that fit together: angles, elements and frames from states, thrust and normal."""
    axes = frames.rtn(given.position, given.velocity)
    thrust = given.thrust
    size = np.linalg.norm(thrust, axis=1)
    normal = given.normal if given.normal is not None else np.where((size > 0)[:, None], thrust, axes[..., 0])
    normal = frames.unit(normal)
    stowed: np.ndarray = ~np.any(normal, axis=1)
    pitch, cone, clock = frames.pitch_cone_clock(axes, normal, thrust)
    axes_of_body = frames.quaternion(frames.body_axes(frames.stance(axes, normal), axes[..., 1]))
    attitude = Attitude(
        np.where(stowed, np.nan, pitch),
        cone,
        np.where(stowed, np.nan, clock),
        normal,
        axes_of_body if given.quaternion is None else given.quaternion,
    )
    return Run(
        setting,
        0,
        given.time,
        given.position,
        given.velocity,
        given.mass,
        attitude,
        Thrust(thrust, frames.to_frame(axes, thrust), size, size > 0),
        elements(given.position, given.velocity, given.body.mu),
        _turning(given) | ({"stowed": stowed} if stowed.any() else {}) | given.environment,
        bodies=bodies,
        events=given.events,
    )


def _turning(given: _Given) -> dict[str, np.ndarray]:
    """How far the Earth has turned, rad, where it is the centre and the date is known: its map turns with it."""
    if given.body.name != "Earth" or given.epoch is None:
        return {}
    return {"earth_rotation_rad": ephemeris.greenwich_sidereal_time(given.epoch, given.time)}


def _planet_orbits(position: np.ndarray, epoch: np.datetime64 | None) -> tuple[Reference, ...]:
    """Orbits of the planets within reach."""
    reach = 1.15 * np.linalg.norm(position, axis=1).max()
    orbits = {name: ephemeris.planet_orbit(name, epoch) for name in ephemeris.PLANETS}
    return tuple(
        Reference(name, "planet", orbit)
        for name, orbit in orbits.items()
        if np.linalg.norm(orbit, axis=1).min() <= reach
    )


def _bodies(body: Body, epoch: np.datetime64 | None, time: np.ndarray, planets: bool) -> dict[str, np.ndarray]:
    if epoch is None:
        return {}
    if body.name == "Earth":
        return {"Sun": ephemeris.sun_position(epoch, time)}
    if body.name == "Sun" and planets:
        return {name: ephemeris.planet_position(name, epoch, time) for name in ephemeris.PLANETS}
    return {}


def _identity(run: Run) -> str:
    """Hash of the numbers and of what they are called."""
    told: tuple[object, ...] = (run.setting.resolved, str(run.setting.epoch), run.setting.craft)
    found = hashlib.sha256(repr((*told, run.setting.gaps) if run.setting.gaps else told).encode())
    thrust, normal = run.thrust.acceleration, run.attitude.normal
    turned = (run.attitude.quaternion,) if run.setting.resolved.get("attitude") else ()
    for values in (run.time, run.position, run.velocity, run.mass, thrust, normal, *turned, *run.environment.values()):
        found.update(np.ascontiguousarray(values).tobytes())
    return found.hexdigest()[:16]
