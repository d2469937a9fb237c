"""What a key of a scene takes in a sweep: listed values or draws from a distribution, and how a person writes them.

0.5:1.5:11          eleven values from 0.5 to 1.5, ends included     0.1:10:21:log   the same, even in the logarithm
20,25,40            these values, numbers or words
normal(1, 0.05)     drawn; also uniform(low, high), lognormal(median, sigma of the logarithm), gamma(shape, scale)
seed                the flight's own seed, a whole number below 2^32: for keys such as environment.solar_wind.seed
"""

from __future__ import annotations

import hashlib
import re
import tomllib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from sailviz.words import nearest

MOST_VALUES = 10_000_000  # unless limits.flights of the scene says otherwise
BYTES_PER_FLIGHT = 100  # of a table, about; more with many columns


@dataclass(frozen=True)
class Axis:
    """Listed values of a key."""

    key: str
    values: tuple[Any, ...]

    def words(self) -> list[Any]:
        """What the definition of a sweep keeps of it."""
        return list(self.values)


@dataclass(frozen=True)
class _Distribution:
    parameters: tuple[str, ...]
    fault: Callable[..., str]  # of the parameters, "" if they will do
    draw: Callable[..., float]
    centre: Callable[..., float]


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
        lambda rng, median, sigma: median * np.exp(sigma * rng.standard_normal()),
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
        """The value of one flight: known from the sweep's seed, the key, the place on the grid and the draw's number
        alone, so that neither workers nor order nor the other keys of the sweep change it."""
        if self.distribution == "seed":
            return flight_seed(seed, cell, draw)
        own = int.from_bytes(hashlib.sha256(self.key.encode()).digest()[:8], "little")
        rng = np.random.default_rng([seed, own, cell, draw])
        return float(_DISTRIBUTIONS[self.distribution].draw(rng, *self.parameters))

    def words(self) -> str:
        """What the definition of a sweep keeps of it."""
        numbers = ", ".join(f"{number:.17g}" for number in self.parameters)
        return f"{self.distribution}({numbers})" if self.parameters else self.distribution


def flight_seed(seed: int, cell: int, draw: int) -> int:
    """A flight's own seed, below 2^32."""
    return int(np.random.SeedSequence([seed, cell, draw]).generate_state(1)[0])


def axis(key: str, low: float, high: float, count: float, spacing: str = "linear", most: int = MOST_VALUES) -> Axis:
    """Values from low to high, both included; whole numbers where all of them are. most : values that are allowed.
    ValueError says what is wrong."""
    if isinstance(count, bool) or not 1 <= count < np.inf or count != int(count):
        raise ValueError(f"a range has a whole number of values, 1 or more, not {count!r}.")
    if count > most:
        raise ValueError(too_many(count, "values", most))
    if not np.isfinite([low, high]).all():
        raise ValueError("a range goes from one finite number to another.")
    if spacing == "log":
        if low <= 0 or high <= 0:
            raise ValueError("a range even in the logarithm has ends above 0.")
        values = np.geomspace(low, high, int(count))
    else:
        values = np.linspace(low, high, int(count))
    values = values.tolist()
    whole = isinstance(low, int) and isinstance(high, int) and all(value == int(value) for value in values)
    return Axis(key, tuple(int(value) for value in values) if whole else tuple(values))


def too_many(asked: float, what: str, most: int) -> str:
    """That a sweep asks for more than its limit, with what the table would weigh."""
    size = asked * BYTES_PER_FLIGHT / 1e9
    return (
        f"asks for {asked:,.0f} {what} (a table of some {size:,.3g} GB), more than the {most:,} that limits.flights of "
        "the scene allows."
    )


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
    if len(parameters) != len(distribution.parameters) or not np.isfinite(parameters).all():
        raise ValueError(f'"{text.strip()}": needs {len(distribution.parameters)} finite numbers, {usage}.')
    if fault := distribution.fault(*parameters):
        raise ValueError(f'"{text.strip()}": {fault}.')
    return Draw(key, found[1], parameters)


def varied(key: str, wanted: Any, most: int = MOST_VALUES) -> Axis | Draw:
    """What a key takes, from text as above or from values. most : values that are allowed. ValueError says what is
    wrong."""
    if isinstance(wanted, str):
        return _from_text(key, wanted, most)
    if isinstance(wanted, np.ndarray):
        wanted = wanted.tolist()
    values = wanted if isinstance(wanted, (list, tuple, range)) else [wanted]
    values = tuple(value.item() if isinstance(value, np.generic) else value for value in values)
    if not values:
        raise ValueError("has no values.")
    return Axis(key, values)


def _from_text(key: str, text: str, most: int) -> Axis | Draw:
    if text.strip() == "seed" or re.fullmatch(r"\s*[A-Za-z]\w*\s*\(.*\)\s*", text):
        return drawn(key, text)
    ends = text.split(":")
    if len(ends) > 1 and (numbers := _numbers(ends[:3])):
        spacing = ends[3].strip() if len(ends) == 4 else "linear"
        if len(numbers) < 3 or len(ends) > 4 or spacing not in ("linear", "log"):
            raise ValueError(f'"{text}": a range is LOW:HIGH:COUNT or LOW:HIGH:COUNT:log.')
        low, high, count = numbers
        return axis(key, low, high, count, spacing, most)
    if not text.strip():
        raise ValueError("has no values.")
    try:
        return varied(key, tomllib.loads(f"values = [{text}]")["values"])
    except tomllib.TOMLDecodeError:
        return varied(key, [_plain(word.strip()) for word in text.split(",")])


def _numbers(words: Iterable[str]) -> list[int | float] | None:
    """The numbers that words are, None if one is not (but a time of day, say)."""
    found: list[int | float] = []
    for word in words:
        try:
            found.append(int(word) if word.strip().lstrip("+-").isdecimal() else float(word))
        except ValueError:
            return None
    return found


def _plain(word: str) -> Any:
    """A TOML value, or the word itself."""
    try:
        return tomllib.loads(f"value = {word}")["value"]
    except tomllib.TOMLDecodeError:
        return word
