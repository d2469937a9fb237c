"""What a trajectory from elsewhere is given as, and the same as float64 arrays of one length, once it is known to fit
together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sailviz import frames
from sailviz.constants import AU
from sailviz.run.array_checks import ArrayChecks
from sailviz.run.arrays import Body, Event, Reference
from sailviz.run.devices import SAILS

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from sailviz.run.array_checks import Curves, Epoch, Events, Missing
    from sailviz.shapes.own_meshes import OwnMesh, SeenMesh


@dataclass(frozen=True)
class Given:
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
    mesh: SeenMesh | None
    note: str  # what is strange about the rows though it may be so
    light: np.ndarray | None = None  # (n, 3) m from the central body; None where that shines, or where nothing was said


class Columns(NamedTuple):
    """What has a row for each time, as it was given."""

    time: Any
    position: ArrayLike
    velocity: ArrayLike
    normal: ArrayLike | None
    attitude: ArrayLike | None
    thrust: ArrayLike | None
    mass: ArrayLike | None
    light: ArrayLike | None = None  # a direction (3,) or places (n, 3)


class Turned(NamedTuple):
    """How the quaternions of an attitude are meant."""

    scalar: str | None
    direction: str | None


class GivenMesh(NamedTuple):
    """A mesh of one's own, and how it is meant."""

    mesh: OwnMesh | None
    unit: str | None
    front: str | None
    side: float | None


class Span(NamedTuple):
    """What happened when, as it was given."""

    epoch: Epoch | None
    events: Events
    gaps: Missing


def checked(
    check: ArrayChecks,
    columns: Columns,
    turned: Turned,
    body: tuple[str | None, float, float | None],
    device: str | None,
    mesh: GivenMesh,
    environment: Mapping[str, ArrayLike] | None,
    references: Curves,
    span: Span,
) -> Given:
    """TrajectoryError with everything that is wrong, in the order of the arguments."""
    moment = check.epoch(span.epoch)
    columns, environment = _with_data(check, columns, environment)
    times, moment = check.times(columns.time, moment)
    rows = len(times) or None
    places = check.vectors("position", columns.position, rows)
    velocities = check.vectors("velocity", columns.velocity, rows)
    normals, quaternions = _attitude(check, columns, turned, rows)
    pushes = np.zeros((rows or 0, 3)) if columns.thrust is None else check.vectors("thrust", columns.thrust, rows)
    masses, centre = check.mass(columns.mass, rows), check.body(*body)
    kind = check.device(_suggested(columns) if device is None else device)
    seen = _seen(check, mesh)
    shines = _light(check, columns.light, places, centre)
    acted = check.environment({} if environment is None else environment, rows)
    curves = check.references(references)
    strange = _fit_together(check, times, places, velocities, centre, moment)
    without = check.gaps(span.gaps, times, moment) if check.good else ()
    marks = check.events(span.events, times, places, velocities, masses, without) if check.good else ()
    if check.good and normals is not None:
        check.stowed(normals, pushes) if kind in SAILS else check.no_zeros("normal", normals)
    check.finish()
    marks = _with_jumps(marks, times, places, velocities, masses)
    note = "" if pushes.any() else strange  # thrust explains what gravity does not
    return Given(
        times, places, velocities, normals, pushes, masses, centre, moment, kind, acted, curves, marks, without,
        quaternions, seen, note, shines
    )  # fmt: skip


def _with_data(
    check: ArrayChecks, columns: Columns, environment: Mapping[str, ArrayLike] | None
) -> tuple[Columns, Mapping[str, ArrayLike] | None]:
    """The rows that hold data."""
    kept = check.with_data(columns.position, columns.velocity)
    if kept is None:
        return columns, environment
    count = len(np.ma.asarray(columns.position))
    if isinstance(environment, Mapping):
        environment = {name: _rows(values, kept, count) for name, values in environment.items()}
    one = columns.light is None or np.asarray(columns.light).ndim == 1
    light = columns.light if one else _rows(columns.light, kept, count)
    rows = [_rows(values, kept, count) for values in columns[:-1]]
    return Columns(*[*rows, light]), environment


def _attitude(
    check: ArrayChecks, columns: Columns, turned: Turned, rows: int | None
) -> tuple[np.ndarray | None, np.ndarray | None]:
    """Normals (n, 3) and quaternions (n, 4), None for what was not given; of quaternions the normal is the z axis."""
    normals = None if columns.normal is None else check.vectors("normal", columns.normal, rows)
    if columns.attitude is None:
        return normals, None
    quaternions = check.attitude(columns.attitude, turned.scalar, turned.direction, rows)
    if normals is not None:
        check.say("normal: an attitude is given, whose z axis is the normal: leave one of them out")
    elif check.good:
        normals = frames.rotation(quaternions)[..., 2]
    return normals, quaternions


def _light(check: ArrayChecks, given: ArrayLike | None, places: np.ndarray, centre: Body) -> np.ndarray | None:
    """Places (n, 3) m of the light, from the central body; of a direction (3,) towards it an au away."""
    if given is None:
        return None
    if centre.name == "Sun":
        check.say("light: the Sun is at the centre and shines there: leave it out, or name another body")
        return None
    one = np.asarray(given).shape == (3,)
    found = check.vectors("light", np.reshape(given, (1, 3)) if one else given, 1 if one else len(places) or None)
    if not check.good:
        return None
    check.no_zeros("light", found)
    if one:
        return np.tile(AU * frames.unit(found), (len(places), 1))
    if (np.linalg.norm(found - places, axis=1) == 0.0).any():
        check.say("light: the craft is where the light is")
    return found


def _seen(check: ArrayChecks, given: GivenMesh) -> SeenMesh | None:
    """The mesh of one's own, None where there is none."""
    if given.mesh is None:
        for word, value in (("unit", given.unit), ("front", given.front)):
            if value is not None:
                check.say(f"{word}: it is that of a mesh, and there is none")
        return None
    if given.side is not None:
        check.say("side: the mesh has a size of its own: leave one of them out")
    from sailviz.shapes.file_checks import ShapeError
    from sailviz.shapes.own_meshes import seen_mesh

    try:
        return seen_mesh(given.mesh, given.unit, given.front)
    except ShapeError as error:
        check.say(f"mesh: {error}")
        return None


def _fit_together(
    check: ArrayChecks,
    times: np.ndarray,
    places: np.ndarray,
    velocities: np.ndarray,
    centre: Body,
    moment: np.datetime64 | None,
) -> str:
    """Whether times, places and velocities are in order, in SI and within reach -> what is strange though it may be."""
    if check.good:
        check.order(times, places)
    strange = check.units(times, places, velocities, centre) if check.good else ""
    if check.good:
        check.reach(times, moment)
    return strange


def _suggested(columns: Columns) -> str:
    """The device that the arrays which were given suggest."""
    if columns.normal is not None or columns.attitude is not None:
        return "solar-sail"
    return "none" if columns.thrust is None else "thruster"


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
