"""What a scene or a sweep names is a regular file inside its folder, and nothing else is opened."""

from __future__ import annotations

import os
import socket

import pytest

from sailviz.errors import SceneError
from sailviz.scene.loading import load_scene
from sailviz.scene.named_files import outside

SCENE = """\
title = "t"
[start]
kind = "circular"
radius_au = 1
[device]
kind = "electric-sail"
characteristic_acceleration_mm_s2 = 1
[environment.solar_wind]
kind = "replay"
file = {name}
seed = 1
[propagation]
duration_d = 1
"""


@pytest.fixture
def folder(tmp_path):
    """A folder with a good file, one below, links, a folder and a pipe; and a file beside the folder."""
    inside = tmp_path / "inside"
    (inside / "winds").mkdir(parents=True)
    (tmp_path / "secret.csv").write_text("x")
    (inside / "wind.csv").write_text("x")
    (inside / "winds" / "below.csv").write_text("x")
    (inside / "in.csv").symlink_to("wind.csv")
    (inside / "out.csv").symlink_to(tmp_path / "secret.csv")
    (inside / "away").symlink_to(tmp_path)
    (inside / "circle.csv").symlink_to("circle.csv")
    (inside / "null.csv").symlink_to("/dev/null")
    os.mkfifo(inside / "pipe.csv")
    return inside


@pytest.mark.parametrize("name", ["wind.csv", "winds/below.csv", "in.csv", "./wind.csv", "none.csv"])
def test_names_inside_the_folder_are_taken(folder, name):
    assert outside(folder, name) == ""


REFUSED = [
    ("/etc/passwd", "absolute"),
    ("~/wind.csv", "absolute"),
    ("C:\\wind.csv", "absolute"),
    ("\\\\host\\wind.csv", "absolute"),
    ("../secret.csv", '".." is not allowed'),
    ("winds/../wind.csv", '".." is not allowed'),
    ("winds\\..\\..\\secret.csv", '".." is not allowed'),
    ("out.csv", "a link that leads out"),
    ("away/secret.csv", "a link that leads out"),
    ("null.csv", "a link that leads out"),
    ("winds", "a folder, not a regular file"),
    (".", "a folder, not a regular file"),
    ("pipe.csv", "a pipe, not a regular file"),
    ("", "no name of a file"),
    ("wind\0.csv", "no name of a file"),
    ("x" * 5000, "cannot be read"),
]


@pytest.mark.parametrize(("name", "words"), REFUSED, ids=[name[:20] for name, _ in REFUSED])
def test_other_names_are_refused_each_with_its_reason(folder, name, words):
    assert words in outside(folder, name)
    file = folder / "scene.toml"
    quoted = '"' + name.replace("\\", "\\\\").replace("\0", "\\u0000") + '"'
    file.write_text(SCENE.format(name=quoted))
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    (fault,) = caught.value.faults
    assert fault.where == "environment.solar_wind.file"
    assert words in fault.what
    assert len(fault.what) < 200


def test_links_in_a_circle_and_sockets_are_refused(folder, monkeypatch):
    assert outside(folder, "circle.csv")
    monkeypatch.chdir(folder)
    with socket.socket(socket.AF_UNIX) as server:
        server.bind("door")
        assert "a socket" in outside(folder, "door")


def test_the_winds_of_ensembles_are_held_to_the_same():
    device = {"kind": "electric-sail", "characteristic_acceleration_mm_s2": 1}
    wind = {"kind": "replay", "file": "/etc/passwd", "seed": 1}
    scene = {
        "title": "t",
        "start": {"kind": "circular", "radius_au": 1},
        "device": device,
        "propagation": {"duration_d": 1},
        "ensemble": [{"name": "one", "solar_wind": wind}],
    }
    with pytest.raises(SceneError, match=r"ensemble\[0\]\.solar_wind\.file: .*absolute"):
        load_scene(scene)


def test_a_sweep_names_its_scene_in_its_own_folder(folder):
    from sailviz.sweeps.definition import define

    (folder.parent / "scene.toml").write_text("")
    file = folder / "sweep.toml"
    for name in ("../scene.toml", str(folder.parent / "scene.toml"), "pipe.csv"):
        file.write_text(f'[sweep]\nscene = "{name}"\n[[vary]]\nkey = "propagation.duration_d"\nvalues = [1, 2]\n')
        with pytest.raises(SceneError, match=r"sweep\.scene \(line 2\)"):
            define(file)


def test_a_measured_wind_that_is_not_there_is_told_before_the_flight(tmp_path):
    (tmp_path / "winds.csv").touch()
    file = tmp_path / "scene.toml"
    file.write_text(SCENE.format(name='"wind.csv"'))
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    (fault,) = caught.value.faults
    assert fault.where == "environment.solar_wind.file"
    assert "there is no file" in fault.what
    assert 'Did you mean "winds.csv"?' in fault.what
    (tmp_path / "wind.csv").touch()
    load_scene(file)
