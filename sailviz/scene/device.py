"""What pushes a craft: the kinds of [device]."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from sailviz.scene.shape import Shapes
from sailviz.scene.steering import Steering
from sailviz.scene.values import (
    POSITIVE,
    Acceleration,
    Angle,
    Area,
    Force,
    Intervals,
    Length,
    Mass,
    Power,
    Pressure,
    Section,
    Temperature,
    Thickness,
    Time,
    Voltage,
    one_of,
    wrong,
)

DESIGNED = Literal["as designed"]
BY_ATTITUDE = Literal["attitude"]  # what a sail shows to the flow, and its edge_area beside


class FilmCoefficients(Section):
    """Own force coefficients."""

    b1: float
    b2: float
    b3: float
    efficiency: Annotated[float, Field(gt=0, le=1)] = 1.0

    @model_validator(mode="after")
    def _pushes(self) -> Self:
        if self.b1 + self.b2 + self.b3 <= 0:
            raise wrong("b1 + b2 + b3 must be positive: the sail is pushed away from the Sun")
        return self


class FilmOptics(Section):
    """Own optical properties: reflectivity, specular share, non-Lambertian coefficients, emissivities of front and
    back."""

    cr: Annotated[float, Field(ge=0, le=1)]
    cs: Annotated[float, Field(ge=0, le=1)]
    Bf: Annotated[float, Field(ge=0, le=1)]
    Bb: Annotated[float, Field(ge=0, le=1)]
    ef: Annotated[float, Field(ge=0, le=1)]
    eb: Annotated[float, Field(ge=0, le=1)]


class Device(Section):
    """What every device may say. mass : of the whole craft, also where it has several devices; name, steering : of one
    in a list of them."""

    name: Annotated[str, Field(min_length=1)] | None = None
    steering: Steering | None = None
    mass: Annotated[Mass, POSITIVE] | None = None
    active: Intervals | None = None
    drag_area: Annotated[Area, POSITIVE] | BY_ATTITUDE | None = None
    drag_coefficient: Annotated[float, POSITIVE] = 2.2
    edge_area: Annotated[Area, Field(ge=0)] | None = None

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        edges = [edge for pair in self.active or [] for edge in pair]
        if edges != sorted(set(edges)):
            raise wrong("active must list [start, stop] pairs, each after the one before")
        return self


class VoltageControl(Section):
    """How an electric sail sets its voltage, at the start of every interval."""

    nominal_voltage: Annotated[Voltage, POSITIVE] = 20_000.0
    maximum_voltage: Annotated[Voltage, POSITIVE] = 40_000.0
    minimum_voltage: Annotated[Voltage, Field(ge=0)] = 0.0
    dead_band: Annotated[Voltage, Field(ge=0)] = 0.0

    @model_validator(mode="after")
    def _rises(self) -> Self:
        if not self.minimum_voltage <= self.nominal_voltage <= self.maximum_voltage:
            raise wrong("voltages must rise from minimum_voltage over nominal_voltage to maximum_voltage")
        return self


class PressureControl(VoltageControl):
    """Against the measured dynamic pressure."""

    kind: Literal["pressure"]
    interval: Annotated[Time, POSITIVE] = 3600.0


class DistanceControl(VoltageControl):
    """Back to the distance and radial speed of the flight in the nominal wind."""

    kind: Literal["distance"]
    interval: Annotated[Time, POSITIVE] = 86_400.0
    position_gain: Annotated[float, Field(ge=0)] = 100.0
    speed_gain: Annotated[float, Field(ge=0)] = 50.0


class ElectrochromicControl(Section):
    """A share of a solar sail's area turns from mirror to black so that the push stays that of the dimmest Sun."""

    kind: Literal["electrochromic"]
    fraction: Annotated[float, Field(gt=0, le=1)] = 0.007


class Ageing(Section):
    """How a film ages with its dose of sunlight: the factor by which it mirrors less, over 1 + factor, and its front
    radiates more in the end; the dose in which half of that happens, and the one that it has at the start, in time of
    full sunlight at 1 au."""

    factor: Annotated[float, Field(ge=0, le=1)]
    half_dose: Annotated[Time, POSITIVE] = 15_778_800.0
    dose: Annotated[Time, Field(ge=0)] = 0.0


class SolarSail(Device):
    """A solar sail. Its strength: characteristic acceleration, lightness number, or area with mass, of a flat one; or
    its shape with mass, the film's back and its roll about the normal beside. ageing : of its film; hottest : what
    that bears."""

    kind: Literal["solar-sail"]
    film: Literal["ideal", "eta-perfect", "jpl-1978", "jpl-2015"] | FilmCoefficients | FilmOptics = "ideal"
    characteristic_acceleration: Annotated[Acceleration, POSITIVE] | DESIGNED | None = None
    lightness_number: Annotated[float, POSITIVE] | None = None
    area: Annotated[Area, POSITIVE] | None = None
    control: ElectrochromicControl | None = None
    shape: Shapes | None = None
    back: Literal["same", "black"] | FilmCoefficients | FilmOptics | None = None
    roll: Angle | None = None
    ageing: Ageing | None = None
    hottest: Annotated[Temperature, POSITIVE] | None = None

    @model_validator(mode="after")
    def _strength(self) -> Self:
        one_of(self, "characteristic_acceleration", "lightness_number", "area+mass", "shape+mass")
        if self.shape is None and self.roll is not None:
            raise wrong("roll belongs to a sail with a shape")
        if self.shape is None and self.back is not None and self.hottest is None and self.ageing is None:
            raise wrong("back belongs to a sail with a shape, or whose film ages or has a hottest temperature")
        if self.shape is not None and self.back is None:
            raise wrong('a sail with a shape needs its back: "same", "black", b1, b2, b3 or optics of its own')
        return self

    @property
    def by_area(self) -> bool:
        """Whether its area and mass make its strength."""
        return self.characteristic_acceleration is None and self.lightness_number is None


class Wheel(Section):
    """The wheel of an electric sail as a body, its tethers bent downwind: straight ones coned by an angle, or parabolas
    of a rise over their reach. hold : whether the voltage holds its axis; spin_period : of one turn at the start, with
    the mass at the tip of each tether and of each tether itself."""

    cone: Annotated[Angle, Field(ge=0, lt=1.4)] = 0.0
    rise: Annotated[float, Field(ge=0, le=1)] | None = None
    hold: bool = True
    spin_period: Annotated[Time, POSITIVE] | None = None
    tip_mass: Annotated[Mass, Field(ge=0)] = 0.0
    tether_mass: Annotated[Mass, Field(ge=0)] = 0.0

    @model_validator(mode="after")
    def _spins(self) -> Self:
        if self.rise is not None and self.cone:
            raise wrong("cone and rise are two ways to bend a tether: give one")
        heavy = self.tip_mass + self.tether_mass > 0
        if (self.spin_period is not None) != heavy:
            raise wrong(
                "spin_period, and tip_mass or tether_mass, from which the spin has its momentum, belong together"
            )
        return self


class ElectricSail(Device):
    """An electric solar wind sail. Its strength: characteristic acceleration, or hardware by (3.40)-(3.41)."""

    kind: Literal["electric-sail"]
    model: Literal["final", "original", "updated", "polynomial"] = "final"
    characteristic_acceleration: Annotated[Acceleration, POSITIVE] | DESIGNED | None = None
    tethers: Annotated[int, Field(gt=0)] | None = None
    tether_length: Annotated[Length, POSITIVE] | None = None
    voltage: Annotated[Voltage, POSITIVE] | None = None
    wind_pressure: Annotated[Pressure, POSITIVE] = 2.0e-9
    wind_potential: Annotated[Voltage, Field(ge=0)] = 1_000.0
    pitch_limit: Annotated[Angle, Field(gt=0, le=1.5707963267948968)] = 1.0471975511965976
    control: Annotated[PressureControl | DistanceControl, Field(discriminator="kind")] | None = None
    wheel: Wheel | None = None

    @model_validator(mode="after")
    def _strength(self) -> Self:
        one_of(self, "characteristic_acceleration", "tethers+tether_length+voltage+mass")
        if self.voltage is not None and self.voltage <= self.wind_potential:
            raise wrong("voltage must exceed wind_potential, or there is no thrust")
        if self.control is not None and self.control.nominal_voltage <= self.wind_potential:
            raise wrong("control.nominal_voltage must exceed wind_potential, or there is no thrust")
        return self


class PlasmaBrake(Device):
    """A charged tether hanging below a satellite. voltage is taken by its size, and its sign, if any, must agree with
    the polarity; wire_radius is the effective electric radius, wire_diameter the sum over the wires."""

    kind: Literal["plasma-brake"]
    mass: Annotated[Mass, POSITIVE]
    tether_length: Annotated[Length, POSITIVE]
    voltage: Voltage = 1_000.0
    polarity: Literal["negative", "positive"] = "negative"
    wire_radius: Annotated[Thickness, POSITIVE] = 1e-3
    wire_diameter: Annotated[Thickness, POSITIVE] = 50e-6
    efficiency: Annotated[float, Field(gt=0, le=1)] = 1.0
    power: Annotated[Power, POSITIVE] | None = None
    eclipse: Literal["on", "off", "limited"] = "on"
    eclipse_power: Annotated[Power, POSITIVE] | None = None
    tether_mass: Annotated[Mass, POSITIVE] | None = None
    tip_mass: Annotated[Mass, POSITIVE] | None = None
    off_below: Annotated[Length, Field(ge=0)] = 200e3

    @model_validator(mode="after")
    def _agrees(self) -> Self:
        if self.voltage == 0:
            raise wrong("voltage 0 makes no brake: give the size of the voltage")
        if self.voltage < 0 and self.polarity == "positive":
            raise wrong('voltage is negative and polarity "positive": give one sign only')
        if (self.eclipse == "limited") != (self.eclipse_power is not None):
            raise wrong('eclipse = "limited" and eclipse_power, what is left in the shadow, belong together')
        return self


class Thruster(Device):
    """Constant acceleration or constant thrust, with mass loss if a specific impulse is given."""

    kind: Literal["thruster"]
    acceleration: Annotated[Acceleration, POSITIVE] | None = None
    thrust: Annotated[Force, POSITIVE] | None = None
    specific_impulse: Annotated[Time, POSITIVE] | None = None

    @model_validator(mode="after")
    def _strength(self) -> Self:
        one_of(self, "acceleration", "thrust+mass")
        return self


class NoDevice(Device):
    """Ballistic flight."""

    kind: Literal["none"]


Devices = Annotated[SolarSail | ElectricSail | PlasmaBrake | Thruster | NoDevice, Field(discriminator="kind")]


def by_force(device: Device) -> bool:
    """Whether a sail's strength comes of a force, by its area or its hardware, and the mass of the craft."""
    if isinstance(device, SolarSail):
        return device.by_area
    return isinstance(device, ElectricSail) and device.characteristic_acceleration is None


def has_shape(device: Device) -> bool:
    """Whether the facets of a shape make a sail's force."""
    return isinstance(device, SolarSail) and device.shape is not None


def air_on_facets(device: Device) -> bool:
    """Whether the air of a scene pushes the facets of a sail's shape."""
    return isinstance(device, SolarSail) and device.shape is not None and device.shape.air is not None


def control_of(device: Device) -> PressureControl | DistanceControl | ElectrochromicControl | None:
    """How a device answers to wind or sunlight that varies; None where it does not."""
    return device.control if isinstance(device, (SolarSail, ElectricSail)) else None
