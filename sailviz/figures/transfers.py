"""Figures of minimum-time transfers: flight times, steering laws, films and E-sail models, launch windows."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.dates import DateFormatter, MonthLocator

from sailviz.constants import AU, DAY, YEAR
from sailviz.figures import transfer_data
from sailviz.figures.transfer_data import COMPARED, OVER_ACCELERATION, TARGETS
from sailviz.propulsion.solar_sail import FILMS
from sailviz.simulation import simulate
from sailviz.steering.optimal import analytic_pitch, optimal_pitch

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from sailviz.figures.page import Pen

WORDS = {
    "ideal": "ideal film",
    "jpl-2015": "JPL-2015",
    "jpl-1978": "JPL-1978",
    "electric-sail": "E-sail",
    "electric-sail-updated": "E-sail, updated",
    "electric-sail-polynomial": "E-sail, polynomial",
    "electric-sail-original": "E-sail, original",
}
DASHED, DOTTED = (0, (4, 2.5)), (0, (1, 2))


def flight_time(pen: Pen, *panels: Axes) -> None:
    """Flight time over the characteristic acceleration, one panel per target."""
    found = transfer_data.flight_times()
    for panel, target in zip(panels, TARGETS, strict=True):
        for device, color in zip(OVER_ACCELERATION, pen.style.series, strict=False):
            a_c, days, _ = found[target, device].T
            known = np.isfinite(days)
            panel.plot(a_c[known], days[known], color=color, marker="o", markersize=4, label=WORDS[device])
        panel.set(xscale="log", yscale="log", xlabel="characteristic acceleration [mm/s²]")
        panel.set_xticks([0.25, 0.5, 1, 2], ["0.25", "0.5", "1", "2"])
        panel.set_xticks([], minor=True)
        ticks = [t for t in (150, 200, 300, 500, 1000, 2000, 4000) if panel.get_ylim()[0] < t < panel.get_ylim()[1]]
        panel.set_yticks(ticks, [f"{t}" for t in ticks])
        panel.set_yticks([], minor=True)
        panel.set_title(f"to {target.capitalize()}")
    panels[0].set_ylabel("flight time [d]")
    panels[0].legend(loc="upper right")


def steering_laws(pen: Pen, pitches: Axes, errors: Axes, losses: Axes) -> None:
    """Optimal pitch over the primer angle; error and loss of flying simpler laws with a real film."""
    s = pen.style
    degrees = np.linspace(0, 180, 1801)
    angle = np.radians(degrees)
    for device, color in zip(("ideal", "jpl-2015", "electric-sail"), s.series, strict=False):
        best = optimal_pitch(angle, device)
        pitches.plot(degrees, np.where(best.on, np.degrees(best.pitch), np.nan), color=color, label=WORDS[device])
        off = degrees[~best.on]
        if len(off) and device == "jpl-2015":
            edge = np.degrees(best.pitch[best.on][-1])
            pitches.plot([off[0], off[0], 180], [edge, 90, 90], color=color, linestyle=DOTTED, linewidth=1.4)
    pitches.set(xlabel="angle of the primer from the Sun line [°]", ylabel="pitch [°]", xlim=(0, 180), ylim=(0, 95))
    pitches.set_xticks([0, 45, 90, 135, 180])
    pitches.legend(loc="upper left")
    pitches.set_title("the pitch of the most thrust; dotted: off")

    for name, color in zip(("jpl-2015", "jpl-1978"), s.series[1:3], strict=True):
        best = optimal_pitch(angle, name)
        analytic = analytic_pitch(angle, name)
        ideal = optimal_pitch(angle, "ideal").pitch
        on = best.on & analytic.on
        for pitch, line, word in ((ideal, DASHED, "ideal law"), (np.asarray(analytic), "-", "analytic law")):
            away = np.degrees(np.abs(pitch - best.pitch))
            errors.plot(degrees, np.where(on, np.maximum(away, 1e-5), np.nan), color=color, linestyle=line)
            loss = 1 - _along(FILMS[name], pitch, angle) / np.where(on, best.support, np.nan)
            losses.plot(degrees, np.maximum(loss, 1e-9), color=color, linestyle=line, label=f"{name.upper()}, {word}")
    ends = {"xlabel": "angle of the primer from the Sun line [°]", "xlim": (0, 150), "yscale": "log"}
    errors.set(ylabel="error of the pitch [°]", ylim=(1e-4, 20), **ends)
    errors.set_title("how far simpler laws are off")
    losses.set(ylabel="share of the thrust along the primer", ylim=(1e-9, 1), **ends)
    losses.legend(loc="upper left", fontsize=8.5)
    losses.set_title("and what that costs at the moment")
    for panel in (errors, losses):
        panel.set_xticks([0, 45, 90, 135])


def _along(film, pitch, angle):
    """Thrust along a primer as a share of the full one: (3.21)."""
    c = np.cos(pitch)
    along = c * film.b1 * np.cos(angle) + c * (film.b2 * c + film.b3) * np.cos(angle - pitch)
    return along / film.total


def films(pen: Pen, *panels: Axes) -> None:
    """Flight times at 1 mm/s2 with every film and E-sail model, one panel per target."""
    found = transfer_data.flight_times()
    for panel, target in zip(panels, TARGETS[:3], strict=True):
        days = []
        for device in COMPARED:
            rows = found[target, device]
            days.append(float(rows[np.isclose(rows[:, 0], 1.0), 1][0]))
        place = np.arange(len(COMPARED))[::-1]
        colors = [pen.device(kind_of(device)) for device in COMPARED]
        panel.barh(place, days, color=colors, height=0.62)
        for y, value in zip(place, days, strict=True):
            word = f"{value:.1f} d" if np.isfinite(value) else "none found"
            panel.text(np.nan_to_num(value), y, f" {word}", color=pen.style.ink, va="center", fontsize=9)
        panel.set_yticks(place, [WORDS[device] for device in COMPARED] if panel is panels[0] else [""] * len(place))
        panel.set(xlabel="flight time [d]", xlim=(0, 1.28 * np.nanmax(days)))
        panel.grid(visible=False, axis="y")
        panel.set_title(f"to {target.capitalize()}")


def kind_of(device: str) -> str:
    """What a device is called in the table of colours."""
    if device.startswith("electric"):
        return "electric sail"
    return "ideal film" if device == "ideal" else "real film"


def throttle(pen: Pen, path: Axes, share: Axes) -> None:
    """The fastest flight of an electric sail to Jupiter: where it flies, and its throttle over time, arc by arc."""
    run = simulate("transfers/earth-jupiter-electric-sail")
    place, days, value = run.position / AU, run.time / DAY, run.environment["throttle"]
    colors: dict[str, str] = {}
    for phase in run.setting.phases:
        color = colors.setdefault(phase.name, pen.style.series[len(colors)])
        inside = (run.time >= phase.start) & (run.time <= phase.end)
        path.plot(*place[inside, :2].T, color=color)
        own = inside & (run.time < phase.end) if phase is not run.setting.phases[-1] else inside
        share.plot(days[own], value[own], color=color)
        middle = 0.5 * (phase.start + phase.end) / DAY
        share.text(middle, 1.04, phase.name, color=color, ha="center", fontsize=9)
    turn = np.linspace(0, 2 * np.pi, 361)
    for radius in np.linalg.norm(place[[0, -1]], axis=1):
        path.plot(radius * np.cos(turn), radius * np.sin(turn), color=pen.style.ink, linestyle=DOTTED, linewidth=1.2)
    path.plot(0, 0, marker="o", color=pen.style.ink)
    path.set(xlabel="x [au]", ylabel="y [au]", aspect="equal")
    path.set_title("seen from the north of the ecliptic")
    share.set(xlabel="time [d]", ylabel="share of the full thrust", xlim=(0, days[-1]), ylim=(-0.03, 1.12))
    share.set_title("throttle")


def photonic_assist(pen: Pen, cells: Axes, curves: Axes) -> None:
    """Flight time out to a distance over lightness and perihelion limit, as a map and as curves, one per limit."""
    found = transfer_data.photonic_assists()
    betas, limits = np.unique(found[:, 0]), np.unique(found[:, 1])
    years = found[:, 2].reshape(len(betas), len(limits)).T * DAY / YEAR
    free = (found[:, 3] > 1.001 * found[:, 1]).reshape(len(betas), len(limits)).T
    edges = np.arange(len(betas) + 1), np.arange(len(limits) + 1)
    image = cells.pcolormesh(*edges, np.ma.masked_invalid(years), cmap=pen.ramp)
    pen.bar(cells, image, "years")
    for k, i in np.argwhere(np.isfinite(years)):
        words = f"{years[k, i]:.2f}" + ("*" if free[k, i] else "")
        pen.label(cells, i + 0.5, k + 0.5, words, fontsize=8.5)
    cells.set_xticks(np.arange(len(betas)) + 0.5, [f"{beta:g}" for beta in betas])
    cells.set_yticks(np.arange(len(limits)) + 0.5, [f"{limit:g}" for limit in limits])
    cells.grid(visible=False)
    cells.set(xlabel="lightness", ylabel="perihelion limit [au]")
    cells.set_title("years to 30 au; blank: not found by this search")
    for limit, row, color in zip(limits, years, pen.style.series, strict=False):
        curves.plot(betas, row, color=color, marker="o", markersize=4, label=f"{limit:g} au")
    curves.set(xlabel="lightness", ylabel="years to 30 au", yscale="log")
    ticks = [tick for tick in (2, 3, 4, 5, 6, 8, 10) if curves.get_ylim()[0] < tick < curves.get_ylim()[1]]
    curves.set_yticks(ticks, [f"{tick}" for tick in ticks])
    curves.set_yticks([], minor=True)
    curves.legend(loc="upper right", title="limit")
    curves.set_title("what a nearer pass saves")


def launch_window(pen: Pen, *panels: Axes) -> None:
    """Flight time over the date of departure, one panel per body."""
    for panel, (target, (dates, days)), color in zip(
        panels, transfer_data.launch_windows().items(), pen.style.series, strict=False
    ):
        panel.plot(dates, days, color=color, marker="o", markersize=3)
        later = (dates[None, :] - dates[:, None]) / np.timedelta64(1, "D")
        waited = np.nanmin(np.where(later >= 0, later + days[None, :], np.nan), axis=1)
        panel.plot(dates, waited, color=pen.style.ink, linestyle=DOTTED, linewidth=1.4, label="waiting included")
        best = int(np.nanargmin(days))
        panel.plot(dates[best], days[best], marker="o", color=pen.style.ink)
        words = f"{np.datetime_as_string(dates[best], 'D')}: {days[best]:.1f} d"
        panel.annotate(words, (dates[best], days[best]), (0, -14), textcoords="offset points", ha="center", fontsize=9)
        panel.set(ylabel="flight time [d]", xlabel="departure", ylim=(0.8 * days[best], 1.05 * np.nanmax(days)))
        panel.set_title(f"to {target.capitalize()}")
        panel.xaxis.set_major_locator(MonthLocator(bymonth=1))
        panel.xaxis.set_major_formatter(DateFormatter("%Y"))
    panels[0].legend(loc="lower left")
