"""The plane of a low orbit: the orbit of the moment, old ones as faint rings, and what lies in the plane, in altitude.

/world/plane turns with the orbit: z is its normal, x towards the Sun or, without one, the ascending node. So altitudes
of years can be compared, although the orbits themselves lie across each other. Nothing is exaggerated.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import rerun as rr

from sailviz.frames import quaternion, to_frame, unit
from sailviz.recording.contract import word
from sailviz.recording.drawing import style
from sailviz.recording.drawing.log import Color, Index, Picture, f4
from sailviz.recording.drawing.samples import Frame, Samples, rings
from sailviz.recording.drawing.style import points
from sailviz.run.arrays import Run, Shell
from sailviz.shapes.primitives import band, circle

CIRCLE = 361  # points
STAIRS = 1.1  # how far the labels of the rings are spread, in heights of the highest
FAINT = 0.02  # share of the ramp below which a map is not drawn


class OrbitPlane:
    """Writes /world/plane."""

    def __init__(self, picture: Picture, first: Run, frame: Frame, color: Color = style.CRAFT):
        """color : of the altitude of the moment."""
        self._picture, self._frame = picture, frame
        self._day = 86400.0 if frame.duration > 3 * 86400 else 3600.0
        ring = rr.LineStrips3D.from_fields(strips=[f4(circle(CIRCLE))], radii=points(style.WIDTH["recent"] * 0.8))
        picture.log_static("/world/plane/orbit", ring)
        picture.log_label_style("/world/plane/now", color)
        axes = plane_axes(first)[0]
        for shell in first.setting.shells:
            log_shell(picture, f"/world/plane/shells/{word(shell.name)}", shell, axes, frame.unit)

    def add(self, samples: Samples, colors: np.ndarray, name: str = "") -> None:
        """name : what stands before the altitude."""
        picture, index, run = self._picture, samples.index, samples.run
        axes = plane_axes(run)
        picture.log_pose("/world/plane", index, quaternion=quaternion(axes))
        values: dict[str, Any] = {name: f4(value) for name, value in rings(run, axes, self._frame).items()}
        ramp = rr.LineStrips3D.columns(colors=np.asarray(colors, np.uint32))
        picture.log_columns("/world/plane/orbit", index, [*rr.Transform3D.columns(**values), *ramp])
        radius = run.elements.semi_major_axis / self._frame.unit
        texts = [f"{name}{altitude:.0f} km" for altitude in (radius - 1) * self._frame.unit / 1e3]
        picture.log_labels("/world/plane/now", index, np.stack([radius, 0 * radius, 0 * radius], 1), texts)

    def add_ladder(
        self, run: Run, index_of: Callable[[np.ndarray], Index], rows: np.ndarray, colors: np.ndarray, count: int
    ) -> None:
        """Orbits far apart in time, turned into one plane, every other one with its age and altitude. rows (k,) of the
        drawn ones, of which `run` has the numbers; count : of them in the whole planned time."""
        self._picture.log_strip_style("/world/plane/ladder", None, style.WIDTH["ladder"])
        style_of_rungs = rr.Points3D.from_fields(radii=points(style.ANCHOR), show_labels=True)
        self._picture.log_static("/world/plane/rungs", style_of_rungs)
        placed = rings(run, plane_axes(run), self._frame)
        lines = placed["scale"][:, None] * circle(CIRCLE)
        lines = turned_by(placed["quaternion"], lines) + placed["translation"][:, None]
        self._picture.log_strips("/world/plane/ladder", index_of(rows), lines, colors)
        radius = run.elements.semi_major_axis / self._frame.unit
        rung = np.round((run.time - self._frame.start) / self._frame.duration * count)
        height = STAIRS * (self._frame.origin_radius - 1)
        across = height * (1 - 2 * rung / count)
        age, name = (run.time - self._frame.start) / self._day, "d" if self._day > 3600 else "h"
        high = (radius - 1) * self._frame.unit / 1e3
        texts = [f"{t:.0f} {name}: {h:.0f} km" for t, h in zip(age.tolist(), high.tolist(), strict=True)]
        named = np.flatnonzero(rung % 2 == 0)
        if len(named):
            place = np.stack([np.sqrt(np.clip(radius**2 - across**2, 0, None)), across, 0 * across], 1)
            colors = np.asarray(colors, np.uint32)[named]
            columns = rr.Points3D.columns(positions=f4(place[named]), labels=[texts[k] for k in named], colors=colors)
            self._picture.log_columns("/world/plane/rungs", index_of(rows[named]), columns)


def plane_axes(run: Run) -> np.ndarray:
    """(n, 3, 3), columns: x towards the Sun within the plane or along the node, z the orbit's normal."""
    normal = unit(np.cross(run.position, run.velocity))
    hint = run.bodies.get("Sun")
    if hint is None:
        hint = np.cross([0.0, 0.0, 1.0], normal) + 1e-9 * run.position
    across = np.cross(normal, hint)
    y = unit(across)
    return np.stack([np.cross(y, normal), y, normal], -1)


def turned_by(quaternions: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Vectors (n, k, 3) turned by quaternions (n, 4) xyzw."""
    axis, scalar = quaternions[:, None, :3], quaternions[:, None, 3:]
    twice = 2 * np.cross(axis, vectors)
    return np.asarray(vectors + scalar * twice + np.cross(axis, twice))


def log_shell(picture: Picture, path: str, shell: Shell, axes: np.ndarray, length: float) -> None:
    """A map as a translucent band, bright where the value is large: its logarithm, where it spans a factor of ten."""
    start = float(np.arctan2(*to_frame(axes, np.asarray(shell.reference, float))[[1, 0]]))
    sense = 1.0 if to_frame(axes, np.asarray(shell.normal, float))[2] >= 0 else -1.0
    angle, value = np.asarray(shell.angle, float), np.asarray(shell.value, float)
    if 2 * np.pi - (angle[-1] - angle[0]) > 1e-6:  # close the circle
        angle, value = np.append(angle, angle[0] + 2 * np.pi), np.concatenate([value, value[:1]])
    direction = start + sense * angle
    radius = 1 + np.asarray(shell.altitude, float) / length
    share = shares(value)
    mesh = band(direction, radius)
    faces = mesh.faces[share.ravel()[mesh.faces].max(1) > FAINT]
    stops = np.array(style.PLASMA, float)
    where = np.linspace(0, 1, len(stops))
    colors = np.stack([np.interp(share.ravel(), where, stops[:, k]) for k in range(3)], 1).astype(np.uint8)
    picture.log_static(
        path,
        rr.Mesh3D(
            vertex_positions=f4(mesh.vertices),
            triangle_indices=np.ascontiguousarray(faces, np.uint32),
            vertex_colors=colors,
            albedo_factor=[255, 255, 255, style.PLASMA_ALPHA],
        ),
    )


def shares(value: np.ndarray) -> np.ndarray:
    """Values as 0 to 1, on a logarithmic scale where they span more than a factor of ten, at most three decades."""
    high = np.nanmax(value)
    low = np.nanmin(value)
    if low >= 0 and high > 10 * low:
        decades = min(3.0, np.log10(high / low)) if low > 0 else 3.0
        return np.asarray(np.clip(np.log10(np.clip(np.nan_to_num(value) / high, 1e-30, None)) / decades + 1, 0, 1))
    return np.asarray(np.nan_to_num((value - low) / (high - low)) if high > low else np.ones_like(value))


def shell_words(run: Run) -> list[str]:
    """What the maps show, for the description."""
    lines = []
    for shell in run.setting.shells:
        low, high = float(np.nanmin(shell.value)), float(np.nanmax(shell.value))
        lines.append(f"in Descent the **violet** band is the {shell.name}: {low:.0e} to {high:.0e} {shell.unit}")
    return lines
