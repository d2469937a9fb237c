"""The scene file: TOML with the unit in every physical key, checked whole, SI once loaded.

Imports neither rerun nor numba nor scipy, so that `sailviz check` answers at once. What the values mean as arrays is
simulation.py's business.
"""

from __future__ import annotations

import hashlib
import json
import tomllib
from datetime import UTC, date, datetime
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, model_validator
from pydantic_core import PydanticCustomError, ValidationError

from sailviz.errors import SceneError
from sailviz.scene_faults import Dimension, convert, faults_of, locate, nearest
from sailviz.shipped import shipped_scenes

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
    """A circular Keplerian orbit."""

    kind: Literal["circular"]
    radius: Annotated[Length, POSITIVE] | None = None
    altitude: Annotated[Length, POSITIVE] | None = None
    inclination: Annotated[Angle, Field(ge=0, le=3.141592653589794)] = 0.0
    raan: Angle = 0.0
    argument_of_latitude: Angle = 0.0

    @model_validator(mode="after")
    def _size(self):
        _one_of(self, "radius", "altitude")
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

    @model_validator(mode="after")
    def _ordered(self):
        edges = [edge for pair in self.active or [] for edge in pair]
        if edges != sorted(set(edges)):
            raise _wrong("active must list [start, stop] pairs, each after the one before")
        return self


class SolarSail(Device):
    """A flat solar sail. Its strength: characteristic acceleration, lightness number, or area with mass."""

    kind: Literal["solar-sail"]
    film: Literal["ideal", "eta-perfect", "jpl-1978", "jpl-2015"] | FilmCoefficients | FilmOptics = "ideal"
    characteristic_acceleration: Annotated[Acceleration, POSITIVE] | DESIGNED | None = None
    lightness_number: Annotated[float, POSITIVE] | None = None
    area: Annotated[Area, POSITIVE] | None = None

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

    @model_validator(mode="after")
    def _strength(self):
        _one_of(self, "characteristic_acceleration", "tethers+tether_length+voltage+mass")
        if self.voltage is not None and self.voltage <= self.wind_potential:
            raise _wrong("voltage must exceed wind_potential, or there is no thrust")
        return self


class PlasmaBrake(Device):
    """A negatively charged tether hanging below a satellite."""

    kind: Literal["plasma-brake"]
    mass: Annotated[Mass, POSITIVE]
    tether_length: Annotated[Length, POSITIVE]
    voltage: Annotated[Voltage, POSITIVE] = 1_000.0
    wire_radius: Annotated[Thickness, POSITIVE] = 1e-3
    off_below: Annotated[Length, Field(ge=0)] = 200e3


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

    kind: Literal["sun-facing", "radial", "circumferential", "tangential", "vertical", "as designed"]


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


Steering = Annotated[PlainSteering | FrameSteering | InertialSteering | TableSteering, Field(discriminator="kind")]


# ---------------------------------------------------------------- what surrounds it
class GammaWind(Section):
    """Solar-wind dynamic pressure redrawn from a gamma distribution, independently, every interval."""

    kind: Literal["gamma"]
    shape: Annotated[float, POSITIVE]
    scale: Annotated[Pressure, POSITIVE]
    redraw: Annotated[Time, POSITIVE]
    seed: Annotated[int, Field(ge=0)]
    reference: Literal["mean", "unbiased"] = "mean"


class SteadyWind(Section):
    """The nominal wind."""

    kind: Literal["steady"]


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


class ThirdBody(Section):
    """A planet on a circular orbit in the ecliptic, whose gravity acts on the craft."""

    name: str = "Earth"
    mu: Annotated[Mu, POSITIVE] = 3.986004418e14
    radius: Annotated[Length, POSITIVE] = 149_597_870_700.0
    azimuth: Angle = 0.0


class Environment(Section):
    """Everything around the craft but the point mass it orbits."""

    solar_wind: Annotated[SteadyWind | GammaWind, Field(discriminator="kind")] = SteadyWind(kind="steady")
    ionosphere: Annotated[ForceProfile | DensityProfile, Field(discriminator="kind")] | None = None
    third_body: ThirdBody | None = None
    j2: bool = False
    corotation: bool = False


# ---------------------------------------------------------------- how it is computed, watched, recorded, judged
class Propagation(Section):
    """Duration, output grid and accuracy."""

    duration: Annotated[Time, POSITIVE]
    outputs: Annotated[int, Field(ge=2, le=100_000_000)] | None = None
    output_interval: Annotated[Time, POSITIVE] | None = None
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

    kind: Literal["radius", "altitude", "periapsis", "apoapsis", "node", "escape"]
    name: str | None = None
    radius: Annotated[Length, POSITIVE] | None = None
    altitude: Annotated[Length, POSITIVE] | None = None
    sense: Literal["up", "down", "both"] = "both"
    stop: bool = False

    @model_validator(mode="after")
    def _level(self):
        for field in ("radius", "altitude"):
            if (self.kind == field) != (getattr(self, field) is not None):
                needs = f'kind = "{field}" needs {field}'
                raise _wrong(needs if self.kind == field else f'{field} belongs to kind = "{field}" and to no other')
        return self


class Approximation(Section):
    """The first-order analytic solution, recorded beside the integrated trajectory."""

    kind: Literal["first-order"]
    name: str = "first order"
    leg: Annotated[Angle, POSITIVE] | None = None
    scheme: Literal["plain", "midpoint"] = "plain"


class Recording(Section):
    """How the recording plays."""

    play_duration: Annotated[Time, POSITIVE] = 40.0


class Expectation(Section):
    """A quantity that the run must reach: value and tolerance in the quantity's own unit."""

    quantity: str
    closed_form: Literal["kepler", "reduced-kepler", "displaced-orbit", "logarithmic-spiral"] | None = None
    at: Literal["start", "end", "min", "max", "mean", "drift"] | str | None = None
    at_time: Time | None = None
    value: float
    within: Annotated[float, POSITIVE] | None = None
    within_percent: Annotated[float, POSITIVE] | None = None

    @model_validator(mode="after")
    def _known(self):
        from sailviz.quantities import spellings

        if self.quantity not in spellings():
            raise _wrong(f'unknown quantity "{self.quantity}". {nearest(self.quantity, spellings())}')
        if (self.quantity == "closed_form_error") != (self.closed_form is not None):
            raise _wrong('closed_form belongs to quantity = "closed_form_error" and to no other')
        _one_of(self, "at", "at_time")
        _one_of(self, "within", "within_percent")
        if self.value == 0 and self.within_percent is not None:
            raise _wrong("of a value of 0 no percentage can be taken: give within")
        return self


class Scene(Section):
    """A whole scene, SI. Build it with `load_scene`."""

    title: Annotated[str, Field(min_length=1)]
    about: str = ""
    thesis: str = ""
    look_for: list[str] = []
    family: Literal["displaced", "spirals", "deorbit", "wind", "transfers"] | None = None
    epoch: datetime | date | None = None
    ephemeris: Literal["mean-elements", "de421"] = "mean-elements"
    body: Literal["sun", "earth"] | CustomBody = "sun"
    start: Start
    device: Devices
    steering: Steering | None = None
    environment: Environment = Environment()
    propagation: Propagation
    event: list[Watched] = []
    approximation: list[Approximation] = []
    recording: Recording = Recording()
    expect: list[Expectation] = []

    _text: str = PrivateAttr("")
    _source: str = PrivateAttr("scene")
    _raw: dict = PrivateAttr(default_factory=dict)

    @property
    def text(self) -> str:
        """The scene file as it was read, overrides not included; "" if the scene was not made from a file."""
        return self._text

    @property
    def source(self) -> str:
        """File or shipped name that the scene came from, for messages."""
        return self._source

    def resolved(self) -> dict:
        """Every value, defaults included, SI, ready for JSON."""
        return self.model_dump(mode="json")

    def identity(self) -> str:
        """Hash of the resolved scene, 16 hexadecimal digits: equal scenes have equal recordings."""
        canonical = json.dumps(self.resolved(), sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(canonical.encode()).hexdigest()[:16]

    def with_values(self, values: dict[str, Any]) -> Scene:
        """A copy with other values. values : {"device.lightness_number": 0.1, "propagation.duration_yr": 2}, keys
        and units as in a scene file; a key in another unit replaces the one in the file. SceneError as for
        `load_scene`."""
        return _built(self._raw, values, self._text, self._source)

    @property
    def epoch_utc(self) -> datetime | None:
        """The epoch as a naive UTC datetime."""
        if self.epoch is None:
            return None
        if not isinstance(self.epoch, datetime):
            return datetime(self.epoch.year, self.epoch.month, self.epoch.day)
        return self.epoch.astimezone(UTC).replace(tzinfo=None) if self.epoch.tzinfo else self.epoch


# ---------------------------------------------------------------- checks between sections
def _conflicts(scene: Scene) -> list[tuple[str, str]]:
    """(place, sentence) of everything that fits its own section but not the others."""
    found = []
    device, steering, start = scene.device, scene.steering, scene.start
    sail = device.kind in ("solar-sail", "electric-sail")
    law = steering.kind if steering else None
    duration = scene.propagation.duration
    if sail and scene.body != "sun":
        found.append(("device.kind", f"a {device.kind} needs the Sun as its central body"))
    if device.kind == "plasma-brake":
        if scene.body != "earth":
            found.append(("device.kind", 'a plasma brake works in the ionosphere: body = "earth"'))
        if scene.environment.ionosphere is None:
            found.append(("environment.ionosphere", "a plasma brake needs an ionosphere"))
        if law not in (None, "vertical"):
            found.append(("steering.kind", 'a plasma-brake tether hangs along the gravity gradient: "vertical"'))
    if device.kind == "thruster" and law in (None, "sun-facing", "vertical", "as designed"):
        words = '"radial", "circumferential", "tangential", "inertial", "orbital", "meridian" or "table"'
        found.append(("steering.kind", f"a thruster needs a direction: {words}"))
    if sail and law in ("circumferential", "tangential", "vertical"):
        found.append(("steering.kind", f'"{law}" is a thruster\'s law; a sail is steered by pitch and clock angle'))
    designed = getattr(device, "characteristic_acceleration", None) == "as designed"
    if start.kind not in HELD_STARTS:
        needs = f'"as designed" needs a start.kind that is held: {", ".join(HELD_STARTS)}'
        if designed:
            found.append(("device.characteristic_acceleration", needs))
        if law == "as designed":
            found.append(("steering.kind", needs))
    elif not sail:
        found.append(("start.kind", f"{start.kind}: such an orbit is held by a solar sail or an electric sail"))
    elif device.kind == "electric-sail" and device.model != "final":
        found.append(("device.model", 'orbits are designed with the "final" model'))
    elif start.kind in ("planet-following", "flat-ellipse") and (not designed or law != "as designed"):
        found.append(("start.kind", f'{start.kind} needs characteristic_acceleration and steering "as designed"'))
    if scene.environment.third_body is not None and scene.body != "sun":
        found.append(("environment.third_body", "a third body goes round the Sun"))
    if start.kind == "spiral":
        if device.kind != "solar-sail":
            found.append(("start.kind", "a logarithmic spiral is flown by a solar sail"))
        elif law != "orbital":
            found.append(("steering.kind", 'a logarithmic spiral needs a fixed pitch: kind = "orbital"'))
        elif abs(abs(steering.clock) % 6.283185307179586 - 1.5707963267948966) > 1e-9:
            found.append(
                ("steering.clock", "a logarithmic spiral is planar: clock_deg = 90 (negative pitch goes inwards)")
            )
    if scene.ephemeris == "de421" and scene.epoch is not None:
        if not 1900 <= scene.epoch.year <= 2053 - duration / 3.15576e7:
            found.append(("ephemeris", "DE421 reaches from 1899 to 2053"))
        if find_spec("skyfield_data") is None or find_spec("jplephem") is None:
            found.append(("ephemeris", 'DE421 needs the extra "ephemeris": pip install "sailviz[ephemeris]"'))
    if scene.approximation:
        found += [("approximation[0]", sentence) for sentence in _beyond_first_order(scene)]
        if len({item.name for item in scene.approximation}) < len(scene.approximation):
            found.append(("approximation[1].name", "two approximations have the same name"))
    if start.kind == "circular" and start.altitude is not None and _body_radius(scene) == 0:
        found.append(("start.altitude", "the body has no radius to measure an altitude from"))
    if scene.environment.solar_wind.kind != "steady" and device.kind != "electric-sail":
        found.append(("environment.solar_wind", "the solar wind acts on an electric sail only"))
    if scene.environment.solar_wind.kind == "gamma" and duration / scene.environment.solar_wind.redraw > 1e7:
        found.append(("environment.solar_wind.redraw", "more than ten million draws in one run"))
    if scene.epoch is not None and not 1700 <= scene.epoch.year <= 2262 - duration / 3.15576e7:
        found.append(("epoch", "the run must lie between the years 1700 and 2262, what 64 bits of nanoseconds reach"))
    if scene.environment.j2 and scene.body != "earth":
        found.append(("environment.j2", 'j2 is known for body = "earth"'))
    if sail and law in ("orbital", "meridian", "table"):
        angles = steering.pitch if isinstance(steering.pitch, list) else [steering.pitch]
        limited = device.kind == "electric-sail" and device.model in ("original", "updated")
        limit = device.pitch_limit if limited else 1.5707963267948968
        if max(map(abs, angles)) > limit * (1 + 1e-12):
            degrees = limit * 57.29577951308232
            found.append(("steering.pitch", f"beyond {degrees:.4g} deg the {device.kind}'s force model does not hold"))
    for i, watched in enumerate(scene.event):
        if watched.kind == "altitude" and _body_radius(scene) == 0:
            found.append((f"event[{i}].altitude", "the body has no radius to measure an altitude from"))
    names = {w.name or w.kind for w in scene.event} | {"impact", "thrust on", "thrust off", "brake off"}
    for i, expected in enumerate(scene.expect):
        if expected.at not in (None, "start", "end", "min", "max", "mean", "drift") and expected.at not in names:
            words = ["start", "end", "min", "max", "mean", "drift", *sorted(names)]
            found.append((f"expect[{i}].at", f'no such moment "{expected.at}". {nearest(expected.at, words)}'))
        if expected.at_time is not None and not 0 <= expected.at_time <= duration:
            found.append((f"expect[{i}].at_time", "outside the run"))
    return found


def _beyond_first_order(scene: Scene) -> list[str]:
    """What keeps a scene from the first-order solution, which is planar and has one thrust law at fixed pitch."""
    device, steering, found = scene.device, scene.steering, []
    planar = scene.start.kind in ("circular", "elements") and scene.start.inclination == 0
    if not planar:
        found.append('the first-order solution is planar: start.kind "circular" or "elements" without inclination')
    law = steering.kind if steering else "sun-facing"
    sideways = law != "orbital" or abs(abs(steering.clock) % 3.141592653589793 - 1.5707963267948966) < 1e-9
    if law not in ("orbital", "sun-facing", "radial", "circumferential") or not sideways:
        found.append(
            "the first-order solution needs a fixed pitch in the orbit plane, or radial or circumferential thrust"
        )
    if device.active is not None or scene.environment.solar_wind.kind != "steady" or device.kind == "plasma-brake":
        found.append("the first-order solution needs thrust that is always on and never disturbed")
    if device.kind == "electric-sail" and device.model != "final":
        found.append('the first-order solution needs the electric sail\'s "final" model')
    if device.kind == "thruster" and (device.thrust is not None or device.specific_impulse is not None):
        found.append("the first-order solution is compared at constant acceleration, without loss of mass")
    return found


def _body_radius(scene: Scene) -> float:
    return 1.0 if isinstance(scene.body, str) else scene.body.radius


# ---------------------------------------------------------------- loading
def load_scene(source, set: dict[str, Any] | None = None) -> Scene:
    """Read, check and convert a scene.

    source : path of a TOML file, the name of a shipped scene ("displaced/circular"), or a dict as tomllib would give
    it. set : values to put over those of the file, keys dotted: {"propagation.duration_yr": 1}. Raises SceneError
    with every fault at once.
    """
    if isinstance(source, dict):
        return _built(source, set or {}, "", "scene")
    path, name = _find(source)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise SceneError(faults_of([("file", error.strerror or str(error))]), name) from None
    except UnicodeDecodeError:
        raise SceneError(faults_of([("file", "is not UTF-8 text, so not a scene")]), name) from None
    try:
        raw = tomllib.loads(text)
    except ValueError as error:  # tomllib's own, or Python's for a number of thousands of digits
        raise SceneError(faults_of([("file", f"is not valid TOML: {error}")]), name) from None
    except RecursionError:
        raise SceneError(faults_of([_TOO_DEEP]), name) from None
    return _built(raw, set or {}, text, name)


_TOO_DEEP = ("file", "is nested too deeply")


def _built(raw: dict, values: dict[str, Any], text: str, name: str) -> Scene:
    try:
        return _validated(_overridden(raw, values), text, name)
    except RecursionError:
        raise SceneError(faults_of([_TOO_DEEP]), name) from None


def _find(source) -> tuple[Path, str]:
    path = Path(source)
    try:
        if path.is_file():
            return path, str(source)
    except OSError as error:  # a name that no file can have
        raise SceneError(faults_of([("file", error.strerror or str(error))]), str(source)) from None
    known = shipped_scenes()
    name = str(source).removesuffix(".toml")
    if name in known:
        return known[name], name
    what = "is a folder, not a scene file." if path.is_dir() else "no such file or shipped scene."
    raise SceneError(faults_of([("file", f"{what} {nearest(name, known)}")]), str(source))


def _overridden(raw: dict, values: dict[str, Any]) -> dict:
    """A deep copy of raw with dotted keys replaced."""
    result = _copy(raw)
    for key, value in values.items():
        *path, last = key.split(".")
        table = result
        for part in path:
            if isinstance(table, list) and part.isdecimal() and len(part) < 9 and int(part) < len(table):
                table = table[int(part)]
                continue
            if isinstance(table, dict) and not isinstance(table.get(part, {}), (dict, list)):
                table[part] = {}
            table = table.setdefault(part, {}) if isinstance(table, dict) else None
            if table is None:
                raise SceneError(faults_of([(key, "no such place in the scene")]), "--set")
        if not isinstance(table, dict):
            raise SceneError(faults_of([(key, "no such place in the scene")]), "--set")
        for sibling in _same_quantity(last, table):
            del table[sibling]
        table[last] = _copy(value)
    return result


def _copy(value):
    if isinstance(value, dict):
        return {key: _copy(item) for key, item in value.items()}
    return [_copy(item) for item in value] if isinstance(value, list) else value


def _same_quantity(key: str, table: dict) -> list[str]:
    """Keys of the table that say the same quantity in another unit."""
    from sailviz.units import UNITS

    for units in UNITS.values():
        for unit in units:
            if unit and key.endswith(f"_{unit}"):
                stem = key.removesuffix(f"_{unit}")
                twins = {stem, *(f"{stem}_{other}" for other in units)}
                found = [name for name in table if name in twins and name != key]
                if found:
                    return found
    return []


def _validated(raw: dict, text: str, source: str) -> Scene:
    converted, faults, written = convert(Scene, raw)
    scene = None
    try:
        scene = Scene.model_validate(converted)
    except ValidationError as error:
        faults += faults_of(error, written, Scene)
    if scene is not None and not faults:
        faults = faults_of([(written.get(place, place), what) for place, what in _conflicts(scene)])
    if faults:
        raise SceneError(locate(faults, text), source)
    scene._text, scene._source, scene._raw = text, source, raw
    return scene


@cache
def schema() -> dict:
    """JSON Schema of the scene file, every spelling of every quantity included, for editors and other tools."""
    from sailviz.scene_faults import with_units

    return with_units(Scene.model_json_schema())
