"""Dates and times as people give them: what becomes an instant, and what is refused."""

from __future__ import annotations

from datetime import UTC, date, datetime, timedelta, timezone

import numpy as np
import pytest

from sailviz.calendar import LEAP_SECONDS, DateError, leap_seconds, tai
from sailviz.run import dates


@pytest.mark.parametrize(
    ("text", "system", "utc"),
    [
        ("1998-08-01T00:00:00", "TDB", "1998-07-31T23:58:56.816"),
        ("1990-08-01T00:00:00", "TAI", "1990-07-31T23:59:35"),
        ("2007-01-01T00:00:00", "TT", "2006-12-31T23:58:54.816"),
        ("2020-01-06T00:00:18", "GPS", "2020-01-06T00:00:00"),
        ("2012-07-01T00:00:34.5", "TAI", "2012-07-01T00:00:00.5"),  # 23:59:60.5, which datetime64 cannot hold
        ("2031-04-01T12:00:00.1234567896", "UTC", "2031-04-01T12:00:00.123456790"),
    ],
)
def test_time_systems_differ_from_utc_by_the_leap_seconds_of_their_date(text, system, utc):
    assert dates.utc_of(tai(text, system)) == np.datetime64(utc)


def test_every_leap_second_is_there_as_another_table_has_it():
    erfa = pytest.importorskip("erfa")
    theirs = [(int(y), int(m), float(s)) for y, m, s in erfa.leap_seconds.get() if y >= 1972]
    assert [(y, m, float(s)) for y, m, s in LEAP_SECONDS] == theirs


def test_labels_run_through_each_leap_second_once():
    for year, month, offset in LEAP_SECONDS[1:]:
        start = tai(f"{year}-{month:02}-01T00:00:00", "UTC")
        texts = dates.utc_texts(start + np.array([-2, -1, 0], np.int64) * 10**9)
        assert [text[17:19] for text in texts] == ["59", "60", "00"]
        assert [tai(text, "UTC") - start for text in texts] == [-2 * 10**9, -(10**9), 0]
        assert leap_seconds(date(year, month, 1)) == offset


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (None, None),
        ("2031-04-01", "2031-04-01"),
        ("2031-091T12:00Z", "2031-04-01T12:00"),
        ("2031-04-01T12:00+02:00", "2031-04-01T10:00"),
        ("2031-01-01T00:30+02:00", "2030-12-31T22:30"),
        (date(2031, 4, 1), "2031-04-01"),
        (datetime(2031, 4, 1, 12), "2031-04-01T12:00"),
        (datetime(2031, 4, 1, 12, tzinfo=timezone(timedelta(hours=-5))), "2031-04-01T17:00"),
        (datetime(2031, 4, 1, 12, tzinfo=UTC), "2031-04-01T12:00"),
        (np.datetime64("2031-04-01T12", "h"), "2031-04-01T12:00"),
        (np.datetime64("1678-01-01"), "1678-01-01"),
    ],
)
def test_dates_of_every_kind_are_one(value, expected):
    found = dates.epoch_of(value)
    assert found is None if expected is None else found == np.datetime64(expected, "ns")


@pytest.mark.parametrize(
    ("value", "word"),
    [
        (2031, "2031 is no date"),
        (2461000.5, "is no date"),
        (True, "is no date"),
        ("now", "'now' is no date"),
        ("today", "is no date"),
        ("", "is no date"),
        ("2031-02-30", "no such day"),
        ("2031-04-01T24:00", "there is no time 24:00:00"),
        ("2500-01-01", "outside the years 1678 to 2262"),
        ("1492-10-12", "outside the years"),
        (datetime(2500, 1, 1), "outside the years"),
        (date(1500, 1, 1), "outside the years"),
        (np.datetime64("2500-01-01"), "outside the years"),
        (np.datetime64(10**15, "Y"), "outside the years"),
        (np.datetime64("NaT"), "NaT"),
        (np.float64(1.0), "is no date"),
    ],
)
def test_what_is_no_date_is_refused_never_wrapped(value, word):
    with pytest.raises(DateError, match=word):
        dates.epoch_of(value)


@pytest.mark.parametrize("unit", ["ns", "us", "ms", "s", "m", "h", "D", "W"])
def test_spans_of_any_unit_become_seconds(unit):
    step = np.timedelta64(1, unit) / np.timedelta64(1, "s")
    found, epoch = dates.seconds_of(np.arange(4).astype(f"m8[{unit}]"))
    assert epoch is None
    assert np.allclose(found, step * np.arange(4), rtol=1e-15)


def test_dates_as_times_count_from_the_epoch_or_from_the_first():
    stamps = np.array(["2031-01-02", "2031-01-03"], "M8[D]")
    found, epoch = dates.seconds_of(stamps)
    assert found.tolist() == [0.0, 86400.0]
    assert epoch == np.datetime64("2031-01-02")
    found, epoch = dates.seconds_of(stamps, np.datetime64("2031-01-01", "ns"))
    assert found.tolist() == [86400.0, 172800.0]
    assert epoch == np.datetime64("2031-01-01")


@pytest.mark.parametrize(
    ("values", "word"),
    [
        (np.ma.masked_array([0.0, 1.0, 2.0], [0, 1, 0]), "row 1 is masked"),
        (np.array([0, 1], "m8[Y]"), "no fixed length"),
        (np.array([0, 1], "m8"), "no unit"),
        (np.array(["2031-01-01", "NaT"], "M8[s]"), r"row 1 is not a time \(NaT\)"),
        (np.array(["2031-01-01", "2500-01-01"], "M8[D]"), "outside the years"),
        (np.array([0, 1j]), "complex"),
        (["a", "b"], "not an array of numbers"),
        ([[0, 1], [2]], "not an array of numbers|inhomogeneous"),
    ],
)
def test_times_that_are_none_are_refused(values, word):
    with pytest.raises((DateError, ValueError), match=word):
        dates.seconds_of(values)


def test_an_array_whose_mask_is_empty_is_an_array():
    assert dates.numbers(np.ma.masked_array([1.0, 2.0], [0, 0])).tolist() == [1.0, 2.0]
