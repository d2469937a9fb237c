"""Drag per length of tether over altitude, as the quasi-circular decay needs it: shapes, fits and the shipped tables.

Altitudes are above a sphere of the equatorial radius. Tables: orbit averages of the force law over IRI-2020 at -1 kV,
effective wire radius 1 mm, circular speed, no co-rotation; see assets/README.md.
"""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import numpy.typing as npt

from sailviz.constants import ATOMIC_MASS, MU_EARTH, RADIUS_EARTH
from sailviz.environment import ionosphere
from sailviz.propulsion.plasma_brake import force_per_length
from sailviz.shipped import shipped_folder

LEVELS = ionosphere.LEVELS  # solar level -> F10.7 in solar flux units
INCLINATIONS = (97.8, 51.6)  # deg, of the shipped orbit averages
BAND = (0.5, 1.0, 2.0)  # plasma density over the model's: topside models differ by this much and, near maximum, more
POLAR = np.radians(INCLINATIONS[0])
REFERENCE = 700e3  # m, altitude at which the fitted shapes are anchored

# d ln f / d ln n, d ln f / d ln V, d ln f / d ln v at 3e10 / m3, O+, 1 kV, 7.5 km/s: what a shape follows that has lost
# the plasma behind it
DENSITY_EXPONENT, VOLTAGE_EXPONENT, SPEED_EXPONENT = 0.537, 0.497, 1.933


@dataclass(frozen=True)
class Plasma:
    """What a table was made of, at altitudes in m: effective density 1/m3 (with the mean ion mass it gives the averaged
    force), mean ion mass kg, voltage V (absolute), wire radius m."""

    altitude: np.ndarray
    density: np.ndarray
    ion_mass: np.ndarray
    voltage: float = 1000.0
    wire_radius: float = 1e-3

    def force(self) -> np.ndarray:
        """Force per length at its altitudes, N/m, at circular speed."""
        speed = np.sqrt(MU_EARTH / (RADIUS_EARTH + self.altitude))
        return force_per_length(self.density, self.ion_mass, speed, self.voltage, self.wire_radius)


@dataclass(frozen=True)
class ForceProfile:
    """profile(altitude in m) -> force per length of tether in N/m, same shape.

    label : in words. law : the function. knots : altitudes in m between which it is smooth. lowest, highest : m, the
    range it was made for. plasma : what stands behind it, if that is known.
    """

    label: str
    law: Callable[[np.ndarray], np.ndarray]
    knots: tuple[float, ...] = ()
    lowest: float = -np.inf
    highest: float = np.inf
    plasma: Plasma | None = None

    def __call__(self, altitude: npt.ArrayLike) -> np.ndarray:
        return self.law(np.asarray(altitude, dtype=float))

    def scaled(self, factor: float, label: str | None = None) -> ForceProfile:
        """The same profile times a factor."""
        return replace(self, label=label or f"{self.label}, times {factor:g}", law=lambda h: factor * self.law(h))

    def extended(self) -> ForceProfile:
        """The same profile without its limits: a table holds its end values there, a shape goes on."""
        return replace(self, lowest=-np.inf, highest=np.inf)

    def with_density(self, factor: float) -> ForceProfile:
        """For a plasma density times `factor`: by the force law where the plasma is known, else factor^0.537."""
        label = f"{self.label}, density times {factor:g}"
        if self.plasma is None:
            return self.scaled(factor**DENSITY_EXPONENT, label)
        return self._rescaled(replace(self.plasma, density=factor * self.plasma.density), label)

    def with_voltage(self, voltage: float, wire_radius: float | None = None) -> ForceProfile:
        """For another voltage in V (absolute) and wire radius in m: f goes with sqrt(Vt) exp(-Vi / Vt), evaluated with
        the plasma behind the table; without one (V / 1 kV)^0.497, and the wire radius cannot change."""
        label = f"{self.label}, {voltage:g} V"
        if self.plasma is None:
            if wire_radius is not None:
                raise ValueError(f"{self.label}: how the force depends on the wire's radius is not known here")
            return self.scaled((voltage / 1000.0) ** VOLTAGE_EXPONENT, label)
        radius = self.plasma.wire_radius if wire_radius is None else wire_radius
        return self._rescaled(replace(self.plasma, voltage=voltage, wire_radius=radius), label)

    def _rescaled(self, plasma: Plasma, label: str) -> ForceProfile:
        if self.plasma is None:
            raise ValueError(f"{self.label}: the plasma behind it is not known")
        ratio = np.log(plasma.force() / self.plasma.force())
        altitude = plasma.altitude
        return replace(
            self, label=label, plasma=plasma, law=lambda h: self.law(h) * np.exp(np.interp(h, altitude, ratio))
        )


def constant(force: float) -> ForceProfile:
    """The same force per length, N/m, at every altitude."""
    return ForceProfile("constant force", lambda h: np.full_like(h, force))


def exponential(f700: float, scale_height: float) -> ForceProfile:
    """f700 exp(-(h - 700 km) / H), f700 in N/m, H in m."""
    return ForceProfile("exponential", lambda h: f700 * np.exp((REFERENCE - h) / scale_height))


def power_law(f700: float, exponent: float) -> ForceProfile:
    """f700 (h / 700 km)^p, f700 in N/m."""
    return ForceProfile("power law", lambda h: f700 * (h / REFERENCE) ** exponent)


def log_quadratic(q0: float, q1: float, q2: float) -> ForceProfile:
    """ln f = q0 + q1 x + q2 x^2 with f in N/m and x = h - 700 km in m: the analytical model that fits every level."""
    return ForceProfile("log-quadratic", lambda h: np.exp(q0 + (h - REFERENCE) * (q1 + (h - REFERENCE) * q2)))


def tabulated(
    altitude: npt.ArrayLike, force: npt.ArrayLike, label: str = "table", plasma: Plasma | None = None
) -> ForceProfile:
    """From forces per length in N/m at altitudes (k,) in m, rising: ln f linear between them, held outside."""
    altitude, force = np.asarray(altitude, dtype=float), np.asarray(force, dtype=float)
    if altitude.ndim != 1 or altitude.shape != force.shape or len(altitude) < 2 or np.any(np.diff(altitude) <= 0):
        raise ValueError("a force profile takes at least two rising altitudes and as many forces")
    if not np.all(force > 0):
        raise ValueError("the forces of a profile must be positive: between the altitudes their logarithm is linear")
    log = np.log(force)
    return ForceProfile(
        label, lambda h: np.exp(np.interp(h, altitude, log)), tuple(altitude), altitude[0], altitude[-1], plasma
    )


@cache
def _shipped_columns():
    path = shipped_folder("assets") / "plasma_brake_profiles.csv"
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    return dict(zip(rows[0], np.array(rows[1:], dtype=float).T, strict=True))


def shipped_profile(level: str = "min2019", inclination: float = POLAR) -> ForceProfile:
    """The shipped orbit average, 200-1500 km every 25 km. level : "min2019", "mid2014", "max2001". inclination : rad,
    within 2 deg of 97.8 or 51.6 deg or of their supplements, which cover the same latitudes.

    Averaged over local time, longitude, two seasons and the latitudes of the orbit (the force, not the density).
    """
    if level not in LEVELS:
        raise ValueError(f"there is no solar level {level!r}, only {', '.join(LEVELS)}")
    folded = np.degrees(np.arcsin(np.sin(inclination)))
    near = [i for i in INCLINATIONS if abs(folded - np.degrees(np.arcsin(np.sin(np.radians(i))))) <= 2]
    if not near:
        raise ValueError(
            f"the shipped profiles are averages over orbits of {' and '.join(f'{i:g}' for i in INCLINATIONS)} deg, not "
            f"{np.degrees(inclination):g}: average the ionosphere table instead (averaged_profile)"
        )
    columns, stem = _shipped_columns(), f"{level}_{near[0]:g}_"
    altitude = 1e3 * columns["alt_km"]
    plasma = Plasma(altitude, columns[stem + "neff_m3"], columns[stem + "mi_u"] * ATOMIC_MASS)
    force = 1e-9 * columns[stem + "f1kV_nN_per_m"]
    return tabulated(altitude, force, f"IRI-2020 {level}, {near[0]:g} deg", plasma)


def _panels(edges):
    """Nodes and weights (sum 1) of the mean over a stretch that is smooth between the edges of a table's cells."""
    edges = np.asarray(edges)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    middle, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * (edges[1:] - edges[:-1])
    return (middle[:, None] + half[:, None] * nodes).ravel(), (half[:, None] * weights).ravel() / (edges[-1] - edges[0])


def averaged_profile(
    inclination: float, f107: float, voltage: float = 1000.0, wire_radius: float = 1e-3
) -> ForceProfile:
    """From the ionosphere table for any orbit, 200-1500 km every 25 km: the force, not the density, averaged over the
    latitudes of a circular orbit and over local time.

    inclination : rad. f107 : sfu, 70-193. voltage : V (absolute), wire_radius : m. The table is averaged over longitude
    and season already, and the force is concave in the density: 1 to 5 % above the `shipped_profile` of that level.
    """
    if not ionosphere.in_table(500e3, f107):
        lowest, highest = min(LEVELS.values()), max(LEVELS.values())
        raise ValueError(f"the ionosphere table holds F10.7 from {lowest:g} to {highest:g}, not {f107:g}")
    altitude = np.arange(ionosphere.LOWEST, ionosphere.HIGHEST + 1, 25e3)
    tilt = np.arcsin(np.abs(np.sin(inclination)))  # the latitudes end here
    rows = np.radians(np.arange(-90, 91, 10))
    crossed = rows[np.abs(rows) < tilt]
    kinks = [-np.pi / 2, *np.arcsin(np.sin(crossed) / np.sin(tilt)), np.pi / 2] if tilt > 0 else [0.0, 1.0]
    along, share = _panels(kinks)
    hour, weight = _panels(np.radians(np.arange(0, 361, 45)))
    share = share[:, None] * weight
    latitude = np.arcsin(np.sin(tilt) * np.sin(along))
    density, mass = ionosphere.density(latitude[:, None, None], hour[:, None], altitude, f107)
    speed = np.sqrt(MU_EARTH / (RADIUS_EARTH + altitude))
    force = np.tensordot(share, force_per_length(density, mass, speed, voltage, wire_radius), 2)
    mean = np.tensordot(share, density, 2)
    plasma = Plasma(altitude, mean, np.tensordot(share, density * mass, 2) / mean, voltage, wire_radius)
    for _ in range(8):  # towards the density that gives the averaged force
        plasma = replace(plasma, density=plasma.density * (force / plasma.force()) ** (1 / DENSITY_EXPONENT))
    return tabulated(altitude, force, f"IRI-2020 at F10.7 {f107:g}, {np.degrees(inclination):g} deg", plasma)


@dataclass(frozen=True)
class Fit:
    """A shape through a profile: the profile itself, its coefficients (SI, in the order of its constructor) and the
    largest relative error of the force at the altitudes it was fitted to."""

    profile: ForceProfile
    coefficients: tuple[float, ...]
    largest_error: float


def fit(
    profile: Callable[[np.ndarray], np.ndarray],
    shape: str = "log-quadratic",
    lower: float = 400e3,
    upper: float = 1000e3,
    spacing: float = 25e3,
) -> Fit:
    """Least squares of ln f between two altitudes in m, every `spacing` m. shape : "exponential", "power" or
    "log-quadratic". Of the shipped profiles, 400-1000 km: the log-quadratic is within 2 to 6 %, the exponential within
    5 to 14 %, the power law within 7 to 26 %."""
    altitude = np.arange(lower, upper + spacing / 2, spacing)
    log = np.log(profile(altitude))
    coefficients: tuple[float, ...]
    if shape == "exponential":
        slope, top = np.polyfit(altitude - REFERENCE, log, 1)
        coefficients = float(np.exp(top)), float(-1 / slope)
        made = exponential(*coefficients)
    elif shape == "power":
        slope, top = np.polyfit(np.log(altitude / REFERENCE), log, 1)
        coefficients = float(np.exp(top)), float(slope)
        made = power_law(*coefficients)
    elif shape == "log-quadratic":
        q2, q1, q0 = np.polyfit((altitude - REFERENCE) / 1e6, log, 2)
        coefficients = float(q0), float(q1 / 1e6), float(q2 / 1e12)
        made = log_quadratic(*coefficients)
    else:
        raise ValueError(f'there is no shape {shape!r}, only "exponential", "power" and "log-quadratic"')
    found = replace(made, lowest=lower, highest=upper)
    return Fit(found, coefficients, float(np.max(np.abs(found(altitude) / np.exp(log) - 1))))
