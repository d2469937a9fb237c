"""What lowers a near-circular orbit: tether and neutral drag along the velocity, and how long each metre takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from sailviz.constants import J2_EARTH, MU_EARTH, RADIUS_EARTH, ROTATION_EARTH
from sailviz.design.decay.profiles import SPEED_EXPONENT, ForceProfile, constant

Force = ForceProfile | Callable[[np.ndarray], np.ndarray] | float  # per length of tether over altitude, or one number
Atmosphere = Callable[[np.ndarray], np.ndarray] | tuple[npt.ArrayLike, npt.ArrayLike]  # or altitudes and densities

BRAKE_FLOOR = 200e3  # m, the brake is off below: molecular ions, and drag is stronger anyway
PANEL = 100e3  # m, longest stretch of altitude under one Gauss-Legendre rule
MOST_NODES = 10_000_000  # of a quadrature
RULES = {count: np.polynomial.legendre.leggauss(count) for count in (40, 6)}  # for a PANEL, and for a few km


def mean_radius_offset(semi_major_axis: npt.ArrayLike, inclination: npt.ArrayLike) -> np.ndarray:
    """Mean radius less mean semi-major axis (time mean of the osculating one) of a near-circular orbit under J2, m; a
    in m, i in rad. (3/4) J2 (R_E / a)^2 a (3 sin^2 i - 2): +4.4 km at 97.8 deg, -0.7 km at 51.6 deg. Re-derived."""
    a = np.asarray(semi_major_axis, dtype=float)
    return 0.75 * J2_EARTH * RADIUS_EARTH**2 / a * (3 * np.sin(inclination) ** 2 - 2)


def corotation_factor(
    semi_major_axis: npt.ArrayLike, inclination: npt.ArrayLike, exponent: float = SPEED_EXPONENT
) -> np.ndarray:
    """Braking along the velocity in a medium that turns with the Earth, over that in one at rest; a in m, i in rad.

    A force ~ u^exponent against u = v - omega x r: (u / v)^exponent (v - omega a cos i) / u, with cos^2 of the latitude
    at its mean over the orbit. exponent : 1.933 of Coulomb drag, 2 of neutral drag. Re-derived.
    """
    turning = ROTATION_EARTH * np.power(semi_major_axis, 1.5) / np.sqrt(MU_EARTH)
    along = 1 - turning * np.cos(inclination)
    relative2 = 1 - 2 * turning * np.cos(inclination) + turning**2 * (1 - np.sin(inclination) ** 2 / 2)
    return relative2 ** ((exponent - 1) / 2) * along


@dataclass(frozen=True)
class Craft:
    """All that brakes one craft; what each means: `sailviz.design.decay.decay_time`."""

    mass: float
    length: float
    profile: Callable[[np.ndarray], np.ndarray] | None
    drag_area: float
    air: Callable[[np.ndarray], np.ndarray] | None
    brake_floor: float
    inclination: float  # rad; NaN where neither correction is asked for
    mean_radius: bool
    corotation: bool

    def height(self, altitude: np.ndarray | float) -> np.ndarray:
        """Altitude in m at which force and air are looked up."""
        offset = mean_radius_offset(RADIUS_EARTH + altitude, self.inclination) if self.mean_radius else 0.0
        return np.add(altitude, offset)

    def brake(self, altitude: np.ndarray) -> np.ndarray:
        """Force of the tether along the velocity, N."""
        if self.profile is None or self.length == 0:
            return np.zeros_like(altitude)
        force = self.length * np.where(altitude < self.brake_floor, 0.0, self.profile(self.height(altitude)))
        return force * corotation_factor(RADIUS_EARTH + altitude, self.inclination) if self.corotation else force

    def drag(self, altitude: np.ndarray) -> np.ndarray:
        """Neutral drag along the velocity, N."""
        if self.air is None or self.drag_area == 0:
            return np.zeros_like(altitude)
        a = RADIUS_EARTH + altitude
        force = 0.5 * self.air(self.height(altitude)) * MU_EARTH / a * self.drag_area
        return force * corotation_factor(a, self.inclination, 2.0) if self.corotation else force

    def slowness(self, altitude: np.ndarray) -> np.ndarray:
        """Time per metre of descent, s/m."""
        a = RADIUS_EARTH + altitude
        return self.mass * np.sqrt(MU_EARTH) / (2 * a**1.5 * (self.brake(altitude) + self.drag(altitude)))

    def edges(self, lower: float, upper: float, spacing: float = PANEL) -> np.ndarray:
        """Altitudes from upper down to lower, between which everything is smooth."""
        knots = [*getattr(self.profile, "knots", ()), *getattr(self.air, "knots", ()), self.brake_floor]
        shift = float(self.height(0.5 * (lower + upper)) - 0.5 * (lower + upper))  # within 0.5 km over the whole range
        inside = [k - shift for k in knots[:-1]] + knots[-1:]
        pieces = np.linspace(upper, lower, 1 + int(np.ceil((upper - lower) / spacing)))
        inside = [k for k in inside if lower < k < upper]
        return np.unique(np.concatenate([pieces, inside]))[::-1]

    def check_nodes(self, lower: float, upper: float, most: int, spacing: float = PANEL, count: int = 40) -> None:
        """ValueError, with their number, where a descent by `edges` and `stages` has more nodes than `most`."""
        nodes = (upper - lower) / spacing * count
        if nodes > most:
            raise ValueError(
                f"a descent over {(upper - lower) / 1e3:,.6g} km has {nodes:,.0f} nodes of quadrature (some "
                f"{8 * nodes / 1e9:,.3g} GB at a time), more than the {most:,} that most_nodes "
                "(limits.steps of a scene) allows"
            )

    def stages(self, edges: np.ndarray, count: int = 40) -> np.ndarray:
        """Time in s that each stretch between falling altitudes takes, by `count` nodes of RULES."""
        nodes, weights = RULES[count]
        middle, half = 0.5 * (edges[:-1] + edges[1:]), 0.5 * (edges[:-1] - edges[1:])
        return half * (self.slowness(middle[:, None] + half[:, None] * nodes) @ weights)


class Air:
    """Density kg/m3 at altitudes in m, its logarithm linear between those of a table."""

    def __init__(self, altitude: npt.ArrayLike, density: npt.ArrayLike):
        self.altitude, self.log = np.asarray(altitude, dtype=float), np.log(np.asarray(density, dtype=float))
        self.knots = tuple(self.altitude)

    def __call__(self, altitude: npt.ArrayLike) -> np.ndarray:
        return np.exp(np.interp(np.asarray(altitude, dtype=float), self.altitude, self.log))


def setting(
    force_profile: Force | None,
    drag_area: npt.ArrayLike,
    air: Atmosphere | None,
    brake_floor: float,
    inclination: float | None,
    mean_radius: bool,
    corotation: bool,
) -> Craft:
    """A Craft without mass and length, its options checked."""
    profile = force_profile if force_profile is None or callable(force_profile) else constant(float(force_profile))
    density = air if air is None or callable(air) else Air(*air)
    if (mean_radius or corotation) and inclination is None:
        raise ValueError("the mean radius and the co-rotation of the plasma depend on the inclination: give it, in rad")
    if np.any(np.asarray(drag_area) < 0) or (np.any(np.asarray(drag_area) > 0) and air is None):
        raise ValueError("a drag area, zero or more, takes an atmosphere: air = (altitude in m, density in kg/m3)")
    tilt = np.nan if inclination is None else inclination
    return Craft(1.0, 0.0, profile, 0.0, density, brake_floor, tilt, mean_radius, corotation)


def craft_of(setting: Craft, mass: float, length: float, upper: float, lower: float, drag_area: float) -> Craft:
    """One craft between two altitudes, or the reason why it cannot be."""
    if not (mass > 0 and length >= 0):
        raise ValueError(f"mass must be positive and length not negative, not {mass:g} kg and {length:g} m")
    if not lower <= upper:
        raise ValueError(f"a brake only lowers an orbit: {upper / 1e3:g} km is not above {lower / 1e3:g} km")
    craft = replace(setting, mass=mass, length=length, drag_area=drag_area)
    braking = craft.profile is not None and length > 0
    if drag_area == 0 and (not braking or lower < craft.brake_floor):
        what = f"below {craft.brake_floor / 1e3:g} km the brake is off" if braking else "there is no brake"
        raise ValueError(f"{what} and no drag area is given: nothing lowers the orbit")
    if braking:
        lowest, highest = getattr(craft.profile, "lowest", -np.inf), getattr(craft.profile, "highest", np.inf)
        label = getattr(craft.profile, "label", "given")
        if upper > highest or max(lower, craft.brake_floor) < lowest:
            raise ValueError(
                f"the force profile {label} is known from {lowest / 1e3:g} to {highest / 1e3:g} km, the "
                f"descent runs from {upper / 1e3:g} to {lower / 1e3:g} km; profile.extended() holds its ends"
            )
    return craft
