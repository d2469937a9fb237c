"""Every kind of craft that a run may have is drawn, close by and from afar."""

import re
from pathlib import Path

import pytest

from sailviz.recording.drawing.devices import CRAFT
from sailviz.recording.drawing.style import LANES
from sailviz.run import arrays, from_arrays


def test_every_kind_of_craft_has_a_drawing():
    source = Path(arrays.__file__).read_text(encoding="utf-8")
    line = re.search(r"class Craft.*?kind: str  #([^\n]*)", source, re.S).group(1)
    assert set(re.findall(r'"([a-z-]+)"', line)) == set(CRAFT)
    assert set(from_arrays.LABELS) <= set(CRAFT)


@pytest.mark.parametrize("kind", CRAFT)
def test_what_glows_is_drawn_and_what_works_has_words(kind):
    craft, paths = CRAFT[kind], []

    class Listening:
        def __getattr__(self, name):
            return lambda path, *values, **options: paths.append(path)

    craft.log_shape(Listening(), "shape", True)
    assert all(path.startswith("shape/") for path in paths)
    assert craft.glow in ("", "tether/sheath", *paths)
    assert craft.lane in LANES
