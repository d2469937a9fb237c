"""Passages of the perihelion on conics, and where bodies of the catalogue stand."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from sailviz import elements, two_body
from sailviz.checks.gtoc13.rules import MU
from sailviz.exchange.gtoc13 import CompetitionBody

Floats = NDArray[np.float64]

MOST_TURNS = 100_000  # of one conic that are counted one by one; 200 years at 0.01 au are fewer


def body_state(body: CompetitionBody, time: Floats) -> tuple[Floats, Floats]:
    """Position (n, 3) m and velocity (n, 3) m/s of a body of the catalogue at times (n,) s."""
    a, e = body.semi_major_axis, body.eccentricity
    anomaly = np.remainder(body.mean_anomaly + math.sqrt(MU / a**3) * np.asarray(time, float), 2 * np.pi)
    eccentric = anomaly + e * np.sin(anomaly)
    for _ in range(60):
        step = (eccentric - e * np.sin(eccentric) - anomaly) / (1 - e * np.cos(eccentric))
        eccentric = eccentric - np.clip(step, -1.0, 1.0)
        if np.all(np.abs(step) < 1e-14):
            break
    true = 2 * np.arctan2(math.sqrt(1 + e) * np.sin(eccentric / 2), math.sqrt(1 - e) * np.cos(eccentric / 2))
    return elements.state(a, e, body.inclination, body.node, body.argument, true, MU)


def period(body: CompetitionBody) -> float:
    """Of a body's orbit, s."""
    return 2 * math.pi * math.sqrt(body.semi_major_axis**3 / MU)


def on_conic(position: Floats, velocity: Floats, span: float, turns_back: bool) -> list[tuple[float, float]]:
    """(time after the start s, distance m) of every passage of the perihelion on a conic.

    position (3,) m, velocity (3,) m/s at the start; span s; turns_back : whether the craft comes closer at the start
    and goes away at the end, as its rows say.
    """
    orbit = elements.elements(position[None], velocity[None], MU)
    e, a = float(orbit.eccentricity[0]), float(orbit.semi_major_axis[0])
    momentum = float(np.sum(np.cross(position, velocity) ** 2))
    nearest = momentum / MU / (1 + e)
    if not (a > 0 and e < 1):
        return [(_closest(position, velocity, span), nearest)] if turns_back else []
    turn = 2 * math.pi * math.sqrt(a**3 / MU)
    r = float(np.linalg.norm(position))
    eccentric = math.atan2(float(position @ velocity) / math.sqrt(MU * a), 1 - r / a)
    due = -(eccentric - e * math.sin(eccentric)) / (2 * math.pi) * turn  # of the passage nearest to the start
    first = due if due >= 0 else due + turn
    count = math.floor((span - first) / turn) + 1 if span >= first else 0
    return [(first + k * turn, nearest) for k in range(min(count, MOST_TURNS))]


def _closest(position: Floats, velocity: Floats, span: float) -> float:
    """When on an open conic the craft stops coming closer: by halving."""
    low, high = 0.0, span
    for _ in range(50):
        middle = 0.5 * (low + high)
        place, speed = two_body.advance(position[None], velocity[None], [middle], MU)
        low, high = (middle, high) if np.sum(place * speed) < 0 else (low, middle)
    return high
