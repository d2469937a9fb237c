"""Motion on any conic keeps energy and angular momentum, and leads back to where it began."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import AU, MU_SUN
from sailviz.elements import state
from sailviz.two_body import advance


@pytest.mark.parametrize("e", [0.0, 1e-9, 0.3, 0.9, 0.999, 1.0001, 1.5, 5.0])
@pytest.mark.parametrize("span", [1e3, -1e5, 1e7, -1e8, 1e9])
def test_it_keeps_energy_and_angular_momentum_and_leads_back(e, span):
    a = AU if e < 1 else -AU
    edge = np.pi if e < 1 else np.arccos(-1 / e)
    nu = np.linspace(-0.9, 0.9, 12) * edge
    r, v = state(np.full(12, a), np.full(12, e), 0.7, 1.0, 2.0, nu, MU_SUN)
    far, fast = advance(r, v, np.full(12, span), MU_SUN)
    back, _ = advance(far, fast, np.full(12, -span), MU_SUN)
    size, speed = np.linalg.norm(far, axis=1), np.linalg.norm(fast, axis=1)

    def energy(place, rate):
        return np.sum(rate * rate, axis=1) / 2 - MU_SUN / np.linalg.norm(place, axis=1)

    scale = np.sum(v * v, axis=1) / 2 + MU_SUN / np.linalg.norm(r, axis=1)
    assert np.abs(energy(far, fast) - energy(r, v)).max() < 1e-13 * scale.max()
    turn = np.linalg.norm(np.cross(far, fast) - np.cross(r, v), axis=1)
    assert np.max(turn / (size * speed)) < 1e-9
    assert np.max(np.linalg.norm(back - r, axis=1) / size) < 2e-8  # near a parabola the period is known to fewer digits


def test_a_circle_turns_uniformly():
    rate = np.sqrt(MU_SUN / AU**3)
    spans = np.array([0.0, 0.25, 0.5, 10.25]) * 2 * np.pi / rate
    r, v = np.tile([AU, 0.0, 0.0], (4, 1)), np.tile([0.0, AU * rate, 0.0], (4, 1))
    place, _ = advance(r, v, spans, MU_SUN)
    assert np.abs(place / AU - [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, 1, 0]]).max() < 1e-13
