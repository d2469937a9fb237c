"""Acceleration and mass rate of every device."""

from __future__ import annotations

import numpy as np
from independent.bodies import ageing_sail, is_body, wheel
from independent.constants import AU, EPSILON, MU_SUN
from independent.designed_orbits import designed
from independent.film import film_force, film_of
from independent.plasma_brake import brake
from independent.shapes import shaped_sail
from independent.sky import from_light, sunlight, wind_blows
from independent.steering import normal


def device(scene):
    """(t, r, v, mass) -> acceleration, mass rate; None without a device."""
    craft = scene.device
    if is_body(scene):
        return ageing_sail(scene) if craft.kind == "solar-sail" else wheel(scene)
    return {"solar-sail": solar_sail, "electric-sail": electric_sail, "plasma-brake": brake, "thruster": thruster}.get(
        craft.kind, lambda scene: None
    )(scene)


def solar_sail(scene):
    craft, film = scene.device, film_of(scene.device)
    if craft.shape is not None:
        return shaped_sail(scene)
    ac = craft.characteristic_acceleration
    if ac is not None:
        pass
    elif craft.lightness_number is not None:
        ac = film[3] * craft.lightness_number * MU_SUN / AU**2
    else:
        said = scene.light
        pressure = 4.563e-6 if said is None or said.pressure is None else said.pressure
        if said is not None and said.distance is not None and said.pressure is not None:
            pressure *= (said.distance / AU) ** 2
        ac = film[3] * 2 * pressure * craft.area / craft.mass * sum(film[:3])

    def push(t, r, v, mass):
        n, out = normal(scene, t, r, v), from_light(scene, t, r)
        size = np.linalg.norm(out)
        cosine = n @ out / size
        if cosine <= 0:
            return np.zeros(3), 0.0
        light, along = film_force(film, cosine)
        ac_now = designed(scene, t)[2] if ac == "as designed" else ac
        ac_now *= sunlight(scene, t, r)
        return ac_now * (AU / size) ** 2 * (light * out / size + along * n), 0.0

    return push


def electric_sail(scene):
    craft = scene.device
    ac = craft.characteristic_acceleration
    if ac is None:
        sigma = 0.18 * (craft.voltage - craft.wind_potential) * np.sqrt(EPSILON * craft.wind_pressure)  # (3.41)
        ac = craft.tethers * craft.tether_length * sigma / craft.mass

    def push(t, r, v, mass):
        n, out = normal(scene, t, r, v), from_light(scene, t, r)
        size = np.linalg.norm(out)
        r_hat = out / size
        if not n.any() or not wind_blows(scene, t, r):
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


def thruster(scene):
    craft = scene.device

    def push(t, r, v, mass):
        a = craft.acceleration if craft.thrust is None else craft.thrust / mass
        rate = 0.0 if craft.specific_impulse is None else -mass * a / (9.80665 * craft.specific_impulse)  # (2.3)
        return a * normal(scene, t, r, v), rate

    return push
