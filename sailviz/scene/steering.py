"""How a craft is steered: the kinds of [steering]."""

from itertools import pairwise
from math import hypot
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from sailviz.scene.values import (
    HALF_TURN,
    POSITIVE,
    Angle,
    Angles,
    Length,
    Section,
    Temperature,
    Three,
    Time,
    Times,
    wrong,
)

InShadow = Literal["hold", "edge-on"]  # how a sail stands in full shadow: as its law says, or edge-on to the flow


class PlainSteering(Section):
    """A law without parameters."""

    kind: Literal[
        "sun-facing", "radial", "circumferential", "tangential", "vertical", "gravity-gradient", "as designed"
    ]
    in_shadow: InShadow | None = None

    @model_validator(mode="after")
    def _shaded(self) -> Self:
        if self.in_shadow is not None and self.kind != "sun-facing":
            raise wrong('in_shadow belongs to a sail that is steered by the light: kind = "sun-facing"')
        return self


class SpinningSteering(Section):
    """A tether that spins, its force averaged over a turn: about the horizontal across the track, so that it lies in
    the plane of motion, or about the velocity."""

    kind: Literal["spinning"]
    plane: Literal["along-track", "across-track"]


class FrameSteering(Section):
    """Pitch and clock angle fixed in the orbital frame or in the meridian plane."""

    kind: Literal["orbital", "meridian"]
    pitch: Annotated[Angle, HALF_TURN]
    clock: Angle = 0.0


class SunFrameSteering(Section):
    """Pitch from the line of the light, and clock angle about it: from the north of the ecliptic, or from the axis of
    the orbit about the central body, towards the motion that a planet has round its light."""

    kind: Literal["sun-frame"]
    pitch: Annotated[Angle, HALF_TURN]
    clock: Angle = 0.0
    reference: Literal["ecliptic", "orbit"] = "ecliptic"
    in_shadow: InShadow | None = None


class OnOffSteering(Section):
    """Facing the light while the craft flies away from it, edge-on to light and flow while it flies towards it."""

    kind: Literal["on-off"]
    by: Literal["motion"] = "motion"
    in_shadow: InShadow | None = None


class InertialSteering(Section):
    """A direction fixed in space."""

    kind: Literal["inertial"]
    direction: Annotated[list[float], Three]

    @model_validator(mode="after")
    def _nonzero(self) -> Self:
        length = hypot(*self.direction)
        if length == 0:
            raise wrong("direction must not be the zero vector")
        if not 1e-100 < length < 1e100:
            raise wrong(f"direction must be a vector of moderate length, for example a unit vector, has {length:.3g}")
        return self


class TableSteering(Section):
    """Pitch, clock angle and throttle over time."""

    kind: Literal["table"]
    frame: Literal["orbital", "meridian"] = "orbital"
    interpolation: Literal["linear", "hold", "cubic"] = "linear"
    time: Annotated[Times, Field(min_length=2)]
    pitch: Angles
    clock: Angles
    throttle: list[Annotated[float, Field(ge=0)]] | None = None

    @model_validator(mode="after")
    def _columns(self) -> Self:
        if len({len(c) for c in (self.time, self.pitch, self.clock, self.throttle) if c is not None}) > 1:
            raise wrong("time, pitch, clock and throttle must have the same length")
        if any(b <= a for a, b in zip(self.time, self.time[1:], strict=False)):
            raise wrong("time must increase")
        return self


SAIL_LAW = Literal[
    "ideal", "eta-perfect", "jpl-1978", "jpl-2015", "electric-sail", "electric-sail-original",
    "electric-sail-updated", "electric-sail-polynomial",
]  # fmt: skip


class PrimerSteering(Section):
    """What laws have in common that make the most of the thrust along a primer: the sail they reckon with, the
    device itself unless another is named."""

    reckons_with: SAIL_LAW | None = None
    in_shadow: InShadow | None = None


class Arc(Section):
    """A stretch of a minimum-time flight of an electric sail, at full thrust, without, or with the share of it that
    keeps the primer at the angle of the switch."""

    kind: Literal["thrust", "coast", "singular"]
    duration: Annotated[Time, POSITIVE]


class Touched(Section):
    """Where a minimum-time flight touches a limit of its distance from the Sun: the time from where the steering
    begins, and by how much the costate along the radius jumps there, in the unit of the costates."""

    time: Annotated[Time, POSITIVE]
    jump: float


class OptimalSteering(PrimerSteering):
    """A minimum-time flight from its initial costates: three of a planar flight, for the radius, the radial and the
    transverse speed (mu = 1, distance of the start = 1), or six, for position and velocity (mu = 1 au = 1). Only their
    ratios steer: all may be scaled alike, whatever H is then. Without arcs the thrust switches where the primer says
    so; a singular arc has to be told. touches : where the costates jump; hottest : temperature of the film above which
    it turns from the Sun."""

    kind: Literal["optimal"]
    costates: Annotated[list[float], Field(min_length=3, max_length=6)]
    arcs: Annotated[list[Arc], Field(min_length=1, max_length=1000)] | None = None
    touches: Annotated[list[Touched], Field(min_length=1, max_length=1000)] | None = None
    hottest: Annotated[Temperature, POSITIVE] | None = None

    @model_validator(mode="after")
    def _count(self) -> Self:
        if len(self.costates) not in (3, 6):
            raise wrong("costates are three numbers of a planar flight or six of any other")
        if not any(self.costates[-len(self.costates) // 2 :]):
            raise wrong("the costates of velocity are all zero: they point the thrust")
        times = [one.time for one in self.touches or ()]
        if any(b <= a for a, b in pairwise(times)):
            raise wrong("the times of touches must increase")
        if self.arcs is not None and times:
            raise wrong("arcs are those of an electric sail, touches those of a flight without arcs: give one of them")
        return self


class SmoothedSteering(Section):
    """A fast transfer of an electric sail to another circle, its voltage falling smoothly towards the coasts; found by
    shooting from costates of radius, radial and transverse speed (of any length) and from the run's duration. Pitch and
    voltage are held over every `hold`."""

    kind: Literal["smoothed-transfer"]
    radius: Annotated[Length, POSITIVE]
    costates: Annotated[list[float], Three]
    hold: Annotated[Time, POSITIVE] = 3600.0
    width: Annotated[float, Field(gt=0, le=1)] = 0.05

    @model_validator(mode="after")
    def _nonzero(self) -> Self:
        if not any(self.costates[1:]):
            raise wrong("the costates of velocity are all zero: they point the thrust")
        return self

    @property
    def interpolation(self) -> str:
        return "hold"


class LocalSteering(PrimerSteering):
    """Whatever changes one orbital element fastest at every moment, the distance of the apogee or of the perigee from
    the centre included, round whatever body. minimum_perigee : distance from the centre below which the perigee must
    not sink; over the margin above it the law gives way to what raises the perigee."""

    kind: Literal["locally-optimal"]
    goal: Literal["energy", "semi-major-axis", "eccentricity", "inclination", "raan", "argument", "apogee", "perigee"]
    sense: Literal["increase", "decrease"] = "increase"
    minimum_perigee: Annotated[Length, POSITIVE] | None = None
    margin: Annotated[Length, POSITIVE] | None = None

    @model_validator(mode="after")
    def _guarded(self) -> Self:
        if self.margin is not None and self.minimum_perigee is None:
            raise wrong("margin stands over minimum_perigee: give that too")
        return self


class LyapunovSteering(PrimerSteering):
    """Down the distance to a target orbit, a weighted sum of squares of the equinoctial elements' misses, until its
    root is `within`; then without thrust."""

    kind: Literal["lyapunov"]
    semi_major_axis: Annotated[Length, POSITIVE]
    eccentricity: Annotated[float, Field(ge=0, lt=1)] = 0.0
    inclination: Annotated[Angle, Field(ge=0, lt=3.14)] = 0.0
    raan: Angle = 0.0
    argument: Angle = 0.0
    weights: Annotated[list[Annotated[float, Field(ge=0)]], Field(min_length=5, max_length=5)] = [1, 1, 1, 1, 1]
    within: Annotated[float, POSITIVE] = 0.02


Steering = Annotated[
    PlainSteering
    | FrameSteering
    | SunFrameSteering
    | OnOffSteering
    | InertialSteering
    | TableSteering
    | SpinningSteering
    | OptimalSteering
    | SmoothedSteering
    | LocalSteering
    | LyapunovSteering,
    Field(discriminator="kind"),
]
