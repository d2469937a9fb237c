"""What a simulation yields: arrays, and the setting that a picture of them needs. float64, SI, radians.

A Run is whole or a block of consecutive rows of one; `join` puts blocks together. Nothing here computes or draws.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np

from sailviz.elements import Elements


@dataclass(frozen=True)
class Body:
    """The central body. mu m3/s2, radius m (0 for a point)."""

    name: str  # "Sun", "Earth" or the scene's own word
    mu: float
    radius: float


@dataclass(frozen=True)
class CraftPart:
    """A part of a craft of its own shape, in body axes. corners (n, 3) m; faces (k, 3), fronts outwards."""

    name: str
    corners: np.ndarray
    faces: np.ndarray
    film: bool  # seen from both sides, its front the sunward one


@dataclass(frozen=True)
class Craft:
    """What flies, for its mesh and its labels. Lengths in m; None where the scene does not say."""

    kind: str  # "solar-sail" | "electric-sail" | "plasma-brake" | "thruster" | "none"
    label: str  # e.g. "Solar sail", "E-sail", "Plasma brake"
    side: float | None = None  # of a square sail
    tethers: int | None = None
    tether_length: float | None = None
    spin: str = ""  # of a tether that spins: the plane in which, "along-track" or "across-track"
    cone: float = 0.0  # rad, by which the straight tethers of a wheel stand downwind of the plane of their hub
    rise: float = 0.0  # of one whose tethers are parabolas: how far downwind their tips are, over their reach
    parts: tuple[CraftPart, ...] = field(default=(), compare=False, repr=False)  # of a sail with a shape, its mesh
    # of such a sail, what tells the pressure of light on its facets, part after part: directions of the light (n, 3) in
    # body axes, and doses (n,) s of films that age or None -> (n, k) over twice the radiation pressure, 0 in the shade
    pressure: Callable[[np.ndarray, np.ndarray | None], np.ndarray] | None = field(
        default=None, compare=False, repr=False
    )
    shape: str = ""  # of such a one: kind, hashes of facets, file and table, facets, area m2, as JSON


@dataclass(frozen=True)
class Reference:
    """A curve that is there from the start: a target orbit, an initial orbit, a planet's orbit. points : (k, 3) m."""

    name: str
    role: str  # "target" | "initial" | "planet" | "approximation"
    points: np.ndarray


@dataclass(frozen=True)
class Phase:
    """What held from one event to the next. start, end s; NaN both where the flight never came to it."""

    name: str
    start: float
    end: float
    words: str = ""  # what held, e.g. "locally optimal, inclination"

    @property
    def reached(self) -> bool:
        """Whether the flight came to it."""
        return not np.isnan(self.start)


@dataclass(frozen=True)
class Shell:
    """A polar map of something round the central body, in the plane of the orbit at the start, e.g. plasma density.

    normal, reference (3,) inertial unit vectors: of the plane, and in it where the angle is 0; angle (m,) rad about the
    normal, altitude (k,) m, both increasing, value (m, k). Drawn as a band that turns with the plane and with the Sun.
    """

    name: str
    unit: str  # of the value, as a label writes it, e.g. "1/m³"
    normal: np.ndarray
    reference: np.ndarray
    angle: np.ndarray
    altitude: np.ndarray
    value: np.ndarray


@dataclass(frozen=True)
class EnsembleStatistics:
    """Many flights of the craft of a run, each through a wind (or sunshine) of its own. n times, SI, radians.

    States are cylindrical about `axes[2]`: distance from the axis m, azimuth rad counted from the start without jumps,
    height m, and the speeds radial, transverse and along the axis, m/s. `planar` flights have height 0: their distance
    from the axis is that from the Sun.
    """

    name: str
    words: str  # what the craft does about it, e.g. "pressure law, at most 40 kV"
    wind: str  # what blows, in words
    method: str  # "monte-carlo" | "polynomial-chaos"
    control: str  # "none" | "pressure" | "distance" | "electrochromic"
    flights: int
    seed: int
    planar: bool
    step: np.ndarray  # (n,) rows of the run that stand at the same times
    time: np.ndarray  # (n,) s
    axes: np.ndarray  # (3, 3) rows: inertial directions of azimuth 0, azimuth 90 deg and the axis
    nominal: np.ndarray  # (n, 6) the flight with thrust factor 1
    kept: np.ndarray  # (k, n, 6) flights drawn whole
    mean: np.ndarray  # (n, 6)
    covariance: np.ndarray  # (n, 6, 6)
    levels: np.ndarray  # (m,) per cent
    percentiles: dict[str, np.ndarray]  # name with unit -> (m, n), e.g. "radius_m", "thrust_factor"
    one: dict[str, np.ndarray]  # name with unit -> (n,) of the first flight: what drove it
    saturated: np.ndarray  # (n,) share of the flights at the largest voltage
    end: np.ndarray  # (flights, 6) states
    end_mean: np.ndarray  # (6,)
    end_deviation: np.ndarray  # (6,)
    mean_factor: float  # thrust over nominal thrust, over time and flights
    mean_voltage: float  # V, over time and flights; NaN for a solar sail
    mean_saturated: float  # share of time at the largest voltage
    limits: dict[str, float]  # "nominal_voltage_V", "maximum_voltage_V", "reference_pressure_Pa", ...
    miss: np.ndarray  # (k', n) m, distance of recorded flights from the nominal one
    error: float  # of integration, largest in position over distance among the first flights
    tail: float = 0.0  # of an expansion: share of the last order in the deviation of distance and azimuth at the end
    histogram_edges: np.ndarray = field(default_factory=lambda: np.zeros(2))  # (b + 1,) m, distance from the nominal
    histogram: np.ndarray = field(default_factory=lambda: np.zeros((1, 1)))  # (n, b) shares

    def places(self, states: np.ndarray) -> np.ndarray:
        """Inertial positions (..., 3) m of cylindrical states (..., 3 or 6)."""
        rho, angle, height = np.moveaxis(np.asarray(states)[..., :3], -1, 0)
        found: np.ndarray = np.stack([rho * np.cos(angle), rho * np.sin(angle), height], axis=-1) @ self.axes
        return found


@dataclass(frozen=True)
class AttitudeEnsemble:
    """Many flights of a craft that turns, each with what it drew. n times, k flights kept whole; SI, radians.

    A quantity's name carries its unit, e.g. "body_rate_rad_s". What a flight is not there for any more is NaN.
    """

    name: str
    words: str  # what was drawn, e.g. "attitude.pitch_deg normal(20, 3)"
    flights: int
    seed: int
    step: np.ndarray  # (n,) rows of the run that stand at the same times
    time: np.ndarray  # (n,) s
    levels: np.ndarray  # (m,) per cent
    percentiles: dict[str, np.ndarray]  # quantity -> (m, n)
    mean: dict[str, np.ndarray]  # quantity -> (n,)
    deviation: dict[str, np.ndarray]  # quantity -> (n,), of the flights
    nominal: dict[str, np.ndarray]  # quantity -> (n,) of the scene's own flight
    kept_axis: np.ndarray  # (k, n, 3) z of the body, inertial
    kept_position: np.ndarray  # (k, n, 3) m
    drawn: dict[str, np.ndarray]  # key of the scene -> (flights,) in the unit of the key
    met: dict[str, np.ndarray]  # event -> (flights,) s, when each flight met it first; NaN where it did not
    # what [[expect]] asks: "body_rate@max" -> (flights + 1,), the last one the scene's own flight
    values: dict[str, np.ndarray] = field(default_factory=dict)

    def share(self, event: str) -> np.ndarray:
        """Share (n,) of the flights that have met an event up to each time."""
        times = self.met.get(event, np.full(self.flights, np.nan))
        found: np.ndarray = np.mean(times[:, None] <= self.time, axis=0)
        return found


@dataclass(frozen=True)
class Setting:
    """Everything about a run that is not a column of numbers."""

    title: str
    family: str  # "displaced" | "spirals" | "deorbit" | "wind" | "transfers" | "planets"
    about: str  # one or two sentences, Markdown
    look_for: tuple[str, ...]  # what to watch, Markdown, one line each
    thesis: str  # section of the thesis, "" where none applies
    body: Body
    craft: Craft
    duration: float  # s, as asked for, or until what ended the run where its rows are spread over that
    rows: int  # rows the whole run will have if nothing stops it before
    epoch: np.datetime64 | None  # UTC label of t = 0, ns
    references: tuple[Reference, ...]
    parameters: tuple[tuple[str, str], ...]  # words and values for the description panel, e.g. ("pitch", "35.26 deg")
    text: str  # the scene file, "" for a trajectory that came without one
    resolved: dict[str, Any]  # every value of the scene, SI
    versions: dict[str, str]
    accuracy: str  # one sentence on how the numbers were made
    identity: str  # hash of the resolved scene, hexadecimal
    play_duration: float | None = None  # s of wall time that a replay takes; None as suits the picture
    plots: tuple[str, ...] = ()  # words of the curves that shall be in front
    shells: tuple[Shell, ...] = ()
    ensembles: tuple[EnsembleStatistics, ...] = ()
    attitude_ensembles: tuple[AttitudeEnsemble, ...] = ()
    gaps: tuple[tuple[float, float], ...] = ()  # s, (start, end) of spans without data
    phases: tuple[Phase, ...] = ()  # of a flight in phases, in their order
    magnetopause: np.ndarray | None = (
        None  # (k, 2) angle from the Sun, rad, and distance, m, within which no wind blows
    )

    def phase_of(self, time: np.ndarray) -> np.ndarray:
        """Number in `phases` (n,) int64 of the phase at times (n,) s; a phase begins with the row at its start."""
        starts = np.array([phase.start for phase in self.phases if phase.reached])
        found: np.ndarray = np.maximum(np.searchsorted(starts, time, side="right") - 1, 0)
        return found


@dataclass(frozen=True)
class Attitude:
    """pitch, cone, clock (n,) rad; normal (n, 3) inertial unit vector: the sail normal away from the Sun, the thrust
    direction of a thruster, or from tip to satellite along a tether; quaternion (n, 4) xyzw, body to inertial, body
    z = normal. A stowed sail has the normal 0, pitch and clock NaN, and z away from the central body. motion : of a
    craft whose attitude moves by itself, name with unit -> (n, 3): rate_rad_s of the body, along its axes;
    angular_momentum_N_m_s, inertial; wheels_N_m_s, what wheels hold of it, along the body's axes."""

    pitch: np.ndarray
    cone: np.ndarray
    clock: np.ndarray
    normal: np.ndarray
    quaternion: np.ndarray
    motion: dict[str, np.ndarray] = field(default_factory=dict)


@dataclass(frozen=True)
class Thrust:
    """acceleration (n, 3) m/s2 inertial, acceleration_rtn (n, 3), magnitude (n,), on (n,) bool."""

    acceleration: np.ndarray
    acceleration_rtn: np.ndarray
    magnitude: np.ndarray
    on: np.ndarray


@dataclass(frozen=True)
class Event:
    """Something that happened at a time between the output rows. time s, state (7,) position m, velocity m/s, mass
    kg."""

    name: str
    time: float
    state: np.ndarray


@dataclass(frozen=True)
class Run:
    """A trajectory with everything that was acting on it. n rows."""

    setting: Setting
    first: int  # number of the first row in the whole run; 0 unless this is a later block
    time: np.ndarray  # (n,) s since the start
    position: np.ndarray  # (n, 3) m, inertial, from the central body
    velocity: np.ndarray  # (n, 3) m/s
    mass: np.ndarray  # (n,) kg; NaN where none is given
    attitude: Attitude
    thrust: Thrust
    elements: Elements[np.ndarray]
    environment: dict[str, np.ndarray]  # name with unit -> (n,) or (n, 3), e.g. "thrust_factor", "plasma_force_N_m"
    bodies: dict[str, np.ndarray]  # name -> (n, 3) m from the central body, e.g. "Earth", or "Sun" seen from the Earth
    approximations: dict[str, np.ndarray] = field(default_factory=dict)  # name -> (n, 3) m, another answer to the same
    devices: dict[str, Thrust] = field(default_factory=dict)  # name -> what each device in a list of them does
    film: dict[str, np.ndarray] = field(default_factory=dict)  # of a sail that ages or gets hot: name with unit -> (n,)
    events: tuple[Event, ...] = ()
    ended: str = field(default="")  # why a run stopped before its duration, "" if it did not

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        from sailviz.run.summary import span

        return f"<Run {self.setting.title}: {span(self)}>"

    def _repr_html_(self) -> str:
        from sailviz.run.summary import html

        return html(self)


COLUMNS = (  # fields of a Run that have a row for each time
    "time",
    "position",
    "velocity",
    "mass",
    "attitude",
    "thrust",
    "elements",
    "environment",
    "bodies",
    "approximations",
    "devices",
    "film",
)


def join(blocks: list[Run]) -> Run:
    """One Run from consecutive blocks."""
    if len(blocks) == 1:
        return blocks[0]

    def stack(parts: list[Any]) -> Any:
        if isinstance(parts[0], np.ndarray):
            return np.concatenate(parts)
        if isinstance(parts[0], dict):
            return {key: stack([part[key] for part in parts]) for key in parts[0]}
        return type(parts[0])(*(stack([getattr(p, f.name) for p in parts]) for f in fields(parts[0])))

    events = tuple(event for block in blocks for event in block.events)
    joined = {name: stack([getattr(block, name) for block in blocks]) for name in COLUMNS}
    return replace(blocks[0], events=events, ended=blocks[-1].ended, **joined)
