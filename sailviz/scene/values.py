"""Kinds of values in a scene file: SI inside, the unit in the key outside."""

from datetime import date, datetime
from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, WithJsonSchema
from pydantic_core import PydanticCustomError

from sailviz.calendar import PATTERN, DateError, moment
from sailviz.scene.units_in_keys import Dimension


def wrong(message: str) -> PydanticCustomError:
    """An error of a validator that comes to the person as this sentence."""
    return PydanticCustomError("scene", message)


def _moment(value: object) -> date:
    """A date, quoted or not."""
    try:
        return moment(value)
    except DateError as error:
        raise wrong(str(error)) from None


Length = Annotated[float, Dimension("length")]
Thickness = Annotated[float, Dimension("thickness")]
Time = Annotated[float, Dimension("time")]
Angle = Annotated[float, Dimension("angle")]
Acceleration = Annotated[float, Dimension("acceleration")]
Mass = Annotated[float, Dimension("mass")]
Area = Annotated[float, Dimension("area")]
Voltage = Annotated[float, Dimension("voltage")]
Pressure = Annotated[float, Dimension("pressure")]
Irradiance = Annotated[float, Dimension("irradiance")]
AngularRate = Annotated[float, Dimension("angular_rate")]
Torque = Annotated[float, Dimension("torque")]
Temperature = Annotated[float, Dimension("temperature")]
Force = Annotated[float, Dimension("force")]
ForcePerLength = Annotated[float, Dimension("force_per_length")]
NumberDensity = Annotated[float, Dimension("number_density")]
Power = Annotated[float, Dimension("power")]
MassDensity = Annotated[float, Dimension("mass_density")]
SolarFlux = Annotated[float, Dimension("solar_flux")]
IonMass = Annotated[float, Dimension("ion_mass")]
Speed = Annotated[float, Dimension("speed")]
AngularMomentum = Annotated[float, Dimension("angular_momentum")]
Current = Annotated[float, Dimension("current")]
SpecificEnergy = Annotated[float, Dimension("specific_energy")]
SpecificAngularMomentum = Annotated[float, Dimension("specific_angular_momentum")]
Mu = Annotated[float, Dimension("mu")]
Moment = Annotated[
    datetime | date,
    BeforeValidator(_moment),
    WithJsonSchema({"type": "string", "pattern": PATTERN}),
]
Three = Field(min_length=3, max_length=3)
PositionVector = Annotated[list[float], Dimension("length"), Three]
VelocityVector = Annotated[list[float], Dimension("speed"), Three]
RateVector = Annotated[list[float], Dimension("angular_rate"), Three]
InertiaMatrix = Annotated[list[float] | list[list[float]], Dimension("inertia")]
Times = Annotated[list[float], Dimension("time")]
Angles = Annotated[list[float], Dimension("angle")]
Intervals = Annotated[list[Annotated[list[float], Field(min_length=2, max_length=2)]], Dimension("time")]
POSITIVE = Field(gt=0)
HALF_TURN = Field(ge=-3.141592653589794, le=3.141592653589794)
QUARTER_TURN = Field(ge=-1.5707963267948968, le=1.5707963267948968)


# Modules of sections do without `from __future__ import annotations`: pydantic would have to compile each annotation
# from its text, which costs `sailviz check` one part in forty.
class Section(BaseModel):
    """A table of the scene file."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)


def one_of(section: Section, *names: str) -> None:
    """Exactly one of several fields (or groups joined by '+') must be given."""
    given = [name for name in names if all(getattr(section, part) is not None for part in name.split("+"))]
    if len(given) != 1:
        words = " or ".join(name.replace("+", " with ") for name in names)
        raise wrong(f"needs exactly one of {words}" + (f", has {' and '.join(given)}" if given else ""))
