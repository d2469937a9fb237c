"""Numbers and choices in words."""

from __future__ import annotations

import math
from collections.abc import Iterable
from difflib import get_close_matches

from sailviz.constants import AU, DAY, YEAR

LONGEST_WORD = 200  # letters; nothing that a scene may say is longer, and the search takes time with the square


def length(value: float) -> str:
    """A length in m in the unit a reader expects."""
    if abs(value) >= 0.01 * AU:
        return f"{value / AU:.6g} au"
    if abs(value) >= 1e3:
        return f"{value / 1e3:,.6g} km"
    return f"{value:.6g} m" if abs(value) >= 0.1 else f"{value * 1e3:.6g} mm"


def duration(value: float) -> str:
    """A time in s in years, days, hours, minutes or seconds."""
    for size, word in ((YEAR, "yr"), (DAY, "d"), (3600.0, "h"), (60.0, "min")):
        if abs(value) >= size * 0.999_999:
            return f"{value / size:.6g} {word}"
    return f"{value:.6g} s"


def angle(value: float) -> str:
    """An angle in rad in degrees."""
    return f"{math.degrees(value):.6g}°"


def acceleration(value: float) -> str:
    """An acceleration in m/s2 in mm/s2, or um/s2 when small."""
    return f"{value * 1e3:.5g} mm/s²" if abs(value) >= 1e-5 else f"{value * 1e6:.5g} µm/s²"


SI = {  # endings of the names of columns; the longest that fits counts
    "_m": "m",
    "_m2": "m²",
    "_m_s": "m/s",
    "_m_s2": "m/s²",
    "_s": "s",
    "_rad": "rad",
    "_rad_s": "rad/s",
    "_kg": "kg",
    "_kg_m3": "kg/m³",
    "_m3": "1/m³",
    "_u": "u",
    "_Pa": "Pa",
    "_N": "N",
    "_N_m": "N/m",
    "_V": "V",
    "_A": "A",
    "_W": "W",
    "_W_m2": "W/m²",
    "_K": "K",
    "_eV": "eV",
    "_T": "T",
    "_sfu": "sfu",
    "_m3_s2": "m³/s²",
}


def unit_of(column: str) -> str:
    """The unit that the name of a column ends in: "position_m" -> m; "" for a column without one."""
    return SI.get(max((ending for ending in SI if column.endswith(ending)), key=len, default=""), "")


def nearest(word: str, words: Iterable[str]) -> str:
    """ "Did you mean ...?" or the list of what is allowed."""
    words = list(words)
    low = {w.lower(): w for w in words}
    close = get_close_matches(str(word).lower(), low, n=1, cutoff=0.6) if len(str(word)) <= LONGEST_WORD else []
    if close:
        return f'Did you mean "{shortened(low[close[0]])}"?'
    return f"Allowed: {', '.join(shortened(w) for w in words)}." if len(words) <= 24 else ""


def shown(value: object) -> str:
    """A value as a message shows it: text in quotes, nothing longer than a line bears."""
    try:
        text = f'"{_printable(value)}"' if isinstance(value, str) else repr(value)
    except ValueError:  # Python writes no number of more than 4300 digits
        return "a number of thousands of digits"
    return shortened(text)


def shortened(text: str) -> str:
    """Text as long as a message bears it."""
    return text if len(text) <= 60 else text[:57] + "..."


def _printable(text: str) -> str:
    """Text on one line, whatever it is made of."""
    return text if text.isprintable() else repr(text)[1:-1]
