"""What each kind of [start] goes together with."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, pi
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from sailviz.constants import RADIUS_EARTH
from sailviz.scene.conflicts import known_starts, start_points
from sailviz.scene.conflicts.answers import Faults, never, nothing, unknown
from sailviz.scene.device import SolarSail
from sailviz.scene.known_starts import OemStart, PlanetStart, SmallBodyStart, TleStart
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


def nowhere(scene: Scene, start: Section) -> None:
    """Starts of this kind do not say, or have no need to."""


class StartFits(NamedTuple, Generic[S]):
    """Facts of a kind of start. Functions take a section of the kind."""

    held: bool = False  # an orbit that a sail is designed to hold
    track: bool = False  # one that only the steering of its design holds
    keplerian: bool = False  # an orbit of gravity alone
    inclined: Callable[[S], bool] = never
    over_surface: Callable[[S], bool] = never  # counts from the surface of the central body
    point: Callable[[Scene, S], start_points.Vector | None] = nowhere  # where it begins, m
    velocity: Callable[[Scene, S], start_points.Vector | None] = nowhere  # m/s, where it may be at rest
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
    CartesianStart: StartFits[CartesianStart](
        point=start_points.cartesian, velocity=start_points.cartesian_velocity, conflicts=known_starts.cartesian
    ),
    ElementsStart: StartFits[ElementsStart](
        keplerian=True,
        inclined=lambda start: start.inclination != 0,
        point=start_points.elements,
        altitudes=_altitudes_of_elements,
    ),
    CircularStart: StartFits[CircularStart](
        keplerian=True,
        inclined=lambda start: start.inclination != 0,
        over_surface=lambda start: start.altitude is not None,
        point=start_points.circular,
        altitudes=_altitudes_of_circle,
        of_the_earth=_circle_round_the_earth,
    ),
    DisplacedStart: StartFits[DisplacedStart](
        held=True, point=start_points.displaced, velocity=start_points.displaced_velocity
    ),
    HeliostationaryStart: StartFits[HeliostationaryStart](
        held=True, point=start_points.heliostationary, velocity=start_points.heliostationary_velocity
    ),
    LagrangeStart: StartFits[LagrangeStart](held=True, point=start_points.lagrange),
    PlanetFollowingStart: StartFits[PlanetFollowingStart](held=True, track=True, point=start_points.planet_following),
    FlatEllipseStart: StartFits[FlatEllipseStart](held=True, track=True, point=start_points.flat_ellipse),
    SpiralStart: StartFits[SpiralStart](point=start_points.spiral, conflicts=_spiral),
    TleStart: StartFits[TleStart](conflicts=known_starts.element_set),
    OemStart: StartFits[OemStart](conflicts=known_starts.message),
    PlanetStart: StartFits[PlanetStart](conflicts=known_starts.planet),
    SmallBodyStart: StartFits[SmallBodyStart](conflicts=known_starts.small_body),
}
