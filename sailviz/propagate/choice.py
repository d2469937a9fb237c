"""Which integrator suits a run: collocation for smooth flights, the multistep method for many revolutions close to a
body whose forces cost much, DOP853 where the forces may have kinks that no schedule knows.

Measured on a year in low orbit at 1e-9 to 1e-10: collocation, which evaluates the forces three to five times at eight
places in each radian, takes half the time of the multistep method where all eight are evaluated at once (oblateness and
air), and twice its time where they are evaluated one by one (a plasma brake's).

Measured on the shipped scenes at equal tolerance: collocation takes 0.2 to 0.9 of the time of DOP853 and errs as
little or less, but its steps see the forces at eight places only, and what jumps between the last of them and the end
of a step is missed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailviz.environment import atmosphere, ionosphere
from sailviz.propagate.collocation_forces import fits_lanes
from sailviz.propagate.dynamics import loses_mass
from sailviz.propagate.gauss_jackson_coefficients import LAGS
from sailviz.propagate.gauss_jackson_steps import ANGLE, LARGEST_ECCENTRICITY, SMALLEST_TOLERANCE
from sailviz.propulsion.devices import CALLED, ELECTRIC_SAIL, SOLAR_SAIL
from sailviz.steering import attitude, by_light

COLLOCATION, DOP853, GAUSS_JACKSON = "collocation", "dop853", "gauss-jackson"
TURNING = "turning"  # the steps of dop853 at the size of a craft that turns, `body_steps`
ASKED = "it was asked for"
FEWEST_TURNS = 50  # below, other integrators are as accurate and the gain is microseconds
LOW = 3.0  # radii of the body within which orbits decay and the forces are small beside gravity
STEPS_A_START_COSTS = 10 * LAGS  # twelve evaluations for each point, and as much again lost on the way to a kink


@dataclass(frozen=True)
class Choice:
    """integrator : "collocation", "dop853" or "gauss-jackson"; reason : one clause, why; possible : False where
    gauss-jackson, asked for, would not work, and reason says why."""

    integrator: str
    reason: str
    possible: bool = True


def choose(model, position, velocity, duration, breaks=(0.0,), wanted="auto", tolerance=1e-10, beside=0) -> Choice:
    """The integrator for a run of duration s from position m and velocity m/s, whose thrust factor has kinks at breaks
    s. wanted : "auto" or one of these; tolerance : of the distance; beside : how many devices push beside the first
    one. ValueError for another word.

    Looks at the osculating orbit at the start alone: an orbit that becomes eccentric later is finished by the DOP853
    steps of gauss_jackson itself, correctly but no faster than by DOP853.
    """
    if wanted not in ("auto", COLLOCATION, DOP853, GAUSS_JACKSON):
        words = f'"auto", "{COLLOCATION}", "{DOP853}" or "{GAUSS_JACKSON}"'
        raise ValueError(f"the integrator must be {words}, not {wanted!r}.")
    if wanted in (COLLOCATION, DOP853):
        return Choice(wanted, ASKED)
    if beside:  # whose attitudes and times only their own callbacks know
        if wanted == GAUSS_JACKSON:
            return Choice(DOP853, "several devices push, each at times of its own", False)
        return Choice(DOP853, "several devices push, each at times of its own")
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
    if obstacle and wanted == GAUSS_JACKSON:
        return Choice(DOP853, obstacle, False)
    if obstacle:
        return _without_equal_steps(model)
    if wanted == GAUSS_JACKSON:
        return Choice(GAUSS_JACKSON, ASKED)
    turn = 2 * np.pi * np.sqrt(axis**3 / mu)
    kinks = np.count_nonzero((np.asarray(breaks) > 0.0) & (np.asarray(breaks) < duration))
    low = surface > 0.0 and axis <= LOW * surface and duration >= FEWEST_TURNS * turn
    rarely = duration / (kinks + 1) >= STEPS_A_START_COSTS * ANGLE / (2 * np.pi) * turn
    # at kinks the multistep method halves its step and halves it again, and takes ten times as long
    if not low or not rarely or _kinked(p) or p.pushed.device:
        return _without_equal_steps(model)
    orbit = f"the orbit is low, of eccentricity {e:.2g}, and turns {duration / turn:.0f} times"
    if fits_lanes.py_func(p):
        return Choice(COLLOCATION, f"{orbit}, and its forces are evaluated at eight places at once")
    return Choice(GAUSS_JACKSON, orbit)


def _without_equal_steps(model) -> Choice:
    """Collocation for what is smooth, with the reason where it is not."""
    p, device, steering = model.named, model.device, model.steering
    sail, pushed = device in (SOLAR_SAIL, ELECTRIC_SAIL) or p.pushed.device != 0, p.pushed.device != 0
    counted = steering == attitude.CALLED and p.by_light.law in (by_light.FACING, by_light.FRAME)
    if _kinked(p) or p.callbacks.edges:
        return Choice(DOP853, "a force read from tables or switched by the shadow has kinks")
    if p.third_body.mu != 0.0:  # of whose pull the correction between two sweeps of collocation knows nothing
        return Choice(DOP853, "a body besides the central one may be passed closely")
    if p.callbacks.user_steering or p.callbacks.user_force or (device == CALLED and not pushed):
        return Choice(DOP853, "a function of one's own may jump")
    if steering == attitude.CALLED and not counted:
        return Choice(DOP853, "a function of one's own may jump")
    film = p.solar_sail
    real_film = device == SOLAR_SAIL and (film.b1 != 0.0 or film.b3 != 0.0)  # which turns edge-on at once
    switches = steering == attitude.PRIMER and (device != SOLAR_SAIL or real_film)
    if steering in (attitude.LOCAL, attitude.LYAPUNOV) or switches:
        return Choice(DOP853, "the steering switches the thrust when it is time")
    if sail and steering in (attitude.INERTIAL, attitude.TANGENTIAL):
        return Choice(DOP853, "the sail may turn edge-on, where its force has a kink")
    return Choice(COLLOCATION, "the forces are smooth")


def _kinked(p) -> bool:
    """Whether the forces of named parameters have kinks along the way, at places that no schedule knows."""
    brake = p.brake
    kinked = p.plasma.kind == ionosphere.TABLE_PROFILE or brake.power != brake.eclipse_power
    return bool(p.air.kind == atmosphere.TABLED or (brake.present and kinked))
