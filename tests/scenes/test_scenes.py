"""Every shipped scene does what it says of itself, and an independent integration of the same physics agrees with it.

The right-hand side below is written from the models' papers in plain numpy, not from sailviz. A scene that needs a
device, a steering law or an environment that is missing here fails until its physics stands here too.
"""

from __future__ import annotations

from datetime import datetime
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from numpy.polynomial.legendre import Legendre
from scipy import stats
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline, RegularGridInterpolator
from scipy.optimize import brentq

import sailviz
from sailviz.checks.expectations import check
from sailviz.design.minimum_time.smoothed import smoothed_transfer
from sailviz.scene.environment import SteadyWind
from sailviz.shipped import shipped_folder, shipped_scenes

AU, MU_SUN, MU_EARTH, RADIUS_EARTH = 149_597_870_700.0, 1.32712440018e20, 3.986004418e14, 6_378_137.0
J2, J3, J4, ROTATION = 1.08262668e-3, -2.53265649e-6, -1.61962159e-6, 7.2921159e-5
CHARGE, EPSILON = 1.602176634e-19, 8.8541878128e-12
FILMS = {  # b1, b2, b3, efficiency
    "ideal": (0, 1, 0, 1),
    "eta-perfect": (0, 1, 0, 0.85),
    "jpl-1978": (0.0864, 0.8272, -0.0055, 1),
    "jpl-2015": (0.0723, 0.8554, -0.0030, 1),
}
SCENES = sorted(shipped_scenes())
MOST_JUMPS = 150  # of the thrust, each of which begins the integration anew


@pytest.mark.parametrize("name", SCENES)
def test_scene_fulfils_its_expectations(shipped_run, name):
    verdicts = check(*shipped_run(name))
    assert verdicts, "a scene says what it expects of itself"
    assert all(verdict.passed for verdict in verdicts), "\n".join(map(str, verdicts))


@pytest.mark.parametrize("name", SCENES)
def test_scene_agrees_with_scipy(shipped_run, name):
    """Within 1e-8 of the distance over twenty revolutions or 2 % of the run, whichever is shorter, and one at least.

    Where the thrust jumps often, as far as MOST_JUMPS of its jumps. Where tables are looked up, which plain Python does
    slowly, two revolutions; and in steps of 10 s, since at the scene's own tolerance the kinks of tables and the edges
    of the shadow cost up to a metre per revolution.
    """
    scene, run = shipped_run(name)
    mu = body(scene)[0]
    r, v = run.position[0], run.velocity[0]
    a = 1 / (2 / np.linalg.norm(r) - v @ v / mu)
    last = 0.02 * scene.propagation.duration
    if a > 0:
        turn = 2 * np.pi * np.sqrt(a**3 / mu)
        last = max(turn, min((2 if tabled(scene) else 20) * turn, last))
    runs = [(run, 1e-8)]
    if tabled(scene):
        own = {"duration_s": last, "outputs": 40, "tolerance": scene.propagation.tolerance}
        fine = own | {"tolerance": 1e-13, "largest_step_s": 10, "integrator": "dop853"}
        again = [sailviz.simulate(scene.with_values({"propagation": values})) for values in (own, fine)]
        runs = [(again[0], 1e-6), (again[1], 1e-8)]
    jumps = schedule(scene)[0]
    rows = runs[0][0].time <= min([last, *jumps[MOST_JUMPS : MOST_JUMPS + 1]])
    assert rows.sum() > 5
    position = integrate(scene, np.concatenate([r, v, run.mass[:1]]), runs[0][0].time[rows])
    for flown, within in runs:
        away = np.linalg.norm(flown.position[rows] - position, axis=1) / np.linalg.norm(position, axis=1)
        assert away.max() < within


def tabled(scene):
    """Whether forces have kinks or jumps that no step can be told of."""
    around = scene.environment
    tables = [
        getattr(part, "kind", "") in ("iri-2020", "nrlmsis-2.1") for part in (around.ionosphere, around.atmosphere)
    ]
    return any(tables) or getattr(scene.device, "eclipse", "on") != "on"


# ---------------------------------------------------------------- the independent integration
def integrate(scene, state, times):
    """Position (n, 3) at times, restarting wherever the thrust or a steering table has a kink."""
    breaks, factors = schedule(scene)
    voltage = controlled(scene, state, breaks[breaks < times[-1]])
    edges = [*breaks[breaks < times[-1]], times[-1]]
    acceleration, mu = device(scene), body(scene)[0]
    longest = 30.0 if tabled(scene) else np.inf
    rows = [state[None, :3]]
    scale = np.linalg.norm(state[:3])
    atol = 1e-16 * np.array([scale] * 3 + [np.sqrt(mu / scale)] * 3 + [state[6]])
    for i, (begin, end) in enumerate(pairwise(edges)):
        inside = times[(times > begin) & (times <= end)]
        # a piece belongs to the values at its beginning: time never quite reaches the next kink
        factor = factors[i] if voltage is None else voltage(begin, state, factors[i])
        rhs = right_hand_side(scene, acceleration, factor, np.nextafter(end, begin))
        asked = np.unique([*inside, end])
        y = solve_ivp(rhs, (begin, end), state, "DOP853", asked, rtol=1e-13, atol=atol, max_step=longest).y
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
    """(breaks, factors): the thrust factor at nominal voltage is factors[i] from breaks[i] on."""
    duration, control = scene.propagation.duration, getattr(scene.device, "control", None)
    redrawn, draws = history(scene)
    active = scene.device.active
    kinks = [0.0, *redrawn, *(t for pair in active or [] for t in pair)]
    if getattr(control, "interval", None):
        kinks += list(np.arange(0, duration, control.interval))
    if scene.steering is not None and scene.steering.kind == "smoothed-transfer":
        kinks += list(smoothed(scene)[0])
    elif getattr(scene.steering, "interpolation", "cubic") != "cubic":
        kinks += scene.steering.time
    breaks = np.array(sorted({t for t in kinks if 0 <= t < duration}))
    on = np.array([active is None or any(a <= t < b for a, b in active) for t in breaks])
    return breaks, on * draws[np.searchsorted(redrawn, breaks, side="right") - 1]


def history(scene):
    """(times, thrust over nominal thrust from each on) of the scene's wind or sunshine at nominal voltage."""
    duration, wind, light = scene.propagation.duration, scene.environment.solar_wind, scene.environment.irradiance
    if light.kind == "cycle":
        times = np.arange(0, duration, light.redraw)
        random = np.random.Generator(np.random.PCG64(np.random.SeedSequence(light.seed, spawn_key=(3,))))
        noise = relaxing(random.standard_normal(len(times)), 0.80 ** (light.redraw / 86400))
        since = (np.datetime64(scene.epoch_utc, "s") - np.datetime64("1991-01-27T16")) / np.timedelta64(1, "s")
        turn = 2 * np.pi * (times + since) / (11.15 * 365.25 * 86400)
        share = 1 + light.amplitude * np.cos(turn) + light.flicker * noise
        if scene.device.control is not None:  # black takes half a mirror's push; the dimmest Sun is the reference
            black = np.minimum(2 / scene.device.control.fraction * (1 - share.min() / share), 1)
            share = share / share.min() * (1 - scene.device.control.fraction / 2 * black)
        return times, share
    if wind.kind == "steady":
        return np.zeros(1), np.ones(1)
    if wind.kind != "gamma":
        raise NotImplementedError(wind.kind)
    random = np.random.Generator(np.random.PCG64(wind.seed))
    times = np.zeros(1) if wind.variation == "constant" else np.arange(0, duration, wind.redraw)
    if wind.variation == "correlated":
        z = relaxing(random.standard_normal(len(times)), np.exp(-wind.redraw / wind.correlation_time))
        draws = stats.gamma(wind.shape, scale=wind.scale).ppf(stats.norm.cdf(z))
    else:
        draws = random.gamma(wind.shape, wind.scale, len(times))
    reference = {"mean": wind.shape * wind.scale}.get(wind.reference, wind.reference)
    return times, np.sqrt(draws / reference)


def relaxing(z, memory):
    """Independent normal numbers made into a chain that remembers."""
    for i in range(1, len(z)):
        z[i] = memory * z[i - 1] + np.sqrt(1 - memory**2) * z[i]
    return z


def controlled(scene, state, breaks):
    """(time, state, factor at nominal voltage) -> factor under the scene's voltage control; None without any."""
    law = getattr(scene.device, "control", None)
    if law is None or law.kind == "electrochromic":
        return None
    potential, held = scene.device.wind_potential, [law.nominal_voltage]
    updates = list(np.arange(0, scene.propagation.duration, law.interval))
    aim = {} if law.kind == "pressure" else reference_flight(scene, state, [t for t in breaks if t in updates])

    def factor(t, y, nominal):
        if t in updates:
            r, u = np.linalg.norm(y[:3]), y[:3] @ y[3:6] / np.linalg.norm(y[:3])
            if law.kind == "pressure":
                wanted = 1 / nominal
            else:
                r0, u0 = aim[t]
                wanted = 1 + law.position_gain * (1 - r / r0) + law.speed_gain * (u0 - u) / np.sqrt(MU_SUN / r0)
            wish = potential + (law.nominal_voltage - potential) * wanted
            held[0] = min(max(wish, law.minimum_voltage), law.maximum_voltage)
        return nominal * max(held[0] - potential, 0) / (law.nominal_voltage - potential)

    return factor


def reference_flight(scene, state, times):
    """Time -> (distance, radial speed) of the flight in a steady wind, which the distance law leads back to."""
    if hasattr(scene.start, "position_offset"):
        return {t: (scene.start.radius, 0.0) for t in times}
    calm = scene.environment.model_copy(update={"solar_wind": SteadyWind(kind="steady")})
    free = scene.device.model_copy(update={"control": None})
    rest = scene.model_copy(update={"environment": calm, "device": free})
    step = 60.0  # a difference over two minutes gives the speed to 1e-9 of it
    around = np.unique([t + k * step for t in times for k in (-1, 0, 1) if t + k * step >= 0])
    r = dict(zip(around, np.linalg.norm(integrate(rest, state, around), axis=1), strict=True))
    begin = state[:3] @ state[3:6] / np.linalg.norm(state[:3])
    return {t: (r[t], (r[t + step] - r[t - step]) / (2 * step) if t else begin) for t in times}


def smoothed(scene):
    """(times, pitch, throttle) of a smoothed transfer: the design's own table, whose arrival is tested with it."""
    s, r0 = scene.steering, scene.start.radius
    strength = scene.device.characteristic_acceleration * AU * r0 / MU_SUN
    clock = np.sqrt(r0**3 / MU_SUN)
    return shot(s.radius / r0, strength, tuple(s.costates), scene.propagation.duration, s.hold, s.width, clock)


@cache
def shot(ratio, strength, costates, duration, hold, width, clock):
    found = smoothed_transfer(ratio, strength, np.array(costates), duration / clock, hold / clock, width)
    return found.time * clock / len(found.pitch) * np.arange(len(found.pitch)), found.pitch, found.throttle


def right_hand_side(scene, acceleration, factor, latest):
    mu, around = body(scene)[0], scene.environment
    drag = air_drag(scene)
    smooth = smoothed(scene) if getattr(scene.steering, "kind", "") == "smoothed-transfer" else None

    def rhs(t, y):
        r, v, mass = y[:3], y[3:6], y[6]
        size = np.sqrt(r @ r)
        a = -mu * r / size**3
        if around.j2:
            a = a + oblate(around, r)
        if drag is not None:
            a = a + drag(t, r, v, mass)
        rate = 0.0
        a = a + third_body(scene, t, r)
        if factor and acceleration is not None:
            throttle = getattr(scene.steering, "throttle", None)
            share = factor * (table(scene.steering, throttle, min(t, latest)) if throttle else 1.0)
            if smooth is not None:
                share *= smooth[2][np.searchsorted(smooth[0], min(t, latest), side="right") - 1]
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
    if kind in PRIMERS:
        return most_along(scene, r_hat, PRIMERS[kind](scene, t, r, v))
    frame = "orbital"
    if kind == "circumferential":
        pitch, clock = np.pi / 2, np.pi / 2
    elif kind == "as designed":
        pitch, clock, _ = designed(scene, t)
        if pitch == 0:  # along the Sun line: no plane of motion is needed, and there may be none
            return r_hat
    elif kind == "smoothed-transfer":
        times, angles, _ = smoothed(scene)
        pitch, clock = angles[np.searchsorted(times, t, side="right") - 1], np.pi / 2
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
        if not n.any():
            return np.zeros(3), 0.0
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
    """Coulomb drag of a charged tether: Janhunen's law, or the electric sail's for a positive one."""
    craft, profile, radius = scene.device, scene.environment.ionosphere, body(scene)[1]
    assert scene.environment.magnetic_sensitivity == 0
    law = scene.steering.kind if scene.steering else "vertical"
    full = abs(craft.voltage)
    table = density_factor = None
    if profile.kind == "iri-2020":
        table, density_factor = plasma_table(), profile.density_factor
    limited = craft.power is not None or craft.eclipse != "on"

    def plasma(t, r):
        """(density, ion mass)."""
        if table is not None:
            n, mass = np.exp(table(place(scene, t, r))[:3]), table(place(scene, t, r))[3:]
            levels, flux = [70.0, 145.0, 193.0], solar_flux(scene, t)
            return density_factor * np.exp(np.interp(flux, levels, np.log(n))), np.interp(flux, levels, mass)
        fade = np.exp((profile.reference_altitude - (np.linalg.norm(r) - radius)) / profile.scale_height)
        return profile.density * fade, profile.ion_mass

    def per_length(n, m, speed, voltage):
        if voltage <= m * speed**2 / (2 * CHARGE):
            return 0.0
        if craft.polarity == "positive":
            return 0.18 * (voltage - m * speed**2 / (2 * CHARGE)) * np.sqrt(EPSILON * m * n * speed**2)
        sheath = np.sqrt(EPSILON * voltage / (CHARGE * n))
        v_t = voltage / np.log(sheath / craft.wire_radius)
        thickness = np.sqrt(EPSILON * v_t / (CHARGE * n))
        return 3.864 * m * n * speed**2 * thickness * np.exp(-m * speed**2 / (2 * CHARGE * v_t))

    def voltage_at(t, r, n, m, speed):
        lit = not limited or sunlit(scene, t, r)
        available = craft.power if lit else {"on": craft.power, "off": 0, "limited": craft.eclipse_power}[craft.eclipse]
        if available is None:
            return full
        assert craft.polarity == "negative"

        def excess(voltage):
            rate = np.sqrt(2 * CHARGE * voltage / m + speed**2)
            return (
                voltage * CHARGE * n * craft.wire_diameter * craft.tether_length * rate / craft.efficiency - available
            )

        return full if excess(full) <= 0 else brentq(excess, 0.0, full, xtol=1e-12, rtol=1e-14)

    def push(t, r, v, mass):
        up = r / np.linalg.norm(r)
        u = v - np.cross(spin_of_earth(scene), r)
        level = u - (u @ up) * up
        if profile.kind == "exponential-force":
            height = np.linalg.norm(r) - radius
            f = profile.force_per_length * np.exp((profile.reference_altitude - height) / profile.scale_height)
            return -craft.tether_length * f / mass * level / np.linalg.norm(level), 0.0
        n, m = plasma(t, r)
        voltage = voltage_at(t, r, n, m, np.linalg.norm(u))
        if law == "spinning":  # in the plane of motion: the mean of |sin|^3; about the velocity: all of it
            share = 4 / (3 * np.pi) if scene.steering.plane == "along-track" else 1.0
            return -share * craft.tether_length * per_length(
                n, m, np.linalg.norm(u), voltage
            ) / mass * u / np.linalg.norm(u), 0.0
        along = up
        if law == "gravity-gradient":  # moments about the hinge: drag of the hanging tether against 3 n^2 sin cos
            ahead = level / np.linalg.norm(level)
            force = craft.tether_length * per_length(n, m, np.linalg.norm(level), voltage)
            tether = craft.tether_mass if craft.tether_mass is not None else 11e-6 * craft.tether_length
            rate2 = MU_EARTH / np.linalg.norm(r) ** 3
            lean = np.arctan(force / (6 * rate2 * (craft.tip_mass + tether / 3) * craft.tether_length))
            along = np.cos(lean) * up + np.sin(lean) * ahead
        across = u - (u @ along) * along
        speed = np.linalg.norm(across)
        return -craft.tether_length * per_length(n, m, speed, voltage) / mass * across / speed, 0.0

    return push


# ---------------------------------------------------------------- what surrounds a low orbit
def spin_of_earth(scene):
    return np.array([0, 0, ROTATION if scene.environment.corotation else 0.0])


def days_since_j2000(scene, t):
    epoch = scene.epoch if isinstance(scene.epoch, datetime) else datetime(*scene.epoch.timetuple()[:3])
    return (epoch.replace(tzinfo=None) - datetime(2000, 1, 1, 12)).total_seconds() / 86400 + t / 86400


def mean_longitude(scene, t):
    """Of the Sun, rad: the right ascension of the mean Sun, by which local time goes."""
    if scene.epoch is None:
        return (scene.environment.sun_right_ascension or 0.0) + 2 * np.pi * t / (365.25 * 86400)
    return np.radians(280.460 + 0.9856474 * days_since_j2000(scene, t))


def sun(scene, t):
    """Unit vector to the Sun, equator of date: Astronomical Almanac, low precision."""
    longitude, tilt = mean_longitude(scene, t), np.radians(23.439)
    if scene.epoch is not None:
        n = days_since_j2000(scene, t)
        g = np.radians(357.528 + 0.9856003 * n)
        longitude += np.radians(1.915 * np.sin(g) + 0.020 * np.sin(2 * g))
        tilt -= np.radians(4e-7 * n)
    return np.array([np.cos(longitude), np.cos(tilt) * np.sin(longitude), np.sin(tilt) * np.sin(longitude)])


def sunlit(scene, t, r):
    """Whether at least half of the Sun is seen. In the cone, the Sun's centre at the limb stands for that: 5 ms."""
    to_sun, radius = sun(scene, t), body(scene)[1]
    if scene.environment.shadow == "cylinder":
        return r @ to_sun > 0 or np.linalg.norm(r - (r @ to_sun) * to_sun) > radius
    to_sun = AU * to_sun - r
    apart = np.arccos(-(to_sun @ r) / np.linalg.norm(to_sun) / np.linalg.norm(r))
    return apart > np.arcsin(radius / np.linalg.norm(r))


def altitude(scene, r):
    """Above the sphere, or above the ellipsoid by Bowring's iteration."""
    if scene.environment.height_above == "sphere":
        return np.linalg.norm(r) - body(scene)[1]
    flattening = 1 / 298.257223563
    squash = flattening * (2 - flattening)
    out = np.hypot(r[0], r[1])
    tangent = r[2] / (out * (1 - squash))
    for _ in range(4):
        latitude = np.arctan(tangent)
        curvature = RADIUS_EARTH / np.sqrt(1 - squash * np.sin(latitude) ** 2)
        tangent = (r[2] + squash * curvature * np.sin(latitude)) / out
    return out * np.cos(latitude) + r[2] * np.sin(latitude) - RADIUS_EARTH**2 / curvature


def place(scene, t, r):
    """(latitude deg, local time h, altitude km) as the tables count them."""
    hour = np.degrees(np.arctan2(r[1], r[0]) - mean_longitude(scene, t)) / 15 + 12
    return np.degrees(np.arcsin(r[2] / np.linalg.norm(r))), hour % 24, altitude(scene, r) / 1e3


def solar_flux(scene, t):
    if scene.environment.solar_flux != "cycle":
        return scene.environment.solar_flux
    year = 2000 + days_since_j2000(scene, t) / 365.25
    return 70 + 61.5 * (1 - np.cos(2 * np.pi * (year - 2019.96) / 11))


def gridded(latitude, hour, height, values):
    """Straight lines between the nodes, round the clock, held at the top and the bottom."""
    hour, values = [*hour, 24.0], np.concatenate([values, values[:, :1]], axis=1)
    inside = RegularGridInterpolator((latitude, hour, height), values)
    return lambda where: inside((where[0], where[1], min(max(where[2], height[0]), height[-1])))


@cache
def plasma_table():
    """ln of the density (1/m3) at three solar levels, then the mean ion masses (kg)."""
    with np.load(shipped_folder("assets") / "ionosphere_iri2020.npz") as file:
        levels = ("min2019", "mid2014", "max2001")
        values = [np.log(file[f"{name}_electron_density_m3"].astype(float)) for name in levels]
        values += [1.66053906660e-27 * file[f"{name}_mean_ion_mass_u"].astype(float) for name in levels]
        axes = file["latitude_deg"], file["local_time_h"], file["altitude_km"]
    return gridded(*axes, np.stack(values, axis=-1))


@cache
def air_table(levels, ap):
    """ln of the density (kg/m3) at solar levels, from NRLMSIS 2.1: what depends on longitude and UT off, an equinox and
    a solstice averaged, eight local times made 24 by their Fourier sum."""
    from pymsis import calculate

    off = {"all_ut_effects": 0, "longitudinal": 0, "mixed_ut_long": 0, "mixed_ap_ut_long": 0}
    latitude, height = np.linspace(-90, 90, 19), np.arange(100.0, 1500.1, 10)
    values = []
    for level in levels:
        means = 0.0
        for day in ("2019-03-21T12:00", "2019-06-21T12:00"):  # longitude -180 deg has midnight at noon UT
            drivers = {"f107s": [level], "f107as": [level], "aps": [[ap] * 7], "version": 2.1} | off
            means = means + calculate([day], np.arange(-180.0, 180, 45), latitude, height, **drivers)[0, ..., 0] / 2
        log, angle = np.log(means.astype(float)), np.radians(np.arange(0, 360, 45))
        fine, total = np.radians(np.arange(0, 360, 15)), log.mean(axis=0)[None]
        for k in range(1, 5):
            weight = 1 / 8 if k == 4 else 1 / 4
            total = total + np.tensordot(np.cos(k * (fine[:, None] - angle)), weight * log, 1)
        values.append(np.swapaxes(total, 0, 1))
    return gridded(latitude, np.arange(0.0, 24), height, np.stack(values, axis=-1))


def air_drag(scene):
    """(t, r, v, mass) -> acceleration; None without air."""
    air, craft = scene.environment.atmosphere, scene.device
    if air is None:
        return None
    if air.kind == "nrlmsis-2.1":
        flux = scene.environment.solar_flux
        levels = (70.0, 100.0, 145.0, 200.0) if flux == "cycle" else (flux,)
        table = air_table(levels, air.ap)

    def drag(t, r, v, mass):
        if air.kind == "exponential":
            density = air.density * np.exp(
                (air.reference_altitude - np.linalg.norm(r) + body(scene)[1]) / air.scale_height
            )
        else:
            density = np.exp(np.interp(solar_flux(scene, t), levels, table(place(scene, t, r))))
        u = v - np.cross(spin_of_earth(scene), r)
        return -0.5 * density * craft.drag_coefficient * craft.drag_area / mass * np.linalg.norm(u) * u

    return drag


def oblate(environment, r):
    """Pull of the zonal harmonics: gradient of -(mu / r) J_n (R / r)^n P_n(z / r)."""
    size = np.linalg.norm(r)
    s, up, a = r[2] / size, r / size, np.zeros(3)
    for n, j in ((2, J2 * environment.j2), (3, J3 * environment.j3), (4, J4 * environment.j4)):
        p = Legendre.basis(n)
        k = MU_EARTH * j * (RADIUS_EARTH / size) ** n / size**2
        a = a + k * ((n + 1) * p(s) * up - p.deriv()(s) * (np.array([0, 0, 1.0]) - s * up))
    return a


def thruster(scene):
    craft = scene.device

    def push(t, r, v, mass):
        a = craft.acceleration if craft.thrust is None else craft.thrust / mass
        rate = 0.0 if craft.specific_impulse is None else -mass * a / (9.80665 * craft.specific_impulse)  # (2.3)
        return a * normal(scene, t, r, v), rate

    return push


# ---------------------------------------------------------------- steering towards a primer, by brute force
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
    span = (0.0, scene.propagation.duration)
    return solve_ivp(rates, span, start, "DOP853", rtol=1e-13, atol=1e-15 * scale, dense_output=True).sol


def steepest(function, r, v):
    """Gradient over the velocity, by complex steps."""
    step = 1e-20j * np.linalg.norm(v)
    return np.array([function(r, v + step * axis).imag for axis in np.eye(3)]) / abs(step)


def local_primer(scene, t, r, v):
    if scene.steering.goal != "inclination":
        raise NotImplementedError(scene.steering.goal)

    def inclination(r, v):
        h = np.cross(r, v)
        return np.arctan(np.sqrt(h[0] ** 2 + h[1] ** 2) / h[2]) if abs(h[2]) > abs(h[0]) else np.arccos(h[2] / root(h))

    return (1 if scene.steering.sense == "increase" else -1) * steepest(inclination, r, v)


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


PRIMERS = {"optimal": optimal_primer, "locally-optimal": local_primer, "lyapunov": lyapunov_primer}
