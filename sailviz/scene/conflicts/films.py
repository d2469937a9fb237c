"""What a film that ages, or whose temperature is told, goes together with."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sailviz.scene.attitude import Moving
from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.device import SolarSail
from sailviz.scene.film import WITH_OPTICS, ages, asked_for, has_optics, radiates
from sailviz.scene.steering import OptimalSteering

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

OPTICS = ", ".join(f'"{word}"' for word in WITH_OPTICS if word != "ideal")
NEEDS_OPTICS = f"needs the optics of the film: {OPTICS}, or film = {{cr, cs, Bf, Bb, ef, eb}}"
NO_HEAT = "a film that radiates nothing has no temperature: its emissivities are 0"


def film_of_the_sail(scene: Scene) -> Faults:
    """What knows films that stay as they are, and what temperatures need."""
    return _of_those_beside(scene) + _ageing(scene) + _warmth(scene) + _turned_from_heat(scene) + _asked(scene)


def _of_those_beside(scene: Scene) -> Faults:
    """A craft with several devices keeps its mass where an ageing sail keeps its dose."""
    found: Faults = []
    if scene.place is not None and any(isinstance(one, SolarSail) and one.ageing is not None for one in scene.devices):
        where = "device.ageing" if ages(scene) else "device"
        found.append((where, "a sail whose film ages is its craft's only device, in no list of several"))
    if any(isinstance(one, SolarSail) and one.hottest is not None for one in scene.beside):
        found.append(
            ("device", "of several sails the temperature of the first one alone is told: hottest belongs there")
        )
    return found


def _ageing(scene: Scene) -> Faults:
    device = scene.device
    if not isinstance(device, SolarSail) or device.ageing is None:
        return []
    where, found = "device.ageing", list[tuple[str, str]]()
    if not has_optics(device):
        found.append((where, NEEDS_OPTICS))
    if device.control is not None:
        found.append(
            (where, "a film that darkens when it is told to ages in a way that is not known: control or ageing")
        )
    if scene.environment.atmosphere is not None:
        found.append((where, "ageing is known of flights without air: leave environment.atmosphere out"))
    steering = scene.steering
    if isinstance(steering, OptimalSteering) and steering.reckons_with is None:
        words = "was solved for a film that stays as it is: say with which it reckons, reckons_with, or steer otherwise"
        found.append(("steering.kind", f'"{steering.kind}" {words}'))
    if (scene.ensemble or scene.chaos) and not isinstance(scene.attitude, Moving):
        place = "ensemble[0]" if scene.ensemble else "chaos[0]"
        found.append((place, "ensembles fly films that stay as they are: device.ageing"))
    if scene.propagation.integrator not in ("auto", "dop853"):
        words = "the dose of a film that ages is carried by DOP853 alone, which auto takes"
        found.append(("propagation.integrator", words))
    return found


def _warmth(scene: Scene) -> Faults:
    device = scene.device
    if not isinstance(device, SolarSail) or device.hottest is None:
        return [
            (f"event[{i}].kind", 'a film is "too-hot" over device.hottest, which is not given')
            for i, item in enumerate(scene.event)
            if item.kind == "too-hot"
        ]
    where, found = "device.hottest", list[tuple[str, str]]()
    if not has_optics(device):
        found.append((where, NEEDS_OPTICS))
    elif not radiates(device):
        found.append((where, NO_HEAT))
    if device.control is not None:
        found.append((where, "how warm a film gets that darkens is not known: control or hottest"))
    return found


def _turned_from_heat(scene: Scene) -> Faults:
    """A minimum-time flight whose film turns from the Sun where it would become too hot."""
    steering, device = scene.steering, scene.device
    if not isinstance(steering, OptimalSteering) or steering.hottest is None:
        return []
    where, found = "steering.hottest", list[tuple[str, str]]()
    if not isinstance(device, SolarSail) or device.shape is not None or device.control is not None:
        found.append((where, "is the temperature of the film of a flat solar sail without control"))
    elif not has_optics(device):
        found.append((where, NEEDS_OPTICS))
    elif not radiates(device):
        found.append((where, NO_HEAT))
    if steering.reckons_with is not None:
        found.append((where, "is that of the sail's own film: leave reckons_with out"))
    return found


def _asked(scene: Scene) -> Faults:
    """Quantities of a film, where there are none."""
    found: Faults = []
    if not ages(scene):
        found += [(place, "only a film that ages has a dose: device.ageing") for place in asked_for(scene, "dose")]
    elif scene.device.mass is not None:
        words = "no propellant burns beside a film that ages: the mass stays as it is"
        found += [(place, words) for place in asked_for(scene, "mass") if not place.startswith("expect")]
    return found + _temperature_asked(scene)


def _temperature_asked(scene: Scene) -> Faults:
    """The temperature of a film, where there is none; and what it is warmed by."""
    found: Faults = []
    places, device = asked_for(scene, "film_temperature"), scene.device
    warm = isinstance(device, SolarSail) and device.control is None
    if places and not warm:
        words = "the temperature is known of the film of a solar sail only, of one without control"
        found += [(place, words) for place in places]
    elif places and not radiates(device):
        found += [(place, NO_HEAT if has_optics(device) else f"film_temperature {NEEDS_OPTICS}") for place in places]
    shone_on = ages(scene) or places or getattr(device, "hottest", None)
    if shone_on and not isinstance(scene.body, str) and (scene.light is None or not scene.light.bright):
        words = f"how bright the light of {scene.body.name} is has to be said: light.irradiance_W_m2"
        found.append(("light", words))
    return found
