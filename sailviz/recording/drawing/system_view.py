"""The system view: centre, planets, orbits, trail and craft, in units of order 1 to 100 (never metres, Rerun is
float32).

What moves has rows; what depends on how far the run reaches (sizes of the craft, of arrows, of the Sun) is a static
scale that is written again at the end. Craft and arrows hang under `/world/craft`, which moves with the craft without
turning.
"""

from __future__ import annotations

import numpy as np
import rerun as rr

from sailviz.frames import body_axes, from_frame, quaternion
from sailviz.recording.contract import word
from sailviz.recording.drawing import style
from sailviz.recording.drawing.craft import CraftDrawing, Glow, log_tether
from sailviz.recording.drawing.layout import Layout
from sailviz.recording.drawing.log import Picture, f4
from sailviz.recording.drawing.orbit_plane import OrbitPlane, notes
from sailviz.recording.drawing.planet import Planet
from sailviz.recording.drawing.samples import PLANE_TURNS, SPARSE, Frame, Samples, arc, orbits, smooth_lines
from sailviz.recording.drawing.sky import log_stars, log_sun
from sailviz.recording.drawing.style import points
from sailviz.run.arrays import Reference, Run
from sailviz.shapes.primitives import disc

STRIP = 4  # drawn rows in one piece of the trail
LADDER = 12  # osculating orbits that show a long descent
GAP = 2 * SPARSE  # revolutions between rows over which a curve through both would miss the orbit


class SystemView:
    """Writes /world."""

    def __init__(self, picture: Picture, first: Run, frame: Frame, craft: CraftDrawing):
        self._picture, self._frame, self._setting, self._craft = picture, frame, first.setting, craft
        self._held: tuple[np.ndarray, ...] | None = None  # time, position, velocity before the next piece of trail
        picture.log_static("/world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        log_stars(picture, "/world/stars", 1.0)
        self._planet = not frame.sun and self._setting.body.radius > 0
        self._center = Planet(picture, first) if self._planet else None
        self._plane = OrbitPlane(picture, first, frame, LADDER) if self._has_plane else None
        self.notes = notes(first, frame, LADDER) if self._plane else []
        if self._setting.family == "transfers":
            self.notes.append("orbits: pink the target (drawn 0.6 % large), cyan and thin the one reached")
        if "primer_direction" in first.environment:
            self.notes.append("the **turquoise** arrow is the primer vector, which the steering follows")
        if frame.sun:
            log_sun(picture)
        elif not self._planet:
            picture.log_static("/world/center", rr.Points3D([[0, 0, 0]], radii=points(7), colors=[style.SUN]))
        if not self._planet:
            picture.log_mesh("/world/ecliptic", disc(0.06, style.DISC_RADIUS), style.ECLIPTIC, shaded=False)
            picture.log_strip_style("/world/sun_line", style.SUN_LINE, style.WIDTH["helper"])
            picture.log_strip_style("/world/height", style.HEIGHT, style.WIDTH["helper"])
        for reference in self._setting.references:
            log_reference(picture, reference, frame.unit)
        for name in first.bodies:
            if name != "Sun":
                color = style.planet_color(name)
                picture.log_static(
                    f"/world/planets/{name}/body",
                    rr.Points3D.from_fields(radii=points(style.PLANET_DOTS.get(name, 4.6)), colors=[color]),
                )
                picture.log_label_style(f"/world/names/{name}", color, name)
        for name in first.approximations:
            path = f"/world/approximation/{word(name)}"
            picture.log_static(
                f"{path}/place", rr.Points3D.from_fields(radii=points(4.2), colors=[style.APPROXIMATION])
            )
            picture.log_label_style(f"{path}/name", style.APPROXIMATION, name)
        self._log_craft()
        self._log_trail_style()

    def _log_craft(self) -> None:
        picture = self._picture
        self._craft.log_shape(picture, "/world/craft/body/shape", False)
        if self._craft.tether:
            log_tether(picture, "/world/craft/body/tether", 0.0, 1.2, 0.1, near=False)
        self._glow = Glow(picture, "/world/craft/body", self._craft)
        picture.log_arrow_style("/world/craft/thrust/arrow", style.THRUST, style.WIDTH["thrust"])
        picture.log_arrow_style("/world/craft/velocity/arrow", style.VELOCITY, style.WIDTH["velocity"])
        picture.log_arrow_style("/world/craft/primer/arrow", style.PRIMER, style.WIDTH["velocity"])
        picture.log_label_style("/world/craft/primer/name", style.PRIMER, "primer")

    def _log_trail_style(self) -> None:
        picture, color = self._picture, None if self._planet else style.TRAIL_RECENT
        if self._frame.sparse and not self._plane:
            picture.log_strip_style("/world/orbit", color, style.WIDTH["recent"] * 0.8)
        elif not self._frame.sparse:
            picture.log_strip_style("/world/trail/recent", color, style.WIDTH["recent"])
            if not self._planet:
                picture.log_strip_style("/world/trail/past", style.TRAIL_PAST, style.WIDTH["past"])
                picture.log_strip_style("/world/trail/future", style.TRAIL_FUTURE, style.WIDTH["future"])
        if self._has_ladder:
            picture.log_strip_style("/world/ladder", None, style.WIDTH["ladder"])

    @property
    def _has_ladder(self) -> bool:
        return self._frame.sparse or self._has_plane

    @property
    def _has_plane(self) -> bool:
        return self._planet and self._frame.turns > PLANE_TURNS

    def add(self, samples: Samples) -> None:
        """A group of drawn rows: whole pieces of trail, except at the end of the run."""
        picture, index = self._picture, samples.index
        picture.log_pose("/world/craft", index, translation=samples.position)
        picture.log_pose("/world/rtn", index, translation=samples.position, quaternion=quaternion(samples.axes))
        normal = from_frame(samples.axes, samples.normal_rtn)
        picture.log_pose("/world/craft/body", index, quaternion=quaternion(body_axes(normal, samples.axes[..., 1])))
        self._glow.add(samples.index_of, samples.run.thrust.on)
        picture.log_arrows("/world/craft/thrust/arrow", index, from_frame(samples.axes, samples.thrust_rtn))
        picture.log_arrows("/world/craft/velocity/arrow", index, from_frame(samples.axes, samples.velocity_rtn))
        if samples.primer_rtn is not None:
            primer = from_frame(samples.axes, samples.primer_rtn)
            picture.log_arrows("/world/craft/primer/arrow", index, primer)
            picture.log_labels("/world/craft/primer/name", index, 1.06 * primer)
        if self._center:
            self._center.add(samples)
        for name, position in samples.run.bodies.items():
            if name != "Sun":
                picture.log_columns(
                    f"/world/planets/{name}/body", index, rr.Points3D.columns(positions=f4(position / self._frame.unit))
                )
                picture.log_labels(f"/world/names/{name}", index, position / self._frame.unit)
        for name, position in samples.run.approximations.items():
            path, place = f"/world/approximation/{word(name)}", position / self._frame.unit
            picture.log_columns(f"{path}/place", index, rr.Points3D.columns(positions=f4(place)))
            picture.log_labels(f"{path}/name", index, place)
        if not self._planet:
            zero = np.zeros_like(samples.position)
            foot = samples.position * [1.0, 1.0, 0.0]
            picture.log_strips("/world/sun_line", index, np.stack([zero, samples.position], 1))
            picture.log_strips("/world/height", index, np.stack([foot, samples.position], 1))
        if self._plane:
            self._plane.add(samples, self._ramp(samples))
        elif self._frame.sparse:
            colors = self._ramp(samples) if self._planet else None
            picture.log_strips("/world/orbit", index, orbits(samples.run, self._frame), colors)
        if not self._frame.sparse:
            self._add_trail(samples)

    def _add_trail(self, samples: Samples) -> None:
        """Pieces of STRIP rows that join on; each stands at its last row, so that it shows when it has been flown."""
        new = (samples.run.time, samples.position, samples.velocity)
        held = self._held or tuple(part[:1] for part in new)  # a piece needs a point before it
        self._held = tuple(part[-1:] for part in new)
        pieces = self._frame.smooth
        time, position, velocity = (np.concatenate(parts) for parts in zip(held, new, strict=True))
        line = smooth_lines(time, position, velocity, pieces)
        gaps = np.diff(time)
        arcs = {  # where rows lie far apart on their orbit
            k: arc(samples.run, k, position[k], float(gaps[k]), self._frame)
            for k in np.flatnonzero(self._wide(samples.run, gaps)).tolist()
        }
        whole, rest = divmod(len(samples), STRIP)
        for start, number, length in ((0, whole, STRIP), (whole * STRIP, min(rest, 1), rest)):
            if number == 0:
                continue
            first = start + STRIP * np.arange(number)
            ends = first + length - 1
            index = samples.index_of(ends)
            colors = self._ramp(samples)[ends] if self._planet else None
            for part in ("recent",) if self._planet else ("recent", "past", "future"):
                if arcs:
                    strips = [drawn(line, arcs, k, k + length, pieces) for k in first.tolist()]
                    self._picture.log_broken_strips(f"/world/trail/{part}", index, strips, colors)
                else:
                    strips = line[first[:, None] * pieces + np.arange(length * pieces + 1)]
                    self._picture.log_strips(f"/world/trail/{part}", index, strips, colors)

    def _wide(self, run: Run, gaps: np.ndarray) -> np.ndarray:
        """Whether the time since the row before is so long that a curve through both would miss the orbit. (n,)"""
        e = run.elements
        with np.errstate(invalid="ignore"):
            turn = 2 * np.pi * np.sqrt(e.semi_major_axis**3 / self._frame.mu)
            wide: np.ndarray = (e.eccentricity < 1) & (gaps > GAP * turn)
            return wide

    def _ramp(self, samples: Samples, factor: float = 1.0) -> np.ndarray:
        """Colours (n,) by altitude, HIGH at the start to LOW on the ground; the root because a descent ends fast."""
        start = max(self._frame.origin_radius - 1, 1e-9)
        altitude = samples.run.elements.semi_major_axis / self._frame.unit - 1
        down = np.sqrt(np.clip(1 - altitude / start, 0, 1))
        stops = factor * np.array([style.HIGH, style.BETWEEN, style.LOW], float)
        rgb = np.stack([np.interp(down, [0.0, 0.5, 1.0], stops[:, k]) for k in range(3)], 1).astype(np.uint32)
        return (rgb[:, 0] << 24) | (rgb[:, 1] << 16) | (rgb[:, 2] << 8) | 255

    def add_ladder(self, samples: Samples) -> None:
        """Osculating orbits of a few rows far apart, always in sight: the whole descent at a glance."""
        if self._has_ladder and len(samples):
            color = self._ramp(samples, 0.55) if self._planet else np.full(len(samples), style.rgba(style.TRAIL_FUTURE))
            if self._plane:
                self._plane.add_ladder(samples, self._ramp(samples))
            self._picture.log_strips("/world/ladder", samples.index, orbits(samples.run, self._frame, 241), color)

    def finish(self, last: Samples) -> None:
        """The orbit that a transfer has reached, to be seen beside the one it aimed at."""
        if self._setting.family == "transfers" and self._frame.sun:
            line = orbits(last.run, self._frame, 361)[-1]
            self._picture.log_lines(
                "/world/references/reached", [line], style.dim(style.TRAIL_RECENT, 0.75), style.WIDTH["orbit"]
            )

    def size(self, layout: Layout) -> None:
        """Everything that depends on how far the run reaches."""
        picture, radius = self._picture, layout.scene_radius
        picture.log_scale("/world/stars", style.STARS_RADIUS * radius)
        if self._frame.sun:
            picture.log_scale("/world/sun", style.SUN_RADIUS * radius)
        if not self._planet:
            picture.log_scale("/world/ecliptic", radius)
        if self._craft.size > 0:
            picture.log_scale("/world/craft/body/shape", layout.sail_size)
        if self._craft.tether:
            picture.log_scale("/world/craft/body/tether", layout.tether_size)
        picture.log_scale("/world/craft/thrust", layout.thrust_scale)
        picture.log_scale("/world/craft/velocity", style.VELOCITY_LENGTH * radius)
        picture.log_scale("/world/craft/primer", style.PRIMER_LENGTH * radius)
        name = self._setting.craft.label or "craft"
        if self._planet:  # outwards, so that it does not lie on the planet
            picture.log_label("/world/rtn/name", name, style.CRAFT, (0.17 * radius, 0.0, 0.0))
        else:
            picture.log_label("/world/craft/name", name, style.CRAFT, (0.0, 0.0, style.LABEL_HEIGHT * radius))


def drawn(line: np.ndarray, arcs: dict[int, np.ndarray], start: int, end: int, pieces: int) -> list[np.ndarray]:
    """The lines of the intervals from `start` to `end`: the curve through all of them, broken where there are arcs."""
    lines, begun = [], start
    for k in range(start, end):
        if k in arcs:
            lines += [line[begun * pieces : k * pieces + 1]] if k > begun else []
            lines.append(arcs[k])
            begun = k + 1
    return lines + ([line[begun * pieces : end * pieces + 1]] if end > begun else [])


def log_reference(picture: Picture, reference: Reference, length: float) -> None:
    """An orbit that is there from the start. A target is drawn a little large: on the trail it would tear."""
    line = np.asarray(reference.points, float) / length
    if reference.role == "planet":
        color = style.dim(style.planet_color(reference.name))
        picture.log_lines(f"/world/planets/{reference.name}/orbit", [line], color, style.WIDTH["orbit"])
        return
    target = reference.role == "target"
    color, width = (style.TARGET, "target") if target else (style.INITIAL, "orbit")
    if reference.role == "approximation":
        color = style.dim(style.APPROXIMATION)
    name = reference.name.lower().replace(" ", "_").replace("/", "_")
    picture.log_lines(f"/world/references/{name}", [1.006 * line if target else line], color, style.WIDTH[width])
