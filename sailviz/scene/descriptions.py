"""What keys mean, in a sentence each: of the models in device.py they stand in device.toml beside it, [SolarSail] film.

They are apart from the models so that `sailviz check` does not read them. A key that several models inherit is told
once, of the model that declares it; a model may tell an inherited key in its own words. The key "" is the table itself,
where the docstring of the model is not for those who write files.
"""

from __future__ import annotations

import inspect
import tomllib
from functools import cache
from importlib.resources import files

from pydantic import BaseModel


@cache
def told_in(module: str) -> dict[str, dict[str, str]]:
    """Sentences by model and key that stand beside a module, e.g. "sailviz.scene.device"; none where it has no such
    file."""
    package, _, stem = module.rpartition(".")
    try:
        text = (files(package) / f"{stem}.toml").read_text(encoding="utf-8")
    except FileNotFoundError:
        return {}
    return tomllib.loads(text)


def description_of(model: type[BaseModel], key: str) -> str:
    """What a key of a table means, "" where nothing is said."""
    for ancestor in model.__mro__[: model.__mro__.index(BaseModel)]:
        said = told_in(ancestor.__module__).get(ancestor.__name__, {})
        if key in said:
            return said[key]
    return ""


def table_description(model: type[BaseModel]) -> str:
    """What a table is for, on one line."""
    own = told_in(model.__module__).get(model.__name__, {})
    return own.get("", " ".join((inspect.getdoc(model) or "").split()))
