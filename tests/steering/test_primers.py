"""Primers of the locally optimal laws against differences of the elements, and what the steered sails do with them."""

from __future__ import annotations

from dataclasses import astuple

import numpy as np
import pytest

from sailviz import elements
from sailviz.compiled import compiled
from sailviz.propulsion import electric_sail, solar_sail
from sailviz.propulsion.devices import sail
from sailviz.steering import primers
from sailviz.steering.optimal import analytic_pitch, optimal_pitch, towards_primer, towards_primer_analytic

MU = 1.3
ORBIT = (1.1, 0.3, 0.7, 0.5, 1.9, 2.3)  # a, e, i, raan, argument, true anomaly


@compiled
def primer(kind, r, v, mu):
    return primers.locally_optimal_primer(kind, r[0], r[1], r[2], v[0], v[1], v[2], mu)


@compiled
def lyapunov(r, v, mu, p):
    return primers.lyapunov_primer(r[0], r[1], r[2], v[0], v[1], v[2], mu, p, 1)[:3]


@compiled
def normals(kind, p, u, lam, analytic):
    if analytic:
        return towards_primer_analytic(p, 0, u[0], u[1], u[2], lam[0], lam[1], lam[2])
    return towards_primer(kind, p, 0, 1.0, u[0], u[1], u[2], lam[0], lam[1], lam[2])


def gradient(quantity, r, v, step=1e-5):
    """Central differences of fourth order of a function of position and velocity, by the velocity."""
    rows = np.eye(3) * step
    first = np.array([quantity(r, v + d) - quantity(r, v - d) for d in rows])
    second = np.array([quantity(r, v + 2 * d) - quantity(r, v - 2 * d) for d in rows])
    return (8 * first - second) / (12 * step)


def element(name):
    if name == "energy":
        return lambda r, v: v @ v / 2 - MU / np.linalg.norm(r)
    if name in ("apogee", "perigee"):
        distance = {"apogee": elements.apoapsis, "perigee": elements.periapsis}[name]
        return lambda r, v: float(distance(elements.elements(r, v, MU)))
    place = ["semi-major-axis", "eccentricity", "inclination", "raan", "argument"].index(name)
    return lambda r, v: float(astuple(elements.elements(r, v, MU))[place])


@pytest.mark.parametrize("name", primers.GOALS)
@pytest.mark.parametrize("nu", [0.2, 2.3, 4.4])
def test_primer_is_the_gradient_of_the_element(name, nu):
    """1e-8: rounding of the elements over the step of the differences."""
    r, v = elements.state(*ORBIT[:5], nu, MU)
    assert primer(primers.GOALS[name], r, v, MU) == pytest.approx(gradient(element(name), r, v), abs=1e-8)


def equinoctial(r, v):
    a, e, i, raan, argument, _ = map(float, astuple(elements.elements(r, v, MU)))
    long = raan + argument
    tilt = np.tan(i / 2)
    return np.array([a * (1 - e * e), e * np.cos(long), e * np.sin(long), tilt * np.cos(raan), tilt * np.sin(raan)])


def test_lyapunov_primer_is_the_way_down_the_squared_distance_to_the_target():
    p = np.array([0.0, 1.5, 0.1, -0.05, 0.02, 0.3, 1.0, 2.0, 3.0, 4.0, 5.0, 1.5, 0.7, 0.8, 0.9, 1.1, 1e-9])
    targets, weights, scales = p[1:6], p[6:11], p[11:16]
    r, v = elements.state(*ORBIT, MU)

    def distance(r, v):
        return np.sum(weights * ((equinoctial(r, v) - targets) / scales) ** 2)

    assert lyapunov(r, v, MU, p) == pytest.approx(-gradient(distance, r, v), abs=1e-8)


def test_primers_exist_on_circles_in_the_reference_plane():
    """Along the motion to grow an eccentricity, along the normal to grow an inclination; no node or apsis to turn."""
    r, v = np.array([1.0, 0, 0]), np.array([0, np.sqrt(MU), 0])
    assert primer(primers.ECCENTRICITY, r, v, MU) == pytest.approx([0, 2 / np.sqrt(MU), 0])
    assert primer(primers.INCLINATION, r, v, MU) == pytest.approx([0, 0, 1 / np.sqrt(MU)])
    assert primer(primers.RAAN, r, v, MU) == primer(primers.ARGUMENT, r, v, MU) == (0, 0, 0)


DEVICES = ["ideal", "jpl-1978", "electric-sail", "electric-sail-original", "electric-sail-polynomial"]


@pytest.mark.parametrize("device", DEVICES)
def test_normal_lies_between_sun_line_and_primer_at_the_optimal_pitch(device):
    kind, p = sail(device, 1.0, 1.0)
    u = np.array([0.6, -0.48, 0.64])
    rng = np.random.default_rng(3)
    for lam in rng.normal(size=(20, 3)):
        *n, on = normals(kind, np.array([*p, 0.0]), u, lam, False)
        angle = np.arctan2(np.linalg.norm(np.cross(u, lam)), u @ lam)
        found = optimal_pitch(angle, device)
        assert np.linalg.norm(n) == pytest.approx(1, abs=1e-14)
        assert np.arctan2(np.linalg.norm(np.cross(u, n)), u @ n) == pytest.approx(found.pitch, abs=1e-12)
        assert np.dot(n, np.cross(u, lam)) == pytest.approx(0, abs=1e-14)
        assert (on > 0) == found.on
        assert np.dot(n, lam) >= (u @ lam) * np.dot(u, n) - 1e-14  # leaning to the primer's side


@pytest.mark.parametrize("device", DEVICES)
def test_radial_and_vanished_primers_give_finite_normals(device):
    kind, p = sail(device, 1.0, 1.0)
    for u in np.eye(3):
        assert normals(kind, np.array([*p, 0.0]), u, 2 * u, False) == pytest.approx((*u, 1))
        for lam in (-u, 0 * u):
            *n, on = normals(kind, np.array([*p, 0.0]), u, lam, False)
            assert np.linalg.norm(n) == pytest.approx(1)
            assert on == 0


def test_analytic_normal_has_the_analytic_pitch():
    kind, p = sail("jpl-2015", 1.0, 1.0)
    u = np.array([1.0, 0, 0])
    for angle in (0.0, 0.3, 1.4, 2.5, 2.7, 3.1):
        *n, on = normals(kind, np.array([*p, 0.0]), u, np.array([np.cos(angle), 0, np.sin(angle)]), True)
        found = analytic_pitch(angle, "jpl-2015")
        assert np.arctan2(n[2], n[0]) == pytest.approx(found.pitch, abs=1e-14)
        assert on == found.on


def test_no_attitude_changes_an_element_faster():
    """5,000 random attitudes of an optical sail and of an E-sail lose against the law for every element."""
    r, v = elements.state(*ORBIT, MU)
    u = r / np.linalg.norm(r)
    attitudes = np.random.default_rng(4).normal(size=(5000, 3))
    attitudes /= np.linalg.norm(attitudes, axis=1)[:, None]
    position = np.broadcast_to(u * solar_sail.AU, attitudes.shape)
    forces = {
        "jpl-1978": lambda n: solar_sail.acceleration(position[: len(n)], n, 1.0, "jpl-1978"),
        "electric-sail": lambda n: electric_sail.acceleration(position[: len(n)], n, 1.0),
    }
    for device, force in forces.items():
        kind, p = sail(device, 1.0, 1.0)
        rates = force(attitudes)
        for goal in primers.GOALS.values():
            for sign in (1, -1):
                lam = sign * np.array(primer(goal, r, v, MU))
                *n, on = normals(kind, np.array([*p, 0.0]), u, lam, False)
                best = (on > 0) * (force(np.array([n])) @ lam)[0]
                assert best >= (rates @ lam).max() - 1e-12
