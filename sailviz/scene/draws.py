"""What a key of a scene is drawn from, and how a person writes it.

normal(1, 0.05)     also uniform(low, high), lognormal(median, sigma of the logarithm), gamma(shape, scale)
seed                the flight's own seed, a whole number below 2^32: for keys such as environment.irradiance.seed

numpy is imported by the first draw, so that a scene is checked without it.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from dataclasses import dataclass
from math import isfinite
from typing import Any

from sailviz.words import nearest


@dataclass(frozen=True)
class _Distribution:
    parameters: tuple[str, ...]
    fault: Callable[..., str]  # of the parameters, "" if they will do
    draw: Callable[..., float]
    centre: Callable[..., float]


def _lognormal(rng: Any, median: float, sigma: float) -> float:
    import numpy as np

    return float(median * np.exp(sigma * rng.standard_normal()))


_DISTRIBUTIONS = {
    "normal": _Distribution(
        ("mean", "deviation"),
        lambda mean, deviation: "" if deviation >= 0 else "its deviation must be at least 0",
        lambda rng, mean, deviation: rng.normal(mean, deviation),
        lambda mean, deviation: mean,
    ),
    "uniform": _Distribution(
        ("low", "high"),
        lambda low, high: "" if low < high else "its low end must lie below its high end",
        lambda rng, low, high: rng.uniform(low, high),
        lambda low, high: (low + high) / 2,
    ),
    "lognormal": _Distribution(
        ("median", "sigma"),
        lambda median, sigma: "" if median > 0 and sigma >= 0 else "needs a median above 0 and a sigma of at least 0",
        _lognormal,
        lambda median, sigma: median,
    ),
    "gamma": _Distribution(
        ("shape", "scale"),
        lambda shape, scale: "" if shape > 0 and scale > 0 else "needs shape and scale above 0",
        lambda rng, shape, scale: rng.gamma(shape, scale),
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

    def value(self, seed: int, cell: int, draw: int) -> float:
        """The value of one flight: known from the seed of all, the key, the place on a grid and the draw's number
        alone, so that neither workers nor order nor the other keys change it."""
        if self.distribution == "seed":
            return flight_seed(seed, cell, draw)
        import numpy as np

        own = int.from_bytes(hashlib.sha256(self.key.encode()).digest()[:8], "little")
        rng = np.random.default_rng([seed, own, cell, draw])
        return float(_DISTRIBUTIONS[self.distribution].draw(rng, *self.parameters))

    def words(self) -> str:
        """As it is written."""
        numbers = ", ".join(f"{number:.17g}" for number in self.parameters)
        return f"{self.distribution}({numbers})" if self.parameters else self.distribution


def flight_seed(seed: int, cell: int, draw: int) -> int:
    """A flight's own seed, below 2^32."""
    import numpy as np

    return int(np.random.SeedSequence([seed, cell, draw]).generate_state(1)[0])


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
