"""What is looked for along a flight: the kinds of [[event]], and any quantity that crosses a value."""

from collections.abc import Callable, Iterator
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from sailviz.scene.values import (
    POSITIVE,
    Acceleration,
    Angle,
    AngularMomentum,
    AngularRate,
    Current,
    Force,
    ForcePerLength,
    Length,
    Mass,
    NumberDensity,
    Power,
    Section,
    SpecificAngularMomentum,
    SpecificEnergy,
    Speed,
    Temperature,
    Time,
    Torque,
    Voltage,
    wrong,
)
from sailviz.words import acceleration, angle, duration, length

TURN = 6.283185307179587
NOT_NEGATIVE = Field(ge=0)
A_TURN = Field(ge=-TURN, le=TURN)
HALF_A_TURN = Field(ge=0, le=TURN / 2 + 1e-15)
RIGHT_ANGLE = Field(ge=-TURN / 4, le=TURN / 4)

Sense = Literal["up", "down", "both"]


class Crossing(Section):
    """A quantity of [[expect]] and the value that it crosses. sense : up, down or both."""

    radius: Annotated[Length, POSITIVE] | None = None
    altitude: Annotated[Length, POSITIVE] | None = None
    elevation: Annotated[Angle, RIGHT_ANGLE] | None = None
    height: Length | None = None
    longitude: Annotated[Angle, A_TURN] | None = None
    speed: Annotated[Speed, POSITIVE] | None = None
    radial_speed: Speed | None = None
    transverse_speed: Annotated[Speed, POSITIVE] | None = None
    flight_path_angle: Annotated[Angle, RIGHT_ANGLE] | None = None
    energy: SpecificEnergy | None = None
    angular_momentum: Annotated[SpecificAngularMomentum, POSITIVE] | None = None
    angular_momentum_z: SpecificAngularMomentum | None = None
    time: Annotated[Time, POSITIVE] | None = None
    mass: Annotated[Mass, POSITIVE] | None = None
    semi_major_axis: Length | None = None
    eccentricity: Annotated[float, NOT_NEGATIVE] | None = None
    inclination: Annotated[Angle, HALF_A_TURN] | None = None
    raan: Annotated[Angle, A_TURN] | None = None
    true_anomaly: Annotated[Angle, A_TURN] | None = None
    periapsis: Annotated[Length, POSITIVE] | None = None
    apoapsis: Annotated[Length, POSITIVE] | None = None
    perigee_altitude: Length | None = None
    mean_altitude: Length | None = None
    apogee_altitude: Length | None = None
    pitch: Annotated[Angle, HALF_A_TURN] | None = None
    cone: Annotated[Angle, HALF_A_TURN] | None = None
    clock: Annotated[Angle, A_TURN] | None = None
    thrust_acceleration: Annotated[Acceleration, NOT_NEGATIVE] | None = None
    thrust_factor: float | None = None
    sunlit_fraction: Annotated[float, Field(gt=0, lt=1)] | None = None
    sun_distance: Annotated[Length, POSITIVE] | None = None
    moon_distance: Annotated[Length, POSITIVE] | None = None
    air_drag: Annotated[Force, POSITIVE] | None = None
    plasma_force: Annotated[ForcePerLength, POSITIVE] | None = None
    plasma_density: Annotated[NumberDensity, POSITIVE] | None = None
    tether_current: Annotated[Current, POSITIVE] | None = None
    tether_voltage: Voltage | None = None
    tether_power: Annotated[Power, POSITIVE] | None = None
    tether_tilt: Annotated[Angle, NOT_NEGATIVE] | None = None
    dose: Annotated[Time, POSITIVE] | None = None
    film_temperature: Annotated[Temperature, POSITIVE] | None = None
    spin_rate: Annotated[AngularRate, POSITIVE] | None = None
    modulation: Annotated[float, POSITIVE] | None = None
    thrust_lost: Annotated[float, POSITIVE] | None = None
    wheel_torque: Annotated[Torque, POSITIVE] | None = None
    body_rate: Annotated[AngularRate, POSITIVE] | None = None
    nutation: Annotated[Angle, HALF_A_TURN] | None = None
    wheel_momentum: Annotated[AngularMomentum, POSITIVE] | None = None
    sense: Sense = "both"

    always: ClassVar[tuple[str, ...]] = ()  # said in the resolved scene where they are not given, too
    # what [[expect]] knows and no event can watch, with the reason
    why_not: ClassVar[dict[str, str]] = {
        "closed_form_error": "compares with a motion begun in the first row: a state alone does not tell it",
        "quasi_circular_altitude": "belongs to the approximation, not to the flight",
        "sunlit": "is 0 or 1 and crosses no value: watch sunlit_fraction = 0.5",
        "in_solar_wind": 'is 0 or 1 and crosses no value: "wind on" and "wind off" are found without being asked for',
        "force_law_valid": "is 0 or 1 and crosses no value",
        "thrust_voltage": "jumps at the controller's updates and crosses nothing between them: watch thrust_factor",
        "wind_pressure": "jumps whenever the wind is drawn and crosses nothing between: watch thrust_factor",
        "electrochromic_state": "jumps at known times and crosses nothing between them",
        "light_torque": "is made of the attitude, which can be watched: watch pitch or body_rate",
        "air_torque": "is made of air and attitude, which can be watched: watch air_drag or body_rate",
        "control_torque": "jumps where actuators reach their limits: watch wheel_momentum or body_rate",
        "share": "is of all flights of an ensemble: no single flight meets it",
        "saturated": "counts a controller's updates: it is no function of state and time",
    }

    @property
    def quantity(self) -> str | None:
        """Stem of the quantity that is given, e.g. "radius"; None where there is none."""
        return next(self.quantities(), None)

    def quantities(self) -> Iterator[str]:
        """Stems of all that are given."""
        return (name for name in Crossing.model_fields if name != "sense" and getattr(self, name) is not None)

    @property
    def level(self) -> float:
        """The value that the quantity crosses, SI."""
        return float(getattr(self, self.quantity or ""))

    @property
    def words(self) -> str:
        """What is crossed, e.g. "radius = 0.48 au"."""
        stem = self.quantity or ""
        return f"{stem.replace('_', ' ')} = {_WORDS.get(_dimension(stem), _plain)(self.level)}"

    @model_serializer(mode="wrap")
    def _given(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Quantities that are not given are left out: what scenes were before they could be, they still are."""
        values: dict[str, Any] = handler(self)
        return {k: v for k, v in values.items() if v is not None or k not in Crossing.model_fields or k in self.always}

    @model_validator(mode="after")
    def _one(self) -> Self:
        given = list(self.quantities())
        if len(given) > 1:
            raise wrong(f"needs one quantity and its value, has {' and '.join(given)}")
        if self.semi_major_axis == 0:
            raise wrong("no orbit has a semi-major axis of 0")
        return self


def _plain(value: float) -> str:
    return f"{value:.6g}"


def _dimension(stem: str) -> str:
    from sailviz.scene.quantities import DIMENSIONS

    return DIMENSIONS.get(stem, "none")


_WORDS: dict[str, Callable[[float], str]] = {
    "length": length,
    "time": duration,
    "angle": angle,
    "acceleration": acceleration,
    "speed": lambda value: f"{value / 1e3:.6g} km/s",
    "mass": lambda value: f"{value:.6g} kg",
    "specific_energy": lambda value: f"{value / 1e6:.6g} km²/s²",
    "specific_angular_momentum": lambda value: f"{value / 1e6:.6g} km²/s",
    "force": lambda value: f"{value:.6g} N",
    "force_per_length": lambda value: f"{value * 1e9:.6g} nN/m",
    "number_density": lambda value: f"{value:.6g} /m³",
    "current": lambda value: f"{value * 1e3:.6g} mA",
    "voltage": lambda value: f"{value:.6g} V",
    "angular_momentum": lambda value: f"{value:.6g} N m s",
    "power": lambda value: f"{value:.6g} W",
    "temperature": lambda value: f"{value:.6g} K",
    "angular_rate": lambda value: f"{value:.6g} rad/s",
    "torque": lambda value: f"{value:.6g} N m",
}


class Watched(Crossing):
    """An event to find: of a kind, or where a quantity crosses a value. `stop` ends the run there."""

    kind: (
        Literal["radius", "altitude", "mean-altitude", "periapsis", "apoapsis", "node", "escape", "too-hot"] | None
    ) = None
    name: str | None = None
    stop: bool = False

    always: ClassVar[tuple[str, ...]] = ("radius", "altitude")

    @property
    def called(self) -> str:
        """The event's name, its kind, or what is crossed."""
        return self.name or self.kind or self.words

    @model_validator(mode="after")
    def _level(self) -> Self:
        given = list(self.quantities())
        if self.kind is None:
            if not given:
                raise wrong('needs a kind, e.g. kind = "periapsis", or a quantity and its value, e.g. radius_au = 0.48')
            return self
        needs = {"radius": "radius", "altitude": "altitude", "mean-altitude": "altitude"}.get(self.kind)
        if needs is not None and needs not in given:
            raise wrong(f'kind = "{self.kind}" needs {needs}')
        for field in given:
            if field != needs:
                raise wrong(f'{field} belongs to no kind = "{self.kind}": leave the kind out to watch {field}')
        return self
