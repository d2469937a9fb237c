"""Figures of chapter 4: displaced orbits of an electric sail."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sailviz.constants import AU, GRAVITY_AT_1_AU
from sailviz.design import displaced
from sailviz.propulsion.electric_sail import CONE_MAX

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from sailviz.figures.page import Pen

PHI_MAX = np.degrees(CONE_MAX)
DASHES = (0, (4, 2.5))


def requirements(pen: Pen, far: Axes, near: Axes) -> None:
    """Fig. 4.2 for the angular rate of the Earth: cone angle and a_c over elevation and distance."""
    s = pen.style
    # levels, and the places nearest to which their numbers stand
    outer = (
        {5: (86.3, 1.1), 10: (82.6, 1.1), 15: (79.1, 1.1)},
        {3.5: (88, 1.8), 4: (87, 1.6), 5: (84, 1.35), 6: (80.6, 1.25)},
    )
    inner = (
        {2: (55, 0.41), 5: (55, 0.55), 10: (55, 0.68), 15: (55, 0.76)},
        {2: (4, 0.91), 4: (10, 0.81), 6: (18, 0.71), 8: (20, 0.61), 10: (20, 0.53), 14: (20, 0.4), 18: (20, 0.32)},
    )
    panels = (
        (far, np.linspace(70, 90, 241), np.linspace(1, 2, 241), *outer),
        (near, np.linspace(0, 90, 241), np.linspace(0.3, 1, 241), *inner),
    )
    for axes, psi, r, cones, strengths in panels:
        elevation, radius = np.meshgrid(psi, r)
        found = displaced.circular(radius * AU, np.radians(elevation), radius**1.5)
        strength = found.characteristic_acceleration * 1e3
        # the cone angle also beyond the limit, so that the limit is a smooth line
        w, c, sine = radius**3, np.cos(np.radians(elevation)), np.sin(np.radians(elevation))
        cone = np.degrees(np.arctan2(w * sine * c, 1 - w * c * c))
        axes.contourf(elevation, radius, cone, [PHI_MAX, 360], colors=[s.forbidden], zorder=1)
        axes.contour(elevation, radius, cone, [PHI_MAX], colors=[s.bad], linewidths=2.0, zorder=4)
        lines = axes.contour(elevation, radius, cone, list(cones), colors=[s.series[0]], linewidths=1.4, zorder=3)
        pen.contour_labels(axes, lines, lambda v: f"{v:g}°", cones.values())
        lines = axes.contour(
            elevation, radius, strength, list(strengths), colors=[s.series[1]], linewidths=1.4, zorder=3
        )
        pen.contour_labels(axes, lines, lambda v: f"{v:g}", strengths.values())
        axes.set(xlabel="elevation ψ [°]", ylabel="distance from the Sun r [au]", xlim=psi[[0, -1]], ylim=r[[0, -1]])
        axes.grid(False)
    far.set_xticks(np.arange(70, 91, 5))
    words = f"cone angle over {PHI_MAX:.2f}°"
    far.text(75, 1.66, f"forbidden:\n{words}", color=s.quiet, ha="center", fontsize=9.5)
    near.text(34, 0.9, f"forbidden:\n{words}", color=s.quiet, ha="center", va="center", fontsize=9.5)
    far.set_title("outside the Earth's distance")
    near.set_title("inside the Earth's distance")
    far.plot([], [], color=s.series[0], label="cone angle φ [°]")
    far.plot([], [], color=s.series[1], label="characteristic acceleration [mm/s²]")
    far.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2)
    near.plot([], [], color=s.bad, label="largest cone angle")
    near.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13))


def _type_ii(radius, psi):
    return displaced.type_ii(radius * AU, psi).characteristic_acceleration * 1e3


def type_ii(pen: Pen, axes: Axes) -> None:
    """Fig. 4.3: a_c over elevation for distances from 0.5 to 2 au."""
    s = pen.style
    psi = np.radians(90) - CONE_MAX * np.linspace(1, 0, 400) ** 2  # dense at the limit, where a square root ends
    radii = (0.5, 0.6, 0.7, 0.8, 0.9, 1, 1.25, 1.5, 1.75, 2)
    for i, r in enumerate(radii):
        value = _type_ii(r, psi)
        axes.plot(np.degrees(psi), value, color=pen.ramp(0.25 + 0.75 * (1 - i / (len(radii) - 1))), zorder=3)
        axes.annotate(
            f"{r:g} au",
            (90, value[-1]),
            (6, 0),
            textcoords="offset points",
            va="center",
            fontsize=9,
            color=s.ink,
            annotation_clip=False,
        )
    _limit(pen, axes)
    axes.set(
        xlabel="elevation ψ [°]",
        ylabel="characteristic acceleration $a_c$ [mm/s²]",
        xlim=(70, 90),
        ylim=(2, 16),
    )
    axes.set_xticks(np.arange(70, 91, 2))


def _limit(pen, axes):
    edge = 90 - PHI_MAX
    axes.axvspan(70, edge, color=pen.style.forbidden, zorder=1)
    axes.axvline(edge, color=pen.style.bad, linewidth=1.4, zorder=2)
    axes.text(
        edge + 0.2, 2.4, f"no thrust points there below {edge:.2f}°", fontsize=9, color=pen.style.bad, va="center"
    )


def type_ii_models(pen: Pen, axes: Axes) -> None:
    """Fig. 4.4: the recent model against the original one, whose thrust falls as r^-7/6 whatever the attitude."""
    s = pen.style
    psi = np.radians(90) - CONE_MAX * np.linspace(1, 0, 400) ** 2
    everywhere = np.radians(np.linspace(70, 90, 200))
    colors = (s.series[i] for i in (5, 1, 0, 2, 4))
    for color, r in zip(colors, (0.5, 0.75, 1, 1.5, 2), strict=True):
        value = _type_ii(r, psi)
        original = GRAVITY_AT_1_AU * 1e3 * np.sin(everywhere) * r ** (-2 + 7 / 6)  # (3.33): |a| = a_c (r_E / r)^(7/6)
        axes.plot(np.degrees(psi), value, color=color, zorder=3)
        axes.plot(np.degrees(everywhere), original, color=color, linestyle=DASHES, linewidth=1.6, zorder=3)
        axes.annotate(
            f"{r:g} au",
            (90, value[-1]),
            (6, 0),
            textcoords="offset points",
            va="center",
            fontsize=9,
            color=color,
            annotation_clip=False,
        )
    _limit(pen, axes)
    axes.plot([], [], color=s.ink, label="recent model, r⁻¹")
    axes.plot([], [], color=s.ink, linestyle=DASHES, linewidth=1.6, label="original model, r^(-7/6)")
    axes.legend(loc="upper right", borderaxespad=1.2)
    axes.set(
        xlabel="elevation ψ [°]",
        ylabel="characteristic acceleration $a_c$ [mm/s²]",
        xlim=(70, 90),
        ylim=(2, 16),
    )
    axes.set_xticks(np.arange(70, 91, 2))


def stability_map(pen: Pen, *panels: Axes) -> None:
    """Growth of a disturbance over elevation and rate, for both ways of holding the clock angle."""
    s = pen.style
    psi, ratio = np.linspace(0, 40, 401), np.linspace(0.3, 1, 401)
    x, y = np.meshgrid(psi, ratio)
    words = {
        "orbital": "clock angle held against the orbit's own plane",
        "meridian": "thrust held in the plane of Sun line and pole",
    }
    for axes, clock in zip(panels, ("orbital", "meridian"), strict=True):
        found = displaced.stability(np.radians(x), y, clock=clock)
        growth = np.where(
            found.feasible, 2 * np.pi / y * found.growth_rate / np.log(10), np.nan
        )  # decades a revolution
        image = axes.pcolormesh(
            x, y, growth, cmap=pen.ramp, vmin=0, vmax=8, shading="gouraud", rasterized=True, zorder=1
        )
        least, most = (
            displaced.smallest_stable_rate(np.radians(psi), clock),
            displaced.largest_rate_ratio(np.radians(psi)),
        )
        axes.fill_between(psi, least, most, where=least < most, color=s.good, zorder=2, linewidth=0)
        axes.fill_between(psi, most, 1, color=s.forbidden, zorder=2.5, linewidth=0)
        axes.plot(psi, most, color=s.bad, linewidth=1.8, zorder=4)
        lines = axes.contour(
            x,
            y,
            np.where(found.stable, np.nan, growth),
            [1, 2, 3, 4, 5, 6],
            colors=[s.ink],
            linewidths=0.7,
            alpha=0.6,
            zorder=3,
        )
        pen.contour_labels(axes, lines, lambda v: f"{10**v:.0f}×" if v < 4 else f"10$^{{{v:.0f}}}$×")
        at, rate = displaced.largest_stable_elevation(clock)
        axes.plot(np.degrees(at), rate, "o", color=s.ink, markersize=6, zorder=5)
        axes.annotate(
            f"the wedge closes at {np.degrees(at):.2f}°",
            (np.degrees(at), rate),
            (22.5, 0.815),
            fontsize=9.5,
            color=s.ink,
            arrowprops={"arrowstyle": "-", "color": s.quiet, "linewidth": 0.8},
            zorder=6,
        )
        axes.text(6, 0.79, "stable", color="#07120d", fontsize=11, fontweight="bold", ha="center", zorder=6)
        axes.text(25, 0.93, "the thrust cannot point there", color=s.quiet, fontsize=9.5, ha="center", zorder=6)
        axes.set(
            xlabel="elevation ψ [°]",
            ylabel="angular rate over that of a Keplerian orbit of this radius",
            xlim=(0, 40),
            ylim=(0.3, 1),
        )
        axes.set_title(words[clock])
        axes.grid(False)
    bar = pen.bar(panels[-1], image, "a disturbance grows in one revolution", ticks=[0, 2, 4, 6, 8])
    bar.ax.set_yticklabels(["1×", "100×", "10⁴×", "10⁶×", "10⁸×"])
