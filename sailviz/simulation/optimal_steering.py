"""A minimum-time flight of a scene: from its initial costates to the primer that its sail follows in time."""

from __future__ import annotations

import numpy as np

from sailviz import frames
from sailviz.constants import MU_SUN
from sailviz.design.minimum_time.replay import Solved, from_planar, primer_history
from sailviz.errors import Fault, SceneError
from sailviz.steering.optimal import optimal_pitch


def primer_table(scene, position, velocity, device, characteristic_acceleration, begin=0.0):
    """Rows (n, 7): time s, primer (3), its rate (3), inertial, from `begin` s to the end of the run; and (time s,
    "thrust on" | "thrust off") of every switch.

    position m, velocity m/s (3,) at `begin`; device : the sail that the law reckons with, a name or a Film. SceneError
    where the costates lead nowhere.
    """
    duration, numbers = scene.propagation.duration - begin, np.asarray(scene.steering.costates, dtype=float)
    try:
        if len(numbers) == 3:
            start = planar_start(position, velocity, numbers)
            radius = float(np.linalg.norm(position))
            solved = from_planar(start, radius, duration, device, characteristic_acceleration)
        else:
            solved = Solved(position, velocity, numbers, duration, device, characteristic_acceleration)
        found = primer_history(solved)
    except ValueError as error:
        raise SceneError([Fault("steering.costates", f"{error}.")], scene.source) from None
    return np.column_stack([begin + found.time, found.primer, found.rate]), _switches(found, device, begin)


def _switches(found, device, begin):
    """(time s, word) of a flight's switches, from whether it begins with thrust."""
    r, primer = found.position, found.primer[0]
    on = bool(optimal_pitch(np.arctan2(np.linalg.norm(np.cross(r, primer)), r @ primer), device).on)
    words = ("thrust off", "thrust on") if on else ("thrust on", "thrust off")
    return tuple((begin + float(time), words[i % 2]) for i, time in enumerate(found.switches))


def planar_start(position, velocity, costates):
    """State and costates (12,), Cartesian, in units of mu = 1 and the distance |position|, from the costates of
    radius, radial and transverse speed."""
    r = np.linalg.norm(position)
    axes = frames.rtn(position, velocity)
    speed = np.asarray(velocity) / np.sqrt(MU_SUN / r)
    lam_r, lam_u, lam_v = costates
    u, v = speed @ axes[0], speed @ axes[1]
    lam_position = lam_r * axes[0] + (lam_u * v - lam_v * u) * axes[1]
    return np.concatenate([np.asarray(position) / r, speed, lam_position, lam_u * axes[0] + lam_v * axes[1]])
