"""Collocation: what is asked of it is achieved, by closed forms and independent integration; eight forces at once are
those of the right-hand side. What every integrator has to do: test_integrators.py. Units: mu = r0 = 1."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz.compiled import entry
from sailviz.constants import AU
from sailviz.environment import atmosphere
from sailviz.propagate import collocation, collocation_memory, dop853, dynamics
from sailviz.propagate.collocation_forces import fits_lanes, forces_at_once, prepare
from sailviz.propagate.collocation_memory import LENGTH, load, node, store
from sailviz.propagate.dynamics import derivative
from sailviz.propagate.events import APSIS, NODE, RADIUS, RECORD, watch
from sailviz.propagate.gauss_legendre import FITTED, NODES, tables
from sailviz.propagate.parameters import PARAMETERS
from sailviz.propulsion.electric_sail import MODELS
from sailviz.steering import attitude

TURN = 2 * np.pi
ASKED = 10.0 ** -np.arange(6, 13)


def flown(model, position, velocity, times, tolerance, *, method=collocation, events=(), breaks=(0.0,), factors=(1.0,)):
    """States (6, n) at the times, and the integration."""
    s = method.start(0.0, position, velocity, 1.0, events=len(events))
    out = np.empty((6, len(times)))
    arguments = np.asarray(breaks, float), np.asarray(factors, float), watch(events), times, out, times[-1]
    assert method.advance(s, model, *arguments, tolerance, np.inf) == method.DONE
    return out, s


def errs(states, exact):
    """The largest error of the positions, over the distance, or of the velocities, over the larger of speed and
    circular speed."""
    wrong = states - exact
    distance, speed = np.linalg.norm(exact[:3], axis=0), np.linalg.norm(exact[3:], axis=0)
    place = np.linalg.norm(wrong[:3], axis=0) / distance
    return float(np.max([place, np.linalg.norm(wrong[3:], axis=0) / np.maximum(speed, distance**-0.5)]))


def ellipse(e, mu=1.0):
    """(start, function of times) of a Kepler orbit from periapsis at the distance 1."""
    axis = 1 / (1 - e)
    rate = np.sqrt(mu / axis**3)

    def exact(times):
        mean = np.remainder(rate * times, TURN)
        anomaly = mean + e * np.sin(mean)
        for _ in range(60):
            anomaly = anomaly - (anomaly - e * np.sin(anomaly) - mean) / (1 - e * np.cos(anomaly))
        x, y = np.cos(anomaly) - e, np.sqrt(1 - e * e) * np.sin(anomaly)
        speed = rate / (1 - e * np.cos(anomaly))
        u, v = -speed * np.sin(anomaly), speed * np.sqrt(1 - e * e) * np.cos(anomaly)
        return axis * np.stack([x, y, 0 * x, u, v, 0 * x])

    return ((1.0, 0, 0), (0, np.sqrt(mu * (1 + e)), 0)), exact


def ideal_sail(lightness, steering, *parameters):
    return dynamics.model(
        1.0,
        device=dynamics.SOLAR_SAIL,
        device_parameters=(lightness, 0.0, 1.0, 0.0),
        steering=steering,
        steering_parameters=parameters,
    )


def spiral():
    """An ideal sail at a fixed pitch on the logarithmic spiral r = exp(g theta): with the pitch's accelerations
    a_r, a_t over r^2, v_r = g v_t and v_t^2 r = k constant, r dv_t/dt + v_r v_t = a_t/r and the radial equation give
    g k / 2 = a_t and k (1 + g^2 / 2) = 1 - a_r, two equations for g and k."""
    pitch, lightness = 0.6, 0.05
    radial, transverse = lightness * np.cos(pitch) ** 3, lightness * np.cos(pitch) ** 2 * np.sin(pitch)
    pull = 1 - radial
    # with k = 2 a_t / g: 2 a_t + a_t g^2 = pull g, the smaller root
    g = 4 * transverse / (pull + np.sqrt(pull**2 - 8 * transverse**2))
    k = 2 * transverse / g
    model = ideal_sail(lightness, attitude.ORBITAL, *attitude.direction_parameters(pitch, np.pi / 2))

    def exact(times):
        # dr/dt = g (k / r)^(1/2)
        r = (1 + 1.5 * g * np.sqrt(k) * times) ** (2 / 3)
        theta = np.log(r) / g
        outwards, around = np.array([np.cos(theta), np.sin(theta)]), np.array([-np.sin(theta), np.cos(theta)])
        velocity = np.sqrt(k / r) * (g * outwards + around)
        return np.stack([*(r * outwards), 0 * r, *velocity, 0 * r])

    return model, ((1.0, 0, 0), (g * np.sqrt(k), np.sqrt(k), 0)), exact


def displaced():
    """A meridian-steered ideal sail on a circle of radius 1 at the height 0.2 that it goes round once in 1.1 turns: the
    thrust along its normal is what lacks."""
    height, rate = 0.2, 1 / 1.1
    place = np.array([1.0, 0.0, height])
    r = np.linalg.norm(place)
    wanted = place / r**3 - rate**2 * np.array([1.0, 0, 0])  # acceleration less gravity
    up = place / r
    normal = wanted / np.linalg.norm(wanted)
    cosine = normal @ up
    lightness = np.linalg.norm(wanted) * r**2 / cosine**2
    north = np.array([-up[2], 0, up[0]])
    model = ideal_sail(lightness, attitude.MERIDIAN, cosine, 0.0, normal @ north)

    def exact(times):
        c, s = np.cos(rate * times), np.sin(rate * times)
        return np.stack([c, s, height + 0 * times, -rate * s, rate * c, 0 * times])

    return model, (place, (0, rate, 0)), exact


def closed_forms():
    for e in (0.0, 0.2, 0.5):
        yield f"ellipse {e}", dynamics.model(1.0), *ellipse(e), 6 * TURN
    yield "radial sail", ideal_sail(0.3, attitude.RADIAL), *ellipse(0.1, 0.7), 6 * TURN
    yield "logarithmic spiral", *spiral(), 400.0
    yield "displaced", *displaced(), 4 * TURN


CLOSED = {name: rest for name, *rest in closed_forms()}


# ---------------------------------------------------------------- asked and achieved
@pytest.mark.parametrize("tolerance", ASKED)
@pytest.mark.parametrize("name", CLOSED)
def test_the_error_is_between_a_tenth_and_all_of_what_is_asked(name, tolerance):
    model, start, exact, end = CLOSED[name]
    times = np.linspace(0, end, 4001)
    states, _ = flown(model, *start, times, tolerance)
    assert 0.1 * tolerance <= errs(states, exact(times)) <= tolerance


@pytest.mark.parametrize("e", [0.1, 0.3, 0.6, 0.8])
def test_few_steps_on_an_ellipse_are_refused(e):
    """Steps are as long as the distance that they will come to allows; without looking ahead 11 to 37 % are refused."""
    start, _ = ellipse(e)
    times = np.linspace(0.0, 3 * TURN * (1 - e) ** -1.5, 101)
    flights = [flown(dynamics.model(1.0), *start, times, asked)[1] for asked in (1e-6, 1e-9, 1e-12)]
    accepted, refused = np.sum([collocation.statistics(s) for s in flights], axis=0)
    assert refused < 0.1 * accepted


def test_a_sail_of_real_film_agrees_with_scipy():
    """Out of the plane on an ellipse; SciPy's own error is 1e-11 or so."""
    film, lightness = (0.0864, 0.8272, -0.0055), 0.05 / 0.9081
    parameters = attitude.direction_parameters(0.6, 1.0)
    model = dynamics.model(
        1.0,
        device=dynamics.SOLAR_SAIL,
        device_parameters=(lightness, *film),
        steering=attitude.ORBITAL,
        steering_parameters=parameters,
    )

    def rates(_, y):
        r, v = y[:3], y[3:]
        size = np.linalg.norm(r)
        up, h = r / size, np.cross(r, v)
        h /= np.linalg.norm(h)
        normal = parameters.radial * up + parameters.transverse * np.cross(h, up) + parameters.normal * h
        c = up @ normal
        push = lightness * c / size**2 * (film[0] * up + (film[1] * c + film[2]) * normal)
        return np.concatenate([v, -r / size**3 + push])

    times = np.linspace(0, 5 * TURN, 1001)
    start = np.array([0.7, 0, 0, 0, 1.3, 0.4])
    exact = solve_ivp(rates, (0, times[-1]), start, method="DOP853", t_eval=times, rtol=3e-14, atol=1e-15).y
    for tolerance in ASKED[:5]:
        states, _ = flown(model, start[:3], start[3:], times, tolerance)
        assert 0.1 * tolerance <= errs(states, exact) <= tolerance


def test_a_hundred_years_of_mercurys_orbit_are_no_worse_than_by_dop853():
    start, exact = ellipse(0.2056)
    times = np.linspace(0, 415 * TURN / (1 - 0.2056) ** 1.5, 20001)
    wrong = [
        errs(flown(dynamics.model(1.0), *start, times, 1e-13, method=method)[0], exact(times))
        for method in (collocation, dop853)
    ]
    assert wrong[0] < 0.2 * wrong[1]
    assert wrong[0] < 3e-11


def test_symmetric_flights_stay_symmetric():
    """Clock angles pi - a and a mirror each other in the plane of the orbit, as do inclinations up and down."""
    times = np.linspace(0, 5 * TURN, 501)
    up, down = (
        flown(
            ideal_sail(0.05, attitude.ORBITAL, *attitude.direction_parameters(0.5, clock)),
            (1, 0, 0),
            (0, 1, tilt),
            times,
            1e-11,
        )[0]
        for clock, tilt in ((1.0, 0.1), (np.pi - 1.0, -0.1))
    )
    assert np.abs(up * np.array([1, 1, -1, 1, 1, -1])[:, None] - down).max() < 1e-12


def test_events_come_when_keplers_equation_says():
    """Apsides, nodes and a radius, to 1e-9 of the period."""
    e = 0.3
    start, _ = ellipse(e)
    period = TURN / (1 - e) ** 1.5
    tilted = start[0], (0, start[1][1] * np.cos(0.4), start[1][1] * np.sin(0.4))
    level = 1 / (1 - e)  # the end of the minor axis, at the mean anomaly pi / 2 - e
    watched = [(APSIS, 0, 0, RECORD), (NODE, 0, 0, RECORD), (RADIUS, level, 1, RECORD)]
    s = collocation.start(0.0, *tilted, 1.0, events=3)
    times = np.array([5.3 * period])
    arguments = dynamics.model(1.0), np.zeros(1), np.ones(1), watch(watched), times, np.empty((6, 1)), times[-1]
    assert collocation.advance(s, *arguments, 1e-10, np.inf) == collocation.DONE
    found = collocation.drain_events(s)
    of_kind = [np.array([time for index, time, _ in found if index == kind]) / period for kind in range(3)]
    assert of_kind[0] == pytest.approx(np.arange(1, 11) / 2, abs=1e-9)
    assert of_kind[1] == pytest.approx(np.arange(1, 11) / 2, abs=1e-9)
    assert of_kind[2] == pytest.approx(np.arange(6) + 0.25 - e / TURN, abs=1e-9)


def test_thrust_that_is_drawn_anew_equals_flights_one_after_the_other():
    breaks, factors = np.arange(0, 20, 0.7), 1 + 0.2 * np.sin(np.arange(29))
    sail = (0.05, attitude.ORBITAL, *attitude.direction_parameters(0.5, 1.0))
    whole, s = flown(ideal_sail(*sail), (1, 0, 0), (0, 1, 0), np.array([20.0]), 1e-12, breaks=breaks, factors=factors)
    y = np.array([1, 0, 0, 0, 1, 0.0])
    for begin, end, factor in zip(breaks, [*breaks[1:], 20.0], factors, strict=True):
        model = ideal_sail(0.05 * factor, *sail[1:])
        y = flown(model, y[:3], y[3:], np.array([end - begin]), 1e-12)[0][:, 0]
    assert np.abs(whole[:, 0] - y).max() < 1e-11
    assert collocation.statistics(s)[0] >= len(breaks)


# ---------------------------------------------------------------- eight at once
@entry("D2 D2 d R1", PARAMETERS)
def _both_ways(states, out, factor, parameters):
    """Accelerations (3, 8) at eight states (7, 8) at once, in the rows 0 to 2, and by `derivative`, in 3 to 5."""
    p = parameters[0]
    if not fits_lanes(p):
        return 1
    nodes, y, rate = out[6], states[7], out[7]
    store(nodes, collocation_memory.NODE, node())
    prepare(nodes, 3.0, 2.0, factor, p)
    place = load(states[0], 0), load(states[1], 0), load(states[2], 0)
    speed = load(states[3], 0), load(states[4], 0), load(states[5], 0)
    r2 = place[0] * place[0] + place[1] * place[1] + place[2] * place[2]
    inverse = 1.0 / np.sqrt(r2)
    ax, ay, az = forces_at_once(
        nodes, place[0], place[1], place[2], r2 * inverse, inverse, speed[0], speed[1], speed[2], 1.0, factor, p
    )
    pull = -p.gravity.mu * inverse * inverse * inverse
    store(out[0], 0, pull * place[0] + ax)
    store(out[1], 0, pull * place[1] + ay)
    store(out[2], 0, pull * place[2] + az)
    for i in range(8):
        for j in range(7):
            y[j] = states[j, i]
        derivative(3.0 + 2.0 * nodes[collocation_memory.NODE + i], y, factor, p, rate)
        for j in range(3):
            out[3 + j, i] = rate[3 + j]
    return 0


STEERING = {
    "radial": {"steering": attitude.RADIAL},
    "transverse": {"steering": attitude.TRANSVERSE},
    "orbital": {
        "steering": attitude.ORBITAL,
        "steering_parameters": attitude.direction_parameters(0.7, 0.4),
    },
    "meridian": {
        "steering": attitude.MERIDIAN,
        "steering_parameters": attitude.direction_parameters(0.7, 0.4),
    },
}
ROWS = [0.0, 3.3, 4.1, 9.0], [0.3, 0.9, 0.2, 0.5], [0.1, 0.8, -2.0, 3.0], [1.0, 0.5, 0.8, 1.0]
for _name, _kind in (("table", attitude.TABLE_ORBITAL), ("meridian table", attitude.TABLE_MERIDIAN)):
    for _interpolation in attitude.INTERPOLATIONS:
        STEERING[f"{_name}, {_interpolation}"] = {
            "steering": _kind,
            "table": attitude.table(*ROWS, interpolation=_interpolation),
            "interpolation": attitude.INTERPOLATIONS[_interpolation],
        }
DEVICES = {"none": {}, "film": {"device": dynamics.SOLAR_SAIL, "device_parameters": (0.3, 0.08, 0.82, -0.005)}}
DEVICES |= {
    name: {"device": dynamics.ELECTRIC_SAIL, "device_parameters": (0.2 / AU, kind, np.radians(100))}
    for name, kind in MODELS.items()
}


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("steering", STEERING)
def test_eight_forces_at_once_are_those_of_the_right_hand_side(steering, device):
    random = np.random.default_rng(3)
    states = np.ones((8, 8))
    states[:6] = random.uniform(-2, 2, (6, 8))
    air = (atmosphere.EXPONENTIAL, 0.1, 1.0, 0.7, 0.8)
    more = {"j2_strength": 1e-3, "zonal": (1e-3, 1e-3), "air": air, "rotation": 0.1}
    model = dynamics.model(1.0, **more, **STEERING[steering], **DEVICES[device])
    for factor in (1.0, 0.4, 0.0):
        out = np.zeros((8, LENGTH))
        assert _both_ways(states, out, factor, model.parameters) == 0
        together, alone = out[:3, :8], out[3:6, :8]
        assert np.isfinite(alone).any()
        assert together == pytest.approx(alone, rel=1e-12, abs=1e-13, nan_ok=True)


@entry("D1 d1")
def _exponentials(out, x):
    store(out, 0, np.exp(load(x, 0)))
    return 0


def test_exponentials_of_lanes_are_good_to_the_last_digit():
    random = np.random.default_rng(5)
    for size in (1.0, 30.0, 600.0):
        x, out = random.uniform(-size, size, 8), np.zeros(8)
        _exponentials(out, x)
        assert out == pytest.approx(np.exp(x), rel=4e-16)
    x, out = np.array([0.0, -0.0, 800, -800, 1e9, -1e9, np.log(2), 1]), np.zeros(8)
    _exponentials(out, x)
    assert out[:2].tolist() == [1.0, 1.0]
    assert np.isfinite(out).all()
    assert out[3] < 1e-300


def test_the_tables_integrate_polynomials_exactly():
    t = tables()
    for power in range(NODES):
        a = t.node**power
        assert t.velocity @ a == pytest.approx(t.node ** (power + 1) / (power + 1), rel=1e-14)
        assert t.position @ a == pytest.approx(t.node ** (power + 2) / (power + 1) / (power + 2), rel=1e-13, abs=1e-18)
        assert t.end_velocity @ a == pytest.approx(1 / (power + 1), rel=1e-14)
        assert t.end_position @ a == pytest.approx(1 / (power + 1) / (power + 2), rel=1e-14)
        assert t.monomial @ (2 * t.node - 1) ** power == pytest.approx(np.eye(NODES)[power], abs=1e-12)
    old = np.concatenate([t.node, 1 + t.node])
    for power in range(FITTED + 1):
        new = (t.node + 0.5) ** power  # of 2 + node, less 1.5
        assert t.following @ (old - 1.5) ** power == pytest.approx(new, rel=1e-7, abs=1e-7)
    assert np.abs(t.following).sum(axis=1).max() < 1e8  # by which it multiplies rounding
    assert np.sum(t.end_velocity) == pytest.approx(1.0, rel=1e-15)
    # the weights add up to 1 exactly, and these to 1/2, with what their doubles lack
    for table, left, whole in (
        (t.end_velocity, t.end_velocity_left, 1.0),
        (t.end_position, t.end_position_left, 0.5),
    ):
        assert abs(math.fsum([*table, *left, -whole])) < 1e-31
