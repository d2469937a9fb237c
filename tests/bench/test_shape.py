"""A sail of any shape: what one look into its table costs, and its table. Thread CPU time."""

import time

import numpy as np
import pytest

from sailviz.propulsion import shaped_sail
from sailviz.shapes import membranes, shadows, structures
from sailviz.shapes.facets import Coefficients, Shape, Surface
from sailviz.shapes.light_table import build

BLACK = Coefficients(0.5, 0.0, 0.0)


def sail() -> Shape:
    """9 m square with a bus and booms, 1,628 facets."""
    b = Coefficients(0.0723, 0.8554, -0.0030)
    film = membranes.square(9.0, Surface(b, Coefficients(0.35, 0.3, 0.02)))
    bus = structures.bus([0.6, 0.6, 1.0], [0, 0, -0.6], BLACK)
    return Shape((film, bus, structures.booms(structures.boom_tips(9.0), 0.01, BLACK, 0.02)))


def test_a_look_into_the_table_takes_less_than_sixty_nanoseconds():
    """Force and torque by tensors and straight lines, at random directions; cubics for comparison."""
    u = np.random.default_rng(1).normal(size=(200_000, 3))
    u, out = u / np.linalg.norm(u, axis=1)[:, None], np.empty((len(u), 6))
    for interpolation in ("bicubic", "bilinear"):
        numbers = build(sail(), 32, shadow=False, interpolation=interpolation).numbers
        best = np.inf
        for _ in range(20):
            begin = time.thread_time()
            shaped_sail._read(u, numbers, out)
            best = min(best, time.thread_time() - begin)
        print(f"{interpolation}: {best / len(u) * 1e9:.1f} ns")
    assert best / len(u) < 60e-9


@pytest.mark.skipif(shadows.ray_caster() != "embreex", reason="embreex is not installed")
def test_a_table_with_shadows_takes_less_than_ten_seconds():
    """32 cells along a side, some 1,700 facets: 6,146 directions, one ray a lit facet."""
    shape = sail()
    assert 1600 < len(shape.elements) < 1800
    begin = time.process_time()
    build(shape, 32)
    took = time.process_time() - begin
    print(f"{took:.1f} s")
    assert took < 10
