"""Pictures for print: white ground, colours that are read on it, bodies as they are, and more pixels for the same
picture."""

import io
import json

import numpy as np
import pytest
from click.testing import CliRunner
from PIL import Image

from sailviz.cli import main
from sailviz.errors import RecordingError
from sailviz.recording import picture, record
from sailviz.recording.drawing import style
from sailviz.recording.views import paper
from sailviz.recording.views.screenshot import has_vulkan, is_paper, tenths_above_one
from sailviz.shapes.planets import globe

needs_vulkan = pytest.mark.skipif(
    not has_vulkan(), reason="no Vulkan driver: apt-get install libvulkan1 mesa-vulkan-drivers"
)


def luminance(color):
    """Of colours (..., 3) of 0 to 255, as WCAG 2.1 defines it."""
    share = np.asarray(color, float) / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return linear @ [0.2126, 0.7152, 0.0722]


def as_png(pixels):
    out = io.BytesIO()
    Image.fromarray(np.asarray(pixels, np.uint8)).save(out, "PNG")
    return out.getvalue()


def pixels_of(png):
    return np.asarray(Image.open(png if not isinstance(png, bytes) else io.BytesIO(png)).convert("RGB"), int)


def test_a_colour_turned_round_twice_is_itself_and_stays_a_colour():
    colors = np.random.default_rng(3).random((500, 3))
    once = paper.turned(colors)
    assert once.min() >= -1e-12
    assert once.max() <= 1 + 1e-12
    assert np.allclose(paper.turned(once), colors, atol=1e-12)
    assert np.array_equal(np.argmax(once, 1), np.argmax(colors, 1)), "red became another hue"


@pytest.mark.parametrize("name", sorted(style.QUANTITY))
def test_the_colour_of_every_quantity_is_read_on_white(name):
    """3 to 1 is the least contrast of lines of WCAG 2.1, 1.4.11; teal has a little less."""
    [[on_white]] = pixels_of(paper.on_paper(as_png([[style.QUANTITY[name]]])))
    assert 1.05 / (luminance(on_white) + 0.05) > 2.6, on_white


def test_the_dark_ground_is_white_paper():
    assert np.all(pixels_of(paper.on_paper(as_png([[style.BACKGROUND]]))) >= 254)


def test_a_body_is_itself_on_paper():
    """What is bright and has much colour is darker, by 8 % at most."""
    for color in (style.FILM_LIT, style.FILM_DARK, style.SUN_DISC, style.NIGHT, style.BUS, style.PANEL):
        [[seen]] = pixels_of(paper.on_paper(as_png([[paper.before(np.array(color))]])))
        assert np.all(seen <= np.array(color) + 2), color
        assert np.all(seen >= 0.92 * np.array(color) - 2), color


def test_the_map_of_a_planet_is_itself_on_paper():
    """Within what a JPEG loses twice."""
    world = np.zeros((64, 128, 3), np.uint8)
    world[:, :64], world[:, 64:] = style.OCEAN, (190, 160, 110)
    out = io.BytesIO()
    Image.fromarray(world).save(out, "JPEG", quality=95)
    glb = paper.map_before(globe(out.getvalue(), 6, 12))
    size = int.from_bytes(glb[12:16], "little")
    described = json.loads(glb[20 : 20 + size])
    view = described["bufferViews"][described["images"][0]["bufferView"]]
    start = 28 + size + view["byteOffset"]
    shown = pixels_of(paper.on_paper(as_png(pixels_of(glb[start : start + view["byteLength"]]))))
    assert np.abs(shown[:, 8:56] - style.OCEAN).max() < 10
    assert np.abs(shown[:, 72:120] - (190, 160, 110)).max() < 10
    assert int.from_bytes(glb[8:12], "little") == len(glb)


def test_scales_and_styles_that_there_are_not_are_refused_in_a_sentence():
    for scale in (0.5, 1.23, 4.1, float("nan")):
        with pytest.raises(RecordingError, match="pixels to a point"):
            tenths_above_one(scale, (1600, 900))
    with pytest.raises(RecordingError, match="more than 8,192 pixels"):
        tenths_above_one(4.0, (3000, 1000))
    with pytest.raises(RecordingError, match="dark or paper"):
        is_paper("sepia")
    for words in (("--scale", "1.23"), ("--scale", "9"), ("--style", "sepia")):
        result = CliRunner().invoke(main, ["picture", "nothing.rrd", *words])
        assert result.exit_code == 2
        assert "Traceback" not in result.output


@needs_vulkan
def test_on_paper_the_ground_is_white_the_film_gold_and_words_dark(run, tmp_path):
    record(run, tmp_path / "run.rrd")
    report = picture(tmp_path / "run.rrd", tmp_path / "a.png", style="paper", at=0.5)
    assert report.errors == ()
    seen = pixels_of(report.path)
    assert np.mean(np.all(seen >= 250, axis=2)) > 0.6, "no white ground"
    assert np.mean(luminance(seen) < 0.02) < 0.05, "black is left"
    gold = np.all(np.abs(seen - style.FILM_LIT) < 40, axis=2)
    assert gold.sum() > 500, "the film is not gold"


@needs_vulkan
def test_more_pixels_to_a_point_are_the_same_picture_and_sharper(run, tmp_path):
    record(run, tmp_path / "run.rrd")
    once = picture(tmp_path / "run.rrd", tmp_path / "a.png", at=0.5, size=(1200, 700))
    twice = picture(tmp_path / "run.rrd", tmp_path / "b.png", at=0.5, size=(1200, 700), scale=2.0)
    assert twice.size == (2400, 1400)
    large = pixels_of(twice.path)
    small = large.reshape(700, 2, 1200, 2, 3).mean((1, 3))
    other = np.abs(small - pixels_of(once.path)).max(2)
    assert np.mean(other > 60) < 0.02, "the layout is another"
    edges = np.abs(np.diff(large.sum(2), axis=1)).max()
    assert edges > 300
    part = picture(tmp_path / "run.rrd", tmp_path / "c.png", view="Flight", size=(333, 217), scale=1.3, dressed=True)
    assert part.size == (433, 282)
