"""How far a quantity may be off: what was asked for, or the default."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence

from sailviz.errors import RecordingError

Given = float | Mapping[str, float] | None  # one for all, or by the name of a quantity, a column or an entity


class Tolerances:
    """Tolerances by quantity."""

    def __init__(self, atol: Given, rtol: Given):
        self._atol = self._by_name(atol, "atol")
        self._rtol = self._by_name(rtol, "rtol")
        self._used: set[str] = {""}

    @staticmethod
    def _by_name(given: Given, word: str) -> dict[str, float]:
        if given is None:
            return {}
        named = dict(given) if isinstance(given, Mapping) else {"": given}
        for name, value in named.items():
            if not isinstance(value, int | float) or not value >= 0:
                raise RecordingError(f"{word} {name or 'for all quantities'} must be a number >= 0, not {value!r}")
        return {str(name): float(value) for name, value in named.items()}

    def of(self, entity: str, column: str) -> tuple[float | None, float]:
        """(atol, or None for the default; rtol) of a quantity."""
        return self._find(self._atol, entity, column), self._find(self._rtol, entity, column) or 0.0

    def _find(self, named: dict[str, float], entity: str, column: str) -> float | None:
        for name in (f"{entity}:{column}", column, entity):
            if name in named:
                self._used.add(name)
                return named[name]
        return named.get("")

    def check_used(self, known: Sequence[str]) -> None:
        """Raise RecordingError for a name that no quantity has."""
        for name in [*self._atol, *self._rtol]:
            if name not in self._used:
                near = difflib.get_close_matches(name, known, 1, 0.4)
                hint = f"; did you mean {near[0]}?" if near else ""
                raise RecordingError(f"a tolerance is given for {name}, which neither side has{hint}")
