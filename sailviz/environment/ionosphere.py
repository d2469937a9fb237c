"""Plasma around the Earth as a plasma brake meets it: exponential profiles of the drag itself or of the density."""

from __future__ import annotations

import numpy as np

from sailviz.compiled import inlined

FORCE_PROFILE, DENSITY_PROFILE = 0, 1
PROFILES = {"exponential-force": FORCE_PROFILE, "exponential-density": DENSITY_PROFILE}


@inlined
def exponential(altitude, reference_altitude, value, scale_height):
    """value exp(-(h - h0) / H); all lengths in m."""
    return value * np.exp((reference_altitude - altitude) / scale_height)
