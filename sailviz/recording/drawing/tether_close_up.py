"""The close-up of a plasma brake: the satellite with its tether over the planet, and what acts on it.

/sail has x transverse, y along the orbit normal and z up, so that the planet is below. The ground passes below as it
does in the system view, bright in sunlight and dark in shadow.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

from sailviz.frames import body_axes, quaternion, to_frame, unit
from sailviz.recording.drawing import style
from sailviz.recording.drawing.cameras import Camera
from sailviz.recording.drawing.craft import CraftDrawing, Glow, log_tether
from sailviz.recording.drawing.log import Picture, f4
from sailviz.recording.drawing.planet import about_axis, log_air, log_planet
from sailviz.recording.drawing.sail_close_up import acceleration_text
from sailviz.recording.drawing.samples import Samples
from sailviz.recording.drawing.sky import log_stars
from sailviz.run.arrays import Craft, Run
from sailviz.shapes.primitives import cap

if TYPE_CHECKING:
    from sailviz.recording.drawing.layout import Layout

TETHER = 12.0
ARROWS = 14  # along the tether
PLANET, DOWN = 300.0, 318.0  # radius of the planet and depth of its centre
THIN_AIR = ((1.004, 60), (1.010, 36), (1.018, 18))  # radius and alpha: near, the halo must not cover the craft
TILTED = np.radians(0.05)  # a tilt below it is not worth a number
DAY, NIGHT = [190, 190, 190, 255], [70, 74, 96, 255]  # the ground below a satellite in light and in shadow


class TetherCloseUp:
    """Writes /sail for a plasma brake."""

    def __init__(self, picture: Picture, first: Run, craft: CraftDrawing):
        self._picture = picture
        self._lit: bool | None = None
        picture.log_static("/sail", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        log_stars(picture, "/sail/stars", 700.0, 700)
        craft.log_shape(picture, "/sail/body/shape", True)
        picture.log_scale("/sail/body/shape", craft.close_size)
        log_tether(picture, "/sail/body/tether", 0.06, 1.8, 0.04, near=True)
        self._glow = Glow(picture, "/sail/body", craft)
        picture.log_scale("/sail/body/tether", TETHER)
        self._planet = first.setting.body.radius > 0
        if self._planet:
            picture.log_static("/sail/planet", rr.Transform3D(translation=[0.0, 0.0, -DOWN]))
            picture.log_scale("/sail/planet/shape", PLANET)
            log_planet(picture, "/sail/planet/shape/globe", first.setting.body.name)
            log_air(picture, "/sail/planet/shape/air", cap(np.radians(50), 20, 96), THIN_AIR)
        picture.log_lines(
            "/sail/vertical", [[[0.0, 0.0, 0.0], [0.0, 0.0, -TETHER]]], style.dim(style.REFERENCE, 0.7), 0.8
        )
        down = [[0.0, 0.0, -share * TETHER] for share in np.linspace(0.10, 0.95, ARROWS)]
        picture.log_fixed_arrows("/sail/body/force/arrows", down, [1.0, 0, 0], style.THRUST, 1.3)
        picture.log_label_style("/sail/force_name", style.THRUST)
        picture.log_fixed_arrows("/sail/motion/velocity", [[0.0, 0, 0]], [8.0, 0, 0], style.VELOCITY, 1.8)
        picture.log_label("/sail/motion/velocity_name", "velocity", style.VELOCITY, (8.6, 0, 0))
        ions = [[9.0, y, z] for y in (-1.5, 1.5) for z in (-3, -5.5, -8, -10.5)]
        picture.log_fixed_arrows("/sail/motion/flow", ions, [-3.4, 0, 0], style.dim(style.WIND, 0.6), 0.9)
        picture.log_label("/sail/motion/flow_name", "ion ram flow", style.WIND, (8.4, 0, -2.3))
        picture.log_label_style("/sail/body/tip_name", style.BUS)
        picture.log_static("/sail/body/tip_name", rr.Points3D.from_fields(positions=[[0, 0, -1.04 * TETHER]]))
        picture.log_label_style("/sail/tether_name", style.SHEATH)
        picture.log_static("/sail/tether_name", rr.Points3D.from_fields(positions=[[-3.2, 0.0, 3.0]]))
        self._texts: dict[str, str] = {}
        self._sun = "Sun" in first.bodies
        if self._sun:
            picture.log_fixed_arrows("/sail/sun/light", [[9.0, 0, 0]], [-4.0, 0, 0], style.SUN, 1.6)
            picture.log_label_style("/sail/sun/name", style.SUN)
            picture.log_static("/sail/sun/name", rr.Points3D.from_fields(positions=[[9.6, 0, 0]]))

    def add(self, samples: Samples) -> None:
        """A group of drawn rows."""
        picture, index, count, run = self._picture, samples.index, len(samples), samples.run
        velocity, thrust, normal = (turned(v) for v in (samples.velocity_rtn, samples.thrust_rtn, samples.normal_rtn))
        axes = body_axes(normal, np.tile([1.0, 0.0, 0.0], (count, 1)))  # panels across the flight direction
        picture.log_pose("/sail/body", index, quaternion=quaternion(axes))
        self._glow.add(samples.index_of, run.thrust.on)
        picture.log_pose("/sail/motion", index, quaternion=quaternion(x_along(velocity)))
        self._add_force(samples, axes, thrust, normal)
        self._add_words(samples, normal)
        if self._planet:
            self._add_ground(samples)
        if self._sun:
            self._add_light(samples)

    def _add_force(self, samples: Samples, axes: np.ndarray, thrust: np.ndarray, normal: np.ndarray) -> None:
        """Uniform along the tether, since the run knows the whole force only. In the tether's own frame, across it:
        there turns about z and a scale across it stretch the arrows and leave their places alone."""
        size = samples.run.thrust.magnitude
        across = np.sqrt(size)[:, None] * to_frame(axes, unit(thrust))
        length = np.maximum(np.hypot(across[:, 0], across[:, 1]), 1e-9)
        scale = np.stack([length, length, np.ones_like(length)], 1)
        turn = about_axis(np.arctan2(across[:, 1], across[:, 0]))
        columns = rr.Transform3D.columns(quaternion=f4(turn), scale=f4(scale))
        self._picture.log_columns("/sail/body/force/arrows", samples.index, columns)
        per_length = samples.run.environment.get("plasma_force_N_m")
        texts = [f"drag {acceleration_text(a)}" if a > 0 else "no drag" for a in size.tolist()]
        if per_length is not None:
            texts = [f"{1e9 * f:.3g} nN/m" if f > 0 else "no force" for f in per_length.tolist()]
        pulled: np.ndarray = np.where(np.any(thrust, 1, keepdims=True), unit(thrust), [-1.0, 0, 0])
        place = -0.5 * TETHER * normal + 10.2 * pulled
        self._picture.log_labels("/sail/force_name", samples.index, place, texts)

    def _add_words(self, samples: Samples, normal: np.ndarray) -> None:
        """The tether's length and tilt at its tip, its voltage, current and power at its top."""
        environment = samples.run.environment
        tilt = environment.get("tether_tilt_rad", np.arccos(np.clip(normal[:, 2], -1, 1)))
        tip = tether_text(samples.run.setting.craft)
        texts = [f"{tip}, tilt {np.degrees(t):.2g}°" if t > TILTED else tip for t in tilt.tolist()]
        self._add_texts("/sail/body/tip_name", samples, texts)
        columns = [
            (environment[name], factor, unit_name)
            for name, factor, unit_name in (
                ("tether_voltage_V", 1.0, "V"),
                ("tether_current_A", 1e3, "mA"),
                ("tether_power_W", 1.0, "W"),
            )
            if name in environment
        ]
        if columns:
            words = [
                ", ".join(f"{number(factor * value[k])} {name}" for value, factor, name in columns)
                for k in range(len(samples))
            ]
            self._add_texts("/sail/tether_name", samples, words)

    def _add_texts(self, path: str, samples: Samples, texts: list[str]) -> None:
        """A label's text where it changes."""
        before = [self._texts.get(path), *texts[:-1]]
        changed = np.array([k for k, text in enumerate(texts) if text != before[k]], int)
        self._texts[path] = texts[-1]
        if len(changed):
            columns = rr.Points3D.columns(labels=[texts[k] for k in changed])
            self._picture.log_columns(path, samples.index_of(changed), columns)

    def _add_ground(self, samples: Samples) -> None:
        """The ground as it passes below, dark while the satellite is in shadow."""
        up = samples.axes[..., [1, 2, 0]]  # columns: x, y, z of the close-up, inertial
        if samples.earth_rotation is not None:
            half = about_axis(samples.earth_rotation)
            spin = np.zeros((len(samples), 3, 3))
            spin[:, 0, 0] = spin[:, 1, 1] = 2 * half[:, 3] ** 2 - 1
            spin[:, 1, 0] = 2 * half[:, 2] * half[:, 3]
            spin[:, 0, 1], spin[:, 2, 2] = -spin[:, 1, 0], 1.0
            turn = np.swapaxes(up, 1, 2) @ spin
            self._picture.log_pose("/sail/planet/shape/globe", samples.index, quaternion=quaternion(turn))
        lit = samples.lit
        changed = np.flatnonzero(np.diff(lit, prepend=not lit[0] if self._lit is None else self._lit))
        self._lit = bool(lit[-1])
        if len(changed):
            colors = np.where(lit[changed], style.rgba(DAY), style.rgba(NIGHT)).astype(np.uint32)
            columns = rr.Asset3D.columns(albedo_factor=colors)
            self._picture.log_columns("/sail/planet/shape/globe/ball", samples.index_of(changed), columns)
            scale = np.where(lit[changed], 1.0, 1e-6)[:, None] * np.ones(3)
            self._picture.log_columns(
                "/sail/sun/light", samples.index_of(changed), rr.Transform3D.columns(scale=f4(scale))
            )

    def _add_light(self, samples: Samples) -> None:
        """An arrow from the Sun towards the satellite; in shadow there is none."""
        sun = turned(to_frame(samples.axes, unit(samples.run.bodies["Sun"])))
        self._picture.log_pose("/sail/sun", samples.index, quaternion=quaternion(x_along(sun)))
        self._add_texts("/sail/sun/name", samples, ["sunlight" if lit else "Sun, hidden" for lit in samples.lit])

    def camera(self, middle: Samples) -> Camera:
        """From the side, the whole tether in sight."""
        return Camera("Tether close-up (orbital frame, not to scale)", "/sail", (5.0, -23.0, 3.5), (0.0, 0.0, -5.0))

    def size(self, layout: Layout) -> None:
        """The length of the force's arrows."""
        self._picture.log_scale(
            "/sail/body/force", [0.65 * layout.close_thrust_scale, 0.65 * layout.close_thrust_scale, 1.0]
        )


def x_along(directions: np.ndarray) -> np.ndarray:
    """Axes (n, 3, 3), columns, whose x is the unit vectors (n, 3) and whose z is as close to up as can be."""
    axes = body_axes(directions, np.tile([0.0, 0.0, 1.0], (len(directions), 1)))
    return np.stack([directions, -axes[..., 1], axes[..., 0]], -1)


def number(value: float) -> str:
    """Three digits, or all before the point."""
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def turned(rtn: np.ndarray) -> np.ndarray:
    """Orbital frame (radial, transverse, normal) -> (transverse, normal, radial): up is away from the planet."""
    return rtn[:, [1, 2, 0]]


def tether_text(craft: Craft) -> str:
    """How long the tether is, for the label at its tip."""
    length = craft.tether_length
    if not length:
        return "tip mass"
    return f"tip, {length / 1e3:g} km down" if length >= 1e4 else f"tip, {length:g} m down"
