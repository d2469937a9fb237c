"""Pictures from a shell: of recordings and of scenes, exit codes and messages."""

import pytest
from click.testing import CliRunner
from PIL import Image

from sailviz.cli import main
from sailviz.recording.views import screenshot as shot
from sailviz.recording.views.screenshot import has_vulkan

SHORT = ("--set", "propagation.duration_d=30", "--set", "propagation.outputs=20", "--set", "expect=[]")
SMALL = ("--size", "320x200", "--view", "Flight")

needs_vulkan = pytest.mark.skipif(
    not has_vulkan(), reason="no Vulkan driver: apt-get install libvulkan1 mesa-vulkan-drivers"
)


@pytest.fixture
def shell(tmp_path, monkeypatch):
    """Call sailviz in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return lambda *words: CliRunner().invoke(main, [str(word) for word in words], catch_exceptions=False)


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    path = tmp_path_factory.mktemp("recorded") / "circular.rrd"
    assert CliRunner().invoke(main, ["run", "displaced/circular", "-q", "-o", str(path), *SHORT]).exit_code == 0
    return path


def names(folder):
    return sorted(path.name for path in folder.iterdir())


@needs_vulkan
def test_a_scene_is_flown_and_leaves_only_its_picture(shell, tmp_path):
    result = shell("picture", "displaced/circular", *SHORT, *SMALL, "--at", "10d")
    assert result.exit_code == 0, result.output
    assert "circular.png: 320 x 200" in result.output
    assert names(tmp_path) == ["circular.png"]
    with Image.open("circular.png") as image:
        assert image.size == (320, 200)


@needs_vulkan
def test_several_sources_go_into_a_folder_and_a_bad_one_does_not_stop_the_others(shell, tmp_path, recording):
    result = shell("picture", "nothing.rrd", recording, "-o", "pictures", *SMALL, "-q")
    assert result.exit_code == 2
    assert "nothing.rrd" in result.stderr
    assert names(tmp_path / "pictures") == ["circular.png"]


@needs_vulkan
def test_a_complaint_of_a_view_is_exit_code_1(shell, recording, monkeypatch):
    from dataclasses import replace

    true = shot.Studio.shoot
    monkeypatch.setattr(
        shot.Studio, "shoot", lambda *words, **more: replace(true(*words, **more), errors=("Flight: no such entity",))
    )
    result = shell("picture", recording, *SMALL)
    assert result.exit_code == 1
    assert "Flight: no such entity" in result.stderr


@needs_vulkan
def test_a_movie_from_a_shell(shell, tmp_path, recording):
    result = shell("picture", recording, "--movie", "film.gif", "--seconds", 0.5, "--fps", 6, *SMALL)
    assert result.exit_code == 0, result.output
    assert "film.gif: 320 x 200, 3 frames" in result.output
    assert names(tmp_path) == ["film.gif"]


@needs_vulkan
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--view", "Syzygy"), "no view Syzygy; it has"),
        (("--at", "40d"), "outside the run, which goes from 0 s to 30 d"),
        (("--at", "later"), "is no moment of a run"),
        (("--size", "big"), "WIDTHxHEIGHT"),
        (("-o", "picture.jpg"), "must end in .png"),
        (("--movie", "film.avi"), "must end in .mp4, .webp or .gif"),
        (("--movie", "film.gif", "-o", "a.png"), "-o is for pictures"),
        (("--set", "propagation.duration_d=3"), "--set changes scenes"),
    ],
)
def test_bad_input_is_exit_code_2_and_writes_nothing(shell, tmp_path, recording, words, said):
    result = shell("picture", recording, *words)
    assert result.exit_code == 2
    assert said in result.stderr
    assert names(tmp_path) == []


def test_missing_vulkan_is_one_sentence_with_the_packages(shell, tmp_path, recording, monkeypatch):
    monkeypatch.setattr(shot, "has_vulkan", lambda: False)
    result = shell("picture", recording)
    assert result.exit_code == 2
    assert result.stderr.count("\n") == 1
    assert "apt-get install libvulkan1 mesa-vulkan-drivers" in result.stderr
    assert names(tmp_path) == []
