"""When the thrust changes by jumps, and by how much: winds, sunshine, windows, tables, smoothed transfers."""

from __future__ import annotations

from functools import cache

import numpy as np
from independent.constants import AU, MU_SUN
from scipy import stats

from sailviz.design.minimum_time.smoothed import smoothed_transfer


def schedule(scene):
    """(breaks, factors): the thrust factor at nominal voltage is factors[i] from breaks[i] on."""
    duration, control = scene.propagation.duration, getattr(scene.device, "control", None)
    redrawn, draws = history(scene)
    active = scene.device.active
    kinks = [0.0, *redrawn, *(t for pair in active or [] for t in pair)]
    if getattr(control, "interval", None):
        kinks += list(np.arange(0, duration, control.interval))
    if scene.steering is not None and scene.steering.kind == "smoothed-transfer":
        kinks += list(smoothed(scene)[0])
    elif getattr(scene.steering, "interpolation", "cubic") != "cubic":
        kinks += scene.steering.time
    breaks = np.array(sorted({t for t in kinks if 0 <= t < duration}))
    on = np.array([active is None or any(a <= t < b for a, b in active) for t in breaks])
    return breaks, on * draws[np.searchsorted(redrawn, breaks, side="right") - 1]


def history(scene):
    """(times, thrust over nominal thrust from each on) of the scene's wind or sunshine at nominal voltage."""
    duration, wind, light = scene.propagation.duration, scene.environment.solar_wind, scene.environment.irradiance
    if light.kind == "cycle":
        times = np.arange(0, duration, light.redraw)
        random = np.random.Generator(np.random.PCG64(np.random.SeedSequence(light.seed, spawn_key=(3,))))
        noise = relaxing(random.standard_normal(len(times)), 0.80 ** (light.redraw / 86400))
        since = (np.datetime64(scene.epoch_utc, "s") - np.datetime64("1991-01-27T16")) / np.timedelta64(1, "s")
        turn = 2 * np.pi * (times + since) / (11.15 * 365.25 * 86400)
        share = 1 + light.amplitude * np.cos(turn) + light.flicker * noise
        if scene.device.control is not None:  # black takes half a mirror's push; the dimmest Sun is the reference
            black = np.minimum(2 / scene.device.control.fraction * (1 - share.min() / share), 1)
            share = share / share.min() * (1 - scene.device.control.fraction / 2 * black)
        return times, share
    if wind.kind == "steady":
        return np.zeros(1), np.ones(1)
    if wind.kind != "gamma":
        raise NotImplementedError(wind.kind)
    random = np.random.Generator(np.random.PCG64(wind.seed))
    times = np.zeros(1) if wind.variation == "constant" else np.arange(0, duration, wind.redraw)
    if wind.variation == "correlated":
        z = relaxing(random.standard_normal(len(times)), np.exp(-wind.redraw / wind.correlation_time))
        draws = stats.gamma(wind.shape, scale=wind.scale).ppf(stats.norm.cdf(z))
    else:
        draws = random.gamma(wind.shape, wind.scale, len(times))
    reference = {"mean": wind.shape * wind.scale}.get(wind.reference, wind.reference)
    return times, np.sqrt(draws / reference)


def relaxing(z, memory):
    """Independent normal numbers made into a chain that remembers."""
    for i in range(1, len(z)):
        z[i] = memory * z[i - 1] + np.sqrt(1 - memory**2) * z[i]
    return z


def smoothed(scene):
    """(times, pitch, throttle) of a smoothed transfer: the design's own table, whose arrival is tested with it."""
    s, r0 = scene.steering, scene.start.radius
    strength = scene.device.characteristic_acceleration * AU * r0 / MU_SUN
    clock = np.sqrt(r0**3 / MU_SUN)
    return shot(s.radius / r0, strength, tuple(s.costates), scene.propagation.duration, s.hold, s.width, clock)


@cache
def shot(ratio, strength, costates, duration, hold, width, clock):
    found = smoothed_transfer(ratio, strength, np.array(costates), duration / clock, hold / clock, width)
    return found.time * clock / len(found.pitch) * np.arange(len(found.pitch)), found.pitch, found.throttle
