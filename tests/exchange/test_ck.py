"""CK kernels: SPICE reads back how the craft stood and turned, and knows where nothing is said; damage is refused."""

import numpy as np
import pytest

import sailviz
from sailviz import frames
from sailviz.errors import RecordingError
from sailviz.exchange import ck, daf, spk
from sailviz.recording import export, record
from sailviz.recording.attitude_files import product
from sailviz.sky import Sky

START = 8.274e8  # s of TDB after J2000
RATE = np.array([2e-4, -3e-4, 5e-4])  # rad/s, of the frame


def quaternion(axis, angle):
    """(n, 4) x y z w of turns about one axis."""
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    return np.column_stack([np.sin(angle / 2)[:, None] * axis, np.cos(angle / 2)])


def spinning(rows, start=START, step=60.0):
    """An even spin about an axis of the frame, from an attitude of its own."""
    et = start + step * np.arange(rows)
    spin = quaternion(RATE, np.linalg.norm(RATE) * (et - start))
    first = np.tile(np.array([0.1, 0.7, -0.5, 0.5]) / np.linalg.norm([0.1, 0.7, -0.5, 0.5]), (rows, 1))
    return ck.Pointing(et, product(spin, first))


@pytest.fixture
def spice():
    spiceypy = pytest.importorskip("spiceypy")
    yield spiceypy
    spiceypy.kclear()


def furnished(spice, folder, pointings, craft=spk.CRAFT, **more):
    ck.write_ck(folder / "a.bc", pointings, craft=craft, **more)
    ck.write_clock(folder / "a.tsc", craft, ck.clock_start(pointings[0].et[0]))
    ck.write_frame(folder / "a.tf", craft)
    for ending in ("bc", "tsc", "tf"):
        spice.furnsh(str(folder / f"a.{ending}"))


@pytest.mark.parametrize(("rows", "start", "craft"), [(1, START, -910001), (2, START, -77), (101, -3e8, -910001),
                                                      (1001, START, -2147483)])  # fmt: skip
def test_spice_finds_the_craft_as_it_stood_and_turned(spice, tmp_path, rows, start, craft):
    """At the rows and between them, by the frame and by the instrument, before J2000 too."""
    flown = spinning(rows, start)
    furnished(spice, tmp_path, [flown], craft, name="a spin")
    finer = spinning(2 * rows - 1, start, 30.0)
    axes = frames.rotation(finer.quaternion)
    for row, et in enumerate(finer.et):
        to_world = spice.pxform(ck.frame_name(craft), "J2000", et)
        assert np.abs(to_world - axes[row]).max() < 1e-12
    matrix, turning, _ = spice.ckgpav(1000 * craft, spice.sce2c(craft, flown.et[-1]), 0.0, "J2000")
    assert np.abs(matrix - axes[-1].T).max() < 1e-12  # from the frame to the craft
    assert np.abs(turning - (RATE if rows > 1 else 0.0)).max() < 1e-12
    assert spice.namfrm(ck.frame_name(craft)) in (1910001, 1000 * craft)


def test_spice_turns_from_the_ecliptic_and_back(spice, tmp_path):
    flown = spinning(5)
    furnished(spice, tmp_path, [flown], frame="ECLIPJ2000")
    own = spice.pxform("SAIL_BODY", "ECLIPJ2000", flown.et[2])
    assert np.abs(own - frames.rotation(flown.quaternion[2])).max() < 1e-12
    home = spice.pxform("ECLIPJ2000", "J2000", 0.0) @ own
    assert np.abs(spice.pxform("SAIL_BODY", "J2000", flown.et[2]) - home).max() < 1e-12


def test_spice_finds_nothing_between_intervals(spice, tmp_path):
    """150 of them, more than a directory's stretch."""
    pointings = [spinning(3, START + 1000.0 * k) for k in range(150)]
    furnished(spice, tmp_path, pointings)
    cover = spice.ckcov(str(tmp_path / "a.bc"), 1000 * spk.CRAFT, False, "INTERVAL", 0.0, "TDB")
    assert spice.wncard(cover) == 150
    assert spice.wnfetd(cover, 149) == pytest.approx((pointings[149].et[0], pointings[149].et[-1]), abs=2e-7)
    axes = frames.rotation(pointings[70].quaternion[1])
    assert np.abs(spice.pxform("SAIL_BODY", "J2000", pointings[70].et[1]) - axes).max() < 1e-12
    with pytest.raises(spice.utils.exceptions.SpiceyError):
        spice.pxform("SAIL_BODY", "J2000", pointings[70].et[-1] + 100.0)


def test_what_was_written_is_read(tmp_path):
    pointings = [spinning(250), spinning(1, START + 1e5)]
    (found,) = ck.read_ck(ck.write_ck(tmp_path / "a.bc", pointings, name="a craft"))
    assert (found.name, found.instrument, found.frame, found.begins) == ("a craft", -910001000, "J2000", (0, 250))
    assert np.array_equal(found.ticks, np.concatenate([one.et for one in pointings]) * 1e6)
    assert np.abs(found.quaternion - np.concatenate([one.quaternion for one in pointings])).max() < 4e-16
    assert np.abs(found.rates[:250] - RATE).max() < 1e-12
    assert not found.rates[250].any()


def test_rates_of_a_turn_that_speeds_up_err_by_the_square_of_the_step():
    """Angle t^3 about one axis: of the parabola through three rows h^2 is left in the middle, 2 h^2 at the ends."""
    et = np.linspace(0.0, 1.0, 101)
    found = ck.rates(et, quaternion([0, 0, 1], et**3))
    error = np.abs(found - np.column_stack([0 * et, 0 * et, 3 * et**2]))[:, 2]
    assert error[1:-1].max() < 1.01e-4
    assert error.max() < 2.1e-4
    assert np.array_equal(ck.rates(et, np.tile([0.0, 0, 0, 1], (101, 1))), np.zeros((101, 3)))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda et, q: (et[::-1], q), "increase in time"),
        (lambda et, q: (et, 1.1 * q), "length 1"),
        (lambda et, q: (et, q * np.nan), "length 1"),
        (lambda et, q: (et[:0], q[:0]), "needs a row"),
        (lambda et, q: (et + 9e9, q), "reaches from"),
        (lambda et, q: (et - 9e9, q), "reaches from"),
    ],
)
def test_what_a_kernel_cannot_say_is_refused(tmp_path, change, words):
    flown = spinning(5)
    with pytest.raises(RecordingError, match=words):
        ck.write_ck(tmp_path / "a.bc", [ck.Pointing(*change(flown.et, flown.quaternion))])
    for craft in (0, 5, -2147484):
        with pytest.raises(RecordingError, match="NAIF id"):
            ck.write_ck(tmp_path / "a.bc", [flown], craft=craft)
    assert not list(tmp_path.iterdir())


def test_damaged_kernels_are_read_or_refused_in_one_sentence(tmp_path):
    path = ck.write_ck(tmp_path / "a.bc", [spinning(20), spinning(9, START + 1e5)])
    spk.write_spk(tmp_path / "a.bsp", [spk.Arc(np.arange(3.0), np.ones((3, 3)), np.ones((3, 3)))], centre=10)
    with pytest.raises(RecordingError, match="is a SPK kernel, not a CK"):
        ck.read_ck(tmp_path / "a.bsp")
    daf.write(tmp_path / "b.bc", "CK", [daf.Array("x", (0.0, 1.0), (-5000, 1, 2, 1), np.ones(30))])
    with pytest.raises(RecordingError, match="no segment of type 3, whose rows are read here; it has: 2"):
        ck.read_ck(tmp_path / "b.bc")
    content, generator, refused = path.read_bytes(), np.random.default_rng(5), 0
    for k in range(200):
        letters = bytearray(content)
        for place in generator.integers(0, len(letters), 4):
            letters[place] = int(generator.integers(0, 256))
        path.write_bytes(letters[: int(generator.integers(0, len(letters)))] if k % 2 else letters)
        try:
            ck.read_ck(path)
        except RecordingError as error:
            refused += "\n" not in str(error)
    assert refused > 100


SCENE = {
    "title": "Seen from the Earth",
    "body": "earth",
    "epoch": "2026-03-20T00:00:00",
    "start": {
        "kind": "cartesian", "position_km": [42164.169, 0, 0], "velocity_km_s": [0, 3.0746660 * np.sqrt(0.75), 1.5373],
    },
    "device": {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 0.1},
    "steering": {"kind": "sun-frame", "pitch_deg": 35.0, "clock_deg": 90.0},
    "propagation": {"duration_d": 1.2, "outputs": 60},
}  # fmt: skip


@pytest.fixture(scope="module")
def run():
    return sailviz.simulate(SCENE)


@pytest.mark.parametrize("frame", ["", "ECLIPJ2000"])
def test_an_exported_attitude_is_that_of_the_run_in_spice(spice, run, tmp_path, frame):
    """By the matrices of the run itself, turned to the axes of the kernel."""
    record(run, tmp_path / "a.rrd")
    files = export(tmp_path / "a.rrd", tmp_path / "a.bc", frame=frame)
    assert [file.name for file in files] == ["a.bc", "a.tsc", "a.tf"]
    for file in files:
        spice.furnsh(str(file))
    et = spk.seconds_of_tdb(np.datetime64(SCENE["epoch"], "ns"), run.time)
    own = frames.icrf_to("equator-of-date", Sky(np.datetime64(SCENE["epoch"], "ns")).centuries)
    home = own.T if not frame else frames.icrf_to("ecliptic-j2000") @ own.T
    for row in (0, 17, 59):
        found = spice.pxform("SAIL_BODY", frame or "J2000", et[row])
        assert np.abs(found - home @ frames.rotation(run.attitude.quaternion[row])).max() < 1e-12
        assert np.abs(found[:, 2] - home @ run.attitude.normal[row]).max() < 1e-12


def test_where_the_attitude_jumps_both_sides_are_there_and_a_stowed_sail_has_none(spice, tmp_path):
    """A tick apart; across the jump, in gaps and while the sail is stowed SPICE finds nothing."""
    time = np.array([0.0, 100, 200, 200, 300, 400, 500, 600, 700, 2000, 2100])
    place = np.column_stack([7e6 * np.cos(time * 1e-3), 7e6 * np.sin(time * 1e-3), 0 * time])
    speed = np.column_stack([-7e3 * np.sin(time * 1e-3), 7e3 * np.cos(time * 1e-3), 0 * time])
    normal = np.array([[1.0, 0, 0]] * 3 + [[0.0, 1, 0]] * 8)
    speed[3:] *= 1.001
    normal[6:8] = 0.0
    run = sailviz.run.trajectory(
        time, place, speed, mu=3.986e14, body="Earth", epoch="2026-03-20", normal=normal, gaps=[(700.0, 2000.0)]
    )
    for file in export(run, tmp_path / "a.bc"):
        spice.furnsh(str(file))
    et = spk.seconds_of_tdb(np.datetime64("2026-03-20", "ns"), time)
    cover = spice.ckcov(str(tmp_path / "a.bc"), -910001000, False, "INTERVAL", 0.0, "TDB")
    spans = [spice.wnfetd(cover, k) for k in range(spice.wncard(cover))]
    due = [(et[0], et[2] - 1e-6), (et[3], et[5]), (et[8], et[8]), (et[9], et[10])]
    assert np.array(spans) == pytest.approx(np.array(due), abs=3e-7)
    before, after = (spice.pxform("SAIL_BODY", "J2000", moment)[:, 2] for moment in (et[2] - 1e-6, et[3]))
    assert abs(np.dot(before, after)) < 1e-3
    (segment,) = ck.read_ck(tmp_path / "a.bc")
    assert len(segment.ticks) == 9


def test_a_clock_and_a_centre_that_have_no_place_are_refused(run, tmp_path):
    with pytest.raises(RecordingError, match="no place for a centre_id"):
        export(run, tmp_path / "a.bc", centre_id=10)
    with pytest.raises(RecordingError, match=r"a CK's name ends in \.bc"):
        export(run, tmp_path / "a.tsc", to="ck")
    with pytest.raises(RecordingError, match="a CK is written in J2000 or ECLIPJ2000, not in TEME"):
        export(run, tmp_path / "a.bc", frame="TEME")
    with pytest.raises(RecordingError, match="a CK holds the attitude; it takes no other entity"):
        export(run, tmp_path / "a.bc", entities=["/state"])
    assert not list(tmp_path.iterdir())
