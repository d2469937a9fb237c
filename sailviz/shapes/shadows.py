"""Which facets of a shape are in the shadow of others: rays from the facets towards the Sun.

Rays are cast by embreex where it is installed, else by trimesh itself, which needs rtree and is some two hundred times
slower. With neither, a shape whose parts may shade each other cannot be told; what casts no shadow needs no rays.
"""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from typing import Any

import numpy as np

from sailviz.shapes.facets import Elements, Shape
from sailviz.shapes.primitives import Trimesh

OFF = 1e-5  # of the size of the shape, how far from its facet a ray begins: rays of embree are of single precision
SLOW_LIMIT = 2000  # facets beyond which rays without embree would take hours
EDGE_ON = 1e-9  # component of a facet's normal along the light below which no light meets it


class NoRaysError(ValueError):
    """Nothing that casts rays is installed, or it would take hours."""


def ray_caster() -> str:
    """ "embreex", "rtree", or "" where neither is installed."""
    return next((name for name in ("embreex", "rtree") if find_spec(name) is not None), "")


def may_shade(shape: Shape) -> bool:
    """Whether some facet might shade another: not in one flat part, nor in one closed body that is convex."""
    if len(shape.parts) > 1:
        return True
    part = shape.parts[0]
    return not (part.is_flat or (not part.is_film and is_convex(part.mesh)))


def is_convex(mesh: Trimesh) -> bool:
    """Whether no corner lies in front of a facet's plane; of many facets that is not asked."""
    if len(mesh.faces) > SLOW_LIMIT:
        return False
    size = float(np.ptp(mesh.vertices, axis=0).max())
    for triangle, normal in zip(mesh.triangles, mesh.face_normals, strict=True):
        if np.max((mesh.vertices - triangle[0]) @ normal) > 1e-9 * size:
            return False
    return True


def why_no_rays(shape: Shape) -> str:
    """Why the shadows of a shape cannot be told, in a sentence; "" if they can, or if there are none."""
    if not may_shade(shape):
        return ""
    caster, facets = ray_caster(), len(shape.elements)
    if not caster:
        return (
            "its parts may shade each other, and nothing that casts rays is installed: "
            "pip install 'sailviz[shapes]', or fly it without shadows"
        )
    if caster == "rtree" and facets > SLOW_LIMIT:
        return (
            f"it has {facets} facets, and without embreex, which has no wheel for this machine, rays through more than "
            f"{SLOW_LIMIT} take hours: fewer facets, or no shadows"
        )
    return ""


@cache
def points_in(samples: int) -> np.ndarray:
    """Barycentric coordinates of the middles of the samples^2 equal triangles into which a triangle can be cut."""
    s, found = samples, []
    for i in range(s):
        for j in range(s - i):
            found.append((3 * i + 1, 3 * j + 1))
            if j < s - i - 1:
                found.append((3 * i + 2, 3 * j + 2))
    a, b = np.array(found).T / (3 * s)
    return np.stack([a, b, 1 - a - b], axis=1)


class Shadows:
    """The shadows of one shape. samples : rays along each side of a facet, samples^2 in all, for shares of it."""

    def __init__(self, shape: Shape, samples: int = 1):
        why_not = why_no_rays(shape)
        if why_not:
            raise NoRaysError(why_not)
        self.backend = ray_caster() if may_shade(shape) else "none"
        self._elements: Elements = shape.elements
        self._meets_back = np.repeat([part.is_film for part in shape.parts], [len(p.elements) for p in shape.parts])
        self._off = OFF * shape.size
        self._caster = _caster(shape.mesh, self.backend)
        weights = points_in(samples)
        self._points = (
            np.einsum("sv,kvi->ski", weights, shape.mesh.triangles) if samples > 1 else shape.elements.centre[None]
        )

    def visible(self, u: np.ndarray, turned_away: float = 0.0) -> np.ndarray:
        """Share of each facet that light from one direction reaches, (n, k). turned_away : what is said of a facet that
        stands edge-on, or would be met on the back of a closed body. u (n, 3)."""
        d = u @ self._elements.normal.T
        met = (np.abs(d) > EDGE_ON) & ((d < 0) | self._meets_back)
        found = np.where(met, 1.0, turned_away)
        if self._caster is None:
            return np.asarray(found)
        which, facet = np.nonzero(met)
        found[which, facet] = self._share(u[which], facet, d[which, facet])
        return np.asarray(found)

    def reached(self, u: np.ndarray, facet: np.ndarray) -> np.ndarray:
        """Share (n,) that light along each of u (n, 3) reaches of one facet, by its number, (n,)."""
        d = np.sum(u * self._elements.normal[facet], axis=1)
        met = (np.abs(d) > EDGE_ON) & ((d < 0) | self._meets_back[facet])
        found = np.where(met, 1.0, 0.0)
        if self._caster is not None and met.any():
            found[met] = self._share(u[met], facet[met], d[met])
        return np.asarray(found)

    def _share(self, u: np.ndarray, facet: np.ndarray, d: np.ndarray) -> np.ndarray:
        """Share (m,) of facets (m,) that no other hides from light along u (m, 3); d (m,) : components of their normals
        along it."""
        lift = self._elements.normal[facet] * (-np.sign(d) * self._off)[:, None]
        hits = np.zeros(len(facet))
        for points in self._points:
            hits += self._caster.intersects_any(points[facet] + lift, -u)
        return np.asarray(1.0 - hits / len(self._points))


def _caster(mesh: Trimesh, backend: str) -> Any:
    """What answers `intersects_any(origins, directions)`; None where there is nothing to hit."""
    if backend == "none":
        return None
    if backend == "embreex":
        from trimesh.ray.ray_pyembree import RayMeshIntersector

        return RayMeshIntersector(mesh)
    from trimesh.ray.ray_triangle import RayMeshIntersector as InPython

    return InPython(mesh)
