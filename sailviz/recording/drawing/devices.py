"""The kinds of craft and how each is drawn: one record a kind. A new device is drawn by one function and one record.

Frame: +z is the sail's normal, away from the Sun; of a tether, from its tip to the satellite; of a thruster, the
thrust.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np
import rerun as rr

from sailviz.recording.drawing import style
from sailviz.recording.drawing.craft import CraftDrawing
from sailviz.recording.drawing.log import Color, Picture, f4
from sailviz.recording.drawing.style import points
from sailviz.run.arrays import Craft, CraftPart
from sailviz.shapes import sails, tethers
from sailviz.shapes.primitives import Trimesh, circle, flat_sided, joined, surface_of_revolution


def log_square_sail(picture: Picture, path: str, near: bool) -> None:
    """Film seen from both sides: the sunward side is the back of a mesh whose front is the dark one."""
    film = sails.film()
    picture.log_mesh(f"{path}/film_lit", film, style.FILM_LIT, side="back")
    picture.log_mesh(f"{path}/film_dark", film, style.FILM_DARK, side="front")
    picture.log_mesh(f"{path}/booms", sails.booms(), style.BOOM)
    picture.log_mesh(f"{path}/bus", sails.bus(), style.BUS)
    picture.log_mesh(f"{path}/vanes", sails.vanes(), style.NORMAL, shaded=False)
    if near:
        lifts = [[0, 0, side * 0.004] for side in (-1, 1)]  # off the film, or the lines tear
        strips = [seam + lift for seam in sails.seams() for lift in lifts]
        picture.log_lines(f"{path}/seams", strips, style.SEAM, style.WIDTH["seam"])


def own_meshes(parts: tuple[CraftPart, ...], size: float) -> Iterator[tuple[str, Trimesh, Color, str | None]]:
    """(name, mesh, colour, side) of what is drawn of a craft with a shape, its longest side as 1: what is pushed is
    what is seen. The front of a film is the lit side."""
    for film in (True, False):
        meshes = [Trimesh(part.corners / size, part.faces, process=False) for part in parts if part.film == film]
        if meshes and film:
            yield "film_lit", joined(meshes), style.FILM_LIT, "front"
            yield "film_dark", joined(meshes), style.FILM_DARK, "back"
        elif meshes:
            yield "bus", flat_sided(joined(meshes)), style.BUS, None


def log_own_shape(parts: tuple[CraftPart, ...], size: float, picture: Picture, path: str, near: bool) -> None:
    """The parts of a craft with a shape."""
    for name, mesh, color, side in own_meshes(parts, size):
        picture.log_mesh(f"{path}/{name}", mesh, color, side=side)


OWN_SIZE = 0.12  # in the system view, of a mesh whose craft is else drawn as a dot


def drawing_of(craft: Craft) -> CraftDrawing:
    """How a craft is drawn: as its kind is, or, of one with a shape, as it is."""
    kind = CRAFT[craft.kind]
    if craft.cone or craft.rise:
        return replace(kind, log_shape=partial(log_electric_sail, craft.cone, craft.rise))
    if not craft.parts or craft.side is None:
        return kind
    own = partial(log_own_shape, craft.parts, craft.side)
    film = any(part.film for part in craft.parts)
    stowable = ("film_lit", "film_dark") if film else ()
    size, close = (kind.size, kind.close_size) if kind.size else (OWN_SIZE, CraftDrawing.close_size)
    glow = kind.glow if kind.tether else ""  # what glows is a part of the kind's own shape, but for a tether's sheath
    return replace(kind, log_shape=own, size=size, close_size=close, glow=glow, stowable=stowable, stowable_near=())


def log_electric_sail(cone: float, rise: float, picture: Picture, path: str, near: bool) -> None:
    """A wheel of tethers, bent downwind as it is told, with its charged sheath. 24 are drawn, 16 from afar, however
    many there are."""
    count = 24 if near else 16
    out, profile = tethers.spokes(count), tethers.bent(cone, rise)
    lines, slope = tethers.round_hub(profile, out), float(np.arctan2(*profile[-1, ::-1]))
    turns, (reach, height) = tethers.spoke_quaternions(count, slope), profile[-1]
    from_hub = tethers.round_hub(tethers.bent(cone, rise, 0.03), out)
    picture.log_lines(f"{path}/tethers", list(from_hub), style.TETHER, 0.9 if near else 0.7)
    rim = reach * circle() + [0.0, 0.0, height]
    picture.log_lines(f"{path}/rim", [rim], style.dim(style.TETHER, 0.7), 0.7 if near else 0.55)
    picture.log_mesh(f"{path}/hub", tethers.wheel_hub(), style.BUS)
    picture.log_mesh(f"{path}/disc", surface_of_revolution(profile[::-1], 72), style.WHEEL, shaded=False)
    if near:
        picture.log_mesh(f"{path}/tips", tethers.remote_unit(), style.BOOM)
        picture.log_static(f"{path}/tips", rr.InstancePoses3D(translations=f4(lines[:, -1]), quaternions=f4(turns)))
    picture.log_static(
        f"{path}/sheath",
        rr.GaussianSplats3D(
            f4(0.52 * lines[:, -1]),
            scales=[[0.21, 0.008, 0.008]] * count,
            quaternions=f4(turns),
            colors=[[*style.SHEATH, 120]] * count,
        ),
    )


def log_satellite(picture: Picture, path: str, near: bool) -> None:
    """A small satellite with two panels."""
    picture.log_mesh(f"{path}/bus", tethers.satellite_bus(), style.BOOM)
    picture.log_mesh(f"{path}/panels", tethers.satellite_panels(), style.PANEL)


def log_thruster(picture: Picture, path: str, near: bool) -> None:
    """A bus with panels, a nozzle and the plume, which leaves against the thrust."""
    picture.log_mesh(f"{path}/bus", tethers.thruster_bus(), style.BUS)
    picture.log_mesh(f"{path}/panels", tethers.thruster_panels(), style.PANEL)
    picture.log_mesh(f"{path}/nozzle", tethers.thruster_nozzle(), style.BOOM)
    along = -(0.42 + 0.13 * np.arange(5))
    widths = 0.05 + 0.022 * np.arange(5)
    picture.log_static(
        f"{path}/plume",
        rr.GaussianSplats3D(
            [[0, 0, z] for z in along],
            scales=[[w, w, 0.10] for w in widths],
            colors=[[*style.PLUME, alpha] for alpha in (150, 110, 80, 55, 35)],
        ),
    )


def log_dot(picture: Picture, path: str, near: bool) -> None:
    """A craft without a device."""
    picture.log_static(
        f"{path}/dot", rr.Points3D([[0, 0, 0]], radii=points(9.0 if near else 4.5), colors=[style.CRAFT])
    )


CRAFT = {
    "solar-sail": CraftDrawing(
        log_shape=log_square_sail,
        size=0.20,
        close_size=9.5,
        true_size=lambda craft: craft.side,
        facing=True,
        stowable=("film_lit", "film_dark", "booms", "vanes"),
        stowable_near=("seams",),
        flow_word="sunlight",
    ),
    "electric-sail": CraftDrawing(
        log_shape=partial(log_electric_sail, 0.0, 0.0),
        size=0.13,
        close_size=6.5,
        true_size=lambda craft: craft.tether_length,
        glow="shape/sheath",
        slanted=True,
        stowable=("tethers", "rim", "disc"),
        stowable_near=("tips",),
        sail_word="E-sail",
        flow_word="wind",
        flow_color=style.WIND,
    ),
    "plasma-brake": CraftDrawing(
        log_shape=log_satellite,
        close_size=5.0,
        true_size=lambda craft: craft.tether_length,
        tether=True,
        glow="tether/sheath",
        has_angles=False,
        descends=True,
        force="drag",
        lane="brake",
    ),
    "thruster": CraftDrawing(log_shape=log_thruster, close_size=8.0, close_name="Thruster", glow="shape/plume"),
    "none": CraftDrawing(log_shape=log_dot, size=0.0, close_size=1.0, has_angles=False, pushes=False),
}
