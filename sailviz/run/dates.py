"""Dates and times as people give them: one gate for messages, arrays and epochs.

Inside, an instant is a whole number of nanoseconds of TAI since 1970-01-01T00:00:00 TAI, so that differences are
physical seconds; a UTC label becomes one with the leap seconds below, and is made from one again.
Sources: IERS Bulletin C (leap seconds), CCSDS 502.0-B-3 annex A (what a time system is called).
"""

from __future__ import annotations

import re
from bisect import bisect_right
from datetime import UTC, date, datetime, timedelta

import numpy as np

FIRST_YEAR, LAST_YEAR = 1678, 2262  # what 64 bits of nanoseconds reach, 1677-09-21 to 2262-04-11
OUT_OF_REACH = f"lies outside the years {FIRST_YEAR} to {LAST_YEAR} that a recording's clock reaches"
_EARLIEST, _LATEST = datetime(1677, 9, 21, 0, 12, 44), datetime(2262, 4, 11, 23, 47, 16)
LONGEST = 2**63 / 1e9  # s, what 64 bits of nanoseconds reach
_UNIX = date(1970, 1, 1)
_DAY = 86_400 * 10**9  # ns

# (year, month, TAI - UTC in s from its first day on)
LEAP_SECONDS = (
    (1972, 1, 10), (1972, 7, 11), (1973, 1, 12), (1974, 1, 13), (1975, 1, 14), (1976, 1, 15), (1977, 1, 16),
    (1978, 1, 17), (1979, 1, 18), (1980, 1, 19), (1981, 7, 20), (1982, 7, 21), (1983, 7, 22), (1985, 7, 23),
    (1988, 1, 24), (1990, 1, 25), (1991, 1, 26), (1992, 7, 27), (1993, 7, 28), (1994, 7, 29), (1996, 1, 30),
    (1997, 7, 31), (1999, 1, 32), (2006, 1, 33), (2009, 1, 34), (2012, 7, 35), (2015, 7, 36), (2017, 1, 37),
)  # fmt: skip
_STEPS = [date(year, month, 1) for year, month, _ in LEAP_SECONDS]

# ns of TAI ahead of a uniform time system. TDB counts as TT, from which it never differs by more than 1.7 ms.
AHEAD = {"TAI": 0, "GPS": 19 * 10**9, "TT": -32_184_000_000, "TDB": -32_184_000_000}
SYSTEMS = ("UTC", *AHEAD)

_ISO = re.compile(
    r"(?P<year>\d{4})-(?:(?P<month>\d\d)-(?P<day>\d\d)|(?P<ordinal>\d{3}))"
    r"(?:[T ](?P<hour>\d\d):(?P<minute>\d\d)(?::(?P<second>\d\d)(?:\.(?P<fraction>\d*))?)?)?"
    r"(?P<zone>Z|[+-]\d\d:?\d\d)?"
)


class DateError(ValueError):
    """A date or time that cannot be taken, in one sentence without a full stop."""


def leap_seconds(day: date) -> int:
    """TAI - UTC on a day, s. DateError before 1972, when UTC ran at another rate."""
    step = bisect_right(_STEPS, day)
    if step == 0:
        raise DateError(f"{day} is before 1972, from when on UTC has whole leap seconds")
    return LEAP_SECONDS[step - 1][2]


def has_leap_second(day: date) -> bool:
    """Whether a day of UTC ends with a second 60."""
    return day + timedelta(days=1) in _STEPS[1:]


def label(text: str) -> tuple[date, int]:
    """(day, nanoseconds into it) of a calendar (2031-04-01T12:00:00.5) or ordinal (2031-091T12:00) date.

    Digits beyond the nanosecond are rounded; a second 60 gives a minute's 60 seconds; an offset such as +02:00 is taken
    off. DateError for what is no date.
    """
    found = _ISO.fullmatch(text.strip())
    if not found:
        raise DateError(f"{text!r} is no date; wanted one like 2031-04-01T12:00:00")
    try:
        day = _day_of(found)
    except ValueError:
        raise DateError(f"{text.strip()!r}: there is no such day") from None
    hour, minute, second = (int(found[part] or 0) for part in ("hour", "minute", "second"))
    if hour > 23 or minute > 59 or second > 60:
        raise DateError(f"{text!r}: there is no time {hour:02}:{minute:02}:{second:02}")
    if second == 60 and (hour, minute) != (23, 59) and found["zone"] in (None, "Z"):
        raise DateError(f"{text!r}: a second 60 stands at the end of a day only")
    digits = (found["fraction"] or "").ljust(10, "0")
    ns = (int(digits[:10]) + 5) // 10  # the tenth digit rounds
    ns += ((hour * 60 + minute) * 60 + second) * 10**9
    if found["zone"] not in (None, "Z"):
        sign = 1 if found["zone"][0] == "-" else -1
        hours, minutes = int(found["zone"][1:3]), int(found["zone"][-2:])
        ns += sign * (hours * 60 + minutes) * 60 * 10**9
        return day + timedelta(days=ns // _DAY), ns % _DAY
    return day, ns


def _day_of(found: re.Match[str]) -> date:
    year = int(found["year"])
    if found["ordinal"] is None:
        return date(year, int(found["month"]), int(found["day"]))
    number = int(found["ordinal"])
    if not 1 <= number <= (date(year + 1, 1, 1) - date(year, 1, 1)).days:
        raise ValueError
    return date(year, 1, 1) + timedelta(days=number - 1)


def in_reach(day: date, what: str = "") -> None:
    """DateError for a day that nanoseconds in 64 bits do not reach."""
    if not _EARLIEST.date() < day < _LATEST.date():
        raise DateError(f"{what or day} {OUT_OF_REACH}")


def tai(text: str, system: str) -> int:
    """Nanoseconds of TAI since 1970 of a date in a time system of SYSTEMS. DateError for another system, for a second
    60 where UTC has none, and for a year out of reach."""
    day, ns = label(text)
    in_reach(day, repr(text.strip()))
    if ns >= _DAY and not (system == "UTC" and has_leap_second(day)):
        raise DateError(f"{text.strip()!r}: no leap second was added to {system} at the end of that day")
    return _since_1970(day, ns) + _ahead(day, system)


def _since_1970(day: date, ns: int) -> int:
    return (day - _UNIX).days * _DAY + ns


def _ahead(day: date, system: str) -> int:
    if system == "UTC":
        return leap_seconds(day) * 10**9
    if system not in AHEAD:
        raise DateError(f"the time system {system} is not known here; known: {', '.join(SYSTEMS)}")
    return AHEAD[system]


def utc_of(instant: int) -> np.datetime64:
    """UTC label, datetime64[ns], of an instant in nanoseconds of TAI. The second 60, which datetime64 cannot hold,
    reads as the first second of the day that follows."""
    for year, month, offset in reversed(LEAP_SECONDS):
        ns = instant - offset * 10**9
        if ns >= _since_1970(date(year, month, 1), 0) - 10**9:
            start = _since_1970(date(year, month, 1), 0)
            return np.datetime64(ns if ns >= start else ns + 10**9, "ns")
    raise DateError("this instant is before 1972, from when on UTC has whole leap seconds")


def utc_texts(instants: np.ndarray) -> list[str]:
    """UTC labels with nine decimals of instants (n,), ns of TAI; within a leap second they read 23:59:60."""
    ends = np.array([_since_1970(date(year, month, 1), (offset - 1) * 10**9) for year, month, offset in LEAP_SECONDS])
    step = np.searchsorted(ends, instants, side="right") - 1  # ends: where the second before each new offset begins
    if instants.min() < ends[0]:
        raise DateError("before 1972 UTC had no whole leap seconds")
    ahead = np.array([offset for _, _, offset in LEAP_SECONDS], np.int64)[step] * 10**9
    inside = instants < ends[step] + 10**9  # within the leap second itself
    ns = instants - ahead
    texts: list[str] = np.datetime_as_string(ns.astype("datetime64[ns]"), unit="ns").tolist()
    for row in np.flatnonzero(inside & (step > 0)):
        texts[row] = texts[row][:17] + "60" + texts[row][19:]
    return texts


def label_of(instant: int, system: str) -> np.datetime64:
    """datetime64[ns] label of an instant, ns of TAI, in a time system."""
    if system == "UTC":
        return utc_of(instant)
    return np.datetime64(instant - _ahead(_UNIX, system), "ns")


def instant_of(epoch: np.datetime64, system: str = "UTC") -> int:
    """Nanoseconds of TAI of a datetime64 label in a time system."""
    ns = int(epoch.astype("datetime64[ns]").astype(np.int64))
    return ns + _ahead(_UNIX + timedelta(days=ns // _DAY), system)


def epoch_of(value: object) -> np.datetime64 | None:
    """A date as a person gives it -> datetime64[ns] of UTC; None stays None.

    value : datetime64, datetime (with a time zone it is turned to UTC), date, or text like 2031-04-01T12:00. DateError
    for numbers, words such as "now", NaT and years out of reach.
    """
    if value is None:
        return None
    if isinstance(value, np.datetime64):
        return _from_datetime64(value)
    if isinstance(value, datetime):
        value = value.astimezone(UTC).replace(tzinfo=None) if value.tzinfo else value
        in_reach(value.date())
        return np.datetime64(value, "ns")
    if isinstance(value, date):
        in_reach(value)
        return np.datetime64(value, "ns")
    if isinstance(value, str):
        day, ns = label(value)
        in_reach(day, repr(value.strip()))
        if ns >= _DAY:
            raise DateError(f"{value.strip()!r}: an epoch cannot stand in a leap second")
        return np.datetime64(_since_1970(day, ns), "ns")
    raise DateError(f"{value!r} is no date; wanted a datetime64, a datetime or text like 2031-04-01T12:00")


def _from_datetime64(value: np.datetime64) -> np.datetime64:
    if np.isnat(value):
        raise DateError("is not a time (NaT)")
    coarse = value.astype("datetime64[D]").astype(object)  # a date, or a number where Python's calendar ends
    if not isinstance(coarse, date):
        raise DateError(f"{value} {OUT_OF_REACH}")
    in_reach(coarse)
    in_ns: np.datetime64 = value.astype("datetime64[ns]")
    return in_ns


def span_in_reach(first: float, last: float, epoch: np.datetime64 | None) -> None:
    """DateError for times, s after the epoch if there is one, that a recording's clock does not reach."""
    if max(abs(first), abs(last)) > LONGEST:
        raise DateError(f"{max(abs(first), abs(last)):.4g} s is beyond the 292 years that a recording's clock reaches")
    if epoch is not None:
        for edge in (first, last):
            epoch_of(epoch.astype("datetime64[us]") + np.timedelta64(round(edge * 1e6), "us"))


def seconds_of(values: object, epoch: np.datetime64 | None = None) -> tuple[np.ndarray, np.datetime64 | None]:
    """(times (n,) s, epoch) of an array of times.

    values : numbers, s; timedelta64 of any unit; datetime64 of any unit, counted from the epoch or, without one, from
    the first, which then is the epoch. DateError for masked rows, NaT, complex numbers, and anything else.
    """
    found = unmasked(values)
    if found.dtype.kind == "O" and found.size and all(isinstance(item, datetime) for item in found.flat):
        found = np.array([epoch_of(item) for item in found.flat], "datetime64[ns]").reshape(found.shape)
    if found.dtype.kind in "mM":
        lost = np.flatnonzero(np.isnat(found.ravel()))
        if len(lost):
            raise DateError(f"row {lost[0]} is not a time (NaT)")
        if found.dtype == np.dtype("m8") or found.dtype == np.dtype("M8"):
            raise DateError("has no unit; wanted seconds, or timedelta64 or datetime64 with a unit")
    if found.dtype.kind == "M":
        first = epoch if epoch is not None else epoch_of(found.ravel()[0]) if found.size else None
        for edge in (found.min(), found.max()) if found.size else ():
            epoch_of(edge)
        return (found.astype("datetime64[ns]") - first) / np.timedelta64(1, "s"), first
    if found.dtype.kind == "m":
        if np.datetime_data(found.dtype)[0] in ("Y", "M"):
            raise DateError("months and years have no fixed length: give days or seconds")
        return found / np.timedelta64(1, "s"), epoch
    return numbers(found), epoch


def unmasked(values: object) -> np.ndarray:
    """An array, masks resolved. DateError where a row is masked: what lies under a mask is not data."""
    if isinstance(values, np.ma.MaskedArray):
        mask = np.ma.getmaskarray(values)
        if mask.any():
            raise DateError(f"row {np.argwhere(mask)[0][0]} is masked")
        return np.asarray(values.data)
    return np.asarray(values)


def numbers(values: object) -> np.ndarray:
    """float64 of an array of real numbers. DateError for complex numbers, text, truth values that are none of them."""
    found = unmasked(values)
    if found.dtype.kind == "c":
        raise DateError("holds complex numbers")
    if found.dtype.kind in "USmM":
        raise DateError("is not an array of numbers")
    try:
        return np.array(found, dtype=float)
    except (TypeError, ValueError):
        raise DateError("is not an array of numbers") from None
