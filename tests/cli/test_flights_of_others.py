"""Flights of others at the shell: about which body they are, what the craft looks like, and what is refused."""

import numpy as np
import pytest
import trimesh
from click.testing import CliRunner

import sailviz
from sailviz import two_body
from sailviz.cli.entry import main
from sailviz.constants import AU, MU_SUN
from sailviz.recording.flights import read_flight
from sailviz.sky.bodies import BODIES

HEADER = "time_s,x_km,y_km,z_km,vx_km_s,vy_km_s,vz_km_s"


def table(path, mu, r0, v0, time, header=HEADER):
    places, speeds = two_body.advance(np.tile(r0, (len(time), 1)), np.tile(v0, (len(time), 1)), time, mu)
    rows = np.column_stack([time, places / 1e3, speeds / 1e3])
    np.savetxt(path, rows, delimiter=",", header=header, comments="", fmt="%.17g")
    return path


def run(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Tables: round Mars, dense; round the Sun, three rows a turn with a push that no gravity explains."""
    folder = tmp_path_factory.mktemp("flights")
    mars = table(folder / "mars.csv", BODIES["mars"].mu, [4e6, 0, 0], [0, 3.2e3, 1e3], np.linspace(0, 9e3, 40))
    pushed = table(folder / "pushed.csv", 1.4 * MU_SUN, [AU, 0, 0], [0, 33e3, 0], np.linspace(0, 3e7, 14))
    return {"mars": mars, "pushed": pushed, "mesh": folder / "craft.stl"}


def test_a_table_round_a_body_is_known_by_its_gravity(files):
    assert read_flight(files["mars"]).setting.body.name == "Mars"


@pytest.mark.parametrize("word", ["mars", "Mars", "MARS"])
def test_a_body_that_is_said_is_that_body(files, tmp_path, word):
    result = run("record", files["mars"], "-o", tmp_path / "a.rrd", "--body", word)
    assert result.exit_code == 0, result.stderr
    facts = sailviz.read(tmp_path / "a.rrd")["/scene"]
    assert (facts["body"][0], facts["body_mu_m3_s2"][0]) == ("Mars", BODIES["mars"].mu)


def test_rows_that_follow_no_gravity_need_their_body_said(files, tmp_path):
    result = run("record", files["pushed"], "-o", tmp_path / "a.rrd")
    assert result.exit_code == 2
    assert "say it, by --body, one of sun, mercury" in result.stderr
    assert not list(tmp_path.iterdir())
    assert run("record", files["pushed"], "-o", tmp_path / "a.rrd", "--body", "sun").exit_code == 0
    assert run("compare", files["pushed"], tmp_path / "a.rrd", "--body", "sun", "--no-picture").exit_code == 0


@pytest.mark.parametrize(
    "header",
    [
        "time_s,x_mars_km,y_mars_km,z_mars_km,vx_mars_km_s,vy_mars_km_s,vz_mars_km_s",
        "time_s,areocentric_x [km],areocentric_y [km],areocentric_z [km],mars.vx_km_s,mars.vy_km_s,mars.vz_km_s",
    ],
)
def test_a_header_names_the_body(tmp_path, header):
    start = [4e6, 0, 0], [0, 3.2e3, 1e3], np.linspace(0, 9e3, 40)
    assert read_flight(table(tmp_path / "a.csv", BODIES["mars"].mu, *start, header)).setting.body.name == "Mars"
    assert run("view", tmp_path / "a.csv", "--body", "venus").stderr.endswith("leave the body out\n")
    mixed = header.replace("vz", "vz").replace("vy_mars", "vy_earth").replace("mars.vy", "earth.vy")
    said = run("view", table(tmp_path / "b.csv", BODIES["mars"].mu, *start, mixed))
    assert said.exit_code == 2
    assert "are about different bodies" in said.stderr


def test_a_mesh_is_drawn_and_a_wrong_one_refused_before_anything_is_written(files, tmp_path):
    trimesh.creation.box([300, 100, 100]).export(str(files["mesh"]))
    out = tmp_path / "a.rrd"
    for words, said in (
        (["--mesh", files["mesh"]], "has no unit of its own"),
        (["--mesh", files["mesh"], "--unit", "m", "--front", "up"], "is no side that a front may face"),
        (["--mesh", files["mesh"], "--unit", "km"], "its unit must be another"),
        (["--mesh", files["mars"], "--unit", "m"], "is no file of facets"),
        (["--unit", "m"], "give --mesh as well"),
        (["--body", "mrs"], 'Did you mean "mars"?'),
        (["--body", "pluto"], "Allowed: sun, mercury"),
    ):
        result = run("record", files["mars"], "-o", out, *words)
        assert result.exit_code == 2, words
        assert said in result.stderr
        assert "Traceback" not in result.stderr
        assert not out.exists()
    result = run("record", files["mars"], "-o", out, "--mesh", files["mesh"], "--unit", "cm", "-q")
    assert (result.exit_code, result.output) == (0, "")
    told = sailviz.read(out)
    assert told["/scene"]["craft_side_m"][0] == pytest.approx(3.0)
    assert told.resolved["mesh"]["facets"] == 12
    for verb in ("view", "web"):
        result = run(verb, out, "--body", "mars")
        assert result.exit_code == 2
        assert "are for flights of others" in result.stderr


def test_a_scene_is_no_flight_of_others(tmp_path):
    result = run("record", "displaced/circular", "-o", tmp_path / "a.rrd")
    assert result.exit_code == 2
    assert "sailviz run" in result.stderr
