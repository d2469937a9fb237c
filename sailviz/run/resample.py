"""Columns of one run at the times of another: what each kind of column allows, and what it costs. Nothing is read off
across a gap.

position   cubic Hermite through positions and velocities   error h^4 / 384 x''''
velocity   cubic through the four rows around               error h^4 / 43 v''''
angle      linear along the shorter arc; quaternions likewise, made unit again
on, words  held from the row before
others     linear                                           error h^2 / 8 x''
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from sailviz.run import gaps as spans

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from sailviz.run.gaps import Gaps

TURN = 2 * np.pi


def is_angle(name: str) -> bool:
    """Whether a column holds angles, which come back after a turn."""
    return name.endswith("_rad")


def at(
    times: np.ndarray,
    name: str,
    grid: ArrayLike,
    values: ArrayLike,
    siblings: Mapping[str, np.ndarray] | None = None,
    gaps: Gaps = (),
) -> np.ndarray:
    """Values (n, ...) of the column `name`, given at `grid` (n,) s, increasing, at other times (m,) within it.

    siblings : the other columns of the entity, among which a position finds its velocity. gaps : (start, end) s without
    data, where numbers are NaN and what is held stays as in the last row before.
    A time that is a row of the grid gets that row's value, bit for bit.
    """
    grid, values = np.asarray(grid, float), np.asarray(values)
    if len(spans.last_rows(grid, gaps)):
        return _piece_by_piece(times, name, grid, values, siblings or {}, gaps)
    if len(grid) == 1:
        return np.repeat(values, len(times), axis=0)
    left = np.clip(np.searchsorted(grid, times, side="right") - 1, 0, len(grid) - 2)
    h = grid[left + 1] - grid[left]
    s = (times - grid[left]) / h
    exact = np.where(s >= 1, left + 1, left)
    known = (s == 0) | (s >= 1)
    if values.dtype == bool or values.dtype.kind not in "f" or name == "number":  # which phase it is
        return values[exact]
    shape = (-1,) + (1,) * (values.ndim - 1)
    s, h = s.reshape(shape), h.reshape(shape)
    before, after = values[left], values[left + 1]
    siblings = siblings or {}
    if name == "position_m" and "velocity_m_s" in siblings:
        v = siblings["velocity_m_s"]
        found = hermite(s, h, before, after, v[left], v[left + 1])
    elif name == "velocity_m_s" and len(grid) > 3:
        found = through_four(times, grid, values, left)
    elif name == "quaternion":
        after = np.where(np.sum(before * after, axis=-1, keepdims=True) < 0, -after, after)
        found = before + s * (after - before)
        found = found / np.linalg.norm(found, axis=-1, keepdims=True)
    elif is_angle(name):
        found = before + s * (np.remainder(after - before + np.pi, TURN) - np.pi)
    else:
        with np.errstate(invalid="ignore"):  # infinite semi-major axes
            found = before + s * (after - before)
    return np.where(known.reshape(shape), values[exact], found)


def _piece_by_piece(
    times: np.ndarray,
    name: str,
    grid: np.ndarray,
    values: np.ndarray,
    siblings: Mapping[str, np.ndarray],
    gaps: Gaps,
) -> np.ndarray:
    """`at`, each stretch between gaps from its own rows alone."""
    held = np.clip(np.searchsorted(grid, times, side="right") - 1, 0, len(grid) - 1)
    found = values[held]
    if values.dtype.kind == "f":
        found = np.full_like(found, np.nan)
    for rows in spans.pieces(grid, gaps):
        here = (times >= grid[rows][0]) & (times <= grid[rows][-1])
        own = {key: column[rows] for key, column in siblings.items()}
        found[here] = at(times[here], name, grid[rows], values[rows], own)
    return found


def hermite(s: np.ndarray, h: np.ndarray, x0: np.ndarray, x1: np.ndarray, v0: np.ndarray, v1: np.ndarray) -> np.ndarray:
    """The cubic with values x and slopes v at both ends of an interval of length h, at its fraction s."""
    found: np.ndarray = (
        x0 * (1 + 2 * s) * (1 - s) ** 2 + x1 * s * s * (3 - 2 * s) + h * s * (1 - s) * (v0 * (1 - s) - v1 * s)
    )
    return found


def through_four(times: np.ndarray, grid: np.ndarray, values: np.ndarray, left: np.ndarray) -> np.ndarray:
    """The cubic through the two rows on either side (at the ends: the four nearest), by Lagrange's formula."""
    first = np.clip(left - 1, 0, len(grid) - 4)
    rows = first[:, None] + np.arange(4)
    x = grid[rows]  # (m, 4)
    found = np.zeros(())
    for i in range(4):
        weight = np.ones(len(times))
        for j in range(4):
            if i != j:
                weight *= (times - x[:, j]) / (x[:, i] - x[:, j])
        found = found + weight.reshape((-1,) + (1,) * (values.ndim - 1)) * values[rows[:, i]]
    return found


def misses(name: str, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """|a - b|, modulo a turn for angles, up to the sign for quaternions; 0 where both are NaN or the same infinity, inf
    where only one is.
    """
    with np.errstate(invalid="ignore"):
        gap = np.abs(a - b)
        if is_angle(name):
            turned = gap % TURN
            gap = np.minimum(turned, TURN - turned)
        elif name.startswith("quaternion") and a.ndim > 1:
            other = np.abs(a + b)
            gap = np.where(other.max(axis=-1, keepdims=True) < gap.max(axis=-1, keepdims=True), other, gap)
    same = (a == b) | (np.isnan(a) & np.isnan(b))
    return np.where(same, 0.0, np.where(np.isnan(gap), np.inf, gap))


def cost(
    name: str,
    grid: np.ndarray,
    values: ArrayLike,
    siblings: Mapping[str, np.ndarray] | None = None,
    gaps: Gaps = (),
) -> float:
    """About the largest error that `at` makes on this grid: two of three rows are left out, interpolated, and the miss
    divided by what a third of the spacing gains. Rows beside a gap do not count. 0 for columns that are held, NaN with
    fewer than ten rows.
    """
    values = np.asarray(values)
    if values.dtype.kind != "f":
        return 0.0
    if len(grid) < 10:
        return np.nan
    third = slice(None, None, 3)
    thinned = {key: column[third] for key, column in (siblings or {}).items()}
    inner = np.arange(1, 3 * (len(grid[third]) - 1))
    inner = inner[inner % 3 > 0]
    for row in spans.last_rows(grid, gaps).tolist():
        inner = inner[inner // 3 != row // 3]
    miss = misses(name, at(grid[inner], name, grid[third], values[third], thinned), values[inner])
    cubic = name == "velocity_m_s" or (name == "position_m" and "velocity_m_s" in (siblings or {}))
    miss = miss[np.isfinite(miss)]
    return float(miss.max() / (81 if cubic else 9)) if len(miss) else np.nan
