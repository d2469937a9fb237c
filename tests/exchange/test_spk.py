"""SPK kernels: SPICE and jplephem read what is written, to the last digit; what is damaged is refused in a sentence."""

import sys
from contextlib import suppress

import numpy as np
import pytest

from sailviz import two_body
from sailviz.constants import AU, DAY, MU_EARTH, MU_SUN
from sailviz.errors import RecordingError
from sailviz.exchange import daf, spk
from sailviz.exchange.spice import read_segments
from sailviz.recording.flights import read_flight

START = 8.274e8  # s of TDB after J2000


def arc(rows, step=60.0, start=START):
    """A stretch of an orbit of e = 0.1 round the Earth."""
    et = start + step * np.arange(rows)
    a, e = 8e6, 0.1
    r, v = [a * (1 - e), 0.0, 0.0], [0.0, 0.8 * np.sqrt(MU_EARTH / a * (1 + e) / (1 - e)), 0.6 * np.sqrt(MU_EARTH / a)]
    position, velocity = two_body.advance(np.tile(r, (rows, 1)), np.tile(v, (rows, 1)), et - start, MU_EARTH)
    return spk.Arc(et, position, velocity)


@pytest.fixture
def spice():
    spiceypy = pytest.importorskip("spiceypy")
    yield spiceypy
    spiceypy.kclear()


@pytest.mark.parametrize("kind", [spk.HERMITE, spk.LAGRANGE])
@pytest.mark.parametrize("rows", [2, 5, 8, 100, 101, 200, 1001])
def test_spice_reads_every_row_back(spice, kind, rows, tmp_path):
    """The numbers to the last bit; what SPICE's own interpolation makes of them at a row to its rounding."""
    flown = arc(rows)
    path = str(tmp_path / "a.bsp")
    spk.write_spk(path, [flown], centre=399, name="a craft", kind=kind)
    states = np.hstack([flown.position, flown.velocity]) / 1e3
    handle = spice.dafopr(path)
    spice.dafbfs(handle)
    assert spice.daffna()
    doubles, integers = spice.dafus(spice.dafgs(5), 2, 6)
    array = spice.dafgda(handle, int(integers[4]), int(integers[5]))
    spice.dafcls(handle)
    assert (*doubles, *integers[:4]) == (flown.et[0], flown.et[-1], spk.CRAFT, 399, 1, kind)
    assert np.array_equal(array[: 6 * rows].reshape(rows, 6), states)
    assert np.array_equal(array[6 * rows : 7 * rows], flown.et)
    spice.furnsh(path)
    found = np.array([spice.spkez(spk.CRAFT, et, "J2000", "NONE", 399)[0] for et in flown.et])
    assert np.abs(found - states)[:, :3].max() <= 4 * np.spacing(7e3)  # km
    assert np.abs(found - states)[:, 3:].max() <= 1e-13  # km/s


def test_spice_flies_between_the_rows_as_the_orbit_does(spice, tmp_path):
    flown, finer = arc(200), arc(398, step=30.0)
    for kind, within in ((spk.HERMITE, 1e-3), (spk.LAGRANGE, 1e-1)):  # m: degree 15 and 7, 120 rows in a revolution
        spk.write_spk(tmp_path / f"{kind}.bsp", [flown], centre=399, kind=kind)
        spice.furnsh(str(tmp_path / f"{kind}.bsp"))
        states = np.array([spice.spkez(spk.CRAFT, et, "J2000", "NONE", 399)[0] for et in finer.et])
        assert np.abs(1e3 * states[:, :3] - finer.position).max() < within
        spice.kclear()


def test_spice_knows_segments_comments_and_turns_the_ecliptic(spice, tmp_path):
    path = tmp_path / "a.bsp"
    arcs = [arc(9, start=START + 1e5 * k) for k in range(60)]  # more than two records of summaries
    comments = ["first line", "", "x" * 900, "y" * 900, "the last"]
    spk.write_spk(path, arcs, centre=10, frame="ECLIPJ2000", target=-42, name="kite", comments=comments)
    spice.furnsh(str(path))
    assert list(spice.spkobj(str(path))) == [-42]
    cover = spice.spkcov(str(path), -42)
    assert spice.wncard(cover) == 60
    assert spice.wnfetd(cover, 59) == (arcs[59].et[0], arcs[59].et[-1])
    handle = spice.dafopr(str(path))
    count, lines, done = spice.dafec(handle, 10, lenout=1000)
    assert (count, list(lines[:count]), done) == (5, comments, True)
    spice.dafcls(handle)
    own = spice.spkez(-42, arcs[3].et[4], "ECLIPJ2000", "NONE", 10)[0]
    turned = spice.pxform("ECLIPJ2000", "J2000", 0.0) @ own[:3]
    assert np.allclose(spice.spkez(-42, arcs[3].et[4], "J2000", "NONE", 10)[0][:3], turned, rtol=1e-15)
    assert np.abs(own[:3] - arcs[3].position[4] / 1e3).max() <= 4 * np.spacing(7e3)  # km


def test_a_date_means_the_same_moment_as_in_spice(spice, tmp_path):
    """TDB less TT by the constants of NAIF's leap-second kernels."""
    kernel = tmp_path / "one.tls"
    kernel.write_text(
        "KPL/LSK\n\\begindata\nDELTET/DELTA_T_A = 32.184\nDELTET/K = 1.657D-3\nDELTET/EB = 1.671D-2\n"
        "DELTET/M = ( 6.239996D0 1.99096871D-7 )\nDELTET/DELTA_AT = ( 37, @2017-JAN-1 )\n\\begintext\n"
    )
    spice.furnsh(str(kernel))
    for tt in (6e8, START, 9e8):
        assert spk.tdb_less_tt(tt) == pytest.approx(spice.unitim(tt, "TT", "TDB") - tt, abs=2.5e-7)  # ulps of 9e8


def test_jplephem_reads_the_same_arrays(tmp_path):
    reader = pytest.importorskip("jplephem.daf")
    flown = arc(250)
    spk.write_spk(tmp_path / "a.bsp", [flown], centre=399, name="a craft", comments=["a comment"])
    with open(tmp_path / "a.bsp", "rb") as file:
        found = reader.DAF(file)
        assert found.comments().strip() == "a comment"
        ((name, values),) = found.summaries()
        assert name.strip() == b"a craft"
        assert values[:6] == (flown.et[0], flown.et[-1], spk.CRAFT, 399, 1, 13)
        array = np.array(found.read_array(values[6], values[7]))
    states = np.hstack([flown.position, flown.velocity]) / 1e3
    assert np.array_equal(array[: 6 * 250].reshape(250, 6), states)
    assert np.array_equal(array[1500:1750], flown.et)
    assert array[1750:].tolist() == [flown.et[99], flown.et[199], 7.0, 250.0]


@pytest.mark.parametrize(("kind", "within"), [(spk.HERMITE, 9e-8), (spk.LAGRANGE, 1.35e-7)])
def test_a_day_between_rows_round_the_sun_costs_a_tenth_of_a_millimetre(spice, kind, within, tmp_path):
    """A circle at 0.9 au: at the rows an ulp of 1.3e8 km and some 1e-13 km/s, between them 9e-8 and 1.3e-7 km."""
    radius, rows = 0.9 * AU, 60
    et = START + DAY * np.arange(0.0, rows, 0.5)
    rate = np.sqrt(MU_SUN / radius**3)
    angle = rate * (et - START)
    c, s = np.cos(angle), np.sin(angle)
    place = radius * np.column_stack([c, s, 0 * c])
    speed = radius * rate * np.column_stack([-s, c, 0 * c])
    path = tmp_path / "a.bsp"
    spk.write_spk(path, [spk.Arc(et[::2], place[::2], speed[::2])], centre=10, kind=kind)
    spice.furnsh(str(path))
    found = np.array([spice.spkez(spk.CRAFT, moment, "J2000", "NONE", 10)[0] for moment in et[:-1]])
    off = np.linalg.norm(found - np.hstack([place, speed])[:-1] / 1e3, axis=1)
    assert np.abs(found[::2, :3] - place[::2] / 1e3).max() <= 5e-8
    assert np.abs(found[::2, 3:] - speed[::2] / 1e3).max() <= 2e-13
    assert off[9:-9:2].max() < within


def test_a_kernel_without_rows_is_read_by_spice(spice, tmp_path, monkeypatch):
    """Type 15, a conic that its own parameters say; without the extra it is named."""
    path = str(tmp_path / "a.bsp")
    handle = spice.spkopn(path, "test", 0)
    mu, a, e = MU_EARTH / 1e9, 8e3, 0.1
    span = 2e4
    axes = [0, 0, 1], [1, 0, 0]
    shape = a * (1 - e * e), e, 0, [0, 0, 1], mu, 0.0, 6378.0
    spice.spkw15(handle, -55, 399, "J2000", START, START + span, "conic", START, *axes, *shape)
    spice.spkcls(handle)
    (found,) = read_segments(path)
    assert (found.target, found.centre, found.frame, found.kind) == (-55, 399, "J2000", 15)
    count = len(found.et)
    assert 300 < count < 600  # 120 in a revolution and more, of 7121 s, by the fastest pace
    r = [1e3 * a * (1 - e), 0.0, 0.0]
    v = [0.0, 1e3 * np.sqrt(mu / a * (1 + e) / (1 - e)), 0.0]
    place, speed = two_body.advance(np.tile(r, (count, 1)), np.tile(v, (count, 1)), found.et - START, MU_EARTH)
    assert np.abs(found.position - place).max() < 1e-2  # m: an ulp of 26 years at 8 km/s
    assert np.abs(found.velocity - speed).max() < 1e-5
    assert len(read_flight(path)) == count
    monkeypatch.setitem(sys.modules, "spiceypy", None)
    with pytest.raises(RecordingError, match=r"type 15, which SPICE reads: pip install .sailviz\[spice\]"):
        read_segments(path)


@pytest.mark.parametrize("kind", [spk.HERMITE, spk.LAGRANGE])
def test_what_was_written_is_read(kind, tmp_path):
    arcs = [arc(3), arc(150, start=START + 1e4)]
    spk.write_spk(tmp_path / "a.bsp", arcs, centre=399, name="kite", kind=kind)
    found = spk.read_spk(tmp_path / "a.bsp")
    assert [(s.name, s.target, s.centre, s.frame, s.kind) for s in found] == [("kite", -910001, 399, "J2000", kind)] * 2
    for given, back in zip(arcs, found, strict=True):
        assert np.array_equal(back.et, given.et)
        assert np.abs(back.position - given.position).max() <= np.spacing(1e7)
        assert np.abs(back.velocity - given.velocity).max() <= np.spacing(1e4)


def test_rows_of_other_types_and_byte_orders_are_read(spice, tmp_path):
    flown = arc(330)
    states = np.hstack([flown.position, flown.velocity]) / 1e3
    handle = spice.spkopn(str(tmp_path / "s.bsp"), "other", 0)
    ends = flown.et[0], flown.et[-1]
    spice.spkw05(handle, -5, 399, "J2000", *ends, "five", MU_EARTH / 1e9, 330, states, flown.et)
    spice.spkw08(handle, -8, 399, "J2000", *ends, "eight", 7, 330, states, flown.et[0], 60.0)
    spice.spkw09(handle, -9, 399, "J2000", *ends, "nine", 7, 330, states, flown.et)
    spice.spkw13(handle, -13, 399, "ECLIPJ2000", *ends, "thirteen", 7, 330, states, flown.et)
    spice.spkcls(handle)
    found = spk.read_spk(tmp_path / "s.bsp")
    assert [segment.kind for segment in found] == [5, 8, 9, 13]
    assert found[3].frame == "ECLIPJ2000"
    for segment in found:
        assert np.array_equal(segment.position, 1e3 * states[:, :3])
        assert np.abs(segment.et - flown.et).max() <= np.spacing(START)
    other = _big_endian((tmp_path / "s.bsp").read_bytes())
    (tmp_path / "big.bsp").write_bytes(other)
    for segment, same in zip(spk.read_spk(tmp_path / "big.bsp"), found, strict=True):
        assert np.array_equal(segment.position, same.position)


def _big_endian(data):
    """The same file as a machine of the other byte order has it: one summary record, no comments."""
    words = bytearray(np.frombuffer(data, "<f8").byteswap().tobytes())
    words[:1024] = data[:1024]
    for at in (8, 12, 76, 80, 84):
        words[at : at + 4] = data[at : at + 4][::-1]
    words[88:96] = b"BIG-IEEE"
    first = int.from_bytes(data[76:80], "little")
    summaries = (first - 1) * 1024
    for k in range(25):
        for at in range(summaries + 24 + 40 * k + 16, summaries + 24 + 40 * k + 40, 4):
            words[at : at + 4] = data[at : at + 4][::-1]
    words[first * 1024 : (first + 1) * 1024] = data[first * 1024 : (first + 1) * 1024]
    return bytes(words)


@pytest.mark.parametrize(
    ("spoil", "word"),
    [
        (lambda data: data[:700], "is cut off"),
        (lambda data: data[: len(data) - 2048], "cut off or damaged"),
        (lambda data: b"DAFETF NAIF DAF" + data[15:], "transfer form"),
        (lambda data: b"PK" + data[2:], "no binary kernel"),
        (lambda data: data[:88] + b"VAX-GFLT" + data[96:], "form that is not known"),
        (lambda data: data.replace(b"FTPSTR:\r", b"FTPSTR:\n"), "transferred as text"),
        (lambda data: data[:76] + b"\xff\xff\xff\x7f" + data[80:], "names a record"),
        (lambda data: data[:76] + b"\0\0\0\0" + data[80:], "names a record"),
        (lambda data: data[:1024] + np.array([2.0]).tobytes() + data[1032:], "names a record 2"),
        (lambda data: data[:1040] + np.array([99.0]).tobytes() + data[1048:], "holds no summaries"),
        (lambda data: data.replace(b"DAF/SPK ", b"DAF/CK  "), "is a CK kernel"),
        (lambda data: data[:1076] + b"\x02\0\0\0" + data[1080:], "no segment of type"),
    ],
)
def test_a_spoilt_kernel_is_refused_in_one_sentence(spoil, word, tmp_path):
    path = tmp_path / "a.bsp"
    spk.write_spk(path, [arc(300)], centre=399)
    path.write_bytes(spoil(path.read_bytes()))
    with pytest.raises(RecordingError, match=word) as error:
        spk.read_spk(path)
    assert "\n" not in str(error.value)


def test_no_spoilt_byte_ends_in_a_traceback(tmp_path):
    path = tmp_path / "a.bsp"
    spk.write_spk(path, [arc(20)], centre=399)
    whole = path.read_bytes()
    dice = np.random.default_rng(1)
    for _ in range(300):
        spoilt = bytearray(whole)
        for at in dice.integers(0, [1024, 2048, len(whole)][int(dice.integers(3))], 4):
            spoilt[at] = int(dice.integers(256))
        path.write_bytes(bytes(spoilt[: len(spoilt) - int(dice.integers(2)) * int(dice.integers(len(spoilt)))]))
        with suppress(RecordingError):
            spk.read_spk(path)


def test_what_no_kernel_can_say_is_refused(tmp_path):
    good = arc(9)
    backwards = spk.Arc(good.et[::-1], good.position, good.velocity)
    for arcs, more, word in (
        ([good], {"target": 5}, "NAIF id of a craft is negative"),
        ([good], {"kind": 2}, "type 13 or 9"),
        ([good], {"frame": "TEME"}, "J2000 or ECLIPJ2000"),
        ([backwards], {}, "in order of time"),
        ([spk.Arc(good.et[:1], good.position[:1], good.velocity[:1])], {}, "two rows"),
        ([spk.Arc(good.et, good.position * np.nan, good.velocity)], {}, "finite"),
        ([], {}, "two rows"),
    ):
        with pytest.raises(RecordingError, match=word):
            spk.write_spk(tmp_path / "a.bsp", arcs, centre=399, **more)
    assert not list(tmp_path.iterdir())


def test_other_array_files_go_through_whole(tmp_path):
    given = [daf.Array(f"array {k}", (1.0 * k, 2.0 * k), (k, -k, 3, 1), np.arange(1.0 + k)) for k in range(1, 30)]
    daf.write(tmp_path / "a.ck", "CK", given, "attitude", ["one", "two"])
    found = daf.read(tmp_path / "a.ck")
    assert (found.kind, found.internal_name, found.comments) == ("CK", "attitude", ("one", "two"))
    for one, other in zip(given, found.arrays, strict=True):
        assert (one.name, one.span, one.numbers) == (other.name, other.span, other.numbers)
        assert np.array_equal(one.values, other.values)
