"""Where a craft starts: the kinds of [start]."""

from math import acos, cos, degrees
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from sailviz.scene.body import PLANET
from sailviz.scene.known_starts import KnownStarts
from sailviz.scene.values import (
    POSITIVE,
    QUARTER_TURN,
    Angle,
    Length,
    PositionVector,
    Section,
    Time,
    VelocityVector,
    one_of,
    wrong,
)

ROUNDING = 1e-12  # of the cosine of an angle that was written in degrees


class CartesianStart(Section):
    """Position and velocity in the frame of the scene, or in another one at the epoch."""

    kind: Literal["cartesian"]
    position: PositionVector
    velocity: VelocityVector
    frame: Literal["ecliptic-j2000", "icrf", "equator-of-date", "teme"] | None = None


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
    def _conic(self) -> Self:
        a, e = self.semi_major_axis, self.eccentricity
        if e == 1:
            raise wrong('a parabola has no semi-major axis: give position and velocity, kind = "cartesian"')
        if a == 0 or (e < 1) != (a > 0):
            raise wrong("an ellipse has eccentricity < 1 and semi-major axis > 0, a hyperbola > 1 and < 0")
        if 1 + e * cos(self.true_anomaly) <= ROUNDING * e:
            limit = degrees(acos(-1 / e))
            raise wrong(
                f"a hyperbola of eccentricity {e:.10g} has no point at this true_anomaly: it must lie between "
                f"its asymptotes, less than {limit:.8g} deg from periapsis"
            )
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
    def _size(self) -> Self:
        one_of(self, "radius", "altitude", "mean_altitude")
        if self.raan is not None and self.ltan is not None:
            raise wrong("needs raan or ltan, the local time of the ascending node, has both")
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
    planet: PLANET | None = None
    semi_major_axis: Annotated[Length, POSITIVE] | None = None
    eccentricity: Annotated[float, Field(ge=0, lt=1)] | None = None
    elevation: Annotated[Angle, QUARTER_TURN]
    radius_ratio: Annotated[float, POSITIVE] = 1.0
    true_anomaly: Angle = 0.0

    @model_validator(mode="after")
    def _which(self) -> Self:
        one_of(self, "planet", "semi_major_axis+eccentricity")
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
    | SpiralStart
    | KnownStarts,
    Field(discriminator="kind"),
]
