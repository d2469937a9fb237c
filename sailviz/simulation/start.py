"""Where a scene starts, one record per kind: its state, the designed orbit behind it, its words and its curves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from sailviz import elements as orbital
from sailviz.constants import AU, DAY, J2_EARTH, RADIUS_EARTH
from sailviz.design import displaced
from sailviz.environment.sun import sun_parameters
from sailviz.errors import Fault, SceneError
from sailviz.scene.known_starts import OemStart, PlanetStart, SmallBodyStart, TleStart
from sailviz.scene.start import (
    CartesianStart,
    CircularStart,
    DesignedStart,
    DisplacedStart,
    ElementsStart,
    FlatEllipseStart,
    HeliostationaryStart,
    LagrangeStart,
    PlanetFollowingStart,
    SpiralStart,
)
from sailviz.scene.values import Section
from sailviz.simulation import designed_orbits, known_starts
from sailviz.simulation.bodies import epoch_of
from sailviz.words import angle, length

if TYPE_CHECKING:
    from sailviz.design.displaced.holding import Holding, Track
    from sailviz.design.spirals import LogarithmicSpiral
    from sailviz.run.arrays import Body
    from sailviz.scene.loading import Scene

    Design = Holding | LogarithmicSpiral | None  # a Track is a Holding
    State = tuple[np.ndarray, np.ndarray]  # position (3,) m, velocity (3,) m/s
    Rows = list[tuple[str, str]]  # of the description panel: words, value

S = TypeVar("S", bound=Section)


@dataclass(frozen=True)
class Departure(Generic[S]):
    """What a kind of start means. Functions take a section of the kind, and the design where there is one."""

    state: Callable[[Scene, S, Body, Any], State]
    design: Callable[[Scene, S], Design] = lambda scene, start: None  # SceneError where it does not exist
    words: Callable[[S, Any], Rows] = lambda start, design: []
    designed_curve: Callable[[S, Any], np.ndarray | None] = lambda start, design: None  # (k, 3) m
    initial_orbit: bool = False  # drawn: it departs from an orbit of gravity alone
    towards: bool = False  # the same, where the scene has an orbit to reach
    held_radius: Callable[[S], float | None] = lambda start: None  # m, a distance from the Sun that does not change


def departure(scene: Scene) -> Departure[Any]:
    """The record of the scene's kind of start."""
    return STARTS[type(scene.start)]


def design_of(scene: Scene) -> Design:
    """The closed form behind a start on a designed orbit; SceneError where it does not exist."""
    return departure(scene).design(scene, scene.start)


def initial_state(scene: Scene, body: Body, design: Design) -> State:
    """Position (3,) m and velocity (3,) m/s; SceneError for a place inside the body."""
    return _above_ground(scene, body, departure(scene).state(scene, scene.start, body, design))


def held_radius(scene: Scene) -> float | None:
    """Distance from the Sun, m, at which the scene's orbit stays; None if it does not."""
    return departure(scene).held_radius(scene.start)


def _beside(state: State, start: DesignedStart) -> State:
    """A little beside a designed orbit, as the start says."""
    return state[0] + start.position_offset, state[1] + start.velocity_offset


def _displaced(scene: Scene, start: DisplacedStart, body: Body, design: Holding) -> State:
    return _beside(displaced.state(start.radius, start.elevation, start.rate_ratio, start.azimuth), start)


def _at_rest(scene: Scene, start: HeliostationaryStart, body: Body, design: Holding) -> State:
    return _beside(displaced.state(start.radius, start.elevation, 0.0, start.azimuth), start)


def _lagrange(scene: Scene, start: LagrangeStart, body: Body, design: Holding) -> State:
    third = scene.environment.third_body
    mu, orbit, azimuth = (0.0, AU, 0.0) if third is None else (third.mu, third.radius, third.azimuth)
    ratio = (start.radius / orbit) ** 1.5 * np.sqrt(1 + mu / body.mu)  # of the planet's rate to Kepler's at the craft
    return _beside(displaced.state(start.radius, 0.0, ratio, azimuth), start)


def _on_track(scene: Scene, start: DesignedStart, body: Body, design: Track) -> State:
    return _beside((design.position[0], design.velocity[0]), start)


def _spiral(scene: Scene, start: SpiralStart, body: Body, design: LogarithmicSpiral) -> State:
    return design.state(start.radius, start.azimuth, body.mu)


def _circular(scene: Scene, start: CircularStart, body: Body, design: None) -> State:
    radius, node = _circle(scene, start, body), _node(scene, start)
    return orbital.state(radius, 0.0, start.inclination, node, 0.0, start.argument_of_latitude, body.mu)


def _elements(scene: Scene, start: ElementsStart, body: Body, design: None) -> State:
    return orbital.state(
        start.semi_major_axis,
        start.eccentricity,
        start.inclination,
        start.raan,
        start.argument,
        start.true_anomaly,
        body.mu,
    )


def _above_ground(scene: Scene, body: Body, state: State) -> State:
    position, _ = state
    if not np.isfinite(position).all() or np.linalg.norm(position) <= body.radius:
        raise SceneError([Fault("start", f"this point is not above the surface of the {body.name}.")], scene.source)
    return state


def _circle(scene: Scene, start: CircularStart, body: Body) -> float:
    """Radius, m, of a circular start; for a mean altitude the one whose mean semi-major axis lies there."""
    if start.radius is not None:
        return start.radius
    if start.altitude is not None:
        return body.radius + start.altitude
    assert start.mean_altitude is not None  # the section gives one of the three
    return orbital.osculating_radius(
        body.radius + start.mean_altitude,
        start.inclination,
        start.argument_of_latitude,
        J2_EARTH * RADIUS_EARTH**2 if scene.environment.j2 else 0.0,
    )


def _node(scene: Scene, start: CircularStart) -> float:
    """Right ascension of the ascending node, rad, from itself or from the local time of passing it."""
    if start.ltan is None:
        return start.raan or 0.0
    sun = sun_parameters(epoch_of(scene), scene.environment.sun_right_ascension or 0.0)
    return float(np.remainder(sun[0] + 2 * np.pi * (start.ltan / DAY - 0.5), 2 * np.pi))


def _displaced_words(start: DisplacedStart, design: Holding) -> Rows:
    return [
        ("distance from the Sun", length(start.radius)),
        ("elevation", angle(start.elevation)),
        ("Ω / Ω_K", f"{start.rate_ratio:.6g}"),
        ("cone angle", angle(float(design.cone))),
    ]


def _distance_words(start: HeliostationaryStart | LagrangeStart, design: Holding) -> Rows:
    return [("distance from the Sun", length(start.radius))]


def _planet_following_words(start: PlanetFollowingStart, design: Track) -> Rows:
    return [("elevation", angle(start.elevation)), ("distance over the planet's", f"{start.radius_ratio:.6g}")]


def _flat_ellipse_words(start: FlatEllipseStart, design: Track) -> Rows:
    return [("height", length(start.height)), ("eccentricity", f"{start.eccentricity:.6g}")]


def _spiral_words(start: SpiralStart, design: LogarithmicSpiral) -> Rows:
    return [("flight-path angle", angle(float(design.flight_path_angle)))]


def _circular_words(start: CircularStart, design: None) -> Rows:
    sizes = (("radius", start.radius), ("altitude", start.altitude), ("mean altitude", start.mean_altitude))
    rows = [(f"initial {name}", length(value)) for name, value in sizes if value is not None]
    return rows + ([("inclination", angle(start.inclination))] if start.inclination else [])


def _elements_words(start: ElementsStart, design: None) -> Rows:
    return [("semi-major axis", length(start.semi_major_axis)), ("eccentricity", f"{start.eccentricity:.6g}")]


def _ring(start: DisplacedStart, design: Holding) -> np.ndarray:
    turn = np.linspace(0, 2 * np.pi, 361)
    rho, z = start.radius * np.cos(start.elevation), start.radius * np.sin(start.elevation)
    return np.column_stack([rho * np.cos(turn), rho * np.sin(turn), np.full_like(turn, z)])


def _first_turn(start: DesignedStart, design: Track) -> np.ndarray:
    return design.position[: designed_orbits.TRACK_POINTS + 1]


def _radius(start: DisplacedStart | HeliostationaryStart | LagrangeStart) -> float:
    return start.radius


STARTS: dict[type[Section], Departure[Any]] = {  # the functions of each record take the class that it stands under
    CartesianStart: Departure[CartesianStart](known_starts.cartesian, towards=True),
    ElementsStart: Departure[ElementsStart](_elements, words=_elements_words, initial_orbit=True),
    CircularStart: Departure[CircularStart](_circular, words=_circular_words, initial_orbit=True),
    DisplacedStart: Departure[DisplacedStart](
        _displaced,
        designed_orbits.displaced_orbit,
        _displaced_words,
        _ring,
        held_radius=_radius,
    ),
    HeliostationaryStart: Departure[HeliostationaryStart](
        _at_rest, designed_orbits.heliostationary, _distance_words, held_radius=_radius
    ),
    LagrangeStart: Departure[LagrangeStart](
        _lagrange, designed_orbits.lagrange_point, _distance_words, held_radius=_radius
    ),
    PlanetFollowingStart: Departure[PlanetFollowingStart](
        _on_track, designed_orbits.planet_following, _planet_following_words, _first_turn
    ),
    FlatEllipseStart: Departure[FlatEllipseStart](
        _on_track, designed_orbits.flat_ellipse, _flat_ellipse_words, _first_turn
    ),
    SpiralStart: Departure[SpiralStart](_spiral, designed_orbits.logarithmic_spiral, _spiral_words),
    TleStart: Departure[TleStart](known_starts.element_set, words=known_starts.element_set_words, initial_orbit=True),
    OemStart: Departure[OemStart](known_starts.message, initial_orbit=True),
    PlanetStart: Departure[PlanetStart](known_starts.planet, words=known_starts.planet_words, towards=True),
    SmallBodyStart: Departure[SmallBodyStart](
        known_starts.small_body, words=known_starts.small_body_words, towards=True
    ),
}
