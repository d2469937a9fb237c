"""Modules that a library names when it is imported, loaded only when one of their names is first used.

Of the time that `import trimesh` takes, nine tenths go into what none of our shapes need: convex hulls, minimizers,
searches for neighbours and sparse matrices of scipy, graphs, readers of XML. They cost more than a whole flight.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType
from typing import Any


class Deferred:
    """Stands for one name of a module until it is used."""

    def __init__(self, module: str, name: str, library: str):
        self.source = module, name, library

    def _real(self) -> Any:
        module, name, library = self.source
        load(module, library)
        return _named(import_module(module), name)

    def __call__(self, *values: Any, **options: Any) -> Any:
        return self._real()(*values, **options)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._real(), name)

    def __instancecheck__(self, instance: object) -> bool:
        return isinstance(instance, self._real())


class DeferredModule(ModuleType):
    """Stands for a module while a library is imported, and in that library until one of its names is used."""

    def __init__(self, module: str, library: str):
        super().__init__(module)
        self._library = library

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return Deferred(self.__name__, name, self._library)


@contextmanager
def deferred(library: str, *modules: str) -> Iterator[None]:
    """Inside this context a library is imported that names `modules`; those not yet loaded are not loaded by it.

    They are loaded when the library first uses one of their names. Nobody else ever sees what stands for them, save a
    thread that imports one of them at that very moment. Of what is not installed the library is told so at once.
    """
    waiting = [module for module in modules if module not in sys.modules and find_spec(module.partition(".")[0])]
    for module in waiting:
        sys.modules[module] = DeferredModule(module, library)
    try:
        yield
    finally:
        for module in waiting:
            if isinstance(sys.modules.get(module), DeferredModule):
                del sys.modules[module]


def load(module: str, library: str) -> None:
    """Import a module and put its names where the library holds what stands for them."""
    real = import_module(module)
    for name, part in list(sys.modules.items()):
        if name != library and not name.startswith(f"{library}."):
            continue
        for key, value in list(vars(part).items()):
            if isinstance(value, DeferredModule) and value.__name__ == module:
                setattr(part, key, real)
            elif type(value) is Deferred and value.source[0] == module:
                setattr(part, key, _named(real, value.source[1]))


def _named(module: ModuleType, name: str) -> Any:
    """What `from module import name` gives: a name of the module, or a module below it that is not loaded yet."""
    try:
        return getattr(module, name)
    except AttributeError:
        return import_module(f"{module.__name__}.{name}")
