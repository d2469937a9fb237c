"""Ensembles of a craft that turns: axes on the sphere of directions, bands and shares against /attitude_ensemble."""

from __future__ import annotations

import numpy as np

from .ensembles import close, color_of_table
from .measure import hue, same_place
from .picture import Picture
from .plots import convert, in_range

TAIL, OFF, NEAR = 12, 1.004, np.cos(np.radians(40.0))


class Members:
    """One ensemble: n times, k flights that are kept."""

    def __init__(self, f, name):
        path = f"/attitude_ensemble/{name}"
        self.table, self.facts = f.truth.recording[path], f.truth.recording[f"{path}/facts"]
        self.steps, self.time = self.table.timeline("step"), self.table["time_s"]
        self.levels = np.ravel(self.facts["levels"])
        self.title = self.facts["name"][0]
        self.axes = self.table["kept_axis"].reshape(len(self.time), -1, 3)
        self.color = color_of_table(f, self.title)


def column(picture: Picture, entity, name):
    """Steps and numbers (n,) of a component with one number a row."""
    steps, values = picture.rows(entity, name)
    return np.array(steps), np.array(values)[:, 0]


def axes_now(f, entity, name):
    """Where the axes of the flights that are kept point at the moment, just off the sphere."""
    e = Members(f, name)
    steps, spots = f.picture.rows(entity, "Points3D:positions")
    assert np.array_equal(steps, e.steps)
    for row, spot in enumerate(spots):
        same_place(np.array(spot), OFF * e.axes[row])
    same_place(np.linalg.norm(e.axes, axis=-1), np.ones(e.axes.shape[:2]))
    assert hue(f.picture.color(entity, "Points3D:colors")[0]) == e.color


def tails(f, entity, name):
    """The way of each axis over the last rows, broken where it turns by more than 40 degrees between two."""
    e = Members(f, name)
    steps, groups = f.picture.rows(entity, "LineStrips3D:strips")
    assert np.array_equal(steps, e.steps)
    for row, group in enumerate(groups):
        true = []
        for flight in e.axes[max(0, row + 1 - TAIL) : row + 1].swapaxes(0, 1):
            far = np.flatnonzero(np.sum(flight[1:] * flight[:-1], axis=1) <= NEAR) + 1
            true += [piece for piece in np.split(flight, far) if len(piece) > 1]
        assert len(group) == len(true)
        for line, piece in zip(group, true, strict=True):
            same_place(np.array(line), OFF * piece)
    assert hue(f.picture.color(entity, "LineStrips3D:colors")[0]) == e.color


def band(f, entity, key, name, number):
    """Between two percentiles, as mean and squared half width."""
    e, k = Members(f, name), int(number)
    steps, middle = column(f.picture, entity, "Measurements:values")
    half = np.sqrt(column(f.picture, entity, "Measurements:variances")[1])
    assert np.array_equal(steps, e.steps)
    low, high = (convert(f, entity, e.table[key][:, at]) for at in (k, len(e.levels) - 1 - k))
    allowed = 1e-6 * np.abs(high).max()
    close(middle - half, low, allowed)
    close(middle + half, high, allowed)
    words = f"{e.title}, {e.levels[k]:g}-{e.levels[-1 - k]:g} %"
    assert f.picture.fixed(entity, "Measurements:names") == [words]
    assert hue(f.picture.color(entity, "Measurements:colors")[0]) == e.color
    in_range(f, entity, np.concatenate([middle - half, middle + half]))


def median(f, entity, key, name):
    """The middle percentile."""
    e = Members(f, name)
    assert e.levels[len(e.levels) // 2] == 50
    curve(f, entity, e, e.table[key][:, len(e.levels) // 2], f"{e.title}, median")


def nominal(f, entity, key):
    """The scene's own flight, of which the rows are known."""
    names = [n.split("/")[2] for n in f.picture.entities if n.startswith("/attitude_ensemble/") and n.count("/") == 2]
    e = Members(f, names[0])
    own = {"pitch_rad": f.truth.pitch, "body_rate_rad_s": None}.get(key)
    if own is not None:
        close(e.table[f"nominal_{key}"], own[np.searchsorted(f.truth.steps, e.steps)], 1e-12)
    curve(f, entity, e, e.table[f"nominal_{key}"], "nominal flight", colored=False)


def share(f, entity, name, event):
    """The share of the flights that have met an event, by the times at which each met it."""
    e = Members(f, name)
    times = np.ravel(e.facts[f"met_{event}_s"])
    title = next(word for word in np.ravel(e.facts["events"]) if word.replace(" ", "_").lower() == event)
    assert len(times) == int(e.facts["flights"][0])
    close(e.table[f"share_{event}"], np.array([np.sum(times <= now) for now in e.time]) / len(times), 1e-12)
    curve(f, entity, e, e.table[f"share_{event}"], f"{e.title}, {title}")


def curve(f, entity, e, true, words, colored=True):
    """A line of a plot."""
    steps, values = column(f.picture, entity, "Scalars:scalars")
    assert np.array_equal(steps, e.steps)
    true = convert(f, entity, true)
    close(values, true, 1e-9 * np.abs(true).max() + 1e-300)
    assert f.picture.fixed(entity, "SeriesLines:names") == [words]
    assert not colored or hue(f.picture.color(entity, "SeriesLines:colors")[0]) == e.color
    in_range(f, entity, values)
