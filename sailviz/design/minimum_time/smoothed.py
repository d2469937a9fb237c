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

from sailviz.compiled import compiled, inlined


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


@compiled
def _shoot(y, time, steps, a_c, width, pitch, throttle):
    """Advance y (7,) = r, theta, u, v and costates by classical Runge-Kutta steps, filling pitch and throttle."""
    h = time / steps
    for n in range(steps):
        size = np.sqrt(y[5] * y[5] + y[6] * y[6])
        alpha = 0.5 * np.arctan2(y[6], y[5])
        switch = (3.0 * y[5] + size) / size
        tau = 0.5 * (1.0 + np.tanh(switch / width))
        pitch[n], throttle[n] = alpha, tau
        f, g = 0.25 * a_c * tau * (3.0 + np.cos(2.0 * alpha)), 0.25 * a_c * tau * np.sin(2.0 * alpha)
        k = _rates(y[0], y[2], y[3], y[4], y[5], y[6], f, g)
        z = (y[0], y[1], y[2], y[3], y[4], y[5], y[6])
        for j in range(7):
            y[j] = z[j] + h / 6.0 * k[j]
        for weight, part in ((2.0, 0.5), (2.0, 0.5), (1.0, 1.0)):
            x = part * h
            r, u, v = z[0] + x * k[0], z[2] + x * k[2], z[3] + x * k[3]
            k = _rates(r, u, v, z[4] + x * k[4], z[5] + x * k[5], z[6] + x * k[6], f, g)
            for j in range(7):
                y[j] += h / 6.0 * weight * k[j]


def smoothed_transfer(radius, characteristic_acceleration, costates, time, step, width=0.05) -> SmoothedTransfer:
    """Transfer from the circle of radius 1 to another by shooting on the direction of the costates and the time.

    characteristic_acceleration at r = 1; costates (3,) of r, u, v at the start and time: where to begin; step : longest
    hold of the controls. `residual` says whether the shooting converged. It does so locally: other beginnings may lead
    to slower transfers.
    """
    from scipy.optimize import root

    def direction(x):
        return np.array([np.sin(x[1]), np.cos(x[1]) * np.cos(x[0]), np.cos(x[1]) * np.sin(x[0])])

    def fly(x, steps):
        y = np.concatenate([[1.0, 0.0, 0.0, 1.0], direction(x)])
        pitch, throttle = np.empty(steps), np.empty(steps)
        _shoot(y, x[2], steps, characteristic_acceleration, width, pitch, throttle)
        return y, pitch, throttle

    def miss(x, steps):
        y = fly(x, steps)[0]
        return [y[0] - radius, y[2], y[3] - radius**-0.5]

    p, q, s = costates
    x = np.array([np.arctan2(s, q), np.arctan2(p, np.hypot(q, s)), time])
    for _ in range(2):  # the number of steps follows the time found
        steps = max(1, int(np.ceil(x[2] / step)))
        x = root(miss, x, args=(steps,), tol=1e-13).x
    y, pitch, throttle = fly(x, steps)
    return SmoothedTransfer(x[2], y[1], pitch, throttle, direction(x), float(np.abs(miss(x, steps)).max()))
