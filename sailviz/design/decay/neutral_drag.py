"""Coulomb drag against neutral drag, and descents that outlast a solar cycle."""

from __future__ import annotations

import numpy as np

from sailviz.design.decay.orbit import BRAKE_FLOOR, Atmosphere, Force, craft_of, setting
from sailviz.design.decay.profiles import LEVELS, POLAR, averaged_profile
from sailviz.design.decay.quasi_circular import FINE, REENTRY, Descent
from sailviz.environment import atmosphere, solar_level

TOLERANCE = 1e-7  # relative, of the time


def crossover_altitude(
    length: float,
    force_profile: Force | None,
    drag_area: float,
    air: Atmosphere | None,
    brake_floor: float = BRAKE_FLOOR,
    top: float = 1500e3,
) -> float:
    """Altitude in m where the brake's force equals neutral drag: the brake leads above, the air below. Not a place of
    rest, both brake.

    length : m of tether. The rest as in `decay.decay_time`. NaN where the brake leads all the way down to its floor, or
    nowhere up to `top` in m; where they are equal more than once, the lowest.
    """
    from scipy.optimize import brentq

    given = setting(force_profile, drag_area, air, brake_floor, None, False, False)
    craft = craft_of(given, 1.0, length, top, brake_floor, drag_area)
    if length == 0 or drag_area == 0:
        return np.nan

    def lead(altitude):
        return np.log(craft.brake(np.asarray(altitude)) / craft.drag(np.asarray(altitude)))

    altitude = np.arange(brake_floor, top + 1, 5e3)
    sign = np.sign(lead(altitude))
    places = np.nonzero(sign[1:] > sign[:-1])[0]
    return brentq(lead, altitude[places[0]], altitude[places[0] + 1], xtol=1e-3) if len(places) else np.nan


class _Levels:
    """ln of a quantity over solar level and altitude, linear in both, held at the outermost levels."""

    def __init__(self, levels, altitude, values):
        self.levels, self.altitude, self.log = np.asarray(levels, dtype=float), altitude, np.log(values)

    def __call__(self, altitude, f107):
        level = np.clip(f107, self.levels[0], self.levels[-1])
        low = min(int(np.searchsorted(self.levels, level, side="right")) - 1, len(self.levels) - 2)
        weight = (level - self.levels[low]) / (self.levels[low + 1] - self.levels[low])
        row = (1 - weight) * self.log[low] + weight * self.log[low + 1]
        return np.exp(np.interp(altitude, self.altitude, row))


def cycle_descent(
    mass: float,
    start_altitude: float,
    year: float,
    *,
    drag_area: float,
    length: float = 0.0,
    end_altitude: float = REENTRY,
    inclination: float = POLAR,
    f107: float | None = None,
    brake_floor: float = BRAKE_FLOOR,
) -> Descent:
    """A descent through changing solar activity: F10.7 = 70 + 61.5 (1 - cos(2 pi (year - 2019.96) / 11)), as
    `solar_level.cycle`. A lifetime of decades at a constant level says little.

    mass : kg. start_altitude, end_altitude : m. year : decimal, at the start. drag_area : Cd A, m2. length : m of
    tether, 0 for drag alone. inclination : rad. f107 : a constant level in sfu instead. brake_floor : m.
    Air: NRLMSIS at the levels of `atmosphere`, ln rho linear between them (8 % at most between levels; decades average
    it); plasma: the ionosphere table at 1 kV. Integrated over the altitude, which knows no singularity at the end, with
    DOP853 to 1e-7 of the time.
    """
    from scipy.integrate import solve_ivp

    least, most = atmosphere.LEVELS[0], atmosphere.LEVELS[-1]
    if f107 is not None and not least <= f107 <= most:
        raise ValueError(f"F10.7 must be from {least:g} to {most:g}, where the air is known, not {f107:g}")
    levels = zip(atmosphere.LEVELS, atmosphere.GEOMAGNETIC, strict=True)
    profiles = [atmosphere.mean_profile(level, ap, inclination) for level, ap in levels]
    air = _Levels(atmosphere.LEVELS, profiles[0][0], [density for _, density in profiles])
    plasma = None
    if length > 0:
        tables = [averaged_profile(inclination, level) for level in LEVELS.values()]
        at = np.array(tables[0].knots)
        plasma = _Levels(list(LEVELS.values()), at, [table(at) for table in tables])
    cycle = solar_level.constant(f107) if f107 is not None else solar_level.cycle(year)

    def craft(time):
        level = solar_level.flux.py_func(time, cycle)
        force = None if plasma is None else lambda altitude: plasma(altitude, level)
        given = setting(force, drag_area, lambda h: air(h, level), brake_floor, None, False, False)
        return craft_of(given, mass, length, start_altitude, end_altitude, drag_area)

    craft(0.0)  # refuses what cannot be
    edges = np.linspace(start_altitude, end_altitude, 1 + int(np.ceil((start_altitude - end_altitude) / FINE)))
    found = solve_ivp(
        lambda altitude, time: -craft(time[0]).slowness(np.array([altitude])),
        (start_altitude, end_altitude),
        [0.0],
        "DOP853",
        edges,
        rtol=TOLERANCE,
        atol=1.0,
        max_step=10e3,
    )
    if not found.success:
        raise ArithmeticError(f"the descent could not be integrated: {found.message}")
    time = found.y[0]
    forces = np.array([[c.brake(h), c.drag(h)] for c, h in ((craft(t), h) for t, h in zip(time, edges, strict=True))])
    return Descent(time, edges, forces[:, 0], forces[:, 1])
