"""The propagator against closed forms, conservation laws and an independent integrator. Units: mu = r0 = 1."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from sailviz.constants import AU
from sailviz.propagate import dop853, dynamics
from sailviz.propagate.events import APSIS, END_OF_USE, ENERGY, NODE, RADIUS, RECORD, STOP, watch
from sailviz.steering import attitude

TURN = 2 * np.pi


def perihelion(e):
    """Position and velocity at the perihelion of the ellipse with a = 1 in the x-y plane."""
    return (1 - e, 0, 0), (0, np.sqrt((1 + e) / (1 - e)), 0)


def kepler(e, t):
    """Position (2, n) on that ellipse by Kepler's equation; t (n,) since perihelion."""
    mean = np.remainder(t, TURN)
    anomaly = mean + e * np.sin(mean)
    for _ in range(80):
        anomaly = anomaly - (anomaly - e * np.sin(anomaly) - mean) / (1 - e * np.cos(anomaly))
    return np.stack([np.cos(anomaly) - e, np.sqrt(1 - e * e) * np.sin(anomaly)])


def thruster(acceleration, steering=attitude.RADIAL, **more):
    return dynamics.model(
        1.0, device=dynamics.THRUSTER, device_parameters=(acceleration, 0.0, 0.0), steering=steering, **more
    )


def sail(lightness, pitch, clock):
    """Ideal sail at fixed pitch and clock in the orbital frame."""
    return dynamics.model(
        1.0,
        device=dynamics.SOLAR_SAIL,
        device_parameters=(lightness, 0.0, 1.0, 0.0),
        steering=attitude.ORBITAL,
        steering_parameters=attitude.direction_parameters(pitch, clock),
    )


# ---------------------------------------------------------------- accuracy
# Lengths in units of a. An error per step of 1e-13 in energy drifts along the track with the square of time, and counts
# 1 / (1 - e) times as much at perihelion; the bounds are three times what the integrator does.
@pytest.mark.parametrize(("e", "within"), [(0.0, 2e-10), (0.1, 2e-9), (0.5, 3e-8), (0.9, 2e-7)])
def test_hundred_revolutions_follow_keplers_equation(fly, e, within):
    times = np.linspace(0, 100 * TURN, 5001)
    flight = fly(None, *perihelion(e), times)
    assert np.abs(flight.states[:2] - kepler(e, times)).max() < within
    assert np.abs(flight.states[2]).max() == 0


def test_error_per_revolution_falls_with_the_eighth_power_of_the_step(fly):
    fly = partial(fly, method=dop853)
    e = 0.2
    missed = []
    for steps in (40, 80):
        flight = fly(None, *perihelion(e), [TURN], tolerance=1e9, largest_step=TURN / steps)
        assert dop853.statistics(flight.integration) == (steps, 0)
        missed.append(np.linalg.norm(flight.states[:3, 0] - [1 - e, 0, 0]))
    assert np.log2(missed[0] / missed[1]) == pytest.approx(8, abs=0.4)


def test_dense_output_has_order_seven(fly):
    fly = partial(fly, method=dop853)
    """The error inside one step of length h goes with h^8: halving the step divides it by 256."""
    missed = []
    for h in (TURN / 20, TURN / 40):
        times = np.linspace(0, h, 33)
        flight = fly(None, *perihelion(0.2), times, tolerance=1e9, largest_step=h)
        missed.append(np.abs(flight.states[:2] - kepler(0.2, times)).max())
    assert np.log2(missed[0] / missed[1]) == pytest.approx(8, abs=0.2)


@pytest.mark.parametrize("tolerance", [1e-7, 1e-10, 1e-13])
def test_output_between_steps_is_as_good_as_at_steps(fly, tolerance):
    e, times = 0.3, np.linspace(0, 3 * TURN, 3001)
    dense = fly(None, *perihelion(e), times, tolerance=tolerance)
    s = dop853.start(0.0, *perihelion(e), 1.0)
    ends, one = [], np.empty((6, 1))
    for t in times:
        dop853.advance(
            s, dynamics.model(1.0), np.zeros(1), np.ones(1), watch(()), np.array([t]), one, times[-1], tolerance, np.inf
        )
        ends.append((dop853.time(s), *dop853.state(s)[:2]))
    t, *xy = np.unique(ends, axis=0).T
    at_steps = np.linalg.norm(np.array(xy) - kepler(e, t), axis=0)
    between = np.linalg.norm(dense.states[:2] - kepler(e, times), axis=0)
    assert between.max() < 1.5 * at_steps.max()


@pytest.mark.parametrize("e", [0.0, 0.6])
def test_energy_and_angular_momentum_stay_for_a_thousand_revolutions(fly, e):
    """Step errors of 1e-13 partly cancel; a drift of 1e-14 per revolution is rounding."""
    flight = fly(None, *perihelion(e), np.linspace(0, 1000 * TURN, 2001))
    r, v = flight.position, flight.velocity
    energy = np.sum(v * v, axis=1) / 2 - 1 / np.linalg.norm(r, axis=1)
    momentum = np.linalg.norm(np.cross(r, v), axis=1)
    assert np.abs(energy + 0.5).max() < 2e-10
    assert np.abs(momentum - np.sqrt(1 - e * e)).max() < 2e-10


def test_time_runs_symmetrically(fly):
    """Reversing the velocity at the end of a ballistic flight leads back to its start."""
    there = fly(None, (1, 0, 0), (0.1, 0.9, 0.3), [20.0]).states[:, 0]
    back = fly(None, there[:3], -there[3:], [20.0]).states[:, 0]
    assert np.abs(back - [1, 0, 0, -0.1, -0.9, -0.3]).max() < 1e-10


def test_sail_in_three_dimensions_agrees_with_scipy(fly):
    lightness, pitch, clock = 0.1, np.radians(35), np.radians(50)

    def independent(_, y):
        r, v = y[:3], y[3:]
        size = np.linalg.norm(r)
        r_hat = r / size
        h_hat = np.cross(r, v) / np.linalg.norm(np.cross(r, v))
        t_hat = np.cross(h_hat, r_hat)
        normal = np.cos(pitch) * r_hat + np.sin(pitch) * (np.sin(clock) * t_hat + np.cos(clock) * h_hat)
        return [*v, *(-r / size**3 + lightness * np.cos(pitch) ** 2 / size**2 * normal)]

    times = np.linspace(0, 20 * TURN, 401)
    start = [0.8, 0, 0, 0, 1.1, 0.2]
    reference = solve_ivp(independent, (0, times[-1]), start, "DOP853", times, rtol=1e-13, atol=1e-15).y
    flight = fly(sail(lightness, pitch, clock), start[:3], start[3:], times)
    distance = np.linalg.norm(reference[:3], axis=0)
    assert (np.linalg.norm(flight.states[:3] - reference[:3], axis=0) / distance).max() < 1e-9


# ---------------------------------------------------------------- the same run however it is asked for
def test_rows_do_not_depend_on_the_block_size(fly):
    times = np.linspace(0, 30, 1000)
    watched = [(APSIS, 0, 0, RECORD), (RADIUS, 1.05, 0, RECORD)]
    breaks, factors = np.arange(0, 30, 0.7), 1 + 0.3 * np.sin(np.arange(43))
    arguments = (sail(0.1, 0.6, 1.0), *perihelion(0.1), times)
    whole = fly(*arguments, events=watched, breaks=breaks, factors=factors)
    for block in (1, 7, 256, 999):
        pieces = fly(*arguments, events=watched, breaks=breaks, factors=factors, block=block)
        assert np.array_equal(pieces.states, whole.states)
        assert [event[:2] for event in pieces.events] == [event[:2] for event in whole.events]


def test_state_at_a_time_does_not_depend_on_what_else_is_asked_for(fly):
    coarse, fine = np.linspace(0, 30, 31), np.linspace(0, 30, 3001)
    few = fly(sail(0.1, 0.6, 1.0), *perihelion(0.1), coarse)
    many = fly(sail(0.1, 0.6, 1.0), *perihelion(0.1), fine, events=[(APSIS, 0, 0, RECORD)])
    same = np.isin(fine, coarse)
    assert same.sum() > 25
    assert np.array_equal(many.states[:, same], few.states[:, np.isin(coarse, fine)])


# ---------------------------------------------------------------- thrust with a schedule
def test_redrawn_thrust_equals_flights_flown_one_after_the_other(fly):
    breaks = np.array([0.0, 1.3, 2.0, 5.5, 7.25])
    factors = np.array([1.0, 0.4, 1.7, 0.0, 0.9])
    model = sail(0.2, 0.6, 1.2)
    once = fly(model, *perihelion(0.1), [10.0], breaks=breaks, factors=factors).states[:, 0]
    y = np.concatenate(perihelion(0.1))
    for begin, end, factor in zip(breaks, [*breaks[1:], 10.0], factors, strict=True):
        y = fly(model, y[:3], y[3:], [end - begin], factors=[factor]).states[:, 0]
    assert np.abs(once - y).max() < 1e-12


def test_steps_land_on_every_redraw(fly):
    """Thousands of jumps of the thrust cost no accuracy: the velocity that it gives where there is no gravity."""
    rng = np.random.default_rng(1)
    breaks = np.concatenate([[0.0], np.sort(rng.uniform(0, 10, 3000))])
    factors = rng.uniform(0, 2, 3001)
    model = dynamics.model(
        1e-30,
        device=dynamics.THRUSTER,
        device_parameters=(0.1, 0, 0),
        steering=attitude.INERTIAL,
        steering_parameters=(0, 0, 1),
    )
    times = np.sort(rng.uniform(0, 10, 500))
    flight = fly(model, (1, 0, 0), (0, 1, 0), times, breaks=breaks, factors=factors)
    gained = np.concatenate([[0], np.cumsum(0.1 * factors[:-1] * np.diff(breaks))])
    interval = np.searchsorted(breaks, times, side="right") - 1
    expected = gained[interval] + 0.1 * factors[interval] * (times - breaks[interval])
    assert np.abs(flight.states[5] - expected).max() < 1e-14
    if fly.keywords["method"] is dop853:
        assert dop853.statistics(flight.integration)[1] == 0


def test_held_table_turns_exactly_at_its_rows(fly):
    """A thruster that points along +z, then along -z: no step may see both rows of the table."""
    table = attitude.table([0.0, 4.0, 6.0], [np.pi / 2] * 3, [0.0, np.pi, 0.0])
    arguments = {
        "device": dynamics.THRUSTER,
        "device_parameters": (0.01, 0, 0),
        "steering": attitude.TABLE_ORBITAL,
        "table": table,
    }
    flight = fly(
        dynamics.model(1.0, interpolation=attitude.HOLD, **arguments),
        *perihelion(0.2),
        [9.0],
        breaks=[0, 4, 6],
        factors=[1, 1, 1],
    )
    if fly.keywords["method"] is dop853:
        assert dop853.statistics(flight.integration)[1] == 0
    y, begin = np.concatenate(perihelion(0.2)), 0.0
    for end, clock in ((4.0, 0.0), (6.0, np.pi), (9.0, 0.0)):
        model = thruster(0.01, attitude.ORBITAL, steering_parameters=attitude.direction_parameters(np.pi / 2, clock))
        y, begin = fly(model, y[:3], y[3:], [end - begin]).states[:, 0], end
    assert np.abs(flight.states[:, 0] - y).max() < 1e-12


# ---------------------------------------------------------------- events
@pytest.mark.parametrize("e", [0.05, 0.3, 0.8])
def test_apsides_come_every_half_period(fly, e):
    flight = fly(None, *perihelion(e), [4.6 * TURN], events=[(APSIS, 0, 1, RECORD), (APSIS, 0, -1, RECORD)])
    times = {index: np.array([t for i, t, _ in flight.events if i == index]) for index in (0, 1)}
    assert times[0] == pytest.approx(TURN * np.arange(1, 5), abs=1e-9)
    assert times[1] == pytest.approx(TURN * (np.arange(5) + 0.5), abs=1e-9)
    assert [t for _, t, _ in flight.events] == sorted(t for _, t, _ in flight.events)
    assert all(
        np.linalg.norm(y[:3]) == pytest.approx(1 - e if i == 0 else 1 + e, abs=1e-10) for i, _, y in flight.events
    )


def test_radius_is_crossed_at_the_time_of_keplers_equation(fly):
    """r = a where the eccentric anomaly is a quarter turn: t = pi/2 - e going up, 3 pi/2 + e coming down."""
    e = 0.3
    flight = fly(None, *perihelion(e), [TURN], events=[(RADIUS, 1.0, 1, RECORD), (RADIUS, 1.0, -1, RECORD)])
    assert [(i, pytest.approx(t, abs=1e-11)) for i, t, _ in flight.events] == [(0, np.pi / 2 - e), (1, 1.5 * np.pi + e)]


def test_nodes_of_a_circular_orbit_come_every_half_turn(fly):
    inclined = (0, np.cos(1.0), np.sin(1.0))
    flight = fly(None, (1, 0, 0), inclined, [3.3 * TURN], events=[(NODE, 0, 0, RECORD)])
    assert [t for _, t, _ in flight.events] == pytest.approx(np.pi * np.arange(1, 7), abs=1e-11)
    only_up = fly(None, (1, 0, 0), inclined, [3.3 * TURN], events=[(NODE, 0, 1, RECORD)])
    assert [t for _, t, _ in only_up.events] == pytest.approx(TURN * np.arange(1, 4), abs=1e-11)


def escape_time(a):
    """Tsien's escape time from r = 1 under radial thrust a > 1/8: t = int dr / r_dot with
    r_dot^2 = (r - 1)(2 a r^2 - r + 1) / r^2, r = 1 + x^2, up to r = 1 + 1/(2a), (2.15)."""
    return quad(
        lambda x: 2 * (1 + x * x) / np.sqrt(2 * a * (1 + x * x) ** 2 - x * x), 0, np.sqrt(1 / (2 * a)), epsabs=1e-13
    )[0]


# third and fourth columns: an independent integration at 1e-13 with an energy event, agreed with the quadrature
@pytest.mark.parametrize(
    ("a", "radius", "time", "angle"),
    [
        (0.126, 4.968253968, 25.871878467, 7.417608070),
        (0.15, 4.333333333, 11.831267500, 4.082561530),
        (0.5, 2.0, 2.168627099, None),
        (1.0, 1.5, 1.027069728, None),
    ],
)
def test_radial_thrust_escapes_when_tsien_says(fly, a, radius, time, angle):
    flight = fly(thruster(a), times=[100.0], events=[(ENERGY, 0, 1, STOP)])
    assert flight.status == dop853.STOPPED
    ((_, t, y),) = flight.events
    assert np.linalg.norm(y[:3]) == pytest.approx(1 + 1 / (2 * a), abs=1e-11)  # (2.15)
    assert t == pytest.approx(escape_time(a), rel=1e-11)  # close to the threshold a hundredfold worse than the radius
    assert (np.linalg.norm(y[:3]), t) == pytest.approx((radius, time), abs=1e-9)
    if angle is not None:
        assert np.arctan2(y[1], y[0]) % TURN == pytest.approx(angle % TURN, abs=1e-9)


def test_escape_by_transverse_and_tangential_thrust_agrees_with_published_integrations(fly):
    """Independent integrations at 1e-13 for a = 1e-2; no closed form exists, (2.21) and (2.26) are rough."""
    for steering, radius, time in (
        (attitude.TRANSVERSE, 8.509256983, 76.118905570),
        (attitude.TANGENTIAL, 8.779452316, 74.534367268),
    ):
        flight = fly(thruster(0.01, steering), times=[200.0], events=[(ENERGY, 0, 1, STOP)])
        ((_, t, y),) = flight.events
        assert (np.linalg.norm(y[:3]), t) == pytest.approx((radius, time), abs=1e-8)


def test_nothing_happens_at_the_very_start(fly):
    """A flight that begins on a node, at an apsis and at a watched radius does not report them at t = 0."""
    watched = [(NODE, 0, 0, RECORD), (APSIS, 0, 0, RECORD), (RADIUS, 0.7, 0, RECORD)]
    flight = fly(None, (0.7, 0, 0), (0, 1.0, 0.9), [1.0], events=watched)
    assert flight.events == []


def test_stop_ends_the_run_at_the_event(fly):
    times = np.linspace(0, TURN, 1001)
    watched = [(RADIUS, 1.0, 1, STOP), (APSIS, 0, -1, RECORD)]
    flight = fly(None, *perihelion(0.3), times, events=watched)
    assert flight.status == dop853.STOPPED
    assert [i for i, _, _ in flight.events] == [0]
    end = np.pi / 2 - 0.3
    assert dop853.time(flight.integration) == pytest.approx(end, abs=1e-11)
    assert flight.states.shape[1] == np.sum(times <= end)
    assert np.array_equal(dop853.state(flight.integration), flight.events[0][2])


@pytest.mark.parametrize("block", [1, 2, 7])
def test_no_row_before_the_stop_is_lost_between_blocks(fly, block):
    """The step that finds the stop may reach over several blocks of rows."""
    times, watched = np.linspace(0, TURN, 1001), [(RADIUS, 1.0, 1, STOP)]
    whole = fly(None, *perihelion(0.3), times, events=watched)
    pieces = fly(None, *perihelion(0.3), times, events=watched, block=block)
    assert pieces.status == dop853.STOPPED
    assert dop853.stopped_by(pieces.integration) == 0
    assert np.array_equal(pieces.states, whole.states)


def test_two_crossings_inside_one_step_are_both_seen(fly):
    """Steps of 0.483 straddle aphelion at pi: the radius there is exceeded for a good half of one step only."""
    e, step = 0.1, np.pi / 6.5
    anomaly = np.arccos(-np.cos(0.17))  # eccentric anomaly 0.17 before aphelion
    level, first = 1 - e * np.cos(anomaly), anomaly - e * np.sin(anomaly)
    flight = fly(None, *perihelion(e), [TURN], tolerance=1e9, largest_step=step, events=[(RADIUS, level, 0, RECORD)])
    assert int(first / step) == int((TURN - first) / step)
    assert [t for _, t, _ in flight.events] == pytest.approx([first, TURN - first], abs=1e-5)  # of steps of 0.483


def test_events_inside_one_step_come_in_order_of_time(fly):
    levels = [1.0, 0.9, 1.05, 0.95, 0.85]
    watched = [(RADIUS, level, 0, RECORD) for level in levels]
    flight = fly(None, *perihelion(0.3), [2.0], tolerance=1e9, largest_step=2.0, events=watched)
    assert dop853.statistics(flight.integration)[0] == 1
    assert [levels[i] for i, _, _ in flight.events] == sorted(levels)


def test_a_hundred_levels_in_one_step_do_not_overflow_the_list_of_events(fly):
    levels = np.linspace(0.75, 1.25, 1500)
    watched = [(RADIUS, level, 0, RECORD) for level in levels]
    flight = fly(None, *perihelion(0.3), [3 * TURN], tolerance=1e-4, events=watched)
    assert len(flight.events) == 6 * len(levels)
    times = [t for _, t, _ in flight.events]
    assert times == sorted(times)


def test_more_events_than_fit_are_all_delivered(fly):
    watched = [(NODE, 0, 0, RECORD), (APSIS, 0, 0, RECORD), *((RADIUS, r, 0, RECORD) for r in (0.9, 1.0, 1.1))]
    velocity = np.sqrt(1.3 / 0.7) * np.array([0, np.cos(1), np.sin(1)])
    turns = 500
    flight = fly(None, (0.7, 0, 0), velocity, np.linspace(0, (turns + 0.25) * TURN, 11), tolerance=1e-9, events=watched)
    assert len(flight.events) > dop853.MOST_EVENTS
    counts = np.bincount([i for i, _, _ in flight.events])
    # the quarter of a period after the last perihelion leads to r = 1.08
    assert list(counts) == [2 * turns, 2 * turns, 2 * turns + 1, 2 * turns + 1, 2 * turns]
    assert not np.isnan(flight.states).any()


# ---------------------------------------------------------------- how a run may end
@pytest.mark.parametrize("radius", [0.9, 0.5, 0.05])
def test_a_dropped_stone_touches_the_surface_on_time(fly, radius):
    """Free fall from rest at r = 1: t = (arccos sqrt r + sqrt(r (1 - r))) / sqrt 2."""
    flight = fly(dynamics.model(1.0, surface_radius=radius), (1, 0, 0), (0, 0, 0), np.linspace(0, 2, 201))
    expected = (np.arccos(np.sqrt(radius)) + np.sqrt(radius * (1 - radius))) / np.sqrt(2)
    assert flight.status == dop853.SURFACE
    ((index, t, y),) = flight.events
    assert index == -1
    assert t == pytest.approx(expected, abs=1e-11)
    assert y[0] == pytest.approx(radius, abs=1e-12)
    assert flight.states.shape[1] == int(expected / 0.01) + 1


@pytest.mark.parametrize(
    ("depth", "tolerance"),
    # a depth of 1e-6 is less than what a flight at 1e-3 errs by
    [(1e-1, 1e-3), (1e-3, 1e-3)] + [(depth, tolerance) for tolerance in (1e-6, 1e-10) for depth in (1e-1, 1e-3, 1e-6)],
)
def test_a_pass_just_below_the_surface_is_an_impact_whatever_the_step(fly, depth, tolerance):
    """From aphelion of e = 0.5 the perihelion at 0.5 lies a little below the surface, between two steps."""
    surface = 0.5 * (1 + depth)
    flight = fly(
        dynamics.model(1.0, surface_radius=surface),
        (1.5, 0, 0),
        (0, np.sqrt(0.5 / 1.5), 0),
        [TURN],
        tolerance=tolerance,
    )
    assert flight.status == dop853.SURFACE
    anomaly = np.arccos((1 - surface) / 0.5)
    # in units of the tolerance the perihelion is met a hundredfold worse; a grazing crossing is worse by sqrt(depth)
    expected = np.pi - (anomaly - 0.5 * np.sin(anomaly))
    assert flight.events[0][1] == pytest.approx(expected, abs=300 * tolerance / np.sqrt(depth))


def test_a_pass_just_above_the_surface_is_no_impact(fly):
    flight = fly(dynamics.model(1.0, surface_radius=0.4999), (1.5, 0, 0), (0, np.sqrt(0.5 / 1.5), 0), [5 * TURN])
    assert flight.status == dop853.DONE


def test_a_device_out_of_use_leaves_a_ballistic_flight(fly, speed_errs):
    """Transverse thrust until r = 1.5; from there on energy and angular momentum stay what they were."""
    flight = fly(
        thruster(0.02, attitude.TRANSVERSE), times=np.linspace(0, 60, 601), events=[(RADIUS, 1.5, 1, END_OF_USE)]
    )
    ((_, when, y),) = flight.events
    assert flight.status == dop853.DONE
    assert not dop853.in_use(flight.integration)
    after = np.linspace(0, 60, 601) > when
    r, v = flight.position[after], flight.velocity[after]
    energy = np.sum(v * v, axis=1) / 2 - 1 / np.linalg.norm(r, axis=1)
    assert np.abs(energy - (y[3:6] @ y[3:6] / 2 - 1 / 1.5)).max() < 1e-12 * speed_errs
    assert np.abs(np.cross(r, v)[:, 2] - np.cross(y[:3], y[3:6])[2]).max() < 1e-12 * speed_errs


def test_an_acceleration_that_is_not_finite_is_reported_where_it_begins(fly):
    """A sail in the orbital frame dropped from rest has no orbital plane to steer by."""
    flight = fly(sail(0.1, 0.5, 0.5), velocity=(0, 0, 0), times=[1.0])
    assert flight.status == dop853.NOT_FINITE
    assert dop853.time(flight.integration) == 0
    assert np.array_equal(dop853.state(flight.integration), [1, 0, 0, 0, 0, 0, 1])


def test_a_fall_into_the_centre_underflows_at_the_time_of_the_fall(fly):
    flight = fly(velocity=(0, 0, 0), times=[2.0])
    assert flight.status in (dop853.UNDERFLOW, dop853.NOT_FINITE)
    assert dop853.time(flight.integration) == pytest.approx(np.pi / np.sqrt(8), abs=1e-9)
    assert np.abs(dop853.state(flight.integration)[0]) < 1e-5


# ---------------------------------------------------------------- mass, oblateness
def test_mass_and_speed_obey_the_rocket_equation(fly, speed_errs):
    """Constant thrust in empty space: m = m0 - F t / c, v = c ln(m0 / m)."""
    thrust, exhaust = 0.3, 2.0
    model = dynamics.model(
        1e-30,
        device=dynamics.THRUSTER,
        device_parameters=(thrust, 1.0, 1 / exhaust),
        steering=attitude.INERTIAL,
        steering_parameters=(0, 1, 0),
    )
    times = np.linspace(0, 9, 91)
    flight = fly(model, velocity=(0, 0, 0), times=times, mass=1.5, components=7)
    mass = 1.5 - thrust * times / exhaust
    assert np.abs(flight.states[6] - mass).max() < 1e-14
    assert np.abs(flight.states[4] - exhaust * np.log(1.5 / mass)).max() < 1e-12 * speed_errs


def test_constant_acceleration_burns_mass_exponentially(fly):
    model = dynamics.model(
        1.0, device=dynamics.THRUSTER, device_parameters=(0.05, 0.0, 1 / 3), steering=attitude.TRANSVERSE
    )
    times = np.linspace(0, 20, 21)
    flight = fly(model, times=times, mass=700.0, components=7)
    assert flight.states[6] == pytest.approx(700 * np.exp(-0.05 * times / 3), rel=1e-13)


def test_running_out_of_propellant_ends_in_underflow_not_in_negative_mass(fly):
    model = dynamics.model(
        1.0, device=dynamics.THRUSTER, device_parameters=(0.1, 1.0, 0.5), steering=attitude.TRANSVERSE
    )
    flight = fly(model, times=np.linspace(0, 30, 31), mass=1.0, components=7)
    assert flight.status in (dop853.UNDERFLOW, dop853.NOT_FINITE)
    assert dop853.time(flight.integration) == pytest.approx(20.0, abs=1e-6)
    assert flight.states[6].min() >= 0


@pytest.mark.parametrize("inclination", [0.5, 1.2, 2.4])
def test_oblateness_turns_the_node_as_the_closed_form_says(fly, inclination):
    """d(node)/dt = -(3/2) J2 n (R/p)^2 cos i to first order in J2; J2 = 1e-6 leaves second-order terms of 1e-6."""
    j2, turns = 1e-6, 100
    model = dynamics.model(1.0, j2_strength=1.5 * j2)
    velocity = (0, np.cos(inclination), np.sin(inclination))
    flight = fly(model, velocity=velocity, times=[turns * TURN + 1], events=[(NODE, 0, 1, RECORD)])
    (_, t, y) = flight.events[-1]
    h = np.cross(y[:3], y[3:6])
    node = np.arctan2(h[0], -h[1])
    assert len(flight.events) == turns
    assert node / t == pytest.approx(-1.5 * j2 * np.cos(inclination), rel=1e-5)


def test_oblateness_keeps_energy_and_the_axial_angular_momentum(fly):
    """Energy with the potential mu J2 R^2 (3 sin^2 phi - 1) / (2 r^3) of the oblate body."""
    j2 = 1e-3
    times = np.linspace(0, 50 * TURN, 501)
    flight = fly(dynamics.model(1.0, j2_strength=1.5 * j2), (1.1, 0, 0), (0.1, 0.5, 0.8), times)
    r, v = flight.position, flight.velocity
    size = np.linalg.norm(r, axis=1)
    potential = -1 / size + j2 * (3 * (r[:, 2] / size) ** 2 - 1) / (2 * size**3)
    energy = np.sum(v * v, axis=1) / 2 + potential
    assert np.ptp(energy) < 1e-11
    assert np.ptp(np.cross(r, v)[:, 2]) < 1e-11
    assert np.ptp(np.cross(r, v)[:, 0]) > 1e-3  # the others are not kept: the plane turns


# ---------------------------------------------------------------- the electric sail's reach
def test_electric_sail_weakens_with_distance_not_with_its_square(fly, speed_errs):
    """Sun-facing E-sail: radial thrust a_c (r_E / r), so the energy E + a_c r_E ln r is lost to nothing."""
    model = dynamics.model(1.0, device=dynamics.ELECTRIC_SAIL, device_parameters=(0.1 / AU, 0, 1.0))
    flight = fly(model, *perihelion(0.2), np.linspace(0, 40, 401))
    r = np.linalg.norm(flight.position, axis=1)
    energy = np.sum(flight.velocity**2, axis=1) / 2 - 1 / r - 0.1 * np.log(r)
    assert np.ptp(energy) < 1e-12 * speed_errs
