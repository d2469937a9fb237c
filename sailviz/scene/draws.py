"""What a key of a scene is drawn from, and how a person writes it.

normal(1, 0.05)     also uniform(low, high), lognormal(median, sigma of the logarithm), gamma(shape, scale)
seed                the flight's own seed, a whole number below 2^32: for keys such as environment.irradiance.seed
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite

from sailviz.words import nearest


@dataclass(frozen=True)
class _Distribution:
    parameters: tuple[str, ...]
    fault: Callable[..., str]  # of the parameters, "" if they will do
    centre: Callable[..., float]


_DISTRIBUTIONS = {
    "normal": _Distribution(
        ("mean", "deviation"),
        lambda mean, deviation: "" if deviation >= 0 else "its deviation must be at least 0",
        lambda mean, deviation: mean,
    ),
    "uniform": _Distribution(
        ("low", "high"),
        lambda low, high: "" if low < high else "its low end must lie below its high end",
        lambda low, high: (low + high) / 2,
    ),
    "lognormal": _Distribution(
        ("median", "sigma"),
        lambda median, sigma: "" if median > 0 and sigma >= 0 else "needs a median above 0 and a sigma of at least 0",
        lambda median, sigma: median,
    ),
    "gamma": _Distribution(
        ("shape", "scale"),
        lambda shape, scale: "" if shape > 0 and scale > 0 else "needs shape and scale above 0",
        lambda shape, scale: shape * scale,
    ),
}


@dataclass(frozen=True)
class Draw:
    """A key that is drawn anew for every flight. distribution : name, or "seed" for the flight's own seed."""

    key: str
    distribution: str
    parameters: tuple[float, ...] = ()

    def centre(self) -> float:
        """A value in the middle of the distribution."""
        return 0 if self.distribution == "seed" else float(_DISTRIBUTIONS[self.distribution].centre(*self.parameters))

    def words(self) -> str:
        """As it is written."""
        numbers = ", ".join(f"{number:.17g}" for number in self.parameters)
        return f"{self.distribution}({numbers})" if self.parameters else self.distribution


def drawn(key: str, text: str) -> Draw:
    """`normal(1, 0.05)` -> Draw. ValueError says what is wrong."""
    if text.strip() == "seed":
        return Draw(key, "seed")
    found = re.fullmatch(r"\s*(\w+)\s*\(([^()]*)\)\s*", text)
    if not found or found[1] not in _DISTRIBUTIONS:
        hint = nearest(found[1] if found else text, [*_DISTRIBUTIONS, "seed"])
        raise ValueError(f'"{text}" is not a distribution. {hint}')
    distribution = _DISTRIBUTIONS[found[1]]
    usage = f"{found[1]}({', '.join(distribution.parameters)})"
    try:
        parameters = tuple(float(word) for word in found[2].split(","))
    except ValueError:
        raise ValueError(f'"{text.strip()}": write numbers, {usage}.') from None
    if len(parameters) != len(distribution.parameters) or not all(map(isfinite, parameters)):
        raise ValueError(f'"{text.strip()}": needs {len(distribution.parameters)} finite numbers, {usage}.')
    if fault := distribution.fault(*parameters):
        raise ValueError(f'"{text.strip()}": {fault}.')
    return Draw(key, found[1], parameters)
