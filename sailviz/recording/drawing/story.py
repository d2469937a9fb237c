"""The whole run in its drawn rows: what can only be drawn once it is known where the flight goes and how it ends."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sailviz.frames import body_axes, from_frame, unit
from sailviz.recording import timelines
from sailviz.recording.drawing.craft import CraftDrawing
from sailviz.recording.drawing.log import Index
from sailviz.recording.drawing.near import Near, near_of
from sailviz.recording.drawing.samples import Frame, Samples
from sailviz.recording.drawing.ways import Ways, ways_of
from sailviz.run import gaps
from sailviz.run.arrays import Event, Run, Setting

RING_DEPTH = 0.12  # change of distance, of the largest, up to which an orbit counts as one ring
RING_TILT = 0.05  # rad that its plane may turn
RING_TURNS = 1.2  # revolutions from which it is drawn once round
LIFTED = 0.10  # height over the plane x, y, of S, from which a flight counts as lifted out of it
BRIGHT_TAIL = 0.10  # of the duration, and at most BRIGHT_TURN revolutions: the bright part of the trail
BRIGHT_TURN = 0.13
ARROW, RING_ARROW, TURNS_ARROW = (
    0.17,
    0.12,
    0.10,
)  # of S, arrows of the push: of a flight, of a ring, of very many turns
SPINS = 8  # turns of a spinning tether in a replay, so that the eye follows
SPIN_AXIS = {"along-track": (0.0, 1.0, 0.0), "across-track": (1.0, 0.0, 0.0)}  # in the body: x ahead, z up
GROUND = 200e3  # m below which a descent is a plunge, without a mean orbit


def reach_of(setting: Setting, run: Run) -> float:
    """The largest distance from the centre, m, that must be in sight."""
    drawn = [r for r in setting.references if r.role != "planet"]
    references = [float(np.linalg.norm(reference.points, axis=1).max()) for reference in drawn]
    spread = [float(e.percentiles.get("radius_m", e.nominal[:, :1].T).max()) for e in setting.ensembles]
    return max([float(np.linalg.norm(run.position, axis=1).max()), *references, *spread])


@dataclass(frozen=True)
class Arrows:
    """Of pushes: `least` of S for a weak one, twice that for the strongest, `most` m/s2."""

    least: float
    most: float


@dataclass(frozen=True)
class Story:
    """The drawn rows of a whole run, n of them, and what happened. Lengths in view units where not said otherwise."""

    samples: Samples
    frame: Frame
    craft: CraftDrawing
    events: tuple[Event, ...]
    reach: float  # S: the largest distance from the centre that is drawn
    beside: Arrows | None = None  # how long arrows are where several flights are drawn
    rows: Story | None = None  # the rows alone, where these samples hold points between them as well
    fine: bool = False  # of the rows alone: the way between them is drawn wherever there are points on it
    unknown: tuple[int, ...] = ()  # of the rows alone: those from which no way is known to the next

    @property
    def told(self) -> Story:
        """The rows alone."""
        return self.rows or self

    @property
    def setting(self) -> Setting:
        """Everything about the run that is not a column."""
        return self.samples.run.setting

    @property
    def index(self) -> Index:
        """The timelines of all rows."""
        return self.samples.index

    @property
    def time(self) -> np.ndarray:
        """(n,) s"""
        return self.samples.run.time

    @property
    def duration(self) -> float:
        """s from the first row to the last."""
        return float(self.time[-1] - self.time[0])

    @cached_property
    def share(self) -> np.ndarray:
        """(n,) of the time that has passed, 0 to 1."""
        return np.asarray((self.time - self.time[0]) / max(self.duration, 1e-30))

    @property
    def position(self) -> np.ndarray:
        """(n, 3) where the craft is drawn."""
        return self.samples.position

    @cached_property
    def distance(self) -> np.ndarray:
        """(n,) from the centre."""
        return np.asarray(np.linalg.norm(self.position, axis=1))

    @cached_property
    def normal(self) -> np.ndarray:
        """(n, 3) of the sail, inertial, at the drawn place."""
        return np.asarray(from_frame(self.samples.axes, self.samples.normal_rtn))

    @cached_property
    def stance(self) -> np.ndarray:
        """(n, 3) how the craft stands, inertial: its normal, or without one away from the centre."""
        return np.asarray(from_frame(self.samples.axes, self.samples.stance_rtn))

    @cached_property
    def stowed(self) -> np.ndarray:
        """(n,) whether there is a sail, but no film or wheel is out."""
        return self.samples.stowed & (self.craft.facing or self.craft.slanted)

    @cached_property
    def breaks(self) -> np.ndarray:
        """(m,) rows after which there is no data until the next row."""
        return gaps.last_rows(self.time, self.setting.gaps)

    @cached_property
    def gaps(self) -> tuple[tuple[float, float], ...]:
        """s, (start, end) of the spans without data that lie between drawn rows."""
        return tuple(gap for gap in self.setting.gaps if len(gaps.last_rows(self.time, [gap])))

    @property
    def gap_index(self) -> Index:
        """The timelines just within each gap."""
        return timelines.between_rows(self.setting, gaps.moments(self.gaps))

    @cached_property
    def ways(self) -> Ways:
        """How the trail gets from row to row where these lie far apart."""
        return ways_of(self.samples, self.frame, self.breaks, fine=self.fine)

    @cached_property
    def thrust(self) -> np.ndarray:
        """(n, 3) m/s2, inertial, at the drawn place."""
        return np.asarray(from_frame(self.samples.axes, self.samples.thrust_rtn))

    @cached_property
    def near(self) -> Near:
        """What acts on the craft in the frame of the close-up."""
        return near_of(self.samples, self.craft.facing or self.craft.slanted, self.frame.sun)

    @property
    def push(self) -> np.ndarray:
        """(n,) m/s2, size of the thrust."""
        return self.samples.run.thrust.magnitude

    @cached_property
    def most(self) -> float:
        """m/s2, the largest push; 0 for a ballistic craft."""
        return float(self.push.max())

    @cached_property
    def altitude(self) -> np.ndarray:
        """(n,) m: the mean altitude of the orbit, or, near re-entry, the height of the craft over the ground."""
        run, radius = self.samples.run, self.setting.body.radius
        a = run.elements.semi_major_axis
        mean = run.environment.get("mean_altitude_m", np.where(a > 0, a, np.nan) - radius)
        own = np.linalg.norm(run.position, axis=1) - radius
        return np.asarray(np.where((mean > GROUND) & np.isfinite(mean), mean, own))

    @cached_property
    def spin(self) -> np.ndarray | None:
        """Quaternions (n, 4) xyzw by which a spinning tether is turned in the frame of its body; None of any other.

        How fast it spins is no part of a run, whose force is the mean over a turn: it goes round `SPINS` times.
        """
        plane = self.setting.craft.spin
        if not plane:
            return None
        half = np.pi * SPINS * self.share
        about, still = [*SPIN_AXIS[plane], 0.0], [0.0, 0.0, 0.0, 1.0]
        return np.asarray(np.outer(np.sin(half), about) + np.outer(np.cos(half), still))

    @cached_property
    def tether_rtn(self) -> np.ndarray:
        """(n, 3) from the tip of a tether to its satellite, in the orbital frame."""
        hanging = self.samples.normal_rtn
        if self.spin is None:
            return hanging
        body = body_axes(self.samples.stance_rtn, np.tile([0.0, 1.0, 0.0], (len(hanging), 1)))
        x, y, _, w = self.spin.T
        turned = np.stack([2 * y * w, -2 * x * w, 1 - 2 * (x * x + y * y)], 1)
        return np.asarray(np.einsum("nij,nj->ni", body, turned))

    @cached_property
    def drag_word(self) -> str:
        """What acts on a craft in low orbit, in words: its tether's drag, its own push or, without either, the air."""
        if self.craft.descends:
            return "drag"
        return "push" if self.craft.pushes or "air_drag_N" not in self.samples.run.environment else "air drag"

    @cached_property
    def drag(self) -> np.ndarray:
        """(n,) m/s2 of that."""
        if self.drag_word != "air drag":
            return self.push
        return np.asarray(self.samples.run.environment["air_drag_N"] / self.samples.run.mass)

    def about(self, word: str) -> bool:
        """Whether the scene's own words speak of something."""
        setting = self.setting
        return any(word in text.lower() for text in (setting.title, setting.about, *setting.look_for))

    @cached_property
    def turns(self) -> float:
        """Revolutions flown, by the angle that the line from the centre sweeps."""
        run = self.samples.run
        rate = np.linalg.norm(np.cross(run.position, run.velocity), axis=1) / np.sum(run.position**2, 1)
        return float(np.trapezoid(rate, run.time) / (2 * np.pi)) if len(self.time) > 1 else 0.0

    @cached_property
    def ring(self) -> bool:
        """Whether the flight goes round on one ring."""
        tilt = self.samples.run.elements.inclination
        depth = self.distance.max() - self.distance.min()
        level = np.ptp(tilt) < RING_TILT and depth < RING_DEPTH * self.distance.max()
        return bool(level and self.turns > RING_TURNS)

    @cached_property
    def lifted(self) -> bool:
        """Whether the flight leaves the plane x, y."""
        return bool(np.abs(self.position[:, 2]).max() > LIFTED * self.reach)

    @cached_property
    def tail(self) -> float:
        """s of the bright part of the trail."""
        return min(BRIGHT_TAIL * self.duration, BRIGHT_TURN * self.duration / max(self.turns, 0.2))

    @cached_property
    def once_round(self) -> int:
        """Number of rows in the first revolution of a ring; all rows of another flight."""
        if not self.ring:
            return len(self.time)
        return int(np.searchsorted(self.time, self.time[0] + self.duration / self.turns)) + 1

    @cached_property
    def moments(self) -> np.ndarray:
        """About sixty rows spread over the time: those by which a camera is judged."""
        return np.unique(np.searchsorted(self.share, np.linspace(0, 1, 61)).clip(0, len(self.time) - 1))

    def ladder(self, count: int) -> np.ndarray:
        """Rows at `count` even steps of the time, or the first ones after, the first row among them."""
        wanted = np.searchsorted(self.share, np.linspace(0, 1, count + 1) - 1e-9)
        return np.unique(wanted.clip(0, len(self.time) - 1))

    @property
    def arrows(self) -> Arrows:
        """How long the arrow of its push is, by itself or beside other flights."""
        least = TURNS_ARROW if self.frame.sparse else RING_ARROW if self.ring else ARROW
        return self.beside or Arrows(least, self.most)

    def arrow(self) -> np.ndarray:
        """(n, 3) the arrow of the push: never short where it pushes at all, nothing where it does not."""
        least, most = self.arrows.least, self.arrows.most
        length = least + least * self.push / most if most > 0 else np.zeros(len(self.time))
        return np.asarray((length * (self.push > 0))[:, None] * self.reach * unit(self.thrust))
