"""Every shipped scene does what it says of itself, and an independent integration of the same physics agrees with it.

The right-hand side below is written from the models' papers in plain numpy, not from sailviz. A scene that needs a
device, a steering law or an environment that is missing here fails until its physics stands here too.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from sailviz.expectations import check
from sailviz.shipped import shipped_scenes

AU, MU_SUN, MU_EARTH, RADIUS_EARTH = 149_597_870_700.0, 1.32712440018e20, 3.986004418e14, 6_378_137.0
J2, ROTATION = 1.08262668e-3, 7.2921159e-5
CHARGE, EPSILON = 1.602176634e-19, 8.8541878128e-12
FILMS = {  # b1, b2, b3, efficiency
    "ideal": (0, 1, 0, 1),
    "eta-perfect": (0, 1, 0, 0.85),
    "jpl-1978": (0.0864, 0.8272, -0.0055, 1),
    "jpl-2015": (0.0723, 0.8554, -0.0030, 1),
}
SCENES = sorted(shipped_scenes())


@pytest.mark.parametrize("name", SCENES)
def test_scene_fulfils_its_expectations(shipped_run, name):
    verdicts = check(*shipped_run(name))
    assert verdicts, "a scene says what it expects of itself"
    assert all(verdict.passed for verdict in verdicts), "\n".join(map(str, verdicts))


@pytest.mark.parametrize("name", SCENES)
def test_scene_agrees_with_scipy(shipped_run, name):
    """Within 1e-8 of the distance over twenty revolutions or 2 % of the run, whichever is shorter, and one at least."""
    scene, run = shipped_run(name)
    mu = body(scene)[0]
    r, v = run.position[0], run.velocity[0]
    a = 1 / (2 / np.linalg.norm(r) - v @ v / mu)
    last = 0.02 * scene.propagation.duration
    if a > 0:
        turn = 2 * np.pi * np.sqrt(a**3 / mu)
        last = max(turn, min(20 * turn, last))
    rows = run.time <= last
    assert rows.sum() > 5
    position = integrate(scene, np.concatenate([r, v, run.mass[:1]]), run.time[rows])
    away = np.linalg.norm(run.position[rows] - position, axis=1) / np.linalg.norm(position, axis=1)
    assert away.max() < 1e-8


# ---------------------------------------------------------------- the independent integration
def integrate(scene, state, times):
    """Position (n, 3) at times, restarting wherever the thrust or a steering table has a kink."""
    breaks, factors = schedule(scene)
    edges = [*breaks[breaks < times[-1]], times[-1]]
    acceleration, mu = device(scene), body(scene)[0]
    rows = [state[None, :3]]
    scale = np.linalg.norm(state[:3])
    atol = 1e-16 * np.array([scale] * 3 + [np.sqrt(mu / scale)] * 3 + [state[6]])
    for i, (begin, end) in enumerate(pairwise(edges)):
        inside = times[(times > begin) & (times <= end)]
        # a piece belongs to the values at its beginning: time never quite reaches the next kink
        rhs = right_hand_side(scene, acceleration, factors[i], np.nextafter(end, begin))
        asked = np.unique([*inside, end])
        y = solve_ivp(rhs, (begin, end), state, "DOP853", asked, rtol=1e-13, atol=atol).y
        rows.append(y[:3, np.isin(asked, inside)].T)
        state = y[:, -1]
    return np.concatenate(rows)


def body(scene):
    """(mu, radius) of the central body."""
    return {"sun": (MU_SUN, 695_700e3), "earth": (MU_EARTH, RADIUS_EARTH)}.get(scene.body) or (
        scene.body.mu,
        scene.body.radius,
    )


def schedule(scene):
    """(breaks, factors): the thrust factor is factors[i] from breaks[i] on."""
    duration, wind = scene.propagation.duration, scene.environment.solar_wind
    kinks, draws = [0.0], None
    if wind.kind == "gamma":
        draws = np.random.Generator(np.random.PCG64(wind.seed)).gamma(
            wind.shape, wind.scale, int(np.ceil(duration / wind.redraw))
        )
        kinks += list(wind.redraw * np.arange(len(draws)))
        assert wind.reference == "mean"
    elif wind.kind != "steady":
        raise NotImplementedError(wind.kind)
    active = scene.device.active
    kinks += [t for pair in active or [] for t in pair]
    kinks += scene.steering.time if getattr(scene.steering, "interpolation", "cubic") != "cubic" else []
    breaks = np.array(sorted({t for t in kinks if 0 <= t < duration}))
    factors = []
    for t in breaks:
        on = active is None or any(a <= t < b for a, b in active)
        pressure = 1.0 if draws is None else draws[int((t + 1e-6) // wind.redraw)] / (wind.shape * wind.scale)
        factors.append(on * np.sqrt(pressure))
    return breaks, factors


def right_hand_side(scene, acceleration, factor, latest):
    mu, j2 = body(scene)[0], scene.environment.j2

    def rhs(t, y):
        r, v, mass = y[:3], y[3:6], y[6]
        size = np.sqrt(r @ r)
        a = -mu * r / size**3
        if j2:  # gradient of the potential -mu J2 R^2 (1 - 3 sin^2(latitude)) / (2 r^3)
            s = (r[2] / size) ** 2
            a = a - 1.5 * J2 * mu * RADIUS_EARTH**2 / size**5 * r * np.array([1 - 5 * s, 1 - 5 * s, 3 - 5 * s])
        rate = 0.0
        a = a + third_body(scene, t, r)
        if factor and acceleration is not None:
            throttle = getattr(scene.steering, "throttle", None)
            share = factor * (table(scene.steering, throttle, min(t, latest)) if throttle else 1.0)
            push, rate = acceleration(min(t, latest), r, v, mass)
            a, rate = a + share * push, share * rate
        return np.concatenate([v, a, [rate]])

    return rhs


def normal(scene, t, r, v):
    """Unit vector that the steering asks for."""
    steering, r_hat = scene.steering, r / np.linalg.norm(r)
    kind = steering.kind if steering else "radial"
    if kind in ("radial", "sun-facing", "vertical"):
        return r_hat
    if kind == "tangential":
        return v / np.linalg.norm(v)
    if kind == "inertial":
        return np.array(steering.direction) / np.linalg.norm(steering.direction)
    frame = "orbital"
    if kind == "circumferential":
        pitch, clock = np.pi / 2, np.pi / 2
    elif kind == "as designed":
        pitch, clock, _ = designed(scene, t)
        if pitch == 0:  # along the Sun line: no plane of motion is needed, and there may be none
            return r_hat
    elif kind == "table":
        frame = steering.frame
        pitch, clock = (table(steering, column, t) for column in (steering.pitch, steering.clock))
    elif kind in ("orbital", "meridian"):
        frame, pitch, clock = kind, steering.pitch, steering.clock
    else:
        raise NotImplementedError(kind)
    up = np.cross(r, v) if frame == "orbital" else np.array([0.0, 0.0, 1.0]) - r_hat[2] * r_hat
    up = up / np.linalg.norm(up)
    along = np.cross(up, r_hat)
    return np.cos(pitch) * r_hat + np.sin(pitch) * (np.sin(clock) * along + np.cos(clock) * up)


def table(steering, column, t):
    """Value of a column of a steering table at time t; the first and the last row hold before and after."""
    times = np.array(steering.time)
    t = np.clip(t, times[0], times[-1])
    if steering.interpolation == "hold":
        return column[np.searchsorted(times, t, side="right") - 1]
    return np.interp(t, times, column) if steering.interpolation == "linear" else CubicSpline(times, column)(t)


def film_of(device):
    film = device.film
    if isinstance(film, str):
        return FILMS[film]
    if hasattr(film, "b1"):
        return film.b1, film.b2, film.b3, film.efficiency
    share = (film.ef * film.Bf - film.eb * film.Bb) / (film.ef + film.eb) if film.ef + film.eb else 0.0
    b3 = (film.Bf * film.cr * (1 - film.cs) + (1 - film.cr) * share) / 2  # (3.20)
    return (1 - film.cr * film.cs) / 2, film.cr * film.cs, b3, 1.0


def film_force(film, cosine):
    """(along the light, along the normal) over the force of the same film facing the Sun."""
    b1, b2, b3, _ = film
    total = b1 + b2 + b3
    return cosine * b1 / total, cosine * (b2 * cosine + b3) / total


PLANETS = {  # semi-major axis au and eccentricity at J2000: Standish, JPL
    "mercury": (0.38709927, 0.20563593),
    "venus": (0.72333566, 0.00677672),
    "earth": (1.00000261, 0.01671123),
    "mars": (1.52371034, 0.09339410),
    "jupiter": (5.20288700, 0.04838624),
}


def held(scene, t):
    """(position, velocity, thrust acceleration that holds it) on the designed orbit at time t."""
    start = scene.start
    if start.kind == "displaced" or start.kind == "heliostationary":
        ratio = start.rate_ratio if start.kind == "displaced" else 0.0
        rate, azimuth = ratio * np.sqrt(MU_SUN / start.radius**3), start.azimuth
        rho, z = start.radius * np.cos(start.elevation), start.radius * np.sin(start.elevation)
        r, v, a = circling(rho, z, rate, azimuth + rate * t)
    elif start.kind == "lagrange-point":
        third = scene.environment.third_body
        radius, azimuth = (third.radius, third.azimuth) if third else (AU, 0.0)
        rate = np.sqrt(MU_SUN / radius**3)
        r, v, a = circling(start.radius, 0.0, rate, azimuth + rate * t)
        a = a - third_body(scene, t, r)
    elif start.kind == "planet-following":
        # r = k times the planet's ellipse, at the planet's longitude and a fixed elevation
        a, e = PLANETS[start.planet] if start.planet else (start.semi_major_axis / AU, start.eccentricity)
        x, dx, ddx = ellipse(a * AU, e, MU_SUN, start.true_anomaly, t)
        up = np.array([0, 0, np.tan(start.elevation)])
        k = start.radius_ratio * np.cos(start.elevation)
        size = np.linalg.norm(x)
        speed = x @ dx / size
        bend = (dx @ dx + x @ ddx - speed**2) / size
        r, v, a = k * (x + size * up), k * (dx + speed * up), k * (ddx + bend * up)
    elif start.kind == "flat-ellipse":
        e = start.eccentricity
        r, v, a = ellipse(start.semi_latus_rectum / (1 - e * e), e, start.mu_ratio * MU_SUN, start.true_anomaly, t)
        r = r + np.array([0, 0, start.height])
    else:
        raise NotImplementedError(start.kind)
    return r, v, a + MU_SUN * r / np.linalg.norm(r) ** 3


def circling(rho, z, rate, angle):
    """Position, velocity and acceleration on a circle about the z axis."""
    out, along = np.array([np.cos(angle), np.sin(angle), 0]), np.array([-np.sin(angle), np.cos(angle), 0])
    return rho * out + np.array([0, 0, z]), rate * rho * along, -(rate**2) * rho * out


def ellipse(a, e, mu, true_anomaly, t):
    """Position, velocity and acceleration on a Keplerian ellipse in the x-y plane, perihelion on the x axis."""
    half = np.tan(true_anomaly / 2) * np.sqrt((1 - e) / (1 + e))
    begin = 2 * np.arctan(half)
    mean = begin - e * np.sin(begin) + np.sqrt(mu / a**3) * t
    anomaly = brentq(lambda x: x - e * np.sin(x) - mean, mean - 1, mean + 1, xtol=1e-15, rtol=1e-15)
    shape = np.sqrt(1 - e * e)
    r = a * np.array([np.cos(anomaly) - e, shape * np.sin(anomaly), 0])
    rate = np.sqrt(mu / a**3) / (1 - e * np.cos(anomaly))
    v = a * rate * np.array([-np.sin(anomaly), shape * np.cos(anomaly), 0])
    return r, v, -mu * r / np.linalg.norm(r) ** 3


def third_body(scene, t, r):
    """Pull of a planet on a circular orbit in the ecliptic."""
    third = scene.environment.third_body
    if third is None:
        return np.zeros(3)
    angle = third.azimuth + np.sqrt(MU_SUN / third.radius**3) * t
    d = third.radius * np.array([np.cos(angle), np.sin(angle), 0]) - r
    return third.mu * d / np.linalg.norm(d) ** 3


def designed(scene, t):
    """(pitch, clock, characteristic acceleration) that hold the designed orbit at time t, by the force law alone."""
    r, v, a = held(scene, t)
    size, r_hat = np.linalg.norm(r), r / np.linalg.norm(r)
    out, sideways = a @ r_hat, a - (a @ r_hat) * r_hat
    across = np.linalg.norm(sideways)
    law = esail_force if scene.device.kind == "electric-sail" else lambda x: film_components(scene.device, x)
    most = np.arccos(3**-0.5) if scene.device.kind == "electric-sail" else np.radians(54)
    pitch, clock = 0.0, 0.0
    if across > 1e-12 * out:
        pitch = brentq(lambda x: law(x)[1] * out - across * law(x)[0], 0, most, xtol=1e-15)
        h = np.cross(r, v)
        h = h / np.linalg.norm(h)
        clock = np.arctan2(sideways @ np.cross(h, r_hat), sideways @ h)
    return pitch, clock, np.linalg.norm(a) / np.hypot(*law(pitch)) * (size / AU) ** law(pitch).exponent


class Force(tuple):
    """(along the Sun line, across it) over the force facing the Sun; exponent of its decrease with distance."""

    exponent = 2


class ElectricForce(Force):
    exponent = 1


def esail_force(pitch):
    """(3.39): half of r_hat + cos(alpha) n_hat."""
    c, s = np.cos(pitch), np.sin(pitch)
    return ElectricForce(((1 + c * c) / 2, s * c / 2))


def film_components(craft, pitch):
    light, along = film_force(film_of(craft), np.cos(pitch))
    return Force((light + along * np.cos(pitch), along * np.sin(pitch)))


def device(scene):
    """(t, r, v, mass) -> acceleration, mass rate; None without a device."""
    craft = scene.device
    return {"solar-sail": solar_sail, "electric-sail": electric_sail, "plasma-brake": brake, "thruster": thruster}.get(
        craft.kind, lambda scene: None
    )(scene)


def solar_sail(scene):
    craft, film = scene.device, film_of(scene.device)
    ac = craft.characteristic_acceleration
    if ac is not None:
        pass
    elif craft.lightness_number is not None:
        ac = film[3] * craft.lightness_number * MU_SUN / AU**2
    else:
        ac = film[3] * 2 * 4.563e-6 * craft.area / craft.mass * sum(film[:3])

    def push(t, r, v, mass):
        n, size = normal(scene, t, r, v), np.linalg.norm(r)
        cosine = n @ r / size
        if cosine <= 0:
            return np.zeros(3), 0.0
        light, along = film_force(film, cosine)
        ac_now = designed(scene, t)[2] if ac == "as designed" else ac
        return ac_now * (AU / size) ** 2 * (light * r / size + along * n), 0.0

    return push


def electric_sail(scene):
    craft = scene.device
    ac = craft.characteristic_acceleration
    if ac is None:
        sigma = 0.18 * (craft.voltage - craft.wind_potential) * np.sqrt(EPSILON * craft.wind_pressure)  # (3.41)
        ac = craft.tethers * craft.tether_length * sigma / craft.mass

    def push(t, r, v, mass):
        n, size = normal(scene, t, r, v), np.linalg.norm(r)
        r_hat = r / size
        if craft.model == "final":
            ac_now = designed(scene, t)[2] if ac == "as designed" else ac
            return ac_now / 2 * (AU / size) * (r_hat + (r_hat @ n) * n), 0.0  # (3.39)
        n = n if n @ r_hat >= 0 else -n
        pitch = np.arccos(min(n @ r_hat, 1.0))
        cone, gamma, power = pitch / 2, 1.0, 7 / 6 if craft.model == "original" else 1.0
        if craft.model == "polynomial":
            d = np.degrees(pitch)
            cone = np.radians(
                np.polyval([3.681e-10, -8.295e-8, 6.322e-6, -2.661e-4, 3.652e-3, 4.853e-1, 0], d).clip(min=0)
            )
            gamma = min(1, np.polyval([-5.896e-13, 1.943e-10, -1.261e-8, 7.027e-7, -1.271e-4, 6.904e-5, 1], d))
        across = n - (n @ r_hat) * r_hat
        across = across / (np.linalg.norm(across) or 1.0)
        return gamma * ac * (AU / size) ** power * (np.cos(cone) * r_hat + np.sin(cone) * across), 0.0

    return push


def brake(scene):
    craft, profile, radius = scene.device, scene.environment.ionosphere, body(scene)[1]
    spin = np.array([0, 0, ROTATION if scene.environment.corotation else 0.0])

    def push(t, r, v, mass):
        up = r / np.linalg.norm(r)
        u = v - np.cross(spin, r)
        u = u - (u @ up) * up
        speed = np.linalg.norm(u)
        fade = np.exp((profile.reference_altitude - (np.linalg.norm(r) - radius)) / profile.scale_height)
        if profile.kind == "exponential-force":
            f = profile.force_per_length * fade
        elif profile.kind == "exponential-density":
            n, m = profile.density * fade, profile.ion_mass
            sheath = np.sqrt(EPSILON * craft.voltage / (CHARGE * n))
            v_t = craft.voltage / np.log(sheath / craft.wire_radius)
            f = (
                3.864
                * m
                * n
                * speed**2
                * np.sqrt(EPSILON * v_t / (CHARGE * n))
                * np.exp(-m * speed**2 / (2 * CHARGE * v_t))
            )
        else:
            raise NotImplementedError(profile.kind)
        return -craft.tether_length * f / mass * u / speed, 0.0

    return push


def thruster(scene):
    craft = scene.device

    def push(t, r, v, mass):
        a = craft.acceleration if craft.thrust is None else craft.thrust / mass
        rate = 0.0 if craft.specific_impulse is None else -mass * a / (9.80665 * craft.specific_impulse)  # (2.3)
        return a * normal(scene, t, r, v), rate

    return push
