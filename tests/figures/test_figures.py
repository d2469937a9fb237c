"""Every figure is drawn, in both styles and all formats, with its words inside the page and nothing on top of them."""

from __future__ import annotations

import sys
from itertools import combinations

import numpy as np
import pytest

from sailviz import figures
from sailviz.figures import transfer_data

pytest.importorskip("matplotlib")


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", figures.names())
def test_words_stay_inside_the_page_and_apart(name):
    drawn = figures.figure(name)
    drawn.canvas.draw()
    renderer, page = drawn.canvas.get_renderer(), drawn.bbox
    for panel in drawn.axes:
        words = [w for w in (panel.title, panel.xaxis.label, panel.yaxis.label, *panel.texts) if w.get_text()]
        boxes = [(word.get_text(), word.get_window_extent(renderer)) for word in words]
        for text, box in boxes:
            assert page.x0 <= box.x0, text
            assert box.x1 <= page.x1, text
            assert page.y0 <= box.y0, text
            assert box.y1 <= page.y1, text
        for (one, a), (other, b) in combinations(boxes, 2):
            shared = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
            assert min(shared) < 2, f"{one!r} runs into {other!r}"
    for words in (drawn.get_suptitle(), drawn.get_supxlabel()):
        assert words
    for artist in (drawn._suptitle, drawn._supxlabel):
        box = artist.get_window_extent(renderer)
        assert 0 <= box.x0 < box.x1 <= page.x1


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_figures_are_written_and_the_same_every_time(tmp_path, ending):
    files = [figures.draw("thesis-3.5", tmp_path / f"{i}.{ending}", style="light") for i in range(2)]
    assert files[0].read_bytes() == files[1].read_bytes()
    assert len(files[0].read_bytes()) > 5000


def test_titles_come_without_matplotlib():
    assert all(figures.title(name) for name in figures.names())
    assert figures.names()[:2] == ["thesis-3.4", "thesis-3.5"]


def test_wrong_requests_are_refused_in_a_sentence(tmp_path, monkeypatch):
    with pytest.raises(figures.FigureError, match=r"there are thesis-3\.4"):
        figures.draw("thesis-9.9", tmp_path / "a.png")
    with pytest.raises(figures.FigureError, match="png, svg, pdf"):
        figures.draw("escape", tmp_path / "a.docx")
    with pytest.raises(figures.FigureError, match="dark and light"):
        figures.draw("thesis-3.5", tmp_path / "a.png", style="neon")
    with pytest.raises(figures.FigureError, match="there is no directory"):
        figures.draw("thesis-3.5", tmp_path / "nowhere" / "a.png")
    monkeypatch.setitem(sys.modules, "sailviz.figures.page", None)
    monkeypatch.delattr(figures, "page", raising=False)
    with pytest.raises(figures.FigureError, match="sailviz\\[plot\\]"):
        figures.draw("thesis-3.5", tmp_path / "a.png")


def test_figures_come_from_the_shell(tmp_path):
    from click.testing import CliRunner

    from sailviz.cli import main

    def shell(*words):
        return CliRunner().invoke(main, ["figure", *words])

    listing = shell("--list")
    assert listing.exit_code == 0
    assert all(name in listing.output for name in figures.names())
    drawn = shell("thesis-4.3", "thesis-4.4", "-o", str(tmp_path / "new"), "--style", "light", "--dpi", "50")
    assert drawn.exit_code == 0, drawn.output
    assert sorted(path.name for path in (tmp_path / "new").iterdir()) == ["thesis-4.3.png", "thesis-4.4.png"]
    single = shell("thesis-4.3", "-q", "-o", str(tmp_path / "one.svg"))
    assert (single.exit_code, single.output) == (0, "")
    assert "<svg" in (tmp_path / "one.svg").read_text()
    for words, sentence in (
        ((), "--list"),
        (("thesis-9",), "there are thesis-3.4"),
        (("escape", "-o", str(tmp_path / "x.docx")), "png, svg, pdf"),
        (("escape", "spirals", "-o", str(tmp_path / "x.png")), "folder"),
    ):
        refused = shell(*words)
        assert refused.exit_code == 2
        assert sentence in refused.output


def test_shipped_flight_times_have_no_gaps_and_less_thrust_takes_longer():
    for (target, device), rows in transfer_data.flight_times().items():
        acceleration, days, _ = rows.T
        assert np.all(np.isfinite(rows)), (target, device)
        assert np.all(np.diff(acceleration) > 0)
        assert np.all(np.diff(days) < 0), (target, device)
