"""Every view of every family shows something and complains about nothing."""

import io

import numpy as np
import pytest
from PIL import Image

from sailviz.errors import RecordingError
from sailviz.recording import picture, record
from sailviz.recording.drawing.style import BACKGROUND
from sailviz.recording.views.screenshot import Studio, has_vulkan

pytestmark = pytest.mark.skipif(
    not has_vulkan(), reason="no Vulkan driver: apt-get install libvulkan1 mesa-vulkan-drivers"
)


def lit(path):
    """Share of pixels that differ from the background by more than the eye forgives."""
    pixels = np.asarray(Image.open(io.BytesIO(path.read_bytes())).convert("RGB"), int)
    return np.mean(np.abs(pixels - BACKGROUND).max(axis=2) > 24)


def test_every_view_shows_something_without_a_complaint(recorded_family, tmp_path):
    name, path = recorded_family
    titles = [f"A run of the family {name}"]
    with Studio(path, size=(640, 440)) as studio:
        spaces = ["Flight", "Where it is", "From above", "From afar", "Riding along", "close up", "About", *titles]
        for view in studio.views:
            if name != "spirals" and not any(word in view for word in spaces):
                continue  # curves look alike in every family
            report = studio.shoot(tmp_path / "view.png", view=view, at=0.4)
            assert report.errors == (), f"{name} {view}"
            assert lit(report.path) > (0.0005 if view == "Events" else 0.004), f"{name} {view} is empty"


def test_a_picture_moves_with_the_time(run, tmp_path):
    record(run, tmp_path / "run.rrd")
    early = picture(tmp_path / "run.rrd", tmp_path / "a.png", view="Flight", at="start", size=(640, 480))
    late = picture(tmp_path / "run.rrd", tmp_path / "b.png", view="Flight", at=0.5, size=(640, 480))
    assert early.path.read_bytes() != late.path.read_bytes()
    assert early.size == late.size == (640, 480)


def test_a_picture_of_a_view_that_is_not_there_is_refused(run, tmp_path):
    record(run, tmp_path / "run.rrd")
    with pytest.raises(RecordingError, match=r"no view Syzygy; it has .*Flight"):
        picture(tmp_path / "run.rrd", tmp_path / "a.png", view="Syzygy")
