"""Sails whose seventh number of the state is no mass: films that age carry their dose, wheels that spin their drift."""

from __future__ import annotations

import numpy as np
from independent.constants import AU, EPSILON
from independent.film import film_force, film_of
from independent.shapes import PRESSURE, cap
from independent.steering import normal

TABLE_3_1 = {  # cr, cs, Bf, Bb, ef, eb
    "jpl-1978": (0.88, 0.94, 0.79, 0.55, 0.05, 0.55),
    "jpl-2015": (0.91, 0.94, 0.79, 0.67, 0.025, 0.27),
}
RING = np.linspace(0, 2 * np.pi, 12, endpoint=False)  # tethers, as many as make the second harmonics vanish


class Optics:
    """As a scene gives them."""

    def __init__(self, *values):
        self.cr, self.cs, self.Bf, self.Bb, self.ef, self.eb = values


def is_body(scene):
    """Whether the seventh number is none of the mass."""
    wheel = getattr(scene.device, "wheel", None)
    return getattr(scene.device, "ageing", None) is not None or wheel is not None


def seventh(scene):
    """The last number of the state at the start."""
    if not is_body(scene):
        return scene.device.mass or 1.0
    age = getattr(scene.device, "ageing", None)
    return 0.0 if age is None else age.dose


def ageing_sail(scene):
    """(t, r, v, dose s) -> acceleration, rate of the dose."""
    craft, age = scene.device, scene.device.ageing
    fresh = Optics(*TABLE_3_1[craft.film]) if isinstance(craft.film, str) else craft.film
    craft_of = type("Craft", (), {})

    def film(dose):
        gone = 1 - 2.0 ** (-dose / age.half_dose)
        mirror, front = (1 + age.factor * (1 - gone)) / (1 + age.factor), 1 + age.factor * gone
        one = craft_of()
        one.film = Optics(fresh.cr * mirror, fresh.cs * mirror, fresh.Bf, fresh.Bb, fresh.ef * front, fresh.eb)
        return film_of(one)

    if craft.shape is not None:
        return _ageing_cap(scene, film)
    first = sum(film(0.0)[:3])

    def push(t, r, v, dose):
        n, size = normal(scene, t, r, v), np.linalg.norm(r)
        cosine, near = n @ r / size, (AU / size) ** 2
        if cosine <= 0:
            return np.zeros(3), 0.0
        aged = film(dose)
        light, along = film_force(aged, cosine)
        share = craft.characteristic_acceleration * sum(aged[:3]) / first
        return share * near * (light * r / size + along * n), near * cosine

    return push


def _ageing_cap(scene, film):
    """The same of part of a sphere whose front alone is lit: its film is 2 / (1 + cos) times as large as its mouth."""
    shape, mass = scene.device.shape, scene.device.mass
    assert shape.kind == "cap"
    shown = (1 + np.cos(shape.edge_slope)) / 2

    def push(t, r, v, dose):
        n, size = normal(scene, t, r, v), np.linalg.norm(r)
        x = np.cross(np.cross(r, v), r)
        x = x - (x @ n) * n
        x = x / np.linalg.norm(x)
        axes, near = np.stack([x, np.cross(n, x), n], 1), (AU / size) ** 2
        u = axes.T @ r / size
        force = 2 * PRESSURE * near * axes @ cap(shape, film(dose)[:3])(u)
        return force / mass, near * shown * u[2]

    return push


def wheel(scene):
    """(t, r, v, drift) -> acceleration, rate of the drift: forces and torques summed over straight tethers."""
    craft, bent = scene.device, scene.device.wheel
    sigma = 0.18 * (craft.voltage - craft.wind_potential) * np.sqrt(EPSILON * craft.wind_pressure)  # (3.41)
    length, count = craft.tether_length, craft.tethers
    inertia = count * (bent.tip_mass + bent.tether_mass / 3) * length**2
    start = 2 * np.pi / bent.spin_period if bent.spin_period else 0.0

    def push(t, r, v, drift):
        size = np.linalg.norm(r)
        n, u = normal(scene, t, r, v), r / size
        turn = np.cross(np.cross(r, v) / size**2, n)
        one = np.cross(n, [0.3, 0.5, 0.8])
        one /= np.linalg.norm(one)
        out = np.cos(RING)[:, None] * one + np.sin(RING)[:, None] * np.cross(n, one)
        way = np.cos(bent.cone) * out + np.sin(bent.cone) * n
        force = sigma * AU / size * length * count / len(RING) * (u - (way @ u)[:, None] * way)
        torque = np.cross(way * length / 2, force)
        share = np.zeros(2)
        if bent.hold:
            sides = np.stack([one, np.cross(n, one)])
            wanted = sides @ (inertia * start * np.exp(drift) * turn - torque.sum(axis=0))
            swings = sides @ np.stack([np.cos(RING) @ torque, np.sin(RING) @ torque], 1)
            share = np.linalg.solve(swings, wanted)
        weights = (1 + share[0] * np.cos(RING) + share[1] * np.sin(RING)) / (1 + np.hypot(*share))
        rate = -(u @ turn) / (u @ n) if start else 0.0
        return weights @ force / craft.mass, rate

    return push
