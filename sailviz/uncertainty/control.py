"""What voltage control and electrochromic area can hold, in closed form, and the power that an electron gun takes.

The compiled laws that a flight uses are in `propulsion.voltage_control`. The thesis' own formulae (7.3) could not be
read; all here is re-derived.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sailviz.constants import ELEMENTARY_CHARGE, MASS_ELECTRON, WIND_POTENTIAL


@dataclass(frozen=True)
class Saturation:
    """Pressure law in gamma wind. probability : share of time at the maximum voltage. mean_thrust, thrust_deviation :
    of the thrust factor. mean_voltage V. critical_pressure Pa : below it the voltage saturates. uncontrolled_thrust,
    uncontrolled_deviation : of the factor at the nominal voltage."""

    probability: np.ndarray
    mean_thrust: np.ndarray
    thrust_deviation: np.ndarray
    mean_voltage: np.ndarray
    critical_pressure: np.ndarray
    uncontrolled_thrust: np.ndarray
    uncontrolled_deviation: np.ndarray


def saturation(
    shape: npt.ArrayLike,
    scale: npt.ArrayLike,
    nominal_voltage: npt.ArrayLike,
    maximum_voltage: npt.ArrayLike,
    wind_potential: npt.ArrayLike = WIND_POTENTIAL,
    reference_pressure: npt.ArrayLike | None = None,
) -> Saturation:
    """Statistics of V = Vw + (Vn - Vw) sqrt(p_ref / p), at most V_max, and of the thrust factor it leaves.

    shape -, scale Pa : of the gamma law; voltages V; reference_pressure Pa, the mean if None; scalars or arrays,
    broadcast. The voltage follows the pressure without delay or dead band. Exact; mean_voltage needs a shape above 1/2.
    """
    from scipy.special import gammainc, gammaincc, gammaln

    k, theta = np.asarray(shape, dtype=float), np.asarray(scale, dtype=float)
    p_ref = k * theta if reference_pressure is None else np.asarray(reference_pressure, dtype=float)
    vn, vmax, vw = (np.asarray(v, dtype=float) for v in (nominal_voltage, maximum_voltage, wind_potential))
    if np.any(k <= 0.5) or np.any(theta <= 0) or np.any(p_ref <= 0):
        raise ValueError("the shape must exceed 1/2, scale and reference pressure must be positive")
    if np.any(vw >= vn) or np.any(vn > vmax) or np.any(vw < 0):
        raise ValueError("voltages must rise from the wind's potential over the nominal voltage to the maximum")
    c = (vmax - vw) / (vn - vw)  # largest thrust factor at p_ref
    critical = p_ref / c**2
    x = critical / theta
    up, down = np.exp(gammaln(k + 0.5) - gammaln(k)), np.exp(gammaln(k - 0.5) - gammaln(k))  # E sqrt x, E 1 / sqrt x
    ratio = theta / p_ref
    probability = gammainc(k, x)
    mean = c * np.sqrt(ratio) * up * gammainc(k + 0.5, x) + gammaincc(k, x)
    square = c**2 * ratio * k * gammainc(k + 1, x) + gammaincc(k, x)
    volts = vw + (vn - vw) * (down / np.sqrt(ratio) * gammaincc(k - 0.5, x) + c * probability)
    free = np.sqrt(ratio) * up
    parts = (
        probability,
        mean,
        np.sqrt(np.maximum(square - mean**2, 0)),
        volts,
        critical,
        free,
        np.sqrt(ratio * (k - up**2)),
    )
    return Saturation(*(part[()] for part in np.broadcast_arrays(*parts)))


def gun_current_per_length(voltage: npt.ArrayLike, density: npt.ArrayLike, wire_radius: npt.ArrayLike) -> np.ndarray:
    """Electrons that a thin wire collects (orbital motion limited), A/m: 2 r_w e n sqrt(2 e V / m_e).

    voltage V, density of the wind's electrons 1/m3, wire_radius m; broadcast. Several wires side by side collect their
    sum.
    """
    speed = np.sqrt(2 * ELEMENTARY_CHARGE * np.asarray(voltage, dtype=float) / MASS_ELECTRON)
    width, density = 2 * np.asarray(wire_radius, dtype=float), np.asarray(density, dtype=float)
    return width * ELEMENTARY_CHARGE * density * speed


def gun_power(
    voltage: npt.ArrayLike, density: npt.ArrayLike, wire_radius: npt.ArrayLike, length: npt.ArrayLike
) -> np.ndarray:
    """Power, W, of the electron gun that keeps tethers of a total wire length, m, at a voltage: V I = K n V^1.5."""
    return np.multiply(voltage, length) * gun_current_per_length(voltage, density, wire_radius)


def gun_strength(power: npt.ArrayLike, wire_radius: npt.ArrayLike, length: npt.ArrayLike) -> np.ndarray:
    """power / K, V^1.5/m3: POWER in a row of `propulsion.voltage_control`. power W.

    The gun reaches V_P = (power / (K n))^(2/3), the same at every distance from the Sun when panels feed it, since
    density and power fall alike.
    """
    return np.asarray(power, dtype=float) / gun_power(1.0, 1.0, wire_radius, length)


def largest_voltage(
    power: npt.ArrayLike, density: npt.ArrayLike, wire_radius: npt.ArrayLike, length: npt.ArrayLike
) -> np.ndarray:
    """Voltage, V, at which the gun's power, W, is spent; other arguments as of `gun_power`; broadcast."""
    return (gun_strength(power, wire_radius, length) / np.asarray(density, dtype=float)) ** (2 / 3)


def electrochromic_fraction(smallest: npt.ArrayLike, largest: npt.ArrayLike) -> np.ndarray:
    """Share of a Sun-facing sail's area that must be able to turn from mirror to black so that irradiances between
    smallest and largest (one unit) all push like the smallest: 2 (1 - S_min / S_max)."""
    smallest, largest = np.asarray(smallest, dtype=float), np.asarray(largest, dtype=float)
    if np.any(smallest <= 0) or np.any(smallest > largest):
        raise ValueError("irradiances must be positive, the smallest not above the largest")
    return 2 * (1 - smallest / largest)


def electrochromic_state(irradiance: npt.ArrayLike, fraction: npt.ArrayLike, smallest: npt.ArrayLike) -> np.ndarray:
    """How reflective the electrochromic area is, 0 black to 1 mirror, to hold the thrust at that of the smallest
    irradiance: s = 1 - (2 / f) (1 - S_min / S), bounded. A flight that uses it takes S_min as its S0."""
    missing = 1 - np.divide(smallest, irradiance)
    return np.clip(1 - np.divide(2.0, fraction) * missing, 0.0, 1.0)


def electrochromic_factor(state: npt.ArrayLike, fraction: npt.ArrayLike) -> np.ndarray:
    """Thrust over that of the all-mirror sail: 1 - (f / 2) (1 - s), as black takes half of a mirror's push."""
    return 1 - 0.5 * np.asarray(fraction) * (1 - np.asarray(state))
