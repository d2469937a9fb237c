"""Whether a scene asks for more than fits: counted before any memory is asked for, and refused with the number and the
key that allows it."""

from __future__ import annotations

from math import floor, isfinite, pi, sqrt
from typing import TYPE_CHECKING

from sailviz.constants import AU, MU_SUN
from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.conflicts.devices import CONTROLS
from sailviz.scene.conflicts.start_points import PLANETS, mu_of_body, radius_of_body
from sailviz.scene.conflicts.surroundings import IRRADIANCES, WINDS
from sailviz.scene.device import control_of
from sailviz.scene.environment import MsisAtmosphere
from sailviz.scene.sections import FirstOrderApproximation
from sailviz.scene.start import CircularStart, ElementsStart, FlatEllipseStart, PlanetFollowingStart
from sailviz.scene.steering import SmoothedSteering

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

BYTES_PER_ROW = 850  # of a recording, as measured round the Sun; 410 round the Earth
BYTES_PER_MOMENT = 250_800  # of a table of the air
TRACK_POINTS = 720  # of a designed orbit's steering, per revolution


def too_many(scene: Scene, asked: float, limit: str, what: str, place: str, more: str = "") -> Faults:
    """A fault where a scene asks for more than one of its limits. more : what else the sentence says of the number."""
    allowed: int = getattr(scene.limits, limit)
    if asked <= allowed:
        return []
    number = f"{asked:,.0f}" if asked < 1e15 else f"{asked:.3g}" if isfinite(asked) else "endlessly many"
    words = f"asks for {number} {what}{more}, more than the {allowed:,} that limits.{limit} allows"
    return [(place, words)]


def rows(scene: Scene) -> Faults:
    """Rows of the recording, those of all dense windows together."""
    run = scene.propagation
    even = float(run.outputs or 0)
    if run.output_interval is not None:
        even = _count(run.duration, run.output_interval)
    dense = sum(_count(window.end - window.start, window.output_interval) for window in run.dense)
    total = even + dense
    place = "propagation.output_interval" if run.output_interval is not None else "propagation.outputs"
    size = f" (some {total * BYTES_PER_ROW / 1e9:,.3g} GB)"
    return too_many(scene, total, "rows", "rows", "propagation.dense" if dense > even else place, size)


def moments_of_air(scene: Scene) -> Faults:
    """Tables of the air of real space weather, one for each day or each three hours."""
    weather = scene.environment.space_weather
    if weather is None or not isinstance(scene.environment.atmosphere, MsisAtmosphere):
        return []
    step = 10_800.0 if weather.storms else 86_400.0
    size = f" (some {scene.propagation.duration / step * BYTES_PER_MOMENT / 1e9:,.3g} GB)"
    place = "environment.space_weather"
    return too_many(scene, scene.propagation.duration / step, "air_tables", "tables of air", place, size)


def _count(span: float, interval: float) -> float:
    """Rows of a span, both its ends included."""
    rows = span / interval
    return floor(rows) + 1.0 if rows < 1e15 else rows


def draws(scene: Scene) -> Faults:
    """Draws of wind and sunlight and updates of a controller."""
    found, around, whole = [], scene.environment, scene.propagation.duration
    wind, light, control = around.solar_wind, around.irradiance, control_of(scene.device)
    for step, place in (
        (WINDS[type(wind)].step(wind), "environment.solar_wind.redraw"),
        (IRRADIANCES[type(light)].step(light), "environment.irradiance.redraw"),
    ):
        found += too_many(scene, whole / (step or whole), "draws", "draws", place)
    every = None if control is None else CONTROLS[type(control)].interval(control)
    return found + too_many(scene, whole / (every or whole), "draws", "updates", "device.control.interval")


def steps(scene: Scene) -> Faults:
    """Steps of the integration, rows of steering tables that laws and designs make, legs of the first-order
    solution."""
    found, start, whole = [], scene.start, scene.propagation.duration
    shortest = whole / (scene.propagation.largest_step or whole)
    found += too_many(scene, shortest, "integration_steps", "steps", "propagation.largest_step")
    if isinstance(scene.steering, SmoothedSteering):
        held = whole / scene.steering.hold
        found += too_many(scene, held, "steps", "held rows of steering", "steering.hold")
    if isinstance(start, (PlanetFollowingStart, FlatEllipseStart)):
        points = TRACK_POINTS * whole * _rate(scene) / (2 * pi)
        found += too_many(scene, points, "steps", "rows of steering over so many revolutions", "propagation.duration")
    for i, item in enumerate(scene.approximation):
        if isinstance(item, FirstOrderApproximation) and item.leg is not None:
            legs = whole * _rate(scene) / item.leg
            found += too_many(scene, legs, "steps", "legs", f"approximation[{i}].leg")
    return found


def _rate(scene: Scene) -> float:
    """Mean motion of the orbit of the start, rad/s; 0 of what does not come round."""
    start, mu = scene.start, mu_of_body(scene)
    axis = 0.0
    if isinstance(start, PlanetFollowingStart):
        axis = PLANETS[start.planet][0] * AU if start.planet else start.semi_major_axis or 0.0
    elif isinstance(start, FlatEllipseStart):
        axis, mu = start.semi_latus_rectum / (1 - start.eccentricity**2), start.mu_ratio * MU_SUN
    elif isinstance(start, CircularStart):
        axis = start.radius or radius_of_body(scene) + (start.altitude or start.mean_altitude or 0.0)
    elif isinstance(start, ElementsStart):
        axis = start.semi_major_axis
    return sqrt(mu / axis) / axis if axis > 0 else 0.0
