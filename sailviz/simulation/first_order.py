"""The first-order analytic solution of a scene, at the times of its run.

Between simulation and design: takes the scene's state and thrust to canonical units, sweeps the angle, and turns the
result, which knows time as a function of angle, round.
"""

from __future__ import annotations

import numpy as np

from sailviz.design import asymptotic
from sailviz.errors import Fault, SceneError

POINTS_PER_REVOLUTION = 96  # of the Hermite cubic from which places at given times are read: good to 1e-7


class FirstOrder:
    """Positions of a first-order solution at any time of a run."""

    def __init__(self, position, velocity, mu, duration, thrust, leg, scheme, source):
        """position (3,) m and velocity (3,) m/s in the x-y plane. thrust : (radial, transverse, exponent), canonical
        for length |position|. leg : rad or None. duration : s.

        SceneError, naming `source`, where the solution breaks down before the duration is over.
        """
        r0 = float(np.linalg.norm(position))
        self._length, self._time = r0, np.sqrt(r0**3 / mu)
        speed = r0 / self._time
        theta0 = float(np.arctan2(position[1], position[0]))
        v_r = float(position @ velocity) / r0 / speed
        self._sense = 1.0 if position[0] * velocity[1] - position[1] * velocity[0] > 0 else -1.0
        v_t = float(np.hypot(*velocity[:2] / speed) ** 2 - v_r**2) ** 0.5
        self._theta0 = theta0
        q = asymptotic.from_state(1.0, 0.0, v_r, v_t)
        turns = 1.0
        while True:  # as many revolutions as the duration takes
            theta = np.linspace(0.0, 2 * np.pi * turns, int(POINTS_PER_REVOLUTION * turns) + 1)
            try:
                found = asymptotic.propagate(q, 0.0, theta, *thrust, leg=leg, scheme=scheme)
            except asymptotic.BreakdownError as error:
                days = self._reach(q, thrust, leg, scheme, error.theta) * self._time / 86400
                what = f"the first-order solution breaks down after {days:.4g} d: {error}."
                raise SceneError([Fault("approximation[0]", what)], source) from None
            if found.time[-1] * self._time >= duration:
                break
            turns *= 1.5
        self._found = found

    @staticmethod
    def _reach(q, thrust, leg, scheme, theta):
        """Canonical time shortly before the angle at which the solution ends."""
        return asymptotic.propagate(q, 0.0, [0.98 * theta], *thrust, leg=leg, scheme=scheme).time[-1]

    def positions(self, time):
        """(n, 3) m at times (n,) s since the start."""
        from scipy.interpolate import CubicHermiteSpline

        s = self._found
        rate = s.transverse_speed / s.radius  # d theta / dt
        t = np.asarray(time, dtype=float) / self._time
        theta = CubicHermiteSpline(s.time, s.theta, rate)(t)
        r = CubicHermiteSpline(s.time, s.radius, s.radial_speed)(t)
        angle = self._theta0 + self._sense * theta
        return self._length * np.column_stack([r * np.cos(angle), r * np.sin(angle), np.zeros_like(r)])
