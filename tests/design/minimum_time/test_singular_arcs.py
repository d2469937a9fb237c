"""Arcs that do not switch by themselves: the singular throttle against differences, and flown into the past."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.design.minimum_time.singular_arcs import fly_arcs, propagate_arcs, switching
from sailviz.design.minimum_time.state_costate import SWITCH, canonical_sail

DEVICES = ("electric-sail", "electric-sail-original", "electric-sail-updated", "electric-sail-polynomial")


def unit(x):
    return x / np.linalg.norm(x)


def at_the_switch(seed, sail):
    """State and costates in space whose primer stands at the angle of the switch."""
    rng, cosine = np.random.default_rng(seed), sail.parameters[SWITCH]
    r = rng.uniform(1.2, 2.0) * unit(rng.normal(size=3))
    p = cosine * unit(r) + np.sqrt(1 - cosine**2) * unit(np.cross(r, rng.normal(size=3)))
    return np.concatenate([r, 0.4 * rng.normal(size=3), rng.normal(size=3), 1.7 * p])


def curve(y, arc, sail, h=2e-3):
    """S' and S'' of S / |p| |p| along an arc through y, by differences over a step to either side."""
    ends = fly_arcs(np.vstack([y, y, y]), arc, np.array([[-h], [0.0], [h]]), sail)[-1]
    s = switching(ends, sail).value * np.linalg.norm(ends[:, 9:], axis=1)
    return (s[2] - s[0]) / (2 * h), (s[2] - 2 * s[1] + s[0]) / h**2


@pytest.mark.parametrize("device", DEVICES)
def test_singular_throttle_is_what_differences_of_the_switching_function_ask_for(device):
    """S'' = D without thrust and D + B with it, so tau = -D / B; in space, for every model."""
    sail = canonical_sail(device, 2e-3)
    for seed in range(4):
        y = at_the_switch(seed, sail)
        (first, without), (_, thrust) = curve(y, "C", sail), curve(y, "T", sail)
        found = switching(y[None], sail)
        assert thrust > without  # the Kelley condition, strengthened
        assert found.rate[0] * 1.7 == pytest.approx(first, abs=1e-5)
        assert found.throttle[0] == pytest.approx(-without / (thrust - without), rel=1e-4)


def test_an_arc_into_the_past_undoes_one_into_the_future():
    sail = canonical_sail("electric-sail", 1e-3)
    y = at_the_switch(1, sail)[None]
    there = fly_arcs(y, "TC", np.array([[0.7, 0.4]]), sail)[-1]
    back = fly_arcs(there, "CT", np.array([[-0.4, -0.7]]), sail)[-1]
    assert np.abs(back - y).max() < 1e-11
    flown = propagate_arcs(y[0], [("thrust", 0.7), ("coast", 0.4)], sail, times=[0.0, 0.7, 1.1])
    assert np.abs(flown.rows[-1] - there[0]).max() < 1e-12
    assert flown.switches.tolist() == [0.7]
