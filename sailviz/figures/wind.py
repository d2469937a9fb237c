"""Figures of the solar wind: laws fitted to a series of its pressure, and how chaos expansions converge."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz.constants import AU, DAY, GRAVITY_AT_1_AU, MU_SUN, YEAR
from sailviz.design.minimum_time.smoothed import smoothed_transfer
from sailviz.environment.solar_wind.laws import Gamma
from sailviz.environment.solar_wind.pressure import CORRELATION_TIME
from sailviz.propagate import dop853, dynamics
from sailviz.propagate.events import watch
from sailviz.propulsion import voltage_control
from sailviz.propulsion.electric_sail import FINAL, PITCH_LIMIT
from sailviz.steering import attitude
from sailviz.uncertainty import chaos, wind
from sailviz.uncertainty.covariance import linear
from sailviz.uncertainty.ensembles import RandomWind, fly_ensemble, fly_factors

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes

    from sailviz.figures.page import Pen

NPA, HOUR = 1e-9, 3600.0
LAW = wind.named("lognormal", sigma=0.6144, scale=np.exp(0.4984) * NPA)  # fitted to OMNI2, 1998-2018
SAMPLE_YEARS, SEED = 5, 2018
SHOWN = {"burr": "Burr XII", "lognormal": "lognormal", "gamma": "gamma"}

SHAPE, SCALE = 2.6, 0.77e-9  # of the gamma law that the expansions are tested with
CASES = {  # a_c mm/s2, pitch deg, years
    "0.5 mm/s², 45°, 1 yr": (0.5, 45.0, 1.0),
    "1 mm/s², 45°, 1 yr": (1.0, 45.0, 1.0),
    "1 mm/s², 45°, 2 yr": (1.0, 45.0, 2.0),
}


def wind_fit(pen: Pen, density: Axes, rarity: Axes, memory: Axes, series: str | Path | None = None) -> None:
    """Histogram with laws, how rare high pressures are, autocorrelation. series : file of a measured series, or None
    for a sample of the lognormal law."""
    s = pen.style
    if series is not None:
        data = wind.read_series(series)
        fits, pressure, step, measured = wind.fit(data), data.pressure, data.step, data.measured
        words = f"{series}: {measured.sum()} values of {step / HOUR:g} h; {data.repairs}"
        density.figure.supxlabel(words, fontsize=8.5, color=s.quiet)
    else:
        step = HOUR
        times = np.arange(0, SAMPLE_YEARS * YEAR, step)
        pressure = wind.generate(LAW, times, SEED, "correlated")
        fits, measured = wind.fit(pressure), np.ones(len(pressure), dtype=bool)
    known = np.sort(pressure[measured]) / NPA

    top = min(float(np.percentile(known, 99.5)), 15.0)
    p = np.linspace(top / 400, top, 400)
    density.hist(known, np.linspace(0, top, 61).tolist(), density=True, color=s.quiet, alpha=0.35, rwidth=0.92)
    far = np.geomspace(known[len(known) // 10], 1.3 * known[-1], 300)
    rarity.step(known, 1 - np.arange(len(known)) / len(known), where="pre", color=s.quiet, linewidth=3.2, alpha=0.6)
    for (name, word), color in zip(SHOWN.items(), s.series, strict=False):
        fit = fits[name]
        label = f"{word}: KS {fit.ks:.3f}, AIC {fit.aic - fits[fits.best].aic:+,.0f}"
        density.plot(p, np.exp(fit.law.log_density(p * NPA)) * NPA, color=color, label=label)
        rarity.plot(far, 1 - fit.law.distribution(far * NPA), color=color)
    ends = {"xlabel": "dynamic pressure at 1 au [nPa]"}
    density.set(ylabel="probability density [1/nPa]", xlim=(0, top), **ends)
    mean, unbiased = float(known.mean()), float(np.mean(np.sqrt(known)) ** 2)
    density.axvline(mean, color=s.ink, linewidth=0.9)
    density.axvline(unbiased, color=s.ink, linewidth=0.9, linestyle=(0, (4, 2.5)))
    density.plot([], [], color=s.ink, linewidth=0.9, label=f"mean, {mean:.3f} nPa")
    dash = (0, (4, 2.5))
    density.plot([], [], color=s.ink, linewidth=0.9, linestyle=dash, label=f"of the mean thrust, {unbiased:.3f} nPa")
    density.legend(loc="upper right")
    density.set_title("laws of the greatest likelihood" if series is not None else "a seeded sample, not measured")
    rarity.set(xscale="log", yscale="log", ylabel="share of time above", ylim=(0.5 / len(known), 1.5), **ends)
    rarity.set_xlim(far[0], far[-1])
    rarity.set_title("how rare high pressures are")

    ahead = np.unique(np.round(np.geomspace(1, 27 * 24, 60) * HOUR / step).astype(int))
    ahead = ahead[(ahead >= 1) & (ahead < len(pressure) // 4)]
    days = ahead * step / 86400
    shown = np.where(measured, pressure, np.nan)
    for function, word, color in ((np.log, "ln p", s.series[0]), (np.sqrt, "√p", s.series[1])):
        memory.plot(days, wind.autocorrelation(function(shown), ahead), color=color, label=word)
    rate = CORRELATION_TIME / 86400
    memory.plot(days, np.exp(-days / rate), color=s.ink, linestyle=(0, (1, 2)), linewidth=1.4, label="exp(−t / 17 h)")
    memory.axhline(np.exp(-1), color=s.quiet, linewidth=0.8)
    memory.set(xscale="log", xlabel="apart [d]", ylabel="autocorrelation", ylim=(-0.15, 1.02))
    memory.set_xlim(days[0], days[-1])
    memory.set_title("how long the wind is remembered; grey: 1/e")
    memory.legend(loc="upper right")


def _distance(case, pressure, times):
    """Distance from the Sun, au (m, n), of an E-sail that left the Earth's orbit, one row per pressure in Pa."""
    a_c, pitch, _ = case
    model = dynamics.model(
        MU_SUN,
        device=dynamics.ELECTRIC_SAIL,
        device_parameters=(a_c * 1e-3, FINAL, PITCH_LIMIT),
        steering=attitude.ORBITAL,
        steering_parameters=(np.cos(np.radians(pitch)), np.sin(np.radians(pitch)), 0.0),
    )
    out = np.empty((len(pressure), 6, len(times)))
    for row, p in zip(out, pressure, strict=True):
        start = dop853.start(0.0, (AU, 0.0, 0.0), (0.0, np.sqrt(MU_SUN / AU), 0.0), 1.0)
        factor = np.array([np.sqrt(p / (SHAPE * SCALE))])
        dop853.advance(start, model, np.zeros(1), factor, watch([]), times, row, times[-1], 1e-12, np.inf)
    return np.linalg.norm(out[:, :3], axis=1) / AU


def gpc_convergence(pen: Pen, left: Axes, right: Axes) -> None:
    """Error of the standard deviation over the number of flights, two bases; a tube from six flights."""
    s = pen.style
    orders = (1, 2, 3, 4, 5, 6, 8, 10, 12)
    for (word, case), color in zip(CASES.items(), s.series, strict=False):
        end = np.array([0.0, case[2] * YEAR])

        def distance(p, case=case, end=end):
            return _distance(case, p, end)[:, -1]

        best = chaos.expand(distance, SHAPE, SCALE, 30).standard_deviation
        for basis, line in (("root", "-"), ("laguerre", (0, (4, 2.5)))):
            found = chaos.convergence(distance, SHAPE, SCALE, orders, basis)
            options: dict[str, Any] = {
                "color": color,
                "linestyle": line,
                "linewidth": 1.6,
                "marker": "o",
                "markersize": 3.5,
            }
            left.plot(found.orders + 1, np.maximum(found.error(best), 1e-13), **options)
        left.plot([], [], color=color, label=word)
    left.axhline(1 / np.sqrt(2 * 1e5), color=s.ink, linewidth=0.9)
    left.text(13.2, 1.25 / np.sqrt(2e5), "100 000 drawn flights", color=s.ink, fontsize=9, ha="right", va="bottom")
    left.plot([], [], color=s.ink, label="polynomials in √p")
    left.plot([], [], color=s.ink, linestyle=(0, (4, 2.5)), label="polynomials in p")
    left.set(yscale="log", xlabel="flights", ylabel="relative error of the standard deviation of r", ylim=(1e-12, 3))
    left.set_xticks([2, 4, 6, 8, 10, 12], ["2", "4", "6", "8", "10", "12"])
    left.legend(loc="lower left", ncols=1, fontsize=8.5)
    left.set_title("distance at the end of three flights")

    case = CASES["1 mm/s², 45°, 1 yr"]
    times = np.linspace(0, case[2] * YEAR, 200)
    days = times / 86400
    series = chaos.expand(lambda p: _distance(case, p, times), SHAPE, SCALE, 5)
    for path in series.values:
        right.plot(days, path, color=s.quiet, linewidth=0.9)
    low, middle, high = series.percentile([5, 50, 95])
    right.fill_between(days, low, high, color=s.series[0], alpha=0.18, linewidth=0, label="5 to 95 %")
    deviation = series.standard_deviation
    for edge in (series.mean - deviation, series.mean + deviation):
        right.plot(days, edge, color=s.series[1], linestyle=(0, (4, 2.5)), linewidth=1.4)
    right.plot(days, series.mean, color=s.series[1], label="mean, ± standard deviation")
    right.plot(days, middle, color=s.series[0], label="median")
    nominal = _distance(case, [SHAPE * SCALE], times)[0]
    right.plot(days, nominal, color=s.ink, linestyle=(0, (1, 2)), linewidth=1.4, label="at the mean pressure")
    right.plot([], [], color=s.quiet, linewidth=0.9, label="the six flights")
    right.set(xlabel="time [d]", ylabel="distance from the Sun [au]", xlim=(0, days[-1]))
    right.legend(loc="upper left")
    right.set_title("tube of the second from six flights")


MARS = 1.523679, (0.6835, 0.2181, 0.6966), 8.98  # au; costates and time from which the shooting begins
HOURLY = Gamma(2.593, 0.7793e-9)  # of OMNI2, 1998-2018
FLIGHTS = 1000
CONTROLS: dict[str, dict[str, Any]] = {
    "constant voltage": {},
    "pressure law, 40 kV": {"kind": "pressure"},
    "distance law, 40 kV": {"kind": "distance", "position_gain": 100.0, "speed_gain": 50.0},
}


def arrival_dispersion(pen: Pen, scatter: Axes, bars: Axes) -> None:
    """Where flights to Mars end with and without voltage control; Monte Carlo against linear covariance."""
    s, tu = pen.style, np.sqrt(AU**3 / MU_SUN)
    transfer = smoothed_transfer(MARS[0], 1e-3 / GRAVITY_AT_1_AU, MARS[1], MARS[2], HOUR / tu)
    steps, duration = len(transfer.pitch), transfer.time * tu
    times = duration / steps * np.arange(steps)
    table = attitude.table(times, transfer.pitch, np.full(steps, np.pi / 2), transfer.throttle, "hold")
    start = (AU, 0.0, 0.0), (0.0, np.sqrt(MU_SUN / AU), 0.0), duration
    turn = np.linspace(0, 2 * np.pi, 181)
    spreads = []
    for (word, control), color in zip(CONTROLS.items(), (s.series[1], s.series[2], s.series[3]), strict=True):
        row = voltage_control.row(reference_pressure=HOURLY.mean, **control)
        gusts = RandomWind(HOURLY, "redrawn", DAY)
        found = fly_ensemble(
            *start, wind=gusts, control=row, flights=FLIGHTS, seed=2018, table=table, outputs=2, keep=0
        )
        off = found.miss[:, [1, 0, 3, 4]] / [np.pi / 180, AU / 1000, 1e3, 1e3]
        spreads.append(off)
        scatter.plot(off[:, 0], off[:, 1], ".", markersize=2.5, color=color, alpha=0.55, markeredgewidth=0)
        middle, spread = off[:, :2].mean(axis=0), np.linalg.cholesky(np.cov(off[:, :2].T))
        for sigma in (1, 2, 3):
            ring = middle[:, None] + sigma * spread @ np.stack([np.cos(turn), np.sin(turn)])
            scatter.plot(*ring, color=color, linewidth=1.1, alpha=1.15 - 0.25 * sigma)
        mean, deviation = off[:, 1].mean(), off[:, 1].std(ddof=1)
        scatter.plot([], [], "o", color=color, label=f"{word}: r {mean:+.1f} ± {deviation:.1f}")
    scatter.plot([0], [0], "+", color=s.ink, markersize=12, markeredgewidth=1.6, label="nominal")
    scatter.set(xlabel="ahead of the nominal flight [deg]", ylabel="farther out than nominal [10⁻³ au]")
    scatter.legend(loc="upper right")
    scatter.set_title(f"{FLIGHTS} flights each, with 1, 2 and 3 σ")

    intervals = int(np.ceil(duration / DAY))
    share = HOURLY.reference_pressure(True) / HOURLY.mean  # (E sqrt p)^2 / E p
    mean, deviation = np.sqrt(share), np.sqrt(1 - share)
    ends = linear(lambda f: fly_factors(f, DAY, *start, table=table)[:, [1, 0, 3, 4]], intervals, mean, deviation)
    expected = ends.standard_deviation / [np.pi / 180, AU / 1000, 1e3, 1e3]
    drawn = spreads[0].std(axis=0, ddof=1)
    names = ("azimuth\n[deg]", "distance\n[10⁻³ au]", "speed out\n[km/s]", "speed across\n[km/s]")
    place = np.arange(4)
    ratio = drawn / expected
    bars.bar(place - 0.2, np.ones(4), 0.36, color=s.series[0], label="linear covariance")
    bars.bar(place + 0.2, ratio, 0.36, color=s.series[1], label=f"{FLIGHTS} flights, ± 2 standard errors")
    error = 2 * ratio / np.sqrt(2 * (FLIGHTS - 1))
    bars.errorbar(place + 0.2, ratio, error, fmt="none", ecolor=s.ink, elinewidth=1.2, capsize=4)
    for k in range(4):
        pen.label(bars, place[k] - 0.2, 0.5, f"{expected[k]:.3g}")
        pen.label(bars, place[k] + 0.2, 0.5, f"{drawn[k]:.3g}")
    bars.set_xticks(place, names)
    bars.set(ylabel="standard deviation over the linear one", ylim=(0, 1.45))
    bars.legend(loc="upper center", ncols=2)
    bars.set_title("constant voltage: spread from sensitivities and from flights")
