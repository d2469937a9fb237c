"""Voltage control of an electric sail: what the craft sets, and what thrust the wind then gives.

Compiled, scalars in and out, so that single runs and ensembles share it. A law is one flat row of numbers, built
by `row`. A law acts at the start of every INTERVAL; in between the caller holds the voltage. Source: the two strategies
that the thesis' contents name (7.3.1 dynamic pressure, 7.3.2 heliocentric distance); the formulae are re-derived.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import entry, inlined
from sailviz.constants import DAY, MU_SUN, WIND_POTENTIAL, WIND_PRESSURE

CONSTANT, PRESSURE, DISTANCE, CONSTANT_POWER = range(4)
LAWS = {
    "constant": CONSTANT,
    "pressure": PRESSURE,
    "distance": DISTANCE,
    "constant-power": CONSTANT_POWER,
}

# The parameter row: who reads which place
KIND, NOMINAL, MINIMUM, MAXIMUM, WIND, P_REF = 0, 1, 2, 3, 4, 5  # law, V, V, V, V of the wind's ions, Pa
INTERVAL, DEAD_BAND = 6, 7  # s, V
KP, KD, MU = 8, 9, 10  # gains of the distance law; mu in the units of its r and u
POWER = 11  # gun power over its constant, V^1.5/m3: V_P = (POWER / n)^(2/3); 0 sets no limit
SIZE = 12


def row(
    kind: str = "constant",
    *,
    nominal_voltage: float = 20e3,
    maximum_voltage: float = 40e3,
    minimum_voltage: float = 0.0,
    wind_potential: float = WIND_POTENTIAL,
    reference_pressure: float = WIND_PRESSURE,
    interval: float | None = None,
    dead_band: float = 0.0,
    position_gain: float = 0.0,
    speed_gain: float = 0.0,
    mu: float = MU_SUN,
    power: float = 0.0,
) -> np.ndarray:
    """The parameter row (SIZE,) of a law: "constant", "pressure", "distance" or "constant-power".

    Voltages and dead_band V; reference_pressure Pa, where the nominal voltage gives the nominal thrust; interval s
    between updates (a day for the distance law, else an hour); position_gain and speed_gain dimensionless; mu in the
    units in which the law gets r and u; power V^1.5/m3, see `power_limit` (0: no limit). ValueError for what cannot be.
    """
    if kind not in LAWS:
        raise ValueError(f"a voltage law is one of {', '.join(LAWS)}, not {kind!r}")
    if interval is None:
        interval = DAY if kind == "distance" else 3600.0
    if not 0 <= wind_potential < nominal_voltage <= maximum_voltage:
        raise ValueError(
            f"voltages must rise from the wind's potential ({wind_potential:g} V) over the nominal voltage "
            f"({nominal_voltage:g} V) to the maximum ({maximum_voltage:g} V)"
        )
    if not 0 <= minimum_voltage <= nominal_voltage:
        raise ValueError(f"the minimum voltage must lie between 0 and the nominal, not at {minimum_voltage:g} V")
    if kind == "constant-power" and not power > 0:
        raise ValueError("a gun at constant power needs a power above 0")
    for name, value in (("reference pressure", reference_pressure), ("interval", interval), ("mu", mu)):
        if not value > 0:
            raise ValueError(f"the {name} must be positive, not {value:g}")
    if dead_band < 0 or power < 0:
        raise ValueError(f"dead band ({dead_band:g} V) and power ({power:g}) must not be negative")
    c = np.zeros(SIZE)
    c[KIND], c[NOMINAL], c[MINIMUM], c[MAXIMUM] = LAWS[kind], nominal_voltage, minimum_voltage, maximum_voltage
    c[WIND], c[P_REF], c[INTERVAL], c[DEAD_BAND] = wind_potential, reference_pressure, interval, dead_band
    c[KP], c[KD], c[MU], c[POWER] = position_gain, speed_gain, mu, power
    return c


@inlined
def pressure_law(pressure, c):
    """Voltage that keeps the thrust nominal at a dynamic pressure (1 au, same unit as P_REF); no bounds."""
    return c[WIND] + (c[NOMINAL] - c[WIND]) * np.sqrt(c[P_REF] / pressure)


@inlined
def distance_law(r, u, r_ref, u_ref, c):
    """Voltage that leads distance r and radial speed u back to r_ref and u_ref; the speed counts against the circular
    speed at r_ref. No bounds. At rest on a heliostationary point stable if and only if KP > 1, damped by KD."""
    gain = c[KP] * (r_ref - r) / r_ref + c[KD] * (u_ref - u) * np.sqrt(r_ref / c[MU])
    return c[WIND] + (c[NOMINAL] - c[WIND]) * (1.0 + gain)


@inlined
def power_limit(density, c):
    """Largest voltage that the gun's power allows: P = K n V^1.5, V_P = (POWER / n)^(2/3).

    density : electrons per m3 at 1 au; with solar panels both it and the power fall as 1/r2, and V_P stays.
    """
    return (c[POWER] / density) ** (2.0 / 3.0)


@inlined
def voltage(held, pressure, density, r, u, r_ref, u_ref, c):
    """Voltage from now until the next update. Call it at the start of every interval.

    held : V so far, NaN at the start. The dead band compares what is held with what the bounds leave of the law's
    wish; the power limit stands over all.
    """
    kind = c[KIND]
    wish = c[NOMINAL]
    if kind == PRESSURE:
        wish = pressure_law(pressure, c)
    elif kind == DISTANCE:
        wish = distance_law(r, u, r_ref, u_ref, c)
    elif kind == CONSTANT_POWER:
        wish = power_limit(density, c)
    wish = min(max(wish, c[MINIMUM]), c[MAXIMUM])
    if c[POWER] > 0.0:
        limit = power_limit(density, c)
        wish = min(wish, limit)
        if held > limit:
            held = limit
    if abs(wish - held) <= c[DEAD_BAND]:  # false for NaN
        return held
    return wish


@inlined
def thrust_factor(voltage, pressure, wind_potential, c):
    """Thrust over nominal: max(0, V - Vw) / (Vn - Vw0) sqrt(p / p_ref), from (3.41).

    wind_potential : V, of the wind that blows now; c[WIND] if that does not vary.
    """
    return max(0.0, voltage - wind_potential) / (c[NOMINAL] - c[WIND]) * np.sqrt(pressure / c[P_REF])


def histories(duration, pressure, density, wind_potential, c):
    """Voltages and thrust factors (n,) of equal steps of `duration` s for laws that see only the wind.

    pressure Pa, density 1/m3, wind_potential V: (n,) each; a step's value holds throughout it. An update finds the
    values of the same step, without latency. The distance law needs the flight and belongs in the propagator.
    """
    volts, factors = np.empty(len(pressure)), np.empty(len(pressure))
    _histories(duration, pressure, density, wind_potential, c, volts, factors)
    return volts, factors


@entry("d d1 d1 d1 d1 D1 D1")
def _histories(duration, pressure, density, wind_potential, c, volts, factors):
    """`histories` without its arrays made."""
    every = max(1, round(c[INTERVAL] / duration))
    held = np.nan
    for i in range(len(pressure)):
        if i % every == 0:
            held = voltage(held, pressure[i], density[i], 1.0, 0.0, 1.0, 0.0, c)
        volts[i] = held
        factors[i] = thrust_factor(held, pressure[i], wind_potential[i], c)
    return 0
