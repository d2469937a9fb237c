"""The sail of GTOC13 against another integrator, and its closest approach to the star."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz.checks.gtoc13 import rules, sail
from sailviz.checks.gtoc13.controls import step_errors
from sailviz.constants import DAY

AU = rules.AU


def _steps(span, middle=(0.6, 0.2, 0.1)):
    state = np.array([[-1.0 * AU, 0.3 * AU, 0.2 * AU, 15e3, -12e3, 3e3]])
    ends = sail.unit(np.array([[1.0, 0.1, 0.0], middle, [0.7, -0.6, 0.3]]))
    return sail.Steps(state, np.array([span]), ends[:1], ends[1:2], ends[2:])


def _scipy(steps, events=None):
    def rate(t, y):
        x = t / steps.span[0]
        u = (
            (1 - x) * (1 - 2 * x) * steps.before[0]
            + 4 * x * (1 - x) * steps.middle[0]
            + x * (2 * x - 1) * steps.after[0]
        )
        u = u / np.linalg.norm(u)
        r = np.linalg.norm(y[:3])
        facing = u @ (-y[:3] / r)
        push = 2 * 5.4026e-6 * 15000 / 500 * (149597870691.0 / r) ** 2 * facing**2
        return np.concatenate([y[3:], -139348062043.343e9 * y[:3] / r**3 - push * u])

    return solve_ivp(rate, (0, steps.span[0]), steps.state[0], "DOP853", rtol=1e-13, atol=1e-8, events=events)


@pytest.mark.parametrize("days", [0.01, 3.0, 60.0, 400.0])
def test_a_turning_sail_flies_as_with_another_integrator(days):
    steps = _steps(days * DAY)
    off = sail.fly(steps).state[0] - _scipy(steps).y[:, -1]
    assert np.linalg.norm(off[:3]) < 20.0  # m, of 1.5e11: rounding that a perihelion enlarges
    assert np.linalg.norm(off[3:]) < 1e-5


def test_the_closest_approach_within_a_step_is_found():
    steps = _steps(250 * DAY)

    def turning(_, y):
        return y[:3] @ y[3:]

    turning.direction = 1
    known = _scipy(steps, turning)
    nearest = sail.fly(steps).nearest
    assert len(nearest) == len(known.t_events[0]) > 0
    for (_, time, distance), when, state in zip(nearest, known.t_events[0], known.y_events[0], strict=True):
        assert time == pytest.approx(when, abs=1.0)
        assert distance == pytest.approx(np.linalg.norm(state[:3]), abs=100.0)  # m; the rule has 1 km


def test_a_runge_kutta_step_errs_by_the_fifth_power_of_its_length():
    errors = []
    for days in (6.0, 3.0):
        steps = _steps(days * DAY)
        steps = steps._replace(before=steps.middle, after=steps.middle)
        errors.append(np.linalg.norm(sail.one_step(steps)[0, :3] - sail.fly(steps).state[0, :3]))
    assert 20 < errors[0] / errors[1] < 45


def test_a_normal_that_the_file_does_not_tell_is_found():
    """A step flown with a normal in the middle far from the mean of its ends is legal: one is found."""
    steps = _steps(1.0 * DAY, middle=(1.0, 0.15, 0.06))._replace(after=sail.unit(np.array([[1.0, 0.1, 0.05]])))
    wanted = sail.fly(steps).state
    unknown = steps._replace(middle=sail.unit(steps.before + steps.after))
    as_mean = step_errors(unknown, wanted, np.array([False]))
    assert as_mean.truly[0] > rules.STEP_ERROR
    found = step_errors(unknown, wanted, np.array([True]))
    assert max(found.truly[0], found.by_one_step[0]) < rules.STEP_ERROR


def test_no_normal_makes_up_for_a_push_that_no_sail_has():
    steps = _steps(1.0 * DAY)
    wanted = sail.fly(steps).state + np.array([0, 0, 0, 0, 0, 100.0])
    found = step_errors(steps, wanted, np.array([True]))
    assert found.truly[0] > 0.01
