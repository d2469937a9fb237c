"""The column of curves: which are shown, which share a line, in which ranges and with which legend."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

SHOWN_FROM = 0.04  # score below which a curve says nothing
FLAT = 0.02  # relative change below which a quantity is steady
TWINS = 0.015  # of the range, within which two curves are one
NUMBERS = 8  # at most on an axis
CORNERS = (
    ("LeftTop", False, True),
    ("RightTop", True, True),
    ("LeftBottom", False, False),
    ("RightBottom", True, False),
)


@dataclass(frozen=True)
class PlotView:
    """A view of curves, with the range of its axis."""

    title: str
    paths: tuple[str, ...]
    low: float
    high: float
    legend: str = ""  # corner, "" for none


def score(values: np.ndarray, natural: float, bonus: float) -> float:
    """What a curve's change is worth: from its 1st to its 99th percentile, against the quantity's natural change."""
    known = values[np.isfinite(values)]
    if len(known) == 0:
        return 0.0
    most = float(np.abs(known).max())
    size = natural if natural > 0 else -natural * most
    spread = float(np.percentile(known, 99) - np.percentile(known, 1))
    if spread <= FLAT * most:
        return 0.0
    return bonus * min(spread / size, 1.5) if size > 0 else 0.0


def merged(names: Sequence[str], values: np.ndarray) -> list[tuple[str, int]]:
    """Joint names and first columns of curves, (n, k), that coincide."""
    known = np.isfinite(values)
    reach = max(
        (float(np.ptp(values[known[:, k], k])) for k in range(values.shape[1]) if known[:, k].any()), default=0.0
    )
    kept: list[tuple[str, int]] = []
    for k, name in enumerate(names):
        if not known[:, k].any():
            continue
        twin = next((place for place, (_, j) in enumerate(kept) if coincide(values[:, j], values[:, k], reach)), None)
        if twin is None:
            kept.append((name, k))
        else:
            kept[twin] = (f"{kept[twin][0]} = {name}", kept[twin][1])
    return kept


def coincide(one: np.ndarray, other: np.ndarray, reach: float) -> bool:
    """Whether two curves are closer than the eye can tell, everywhere and where they have gaps."""
    if not np.array_equal(np.isfinite(one), np.isfinite(other)):
        return False
    known = np.isfinite(one)
    return bool(np.max(np.abs(one[known] - other[known]), initial=0.0) <= TWINS * reach)


def nice_range(low: float, high: float, most: int = NUMBERS) -> tuple[float, float]:
    """A range about the data with two to `most` numbers on its axis: the viewer writes multiples of a power of ten."""
    span = max(high - low, 1e-3 * max(abs(low), abs(high)), 1e-12)
    bottom, top = low - 0.07 * span, high + 0.07 * span
    step = 10.0 ** np.ceil(np.log10(span))
    while multiples(bottom, top, step / 10) <= most:
        step /= 10
    while multiples(bottom, top, step) < 2:
        below, above = np.ceil(bottom / step) * step - step, np.floor(top / step) * step + step
        if bottom - below < above - top and not (low >= 0 and below < 0):
            bottom = below - 0.05 * span
        else:
            top = above + 0.05 * span
    return float(bottom), float(top)


def multiples(low: float, high: float, step: float) -> int:
    """How many multiples of a step lie in a range."""
    return int(np.floor(high / step) - np.ceil(low / step)) + 1


def corner(curves: Sequence[np.ndarray], low: float, high: float) -> str:
    """The corner that the curves (n,) leave most free."""
    hits = {}
    for name, right, top in CORNERS:
        hits[name] = 0
        for values in curves:
            part = values[int(0.68 * len(values)) :] if right else values[: max(int(0.32 * len(values)), 1)]
            share = (part - low) / (high - low)
            with np.errstate(invalid="ignore"):
                hits[name] += int(np.sum(share > 0.55 if top else share < 0.45))
    return min(hits, key=lambda name: hits[name])
