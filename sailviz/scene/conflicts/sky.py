"""Whether what pulls, shines, shades and blows in a scene is known, and goes together with what flies in it."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING

from sailviz.scene.attitude import Moving
from sailviz.scene.body import CustomBody
from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.conflicts.records import start_of
from sailviz.scene.conflicts.start_points import radius_of_body
from sailviz.scene.device import DistanceControl, ElectricSail, SolarSail, control_of
from sailviz.scene.environment import SteadyWind
from sailviz.scene.named_files import folder_of, outside, unreadable
from sailviz.scene.sections import FirstOrderApproximation
from sailviz.scene.sky import (
    counts_from_light,
    frame_of,
    has_device,
    is_sail,
    kernel_bodies,
    light_away,
    light_kind,
    light_mu,
    magnetosphere_of,
    shades,
    sky_body,
)
from sailviz.scene.steering import LocalSteering
from sailviz.words import length

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

NOT_AT_CENTRE = "was solved for light at the centre"
FROM_THE_PLANET = ("radial", "orbital", "meridian", "table")  # laws whose angles count from the central body


def bodies_that_pull(scene: Scene) -> Faults:
    """Gravity of bodies whose places are known."""
    named, place, found = scene.environment.gravity_of_bodies, "environment.gravity_of", []
    if scene.environment.gravity_of is None:
        return []
    if len(set(named)) < len(named):
        found.append((place, "a body stands there twice"))
    if {"earth", "moon"} & set(named) and "earth-moon" in named:
        found.append((place, 'earth-moon is both together: give it alone, or "earth" and "moon"'))
    if scene.body in named or (scene.body in ("earth", "moon") and "earth-moon" in named):
        found.append((place, "the central body pulls already"))
    if isinstance(scene.body, CustomBody):
        words = f"where {scene.body.name} is among the planets is not known: give light and third_body"
        found.append((place, words))
    if scene.environment.third_body is not None:
        found.append((place, "one sky at a time: gravity_of, or the circular third_body"))
    return found


def bodies_that_shade(scene: Scene) -> Faults:
    """Shadows of bodies that have a size, on what feels them."""
    named, place, found = scene.environment.shadow_of, "environment.shadow_of", []
    if not named:
        return []
    if not has_device(scene, SolarSail):
        words = "says what hides the light from a solar sail; a plasma brake feels the Earth's shadow by itself"
        return [(place, words)]
    if len(set(named)) < len(named):
        found.append((place, "a body stands there twice"))
    found += [(place, f"{name} has no radius") for name in named if sky_body(name).radius == 0]
    if "sun" in named and light_kind(scene) in ("centre", "ephemeris"):
        found.append((place, "the Sun is the light"))
    if isinstance(scene.body, CustomBody):
        words = f"where {scene.body.name} is among the planets is not known; its own shadow needs no word"
        found.append((place, words))
    return found


def places_of_bodies(scene: Scene) -> Faults:
    """Where bodies stand needs a date, and a source that holds it."""
    asked = kernel_bodies(scene)
    if isinstance(scene.body, CustomBody) and light_kind(scene) == "ephemeris":
        words = f'where {scene.body.name} is among the planets is not known: "circular", "fixed" or "centre"'
        return [("light.kind", words)]
    if asked and scene.epoch is None:
        return [("epoch", "where the bodies stand needs a date: epoch")]
    if not is_sail(scene) or scene.epoch is not None or light_kind(scene) != "circular":
        return []
    if scene.body not in ("earth", "moon") and scene.light is None:
        words = f'where the Sun stands as seen from {scene.body} needs a date: epoch, or light.kind = "circular"'
        return [("epoch", words)]
    return []


def own_kernel(scene: Scene) -> Faults:
    """A kernel of one's own is there, and what reads it."""
    if not scene.ephemeris.lower().endswith(".bsp"):
        return []
    folder = folder_of(scene)
    if what := outside(folder, scene.ephemeris) or unreadable(folder, scene.ephemeris):
        return [("ephemeris", what)]
    if find_spec("jplephem") is None:
        return [("ephemeris", 'a kernel needs the extra "ephemeris": pip install "sailviz[ephemeris]"')]
    return []


def frame(scene: Scene) -> Faults:
    """A frame that is known of the body, with its pole where zonal gravity, air and plasma want it."""
    found: Faults = []
    if scene.frame == "equator-of-date" and scene.body != "earth":
        words = 'is known for body = "earth"; elsewhere "ecliptic-j2000" or "icrf"'
        return [("frame", f"equator-of-date {words}")]
    if scene.body != "earth" or frame_of(scene) == "equator-of-date":
        return []
    around = scene.environment
    for name in ("j2", "atmosphere", "ionosphere"):
        if getattr(around, name):
            found.append((f"environment.{name}", 'counts from the Earth\'s equator: frame = "equator-of-date"'))
    if getattr(scene.start, "ltan", None) is not None:
        found.append(("start.ltan", 'local time counts along the Earth\'s equator: frame = "equator-of-date"'))
    return found


def light(scene: Scene) -> Faults:
    """A light that shines on something, and a strength that it can have."""
    device, found = scene.device, []
    if isinstance(device, SolarSail) and device.lightness_number is not None and light_mu(scene) is None:
        words = "is a share of the light's own pull, which is not known: light.mu, or characteristic_acceleration"
        found.append(("device.lightness_number", words))
    if scene.light is not None and scene.light.kind is not None and not is_sail(scene) and not counts_from_light(scene):
        found.append(("light.kind", "light pushes a sail; nothing in this scene depends on where it is"))
    return found


def steered_by_light(scene: Scene) -> Faults:
    """Round a planet a sail is steered from the line of the light; what was solved or designed for light at the centre
    flies there only, and round the Sun."""
    found: Faults = []
    word = scene.steering.kind if scene.steering is not None else ""
    if is_sail(scene) and light_away(scene) and word in FROM_THE_PLANET:
        found.append(("steering.kind", 'a sail is steered from the Sun line: kind = "sun-frame"'))
    if not is_sail(scene) or scene.body == "sun":
        return found
    if word in ("optimal", "smoothed-transfer"):
        found.append(("steering.kind", f'"{word}" {NOT_AT_CENTRE}, and that of the Sun'))
    if start_of(scene).held or scene.start.kind == "spiral":
        found.append(("start.kind", f"{scene.start.kind}: this orbit {NOT_AT_CENTRE}, and that of the Sun"))
    if light_away(scene):
        for i, item in enumerate(scene.approximation):
            if isinstance(item, FirstOrderApproximation):
                found.append((f"approximation[{i}]", f"the first-order solution {NOT_AT_CENTRE}"))
        if isinstance(control_of(scene.device), DistanceControl):
            found.append(("device.control", "the distance that it controls is that from the Sun at the centre"))
    return found


def guard(scene: Scene) -> Faults:
    """The lowest perigee lies above the ground."""
    steering = scene.steering
    if not isinstance(steering, LocalSteering) or steering.minimum_perigee is None:
        return []
    radius = radius_of_body(scene)
    if steering.minimum_perigee > radius:
        return []
    words = f"counts from the centre of the body, whose radius is {length(radius)}"
    return [("steering.minimum_perigee", words)]


def in_the_wind(scene: Scene) -> Faults:
    """A magnetosphere keeps the wind from an electric sail, round a planet that has one."""
    place, around = "environment.magnetosphere", scene.environment
    if around.magnetosphere is not None and not has_device(scene, ElectricSail):
        return [(place, "a magnetosphere keeps the wind from an electric sail, from no other")]
    kind = magnetosphere_of(scene)
    if kind == "shue-1998" and scene.body != "earth" and "earth" not in around.gravity_of_bodies:
        return [(place, 'shue-1998 is the Earth\'s: body = "earth", or the Earth in gravity_of')]
    if kind == "shue-1998" and not isinstance(around.solar_wind, SteadyWind):
        words = (
            'shue-1998 stands in the nominal wind of 2 nPa: magnetosphere = "none", or a radius, where the wind varies'
        )
        return [(place, words)]
    return []


def drag_by_attitude(scene: Scene) -> Faults:
    """An area that faces the flow or not is that of a sail whose attitude follows the light."""
    device = scene.device
    if device.drag_area != "attitude":
        if device.edge_area is not None:
            return [("device.edge_area", 'belongs to drag_area = "attitude"')]
        return []
    if not isinstance(device, SolarSail) or device.area is None:
        return [("device.drag_area", '"attitude" is for a solar sail that gives its area; of a shape, shape.air')]
    return []


def many_under_a_sky(scene: Scene) -> Faults:
    """Ensembles know the Sun's pull and light alone."""
    if (not scene.ensemble and not scene.chaos) or isinstance(scene.attitude, Moving):
        return []
    place = "ensemble[0]" if scene.ensemble else "chaos[0]"
    if scene.environment.gravity_of is not None:
        return [(place, "an ensemble knows no gravity but the Sun's")]
    if is_sail(scene) and (shades(scene) or counts_from_light(scene) or magnetosphere_of(scene) != "none"):
        return [(place, "an ensemble knows no shadow, no magnetosphere and no steering by the light's frame")]
    return []


QUESTIONS = (
    bodies_that_pull,
    bodies_that_shade,
    places_of_bodies,
    own_kernel,
    frame,
    light,
    steered_by_light,
    guard,
    in_the_wind,
    drag_by_attitude,
    many_under_a_sky,
)


def under_its_sky(scene: Scene) -> Faults:
    """Everything that a scene's sky does not go together with."""
    return [fault for question in QUESTIONS for fault in question(scene)]
