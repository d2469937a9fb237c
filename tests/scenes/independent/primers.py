"""Steering towards a primer, by brute force."""

from __future__ import annotations

import numpy as np
from independent.constants import AU, FILMS, MU_SUN, body
from independent.film import Force, esail_force, film_force, film_of
from scipy.integrate import solve_ivp
from scipy.optimize import brentq


def most_along(scene, r_hat, primer):
    """The normal of the most thrust along a primer, zero where there is none: the attitudes are tried."""
    size = np.linalg.norm(primer)
    if size == 0:
        return np.zeros(3)
    along = r_hat @ primer / size
    across = primer / size - along * r_hat
    pitch = best_pitch(shape_of(scene), np.arctan2(np.linalg.norm(across), along))
    if pitch is None:
        return np.zeros(3)
    return np.cos(pitch) * r_hat + np.sin(pitch) * across / (np.linalg.norm(across) or 1.0)


def shape_of(scene):
    """pitch -> force along and across the Sun line of the sail that the law reckons with."""
    other = scene.steering.reckons_with
    if other is None:
        if scene.device.kind == "electric-sail":
            assert scene.device.model == "final"
            return esail_force
        film = film_of(scene.device)
    elif other == "electric-sail":
        return esail_force
    else:
        film = FILMS[other]

    def shape(pitch):
        light, along = film_force(film, np.cos(pitch))
        return Force((light + along * np.cos(pitch), along * np.sin(pitch)))

    return shape


PITCHES = np.radians(np.linspace(0, 90, 181))


def best_pitch(shape, angle):
    """Pitch of the most force along a primer at an angle from the Sun line, None where every force is against it."""

    def gain(pitch):
        along, across = shape(pitch)
        return np.cos(angle) * along + np.sin(angle) * across

    k = int(np.argmax(gain(PITCHES)))
    low, high = PITCHES[max(k - 1, 0)], PITCHES[min(k + 1, 180)]
    pitch = PITCHES[k]
    if k < 180 and angle > 0:
        pitch = brentq(lambda x: gain(x + 1e-30j).imag, low, high, xtol=1e-16, rtol=1e-15)
    return pitch if gain(pitch) > 0 else None


def optimal_primer(scene, t, r, v):
    """The primer in time of the flight that the scene's costates begin, of the sail that the law reckons with."""
    key = scene.identity()
    if key not in FLOWN:
        FLOWN[key] = costate_flight(scene, r, v)  # asked first at the start
    return FLOWN[key](t)[9:]


FLOWN = {}


def costate_flight(scene, r, v):
    """Dense state and costates: H = lam_r v + lam_v (a_gravity + a_thrust) is largest and constant."""
    shape, numbers = shape_of(scene), scene.steering.costates
    power, strength = shape(0.0).exponent, scene.device.characteristic_acceleration
    u = r / np.linalg.norm(r)
    if len(numbers) == 3:
        unit = np.linalg.norm(r)
        speed = np.sqrt(MU_SUN / unit)
        along = np.cross(np.cross(r, v), u) / np.linalg.norm(np.cross(r, v))
        lam_r, lam_u, lam_v = numbers
        lam = [lam_r * u + (lam_u * (v @ along) - lam_v * (v @ u)) / speed * along, lam_u * u + lam_v * along]
    else:
        unit, speed = AU, np.sqrt(MU_SUN / AU)
        lam = np.reshape(numbers, (2, 3))
    start = np.concatenate([r, v, lam[0] * speed / unit, lam[1]])

    def rates(t, y):
        r, v, lam_r, lam_v = y.reshape(4, 3)
        distance, size = np.linalg.norm(r), np.linalg.norm(lam_v)
        u = r / distance
        c = u @ lam_v / size
        across = lam_v / size - c * u
        s = np.linalg.norm(across)
        pitch = best_pitch(shape, np.arctan2(s, c))
        f_r, f_t = (0.0, 0.0) if pitch is None else shape(pitch)
        full = strength * (AU / distance) ** power
        a = -MU_SUN * r / distance**3 + full * (f_r * u + f_t * across / s)
        pull = MU_SUN * (lam_v / distance**3 - 3 * (lam_v @ r) * r / distance**5)
        # the support function h(c) = c f_r + s f_t at its maximum has the slope f_r - f_t c / s
        h, slope = c * f_r + s * f_t, f_r - f_t * c / s
        push = full * size / distance * (slope * across - power * h * u)
        return np.concatenate([v, a, pull - push, -lam_r])

    scale = np.repeat([np.linalg.norm(x) for x in start.reshape(4, 3)], 3)
    arcs = scene.steering.arcs  # the first one is at full thrust, and behind it the switch would be thrown without end
    end = arcs[0].duration if arcs else scene.propagation.duration
    pieces, begin = [], 0.0
    for touch in [*(scene.steering.touches or ()), None]:  # where the costate of the radius jumps
        until = end if touch is None else touch.time
        flown = solve_ivp(rates, (begin, until), start, "DOP853", rtol=1e-13, atol=1e-15 * scale, dense_output=True)
        pieces.append((until, flown.sol))
        if touch is not None:
            begin, start = until, flown.y[:, -1].copy()
            start[6:9] += touch.jump * speed / unit * start[:3] / np.linalg.norm(start[:3])
    return lambda t: next((sol for until, sol in pieces if t <= until), pieces[-1][1])(t)


def steepest(function, r, v):
    """Gradient over the velocity, by complex steps."""
    step = 1e-20j * np.linalg.norm(v)
    return np.array([function(r, v + step * axis).imag for axis in np.eye(3)]) / abs(step)


def local_primer(scene, t, r, v):
    if scene.steering.goal == "energy":
        assert not scene.steering.minimum_perigee or at_least(scene, r, v) > scene.steering.minimum_perigee + 100e3
        return v if scene.steering.sense == "increase" else -v
    if scene.steering.goal != "inclination":
        raise NotImplementedError(scene.steering.goal)

    def inclination(r, v):
        h = np.cross(r, v)
        return np.arctan(np.sqrt(h[0] ** 2 + h[1] ** 2) / h[2]) if abs(h[2]) > abs(h[0]) else np.arccos(h[2] / root(h))

    return (1 if scene.steering.sense == "increase" else -1) * steepest(inclination, r, v)


def at_least(scene, r, v):
    """Distance of the nearest point of the osculating orbit: above the margin the guard of a perigee sleeps."""
    mu, h = body(scene)[0], np.cross(r, v)
    e = np.cross(v, h) / mu - r / np.linalg.norm(r)
    return h @ h / mu / (1 + np.linalg.norm(e))


def root(x):
    """Length of a complex vector, without conjugation."""
    return np.sqrt(np.sum(x * x))


def lyapunov_primer(scene, t, r, v):
    law = scene.steering
    tangent, longitude = np.tan(law.inclination / 2), law.raan + law.argument
    p = law.semi_major_axis * (1 - law.eccentricity**2)
    target = [1.0, law.eccentricity * np.cos(longitude), law.eccentricity * np.sin(longitude)]
    target += [tangent * np.cos(law.raan), tangent * np.sin(law.raan)]

    def value(r, v):
        h_vec = np.cross(r, v)
        w = h_vec / root(h_vec)
        h, k = -w[1] / (1 + w[2]), w[0] / (1 + w[2])
        e = np.cross(v, h_vec) / MU_SUN - r / root(r)
        size = 1 + h * h + k * k
        f_hat, g_hat = np.array([1 + h * h - k * k, 2 * h * k, -2 * k]), np.array([2 * h * k, 1 - h * h + k * k, 2 * h])
        now = np.array([np.sum(h_vec**2) / MU_SUN / p, np.sum(e * f_hat) / size, np.sum(e * g_hat) / size, h, k])
        return np.sum(law.weights * (now - target) ** 2)

    if value(r, v) <= law.within**2:
        return np.zeros(3)
    return -steepest(value, r, v)


def ease(x):
    """What a soft edge leaves of the thrust: a parabola from its bottom, 0, to its rim, 1."""
    return 1 - (1 - min(x, 1.0)) ** 2


def soft_edges(scene, t, r, v):
    """The share of the best thrust that a law steered by the state uses; 1 of any other."""
    law = scene.steering
    if law is None or law.kind not in ("lyapunov", "locally-optimal"):
        return 1.0
    if scene.body != "sun" and film_of(scene.device)[:3] == (0, 1, 0):  # ends by itself where the light is elsewhere
        return 1.0
    primer = PRIMERS[law.kind](scene, t, r, v)
    size = np.linalg.norm(primer)
    if size == 0:
        return 0.0
    angle = np.arccos(np.clip(r @ primer / np.linalg.norm(r) / size, -1, 1))
    pitch = best_pitch(shape_of(scene), angle)
    if pitch is None:
        return 0.0
    along, across = shape_of(scene)(pitch)
    share = ease((np.cos(angle) * along + np.sin(angle) * across) / 0.05)
    h = np.cross(r, v)
    if law.kind == "locally-optimal":  # of the inclination
        if law.sense == "increase":
            return share
        node = np.array([-h[1], h[0], 0.0]) / np.hypot(h[0], h[1])
        share *= ease(abs(node @ r) / np.linalg.norm(r) / 0.05)
        tilt = np.arctan2(np.hypot(h[0], h[1]), abs(h[2]))
        return share * ease(tilt / 1e-3)
    p, target = h @ h / MU_SUN, law.semi_major_axis * (1 - law.eccentricity**2)
    longitude, tangent = law.raan + law.argument, np.tan(law.inclination / 2)
    w = h / np.linalg.norm(h)
    tilt = np.array([-w[1], w[0]]) / (1 + w[2])
    s2 = 1 + tilt @ tilt
    f_hat = np.array([1 + tilt[0] ** 2 - tilt[1] ** 2, 2 * tilt[0] * tilt[1], -2 * tilt[1]]) / s2
    g_hat = np.array([2 * tilt[0] * tilt[1], 1 - tilt[0] ** 2 + tilt[1] ** 2, 2 * tilt[0]]) / s2
    e = np.cross(v, h) / MU_SUN - r / np.linalg.norm(r)
    misses = np.array(
        [
            p / target - 1,
            e @ f_hat - law.eccentricity * np.cos(longitude),
            e @ g_hat - law.eccentricity * np.sin(longitude),
            tilt[0] - tangent * np.cos(law.raan),
            tilt[1] - tangent * np.sin(law.raan),
        ]
    )
    weights = np.array(law.weights)
    pulls = np.abs(weights * misses) * [2 * p / target, 2, 2, s2 / 2, s2 / 2]
    distance = np.sqrt(weights @ misses**2)
    share *= ease(size / (0.05 * 2 * np.sqrt(p / MU_SUN) * pulls.sum()))
    return share * ease((distance / law.within - 1) / 0.1)


PRIMERS = {"optimal": optimal_primer, "locally-optimal": local_primer, "lyapunov": lyapunov_primer}
