"""Where a scene takes the places of bodies from."""

from typing import Annotated

from pydantic import BeforeValidator

from sailviz.scene.values import wrong
from sailviz.words import nearest, shown

WORDS = ("series", "mean-elements", "de421")


def _name(value: object) -> object:
    """The word or the file's name; the mean elements and the Moon's series go by two names."""
    if not isinstance(value, str) or value in ("mean-elements", "de421"):
        return value
    if value == "series":
        return "mean-elements"
    if value.lower().endswith(".bsp"):
        return value
    raise wrong(f"{shown(value)} is not allowed here. {nearest(value, WORDS)} Or the name of a file that ends in .bsp")


EphemerisName = Annotated[str, BeforeValidator(_name)]
