"""The craft themselves, of size 1: a square sail of side 1, an E-sail of radius 1, a satellite of height 0.3 with its
tether.

Frame: +z is the sail's normal, away from the Sun; of a tether, from its tip to the satellite; of a thruster, the
thrust.
"""

from __future__ import annotations

import numpy as np
import rerun as rr

from sailviz.recording.drawing import meshes
from sailviz.recording.drawing import style as look
from sailviz.recording.drawing.log import Pen, f4
from sailviz.recording.drawing.style import points


def draw(pen: Pen, path: str, kind: str, near: bool) -> None:
    """Draw the craft of a kind under `path`. `near` adds what is only seen from close by."""
    {
        "solar-sail": square_sail,
        "electric-sail": electric_sail,
        "plasma-brake": satellite,
        "thruster": thruster,
        "none": dot,
    }.get(kind, dot)(pen, path, near)


def square_sail(pen: Pen, path: str, near: bool) -> None:
    """Film seen from both sides: the sunward side is the back of a mesh whose front is the dark one."""
    sail = meshes.film()
    pen.mesh(f"{path}/film_sun", sail, look.FILM_SUN, side="back")
    pen.mesh(f"{path}/film_dark", sail, look.FILM_DARK, side="front")
    pen.mesh(f"{path}/booms", meshes.booms(), look.BOOM)
    pen.mesh(f"{path}/bus", meshes.box([0.07, 0.07, 0.09]).moved([0, 0, 0.045]), look.BUS)
    pen.mesh(f"{path}/vanes", meshes.vanes(), look.NORMAL, shaded=False)
    if near:
        lifts = [[0, 0, side * 0.004] for side in (-1, 1)]  # off the film, or the lines tear
        strips = [seam + lift for seam in meshes.seams() for lift in lifts]
        pen.lines(f"{path}/seams", strips, look.SEAM, look.WIDTH["seam"])


def electric_sail(pen: Pen, path: str, near: bool) -> None:
    """A wheel of tethers with its charged sheath. 24 are drawn, 16 from afar, however many there are."""
    count = 24 if near else 16
    out, turns = meshes.spokes(count), meshes.spoke_quaternions(count)
    pen.lines(f"{path}/tethers", [[0.03 * d, d] for d in out], look.TETHER, 0.9 if near else 0.7)
    pen.lines(f"{path}/rim", [meshes.ring()], look.dim(look.TETHER, 0.7), 0.7 if near else 0.55)
    pen.mesh(f"{path}/hub", meshes.cylinder(0.035, -0.025, 0.025), look.BUS)
    if near:
        pen.mesh(f"{path}/tips", meshes.box([0.025, 0.018, 0.018]), look.BOOM)
        pen.static(f"{path}/tips", rr.InstancePoses3D(translations=f4(out), quaternions=f4(turns)))
    pen.static(
        f"{path}/sheath",
        rr.GaussianSplats3D(
            f4(0.52 * out),
            scales=[[0.21, 0.008, 0.008]] * count,
            quaternions=f4(turns),
            colors=[[*look.SHEATH, 120]] * count,
        ),
    )


def satellite(pen: Pen, path: str, near: bool) -> None:
    """A small satellite with two panels; its tether is drawn apart, since its length has another scale."""
    pen.mesh(f"{path}/bus", meshes.box([0.10, 0.10, 0.30]), look.BOOM)
    panels = [meshes.box([0.012, 0.34, 0.26]).moved([0, side * 0.24, 0]) for side in (-1, 1)]
    pen.mesh(f"{path}/panels", meshes.joined(panels), look.PANEL)


def tether(pen: Pen, path: str, start: float, width: float, thickness: float, near: bool) -> None:
    """A tether of length 1 hanging from z = -start to -1 with tip and sheath; thickness of the sheath in lengths."""
    pen.lines(f"{path}/line", [[[0, 0, -start], [0, 0, -1]]], look.TETHER_BRAKE, width)
    pen.static(f"{path}/tip", rr.Points3D([[0, 0, -1]], radii=points(6.0 if near else 3.0), colors=[look.BUS]))
    pen.static(
        f"{path}/sheath",
        rr.GaussianSplats3D(
            [[0, 0, -(0.1 + 0.2 * k)] for k in range(5)],
            scales=[[thickness, thickness, 0.12]] * 5,
            colors=[[*look.SHEATH, 130]] * 5,
        ),
    )


def thruster(pen: Pen, path: str, near: bool) -> None:
    """A bus with panels, a nozzle and the plume, which leaves against the thrust."""
    pen.mesh(f"{path}/bus", meshes.box([0.34, 0.34, 0.46]), look.BUS)
    panels = [meshes.box([0.62, 0.30, 0.014]).moved([side * 0.52, 0, 0]) for side in (-1, 1)]
    pen.mesh(f"{path}/panels", meshes.joined(panels), look.PANEL)
    pen.mesh(f"{path}/nozzle", meshes.tube(-0.36, -0.23, 0.11, 0.05), look.BOOM)


def plume(pen: Pen, path: str) -> None:
    """The glow behind a thruster of size 1; it is shown while the thruster works."""
    along = -(0.42 + 0.13 * np.arange(5))
    widths = 0.05 + 0.022 * np.arange(5)
    pen.static(
        path,
        rr.GaussianSplats3D(
            [[0, 0, z] for z in along],
            scales=[[w, w, 0.10] for w in widths],
            colors=[[*look.PLUME, alpha] for alpha in (150, 110, 80, 55, 35)],
        ),
    )


GLOWING = {"electric-sail": "shape/sheath", "plasma-brake": "tether/sheath", "thruster": "shape/plume"}


class Glow:
    """What of a craft only shows while it thrusts: the sheath of a charged tether, the plume of a thruster."""

    def __init__(self, pen: Pen, body: str, kind: str):
        self._pen, self._on = pen, None
        self._path = f"{body}/{GLOWING[kind]}" if kind in GLOWING else None

    def add(self, index_of, on) -> None:
        """on (n,) bool; index_of(rows) gives the timelines of some of the rows. Only changes are written."""
        before = not on[0] if self._on is None else self._on
        changed = np.flatnonzero(np.diff(on, prepend=before))
        self._on = bool(on[-1])
        if self._path and len(changed):
            scale = np.where(on[changed], 1.0, 1e-6)[:, None] * np.ones(3)
            self._pen.columns(self._path, index_of(changed), rr.Transform3D.columns(scale=f4(scale)))


def dot(pen: Pen, path: str, near: bool) -> None:
    pen.static(f"{path}/dot", rr.Points3D([[0, 0, 0]], radii=points(9.0 if near else 4.5), colors=[look.CRAFT]))
