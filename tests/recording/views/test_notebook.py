"""In a notebook: a run sums itself up, a viewer shows it without the internet, and the example notebook runs."""

import os
import re
import sys
from dataclasses import replace
from html.parser import HTMLParser
from importlib.util import find_spec
from types import SimpleNamespace

import numpy as np
import pytest

import sailviz
from sailviz.recording import record
from sailviz.run.arrays import Event
from sailviz.shipped import shipped_folder

NOTEBOOKS = sorted((shipped_folder("scenes") / "notebooks").glob("*.ipynb"))


@pytest.fixture(scope="module")
def run():
    scene = sailviz.load_scene("spirals/radial-escape", {"propagation.outputs": 40, "expect": []})
    return sailviz.simulate(scene)


class Words(HTMLParser):
    """The text of a page; refuses tags that are left open."""

    def __init__(self, page):
        super().__init__()
        self.words, self.open = [], []
        self.feed(page)
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)


def test_a_run_sums_itself_up(run):
    words = Words(run._repr_html_()).words
    assert "Tsien's problem: escape by radial thrust" in words
    assert any("ended by escape" in word for word in words)
    assert words[words.index("semi-major axis") + 1] == "1 au"
    assert words[words.index("distance from the Sun") + 2].startswith("4.33333 au")
    assert "escape" in words[words.index("event") :]
    assert repr(run).startswith(
        "<Run Tsien's problem: escape by radial thrust: 40 rows over 1.88304 yr, ended by escape"
    )
    assert len(repr(run)) < 200


def test_a_summary_fetches_nothing_and_has_no_colours_of_its_own(run):
    page = run._repr_html_()
    assert len(page) < 8000
    assert not re.search(r"https?:|<script|<img|url\(", page)
    assert re.findall(r"(?:color|background): ([^;\"]+)", page).count("inherit") >= 2
    assert set(re.findall(r"(?:color|background): ([^;\"]+)", page)) == {"inherit", "none"}


def test_words_of_a_scene_cannot_become_markup(run):
    evil = "<script>alert('&')</script>"
    setting = replace(run.setting, title=evil, about=f"**{evil}**", parameters=((evil, evil),))
    events = tuple(Event(evil, float(t), np.zeros(7)) for t in range(40))
    page = replace(run, setting=setting, events=events, ended=evil)._repr_html_()
    assert "<script" not in page
    assert "and 28 more" in page
    assert Words(page).words.count(evil) >= 15


def test_a_block_says_where_it_begins(run):
    from sailviz.recording.timelines import take

    part = take(run, slice(10, 11))
    assert "1 row over 0 s from" in " ".join(Words(part._repr_html_()).words)
    assert "no rows" in take(run, slice(0, 0))._repr_html_()


@pytest.fixture
def sent(monkeypatch):
    """What a stand-in for Rerun's widget was given; its import is that of the true one."""
    calls = []

    class Viewer:
        def __init__(self, **how):
            calls.append(how)

        def send_rrd(self, data):
            calls.append(data)

    monkeypatch.setitem(sys.modules, "rerun_notebook", SimpleNamespace(Viewer=Viewer))
    monkeypatch.delenv("RERUN_NOTEBOOK_ASSET", raising=False)
    return calls


def test_show_sends_the_whole_recording_and_serves_the_viewer_from_here(run, sent, tmp_path):
    assert sailviz.show(run, width=800, height=450) is not None
    assert sent[0] == {"width": 800, "height": 450, "theme": "dark"}
    assert os.environ["RERUN_NOTEBOOK_ASSET"] == "serve-local"
    path = tmp_path / "sent.rrd"
    path.write_bytes(sent[1])
    assert np.array_equal(sailviz.read(path)["/state"]["position_m"], run.position)
    for source in (path, str(path), sailviz.read(path)):
        sailviz.show(source)
        assert sent[-1] == path.read_bytes()


def test_show_leaves_the_users_choice_of_server_alone(run, sent, monkeypatch):
    monkeypatch.setenv("RERUN_NOTEBOOK_ASSET", "inline")
    sailviz.show(run)
    assert os.environ["RERUN_NOTEBOOK_ASSET"] == "inline"


def test_without_the_extra_show_says_what_to_install(run, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "rerun_notebook", None)
    with pytest.raises(sailviz.RecordingError, match=r"pip install 'sailviz\[notebook\]'"):
        sailviz.show(run)
    record(run, tmp_path / "run.rrd")


def test_show_refuses_what_it_cannot_show(sent, tmp_path):
    with pytest.raises(sailviz.RecordingError, match="not a dict"):
        sailviz.show({})
    with pytest.raises(sailviz.RecordingError, match="no such file"):
        sailviz.show(tmp_path / "nothing.rrd")


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook_runs_from_top_to_bottom(notebook, tmp_path, monkeypatch):
    """Cells tagged `viewer` need the extra `notebook` and are left out without it."""
    nbclient = pytest.importorskip("nbclient", reason="the extra test brings nbclient")
    nbformat = pytest.importorskip("nbformat")
    pytest.importorskip("ipykernel", reason="the extra test brings ipykernel")
    book = nbformat.read(notebook, as_version=4)
    cells = [cell for cell in book.cells if cell.cell_type == "code"]
    assert all(cell.outputs == [] and cell.execution_count is None for cell in cells), "strip the outputs"
    more = {} if find_spec("rerun_notebook") else {"skip_cells_with_tag": "viewer"}
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    nbclient.NotebookClient(book, timeout=120, resources={"metadata": {"path": str(tmp_path)}}, **more).execute()
    kinds = {kind for cell in cells for output in cell.outputs for kind in output.get("data", {})}
    assert "text/html" in kinds
    assert more or "application/vnd.jupyter.widget-view+json" in kinds
    assert next(tmp_path.glob("*.rrd")).stat().st_size > 0
