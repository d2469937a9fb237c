"""Figures of what turns a craft: the torques that vanes and switched patches give, and how a wheel winds itself up."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sailviz.constants import AU, MU_SUN, RADIATION_PRESSURE
from sailviz.propagate.body_control import Vane, vane_loads
from sailviz.propulsion.electric_sail import characteristic_acceleration
from sailviz.propulsion.esail_wheel import Numbers, spin_up, straight, wheel_parts
from sailviz.propulsion.rigid_body import flat_plate
from sailviz.propulsion.solar_sail import FILMS
from sailviz.propulsion.surfaces import side_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from sailviz.figures.page import Pen

AWAY = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))  # of four actuators, about the middle of the sail
ARM, PATCH_ARM, AREA = 10.0, 9.6, 1.0  # m, m, m2
LIMIT = np.radians(85.0)  # of a vane, to either side
OFF = (0.4, 0.2, 0.7 / 3)  # b1, b2, b3 of a patch that is off
INCIDENCES = (0.0, 35.0, 60.0)  # deg, between the light and the sail's normal
MICRO = 1e6


def light(incidence: float) -> tuple[float, float, float]:
    """Along the light in body axes, tilted towards x by an angle, rad."""
    return float(np.sin(incidence)), 0.0, float(np.cos(incidence))


def vane_torques(incidence: float, angles: np.ndarray) -> np.ndarray:
    """(4, n, 3) N m about the middle of the sail, 1 au from the Sun: of each of four vanes at angles (n,) rad."""
    film = side_of(FILMS["jpl-2015"])
    found = []
    for x, y in AWAY:
        row = np.array(Vane(ARM * x, ARM * y, 0.0, AREA, LIMIT, 0.0, *film, *film))
        loads = [
            vane_loads.py_func(angle, *light(incidence), 2 * RADIATION_PRESSURE, 0.0, 0.0, 0.0, row, 0)[3:]
            for angle in angles.tolist()
        ]
        found.append(loads)
    return np.array(found)


def patch_torques(incidence: float) -> np.ndarray:
    """(4, 2, 3) N m by which each of four patches of the film, off and on, differs from one that is half on."""
    change = np.subtract(side_of(FILMS["jpl-2015"]), OFF)
    force = (
        2 * RADIATION_PRESSURE * AREA * np.array(flat_plate.py_func(*light(incidence), 0.0, 0.0, 1.0, *change, 0, 0, 0))
    )
    arms = PATCH_ARM * np.array([[*away, 0.0] for away in AWAY])
    half = 0.5 * np.cross(arms, force)
    return np.stack([-half, half], 1)


def most_of(torques: np.ndarray, plane: tuple[int, int]) -> np.ndarray:
    """(m, 2) N m in a plane of axes: the outline of what k actuators, each at one of n torques (k, n, 3), give
    together, by the most of them in every direction."""
    turn = np.linspace(0, 2 * np.pi, 361) + 1e-3
    ways = np.stack([np.cos(turn), np.sin(turn)], 1)
    flat = torques[..., list(plane)]
    best = np.argmax(np.einsum("mj,knj->kmn", ways, flat), axis=2)
    return np.asarray(sum(one[pick] for one, pick in zip(flat, best, strict=True)))


def attainable(pen: Pen, left: Axes, middle: Axes, right: Axes) -> None:
    """What four vanes and four switched patches can turn, facing the Sun and leaning from it."""
    angles = np.linspace(-LIMIT, LIMIT, 341)
    for incidence, color in zip(INCIDENCES, pen.style.series, strict=False):
        vanes, patches = vane_torques(np.radians(incidence), angles), patch_torques(np.radians(incidence))
        for axes, torques, plane in ((left, vanes, (0, 1)), (middle, vanes, (2, 1)), (right, patches, (0, 1))):
            outline = MICRO * most_of(torques, plane)
            axes.fill(*outline.T, color=color, alpha=0.10, zorder=2)
            axes.plot(*outline.T, color=color, label=f"light {incidence:.0f}° off", zorder=4)
    for axes, title, across in (
        (left, "four vanes", "x"),
        (middle, "four vanes", "z, the normal"),
        (right, "four patches", "x"),
    ):
        axes.set(xlabel=f"torque about {across} [µN m]", ylabel="torque about y [µN m]")
        axes.set_title(title, loc="left")
        axes.margins(0.08)
    right.set_ylim(top=1.5 * right.get_ylim()[1])
    right.legend(loc="upper left", fontsize=9)


PITCHES = (-20.0, 10.0, 20.0, 25.0, 35.0)  # deg, positive with the thrust forward
TURNS = 2.0
WHEEL = (20, 15e3, 20e3, 300.0, 2e-9, 1e3)  # tethers, m, V, kg, Pa, V: that of body/e-sail-spin
CONE, FIRST_TURN, TIP, TETHER = np.radians(3.0), 1800.0, 1.0, 0.2  # rad, s, kg, kg


def swing(pitch: float, longitude: np.ndarray) -> np.ndarray:
    """(n,) share of the voltage that holds the axis of the wheel on a circle at 1 au, after longitudes (n,) rad."""
    count, length, voltage, mass, pressure, potential = WHEEL
    strength = float(characteristic_acceleration(count, length, voltage, mass, pressure, potential))
    inertia = count * (TIP + TETHER / 3) * length**2
    lever = strength * mass * length * AU
    wheel = Numbers(strength * AU, *straight(CONE), lever, inertia, 1.0, 1.0)
    c, s, rate = np.cos(pitch), np.sin(pitch), np.sqrt(MU_SUN / AU**3)
    spins = 2 * np.pi / FIRST_TURN * spin_up(pitch, longitude)
    rows = [
        wheel_parts.py_func(1.0, 0.0, 0.0, c, s, 0.0, -s * rate, c * rate, 0.0, 1 / AU, spin, wheel)
        for spin in spins.tolist()
    ]
    return np.array([row[4] for row in rows])


def coriolis(pen: Pen, left: Axes, right: Axes) -> None:
    """How the spin of an electric sail's wheel grows or dies over the longitude, and what voltage holds its axis."""
    degrees = np.linspace(0, 360 * TURNS, 361)
    way = np.radians(degrees)
    for pitch, color in zip(PITCHES, pen.style.series, strict=False):
        left.plot(degrees, spin_up(np.radians(pitch), way), color=color, label=f"{pitch:+.0f}°", zorder=4)
        asked = swing(np.radians(pitch), way)
        held = asked <= 1
        right.plot(degrees[held], asked[held], color=color, zorder=4)
        if not held.all():
            right.plot(degrees[held][-1], asked[held][-1], "o", color=color, markersize=5, zorder=5)
    left.set_yscale("log")
    left.set(xlabel="heliocentric longitude flown [°]", ylabel="spin over that at the start", xlim=(0, 360 * TURNS))
    left.legend(loc="upper left", title="pitch", fontsize=9)
    right.axhline(1.0, color=pen.style.quiet, linewidth=1.0)
    pen.label(right, 360, 1.04, "more than all of the voltage", pen.style.quiet)
    right.set(
        xlabel="heliocentric longitude flown [°]",
        ylabel="swing of the voltage that holds the axis",
        xlim=(0, 360 * TURNS),
        ylim=(0, 1.12),
    )
    for axes in (left, right):
        axes.set_xticks(np.arange(0, 360 * TURNS + 1, 90))
