"""The tables of a scene file, one class each: what may stand in them, in SI once loaded.

Imports neither rerun nor numba nor scipy, so that `sailviz check` answers at once.
"""

from __future__ import annotations

from datetime import date, datetime
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic_core import PydanticCustomError

from sailviz.scene.faults import Dimension, nearest

# ---------------------------------------------------------------- kinds of values: SI inside, unit in the key outside
Length = Annotated[float, Dimension("length")]
Thickness = Annotated[float, Dimension("thickness")]
Time = Annotated[float, Dimension("time")]
Angle = Annotated[float, Dimension("angle")]
Acceleration = Annotated[float, Dimension("acceleration")]
Mass = Annotated[float, Dimension("mass")]
Area = Annotated[float, Dimension("area")]
Voltage = Annotated[float, Dimension("voltage")]
Pressure = Annotated[float, Dimension("pressure")]
Force = Annotated[float, Dimension("force")]
ForcePerLength = Annotated[float, Dimension("force_per_length")]
NumberDensity = Annotated[float, Dimension("number_density")]
Power = Annotated[float, Dimension("power")]
MassDensity = Annotated[float, Dimension("mass_density")]
SolarFlux = Annotated[float, Dimension("solar_flux")]
IonMass = Annotated[float, Dimension("ion_mass")]
Mu = Annotated[float, Dimension("mu")]
Three = Field(min_length=3, max_length=3)
PositionVector = Annotated[list[float], Dimension("length"), Three]
VelocityVector = Annotated[list[float], Dimension("speed"), Three]
Times = Annotated[list[float], Dimension("time")]
Angles = Annotated[list[float], Dimension("angle")]
Intervals = Annotated[list[Annotated[list[float], Field(min_length=2, max_length=2)]], Dimension("time")]

POSITIVE = Field(gt=0)
HALF_TURN = Field(ge=-3.141592653589794, le=3.141592653589794)
QUARTER_TURN = Field(ge=-1.5707963267948968, le=1.5707963267948968)


class Section(BaseModel):
    """A table of the scene file."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)


def _wrong(message: str, **context) -> PydanticCustomError:
    return PydanticCustomError("scene", message, context or None)


def _one_of(section: Section, *names: str) -> None:
    """Exactly one of several fields (or groups joined by '+') must be given."""
    given = [name for name in names if all(getattr(section, part) is not None for part in name.split("+"))]
    if len(given) != 1:
        words = " or ".join(name.replace("+", " with ") for name in names)
        raise _wrong(f"needs exactly one of {words}" + (f", has {' and '.join(given)}" if given else ""))


# ---------------------------------------------------------------- central body
class CustomBody(Section):
    """Any central body."""

    name: str = "body"
    mu: Annotated[Mu, POSITIVE]
    radius: Annotated[Length, Field(ge=0)] = 0.0


# ---------------------------------------------------------------- where it starts
class CartesianStart(Section):
    """Position and velocity in the inertial frame."""

    kind: Literal["cartesian"]
    position: PositionVector
    velocity: VelocityVector


class ElementsStart(Section):
    """Osculating orbital elements."""

    kind: Literal["elements"]
    semi_major_axis: Length
    eccentricity: Annotated[float, Field(ge=0)]
    inclination: Annotated[Angle, Field(ge=0, le=3.141592653589794)] = 0.0
    raan: Angle = 0.0
    argument: Angle = 0.0
    true_anomaly: Angle = 0.0

    @model_validator(mode="after")
    def _conic(self):
        if (self.eccentricity < 1) != (self.semi_major_axis > 0) or self.eccentricity == 1:
            raise _wrong("an ellipse has eccentricity < 1 and semi-major axis > 0, a hyperbola > 1 and < 0")
        return self


class CircularStart(Section):
    """A circular Keplerian orbit. Its size is osculating, or with mean_altitude the mean over an orbit about an oblate
    body; its node is given as raan or as the local time at which it is passed going north."""

    kind: Literal["circular"]
    radius: Annotated[Length, POSITIVE] | None = None
    altitude: Annotated[Length, POSITIVE] | None = None
    mean_altitude: Annotated[Length, POSITIVE] | None = None
    inclination: Annotated[Angle, Field(ge=0, le=3.141592653589794)] = 0.0
    raan: Angle | None = None
    ltan: Annotated[Time, Field(ge=0, lt=86400)] | None = None
    argument_of_latitude: Angle = 0.0

    @model_validator(mode="after")
    def _size(self):
        _one_of(self, "radius", "altitude", "mean_altitude")
        if self.raan is not None and self.ltan is not None:
            raise _wrong("needs raan or ltan, the local time of the ascending node, has both")
        return self


class DesignedStart(Section):
    """On an orbit that the device is designed to hold, or a little beside it."""

    position_offset: PositionVector = [0.0, 0.0, 0.0]
    velocity_offset: VelocityVector = [0.0, 0.0, 0.0]


class DisplacedStart(DesignedStart):
    """On a circular displaced non-Keplerian orbit: Sun distance, elevation over the ecliptic, Omega / Omega_K."""

    kind: Literal["displaced"]
    radius: Annotated[Length, POSITIVE]
    elevation: Annotated[Angle, QUARTER_TURN]
    rate_ratio: Annotated[float, POSITIVE]
    azimuth: Angle = 0.0


class HeliostationaryStart(DesignedStart):
    """At rest, the thrust balancing the Sun's pull."""

    kind: Literal["heliostationary"]
    radius: Annotated[Length, POSITIVE]
    elevation: Annotated[Angle, QUARTER_TURN] = 0.0
    azimuth: Angle = 0.0


class LagrangeStart(DesignedStart):
    """At an artificial Lagrange point on the line from the Sun to a planet, environment.third_body or a massless
    Earth."""

    kind: Literal["lagrange-point"]
    radius: Annotated[Length, POSITIVE]


class PlanetFollowingStart(DesignedStart):
    """Over a planet on its ellipse, at its longitude, at a fixed elevation and a fixed share of its distance;
    perihelion on the x axis."""

    kind: Literal["planet-following"]
    planet: Literal["mercury", "venus", "earth", "mars", "jupiter"] | None = None
    semi_major_axis: Annotated[Length, POSITIVE] | None = None
    eccentricity: Annotated[float, Field(ge=0, lt=1)] | None = None
    elevation: Annotated[Angle, QUARTER_TURN]
    radius_ratio: Annotated[float, POSITIVE] = 1.0
    true_anomaly: Angle = 0.0

    @model_validator(mode="after")
    def _which(self):
        _one_of(self, "planet", "semi_major_axis+eccentricity")
        return self


class FlatEllipseStart(DesignedStart):
    """On a Keplerian ellipse lifted off the ecliptic, its focus above the Sun; perihelion on the x axis."""

    kind: Literal["flat-ellipse"]
    semi_latus_rectum: Annotated[Length, POSITIVE]
    eccentricity: Annotated[float, Field(ge=0, lt=1)]
    height: Length
    mu_ratio: Annotated[float, POSITIVE] = 1.0
    true_anomaly: Angle = 0.0


class SpiralStart(Section):
    """On the logarithmic spiral that the sail's lightness number and pitch allow."""

    kind: Literal["spiral"]
    radius: Annotated[Length, POSITIVE]
    azimuth: Angle = 0.0


Start = Annotated[
    CartesianStart
    | ElementsStart
    | CircularStart
    | DisplacedStart
    | HeliostationaryStart
    | LagrangeStart
    | PlanetFollowingStart
    | FlatEllipseStart
    | SpiralStart,
    Field(discriminator="kind"),
]
HELD_STARTS = ("displaced", "heliostationary", "lagrange-point", "planet-following", "flat-ellipse")

# ---------------------------------------------------------------- what flies
DESIGNED = Literal["as designed"]


class FilmCoefficients(Section):
    """Own force coefficients."""

    b1: float
    b2: float
    b3: float
    efficiency: Annotated[float, Field(gt=0, le=1)] = 1.0

    @model_validator(mode="after")
    def _pushes(self):
        if self.b1 + self.b2 + self.b3 <= 0:
            raise _wrong("b1 + b2 + b3 must be positive: the sail is pushed away from the Sun")
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
    """What every device may say."""

    mass: Annotated[Mass, POSITIVE] | None = None
    active: Intervals | None = None
    drag_area: Annotated[Area, POSITIVE] | None = None
    drag_coefficient: Annotated[float, POSITIVE] = 2.2

    @model_validator(mode="after")
    def _ordered(self):
        edges = [edge for pair in self.active or [] for edge in pair]
        if edges != sorted(set(edges)):
            raise _wrong("active must list [start, stop] pairs, each after the one before")
        return self


class VoltageControl(Section):
    """How an electric sail sets its voltage, at the start of every interval."""

    nominal_voltage: Annotated[Voltage, POSITIVE] = 20_000.0
    maximum_voltage: Annotated[Voltage, POSITIVE] = 40_000.0
    minimum_voltage: Annotated[Voltage, Field(ge=0)] = 0.0
    dead_band: Annotated[Voltage, Field(ge=0)] = 0.0

    @model_validator(mode="after")
    def _rises(self):
        if not self.minimum_voltage <= self.nominal_voltage <= self.maximum_voltage:
            raise _wrong("voltages must rise from minimum_voltage over nominal_voltage to maximum_voltage")
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


class SolarSail(Device):
    """A flat solar sail. Its strength: characteristic acceleration, lightness number, or area with mass."""

    kind: Literal["solar-sail"]
    film: Literal["ideal", "eta-perfect", "jpl-1978", "jpl-2015"] | FilmCoefficients | FilmOptics = "ideal"
    characteristic_acceleration: Annotated[Acceleration, POSITIVE] | DESIGNED | None = None
    lightness_number: Annotated[float, POSITIVE] | None = None
    area: Annotated[Area, POSITIVE] | None = None
    control: ElectrochromicControl | None = None

    @model_validator(mode="after")
    def _strength(self):
        _one_of(self, "characteristic_acceleration", "lightness_number", "area+mass")
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

    @model_validator(mode="after")
    def _strength(self):
        _one_of(self, "characteristic_acceleration", "tethers+tether_length+voltage+mass")
        if self.voltage is not None and self.voltage <= self.wind_potential:
            raise _wrong("voltage must exceed wind_potential, or there is no thrust")
        if self.control is not None and self.control.nominal_voltage <= self.wind_potential:
            raise _wrong("control.nominal_voltage must exceed wind_potential, or there is no thrust")
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
    def _agrees(self):
        if self.voltage == 0:
            raise _wrong("voltage 0 makes no brake: give the size of the voltage")
        if self.voltage < 0 and self.polarity == "positive":
            raise _wrong('voltage is negative and polarity "positive": give one sign only')
        if (self.eclipse == "limited") != (self.eclipse_power is not None):
            raise _wrong('eclipse = "limited" and eclipse_power, what is left in the shadow, belong together')
        return self


class Thruster(Device):
    """Constant acceleration or constant thrust, with mass loss if a specific impulse is given."""

    kind: Literal["thruster"]
    acceleration: Annotated[Acceleration, POSITIVE] | None = None
    thrust: Annotated[Force, POSITIVE] | None = None
    specific_impulse: Annotated[Time, POSITIVE] | None = None

    @model_validator(mode="after")
    def _strength(self):
        _one_of(self, "acceleration", "thrust+mass")
        return self


class NoDevice(Device):
    """Ballistic flight."""

    kind: Literal["none"]


Devices = Annotated[SolarSail | ElectricSail | PlasmaBrake | Thruster | NoDevice, Field(discriminator="kind")]


# ---------------------------------------------------------------- how it is steered
class PlainSteering(Section):
    """A law without parameters."""

    kind: Literal[
        "sun-facing", "radial", "circumferential", "tangential", "vertical", "gravity-gradient", "as designed"
    ]


class SpinningSteering(Section):
    """A tether that spins, its force averaged over a turn: about the horizontal across the track, so that it lies in
    the plane of motion, or about the velocity."""

    kind: Literal["spinning"]
    plane: Literal["along-track", "across-track"]


class FrameSteering(Section):
    """Pitch and clock angle fixed in the orbital frame or in the meridian plane."""

    kind: Literal["orbital", "meridian"]
    pitch: Annotated[Angle, HALF_TURN]
    clock: Angle = 0.0


class InertialSteering(Section):
    """A direction fixed in space."""

    kind: Literal["inertial"]
    direction: Annotated[list[float], Three]

    @model_validator(mode="after")
    def _nonzero(self):
        if not any(self.direction):
            raise _wrong("direction must not be the zero vector")
        return self


class TableSteering(Section):
    """Pitch, clock angle and throttle over time."""

    kind: Literal["table"]
    frame: Literal["orbital", "meridian"] = "orbital"
    interpolation: Literal["linear", "hold", "cubic"] = "linear"
    time: Annotated[Times, Field(min_length=2)]
    pitch: Angles
    clock: Angles
    throttle: list[Annotated[float, Field(ge=0)]] | None = None

    @model_validator(mode="after")
    def _columns(self):
        if len({len(c) for c in (self.time, self.pitch, self.clock, self.throttle) if c is not None}) > 1:
            raise _wrong("time, pitch, clock and throttle must have the same length")
        if any(b <= a for a, b in zip(self.time, self.time[1:], strict=False)):
            raise _wrong("time must increase")
        return self


SAIL_LAW = Literal[
    "ideal", "eta-perfect", "jpl-1978", "jpl-2015", "electric-sail", "electric-sail-original",
    "electric-sail-updated", "electric-sail-polynomial",
]  # fmt: skip


class PrimerSteering(Section):
    """What laws have in common that make the most of the thrust along a primer: the sail they reckon with, the
    device itself unless another is named."""

    reckons_with: SAIL_LAW | None = None


class OptimalSteering(PrimerSteering):
    """A minimum-time flight from its initial costates, canonical (mu = 1 au = 1, H = +1): three of a planar flight,
    for the radius, the radial and the transverse speed, or six, for position and velocity."""

    kind: Literal["optimal"]
    costates: Annotated[list[float], Field(min_length=3, max_length=6)]

    @model_validator(mode="after")
    def _count(self):
        if len(self.costates) not in (3, 6):
            raise _wrong("costates are three numbers of a planar flight or six of any other")
        if not any(self.costates[-len(self.costates) // 2 :]):
            raise _wrong("the costates of velocity are all zero: they point the thrust")
        return self


class SmoothedSteering(Section):
    """A fast transfer of an electric sail to another circle, its voltage falling smoothly towards the coasts; found by
    shooting from costates of radius, radial and transverse speed (of any length) and from the run's duration. Pitch and
    voltage are held over every `hold`."""

    kind: Literal["smoothed-transfer"]
    radius: Annotated[Length, POSITIVE]
    costates: Annotated[list[float], Three]
    hold: Annotated[Time, POSITIVE] = 3600.0
    width: Annotated[float, Field(gt=0, le=1)] = 0.05

    @model_validator(mode="after")
    def _nonzero(self):
        if not any(self.costates[1:]):
            raise _wrong("the costates of velocity are all zero: they point the thrust")
        return self

    @property
    def interpolation(self) -> str:
        return "hold"


class LocalSteering(PrimerSteering):
    """Whatever changes one orbital element fastest at every moment."""

    kind: Literal["locally-optimal"]
    goal: Literal["energy", "semi-major-axis", "eccentricity", "inclination", "raan", "argument"]
    sense: Literal["increase", "decrease"] = "increase"


class LyapunovSteering(PrimerSteering):
    """Down the distance to a target orbit, a weighted sum of squares of the equinoctial elements' misses, until its
    root is `within`; then without thrust."""

    kind: Literal["lyapunov"]
    semi_major_axis: Annotated[Length, POSITIVE]
    eccentricity: Annotated[float, Field(ge=0, lt=1)] = 0.0
    inclination: Annotated[Angle, Field(ge=0, lt=3.14)] = 0.0
    raan: Angle = 0.0
    argument: Angle = 0.0
    weights: Annotated[list[Annotated[float, Field(ge=0)]], Field(min_length=5, max_length=5)] = [1, 1, 1, 1, 1]
    within: Annotated[float, POSITIVE] = 0.02


Steering = Annotated[
    PlainSteering
    | FrameSteering
    | InertialSteering
    | TableSteering
    | SpinningSteering
    | OptimalSteering
    | SmoothedSteering
    | LocalSteering
    | LyapunovSteering,
    Field(discriminator="kind"),
]
PRIMER_LAWS = ("optimal", "locally-optimal", "lyapunov")


# ---------------------------------------------------------------- where it is meant to arrive
PLANET = Literal["mercury", "venus", "earth", "mars", "jupiter", "saturn"]


class Target(Section):
    """An orbit to be reached, drawn beside the flight: a circle, an ellipse, or the orbit of a planet (mean elements at
    the epoch, or of J2000 without one)."""

    name: str | None = None
    planet: PLANET | None = None
    radius: Annotated[Length, POSITIVE] | None = None
    semi_major_axis: Annotated[Length, POSITIVE] | None = None
    eccentricity: Annotated[float, Field(ge=0, lt=1)] = 0.0
    inclination: Annotated[Angle, Field(ge=0, le=3.141592653589794)] = 0.0
    raan: Angle = 0.0
    argument: Angle = 0.0

    @model_validator(mode="after")
    def _which(self):
        _one_of(self, "planet", "radius", "semi_major_axis")
        if self.radius is not None and (self.eccentricity or self.argument):
            raise _wrong("radius is that of a circle: an ellipse has semi_major_axis and eccentricity")
        if self.planet is not None and (self.eccentricity or self.inclination or self.raan or self.argument):
            raise _wrong("the orbit of a planet is known: give the planet alone")
        return self


# ---------------------------------------------------------------- what surrounds it
class DrawnWind(Section):
    """Solar-wind dynamic pressure at 1 au drawn from a law: independent every `redraw`, correlated, or one value for
    the whole flight. reference : the pressure of nominal thrust, the law's mean, what leaves the mean thrust nominal,
    or a pressure."""

    variation: Literal["redrawn", "correlated", "constant"] = "redrawn"
    redraw: Annotated[Time, POSITIVE] = 86_400.0
    correlation_time: Annotated[Time, POSITIVE] = 61_200.0
    yearly_deviation: Annotated[float, Field(ge=0, le=1)] = 0.0
    seed: Annotated[int, Field(ge=0)]
    reference: Annotated[Pressure, POSITIVE] | Literal["mean", "unbiased"] = "mean"


class GammaWind(DrawnWind):
    """The thesis' law."""

    kind: Literal["gamma"]
    shape: Annotated[float, POSITIVE]
    scale: Annotated[Pressure, POSITIVE]


class LognormalWind(DrawnWind):
    """Fits the measured pressures better: scale is the median, sigma that of ln p."""

    kind: Literal["lognormal"]
    sigma: Annotated[float, POSITIVE]
    scale: Annotated[Pressure, POSITIVE]


class BurrWind(DrawnWind):
    """Burr XII, which fits the measured pressures best."""

    kind: Literal["burr"]
    c: Annotated[float, POSITIVE]
    d: Annotated[float, POSITIVE]
    scale: Annotated[Pressure, POSITIVE]

    @model_validator(mode="after")
    def _mean_exists(self):
        if self.c * self.d <= 1:
            raise _wrong("with c d not above 1 this law has no mean pressure")
        return self


class ReplayedWind(Section):
    """A measured series: OMNI2 hourly text, npz, CSV or parquet. It begins at `start`, or at a place drawn with the
    seed; impossible values are an error unless `repair` says to fill and count them."""

    kind: Literal["replay"]
    file: str
    start: datetime | date | None = None
    seed: Annotated[int, Field(ge=0)] | None = None
    reference: Annotated[Pressure, POSITIVE] | Literal["mean", "unbiased"] = "mean"
    potential: Literal["fixed", "from speed"] = "fixed"
    repair: bool = False

    @model_validator(mode="after")
    def _begins(self):
        _one_of(self, "start", "seed")
        return self


class SteadyWind(Section):
    """The nominal wind."""

    kind: Literal["steady"]


class SteadyIrradiance(Section):
    """Sunlight as at the mean."""

    kind: Literal["steady"]


class CyclicIrradiance(Section):
    """Sunlight with its 11-year cycle (by the epoch, else from a maximum on) and a daily flicker drawn with the seed;
    both as shares of the mean."""

    kind: Literal["cycle"]
    amplitude: Annotated[float, Field(ge=0, lt=0.1)] = 3.6e-4
    flicker: Annotated[float, Field(ge=0, lt=0.1)] = 2.454e-4
    redraw: Annotated[Time, POSITIVE] = 86_400.0
    seed: Annotated[int, Field(ge=0)] = 0


Winds = Annotated[SteadyWind | GammaWind | LognormalWind | BurrWind | ReplayedWind, Field(discriminator="kind")]


class ForceProfile(Section):
    """Plasma drag per length of tether, exponential in altitude."""

    kind: Literal["exponential-force"]
    force_per_length: Annotated[ForcePerLength, POSITIVE]
    reference_altitude: Annotated[Length, POSITIVE] = 700e3
    scale_height: Annotated[Length, POSITIVE]


class DensityProfile(Section):
    """Plasma density, exponential in altitude, of one mean ion mass; the force law makes drag of it."""

    kind: Literal["exponential-density"]
    density: Annotated[NumberDensity, POSITIVE]
    reference_altitude: Annotated[Length, POSITIVE] = 700e3
    scale_height: Annotated[Length, POSITIVE]
    ion_mass: Annotated[IonMass, POSITIVE] = 15.999 * 1.66053906660e-27


class IonosphereTable(Section):
    """The plasma of IRI-2020 over latitude, local time, altitude and solar flux. density_factor: how far the truth may
    be off, 0.5 to 2 for the whole model."""

    kind: Literal["iri-2020"]
    density_factor: Annotated[float, POSITIVE] = 1.0
    above_table: Literal["refuse", "hold"] = "refuse"


class ExponentialAtmosphere(Section):
    """Neutral density, exponential in altitude."""

    kind: Literal["exponential"]
    density: Annotated[MassDensity, POSITIVE]
    reference_altitude: Annotated[Length, POSITIVE] = 700e3
    scale_height: Annotated[Length, POSITIVE]


class MsisAtmosphere(Section):
    """Neutral density of NRLMSIS 2.1, tabulated for the solar flux and the geomagnetic index ap of the scene."""

    kind: Literal["nrlmsis-2.1"]
    ap: Annotated[float, Field(ge=0, le=400)] = 10.0


class ThirdBody(Section):
    """A planet on a circular orbit in the ecliptic, whose gravity acts on the craft."""

    name: str = "Earth"
    mu: Annotated[Mu, POSITIVE] = 3.986004418e14
    radius: Annotated[Length, POSITIVE] = 149_597_870_700.0
    azimuth: Angle = 0.0


class Environment(Section):
    """Everything around the craft but the point mass it orbits."""

    solar_wind: Winds = SteadyWind(kind="steady")
    irradiance: Annotated[SteadyIrradiance | CyclicIrradiance, Field(discriminator="kind")] = SteadyIrradiance(
        kind="steady"
    )
    ionosphere: Annotated[ForceProfile | DensityProfile | IonosphereTable, Field(discriminator="kind")] | None = None
    atmosphere: Annotated[ExponentialAtmosphere | MsisAtmosphere, Field(discriminator="kind")] | None = None
    solar_flux: Annotated[SolarFlux, POSITIVE] | Literal["cycle"] | None = None
    sun_right_ascension: Angle | None = None
    shadow: Literal["cylinder", "cone"] = "cylinder"
    magnetic_sensitivity: Annotated[float, Field(ge=0, le=1)] = 0.0
    third_body: ThirdBody | None = None
    j2: bool = False
    j3: bool = False
    j4: bool = False
    corotation: bool = False
    height_above: Literal["sphere", "ellipsoid"] = "sphere"


# ---------------------------------------------------------------- how it is computed, watched, recorded, judged
class DenseOutput(Section):
    """A window of the run in which rows come closer."""

    start: Annotated[Time, Field(ge=0)]
    end: Annotated[Time, POSITIVE]
    output_interval: Annotated[Time, POSITIVE]

    @model_validator(mode="after")
    def _window(self):
        if self.end - self.start < self.output_interval:
            raise _wrong("the window from start to end is shorter than its output_interval")
        return self


class Propagation(Section):
    """Duration, output grid, integrator and accuracy."""

    duration: Annotated[Time, POSITIVE]
    outputs: Annotated[int, Field(ge=2, le=100_000_000)] | None = None
    output_interval: Annotated[Time, POSITIVE] | None = None
    dense: list[DenseOutput] = []
    integrator: Literal["auto", "dop853", "gauss-jackson"] = "auto"
    tolerance: Annotated[float, Field(ge=1e-15, le=1e-3)] = 1e-10
    largest_step: Annotated[Time, POSITIVE] | None = None

    @model_validator(mode="after")
    def _grid(self):
        if self.outputs is not None and self.output_interval is not None:
            raise _wrong("give outputs or output_interval, not both")
        if self.output_interval is not None and self.output_interval > self.duration:
            raise _wrong("output_interval is longer than duration")
        return self


class Watched(Section):
    """An event to find. `stop` ends the run there."""

    kind: Literal["radius", "altitude", "mean-altitude", "periapsis", "apoapsis", "node", "escape"]
    name: str | None = None
    radius: Annotated[Length, POSITIVE] | None = None
    altitude: Annotated[Length, POSITIVE] | None = None
    sense: Literal["up", "down", "both"] = "both"
    stop: bool = False

    @model_validator(mode="after")
    def _level(self):
        for field in ("radius", "altitude"):
            of_it = (field, "mean-altitude") if field == "altitude" else (field,)
            if (self.kind in of_it) != (getattr(self, field) is not None):
                needs = f'kind = "{self.kind}" needs {field}'
                raise _wrong(needs if self.kind in of_it else f'{field} belongs to kind = "{field}" and to no other')
        return self


class FirstOrderApproximation(Section):
    """The first-order analytic solution, recorded beside the integrated trajectory."""

    kind: Literal["first-order"]
    name: str = "first order"
    leg: Annotated[Angle, POSITIVE] | None = None
    scheme: Literal["plain", "midpoint"] = "plain"


class QuasiCircularApproximation(Section):
    """The decay of a nearly circular orbit by quadrature, its altitude recorded beside the integrated one."""

    kind: Literal["quasi-circular"]


Approximation = Annotated[FirstOrderApproximation | QuasiCircularApproximation, Field(discriminator="kind")]


class Swarm(Section):
    """Many flights of the scene side by side. control : "device" as the device has it, "none", or one of its own;
    solar_wind : another wind than the scene's."""

    name: Annotated[str, Field(min_length=1)]
    control: (
        Literal["device", "none"]
        | Annotated[PressureControl | DistanceControl | ElectrochromicControl, Field(discriminator="kind")]
    ) = "device"
    solar_wind: Winds | None = None


class Ensemble(Swarm):
    """Flights through winds (or sunshine) of their own. seed : that of the wind if absent; keep : flights drawn
    whole."""

    flights: Annotated[int, Field(ge=2, le=1_000_000)] = 200
    seed: Annotated[int, Field(ge=0)] | None = None
    keep: Annotated[int, Field(ge=1, le=200)] = 60


class Chaos(Swarm):
    """What order + 1 flights tell about a gamma-distributed pressure that stays the same for a whole flight."""

    order: Annotated[int, Field(ge=1, le=30)] = 5
    basis: Literal["root", "laguerre"] = "root"


class Recording(Section):
    """How the recording plays."""

    play_duration: Annotated[Time, POSITIVE] = 40.0


class Expectation(Section):
    """A quantity that the run must reach: value and tolerance in the quantity's own unit. ensemble : of its flights
    instead, a statistic of their ends: the mean, the mean miss of the nominal flight's end, or the standard
    deviation."""

    quantity: str
    ensemble: str | None = None
    statistic: Literal["mean", "miss", "deviation"] | None = None
    closed_form: Literal["kepler", "reduced-kepler", "displaced-orbit", "logarithmic-spiral"] | None = None
    at: Literal["start", "end", "min", "max", "mean", "drift"] | str | None = None
    at_time: Time | None = None
    value: float
    within: Annotated[float, POSITIVE] | None = None
    within_percent: Annotated[float, POSITIVE] | None = None

    @model_validator(mode="after")
    def _known(self):
        from sailviz.scene.quantities import spellings

        if self.quantity not in spellings():
            raise _wrong(f'unknown quantity "{self.quantity}". {nearest(self.quantity, spellings())}')
        if (self.quantity == "closed_form_error") != (self.closed_form is not None):
            raise _wrong('closed_form belongs to quantity = "closed_form_error" and to no other')
        _one_of(self, "at", "at_time")
        if (self.ensemble is None) != (self.statistic is None):
            raise _wrong("ensemble and statistic belong together")
        _one_of(self, "within", "within_percent")
        if self.value == 0 and self.within_percent is not None:
            raise _wrong("of a value of 0 no percentage can be taken: give within")
        return self
