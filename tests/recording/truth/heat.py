"""The plane of a film's temperature over its distance: read as a person reads it, by the numbers on its axes."""

from __future__ import annotations

import re

import numpy as np

from .facts import AU
from .measure import hue

READ = 3e-3  # of what the plane shows: its numbers have four digits


def scales(f) -> np.ndarray:
    """(2, 2): for distance in au along x and K along y the factor and offset from a place to a number."""
    strips = [np.asarray(strip, float) for strip in f.picture.fixed("/heat/axes", "LineStrips2D:strips")]
    across, up = strips[0], strips[1]
    assert across[0, 1] == across[1, 1]
    assert up[0, 0] == up[1, 0]
    found = []
    labels = [float(text) for text in f.picture.fixed("/heat/axes/numbers", "Points2D:labels")]
    spots = np.asarray(f.picture.fixed("/heat/axes/numbers", "Points2D:positions"), float)
    marks = np.array([strip.mean(0) for strip in strips[2:]])
    level = np.abs(marks[:, 1] - across[0, 1]) < 1e-6
    for axis, chosen in enumerate((level, ~level)):
        numbers, places = np.array(labels)[chosen], marks[chosen, axis]
        assert len(numbers) >= 2, "fewer than two numbers on an axis"
        assert np.abs(spots[chosen, axis] - places).max() < 0.05, "a number beside another tick"
        factor, offset = np.polyfit(places, numbers, 1)
        assert np.abs(factor * places + offset - numbers).max() < READ * np.ptp(numbers)
        found.append((factor, offset))
    return np.array(found)


def read(f, places) -> np.ndarray:
    """(..., 2) au and K of places."""
    scale = scales(f)
    return np.asarray(places, float) * scale[:, 0] + scale[:, 1]


def truth(f) -> tuple[np.ndarray, np.ndarray]:
    """Rows whose temperature is known, and (m, 2) au and K of each."""
    kelvin = f.truth.film["temperature_K"]
    rows = np.flatnonzero(np.isfinite(kelvin))
    return rows, np.stack([np.linalg.norm(f.truth.position, axis=1) / AU, kelvin], 1)[rows]


def close(one, other):
    """Both within what can be read."""
    wide = np.ptp(other, axis=0)
    assert np.all(np.abs(np.asarray(one) - other) < READ * wide + [1e-4, 0.05])


def axes(f, entity):
    """Farther is right and warmer is up, where y runs down on the screen."""
    slopes = scales(f)[:, 0]
    assert slopes[0] > 0 > slopes[1]


def names(f, entity):
    """What runs along each axis, and beside its line what the film bears."""
    hottest, called = f.truth.resolved["device"].get("hottest"), f.picture.fixed(entity, "Points2D:labels")
    assert called[:2] == ["film temperature [K]", "distance from the Sun [au]"]
    assert called[2:] == ([] if hottest is None else [f"bears {hottest:.0f} K"])
    spots = read(f, f.picture.fixed(entity, "Points2D:positions"))
    assert hottest is None or abs(spots[2, 1] - hottest) < 1.0


def numbers(f, entity):
    """Each beside its tick, evenly scaled."""
    assert np.isfinite(scales(f)).all()


def way(f, entity):
    """Through every row, in its order."""
    rows, there = truth(f)
    lines = [np.asarray(line, float) for line in f.picture.fixed(entity, "LineStrips2D:strips")]
    assert len(np.concatenate(lines)) == len(rows)
    close(read(f, np.concatenate(lines)), there)
    assert hue(f.picture.color(entity, "LineStrips2D:colors")[0]) == hue(np.array([255, 190, 92, 255]))


def limit(f, entity):
    """What the scene says that the film bears, in red, all across."""
    (line,) = f.picture.fixed(entity, "LineStrips2D:strips")
    found = read(f, line)
    assert np.abs(found[:, 1] - f.truth.resolved["device"]["hottest"]).max() < 1.0
    assert np.ptp(found[:, 0]) > np.ptp(truth(f)[1][:, 0])
    assert hue(f.picture.color(entity, "LineStrips2D:colors")[0]) == "red"


def now(f, entity):
    """Where the film is, with its temperature, its distance and, of one that ages, its dose."""
    rows, there = truth(f)
    steps, spots = f.picture.rows(entity, "Points2D:positions")
    assert np.array_equal(steps, f.truth.steps[rows])
    close(read(f, np.concatenate([np.asarray(spot, float) for spot in spots])), there)
    dose = f.truth.film.get("dose_yr")
    for k, row in enumerate(rows):
        text = f.picture.at(entity, "Points2D:labels", f.truth.steps[row])[0]
        told = [float(number) for number in re.findall(r"[\d.]+", text)]
        assert abs(told[0] - there[k, 1]) <= 0.5001
        assert abs(told[1] - there[k, 0]) <= 0.00501
        assert (", dose" in text) == (dose is not None)
        assert dose is None or abs(told[2] - dose[row]) <= 0.00501
