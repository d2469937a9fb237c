"""Anybody's arrays as a Run: a trajectory from elsewhere, with angles, elements and frames derived from it.

    import sailviz
    sailviz.record_trajectory(time, position, velocity, "mine.rrd", thrust=acceleration, epoch="2031-04-01")

Nothing is propagated and nothing is corrected: what is missing in the arrays is missing in the picture.
"""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np

import sailviz
from sailviz import ephemeris, frames
from sailviz.constants import MU_EARTH, MU_SUN, RADIUS_EARTH, RADIUS_SUN
from sailviz.elements import elements
from sailviz.errors import RecordingError
from sailviz.run.arrays import Attitude, Body, Craft, Event, Reference, Run, Setting, Thrust

LABELS = {
    "solar-sail": "Solar sail",
    "electric-sail": "E-sail",
    "plasma-brake": "Plasma brake",
    "thruster": "Thruster",
    "none": "Spacecraft",
}
BODIES = {"Sun": Body("Sun", MU_SUN, RADIUS_SUN), "Earth": Body("Earth", MU_EARTH, RADIUS_EARTH)}
INSIDE = 0.9  # of the body's radius: what lies deeper is rather in the wrong unit than in the ground
TOO_FAST = 30.0  # how many times farther than its velocity says a craft may move between two rows


class TrajectoryError(RecordingError, ValueError):
    """Arrays that make no trajectory. `faults` lists everything that is wrong with them."""

    def __init__(self, faults: list[str]):
        self.faults = tuple(faults)
        count = "1 fault" if len(faults) == 1 else f"{len(faults)} faults"
        super().__init__("\n".join([f"trajectory: {count}", *(f"  {fault}" for fault in faults)]))


def trajectory(
    time,
    position,
    velocity,
    *,
    normal=None,
    thrust=None,
    mu: float = MU_SUN,
    body: str | None = None,
    radius: float | None = None,
    epoch=None,
    mass=1.0,
    device: str | None = None,
    side: float | None = None,
    tethers: int | None = None,
    tether_length: float | None = None,
    title: str = "Trajectory",
    about: str = "",
    look_for=(),
    family: str = "trajectories",
    events=(),
    references=(),
    environment: Mapping | None = None,
    planets: bool = True,
    accuracy: str = "Given as arrays; nothing was propagated.",
    play_duration: float = 40.0,
) -> Run:
    """A Run from arrays. SI; vectors inertial: in the ecliptic of J2000 round the Sun, in the equator round the Earth.

    normal : (n, 3) of a sail, away from the Sun; by default the thrust's direction, without thrust the direction away
        from the central body
    thrust : (n, 3) acceleration m/s2; zero rows count as switched off
    mu m3/s2, body's name, radius m : the Sun's by default, the Earth's where mu is hers
    epoch : UTC of time 0, a datetime64, datetime or text. mass : kg, a number or (n,)
    device : "solar-sail", "electric-sail", "plasma-brake", "thruster" or "none", for the mesh; by default what thrust
        and normal suggest. side m of a sail, tethers, tether_length m : for scale and labels
    events : (name, time s) pairs or Events. references : name -> (k, 3) m, or References
    environment : name with unit -> (n,) numbers or truth values, or (n, 3). planets : draw their orbits round the Sun,
        and with an epoch where they are
    Raises TrajectoryError (a ValueError) with every fault at once.
    """
    check = _Checks()
    time = check.array("time", time, "(n,)")
    if time is not None and time.ndim == 1:
        check.increasing("time", time)
    rows = len(time) if time is not None and time.ndim == 1 else None
    position = check.vectors("position", position, rows)
    velocity = check.vectors("velocity", velocity, rows)
    normal = None if normal is None else check.vectors("normal", normal, rows)
    given_thrust = thrust is not None
    thrust = np.zeros((rows or 0, 3)) if thrust is None else check.vectors("thrust", thrust, rows)
    mass = check.mass(mass, rows)
    body = check.body(body, mu, radius)
    epoch = check.epoch(epoch)
    device = device or ("solar-sail" if normal is not None else "thruster" if given_thrust else "none")
    if device not in LABELS:
        check.say(f"device: {device!r} is not one of {', '.join(LABELS)}")
    columns = check.environment(environment or {}, rows)
    curves = check.references(references)
    if check.good and body is not None:
        check.units(time, position, velocity, body)
    marks = check.events(events, time, position, velocity) if check.good else ()
    if check.good and normal is not None:
        check.no_zeros("normal", normal)
    check.finish()

    axes = frames.rtn(position, velocity)
    size = np.linalg.norm(thrust, axis=1)
    if normal is None:
        normal = np.where((size > 0)[:, None], thrust, axes[..., 0])
    normal = frames.unit(normal)
    attitude = Attitude(
        *frames.pitch_cone_clock(axes, normal, thrust),
        normal,
        frames.quaternion(frames.body_axes(normal, axes[..., 1])),
    )
    setting = Setting(
        title=str(title),
        family=str(family),
        about=str(about),
        look_for=tuple(map(str, look_for)),
        thesis="",
        body=body,
        craft=Craft(device, LABELS[device], side, tethers, tether_length),
        duration=float(time[-1] - time[0]) if rows > 1 else 1.0,
        rows=rows,
        epoch=epoch,
        references=(*curves, *(_planet_orbits(position, epoch) if planets and body.name == "Sun" else ())),
        parameters=(("rows", f"{rows:,}"),),
        text="",
        resolved={"kind": "trajectory", "title": str(title), "body": body.name, "mu": body.mu, "device": device},
        versions={"sailviz": sailviz.__version__, "python": platform.python_version(), "numpy": np.__version__},
        accuracy=accuracy,
        identity="",
        play_duration=float(play_duration),
    )
    run = Run(
        setting,
        0,
        time,
        position,
        velocity,
        mass,
        attitude,
        Thrust(thrust, frames.to_frame(axes, thrust), size, size > 0),
        elements(position, velocity, body.mu),
        columns,
        bodies=_bodies(body, epoch, time, planets),
        events=marks,
    )
    return replace(run, setting=replace(setting, identity=_identity(run)))


class _Checks:
    """Gathers everything that is wrong with the arguments."""

    def __init__(self):
        self._faults: list[str] = []

    @property
    def good(self) -> bool:
        return not self._faults

    def say(self, fault: str) -> None:
        self._faults.append(fault)

    def finish(self) -> None:
        if self._faults:
            raise TrajectoryError(self._faults)

    def array(self, name: str, values, wanted: str):
        """float64 and finite, a copy of its own; None where it is not."""
        try:
            found = np.array(values, dtype=float)
        except (TypeError, ValueError):
            return self.say(f"{name}: not an array of numbers, wanted {wanted}")
        if found.size == 0:
            return self.say(f"{name}: has no values, wanted {wanted}")
        if name == "time" and found.ndim != 1:
            return self.say(f"{name}: shape {found.shape}, wanted {wanted}")
        if not np.isfinite(found).all():
            index = np.argwhere(~np.isfinite(found))[0]
            self.say(f"{name}: row {index[0]} is not a number ({found[tuple(index)]})")
        return found

    def increasing(self, name: str, values) -> None:
        down = np.flatnonzero(~(np.diff(values) > 0) & np.isfinite(np.diff(values)))
        if len(down):
            i = int(down[0])
            self.say(f"{name}: does not increase from row {i} ({values[i]:.10g}) to row {i + 1} ({values[i + 1]:.10g})")

    def vectors(self, name: str, values, rows):
        wanted = f"({rows if rows is not None else 'n'}, 3)"
        found = self.array(name, values, wanted)
        if found is None:
            return None
        if found.ndim != 2 or found.shape[1] != 3 or (rows is not None and len(found) != rows):
            turned = ": transpose it" if found.ndim == 2 and found.T.shape == (rows, 3) else ""
            return self.say(f"{name}: shape {found.shape}, wanted {wanted}{turned}")
        return found

    def mass(self, values, rows):
        found = self.array("mass", values, "a number or (n,)")
        if found is None:
            return None
        if found.ndim > 1 or (found.ndim == 1 and len(found) != rows):
            return self.say(f"mass: shape {found.shape}, wanted a number or ({rows},)")
        if not (found > 0).all():
            return self.say("mass: must be positive")
        return np.broadcast_to(found, rows or 1).copy()

    def body(self, name, mu, radius):
        if not isinstance(mu, int | float) or not (0 < mu < np.inf):
            return self.say(f"mu: must be a positive number in m3/s2, not {mu!r}")
        near = next((known for known in BODIES.values() if abs(mu / known.mu - 1) < 1e-3), None)
        if name in BODIES and near is not BODIES[name]:
            self.say(f"body: {name} does not go with mu = {mu:.6g} m3/s2; its own is {BODIES[name].mu:.9g}")
        if radius is not None and (not isinstance(radius, int | float) or not 0 <= radius < np.inf):
            return self.say(f"radius: must be a number of metres, not {radius!r}")
        known = near if name is None else BODIES.get(name)
        default = known.radius if known else 0.0
        name = name or (known.name if known else "body")
        return Body(str(name), float(mu), float(default if radius is None else radius))

    def epoch(self, value):
        if value is None:
            return None
        try:
            if isinstance(value, datetime) and value.tzinfo:
                value = value.astimezone(UTC).replace(tzinfo=None)
            found = np.datetime64(value.removesuffix("Z") if isinstance(value, str) else value, "ns")
        except (TypeError, ValueError):
            return self.say(f"epoch: {value!r} is no date; wanted a datetime64, datetime or text like 2031-04-01T12:00")
        return self.say("epoch: is not a time") if np.isnat(found) else found

    def environment(self, columns, rows) -> dict:
        found = {}
        for name, values in columns.items():
            wanted = f"({rows},) or ({rows}, 3)"
            column = self.array(f"environment[{name!r}]", values, wanted)
            if column is not None and column.shape not in ((rows,), (rows, 3)):
                self.say(f"environment[{name!r}]: shape {column.shape}, wanted {wanted}")
            yes_or_no = column is not None and np.asarray(values).dtype == bool
            found[str(name)] = column.astype(bool) if yes_or_no else column
        return found

    def references(self, curves) -> tuple[Reference, ...]:
        found = []
        for item in curves.items() if isinstance(curves, Mapping) else curves:
            if isinstance(item, Reference):
                found.append(item)
                continue
            name, points = item
            points = self.array(f"references[{name!r}]", points, "(k, 3)")
            if points is not None and (points.ndim != 2 or points.shape[1] != 3):
                self.say(f"references[{name!r}]: shape {points.shape}, wanted (k, 3)")
            found.append(Reference(str(name), "target", points))
        return tuple(found)

    def events(self, events, time, position, velocity) -> tuple[Event, ...]:
        from sailviz.run import resample

        found = []
        for item in events:
            if isinstance(item, Event):
                found.append(item)
                continue
            name, when = item
            if not isinstance(when, int | float | np.number) or not time[0] <= when <= time[-1]:
                self.say(f"events: {name!r} at {when!r} s is outside the run, {time[0]:.6g} to {time[-1]:.6g} s")
                continue
            state = {"position_m": position, "velocity_m_s": velocity}
            at = np.array([float(when)])
            now = [resample.at(at, column, time, values, state)[0] for column, values in state.items()]
            found.append(Event(str(name), float(when), np.concatenate([*now, [1.0]])))
        return tuple(sorted(found, key=lambda event: event.time))

    def no_zeros(self, name: str, vectors) -> None:
        zero = np.flatnonzero(np.linalg.norm(vectors, axis=1) == 0)
        if len(zero):
            self.say(f"{name}: row {zero[0]} is the zero vector")

    def units(self, time, position, velocity, body: Body) -> None:
        """What is plainly in kilometres."""
        distance = np.linalg.norm(position, axis=1)
        row = int(np.argmin(distance))
        if distance[row] == 0:
            self.say(f"position: row {row} is the centre of the {body.name}")
        elif distance[row] < INSIDE * body.radius:
            self.say(
                f"position: row {row} lies {distance[row]:.4g} m from the centre of the {body.name}, whose radius is "
                f"{body.radius:.4g} m; are these kilometres?"
            )
        elif len(time) > 1:
            moved = np.linalg.norm(np.diff(position, axis=0), axis=1) / np.diff(time)
            speed = np.linalg.norm(velocity, axis=1)
            ratio = float(np.median(moved / np.maximum(speed[1:], 1e-300)))
            if ratio > TOO_FAST:
                self.say(f"velocity: the craft moves {ratio:.3g} times as fast; are these kilometres a second?")


def _planet_orbits(position, epoch) -> tuple[Reference, ...]:
    """Orbits of the planets within reach."""
    reach = 1.15 * np.linalg.norm(position, axis=1).max()
    orbits = {name: ephemeris.planet_orbit(name, epoch) for name in ephemeris.PLANETS}
    return tuple(
        Reference(name, "planet", orbit)
        for name, orbit in orbits.items()
        if np.linalg.norm(orbit, axis=1).min() <= reach
    )


def _bodies(body: Body, epoch, time, planets: bool) -> dict:
    if epoch is None:
        return {}
    if body.name == "Earth":
        return {"Sun": ephemeris.sun_position(epoch, time)}
    if body.name == "Sun" and planets:
        return {name: ephemeris.planet_position(name, epoch, time) for name in ephemeris.PLANETS}
    return {}


def _identity(run: Run) -> str:
    """Hash of the numbers and of what they are called."""
    found = hashlib.sha256(repr((run.setting.resolved, str(run.setting.epoch), run.setting.craft)).encode())
    thrust, normal = run.thrust.acceleration, run.attitude.normal
    for values in (run.time, run.position, run.velocity, run.mass, thrust, normal, *run.environment.values()):
        found.update(np.ascontiguousarray(values).tobytes())
    return found.hexdigest()[:16]
