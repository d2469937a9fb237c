"""Dates in scenes: quoted or not, one grammar, within the reach of a recording's clock."""

from __future__ import annotations

from datetime import UTC, date, datetime, time, timedelta, timezone

import jsonschema
import numpy as np
import pytest

from sailviz.scene.loading import load_scene, schema

from .small import faults, with_parts


def test_epochs_become_utc():
    for epoch, utc in (
        (date(2030, 1, 2), datetime(2030, 1, 2)),
        (datetime(2030, 1, 2, 3), datetime(2030, 1, 2, 3)),
        (datetime.fromisoformat("2030-01-02T03:00:00+05:00"), datetime(2030, 1, 1, 22)),
    ):
        assert load_scene(with_parts(epoch=epoch)).epoch_utc == utc


QUOTED = [
    ("2031-04-01", date(2031, 4, 1)),
    ("2031-091", date(2031, 4, 1)),
    ("2031-04-01T12:00:00", datetime(2031, 4, 1, 12)),
    ("2031-04-01 12:00:00.25", datetime(2031, 4, 1, 12, 0, 0, 250_000)),
    ("2031-091T12:00", datetime(2031, 4, 1, 12)),
    ("2031-04-01T12:00:00Z", datetime(2031, 4, 1, 12, tzinfo=UTC)),
    ("2031-04-01T14:00:00+02:00", datetime(2031, 4, 1, 14, tzinfo=timezone(timedelta(hours=2)))),
    ("1678-01-01", date(1678, 1, 1)),
    ("2262-03-01", date(2262, 3, 1)),
]


@pytest.mark.parametrize(("text", "unquoted"), QUOTED)
def test_a_quoted_date_is_the_date_without_quotes_and_the_schema_agrees(text, unquoted):
    quoted, plainly = (load_scene(with_parts(epoch=epoch)) for epoch in (text, unquoted))
    assert quoted.epoch_utc == plainly.epoch_utc
    assert quoted.identity() == plainly.identity()
    assert jsonschema.Draft202012Validator(schema()).is_valid(with_parts(epoch=text))


@pytest.mark.parametrize(
    "epoch", ["now", "2031", "2031-4-1", "04/01/2031", "12:00", "2031-04-01T12", "", 2031, 2461000.5, True]
)
def test_what_is_no_date_is_refused_by_checker_and_schema(epoch):
    assert "is no date" in faults(with_parts(epoch=epoch))["epoch"]
    assert not jsonschema.Draft202012Validator(schema()).is_valid(with_parts(epoch=epoch))


@pytest.mark.parametrize(
    ("epoch", "words"),
    [
        (time(3, 4), "is no date"),
        (np.datetime64("NaT"), "is no date"),
        ("2031-02-30", "no such day"),
        ("2016-12-31T23:59:60", "leap second"),
        (date(1677, 1, 1), "1678 to 2262"),
        (datetime(1, 1, 1, tzinfo=timezone(timedelta(hours=12))), "1678 to 2262"),
        ("2262-04-05", "the end of the run, 2262-04-15, lies outside"),
    ],
)
def test_dates_that_no_recording_can_hold_are_refused(epoch, words):
    assert words in faults(with_parts(epoch=epoch))["epoch"]


def test_the_date_of_a_replayed_wind_may_be_quoted_too(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wind.csv").touch()

    def begins(start):
        wind = {"kind": "replay", "file": "wind.csv", "start": start}
        device = {"kind": "electric-sail", "characteristic_acceleration_mm_s2": 1}
        return with_parts(device=device, environment={"solar_wind": wind})

    assert load_scene(begins("2005-01-02")).identity() == load_scene(begins(date(2005, 1, 2))).identity()
    assert "is no date" in faults(begins(2005))["environment.solar_wind.start"]
