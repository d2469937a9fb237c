"""Figures of sails with a shape: what billow costs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sailviz.propulsion.solar_sail import FILMS
from sailviz.propulsion.surfaces import side_of
from sailviz.shapes import membranes
from sailviz.shapes.facets import Coefficients, Part, Shape, Surface
from sailviz.shapes.light_force import tensors

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from sailviz.figures.page import Pen

FILM = "jpl-2015"


def shapes() -> dict[str, tuple[Part, float]]:
    """By their words: a film of 1 m2 across, and the largest incidence, deg, to which its front alone is lit."""
    b = Coefficients(*side_of(FILMS[FILM]))
    both = Surface(b, b)
    wide = 2 / np.sqrt(np.pi)
    return {
        "flat": (membranes.square(1.0, both), 90.0),
        "square, booms bent by 3°, sag 3 %": (membranes.square(1.0, both, np.radians(3), 0.03), 80.0),
        "part of a sphere, 20° steep at its edge": (membranes.cap(wide, both, np.radians(20)), 70.0),
    }


def pushes(part: Part, incidence: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(force along the light (n,), across it towards the tilted axis (n,)) over 2 P A at angles (n,) rad between the
    light and the axis."""
    zero = np.zeros_like(incidence)
    u = np.stack([np.sin(incidence), zero, np.cos(incidence)], -1)
    across = np.stack([-np.cos(incidence), zero, np.sin(incidence)], -1)
    force = tensors(Shape((part,)), "front").force(u)
    return np.sum(force * u, axis=1), np.sum(force * across, axis=1)


def incidence(pen: Pen, left: Axes, right: Axes) -> None:
    """Force along and across the light over the angle between it and the axis of the sail."""
    series = (pen.style.quiet, *pen.style.series[:2])
    for (name, (part, last)), color in zip(shapes().items(), series, strict=True):
        angle = np.linspace(0, last, 181)
        for axes, push in zip((left, right), pushes(part, np.radians(angle)), strict=True):
            axes.plot(angle, push, color=color, label=name, zorder=4)
    left.set(xlabel="incidence [°]", ylabel="force along the light / 2PA", xlim=(0, 90), ylim=(0, 1.0))
    right.set(xlabel="incidence [°]", ylabel="force across the light / 2PA", xlim=(0, 90), ylim=(0, 0.4))
    right.legend(loc="lower center", borderaxespad=1.2, fontsize=9)
    for axes in (left, right):
        axes.set_xticks(np.arange(0, 91, 15))
