"""The close-up: the craft in the orbital frame, with what acts on it and its angles. Units: a sail is 14 to 16 across.

/sail has x from the central body, y transverse, z along the orbit normal. Arrows of thrust are as long as the root of
the thrust, so that weak ones are still seen.
"""

from __future__ import annotations

import numpy as np
import rerun as rr

from sailviz.frames import body_axes, quaternion, unit
from sailviz.recording.drawing import craft
from sailviz.recording.drawing import style as look
from sailviz.recording.drawing.layout import Layout
from sailviz.recording.drawing.log import Pen, f4
from sailviz.recording.drawing.samples import Samples
from sailviz.recording.drawing.style import points
from sailviz.recording.drawing.system_view import draw_stars
from sailviz.run.arrays import Run

SIZE = {"solar-sail": 15.0, "electric-sail": 9.0, "thruster": 8.0, "none": 1.0}
NORMAL_LENGTH = {"solar-sail": 13.0, "electric-sail": 10.0, "thruster": 10.0}
VELOCITY_LENGTH = 11.0
PRIMER_LENGTH = 9.0
PITCH_RADIUS = 6.0
CONE_RADIUS = 4.4
ARC = 25  # points of an arc


class SailCloseUp:
    """Writes /sail for everything that has an attitude: film, wheel or thruster."""

    def __init__(self, pen: Pen, first: Run):
        self._pen, self._kind = pen, first.setting.craft.kind
        self._length = NORMAL_LENGTH.get(self._kind, 10.0)
        pen.static("/sail", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        draw_stars(pen, "/sail/stars", 900.0, 700)
        craft.draw(pen, "/sail/body/shape", self._kind, near=True)
        if self._kind == "thruster":
            craft.plume(pen, "/sail/body/shape/plume")
        self._glow = craft.Glow(pen, "/sail/body", self._kind)
        pen.scale("/sail/body/shape", SIZE.get(self._kind, 9.0))
        if first.setting.body.name == "Sun":
            self._draw_flow()
        pen.lines("/sail/radial", [[[0, 0, 0], [12, 0, 0]]], [130, 104, 44], look.WIDTH["helper"])
        self._axis = self._kind != "thruster"  # a thruster's normal is its thrust
        if self._axis:
            pen.arrow_style("/sail/normal", look.NORMAL, look.WIDTH["close arrow"])
            pen.label_style("/sail/normal/name", look.NORMAL, "normal")
        pen.arrow_style("/sail/velocity", look.VELOCITY, look.WIDTH["close arrow"])
        pen.arrow_style("/sail/primer", look.PRIMER, look.WIDTH["close arrow"])
        pen.label_style("/sail/primer/name", look.PRIMER, "primer")
        pen.arrow_style("/sail/force/arrow", look.THRUST, look.WIDTH["close thrust"])
        pen.label_style("/sail/velocity/name", look.VELOCITY, "velocity")
        pen.label_style("/sail/force_name", look.THRUST)
        pen.strip_style("/sail/pitch/arc", look.PITCH, look.WIDTH["arc"])
        k = np.arange(1, ARC)
        fan = np.stack([0 * k, k, k + 1], 1).astype(np.uint32)
        pen.triangles("/sail/pitch/fan", fan, [*look.PITCH, 38])
        pen.label_style("/sail/pitch/name", look.PITCH)
        pen.strip_style("/sail/cone", look.CONE, look.WIDTH["arc"])
        pen.strip_style("/sail/clock/circle", look.CLOCK_CIRCLE, look.WIDTH["helper"])
        pen.strip_style("/sail/clock/spokes", look.CLOCK_CIRCLE, look.WIDTH["helper"])
        pen.strip_style("/sail/clock/arc", look.CLOCK, 1.8)
        pen.label_style("/sail/clock/name", look.CLOCK)

    def _draw_flow(self) -> None:
        """What comes from the Sun: light, or the wind on an E-sail."""
        wind = self._kind == "electric-sail"
        color = look.WIND if wind else look.SUN
        origins = [[-12, y, z] for y in (-5, 0, 5) for z in (-5, 0, 5)]
        self._pen.static(
            "/sail/flow",
            rr.Arrows3D(
                origins=origins,
                vectors=[[3.6, 0, 0]] * len(origins),
                colors=[look.dim(color, 0.6)],
                radii=points(look.WIDTH["flow"]),
            ),
        )
        self._pen.label("/sail/flow/name", "solar wind" if wind else "sunlight", color, (-9.0, 0, 6.0))

    def add(self, samples: Samples) -> None:
        pen, index, count = self._pen, samples.index, len(samples)
        normal, velocity = samples.normal_rtn, samples.velocity_rtn
        axes = body_axes(normal, np.tile([0.0, 1.0, 0.0], (count, 1)))
        pen.move("/sail/body", index, quaternion=quaternion(axes))
        self._glow.add(samples.index_of, samples.run.thrust.on)
        if self._axis:
            pen.arrows("/sail/normal", index, self._length * normal)
            pen.labels("/sail/normal/name", index, 1.06 * self._length * normal)
        pen.arrows("/sail/velocity", index, VELOCITY_LENGTH * velocity)
        still = ~np.any(velocity, axis=1, keepdims=True)
        pen.labels("/sail/velocity/name", index, np.where(still, np.nan, 1.06 * VELOCITY_LENGTH * velocity))
        if samples.primer_rtn is not None:
            pen.arrows("/sail/primer", index, PRIMER_LENGTH * samples.primer_rtn)
            pen.labels("/sail/primer/name", index, 1.08 * PRIMER_LENGTH * samples.primer_rtn)
        self._add_force(samples)
        self._add_angles(samples)

    def _add_force(self, samples: Samples) -> None:
        thrust, size = samples.thrust_rtn, samples.run.thrust.magnitude
        root = np.sqrt(size)[:, None] * unit(thrust)
        self._pen.arrows("/sail/force/arrow", samples.index, root)
        texts = [f"thrust {acceleration_text(a)}" if a > 0 else "no thrust" for a in size.tolist()]
        self._pen.columns("/sail/force_name", samples.index, rr.Points3D.columns(labels=texts))

    def _add_angles(self, samples: Samples) -> None:
        """Pitch as a fan from the radial line to the normal, cone as an arc to the thrust, clock on a circle."""
        pen, index, count = self._pen, samples.index, len(samples)
        attitude = samples.run.attitude
        out = np.tile([1.0, 0.0, 0.0], (count, 1))
        fan = PITCH_RADIUS * arcs(out, samples.normal_rtn)
        pen.strips("/sail/pitch/arc", index, fan)
        corners = np.concatenate([np.zeros((count, 1, 3)), fan], 1)
        columns = rr.Mesh3D.columns(vertex_positions=f4(corners.reshape(-1, 3))).partition([ARC + 1] * count)
        pen.columns("/sail/pitch/fan", index, columns)
        # on the other side of the radial line: between it and the normal there is the thrust
        across = unit(samples.normal_rtn * [0.0, 1.0, 1.0])
        place = PITCH_RADIUS * (np.cos(np.radians(14)) * out - np.sin(np.radians(14)) * across)
        pen.labels("/sail/pitch/name", index, place, angle_texts("pitch", attitude.pitch))
        thrust = np.where(np.any(samples.thrust_rtn, 1, keepdims=True), unit(samples.thrust_rtn), out)
        pen.strips("/sail/cone", index, CONE_RADIUS * arcs(out, thrust))
        self._add_clock(samples, attitude.pitch, attitude.clock)

    def _add_clock(self, samples: Samples, pitch, clock) -> None:
        pen, index, length = self._pen, samples.index, self._length
        axial, radius = length * np.cos(pitch), length * np.sin(pitch)

        def on_circle(angle):  # (n, k) -> (n, k, 3); angle from the orbit normal towards the transverse direction
            angle = np.asarray(angle)
            x = np.broadcast_to(axial[:, None], angle.shape)
            return np.stack([x, radius[:, None] * np.sin(angle), radius[:, None] * np.cos(angle)], -1)

        full = np.tile(np.linspace(0, 2 * np.pi, 49), (len(samples), 1))
        pen.strips("/sail/clock/circle", index, on_circle(full))
        center = np.stack([axial, 0 * axial, 0 * axial], -1)[:, None]
        ends = [on_circle(np.zeros((len(samples), 1))), center, on_circle(clock[:, None])]
        pen.strips("/sail/clock/spokes", index, np.concatenate(ends, 1))
        pen.strips("/sail/clock/arc", index, on_circle(clock[:, None] * np.linspace(0, 1, 37)))
        # where the angle starts, but on the far side of the circle where the normal's own label is near
        near = np.clip(1 - np.minimum(clock, 2 * np.pi - clock) / np.radians(60), 0, 1)
        place = on_circle((np.pi * near)[:, None])[:, 0] * [1.0, 1.15, 1.15]
        place[:, 2] -= np.clip(4.0 - radius, 0, None)  # a small circle would lie under its own label
        pen.labels("/sail/clock/name", index, place, angle_texts("clock", clock))

    def size(self, layout: Layout) -> None:
        self._pen.scale("/sail/force", layout.close_thrust_scale)
        # under the craft as the camera sees it, not at the arrow's tip, which often lies among those of other arrows
        eye = unit(np.array(layout.close_up.position))
        down = unit(eye[2] * eye - [0.0, 0.0, 1.0])
        self._pen.static("/sail/force_name", rr.Points3D.from_fields(positions=[f4(9.3 * down)]))


def arcs(start, end) -> np.ndarray:
    """Great-circle arcs between unit vectors, (n, 3), (n, 3) -> (n, ARC, 3)."""
    across = end - np.sum(start * end, 1, keepdims=True) * start
    angle = np.arctan2(np.linalg.norm(across, axis=1), np.sum(start * end, 1))
    share = np.linspace(0, 1, ARC) * angle[:, None]
    return np.cos(share)[..., None] * start[:, None] + np.sin(share)[..., None] * unit(across)[:, None]


def angle_texts(name: str, angle) -> list[str]:
    """pitch 35°: whole degrees, never -0, never 360."""
    return [f"{name} {round(value) % 360}°" for value in np.degrees(angle).tolist()]


def acceleration_text(a: float) -> str:
    for size, name in ((1e-3, "mm/s²"), (1e-6, "µm/s²"), (1e-9, "nm/s²")):
        if a >= 0.0995 * size:
            return f"{a / size:.3g} {name}"
    return f"{a:.1e} m/s²"
