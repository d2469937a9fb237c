"""Where names stand on the screen, from what a recording holds: views as large as in a window of 1600 x 900."""

from __future__ import annotations

import numpy as np

MAIN, RIGHT = 1005, 590  # pixels across
LETTER, EDGE, TALL = 6.2, 6.0, 21.0  # pixels of a letter, beyond the first and the last of them, and of a name's height


def on_screen(places, view, aspect=1005 / 576):
    """(n, 2) of a view, -1 to 1; a viewer's field is as high as the distance."""
    toward = (view.eye - view.target) / np.linalg.norm(view.eye - view.target)
    right = np.cross(view.up, toward)
    right /= np.linalg.norm(right)
    off = places - view.eye
    depth = -(off @ toward)
    assert (depth > 0).all()
    return np.stack([off @ right / aspect, off @ np.cross(toward, right)], -1) / (0.5 * depth[:, None])


def size_of(picture, view) -> tuple[float, float]:
    """Width and height of a view that is in sight when a recording opens, pixels; (0, 0) of another."""
    kinds, low = [one.kind for one in picture.views], "/world/tail" in picture.entities
    if view.name.startswith("Riding along") if low else view.name == "Flight":
        return MAIN, 546.0 if "2D" in kinds else 576.0
    if view.name == "Where it is" or "close up" in view.name:
        return RIGHT, 260.0 if "BarChart" in kinds else 315.0 if kinds.count("TimeSeries") > 1 else 380.0
    return 0.0, 0.0


def meetings(picture, steps: list[int], own_step=lambda entity, step: step) -> list[str]:
    """Which names lie on each other in which view and row. own_step : the row of an entity at the time of another."""
    found = []
    for view in picture.views:
        size = size_of(picture, view) if view.kind == "3D" else (0.0, 0.0)
        if not size[0]:
            continue
        for step in steps:
            names = names_on(picture, view, size, step, own_step)
            for k, one in enumerate(names):
                found += [f"{view.name}, row {step}: {one[4]} on {other[4]}" for other in names[:k] if meet(one, other)]
    return found


def names_on(picture, view, size, step, own_step) -> list[tuple]:
    """Left, right, top, bottom and words of each name that a view shows at a row."""
    pose = picture.pose(view.origin, step) if view.origin != "/" else np.eye(4)
    named = [e for e in picture.entities if view.shows(e) and "Points3D:labels" in picture.components(e)]
    found = []
    for entity in named:
        own = own_step(entity, step)
        if own is None:
            continue
        words = picture.at(entity, "Points3D:labels", own)
        spots = picture.place(entity, "Points3D:positions", own)
        for place, text in zip(spots, [words[0]] * len(spots) if len(words) == 1 else words, strict=True):
            seen = (place - pose[:3, 3])[None] @ pose[:3, :3]
            if (view.eye - seen[0]) @ (view.eye - view.target) <= 0:
                continue  # behind the eye
            x, y = on_screen(seen, view, size[0] / size[1])[0]
            x, y, half = 0.5 * size[0] * x, -0.5 * size[1] * y, LETTER * len(text) / 2 + EDGE
            if abs(x) < 0.5 * size[0] + half and -0.5 * size[1] - TALL < y < 0.5 * size[1]:
                found.append((x - half, x + half, y, y + TALL, text))
    return found


def meet(one, other) -> bool:
    return one[0] < other[1] and other[0] < one[1] and one[2] < other[3] and other[2] < one[3]
