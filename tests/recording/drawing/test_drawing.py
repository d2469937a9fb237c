"""The picture as a whole: its size, and what it shows."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from sailviz.recording import read, record
from sailviz.recording.views.screenshot import Studio, has_vulkan


def test_a_run_without_thrust_is_drawn(runs, tmp_path):
    run = runs.displaced(rows=60)
    still = replace(
        run.thrust,
        acceleration=0 * run.thrust.acceleration,
        acceleration_rtn=0 * run.thrust.acceleration_rtn,
        magnitude=0 * run.thrust.magnitude,
        on=np.zeros(60, bool),
    )
    record(replace(run, thrust=still), tmp_path / "run.rrd")
    assert read(tmp_path / "run.rrd").complete


def test_three_years_with_every_column_take_less_than_five_megabytes(years):
    run, path = years
    assert len(run) > 1900
    assert path.stat().st_size < 5e6


@pytest.mark.skipif(not has_vulkan(), reason="no Vulkan driver: apt-get install libvulkan1 mesa-vulkan-drivers")
def test_the_views_of_a_low_orbit_show_its_colours(years, tmp_path):
    _, path = years
    seen = {}
    with Studio(path, size=(640, 440)) as studio:
        shots = ("Where", 0.1), ("Where", 0.9), ("Descent", 0.1), ("Descent", 0.9), ("Riding", 0.1), ("Riding", 0.9)
        for view, at in shots:
            report = studio.shoot(tmp_path / "view.png", view=view, at=at)
            assert report.errors == report.warnings == (), view
            seen[view, at] = np.asarray(Image.open(report.path).convert("RGB"), int)
    red, green, blue = np.moveaxis(seen["Descent", 0.9], -1, 0)
    assert np.mean((red > 60) & (blue > green + 30) & (red > green + 10)) > 0.05, "no violet band"
    for at, pink in ((0.1, False), (0.9, True)):  # the bright tail: blue at the start, pink near the end
        red, green, blue = np.moveaxis(seen["Riding", at], -1, 0)
        line = (red > 190) & (green < 140) & (blue > 120) if pink else (blue > 225) & (red < 160) & (green > 150)
        assert line.sum() > 150, f"no bright tail at {at}"
    assert np.mean(np.abs(seen["Where", 0.1] - seen["Where", 0.9]).max(-1) > 24) > 0.05, "the Earth does not turn"
