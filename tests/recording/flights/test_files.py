"""Flights of others in whatever file: each holds one known flight and reads as the same run, or is refused."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import sailviz
from sailviz import two_body
from sailviz.cli.entry import main
from sailviz.constants import AU, DAY, MU_EARTH, MU_SUN
from sailviz.errors import RecordingError
from sailviz.exchange import spk
from sailviz.frames import EQUATOR_FROM_ECLIPTIC
from sailviz.recording.flights import is_flight, read_flight
from sailviz.run.oem import Ephemeris
from sailviz.run.oem_writer import write_oem

EPOCH = np.datetime64("2031-04-01T12:00:00", "ns")
TIME = np.linspace(0.0, 100 * DAY, 60)
R0, V0 = np.array([AU, 0.0, 0.1 * AU]), np.array([2e3, 29e3, 1e3])
PLACE, SPEED = two_body.advance(np.tile(R0, (60, 1)), np.tile(V0, (60, 1)), TIME, MU_SUN)


def _csv(path, header, columns):
    lines = [header, *(",".join(str(value) for value in row) for row in zip(*columns, strict=True))]
    path.write_text("\n".join(lines) + "\n")
    return path


def _same(run, digits=1e-12):
    assert np.abs(run.time - TIME).max() < 1e-6
    assert np.abs(run.position - PLACE).max() < digits * AU
    assert np.abs(run.velocity - SPEED).max() < digits * 3e4
    assert run.setting.body.name == "Sun"


KM = [*(PLACE.T / 1e3), *(SPEED.T / 1e3)]


@pytest.mark.parametrize(
    ("header", "columns"),
    [
        ("time_s,x_km,y_km,z_km,vx_km_s,vy_km_s,vz_km_s", [TIME, *KM]),
        ("Time [d],X [km],Y [km],Z [km],VX [km/s],VY [km/s],VZ [km/s]", [TIME / DAY, *KM]),
        ("t_s,rx_au,ry_au,rz_au,vx_m_s,vy_m_s,vz_m_s", [TIME, *(PLACE.T / AU), *SPEED.T]),
        (
            "step,time_s,state.position_m.x,state.position_m.y,state.position_m.z,"
            "state.velocity_m_s.x,state.velocity_m_s.y,state.velocity_m_s.z",
            [range(60), TIME, *PLACE.T, *SPEED.T],
        ),
        (
            "elapsed (s),pos_x (km),pos_y (km),pos_z (km),x_dot (km/s),y_dot (km/s),z_dot (km/s),note",
            [TIME, *KM, ["a"] * 60],
        ),
    ],
)
def test_columns_are_what_their_names_say(tmp_path, header, columns):
    _same(read_flight(_csv(tmp_path / "a.csv", header, columns)))


def test_dates_are_times_and_epoch(tmp_path):
    utc = EPOCH + np.round(TIME * 1e9).astype("timedelta64[ns]")
    run = read_flight(_csv(tmp_path / "a.csv", "utc,x_km,y_km,z_km,vx_km_s,vy_km_s,vz_km_s", [utc, *KM]))
    _same(run)
    assert run.setting.epoch == EPOCH


def test_archives_and_parquet(tmp_path):
    np.savez(tmp_path / "a.npz", time_s=TIME, position_km=PLACE / 1e3, velocity_km_s=SPEED / 1e3)
    _same(read_flight(tmp_path / "a.npz"))
    import pyarrow as pa
    import pyarrow.parquet as parquet

    names = ["time_s", "x_km", "y_km", "z_km", "vx_km_s", "vy_km_s", "vz_km_s"]
    parquet.write_table(pa.table(dict(zip(names, [TIME, *KM], strict=True))), tmp_path / "a.parquet")
    _same(read_flight(tmp_path / "a.parquet"))


def test_our_own_exports_come_back(tmp_path):
    run = sailviz.simulate(
        sailviz.load_scene("spirals/logarithmic").with_values({"propagation.outputs": 80, "expect": []})
    )
    for ending in ("csv", "parquet", "npz"):
        sailviz.export(run, tmp_path / f"a.{ending}")
        back = read_flight(tmp_path / f"a.{ending}")
        assert np.array_equal(back.position, run.position)
        assert np.array_equal(back.velocity, run.velocity)


@pytest.mark.parametrize("frame", ["EME2000", "ECLIPJ2000"])
def test_messages_and_kernels_are_turned_to_the_ecliptic(tmp_path, frame):
    turn = EQUATOR_FROM_ECLIPTIC if frame == "EME2000" else np.eye(3)
    given = PLACE @ turn.T, SPEED @ turn.T
    write_oem(tmp_path / "a.oem", Ephemeris("X", "Y", "SUN", frame, "UTC", EPOCH, TIME, *given))
    run = read_flight(tmp_path / "a.oem")
    _same(run)
    assert run.setting.epoch == EPOCH
    word = "J2000" if frame == "EME2000" else frame
    spk.write_spk(tmp_path / "a.bsp", [spk.Arc(TIME + 9.8e8, *given)], centre=10, frame=word, name="X")
    _same(read_flight(tmp_path / "a.bsp"))


def test_segments_of_a_kernel_leave_a_gap_or_a_jump(tmp_path):
    cut, late = 20, 40
    speed = SPEED.copy()
    arcs = [
        spk.Arc(TIME[:cut] + 9.8e8, PLACE[:cut], speed[:cut]),
        spk.Arc(TIME[late:] + 9.8e8, PLACE[late:], speed[late:]),
    ]
    spk.write_spk(tmp_path / "a.bsp", arcs, centre=10, frame="ECLIPJ2000")
    run = read_flight(tmp_path / "a.bsp")
    assert len(run) == 40
    ((start, end),) = run.setting.gaps
    assert (start, end) == pytest.approx((TIME[cut - 1], TIME[late]), abs=1e-5)
    kicked = SPEED[cut:] + np.array([100.0, 0, 0])
    arcs = [
        spk.Arc(TIME[: cut + 1] + 9.8e8, PLACE[: cut + 1], SPEED[: cut + 1]),
        spk.Arc(TIME[cut:] + 9.8e8, PLACE[cut:], kicked),
    ]
    spk.write_spk(tmp_path / "b.bsp", arcs, centre=10, frame="ECLIPJ2000")
    run = read_flight(tmp_path / "b.bsp")
    assert len(run) == 61
    assert [event.name for event in run.events] == ["velocity jumps"]
    assert not run.setting.gaps


def test_a_long_step_in_a_table_is_a_gap(tmp_path):
    rows = np.r_[0:20, 45:60]
    run = read_flight(
        _csv(
            tmp_path / "a.csv",
            "time_s,x_km,y_km,z_km,vx_km_s,vy_km_s,vz_km_s",
            [TIME[rows], *(column[rows] for column in KM)],
        )
    )
    assert run.setting.gaps == ((pytest.approx(TIME[19]), pytest.approx(TIME[45])),)


@pytest.mark.parametrize("frame", ["ITRF", "TEME", "TOD", "GCRF"])
def test_a_flight_round_the_earth_comes_from_the_frame_it_is_in(tmp_path, frame):
    pytest.importorskip("erfa")
    from sailviz import frames
    from sailviz.exchange import earth_frames
    from sailviz.run import dates

    when = np.datetime64("2024-04-01T12:00:00", "ns")
    time = np.linspace(0.0, 5000.0, 60)
    place, speed = two_body.advance(
        np.tile([7e6, 1e5, 2e5], (60, 1)), np.tile([0.0, 5.2e3, 5.3e3], (60, 1)), time, MU_EARTH
    )
    instants = dates.instant_of(when) + np.round(time * 1e9).astype(np.int64)
    if frame == "ITRF":
        pole, spun = earth_frames._of_the_earth(instants, None)
        given = np.einsum("nij,njk,nk->ni", pole, spun, place)
        turned = np.einsum("nij,nj->ni", spun, speed) - np.cross(
            [0, 0, earth_frames.ROTATION], np.einsum("nij,nj->ni", spun, place)
        )
        moved = np.einsum("nij,nj->ni", pole, turned)
    else:
        turn = earth_frames.from_gcrf_matrix(frame, instants)
        given, moved = (np.einsum("...ij,...j->...i", turn, vectors) for vectors in (place, speed))
    write_oem(tmp_path / "a.oem", Ephemeris("X", "Y", "EARTH", frame, "UTC", when, time, given, moved))
    run = read_flight(tmp_path / "a.oem")
    home = frames.icrf_to("equator-of-date", frames.centuries_since_j2000(when))
    assert np.abs(run.position - place @ home.T).max() < 1e-3
    assert np.abs(run.velocity - speed @ home.T).max() < 1e-6
    assert frame == "GCRF" or "ERFA" in run.setting.accuracy


HEADER = "time_s,x_km,y_km,z_km,vx_km_s,vy_km_s,vz_km_s"


@pytest.mark.parametrize(
    ("header", "columns", "words"),
    [
        (HEADER.replace("x_km,", "x,"), [TIME, *KM], "no unit"),
        (HEADER.replace("x_km,", "x_ft,"), [TIME, *KM], "x"),
        (HEADER.replace("vz_km_s", "other"), [TIME, *KM], "of the velocity the z is lacking"),
        (HEADER.replace("time_s", "other"), [TIME, *KM], "no time"),
        (HEADER, [TIME / DAY, *KM], "days"),
        (HEADER, [TIME, *(PLACE.T), *(SPEED.T / 1e3)], "position|velocity|times as fast"),
        (HEADER, [TIME[::-1], *KM], "time"),
        (HEADER, [["a"] * 60, *KM], "holds no numbers"),
        (HEADER, [TIME[:1], *(column[:1] for column in KM)], "fewer than two rows"),
    ],
)
def test_tables_that_do_not_say_what_they_are_are_refused(tmp_path, header, columns, words):
    path = _csv(tmp_path / "a.csv", header, columns)
    with pytest.raises(RecordingError, match=words) as told:
        read_flight(path)
    assert "\n" not in str(told.value)
    said = CliRunner().invoke(main, ["view", str(path)])
    assert said.exit_code == 2
    assert said.output.count("\n") == 1


def test_damaged_files_of_every_kind_are_read_or_refused_in_one_sentence(tmp_path):
    _csv(tmp_path / "a.csv", HEADER, [TIME, *KM])
    np.savez(tmp_path / "a.npz", time_s=TIME, position_km=PLACE / 1e3, velocity_km_s=SPEED / 1e3)
    write_oem(tmp_path / "a.oem", Ephemeris("X", "Y", "SUN", "ECLIPJ2000", "UTC", EPOCH, TIME, PLACE, SPEED))
    spk.write_spk(tmp_path / "a.bsp", [spk.Arc(TIME + 9.8e8, PLACE, SPEED)], centre=10, frame="ECLIPJ2000")
    import pyarrow as pa
    import pyarrow.parquet as parquet

    parquet.write_table(pa.table(dict(zip(HEADER.split(","), [TIME, *KM], strict=True))), tmp_path / "a.parquet")
    generator = np.random.default_rng(4)
    refused = 0
    for ending in ("csv", "npz", "oem", "bsp", "parquet"):
        content = (tmp_path / f"a.{ending}").read_bytes()
        for k in range(24):
            letters = bytearray(content)
            for place in generator.integers(0, len(letters), 4):
                letters[place] = int(generator.integers(0, 256))
            path = tmp_path / f"b.{ending}"
            path.write_bytes(letters[: int(generator.integers(0, len(letters)))] if k % 2 else letters)
            try:
                read_flight(path)
            except RecordingError as error:
                refused += "\n" not in str(error)
    assert refused > 50


def test_a_flight_is_recorded_and_compared_by_its_file(tmp_path):
    path = _csv(tmp_path / "a.csv", HEADER, [TIME, *KM])
    other = tmp_path / "a.npz"
    np.savez(other, time_s=TIME, position_m=PLACE, velocity_m_s=SPEED)
    assert sailviz.record(path, tmp_path / "a.rrd").rows == 60
    assert sailviz.read(tmp_path / "a.rrd")["/state"]["position_m"] == pytest.approx(PLACE, rel=1e-12)
    assert sailviz.compare(path, other, atol={"": 1.0}).equal
    assert is_flight(path)
    assert not is_flight(Path("scene.toml"))
