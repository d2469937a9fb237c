"""Forces of shapes whose front alone is lit: in closed form, or by a sum over few facets."""

from __future__ import annotations

import numpy as np
from independent.constants import AU
from independent.film import film_of
from independent.sky import from_light
from independent.steering import normal

PRESSURE = 4.563e-6  # N/m2


def shaped_sail(scene):
    """(t, r, v, mass) -> acceleration, mass rate."""
    craft = scene.device
    shapes = {"cap": cap, "square": square, "pyramid": pyramid, "file": shaded_square}
    force = shapes[craft.shape.kind](craft.shape, film_of(craft)[:3])

    def push(t, r, v, mass):
        n, out = normal(scene, t, r, v), from_light(scene, t, r)
        size = np.linalg.norm(out)
        across = np.cross(np.cross(r, v), r)
        x = across - (across @ n) * n
        x = x / np.linalg.norm(x)
        axes = np.stack([x, np.cross(n, x), n], 1)
        return 2 * PRESSURE / craft.mass * (AU / size) ** 2 * axes @ force(axes.T @ out / size), 0.0

    return push


def cap(shape, film):
    """Part of a sphere, its edge so steep, of which light to 90 deg less that slope meets the front alone."""
    b1, b2, b3 = film
    s, k, area = np.sin(shape.edge_slope), np.cos(shape.edge_slope), np.pi * shape.diameter**2 / 4

    def force(u):
        tilt = np.hypot(u[0], u[1])
        along = b2 * ((1 + k * k) / 2 * u[2] ** 2 + s * s / 4 * tilt**2) + b1 * u[2] ** 2
        along += b3 * (2 / 3) * (1 - k**3) / s**2 * u[2]
        aside = b2 * s * s / 2 * u[2] + b3 * (2 / 3 - k + k**3 / 3) / s**2 + b1 * u[2]
        return area * np.array([aside * u[0], aside * u[1], along])

    return force


def square(shape, film):
    """Four films between booms, each along its strips: by Gauss's rule of 60 points over a strip."""
    t, weight = np.polynomial.legendre.leggauss(60)
    slope = np.tan(shape.cone) + 2 * shape.sag * (1 + t * t)
    one = np.stack([-slope, 4 * shape.sag * t, np.ones(60)], 1) * (shape.side**2 / 8 * weight)[:, None]
    turn, films = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]), [one]
    for _ in range(3):
        films.append(films[-1] @ turn.T)
    return facets(np.concatenate(films), film)


def pyramid(shape, film):
    """Four triangles from the apex to the tips of the booms."""
    half = shape.opening / 2
    angles = np.array([half, np.pi - half, np.pi + half, -half])
    out, down = shape.boom * np.cos(shape.cone), shape.boom * np.sin(shape.cone)
    tips = np.stack([out * np.cos(angles), out * np.sin(angles), np.full(4, down)], 1)
    return facets(0.5 * np.cross(tips, np.roll(tips, -1, axis=0)), film)


def facets(areas, film):
    """Plane films by their area vectors (k, 3) away from the light."""
    b1, b2, b3 = film
    size = np.linalg.norm(areas, axis=1)
    m = areas / size[:, None]

    def force(u):
        c = m @ u
        assert np.all(c > 0)
        return (size * c) @ (b1 * u + (b2 * c + b3)[:, None] * m)

    return force


def shaded_square(shape, film):
    """scenes/body/square-sail.glb facing the light: 100 m2, of which a black box before it takes 1 m2."""
    assert shape.file == "square-sail.glb"

    def force(u):
        assert u[2] > 1 - 1e-12
        return np.array([0.0, 0.0, 99 * sum(film) + 0.5])

    return force
