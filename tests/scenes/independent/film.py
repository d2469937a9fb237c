"""The force of a film and of an electric sail over the angle to the Sun line."""

from __future__ import annotations

import numpy as np
from independent.constants import FILMS


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
