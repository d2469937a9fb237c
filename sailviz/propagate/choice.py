"""Which integrator suits a run: the multistep method for many revolutions close to a body, DOP853 for all else."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailviz.environment import atmosphere, ionosphere
from sailviz.propagate.dynamics import loses_mass
from sailviz.propagate.gauss_jackson_coefficients import LAGS
from sailviz.propagate.gauss_jackson_steps import ANGLE, LARGEST_ECCENTRICITY, SMALLEST_TOLERANCE

DOP853, GAUSS_JACKSON = "dop853", "gauss-jackson"
FEWEST_TURNS = 50  # below, DOP853 is as accurate and the gain is microseconds
LOW = 3.0  # radii of the body within which orbits decay and the forces are small beside gravity
STEPS_A_START_COSTS = 10 * LAGS  # twelve evaluations for each point, and as much again lost on the way to a kink


@dataclass(frozen=True)
class Choice:
    """integrator : "dop853" or "gauss-jackson"; reason : one clause, why; possible : False where gauss-jackson, asked
    for, would not work, and reason says why."""

    integrator: str
    reason: str
    possible: bool = True


def choose(model, position, velocity, duration, breaks=(0.0,), wanted="auto", tolerance=1e-10) -> Choice:
    """The integrator for a run of duration s from position m and velocity m/s, whose thrust factor has kinks at breaks
    s. wanted : "auto", "dop853" or "gauss-jackson"; tolerance : of the distance. ValueError for another word.

    Looks at the osculating orbit at the start alone: an orbit that becomes eccentric later is finished by the DOP853
    steps of gauss_jackson itself, correctly but no faster than by DOP853.
    """
    if wanted not in ("auto", DOP853, GAUSS_JACKSON):
        raise ValueError(f'the integrator must be "auto", "{DOP853}" or "{GAUSS_JACKSON}", not {wanted!r}.')
    if wanted == DOP853:
        return Choice(DOP853, "asked for")
    p = model.named
    mu, surface = p.gravity.mu, p.surface.radius
    r, v = np.asarray(position, float), np.asarray(velocity, float)
    size = np.linalg.norm(r)
    axis = 1.0 / (2.0 / size - v @ v / mu)  # semi-major, m
    e = float(np.linalg.norm(((v @ v) * r - (r @ v) * v) / mu - r / size))
    if loses_mass(model):
        obstacle = "the thruster burns propellant, and the multistep method keeps the mass constant"
    elif tolerance < SMALLEST_TOLERANCE:
        obstacle = (
            f"its rounding reaches {SMALLEST_TOLERANCE:g} of the distance at best, not a tolerance of {tolerance:g}"
        )
    elif not axis > 0.0:
        obstacle = "the orbit is not bound"
    elif e >= LARGEST_ECCENTRICITY:
        obstacle = f"the eccentricity {e:.3g} is not below {LARGEST_ECCENTRICITY:g}, and its steps are equal"
    else:
        obstacle = ""
    if obstacle:
        return Choice(DOP853, obstacle, wanted == "auto")
    if wanted == GAUSS_JACKSON:
        return Choice(GAUSS_JACKSON, "asked for")
    turn = 2 * np.pi * np.sqrt(axis**3 / mu)
    kinks = np.count_nonzero((np.asarray(breaks) > 0.0) & (np.asarray(breaks) < duration))
    if surface == 0.0 or axis > LOW * surface:
        return Choice(DOP853, "the orbit is not a low one")
    if duration < FEWEST_TURNS * turn:
        return Choice(DOP853, f"{duration / turn:.0f} revolutions are few")
    if duration / (kinks + 1) < STEPS_A_START_COSTS * ANGLE / (2 * np.pi) * turn:
        return Choice(DOP853, f"the thrust is switched {kinks * turn / duration:.1f} times a revolution")
    if _kinked(p):  # where the multistep method halves its step and halves it again, and takes ten times as long
        return Choice(DOP853, "a force read from tables or switched by the shadow has kinks")
    return Choice(GAUSS_JACKSON, f"{duration / turn:.0f} revolutions of a low orbit of eccentricity {e:.2g}")


def _kinked(p) -> bool:
    """Whether the forces of named parameters have kinks along the way, at places that no schedule knows."""
    brake = p.brake
    kinked = p.plasma.kind == ionosphere.TABLE_PROFILE or brake.power != brake.eclipse_power
    return bool(p.air.kind == atmosphere.TABLED or (brake.present and kinked))
