"""Numbers as people say them, in one unit all along a run: dates, distances, pushes, angles."""

from __future__ import annotations

import numpy as np

from sailviz.constants import YEAR

DAY = 86400.0
SHORT = 3 * DAY  # s below which a run is told in hours
LONG = 25 * YEAR  # and above which in years
PUSH_UNITS = ((1e-3, "mm/s²"), (1e-6, "µm/s²"), (1e-9, "nm/s²"))
NAMES, NAME = 40, 6  # letters of all devices' names together, and of each at least, before they are cut
WIDE = 50.0  # factor between the largest and the median push from which each is told in its own unit


def push_unit(most: float) -> tuple[float, str]:
    """The unit, m/s2 and name, in which a largest push is a handy number."""
    return next(((size, name) for size, name in PUSH_UNITS if most >= 0.0995 * size), PUSH_UNITS[-1])


def digits(most: float) -> int:
    """Decimals of a number that reaches so far: three figures in all."""
    return 2 if most < 9.995 else 1 if most < 99.95 else 0


def push_words(push: np.ndarray, word: str = "push", beside: np.ndarray | None = None) -> list[str]:
    """What acts in each row (n,), m/s2: "push 0.40 mm/s²", "no push". beside : (n,) a push in whose unit and decimals
    it is told."""
    whole = push if beside is None else beside
    most, typical = float(whole.max()), float(np.median(whole))
    own = typical > 0 and most > WIDE * typical

    def words(a: float) -> str:
        reference = a if own else most
        return f"{word} {amount(a, *push_unit(reference), most=reference)}" if a > 0 else f"no {word}"

    return [words(a) for a in push.tolist()]


def push_with_shares(push: np.ndarray, shares: dict[str, np.ndarray]) -> list[str]:
    """What acts in each row (n,), m/s2, and in brackets what each device adds to it, in the same unit:
    "push 0.42 mm/s² (solar-sail 0.32, thruster 0.11)". Long names are cut."""
    most = max(float(share.max()) for share in shares.values())
    longest = max(NAME, NAMES // len(shares))
    names = [name if len(name) <= longest else name[: longest - 1] + "…" for name in shares]
    lines = push_words(push)
    for row, line in enumerate(lines):
        usual = push_unit(most)[0]
        size = next((size for size, unit in PUSH_UNITS if line.endswith(unit)), usual)
        each = [float(share[row]) for share in shares.values()]
        decimals = digits((most if size == usual else max(each)) / size)
        told = [f"{value / size:.{decimals}f}" if value > 0 else "off" for value in each]
        if any(each):
            lines[row] = f"{line} ({', '.join(map(' '.join, zip(names, told, strict=True)))})"
    return lines


def amount(value: float, size: float, name: str, most: float) -> str:
    """A number with its unit and as many decimals as the largest one needs."""
    return f"{value / size:.{digits(most / size)}f} {name}"


def clock(duration: float) -> tuple[float, str]:
    """The unit in which a run counts its time: s, and its word."""
    if duration > LONG:
        return YEAR, "Year"
    return (3600.0, "Hour") if duration < SHORT else (DAY, "Day")


def moments(time: np.ndarray, epoch: np.datetime64 | None, span: tuple[float, float] | None = None) -> list[str]:
    """When each row (n,), s, is: "2031-02-25  ·  Day 420 of 765". span : s, begin and end of what is counted, where
    that are not the first and the last row."""
    begin, end = (float(time[0]), float(time[-1])) if span is None else span
    duration = end - begin
    size, word = clock(duration)
    decimals = 1 if duration / size < 20 or word == "Year" else 0
    total = f"{duration / size:.{decimals}f}"
    counted = [f"{word} {(t - begin) / size:.{decimals}f} of {total}" for t in time.tolist()]
    if epoch is None:
        return counted
    stamps = epoch.astype("datetime64[s]") + np.round(time).astype("timedelta64[s]")
    dates = np.datetime_as_string(stamps, unit="m" if word == "Hour" else "D").tolist()
    return [f"{date.replace('T', ' ')} · {text}" for date, text in zip(dates, counted, strict=True)]


def on_day(seconds: float, duration: float) -> str:
    """When something happened: "day 427", "hour 5.3", "year 16.2"."""
    size, word = clock(duration)
    value = seconds / size
    return f"{word.lower()} {value:.0f}" if duration / size >= 20 and word != "Year" else f"{word.lower()} {value:.1f}"


def body_words(name: str) -> str:
    """The Earth, but Mars."""
    return f"the {name}" if name in ("Sun", "Earth", "Moon") else name
