"""Figures of the analytic trajectories: where they hold, what rectification buys, spirals, escape."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import LogNorm

from sailviz.design import asymptotic, special_thrust, spirals
from sailviz.design.displaced.force_shape import force_shape

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from sailviz.figures.page import Pen

CIRCLE = [0.0, 0.0, 1.0]
LAWS = {  # title -> exponent, radial over transverse thrust
    "solar sail, pitch 35.26°": (2, np.sqrt(2)),
    "electric sail, pitch 45°": (1, 3.0),
    "constant circumferential acceleration": (0, 0.0),
}


def _radius(theta, *rest, **more):
    """r at angles from a circle, as far as the solution reaches; it may end before the last angle."""
    while len(theta) > 0:
        try:
            return asymptotic.propagate(CIRCLE, 0.0, theta, *rest, clock=None, **more).radius
        except asymptotic.BreakdownError as error:
            theta = theta[theta < error.theta - 1e-9]
    return np.empty(0)


def validity_map(pen: Pen, *panels: Axes) -> None:
    """Largest error in r over thrust and arc, for the three laws."""
    s = pen.style
    turns = np.geomspace(0.25, 40, 161)
    eps = np.geomspace(1e-4, 5e-2, 91)
    early = 20  # angles before the map's first
    theta = np.concatenate([np.linspace(0.05, 1.5, early), turns * 2 * np.pi])
    for axes, (name, (n, ratio)) in zip(panels, LAWS.items(), strict=True):
        error = np.full((len(eps), len(turns)), np.nan)
        for i, et in enumerate(eps):
            law = (ratio * et, et, n)
            exact = _radius(theta, *law, leg=np.pi / 32, scheme="midpoint")  # to 1e-5 and better while there are orbits
            found = _radius(theta[: len(exact)], *law)
            worst = np.maximum.accumulate(np.abs(found / exact[: len(found)] - 1))[early:]
            error[i, : len(worst)] = np.maximum(worst, 1e-12)
        image = axes.pcolormesh(
            turns,
            eps,
            np.ma.masked_invalid(error),
            cmap=pen.ramp,
            norm=LogNorm(1e-7, 1),
            shading="nearest",
            rasterized=True,
        )
        decades = np.log10(error)
        lines = axes.contour(
            turns, eps, decades, np.arange(-6, 0), linestyles="solid", colors=["#05070d"], linewidths=0.7, alpha=0.7
        )
        pen.contour_labels(axes, lines, lambda v: f"10$^{{{v:.0f}}}$")
        axes.contour(
            turns, eps, decades, [np.log10(asymptotic.DOUBTFUL)], linestyles="solid", colors=["#ffffff"], linewidths=2.4
        )
        axes.set(xscale="log", yscale="log", xlabel="revolutions")
        axes.set_title(name)
        axes.set_xticks([0.25, 1, 2, 5, 10, 20, 40], ["¼", "1", "2", "5", "10", "20", "40"])
        axes.minorticks_off()
        axes.grid(False)
        axes.set_facecolor(s.forbidden)
    panels[0].set_ylabel("transverse thrust over gravity at the start")
    pen.bar(panels[-1], image, "largest relative error in r")


def rectification(pen: Pen, *panels: Axes) -> None:
    """Error at the end of five revolutions over the length of the legs, plain and midpoint."""
    s = pen.style
    legs = np.unique(np.concatenate([5 * 2 * np.pi / np.arange(1, 6), 2 * np.pi / np.arange(1, 65)]))
    cases = ((0.01, s.series[1]), (0.003, s.series[3]), (0.001, s.series[0]), (0.0003, s.series[2]))
    end = np.array([10 * np.pi])
    for axes, (name, (n, ratio)) in zip(panels, LAWS.items(), strict=True):
        for et, color in cases:
            law = (CIRCLE, 0.0, end, ratio * et, et, n)
            try:
                fine = asymptotic.propagate(*law, 2 * np.pi / 1024, "midpoint", clock=None).radius[0]
            except asymptotic.BreakdownError:
                continue
            for scheme, line in (("plain", "-"), ("midpoint", (0, (4, 2.5)))):
                error = []
                for leg in legs:
                    try:
                        error.append(abs(asymptotic.propagate(*law, leg, scheme, clock=None).radius[0] / fine - 1))
                    except asymptotic.BreakdownError:
                        error.append(np.nan)
                axes.plot(np.degrees(legs), error, color=color, linestyle=line, linewidth=1.6)
        axes.set(xscale="log", yscale="log", xlabel="length of a leg [°]", ylim=(1e-12, 3), xlim=(5.5, 1900))
        axes.set_title(name)
        axes.axvline(360, color=s.quiet, linewidth=0.8)
        axes.text(340, 1.2, "one revolution", color=s.quiet, fontsize=8.5, ha="right", va="center")
        axes.set_xticks([10, 30, 90, 360, 1800], ["10", "30", "90", "360", "1800"])
        axes.minorticks_off()
    panels[0].set_ylabel("relative error in r after five revolutions")
    for et, color in cases:
        panels[0].plot([], [], color=color, label=f"transverse thrust {et:g}")
    panels[0].legend(loc="lower left")
    panels[1].plot([], [], color=s.ink, label="plain")
    panels[1].plot([], [], color=s.ink, linestyle=(0, (4, 2.5)), label="midpoint")
    panels[1].legend(loc="lower left")


def spiral_maps(pen: Pen, left: Axes, right: Axes) -> None:
    """Flight-path angle over pitch and lightness; lightness for insertion over anomaly and eccentricity."""
    s = pen.style
    films = [
        (film, name, s.series[i])
        for film, name, i in (("ideal", "ideal", 0), ("jpl-1978", "JPL 1978", 1), ("jpl-2015", "JPL 2015", 3))
    ]
    pitch, beta = np.meshgrid(np.linspace(0.05, 89.95, 451), np.linspace(0.001, 1.2, 451))
    gamma = np.degrees(spirals.logarithmic(beta, np.radians(pitch)).flight_path_angle)
    smooth: dict[str, Any] = {"cmap": pen.ramp, "shading": "gouraud", "rasterized": True, "vmin": 0}
    image = left.pcolormesh(pitch, beta, np.ma.masked_invalid(gamma), vmax=55, **smooth)
    lines = left.contour(pitch, beta, gamma, [1, 2, 5, 10, 20, 30, 40], colors=[s.ink], linewidths=0.8, alpha=0.7)
    pen.contour_labels(left, lines, lambda v: f"{v:g}°")
    angle = np.linspace(0.05, 89.9, 400)
    for film, _, color in films:
        left.plot(angle, spirals.largest_lightness(np.radians(angle), film), color=color, zorder=4)
    left.set(xlabel="pitch angle α [°]", ylabel="lightness number β", xlim=(0, 90), ylim=(0, 1.2))
    left.set_title("flight-path angle of an ideal sail; lines: largest lightness of each film")
    left.grid(False)
    left.set_facecolor(s.forbidden)
    left.text(30, 0.95, "too light for a spiral", color=s.quiet, fontsize=9.5, ha="center")
    pen.bar(left, image, "flight-path angle γ [°]")

    nu, e = np.meshgrid(np.linspace(90, 179.9, 451), np.linspace(0.001, 0.6, 401))
    found = spirals.insertion(e, np.radians(nu))
    image = right.pcolormesh(nu, e, np.ma.masked_invalid(found.lightness), vmax=1, **smooth)
    levels = [0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 1]
    lines = right.contour(nu, e, found.lightness, levels, colors=[s.ink], linewidths=0.8, alpha=0.7)
    pen.contour_labels(right, lines, lambda v: f"{v:g}")
    c, sine = np.cos(np.radians(nu)), np.sin(np.radians(nu))
    cone = np.arctan2(e * sine / 2, -e * c - (e * sine) ** 2 / (2 * (1 + e * c)))
    for film, _, color in films:
        limit = force_shape(film).cone_limit() * (1 - 1e-9)
        right.contour(nu, e, cone, [limit], colors=[color], linewidths=1.9, zorder=4)
    for name, orbit_e in (("Mercury", 0.2056), ("Mars", 0.0934), ("Earth", 0.0167)):
        right.axhline(orbit_e, color=s.ink, linewidth=0.6, alpha=0.5, zorder=3)
        right.text(178.5, orbit_e + 0.006, name, fontsize=8.5, color=s.ink, ha="right", zorder=5)
    right.set(
        xlabel="true anomaly where the sail opens ν [°]",
        ylabel="eccentricity of the ellipse",
        xlim=(90, 180),
        ylim=(0, 0.6),
    )
    right.set_title("sail that enters a spiral without an impulse; each film: right of its line")
    right.grid(False)
    right.set_facecolor(s.forbidden)
    pen.bar(right, image, "lightness number β (ideal film)")
    for _, name, color in films:
        right.plot([], [], color=color, label=name)
    right.legend(loc="upper right", facecolor=s.panel, frameon=True, edgecolor="none", framealpha=0.85)


def escape(pen: Pen, left: Axes, right: Axes) -> None:
    """Escape radius and time over the acceleration."""
    s = pen.style
    slow = np.geomspace(1e-4, 0.3, 200)
    dots = np.geomspace(1e-4, 0.3, 22)
    for name, law, color in (
        ("circumferential", special_thrust.circumferential, s.series[0]),
        ("tangential", special_thrust.tangential, s.series[1]),
    ):
        found, exact = law(slow), law(dots).exact
        left.plot(slow, found.escape_radius, color=color)
        left.plot(slow, found.better_escape_radius, color=color, linestyle=(0, (1, 2)), linewidth=1.6)
        left.plot(dots, exact.radius, "o", color=color, markersize=4)
        right.plot(slow, slow * found.escape_time, color=color)
        right.plot(slow, slow * found.better_escape_time, color=color, linestyle=(0, (1, 2)), linewidth=1.6)
        right.plot(dots, dots * exact.time, "o", color=color, markersize=4, label=name)
    fast, dots = np.geomspace(0.1251, 2, 200), np.geomspace(0.126, 2, 12)
    radial, exact = special_thrust.radial(fast), special_thrust.radial(dots).exact
    left.plot(fast, radial.escape_radius, color=s.series[2])
    left.plot(dots, exact.radius, "o", color=s.series[2], markersize=4)
    right.plot(fast, fast * radial.escape_time, color=s.series[2])
    right.plot(dots, dots * exact.time, "o", color=s.series[2], markersize=4, label="radial")
    for axes in (left, right):
        axes.axvline(0.125, color=s.quiet, linewidth=0.8)
        axes.set(xscale="log", xlabel="acceleration over gravity at the start", xlim=(1e-4, 2))
    left.text(0.115, 24, "least radial thrust, 1/8", color=s.quiet, fontsize=9, rotation=90, ha="right", va="center")
    left.set(yscale="log", ylabel="escape radius over initial radius", ylim=(1, 130))
    left.plot([], [], color=s.ink, label="thesis")
    left.plot([], [], color=s.ink, linestyle=(0, (1, 2)), linewidth=1.6, label="small-thrust limit, ours")
    left.plot([], [], "o", color=s.ink, markersize=4, label="integrated")
    left.legend(loc="lower left", borderaxespad=1.2)
    right.set(ylabel="velocity spent until escape, a t / v₀", ylim=(0, 3.5))
    right.legend(loc="upper left", borderaxespad=1.2)
