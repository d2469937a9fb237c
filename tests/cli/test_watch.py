"""A scene that is flown again whenever its file is saved, in one viewer: the eye, the moment and the last good flight
stay."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from sailviz.cli import main
from sailviz.cli.watch import named_in, stamps
from sailviz.recording.sinks import viewer_binary
from sailviz.recording.views.screenshot import has_vulkan
from sailviz.recording.web_page import free_port

PATIENCE = 240.0  # s; the propagator may have to be compiled first
WITHOUT_A_WINDOW = """
import sys
from sailviz.cli import main
from sailviz.recording.views import live
binary = sys.argv.pop(1)
live.viewer_binary = lambda: binary
main(sys.argv[1:])
"""
SCENE = """title = "{title}"
family = "spirals"
[start]
kind = "circular"
radius_au = 1
[device]
kind = "solar-sail"
film = "ideal"
lightness_number = {lightness}
[steering]
kind = "orbital"
pitch_deg = 35
clock_deg = 90
[propagation]
duration_d = {days}
outputs = {rows}
"""


def written(path, title="First", lightness=0.05, days=200, rows=60):
    """Save as editors do: under another name, which then replaces the scene's."""
    beside = path.with_name("beside")
    beside.write_text(SCENE.format(title=title, lightness=lightness, days=days, rows=rows))
    os.replace(beside, path)


def asked_until(question, patience=PATIENCE):
    started, answer = time.monotonic(), None
    while not answer and time.monotonic() - started < patience:
        with contextlib.suppress(OSError, RuntimeError):  # not up yet, or busy
            answer = question()
        time.sleep(0.2)
    assert answer, "the viewer never came to it"
    return answer


@pytest.fixture
def watched(tmp_path, request):
    """(scene file, viewer, process of the command); the parameter is what stands in the file at first."""
    from rerun.experimental import ViewerClient

    scene, port = tmp_path / "scene.toml", free_port()
    written(scene, lightness=request.param)
    headless = tmp_path / "headless"
    headless.write_text(f'#!/bin/sh\nexec "{viewer_binary()}" --headless --window-size 1000x700 "$@"\n')
    headless.chmod(0o755)
    words = [sys.executable, "-c", WITHOUT_A_WINDOW, str(headless), "watch", str(scene), "--port", str(port)]
    with open(tmp_path / "said", "w") as said:
        process = subprocess.Popen(words, stdout=said, stderr=said, env=dict(os.environ, DISPLAY=":none"))
        try:
            yield scene, asked_until(lambda: ViewerClient.connect(f"rerun+http://127.0.0.1:{port}/proxy")), process
        finally:
            process.kill()
            process.wait()


def titles(viewer):
    """Names of the views in sight or behind tabs, where one flight alone is open."""
    state = viewer.get_state()
    return [view.name for view in state.views] if len(state.recordings) == 1 and not state.loading else []


def eye(viewer):
    """The path of the eye of the main view in the blueprint, and the blueprint."""
    parts = viewer.get_blueprint().blueprint
    view = next(path for path, part in parts.items() if part.get("ViewBlueprint", {}).get("display_name") == "Flight")
    return f"{view}/EyeControls3D", parts


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.skipif(not has_vulkan(), reason="no Vulkan driver: apt-get install libvulkan1 mesa-vulkan-drivers")
@pytest.mark.parametrize("watched", [0.05], indirect=True)
def test_eye_and_moment_stay_over_three_edits_and_a_broken_one_leaves_the_last_flight(watched, tmp_path):
    scene, viewer, process = watched
    asked_until(lambda: "First" in titles(viewer))
    (first,) = viewer.get_state().recordings
    place, parts = eye(viewer)
    parts[place]["EyeControls3D"]["position"] = [0.5, 2.5, 1.5]
    viewer.set_blueprint(parts, store_id=first.store_id)
    viewer.set_time("sim_time", duration=100 * 86400.0, play_state="paused")

    written(scene, "Second", lightness=0.08)
    asked_until(lambda: "Second" in titles(viewer))
    (second,) = asked_until(lambda: len(r := viewer.get_state().recordings) == 1 and r[0].current_time and r)
    assert second.store_id != first.store_id
    assert asked_until(lambda: (found := eye(viewer))[1][found[0]])["EyeControls3D"]["position"] == [0.5, 2.5, 1.5]
    assert asked_until(lambda: viewer.get_state().recordings[0].current_time == 100 * 86400 * 10**9)

    written(scene, "Third", lightness='"much"')
    asked_until(lambda: "Not flown" in titles(viewer))
    assert "Second" in titles(viewer)
    assert [known.store_id for known in viewer.get_state().recordings] == [second.store_id]
    assert "lightness_number" in (tmp_path / "said").read_text()
    faults = viewer.get_recording_schema(store_id=second.store_id, entity_path="/faults")
    assert faults.entities

    written(scene, "Fourth", days=80, rows=40)
    asked_until(lambda: "Fourth" in titles(viewer) and "Not flown" not in titles(viewer))
    assert asked_until(lambda: (found := eye(viewer))[1][found[0]])["EyeControls3D"]["position"] == [0.5, 2.5, 1.5]
    assert asked_until(lambda: viewer.get_state().recordings[0].current_time == 80 * 86400 * 10**9)

    process.send_signal(signal.SIGINT)
    assert process.wait(30) == 0
    with pytest.raises((OSError, RuntimeError)):
        viewer.get_state()


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.skipif(not has_vulkan(), reason="no Vulkan driver: apt-get install libvulkan1 mesa-vulkan-drivers")
@pytest.mark.parametrize("watched", ['"much"'], indirect=True)
def test_a_scene_that_is_broken_at_first_is_told_alone_and_flown_once_it_is_whole(watched):
    scene, viewer, process = watched
    asked_until(lambda: titles(viewer) == ["Not flown"])
    written(scene, "Whole")
    asked_until(lambda: "Whole" in titles(viewer) and "Not flown" not in titles(viewer))
    process.send_signal(signal.SIGTERM)
    assert process.wait(30) == 0
    with pytest.raises((OSError, RuntimeError)):
        viewer.get_state()


def test_a_name_that_there_is_not_ends_before_a_window_opens(monkeypatch):
    monkeypatch.setenv("DISPLAY", ":none")
    result = CliRunner().invoke(main, ["watch", "displaced/circulr"])
    assert result.exit_code == 2
    assert "displaced/circular" in result.stderr


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="screens are found by name on Linux only")
def test_without_a_screen_nothing_is_watched(monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    result = CliRunner().invoke(main, ["watch", "displaced/circular"])
    assert result.exit_code == 2
    assert "no screen for the viewer" in result.stderr


def test_files_that_a_scene_names_are_watched_even_where_it_cannot_be_flown(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text('[[ensemble]]\nsolar_wind = {kind = "replay", file = "wind.csv"}\n[x]\nfile = "../away.csv"\n')
    assert named_in(scene, str(scene), {"environment.solar_wind.file": "own.csv"}) == [
        tmp_path / "own.csv",
        tmp_path / "wind.csv",
    ]
    scene.write_text("[[ensemble")
    assert named_in(scene, str(scene), {}) == []


def test_a_file_replaced_by_one_of_the_same_size_and_time_has_another_stamp(tmp_path):
    file, other = tmp_path / "a", tmp_path / "b"
    for path in (file, other):
        path.write_text("same")
        os.utime(path, ns=(10**18, 10**18))
    before = stamps([file])
    os.replace(other, file)
    assert stamps([file]) != before
    file.unlink()
    assert stamps([file]) == {Path(file): None}
