"""What a scene says of its device: one record for each kind, keyed by the class of its section.

A new device: its force in sailviz/propulsion, its section in scene/device.py, its record here, and how it is drawn in
recording/drawing/devices.py.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Generic, TypeVar

import numpy as np

from sailviz import ephemeris
from sailviz.constants import ATOMIC_MASS, AU, MU_SUN, RADIATION_PRESSURE, STANDARD_GRAVITY
from sailviz.environment import ionosphere
from sailviz.propagate import dynamics, events
from sailviz.propagate import low_orbit_callback as low_orbit
from sailviz.propagate.film_callback import film_thrust
from sailviz.propagate.quantity_callback import FILM_TEMPERATURE, MODULATION
from sailviz.propagate.wheel_callback import wheel_thrust
from sailviz.propulsion import electric_sail, plasma_brake, solar_sail, thruster
from sailviz.propulsion.solar_sail import FILMS, OPTICS, Film
from sailviz.run.arrays import Body, Craft, CraftPart
from sailviz.run.devices import LABELS
from sailviz.scene.device import Device as DeviceSection
from sailviz.scene.device import ElectricSail, NoDevice, PlasmaBrake, SolarSail, Thruster, has_shape
from sailviz.scene.sky import has_sky, light_mu
from sailviz.scene.values import Section
from sailviz.simulation.bodies import epoch_of
from sailviz.simulation.lowered import Array, Columns, LoweredDevice, Words, no_columns, no_words
from sailviz.simulation.steering import steering_of
from sailviz.words import acceleration, length

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

D = TypeVar("D", bound=DeviceSection)
Happening = tuple[str, tuple[int, float, int, int]]  # name of an event, and its row of `events.watch`


def _no_size(device: DeviceSection) -> dict[str, Any]:
    return {}


def _no_events(device: DeviceSection, body: Body) -> list[Happening]:
    return []


@dataclass(frozen=True)
class Device(Generic[D]):
    """A kind of device."""

    label: str
    lower: Callable[[D, Scene, Any], LoweredDevice]  # from the section, the scene and its design
    words: Callable[[D], Words] = no_words
    size: Callable[[D], dict[str, Any]] = _no_size  # keywords of run.arrays.Craft
    sail: Callable[[D], Film | str] | None = None  # of a sail: as design functions take it
    strength: Callable[[D, Scene, Any], float] | None = None  # of a sail: a_c m/s2, from section, scene and design
    events: Callable[[D, Body], list[Happening]] = _no_events  # that come with it
    columns: Callable[[D, Scene, dynamics.Model, Array, Array], Columns] = no_columns  # observed, states of low orbit
    pull: Callable[[Array, Array, Array], tuple[Array, Array]] | None = None  # normal and acceleration, from those


# ---------------------------------------------------------------- sails
def film_of(scene: Scene) -> Film:
    """Force coefficients of the scene's solar sail."""
    assert isinstance(scene.device, SolarSail)
    return _film(scene.device)


def _film(device: SolarSail) -> Film:
    given = device.film
    if isinstance(given, str):  # the printed numbers; of a film that ages those of its optics, which change
        return FILMS[given] if device.ageing is None else Film.from_optics(*OPTICS[given])
    values = given.model_dump()
    return Film(**values) if "b1" in values else Film.from_optics(**values)


def sail_strength(scene: Scene, design: Any) -> float:
    """Characteristic acceleration, m/s2, of either sail."""
    strength = device_of(scene).strength
    assert strength is not None  # only sails are asked for it
    return strength(scene.device, scene, design)


def _said_strength(device: SolarSail | ElectricSail, design: Any) -> float | None:
    """a_c, m/s2, where the scene says it or the design knows it."""
    given = device.characteristic_acceleration
    if given == "as designed":
        return float(np.max(design.characteristic_acceleration))  # of a track: at full throttle
    return given


def radiation_pressure(scene: Scene) -> float | None:
    """N/m2 at 1 au where a sail's area and mass make its strength; None where nothing depends on it."""
    if not isinstance(scene.device, SolarSail) or not scene.device.by_area:
        return None
    said = None if scene.light is None else scene.light.radiation_pressure
    if said is None:
        return RADIATION_PRESSURE
    assert scene.light is not None
    distance = scene.light.reference_distance
    return said if distance is None else said * (distance / AU) ** 2


def _film_strength(device: SolarSail, scene: Scene, design: Any) -> float:
    said = _said_strength(device, design)
    if said is not None:
        return said
    film, pressure = _film(device), radiation_pressure(scene)
    if pressure is None:
        mu = light_mu(scene)
        assert mu is not None  # or the scene would not have been accepted
        return film.characteristic_acceleration(lightness=device.lightness_number) * (mu / MU_SUN)
    if device.shape is not None:
        from sailviz.simulation.sail_shape import sail_shape

        assert device.mass is not None  # or the scene would not have been accepted
        return 2 * pressure * sail_shape(scene).facing() / device.mass
    return film.characteristic_acceleration(area=device.area, mass=device.mass, pressure=pressure)


def _solar_sail(device: SolarSail, scene: Scene, design: Any) -> LoweredDevice:
    film = _film(device)
    strength = _film_strength(device, scene, design) * AU**2 / film.total
    numbers = solar_sail.Parameters(strength, film.b1, film.b2, film.b3)
    if device.shape is None:
        return LoweredDevice(dynamics.SOLAR_SAIL, numbers, None if device.ageing is None else film_thrust())
    from sailviz.simulation.sail_shape import thrust_of_shape  # trimesh, which flat sails do without

    pressure = radiation_pressure(scene)
    assert pressure is not None  # as for every sail that does not say its strength
    return LoweredDevice(dynamics.SOLAR_SAIL, numbers, thrust_of_shape(scene, pressure, has_sky(scene)))


def _too_hot(device: SolarSail, body: Body) -> list[Happening]:
    if device.hottest is None:
        return []
    return [("too-hot", (events.QUANTITY + FILM_TEMPERATURE, device.hottest, 1, events.RECORD))]


def _solar_sail_words(device: SolarSail) -> Words:
    return [] if device.lightness_number is None else [("lightness number", f"{device.lightness_number:.6g}")]


def _solar_sail_size(device: SolarSail) -> dict[str, Any]:
    return {"side": None if device.area is None else float(np.sqrt(device.area))}


def _electric_strength(device: ElectricSail, scene: Scene, design: Any) -> float:
    said = _said_strength(device, design)
    if said is not None:
        return said
    d = device
    hardware: list[Any] = [d.tethers, d.tether_length, d.voltage, d.mass, d.wind_pressure, d.wind_potential]
    return float(electric_sail.characteristic_acceleration(*hardware))


def _electric_sail(device: ElectricSail, scene: Scene, design: Any) -> LoweredDevice:
    model = electric_sail.MODELS[device.model]
    numbers = electric_sail.Parameters(_electric_strength(device, scene, design), model, device.pitch_limit)
    return LoweredDevice(dynamics.ELECTRIC_SAIL, numbers, None if device.wheel is None else wheel_thrust())


def _saturated(device: ElectricSail, body: Body) -> list[Happening]:
    if device.wheel is None or not device.wheel.hold:
        return []
    return [("tethers-saturated", (events.QUANTITY + MODULATION, 1.0, 1, events.RECORD))]


def _electric_name(device: ElectricSail) -> str:
    return "electric-sail" if device.model == "final" else f"electric-sail-{device.model}"


def _electric_size(device: ElectricSail) -> dict[str, Any]:
    bend = {} if device.wheel is None else {"cone": device.wheel.cone, "rise": device.wheel.rise or 0.0}
    return {"tethers": device.tethers, "tether_length": device.tether_length, **bend}


# ---------------------------------------------------------------- thruster
def _thruster(device: Thruster, scene: Scene, design: Any) -> LoweredDevice:
    size = device.thrust if device.thrust is not None else device.acceleration
    assert size is not None
    exhaust = device.specific_impulse
    inverse = 0.0 if exhaust is None else 1.0 / (STANDARD_GRAVITY * exhaust)
    return LoweredDevice(dynamics.THRUSTER, thruster.Parameters(size, float(device.thrust is not None), inverse))


def _thruster_words(device: Thruster) -> Words:
    if device.acceleration is not None:
        return [("acceleration", acceleration(device.acceleration))]
    assert device.thrust is not None
    return [("thrust", f"{device.thrust * 1e3:g} mN"), ("mass", f"{device.mass:g} kg")]


# ---------------------------------------------------------------- plasma brake
def _brake(device: PlasmaBrake, scene: Scene, design: Any) -> LoweredDevice:
    power = np.inf if device.power is None else device.power
    mass = device.tether_mass if device.tether_mass is not None else plasma_brake.tether_mass(device.tether_length)
    tether = steering_of(scene.steering).tether(scene.steering)
    epoch = epoch_of(scene)
    numbers = plasma_brake.Parameters(
        length=device.tether_length,
        voltage=abs(device.voltage),
        wire_radius=device.wire_radius,
        polarity=plasma_brake.POSITIVE if device.polarity == "positive" else plasma_brake.NEGATIVE,
        attitude=tether.attitude,
        wire_diameter=device.wire_diameter,
        efficiency=device.efficiency,
        power=power,
        eclipse_power={"on": power, "off": 0.0, "limited": device.eclipse_power or 0.0}[device.eclipse],
        tip_mass=float((device.tip_mass or 0.0) + mass / 3),
        spin_factor=tether.spin_factor,
        magnetic_sensitivity=scene.environment.magnetic_sensitivity,
        earth_angle=0.0 if epoch is None else float(ephemeris.greenwich_sidereal_time(epoch)),
    )
    return LoweredDevice(dynamics.PLASMA_BRAKE, numbers, forces=(low_orbit.low_orbit_forces(),))


def _brake_words(device: PlasmaBrake) -> Words:
    sign = "+" if device.polarity == "positive" else "−"
    return [
        ("tether", length(device.tether_length)),
        ("voltage", f"{sign}{abs(device.voltage):g} V"),
        ("mass", f"{device.mass:g} kg"),
    ]


def _brake_off(device: PlasmaBrake, body: Body) -> list[Happening]:
    return [("brake off", (events.RADIUS, body.radius + device.off_below, -1, events.END_OF_USE))]


def _brake_columns(device: PlasmaBrake, scene: Scene, model: dynamics.Model, values: Array, velocity: Array) -> Columns:
    columns = {"plasma_force_N_m": values[low_orbit.FORCE]}
    named = model.named
    if named.plasma.kind == ionosphere.FORCE_PROFILE:
        return columns
    density, ion_mass, voltage = values[low_orbit.PLASMA_DENSITY], values[low_orbit.ION_MASS], values[low_orbit.VOLTAGE]
    columns |= {
        "plasma_density_per_m3": density,
        "mean_ion_mass_u": ion_mass / ATOMIC_MASS,
        "tether_voltage_V": voltage if device.polarity == "positive" else 0.0 - voltage,  # never -0
        "tether_current_A": values[low_orbit.CURRENT],
        "tether_power_W": values[low_orbit.POWER],
    }
    if named.brake.attitude == plasma_brake.TILTED:
        columns["tether_tilt_rad"] = values[low_orbit.TILT]
    speed = np.linalg.norm(velocity, axis=1)
    holds = plasma_brake.validity(
        density,
        ion_mass,
        speed,
        abs(device.voltage),
        device.tether_length,
        values[low_orbit.ALTITUDE],
        device.wire_radius,
    )
    columns["force_law_valid"] = np.asarray(holds.all)
    return columns


def _brake_pull(values: Array, states: Array, factor: Array) -> tuple[Array, Array]:
    """The tether's direction as the normal, and the acceleration m/s2, (n, 3) each."""
    force = values[low_orbit.FORCE_X : low_orbit.FORCE_X + 3]
    return values[low_orbit.TETHER_X : low_orbit.TETHER_X + 3].T.copy(), (factor / states[6] * force).T


DEVICES: dict[type[Section], Device[Any]] = {  # the functions of each record take the class that it stands under
    SolarSail: Device[SolarSail](
        LABELS["solar-sail"],
        _solar_sail,
        words=_solar_sail_words,
        size=_solar_sail_size,
        events=_too_hot,
        sail=_film,
        strength=_film_strength,
    ),
    ElectricSail: Device[ElectricSail](
        LABELS["electric-sail"],
        _electric_sail,
        size=_electric_size,
        events=_saturated,
        sail=_electric_name,
        strength=_electric_strength,
    ),
    PlasmaBrake: Device[PlasmaBrake](
        LABELS["plasma-brake"],
        _brake,
        words=_brake_words,
        size=lambda device: {"tether_length": device.tether_length},
        events=_brake_off,
        columns=_brake_columns,
        pull=_brake_pull,
    ),
    Thruster: Device[Thruster](LABELS["thruster"], _thruster, words=_thruster_words),
    NoDevice: Device[NoDevice](LABELS["none"], lambda device, scene, design: LoweredDevice(dynamics.NO_DEVICE)),
}


def device_of(scene: Scene) -> Device[Any]:
    """The record of the scene's device."""
    return DEVICES[type(scene.device)]


def strength_or_none(scene: Scene, design: Any) -> float | None:
    """Characteristic acceleration, m/s2, of a sail; None of any other device."""
    return None if device_of(scene).sail is None else sail_strength(scene, design)


def shape_facts(scene: Scene) -> dict[str, Any] | None:
    """What a recording says of the shape of the scene's sail; None where it has none."""
    if not has_shape(scene.device):
        return None
    from sailviz.simulation.sail_shape import sail_shape

    return sail_shape(scene).facts


def craft(scene: Scene) -> Craft:
    """What flies, for its mesh and its labels."""
    record = device_of(scene)
    spin = steering_of(scene.steering).tether(scene.steering).spin
    labels = [record.label, *(DEVICES[type(device)].label for device in scene.beside)]
    found = Craft(scene.device.kind, " + ".join(dict.fromkeys(labels)), spin=spin, **record.size(scene.device))
    if not isinstance(scene.device, SolarSail) or scene.device.shape is None:
        return found
    from sailviz.simulation.sail_shape import sail_shape

    found_shape = sail_shape(scene)
    shape = found_shape.shape
    parts = (CraftPart(part.name, part.mesh.vertices, part.mesh.faces, part.is_film) for part in shape.parts)
    told = json.dumps(found_shape.facts, sort_keys=True)
    return replace(found, side=shape.size, parts=tuple(parts), shape=told, pressure=found_shape.pressures)
