"""The README's pictures can be made again by one command, and are small."""

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from sailviz.cli import main, readme_pictures
from sailviz.cli.readme_pictures import POSES, Pose, file_names, markdown, pose_of, squeezed, take
from sailviz.recording.views.screenshot import has_vulkan
from sailviz.shipped import shipped_scenes


def png(pixels, path):
    Image.fromarray(pixels).save(path)
    return path.read_bytes()


def test_every_shipped_scene_has_a_picture_of_its_own_and_no_pose_is_left_over():
    assert set(POSES) <= set(shipped_scenes())
    files = file_names(shipped_scenes())
    assert len(set(files.values())) == len(shipped_scenes())
    assert files["displaced/circular"] == "circular.png"


def test_a_scene_without_a_pose_is_shown_from_where_its_family_looks_well():
    assert pose_of("deorbit/new") == Pose("Riding along")
    assert pose_of("spirals/new") == Pose("Flight")


def test_squeezing_keeps_a_thin_line_of_a_rare_colour(tmp_path):
    pixels = np.zeros((300, 400, 3), np.uint8)
    pixels[:, :, 0] = np.linspace(0, 120, 400).astype(np.uint8)
    pixels[100:102, 50:90] = (70, 220, 90)
    before = png(pixels, tmp_path / "a.png")
    (tmp_path / "b.png").write_bytes(squeezed(before))
    with Image.open(tmp_path / "b.png") as image:
        assert image.mode == "P"
        line = np.asarray(image.convert("RGB"), int)[100:102, 50:90].reshape(-1, 3).mean(axis=0)
    assert np.abs(line - (70, 220, 90)).max() < 25


def test_squeezing_takes_fewer_colours_until_a_picture_is_small_enough(tmp_path):
    noise = np.random.default_rng(1).integers(0, 255, (120, 160, 3), dtype=np.uint8)
    before = png(noise, tmp_path / "noise.png")
    small = squeezed(before, 15_000)
    assert len(small) <= 15_000 < len(squeezed(before)) < len(before)


@pytest.mark.skipif(not has_vulkan(), reason="no Vulkan driver: apt-get install libvulkan1 mesa-vulkan-drivers")
def test_the_gallery_makes_a_picture_and_its_table(tmp_path):
    done = []
    made = take(tmp_path, ["spirals/logarithmic"], size=(320, 180), progress=done.append)
    assert made == {"spirals/logarithmic": tmp_path / "logarithmic.png"}
    assert done == [1.0]
    assert [path.name for path in tmp_path.iterdir()] == ["logarithmic.png"]
    with Image.open(tmp_path / "logarithmic.png") as image:
        assert image.size == (320, 180)
    table = markdown(made)
    assert "(scenes/spirals/logarithmic.toml)" in table
    assert "Logarithmic spiral to the orbit of Mars" in table


def test_an_unknown_scene_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(readme_pictures, "check_vulkan", lambda: None)
    result = CliRunner().invoke(main, ["gallery", "spirals/nowhere", "-o", str(tmp_path)])
    assert result.exit_code == 2
    assert "no shipped scene spirals/nowhere" in result.stderr
