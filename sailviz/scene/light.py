"""What shines on a sail, how bright it is, and where it stands: [light]."""

from math import hypot
from typing import Annotated, Literal, Self

from pydantic import model_validator

from sailviz.constants import SPEED_OF_LIGHT
from sailviz.scene.values import POSITIVE, Angle, Irradiance, Length, Mu, Pressure, Section, Three, Time, wrong

LightKind = Literal["ephemeris", "centre", "circular", "fixed"]
BELONGS = {"longitude": "circular", "obliquity": "circular", "period": "circular", "direction": "fixed"}


class Light(Section):
    """Where the light is and how bright: the Sun by its ephemeris, whatever is at the centre, a light that circles
    evenly, or one in a fixed direction. Its brightness, which makes a characteristic acceleration of area and mass, is
    the pressure of its light on a black surface facing it, or its irradiance, which over the speed of light is that
    pressure; both 1 au away. distance : of a circling or fixed light from the centre; of any other the distance at
    which pressure or irradiance hold, if not 1 au. mu, radius : of a light that is not the Sun."""

    kind: LightKind | None = None
    pressure: Annotated[Pressure, POSITIVE] | None = None
    irradiance: Annotated[Irradiance, POSITIVE] | None = None
    distance: Annotated[Length, POSITIVE] | None = None
    longitude: Angle | None = None
    obliquity: Angle | None = None
    period: Annotated[Time, POSITIVE] | None = None
    direction: Annotated[list[float], Three] | None = None
    mu: Annotated[Mu, POSITIVE] | None = None
    radius: Annotated[Length, POSITIVE] | None = None

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.pressure is not None and self.irradiance is not None:
            raise wrong("needs exactly one of pressure or irradiance, has pressure and irradiance")
        if self.kind is None and self.pressure is None and self.irradiance is None:
            raise wrong("needs a kind, a pressure or an irradiance")
        for name, kind in BELONGS.items():
            if getattr(self, name) is not None and self.kind != kind:
                raise wrong(f'{name} belongs to kind = "{kind}" and to no other')
        if self.kind == "fixed" and (self.direction is None or self.distance is None):
            raise wrong('kind = "fixed" needs direction, from the central body to the light, and distance')
        if self.direction is not None and not 1e-100 < hypot(*self.direction) < 1e100:
            raise wrong("direction must be a vector of moderate length that is not zero")
        told = self.pressure is not None or self.irradiance is not None
        if self.distance is not None and self.kind not in ("circular", "fixed") and not told:
            raise wrong("distance is where pressure or irradiance hold: give one of them")
        return self

    @property
    def bright(self) -> bool:
        """Whether it says how bright it is."""
        return self.pressure is not None or self.irradiance is not None

    @property
    def radiation_pressure(self) -> float | None:
        """N/m2 at `reference_distance`, None where it is not said."""
        if self.pressure is not None:
            return self.pressure
        return None if self.irradiance is None else self.irradiance / SPEED_OF_LIGHT

    @property
    def reference_distance(self) -> float | None:
        """m from the light at which the pressure holds; None for 1 au."""
        return None if self.kind in ("circular", "fixed") else self.distance
