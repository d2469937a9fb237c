"""What each kind of [start] goes together with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, pi
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from sailviz.constants import RADIUS_EARTH
from sailviz.scene.conflicts.answers import Faults, never, nothing, unknown
from sailviz.scene.device import SolarSail
from sailviz.scene.start import (
    CartesianStart,
    CircularStart,
    DisplacedStart,
    ElementsStart,
    FlatEllipseStart,
    HeliostationaryStart,
    LagrangeStart,
    PlanetFollowingStart,
    SpiralStart,
)
from sailviz.scene.steering import FrameSteering
from sailviz.scene.values import Section

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

S = TypeVar("S", bound=Section)


@dataclass(frozen=True)
class StartFits(Generic[S]):
    """Facts of a kind of start. Functions take a section of the kind."""

    held: bool = False  # an orbit that a sail is designed to hold
    track: bool = False  # one that only the steering of its design holds
    keplerian: bool = False  # an orbit of gravity alone
    inclined: Callable[[S], bool] = never
    over_surface: Callable[[S], bool] = never  # counts from the surface of the central body
    altitudes: Callable[[S], tuple[float, float] | None] = unknown  # lowest and highest over the Earth's equator, m
    of_the_earth: Callable[[S], Faults] = nothing  # what it says that is known round the Earth only
    conflicts: Callable[[Scene, S], Faults] = nothing  # what the kind alone asks of the scene


def _altitudes_of_elements(start: ElementsStart) -> tuple[float, float]:
    a, e = start.semi_major_axis, start.eccentricity
    return a * (1 - e) - RADIUS_EARTH, (a * (1 + e) if e < 1 else inf) - RADIUS_EARTH


def _altitudes_of_circle(start: CircularStart) -> tuple[float, float] | None:
    altitude = start.radius - RADIUS_EARTH if start.radius is not None else start.altitude or start.mean_altitude
    return None if altitude is None else (altitude, altitude)


def _circle_round_the_earth(start: CircularStart) -> Faults:
    found = []
    if start.mean_altitude is not None:
        found.append(("start.mean_altitude", 'is known for body = "earth"; elsewhere give altitude'))
    if start.ltan is not None:
        found.append(("start.ltan", "local time is counted round the Earth"))
    return found


def _spiral(scene: Scene, start: SpiralStart) -> Faults:
    steering = scene.steering
    if not isinstance(scene.device, SolarSail):
        return [("start.kind", "a logarithmic spiral is flown by a solar sail")]
    if not isinstance(steering, FrameSteering) or steering.kind != "orbital":
        return [("steering.kind", 'a logarithmic spiral needs a fixed pitch: kind = "orbital"')]
    if abs(abs(steering.clock) % (2 * pi) - pi / 2) > 1e-9:
        return [("steering.clock", "a logarithmic spiral is planar: clock_deg = 90 (negative pitch goes inwards)")]
    return []


STARTS: dict[type[Section], StartFits[Any]] = {  # the functions of each record take the class that it stands under
    CartesianStart: StartFits[CartesianStart](),
    ElementsStart: StartFits[ElementsStart](
        keplerian=True, inclined=lambda start: start.inclination != 0, altitudes=_altitudes_of_elements
    ),
    CircularStart: StartFits[CircularStart](
        keplerian=True,
        inclined=lambda start: start.inclination != 0,
        over_surface=lambda start: start.altitude is not None,
        altitudes=_altitudes_of_circle,
        of_the_earth=_circle_round_the_earth,
    ),
    DisplacedStart: StartFits[DisplacedStart](held=True),
    HeliostationaryStart: StartFits[HeliostationaryStart](held=True),
    LagrangeStart: StartFits[LagrangeStart](held=True),
    PlanetFollowingStart: StartFits[PlanetFollowingStart](held=True, track=True),
    FlatEllipseStart: StartFits[FlatEllipseStart](held=True, track=True),
    SpiralStart: StartFits[SpiralStart](conflicts=_spiral),
}
