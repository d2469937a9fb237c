"""The body that the craft flies round, and the orbit that it is meant to reach."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from sailviz.scene.values import POSITIVE, Angle, Length, Moment, Mu, Section, one_of, wrong


class CustomBody(Section):
    """Any central body."""

    name: str = "body"
    mu: Annotated[Mu, POSITIVE]
    radius: Annotated[Length, Field(ge=0)] = 0.0


CENTRE = Literal["sun", "mercury", "venus", "earth", "moon", "mars", "jupiter", "saturn", "uranus", "neptune"]
PLANET = Literal["mercury", "venus", "earth", "mars", "jupiter", "saturn", "uranus", "neptune"]


class Target(Section):
    """An orbit to be reached, drawn beside the flight: a circle, an ellipse, or the orbit of a planet (mean elements at
    the epoch, or of J2000 without one); with a mean anomaly on a date (TDB) also the body that moves on it."""

    name: str | None = None
    planet: PLANET | None = None
    radius: Annotated[Length, POSITIVE] | None = None
    semi_major_axis: Annotated[Length, POSITIVE] | None = None
    eccentricity: Annotated[float, Field(ge=0, lt=1)] = 0.0
    inclination: Annotated[Angle, Field(ge=0, le=3.141592653589794)] = 0.0
    raan: Angle = 0.0
    argument: Angle = 0.0
    mean_anomaly: Angle | None = None
    elements_date: Moment | None = None

    @model_validator(mode="after")
    def _which(self) -> Self:
        one_of(self, "planet", "radius", "semi_major_axis")
        if self.radius is not None and (self.eccentricity or self.argument):
            raise wrong("radius is that of a circle: an ellipse has semi_major_axis and eccentricity")
        if self.planet is not None and (self.eccentricity or self.inclination or self.raan or self.argument):
            raise wrong("the orbit of a planet is known: give the planet alone")
        if (self.mean_anomaly is None) != (self.elements_date is None):
            raise wrong("a body stands where its mean_anomaly has it on a date: give elements_date with it")
        if self.planet is not None and self.mean_anomaly is not None:
            raise wrong("where a planet stands is known: give the planet alone")
        return self
