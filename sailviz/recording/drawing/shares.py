"""What each device of a craft with several adds to its push: an arrow each, thinner than that of the whole, and its
words.

In each row the arrows of the devices are their accelerations times one factor, that of the whole push's arrow where
they fit: then they add up to it. Where they would be longer than allowed, because they pull against each other, the
factor is smaller for all of them alike. A device that pushes alone has none: its push is the whole.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sailviz.frames import from_frame
from sailviz.recording.contract import word
from sailviz.recording.drawing import style
from sailviz.recording.drawing.log import Color, Picture
from sailviz.recording.drawing.names import Names
from sailviz.recording.drawing.phrases import push_with_shares, push_words
from sailviz.recording.drawing.story import Story

if TYPE_CHECKING:
    from sailviz.run.arrays import Run

ALONE = 1e-6  # of the whole push, by which a part that is the whole differs from it
BEYOND = 1.12  # of an arrow, where its name stands
RANK = 4  # of the names: after all others


def kinds_of(run: Run) -> dict[str, str]:
    """Name of each device of a list -> its kind."""
    told = run.setting.resolved.get("device")
    return {str(each.get("name")): str(each.get("kind")) for each in told} if isinstance(told, list) else {}


def own_on(run: Run) -> np.ndarray:
    """(n,) whether the device that is drawn is on."""
    kinds = kinds_of(run)
    drawn = next((name for name in run.devices if kinds.get(name) == run.setting.craft.kind), None)
    return run.thrust.on if drawn is None else run.devices[drawn].on


def device_colors(run: Run) -> dict[str, Color]:
    """Name of each device -> its colour: that of its kind, darker for further ones of the same kind."""
    kinds = kinds_of(run)
    found: dict[str, Color] = {}
    seen: dict[str, int] = {}
    for name in run.devices:
        kind = kinds.get(name, "")
        before = seen.get(kind, 0)
        seen[kind] = before + 1
        found[name] = style.dim(style.DEVICES.get(kind, style.REFERENCE), 0.7**before)
    return found


def arrows_of(story: Story, whole: np.ndarray, near: bool, longest: float) -> dict[str, np.ndarray]:
    """Name -> arrows (n, 3) of each device. whole : (n, 3) the arrow of the whole push; near : in the frame of the
    close-up, else inertial at the drawn place."""
    samples = story.samples
    if len(samples.run.devices) < 2:
        return {}
    if near:
        parts, total = story.near.devices, story.near.thrust
    else:
        parts = {name: from_frame(samples.axes, one.acceleration_rtn) for name, one in samples.run.devices.items()}
        total = story.thrust
    size = np.linalg.norm(total, axis=1)
    most = np.max([np.linalg.norm(part, axis=1) for part in parts.values()], axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.minimum(np.linalg.norm(whole, axis=1) / size, longest / most)
    factor = np.where(most > 0, np.nan_to_num(factor, posinf=0.0), 0.0)
    found = {}
    for name, part in parts.items():
        alone = np.linalg.norm(part - total, axis=1) <= ALONE * size
        found[name] = np.where(alone, 0.0, factor)[:, None] * part
    return found


def log_shares(
    picture: Picture, story: Story, whole: np.ndarray, names: Names | None, top: str = "/world/craft"
) -> None:
    """The arrows in the system view of the craft at `top`; names : to which the devices' own are added."""
    colors = device_colors(story.samples.run)
    longest = 2 * story.arrows.least * story.reach
    for name, arrow in arrows_of(story, whole, False, longest).items():
        if np.any(arrow):
            log_share(picture, story, f"{top}/shares/{word(name)}", arrow, colors[name], "share")
            if names is None:
                continue
            there = np.any(arrow, axis=1, keepdims=True)
            place = np.where(there, story.position + BEYOND * arrow, np.nan)
            names.add(f"/world/names/shares/{word(name)}", name, colors[name], place, RANK)


def log_close_shares(picture: Picture, story: Story, names: Names, whole: np.ndarray, longest: float) -> None:
    """The arrows in the close-up, with what each device adds in words."""
    run = story.samples.run
    colors = device_colors(run)
    for name, arrow in arrows_of(story, whole, True, longest).items():
        if np.any(arrow):
            log_share(picture, story, f"/sail/shares/{word(name)}", arrow, colors[name], "close share")
            there = np.any(arrow, axis=1, keepdims=True)
            place = np.where(there, BEYOND * arrow, np.nan)
            texts = push_words(run.devices[name].magnitude, name, story.push)
            names.add(f"/sail/shares/{word(name)}/name", texts, colors[name], place, RANK)


def log_share(picture: Picture, story: Story, path: str, arrow: np.ndarray, color: Color, width: str) -> None:
    """One arrow."""
    picture.log_arrow_style(path, color, style.WIDTH[width])
    picture.log_arrows(path, story.index, arrow)


def share_words(story: Story) -> list[str]:
    """The push in each row and what each of several devices adds to it."""
    return push_with_shares(story.push, {name: one.magnitude for name, one in story.samples.run.devices.items()})
