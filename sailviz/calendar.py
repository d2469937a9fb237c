"""Dates and times as people write them, in plain Python: one grammar for scene files, messages and arrays.

Inside, an instant is a whole number of nanoseconds of TAI since 1970-01-01T00:00:00 TAI, so that differences are
physical seconds; a UTC label becomes one with the leap seconds below. What makes arrays of them stands in run/dates.py.
Sources: IERS Bulletin C (leap seconds), CCSDS 502.0-B-3 annex A (what a time system is called).
"""

from __future__ import annotations

import re
from bisect import bisect_right
from datetime import UTC, date, datetime, timedelta, timezone

from sailviz.words import shown

FIRST_YEAR, LAST_YEAR = 1678, 2262  # what 64 bits of nanoseconds reach, 1677-09-21 to 2262-04-11
OUT_OF_REACH = f"lies outside the years {FIRST_YEAR} to {LAST_YEAR} that a recording's clock reaches"
EARLIEST, LATEST = datetime(1677, 9, 21, 0, 12, 44), datetime(2262, 4, 11, 23, 47, 16)
LONGEST = 2**63 / 1e9  # s, what 64 bits of nanoseconds reach
UNIX = date(1970, 1, 1)
DAY = 86_400 * 10**9  # ns

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
    r"(?P<zone>Z|[+-]\d\d:?\d\d)?",
    re.ASCII,
)
PATTERN = "^\\s*" + re.sub(r"\?P<\w+>", "", _ISO.pattern) + "\\s*$"  # for other readers of the same grammar


class DateError(ValueError):
    """A date or time that cannot be taken, in one sentence without a full stop."""


def _said(value: object) -> str:
    """A value in a message, text in Python's quotes."""
    return (repr(value) if len(value) <= 60 else repr(value[:57] + "...")) if isinstance(value, str) else shown(value)


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
        raise DateError(f"{_said(text)} is no date; wanted one like 2031-04-01T12:00:00")
    try:
        day = _day_of(found)
    except ValueError:
        raise DateError(f"{_said(text.strip())}: there is no such day") from None
    hour, minute, second = (int(found[part] or 0) for part in ("hour", "minute", "second"))
    if hour > 23 or minute > 59 or second > 60:
        raise DateError(f"{_said(text)}: there is no time {hour:02}:{minute:02}:{second:02}")
    if second == 60 and (hour, minute) != (23, 59) and found["zone"] in (None, "Z"):
        raise DateError(f"{_said(text)}: a second 60 stands at the end of a day only")
    digits = (found["fraction"] or "").ljust(10, "0")
    ns = (int(digits[:10]) + 5) // 10  # the tenth digit rounds
    ns += ((hour * 60 + minute) * 60 + second) * 10**9
    if found["zone"] not in (None, "Z"):
        sign = 1 if found["zone"][0] == "-" else -1
        hours, minutes = int(found["zone"][1:3]), int(found["zone"][-2:])
        ns += sign * (hours * 60 + minutes) * 60 * 10**9
        return day + timedelta(days=ns // DAY), ns % DAY
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
    if not EARLIEST.date() < day < LATEST.date():
        raise DateError(f"{what or day} {OUT_OF_REACH}")


def tai(text: str, system: str) -> int:
    """Nanoseconds of TAI since 1970 of a date in a time system of SYSTEMS. DateError for another system, for a second
    60 where UTC has none, and for a year out of reach."""
    day, ns = label(text)
    in_reach(day, repr(text.strip()))
    if ns >= DAY and not (system == "UTC" and has_leap_second(day)):
        raise DateError(f"{_said(text.strip())}: no leap second was added to {system} at the end of that day")
    return since_1970(day, ns) + ahead_of_tai(day, system)


def since_1970(day: date, ns: int) -> int:
    return (day - UNIX).days * DAY + ns


def ahead_of_tai(day: date, system: str) -> int:
    if system == "UTC":
        return leap_seconds(day) * 10**9
    if system not in AHEAD:
        raise DateError(f"the time system {system} is not known here; known: {', '.join(SYSTEMS)}")
    return AHEAD[system]


def moment(value: object) -> date:
    """A date as a person gives it -> what TOML makes of it without quotes: a date, or a datetime with the offset that
    was given, to the microsecond.

    value : datetime, date, datetime64, or text like 2031-04-01, 2031-091T12:00 or 2031-04-01T14:00+02:00. DateError for
    numbers, times without a day, words such as "now", leap seconds and years out of reach.
    """
    if type(value).__name__ == "datetime64":
        value = str(value)
    if isinstance(value, str):
        return _moment_of(value.strip())
    if not isinstance(value, date):
        raise DateError(f"{_said(value)} is no date; wanted one like 2031-04-01 or 2031-04-01T12:00:00")
    in_reach(value.date() if isinstance(value, datetime) else value)
    if isinstance(value, datetime) and value.tzinfo:
        in_reach(value.astimezone(UTC).date())
    return value


def _moment_of(text: str) -> date:
    day, ns = label(text)
    in_reach(day, _said(text))
    if ns >= DAY:
        raise DateError(f"{_said(text)}: an epoch cannot stand in a leap second")
    found = _ISO.fullmatch(text)
    if not found or found["hour"] is None:
        return day
    utc = datetime(day.year, day.month, day.day) + timedelta(microseconds=ns // 1000)
    zone = found["zone"]
    if zone is None:
        return utc
    if zone == "Z":
        return utc.replace(tzinfo=UTC)
    ahead = timedelta(hours=int(zone[1:3]), minutes=int(zone[-2:]))
    if ahead >= timedelta(days=1):
        raise DateError(f"{_said(text)}: no clock is {zone} off UTC")
    return utc.replace(tzinfo=UTC).astimezone(timezone(-ahead if zone[0] == "-" else ahead))


def naive_utc(value: date) -> datetime:
    """The UTC of a moment without its offset; of a date its first instant."""
    if not isinstance(value, datetime):
        return datetime(value.year, value.month, value.day)
    return value.astimezone(UTC).replace(tzinfo=None) if value.tzinfo else value
