"""What a scene means by its sky: where the light is, in which frame it is flown, whose places it needs. Plain words."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from sailviz.constants import YEAR
from sailviz.scene.body import CustomBody
from sailviz.scene.device import Device, ElectricSail, SolarSail
from sailviz.scene.light import LightKind
from sailviz.scene.steering import LocalSteering, OnOffSteering, SunFrameSteering
from sailviz.sky.bodies import BODIES, SkyBody

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

SERIES = "mean-elements"
EVEN_OBLIQUITY = 0.40908772337  # rad, 23.439 deg: of the even Sun round the Earth
EVEN_PERIOD = YEAR


def is_sail(scene: Scene) -> bool:
    """Whether light or wind pushes the craft."""
    return isinstance(scene.device, (SolarSail, ElectricSail))  # of several devices the first sail


def has_device(scene: Scene, kind: type[Device]) -> bool:
    """Whether one of the craft's devices is of a kind."""
    return any(isinstance(device, kind) for device in scene.devices)


def light_kind(scene: Scene) -> LightKind:
    """Where the light is: what the scene says, else at the centre of the Sun or of an own body, else the Sun by its
    ephemeris where there is a date, else evenly round."""
    said = scene.light.kind if scene.light is not None else None
    if scene.body == "sun" and said in (None, "ephemeris"):
        return "centre"
    if said is not None:
        return said
    if isinstance(scene.body, CustomBody):
        return "centre"
    return "circular" if scene.epoch is None else "ephemeris"


def light_away(scene: Scene) -> bool:
    """Whether what shines is not the central body."""
    return light_kind(scene) != "centre"


def frame_of(scene: Scene) -> str:
    """Of `sailviz.frames.FRAMES`, in which the scene is flown."""
    if scene.frame is not None:
        return scene.frame
    return "equator-of-date" if scene.body == "earth" else "ecliptic-j2000"


def shades(scene: Scene) -> list[str]:
    """Words of the bodies that may hide the light from a solar sail; "" for a central body of the scene's own."""
    if not has_device(scene, SolarSail):
        return []
    named = scene.environment.shadow_of
    if named is not None:
        return list(named)
    if not light_away(scene):
        return []
    if isinstance(scene.body, CustomBody):
        return [""] if scene.body.radius > 0 else []
    return [scene.body]


def shadow_kind(scene: Scene) -> str:
    """How shadows are reckoned: as the scene says, else a cone for a sail that flies in them, a cylinder for others."""
    said = scene.environment.shadow
    if said is not None:
        return said
    return "cone" if is_sail(scene) and (light_away(scene) or shades(scene)) else "cylinder"


def magnetosphere_of(scene: Scene) -> str:
    """ "shue-1998", "sphere" or "none": what keeps the wind from an electric sail."""
    if not has_device(scene, ElectricSail):
        return "none"
    said = scene.environment.magnetosphere
    if said is not None:
        return said if isinstance(said, str) else "sphere"
    return "shue-1998" if scene.body == "earth" or "earth" in scene.environment.gravity_of_bodies else "none"


def kernel_bodies(scene: Scene) -> list[str]:
    """Words of the bodies whose places a scene needs, each once: what pulls, shades, keeps the wind away, shines."""
    asked = [*scene.environment.gravity_of_bodies]
    asked += [name for name in shades(scene) if name and name != scene.body]
    if magnetosphere_of(scene) == "shue-1998" and scene.body != "earth":
        asked.append("earth")
    if (asked or is_sail(scene) or counts_from_light(scene)) and light_kind(scene) == "ephemeris":
        asked.append("sun")
    return list(dict.fromkeys(asked))


def counts_from_light(scene: Scene) -> bool:
    """Whether the steering counts from the light, wherever it is."""
    steering, beside = scene.steering, (device.steering for device in scene.beside)
    if any(isinstance(law, (SunFrameSteering, OnOffSteering)) for law in (steering, *beside)):
        return True
    if isinstance(steering, LocalSteering) and steering.minimum_perigee is not None:
        return True
    return getattr(steering, "in_shadow", None) == "edge-on"


def has_sky(scene: Scene) -> bool:
    """Whether anything of a scene depends on more than the central body with its own light."""
    return bool(
        kernel_bodies(scene)
        or shades(scene)
        or counts_from_light(scene)
        or magnetosphere_of(scene) != "none"
        or (is_sail(scene) and light_away(scene))
    )


def light_mu(scene: Scene) -> float | None:
    """Gravitational parameter of the light, m3/s2; None where it is not known."""
    if scene.light is not None and scene.light.mu is not None:
        return scene.light.mu
    if light_kind(scene) == "centre":
        return scene.body.mu if isinstance(scene.body, CustomBody) else BODIES[scene.body].mu
    return None if isinstance(scene.body, CustomBody) else BODIES["sun"].mu


def even_obliquity(scene: Scene) -> float:
    """Tilt, rad, of the circle of an even light against the x-y plane: of the ecliptic in frames of the equator."""
    if scene.light is not None and scene.light.obliquity is not None:
        return scene.light.obliquity
    return 0.0 if frame_of(scene) == "ecliptic-j2000" else EVEN_OBLIQUITY


def even_longitude(scene: Scene) -> float:
    """Angle, rad, along that circle at the start."""
    if scene.light is not None and scene.light.longitude is not None:
        return scene.light.longitude
    return (scene.environment.sun_right_ascension or 0.0) % (2 * pi)


def sky_body(word: str) -> SkyBody:
    """A body by its word."""
    return BODIES[word]
