"""The rows of which a picture is made, in the units of the view: about PICTURE_ROWS of them, spread over the run's rows
and over its time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import rerun as rr
from numpy.typing import ArrayLike

from sailviz.constants import AU, ROTATION_EARTH
from sailviz.elements import Elements, state
from sailviz.frames import quaternion, rtn, to_frame, unit
from sailviz.recording import timelines
from sailviz.run import gaps
from sailviz.run.arrays import Run, Setting

PICTURE_ROWS = 1010  # 33 in each second of a replay
SPARSE_ROWS = 1010  # where the craft goes round slowly
SPARSE = 1 / 12  # revolutions between drawn rows above which lines from row to row would be a zigzag
TURNS = 30.0  # revolutions that are shown of a run whose rows are sparse
PLANE_TURNS = 6.0  # revolutions round a planet from which a run shows the plane of its orbit
LEAVES = 0.5  # revolutions flown, over those at the first row's pace, below which no picture is slowed
SMOOTH = 72  # points of a trail per revolution
CLOSE = 1 / 6  # revolutions between drawn rows in a dense window
LOW, HIGH = 2.0, 5.0  # radii of a planet within which periapsis and apoapsis of a low orbit lie
STAR = 1e19  # m3/s2, from which a body without a size is a star: a tenth of the Sun's
STILL = 3e-3  # of the circular speed: a craft that is held in place drifts at less


@dataclass(frozen=True)
class Frame:
    """How a run is drawn; known from its first row, so that it never depends on the blocks in which the run arrives.

    unit m is the length 1 of the system view. With sparse rows of more than `TURNS` revolutions the craft is drawn on
    its osculating orbit, going round `TURNS` times in all, and the Earth turns as much slower: distance, orbit and
    attitude are those of the row, the place along the orbit is not. Only where rows are close for a while is it drawn
    where it was. In a run of fewer revolutions every row has its own place, however far apart they are.
    """

    unit: float
    unit_name: str
    sun: bool  # the Sun is in the centre
    low: bool  # a low orbit: its ground lies close below
    most: int  # rows that are drawn, about
    rows: int
    start: float  # s
    duration: float  # s
    mu: float
    period: float  # s of a revolution at the start; inf where it never comes round
    sparse: bool
    close: float  # s between drawn rows below which the place of each is its own even with sparse rows
    longitude: float  # rad, true longitude of the first row
    turns: float  # revolutions of the run at the first row's pace
    smooth: int  # pieces of a trail between neighbouring drawn rows
    origin_radius: float  # distance from the centre at the start, in units

    @staticmethod
    def of(run: Run) -> Frame:
        setting, first = run.setting, timelines.take(run, slice(0, 1))
        distance = float(np.linalg.norm(first.position[0]))
        length, name = unit_of(setting, distance)
        a = float(first.elements.semi_major_axis[0])
        period = 2 * np.pi * np.sqrt(a**3 / setting.body.mu) if np.isfinite(a) and a > 0 else np.inf
        step = (setting.duration - gaps.total(setting.gaps)) / max(setting.rows - 1, 1)
        spacing = step * timelines.stride(setting.rows, PICTURE_ROWS) / period
        sparse = bool(spacing > SPARSE and setting.duration / period > TURNS)
        most = SPARSE_ROWS if sparse else PICTURE_ROWS
        pace = step * timelines.stride(setting.rows, most)
        return Frame(
            unit=length,
            unit_name=name,
            sun=setting.body.name == "Sun",
            low=is_low(first),
            most=most,
            rows=setting.rows,
            start=float(first.time[0]),
            duration=setting.duration,
            mu=setting.body.mu,
            period=period,
            sparse=sparse,
            close=min(CLOSE * period, 0.5 * pace),
            longitude=float(longitude(first.elements)[0]),
            turns=setting.duration / period,
            smooth=int(np.clip(np.ceil(SMOOTH * spacing), 1, 12)),
            origin_radius=distance / length,
        )

    @property
    def slowed(self) -> float:
        """How many times slower than the run the craft goes round in the picture."""
        return max(self.turns / TURNS, 1.0)


def is_low(first: Run) -> bool:
    """Whether the orbit of the first row comes closer to a planet than LOW radii from its centre, and stays within HIGH
    of them."""
    body, e = first.setting.body, first.elements
    if body.name == "Sun" or body.radius <= 0:
        return False
    a, eccentricity, now = float(e.semi_major_axis[0]), float(e.eccentricity[0]), np.linalg.norm(first.position[0])
    nearest, farthest = min(a * (1 - eccentricity), float(now)), a * (1 + eccentricity) if eccentricity < 1 else np.inf
    return bool(nearest < LOW * body.radius and farthest < HIGH * body.radius)


def unit_of(setting: Setting, distance: float) -> tuple[float, str]:
    """Length 1 of the view, m, and its name: au about a star, radii of a body that has a size, else a power of ten."""
    if setting.body.name == "Sun" or (setting.body.radius <= 0 and setting.body.mu > STAR):
        return AU, "au"
    if setting.body.radius > 0:
        return setting.body.radius, f"{setting.body.name} radii"
    power = int(np.floor(np.log10(distance))) if distance > 0 else 0
    return 10.0**power, f"10^{power} m"


def longitude(elements: Elements[np.ndarray]) -> np.ndarray:
    """True longitude, rad: smooth where an orbit is circular or equatorial, which its parts are not."""
    angle: np.ndarray = elements.raan + elements.argument + elements.true_anomaly
    return angle


def as_flown(frame: Frame, run: Run) -> Frame:
    """The frame once the drawn rows are known: a craft that leaves, or spirals out, goes round so much less than the
    pace of its first orbit promised that every row is drawn in its own place."""
    a = run.elements.semi_major_axis
    pace = np.sqrt(np.divide(frame.mu, a**3, out=np.zeros(len(a)), where=np.isfinite(a) & (a > 0)))
    turns = float(np.sum(0.5 * (pace[1:] + pace[:-1]) * np.diff(run.time))) / (2 * np.pi)
    leaves = frame.sparse and turns < LEAVES * frame.turns
    return replace(frame, sparse=False) if leaves else frame


@dataclass(frozen=True)
class Samples:
    """Drawn rows. Directions are given in the orbital frame (radial, transverse, normal), (n, 3); `axes` turn them."""

    run: Run
    number: np.ndarray  # (n,) of the row in the whole run
    index: list[rr.TimeColumn]  # the timelines
    position: np.ndarray  # (n, 3) view units, where the craft is drawn
    axes: np.ndarray  # (n, 3, 3) orbital frame at the drawn place, columns
    velocity: np.ndarray  # (n, 3) view units per second, at the drawn place
    normal_rtn: np.ndarray
    thrust_rtn: np.ndarray  # m/s2
    velocity_rtn: np.ndarray  # unit vector, zero where the craft stands still
    primer_rtn: np.ndarray | None  # unit vector of an optimal transfer's primer
    earth_rotation: np.ndarray | None  # (n,) rad, as drawn
    own_place: np.ndarray  # (n,) bool, whether the craft is drawn where it was
    filled: np.ndarray | None = None  # (n,) bool, which are points between rows; None where there are none

    @staticmethod
    def of(
        run: Run,
        number: np.ndarray,
        frame: Frame,
        before: ArrayLike = (-np.inf, -np.inf),
        filled: np.ndarray | None = None,
        home: tuple[float, float] | None = None,
    ) -> Samples:
        """before : s, times of the two rows drawn before these; filled (n,) bool, which are points between rows; home :
        s, a span in which all stand in their place."""
        position, velocity = run.position, run.velocity
        axes = rtn(position, velocity)
        normal_rtn, velocity_rtn = to_frame(axes, run.attitude.normal), to_frame(axes, unit(velocity))
        pace = np.linalg.norm(velocity, axis=1) / np.sqrt(frame.mu / np.linalg.norm(position, axis=1))
        velocity_rtn = np.where((pace > STILL)[:, None], velocity_rtn, 0.0)
        primer, turned = run.environment.get("primer_direction"), run.environment.get("earth_rotation_rad")
        primer_rtn = None if primer is None else to_frame(axes, primer)
        close = np.ones(len(run), bool)
        if frame.sparse:
            times = np.concatenate([np.asarray(before), run.time])
            close = times[1:] - frame.close < times[:-1]
            close = close[1:] & close[:-1]
            if home is not None:
                close |= (run.time >= home[0]) & (run.time <= home[1])
            even_position, even_velocity = slowed(run, frame)
            position = np.where(close[:, None], position, even_position)
            velocity = np.where(close[:, None], velocity, even_velocity)
            axes = rtn(position, velocity)
            if turned is not None:
                back = ROTATION_EARTH * (1 - 1 / frame.slowed) * (run.time - frame.start)  # what it turns less
                turned = np.where(close, turned, turned - back)
        return Samples(
            run=run,
            number=number,
            index=index_of(run.setting, number, run.time, filled),
            position=position / frame.unit,
            axes=axes,
            velocity=velocity / frame.unit,
            normal_rtn=normal_rtn,
            thrust_rtn=run.thrust.acceleration_rtn,
            velocity_rtn=velocity_rtn,
            primer_rtn=primer_rtn,
            earth_rotation=turned,
            own_place=close,
            filled=filled,
        )

    def __len__(self) -> int:
        return len(self.number)

    def taken(self, some: np.ndarray) -> Run:
        """The run in some of the drawn rows."""
        return timelines.take(self.run, some)

    @property
    def stowed(self) -> np.ndarray:
        """Whether the sail is stowed: it has no normal. (n,) bool"""
        return np.asarray(~self.normal_rtn.any(axis=1))

    @property
    def stance_rtn(self) -> np.ndarray:
        """How the craft stands: its normal, or without one away from the central body. (n, 3)"""
        return np.where(self.stowed[:, None], [1.0, 0.0, 0.0], self.normal_rtn)

    @property
    def lit(self) -> np.ndarray:
        """Whether the craft is in sunlight: by its row where it is drawn in its own place, else outside of the shadow
        as it is drawn. (n,) bool
        """
        sun = self.run.bodies.get("Sun")
        if sun is None:
            return np.asarray(self.run.environment.get("sunlit", np.ones(len(self), bool)), bool)
        away = np.sum(self.position * unit(sun), 1)
        outside = (away > 0) | (np.linalg.norm(self.position - away[:, None] * unit(sun), axis=1) > 1)
        known = self.own_place & ("sunlit" in self.run.environment)
        return np.asarray(np.where(known, self.run.environment.get("sunlit", outside).astype(bool), outside))

    def index_of(self, some: slice | np.ndarray) -> list[rr.TimeColumn]:
        """The timelines of some of the rows."""
        filled = None if self.filled is None else self.filled[some]
        return index_of(self.run.setting, self.number[some], self.run.time[some], filled)


def index_of(setting: Setting, number: np.ndarray, time: np.ndarray, filled: np.ndarray | None) -> list[rr.TimeColumn]:
    """The timelines of rows, or of rows and points between them."""
    if filled is None or not filled.any():
        return timelines.time_columns(setting, number, time)
    return timelines.MixedIndex(setting, number, time, filled)


def slowed(run: Run, frame: Frame) -> tuple[np.ndarray, np.ndarray]:
    """Places and velocities on the osculating orbits that go round evenly, `TURNS` times over the whole run."""
    e = run.elements
    shown = frame.longitude + 2 * np.pi * min(TURNS, frame.turns) * (run.time - frame.start) / frame.duration
    closed = e.eccentricity < 1
    with np.errstate(invalid="ignore", divide="ignore"):
        anomaly = np.where(closed, shown - e.raan - e.argument, e.true_anomaly)
        position, velocity = state(
            e.semi_major_axis, e.eccentricity, e.inclination, e.raan, e.argument, anomaly, frame.mu
        )
    known = np.all(np.isfinite(position), axis=1, keepdims=True)
    return np.where(known, position, run.position), np.where(known, velocity, run.velocity)


def rings(run: Run, axes: np.ndarray, frame: Frame) -> dict[str, np.ndarray]:
    """What makes a circle of radius 1 in x, y the osculating orbits: translation (n, 3), quaternion (n, 4) and scale
    (n, 3), view units. `axes` (n, 3, 3), columns: the frame in which they are given, z the orbit's normal. Open orbits
    shrink to a point.
    """
    e = run.elements
    node = np.stack([np.cos(e.raan), np.sin(e.raan), 0 * e.raan], 1)
    normal = unit(np.cross(run.position, run.velocity))
    ahead = np.cross(normal, node)
    along = np.cos(e.argument)[:, None] * node + np.sin(e.argument)[:, None] * ahead
    along = to_frame(axes, along)
    closed = (e.eccentricity < 1) & np.isfinite(e.semi_major_axis) & np.all(np.isfinite(along), axis=1)
    a = np.where(closed, e.semi_major_axis / frame.unit, 1e-6)
    across = np.where(closed, np.sqrt(np.clip(1 - e.eccentricity**2, 1e-12, 1)), 1.0)
    z = to_frame(axes, normal)
    turn = quaternion(np.stack([along, np.cross(z, along), z], -1))
    return {
        "translation": np.where(closed[:, None], -(a * e.eccentricity)[:, None] * along, 0.0),
        "quaternion": np.where(closed[:, None], turn, [0.0, 0.0, 0.0, 1.0]),
        "scale": np.stack([a, a * across, a], 1),
    }


def orbits(run: Run, frame: Frame, count: int = 121) -> np.ndarray:
    """Osculating orbits as closed lines, (n, count, 3) view units; of open ones the part within 3 distances."""
    e = run.elements
    reach = np.linalg.norm(run.position, axis=1) * 3.0
    with np.errstate(invalid="ignore", divide="ignore"):
        p = e.semi_major_axis * (1 - e.eccentricity**2)
        limit = np.arccos(np.clip((p / reach - 1) / e.eccentricity, -1, 1))
        limit = np.where(e.eccentricity < 1, np.pi, limit)
        around = np.linspace(-1, 1, count)
        closed = (e.eccentricity < 1)[:, None]
        # points of a closed orbit lie evenly about the craft's own place, so that the line meets it
        anomaly = np.where(closed, e.true_anomaly[:, None] + np.pi * (1 + around), limit[:, None] * around)
        a, eccentricity, inclination, raan, argument = (
            column[:, None] for column in (e.semi_major_axis, e.eccentricity, e.inclination, e.raan, e.argument)
        )
        line, _ = state(a, eccentricity, inclination, raan, argument, anomaly, frame.mu)
    line = np.where(np.isfinite(line), line, run.position[:, None, :])
    return np.asarray(line / frame.unit)


def smooth_lines(time: np.ndarray, position: np.ndarray, velocity: np.ndarray, pieces: int) -> np.ndarray:
    """Points between rows by cubic Hermite interpolation. (n,), (n, 3), (n, 3) -> ((n - 1) * pieces + 1, 3)."""
    if pieces == 1 or len(time) < 2:
        return position
    s = (np.arange(pieces) / pieces)[None, :, None]
    h = np.diff(time)[:, None, None]
    p0, p1, v0, v1 = position[:-1, None], position[1:, None], velocity[:-1, None], velocity[1:, None]
    inside = (
        (2 * s**3 - 3 * s**2 + 1) * p0
        + (s**3 - 2 * s**2 + s) * h * v0
        + (3 * s**2 - 2 * s**3) * p1
        + (s**3 - s**2) * h * v1
    )
    return np.concatenate([inside.reshape(-1, 3), position[-1:]])
