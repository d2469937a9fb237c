"""Where the steering points the sail or the tethers."""

from __future__ import annotations

import numpy as np
from independent.designed_orbits import designed
from independent.primers import PRIMERS, most_along
from independent.sky import from_light, north
from independent.thrust_history import smoothed
from scipy.interpolate import CubicSpline


def normal(scene, t, r, v):
    """Unit vector that the steering asks for."""
    steering, out = scene.steering, from_light(scene, t, r)
    r_hat = out / np.linalg.norm(out)  # from the light
    kind = steering.kind if steering else "radial"
    if kind in ("radial", "sun-facing", "vertical"):
        return r_hat
    if kind == "tangential":
        return v / np.linalg.norm(v)
    if kind == "inertial":
        return np.array(steering.direction) / np.linalg.norm(steering.direction)
    if kind in PRIMERS:
        return most_along(scene, r_hat, PRIMERS[kind](scene, t, r, v))
    if kind == "on-off":
        across = np.cross(r_hat, v)
        return r_hat if v @ r_hat > 0 else across / np.linalg.norm(across)
    frame = "orbital"
    if kind == "circumferential":
        pitch, clock = np.pi / 2, np.pi / 2
    elif kind == "as designed":
        pitch, clock, _ = designed(scene, t)
        if pitch == 0:  # along the Sun line: no plane of motion is needed, and there may be none
            return r_hat
    elif kind == "smoothed-transfer":
        times, angles, _ = smoothed(scene)
        pitch, clock = angles[np.searchsorted(times, t, side="right") - 1], np.pi / 2
    elif kind == "table":
        frame = steering.frame
        pitch, clock = (table(steering, column, t) for column in (steering.pitch, steering.clock))
    elif kind in ("orbital", "meridian", "sun-frame"):
        frame, pitch, clock = kind, steering.pitch, steering.clock
    else:
        raise NotImplementedError(kind)
    pole = north(scene) if frame == "sun-frame" and steering.reference != "orbit" else np.array([0.0, 0.0, 1.0])
    turns = frame == "orbital" or (frame == "sun-frame" and steering.reference == "orbit")
    up = np.cross(r, v) if turns else pole
    up = up - (up @ r_hat) * r_hat
    up = up / np.linalg.norm(up)
    along = np.cross(up, r_hat)
    return np.cos(pitch) * r_hat + np.sin(pitch) * (np.sin(clock) * along + np.cos(clock) * up)


def table(steering, column, t):
    """Value of a column of a steering table at time t; the first and the last row hold before and after."""
    times = np.array(steering.time)
    t = np.clip(t, times[0], times[-1])
    if steering.interpolation == "hold":
        return column[np.searchsorted(times, t, side="right") - 1]
    return np.interp(t, times, column) if steering.interpolation == "linear" else CubicSpline(times, column)(t)
