"""Views name what they show: origins, contents, scales, times of trails; and every row stands at its own time."""

from __future__ import annotations

import re

import numpy as np
import pytest

from .craft import size
from .flights import FLIGHTS
from .picture import fits
from .screen import meetings, on_screen
from .table import drawn

SOMETIMES = ("/world/plane/shells", "/world/night", "/world/center")  # rules that not every run fills
NAMED = re.compile(r"/world/(names|marks|approximation)/")
IN_SIGHT = 0.999  # of a view's half width and height


@pytest.mark.parametrize("name", FLIGHTS)
def test_views_look_from_frames_that_exist_at_entities_that_exist(flights, name):
    picture = flights(name).picture
    assert picture.views
    for view in picture.views:
        assert any(fits(entity, f"{view.origin.rstrip('/')}/**") for entity in picture.entities), view.name
        for rule in (rule.removeprefix("+ ").replace("$origin", view.origin) for rule in view.contents):
            if rule.startswith("- ") or rule.startswith(SOMETIMES):
                continue
            assert any(fits(entity, rule) for entity in picture.entities), f"{view.name}: nothing at {rule}"


@pytest.mark.parametrize("name", FLIGHTS)
def test_everything_drawn_is_in_a_view(flights, name):
    picture = flights(name).picture
    hidden = [e for e in drawn(picture.entities) if not any(view.shows(e) for view in picture.views)]
    assert hidden == []


@pytest.mark.parametrize("name", FLIGHTS)
def test_views_stand_where_a_person_looks_for_them(flights, name):
    picture, truth = flights(name).picture, flights(name).truth
    names = [view.name for view in picture.views]
    origins = {view.name: view.origin for view in picture.views if view.kind == "3D"}
    assert truth.scene["title"] in names  # over the line of the moment
    if "/world/tail" in picture.entities:
        assert [origin for title, origin in origins.items() if title.startswith("Riding along")] == ["/world/rtn"]
        assert origins["Where it is"] == ("/world/season" if "/world/season" in picture.entities else "/")
    else:
        assert origins["Flight"] == ("/world/pan" if "/world/pan" in picture.entities else "/")
        assert origins["Riding along"] == "/world/rtn"
        assert any("close up" in title and origin == "/sail" for title, origin in origins.items())
    assert all(origin == "/world/plane" for title, origin in origins.items() if title.startswith("Descent"))


@pytest.mark.parametrize("name", FLIGHTS)
def test_the_first_view_tells_how_much_longer_the_tether_is_drawn(flights, name):
    flight = flights(name)
    truth, picture = flight.truth, flight.picture
    titles = [view.name for view in picture.views if view.name.startswith("Riding along")]
    told = re.search(r"tether drawn about ([\d,]+) times too long", titles[0])
    assert (told is not None) == (truth.kind == "plasma-brake")
    if told:
        lengths = [size(flight, "/world/rtn/body/tether", row) for row in range(len(truth))]
        drawn_length = np.median(lengths) * truth.length / truth.scene["craft_tether_length_m"]
        assert float(told.group(1).replace(",", "")) == pytest.approx(drawn_length, rel=0.06)


@pytest.mark.parametrize(("name", "plane"), [("spinning", 1), ("spinning across", 2)])
def test_a_spinning_tether_turns_eight_times_from_straight_down_in_its_plane_and_the_view_says_that_it_is_slowed(
    flights, name, plane
):
    """plane : of the radial, the transverse and the normal axis the second one in which it lies."""
    flight = flights(name)
    truth = flight.truth
    (view,) = [view for view in flight.picture.views if view.name.startswith("Riding along")]
    assert "its spin slowed" in view.name
    home = truth.place / truth.length
    tips = [flight.picture.place("/world/rtn/body/tether/tip", "Points3D:positions", step)[0] for step in truth.steps]
    frame = truth.drawn_frame @ (np.array(tips) - home)[..., None]
    radial, across, out = frame[:, 0, 0], frame[:, plane, 0], frame[:, 3 - plane, 0]
    assert np.abs(out).max() < 1e-5, "it leaves its plane"
    angle = np.unwrap(np.arctan2(across, -radial))
    assert abs(angle[0]) < 1e-4
    assert abs(angle[-1]) == pytest.approx(16 * np.pi, abs=1e-3)
    assert np.allclose(np.diff(angle) / np.diff(truth.time), angle[-1] / (truth.time[-1] - truth.time[0]), rtol=1e-3)


@pytest.mark.parametrize("name", FLIGHTS)
def test_the_whole_flight_and_its_push_are_in_sight_of_the_first_view_all_along(flights, name):
    flight = flights(name)
    if "/world/tail" in flight.picture.entities:
        pytest.skip("a low orbit is seen from the craft")
    (view,) = [view for view in flight.picture.views if view.name == "Flight"]
    place = flight.truth.place / flight.truth.length
    if "/world/craft/push" in flight.picture.entities:
        arrows = [flight.picture.arrow("/world/craft/push", step)[1][0] for step in flight.truth.steps]
        place = np.concatenate([place, place + arrows]) if len(arrows) < 400 else place
    for step in flight.truth.steps[:: max(len(flight.truth) // 9, 1)]:
        pose = flight.picture.pose(view.origin, step) if view.origin != "/" else np.eye(4)
        local = (place - pose[:3, 3]) @ pose[:3, :3]
        own = local if "/world/pan" not in flight.picture.entities else local[: len(flight.truth)]
        seen = on_screen(own[: len(flight.truth)], view)
        assert np.abs(seen).max() < IN_SIGHT, f"row {step}: {np.abs(seen).max():.3f} of the view"


@pytest.mark.parametrize("name", FLIGHTS)
def test_no_name_lies_on_another_in_the_first_the_middle_and_the_last_frame(flights, name):
    flight = flights(name)
    steps = flight.truth.steps

    def own_step(entity, step):
        """The row of the flight to which an entity belongs at the time of a row of the first; None before it begins."""
        own, row = whose(flight, entity).truth, int(np.searchsorted(steps, step))
        here = int(np.searchsorted(own.clock, flight.truth.clock[row], "right")) - 1
        return own.steps[here] if here >= 0 else None

    met = meetings(flight.picture, [int(steps[row]) for row in (0, len(steps) // 2, -1)], own_step)
    assert met == []


@pytest.mark.parametrize("name", FLIGHTS)
def test_the_trail_has_the_past_behind_the_craft_and_the_future_ahead(flights, name):
    flight = flights(name)
    if "/world/trail/recent" not in flight.picture.entities:
        pytest.skip("rows lie far apart: the orbit of the moment is drawn")
    seen = 0
    for view in flight.picture.views:
        if view.kind != "3D" or view.origin == "/sail":
            continue
        past, recent = (view.trails[f"/world/trail/{part}"] for part in ("past", "recent"))
        assert recent[1] == 0
        assert -0.2 * flight.truth.duration < recent[0] < 0
        assert past[1] == recent[0]
        assert past[0] is None or past[0] < past[1]
        assert view.trails.get("/world/trail/future", (0, None)) == (0, None)
        flown = {path: ends for path, ends in view.trails.items() if path.endswith(("/flights", "/nominal/path"))}
        assert all(ends == (None, 0) for ends in flown.values())
        for part, ends in (("past", (None, 0)), ("future", (0, None))):
            if f"/world/fence/{part}" in flight.picture.entities:
                assert view.trails[f"/world/fence/{part}"] == view.trails[f"/world/fence/{part}/edge"] == ends
        seen += 1
    assert seen >= 3


def whose(first, entity):
    """The flight in whose rows an entity stands."""
    words = [flight.word for flight in first.all[1:]]
    of_first = entity.startswith(("/plots/apart/", "/plots/difference/"))
    word = next((word for word in words if word in entity.split("/")), "") if not of_first else ""
    return first.beside(word) if word else first


@pytest.mark.parametrize("name", FLIGHTS)
def test_every_row_that_is_drawn_stands_at_its_own_time(flights, name):
    first = flights(name)
    flight = first
    for entity, clocks in first.picture.clocks.items():
        flight = whose(first, entity)
        state = f"/flight/{flight.word}/state" if flight.word else "/state"
        rows = {step: (step, *times) for step, *times in first.picture.clocks[state]}
        if entity.startswith("/plots/"):  # just within a gap a curve is broken
            clocks = {clock for clock in clocks if clock[0] not in flight.truth.breaks or clock == rows[clock[0]]}
        if not entity.endswith("/events") and entity != "/log" and not re.search(r"/\d+/(band|mean)$", entity):
            assert all(clock == rows[clock[0]] for clock in clocks), entity
    flight = first
    rows = {step: (step, *times) for step, *times in first.picture.clocks["/state"]}
    points = flight.truth.recording["/filled"]["time_s"] if "/filled" in flight.truth.recording else np.zeros(0)
    moving = [entity for entity in flight.picture.between if entity.startswith(("/world", "/sail", "/filled"))]
    for entity, components in flight.picture.between.items():
        if len(first.all) > 1 and (entity == "/now" or NAMED.match(entity)):  # while the first flight does not fly
            ends = whose(first, entity).truth.clock[[0, -1]] * 1e9
            assert all(not ends[0] <= ns <= ends[1] for rows_between in components.values() for ns, _ in rows_between)
            continue
        for values in components.values():
            filled = set(np.round(points * 1e9).astype(np.int64).tolist()) if entity in moving else set()
            rows_between = [(ns, value) for ns, value in values if ns not in filled]
            if entity in moving:
                assert not rows_between, f"{entity} moves where nothing is filled"
                continue
            for (start, end), (ns, _) in zip(flight.truth.gaps, sorted(rows_between), strict=True):
                assert start < ns * 1e-9 < end, entity
    ns = np.array([rows[step][1] for step in flight.truth.steps])
    assert np.array_equal(ns, np.round(flight.truth.time * 1e9).astype(np.int64))


@pytest.mark.parametrize("name", FLIGHTS)
def test_a_quantity_has_one_colour_in_space_and_in_its_plot(flights, name):
    picture = flights(name).picture
    pairs = {
        ("/plots/push", 0): ("/world/craft/push", "Arrows3D:colors"),
        ("/plots/angle", 0): ("/sail/angle/arc", "LineStrips3D:colors"),
        ("/plots/angle", 1): ("/sail/push", "Arrows3D:colors"),
        ("/plots/clock", 0): ("/sail/clock/arc", "LineStrips3D:colors"),
        ("/plots/speed", 0): ("/sail/velocity", "Arrows3D:colors"),
    }
    for (plot, k), (entity, component) in pairs.items():
        if plot in picture.entities and entity in picture.entities:
            colors = picture.color(plot, "SeriesLines:colors")
            if k < len(colors):
                assert np.array_equal(colors[k], picture.color(entity, component)[0]), plot
    for far, near in {"/world/craft/push": "/sail/push"}.items():
        if near in picture.entities and far in picture.entities:
            same = [picture.color(entity, "Arrows3D:colors")[0] for entity in (far, near)]
            assert np.array_equal(*same)


@pytest.mark.parametrize("name", FLIGHTS)
def test_plots_vary_and_have_two_numbers_on_their_axis(flights, name):
    for view in flights(name).picture.views:
        if view.kind != "TimeSeries":
            continue
        low, high = view.range
        step = 10.0 ** np.floor(np.log10(high - low))
        steps = (step, step / 10)
        counts = [np.floor(high / s + 1e-9) - np.ceil(low / s - 1e-9) + 1 for s in steps]
        assert any(2 <= count <= 20 for count in counts), view.name
