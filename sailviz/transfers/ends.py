"""What a flight has to come to, other than an orbit: ends and limits as a question states them, in SI."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sailviz.constants import RADIUS_SUN
from sailviz.words import length


@dataclass(frozen=True)
class FlyBy:
    """Past the target, whatever the speed there: past its circle, or, where the question has a date, past itself."""

    @property
    def words(self) -> str:
        return "flown by at any speed"


@dataclass(frozen=True)
class Distance:
    """As far from the Sun as a radius, m, anywhere and at any speed."""

    radius: float

    def __post_init__(self) -> None:
        _positive("a distance", self.radius)

    @property
    def words(self) -> str:
        return f"{length(self.radius)} from the Sun at any speed"


@dataclass(frozen=True)
class Escape:
    """Out of the Sun's hold with a speed left over at infinity, excess_speed in m/s, without further thrust."""

    excess_speed: float = 0.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.excess_speed) and self.excess_speed >= 0):
            raise ValueError(f"an excess speed must be a number of at least 0, got {self.excess_speed!r}")

    @property
    def words(self) -> str:
        return f"escape with an excess speed of {self.excess_speed / 1e3:g} km/s"


@dataclass(frozen=True)
class Arrival:
    """At a distance from the Sun, m, moving across the Sun line at a speed, m/s: at an apsis of some orbit."""

    radius: float
    speed: float

    def __post_init__(self) -> None:
        _positive("a distance", self.radius)
        _positive("a speed", self.speed)

    @property
    def words(self) -> str:
        return f"{length(self.radius)} from the Sun, moving across at {self.speed / 1e3:g} km/s"


End = FlyBy | Distance | Escape | Arrival


@dataclass(frozen=True)
class Bounds:
    """What a flight keeps to on its way: perihelion, the smallest distance from the Sun, m; hottest, the temperature of
    the film, K, to which it turns from the Sun; revolutions about the Sun that it makes, exactly. None: unlimited."""

    perihelion: float | None = None
    hottest: float | None = None
    revolutions: float | None = None

    def __post_init__(self) -> None:
        for name in ("perihelion", "hottest", "revolutions"):
            value = getattr(self, name)
            if value is not None:
                _positive({"hottest": "a temperature"}.get(name, f"a limit of {name}"), value)

    @property
    def any(self) -> bool:
        """Whether there is a limit."""
        return not (self.perihelion is self.hottest is self.revolutions is None)

    @property
    def words(self) -> str:
        """What is kept to, "" where nothing is."""
        said = []
        if self.perihelion is not None:
            said.append(f"not nearer to the Sun than {length(self.perihelion)}")
        if self.hottest is not None:
            said.append(f"the film not above {self.hottest:g} K")
        if self.revolutions is not None:
            said.append(f"in {self.revolutions:g} {'revolution' if self.revolutions == 1 else 'revolutions'}")
        return ", ".join(said)

    def impossible(self, origin: float, target: float | None) -> str:
        """Why no flight from a distance to another, m, can keep to the limits; "" where that is not known."""
        near = self.perihelion
        if target is not None and target < RADIUS_SUN:
            return "the target lies inside the Sun"
        if near is None:
            return ""
        if near > origin:
            return f"the flight begins at {length(origin)}, nearer to the Sun than the limit of {length(near)}"
        if target is not None and near > target:
            return f"the target at {length(target)} is nearer to the Sun than the limit of {length(near)}"
        return ""


NO_BOUNDS = Bounds()


def _positive(what: str, value: float) -> None:
    if not (math.isfinite(value) and value > 0):
        raise ValueError(f"{what} must be a positive number, got {value!r}")
