"""Fast electric-sail transfer between coplanar circles with a voltage that falls smoothly towards the coasts.

The indirect solution of the minimum-time problem for the final thrust model (3.39), its on/off switch replaced by
tau = (1 + tanh(S / (width |lambda_v|))) / 2 with S = 3 lambda_u + |lambda_v|, lambda_v = (lambda_u, lambda_v) the
costates of the velocity: partial voltage near the switches, and a little more time than the true optimum. tau enters
the equations of state and costates as a given number, without terms of its derivative, and pitch and tau are held over
every one of many equal steps: what comes out is a steering table, to be flown as it stands. Canonical units,
mu = r0 = 1. Equations re-derived.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sailviz.compiled import entry, inlined

R, THETA, U, V, LAM_R, LAM_U, LAM_V = range(7)  # what stands where in a state: r, angle, speeds and their costates
SIZE = 7
AT_ONCE = 100_000  # steps in one piece of compiled work, which hears no Ctrl-C: 0.1 s


@dataclass(frozen=True)
class SmoothedTransfer:
    """time : duration; angle : swept, rad; pitch rad (negative: towards the Sun) and throttle, each (steps,), held from
    i time / steps on; costates (3,) of r, u, v at the start, of length 1; residual : largest end error in r, u, v."""

    time: float
    angle: float
    pitch: np.ndarray
    throttle: np.ndarray
    costates: np.ndarray
    residual: float


@inlined
def _rates(r, u, v, p, q, s, radial, transverse):
    """Derivatives of r, theta, u, v and of the costates p, q, s of r, u, v; thrust radial / r, transverse / r."""
    i = 1.0 / r
    w = v * i
    return (
        u,
        w,
        v * w - i * i + radial * i,
        -u * w + transverse * i,
        i * i * (q * (v * v - 2.0 * i + radial) - s * (u * v - transverse)),
        -p + s * w,
        (s * u - 2.0 * q * v) * i,
    )


@entry("D1 d i d d D1 D1 i i")
def _shoot(y, time, steps, a_c, width, pitch, throttle, first, last):
    """Advance y (7,), laid out as above, by classical Runge-Kutta steps from the first to before the last, filling
    their pitch and throttle (steps,)."""
    h = time / steps
    for n in range(first, last):
        r0, u0, v0, p, q, s = y[R], y[U], y[V], y[LAM_R], y[LAM_U], y[LAM_V]
        size = np.sqrt(q * q + s * s)
        alpha = 0.5 * np.arctan2(s, q)
        switch = (3.0 * q + size) / size
        tau = 0.5 * (1.0 + np.tanh(switch / width))
        pitch[n], throttle[n] = alpha, tau
        f, g = 0.25 * a_c * tau * (3.0 + np.cos(2.0 * alpha)), 0.25 * a_c * tau * np.sin(2.0 * alpha)
        k = _rates(r0, u0, v0, p, q, s, f, g)
        for j in range(SIZE):
            y[j] += h / 6.0 * k[j]
        for weight, part in ((2.0, 0.5), (2.0, 0.5), (1.0, 1.0)):
            x = part * h
            r, u, v = r0 + x * k[R], u0 + x * k[U], v0 + x * k[V]
            k = _rates(r, u, v, p + x * k[LAM_R], q + x * k[LAM_U], s + x * k[LAM_V], f, g)
            for j in range(SIZE):
                y[j] += h / 6.0 * weight * k[j]
    return 0


def smoothed_transfer(
    radius: float,
    characteristic_acceleration: float,
    costates: npt.ArrayLike,
    time: float,
    step: float,
    width: float = 0.05,
) -> SmoothedTransfer:
    """Transfer from the circle of radius 1 to another by shooting on the direction of the costates and the time.

    characteristic_acceleration at r = 1; costates (3,) of r, u, v at the start and time: where to begin; step : longest
    hold of the controls. `residual` says whether the shooting converged. It does so locally: other beginnings may lead
    to slower transfers.
    """
    from scipy.optimize import root

    def direction(sideways, upwards):
        """Costates (3,) of r, u, v, of length 1, from two angles."""
        level = np.cos(upwards)
        return np.array([np.sin(upwards), level * np.cos(sideways), level * np.sin(sideways)])

    def fly(unknowns, steps):
        sideways, upwards, duration = unknowns
        y = np.concatenate([[1.0, 0.0, 0.0, 1.0], direction(sideways, upwards)])
        pitch, throttle = np.empty(steps), np.empty(steps)
        for first in range(0, steps, AT_ONCE):
            last = min(first + AT_ONCE, steps)
            _shoot(y, duration, steps, characteristic_acceleration, width, pitch, throttle, first, last)
        return y, pitch, throttle

    def miss(unknowns, steps):
        y, _, _ = fly(unknowns, steps)
        return [y[R] - radius, y[U], y[V] - radius**-0.5]

    p, q, s = np.asarray(costates, dtype=float)
    sideways, upwards, duration = np.arctan2(s, q), np.arctan2(p, np.hypot(q, s)), time
    for _ in range(2):  # the number of steps follows the time found
        steps = max(1, int(np.ceil(duration / step)))
        unknowns = root(miss, [sideways, upwards, duration], args=(steps,), tol=1e-13).x
        sideways, upwards, duration = unknowns
    y, pitch, throttle = fly(unknowns, steps)
    residual = float(np.abs(miss(unknowns, steps)).max())
    return SmoothedTransfer(duration, y[THETA], pitch, throttle, direction(sideways, upwards), residual)
