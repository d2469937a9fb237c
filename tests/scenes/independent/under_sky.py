"""Scenes under a sky, in few words: what flights of reference rows share."""

from __future__ import annotations

import numpy as np

import sailviz
from sailviz.constants import MU_EARTH

DE421 = {"epoch": "2026-03-20T00:00:00", "ephemeris": "de421"}
R_GEO = 42_164_169.0
GEO = {"kind": "cartesian", "position_m": [R_GEO, 0, 0], "velocity_m_s": [0, float(np.sqrt(MU_EARTH / R_GEO)), 0]}
DARKLESS = {"shadow_of": []}


def elements(a, e, i, node, argument, anomaly):
    return {
        "kind": "elements", "semi_major_axis_km": a, "eccentricity": e, "inclination_deg": i, "raan_deg": node,
        "argument_deg": argument, "true_anomaly_deg": anomaly,
    }  # fmt: skip


def sail(strength):
    return {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 1e3 * strength}


def locally(goal, **more):
    return {"kind": "locally-optimal", "goal": goal, **more}


def fly(days, tolerance=1e-13, outputs=2, **scene):
    given = {"title": "under a sky", "device": {"kind": "none"}, "body": "earth", **scene}
    given["propagation"] = {"duration_d": days, "outputs": outputs, "tolerance": tolerance}
    return sailviz.simulate(given)
