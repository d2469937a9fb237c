"""Analytic trajectories under small in-plane thrust: the first-order solution in q1, q2, q3 over the swept angle.

Canonical units: mu = 1 and a length of one's choice. q1 = (e / h) cos(w), q2 = (e / h) sin(w), q3 = 1 / h; thrust
a_r = radial r^-n, a_theta = transverse r^-n with n = 2 (solar sail), 1 (electric sail), 0 (constant acceleration).
Then s = v_theta = q3 + q1 cos(theta) + q2 sin(theta), v_r = q1 sin(theta) - q2 cos(theta), r = 1 / (q3 s).
Source: thesis, chapter 5 and appendix A, not read; re-derived for any initial ellipse and the three laws in one
formula, checked against integration: the error falls with the square of the thrust.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from sailviz.constants import AU, GRAVITY_AT_1_AU, MU_SUN
from sailviz.design.asymptotic.legs import (
    ASYMPTOTE,
    CLOSED,
    HYPERBOLIC,
    MIDPOINT,
    NO_MASS,
    NO_MOMENTUM,
    NONE,
    OK,
    PLAIN,
    QUADRATURE,
    TOO_MANY_LEGS,
    march,
    march_adaptive,
)
from sailviz.design.displaced.force_shape import force_shape
from sailviz.errors import SailvizError
from sailviz.propulsion.solar_sail import Film

DOUBTFUL = 0.03  # relative error in r from which a result says that it should not be trusted
ADAPTIVE_CAP = np.pi / 2  # rad; with legs near a revolution the step-doubling estimate aliases and under-reports
SCHEMES = {"plain": PLAIN, "midpoint": MIDPOINT}
CLOCKS = {"quadrature": QUADRATURE, "closed": CLOSED, None: NONE}


class BreakdownError(SailvizError, ValueError):
    """The first-order solution has no orbit somewhere on the arc. theta : rad, where it ends."""

    def __init__(self, reason, theta):
        super().__init__(reason)
        self.theta = theta


@dataclass(frozen=True)
class Solution:
    """An analytic trajectory at n angles, canonical. theta (n,) rad, q (n, 3), time (n,) since theta0 (NaN if not asked
    for), mass (n,) over the initial mass (1 without propellant), legs : how many ellipses were frozen on the way."""

    theta: np.ndarray
    q: np.ndarray
    time: np.ndarray
    mass: np.ndarray
    legs: int
    request: tuple = ()  # how it was made, for the estimate of its error

    @property
    def transverse_speed(self) -> np.ndarray:
        return self.q[:, 2] + self.q[:, 0] * np.cos(self.theta) + self.q[:, 1] * np.sin(self.theta)

    @property
    def radial_speed(self) -> np.ndarray:
        return self.q[:, 0] * np.sin(self.theta) - self.q[:, 1] * np.cos(self.theta)

    @property
    def radius(self) -> np.ndarray:
        """r (n,)."""
        return 1 / (self.q[:, 2] * self.transverse_speed)

    @property
    def eccentricity(self) -> np.ndarray:
        """Osculating (n,)."""
        return np.hypot(self.q[:, 0], self.q[:, 1]) / self.q[:, 2]

    @property
    def semi_major_axis(self) -> np.ndarray:
        """Osculating (n,)."""
        return 1 / (self.q[:, 2] ** 2 - self.q[:, 0] ** 2 - self.q[:, 1] ** 2)

    @property
    def argument(self) -> np.ndarray:
        """Osculating argument of periapsis (n,), rad."""
        return np.arctan2(self.q[:, 1], self.q[:, 0])

    @cached_property
    def error_estimate(self) -> float:
        """Largest relative error in r on the arc, estimated against the midpoint scheme with legs of half the length.

        Computed when asked for, at four times the cost; inf where that breaks down. Within a factor of two of the true
        error of every tested case. Halving plain legs alone is out by three where legs are whole revolutions.
        """
        make, theta0 = self.request
        end = self.theta[np.argmax(np.abs(self.theta - theta0))] if len(self.theta) else theta0
        angles = np.unique(np.concatenate([self.theta, np.linspace(theta0, end, 65)]))
        try:
            coarse, fine = (Solution(**make(angles, refined)).radius for refined in (False, True))
        except BreakdownError:
            return np.inf
        return float(np.max(np.abs(coarse / fine - 1)))

    @property
    def doubtful(self) -> bool:
        """Whether the estimate of the error passes 3 %."""
        return not self.error_estimate <= DOUBTFUL


# ---------------------------------------------------------------- states and thrust
def from_elements(semi_major_axis: float = 1.0, eccentricity: float = 0.0, argument: float = 0.0) -> np.ndarray:
    """q (3,) of an ellipse, canonical, argument of periapsis in rad."""
    q3 = 1 / np.sqrt(semi_major_axis * (1 - eccentricity**2))
    return np.array([eccentricity * q3 * np.cos(argument), eccentricity * q3 * np.sin(argument), q3])


def from_state(radius: float, theta: float, radial_speed: float, transverse_speed: float) -> np.ndarray:
    """q (3,) of a plane state, canonical, theta rad."""
    q3 = 1 / (radius * transverse_speed)
    c, s, a = np.cos(theta), np.sin(theta), transverse_speed - q3
    return np.array([a * c + radial_speed * s, a * s - radial_speed * c, q3])


def thrust(
    device: Film | str,
    characteristic_acceleration: float,
    pitch: float,
    reference_radius: float = AU,
    mu: float = MU_SUN,
) -> tuple[float, float, int]:
    """(radial, transverse, exponent) of a sail at a fixed pitch in rad (negative: against the motion).

    characteristic_acceleration : m/s2. reference_radius : m, the canonical unit of length. mu : m3/s2.
    """
    shape = force_shape(device)
    k_r, k_t = shape.components(pitch)
    size = characteristic_acceleration / GRAVITY_AT_1_AU * MU_SUN / mu * (reference_radius / AU) ** (2 - shape.exponent)
    return float(size * k_r), float(size * k_t), shape.exponent


# ---------------------------------------------------------------- the solution
def propagate(
    q: npt.ArrayLike,
    theta0: float,
    theta: npt.ArrayLike,
    radial: float,
    transverse: float,
    exponent: int,
    leg: float | str | None = None,
    scheme: str = "plain",
    *,
    clock: str | None = "quadrature",
    tolerance: float = 1e-5,
    cap: float = ADAPTIVE_CAP,
) -> Solution:
    """First-order trajectory from q (3,) at theta0 to the angles theta (n,) in rad, any order, any number of
    revolutions, either way.

    radial, transverse : thrust at r = 1. exponent : n = 0, 1 or 2. leg : rad after which the ellipse is frozen anew
    (rectification), None for never, "adaptive" for legs up to `cap` rad that keep max|dq| under `tolerance` a
    revolution by step doubling. scheme : "plain" freezes the ellipse of a leg's start (error ~ leg), "midpoint" that
    predicted for its middle (error ~ leg^2, twice the cost). clock : "quadrature" of 1 / (q3 s^2), "closed" for the
    consistent first-order formula (plain only; 2-4 times the error, a fixed cost per leg and output), None for no time.
    Errors without rectification, x = transverse (theta - theta0), circular start: about x^2 for n = 2, 1 and 3 x^2 for
    n = 0.
    BreakdownError where q3 <= 0 or s <= 0 anywhere on the arc, or the frozen orbit is no ellipse; `.error_estimate`
    tells the rest. Without transverse thrust and n = 2 exact.
    """
    if exponent not in (0, 1, 2):
        raise ValueError(f"exponent is 0, 1 or 2, not {exponent!r}")
    if scheme not in SCHEMES:
        raise ValueError(f"scheme is {' or '.join(SCHEMES)}, not {scheme!r}")
    if clock not in CLOCKS:
        raise ValueError(f'clock is "quadrature", "closed" or None, not {clock!r}')
    if clock == "closed" and scheme != "plain":
        raise ValueError('the closed form of the time belongs to the scheme "plain"')
    if leg != "adaptive" and (isinstance(leg, str) or (leg is not None and not leg > 0)):
        raise ValueError(f'leg is a positive angle, "adaptive" or None, not {leg!r}')
    law = (int(exponent), float(radial), float(transverse))
    q = np.ascontiguousarray(q, dtype=float)

    def make(angles, refined, clock=None):
        arc = max(np.max(np.abs(angles - theta0), initial=0.0), 1e-300)
        way = MIDPOINT if refined else SCHEMES[scheme]
        part = 0.5 if refined else 1.0
        length = cap if isinstance(leg, str) else arc if leg is None else leg

        def run(side, out, time, mass):
            if isinstance(leg, str):
                return march_adaptive(
                    q, theta0, side, tolerance * part, length * part, *law, CLOCKS[clock], way, out, time
                )[:3]
            return march(q, theta0, side, length * part, *law, CLOCKS[clock], way, 0.0, out, time, mass)

        return _both_ways(run, theta0, angles)

    found = make(np.atleast_1d(np.asarray(theta, dtype=float)), False, clock)
    return Solution(**found, request=(make, float(theta0)))


def constant_thrust(
    q: npt.ArrayLike,
    theta0: float,
    theta: npt.ArrayLike,
    radial: float,
    transverse: float,
    exhaust_speed: float,
    leg: float = np.pi / 2,
    scheme: str = "midpoint",
) -> Solution:
    """As `propagate` for a thruster of constant thrust, whose acceleration grows as its mass falls: m = m0 - (F / c) t.

    radial, transverse : initial acceleration, canonical. exhaust_speed : c = g0 Isp, canonical. The acceleration of a
    leg is that of the mass at its start ("plain") or at its middle ("midpoint"). BreakdownError where the mass runs
    out.
    """
    loss = float(np.hypot(radial, transverse) / exhaust_speed)
    q = np.ascontiguousarray(q, dtype=float)
    law = (0, float(radial), float(transverse), QUADRATURE)

    def make(angles, refined):
        way, part = (MIDPOINT, 0.5) if refined else (SCHEMES[scheme], 1.0)

        def run(side, out, time, mass):
            return march(q, theta0, side, float(leg) * part, *law, way, loss, out, time, mass)

        return _both_ways(run, theta0, angles)

    found = make(np.atleast_1d(np.asarray(theta, dtype=float)), False)
    return Solution(**found, request=(make, float(theta0)))


def mass_at_constant_acceleration(time: npt.ArrayLike, acceleration: float, exhaust_speed: float) -> np.ndarray:
    """m / m0 where the acceleration, not the thrust, is held: exp(-a t / c), with `time` of a Solution."""
    return np.exp(-np.asarray(time) * acceleration / exhaust_speed)


def uniform(theta: npt.ArrayLike, radial: float, transverse: float, exponent: int) -> Solution:
    """Long spirals from the unit circle at theta = 0: a two-scale form whose error stays O(thrust) over 1 / thrust.
    theta >= 0 (n,).

    Ours, not the thesis': 7e-4 after 20 revolutions at 0.1 mm/s2 where the plain solution is off by 470 %. q3 decays as
    n = 2: exp(-eps_t theta / (1 - eps_r)); n = 1: q3^2 = y with y - 1 - 2 eps_r ln((y + 2 eps_r) / (1 + 2 eps_r)) = -2
    eps_t theta; n = 0: (1 - 4 eps_t theta)^(1/4), eps_r = 0; then
    q1 + i q2 = (eps_r + 2 i eps_t) (q3^(5/2 - n) e^(i phi) - q3^(2n - 3) e^(i theta)), phi = (2 - n) / 2 (eps_r /
    eps_t) ln(1 / q3).
    """
    angles = np.atleast_1d(np.asarray(theta, dtype=float))
    if exponent not in (0, 1, 2):
        raise ValueError(f"exponent is 0, 1 or 2, not {exponent!r}")
    if np.any(angles < 0):
        raise ValueError("the two-scale form starts at theta = 0 and goes forward")
    order = np.argsort(angles, kind="stable")
    edges = np.concatenate([[0.0], angles[order]])
    panels = max(1, int(np.ceil(np.max(np.diff(edges), initial=0.0) / np.pi)))
    x, w = np.polynomial.legendre.leggauss(20)
    sub = edges[:-1, None] + np.diff(edges)[:, None] * np.arange(panels) / panels
    half = np.repeat(np.diff(edges)[:, None] / (2 * panels), panels, axis=1)
    nodes = sub[..., None] + half[..., None] * (x + 1)
    q = _uniform_q(nodes.ravel(), radial, transverse, exponent)
    speed = q[:, 2] + q[:, 0] * np.cos(nodes.ravel()) + q[:, 1] * np.sin(nodes.ravel())
    _refuse(nodes.ravel(), q[:, 2], speed)
    slices = (half[..., None] * w / (q[:, 2] * speed**2).reshape(nodes.shape)).sum(axis=(1, 2))
    time = np.empty_like(angles)
    time[order] = np.cumsum(slices)
    found = _uniform_q(angles, radial, transverse, exponent)
    solution = Solution(angles, found, time, np.ones_like(angles), 1)
    _refuse(angles, found[:, 2], solution.transverse_speed)
    return solution


def _refuse(theta, q3, speed):
    with np.errstate(invalid="ignore"):
        bad = ~((q3 > 0) & (speed > 0))
    if bad.any():
        at = float(theta[bad].min())
        raise BreakdownError(f"the two-scale form ends before theta = {at:.6g} rad ({at / 2 / np.pi:.4g} rev)", at)


def _uniform_q(theta, eps_r, eps_t, n):
    with np.errstate(invalid="ignore", divide="ignore"):
        if n == 2:
            log_q3 = -eps_t * theta / (1 - eps_r)
            rate = theta / (1 - eps_r)  # ln(1 / q3) / eps_t
        elif n == 0:
            if eps_r != 0:
                raise ValueError("the two-scale form of constant acceleration has no radial part")
            log_q3 = 0.25 * np.log1p(-4 * eps_t * theta)
            rate = np.where(eps_t == 0, theta, -log_q3 / eps_t) if eps_t != 0 else theta
        else:
            log_q3 = 0.5 * np.log(_decay(2 * eps_t * theta, 2 * eps_r))
            rate = -log_q3 / eps_t if eps_t != 0 else theta * (1 + 2 * eps_r)
    q3 = np.exp(log_q3)
    turn = np.exp(1j * (2 - n) / 2 * eps_r * rate)
    pair = (eps_r + 2j * eps_t) * (q3 ** (2.5 - n) * turn - q3 ** (2 * n - 3) * np.exp(1j * theta))
    return np.stack([pair.real, pair.imag, q3], axis=-1)


def _decay(x, c):
    """y in (0, ...) with y - 1 - c ln((y + c) / (1 + c)) = -x; NaN where there is none. Newton in y, from the side
    where it converges; x (n,), c scalar > -1."""
    if c == 0:
        return np.where(x < 1, 1 - x, np.nan)
    y = np.ones_like(x)
    least = -1 - c * np.log(c / (1 + c)) if c > 0 else -np.inf
    possible = -x > least
    for _ in range(60):
        f = y - 1 - c * np.log((y + c) / (1 + c)) + x
        step = f * (y + c) / y
        y = np.where(possible, np.maximum(y - step, 0.1 * y), 1.0)
    return np.where(possible, y, np.nan)


def _both_ways(run, theta0, angles) -> dict:
    """Fields of a Solution at angles in any order, from a march that goes one way."""
    n = len(angles)
    q, time, mass, legs = np.empty((n, 3)), np.empty(n), np.ones(n), 0
    for way in (1.0, -1.0):
        index = np.flatnonzero(angles >= theta0 if way > 0 else angles < theta0)
        index = index[np.argsort(way * angles[index], kind="stable")]
        if len(index) == 0:
            continue
        out, t, m = np.empty((len(index), 3)), np.empty(len(index)), np.ones(len(index))
        status, place, count = run(np.ascontiguousarray(angles[index]), out, t, m)
        if status != OK:
            raise BreakdownError(_words(status, place, theta0), float(place))
        q[index], time[index], mass[index] = out, t, m
        legs += int(count)
    return {"theta": angles, "q": q, "time": time, "mass": mass, "legs": legs}


def _words(status, theta, theta0):
    where = f"theta = {theta:.6g} rad, {(theta - theta0) / (2 * np.pi):.4g} rev from the start"
    what = {
        NO_MOMENTUM: "q3 reaches zero, the angular momentum has no bound",
        ASYMPTOTE: "s reaches zero, the radius has no bound",
        HYPERBOLIC: "the orbit to be frozen is no ellipse",
        NO_MASS: "the mass runs out",
        TOO_MANY_LEGS: "the tolerance asks for more legs than there is patience",
    }[status]
    return f"the first-order solution ends at {where}: {what}; shorter arcs, or legs, may reach further"
