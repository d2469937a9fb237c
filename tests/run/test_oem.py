"""Orbit ephemeris messages of others: dialects that the standard allows, and what is refused with its line."""

from __future__ import annotations

import os
import random
from dataclasses import replace

import numpy as np
import pytest

from sailviz import frames
from sailviz.errors import RecordingError
from sailviz.run import Ephemeris, read_oem, write_oem

OEM = """CCSDS_OEM_VERS = 2.0
COMMENT of a mission
CREATION_DATE = 2026-01-01T00:00:00
ORIGINATOR = X
META_START
OBJECT_NAME = THING
OBJECT_ID = 2020-001A
CENTER_NAME = EARTH
REF_FRAME = EME2000
TIME_SYSTEM = TDB
START_TIME = 2026-01-01T00:00:00
STOP_TIME = 2026-01-01T00:02:00
META_STOP
2026-01-01T00:00:00.5 7000 0 0 0 7.5 0
2026-001T00:01:00.5Z 6990 450 0 -0.5 7.49 0 0.001 0 0
COVARIANCE_START
EPOCH = 2026-01-01T00:00:00
1e-3
COVARIANCE_STOP
META_START
OBJECT_NAME = THING
OBJECT_ID = 2020-001A
CENTER_NAME = EARTH
REF_FRAME = EME2000
TIME_SYSTEM = TDB
START_TIME = 2026-01-01T00:01:00.5
STOP_TIME = 2026-01-01T00:02:00.5
META_STOP
2026-01-01T00:01:00.5 6991 450 0 -0.5 7.49 0
2026-01-01T00:02:00.5 6970 900 0 -1.0 7.4 0
"""


def block(rows, **meta):
    """One block of a message: rows of (epoch, six numbers), metadata over the usual."""
    given = {"OBJECT_NAME": "X", "OBJECT_ID": "1", "CENTER_NAME": "EARTH", "REF_FRAME": "EME2000", "TIME_SYSTEM": "UTC"}
    given |= meta
    lines = ["META_START", *(f"{key} = {value}" for key, value in given.items()), "META_STOP"]
    return "\n".join([*lines, *(f"{epoch} {state}" for epoch, state in rows)]) + "\n"


def circle(minutes):
    """Rows on a circle of 7000 km, a minute apart: (epoch, state) at minutes past midnight."""
    rate = np.sqrt(398600.4418 / 7000**3)
    rows = []
    for minute in minutes:
        c, s = np.cos(60 * minute * rate), np.sin(60 * minute * rate)
        state = (7000 * c, 7000 * s, 0, -7000 * rate * s, 7000 * rate * c, 0)
        rows.append((f"2031-03-01T{minute // 60:02}:{minute % 60:02}:00", " ".join(f"{x:.9f}" for x in state)))
    return rows


def message(tmp_path, *blocks):
    path = tmp_path / "a.oem"
    path.write_text("CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2026-01-01T00:00:00\nORIGINATOR = X\n" + "".join(blocks))
    return path


def test_messages_of_others_are_read(tmp_path):
    (tmp_path / "a.oem").write_text(OEM)
    found = read_oem(tmp_path / "a.oem")
    assert found.time.tolist() == [0.0, 60.0, 120.0]
    assert found.position[1].tolist() == [6991e3, 450e3, 0.0]  # the later block counts
    assert found.utc == np.datetime64("2025-12-31T23:58:51.316")
    assert found.notes == ("accelerations are passed over", "covariances are passed over")


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        ("CCSDS_OEM_VERS = 2.0", "hello", "does not begin with"),
        ("CCSDS_OEM_VERS = 2.0", "<?xml version='1.0'?>", "XML"),
        ("7000 0 0", "7000 x 0", "line 14: an epoch and six numbers"),
        ("7000 0 0", "7000 1.0D3 0", "line 14: an epoch and six numbers"),
        ("7000 0 0", "nan 0 0", "line 14: a state is not a finite number"),
        ("7000 0 0", "1e999 0 0", "line 14: a state is not a finite number"),
        ("2026-01-01T00:00:00.5", "yesterday", "line 14: 'yesterday' is no date"),
        ("2026-001T00:01", "2026-366T00:01", "line 15: .*no such day"),
        ("2026-001T00:01", "2026-000T00:01", "line 15: .*no such day"),
        ("2026-001T00:01", "2500-001T00:01", "line 15: .*outside the years 1678 to 2262"),
        ("2026-001T00:01", "2026-001T00:00:60.5 1 1 1 1 1 1\n2026-001T00:01", "a second 60 stands at the end of a day"),
        ("TIME_SYSTEM = TDB", "TIME_SYSTEM = MRT", "changes its TIME_SYSTEM: MRT, TDB"),
        ("REF_FRAME = EME2000", "REF_FRAME = TEME", "changes its REF_FRAME"),
        ("2026-01-01T00:02:00.5 6970", "2026-01-01T00:00:20.5 6970", "line 30: this row lies before the row above"),
        ("2026-01-01T00:02:00.5 6970", "2026-01-01T00:01:00.5 6970", "line 30: this row repeats the epoch"),
        (
            "META_START\nOBJECT_NAME",
            "2026-01-01T00:00:00 1 2 3 4 5 6\nOBJECT_NAME",
            "an epoch and six|has no|first META",
        ),
    ],
)
def test_messages_that_are_none_are_refused_in_one_sentence(old, new, word, tmp_path):
    (tmp_path / "a.oem").write_text(OEM.replace(old, new, 1))
    with pytest.raises(RecordingError, match=word) as error:
        read_oem(tmp_path / "a.oem")
    assert "\n" not in str(error.value)


def test_a_time_system_without_a_known_distance_from_utc_is_refused_by_name(tmp_path):
    with pytest.raises(RecordingError, match="time system MRT is not known here; known: UTC, TAI, GPS, TT, TDB"):
        read_oem(message(tmp_path, block(circle(range(3)), TIME_SYSTEM="MRT")))


def test_letter_case_of_keywords_and_values_does_not_matter(tmp_path):
    path = message(
        tmp_path, block(circle(range(3))), block(circle(range(3, 6)), CENTER_NAME="Earth", TIME_SYSTEM="utc")
    )
    path.write_text(path.read_text().replace("REF_FRAME", "ref_frame"))
    assert len(read_oem(path).time) == 6


@pytest.mark.parametrize("word", ["J2000", "ICRF", "ICRF3", "GCRF", "EME2000"])
def test_names_of_the_inertial_equator_are_turned_to_the_ecliptic(word, tmp_path):
    found = read_oem(message(tmp_path, block(circle(range(3)), CENTER_NAME="SUN", REF_FRAME=word))).in_ecliptic()
    assert found.frame == "ECLIPJ2000"
    y, z = found.position[2, 1:]  # of a circle in the equator, which the ecliptic cuts at 23.439 deg
    assert np.degrees(np.arctan2(z, y)) == pytest.approx(-23.43929111, abs=1e-7)


@pytest.mark.parametrize("word", ["ITRF2020", "ITRF-93", "WGS84", "RTN", "TNW", "EFG", "MARSIAU"])
def test_a_frame_that_turns_or_is_unknown_is_refused_by_name_round_the_earth(word, tmp_path):
    found = read_oem(message(tmp_path, block(circle(range(3)), REF_FRAME=word)))
    with pytest.raises(RecordingError, match=f"the frame {word} cannot be turned here"):
        found.in_equator_of_date()


def test_rows_outside_the_useable_span_serve_interpolation_only(tmp_path):
    first = block(circle(range(0, 8)), START_TIME="2031-03-01T00:00:00", USEABLE_STOP_TIME="2031-03-01T00:05:30")
    second = block(circle(range(4, 12)), USEABLE_START_TIME="2031-03-01T00:05:30", STOP_TIME="2031-03-01T00:11:00")
    found = read_oem(message(tmp_path, first, second))
    assert found.time.tolist() == [60.0 * i for i in range(12)]
    assert "4 rows outside" in found.notes[0]
    assert not found.gaps


def test_blocks_that_overlap_count_from_the_later_ones_first_row_on_and_two_flights_do_not_join(tmp_path):
    found = read_oem(message(tmp_path, block(circle(range(0, 8))), block(circle(range(4, 12)))))
    assert len(found.time) == 12
    assert "overlap" in found.notes[0]
    other = [(epoch, state.replace("0.000000000", "99.0")) for epoch, state in circle(range(4, 12))]
    with pytest.raises(RecordingError, match=r"the blocks at lines 4 and \d+ overlap and are 0\.01.* of the distance"):
        read_oem(message(tmp_path, block(circle(range(0, 8))), block(other)))
    with pytest.raises(RecordingError, match="not in order of time"):
        read_oem(message(tmp_path, block(circle(range(4, 12))), block(circle(range(0, 3)))))


def test_a_velocity_that_jumps_between_blocks_keeps_both_rows(tmp_path):
    before, after = circle(range(0, 4)), circle(range(3, 6))
    epoch, state = after[0]
    *place, vx, vy, vz = state.split()
    after[0] = (epoch, " ".join([*place, vx, str(float(vy) + 0.1), vz]))
    found = read_oem(message(tmp_path, block(before), block(after)))
    assert found.time.tolist() == [0.0, 60.0, 120.0, 180.0, 180.0, 240.0, 300.0]
    assert "velocity jumps" in found.notes[0]


def test_a_gap_between_blocks_is_named(tmp_path):
    found = read_oem(message(tmp_path, block(circle(range(0, 10))), block(circle(range(209, 219)))))
    assert found.gaps == ((9, 12_000.0),)
    assert found.notes == ("2 blocks, 12,000 s without data between two of them",)
    assert not read_oem(message(tmp_path, block(circle(range(0, 10))), block(circle(range(10, 20))))).gaps


def test_a_leap_second_counts_between_rows_and_its_own_label_is_read(tmp_path):
    states = [state for _, state in circle(range(5))]
    labels = [
        "2016-12-31T23:59:30",
        "2016-12-31T23:59:59",
        "2016-12-31T23:59:60",
        "2017-01-01T00:00:00",
        "2017-001T00:00:30",
    ]
    found = read_oem(message(tmp_path, block(list(zip(labels, states, strict=True)))))
    assert found.time.tolist() == [0.0, 29.0, 30.0, 31.0, 61.0]
    for wrong in ("2015-12-31T23:59:60", "2016-12-31T12:59:60"):
        with pytest.raises(RecordingError, match="second"):
            read_oem(message(tmp_path, block([(wrong, states[0])])))
    with pytest.raises(RecordingError, match="no leap second was added to TAI"):
        read_oem(message(tmp_path, block([("2016-12-31T23:59:60", states[0])], TIME_SYSTEM="TAI")))


def test_rows_written_across_a_leap_second_come_back_a_physical_second_apart(tmp_path):
    time = np.arange(0.0, 4.0, 0.5)
    place = 7e6 * np.column_stack([np.cos(time / 1e3), np.sin(time / 1e3), 0 * time])
    speed = 7e3 * np.column_stack([-np.sin(time / 1e3), np.cos(time / 1e3), 0 * time])
    epoch = np.datetime64("2016-12-31T23:59:58", "ns")
    written = Ephemeris("X", "1", "EARTH", "EME2000", "UTC", epoch, time, place, speed)
    text = write_oem(tmp_path / "a.oem", written).read_text()
    assert "2016-12-31T23:59:60.500000000 " in text
    assert np.abs(read_oem(tmp_path / "a.oem").time - time).max() < 1e-9


def test_precession_is_that_of_the_iau_2006_model():
    erfa = pytest.importorskip("erfa")
    for year in (1950, 2025, 2100):
        theirs = erfa.pmat06(2451545.0 + (year - 2000) * 365.25, 0.0)
        off = np.degrees(np.abs(frames.precession((year - 2000) / 100) - theirs).max()) * 3600
        assert off < 0.024  # arcsec: the frame bias between GCRF and the equator of J2000 is 0.0231


def test_a_damaged_message_is_read_with_finite_numbers_or_refused_in_one_sentence(tmp_path, harmed):
    chance, told = random.Random(2), []
    for _ in range(150):
        (tmp_path / "a.oem").write_bytes(harmed(OEM.encode(), chance))
        try:
            found = read_oem(tmp_path / "a.oem")
        except RecordingError as error:
            told.append(str(error))
        else:
            assert np.isfinite(found.position).all()
            assert np.all(np.diff(found.time) >= 0)
    assert len(told) > 50
    assert all("\n" not in sentence for sentence in told)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names")
def test_a_pipe_or_a_folder_is_no_message(tmp_path):
    os.mkfifo(tmp_path / "a.oem")
    for path in (tmp_path / "a.oem", tmp_path):
        with pytest.raises(RecordingError, match="not a regular file"):
            read_oem(path)


def test_a_gap_and_a_jump_are_segments_of_their_own_and_come_back(tmp_path):
    rows = np.r_[0:10, 209:219]
    time = rows * 60.0
    angle = 0.001 * time
    place = 7e6 * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    speed = 7e3 * np.column_stack([-np.sin(angle), np.cos(angle), 0 * angle])
    time, place, speed = (np.insert(part, 15, part[15], axis=0) for part in (time, place, speed))
    speed[15] *= 1.01
    start = np.datetime64("2031-03-01T00:00:00", "ns")
    written = Ephemeris("X", "Y", "EARTH", "EME2000", "UTC", start, time, place, speed, ((9, 12_000.0 - 60.0),))
    path = write_oem(tmp_path / "a.oem", written)
    assert path.read_text().count("META_START") == 3
    found = read_oem(path)
    assert np.array_equal(found.time, time)
    assert found.without_data == ((time[9], time[10]),)
    assert "velocity jumps" in found.notes[0]
    with pytest.raises(RecordingError, match="nanosecond apart"):
        write_oem(tmp_path / "b.oem", replace(written, position=place + 1e5 * (np.arange(21) == 15)[:, None]))
