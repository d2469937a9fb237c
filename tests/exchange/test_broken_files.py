"""Broken siblings of every format that is read are understood, or refused in one sentence; nothing else comes out.

Good files go bad: cut, bytes and words changed, lines doubled, lost and in another order, numbers and units that do not
belong there.
"""

from __future__ import annotations

import json
import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from sailviz import two_body
from sailviz.cli.entry import main
from sailviz.constants import MU_EARTH
from sailviz.errors import RecordingError
from sailviz.exchange import ck, spk
from sailviz.exchange.aem import read_aem
from sailviz.exchange.apm import read_apm
from sailviz.exchange.element_sets import read_element_sets
from sailviz.exchange.opm import read_opm
from sailviz.recording.flights import read_flight

WORDS = (
    b"nan", b"inf", b"-inf", b"1e400", b"1e308", b"-1e308", b"0", b"-1", b"1_0", b"0x10", b"7D3", b"", b"km", b"[m]",
    b"[au]",
    b"2026-13-45T99:99:99", b"2016-12-31T23:59:60", b"9999-12-31T00:00:00", b"0001-01-01T00:00:00",
    b"2026-366T00:00:00",
    b"MRT", b"RTN", b"ITRF", b"EULER_ANGLE", b"99999999999999999999", b"\xff\xfe", b"\xe2\x88\x92" b"1", b"=",
    b"META_START",
    b"<x>", b"&a;", b"<!DOCTYPE x>", b"\x00", b"\"", b",", b";", b"\r", b"9" * 400,
)  # fmt: skip


def broken(content: bytes, generator: np.random.Generator) -> bytes:
    """A file gone bad, in one to three ways."""
    for _ in range(int(generator.integers(1, 4))):
        content = WAYS[int(generator.integers(len(WAYS)))](content, generator)
    return content


def _cut(content, generator):
    return content[: int(generator.integers(0, len(content) + 1))]


def _bytes(content, generator):
    letters = bytearray(content or b"x")
    for place in generator.integers(0, len(letters), int(generator.integers(1, 6))):
        letters[place] = int(generator.integers(0, 256))
    return bytes(letters)


def _bits(content, generator):
    letters = bytearray(content or b"x")
    letters[int(generator.integers(len(letters)))] ^= 1 << int(generator.integers(8))
    return bytes(letters)


def _word(content, generator):
    """One word, number or tag for another."""
    found = list(re.finditer(rb"[^\s=,<>\[\]]+", content[:20_000]))
    if not found:
        return content
    one = found[int(generator.integers(len(found)))]
    return content[: one.start()] + WORDS[int(generator.integers(len(WORDS)))] + content[one.end() :]


def _lines(content, generator):
    """A line twice, lost, or elsewhere."""
    lines = content.split(b"\n")
    k, m = (int(one) for one in generator.integers(0, len(lines), 2))
    kind = int(generator.integers(3))
    if kind == 0:
        lines.insert(m, lines[k])
    elif kind == 1:
        del lines[k]
    else:
        lines[k], lines[m] = lines[m], lines[k]
    return b"\n".join(lines)


def _units(content, generator):
    """One unit, in brackets, in an attribute or in a name, for another."""
    found = list(
        re.finditer(rb"(?<=\[)[\w/*]+(?=\])|(?<=units=.)[\w/*]+|(?<=_)(?:km_s|km|s)(?=[,\n])", content[:20_000])
    )
    if not found:
        return content
    one = found[int(generator.integers(len(found)))]
    other = (b"m", b"au", b"m/s", b"rad", b"deg", b"km_h", b"d", b"km/day", b"ft")[int(generator.integers(9))]
    return content[: one.start()] + other + content[one.end() :]


def _spliced(content, generator):
    """A stretch of itself in the middle."""
    a, b, c = (int(one) for one in np.sort(generator.integers(0, len(content) + 1, 3)))
    return content[:a] + content[b:c] + content[a:]


WAYS = (_cut, _bytes, _bits, _word, _word, _lines, _units, _spliced)

TIME = np.arange(24) * 60.0
META = """OBJECT_NAME = CRAFT
OBJECT_ID = 2026-001A
CENTER_NAME = EARTH
REF_FRAME = EME2000
TIME_SYSTEM = UTC
"""
KEYS = ("X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT")
UNITS = ("km", "km", "km", "km/s", "km/s", "km/s")


def good_files(folder: Path) -> dict[str, Path]:
    """One of each kind, by its name; those that hold a flight have the ending by which they are read."""
    place, speed = two_body.advance(
        np.tile([7e6, 0.0, 0.0], (24, 1)), np.tile([0.0, 7e3, 2e3], (24, 1)), TIME, MU_EARTH
    )  # fmt: skip
    states = np.hstack([place, speed]) / 1e3
    epochs = [f"2026-04-01T00:{k:02d}:00.000" for k in range(24)]
    rows = [f"{epoch} " + " ".join(f"{one:.9f}" for one in state) for epoch, state in zip(epochs, states, strict=True)]
    texts = {
        "a.oem": "\n".join(["CCSDS_OEM_VERS = 2.0", "META_START", META + "META_STOP", *rows[:12], "META_START",
                            META + "META_STOP", *rows[12:], ""]),
        "b.oem": _xml("oem", META, "".join(_vector(epoch, state) for epoch, state in zip(epochs, states, strict=True))),
        "a.opm": "\n".join(["CCSDS_OPM_VERS = 2.0", META + f"EPOCH = {epochs[0]}",
                            *(f"{k} = {one:.9f} [{u}]" for k, one, u in zip(KEYS, states[0], UNITS, strict=True)),
                            "MASS = 12.5 [kg]", ""]),
        "b.opm": _xml("opm", META, _vector(epochs[0], states[0])
                      + '<spacecraftParameters>\n<MASS units="kg">12</MASS>\n</spacecraftParameters>\n'),
        "a.csv": "time_s,x_km,y_km,z_km,vx_km_s,vy_km_s,vz_km_s\n"
                 + "\n".join(f"{t}," + ",".join(f"{one:.9f}" for one in state)
                             for t, state in zip(TIME, states, strict=True)),
    }  # fmt: skip
    attitude = META.replace("REF_FRAME = EME2000", "REF_FRAME_A = EME2000\nREF_FRAME_B = SC_BODY_1")
    attitude = attitude.replace("CENTER_NAME = EARTH\n", "")
    kind = "ATTITUDE_TYPE = QUATERNION\n"
    turns = [f"{epoch} 0.0 0.0 {np.sin(k / 50):.12f} {np.cos(k / 50):.12f}" for k, epoch in enumerate(epochs)]
    texts["a.aem"] = "\n".join(["CCSDS_AEM_VERS = 2.0", "META_START", attitude + kind + "META_STOP", "DATA_START",
                                *turns, "DATA_STOP", ""])  # fmt: skip
    texts["b.aem"] = _xml("aem", attitude + kind, "".join(map(_turn, turns)))
    texts["a.apm"] = "\n".join(["CCSDS_APM_VERS = 2.0", "META_START", "OBJECT_NAME = A", "OBJECT_ID = B",
                                "TIME_SYSTEM = UTC",
                                "META_STOP", f"EPOCH = {epochs[0]}", "QUAT_START", "REF_FRAME_A = EME2000",
                                "REF_FRAME_B = SC_BODY_1", "Q1 = 0.0", "Q2 = 0.0", "Q3 = 0.6", "QC = 0.8", "QUAT_STOP",
                                ""])  # fmt: skip
    mean = {"EPOCH": epochs[0], "MEAN_MOTION": "15.1 [rev/day]", "ECCENTRICITY": "0.001", "INCLINATION": "97.5 [deg]",
            "RA_OF_ASC_NODE": "1.0 [deg]", "ARG_OF_PERICENTER": "2.0 [deg]", "MEAN_ANOMALY": "3.0 [deg]",
            "BSTAR": "0.0001"}  # fmt: skip
    teme = META.replace("EME2000", "TEME") + "MEAN_ELEMENT_THEORY = SGP4\n"
    texts["a.omm"] = "CCSDS_OMM_VERS = 2.0\n" + teme + "".join(f"{key} = {value}\n" for key, value in mean.items())
    bare = {key: value.split(" [")[0] for key, value in mean.items()}
    texts["b.omm"] = _xml("omm", teme, "<meanElements>\n" + _leaves(bare) + "</meanElements>\n")
    texts["c.omm"] = json.dumps([bare | {"OBJECT_NAME": "A"}], indent=1)
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="ascii")
    np.savez(folder / "a.npz", time_s=TIME, position_km=place / 1e3, velocity_km_s=speed / 1e3)
    import pyarrow as pa
    import pyarrow.parquet as parquet

    names = ["time_s", "x_km", "y_km", "z_km", "vx_km_s", "vy_km_s", "vz_km_s"]
    columns = [TIME, *states.T]
    parquet.write_table(pa.table(dict(zip(names, columns, strict=True))), folder / "a.parquet")
    spk.write_spk(folder / "a.bsp", [spk.Arc(TIME + 8e8, place, speed)], centre=399)
    ck.write_ck(folder / "a.bc", [ck.Pointing(TIME + 8e8, np.tile([0.0, 0.0, 0.6, 0.8], (24, 1)))])
    return {path.name: path for path in sorted(folder.iterdir())}


def _leaves(values):
    return "".join(f"<{key}>{value}</{key}>\n" for key, value in values.items())


def _vector(epoch, state):
    leaves = (f'<{k} units="{u}">{one:.9f}</{k}>\n' for k, one, u in zip(KEYS, state, UNITS, strict=True))
    return f"<stateVector>\n<EPOCH>{epoch}</EPOCH>\n{''.join(leaves)}</stateVector>\n"


def _turn(line):
    epoch, *numbers = line.split()
    leaves = _leaves(dict(zip(("Q1", "Q2", "Q3", "QC"), numbers, strict=True)))
    return f"<attitudeState>\n<quaternionEphemeris>\n<EPOCH>{epoch}</EPOCH>\n<quaternion>\n{leaves}</quaternion>\n" \
           "</quaternionEphemeris>\n</attitudeState>\n"  # fmt: skip


def _xml(kind, meta, data):
    leaves = _leaves(dict(line.split(" = ") for line in meta.splitlines()))
    return (f'<?xml version="1.0" encoding="UTF-8"?>\n<{kind} id="CCSDS_{kind.upper()}_VERS" version="2.0">\n<header>\n'
            f"</header>\n<body>\n<segment>\n<metadata>\n{leaves}</metadata>\n<data>\n{data}</data>\n</segment>\n</body>\n"
            f"</{kind}>\n")  # fmt: skip


FLIGHTS = (".oem", ".csv", ".npz", ".parquet", ".bsp")
READERS = dict.fromkeys(FLIGHTS, read_flight) | {
    ".opm": read_opm, ".aem": read_aem, ".apm": read_apm, ".bc": ck.read_ck, ".omm": read_element_sets,
}  # fmt: skip
NAMES = ("a.aem", "b.aem", "a.apm", "a.bc", "a.bsp", "a.csv", "a.npz", "a.oem", "b.oem", "a.omm", "b.omm", "c.omm",
         "a.opm", "b.opm", "a.parquet")  # fmt: skip
TRIES = 60


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    found = good_files(tmp_path_factory.mktemp("good"))
    assert set(found) == set(NAMES)
    return found


def refusal(reader, path):
    """What a reader says against a file; None where it reads it. Anything but its own refusal goes through."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            reader(path)
        except (RecordingError, ValueError) as error:
            return error
    return None


@pytest.mark.parametrize("name", NAMES)
def test_a_broken_file_is_read_or_refused_in_one_sentence(files, tmp_path, name):
    path, bad = files[name], tmp_path / name
    reader, content = READERS[path.suffix], path.read_bytes()
    reader(path)
    generator = np.random.default_rng([7, NAMES.index(name)])
    refused = 0
    for _ in range(TRIES):
        bad.write_bytes(broken(content, generator))
        error = refusal(reader, bad)
        if error is not None:
            assert isinstance(error, RecordingError) or path.suffix == ".omm"  # a scene's fault, told with its place
            assert "\n" not in str(error)
            assert len(str(error)) < 700
            refused += 1
    assert refused > TRIES / 2


@pytest.mark.parametrize("ending", FLIGHTS)
def test_a_flight_cut_in_two_ends_the_command_in_one_sentence(files, tmp_path, ending):
    content = files[f"a{ending}"].read_bytes()
    bad = tmp_path / f"cut{ending}"
    bad.write_bytes(content[: len(content) // 2 - 7])
    if ending in (".oem", ".csv"):  # what is there is whole but for its last line
        bad.write_bytes(content[: content.rindex(b"," if ending == ".csv" else b" ")])
    said = CliRunner().invoke(main, ["record", str(bad), "-o", str(tmp_path / "out.rrd")])
    assert said.exit_code == 2
    assert said.output.count("\n") == 1
    assert not (tmp_path / "out.rrd").exists()
