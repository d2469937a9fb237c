"""Planes of arrival: read as a person reads them, by the numbers on their axes."""

from __future__ import annotations

from functools import cache

import numpy as np

from .ensembles import MILLI_AU, color_of, ensemble, mahalanobis
from .measure import hue

READ = 2e-3  # of the plane's width: numbers on the axes have four digits, and what is drawn is float32


@cache
def scales(f, plane):
    """(2, 2): for azimuth in deg along x and distance in 10⁻³ au along y, the factor and offset that turn a place in
    the plane into a number. A tick's number hangs beside its tick; 0 is where the axes cross."""
    strips = [np.asarray(strip, float) for strip in f.picture.fixed(f"/arrival/{plane}/axes", "LineStrips2D:strips")]
    across, up = strips[0], strips[1]
    assert across[0, 1] == across[1, 1]
    assert up[0, 0] == up[1, 0]
    origin = np.array([up[0, 0], across[0, 1]])
    ticks = np.array([strip.mean(0) for strip in strips[2:]])
    labels = f.picture.fixed(f"/arrival/{plane}/axes/numbers", "Points2D:labels")
    spots = np.asarray(f.picture.fixed(f"/arrival/{plane}/axes/numbers", "Points2D:positions"), float)
    assert len(labels) == len(spots) == len(ticks)
    found = []
    degrees = [k for k, text in enumerate(labels) if "°" in text]
    for axis, marks in enumerate((degrees, [k for k in range(len(labels)) if k not in degrees])):
        numbers = np.array([float(labels[k].rstrip("°")) for k in marks])
        places = ticks[marks, axis]
        if not len(marks):
            found.append((np.nan, np.nan))
            continue
        assert np.abs(spots[marks, axis] - places).max() < 0.05, "a number beside another tick"
        slopes = numbers / (places - origin[axis])
        assert np.ptp(slopes) <= 2e-3 * np.abs(slopes).max(), "ticks that are not evenly scaled"
        found.append((slopes.mean(), origin[axis]))
    return np.array(found)


def read(f, plane, points) -> np.ndarray:
    """Places (..., 2) as azimuth, deg, and distance, 10⁻³ au, less nominal."""
    scale = scales(f, plane)
    return (np.asarray(points, float) - scale[:, 1]) * scale[:, 0]


def axes(f, entity, plane):
    """Farther out is up and ahead is right."""
    slopes = scales(f, plane)[:, 0]
    assert slopes[1] < 0  # y runs down on the screen
    assert not slopes[0] <= 0


def axis_names(f, entity, plane):
    """The axes' names, each at the end to which its numbers grow."""
    names = f.picture.fixed(entity, "Points2D:labels")
    assert names == ["farther out [10⁻³ au]", "ahead"]
    spots = np.asarray(f.picture.fixed(entity, "Points2D:positions"), float)
    strips = [np.asarray(strip, float) for strip in f.picture.fixed(f"/arrival/{plane}/axes", "LineStrips2D:strips")]
    assert spots[0, 1] < strips[1][:, 1].min() + 0.2
    assert spots[1, 0] > strips[0][:, 0].max() - 0.3


def axis_numbers(f, entity, plane):
    """Each beside its tick, evenly scaled, 0 where the axes cross."""
    assert np.isfinite(scales(f, plane)[1]).all()


def nominal_dot(f, entity, plane):
    """The nominal flight, in the origin."""
    found = read(f, plane, f.picture.fixed(entity, "Points2D:positions")[0])
    assert np.nanmax(np.abs(found)) < 1e-3
    assert hue(f.picture.color(entity, "Points2D:colors")[0]) == "white"


def width(f, plane) -> np.ndarray:
    return np.abs(scales(f, plane)[:, 0]) * [2.0, 1.0]


def dots(f, entity, plane, name):
    """Each flight kept at its azimuth and distance less those of the nominal flight."""
    e = ensemble(f, name)
    steps, drawn = f.picture.rows(entity, "Points2D:positions")
    assert np.array_equal(steps, e.steps)
    off = e.cylindrical(e.kept)
    true = np.stack([np.degrees(off[..., 1]), (off[..., 0] - e.nominal_distance[:, None]) / MILLI_AU], -1)
    found = read(f, plane, np.array(drawn))
    reach = np.nanmax(np.abs(true), axis=(0, 1))
    gap = np.abs(found - true) / (READ * np.maximum(width(f, plane), reach))
    assert np.nanmax(gap) < 1, f"read off wrong by {READ * np.nanmax(gap):.3g} of the plane"
    assert hue(f.picture.color(entity, "Points2D:colors")[0]) == color_of(f, name)


def sigma(f, entity, plane, name, number):
    """The ellipse of so many sigmas about the mean, of the covariance."""
    e = ensemble(f, name)
    steps, drawn = f.picture.rows(entity, "LineStrips2D:strips")
    assert np.array_equal(steps, e.steps)
    mean = e.cylindrical(e.mean)
    for row, strip in enumerate(drawn):
        (strip,) = strip
        found = read(f, plane, strip)
        spread = np.sqrt(np.maximum(np.diag(e.covariance[row])[:2], 0)) / [MILLI_AU, mean[row, 0] * np.pi / 180]
        thin = np.linalg.eigvalsh(e.covariance[row, :2, :2]).min() ** 0.5 / MILLI_AU
        if not np.isfinite(found).all() or thin < 2e-3 * width(f, plane)[1]:
            continue  # too thin to be read
        off = np.stack([found[:, 1] * MILLI_AU + e.nominal_distance[row], np.radians(found[:, 0])], 1)
        sigmas = mahalanobis(e, row, off)
        allowed = 0.02 * int(number) + 4 * READ * (width(f, plane) / spread[::-1]).max()
        assert np.abs(sigmas - int(number)).max() < allowed, f"{sigmas.min():.3g} to {sigmas.max():.3g} sigma"
    assert hue(f.picture.color(entity, "LineStrips2D:colors")[0]) == color_of(f, name)
