"""A folder for Cosmographia: documented keys only, kernels that SPICE reads, a mesh of the right size, and nothing of
what users wrote anywhere but as text."""

import json
import os
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import sailviz
from sailviz import frames
from sailviz.cli.entry import main
from sailviz.errors import OutputError, RecordingError
from sailviz.exchange import spk
from sailviz.recording import cosmographia, export
from sailviz.sky import Sky

EPOCH = "2026-03-20T00:00:00"
# The keys that cosmoguide.org documents: pages "Catalog List Catalog", "SPICE Data Catalog", "Spacecraft Catalog",
# "Geometry Types"; value: the type of what they hold, or the keys below.
CATALOGUE = {"version": str, "name": str, "require": [str], "spiceKernels": [str], "items": "item"}
ITEM = {
    "class": str, "name": str, "startTime": str, "endTime": str, "center": str,
    "trajectory": {"type": str, "target": str, "center": str},
    "bodyFrame": {"type": str, "name": str},
    "geometry": {"type": str, "size": float, "source": str,
                 "meshRotation": [float], "meshOffset": [float], "scale": float},
    "label": {"color": [float], "fadeSize": float, "showText": bool},
    "trajectoryPlot": {"visible": bool, "color": [float], "lineWidth": float, "opacity": float, "duration": str,
                       "lead": str, "fade": float, "sampleCount": int},
}  # fmt: skip


def scene(title="A sail", body="earth", **more):
    start = {"kind": "cartesian", "position_km": [42164.169, 0, 0], "velocity_km_s": [0, 2.6627, 1.5373]}
    if body == "sun":
        start = {"kind": "cartesian", "position_km": [149597870.7, 0, 0], "velocity_km_s": [0, 29.7847, 0]}
    device = {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 0.1}
    steering = {"kind": "sun-frame", "pitch_deg": 35.0, "clock_deg": 90.0} if body != "sun" else {"kind": "radial"}
    return {
        "title": title, "body": body, "epoch": EPOCH, "start": start, "device": device, "steering": steering,
        "propagation": {"duration_d": 1.2, "outputs": 60},
    } | more  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A flight whose title is meant to do harm."""
    place = tmp_path_factory.mktemp("cosmographia")
    run = sailviz.simulate(scene('"},{"class":"x"} <b>../..\\n</b>\n& \x1b[31mÅ Mars'))
    sailviz.record(run, place / "run.rrd")
    (load,) = export(place / "run.rrd", place / "out", to="cosmographia")
    assert load == place / "out" / "load.json"
    return run, place / "out"


def content(folder, name):
    return json.loads((folder / name).read_text(encoding="ascii"))


def held(value, wanted):
    """Fails for a key that is not documented, or a value of another kind."""
    if isinstance(wanted, dict):
        assert isinstance(value, dict)
        for key, inner in value.items():
            held(inner, wanted[key])
    elif isinstance(wanted, list):
        assert isinstance(value, list)
        for inner in value:
            held(inner, wanted[0])
    elif wanted == "item":
        for inner in value:
            held(inner, ITEM)
    else:
        assert isinstance(value, (int, float) if wanted is float else wanted)


def test_the_catalogues_hold_documented_keys_only(folder):
    _, place = folder
    for name in ("load.json", "kernels.json", "craft.json"):
        found = content(place, name)
        held(found, CATALOGUE)
        assert found["version"] == "1.0"
    assert content(place, "load.json")["require"] == ["kernels.json", "craft.json"]
    for name in content(place, "kernels.json")["spiceKernels"]:
        assert (place / name).is_file()
    (item,) = content(place, "craft.json")["items"]
    assert set(item) == {*ITEM}
    assert (item["class"], item["center"], item["bodyFrame"]["name"]) == ("spacecraft", "Earth", "SAIL_BODY")
    assert item["trajectory"] == {"type": "Spice", "target": "-910001", "center": "EARTH"}


def test_the_catalogues_have_the_keys_of_the_examples(folder):
    """Of the three files that Cosmographia's examples were made after."""
    _, place = folder
    examples = Path(__file__).parents[1] / "data" / "foreign"
    for ours, example in (("load", "load"), ("kernels", "spice"), ("craft", "sail")):
        theirs = json.loads((examples / f"cosmographia_{example}.json").read_text())
        held(theirs, CATALOGUE)
        assert set(theirs) <= set(content(place, f"{ours}.json"))
    assert set(content(place, "craft.json")["items"][0]) == set(theirs["items"][0])


def test_what_users_wrote_is_text_and_names_no_file(folder):
    _, place = folder
    assert {path.name for path in place.iterdir()} <= set(cosmographia.FILES)
    (item,) = content(place, "craft.json")["items"]
    assert item["name"] == "},{ class : x } b ../.. n /b [31mÅ Mars"
    assert not set(item["name"]) & set('<>&"\\\n\x1b')
    for name in ("craft.tf", "craft.tsc", "craft.obj", "craft.mtl"):
        assert "Mars" not in (place / name).read_text()
    assert cosmographia.shown_name(" MARS ") == "MARS (flight)"
    assert cosmographia.shown_name("<>") == "Flight"
    assert len(cosmographia.shown_name("x" * 999)) == 60


def test_spice_flies_the_craft_by_the_kernels_of_the_folder(folder):
    """In the order in which they are named, over the whole span of the catalogue."""
    spice = pytest.importorskip("spiceypy")
    run, place = folder
    (item,) = content(place, "craft.json")["items"]
    et = spk.seconds_of_tdb(np.datetime64(EPOCH, "ns"), run.time)
    home = frames.icrf_to("equator-of-date", Sky(np.datetime64(EPOCH, "ns")).centuries).T
    (place.parent / "one.tls").write_text(
        "KPL/LSK\n\\begindata\nDELTET/DELTA_T_A = 32.184\nDELTET/K = 1.657D-3\nDELTET/EB = 1.671D-2\n"
        "DELTET/M = ( 6.239996D0 1.99096871D-7 )\nDELTET/DELTA_AT = ( 37, @2017-JAN-1 )\n\\begintext\n"
    )
    try:
        spice.furnsh(str(place.parent / "one.tls"))
        for name in content(place, "kernels.json")["spiceKernels"]:
            spice.furnsh(str(place / name))
        for edge in ("startTime", "endTime"):
            moment = spice.str2et(item[edge])
            assert et[0] <= moment <= et[-1]
            assert min(abs(moment - et[0]), abs(moment - et[-1])) < 2e-3
            spice.spkezr(item["trajectory"]["target"], moment, "J2000", "NONE", item["trajectory"]["center"])
            spice.pxform(item["bodyFrame"]["name"], "J2000", moment)
        state = spice.spkezr("-910001", et[31], "J2000", "NONE", "EARTH")[0]
        assert np.linalg.norm(1e3 * state[:3] - home @ run.position[31]) < 1e-3  # m: an ulp of 26 years, at 3 km/s
        body = spice.pxform("SAIL_BODY", "J2000", et[31])
    finally:
        spice.kclear()
    assert np.abs(body[:, 2] - home @ run.attitude.normal[31]).max() < 1e-12


def obj(folder):
    """(corners, normals, [(material, faces)]) of an OBJ, checked as it is read."""
    v, vn, vt, groups = [], [], [], []
    for line in (folder / "craft.obj").read_text(encoding="ascii").splitlines():
        word, *rest = line.split() or [""]
        if word in ("v", "vn", "vt"):
            {"v": v, "vn": vn, "vt": vt}[word].append([float(one) for one in rest])
        elif word == "usemtl":
            groups.append((rest[0], []))
        elif word == "f":
            groups[-1][1].append([[int(one) if one else 0 for one in corner.split("/")] for corner in rest])
    return np.array(v), np.array(vn), np.array(vt), groups


def test_the_mesh_is_the_craft_that_is_drawn_in_metres(folder):
    _, place = folder
    v, vn, vt, groups = obj(place)
    materials = (place / "craft.mtl").read_text().split()
    assert {name for name, _ in groups} == {b for a, b in pairwise(materials) if a == "newmtl"}
    assert len(v) == len(vn)
    assert np.abs(np.linalg.norm(vn, axis=1) - 1).max() < 1e-4
    for name, faces in groups:
        numbers = np.array(faces)
        assert numbers[..., 0].max() <= len(v)
        assert numbers[..., 1].max() <= len(vt)
        a, b, c = (v[numbers[:, k, 0] - 1] for k in range(3))
        across = np.cross(b - a, c - a)
        seen = np.sum(across * vn[numbers[:, 0, 2] - 1], axis=1)
        assert np.mean(seen > 0) > 0.9, name  # fronts are where the normals point
    # the sunward side is the one against the normal
    lit = np.array(dict(groups)["film_lit"])[:, 0, 2] - 1
    assert vn[lit, 2].mean() < -0.8
    extent = np.ptp(v, axis=0).max()
    (item,) = content(place, "craft.json")["items"]
    assert item["geometry"]["size"] == pytest.approx(extent / 2000, rel=1e-5)  # km, of half of it
    assert 50.0 < extent < 90.0  # the scene says no size, so a side of 50 m, corner to corner 71 m and vanes
    assert "does not say how large" in (place / "README.txt").read_text()


def test_the_film_has_a_texture_with_its_seams(folder):
    from PIL import Image

    _, place = folder
    assert "map_Kd film_lit.png" in (place / "craft.mtl").read_text()
    image = np.asarray(Image.open(place / "film_lit.png"))
    assert image.shape == (512, 512, 3)
    assert 0.005 < np.mean(np.any(image != image[0, 0], axis=-1)) < 0.2


def test_each_kind_of_craft_has_its_mesh_and_gaps_make_several(tmp_path):
    """An E-sail by its tethers, a sail by its side, a body without a device by none; named by its centre."""
    sail = scene(device={"kind": "solar-sail", "area_m2": 400.0, "mass_kg": 10.0})
    none = scene(device={"kind": "none"}) | {"steering": None}
    wheel = scene(body="sun", device={"kind": "electric-sail", "characteristic_acceleration_mm_s2": 0.5})
    for name, given, extent in (("sail", sail, 30.0), ("none", none, 0.0), ("wheel", wheel, 20_500.0)):
        given = {key: value for key, value in given.items() if value is not None}
        export(sailviz.simulate(given), tmp_path / name, to="cosmographia")
        (item,) = content(tmp_path / name, "craft.json")["items"]
        assert ("geometry" in item) == (extent > 0)
        if extent:
            assert 2000 * item["geometry"]["size"] == pytest.approx(extent, rel=0.05)  # m, corner to corner with vanes
            assert ("does not say" in (tmp_path / name / "README.txt").read_text()) == (name == "wheel")
        assert ("bodyFrame" in item) == (name != "none")
        assert (tmp_path / name / "craft.bc").exists() == (name != "none")
    time = np.r_[np.arange(0.0, 6e6, 2e5), np.arange(2e7, 2.6e7, 2e5)]
    angle = 2e-7 * time
    place = 1.5e11 * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    speed = 3e4 * np.column_stack([-np.sin(angle), np.cos(angle), 0 * angle])
    run = sailviz.run.trajectory(time, place, speed, epoch=EPOCH, title="Sun", gaps=[(5.8e6, 2e7)])
    export(run, tmp_path / "gap", to="cosmographia", craft_id=-77)
    first, second = content(tmp_path / "gap", "craft.json")["items"]
    assert (first["name"], second["name"]) == ("Sun (flight)", "Sun (flight) (2)")
    assert first["trajectory"] == {"type": "Spice", "target": "-77", "center": "SUN"}
    assert first["endTime"] < "2026-06" < second["startTime"]


def test_a_folder_of_others_is_never_touched(tmp_path, folder):
    source = folder[1].parent / "run.rrd"
    strange = tmp_path / "strange"
    strange.mkdir()
    (strange / "mine.txt").write_text("mine")
    with pytest.raises(OutputError, match=r"mine\.txt lies there"):
        export(source, strange, to="cosmographia")
    (strange / "mine.txt").rename(strange / "load.json")
    with pytest.raises(OutputError, match="not by sailviz"):
        export(source, strange, to="cosmographia")
    assert [path.name for path in strange.iterdir()] == ["load.json"]
    (tmp_path / "file").write_text("x")
    with pytest.raises(OutputError, match="is no folder"):
        export(source, tmp_path / "file", to="cosmographia")
    with pytest.raises(OutputError, match="there is no directory"):
        export(source, tmp_path / "no" / "x", to="cosmographia")
    (tmp_path / "empty").mkdir()
    export(source, tmp_path / "empty", to="cosmographia")
    before = (tmp_path / "empty" / "load.json").stat().st_ino
    export(source, tmp_path / "empty", to="cosmographia")  # its own is replaced as a whole
    assert (tmp_path / "empty" / "load.json").stat().st_ino != before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["empty", "file", "strange"]


def test_what_fails_on_the_way_leaves_nothing_and_the_old_folder_as_it_was(tmp_path, folder, monkeypatch):
    source, out = folder[1].parent / "run.rrd", tmp_path / "out"
    export(source, out, to="cosmographia")
    before = {path.name: path.read_bytes() for path in out.iterdir()}

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(cosmographia, "obj_text", full)
    with pytest.raises(OutputError, match="no space"):
        export(source, out, to="cosmographia")
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before
    assert os.listdir(tmp_path) == ["out"]


def test_the_command_says_in_one_sentence_what_cannot_be(tmp_path, folder):
    source = str(folder[1].parent / "run.rrd")
    done = CliRunner().invoke(main, ["export", source, "--to", "cosmographia", "-o", str(tmp_path / "x")])
    assert (done.exit_code, done.output) == (0, f"{tmp_path / 'x' / 'load.json'}\n")
    for arguments in (["--entity", "/state"], ["--centre-id", "3"], ["--craft-id", "5"], ["--frame", "TEME"]):
        said = CliRunner().invoke(
            main, ["export", source, "--to", "cosmographia", "-o", str(tmp_path / "y"), *arguments]
        )
        assert said.exit_code == 2
        assert said.output.count("\n") == 1
    undated = scene()
    del undated["epoch"]
    undated |= {"steering": {"kind": "radial"}, "body": "sun"} | {"start": scene(body="sun")["start"]}
    with pytest.raises(RecordingError, match="has no epoch"):
        export(sailviz.simulate(undated), tmp_path / "y", to="cosmographia")
    star = undated | {"epoch": EPOCH, "body": {"name": "Altaira", "mu_km3_s2": 1.4e11}}
    with pytest.raises(RecordingError, match="round Altaira; Cosmographia shows those round"):
        export(sailviz.simulate(star), tmp_path / "y", to="cosmographia")
    assert [path.name for path in tmp_path.iterdir()] == ["x"]
