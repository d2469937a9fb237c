"""Numbers on the command line: finite, within limits, refused in a sentence."""

from __future__ import annotations

import math
from typing import Any

import click


class Number(click.ParamType):
    """A finite number, above or from `low`, up to `high`. unit : for the sentence."""

    name = "number"

    def __init__(self, low: float = -math.inf, high: float = math.inf, unit: str = "", above: bool = False):
        self._low, self._high, self._unit, self._above = low, high, unit, above

    def convert(self, value: Any, parameter: click.Parameter | None, context: click.Context | None) -> float:
        """The number, or a failure that says what is allowed."""
        try:
            number = float(value)
        except ValueError:
            number = math.nan
        inside = self._low < number if self._above else self._low <= number
        if not (math.isfinite(number) and inside and number <= self._high):
            self.fail(f"{value!r} is not {self._words()}.", parameter, context)
        return number

    def _words(self) -> str:
        words = "a finite number" + (f" of {self._unit}" if self._unit else "")
        limits = []
        if math.isfinite(self._low):
            limits.append(f"{'above' if self._above else 'of at least'} {self._low:g}")
        if math.isfinite(self._high):
            limits.append(f"up to {self._high:g}")
        return " ".join([words, *limits]) if len(limits) < 2 else f"{words} {limits[0]} and {limits[1]}"


PORT = click.IntRange(0, 65535)
