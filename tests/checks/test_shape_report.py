"""`sailviz shape`: numbers against the flat sail and the arithmetic of a lever, the recording against the numbers, and
what is refused."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from rerun.chunk import RrdReader

from sailviz.checks import shape_report
from sailviz.cli.entry import main
from sailviz.constants import RADIATION_PRESSURE
from sailviz.recording.shape_picture import colors_of
from sailviz.shapes import kept_tables, membranes, shadows, structures
from sailviz.shapes.facets import Coefficients, Shape, Surface
from sailviz.shapes.primitives import trimesh

B = Coefficients(0.0723, 0.8554, -0.0030)


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture
def flat(tmp_path):
    path = tmp_path / "flat.stl"
    membranes.square(10.0, Surface(B, B), rows=4).mesh.export(str(path))
    return path


def run(*words: object) -> object:
    return CliRunner().invoke(main, ["shape", *map(str, words)])


def test_a_flat_file_is_pushed_as_the_flat_sail(flat):
    found = run(flat, "--unit", "m", "--film", "jpl-2015", "--cells", 4, "--json")
    assert found.exit_code == 0, found.output
    facts = json.loads(found.output)
    assert facts["film_area_m2"] == pytest.approx(100, rel=1e-6)
    facing, tilted = (np.array(one["force_N"]) for one in facts["light"])
    np.testing.assert_allclose(facing, [0, 0, 2 * RADIATION_PRESSURE * 100 * sum(B)], rtol=0, atol=1e-12)
    c, s = np.cos(np.radians(35)), np.sin(np.radians(35))
    along = B.b1 * c
    expected = 200 * RADIATION_PRESSURE * np.array([along * s, 0, along * c + c * (B.b2 * c + B.b3)])
    np.testing.assert_allclose(tilted, expected, rtol=0, atol=1e-10)
    assert facts["rays"] == "none"
    assert facts["errors"]["table_force"] < 1e-3


def test_a_billowed_scene_is_told_for_both_readings_of_its_table(tmp_path):
    """Curves between the nodes err a third as much, or less; the first line is of what the scene flies by."""
    scene = tmp_path / "billow.toml"
    scene.write_text("""
        title = "billow"
        start = {kind = "circular", radius_au = 1}
        steering = {kind = "sun-facing"}
        propagation = {duration_d = 1, outputs = 2}
        [device]
        kind = "solar-sail"
        film = "jpl-2015"
        back = "black"
        mass_kg = 5
        shape = {kind = "square", side_m = 40, cone_deg = 3, sag = 0.03, shadow = false, interpolation = "bicubic"}
        """)
    found = run(scene, "--json")
    facts = json.loads(found.output)
    off = {word: facts["errors_by"][word]["table_force"] for word in ("bilinear", "bicubic")}
    assert facts["errors"] == facts["errors_by"]["bicubic"]
    assert off["bicubic"] < 4e-4
    assert off["bicubic"] < off["bilinear"] / 3
    words = run(scene).output
    assert "cells, bicubic, no rays" in words
    for word, most in off.items():
        assert f"{word:<9} {most:.1e} at most" in words


def test_the_report_says_everything_in_words(flat):
    found = run(flat, "--unit", "m", "--cells", 4)
    assert found.exit_code == 0
    for word in (
        "1 part, 224 facets",
        "100 m²",
        "facing",
        "35 deg",
        "centre of pressure",
        "Tensors",
        "Table",
        "no rays",
    ):
        assert word in found.output


def test_the_centre_of_pressure_is_where_a_lever_balances():
    force, point = np.array([1.0, -2.0, 5.0]), np.array([0.3, -0.7, 0.0])
    centre, about = shape_report.centre_of_pressure(force, np.cross(point, force) + 0.25 * force)
    np.testing.assert_allclose(centre, point, rtol=0, atol=1e-14)
    assert about == pytest.approx(0.25 * np.sqrt(30))


@pytest.mark.skipif(not shadows.ray_caster(), reason="nothing that casts rays is installed")
def test_the_recording_shows_each_facets_pressure_and_the_force_from_its_centre(tmp_path):
    bus = structures.bus([2, 2, 1], [0, 0, -1.5], Coefficients(0.5, 0, 0))
    scene = trimesh.Scene()
    scene.add_geometry(membranes.square(10.0, Surface(B, B), 0.1, rows=6).mesh, geom_name="film")
    scene.add_geometry(bus.mesh, geom_name="bus")
    scene.export(str(tmp_path / "a.glb"))
    out = tmp_path / "a.rrd"
    found = run(tmp_path / "a.glb", "--film", "jpl-2015", "--back", "black", "--cells", 2, "-o", out)
    assert found.exit_code == 0, found.output
    parts = {"film": "jpl-2015", "back": "black", "parts": ()}
    shape = shape_report.shape_of_file(str(tmp_path / "a.glb"), **parts)
    drawn = shape_report.report("a.glb", shape, 2).picture()
    columns = read(out)
    pitches = [pitch for pitch, _ in columns["/shape/facets", "Mesh3D:vertex_colors"]]
    assert pitches == list(shape_report.DRAWN)
    for row, (_, colors) in enumerate(columns["/shape/facets", "Mesh3D:vertex_colors"]):
        packed = np.array(colors, np.uint32)
        seen = np.stack([packed >> shift & 255 for shift in (24, 16, 8, 0)], axis=1)[::3]
        np.testing.assert_array_equal(seen, colors_of(drawn.pressure[row]))
    shaded = drawn.pressure[0][shape.part_of == [part.name for part in shape.parts].index("film")]
    assert np.any(shaded == 0)  # the bus's shadow is seen
    assert drawn.pressure.max() == 1
    size = float(np.ptp(drawn.corners.reshape(-1, 3), axis=0).max())
    forces = columns["/shape/force", "Arrows3D:vectors"]
    np.testing.assert_allclose([value[0] for _, value in forces], 0.6 * size * drawn.force, rtol=0, atol=1e-5)
    centres = columns["/shape/force", "Arrows3D:origins"]
    np.testing.assert_allclose([value[0] for _, value in centres], drawn.centre, rtol=0, atol=1e-5)
    light = columns["/shape/light", "Arrows3D:vectors"]
    np.testing.assert_allclose([value[0] for _, value in light], 0.35 * size * drawn.light, rtol=0, atol=1e-5)


def read(path) -> dict:
    """(entity, component) -> [(pitch, value)] of what has rows."""
    found: dict = {}
    for chunk in RrdReader(str(path)).stream():
        batch = chunk.to_record_batch()
        if "pitch" not in batch.schema.names:
            continue
        pitches = batch.column("pitch").to_pylist()
        for name in (name for name in batch.schema.names if ":" in name):
            rows = found.setdefault((chunk.entity_path, name), [])
            rows += [
                (pitch, value) for pitch, value in zip(pitches, batch.column(name).to_pylist(), strict=True) if value
            ]
    return {key: sorted(rows, key=lambda row: row[0]) for key, rows in found.items()}


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ([], "has no unit of its own"),
        (["--unit", "m", "--film", "jpl-2016"], 'Did you mean "jpl-2015"'),
        (["--unit", "m", "--back", "white"], "is no film, nor b1,b2,b3"),
        (["--unit", "m", "--film", "eta-perfect", "--back", "black"], "how it radiates is not known"),
        (["--unit", "m", "--part", "sail=ideal"], "has no part"),
        (["--unit", "m", "--part", "film"], "is not NAME=FILM"),
        (["--unit", "m", "--cells", "5"], "an even number of cells"),
        (["--unit", "m", "--film", "nan,0,1"], "positive sum"),
        (["--unit", "km"], "so its unit must be another"),
        (["--unit", "m", "-o", "no/such/folder/a.rrd"], "there is no directory"),
    ],
)
def test_what_cannot_be_is_refused_in_one_sentence(flat, options, words):
    found = run(flat, *options)
    assert found.exit_code == 2, found.output
    assert words in found.output
    assert "Traceback" not in found.output
    assert len(found.output.strip().splitlines()) == 1


def test_a_table_is_made_once_and_again_where_it_was_damaged(monkeypatch):
    shape = Shape((membranes.square(3.0, Surface(B, B), 0.1, rows=3),))
    made = []
    build = kept_tables.light_table.build_all
    monkeypatch.setattr(kept_tables.light_table, "build_all", lambda *a, **more: made.extend(a[0]) or build(*a, **more))
    first = kept_tables.table_of(shape, 4, shadow=False)
    again = kept_tables.table_of(shape, 4, shadow=False)
    assert len(made) == 1
    assert np.array_equal(first.numbers, again.numbers)
    file = next(kept_tables.folder().glob("*.table"))
    content = bytearray(file.read_bytes())
    content[100] ^= 1
    file.write_bytes(content)
    assert np.array_equal(kept_tables.table_of(shape, 4, shadow=False).numbers, first.numbers)
    kept_tables.table_of(shape, 4, shadow=False, interpolation="bicubic")
    kept_tables.table_of(shape, 6, shadow=False)
    other = Shape((membranes.square(3.0, Surface(B, Coefficients(0.5, 0, 0)), 0.1, rows=3),))
    kept_tables.table_of(other, 4, shadow=False)
    assert len(made) == 5
