"""Constant thrust from a circle: the books' formulas to their digits, the exact motion, and what lies between."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz.design import special_thrust

EXACT = 1e-11  # relative, of the reference integrations


@pytest.mark.parametrize(
    ("a", "radius", "time", "angle"),
    [
        (0.126, 4.968253968, 25.871878467, 7.417608070),
        (0.15, 4.333333333, 11.831267500, 4.082561530),
        (0.5, 2.0, 2.168627099, None),
        (1.0, 1.5, 1.027069728, None),  # the table says ...718; three integrations say this
    ],
)
def test_radial_escape_is_the_tabled_one(a, radius, time, angle):
    found = special_thrust.radial(a)
    assert found.escape_radius == pytest.approx(radius, abs=0.51e-9)
    assert found.escape_time == pytest.approx(time, abs=0.51e-9)
    assert found.energy(found.escape_radius) == pytest.approx(0, abs=1e-14)
    assert np.isnan(found.turning_radius)
    if angle:
        assert found.escape_angle == pytest.approx(angle, abs=0.51e-9)
    exact = found.exact
    assert exact.radius == pytest.approx(found.escape_radius, rel=EXACT)
    assert exact.time == pytest.approx(found.escape_time, rel=EXACT)
    assert exact.angle == pytest.approx(found.escape_angle, rel=EXACT)


@pytest.mark.parametrize(
    ("a", "turning", "period"),
    [
        (0.05, 1.127016654, 7.562544652),
        (0.1, 1.381966011, 10.787154024930),
        (0.12, 1.666666667, 16.380085546),
        (-0.05, 0.916079783, 5.523914691),
        (-0.5, 0.618033989, 3.251461343),
    ],
)
def test_weak_radial_thrust_turns_back_where_and_when_tabled(a, turning, period):
    found = special_thrust.radial(a)
    assert found.turning_radius == pytest.approx(turning, abs=0.51e-9)
    assert found.period == pytest.approx(period, abs=0.51e-9)
    assert not found.escapes
    assert "turns back at 1" in found.reason or "turns back at 0" in found.reason
    flown = special_thrust.trajectory("radial", a, [0, found.period / 2, found.period])
    assert flown.radius == pytest.approx([1, found.turning_radius, 1], rel=1e-10)
    assert flown.radial_speed == pytest.approx(0, abs=1e-10)
    assert flown.transverse_speed * flown.radius == pytest.approx(1, abs=1e-11)  # (2.13)


def test_escape_needs_more_than_the_threshold():
    at, above, below = special_thrust.radial(np.array([0.125, 0.125 * (1 + 1e-9), 0.125 * (1 - 1e-9)])).escapes
    assert (at, above, below) == (False, True, False)
    threshold = special_thrust.radial(0.125)
    assert threshold.turning_radius == 2  # approached for ever
    assert threshold.period == np.inf
    assert "twice" in threshold.reason
    slow, slower = special_thrust.radial(np.array([0.125 * (1 + 1e-6), 0.125 * (1 + 1e-8)])).escape_time
    # near r = 2 the craft lingers: dt = 4 dy / sqrt(y^2 + d) with a = (1 + d) / 8 and r = 1 + (1 + y)^2
    assert slower - slow == pytest.approx(4 * np.log(100), rel=1e-5)


def test_no_thrust_is_the_limit_of_little_thrust():
    nothing, little = special_thrust.radial(0.0), special_thrust.radial(1e-9)
    assert nothing.turning_radius == 1
    assert nothing.period == pytest.approx(2 * np.pi, rel=1e-13)
    assert little.period == pytest.approx(2 * np.pi, rel=1e-8)
    assert nothing.exact.radius != nothing.exact.radius  # NaN: no escape
    for kind in (special_thrust.circumferential, special_thrust.tangential):
        found = kind(0.0)
        assert not found.feasible
        assert np.isnan(found.escape_time)
        assert "between 0 and" in found.reason


def test_radial_speed_is_the_energy_integral():
    for a in (0.1, 0.2, -0.3):
        flown = special_thrust.trajectory("radial", a, np.linspace(0, 3, 40))
        assert np.abs(flown.radial_speed) == pytest.approx(
            special_thrust.radial(a).radial_speed(flown.radius), abs=1e-7
        )
        energy = (flown.radial_speed**2 + flown.transverse_speed**2) / 2 - 1 / flown.radius
        assert energy == pytest.approx(special_thrust.radial(a).energy(flown.radius), abs=1e-11)  # (2.16), (2.17)
    assert np.isnan(special_thrust.radial(0.1).radial_speed(1.5))


@pytest.mark.parametrize(
    ("kind", "a", "exact", "formula"),
    [
        (special_thrust.circumferential, 1e-2, (8.509256983, 76.118905570, 26.080618774), (7.071068, 62.393969)),
        (
            special_thrust.circumferential,
            1e-4,
            (85.326537432, 9244.462389584, 2501.087886926),
            (70.710678, 8810.792885),
        ),
        (special_thrust.tangential, 1e-2, (8.779452316, 74.534367268, 25.724210847), (4.728708, 54.013670)),
        (special_thrust.tangential, 1e-4, (87.859532752, 9191.792888112, 2500.725965350), (47.287080, 8545.784567)),
    ],
)
def test_slow_escape_is_the_tabled_one(kind, a, exact, formula):
    found = kind(a)
    assert (found.escape_radius, found.escape_time) == pytest.approx(formula, abs=0.6e-6)
    assert found.exact.radius == pytest.approx(exact[0], abs=1e-9)
    assert found.exact.time == pytest.approx(exact[1], rel=EXACT, abs=0.51e-9)
    assert found.exact.angle == pytest.approx(exact[2], rel=EXACT, abs=0.51e-9)
    assert found.better_escape_radius == pytest.approx(exact[0], rel=4e-3)
    assert found.better_escape_time == pytest.approx(exact[1], rel=2e-3)


def test_estimates_of_the_thesis_miss_the_radius_by_a_constant_factor():
    for kind, factor in ((special_thrust.circumferential, 1.207), (special_thrust.tangential, 1.858)):
        found = kind(1e-5)
        assert found.exact.radius / found.escape_radius == pytest.approx(factor, abs=1e-3)
        assert found.better_escape_radius == pytest.approx(found.exact.radius, rel=1e-6)
        rest = 1 - 1e-5 * found.exact.time
        assert 1 - 1e-5 * found.better_escape_time == pytest.approx(rest, rel=1e-5)


def test_slow_spiral_follows_the_thesis_for_a_while():
    """C4: a = 1e-3, t = 300. (2.20) misses r by 1.3e-3, its linear form by a fifth, (2.23) by 1.4e-3."""
    found, flown = special_thrust.circumferential(1e-3), special_thrust.trajectory("circumferential", 1e-3, [300.0])
    assert flown.radius[0] == pytest.approx(2.038163960, abs=0.51e-9)
    assert flown.angle[0] == pytest.approx(189.989891235, abs=0.51e-9)
    assert found.radius_at_time(300) == pytest.approx(2.040816327, abs=0.51e-9)
    assert found.radius_at_time_linear(300) == pytest.approx(1.6, rel=1e-15)
    assert found.radius_at_angle(flown.angle[0]) == pytest.approx(2.041069520, abs=0.51e-9)
    assert found.radius_at_time(300) / flown.radius[0] - 1 == pytest.approx(1.3e-3, rel=0.1)
    assert np.isnan(found.radius_at_angle(251.0))


def test_estimates_that_make_no_sense_are_refused():
    assert "0.5" in special_thrust.circumferential(0.6).reason
    assert "0.2236" in special_thrust.tangential(0.3).reason
    many = special_thrust.tangential(np.array([-1.0, 0.01, 0.3]))
    assert many.feasible.tolist() == [False, True, False]
    assert (np.isnan(many.escape_radius) == ~many.feasible).all()
    assert np.isfinite(many.exact.radius).tolist() == [False, True, True]  # the motion itself is not refused


@pytest.mark.parametrize("kind", ["radial", "circumferential", "tangential"])
def test_trajectory_agrees_with_an_independent_integrator(kind):
    a, times = 0.02, np.linspace(0, 40, 17)

    def rates(t, y):
        r, _, u, v = y
        size = np.hypot(u, v)
        push = {"radial": (a, 0), "circumferential": (0, a), "tangential": (a * u / size, a * v / size)}[kind]
        return [u, v / r, v * v / r - 1 / r**2 + push[0], -u * v / r + push[1]]

    run = solve_ivp(rates, (0, 40), [1, 0, 0, 1], t_eval=times, method="DOP853", rtol=1e-13, atol=1e-14)
    flown = special_thrust.trajectory(kind, a, times)
    found = np.array([flown.radius, flown.angle, flown.radial_speed, flown.transverse_speed])
    assert found == pytest.approx(run.y, abs=1e-10)


def test_trajectory_may_end_at_escape():
    times = np.linspace(0, 100, 101)
    flown = special_thrust.trajectory("circumferential", 1e-2, times, to_escape=True)
    assert np.isfinite(flown.radius[:77]).all()
    assert np.isnan(flown.radius[77:]).all()
