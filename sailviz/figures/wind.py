"""Figures of the solar wind: laws fitted to a series of its pressure, and how chaos expansions converge."""

from __future__ import annotations

import numpy as np

from sailviz import steering
from sailviz.constants import AU, MU_SUN, YEAR
from sailviz.environment import solar_wind
from sailviz.propagate import dop853, dynamics
from sailviz.propagate.events import watch
from sailviz.propulsion.electric_sail import FINAL, PITCH_LIMIT
from sailviz.uncertainty import chaos, wind

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


def wind_fit(pen, density, rarity, memory, series=None):
    """Histogram with laws, how rare high pressures are, autocorrelation. series : file of a measured series, or None
    for a sample of the lognormal law."""
    s = pen.style
    if series is not None:
        data = wind.read_series(series)
        of_fit, pressure, step, measured = data, data.pressure, data.step, data.measured
        words = f"{series}: {measured.sum()} values of {step / HOUR:g} h; {data.repairs}"
        density.figure.supxlabel(words, fontsize=8.5, color=s.quiet)
    else:
        step = HOUR
        times = np.arange(0, SAMPLE_YEARS * YEAR, step)
        of_fit = pressure = wind.generate(LAW, times, SEED, "correlated")
        measured = np.ones(len(pressure), dtype=bool)
    fits = wind.fit(of_fit)
    known = np.sort(pressure[measured]) / NPA

    top = min(float(np.percentile(known, 99.5)), 15.0)
    p = np.linspace(top / 400, top, 400)
    density.hist(known, np.linspace(0, top, 61), density=True, color=s.quiet, alpha=0.35, rwidth=0.92)
    far = np.geomspace(known[len(known) // 10], 1.3 * known[-1], 300)
    rarity.step(known, 1 - np.arange(len(known)) / len(known), where="pre", color=s.quiet, linewidth=3.2, alpha=0.6)
    for (name, word), color in zip(SHOWN.items(), s.series, strict=False):
        fit = fits[name]
        label = f"{word}: KS {fit.ks:.3f}, AIC {fit.aic - fits[fits.best].aic:+,.0f}"
        density.plot(p, np.exp(fit.law.log_density(p * NPA)) * NPA, color=color, label=label)
        rarity.plot(far, 1 - fit.law.distribution(far * NPA), color=color)
    ends = {"xlabel": "dynamic pressure at 1 au [nPa]"}
    density.set(ylabel="probability density [1/nPa]", xlim=(0, top), **ends)
    mean, unbiased = (known.mean(), np.mean(np.sqrt(known)) ** 2)
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
    rate = solar_wind.CORRELATION_TIME / 86400
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
        steering=steering.ORBITAL,
        steering_parameters=(np.cos(np.radians(pitch)), np.sin(np.radians(pitch)), 0.0),
    )
    out = np.empty((len(pressure), 6, len(times)))
    for row, p in zip(out, pressure, strict=True):
        start = dop853.start(0.0, (AU, 0.0, 0.0), (0.0, np.sqrt(MU_SUN / AU), 0.0), 1.0)
        factor = np.array([np.sqrt(p / (SHAPE * SCALE))])
        dop853.advance(start, model, np.zeros(1), factor, watch([]), times, row, times[-1], 1e-12, np.inf)
    return np.linalg.norm(out[:, :3], axis=1) / AU


def gpc_convergence(pen, left, right):
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
            options = {"color": color, "linestyle": line, "linewidth": 1.6, "marker": "o", "markersize": 3.5}
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
    found = chaos.expand(lambda p: _distance(case, p, times), SHAPE, SCALE, 5)
    for path in found.values:
        right.plot(days, path, color=s.quiet, linewidth=0.9)
    low, middle, high = found.percentile([5, 50, 95])
    right.fill_between(days, low, high, color=s.series[0], alpha=0.18, linewidth=0, label="5 to 95 %")
    deviation = found.standard_deviation
    for edge in (found.mean - deviation, found.mean + deviation):
        right.plot(days, edge, color=s.series[1], linestyle=(0, (4, 2.5)), linewidth=1.4)
    right.plot(days, found.mean, color=s.series[1], label="mean, ± standard deviation")
    right.plot(days, middle, color=s.series[0], label="median")
    nominal = _distance(case, [SHAPE * SCALE], times)[0]
    right.plot(days, nominal, color=s.ink, linestyle=(0, (1, 2)), linewidth=1.4, label="at the mean pressure")
    right.plot([], [], color=s.quiet, linewidth=0.9, label="the six flights")
    right.set(xlabel="time [d]", ylabel="distance from the Sun [au]", xlim=(0, days[-1]))
    right.legend(loc="upper left")
    right.set_title("tube of the second from six flights")
