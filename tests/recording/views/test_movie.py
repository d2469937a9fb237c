"""Movies: every format, whole or not at all, and moving."""

from itertools import pairwise

import numpy as np
import pytest
from PIL import Image, ImageSequence

from sailviz.errors import RecordingError
from sailviz.recording import make_movie, record
from sailviz.recording.views.movie import gif, mp4, webp
from sailviz.recording.views.screenshot import has_vulkan

needs_vulkan = pytest.mark.skipif(
    not has_vulkan(), reason="no Vulkan driver: apt-get install libvulkan1 mesa-vulkan-drivers"
)
FPS = 5


@pytest.fixture
def frames(tmp_path):
    """Six pictures of a bright square that moves over a dark gradient."""
    paths = []
    for number in range(6):
        pixels = np.zeros((61, 81, 3), np.uint8)
        pixels[:, :, 2] = np.arange(81) // 2
        pixels[20:30, 10 * number : 10 * number + 10] = (255, 180, 40)
        paths.append(tmp_path / f"{number}.png")
        Image.fromarray(pixels).save(paths[-1])
    return paths


@pytest.mark.parametrize("encode", [webp, gif])
def test_an_encoder_keeps_frames_order_colours_and_pace(encode, frames, tmp_path):
    out = tmp_path / f"film.{encode.__name__}"
    encode(frames, out, FPS)
    with Image.open(out) as film:
        shown = [np.asarray(frame.convert("RGB"), int) for frame in ImageSequence.Iterator(film)]
        film.seek(1)
        film.load()
        assert film.info["duration"] == 1000 / FPS
        assert film.info["loop"] == 0
    assert len(shown) == len(frames)
    for number, pixels in enumerate(shown):
        square = pixels[22:28, 10 * number + 2 : 10 * number + 8].reshape(-1, 3).mean(axis=0)
        assert np.abs(square - (255, 180, 40)).max() < 25
        assert np.abs(pixels[40:] - shown[0][40:]).max() < 12  # what stands still does not flicker


def test_mp4_is_written_by_the_extra(frames, tmp_path):
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg", reason="mp4 needs the extra movie")
    mp4(frames, tmp_path / "film.mp4", FPS)
    reader = imageio_ffmpeg.read_frames(str(tmp_path / "film.mp4"))
    facts = next(reader)
    shown = [np.frombuffer(frame, np.uint8).reshape(60, 80, 3).astype(int) for frame in reader]
    assert facts["size"] == (80, 60)  # odd sides lose a pixel
    assert facts["fps"] == FPS
    assert len(shown) == len(frames)
    assert np.abs(shown[3][22:28, 32:38].mean(axis=(0, 1)) - (255, 180, 40)).max() < 30


def test_mp4_without_its_encoder_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "imageio_ffmpeg", None)
    with pytest.raises(RecordingError, match=r"sailviz\[movie\]"):
        make_movie(tmp_path / "none.rrd", tmp_path / "film.mp4")


def test_a_movie_for_a_folder_that_is_not_there_is_refused_before_a_picture_is_taken(tmp_path):
    with pytest.raises(RecordingError, match="there is no directory"):
        make_movie(tmp_path / "none.rrd", tmp_path / "nowhere" / "a.gif")


@needs_vulkan
def test_a_movie_moves_and_reports_its_progress(run, tmp_path):
    record(run, tmp_path / "run.rrd")
    told = []
    report = make_movie(
        tmp_path / "run.rrd",
        tmp_path / "film.webp",
        view="Flight",
        end=0.5,
        seconds=0.8,
        fps=FPS,
        size=(320, 200),
        progress=told.append,
    )
    assert (report.frames, report.size, report.errors) == (4, (320, 200), ())
    assert told == sorted(told)
    assert told[-1] == 1.0
    with Image.open(report.path) as film:
        shown = [np.asarray(frame.convert("L"), int) for frame in ImageSequence.Iterator(film)]
    assert all(np.abs(b - a).max() > 60 for a, b in pairwise(shown))


@pytest.mark.parametrize(
    ("out", "more", "said"),
    [
        ("film.mov", {}, r"\.mp4, \.webp or \.gif"),
        ("film.gif", {"seconds": 0}, "frames"),
        ("film.gif", {"fps": 400}, "at most 60"),
        ("film.gif", {"start": "-1d"}, "outside the run"),
        ("no/film.gif", {}, "no directory"),
    ],
)
def test_what_cannot_be_made_is_refused_in_one_sentence(run, tmp_path, out, more, said):
    record(run, tmp_path / "run.rrd")
    with pytest.raises(RecordingError, match=said):
        make_movie(tmp_path / "run.rrd", tmp_path / out, **more)
    assert [path.name for path in tmp_path.iterdir()] == ["run.rrd"]
