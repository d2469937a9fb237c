"""Messages of the CCSDS in keyword = value form: sections of keywords, with or without units, and lines of data."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import NamedTuple

from sailviz.errors import RecordingError

LONGEST_FILE = 256_000_000  # bytes
_UNIT = re.compile(r"\s*\[([^\]]*)\]\s*$")


class Word(NamedTuple):
    """A keyword's value, unit ("" where none is written) and line."""

    value: str
    unit: str
    line: int


def lines_of(path: str | Path, kind: str) -> list[tuple[int, str]]:
    """(line number, text) of the lines of a message that say something. kind : OPM, AEM ... RecordingError, in one
    sentence, for what is no such message."""
    if Path(path).exists() and not Path(path).is_file():  # a pipe or a device may never end
        raise RecordingError(f"cannot read {path}: it is not a regular file")
    try:
        if Path(path).stat().st_size > LONGEST_FILE:
            raise RecordingError(f"{path} is too large for an {kind}")
        text = Path(path).read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise RecordingError(f"{path} is not an {kind}: it is not text") from None
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise RecordingError(f"cannot read {path}: {why.lower()}") from None
    stripped = [(number, line.strip()) for number, line in enumerate(text.splitlines(), 1)]
    said = [item for item in stripped if item[1] and not re.match(r"COMMENT(\s|$)", item[1], re.IGNORECASE)]
    first = said[0][1] if said else ""
    if first.startswith("<"):
        raise RecordingError(f"{path} is an {kind} in XML; only the keyword = value form is read here")
    if not first.upper().startswith(f"CCSDS_{kind}_VERS"):
        raise RecordingError(f"{path} is not an {kind}: it does not begin with CCSDS_{kind}_VERS")
    return said


def is_message(path: str | Path, kind: str) -> bool:
    """Whether a file begins as such a message."""
    try:
        lines_of(path, kind)
    except RecordingError:
        return False
    return True


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
    return value


def needed(words: dict[str, Word], keys: tuple[str, ...], path: str | Path) -> None:
    """RecordingError where keywords lack, naming all."""
    lacking = [key for key in keys if key not in words or not words[key].value]
    if lacking:
        raise RecordingError(f"{path} has no {', '.join(lacking)}")
