"""Anybody's arrays as a Run: a trajectory from elsewhere, with angles, elements and frames derived from it.

    import sailviz
    sailviz.record_trajectory(time, position, velocity, "mine.rrd", thrust=acceleration, epoch="2031-04-01")

Nothing is propagated and nothing is corrected: what is missing in the arrays is missing in the picture.
"""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sailviz import ephemeris, frames
from sailviz.constants import MU_SUN
from sailviz.elements import elements
from sailviz.run.array_checks import ArrayChecks, TrajectoryError
from sailviz.run.arrays import Attitude, Body, Craft, CraftPart, Reference, Run, Setting, Thrust
from sailviz.run.devices import LABELS
from sailviz.run.given_arrays import Columns, Given, GivenMesh, Span, Turned, checked
from sailviz.version import __version__

OUTERMOST = ("Uranus", "Neptune")  # shown beside flights that come near only
if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from sailviz.run.array_checks import Curves, Epoch, Events, Missing
    from sailviz.shapes.own_meshes import OwnMesh

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
    mesh: OwnMesh | None = None,
    unit: str | None = None,
    front: str | None = None,
    title: str = "Trajectory",
    about: str = "",
    look_for: Iterable[str] = (),
    family: str = "trajectories",
    events: Events = (),
    references: Curves = (),
    environment: Mapping[str, ArrayLike] | None = None,
    gaps: Missing = (),
    light: ArrayLike | None = None,
    star: str | None = None,
    planets: bool = True,
    accuracy: str = "Given as arrays; nothing was propagated.",
    play_duration: float | None = None,
) -> Run:
    """A Run from arrays. SI; vectors inertial: in the ecliptic of J2000 round the Sun, in the equator round the Earth.

    A row whose position and velocity are all NaN holds no data: it is left out, and between its neighbours is a gap.

    normal : (n, 3) of a sail, away from the Sun; by default the thrust's direction, without thrust the direction away
        from the light, or from the central body where none is given. Zero where a sail is stowed, which then has no
        angles and must have no thrust
    attitude : (n, 4) quaternions instead of a normal, which then is the body's z axis. scalar : where its scalar
        stands, "first" or "last"; direction : "body_to_world" or "world_to_body". Both must be said
    thrust : (n, 3) acceleration m/s2; zero rows count as switched off
    mu m3/s2, body's name, radius m : the Sun's by default, the Earth's where mu is hers
    epoch : UTC of time 0, a datetime64, datetime or text. mass : kg, a number or (n,); NaN is
        recorded where none is given
    device : "solar-sail", "electric-sail", "plasma-brake", "thruster" or "none", for the mesh; by default what thrust
        and normal suggest. side m of a sail, tethers, tether_length m : for scale and labels
    mesh : what the craft looks like, drawn in the attitude: a file (STL, OBJ, GLB, PLY, 3MF), a mesh or scene of
        trimesh, or a Shape; its longest side is then the side. unit : in which it counts, "m", "cm", "mm", "in", "ft"
        or "km", unless it says so itself; front : its axis towards the Sun, "-z" by default, which leaves it as it is
    light : where the light is that is not at the centre, for the picture and for angles, which then count from it:
        places (n, 3) m from the central body, or one direction (3,) towards it. star : its name if not the Sun
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
    columns = Columns(time, position, velocity, normal, attitude, thrust, mass, light)
    if star is not None and light is None:
        check.say("star: it is the name of a light, and none is given")
    given = checked(
        check, columns, Turned(scalar, direction), (body, mu, radius), device, GivenMesh(mesh, unit, front, side),
        environment, references, Span(epoch, events, gaps),
    )  # fmt: skip
    shines = given.light is not None
    known_planets = planets and given.body.name == "Sun"
    setting = Setting(
        title=str(title),
        family=str(family),
        about=str(about),
        look_for=lines,
        thesis="",
        body=given.body,
        craft=_craft(given, side, tethers, tether_length),
        duration=float(given.time[-1] - given.time[0]) if len(given.time) > 1 else 1.0,
        rows=len(given.time),
        epoch=given.epoch,
        references=(*given.references, *(_planet_orbits(given.position, given.epoch) if known_planets else ())),
        parameters=(("rows", f"{len(given.time):,}"), *([("light", str(star or "the Sun"))] if shines else [])),
        text="",
        resolved={
            "kind": "trajectory",
            "title": str(title),
            "body": given.body.name,
            "mu": given.body.mu,
            "device": given.device,
        }
        | ({} if given.quaternion is None else {"attitude": "given"})
        | ({} if given.mesh is None else {"mesh": given.mesh.told()})
        | ({"light": str(star or "Sun")} if shines else {}),
        versions={"sailviz": __version__, "python": platform.python_version(), "numpy": np.__version__},
        accuracy=f"{accuracy} {given.note[0].upper()}{given.note[1:]}." if given.note else accuracy,
        identity="",
        play_duration=None if play_duration is None else float(play_duration),
        gaps=given.gaps,
    )
    near = {reference.name for reference in setting.references}
    bodies = _bodies(given.body, given.epoch, given.time, planets, near)
    if given.light is not None:
        bodies["Sun" if star is None else "light"] = given.light
        if star is not None:
            bodies.pop("Sun", None)
    run = _derived(given, setting, bodies)
    return replace(run, setting=replace(setting, identity=_identity(run)))


def _derived(given: Given, setting: Setting, bodies: dict[str, np.ndarray]) -> Run:
    """The Run of arrays that fit together: angles, elements and frames from states, thrust and normal."""
    axes = frames.rtn(given.position, given.velocity)
    thrust = given.thrust
    towards = axes if given.light is None else _axes_of_light(given.position - given.light, given.body)
    size = np.linalg.norm(thrust, axis=1)
    normal = given.normal if given.normal is not None else np.where((size > 0)[:, None], thrust, towards[..., 0])
    normal = frames.unit(normal)
    stowed: np.ndarray = ~np.any(normal, axis=1)
    pitch, cone, clock = frames.pitch_cone_clock(towards, normal, thrust)
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


def _axes_of_light(line: np.ndarray, body: Body) -> np.ndarray:
    """Axes (n, 3, 3), columns, in which angles count that are measured from a light: along lines (n, 3) from it, and
    towards east and north of the ecliptic, as under the scene's "sun-frame"."""
    pole = frames.EQUATOR_FROM_ECLIPTIC[:, 2] if body.name == "Earth" else np.array([0.0, 0.0, 1.0])
    x = frames.unit(line)
    y = np.cross(np.where(np.abs(x @ pole)[:, None] < 1.0 - 1e-12, pole, [1.0, 0.0, 0.0]), x)
    y = frames.unit(y)
    return np.stack([x, y, np.cross(x, y)], axis=-1)


def _craft(given: Given, side: float | None, tethers: int | None, tether_length: float | None) -> Craft:
    """What flies; with a mesh of its own its side is the longest of that."""
    label = LABELS[given.device]
    if given.mesh is None:
        return Craft(given.device, label, side, tethers, tether_length)
    parts = tuple(CraftPart(part.name, part.mesh.vertices, part.mesh.faces, part.film) for part in given.mesh.parts)
    return Craft(given.device, label, given.mesh.size, tethers, tether_length, parts=parts)


def _turning(given: Given) -> dict[str, np.ndarray]:
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


def _bodies(
    body: Body, epoch: np.datetime64 | None, time: np.ndarray, planets: bool, near: set[str]
) -> dict[str, np.ndarray]:
    """Places (n, 3) m: of the planets to Saturn, and of those beyond that are near."""
    shown = near | {name for name in ephemeris.PLANETS if name not in OUTERMOST}
    if epoch is None:
        return {}
    if body.name == "Earth":
        return {"Sun": ephemeris.sun_position(epoch, time)}
    if body.name == "Sun" and planets:
        return {name: ephemeris.planet_position(name, epoch, time) for name in ephemeris.PLANETS if name in shown}
    return {}


def _identity(run: Run) -> str:
    """Hash of the numbers and of what they are called."""
    told: tuple[object, ...] = (run.setting.resolved, str(run.setting.epoch), run.setting.craft)
    found = hashlib.sha256(repr((*told, run.setting.gaps) if run.setting.gaps else told).encode())
    thrust, normal = run.thrust.acceleration, run.attitude.normal
    turned = (run.attitude.quaternion,) if run.setting.resolved.get("attitude") else ()
    shines = [run.bodies[name] for name in ("Sun", "light") if "light" in run.setting.resolved and name in run.bodies]
    moved = run.time, run.position, run.velocity, run.mass, thrust, normal
    for values in (*moved, *turned, *run.environment.values(), *shines):
        found.update(np.ascontiguousarray(values).tobytes())
    return found.hexdigest()[:16]
