"""Reports: what a page says is what was recorded, it stands alone, and nothing that people wrote becomes markup."""

import base64
import hashlib
import json
import re
import sys
from html.parser import HTMLParser

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner

from sailviz import load_scene, read, record, simulate, sweep
from sailviz.cli import main
from sailviz.constants import RADIUS_EARTH, YEAR
from sailviz.deorbits.disposal import RULES, Descent, shares_within
from sailviz.recording import digest
from sailviz.recording.views.screenshot import has_vulkan
from sailviz.reports.flight import flight_page
from sailviz.reports.page import html_of
from sailviz.reports.spread import far_words
from sailviz.reports.sweep import facts_of, sweep_page
from sailviz.reports.sweep_pictures import panels_of
from sailviz.words import duration

WICKED = '<img src=x onerror="alert(1)"> & {{ 7 * 7 }}'
DESCENT = {
    "title": WICKED,
    "epoch": "2030-03-20T12:00:00Z",
    "body": "earth",
    "start": {"kind": "circular", "altitude_km": 300, "inclination_deg": 60, "raan_deg": 20},
    "device": {
        "kind": "plasma-brake", "tether_length_m": 2000, "mass_kg": 5, "drag_area_m2": 0.2, "drag_coefficient": 2.2
    },
    "environment": {
        "ionosphere": {
            "kind": "exponential-force", "force_per_length_nN_m": 300, "reference_altitude_km": 300,
            "scale_height_km": 500,
        },
        "atmosphere": {
            "kind": "exponential", "reference_altitude_km": 300, "density_kg_m3": 2e-11, "scale_height_km": 50,
        },
    },
    "propagation": {"duration_d": 40, "outputs": 200},
    "event": [{"kind": "altitude", "name": "re-entry", "altitude_km": 120, "sense": "down", "stop": True}],
    "expect": [{"quantity": "altitude_km", "at": "end", "value": 120, "within": 0.01}],
}  # fmt: skip


class Markup(HTMLParser):
    """Names of all elements, addresses in them, and the words of the cells of tables."""

    def __init__(self, page):
        super().__init__()
        self.tags, self.addresses, self.words = set(), [], []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.addresses += [value for name, value in attrs if name in ("src", "href", "action", "data", "srcset")]
        assert not [name for name, _ in attrs if name.startswith("on")]

    def handle_data(self, data):
        self.words.append(data.strip())


@pytest.fixture(scope="module")
def fallen(tmp_path_factory):
    """A recorded descent: its path."""
    path = tmp_path_factory.mktemp("fallen") / "fallen.rrd"
    record(simulate(load_scene(DESCENT)), path)
    return path


def sentences(section):
    return " ".join(section.sentences)


def test_the_answer_is_the_end_of_the_recorded_flight(fallen):
    page = flight_page(fallen, load_scene(DESCENT), pictures=False, others=False)
    state = read(fallen)["/state"]
    height = np.linalg.norm(state["position_m"][-1]) - RADIUS_EARTH
    assert height == pytest.approx(120e3, abs=1)
    assert page.answer[0] == f"It is down after {duration(float(state['time_s'][-1]))} (the flight ends 120 km high)."
    assert "5 years after the start of this flight: kept" in page.answer[1]
    assert "1 of 1 expectations" in page.answer[-1]
    assert any("casualty risk" in sentences(section) for section in page.sections)
    assumed = next(section for section in page.sections if section.heading == "Assumptions")
    words = " ".join(cell for row in assumed.tables[0].rows for cell in row)
    assert "15 %" in sentences(assumed)
    for said in ("5 kg", "0.2 m²", "2.2"):
        assert said in words, words


def test_without_its_brake_the_craft_stays_up_longer(fallen):
    page = flight_page(fallen, load_scene(DESCENT), pictures=False)
    beside = next(table for section in page.sections for table in section.tables if table.caption == "Beside it")
    braked, alone = beside.rows
    assert alone[0].startswith("drag alone")
    days = [float(re.search(r"after ([\d.]+) d", words)[1]) for words in (braked[1], alone[1])]
    free = simulate(load_scene(DESCENT | {"device": {"kind": "none", "mass_kg": 5, "drag_area_m2": 0.2}, "expect": []}))
    assert days[1] == pytest.approx(free.time[-1] / 86400, rel=1e-5)
    assert days[1] > 1.2 * days[0]
    assert "other Suns" in sentences(next(s for s in page.sections if s.heading == "Disposal"))


def test_the_swept_product_is_area_times_time(fallen):
    page = flight_page(fallen, load_scene(DESCENT), pictures=False, others=False)
    said = sentences(next(section for section in page.sections if section.heading == "Disposal"))
    time = float(read(fallen)["/state"]["time_s"][-1])
    expected = (0.2 + 2000 * 50e-6) * time / YEAR
    assert float(re.search(r"times time: ([\d.e-]+) m² yr", said)[1]) == pytest.approx(expected, rel=1e-3)


def test_the_page_stands_alone_and_what_people_wrote_stays_text(fallen, tmp_path):
    out = tmp_path / "page.html"
    result = CliRunner().invoke(main, ["report", str(fallen), "-o", str(out), "--no-pictures", "--alone"])
    assert result.exit_code == 0, result.stderr
    page = out.read_text()
    markup = Markup(page)
    assert not markup.tags & {"script", "img", "iframe", "object", "link", "form", "base"}
    assert markup.addresses == []
    assert WICKED in markup.words  # as it was written, and not as markup
    assert "49" not in markup.words
    assert "http" not in re.sub(r'http-equiv="Content-Security-Policy"', "", page)
    assert hashlib.sha256(fallen.read_bytes()).hexdigest() in markup.words


@pytest.mark.skipif(not has_vulkan(), reason="no Vulkan driver: apt-get install libvulkan1 mesa-vulkan-drivers")
def test_pictures_are_in_the_page_itself(fallen, tmp_path):
    out = tmp_path / "page.html"
    assert CliRunner().invoke(main, ["report", str(fallen), "-o", str(out), "--alone"]).exit_code == 0
    addresses = Markup(out.read_text()).addresses
    assert len(addresses) == 4
    for address in addresses:
        data = base64.b64decode(address.removeprefix("data:image/png;base64,"))
        assert data.startswith(b"\x89PNG")
        assert 300 < int.from_bytes(data[16:20], "big") <= 1600


def test_a_scene_is_flown_for_its_report_and_its_values_are_told(tmp_path):
    out = tmp_path / "page.html"
    words = ["report", "spirals/logarithmic", "-o", str(out), "--no-pictures", "--set", "propagation.outputs=50"]
    result = CliRunner().invoke(main, words)
    assert result.exit_code == 0, result.stderr
    told = Markup(out.read_text()).words
    assert "propagation.outputs" in told
    assert told[told.index("propagation.outputs") + 2] == "50" or "50" in told
    assert "Flown:" in result.stdout
    assert "Disposal" not in told


def test_a_limit_is_kept_missed_or_open_as_far_as_was_flown():
    (_, five, _), (_, many, _) = RULES
    assert five == 5 * YEAR
    assert many == 25 * YEAR
    down = Descent(4 * YEAR, True, 120e3, "re-entry")
    late = Descent(6 * YEAR, True, 120e3, "re-entry")
    high = Descent(6 * YEAR, False, 500e3, "")
    told = ["kept, with 1 yr to spare", "not kept, by 1 yr", "not kept"]
    assert [d.verdict(five) for d in (down, late, high)] == told
    assert late.verdict(many) == "kept, with 19 yr to spare"
    assert high.verdict(many) == "open: only 6 yr were flown"


def test_flights_that_are_still_up_count_as_late_only_once_their_time_shows_it():
    known = np.array([1.0, 4.0, 6.0, np.nan, np.nan])
    least = np.array([np.nan, np.nan, np.nan, 3.0, 7.0])
    assert shares_within(known, least, 5.0) == (2, 2, 1)


def test_a_sweep_of_descents_says_how_many_are_down_and_how_many_still_fly(tmp_path):
    """With the smaller drag areas the duration of the scene does not suffice."""
    scene = DESCENT | {"expect": [], "propagation": {"duration_d": 4, "outputs": 20}}
    found = sweep(
        scene, {"device.drag_area_m2": [0.05, 0.1, 0.5, 1.0]}, report=["time_d@re-entry"], engine="serial",
        path=tmp_path / "fallen.parquet",
    )  # fmt: skip
    page = sweep_page(found.to_arrow(), load_scene(scene))
    times = found.table["time_d@re-entry"]
    up = int(np.isnan(times).sum())
    assert 0 < up < 4
    assert f"{up:,} of 4 flights ({up / 4:.1%}) had not come there" in page.answer[1]
    limits = next(section for section in page.sections if section.heading == "Disposal").tables[0]
    assert limits.rows[0][1:4] == (f"{4 - up} ({1 - up / 4:.1%})", "0 (0.0%)", f"{up} ({up / 4:.1%})")
    out = tmp_path / "fallen.html"
    result = CliRunner().invoke(main, ["report", str(tmp_path / "fallen.parquet"), "-o", str(out)])
    assert result.exit_code == 0, result.stderr
    assert page.answer[0] in result.stdout


def test_what_is_no_source_of_a_report_is_refused_and_nothing_is_written(fallen, tmp_path, monkeypatch):
    pq.write_table(pa.table({"a": [1]}), tmp_path / "other.parquet")
    (tmp_path / "cut.parquet").write_bytes(b"PAR1 and no more")
    (tmp_path / "words.rrd").write_text("words")
    out = tmp_path / "page.html"

    def refused(*words):
        result = CliRunner().invoke(main, ["report", *map(str, words)])
        assert result.exit_code == 2
        assert "Traceback" not in result.stderr
        assert not out.exists()
        return result.stderr

    assert "does not say of which sweep" in refused(tmp_path / "other.parquet", "-o", out)
    assert "cannot be read as the table" in refused(tmp_path / "cut.parquet", "-o", out)
    assert "not a Rerun recording" in refused(tmp_path / "words.rrd", "-o", out)
    assert "spirals/logarithmic" in refused("spirals/logaritmic", "-o", out)
    assert "was flown already" in refused(fallen, "-o", out, "--set", "propagation.outputs=5")
    assert "must end in .html" in refused(fallen, "-o", tmp_path / "page.pdf")
    monkeypatch.setitem(sys.modules, "jinja2", None)
    assert "sailviz[report]" in refused(fallen, "-o", out)


def swept(columns, vary, draws=0):
    """The table of a sweep, as sailviz writes it."""
    facts = {
        "scene": WICKED, "values": {"title": WICKED}, "vary": vary, "together": False, "draws": draws, "seed": 0,
        "report": [], "sailviz": "0.1",
    }  # fmt: skip
    count = len(next(iter(columns.values())))
    whole = {"index": np.arange(count), "status": ["flown"] * count, "ended": ["there"] * count} | columns
    return pa.table(whole).replace_schema_metadata({b"sailviz.sweep": json.dumps(facts)})


def test_a_sweep_over_one_or_two_keys_is_drawn_over_the_finer_one_and_bounds_apart():
    pitch, mass = np.repeat([20.0, 30.0, 40.0], 2), np.tile([1.0, 2.0], 3)
    time = np.array([5.0, 6.0, 4.0, 5.0, np.nan, np.nan])
    least = np.where(np.isnan(time), 9.0, np.nan)
    columns = {
        "steering.pitch_deg": pitch, "device.mass_kg": mass, "time_d@there": time, "time_d@there at least": least
    }  # fmt: skip
    table = swept(columns, {"steering.pitch_deg": "", "device.mass_kg": ""})
    (panel,) = panels_of(table, facts_of(table), ["time_d@there"])
    assert (panel.quantity, panel.key) == ("time_d@there", "steering.pitch_deg")
    assert [one.name for one in panel.series] == ["device.mass_kg 1", "device.mass_kg 2"]
    for number, one in enumerate(panel.series):
        assert np.array_equal(one.over, [20.0, 30.0, 40.0])
        assert np.array_equal(one.values, time[number::2], equal_nan=True)
        assert np.array_equal(one.least, least[number::2], equal_nan=True)


def test_drawn_flights_are_shown_as_they_are_spread_with_their_percentiles():
    time = np.concatenate([np.arange(1.0, 20.0), [np.nan]])
    least = np.where(np.isnan(time), 30.0, np.nan)
    columns = {"device.drag_coefficient": np.arange(20.0), "time_yr@there": time, "time_yr@there at least": least}
    table = swept(columns, {"device.drag_coefficient": "normal"}, draws=20)
    (panel,) = panels_of(table, facts_of(table), ["time_yr@there"])
    assert np.array_equal(panel.values, time[:-1])
    assert panel.least.tolist() == [30.0]
    assert dict(panel.marks)["median"] == pytest.approx(10.5)


def test_the_picture_of_a_sweep_is_in_its_page_and_words_stay_text():
    columns = {"steering.pitch_deg": [1.0, 2.0, 3.0], "radius_au@end": [1.0, 1.2, 1.1]}
    table = swept(columns, {"steering.pitch_deg": ""})
    markup = Markup(html_of(sweep_page(table, None)))
    (address,) = markup.addresses
    assert base64.b64decode(address.removeprefix("data:image/png;base64,")).startswith(b"\x89PNG")
    assert WICKED in markup.words
    assert not Markup(html_of(sweep_page(table, None, pictures=False))).addresses


@pytest.fixture(scope="module")
def windy(tmp_path_factory):
    """A recording of forty flights through the solar wind, with and without control."""
    path = tmp_path_factory.mktemp("windy") / "windy.rrd"
    short = {"propagation.duration_yr": 0.1, "propagation.outputs": 15}
    scene = load_scene("wind/voltage-limits")
    ensembles = [{"flights": 40} | {k: v for k, v in one.items() if k != "flights"} for one in scene.raw["ensemble"]]
    record(simulate(scene.with_values({**short, "ensemble": ensembles, "expect": []})), path)
    return path


def test_a_report_of_ensembles_says_how_far_from_the_calm_flight_they_end(windy):
    page = flight_page(windy, pictures=False)
    recording = read(windy)
    names = [name for name in recording.entities if name.startswith("/ensemble/") and name.count("/") == 2]
    assert len(names) == 3
    told = " ".join(page.answer)
    for name in names:
        facts, calm = recording[f"{name}/facts"], recording[name]["nominal_position_m"][-1]
        r, angle = np.ravel(facts["end_radius_m"]), np.ravel(facts["end_azimuth_rad"])
        first = recording[name]["nominal_position_m"][0]
        across = np.cross([0.0, 0.0, 1.0], first / np.linalg.norm(first))
        places = r[:, None] * (np.cos(angle)[:, None] * first / np.linalg.norm(first) + np.sin(angle)[:, None] * across)
        half = far_words(float(np.median(np.linalg.norm(places - calm, axis=1))))
        assert f"of 40 flights half end within {half} of the calm flight" in told
    table = next(section for section in page.sections if section.heading == "Uncertainty").tables[0]
    assert len(table.head) == 4
    assert {"flights", "seed", "method"} <= {row[0] for row in table.rows}
    motion = next(section for section in page.sections if section.heading == "Motion").tables[0]
    assert not [cell for row in motion.rows for cell in row if "nan" in cell or "e-1" in cell]
    inputs = next(section for section in page.sections if section.heading == "Inputs").tables[0]
    assert digest(windy) in [row[1] for row in inputs.rows]
