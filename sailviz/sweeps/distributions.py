"""What a key of a scene takes in a sweep: listed values or draws from a distribution, and how a person writes them.

0.5:1.5:11          eleven values from 0.5 to 1.5, ends included     0.1:10:21:log   the same, even in the logarithm
20,25,40            these values, numbers or words
normal(1, 0.05)     drawn; also uniform(low, high), lognormal(median, sigma of the logarithm), gamma(shape, scale)
seed                the flight's own seed, a whole number below 2^32: for keys such as environment.solar_wind.seed
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from sailviz.scene.draws import Draw, drawn

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
