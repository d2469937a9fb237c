"""How long a plasma brake takes: quasi-circular decay under Coulomb drag along the velocity, and neutral drag if asked.

da/dt = -2 a^(3/2) / sqrt(mu) (L f + D) / m, f(h) force per length at h = a - R_E, D = rho v^2 Cd A / 2, v circular.
Re-derived; against propagation through the same force the step to circular orbits costs less than 0.02 % of the time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sailviz.constants import MU_EARTH, RADIUS_EARTH, YEAR
from sailviz.design.decay.orbit import BRAKE_FLOOR, MOST_NODES, Atmosphere, Force, craft_of, setting
from sailviz.design.decay.profiles import BAND, REFERENCE, ForceProfile

REENTRY = 120e3  # m, where a re-entry begins
FINE = 2e3  # m, spacing of the altitudes of a Descent


def decay_time(
    mass: npt.ArrayLike,
    length: npt.ArrayLike,
    start_altitude: npt.ArrayLike,
    end_altitude: npt.ArrayLike,
    force_profile: Force | None,
    *,
    drag_area: npt.ArrayLike = 0.0,
    air: Atmosphere | None = None,
    brake_floor: float = BRAKE_FLOOR,
    inclination: float | None = None,
    mean_radius: bool = False,
    corotation: bool = False,
    most_nodes: int = MOST_NODES,
) -> np.ndarray:
    """Time in s to descend between two altitudes; scalars or arrays, broadcast.

    mass : kg. length : m of tether. start_altitude, end_altitude : m, mean semi-major axis less R_E.
    force_profile : altitude m -> N/m (a ForceProfile or any function of arrays), one number in N/m, or None for drag
    alone. drag_area : Cd A, m2, of neutral drag. air : altitude (k,) m and density (k,) kg/m3, or a function altitude m
    -> kg/m3. brake_floor : m, below it the brake is off.
    inclination : rad, needed by the two corrections. mean_radius : look the force up at the J2 mean radius instead of
    the mean semi-major axis. corotation : plasma and air turn with the Earth (+9 % time at 51.6 deg, -2 % over the
    poles). Quadrature: 40 Gauss-Legendre nodes on every smooth stretch, most_nodes of them at most: ValueError beyond.
    """
    given = setting(force_profile, drag_area, air, brake_floor, inclination, mean_radius, corotation)
    rows = np.broadcast_arrays(
        *(np.asarray(x, dtype=float) for x in (mass, length, start_altitude, end_altitude, drag_area))
    )
    time = np.empty(rows[0].shape)
    for place in np.ndindex(time.shape):
        m, tether, upper, lower, area = (float(row[place]) for row in rows)
        craft = craft_of(given, m, tether, upper, lower, area)
        craft.check_nodes(lower, upper, most_nodes)
        time[place] = craft.stages(craft.edges(lower, upper)).sum() if upper > lower else 0.0
    return time[()]


def exponential_decay_time(
    mass: npt.ArrayLike,
    length: npt.ArrayLike,
    start_altitude: npt.ArrayLike,
    end_altitude: npt.ArrayLike,
    f700: npt.ArrayLike,
    scale_height: npt.ArrayLike,
    exact: bool = True,
) -> np.ndarray:
    """Time in s to descend under f700 exp(-(h - 700 km) / H), f700 in N/m, H in m; scalars or arrays.

    exact : by Dawson's integral. Otherwise a^(3/2) is taken at the mean altitude: longer by up to 0.3 % over 100-200 km
    and 2.3 % from 1000 to 400 km. Both re-derived.
    """
    mass, length, upper, lower, f700, scale = (
        np.asarray(x, dtype=float) for x in (mass, length, start_altitude, end_altitude, f700, scale_height)
    )
    grown = [np.exp((h - REFERENCE) / scale) for h in (upper, lower)]
    if exact:
        from scipy.special import dawsn

        axes = [RADIUS_EARTH + h for h in (upper, lower)]
        inner = [4 * dawsn(np.sqrt(a / scale)) / np.sqrt(scale) - 2 / np.sqrt(a) for a in axes]
        return (mass * np.sqrt(MU_EARTH) / (2 * length * f700) * (grown[0] * inner[0] - grown[1] * inner[1]))[()]
    mean = RADIUS_EARTH + 0.5 * (upper + lower)
    return (mass * np.sqrt(MU_EARTH) * scale / (2 * length * f700 * mean**1.5) * (grown[0] - grown[1]))[()]


@dataclass(frozen=True)
class Descent:
    """A descent as it goes: time (k,) s since the start, altitude (k,) m falling from start to end, brake and drag (k,)
    N along the velocity."""

    time: np.ndarray
    altitude: np.ndarray
    brake: np.ndarray
    drag: np.ndarray

    @property
    def duration(self) -> float:
        """s, the last time."""
        return float(self.time[-1])

    def altitude_at(self, times: npt.ArrayLike) -> np.ndarray:
        """Altitude in m at times in s, same shape; NaN before the start and after the end."""
        from scipy.interpolate import PchipInterpolator

        return PchipInterpolator(self.time, self.altitude, extrapolate=False)(np.asarray(times, dtype=float))

    def time_above(self, altitude: npt.ArrayLike) -> np.ndarray:
        """Time in s spent above altitudes in m, same shape: all of it below the end, none above the start."""
        from scipy.interpolate import PchipInterpolator

        inside = np.clip(altitude, self.altitude[-1], self.altitude[0])
        return PchipInterpolator(self.altitude[::-1], self.time[::-1])(inside)

    def area_time(self, area: npt.ArrayLike) -> np.ndarray:
        """Area-time product, m2 s: what a piece of debris can hit. area : m2, cross section of craft and tether (length
        times width, which for a tape or a multi-wire tether is its full width)."""
        return np.multiply(area, self.duration)


def descend(
    mass: float,
    length: float,
    start_altitude: float,
    end_altitude: float,
    force_profile: Force | None,
    *,
    drag_area: float = 0.0,
    air: Atmosphere | None = None,
    brake_floor: float = BRAKE_FLOOR,
    inclination: float | None = None,
    mean_radius: bool = False,
    corotation: bool = False,
    most_nodes: int = MOST_NODES,
) -> Descent:
    """The whole descent of one craft; scalars as for `decay_time`, and its options."""
    given = setting(force_profile, drag_area, air, brake_floor, inclination, mean_radius, corotation)
    craft = craft_of(given, mass, length, start_altitude, end_altitude, drag_area)
    craft.check_nodes(end_altitude, start_altitude, most_nodes, FINE, 6)
    edges = craft.edges(end_altitude, start_altitude, FINE)
    time = np.concatenate([[0.0], np.cumsum(craft.stages(edges, 6))])
    return Descent(time, edges, craft.brake(edges), craft.drag(edges))


def altitude_history(
    times: npt.ArrayLike,
    mass: float,
    length: float,
    start_altitude: float,
    end_altitude: float,
    force_profile: Force | None,
    **options,
) -> np.ndarray:
    """Altitude in m at times in s since the start, same shape, NaN outside the descent; the rest as `decay_time`. The
    analytic decay to draw beside a propagated one: compare it with the orbit mean of the semi-major axis less R_E."""
    return descend(mass, length, start_altitude, end_altitude, force_profile, **options).altitude_at(times)


@dataclass(frozen=True)
class Band:
    """Decay times (k,) in s for plasma densities (k,) times the model's."""

    density_factor: np.ndarray
    time: np.ndarray


def decay_band(
    mass: float,
    length: float,
    start_altitude: float,
    end_altitude: float,
    force_profile: ForceProfile,
    factors: npt.ArrayLike = BAND,
    **options,
) -> Band:
    """Decay time of one craft with the plasma density halved, as modelled and doubled (or other factors): topside
    models differ by that and more, so a time without its band says too much. force_profile : a ForceProfile."""
    times = [
        decay_time(mass, length, start_altitude, end_altitude, force_profile.with_density(factor), **options)
        for factor in np.asarray(factors, dtype=float)
    ]
    return Band(np.array(factors, dtype=float), np.array(times))


@dataclass(frozen=True)
class Compliance:
    """time : s. within_25_years, within_5_years : bool. Of the time's shape."""

    time: np.ndarray
    within_25_years: np.ndarray
    within_5_years: np.ndarray


def compliance(time: npt.ArrayLike) -> Compliance:
    """Whether an orbital lifetime in s after the end of the mission keeps the rules; scalars or arrays.

    25 years: IADC Space Debris Mitigation Guidelines, 5.3.2, and ISO 24113. 5 years: FCC 22-74 (Second Report and Order
    of 29 September 2022) and ESA Space Debris Mitigation Requirements, ESSB-ST-U-007 (2023), which also bounds the risk
    of collision. Quoted from memory of these documents, not read for this purpose.
    """
    time = np.asarray(time, dtype=float)[()]
    return Compliance(time, time <= 25 * YEAR, time <= 5 * YEAR)
