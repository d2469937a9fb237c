"""Comparisons whose tolerances are lengths and angles. What Rerun draws is float32: 6e-8 of the largest number."""

from __future__ import annotations

import numpy as np

ULP = 4e-7  # of the size: a few roundings of float32 in a row
DEGREES = 2e-3  # of directions between points of float32
PURE = 1e-4  # deg, of vectors and quaternions that were rounded once

HUES = ((8, "red"), (38, "orange"), (70, "yellow"), (165, "green"), (185, "turquoise"), (203, "cyan"), (245, "blue"))


def same_place(drawn, true, length: float = 1.0, size: float | None = None) -> None:
    """Points in view units against points in m, `length` m to the unit."""
    drawn, true = np.asarray(drawn, float), np.asarray(true, float) / length
    assert drawn.shape == np.broadcast_shapes(drawn.shape, true.shape), f"{drawn.shape} points for {true.shape}"
    size = max(np.abs(true).max(initial=0.0), 1e-9) if size is None else size
    off = np.abs(drawn - true).max(initial=0.0)
    assert off <= ULP * size, f"off by {off * length:.4g} m, of {size * length:.4g} m"


def same_direction(drawn, true, degrees: float = PURE) -> None:
    """Vectors (..., 3); where the true one is zero the drawn one must be."""
    drawn, true = np.broadcast_arrays(np.asarray(drawn, float), np.asarray(true, float))
    nothing = ~np.any(true, axis=-1)
    assert not np.any(drawn[nothing]), "an arrow where there is nothing"
    drawn, true = drawn[~nothing], true[~nothing]
    angle = np.degrees(angle_between(drawn, true))
    assert np.all(angle <= degrees), f"off by {np.max(angle):.4g} deg"


def proportional(drawn, true, direction: float = PURE) -> float:
    """Vectors along others, as long as these times one factor, which is returned."""
    drawn, true = np.asarray(drawn, float), np.asarray(true, float)
    same_direction(drawn, true, direction)
    long = np.linalg.norm(true, axis=-1)
    if not long.any():
        return 0.0
    factor = np.linalg.norm(drawn, axis=-1).max() / long.max()
    same_place(np.linalg.norm(drawn, axis=-1), factor * long)
    return float(factor)


def angle_between(a, b) -> np.ndarray:
    """rad, well conditioned for small angles."""
    across = np.linalg.norm(np.cross(a, b), axis=-1)
    return np.arctan2(across, np.sum(np.asarray(a) * b, axis=-1))


def same_turn(drawn, true, degrees: float = PURE) -> None:
    """Rotation matrices (..., 3, 3)."""
    for axis in range(3):
        same_direction(drawn[..., axis], true[..., axis], degrees)


def same_angle(drawn, true, degrees: float = DEGREES) -> None:
    off = np.degrees(np.abs((np.asarray(drawn) - true + np.pi) % (2 * np.pi) - np.pi)).max(initial=0.0)
    assert off <= degrees, f"off by {off:.4g} deg"


def same_number(drawn, true, relative: float = 1e-9) -> None:
    """Plotted numbers, f64; NaN where there is nothing to plot."""
    drawn, true = np.broadcast_arrays(np.asarray(drawn, float), np.asarray(true, float))
    true = np.where(np.isfinite(true), true, np.nan)
    assert np.array_equal(np.isnan(drawn), np.isnan(true)), "gaps in other places"
    size = np.nanmax(np.abs(true)) if np.isfinite(true).any() else 0.0
    off = np.nanmax(np.abs(drawn - true)) if np.isfinite(true).any() else 0.0
    assert off <= relative * size, f"off by {off:.4g}, of {size:.4g}"


def on_ring(points, ring, length: float, tolerance: float = 1e-6) -> None:
    """Points (..., 3), view units, on a conic: direction of its normal, eccentricity vector, semilatus rectum m."""
    normal, eccentricity, rectum = ring
    points = np.asarray(points, float) * length
    size = np.abs(points).max()
    above = np.abs(points @ normal).max()
    assert above <= tolerance * size, f"{above:.4g} m out of the orbit's plane, of {size:.4g} m"
    off = np.abs(np.linalg.norm(points, axis=-1) + points @ eccentricity - rectum).max()
    assert off <= 2 * tolerance * size, f"{off:.4g} m from the orbit, of {size:.4g} m"


def closed(line) -> None:
    same_place(line[0], line[-1], size=np.abs(line).max() * 10)


def hue(color) -> str:
    """The word for a colour: white, grey, black, red, orange, yellow, green, turquoise, cyan, blue, violet or pink."""
    red, green, blue = (float(channel) / 255 for channel in color[:3])
    high, low = max(red, green, blue), min(red, green, blue)
    if high < 0.1:
        return "black"
    if high - low < 0.3 * high:
        return "white" if low > 0.75 else "grey"
    if high == red:
        angle = 60 * ((green - blue) / (high - low)) % 360
    elif high == green:
        angle = 60 * (blue - red) / (high - low) + 120
    else:
        angle = 60 * (red - green) / (high - low) + 240
    if angle > 345:
        return "red"
    return next((word for end, word in HUES if angle < end), "violet" if angle < 290 else "pink")
