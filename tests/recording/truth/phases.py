"""Phases of a flight: names and colours of stretches, from the events that end them and the scene's own list."""

from __future__ import annotations

import re

import numpy as np

from .facts import AU, DAY
from .measure import hue

ARCS = {"thrust": "full thrust", "coast": "coast", "singular": "partial thrust"}
HUES = ["cyan", "yellow", "green", "violet", "pink"]  # of the phases, in their order


def names(f) -> list[str]:
    """Of the phases that were flown, in their order; none in a flight without."""
    steering = f.truth.resolved.get("steering") or {}
    listed = [phase["name"] for phase in f.truth.resolved.get("phase", [])]
    listed = listed or [ARCS[arc["kind"]] for arc in steering.get("arcs") or []]
    over = {event.name for event in f.truth.recording.events}
    flown = [name for k, name in enumerate(listed) if k == 0 or f"end of {listed[k - 1]}" in over]
    return flown


def hues(f) -> dict[str, str]:
    """Of each name, the first time that it comes."""
    return dict(zip(dict.fromkeys(names(f)), HUES, strict=False))


def starts(f) -> list[float]:
    """s, of each of them."""
    when = {event.name: event.time for event in f.truth.recording.events}
    return [f.truth.time[0], *(when[f"end of {name}"] for name in names(f)[:-1])]


def of_rows(f) -> np.ndarray:
    """(n,) number of the phase of each row, the first 0."""
    return np.searchsorted(starts(f), f.truth.time, side="right") - 1


def stretch_colors(f, entity):
    """Each piece of the trail has the colour of the phase that it begins in, and none reaches over a switch."""
    steps, colors = f.picture.rows(entity, "LineStrips3D:colors")
    number, begin = of_rows(f), 0
    for step, color in zip(steps.tolist(), colors, strict=True):
        row, last = (int(np.searchsorted(f.truth.steps, k)) for k in (begin, step))
        packed = int(np.ravel(color)[0])
        shown = hue([(packed >> shift) & 255 for shift in (24, 16, 8)])
        wanted = hues(f)[names(f)[number[row]]]
        assert shown in (wanted, "blue" if wanted == "cyan" else wanted), f"row {row} is {shown}, not {wanted}"
        inside = [t for t in starts(f) if f.truth.time[row] < t < f.truth.time[last]]
        assert not inside, "a piece of the trail reaches over the switch"
        begin = step
    assert steps[-1] == f.truth.steps[-1]


def lane(f, entity):
    """The phase of each row by its name, in its colour, from the row at its switch on."""
    values, labels = (f.picture.fixed(entity, f"StateConfiguration:{key}") for key in ("values", "labels"))
    assert list(values) == list(labels) == list(hues(f))
    assert [hue(color) for color in f.picture.color(entity, "StateConfiguration:colors")] == list(hues(f).values())
    for row, step in enumerate(f.truth.steps.tolist()):
        assert f.picture.at(entity, "StateChange:state", step)[0] == names(f)[of_rows(f)[row]], f"row {row}"
    ends = starts(f)[1:]
    assert np.isin(ends, f.truth.time).all(), "a switch has no row of its own"


def told(f, text):
    """Each phase in its colour with the day of its start, and what held; those that never came."""
    line = re.search(rf"phases{' in their lane' if '/world/tail' in f.picture.entities else ''}: (.*)", text)
    assert (line is not None) == bool(names(f)), "phases are not told"
    if line is None:
        return
    said = re.findall(
        r"\*\*(\w+)\*\* (.*?)(?: from (day|hour) ([\d.]+))?(?: \(([^)]*)\))?(?:, (?=\*\*)|$)", line.group(1)
    )
    assert [(name, color) for color, name, *_ in said] == list(hues(f).items())
    if "phase" not in f.truth.resolved:
        told_arcs(f, said)
        return
    for (_, _, word, value, held), start, phase in zip(said, starts(f), f.truth.resolved["phase"], strict=False):
        if value:
            size = {"day": DAY, "hour": 3600.0}[word]
            assert abs(float(value) * size - (start - f.truth.time[0])) <= 0.51 * size
        state = phase["device"]
        each = (
            [(f"{one['name']} off", one["on"]) for one in state] if isinstance(state, list) else [("off", state["on"])]
        )
        off = [word for word, on in each if not on]
        assert sorted(part for part in held.split(", ") if part.endswith("off")) == sorted(off)
    never = [phase["name"] for phase in f.truth.resolved["phase"]][len(names(f)) :]
    assert all(f"**{' and '.join(never)}** never began" in text for _ in never)


def told_arcs(f, said):
    """When the first arc of each kind begins, and the throttle on those that are partial: what the push is of the full
    one of the final model at its switch, a_c (1 au / r) / sqrt(2)."""
    first = {name: start for name, start in zip(reversed(names(f)), reversed(starts(f)), strict=True)}
    for _, name, word, value, held in said:
        if value:
            size = {"day": DAY, "hour": 3600.0}[word]
            assert abs(float(value) * size - (first[name] - f.truth.time[0])) <= 0.51 * size
        assert bool(held) == (name == "partial thrust")
        if held:
            full = f.truth.resolved["device"]["characteristic_acceleration"] / np.sqrt(2)
            rows = np.array(names(f))[of_rows(f)] == name
            distance = np.linalg.norm(f.truth.position, axis=1) / AU
            share = np.linalg.norm(f.truth.thrust, axis=1)[rows] * distance[rows] / full
            low, high = re.fullmatch(r"throttle ([\d.]+)-([\d.]+)", held).groups()
            assert abs(share.min() - float(low)) < 0.02
            assert abs(share.max() - float(high)) < 0.02
