"""Starts that are looked up: the state at the start against what the file or the ephemeris says by another way."""

import shutil
import sys
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

import sailviz
from sailviz import elements, frames
from sailviz.calendar import tai
from sailviz.constants import AU, MU_EARTH, MU_SUN
from sailviz.errors import SceneError
from sailviz.run.oem import read_oem
from sailviz.simulation.plan import plan
from sailviz.sky.places import Sky

pytest.importorskip("sgp4")
FOREIGN = Path(__file__).parents[1] / "data" / "foreign"
VANGUARD = (
    "1 00005U 58002B   00179.78495062  .00000023  00000-0  28098-4 0  4753",
    "2 00005  34.2682 348.7242 1859667 331.7664  19.3264 10.82419157413667",
)


def _scene(start, body="earth", **more):
    return {
        "title": "Start",
        "body": body,
        "start": start,
        "device": {"kind": "none"},
        "propagation": {"duration_d": 1, "outputs": 10},
    } | more


def _faults(scene):
    with pytest.raises(SceneError) as caught:
        plan(sailviz.load_scene(scene))
    return [(fault.where, fault.what) for fault in caught.value.faults]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    for path in FOREIGN.iterdir():
        shutil.copy(path, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_two_lines_give_state_and_epoch():
    scene = sailviz.load_scene(_scene({"kind": "tle", "line1": VANGUARD[0], "line2": VANGUARD[1]}))
    assert scene.epoch_utc == datetime(2000, 6, 27, 18, 50, 19, 733568)
    planned = plan(scene)
    assert np.linalg.norm(planned.position - [7022465.289, -1400082.968, 221.526]) < 1.0
    assert np.linalg.norm(planned.velocity - [1893.704243, 6405.795883, 4535.002622]) < 1e-3


def test_a_set_from_a_file_is_osculating_where_it_starts(folder):
    planned = plan(sailviz.load_scene(_scene({"kind": "tle", "file": "tle_made_up.txt"})))
    orbit = elements.elements(planned.position, planned.velocity, MU_EARTH)
    assert float(orbit.semi_major_axis) == pytest.approx(6913578.8, abs=0.2)
    assert float(orbit.eccentricity) == pytest.approx(0.0023758145, abs=2e-7)
    assert np.degrees(orbit.inclination) == pytest.approx(97.49, abs=0.06)  # of the mean equator, not the true one
    later = _scene({"kind": "tle", "file": "tle_made_up.txt"}, epoch="2026-05-01T12:00:00")
    other = plan(sailviz.load_scene(later))
    assert np.linalg.norm(other.position) == pytest.approx(
        1e3 * np.linalg.norm((4758.34293, 2179.803795, 4492.607178)), abs=0.1
    )


@pytest.mark.parametrize(
    ("start", "more", "where", "words"),
    [
        ({"line1": VANGUARD[0][:-1] + "4", "line2": VANGUARD[1]}, {}, "start", "the check digit of line 1 is '4'"),
        ({"file": "tle_made_up.txt"}, {"epoch": "2026-07-01"}, "epoch", "lies 61.5 d from that of the element set"),
        ({"file": "tle_made_up.txt"}, {"body": "sun"}, "body", 'body = "earth"'),
        ({"file": "tle_made_up.tx"}, {}, "start.file", "there is no file"),
        ({"file": "../tle_made_up.txt"}, {}, "start.file", "leads out of the folder"),
        ({"file": "gfz_made_up.txt"}, {}, "start.file", "no element sets in this file"),
        ({"line1": VANGUARD[0]}, {}, "start", "exactly one of file or line1 with line2"),
        ({"line1": VANGUARD[0], "line2": VANGUARD[1], "name": "X"}, {}, "start", "name chooses among"),
    ],
)
def test_element_sets_that_are_wrong(folder, start, more, where, words):
    found = _faults(_scene({"kind": "tle", **start}) | more)
    assert any(where == place and words in what for place, what in found), found


STEP = 7.5460532 / 7000.0 * 60.0  # rad between two rows of a circle
OEM = """CCSDS_OEM_VERS = 2.0
CREATION_DATE = 2031-01-01T00:00:00
ORIGINATOR = TEST
META_START
OBJECT_NAME = MADE UP
OBJECT_ID = 2031-001A
CENTER_NAME = {center}
REF_FRAME = {frame}
TIME_SYSTEM = {system}
START_TIME = 2031-04-01T12:00:00
STOP_TIME = 2031-04-01T12:02:00
META_STOP
"""


def _oem(folder, frame="TEME", center="EARTH", system="UTC"):
    rows = []
    for k, minute in enumerate(("12:00:00", "12:01:00", "12:02:00")):
        angle = STEP * k
        r = 7000.0 * np.array([np.cos(angle), np.sin(angle), 0.0])
        v = 7.5460532 * np.array([-np.sin(angle), np.cos(angle), 0.0])
        rows.append(f"2031-04-01T{minute} " + " ".join(f"{x:.9f}" for x in (*r, *v)))
    (folder / "a.oem").write_text(OEM.format(frame=frame, center=center, system=system) + "\n".join(rows) + "\n")


@pytest.mark.parametrize("frame", ["TEME", "TOD", "MOD", "EME2000", "ICRF"])
def test_a_message_starts_at_its_first_row_in_its_own_frame(folder, frame):
    _oem(folder, frame)
    scene = sailviz.load_scene(_scene({"kind": "oem", "file": "a.oem"}))
    assert scene.epoch_utc == datetime(2031, 4, 1, 12)
    planned = plan(scene)
    assert np.linalg.norm(planned.position) == pytest.approx(7e6, abs=1e-3)
    centuries = frames.centuries_since_j2000(np.datetime64("2031-04-01T12:00:00", "ns"))
    home = {"EME2000": frames.precession(centuries), "ICRF": frames.precession(centuries)}.get(frame, np.eye(3))
    off = np.linalg.norm(planned.position - home @ [7e6, 0.0, 0.0])
    assert off < (1e-3 if frame in ("MOD", "EME2000", "ICRF") else 700.0)  # nutation: 19 arcsec at most
    if frame == "TOD":
        assert off > 100.0


def test_a_message_is_read_between_its_rows_and_across_time_systems(folder):
    _oem(folder)
    middle = plan(sailviz.load_scene(_scene({"kind": "oem", "file": "a.oem", "at": "2031-04-01T12:00:30"})))
    assert np.linalg.norm(middle.position) == pytest.approx(7e6, abs=2.0)
    _oem(folder, system="TDB")
    at = {"kind": "oem", "file": "a.oem", "at": "2031-04-01T11:59:50.816"}  # 12:01:00 TDB
    found = plan(sailviz.load_scene(_scene(at)))
    first = plan(sailviz.load_scene(_scene({"kind": "oem", "file": "a.oem"})))
    angle = np.arccos(first.position @ found.position / 49e12)
    assert angle == pytest.approx(STEP, abs=1e-8)


@pytest.mark.parametrize(
    ("oem", "start", "more", "words"),
    [
        ({"center": "MARS"}, {}, {}, "this flight is round Mars, and the scene is round Earth"),
        ({"frame": "SELENA"}, {}, {}, "the frame SELENA is not known; known: GCRF"),
        ({"frame": "RTN"}, {}, {}, "the frame RTN goes along with an orbit"),
        ({"frame": "ITRF", "center": "SUN"}, {}, {"body": "sun"}, "ITRF is a frame of the Earth"),
        ({}, {"at": "2031-04-01T13:00:00"}, {}, "reaches from 2031-04-01T12:00:00.000 to 2031-04-01T12:02:00.000 UTC"),
        ({}, {"at": "2031-04-01T12:00:30"}, {"epoch": "2031-04-01T12:00:00"}, "leave one of them out"),
        ({"center": "SUN", "frame": "TEME"}, {}, {"body": "sun"}, "TEME is a frame of the Earth"),
    ],
)
def test_messages_that_do_not_fit(folder, oem, start, more, words):
    _oem(folder, **oem)
    found = _faults(_scene({"kind": "oem", "file": "a.oem", **start}) | more)
    assert any(words in what for _, what in found), found


ORIENTED = """CCSDS_OPM_VERS = 2.0
OBJECT_NAME = X
OBJECT_ID = X
CENTER_NAME = EARTH
REF_FRAME = ITRF2014
TIME_SYSTEM = UTC
EPOCH = 2025-04-01T12:00:00
X = 4000.123 [km]
Y = -3500.456 [km]
Z = 4700.789 [km]
X_DOT = 3.1 [km/s]
Y_DOT = 6.2 [km/s]
Z_DOT = 1.7 [km/s]
"""


def test_a_state_on_the_turning_earth_starts_where_it_is_among_the_stars(folder, monkeypatch):
    """By the worked row of tests/exchange/test_earth_frames.py, in a message of one state and in one of rows."""
    pytest.importorskip("erfa")
    from sailviz.exchange import earth_frames

    days = np.array([tai(f"2025-04-0{day}T00:00:00", "UTC") for day in (1, 2)])
    arcsecond = np.pi / 180 / 3600
    pole = (np.full(2, angle * arcsecond) for angle in (0.0123, 0.4321))
    orientation = earth_frames.EarthOrientation(days, *pole, np.full(2, 0.0388 - 37.0))
    monkeypatch.setattr(earth_frames, "shipped_orientation", lambda: orientation)
    (folder / "a.opm").write_text(ORIENTED)
    row = " 4000.123 -3500.456 4700.789 3.1 6.2 1.7\n"
    body = "".join(f"2025-04-01T{time}{row}" for time in ("11:58:00", "12:00:00", "12:02:00"))
    (folder / "a.oem").write_text(OEM.format(frame="ITRF", center="EARTH", system="UTC") + body)
    for name, at in (("a.opm", {}), ("a.oem", {"at": "2025-04-01T12:00:00"})):
        planned = plan(sailviz.load_scene(_scene({"kind": "oem", "file": name, **at}, frame="icrf")))
        assert planned.position / 1e3 == pytest.approx((4547.987116223, -2770.120385292, 4689.759022300), abs=2e-9)
        assert planned.velocity / 1e3 == pytest.approx((2.208272588443, 6.967260538783, 1.694298263300), abs=2e-12)


def test_the_extra_that_a_frame_needs_is_named(folder, monkeypatch):
    pytest.importorskip("erfa")
    from sailviz.exchange import earth_frames

    (folder / "a.opm").write_text(ORIENTED)
    start = _scene({"kind": "oem", "file": "a.opm"})
    monkeypatch.setattr(earth_frames, "shipped_orientation", lambda: None)
    ((where, what),) = _faults(start)
    assert where == "start.file"
    assert 'pip install "sailviz[ephemeris]"' in what
    monkeypatch.setitem(sys.modules, "erfa", None)
    ((_, what),) = _faults(start)
    assert 'pip install "sailviz[frames]"' in what


def test_a_message_of_nothing_is_told_when_the_scene_is_read(folder):
    (folder / "a.oem").write_text("hello")
    with pytest.raises(SceneError, match="does not begin with CCSDS_OEM_VERS"):
        sailviz.load_scene(_scene({"kind": "oem", "file": "a.oem"}))


def _at_planet(planet, **start):
    scene = _scene({"kind": "from-planet", "planet": planet, **start}, body="sun", epoch="2031-04-01")
    return plan(sailviz.load_scene(scene))


@pytest.mark.parametrize("planet", ["mercury", "venus", "earth", "mars", "jupiter"])
def test_a_flight_begins_with_the_planet(planet):
    planned = _at_planet(planet)
    sky = Sky(np.datetime64("2031-04-01", "ns"))
    places = sky.position(planet, "sun", np.array([0.0, -10.0, 10.0]))
    np.testing.assert_allclose(planned.position, places[0], rtol=1e-14)
    np.testing.assert_allclose(planned.velocity, (places[2] - places[1]) / 20.0, atol=1e-3)


@pytest.mark.parametrize(
    ("planet", "pulling", "refused"),
    [("earth", "earth", True), ("earth", "earth-moon", True), ("mars", "mars", True), ("mars", "earth", False)],
)
def test_a_flight_does_not_begin_in_the_middle_of_what_pulls(planet, pulling, refused):
    start, sky = {"kind": "from-planet", "planet": planet}, {"gravity_of": [pulling]}
    scene = _scene(start, body="sun", epoch="2031-04-01", environment=sky)
    if refused:
        assert any(where == "start" or where.startswith("start.distance") for where, _ in _faults(scene))
        start["distance_km"] = 1e6
    plan(sailviz.load_scene(scene))


def test_c3_is_the_square_of_the_excess_speed():
    still = _at_planet("earth")
    for towards, axis in (
        ("along", still.velocity),
        ("outward", still.position),
        ("north", [0, 0, 1]),
        ([0, 3, 4], [0, 3, 4]),
    ):
        moving = _at_planet("earth", c3_km2_s2=9.0, towards=towards)
        np.testing.assert_allclose(moving.velocity - still.velocity, 3000.0 * frames.unit(axis), atol=1e-6)
    against = _at_planet("earth", c3_km2_s2=9.0, towards="against")
    assert np.linalg.norm(against.velocity) == pytest.approx(np.linalg.norm(still.velocity) - 3000.0)


def test_near_the_planet_the_flight_is_as_fast_as_its_pull_makes_it():
    still = _at_planet("earth")
    near = _at_planet("earth", c3_km2_s2=4.0, distance_km=200000)
    v = np.linalg.norm(near.velocity - still.velocity)
    assert v**2 / 2 - MU_EARTH / 2e8 == pytest.approx(4e6 / 2)
    assert np.linalg.norm(near.position - still.position) == pytest.approx(2e8)


def test_small_bodies_by_file_and_by_elements(folder):
    tdb = "2025-11-20T23:58:50.816"  # JD 2461000.5 TDB
    files = [{"file": name} for name in ("sbdb_made_up.json", "mpcorb_made_up.dat")]
    said = {
        "semi_major_axis_au": 1.4582,
        "eccentricity": 0.2056,
        "inclination_deg": 6.35,
        "raan_deg": 126.4,
        "argument_deg": 212.9,
        "mean_anomaly_deg": 75.25,
        "elements_date": "2025-11-21",
    }
    for start in (*files, said):
        planned = plan(sailviz.load_scene(_scene({"kind": "small-body", **start}, body="sun", epoch=tdb)))
        assert np.abs(planned.position / 1e3 - (43239281.07724, 210681763.2581, -17786094.53628)).max() < 0.1
        assert np.abs(planned.velocity / 1e3 - (-22.780246016, 10.035261848, 1.377763902)).max() < 1e-8
    comet = {"kind": "small-body", "file": "comet_made_up.txt"}
    planned = plan(sailviz.load_scene(_scene(comet, body="sun", epoch="2026-12-25T23:58:50.816")))
    assert np.linalg.norm(planned.velocity) ** 2 / 2 - MU_SUN / np.linalg.norm(planned.position) > 0
    assert np.linalg.norm(planned.position) < 3 * AU


@pytest.mark.parametrize(
    ("start", "more", "where", "words"),
    [
        ({"kind": "from-planet", "planet": "earth"}, {"epoch": None}, "epoch", "where a planet stands needs a date"),
        ({"kind": "from-planet", "planet": "earth"}, {"body": "earth"}, "body", 'body = "sun"'),
        ({"kind": "from-planet", "planet": "eart"}, {}, "start.planet", "earth"),
        ({"kind": "from-planet", "planet": "earth", "towards": [0, 0, 0]}, {}, "start", "not the zero vector"),
        ({"kind": "from-planet", "planet": "earth", "c3_km2_s2": -1}, {}, "start.c3_km2_s2", "0"),
        ({"kind": "small-body", "file": "sbdb_made_up.json", "name": "Ceres"}, {}, "start.file", "not of Ceres"),
        ({"kind": "small-body", "file": "sw_made_up.csv"}, {}, "start.file", "no orbits of small bodies"),
        (
            {"kind": "small-body", "perihelion_distance_au": 1, "perihelion_date": "2030-01-01"},
            {},
            "start",
            "needs eccentricity too",
        ),
        ({"kind": "small-body"}, {}, "start", "exactly one of"),
        (
            {"kind": "cartesian", "position_km": [1e8, 0, 0], "velocity_km_s": [0, 30, 0], "frame": "teme"},
            {},
            "start.frame",
            "frame of the Earth",
        ),
    ],
)
def test_starts_that_cannot_be(folder, start, more, where, words):
    scene = _scene(start, body="sun", epoch="2031-04-01") | more
    found = _faults({key: value for key, value in scene.items() if value is not None})
    assert any(where == place and words in what for place, what in found), found


def test_a_state_in_another_frame_is_turned():
    state = {"kind": "cartesian", "position_km": [7000, 100, 200], "velocity_km_s": [0, 7, 2.5]}
    own, icrf, teme = (
        plan(sailviz.load_scene(_scene(state | frame, epoch="2031-04-01")))
        for frame in ({}, {"frame": "icrf"}, {"frame": "teme"})
    )
    centuries = frames.centuries_since_j2000(np.datetime64("2031-04-01", "ns"))
    np.testing.assert_allclose(icrf.position, frames.precession(centuries) @ own.position, atol=1e-3)
    assert 10.0 < np.linalg.norm(teme.position - own.position) < 700.0
    sun = plan(sailviz.load_scene(_scene(state | {"position_km": [1e8, 2e7, 3e7], "frame": "icrf"}, body="sun")))
    np.testing.assert_allclose(sun.position, frames.EQUATOR_FROM_ECLIPTIC.T @ [1e11, 2e10, 3e10], rtol=1e-14)


def test_a_start_in_a_message_of_our_own_flies_on_as_the_flight_did(folder):
    """Out as an ephemeris message, in again half way: the same end."""
    whole = sailviz.simulate(
        _scene(
            {"kind": "circular", "altitude_km": 800, "inclination_deg": 60},
            epoch="2031-04-01",
            propagation={"duration_d": 0.5, "outputs": 721},
        )
    )
    sailviz.export(whole, folder / "ours.oem")
    assert read_oem(folder / "ours.oem").frame in ("MOD", "EME2000", "ICRF")
    half = _scene(
        {"kind": "oem", "file": "ours.oem", "at": "2031-04-01T06:00:00"}, propagation={"duration_d": 0.25, "outputs": 2}
    )
    again = sailviz.simulate(half)
    assert np.linalg.norm(again.position[-1] - whole.position[-1]) < 20.0


def test_the_shipped_scene_of_an_element_set_is_checked_without_sgp4_and_flown_with_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "sgp4", None)
    scene = sailviz.load_scene("deorbit/drag-sail")
    assert scene.epoch_utc == datetime(2026, 5, 1, 6)
    with pytest.raises(SceneError, match=r'extra "tle": pip install "sailviz\[tle\]"'):
        plan(scene)
