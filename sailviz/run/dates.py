"""Times and epochs of arrays, whatever kind they come in: one gate, on the grammar of sailviz/calendar.py."""

from __future__ import annotations

from datetime import UTC, date, datetime, timedelta

import numpy as np

from sailviz.calendar import (
    DAY,
    LEAP_SECONDS,
    LONGEST,
    OUT_OF_REACH,
    UNIX,
    DateError,
    ahead_of_tai,
    in_reach,
    label,
    since_1970,
)


def utc_of(instant: int) -> np.datetime64:
    """UTC label, datetime64[ns], of an instant in nanoseconds of TAI. The second 60, which datetime64 cannot hold,
    reads as the first second of the day that follows."""
    for year, month, offset in reversed(LEAP_SECONDS):
        ns = instant - offset * 10**9
        if ns >= since_1970(date(year, month, 1), 0) - 10**9:
            start = since_1970(date(year, month, 1), 0)
            return np.datetime64(ns if ns >= start else ns + 10**9, "ns")
    raise DateError("this instant is before 1972, from when on UTC has whole leap seconds")


def utc_texts(instants: np.ndarray) -> list[str]:
    """UTC labels with nine decimals of instants (n,), ns of TAI; within a leap second they read 23:59:60."""
    ends = np.array([since_1970(date(year, month, 1), (offset - 1) * 10**9) for year, month, offset in LEAP_SECONDS])
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
    return np.datetime64(instant - ahead_of_tai(UNIX, system), "ns")


def instant_of(epoch: np.datetime64, system: str = "UTC") -> int:
    """Nanoseconds of TAI of a datetime64 label in a time system."""
    ns = int(epoch.astype("datetime64[ns]").astype(np.int64))
    return ns + ahead_of_tai(UNIX + timedelta(days=ns // DAY), system)


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
        if ns >= DAY:
            raise DateError(f"{value.strip()!r}: an epoch cannot stand in a leap second")
        return np.datetime64(since_1970(day, ns), "ns")
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
    """An array, masks resolved. DateError where a row is masked: what lies under a mask is not data; or where rows have
    different lengths."""
    if isinstance(values, np.ma.MaskedArray):
        mask = np.ma.getmaskarray(values)
        if mask.any():
            raise DateError(f"row {np.argwhere(mask)[0][0]} is masked")
        return np.asarray(values.data)
    try:
        return np.asarray(values)
    except (TypeError, ValueError):  # rows of different lengths
        raise DateError("is not an array of numbers") from None


def numbers(values: object) -> np.ndarray:
    """float64 of an array of real numbers. DateError for complex numbers, text, truth values that are none of them."""
    found = unmasked(values)
    if found.dtype.kind == "c":
        raise DateError("holds complex numbers")
    if found.dtype.kind in "USmM":
        raise DateError("is not an array of numbers")
    try:
        return np.array(found, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise DateError("is not an array of numbers") from None
