"""The system view: centre, planets, orbits, trail and craft, in units of order 1 to 100 (never metres, Rerun is
float32).

What moves has rows; what depends on how far the run reaches (sizes of the craft, of arrows, of the Sun) is a static
scale that is written again at the end. Craft and arrows hang under `/world/craft`, which moves with the craft without
turning.
"""

from __future__ import annotations

import numpy as np
import rerun as rr

from sailviz.frames import body_axes, from_frame, quaternion, unit
from sailviz.recording.contract import word
from sailviz.recording.drawing import craft, meshes
from sailviz.recording.drawing import style as look
from sailviz.recording.drawing.layout import Layout
from sailviz.recording.drawing.log import Pen, f4
from sailviz.recording.drawing.orbit_plane import OrbitPlane, notes
from sailviz.recording.drawing.planet import Planet
from sailviz.recording.drawing.samples import PLANE_TURNS, SPARSE, Frame, Samples, arc, orbits, smooth_lines
from sailviz.recording.drawing.style import points
from sailviz.run.arrays import Reference, Run

STRIP = 4  # drawn rows in one piece of the trail
LADDER = 12  # osculating orbits that show a long descent
GAP = 2 * SPARSE  # revolutions between rows over which a curve through both would miss the orbit


class World:
    """Writes /world."""

    def __init__(self, pen: Pen, first: Run, frame: Frame):
        self._pen, self._frame, self._setting = pen, frame, first.setting
        self._held = None  # time, position, velocity before the next piece of trail
        pen.static("/world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
        draw_stars(pen, "/world/stars", 1.0)
        self._planet = not frame.sun and self._setting.body.radius > 0
        self._center = Planet(pen, first) if self._planet else None
        self._plane = OrbitPlane(pen, first, frame, LADDER) if self._has_plane else None
        self.notes = notes(first, frame, LADDER) if self._plane else []
        if self._setting.family == "transfers":
            self.notes.append("orbits: pink the target (drawn 0.6 % large), cyan and thin the one reached")
        if "primer_direction" in first.environment:
            self.notes.append("the **turquoise** arrow is the primer vector, which the steering follows")
        if frame.sun:
            draw_sun(pen)
        elif not self._planet:
            pen.static("/world/center", rr.Points3D([[0, 0, 0]], radii=points(7), colors=[look.SUN]))
        if not self._planet:
            disc = meshes.annulus(0.06, look.DISC_RADIUS)
            pen.mesh("/world/ecliptic", disc, look.ECLIPTIC, shaded=False)
            pen.strip_style("/world/sun_line", look.SUN_LINE, look.WIDTH["helper"])
            pen.strip_style("/world/height", look.HEIGHT, look.WIDTH["helper"])
        for reference in self._setting.references:
            draw_reference(pen, reference, frame.unit)
        for name in first.bodies:
            if name != "Sun":
                color = look.planet_color(name)
                pen.static(
                    f"/world/planets/{name}/body",
                    rr.Points3D.from_fields(radii=points(look.PLANET_DOTS.get(name, 4.6)), colors=[color]),
                )
                pen.label_style(f"/world/names/{name}", color, name)
        for name in first.approximations:
            path = f"/world/approximation/{word(name)}"
            pen.static(f"{path}/place", rr.Points3D.from_fields(radii=points(4.2), colors=[look.APPROXIMATION]))
            pen.label_style(f"{path}/name", look.APPROXIMATION, name)
        self._draw_craft()
        self._draw_trail_style()

    def _draw_craft(self) -> None:
        pen, kind = self._pen, self._setting.craft.kind
        craft.draw(pen, "/world/craft/body/shape", kind, near=False)
        if kind == "plasma-brake":
            craft.tether(pen, "/world/craft/body/tether", 0.0, 1.2, 0.1, near=False)
        if kind == "thruster":
            craft.plume(pen, "/world/craft/body/shape/plume")
        self._glow = craft.Glow(pen, "/world/craft/body", kind)
        pen.arrow_style("/world/craft/thrust/arrow", look.THRUST, look.WIDTH["thrust"])
        pen.arrow_style("/world/craft/velocity/arrow", look.VELOCITY, look.WIDTH["velocity"])
        pen.arrow_style("/world/craft/primer/arrow", look.PRIMER, look.WIDTH["velocity"])
        pen.label_style("/world/craft/primer/name", look.PRIMER, "primer")

    def _draw_trail_style(self) -> None:
        pen, color = self._pen, None if self._planet else look.TRAIL_RECENT
        if self._frame.sparse and not self._plane:
            pen.strip_style("/world/orbit", color, look.WIDTH["recent"] * 0.8)
        elif not self._frame.sparse:
            pen.strip_style("/world/trail/recent", color, look.WIDTH["recent"])
            if not self._planet:
                pen.strip_style("/world/trail/past", look.TRAIL_PAST, look.WIDTH["past"])
                pen.strip_style("/world/trail/future", look.TRAIL_FUTURE, look.WIDTH["future"])
        if self._has_ladder:
            pen.strip_style("/world/ladder", None, look.WIDTH["ladder"])

    @property
    def _has_ladder(self) -> bool:
        return self._frame.sparse or self._has_plane

    @property
    def _has_plane(self) -> bool:
        return self._planet and self._frame.turns > PLANE_TURNS

    def add(self, samples: Samples) -> None:
        """A group of drawn rows: whole pieces of trail, except at the end of the run."""
        pen, index = self._pen, samples.index
        pen.move("/world/craft", index, translation=samples.position)
        pen.move("/world/rtn", index, translation=samples.position, quaternion=quaternion(samples.axes))
        normal = from_frame(samples.axes, samples.normal_rtn)
        pen.move("/world/craft/body", index, quaternion=quaternion(body_axes(normal, samples.axes[..., 1])))
        self._glow.add(samples.index_of, samples.run.thrust.on)
        pen.arrows("/world/craft/thrust/arrow", index, from_frame(samples.axes, samples.thrust_rtn))
        pen.arrows("/world/craft/velocity/arrow", index, from_frame(samples.axes, samples.velocity_rtn))
        if samples.primer_rtn is not None:
            primer = from_frame(samples.axes, samples.primer_rtn)
            pen.arrows("/world/craft/primer/arrow", index, primer)
            pen.labels("/world/craft/primer/name", index, 1.06 * primer)
        if self._center:
            self._center.add(samples)
        for name, position in samples.run.bodies.items():
            if name != "Sun":
                pen.columns(
                    f"/world/planets/{name}/body", index, rr.Points3D.columns(positions=f4(position / self._frame.unit))
                )
                pen.labels(f"/world/names/{name}", index, position / self._frame.unit)
        for name, position in samples.run.approximations.items():
            path, place = f"/world/approximation/{word(name)}", position / self._frame.unit
            pen.columns(f"{path}/place", index, rr.Points3D.columns(positions=f4(place)))
            pen.labels(f"{path}/name", index, place)
        if not self._planet:
            zero = np.zeros_like(samples.position)
            foot = samples.position * [1.0, 1.0, 0.0]
            pen.strips("/world/sun_line", index, np.stack([zero, samples.position], 1))
            pen.strips("/world/height", index, np.stack([foot, samples.position], 1))
        if self._plane:
            self._plane.add(samples, self._ramp(samples))
        elif self._frame.sparse:
            colors = self._ramp(samples) if self._planet else None
            pen.strips("/world/orbit", index, orbits(samples.run, self._frame), colors)
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
            for k in np.flatnonzero(self._wide(samples.run, gaps))
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
                    self._pen.broken_strips(f"/world/trail/{part}", index, strips, colors)
                else:
                    strips = line[first[:, None] * pieces + np.arange(length * pieces + 1)]
                    self._pen.strips(f"/world/trail/{part}", index, strips, colors)

    def _wide(self, run: Run, gaps) -> np.ndarray:
        """Whether the time since the row before is so long that a curve through both would miss the orbit. (n,)"""
        e = run.elements
        with np.errstate(invalid="ignore"):
            return (e.eccentricity < 1) & (gaps > GAP * 2 * np.pi * np.sqrt(e.semi_major_axis**3 / self._frame.mu))

    def _ramp(self, samples: Samples, factor: float = 1.0) -> np.ndarray:
        """Colours (n,) by altitude, HIGH at the start to LOW on the ground; the root because a descent ends fast."""
        start = max(self._frame.origin_radius - 1, 1e-9)
        altitude = samples.run.elements.semi_major_axis / self._frame.unit - 1
        down = np.sqrt(np.clip(1 - altitude / start, 0, 1))
        stops = factor * np.array([look.HIGH, look.BETWEEN, look.LOW], float)
        rgb = np.stack([np.interp(down, [0.0, 0.5, 1.0], stops[:, k]) for k in range(3)], 1).astype(np.uint32)
        return (rgb[:, 0] << 24) | (rgb[:, 1] << 16) | (rgb[:, 2] << 8) | 255

    def add_ladder(self, samples: Samples) -> None:
        """Osculating orbits of a few rows far apart, always in sight: the whole descent at a glance."""
        if self._has_ladder and len(samples):
            color = self._ramp(samples, 0.55) if self._planet else np.full(len(samples), look.rgba(look.TRAIL_FUTURE))
            if self._plane:
                self._plane.add_ladder(samples, self._ramp(samples))
            self._pen.strips("/world/ladder", samples.index, orbits(samples.run, self._frame, 241), color)

    def finish(self, last: Samples) -> None:
        """The orbit that a transfer has reached, to be seen beside the one it aimed at."""
        if self._setting.family == "transfers" and self._frame.sun:
            line = orbits(last.run, self._frame, 361)[-1]
            self._pen.lines("/world/references/reached", [line], look.dim(look.TRAIL_RECENT, 0.75), look.WIDTH["orbit"])

    def size(self, layout: Layout) -> None:
        """Everything that depends on how far the run reaches."""
        pen, radius, kind = self._pen, layout.scene_radius, self._setting.craft.kind
        pen.scale("/world/stars", look.STARS_RADIUS * radius)
        if self._frame.sun:
            pen.scale("/world/sun", look.SUN_RADIUS * radius)
        if not self._planet:
            pen.scale("/world/ecliptic", radius)
        if kind != "none":
            pen.scale("/world/craft/body/shape", layout.sail_size)
        if kind == "plasma-brake":
            pen.scale("/world/craft/body/tether", layout.tether_size)
        pen.scale("/world/craft/thrust", layout.thrust_scale)
        pen.scale("/world/craft/velocity", look.VELOCITY_LENGTH * radius)
        pen.scale("/world/craft/primer", look.PRIMER_LENGTH * radius)
        name = self._setting.craft.label or "craft"
        if self._planet:  # outwards, so that it does not lie on the planet
            pen.label("/world/rtn/name", name, look.CRAFT, (0.17 * radius, 0.0, 0.0))
        else:
            pen.label("/world/craft/name", name, look.CRAFT, (0.0, 0.0, look.LABEL_HEIGHT * radius))


def drawn(line, arcs: dict, start: int, end: int, pieces: int) -> list[np.ndarray]:
    """The lines of the intervals from `start` to `end`: the curve through all of them, broken where there are arcs."""
    lines, begun = [], start
    for k in range(start, end):
        if k in arcs:
            lines += [line[begun * pieces : k * pieces + 1]] if k > begun else []
            lines.append(arcs[k])
            begun = k + 1
    return lines + ([line[begun * pieces : end * pieces + 1]] if end > begun else [])


def draw_stars(pen: Pen, path: str, radius: float, count: int = 1100) -> None:
    """The same stars in every recording, on a sphere."""
    random = np.random.default_rng(7)
    direction = unit(random.normal(size=(count, 3)))
    magnitude = random.random(count) ** 4
    tints = np.array([[200, 215, 255], [255, 255, 255], [255, 236, 205]])[random.integers(0, 3, count)]
    colors = (tints * (0.30 + 0.55 * magnitude)[:, None]).astype(np.uint8)
    sizes = points(0.3 + 0.6 * magnitude)
    pen.static(path, rr.Points3D(f4(radius * direction), colors=colors, radii=sizes, point_shading="flat"))


def draw_sun(pen: Pen) -> None:
    """Of radius 1: an unlit ball in a glow of three splats."""
    pen.mesh("/world/sun/ball", meshes.sphere(32, 64)[0], look.SUN_DISC, shaded=False)
    glow = ((1.15, (255, 214, 120, 230)), (2.4, (255, 160, 60, 70)), (5.5, (255, 120, 40, 22)))
    pen.static(
        "/world/sun/glow",
        rr.GaussianSplats3D([[0, 0, 0]] * 3, scales=[[r] * 3 for r, _ in glow], colors=[c for _, c in glow]),
    )
    pen.label("/world/sun/name", "Sun", look.SUN, (0, 0, -2.1))


def draw_reference(pen: Pen, reference: Reference, length: float) -> None:
    """An orbit that is there from the start. A target is drawn a little large: on the trail it would tear."""
    line = np.asarray(reference.points, float) / length
    if reference.role == "planet":
        color = look.dim(look.planet_color(reference.name))
        pen.lines(f"/world/planets/{reference.name}/orbit", [line], color, look.WIDTH["orbit"])
        return
    target = reference.role == "target"
    color, width = (look.TARGET, "target") if target else (look.INITIAL, "orbit")
    if reference.role == "approximation":
        color = look.dim(look.APPROXIMATION)
    name = reference.name.lower().replace(" ", "_").replace("/", "_")
    pen.lines(f"/world/references/{name}", [1.006 * line if target else line], color, look.WIDTH[width])
