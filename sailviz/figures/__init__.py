"""Curves and maps on paper.

    from sailviz import figures
    figures.names()
    figures.draw("stability", "stability.svg")

Needs matplotlib, which comes with the extra `plot`: pip install "sailviz[plot]".
"""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.figures.catalogue import CATALOGUE as CATALOGUE
    from sailviz.figures.catalogue import Entry as Entry
    from sailviz.figures.drawing import FORMATS as FORMATS
    from sailviz.figures.drawing import FigureError as FigureError
    from sailviz.figures.drawing import draw as draw
    from sailviz.figures.drawing import figure as figure
    from sailviz.figures.drawing import names as names
    from sailviz.figures.drawing import title as title
    from sailviz.figures.recorded import draw_recording as draw_recording

_HOMES = {
    "CATALOGUE": "catalogue",
    "Entry": "catalogue",
    "FORMATS": "drawing",
    "FigureError": "drawing",
    "draw": "drawing",
    "figure": "drawing",
    "names": "drawing",
    "title": "drawing",
    "draw_recording": "recorded",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
