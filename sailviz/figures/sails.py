"""Figures of chapter 3: how the sails push, and what age and heat do to a film."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz.constants import AU
from sailviz.propulsion import electric_sail
from sailviz.propulsion.film_ageing import aged_film, temperature
from sailviz.propulsion.solar_sail import FILMS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from sailviz.figures.page import Pen


def cone_and_acceleration(pen: Pen, left: Axes, right: Axes) -> None:
    """Fig. 3.4: phi(alpha) and gamma(alpha) of the electric sail."""
    s = pen.style
    alpha = np.radians(np.linspace(-90, 90, 721))
    degrees = np.degrees(alpha)
    best, most = np.degrees(electric_sail.PITCH_AT_CONE_MAX), np.degrees(electric_sail.CONE_MAX)

    # the polynomial model, by its own force: along and across the Sun line at 1 au
    inside = np.abs(degrees) <= 70
    normal = np.column_stack([np.cos(alpha), np.sin(alpha), np.zeros_like(alpha)])[inside]
    push = electric_sail.acceleration([electric_sail.AU, 0.0, 0.0], normal, 1.0, "polynomial")
    fit: dict[str, Any] = {"color": s.quiet, "linestyle": (0, (1, 2)), "linewidth": 1.6, "zorder": 3}

    left.plot(degrees, np.degrees(electric_sail.cone_angle(alpha)), color=pen.device("electric sail"), zorder=4)
    left.plot(degrees[inside], np.degrees(np.arctan2(push[:, 1], push[:, 0])), **fit)
    for sign in (-1, 1):
        left.plot(sign * best, sign * most, "o", color=s.series[1], markersize=6, zorder=5)
    pen.label(left, 38, 21.6, f"{most:.2f}° at a pitch of {best:.2f}°", s.series[1], fontsize=9.5)
    left.set(xlabel="pitch angle α [°]", ylabel="cone angle φ [°]", xlim=(-90, 90), ylim=(-24, 24))

    right.plot(degrees, electric_sail.dimensionless_acceleration(alpha), color=pen.device("electric sail"), zorder=4)
    right.plot(degrees[inside], np.hypot(push[:, 0], push[:, 1]), **fit)
    for sign in (-1, 1):
        right.plot(sign * best, np.sqrt(0.5), "o", color=s.series[1], markersize=6, zorder=5)
    pen.label(right, 0, 0.5 + 0.035, "edge-on the electric sail still pushes: γ = 1/2", s.quiet)
    right.set(xlabel="pitch angle α [°]", ylabel="dimensionless acceleration γ", xlim=(-90, 90), ylim=(0.48, 1.02))
    for axes in (left, right):
        axes.set_xticks(np.arange(-90, 91, 30))


def thrust_loci(pen: Pen, axes: Axes) -> None:
    """Fig. 3.5: circumferential against radial thrust, pitch as the parameter."""
    s = pen.style
    alpha = np.radians(np.linspace(0, 90, 361))
    dots = np.radians(np.arange(0, 91, 15))

    def sail(film):
        return lambda a: FILMS[film].components(a)

    def esail(a):
        return (3 + np.cos(2 * a)) / 4, np.sin(2 * a) / 4  # (3.47), (3.48)

    curves = (
        ("ideal solar sail", sail("ideal"), pen.device("ideal film"), "-"),
        ("optical solar sail (JPL 1978)", sail("jpl-1978"), pen.device("real film"), (0, (4, 2.5))),
        ("electric sail", esail, pen.device("electric sail"), "-"),
    )
    for name, push, color, line in curves:
        k_r, k_t = push(alpha)
        axes.plot(k_t, k_r, color=color, linestyle=line, label=name, zorder=4)
        k_r, k_t = push(dots)
        axes.plot(k_t, k_r, "o", color=color, markersize=4.5, zorder=5)
    k_r, k_t = esail(dots)
    for a, x, y in zip(dots[1:-1], k_t[1:], k_r[1:], strict=False):
        axes.annotate(
            f"{np.degrees(a):.0f}°",
            (x, y),
            (-8, 0),
            textcoords="offset points",
            fontsize=8.5,
            color=s.quiet,
            ha="right",
            va="top" if a < 0.7 else "bottom" if a > 0.9 else "center",
        )
    axes.set(
        xlabel="circumferential acceleration / greatest acceleration",
        ylabel="radial acceleration / greatest acceleration",
        xlim=(0, 0.5),
        ylim=(0, 1.03),
    )
    axes.set_aspect(0.45)
    axes.legend(loc="upper right", borderaxespad=1.2)


DOSES = (0.5, 1.0, np.inf)  # yr of full sunlight at 1 au
FACTOR, LIMIT = 0.2, (520.0, 570.0)  # of ageing; K, of polyimide: both assumed


def ageing_and_heat(pen: Pen, left: Axes, right: Axes) -> None:
    """Ours: push over the pitch angle of a film that ages, and how warm it gets over the distance."""
    s = pen.style
    pitch = np.linspace(0, np.pi / 2, 361)
    distance = np.geomspace(0.08, 1.2, 400)
    whole = aged_film("jpl-2015", 0.0, FACTOR).total
    for dose, color, word in zip(
        (0.0, *DOSES),
        s.series,
        ("fresh", "half a year of full sunlight", "a year", "in the end"),
        strict=False,
    ):
        film = aged_film("jpl-2015", dose, FACTOR)
        k_r, k_t = film.components(pitch)
        share = film.total / whole
        left.plot(np.degrees(pitch), share * k_r, color=color, label=word, zorder=4)
        left.plot(np.degrees(pitch), share * k_t, color=color, linestyle=(0, (4, 2.5)), zorder=4)
        kelvin = temperature(distance * AU, 0.0, "jpl-2015", dose, FACTOR)
        right.plot(distance, kelvin, color=color, label=word, zorder=4)
    pen.label(left, 62, 0.47, "along the sunlight", s.quiet)
    pen.label(left, 38, 0.20, "across it", s.quiet)
    left.set(
        xlabel="pitch angle α [°]",
        ylabel="push over that of the fresh film facing the Sun",
        xlim=(0, 90),
        ylim=(0, 1.03),
    )
    left.legend(loc="upper right", borderaxespad=1.2)
    right.axhspan(*LIMIT, color=s.series[1], alpha=0.12, zorder=1)
    pen.label(right, 0.75, 545, "polyimide: 520 to 570 K, about", s.quiet)
    right.set(
        xlabel="distance from the Sun [au]",
        ylabel="temperature of the film, facing the Sun [K]",
        xlim=(0.08, 1.2),
        ylim=(200, 1400),
    )
