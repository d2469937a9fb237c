"""The close-up: the craft in the orbital frame, with what acts on it and its angles. Units: a sail is 14 to 16 across.

/sail has x from the central body, y transverse, z along the orbit normal. Arrows of thrust are as long as the root of
the thrust, so that weak ones are still seen.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

from sailviz.frames import body_axes, quaternion, unit
from sailviz.recording.drawing import cameras, style
from sailviz.recording.drawing.cameras import Camera
from sailviz.recording.drawing.craft import CraftDrawing, Glow
from sailviz.recording.drawing.log import Picture, f4
from sailviz.recording.drawing.samples import Samples
from sailviz.recording.drawing.sky import log_stars
from sailviz.run.arrays import Run

if TYPE_CHECKING:
    from sailviz.recording.drawing.layout import Layout

VELOCITY_LENGTH = 11.0
PRIMER_LENGTH = 9.0
CLOCK_AXIS = 10.0  # how far along the thrust the clock angle is shown where there is no arrow of the normal
PITCH_RADIUS = 6.0
CONE_RADIUS = 4.4
ARC = 25  # points of an arc


class SailCloseUp:
    """Writes /sail for everything that has an attitude: film, wheel or thruster."""

    def __init__(self, picture: Picture, first: Run, craft: CraftDrawing):
        self._picture, self._craft = picture, craft
        self._label = craft.close_name or first.setting.craft.label or "Craft"
        self._normal = craft.normal_length is not None
        self._length = craft.normal_length or CLOCK_AXIS
        picture.log_static("/sail", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        log_stars(picture, "/sail/stars", 900.0, 700)
        craft.log_shape(picture, "/sail/body/shape", True)
        self._glow = Glow(picture, "/sail/body", craft)
        picture.log_scale("/sail/body/shape", craft.close_size)
        if first.setting.body.name == "Sun":
            self._log_flow()
        picture.log_lines("/sail/radial", [[[0, 0, 0], [12, 0, 0]]], style.RADIAL, style.WIDTH["helper"])
        if self._normal:
            picture.log_arrow_style("/sail/normal", style.NORMAL, style.WIDTH["close arrow"])
            picture.log_label_style("/sail/normal/name", style.NORMAL, "normal")
        picture.log_arrow_style("/sail/velocity", style.VELOCITY, style.WIDTH["close arrow"])
        picture.log_arrow_style("/sail/primer", style.PRIMER, style.WIDTH["close arrow"])
        picture.log_label_style("/sail/primer/name", style.PRIMER, "primer")
        picture.log_arrow_style("/sail/force/arrow", style.THRUST, style.WIDTH["close thrust"])
        picture.log_label_style("/sail/velocity/name", style.VELOCITY, "velocity")
        picture.log_label_style("/sail/force_name", style.THRUST)
        picture.log_strip_style("/sail/pitch/arc", style.PITCH, style.WIDTH["arc"])
        k = np.arange(1, ARC)
        fan = np.stack([0 * k, k, k + 1], 1).astype(np.uint32)
        picture.log_triangles("/sail/pitch/fan", fan, [*style.PITCH, 38])
        picture.log_label_style("/sail/pitch/name", style.PITCH)
        picture.log_strip_style("/sail/cone", style.CONE, style.WIDTH["arc"])
        picture.log_strip_style("/sail/clock/circle", style.CLOCK_CIRCLE, style.WIDTH["helper"])
        picture.log_strip_style("/sail/clock/spokes", style.CLOCK_CIRCLE, style.WIDTH["helper"])
        picture.log_strip_style("/sail/clock/arc", style.CLOCK, 1.8)
        picture.log_label_style("/sail/clock/name", style.CLOCK)

    def _log_flow(self) -> None:
        """What comes from the Sun: light, or the wind on an E-sail."""
        name, color = self._craft.flow
        origins = [[-12, y, z] for y in (-5, 0, 5) for z in (-5, 0, 5)]
        dimmed, width = style.dim(color, 0.6), style.WIDTH["flow"]
        self._picture.log_fixed_arrows("/sail/flow", origins, [3.6, 0, 0], dimmed, width)
        self._picture.log_label("/sail/flow/name", name, color, (-9.0, 0, 6.0))

    def camera(self, middle: Samples) -> Camera:
        """Arrows apart, the sunlit side of a film in sight."""
        normal, thrust, velocity = middle.normal_rtn[0], middle.thrust_rtn[0], middle.velocity_rtn[0]
        arrows = [np.array([1.0, 0.0, 0.0]), velocity]
        for arrow in (normal, unit(thrust)):
            if all(np.linalg.norm(arrow - other) > 0.05 for other in arrows) and np.linalg.norm(arrow) > 0.5:
                arrows.append(arrow)
        fan = np.cross([1.0, 0.0, 0.0], normal)
        eye = cameras.apart(
            arrows,
            facing=normal if self._craft.facing else None,
            slanted=normal if self._craft.slanted else None,
            open_to=unit(fan) if np.linalg.norm(fan) > 0.05 else None,
            elevations=(20, 28, 36) if self._craft.facing else (20, 28, 36, 44, 52),
        )
        name = f"{self._label} close-up (orbital frame)"
        return Camera(name, "/sail", tuple((26.0 * eye).tolist()), (1.0, 0.0, 0.0))

    def add(self, samples: Samples) -> None:
        """A group of drawn rows."""
        picture, index, count = self._picture, samples.index, len(samples)
        normal, velocity = samples.normal_rtn, samples.velocity_rtn
        axes = body_axes(normal, np.tile([0.0, 1.0, 0.0], (count, 1)))
        picture.log_pose("/sail/body", index, quaternion=quaternion(axes))
        self._glow.add(samples.index_of, samples.run.thrust.on)
        if self._normal:
            picture.log_arrows("/sail/normal", index, self._length * normal)
            picture.log_labels("/sail/normal/name", index, 1.06 * self._length * normal)
        picture.log_arrows("/sail/velocity", index, VELOCITY_LENGTH * velocity)
        still = ~np.any(velocity, axis=1, keepdims=True)
        picture.log_labels("/sail/velocity/name", index, np.where(still, np.nan, 1.06 * VELOCITY_LENGTH * velocity))
        if samples.primer_rtn is not None:
            picture.log_arrows("/sail/primer", index, PRIMER_LENGTH * samples.primer_rtn)
            picture.log_labels("/sail/primer/name", index, 1.08 * PRIMER_LENGTH * samples.primer_rtn)
        self._add_force(samples)
        self._add_angles(samples)

    def _add_force(self, samples: Samples) -> None:
        thrust, size = samples.thrust_rtn, samples.run.thrust.magnitude
        root = np.sqrt(size)[:, None] * unit(thrust)
        self._picture.log_arrows("/sail/force/arrow", samples.index, root)
        texts = [f"thrust {acceleration_text(a)}" if a > 0 else "no thrust" for a in size.tolist()]
        self._picture.log_columns("/sail/force_name", samples.index, rr.Points3D.columns(labels=texts))

    def _add_angles(self, samples: Samples) -> None:
        """Pitch as a fan from the radial line to the normal, cone as an arc to the thrust, clock on a circle."""
        picture, index, count = self._picture, samples.index, len(samples)
        attitude = samples.run.attitude
        out = np.tile([1.0, 0.0, 0.0], (count, 1))
        fan = PITCH_RADIUS * arcs(out, samples.normal_rtn)
        picture.log_strips("/sail/pitch/arc", index, fan)
        corners = np.concatenate([np.zeros((count, 1, 3)), fan], 1)
        columns = rr.Mesh3D.columns(vertex_positions=f4(corners.reshape(-1, 3))).partition([ARC + 1] * count)
        picture.log_columns("/sail/pitch/fan", index, columns)
        # on the other side of the radial line: between it and the normal there is the thrust
        across = unit(samples.normal_rtn * [0.0, 1.0, 1.0])
        place = PITCH_RADIUS * (np.cos(np.radians(14)) * out - np.sin(np.radians(14)) * across)
        picture.log_labels("/sail/pitch/name", index, place, angle_texts("pitch", attitude.pitch))
        thrust = np.where(np.any(samples.thrust_rtn, 1, keepdims=True), unit(samples.thrust_rtn), out)
        picture.log_strips("/sail/cone", index, CONE_RADIUS * arcs(out, thrust))
        self._add_clock(samples, attitude.pitch, attitude.clock)

    def _add_clock(self, samples: Samples, pitch: np.ndarray, clock: np.ndarray) -> None:
        picture, index, length = self._picture, samples.index, self._length
        axial, radius = length * np.cos(pitch), length * np.sin(pitch)

        def on_circle(angle: np.ndarray) -> np.ndarray:
            """Angles (n, k) from the orbit normal towards the transverse direction -> (n, k, 3)."""
            x = np.broadcast_to(axial[:, None], angle.shape)
            return np.stack([x, radius[:, None] * np.sin(angle), radius[:, None] * np.cos(angle)], -1)

        full = np.tile(np.linspace(0, 2 * np.pi, 49), (len(samples), 1))
        picture.log_strips("/sail/clock/circle", index, on_circle(full))
        center = np.stack([axial, 0 * axial, 0 * axial], -1)[:, None]
        ends = [on_circle(np.zeros((len(samples), 1))), center, on_circle(clock[:, None])]
        picture.log_strips("/sail/clock/spokes", index, np.concatenate(ends, 1))
        picture.log_strips("/sail/clock/arc", index, on_circle(clock[:, None] * np.linspace(0, 1, 37)))
        # where the angle starts, but on the far side of the circle where the normal's own label is near
        near = np.clip(1 - np.minimum(clock, 2 * np.pi - clock) / np.radians(60), 0, 1)
        place = on_circle((np.pi * near)[:, None])[:, 0] * [1.0, 1.15, 1.15]
        place[:, 2] -= np.clip(4.0 - radius, 0, None)  # a small circle would lie under its own label
        picture.log_labels("/sail/clock/name", index, place, angle_texts("clock", clock))

    def size(self, layout: Layout) -> None:
        """The length of the thrust, and its label under the craft."""
        self._picture.log_scale("/sail/force", layout.close_thrust_scale)
        # under the craft as the camera sees it, not at the arrow's tip, which often lies among those of other arrows
        eye = unit(np.array(layout.close_up.position))
        down = unit(eye[2] * eye - [0.0, 0.0, 1.0])
        self._picture.log_static("/sail/force_name", rr.Points3D.from_fields(positions=[f4(9.3 * down)]))


def arcs(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Great-circle arcs between unit vectors, (n, 3), (n, 3) -> (n, ARC, 3)."""
    across = end - np.sum(start * end, 1, keepdims=True) * start
    angle = np.arctan2(np.linalg.norm(across, axis=1), np.sum(start * end, 1))
    share = np.linspace(0, 1, ARC) * angle[:, None]
    points: np.ndarray = np.cos(share)[..., None] * start[:, None] + np.sin(share)[..., None] * unit(across)[:, None]
    return points


def angle_texts(name: str, angle: np.ndarray) -> list[str]:
    """pitch 35°: whole degrees, never -0, never 360."""
    return [f"{name} {round(value) % 360}°" for value in np.degrees(angle).tolist()]


def acceleration_text(a: float) -> str:
    """An acceleration in m/s2 with three digits and a handy unit."""
    for size, name in ((1e-3, "mm/s²"), (1e-6, "µm/s²"), (1e-9, "nm/s²")):
        if a >= 0.0995 * size:
            return f"{a / size:.3g} {name}"
    return f"{a:.1e} m/s²"
