"""The rows of which a picture is made, in the units of the view. At most PICTURE_ROWS of them, evenly spaced over the
run.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailviz.constants import AU
from sailviz.elements import Elements, state
from sailviz.frames import rtn, to_frame, unit
from sailviz.recording import rows
from sailviz.run import Run, Setting

PICTURE_ROWS = 3000  # as many as a replay of 40 s has frames, and then some
SPARSE = 1 / 12  # revolutions between drawn rows above which lines from row to row would be a zigzag
TURNS = 30.0  # revolutions that are shown of a run whose rows are sparse
SMOOTH = 72  # points of a trail per revolution


@dataclass(frozen=True)
class Frame:
    """How a run is drawn; known from its first row, so that it never depends on the blocks in which the run arrives.

    unit m is the length 1 of the system view. With sparse rows the craft is drawn on its osculating orbit, going round
    `TURNS` times in all: its distance, orbit and attitude are those of the row, its place along the orbit is not.
    """

    unit: float
    unit_name: str
    sun: bool  # the Sun is in the centre
    every: int
    rows: int
    mu: float
    period: float  # s of a revolution at the start; inf where it never comes round
    sparse: bool
    longitude: float  # rad, true longitude of the first row
    turns: float  # revolutions of the run at the first row's pace
    smooth: int  # pieces of a trail between neighbouring drawn rows
    origin_radius: float  # distance from the centre at the start, in units

    @staticmethod
    def of(run: Run) -> Frame:
        setting, first = run.setting, rows.take(run, slice(0, 1))
        distance = float(np.linalg.norm(first.position[0]))
        length, name = unit_of(setting, distance)
        every = rows.stride(setting.rows, PICTURE_ROWS)
        a = float(first.elements.semi_major_axis[0])
        period = 2 * np.pi * np.sqrt(a**3 / setting.body.mu) if np.isfinite(a) and a > 0 else np.inf
        spacing = setting.duration / max(setting.rows - 1, 1) * every / period
        return Frame(
            unit=length,
            unit_name=name,
            sun=setting.body.name == "Sun",
            every=every,
            rows=setting.rows,
            mu=setting.body.mu,
            period=period,
            sparse=bool(spacing > SPARSE),
            longitude=float(longitude(first.elements)[0]),
            turns=setting.duration / period,
            smooth=int(np.clip(np.ceil(SMOOTH * spacing), 1, 12)),
            origin_radius=distance / length,
        )

    @property
    def slowed(self) -> float:
        """How many times slower than the run the craft goes round in the picture."""
        return max(self.turns / TURNS, 1.0)


def unit_of(setting: Setting, distance: float) -> tuple[float, str]:
    """Length 1 of the view, m, and its name: au about the Sun, radii of a body that has a size, else a power of ten."""
    if setting.body.name == "Sun":
        return AU, "au"
    if setting.body.radius > 0:
        return setting.body.radius, f"{setting.body.name} radii"
    power = int(np.floor(np.log10(distance))) if distance > 0 else 0
    return 10.0**power, f"10^{power} m"


def longitude(elements: Elements):
    """True longitude, rad: smooth where an orbit is circular or equatorial, which its parts are not."""
    return elements.raan + elements.argument + elements.true_anomaly


@dataclass(frozen=True)
class Samples:
    """Drawn rows. Directions are given in the orbital frame (radial, transverse, normal), (n, 3); `axes` turn them."""

    run: Run
    number: np.ndarray  # (n,) of the row in the whole run
    index: list  # the timelines
    position: np.ndarray  # (n, 3) view units, where the craft is drawn
    axes: np.ndarray  # (n, 3, 3) orbital frame at the drawn place, columns
    velocity: np.ndarray  # (n, 3) view units per second, at the drawn place
    normal_rtn: np.ndarray
    thrust_rtn: np.ndarray  # m/s2
    velocity_rtn: np.ndarray  # unit vector

    @staticmethod
    def of(run: Run, number, frame: Frame) -> Samples:
        position, velocity = run.position, run.velocity
        axes = rtn(position, velocity)
        normal_rtn, velocity_rtn = to_frame(axes, run.attitude.normal), to_frame(axes, unit(velocity))
        if frame.sparse:
            position, velocity = slowed(run, number, frame)
            axes = rtn(position, velocity)
        return Samples(
            run=run,
            number=number,
            index=rows.timelines(run.setting, number, run.time),
            position=position / frame.unit,
            axes=axes,
            velocity=velocity / frame.unit,
            normal_rtn=normal_rtn,
            thrust_rtn=run.thrust.acceleration_rtn,
            velocity_rtn=velocity_rtn,
        )

    def __len__(self) -> int:
        return len(self.number)

    def index_of(self, some) -> list:
        """The timelines of some of the rows."""
        return rows.timelines(self.run.setting, self.number[some], self.run.time[some])


def slowed(run: Run, number, frame: Frame):
    """Places and velocities on the osculating orbits that go round evenly, `TURNS` times over the whole run."""
    e = run.elements
    shown = frame.longitude + 2 * np.pi * min(TURNS, frame.turns) * number / max(frame.rows - 1, 1)
    closed = e.eccentricity < 1
    with np.errstate(invalid="ignore", divide="ignore"):
        anomaly = np.where(closed, shown - e.raan - e.argument, e.true_anomaly)
        position, velocity = state(
            e.semi_major_axis, e.eccentricity, e.inclination, e.raan, e.argument, anomaly, frame.mu
        )
    known = np.all(np.isfinite(position), axis=1, keepdims=True)
    return np.where(known, position, run.position), np.where(known, velocity, run.velocity)


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
        columns = (e.semi_major_axis, e.eccentricity, e.inclination, e.raan, e.argument)
        line, _ = state(*(column[:, None] for column in columns), anomaly, frame.mu)
    line = np.where(np.isfinite(line), line, run.position[:, None, :])
    return line / frame.unit


def smooth_lines(time, position, velocity, pieces: int) -> np.ndarray:
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
