"""Keywords of the lines of messages (ndm.py), with or without units, and their numbers."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import NamedTuple

from sailviz.errors import RecordingError

LARGEST = 1e25  # in the units of messages: a place in km would lie beyond everything
_UNIT = re.compile(r"\s*\[([^\]]*)\]\s*$")


class Word(NamedTuple):
    """A keyword's value, unit ("" where none is written) and line."""

    value: str
    unit: str
    line: int


def keyword(text: str, number: int, path: str | Path) -> tuple[str, Word]:
    """One line -> (keyword in capitals, what it says)."""
    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        raise RecordingError(f"{path}, line {number}: KEYWORD = value was due, not {text[:80]!r}")
    unit = _UNIT.search(value)
    return key.strip().upper(), Word(_UNIT.sub("", value).strip(), unit.group(1).strip() if unit else "", number)


def number(word: Word, key: str, unit: str, path: str | Path) -> float:
    """The number that a keyword has, in its one unit. RecordingError for no finite number or another unit."""
    if word.unit and word.unit.lower().replace(" ", "") != unit.lower():
        raise RecordingError(f"{path}, line {word.line}: {key} is in [{word.unit}], and [{unit}] is due")
    return finite(word.value, f"{key}", word.line, path)


def finite(text: str, what: str, line: int, path: str | Path) -> float:
    """A finite number."""
    try:
        value = float(text) if "_" not in text else math.nan
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise RecordingError(f"{path}, line {line}: {what} is no finite number: {text[:40]!r}")
    if abs(value) > LARGEST:
        raise RecordingError(f"{path}, line {line}: {what} is out of all bounds: {text[:40]!r}")
    return value


def needed(words: dict[str, Word], keys: tuple[str, ...], path: str | Path) -> None:
    """RecordingError where keywords lack, naming all."""
    lacking = [key for key in keys if key not in words or not words[key].value]
    if lacking:
        raise RecordingError(f"{path} has no {', '.join(lacking)}")
