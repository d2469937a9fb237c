"""The independent integration, with the voltage control that acts while it goes."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from independent.constants import MU_SUN, body
from independent.designed_orbits import third_body
from independent.devices import device
from independent.low_orbit import air_drag, oblate
from independent.primers import soft_edges
from independent.sky import bodies_pull, shown_area
from independent.steering import normal, table
from independent.thrust_history import schedule, smoothed
from scipy.integrate import solve_ivp

from sailviz.scene.environment import SteadyWind


def tabled(scene):
    """Whether forces have kinks or jumps that no step can be told of."""
    around = scene.environment
    tables = [
        getattr(part, "kind", "") in ("iri-2020", "nrlmsis-2.1") for part in (around.ionosphere, around.atmosphere)
    ]
    return any(tables) or getattr(scene.device, "eclipse", "on") != "on"


def integrate(scene, state, times):
    """Position (n, 3) at times, restarting wherever the thrust or a steering table has a kink."""
    breaks, factors = schedule(scene)
    voltage = controlled(scene, state, breaks[breaks < times[-1]])
    edges = [*breaks[breaks < times[-1]], times[-1]]
    acceleration, mu = device(scene), body(scene)[0]
    longest = 30.0 if tabled(scene) else np.inf
    rows = [state[None, :3]]
    scale = np.linalg.norm(state[:3])
    atol = 1e-16 * np.array([scale] * 3 + [np.sqrt(mu / scale)] * 3 + [max(state[6], 1.0)])
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


def devices_beside(scene):
    """(t, r, v, mass) -> acceleration, mass rate of each device beside the first one."""
    steady = scene.environment.solar_wind.kind == "steady" and scene.environment.irradiance.kind == "steady"
    if scene.beside and (not steady or any(one.active is not None for one in scene.devices)):
        raise NotImplementedError("times of thrust of several devices")
    return [device(scene.alone(one)) for one in scene.beside]


def right_hand_side(scene, acceleration, factor, latest):
    mu, around = body(scene)[0], scene.environment
    drag, others = air_drag(scene), devices_beside(scene)
    smooth = smoothed(scene) if getattr(scene.steering, "kind", "") == "smoothed-transfer" else None

    def rhs(t, y):
        r, v, mass = y[:3], y[3:6], y[6]
        size = np.sqrt(r @ r)
        a = -mu * r / size**3
        if around.j2:
            a = a + oblate(around, r)
        if drag is not None:
            fixed = scene.device.drag_area
            area = shown_area(scene, r, v, normal(scene, t, r, v)) if fixed == "attitude" else fixed
            a = a + drag(t, r, v, mass, area)
        rate = 0.0
        a = a + third_body(scene, t, r) + bodies_pull(scene, t, r)
        if factor and acceleration is not None:
            throttle = getattr(scene.steering, "throttle", None)
            share = factor * (table(scene.steering, throttle, min(t, latest)) if throttle else 1.0)
            if smooth is not None:
                share *= smooth[2][np.searchsorted(smooth[0], min(t, latest), side="right") - 1]
            share *= soft_edges(scene, min(t, latest), r, v)
            push, rate = acceleration(min(t, latest), r, v, mass)
            a, rate = a + share * push, share * rate
        for other in others:
            push, flow = other(min(t, latest), r, v, mass)
            a, rate = a + push, rate + flow
        return np.concatenate([v, a, [rate]])

    return rhs
