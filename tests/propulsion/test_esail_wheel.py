"""Wheels of electric sails as bodies: rows of the source, and sums over tethers written out."""

import numpy as np
import pytest

from sailviz.propulsion import electric_sail
from sailviz.propulsion.esail_wheel import Bend, parabola, spin_up, straight, wheel_force

SIGMA, TETHERS, LENGTH = 4.5511e-7, 20, 15e3  # N/m, m: of the source


@pytest.mark.parametrize(
    ("cone", "pitch", "torque", "share", "left"),
    [(3, 30, 26.795944176, 0.060515290953, 0.941742052), (5, 45, 63.107344647, 0.174977327052, 0.843275128)],
)
def test_a_coned_wheel_is_turned_and_held_as_the_source_has_it(cone, pitch, torque, share, left):
    b, a = np.radians([cone, pitch])
    held, turns, e = wheel_force(float(b), a)
    free, _, none = wheel_force(float(b), a, held=False)
    assert TETHERS * SIGMA * LENGTH**2 * turns == pytest.approx(torque, rel=1e-9)
    assert e == pytest.approx(share, abs=6e-13)
    assert none == 0
    assert np.linalg.norm(held) / np.linalg.norm(free) == pytest.approx(left, abs=6e-10)


def summed(places, tangents, weights, pitch, share):
    """Force over N sigma L and torque over N sigma L^2 of seven tethers of pieces at places (n, 2) out and downwind,
    with tangents (n, 2) and lengths (n,), their voltage 1 + share cos(zeta) over its largest."""
    u = np.array([np.sin(pitch), 0.0, np.cos(pitch)])
    force, torque, length = np.zeros(3), np.zeros(3), weights.sum()
    for k in range(7):
        zeta = 2 * np.pi * k / 7 + 0.3
        out = np.array([np.cos(zeta), np.sin(zeta), 0.0])
        for (x, z), (c, s), w in zip(places, tangents, weights, strict=True):
            along = c * out + s * np.array([0.0, 0.0, 1.0])
            piece = w * (1 + share * np.cos(zeta)) / (1 + share) * (u - (u @ along) * along)
            force += piece / (7 * length)
            torque += np.cross(x * out + z * np.array([0.0, 0.0, 1.0]), piece) / (7 * length**2)
    return force, torque


def pieces(rise: float):
    """Points of a parabola."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    x = 0.5 * (nodes + 1)
    slope = np.arctan(2 * rise * x)
    return (
        np.stack([x, rise * x * x], 1),
        np.stack([np.cos(slope), np.sin(slope)], 1),
        0.5 * weights / np.cos(slope),
    )


def cone(angle: float):
    """Points of a straight tether of length 1."""
    nodes, weights = np.polynomial.legendre.leggauss(10)
    s = 0.5 * (nodes + 1)
    way = np.array([np.cos(angle), np.sin(angle)])
    return s[:, None] * way, np.tile(way, (10, 1)), 0.5 * weights


@pytest.mark.parametrize("pitch", [0.2, 0.7, 1.2])
@pytest.mark.parametrize(
    ("bend", "points"), [(straight(0.15), cone(0.15)), (parabola(0.1), pieces(0.1)), (parabola(0.6), pieces(0.6))]
)
def test_the_five_means_make_the_sum_over_tethers(bend, points, pitch):
    """And the share of the voltage leaves no torque across the axis, nor along it."""
    held, turns, share = wheel_force(bend, pitch)
    force, torque = summed(*points, pitch, float(share))
    normal, across = np.array([np.cos(pitch), np.sin(pitch)]), np.array([np.sin(pitch), -np.cos(pitch)])
    assert held @ normal == pytest.approx(force[2], rel=1e-12)
    assert held @ across == pytest.approx(force[0], rel=1e-12)
    assert np.abs(torque).max() < 1e-13
    _, alone = summed(*points, pitch, 0.0)
    assert alone[1] == pytest.approx(float(turns), rel=1e-12)


def test_a_flat_wheel_is_the_final_model_and_has_no_torque():
    pitch = np.linspace(0, 1.4, 15)
    force, torque, share = wheel_force(0.0, pitch)
    size = np.linalg.norm(force, axis=1)
    np.testing.assert_allclose(size, electric_sail.dimensionless_acceleration(pitch), rtol=1e-14)
    np.testing.assert_allclose(np.arctan2(force[:, 1], force[:, 0]), electric_sail.cone_angle(pitch), atol=1e-14)
    assert not torque.any()
    assert not share.any()


@pytest.mark.parametrize("rise", [0.02, 0.05, 0.1])
def test_the_torque_of_a_shallow_wheel_is_that_of_its_tips(rise):
    """(N sigma L / 2) z_tip sin(pitch): within a share of the rise's square, of whichever shape."""
    _, turns, _ = wheel_force(parabola(rise), 0.5)
    reach = 1 / pieces(rise)[2].sum()  # over the length of a tether
    assert float(turns) == pytest.approx(0.5 * rise * reach * np.sin(0.5), rel=1.1 * rise**2)
    _, turns, _ = wheel_force(float(np.arcsin(rise)), 0.5)
    assert float(turns) == pytest.approx(0.5 * rise * np.sin(0.5), rel=1e-12)


@pytest.mark.parametrize(
    ("pitch", "turns", "ratio"), [(20, 1, 9.8442982350), (35, 0.5, 9.0229096352), (-20, 1, 0.1015816441)]
)
def test_a_wheel_that_follows_the_sun_line_spins_as_the_source_has_it(pitch, turns, ratio):
    assert float(spin_up(np.radians(pitch), 2 * np.pi * turns)) == pytest.approx(ratio, abs=6e-11)


def test_a_rigid_wheel_turned_by_its_tethers_drifts_as_the_formula_says():
    """Flat, its axis at a steady pitch behind or before a Sun line that turns evenly: each tether's torque summed, the
    voltage's harmonic as large as the turn asks for, Euler's equation along the axis integrated."""
    pitch, inertia, steps = np.radians(25), 1.0, 4000
    spin, way = 1.0, 1.5 / steps
    zeta = 2 * np.pi * np.arange(5) / 5
    u, out = np.array([np.sin(pitch), 0, np.cos(pitch)]), np.stack([np.cos(zeta), np.sin(zeta), 0 * zeta], 1)
    wind = u - (out @ u)[:, None] * out
    unit = np.mean(np.sin(zeta)[:, None] * np.cross(0.5 * out, wind), axis=0)  # torque of a sine of size 1
    for _ in range(steps):  # the Sun line runs away along -x as the axis leads the motion: dn = -x
        middle = spin
        for _ in range(3):
            share = -inertia * middle * way / unit[0]
            middle = spin + 0.5 * share * unit[2] / inertia
        spin += share * unit[2] / inertia
    assert spin == pytest.approx(float(spin_up(pitch, 1.5)), rel=1e-6)


def test_a_bend_says_its_means_over_the_length():
    assert straight(0.0) == Bend(1.0, 0.0, 0.0, 0.0, 0.5)
    assert parabola(1e-9) == pytest.approx(straight(0.0), abs=1e-8)
