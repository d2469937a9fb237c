"""Force and torque of light, or of air, on a shape: a sum over its facets, and tensors that say the same where no
facet is shaded and each film is lit from one side.

Of a facet with normal m away from the Sun, c = m . u > 0, and the coefficients of its lit side, thesis (3.17)-(3.23):

    f = 2 P A v c [b1 u + (b2 c + b3) m]          torque = C x f about the origin of the body axes

Here everything stands over 2 P, P the radiation pressure: forces in m2, torques in m3. Neglected: light that one part
throws on another, the size of the Sun's disc, wrinkles.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sailviz.shapes.facets import Elements, Part, Shape


class Law(Protocol):
    """How a facet is pushed. all_round : whether also where it is turned away from the flow."""

    @property
    def all_round(self) -> bool: ...

    def tractions(self, d: np.ndarray, front: np.ndarray, back: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(along the flow, along the front normal), (n, k) each, per area and 2 P, of facets whose front normals have
        the components d (n, k) along the flow. front, back (k, 3): b1, b2, b3 of either side, zero where a side cannot
        be met."""
        ...


@dataclass(frozen=True)
class Light:
    """Sunlight; and air in the hyperthermal limit, whose law is the same."""

    all_round = False

    def tractions(self, d: np.ndarray, front: np.ndarray, back: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """As `Law` says it."""
        lit, c = d < 0, np.abs(d)
        b1, b2, b3 = (np.where(lit, front[:, i], back[:, i]) for i in range(3))
        pressed = c * (b2 * c + b3)
        return b1 * c, np.where(lit, -pressed, pressed)


LIGHT = Light()


def sides_of(parts: list[Part] | tuple[Part, ...], counts: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """(front, back) (k, 3): b1, b2, b3 of every element of these parts, of which each has so many."""
    front = [part.surface.front for part in parts]
    back = [part.surface.back or (0.0, 0.0, 0.0) for part in parts]
    return np.repeat(np.array(front, float), counts, axis=0), np.repeat(np.array(back, float), counts, axis=0)


def pushed(
    elements: Elements,
    front: np.ndarray,
    back: np.ndarray,
    u: np.ndarray,
    visible: np.ndarray | None = None,
    law: Law = LIGHT,
) -> tuple[np.ndarray, np.ndarray]:
    """(force (n, 3) m2, torque (n, 3) m3 about the origin) over 2 P. u (n, 3): unit vectors along the flow, visible
    (n, k): share of each facet that it reaches, all without."""
    d = u @ elements.normal.T
    along, pressed = law.tractions(d, front, back)
    area = elements.area if visible is None else elements.area * visible
    along, pressed = along * area, pressed * area
    r, normal = elements.centre, elements.normal
    force = along.sum(axis=1)[:, None] * u + pressed @ normal
    torque = np.cross(along @ r, u) + pressed @ np.cross(r, normal)
    return force, torque


def force_and_torque(
    shape: Shape, u: np.ndarray, visible: np.ndarray | None = None, law: Law = LIGHT
) -> tuple[np.ndarray, np.ndarray]:
    """The sum over the facets of a shape, as `pushed`. u (n, 3)."""
    front, back = sides_of(shape.parts, [len(part.elements) for part in shape.parts])
    return pushed(shape.elements, front, back, np.atleast_2d(u), visible, law)


def pressure(shape: Shape, u: np.ndarray, visible: np.ndarray | None = None) -> np.ndarray:
    """Pressure of light along the normal over 2 P on every facet, (k,), for one direction u (3,). visible (k,)."""
    front, back = sides_of(shape.parts, [len(part.elements) for part in shape.parts])
    d = (u @ shape.elements.normal.T)[None]
    along, pressed = LIGHT.tractions(d, front, back)
    found = (along * np.abs(d) + np.abs(pressed))[0]
    return np.asarray(found if visible is None else found * visible)


@dataclass(frozen=True)
class Tensors:
    """What films lit from one side feel, polynomials in u: 55 numbers. After the generalised sail model of Rios-Reyes
    and Scheeres, whose name it has; integrals derived here.

        F / 2 P = J2 : u u + J1 u + u (j0 . u)          torque / 2 P = K2 : u u + K1 u + (L u) x u
    """

    j0: np.ndarray  # (3,)
    J1: np.ndarray  # (3, 3) symmetric
    J2: np.ndarray  # (3, 3, 3) symmetric
    L: np.ndarray  # (3, 3)
    K1: np.ndarray  # (3, 3)
    K2: np.ndarray  # (3, 3, 3) symmetric in its last two

    def force(self, u: np.ndarray) -> np.ndarray:
        """(n, 3) m2 for u (n, 3)."""
        found = np.einsum("ijk,nj,nk->ni", self.J2, u, u) + u @ self.J1.T + u * (u @ self.j0)[:, None]
        return np.asarray(found)

    def torque(self, u: np.ndarray) -> np.ndarray:
        """(n, 3) m3 about the origin for u (n, 3)."""
        found = np.einsum("ijk,nj,nk->ni", self.K2, u, u) + u @ self.K1.T + np.cross(u @ self.L.T, u)
        return np.asarray(found)

    def numbers(self) -> np.ndarray:
        """The 55 numbers: j0 3, J1 6, J2 10, L 9, K1 9, K2 18; of symmetric ones xx xy xz yy yz zz, and likewise."""
        two = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]
        three = [(i, j, k) for i in range(3) for j in range(i, 3) for k in range(j, 3)]
        found: list[float] = [*self.j0, *(self.J1[i] for i in two), *(self.J2[i] for i in three)]
        found += [*self.L.ravel(), *self.K1.ravel(), *(self.K2[i][j] for i in range(3) for j in two)]
        return np.array(found)


def tensors(shape: Shape, side: str, smooth: bool = True) -> Tensors:
    """Tensors of a shape's films, lit from the "front" or the "back". smooth : of the curved surfaces that the facets
    stand for, where they are known."""
    films = shape.films
    found = [part.smooth if smooth and part.smooth is not None else part.elements for part in films]
    if not found:
        zero = np.zeros((3, 3))
        return Tensors(np.zeros(3), zero, np.zeros((3, 3, 3)), zero, zero, np.zeros((3, 3, 3)))
    b = sides_of(films, [len(each) for each in found])[0 if side == "front" else 1]
    r = np.concatenate([each.centre for each in found])
    m = np.concatenate([each.normal for each in found]) * (-1.0 if side == "front" else 1.0)
    b1, b2, b3 = (b * np.concatenate([each.area for each in found])[:, None]).T
    turn = np.cross(r, m)
    return Tensors(
        b1 @ m,
        np.einsum("k,ki,kj->ij", b3, m, m),
        np.einsum("k,ki,kj,kl->ijl", b2, m, m, m),
        np.einsum("k,ki,kj->ij", b1, r, m),
        np.einsum("k,ki,kj->ij", b3, turn, m),
        np.einsum("k,ki,kj,kl->ijl", b2, turn, m, m),
    )
