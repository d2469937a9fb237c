"""What the views need to know about a run, once it is known how far it reaches: a handful of numbers and words."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sailviz.frames import unit
from sailviz.recording import timelines
from sailviz.recording.contract import word
from sailviz.recording.drawing import cameras, style
from sailviz.recording.drawing.arrival_plane import Arrival, arrivals_of
from sailviz.recording.drawing.cameras import Camera
from sailviz.recording.drawing.craft import CloseUp, CraftDrawing
from sailviz.recording.drawing.curves import Curves
from sailviz.recording.drawing.ensemble_plots import slots_of
from sailviz.recording.drawing.plot_column import Slot, column, plot_views
from sailviz.recording.drawing.samples import PLANE_TURNS, Frame, Samples
from sailviz.run.arrays import Run, Setting

PUSHES = 400  # rows at which the ends of arrows are looked at
SEASON = 30 * 86400.0  # s of a run from which the eye over a planet goes along with the Sun
DESCENT = "Descent (orbits in one plane, to scale)"
TUBE = "Percentiles"  # the view of ensembles as tubes
DEPARTING = 0.02  # relative change of distance below which an orbit counts as closed


@dataclass(frozen=True)
class Layout:
    """Everything from which a blueprint is made."""

    sun: bool
    scene_radius: float  # S, view units
    sail_size: float  # view units: side of a sail, radius of an E-sail, height of a satellite
    tether_size: float  # view units, of a plasma brake
    thrust_scale: float  # view units per m/s2
    close_thrust_scale: float  # of the close-up, per sqrt(m/s2)
    cameras: tuple[Camera, ...]
    close_up: Camera
    slots: tuple[Slot, ...]
    lanes: tuple[str, ...]
    lane_share: float
    hidden: tuple[str, ...]  # entities that the system view leaves out
    tail: float  # s of the bright part of the trail
    past: float  # s of the trail, 0 for all of it
    future: bool
    sparse: bool
    timeline: str
    timelines: tuple[str, ...]
    speed: float  # seconds of the run in one second of replay
    rows_per_second: float
    arrivals: tuple[Arrival, ...] = ()  # planes in which ensembles are seen
    ensembles: tuple[str, ...] = ()  # their names as parts of paths


class Extents:
    """How far a run reaches, gathered block by block over all rows."""

    def __init__(self, first: Run):
        self.farthest, self.nearest = 0.0, np.inf  # m
        self.lowest = self.highest = 0.0  # m from the plane x, y
        self.thrust = 0.0  # m/s2
        self.reached = 0.0  # s from the first row to the last so far
        self.finished = False  # whether there will be no more
        self.middle = replace(timelines.take(first, slice(0, 1)), first=first.first)  # the last row before half time
        self._start = float(first.time[0])  # s
        self._pushes: list[np.ndarray] = []  # position m and thrust m/s2 of some rows, (k, 6)
        self.bodies: dict[str, float] = {}  # farthest distance of each, m

    def add(self, run: Run) -> None:
        """The next rows."""
        self.reached = float(run.time[-1]) - self._start
        some = timelines.on_stride(run, timelines.stride(run.setting.rows, PUSHES))
        self._pushes.append(np.hstack([run.position[some], run.thrust.acceleration[some]]))
        distance = np.linalg.norm(run.position, axis=1)
        low, high = float(distance.min()), float(distance.max())
        self.farthest, self.nearest = max(self.farthest, high), min(self.nearest, low)
        self.lowest = min(self.lowest, float(run.position[:, 2].min()))
        self.highest = max(self.highest, float(run.position[:, 2].max()))
        self.thrust = max(self.thrust, float(run.thrust.magnitude.max()))
        for name, position in run.bodies.items():
            self.bodies[name] = max(self.bodies.get(name, 0.0), float(np.linalg.norm(position, axis=1).max()))
        halfway = self._start + 0.5 * run.setting.duration
        wanted = int(np.searchsorted(run.time, halfway, side="right")) - 1
        if wanted >= 0:
            self.middle = replace(timelines.take(run, slice(wanted, wanted + 1)), first=run.first + wanted)

    @property
    def still(self) -> bool:
        """Whether the distance hardly changes."""
        return self.farthest - self.nearest < DEPARTING * self.farthest

    def span(self, duration: float) -> float:
        """s that the run lasts: as asked for, until it is known how far it reached."""
        return self.reached if self.finished and self.reached > 0 else duration

    def tips(self, scale: float) -> np.ndarray:
        """Where arrows of thrust end, m, `scale` m long per m/s2. (k, 3)"""
        pushes = np.concatenate(self._pushes)
        return pushes[:, :3] + scale * pushes[:, 3:]


def lay_out(
    setting: Setting, frame: Frame, extents: Extents, curves: Curves, craft: CraftDrawing, close_up: CloseUp
) -> Layout:
    """The layout of a run that reaches as far as `extents` says."""
    radius = reach_of(setting, extents) / frame.unit
    over_planet = not frame.sun and setting.body.radius > 0
    among = style.AMONG_MANY if setting.ensembles else 1.0
    middle = Samples.of(extents.middle, np.array([extents.middle.first]), frame)
    sail, tether = craft.size * radius * among, 0.0
    if over_planet:
        sail = sail if craft.size_over_planet is None else craft.size_over_planet * radius
        tether = min(0.13 * radius, max(0.9 * (extents.nearest / frame.unit - 1), 0.01))
    revolution = revolution_time(extents.middle)
    closed = extents.still and setting.duration / revolution > 1.2 and not frame.sparse
    thrust_scale = (style.THRUST_LENGTH * radius / extents.thrust if extents.thrust > 0 else 1.0) * among
    if not over_planet:
        tips = extents.tips(thrust_scale * frame.unit) / frame.unit
        views = about_sun(
            radius, extents.lowest / frame.unit, extents.highest / frame.unit, tips, middle, setting, craft
        )
        tail = min(0.12 * setting.duration, 0.15 * revolution)
    else:
        views = about_planet(radius, middle, frame, setting)
        tail = min(2.6 * revolution, 0.3 * setting.duration)
    names = name_views(views, setting, frame, craft, tether if craft.tether else sail)
    shown_on = ("sim_time", "step") if setting.epoch is None else ("utc", "sim_time", "step")
    shown, environment = plot_views(curves, frame, craft.steers)
    lanes = tuple(lane for lane, changes in curves.changes.items() if changes)
    slots, lane_share = column(shown, environment, lanes)
    if setting.ensembles:
        slots, lanes = slots_of(setting, shown, environment), ()
        names = (*names, replace(names[0], name=TUBE))
    return Layout(
        sun=frame.sun,
        scene_radius=radius,
        sail_size=sail,
        tether_size=tether,
        thrust_scale=thrust_scale,
        close_thrust_scale=8.0 / np.sqrt(extents.thrust) if extents.thrust > 0 else 1.0,
        cameras=names,
        close_up=close_up.camera(middle),
        slots=slots,
        lanes=lanes,
        lane_share=lane_share,
        hidden=hidden_entities(setting, extents, radius * frame.unit),
        tail=tail,
        past=0.86 * revolution if closed else 0.0,
        future=not closed,
        sparse=frame.sparse,
        timeline=shown_on[0],
        timelines=shown_on,
        speed=extents.span(setting.duration) / setting.play_duration,
        rows_per_second=setting.rows / setting.duration,
        arrivals=arrivals_of(setting) if setting.ensembles else (),
        ensembles=tuple(word(ensemble.name) for ensemble in setting.ensembles),
    )


def reach_of(setting: Setting, extents: Extents) -> float:
    """The largest distance from the centre, m, that must be in sight."""
    references = [float(np.linalg.norm(r.points, axis=1).max()) for r in setting.references if r.role != "planet"]
    spread = [float(e.percentiles.get("radius_m", e.nominal[:, :1].T).max()) for e in setting.ensembles]
    return max([extents.farthest, *references, *spread])


def planets(setting: Setting, extents: Extents) -> dict[str, float]:
    """Farthest distances, m, of the planets that move or whose orbits are drawn."""
    far = {r.name: float(np.linalg.norm(r.points, axis=1).max()) for r in setting.references if r.role == "planet"}
    return far | {name: max(distance, far.get(name, 0.0)) for name, distance in extents.bodies.items() if name != "Sun"}


def hidden_entities(setting: Setting, extents: Extents, reach: float) -> tuple[str, ...]:
    """What would spoil the system view: planets far outside it, and names that would pile up in its centre."""
    far = planets(setting, extents)
    outside = [name for name, distance in far.items() if distance > style.PLANETS_WITHIN * reach]
    inmost = [name for name, distance in far.items() if distance < style.NAMES_FROM * reach and name != "Earth"]
    paths = [f"/world/planets/{name}" for name in outside] + [f"/world/names/{name}" for name in outside + inmost]
    if far and min(far.values()) < 1.4 * style.NAMES_FROM * reach:
        paths.append("/world/sun/name")
    return tuple(paths)


def revolution_time(row: Run) -> float:
    """s that the craft would take to go round at its angular speed in one row; the duration where it hardly moves."""
    position, velocity = row.position[0], row.velocity[0]
    rate = np.linalg.norm(np.cross(position, velocity)) / np.dot(position, position)
    return float(min(2 * np.pi / rate, 20 * row.setting.duration)) if rate > 0 else row.setting.duration


def about_sun(
    radius: float,
    lowest: float,
    highest: float,
    tips: np.ndarray,
    middle: Samples,
    setting: Setting,
    craft: CraftDrawing,
) -> list[Camera]:
    """Cameras of a scene round the Sun: from outside, from the pole, along with the craft.

    tips : (k, 3) view units, where arrows of thrust end: they must be in sight
    """
    lifted = highest - lowest > 0.12 * radius
    direction = unit(np.array([0.11, -0.90, 0.41] if lifted else [0.05, -0.84, 0.53]))
    # the eye sees a third of its distance up and down: an orbit seen aslant and what rises above it must fit in
    half = 0.5 * (highest - lowest) * np.hypot(*direction[:2]) + style.DISC_RADIUS * radius * direction[2]
    distance = max((2.08 if lifted else 1.6) * radius, half / (0.33 if lifted else 0.40))
    reach = float(np.linalg.norm(tips[:, :2], axis=1).max())
    raised = 0.45 * (highest + lowest) if highest - lowest > 0.4 * radius else 0.0
    # the near half of an orbit looks larger than the far one: look at a point in front of the Sun
    nearer = 0.0 if lifted else -0.3 * radius
    middle_of_view = np.array([0.0, nearer, 0.02 * radius + raised])
    distance = max(distance, distance_to_see(tips, middle_of_view, direction))
    if setting.ensembles:  # steeper and closer: ensembles lie in the plane of motion
        direction, distance = unit(np.array([0.05, -0.76, 0.65])), 1.92 * radius
        if lifted:
            direction, distance = unit(np.array([0.08, -0.88, 0.47])), max(1.92 * radius, half / 0.38)
    follow = follow_eye(middle, craft) * radius
    return [
        Camera("System", "/", tuple((middle_of_view + distance * direction).tolist()), tuple(middle_of_view.tolist())),
        Camera("From the pole", "/", (0.0, -0.01 * radius, max(2.45 * radius, 1.5 * highest, 2.1 * reach))),
        Camera("Follow", "/world/rtn", tuple(follow.tolist()), (-0.12 * radius, 0.0, 0.0)),
    ]


def distance_to_see(places: np.ndarray, target: np.ndarray, direction: np.ndarray) -> float:
    """How far from `target` along `direction` an eye must be to see places (k, 3) within its field, about half of its
    distance up and down and once its distance sideways."""
    right = unit(np.cross([0.0, 0.0, 1.0], direction))
    up = np.cross(direction, right)
    off = places - target
    needed = np.maximum(np.abs(off @ up) / 0.47, np.abs(off @ right) / 0.95) + off @ direction
    return float(needed.max())


def follow_eye(middle: Samples, craft: CraftDrawing) -> np.ndarray:
    """Where the view along with the craft looks from, in its orbital frame: a film must show its sunward side."""
    if not craft.facing:
        return np.array([0.30, -0.62, 0.26])
    eyes = np.array([[-0.42, side * 0.50, height] for side in (1, -1) for height in (0.26, 0.44)])
    facing = -unit(eyes) @ middle.normal_rtn[0]
    best: np.ndarray = eyes[np.argmax(facing > 0.3)] if np.any(facing > 0.3) else eyes[np.argmax(facing)]
    return best


def about_planet(radius: float, middle: Samples, frame: Frame, setting: Setting) -> list[Camera]:
    """Cameras of a scene round a planet: over it, along with the craft, along the orbit's pole, and near the edge of
    the planet, where altitudes can be read."""
    sun = middle.run.bodies.get("Sun")
    pole = middle.axes[0, :, 2]
    eye = cameras.over_planet(pole, None if sun is None else unit(sun[0])) * 2.55 * radius
    above = pole if (pole[2] if sun is None else pole @ unit(sun[0])) >= 0 else -pole  # the day side
    above = unit(above + 0.05 * middle.axes[0, :, 0]) * 2.55 * radius
    follow = np.array([[0.30, -0.52, 0.24], [-0.06, 0.16, 0.0]]) * radius / 1.1  # tried on low orbits
    home = "/"
    if sun is not None and setting.duration > SEASON:  # or the eye would be over the night for half of every year
        home, azimuth = "/world/season", np.arctan2(sun[0, 1], sun[0, 0])
        c, s = np.cos(azimuth), np.sin(azimuth)
        eye, above = (np.array([c * v[0] + s * v[1], c * v[1] - s * v[0], v[2]]) for v in (eye, above))
    return [
        Camera(setting.body.name, home, tuple(eye.tolist())),
        Camera("Follow", "/world/rtn", tuple(follow[0].tolist()), tuple(follow[1].tolist()), (1.0, 0.0, 0.0)),
        Camera("Orbit pole", home, tuple(above.tolist())),
        *(descent_camera(radius) if frame.turns > PLANE_TURNS else ()),
    ]


def descent_camera(radius: float) -> list[Camera]:
    """Over the orbits' plane, at the edge of a planet of radius 1, up to the highest orbit; up is away from it."""
    middle, distance = 0.5 * (0.98 + radius), 1.15 * (radius - 0.98)
    return [Camera(DESCENT, "/world/plane", (middle, 0.0, distance), (middle, 0.0, 0.0), (1.0, 0.0, 0.0))]


def name_views(
    views: list[Camera], setting: Setting, frame: Frame, craft: CraftDrawing, drawn: float
) -> tuple[Camera, ...]:
    """Say in the first view's name what is not to scale and what is slowed. drawn : size of the craft, view units."""
    notes, true = [], craft.true_size(setting.craft)
    if true and drawn:
        notes.append(f"{setting.craft.label or 'craft'} ×{in_words(drawn * frame.unit / true)}")
    if frame.sparse and frame.slowed > 1.5:
        notes.append(f"orbiting slowed {in_words(frame.slowed)} times")
    if views[0].origin != "/":
        notes.append("turning with the Sun")
    name = views[0].name + (f" ({', '.join(notes)})" if notes else "")
    return (replace(views[0], name=name), *views[1:])


def in_words(factor: float) -> str:
    """1234567 -> 1.2 million; two digits are enough for an exaggeration."""
    for size, name in ((1e9, " billion"), (1e6, " million"), (1e3, ",000")):
        if factor >= size:
            value = float(f"{factor / size:.2g}")
            if name == ",000" and value != int(value):
                return f"{int(value * 1000):,}"
            return f"{value:.10g}{name}"
    return f"{float(f'{factor:.2g}'):.10g}"
