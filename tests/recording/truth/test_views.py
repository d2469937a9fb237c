"""Views name what they show: origins, contents, scales, times of trails; and every row stands at its own time."""

from __future__ import annotations

import re

import numpy as np
import pytest

from .craft import size
from .flights import FLIGHTS, SLOWED
from .picture import fits
from .table import drawn

SIZES = {"": 1.0, " million": 1e6, " billion": 1e9}
SOMETIMES = ("/world/plane/shells", "/world/night", "/world/center")  # rules that not every run fills


@pytest.mark.parametrize("name", FLIGHTS)
def test_views_look_from_frames_that_exist_at_entities_that_exist(flights, name):
    picture = flights(name).picture
    assert picture.views
    for view in picture.views:
        assert any(fits(entity, f"{view.origin.rstrip('/')}/**") for entity in picture.entities), view.name
        for rule in (rule.removeprefix("+ ").replace("$origin", view.origin) for rule in view.contents):
            if rule.startswith("- ") or rule.startswith(SOMETIMES) or "/tube/" in rule:
                continue
            assert any(fits(entity, rule) for entity in picture.entities), f"{view.name}: nothing at {rule}"


@pytest.mark.parametrize("name", FLIGHTS)
def test_everything_drawn_is_in_a_view_but_far_planets_and_crowded_names(flights, name):
    flight = flights(name)
    for entity in drawn(flight.picture.entities):
        if entity.startswith(("/plots", "/phase")) or any(view.shows(entity) for view in flight.picture.views):
            continue
        planet = re.match(r"/world/(?:planets|names)/(\w+)", entity)
        assert planet or entity == "/world/sun/name", entity
        if planet and entity.endswith("/orbit"):
            (line,) = flight.picture.line(entity, 0)
            assert np.linalg.norm(line, axis=1).max() > flight.truth.reach


@pytest.mark.parametrize("name", FLIGHTS)
def test_the_names_of_views_tell_their_frames(flights, name):
    origins = {view.name: view.origin for view in flights(name).picture.views if view.kind == "3D"}
    first = [title for title in origins if title.startswith(("System", "Earth"))]
    assert len(first) == 1
    assert origins[first[0]] == ("/world/season" if "turning with the Sun" in first[0] else "/")
    assert origins["Follow"] == "/world/rtn"
    (near,) = [title for title in origins if "close-up" in title]
    assert "(orbital frame" in near
    assert origins[near] == "/sail"
    assert all(origin == "/world/plane" for title, origin in origins.items() if title.startswith("Descent"))


@pytest.mark.parametrize("name", FLIGHTS)
def test_the_first_view_tells_how_much_larger_the_craft_is_and_how_much_slower(flights, name):
    flight = flights(name)
    truth, picture = flight.truth, flight.picture
    (title,) = [view.name for view in picture.views if view.name.startswith(("System", "Earth"))]
    slowed = re.search(r"orbiting slowed (.*?) times", title)
    assert (slowed is not None) == (name in SLOWED)
    if slowed:
        assert number(slowed.group(1)) == pytest.approx(truth.slower, rel=0.06)  # two digits
    larger = re.search(r"×([\d.,]*\d(?: \w+illion)?)", title)
    parts = {"solar-sail": "shape", "electric-sail": "shape", "plasma-brake": "tether"}
    true = truth.scene.get("craft_side_m", truth.scene.get("craft_tether_length_m"))
    assert (larger is not None) == (true is not None)
    if larger:
        drawn_size = size(flight, f"/world/craft/body/{parts[truth.kind]}")
        assert number(larger.group(1)) == pytest.approx(drawn_size * truth.length / true, rel=0.06)


def number(words: str) -> float:
    """1.2 million, 370, 1,100."""
    digits, word = re.fullmatch(r"([\d.,]+)( \w+)?", words).groups()
    return float(digits.replace(",", "")) * SIZES[word or ""]


@pytest.mark.parametrize("name", FLIGHTS)
def test_the_trail_has_the_past_behind_the_craft_and_the_future_ahead(flights, name):
    flight = flights(name)
    seen = 0
    for view in flight.picture.views:
        if view.kind != "3D" or view.origin == "/sail":
            continue
        past, recent, future = (view.trails[f"/world/trail/{part}"] for part in ("past", "recent", "future"))
        assert recent[1] == 0
        assert -0.4 * flight.truth.duration < recent[0] < 0
        assert past[1] == recent[0]
        if "/world/trail/past" in flight.picture.entities:
            assert past[0] is None or past[0] < past[1]
        assert future == "hidden" or future == (0, None)
        flown = {path: ends for path, ends in view.trails.items() if path.endswith(("/flights", "/nominal/path"))}
        assert all(ends == (None, 0) for ends in flown.values())
        assert view.trails["/world/ladder"] == view.trails["/world/plane/ladder"] == (None, None)
        seen += 1
    assert seen >= 3


@pytest.mark.parametrize("name", FLIGHTS)
def test_every_row_that_is_drawn_stands_at_its_own_time(flights, name):
    flight = flights(name)
    rows = {step: (step, *times) for step, *times in flight.picture.clocks["/state"]}
    for entity, clocks in flight.picture.clocks.items():
        if entity not in ("/events", "/log"):
            assert all(clock == rows[clock[0]] for clock in clocks), entity
    ns = np.array([rows[step][1] for step in flight.truth.steps])
    assert np.array_equal(ns, np.round(flight.truth.time * 1e9).astype(np.int64))


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_quantity_has_one_colour_in_space_and_in_its_plot(flights, name):
    picture = flights(name).picture
    pairs = {
        ("/plots/thrust", 0): ("/world/craft/thrust/arrow", "Arrows3D:colors"),
        ("/plots/angles", 0): ("/sail/pitch/arc", "LineStrips3D:colors"),
        ("/plots/angles", 1): ("/sail/cone", "LineStrips3D:colors"),
        ("/plots/clock", 0): ("/sail/clock/arc", "LineStrips3D:colors"),
    }
    for (plot, k), (entity, component) in pairs.items():
        if plot in picture.entities and entity in picture.entities:
            curve = picture.color(plot, "SeriesLines:colors")[k]
            assert np.array_equal(curve, picture.color(entity, component)[0]), plot
    words = {"/world/craft/thrust/arrow": "/sail/force/arrow", "/world/craft/velocity/arrow": "/sail/velocity"}
    for far, near in words.items():
        if near in picture.entities:
            same = [picture.color(entity, "Arrows3D:colors")[0] for entity in (far, near)]
            assert np.array_equal(*same)
