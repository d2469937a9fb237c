"""How squarely light meets the facets of a shape's films: what makes the hottest facet of each.

A thin film in balance is the hotter the squarer light meets it, so that of each film two numbers count for every
direction u of the light: the largest c of its facets that are lit from the front, and of those lit from the back,
c = |N . u|. Without shadows they are the extremes of N . u over the film's normals, and are taken as such, exactly; of
a billowed film the normals are those of its quadrature, which has points beside its edge where a facet has none.
Shadows are asked of rays, one from the middle of each facet: what they leave of these extremes, a share from 0 to 1
and 1 wherever the squarest facet is lit, stands on the nodes of a cube and is read bilinearly between them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from sailviz.shapes.facets import Shape
from sailviz.shapes.light_table import batches, directions, distinct
from sailviz.shapes.shadows import Shadows

DIGITS = 12  # of a normal's components, to which two are the same


def normals_of(shape: Shape, parts: Sequence[int]) -> np.ndarray:
    """Distinct normals (k, 3) out of the fronts of some parts, by their numbers: of the points of a quadrature over the
    true surface where that is known, else of the facets."""
    films = [shape.parts[part] for part in parts]
    found = np.concatenate([(part.smooth or part.elements).normal for part in films])
    return np.unique(np.round(found, DIGITS) + 0.0, axis=0)


def squarest(
    shape: Shape, films: Sequence[Sequence[int]], u: np.ndarray, shadows: Shadows | None
) -> tuple[np.ndarray, np.ndarray]:
    """(largest c, the same of facets that light reaches), each (n, films, 2): lit from the front, from the back.
    films : the parts of each film, by their numbers; u (n, 3) along the light."""
    d = u @ shape.elements.normal.T
    bare = np.zeros((len(u), len(films), 2))
    lit = np.zeros_like(bare)
    each = np.arange(len(u))
    for film, parts in enumerate(films):
        facets = np.flatnonzero(np.isin(shape.part_of, parts))
        for side, sign in enumerate((-1.0, 1.0)):
            c = np.maximum(sign * d[:, facets], 0.0)
            first = np.argmax(c, axis=1)
            bare[:, film, side] = lit[:, film, side] = c[each, first]
            if shadows is None:
                continue
            dark = (c[each, first] > 0) & (shadows.reached(u, facets[first]) == 0)
            if dark.any():
                seen = shadows.visible(u[dark])[:, facets] > 0
                lit[dark, film, side] = np.max(np.where(seen, c[dark], 0.0), axis=1)
    return bare, lit


def shares(
    shape: Shape, films: Sequence[Sequence[int]], cells: int, progress: Callable[[float], None] | None = None
) -> np.ndarray:
    """What shadows leave of the largest c, (films, 6, cells + 1, cells + 1, 2) on the nodes of `light_table`: 1 where
    nothing is lit from that side. NoRaysError where they cannot be told."""
    shadows, nodes = Shadows(shape), directions(cells)
    u, again = distinct(nodes.reshape(-1, 3))
    found = np.empty((len(u), len(films), 2))
    for batch in batches(len(u), len(shape.elements)):
        bare, lit = squarest(shape, films, u[batch], shadows)
        found[batch] = np.where(bare > 0, lit / np.where(bare > 0, bare, 1.0), 1.0)
        if progress is not None:
            progress(min(1.0, batch.stop / len(u)))
    return np.moveaxis(found[again].reshape(*nodes.shape[:3], len(films), 2), 3, 0)
