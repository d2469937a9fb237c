"""How fast a sail comes to an end that is no orbit, or to an orbit within limits: what a question means."""

from __future__ import annotations

import numpy as np

from sailviz.constants import AU, MU_SUN, RADIUS_SUN
from sailviz.design.minimum_time.effort import Effort
from sailviz.design.minimum_time.planar_ends import AtEnergy, AtRadius, AtState
from sailviz.design.minimum_time.planar_ends import End as PlanarEnd
from sailviz.design.minimum_time.planar_transfer import Transfer, no_transfer
from sailviz.design.minimum_time.to_ends import Keeping, circle_to_end
from sailviz.propulsion.devices import ELECTRIC_SAILS
from sailviz.propulsion.film_ageing import coolness
from sailviz.propulsion.solar_sail import Film
from sailviz.transfers.ends import Arrival, Bounds, Distance, End, Escape
from sailviz.words import length

WITH_OPTICS = ("jpl-1978", "jpl-2015")  # films that take up heat, and of which it is known how much
SAME_RADIUS = 1e-4  # relative difference of two radii


def flight_to_end(
    origin: float,
    target: float | None,
    end: End | None,
    within: Bounds,
    device: Film | str,
    characteristic_acceleration: float,
    effort: Effort,
) -> Transfer:
    """The fastest flight found from a circle to the circle of a target, both of a radius in m, or to an end, within
    within. ValueError for what cannot be asked; what cannot be, by a proof, is told in the flight's reason."""
    aim = end.radius if isinstance(end, (Distance, Arrival)) else target
    keeping = Keeping(
        0.0 if within.perihelion is None else within.perihelion / origin,
        _coolness(within.hottest, device),
        None if within.revolutions is None else 2 * np.pi * within.revolutions,
    )
    if keeping.perihelion and keeping.angle is not None:
        raise ValueError("a perihelion limit and a number of revolutions are not looked for at once: give one of them")
    if aim is not None and isinstance(end, Arrival) is False and abs(aim / origin - 1) < SAME_RADIUS:
        raise ValueError(f"the flight begins at {length(origin)}: there is nothing to fly")
    proof = within.impossible(origin, aim)
    if proof:
        return no_transfer(device, characteristic_acceleration, origin, proof, effort.impossible())
    planar = _planar(end, aim, origin)
    found = circle_to_end(origin, planar, device, characteristic_acceleration, keeping, effort=effort)
    if found.feasible and found.closest < RADIUS_SUN:
        reason = "the fastest flight found passes through the Sun: keep it out by a perihelion limit"
        return no_transfer(device, characteristic_acceleration, origin, reason, effort.not_found())
    return found


def _planar(end: End | None, aim: float | None, origin: float) -> PlanarEnd:
    """The end in units of mu = 1 and the radius of departure, m."""
    speed = float(np.sqrt(MU_SUN / origin))
    if isinstance(end, Escape):
        return AtEnergy(0.5 * (end.excess_speed / speed) ** 2)
    assert aim is not None, "all other ends are somewhere"
    if isinstance(end, Arrival):
        return AtState(aim / origin, 0.0, end.speed / speed)
    return AtState.circle(aim / origin) if end is None else AtRadius(aim / origin)


def _coolness(hottest: float | None, device: Film | str) -> float:
    """What the film's heat allows, see `canonical_sail`; ValueError for a sail whose heat is not known."""
    if hottest is None:
        return 0.0
    if isinstance(device, str) and device in ELECTRIC_SAILS:
        raise ValueError("a hottest temperature is that of a film, and an electric sail has none")
    if device == "ideal":
        raise ValueError("an ideal film mirrors all light and stays cold: no hottest temperature limits it")
    if not (isinstance(device, str) and device in WITH_OPTICS):
        raise ValueError(f"a hottest temperature needs the optics of the film, known of {' and '.join(WITH_OPTICS)}")
    return coolness(hottest, device)


def speed_at_100_au(speed: float, radius: float, device: Film | str, characteristic_acceleration: float) -> float:
    """Speed, m/s, at 100 au of a sail that faces the Sun from a radius, m, and a speed, m/s, on; NaN where it does not
    come so far. A film's thrust a_c (r_E / r)^2 adds 2 a_c r_E^2 (1 / r - 1 / r') to the square of the speed, an
    electric sail's a_c r_E / r adds 2 a_c r_E ln(r' / r), and goes on beyond."""
    far, a_c = 100 * AU, characteristic_acceleration
    square = speed**2 - 2 * MU_SUN * (1 / radius - 1 / far)
    if isinstance(device, str) and device == "electric-sail-original":
        square += 12 * a_c * AU * ((AU / radius) ** (1 / 6) - (AU / far) ** (1 / 6))  # r^-7/6
    elif isinstance(device, str) and device in ELECTRIC_SAILS:
        square += 2 * a_c * AU * np.log(far / radius)
    else:
        square += 2 * a_c * AU**2 * (1 / radius - 1 / far)
    return float(np.sqrt(square)) if square >= 0 else np.nan
