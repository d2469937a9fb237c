"""A scene's events as the propagator watches them: one record per kind, and quantities by their numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from sailviz.propagate import events
from sailviz.propagate.callbacks import Callback
from sailviz.propagate.film_quantities import film_quantities
from sailviz.propagate.quantity_callback import (
    FILM_TEMPERATURE,
    INVERSE,
    MAGNETOPAUSE,
    OF_BODY,
    OF_FILM,
    OF_WHEEL,
    QUANTITIES,
    quantity_callback,
)
from sailviz.propagate.sky_quantities import sky_quantities
from sailviz.propagate.wheel_callback import wheel_quantities
from sailviz.propulsion.devices import PLASMA_BRAKE
from sailviz.scene.device import air_on_facets
from sailviz.scene.film import heats_shape
from sailviz.scene.phases import Phase, Until, end_of, until_of
from sailviz.scene.quantities import ON_A_CIRCLE
from sailviz.scene.sky import has_sky, magnetosphere_of
from sailviz.simulation.device import device_of
from sailviz.simulation.turning import events_of_turning, moves

if TYPE_CHECKING:
    from sailviz.run.arrays import Body
    from sailviz.scene.events import Crossing, Watched
    from sailviz.scene.loading import Scene

ANGLES_ON_A_CIRCLE = (*ON_A_CIRCLE, "longitude")  # a direction, where it is watched: it does not count revolutions

TOO_HOT = "too-hot"
_SENSE = {"up": 1, "down": -1, "both": 0}


@dataclass(frozen=True)
class Watching:
    """How a kind of event is watched."""

    function: Callable[[Scene], int]  # of `propagate.events`, whose level is passed
    level: Callable[[Watched, Body], float] = lambda event, body: 0.0  # of those that the event itself gives
    sense: int | None = None  # in which the level is passed: 1 up, -1 down; None as the event says


def _plainly(function: int) -> Callable[[Scene], int]:
    return lambda scene: function


def _mean_axis(scene: Scene) -> int:
    return events.MEAN_AXIS if scene.environment.j2 else events.AXIS


def _radius(event: Watched, body: Body) -> float:
    return event.radius or 0.0


def _over_the_surface(event: Watched, body: Body) -> float:
    return body.radius + (event.altitude or 0.0)


EVENTS = {
    "radius": Watching(_plainly(events.RADIUS), _radius),
    "altitude": Watching(_plainly(events.RADIUS), _over_the_surface),
    "mean-altitude": Watching(_mean_axis, _over_the_surface),
    "periapsis": Watching(_plainly(events.APSIS), sense=1),
    "apoapsis": Watching(_plainly(events.APSIS), sense=-1),
    "node": Watching(_plainly(events.NODE)),
    "escape": Watching(_plainly(events.ENERGY), sense=1),
    "too-hot": Watching(_plainly(events.QUANTITY + FILM_TEMPERATURE), sense=1),
}


def crossing_row(item: Crossing, body: Body, action: int) -> tuple[int, float, int, int]:
    """The row of `events.watch` for a quantity that crosses a value."""
    stem, level = item.quantity or "", item.level
    kind = (events.ON_A_CIRCLE if stem in ANGLES_ON_A_CIRCLE else events.QUANTITY) + QUANTITIES.index(stem)
    if stem in INVERSE:
        level = -1.0 / (level + (body.radius if stem == "apogee_altitude" else 0.0))
    return kind, level, _SENSE[item.sense], action


def watched(scene: Scene, body: Body, phase: Phase | None = None) -> tuple[tuple[str, ...], events.Watch]:
    """Names and Watch of the scene's events, of those that come with a device, and of the one that ends a phase."""
    names, rows = [], []
    for event in scene.event:
        action = events.STOP if event.stop else events.RECORD
        names.append(event.called)
        if event.kind is None:
            rows.append(crossing_row(event, body, action))
            continue
        kind = EVENTS[event.kind]
        sense = _SENSE[event.sense] if kind.sense is None else kind.sense
        level = getattr(scene.device, "hottest", 0.0) if event.kind == TOO_HOT else kind.level(event, body)
        rows.append((kind.function(scene), level, sense, action))
    asked = any(event.kind == TOO_HOT for event in scene.event)  # which says by itself whether the run ends there
    for name, row in device_of(scene).events(scene.device, body):
        if name == TOO_HOT and asked:
            continue
        names.append(name)
        rows.append(row)
    for name, stem, level in events_of_turning(scene):
        names.append(name)
        rows.append((events.QUANTITY + QUANTITIES.index(stem), level, 1, events.RECORD))
    if magnetosphere_of(scene) != "none":
        edge = events.QUANTITY + MAGNETOPAUSE
        names += ["wind on", "wind off"]
        rows += [(edge, 0.0, 1, events.RECORD), (edge, 0.0, -1, events.RECORD)]
    until = None if phase is None else until_of(phase)
    if phase is not None and isinstance(until, str):
        rows.append((*rows[names.index(until)][:3], events.STOP))
        names.append(end_of(phase.name))
    elif phase is not None and isinstance(until, Until) and until.duration is None and until.time is None:
        rows.append(crossing_row(until, body, events.STOP))
        names.append(end_of(phase.name))
    return tuple(names), events.watch(rows)


def latest_end(phase: Phase, begin: float, duration: float) -> float:
    """Time, s, at which a phase that begins at a time ends, or the run, unless an event ends it before."""
    until = until_of(phase)
    if not isinstance(until, Until):
        return duration
    if until.duration is not None:
        return min(begin + until.duration, duration)
    return min(until.time, duration) if until.time is not None and until.time > begin else duration


def quantities_watched(scene: Scene, device: int, phase: Phase | None = None) -> Callback | None:
    """What tells the quantities that the scene's events watch, and the end of a phase; None where they watch none.
    device : of propulsion.devices."""
    stems = _stems_watched(scene, phase)
    if any(stem in OF_WHEEL for stem in stems):
        return wheel_quantities(all(stem in OF_WHEEL for stem in stems))
    stems |= {stem for _, stem, _ in events_of_turning(scene)}
    stems -= set(OF_BODY)  # which what turns knows by itself
    blown = magnetosphere_of(scene) != "none"
    if any(stem in OF_FILM for stem in stems):
        alone = not blown and all(stem in OF_FILM for stem in stems)
        if heats_shape(scene):
            from sailviz.propagate.shape_heat_callback import shape_heat_quantities

            return shape_heat_quantities(alone, has_sky(scene))
        return film_quantities(alone, has_sky(scene))
    if air_on_facets(scene.device) and "air_drag" in stems:
        if moves(scene):
            from sailviz.propagate.body_air import body_air_quantities

            return body_air_quantities()
        from sailviz.propagate.shape_air_callback import shape_quantities

        return shape_quantities()
    if has_sky(scene) and (stems or blown):
        return sky_quantities()
    return quantity_callback(stems, device == PLASMA_BRAKE, moves(scene)) if stems else None


def _stems_watched(scene: Scene, phase: Phase | None) -> set[str]:
    """What the scene's own events watch, and those that a film that may be too hot and a wheel bring along."""
    stems = {event.quantity for event in scene.event if event.kind is None and event.quantity}
    until = None if phase is None else until_of(phase)
    if isinstance(until, Until) and until.quantity is not None:
        stems.add(until.quantity)
    if getattr(scene.device, "hottest", None) is not None:
        stems.add("film_temperature")
    wheel = getattr(scene.device, "wheel", None)
    if wheel is not None and wheel.hold:
        stems.add("modulation")
    return stems
