"""Flights in other programs' files of orbits: the right centre, axes and moments, wherever they were flown."""

import numpy as np
import pytest

import sailviz
from sailviz import frames
from sailviz.errors import RecordingError
from sailviz.exchange.spk import read_spk
from sailviz.recording import export, record
from sailviz.run.oem import read_oem
from sailviz.sky import Sky

EPOCH = "2026-03-20T00:00:00"
SAIL = {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 0.1}


def scene(body, radius_km, speed_km_s, days, gravity, steering, **more):
    """A sail on a circle tilted by 30 deg."""
    return {
        "title": "A sail in its own sky",
        "body": body,
        "epoch": EPOCH,
        "start": {
            "kind": "cartesian",
            "position_km": [radius_km, 0.0, 0.0],
            "velocity_km_s": [0.0, speed_km_s * np.sqrt(0.75), speed_km_s / 2],
        },
        "device": SAIL,
        "steering": steering,
        "environment": {"gravity_of": gravity},
        "propagation": {"duration_d": days, "outputs": 241, "tolerance": 1e-12},
    } | more


ASIDE = {"kind": "sun-frame", "pitch_deg": 35.0, "clock_deg": 90.0}
SCENES = {
    "Earth of date": scene("earth", 42_164.169, 3.0746660, 3.3, ["moon", "sun"], ASIDE),
    "Earth in the ICRF": scene("earth", 42_164.169, 3.0746660, 3.3, ["moon", "sun"], ASIDE, frame="icrf"),
    "Earth in the ecliptic": scene("earth", 42_164.169, 3.0746660, 3.3, ["moon"], ASIDE, frame="ecliptic-j2000"),
    "Mars": scene("mars", 20_427.7, 1.4479, 3.3, ["sun"], ASIDE),
    "Moon": scene("moon", 8_000.0, 0.7828, 3.3, ["earth", "sun"], ASIDE, frame="icrf"),
    "Sun": scene("sun", 149_597_870.7, 29.7847, 100, ["venus", "earth", "moon"], {"kind": "radial"}),
    "Sun in the ICRF": scene("sun", 149_597_870.7, 29.7847, 100, ["jupiter"], {"kind": "radial"}, frame="icrf"),
}
NAIF = {"earth": 399, "mars": 4, "moon": 301, "sun": 10}


@pytest.fixture(scope="module")
def flown():
    """The runs of the scenes, each flown once."""
    runs = {}

    def run(name):
        if name not in runs:
            runs[name] = sailviz.simulate(SCENES[name])
        return runs[name]

    return run


@pytest.mark.parametrize("frame", ["EME2000", "ECLIPJ2000"])
@pytest.mark.parametrize("name", SCENES)
def test_a_flight_goes_on_from_its_own_message(flown, name, frame, tmp_path):
    """From a date in the middle of what was written: only with its centre, axes and moments right is it one flight."""
    whole, file = flown(name), tmp_path / "flight.oem"
    export(whole, file, frame=frame)
    at = read_oem(file)
    assert (at.center, at.frame, at.time_system) == (whole.setting.body.name.upper(), frame, "UTC")
    half = len(whole) // 2
    date = np.datetime64(EPOCH, "ns") + np.timedelta64(round(whole.time[half] * 1e9), "ns")
    given = SCENES[name]
    again = given | {
        "epoch": str(date),
        "start": {"kind": "oem", "file": "flight.oem", "at": str(date)},
        "propagation": given["propagation"]
        | {"duration_d": given["propagation"]["duration_d"] / 2, "outputs": len(whole) - half},
    }
    (tmp_path / "again.toml").write_text(_toml(again))
    rest = sailviz.simulate(tmp_path / "again.toml")
    turn = np.eye(3)
    if whole.setting.body.name == "Earth" and "frame" not in given:  # the equator of two days later
        then = [Sky(np.datetime64(moment, "ns")).centuries for moment in (EPOCH, str(date))]
        turn = frames.precession(then[0]) @ frames.precession(then[1]).T
    distance = np.linalg.norm(whole.position[half:] - rest.position @ turn.T, axis=1)
    size = np.linalg.norm(whole.position[half:], axis=1)
    assert distance.max() < 1e-10 * size.max()  # 4 mm of 42,164 km, 15 m of 1 au: the integrator's own
    assert distance[0] < 4 * np.spacing(size.max())  # m: the start is the row
    assert np.linalg.norm(whole.position[-1] - whole.position[half]) > 0.3 * size.max()


@pytest.mark.parametrize("name", SCENES)
def test_a_kernel_holds_the_numbers_of_the_message(flown, name, tmp_path):
    whole = flown(name)
    for frame, word in (("", "J2000"), ("ECLIPJ2000", "ECLIPJ2000")):
        (oem,) = export(whole, tmp_path / "a.oem", frame=frame)
        (spk,) = export(whole, tmp_path / "a.bsp", frame=frame)
        message, (segment,) = read_oem(oem), read_spk(spk)
        assert (segment.target, segment.centre, segment.frame) == (-910001, NAIF[SCENES[name]["body"]], word)
        assert np.allclose(segment.position, message.position, rtol=0, atol=1e-15 * np.abs(message.position).max())
        assert np.allclose(segment.velocity, message.velocity, rtol=0, atol=1e-15 * np.abs(message.velocity).max())
        assert np.abs(segment.et - segment.et[0] - message.time).max() < 3e-7  # s: a float64 of 26 years


def test_spice_finds_the_craft_at_its_dates_and_names_it(flown, tmp_path):
    """By a leap-second kernel of SPICE's own constants; the name comes out of the kernel's comments."""
    spice = pytest.importorskip("spiceypy")
    whole = flown("Earth in the ICRF")
    (file,) = export(whole, tmp_path / "a.bsp", craft_id=-77, centre_id=399)
    (tmp_path / "one.tls").write_text(
        "KPL/LSK\n\\begindata\nDELTET/DELTA_T_A = 32.184\nDELTET/K = 1.657D-3\nDELTET/EB = 1.671D-2\n"
        "DELTET/M = ( 6.239996D0 1.99096871D-7 )\nDELTET/DELTA_AT = ( 36, @2015-JUL-1 37, @2017-JAN-1 )\n\\begintext\n"
    )
    dates = ("2026-03-20T00:00:00", "2026-03-22T18:00:00")
    handle = spice.dafopr(str(file))
    count, lines, _ = spice.dafec(handle, 50, lenout=1000)
    spice.dafcls(handle)
    (tmp_path / "name.tk").write_text("KPL/FK\n" + "\n".join(lines[:count]) + "\n")
    try:
        for kernel in (file, tmp_path / "one.tls", tmp_path / "name.tk"):
            spice.furnsh(str(kernel))
        seen = [
            spice.spkezr("A SAIL IN ITS OWN SKY", spice.str2et(date), "J2000", "NONE", "EARTH")[0] for date in dates
        ]
    finally:
        spice.kclear()
    for state, seconds, within in zip(seen, (0.0, 237_600.0), (1e-3, 0.25), strict=True):
        (row,) = np.flatnonzero(np.abs(whole.time - seconds) < 1e-6)
        # m: 3 km/s for half an ulp of 26 years; later also for the 77 us by which TDB leaves UTC in 2.75 d at most
        assert np.linalg.norm(1e3 * state[:3] - whole.position[row]) < within
        assert np.linalg.norm(1e3 * state[3:] - whole.velocity[row]) < 1e-4 * within


def test_gaps_and_jumps_begin_new_segments(tmp_path):
    time = np.arange(0.0, 2_400.0, 60.0)
    angle = time / 900.0
    position = 8e6 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    velocity = 8e6 / 900.0 * np.stack([-np.sin(angle), np.cos(angle), 0 * angle], 1)
    time, position = np.insert(time, 30, time[30]), np.insert(position, 30, position[30], 0)
    velocity = np.insert(velocity, 30, velocity[30], 0)
    velocity[31:] += [0.0, 0.0, 5.0]  # a burn at row 30
    arrays = {"mu": 3.986004418e14, "body": "Earth", "epoch": EPOCH, "gaps": [(600.0, 660.0)]}
    sailviz.record_trajectory(time, position, velocity, str(tmp_path / "a.rrd"), **arrays)
    (file,) = export(tmp_path / "a.rrd", tmp_path / "a.bsp")
    found = read_spk(file)
    assert [len(segment.et) for segment in found] == [11, 20, 10]
    assert found[1].et[-1] == found[2].et[0]
    assert found[2].velocity[0, 2] - found[1].velocity[-1, 2] == pytest.approx(5.0, abs=0.02)  # turned by 0.15 deg


def test_an_archive_knows_its_axes(flown, tmp_path):
    whole = flown("Moon")
    export(whole, tmp_path / "a.npz")
    (from_archive,) = export(tmp_path / "a.npz", tmp_path / "a.bsp")
    (from_run,) = export(whole, tmp_path / "b.bsp")
    record(whole, tmp_path / "a.rrd")
    (from_recording,) = export(tmp_path / "a.rrd", tmp_path / "c.bsp")
    for file in (from_archive, from_recording):
        assert np.array_equal(read_spk(file)[0].position, read_spk(from_run)[0].position)


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        ({"frame": "TEME"}, "J2000 or ECLIPJ2000, not in TEME"),
        ({"craft_id": 5}, "negative"),
        ({"entities": ["/thrust"]}, "an SPK holds position and velocity"),
    ],
)
def test_what_a_kernel_cannot_say_is_refused(runs, arguments, word, tmp_path):
    record(runs.displaced(rows=30), tmp_path / "run.rrd")
    with pytest.raises(RecordingError, match=word):
        export(tmp_path / "run.rrd", tmp_path / "run.bsp", **arguments)
    assert [file.name for file in tmp_path.iterdir()] == ["run.rrd"]


def test_ids_belong_to_a_kernel_and_a_star_of_ones_own_needs_one(runs, tmp_path):
    run = runs.displaced(rows=30)
    with pytest.raises(RecordingError, match="NAIF ids in an SPK, the craft in a CK; csv knows none"):
        export(run, tmp_path / "run.csv", craft_id=-5)
    star = {
        "title": "A star of its own",
        "body": {"name": "Altaira", "mu_km3_s2": 139348062043.343},
        "epoch": EPOCH,
        "start": {"kind": "elements", "semi_major_axis_au": 2.0, "eccentricity": 0.2},
        "device": {"kind": "none"},
        "propagation": {"duration_yr": 1.0, "outputs": 200},
    }
    flight = sailviz.simulate(star)
    with pytest.raises(RecordingError, match="which NAIF id Altaira has is not known"):
        export(flight, tmp_path / "run.bsp")
    with pytest.raises(RecordingError, match="which frame a run round Altaira is in is not known"):
        export(flight, tmp_path / "run.bsp", centre_id=10)
    (file,) = export(flight, tmp_path / "run.bsp", centre_id=1000, frame="ECLIPJ2000")
    (segment,) = read_spk(file)
    assert (segment.centre, segment.frame) == (1000, "ECLIPJ2000")
    assert np.array_equal(segment.position, 1e3 * (flight.position / 1e3))


def _toml(values):
    lines = [f"{key} = {_said(value)}" for key, value in values.items() if not isinstance(value, dict)]
    for key, value in values.items():
        if isinstance(value, dict):
            lines += [f"[{key}]", *(f"{name} = {_said(one)}" for name, one in value.items())]
    return "\n".join(lines)


def _said(value):
    return repr(value) if not isinstance(value, str) else f'"{value}"'
