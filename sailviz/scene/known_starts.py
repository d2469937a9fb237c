"""Starts that are looked up: where an element set, an ephemeris message, a planet or a small body is at a date."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from sailviz.scene.body import PLANET
from sailviz.scene.values import POSITIVE, Angle, Length, Moment, Section, SpecificEnergy, Three, one_of, wrong

ALONG = Literal["along", "against", "outward", "inward", "north", "south"]


class TleStart(Section):
    """Where SGP4 has a satellite at the scene's epoch, or without one at the epoch of its elements: two lines, or a
    file of such sets or of mean-elements messages (OMM)."""

    kind: Literal["tle"]
    line1: str | None = None
    line2: str | None = None
    file: str | None = None
    name: str | None = None

    @model_validator(mode="after")
    def _given(self) -> Self:
        one_of(self, "file", "line1+line2")
        if (self.line1 is None) != (self.line2 is None):
            raise wrong("an element set has two lines: give line1 and line2")
        if self.name is not None and self.file is None:
            raise wrong("name chooses among the sets of a file: give the file")
        return self


class OemStart(Section):
    """Where an orbit ephemeris message has a craft at a date, by cubic Hermite interpolation between its rows; without
    a date at the scene's epoch, or at its first row. Of an orbit parameter message (OPM) its one state."""

    kind: Literal["oem"]
    file: str
    at: Moment | None = None


class PlanetStart(Section):
    """At a planet at the epoch, leaving it with an excess speed, given as C3, its square. towards : along or against
    its velocity, outward or inward on the line from the Sun, north or south of the ecliptic, or a vector. distance :
    how far from its centre the flight begins on that line, sped up by its pull."""

    kind: Literal["from-planet"]
    planet: PLANET
    c3: Annotated[SpecificEnergy, Field(ge=0)] = 0.0
    towards: ALONG | Annotated[list[float], Three] = "along"
    distance: Annotated[Length, Field(ge=0)] = 0.0

    @model_validator(mode="after")
    def _direction(self) -> Self:
        if not isinstance(self.towards, str) and not any(self.towards):
            raise wrong("towards is a direction, not the zero vector")
        return self


class SmallBodyStart(Section):
    """At an asteroid or a comet at the epoch: from a file of JPL's Small-Body Database or of the Minor Planet Center,
    or by elements, ecliptic of J2000, with the mean anomaly on a date or the date of perihelion (TDB)."""

    kind: Literal["small-body"]
    file: str | None = None
    name: str | None = None
    semi_major_axis: Length | None = None
    perihelion_distance: Annotated[Length, POSITIVE] | None = None
    eccentricity: Annotated[float, Field(ge=0)] | None = None
    inclination: Annotated[Angle, Field(ge=0, le=3.141592653589794)] | None = None
    raan: Angle | None = None
    argument: Angle | None = None
    mean_anomaly: Angle | None = None
    elements_date: Moment | None = None
    perihelion_date: Moment | None = None

    @model_validator(mode="after")
    def _given(self) -> Self:
        elements = ("semi_major_axis", "perihelion_distance", "eccentricity", "inclination", "raan", "argument",
                    "mean_anomaly", "elements_date", "perihelion_date")  # fmt: skip
        said = [name for name in elements if getattr(self, name) is not None]
        if self.file is not None:
            if said:
                raise wrong(f"the file says the orbit: {said[0]} is one too many")
            return self
        one_of(self, "file", "semi_major_axis+mean_anomaly+elements_date", "perihelion_distance+perihelion_date")
        missing = [name for name in ("eccentricity", "inclination", "raan", "argument") if name not in said]
        if missing:
            raise wrong(f"an orbit by its elements needs {missing[0]} too")
        if self.name is not None:
            raise wrong("name chooses among the orbits of a file: give the file")
        axis, e = self.semi_major_axis, self.eccentricity or 0.0
        if axis is not None and not axis * (1.0 - e) > 0.0:
            raise wrong("an ellipse has eccentricity < 1 and semi-major axis > 0, a hyperbola > 1 and < 0")
        return self


KnownStarts = TleStart | OemStart | PlanetStart | SmallBodyStart
