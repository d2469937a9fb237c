"""What light does to a shape, in numbers and words: area and parts, force and centre of pressure at 1 au, and how well
its tensors and its table say what the facets do."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from sailviz.constants import RADIATION_PRESSURE
from sailviz.propulsion import shaped_sail
from sailviz.recording.shape_picture import LitShape
from sailviz.scene import load_scene
from sailviz.scene.device import SolarSail
from sailviz.shapes import kept_tables, light_table, shadows
from sailviz.shapes.facets import Shape
from sailviz.shapes.file_checks import ShapeError
from sailviz.shapes.light_force import pressure, tensors
from sailviz.shapes.light_table import LightTable
from sailviz.simulation.sail_shape import of_file, sail_shape, surface_named

PITCHES = (0, 35)  # deg, of the report
DRAWN = tuple(range(0, 90, 5))  # deg, of the recording
LOOKS = 400  # random directions in which the table is tried
CLOSE = 60.0  # deg from the Sun line within which a table is judged apart


def shape_of_file(
    file: str, *, film: str, back: str, parts: Sequence[str], unit: str | None = None, front: str = "-z"
) -> Shape:
    """The shape of a file of facets. film, back : words for every film; parts : NAME=FILM[/BACK] for single ones.
    ShapeError."""
    named = dict(_part(word) for word in parts)
    return of_file(file, unit, front, surface_named(film, back, False), named, back)


def _part(word: str) -> tuple[str, str]:
    name, equals, material = word.partition("=")
    if not equals or not name or not material:
        raise ShapeError(f"{word!r} is not NAME=FILM[/BACK]")
    return name, material


@dataclass(frozen=True)
class Report:
    """A shape and its table."""

    name: str
    shape: Shape
    tables: dict[str, LightTable]  # by how they are read between their nodes
    shadow: bool
    interpolation: str  # by which it flies

    @property
    def table(self) -> LightTable:
        """The table by which it flies."""
        return self.tables[self.interpolation]

    @cached_property
    def caster(self) -> shadows.Shadows | None:
        """What its shadows are told by."""
        return shadows.Shadows(self.shape) if self.shadow else None

    def at(self, pitch: float) -> dict[str, Any]:
        """Force, torque and centre of pressure at 1 au with the axis at a pitch, deg, from the light, which then leans
        to +x, by the facets."""
        u = tilted(pitch)
        force, torque = (2 * RADIATION_PRESSURE * each[0] for each in light_table.exact(self.shape, u, self.caster))
        centre, windmill = centre_of_pressure(force, torque)
        return {
            "pitch_deg": pitch,
            "force_N": force.tolist(),
            "torque_N_m": torque.tolist(),
            "centre_of_pressure_m": centre.tolist(),
            "torque_about_force_N_m": windmill,
        }

    @property
    def errors(self) -> dict[str, float]:
        """Those of the table by which it flies."""
        return self.errors_by[self.interpolation]

    @cached_property
    def errors_by(self) -> dict[str, dict[str, float]]:
        """For each reading differences between what is read and what the facets say, over 2 P A of the films: of the
        table, at random directions; of the tensors alone where all films show their front and nothing is shaded."""
        u = np.random.default_rng(1).normal(size=(LOOKS, 3))
        u /= np.linalg.norm(u, axis=1)[:, None]
        force, torque = light_table.exact(self.shape, u, self.caster)
        # of a curved film the facets are not the truth, nor what is read: the difference of their tensors is the films'
        width = light_table.width_of(self.shape)
        smooth, rough = (
            (tensors(self.shape, "front", kind), tensors(self.shape, "back", kind)) for kind in (True, False)
        )
        for one, sign in ((smooth, 1.0), (rough, -1.0)):
            more, turn = light_table.by_tensors(*one, width, u)
            force, torque = force + sign * more, torque + sign * turn
        area, size = self.shape.film_area, self.shape.size
        near = u[:, 2] > np.cos(np.radians(CLOSE))
        lit = tilted(0.0)
        of_facets, _ = light_table.exact(self.shape, lit, self.caster)
        found = {}
        for word, table in self.tables.items():
            read_force, read_torque = shaped_sail.force_and_torque(u, table.numbers)
            wrong = np.abs(read_force - force).max(axis=1) / area
            found[word] = {
                "table_force": float(wrong.max()),
                "table_force_rms": float(np.sqrt(np.mean(wrong**2))),
                "table_force_within_60_deg": float(wrong[near].max()),
                "table_torque": float(np.abs(read_torque - torque).max() / (area * size)),
                "tensors_facing": float(np.abs(smooth[0].force(lit) - of_facets).max() / area),
            }
        return found

    def facts(self) -> dict[str, Any]:
        """Everything, for a script."""
        parts = [
            {
                "name": part.name,
                "facets": len(part.elements),
                "area_m2": part.area,
                "front": list(part.surface.front),
                "back": None if part.surface.back is None else list(part.surface.back),
            }
            for part in self.shape.parts
        ]
        return {
            "name": self.name,
            "parts": parts,
            "film_area_m2": self.shape.film_area,
            "facets": len(self.shape.elements),
            "size_m": self.shape.size,
            "notes": list(self.shape.notes),
            "light": [self.at(pitch) for pitch in PITCHES],
            "cells": self.table.cells,
            "interpolation": self.interpolation,
            "rays": self.table.backend,
            "errors": self.errors,
            "errors_by": self.errors_by,
            "hash": self.shape.digest(),
        }

    def words(self) -> str:
        """Everything, for a person."""
        facts, wrong = self.facts(), self.errors
        count = "1 part" if len(self.shape.parts) == 1 else f"{len(self.shape.parts)} parts"
        lines = [f"{self.name}: {count}, {facts['facets']} facets, {facts['size_m']:.4g} m"]
        for part in facts["parts"]:
            front, back = _numbers(part["front"]), part["back"]
            made = f"b {front}, back {_numbers(back)}" if back else f"closed, b {front}"
            lines.append(f"  {part['name']:<12} {part['facets']:>7} facets {part['area_m2']:>12.6g} m²  {made}")
        lines += [f"  {note}" for note in facts["notes"]]
        lines.append("Light at 1 au, body axes, +z away from the Sun, torque about the origin:")
        for one in facts["light"]:
            word = "facing" if one["pitch_deg"] == 0 else f"{one['pitch_deg']:g} deg"
            lines.append(
                f"  {word:<8} force ({_vector(one['force_N'], 1e3)}) mN   centre of pressure "
                f"({_vector(one['centre_of_pressure_m'])}) m   torque ({_vector(one['torque_N_m'], 1e3)}) mN m"
            )
        rays = {"none": "no rays", "embreex": "rays by embreex", "rtree": "rays by trimesh and rtree"}[facts["rays"]]
        lines += [
            f"Tensors: 55 numbers a side; facing the Sun {wrong['tensors_facing']:.1e} of 2 P A from the facets",
            f"Table: 6 x {facts['cells']} x {facts['cells']} cells, {self.interpolation}, {rays}; at {LOOKS} random "
            "directions it is off by, of 2 P A,",
        ]
        for word, off in self.errors_by.items():
            most, near, rms = (off[f"table_force{of}"] for of in ("", "_within_60_deg", "_rms"))
            lines.append(f"  {word:<9} {most:.1e} at most ({near:.1e} within {CLOSE:g} deg of the Sun), rms {rms:.1e}")
        return "\n".join(lines)

    def picture(self) -> LitShape:
        """What is drawn of it."""
        u = np.concatenate([tilted(pitch) for pitch in DRAWN])
        visible = np.ones((len(u), len(self.shape.elements))) if self.caster is None else self.caster.visible(u)
        pressures = np.stack([pressure(self.shape, one, seen) for one, seen in zip(u, visible, strict=True)])
        found = [self.at(pitch) for pitch in DRAWN]
        force = np.array([one["force_N"] for one in found])
        return LitShape(
            f"{Path(self.name).name} in the light",
            self.shape.mesh.triangles,
            pressures / pressures.max(),
            np.array(DRAWN),
            u,
            np.array([one["centre_of_pressure_m"] for one in found]),
            force / np.linalg.norm(force, axis=1).max(),
            self.markdown(float(2 * RADIATION_PRESSURE * pressures.max())),
        )

    def markdown(self, strongest: float) -> str:
        """The words beside the picture. strongest : Pa, of the brightest colour."""
        lines = self.words().split("\n")
        return "\n\n".join(
            [
                f"**{Path(self.name).name}** in sunlight at 1 au, over the pitch angle.",
                f"Facets: dark in the shade, violet to orange by the pressure of light, to {strongest * 1e6:.2f} µPa. "
                "Orange arrow: the force, from its centre of pressure. Yellow: the light.",
                "```\n" + "\n".join(lines) + "\n```",
            ]
        )


def tilted(pitch: float) -> np.ndarray:
    """Direction of the light (1, 3) in body axes for a pitch, deg, of the axis; it leans to +x."""
    a = np.radians(pitch)
    return np.array([[np.sin(a), 0.0, np.cos(a)]])


def centre_of_pressure(force: np.ndarray, torque: np.ndarray) -> tuple[np.ndarray, float]:
    """(point (3,) m where the force's line meets z = 0, or the nearest to the origin of a force across z; torque about
    that line, N m)."""
    square = float(force @ force)
    if square == 0.0:
        return np.zeros(3), 0.0
    point = np.cross(force, torque) / square
    if abs(force[2]) > 1e-6 * np.sqrt(square):
        point = point - point[2] / force[2] * force
    return np.asarray(point), float(force @ torque / np.sqrt(square))


def report(
    name: str,
    shape: Shape,
    cells: int = light_table.CELLS,
    interpolation: str = "bilinear",
    shadow: bool = True,
    progress: Callable[[float], None] | None = None,
) -> Report:
    """The report of a shape. ShapeError where it cannot be had."""
    try:
        tables = both(kept_tables.table_of(shape, cells, shadow=shadow, interpolation="bicubic", progress=progress))
    except ValueError as error:
        raise ShapeError(f"{name}: {error}") from None
    return Report(name, shape, tables, shadow, interpolation)


def both(ringed: LightTable) -> dict[str, LightTable]:
    """A table as it is read either way. ringed : for bicubic reading, which has all nodes of the other one."""
    return {"bilinear": light_table.without_ring(ringed), "bicubic": ringed}


def report_of_scene(name: str) -> Report:
    """The report of the sail of a scene, with the table that it flies by. ShapeError, SceneError."""
    scene = load_scene(name)
    section = scene.device.shape if isinstance(scene.device, SolarSail) else None
    if section is None:
        raise ShapeError(f"{name} is a scene without a sail that has a shape")
    found, shadow = sail_shape(scene), section.shadow
    ringed = found.table
    if section.interpolation == "bilinear":
        ringed = kept_tables.table_of(found.shape, section.cells, shadow=shadow, interpolation="bicubic")
    tables = both(ringed) | {section.interpolation: found.table}
    return Report(name, found.shape, tables, shadow, section.interpolation)


def _numbers(b: Sequence[float]) -> str:
    return " ".join(f"{each:.4g}" for each in b)


def _vector(values: Sequence[float], factor: float = 1.0) -> str:
    return ", ".join(f"{each * factor + 0.0:.6g}" for each in np.round(np.asarray(values) * factor, 12) / factor)
