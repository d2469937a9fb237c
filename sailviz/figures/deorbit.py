"""Figures of the plasma brake: its drag over altitude, the time down, and what it replaces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FuncFormatter

from sailviz.constants import DAY, YEAR
from sailviz.design import decay
from sailviz.design.decay import disposal
from sailviz.environment import atmosphere
from sailviz.propulsion import plasma_brake

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from sailviz.figures.page import Pen

NAMES = {"min2019": "solar minimum, 2019", "mid2014": "middle, 2014", "max2001": "maximum, 2001"}
DASHED, DOTTED = (0, (4, 2.5)), (0, (1, 2))


def _color(style, level):
    return dict(zip(decay.LEVELS, (style.series[0], style.series[2], style.series[1]), strict=True))[level]


def drag_profile(pen: Pen, left: Axes, right: Axes) -> None:
    """Force per length over altitude at three solar levels with the density's band, and the error of fitted shapes."""
    s = pen.style
    h = np.linspace(200e3, 1500e3, 521)
    fitted = np.linspace(400e3, 1000e3, 25)
    for level, name in NAMES.items():
        profile, color = decay.shipped_profile(level), _color(s, level)
        low, high = (profile.with_density(factor)(h) * 1e9 for factor in (0.5, 2.0))
        left.fill_between(h / 1e3, low, high, color=color, alpha=0.16, linewidth=0)
        left.plot(h / 1e3, profile(h) * 1e9, color=color, zorder=4)
        station = decay.shipped_profile(level, np.radians(51.6))
        left.plot(h / 1e3, station(h) * 1e9, color=color, linestyle=DASHED, linewidth=1.2, zorder=4)
        for shape, line in (("log-quadratic", "-"), ("exponential", DASHED), ("power", DOTTED)):
            found = decay.fit(profile, shape).profile
            right.plot(
                fitted / 1e3, 100 * (found(fitted) / profile(fitted) - 1), color=color, linestyle=line, linewidth=1.6
            )
        left.plot([], [], color=color, label=name)
    left.plot([], [], color=s.ink, linestyle=DASHED, linewidth=1.2, label="inclination 51.6° instead of 97.8°")
    left.fill_between([], [], color=s.quiet, alpha=0.3, linewidth=0, label="density × 0.5 to × 2")
    left.set(yscale="log", xlabel="altitude [km]", ylabel="drag per length of tether [nN/m]")
    left.set(xlim=(200, 1500), ylim=(2, 1000))
    left.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    left.legend(loc="lower left")
    left.set_title("averaged over the orbit, −1 kV")
    for shape, line in (("log-quadratic", "-"), ("exponential", DASHED), ("power law", DOTTED)):
        right.plot([], [], color=s.ink, linestyle=line, linewidth=1.6, label=shape)
    right.legend(loc="lower center", ncols=3)
    right.axhline(0, color=s.quiet, linewidth=0.8)
    right.set(xlabel="altitude [km]", ylabel="fit over table, less one [%]", xlim=(400, 1000), ylim=(-22, 20))
    right.set_title("three shapes fitted from 400 to 1000 km, 97.8°")


MASS, LENGTH, TARGET = 260.0, 5e3, 300e3  # kg, m, m: the published example, down to where drag does the rest
SYSTEM = (1.0, 2.0)  # kg of reel, tip mass and high-voltage unit: an assumption, not a datum
CHEMICAL = {"cold gas, 70 s": 70.0, "monopropellant, 220 s": 220.0, "bipropellant, 300 s": 300.0}
ELECTRIC = {"electric, 800 s": 800.0, "electric, 1500 s": 1500.0, "electric, 3000 s": 3000.0}


def _name(axes, altitude, mass, words, color, below=False):
    """A curve's name just above it, or below."""
    place = {"va": "top" if below else "bottom", "ha": "center"}
    axes.text(altitude / 1e3, mass / 1.13 if below else 1.13 * mass, words, color=color, fontsize=9, **place)


def deorbit(pen: Pen, left: Axes, right: Axes) -> None:
    """What 260 kg must carry to come down, and how long it takes, over the altitude."""
    s = pen.style
    h = np.linspace(400e3, 1200e3, 161)
    km = h / 1e3
    burn, thrust, brake = s.series[3], pen.device("thruster"), pen.device("plasma brake")
    for (name, isp), at in zip(CHEMICAL.items(), (800e3, 800e3, 660e3), strict=True):
        left.plot(km, disposal.chemical(MASS, h, isp).propellant, color=burn)
        _name(left, at, disposal.chemical(MASS, at, isp).propellant, name, burn, below=isp == 300)
    for name, isp in ELECTRIC.items():
        left.plot(km, disposal.electric(MASS, h, isp, 0.01).propellant, color=thrust)
        _name(left, 1080e3, disposal.electric(MASS, 1080e3, isp, 0.01).propellant, name, thrust)
    left.axhspan(*SYSTEM, color=brake, alpha=0.28, linewidth=0)
    tether = float(plasma_brake.tether_mass(LENGTH))
    left.axhline(tether, color=brake)
    words: dict[str, Any] = {"color": brake, "fontsize": 9, "ha": "right", "va": "center"}
    left.text(1185, float(np.sqrt(SYSTEM[0] * SYSTEM[1])), "plasma brake: reel, tip mass, high-voltage supply", **words)
    left.text(1185, 1.25 * tether, f"its tether alone: {LENGTH / 1e3:g} km, {1e3 * tether:.0f} g", **words)
    left.set(yscale="log", xlabel="altitude of the circular orbit [km]", ylabel="mass [kg]")
    left.set(xlim=(400, 1200), ylim=(0.03, 200))
    left.yaxis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    left.set_title("propellant, or mass of the brake")

    for level, name in NAMES.items():
        profile, color = decay.shipped_profile(level), _color(s, level)
        slow, time, fast = (
            decay.decay_time(MASS, LENGTH, h, TARGET, profile.with_density(factor)) / YEAR for factor in decay.BAND
        )
        right.fill_between(km, fast, slow, color=color, alpha=0.18, linewidth=0)
        right.plot(km, time, color=color, label=f"brake, {name}")
    for force, line in ((1e-3, DOTTED), (1e-2, DASHED)):
        way = disposal.electric(MASS, h, 1500.0, force)
        label = f"electric, 1500 s, {1e3 * force:g} mN, {way.power[0]:.0f} W"
        right.plot(km, way.time / YEAR, color=thrust, linestyle=line, linewidth=1.6, label=label)
    right.plot(km, disposal.chemical(MASS, h, 220.0).time / YEAR, color=burn, label="chemical: half a revolution")
    for years in (5, 25):
        right.axhline(years, color=s.bad, linewidth=1.2)
        right.text(410, years * 1.06, f"{years}-year rule", color=s.bad, fontsize=9, va="bottom")
    units = {3600 / YEAR: "1 h", DAY / YEAR: "1 d", 30 * DAY / YEAR: "30 d", 1: "1 yr", 10: "10 yr"}
    right.set(yscale="log", xlabel="altitude of the circular orbit [km]", ylabel="time down", xlim=(400, 1200))
    right.set_ylim(0.5 * 3600 / YEAR, 60)
    right.set_yticks(list(units), list(units.values()))
    right.minorticks_off()
    right.legend(loc="center right", bbox_to_anchor=(1.0, 0.36))
    right.set_title("time to 300 km, or to the entry")


AIR = {"min2019": (70.0, 5.0), "mid2014": (145.0, 10.0), "max2001": (200.0, 15.0)}  # F10.7, ap of the neutral air
CRAFT = {"mass": 100.0, "drag_area": 2.2}  # kg, m2 with the drag coefficient


def lifetime(pen: Pen, *panels: Axes) -> None:
    """Time from a circular orbit to re-entry over tether length and altitude, at three solar levels."""
    length = np.geomspace(50, 10e3, 61)
    h = np.linspace(400e3, 1200e3, 161)
    # where the names of the lines stand, km
    names = {0.1: (430, 430, 430), 0.3: (425, 470, 560), 1: (490, 640, 800), 2: (590, 770, 930), 5: (820, 960, 1060),
             25: (980, 1060, 1130)}  # fmt: skip
    halo = [withStroke(linewidth=2.4, foreground="#05070d", alpha=0.75)]
    for place, (axes, (level, title)) in enumerate(zip(panels, NAMES.items(), strict=True)):
        more = {"drag_area": CRAFT["drag_area"], "air": atmosphere.mean_profile(*AIR[level])}
        time = np.empty((len(h), len(length)))
        for i, metres in enumerate(length):
            way = decay.descend(CRAFT["mass"], metres, h[-1], decay.REENTRY, decay.shipped_profile(level), **more)
            time[:, i] = (way.duration - way.time_above(h)) / YEAR
        grid = (length / 1e3, h / 1e3, time)
        image = axes.pcolormesh(*grid, cmap=pen.ramp, norm=LogNorm(0.03, 100), shading="gouraud", rasterized=True)
        axes.contour(*grid, [0.1, 0.3, 1, 2], colors=["#05070d"], linewidths=0.8, alpha=0.7)
        axes.contour(*grid, [5, 25], colors=["#ffffff"], linewidths=[2.6, 1.5])
        for years, heights in names.items():
            row = time[np.argmin(np.abs(h / 1e3 - heights[place]))]
            if row[-1] < years < row[0]:
                x = np.interp(-np.log(years), -np.log(row), length / 1e3)
                weight = "bold" if years in (5, 25) else "normal"
                axes.text(0.96 * x, heights[place], f"{years:g} yr", color="#ffffff", fontsize=9, fontweight=weight,
                          ha="right", va="center", path_effects=halo, zorder=5)  # fmt: skip
        axes.set(xscale="log", xlabel="tether [km]")
        axes.set_xticks([0.1, 0.3, 1, 3, 10], ["0.1", "0.3", "1", "3", "10"])
        axes.set_yticks(np.arange(400, 1201, 200))
        axes.minorticks_off()
        axes.grid(False)
        axes.set_title(title)
    panels[0].set_ylabel("altitude of the circular orbit [km]")
    pen.bar(panels[-1], image, "time to re-entry [years]", format=lambda v, _: f"{v:g}")
