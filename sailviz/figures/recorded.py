"""Figures of a recording: quantities over time, and its orbit.

from sailviz.figures.recorded import draw_recording
draw_recording("mars.rrd", "mars.svg", ["radius", "cone_deg"])
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz import frames
from sailviz.constants import AU
from sailviz.ephemeris import planet_orbit
from sailviz.figures.catalogue import Entry
from sailviz.figures.drawing import FigureError, file_of, written
from sailviz.figures.recorded_curves import (
    MOST,
    Curve,
    broken,
    curve_of,
    telling,
    thinned,
    time_unit,
)
from sailviz.figures.recorded_ensembles import (
    DRIVERS,
    Ensemble,
    Offset,
    draw_drivers,
    draw_histogram,
    draw_offset,
    draw_sigmas,
    ensembles_of,
    has_histogram,
    offsets_of,
)
from sailviz.figures.recorded_swings import bands_of
from sailviz.recording.drawing import style as colors
from sailviz.recording.drawing.landmarks import LARGER
from sailviz.recording.drawing.samples import is_low
from sailviz.recording.reader import Recording, read
from sailviz.recording.recorded_run import run_of
from sailviz.recording.timelines import take
from sailviz.run.arrays import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from sailviz.figures.page import Pen

SMOOTH = 5  # degrees between rows above which an orbit from the pole is no smooth line
MOST_POINTS = 4000  # of a line over another quantity
NEAR = 1.25  # times the largest distance from the Sun: rings of planets within are drawn
RINGS = ("Mercury", "Venus", "Earth", "Mars", "Jupiter", "Saturn", "Uranus", "Neptune")


def draw_recording(
    source: str | Path | Recording,
    path: str | Path,
    quantities: Sequence[str] = (),
    *,
    orbit: bool = False,
    over: str = "",
    style: str = "dark",
    dpi: int = 160,
) -> Path:
    """Draw quantities of a recording over time, or over another quantity (`over`), or with `orbit` its orbit, into a
    PNG, SVG or PDF. Returns the path.

    quantities : names as [[expect]] writes them (`radius_au`), the same without a unit, or columns of /environment;
    without any, those of the usual ones that change, or where there are ensembles how they spread. With `orbit` they
    stand beside it. What swings within a revolution is a band about its mean. FigureError, in a sentence,
    for what cannot be drawn or written; RecordingError for what cannot be read.
    """
    kind = file_of(path)
    recording = read(source)
    run = run_of(recording)
    if orbit and over:
        raise FigureError("an orbit is drawn in its plane, not over a quantity")
    if over:
        entry, options = over_page(run, quantities, over)
        return written(path, kind, entry, style, dpi, options)
    ensembles = ensembles_of(recording)
    if ensembles and not quantities and not orbit:
        entry, options = ensembles_page(run, ensembles)
        return written(path, kind, entry, style, dpi, options)
    curves = curves_of(run, list(quantities) or ([] if orbit else telling(run)))
    entry, options = (orbit_page if orbit else curves_page)(recording, run, curves)
    return written(path, kind, entry, style, dpi, options)


def curves_of(run: Run, names: list[str]) -> list[Curve]:
    """What they mean, each once. FigureError for one that means nothing, and for too many."""
    if len(names) > MOST:
        raise FigureError(f"a page has room for {MOST} quantities, not for {len(names)}")
    return [curve_of(run, name) for name in dict.fromkeys(names)]


def note(run: Run) -> str:
    """What a reader must know of the origin of the numbers."""
    versions = run.setting.versions
    rows = f"{len(run.time):,} rows"
    return f"sailviz {versions.get('sailviz', '')}, {rows}, scene {run.setting.identity[:8]}".replace("  ", " ")


def curves_page(recording: Recording, run: Run, curves: list[Curve]) -> tuple[Entry, dict[str, Any]]:
    """A panel for each quantity, one above the other."""
    size = (9.0, 1.5 + 2.1 * len(curves))
    entry = Entry(run.setting.title, note(run), size, (len(curves), 1), "recorded", "over_time")
    return entry, {"run": run, "curves": curves, "ensembles": ensembles_of(recording)}


def over_page(run: Run, quantities: Sequence[str], over: str) -> tuple[Entry, dict[str, Any]]:
    """A panel for each quantity, one above the other, over another quantity."""
    along = curve_of(run, over)
    names = list(quantities) or [name for name in telling(run) if curve_of(run, name).stem != along.stem]
    curves = curves_of(run, names)
    if not curves:
        raise FigureError(f"nothing but {over} changes in this recording: name quantities to draw over it")
    size = (9.0, 1.5 + 2.1 * len(curves))
    entry = Entry(run.setting.title, note(run), size, (len(curves), 1), "recorded", "over_another")
    return entry, {"curves": curves, "along": along}


def ensembles_page(run: Run, ensembles: list[Ensemble]) -> tuple[Entry, dict[str, Any]]:
    """How ensembles spread about the calm flight, a panel for each coordinate, and where they are at the end."""
    offsets = offsets_of(ensembles)
    panels = len(offsets) + any(has_histogram(ensemble) for ensemble in ensembles)
    entry = Entry(run.setting.title, note(run), (9.0, 1.8 + 2.5 * panels), (panels, 1), "recorded", "spread")
    return entry, {"run": run, "ensembles": ensembles, "offsets": offsets}


def orbit_page(recording: Recording, run: Run, curves: list[Curve]) -> tuple[Entry, dict[str, Any]]:
    """The orbit, and a panel for each quantity beside it; of a low orbit the altitude over time as well."""
    low = is_low(take(run, slice(0, 1)))
    if low and not curves:
        curves = [curve_of(run, name) for name in ("mean_altitude_km",)]
    panels = (1, 1 + len(curves))
    entry = Entry(run.setting.title, note(run), (7.4 + 5.4 * len(curves), 7.2), panels, "recorded", "orbit")
    return entry, {"run": run, "curves": curves, "targets": targets_of(recording), "low": low}


def targets_of(recording: Recording) -> list[np.ndarray]:
    """Orbits (k, 3) that the flight aims at, au, from the picture of the recording, which shows them a little large."""
    wanted = colors.rgba(colors.TARGET)
    found = []
    for name in recording.entities:
        if name.startswith("/world/references/") and int(recording[name]["colors"][0]) == wanted:
            found.append(np.array(list(recording[name]["strips"][0]), float) / LARGER)
    return found


def over_time(pen: Pen, *panels: Axes, run: Run, curves: list[Curve], ensembles: list[Ensemble]) -> None:
    """Curves on one axis of time; ensembles with what is known of them."""
    for panel, curve in zip(panels, curves, strict=True):
        draw_curve(pen, panel, run, curve)
        draw_beside(pen, panel, run, curve, ensembles)
        panel.label_outer()


def over_another(pen: Pen, *panels: Axes, curves: list[Curve], along: Curve) -> None:
    """Curves over another one, in the order of the rows; dots at the start and at the end."""
    few = max(len(along.values) // MOST_POINTS, 1)
    rows = np.unique(np.append(np.arange(0, len(along.values), few), len(along.values) - 1))
    across = broken(along.values, along.turn)[rows]
    for panel, curve in zip(panels, curves, strict=True):
        color = pen.readable(curve.color)
        up = broken(curve.values, curve.turn)[rows]
        panel.plot(across, up, color=color, gid=curve.name)
        panel.plot(across[:1], up[:1], "o", color=color, markersize=4, markerfacecolor="none", gid="start")
        panel.plot(across[-1:], up[-1:], "o", color=color, markersize=4, gid="end")
        panel.set_title(curve.words, loc="left", fontsize=10.5)
        panel.set_xlabel(along.words)
        if along.logarithmic and np.nanmin(along.values) > 0:
            panel.set_xscale("log")
        if curve.logarithmic and np.nanmin(curve.values) > 0:
            panel.set_yscale("log")
        else:
            steady(panel, curve.values)
        panel.label_outer()
    panels[0].set_title("open dot: start, full dot: end", loc="right", fontsize=8.5, color=pen.style.quiet)


def spread(pen: Pen, *panels: Axes, run: Run, ensembles: list[Ensemble], offsets: list[Offset]) -> None:
    """Ensembles about the calm flight over time, and at the end."""
    size, word = time_unit(float(run.time[-1] - run.time[0]))
    for panel, offset in zip(panels, offsets, strict=False):
        draw_offset(pen, panel, ensembles, offset, size)
        panel.set_xlabel(f"time since the start [{word}]" if offset is offsets[-1] else "")
    panels[0].legend(loc="best")
    if len(panels) > len(offsets):
        draw_histogram(pen, panels[-1], ensembles)
        panels[-1].legend(loc="best")


def draw_curve(pen: Pen, panel: Axes, run: Run, curve: Curve) -> None:
    """One quantity over the time since the start; where it would be a solid block, as a band about its mean."""
    size, word = time_unit(float(run.time[-1] - run.time[0]))
    color, bands = pen.readable(curve.color), bands_of(run, curve.values, curve.turn)
    if bands is None:
        time, values = thinned(run.time / size, curve.values)
        panel.plot(time, broken(values, curve.turn), color=color, gid=curve.name)
    else:
        time, short = bands.time / size, f"{curve.name}, least to largest"
        panel.fill_between(time, bands.low, bands.high, color=color, alpha=0.3, linewidth=0, gid=short)
        panel.plot(time, bands.mean, color=color, linewidth=1.3, gid=f"{curve.name}, mean")
        unit, name = time_unit(bands.width)
        how = "band: least to largest" if np.isnan(bands.mean).all() else "mean, and least to largest"
        panel.set_title(
            f"{how} within {bands.width / unit:.2g} {name}", loc="right", fontsize=8.5, color=pen.style.quiet
        )
    panel.set_title(curve.words, loc="left", fontsize=10.5)
    panel.set_xlabel(f"time since the start [{word}]")
    ends = run.time / size
    panel.set_xlim(ends[0], ends[-1] if len(ends) > 1 else ends[0] + 1)
    if curve.logarithmic and np.nanmin(curve.values) > 0:
        panel.set_yscale("log")
    else:
        steady(panel, curve.values)


def draw_beside(pen: Pen, panel: Axes, run: Run, curve: Curve, ensembles: list[Ensemble]) -> None:
    """What is known of ensembles of a quantity: of their distance mean and standard deviations, of what drives them
    percentiles."""
    size, _ = time_unit(float(run.time[-1] - run.time[0]))
    planar = [ensemble for ensemble in ensembles if ensemble.planar]
    if curve.stem == "radius" and planar:
        for line in panel.lines:
            line.set(linewidth=1.1, label="one flight")
        calm, dashes = planar[0].nominal[:, 0] / curve.size, (0, (5, 3))
        panel.plot(
            planar[0].time / size,
            calm,
            color=pen.style.ink,
            linewidth=1.1,
            linestyle=dashes,
            zorder=4,
            label="calm flight",
            gid=f"{curve.name}, calm flight",
        )
        for ensemble in planar:
            mean, wide = ensemble.mean[:, 0] / curve.size, ensemble.deviation[:, 0] / curve.size
            draw_sigmas(pen, panel, ensemble, ensemble.time / size, mean, wide, curve.name)
    elif curve.name in DRIVERS and ensembles:
        for line in panel.lines:
            line.set(linewidth=0.7, label="one flight")
        draw_drivers(pen, panel, ensembles, curve.name, size)
    if panel.get_legend_handles_labels()[0]:
        panel.legend(loc="best", frameon=True, facecolor=pen.style.panel, edgecolor="none", framealpha=0.85)


def steady(panel: Axes, values: np.ndarray) -> None:
    """Room round what hardly changes: rounding must not fill a panel."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    if high - low < 1e-6 * max(abs(low), abs(high), 1e-300):
        room = 0.05 * max(abs(low), abs(high)) or 1.0
        panel.set_ylim(low - room, high + room)
    panel.ticklabel_format(useOffset=False, axis="y")


def orbit(
    pen: Pen, place: Axes, *panels: Axes, run: Run, curves: list[Curve], targets: list[np.ndarray], low: bool
) -> None:
    """The orbit on the left, quantities over time beside it."""
    if low:
        in_its_plane(pen, place, run)
    else:
        from_the_pole(pen, place, run, targets)
    place.set_aspect("equal")
    for panel, curve in zip(panels, curves, strict=True):
        draw_curve(pen, panel, run, curve)


def to_ecliptic(run: Run) -> np.ndarray:
    """Rotation (3, 3) from the frame of a heliocentric flight to the ecliptic of J2000."""
    home = frames.icrf_to("ecliptic-j2000")
    turned: np.ndarray = home @ frames.icrf_to("icrf").T
    return turned if run.setting.resolved.get("frame") == "icrf" else np.eye(3)


def from_the_pole(pen: Pen, axes: Axes, run: Run, targets: list[np.ndarray]) -> None:
    """The way of a flight in the plane x, y: about the Sun the ecliptic, with the orbits of planets near it."""
    sun = run.setting.body.name == "Sun"
    size, word = (AU, "au") if sun else (1e6, "thousand km")
    turn = to_ecliptic(run) if sun else np.eye(3)
    x, y = (run.position @ turn.T / size)[:, :2].T
    reach = float(np.linalg.norm(run.position, axis=1).max()) / size
    if sun:
        epoch = run.setting.epoch
        rings = {name: planet_orbit(name, epoch) / size for name in RINGS}
        for name, ring in rings.items():
            if np.linalg.norm(ring, axis=1).min() < NEAR * reach:
                color = pen.readable(colors.planet_color(name))
                axes.plot(ring[:, 0], ring[:, 1], color=color, linewidth=0.9, label=name, gid=f"orbit of {name}")
    for k, target in enumerate([target @ turn.T for target in targets] if sun else []):
        axes.plot(
            target[:, 0],
            target[:, 1],
            color=pen.readable(colors.TARGET_NAME),
            linewidth=1.2,
            linestyle=(0, (4, 2.5)),
            label="target" if k == 0 else None,
            gid="target",
        )
    axes.plot(x, y, color=pen.readable(colors.DISTANCE), label="flight", gid="flight", marker=dots(run), markersize=2.5)
    axes.plot(0, 0, "o", color=pen.readable(colors.SUN), markersize=9 if sun else 5, label=run.setting.body.name)
    axes.plot(x[0], y[0], "o", color=pen.style.ink, markersize=5.5, label="start", gid="start", zorder=6)
    axes.plot(x[-1], y[-1], "s", color=pen.style.ink, markersize=5.5, label="end", gid="end", zorder=6)
    what = "from the north pole of the ecliptic" if sun else "along the axis z"
    axes.set(xlabel=f"x [{word}]", ylabel=f"y [{word}]")
    axes.set_title(f"seen {what}", loc="left", fontsize=10.5)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=5)


def dots(run: Run) -> str:
    """A dot for each row where rows are so far apart that a line between them is not the way."""
    angle = np.unwrap(np.arctan2(run.position[:, 1], run.position[:, 0]))
    far = len(angle) > 1 and np.degrees(np.abs(np.diff(angle))).max() > 4 * SMOOTH
    return "." if far else ""


def in_its_plane(pen: Pen, axes: Axes, run: Run) -> None:
    """The osculating orbits at the start and at the end of a low orbit in their own planes, periapsis to the right."""
    radius = run.setting.body.radius
    around = np.linspace(0, 2 * np.pi, 361)
    axes.fill(
        radius / 1e3 * np.cos(around), radius / 1e3 * np.sin(around), color=pen.readable(colors.OCEAN), gid="body"
    )
    for row, word, color in ((0, "start", colors.DISTANCE), (-1, "end", colors.QUANTITY["highest"])):
        a, e = float(run.elements.semi_major_axis[row]), float(run.elements.eccentricity[row])
        if not (a > 0 and e < 1):
            continue
        r = a * (1 - e * e) / (1 + e * np.cos(around)) / 1e3
        lowest, highest = (a * (1 - e) - radius) / 1e3, (a * (1 + e) - radius) / 1e3
        label = f"{word}: {lowest:,.0f} to {highest:,.0f} km up"
        axes.plot(r * np.cos(around), r * np.sin(around), color=pen.readable(color), label=label, gid=word)
    axes.set(xlabel="in the plane of the orbit, towards its lowest point [km]", ylabel="[km]")
    axes.set_title(f"osculating orbits round the {run.setting.body.name}", loc="left", fontsize=10.5)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.1), ncols=2)
