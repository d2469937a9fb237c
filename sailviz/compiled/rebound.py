"""The same compiled functions once more, over other names: an integrator at another size of its state.

A compiled function reads the names of its module when it is compiled. `rebound` makes each anew with some of them
changed, and lets them call one another: so an algorithm stands in one place and is compiled for each size as if it had
been written for it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from types import FunctionType
from typing import Any

Made = Callable[[Callable[..., Any]], Any]


def rebound(functions: Iterable[tuple[Made, Any]], name: str, changes: dict[str, Any]) -> dict[str, Any]:
    """The functions by name, all seeing each other and the changes.

    functions : (`inlined`, `called` or `plain`, a compiled function) of each; name : of the module that they are made
    for; changes : names that stand for something else.
    """
    spaces: dict[str, dict[str, Any]] = {}

    def copy(function: Any) -> Callable[..., Any]:
        of = function.py_func
        space = spaces.setdefault(of.__module__, {**of.__globals__, **changes, "__name__": name})
        return FunctionType(of.__code__, space, of.__name__, of.__defaults__)

    made: dict[str, Any] = {function.py_func.__name__: make(copy(function)) for make, function in functions}
    for space in spaces.values():
        space.update({word: one for word, one in made.items() if word not in changes})
    return made


def plain(function: Callable[..., Any]) -> Callable[..., Any]:
    """For what is to be made an entry again."""
    return function
