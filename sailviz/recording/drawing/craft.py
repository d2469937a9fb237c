"""What the views must know about one kind of craft: a record, which devices.py fills in for each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import rerun as rr

from sailviz.recording.drawing import style
from sailviz.recording.drawing.log import Color, Index, Picture, f4
from sailviz.recording.drawing.style import points
from sailviz.run.arrays import Craft


@dataclass(frozen=True)
class CraftDrawing:
    """How one kind of craft is drawn. Its shape is of size 1: a side, a radius or a height."""

    log_shape: Callable[[Picture, str, bool], None]  # under a path; True adds what is only seen from close by
    size: float = 0.10  # in the system view, as a fraction of the largest distance from the centre that is drawn
    close_size: float = 9.0  # in the close-up
    close_name: str = ""  # of the close-up, instead of the craft's own label
    true_size: Callable[[Craft], float | None] = lambda craft: None  # m, what the drawn size stands for
    tether: bool = False  # a tether hangs from it, drawn apart since its length has another scale
    glow: str = ""  # path below the body of what only shows while it thrusts
    facing: bool = False  # a film: its sunward side must be seen
    slanted: bool = False  # a wheel: it must not be seen edge-on
    has_angles: bool = True  # pitch, cone and clock angle mean something
    pushes: bool = True  # it has a thrust to be told
    descends: bool = False  # what it does is brake
    force: str = "push"  # what it does, in a word
    lane: str = "thrust"  # the words and colours of its working and resting, in style.LANES
    sail_word: str = "sail"
    stowable: tuple[str, ...] = ()  # parts of the shape that are not there while the sail is stowed
    stowable_near: tuple[str, ...] = ()  # those of them that are only seen from close by
    flow_word: str = ""  # what comes from the Sun and acts on it, in a word
    flow_color: Color = tuple(style.SUN)


class Glow:
    """What of a craft only shows while it thrusts: the sheath of a charged tether, the plume of a thruster."""

    def __init__(self, picture: Picture, body: str, craft: CraftDrawing):
        self._picture = picture
        self._path = f"{body}/{craft.glow}" if craft.glow else ""

    def add(self, index_of: Callable[[np.ndarray], Index], on: np.ndarray) -> None:
        """on (n,) bool; index_of(rows) gives the timelines of some of the rows. Only changes are written."""
        changed = np.flatnonzero(np.diff(on, prepend=not on[0]))
        if self._path and len(changed):
            scale = np.where(on[changed], 1.0, 1e-6)[:, None] * np.ones(3)
            self._picture.log_columns(self._path, index_of(changed), rr.Transform3D.columns(scale=f4(scale)))


def log_stowing(
    picture: Picture, shape: str, craft: CraftDrawing, index: Index, stowed: np.ndarray, near: bool
) -> None:
    """Of a sail that is stowed at times, stowed (n,) bool, only the bus is left then."""
    if not stowed.any():
        return
    scale = np.where(stowed, 1e-6, 1.0)[:, None] * np.ones(3)
    for part in (*craft.stowable, *(craft.stowable_near if near else ())):
        picture.log_columns(f"{shape}/{part}", index, rr.Transform3D.columns(scale=f4(scale)))


def log_tether(picture: Picture, path: str, start: float, width: float, thickness: float) -> None:
    """A tether of length 1 hanging from z = -start to -1 with tip and sheath; thickness of the sheath in lengths."""
    picture.log_lines(f"{path}/line", [[[0.0, 0.0, -start], [0.0, 0.0, -1.0]]], style.TETHER_BRAKE, width)
    picture.log_static(f"{path}/tip", rr.Points3D([[0, 0, -1]], radii=points(6.0), colors=[style.BUS]))
    picture.log_static(
        f"{path}/sheath",
        rr.GaussianSplats3D(
            [[0, 0, -(0.1 + 0.2 * k)] for k in range(5)],
            scales=[[thickness, thickness, 0.12]] * 5,
            colors=[[*style.SHEATH, 130]] * 5,
        ),
    )
