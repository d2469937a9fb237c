"""How hot the hottest facet of a shape's films is, by how squarely light meets it (`shapes.facing`).

Numbers: a head; then of each film what it takes up and radiates, its distinct normals (front, in body axes) and, where
shadows count, what they leave of the largest cosine on the nodes of a cube, front and back in turn.

    T^4 = W (r_E / r)^2 max of c (1 - cr) / (sigma (ef + eb))

over the facets of all films that are lit: each facet has a balance of its own, no heat is kept, none flows along the
film, and none comes from other parts. Closed bodies are no films and have no temperature here.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sailviz.compiled import called, inlined
from sailviz.propulsion.film_ageing import Optics, worn
from sailviz.propulsion.shaped_sail import cell_of, face_of

COS, SIN, CELLS, FILMS, HEAD = 0, 1, 2, 3, 4  # of the roll; cells along a side of the cube; films
CR, BACK, EF, EB, AGES, COUNT, SHADED, FILM = 0, 1, 2, 3, 4, 5, 6, 7


class HeatedFilm(NamedTuple):
    """A film of a shape. back : reflectivity of its back, negative where that is not known; ages : whether its front
    does; normals (k, 3); shares (6, n + 1, n + 1, 2) that shadows leave, None of none."""

    optics: Optics
    back: float
    ages: bool
    normals: np.ndarray
    shares: np.ndarray | None


def heat_numbers(films: Sequence[HeatedFilm], roll: float) -> np.ndarray:
    """The numbers of films; roll : rad of the shape about its normal, where a steering gives that."""
    cells = max((one.shares.shape[1] - 1 for one in films if one.shares is not None), default=0)
    found: list[np.ndarray] = [np.array([np.cos(roll), np.sin(roll), cells, len(films)])]
    for one in films:
        optics, shaded = one.optics, one.shares is not None
        head = [optics.cr, one.back, optics.ef, optics.eb, one.ages, len(one.normals), shaded]
        found += [np.array(head, float), one.normals.ravel()]
        if one.shares is not None:
            found.append(one.shares.ravel())
    return np.concatenate(found)


@inlined
def left_by_shadows(x, y, z, side, a, at, n):
    """Share of the largest cosine on the front, 0, or the back, 1, for light along (x, y, z); at : where the nodes
    begin."""
    face, p, q = face_of(x, y, z)
    i, s = cell_of(p, 0.5 * n, n)
    j, t = cell_of(q, 0.5 * n, n)
    b = at + 2 * ((face * (n + 1) + i) * (n + 1) + j) + side
    d = b + 2 * (n + 1)
    return (1.0 - s) * ((1.0 - t) * a[b] + t * a[b + 2]) + s * ((1.0 - t) * a[d] + t * a[d + 2])


@called
def warmest(x, y, z, dose, film, a, at):
    """Largest c (1 - cr) / (ef + eb) of the lit facets for light along (x, y, z) in body axes; negative where it falls
    on a back that is not known. film : Numbers of `film_ageing`, whose factor and rate hold for all that ages, at a
    dose, s; a : an array in which the numbers begin at place `at`."""
    most, place, n = 0.0, at + HEAD, int(a[at + CELLS])
    for _ in range(int(a[at + FILMS])):
        count, low, high = int(a[place + COUNT]), 0.0, 0.0
        for i in range(count):
            k = place + FILM + 3 * i
            d = a[k] * x + a[k + 1] * y + a[k + 2] * z
            low, high = min(low, d), max(high, d)
        front, back = -low, high
        nodes = place + FILM + 3 * count
        if a[place + SHADED] != 0.0:
            front = front * left_by_shadows(x, y, z, 0, a, nodes, n)
            back = back * left_by_shadows(x, y, z, 1, a, nodes, n)
        kept, gained = worn(dose, film.factor * a[place + AGES], film.rate)
        radiates = gained * a[place + EF] + a[place + EB]
        if back > 0.0 and a[place + BACK] < 0.0:
            return -1.0
        most = max(most, front * (1.0 - kept * a[place + CR]) / radiates, back * (1.0 - a[place + BACK]) / radiates)
        place = nodes + (12 * (n + 1) * (n + 1) if a[place + SHADED] != 0.0 else 0)
    return most
