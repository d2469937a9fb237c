"""Films of given kinds in m, fronts along -z where they face the Sun: facets to draw and to shade, and the points of a
quadrature over the true surface, so that what the tensors say of a curved film is exact.

The parametrisations are our own; coefficients of billowed films in the literature were not found.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sailviz.shapes.facets import Elements, Part, Surface
from sailviz.shapes.primitives import Trimesh, inverted, joined, sheet

POINTS = 60  # of Gauss' quadrature along a line
AROUND = 64  # points of the rule of equal steps round a circle


def gauss(low: float, high: float, points: int = POINTS) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights of Gauss and Legendre between two numbers."""
    x, w = np.polynomial.legendre.leggauss(points)
    half = (high - low) / 2
    return low + half * (x + 1), half * w


def fronts_sunwards(mesh: Trimesh) -> Trimesh:
    """The mesh with its fronts towards -z on the whole."""
    across = np.cross(mesh.triangles[:, 1] - mesh.triangles[:, 0], mesh.triangles[:, 2] - mesh.triangles[:, 0])
    return inverted(mesh) if across[:, 2].sum() > 0 else mesh


def turned_about_z(vectors: np.ndarray, angle: float) -> np.ndarray:
    """Vectors (..., 3) turned by an angle, rad."""
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(vectors @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]))


def without_slivers(mesh: Trimesh) -> Trimesh:
    """The mesh without facets that have no area, as at a point where a grid comes together."""
    mesh.update_faces(mesh.area_faces > 1e-12 * mesh.area_faces.max())
    return mesh


def quarters(points: np.ndarray, elements: Elements) -> tuple[Trimesh, Elements]:
    """Four times a quadrant about +x, of a grid of points (m, k, 3) and of elements."""
    turns = [quarter * np.pi / 2 for quarter in range(4)]
    mesh = fronts_sunwards(joined([without_slivers(sheet(turned_about_z(points, angle))) for angle in turns]))
    return mesh, Elements(
        np.concatenate([turned_about_z(elements.centre, angle) for angle in turns]),
        np.concatenate([turned_about_z(elements.normal, angle) for angle in turns]),
        np.tile(elements.area, 4),
    )


def square(side: float, surface: Surface, cone: float = 0.0, sag: float = 0.0, rows: int = 10) -> Part:
    """A square sail of four quadrants between diagonal booms, sides along x and y, the hub at the origin.

    cone : rad, by which the booms bend downwind; sag : depth of a strip between two booms over its chord. On the
    quadrant about +x, y = t x, |t| <= 1: z = x [tan(cone) + 2 sag (1 - t^2)]. The booms stay straight.
    """
    rise = np.tan(cone)

    def points(x: np.ndarray, t: np.ndarray) -> np.ndarray:
        return np.stack([x, x * t, x * (rise + 2 * sag * (1 - t * t))], axis=-1)

    t, weight = gauss(-1, 1)
    m = np.stack([-(rise + 2 * sag * (1 + t * t)), 4 * sag * t, np.ones_like(t)], axis=-1)
    w = np.linalg.norm(m, axis=1)
    elements = Elements(points(np.full_like(t, side / 3), t), -m / w[:, None], side**2 / 8 * weight * w)
    grid = points(*np.meshgrid(side / 2 * np.linspace(0, 1, rows + 1), np.linspace(-1, 1, 2 * rows + 1), indexing="ij"))
    mesh, smooth = quarters(grid, elements)
    return Part("film", mesh, surface, smooth)


def cap(diameter: float, surface: Surface, slope: float = 0.0, rows: int = 10) -> Part:
    """Part of a sphere over a circular mouth, its middle blown downwind. slope : of the edge, rad. The origin is the
    middle of the mouth, the sphere's centre on the Sun's side of it; slope 0 is a disc."""
    return _round("film", diameter, 0.0, surface, slope, rows)


def disc(diameter: float, surface: Surface, rows: int = 10) -> Part:
    """A flat round sail."""
    return _round("film", diameter, 0.0, surface, 0.0, rows)


def ring(diameter: float, inner_diameter: float, surface: Surface, rows: int = 10) -> Part:
    """A flat ring."""
    return _round("film", diameter, inner_diameter, surface, 0.0, rows)


def _round(name: str, diameter: float, inner: float, surface: Surface, slope: float, rows: int) -> Part:
    mouth = diameter / 2
    place: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    if slope == 0.0:
        low, high = inner / 2, mouth

        def place(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            return s, np.zeros_like(s)
    else:
        low, high = 0.0, slope
        radius, depth = mouth / np.sin(slope), mouth / np.tan(slope)

        def place(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            return radius * np.sin(s), radius * np.cos(s) - depth

    s, weight = gauss(low, high)
    around = np.arange(AROUND) * (2 * np.pi / AROUND)
    reach, height = place(s)
    east, north = np.cos(around), np.sin(around)
    centre = np.stack(
        [np.outer(reach, east), np.outer(reach, north), np.broadcast_to(height[:, None], (len(s), AROUND))], axis=-1
    )
    tilt = s if slope else np.zeros_like(s)
    normal = -np.stack(
        [
            np.outer(np.sin(tilt), east),
            np.outer(np.sin(tilt), north),
            np.broadcast_to(np.cos(tilt)[:, None], (len(s), AROUND)),
        ],
        axis=-1,
    )
    along = reach * weight * (radius if slope else 1.0)
    area = np.repeat(along * (2 * np.pi / AROUND), AROUND)
    edge = np.linspace(0, 2 * np.pi, 4 * rows + 1)
    out, up = place(np.linspace(low, high, rows + 1))
    grid = np.stack(
        [np.outer(out, np.cos(edge)), np.outer(out, np.sin(edge)), np.repeat(up[:, None], len(edge), axis=1)], axis=-1
    )
    mesh = fronts_sunwards(without_slivers(sheet(grid)))
    return Part(name, mesh, surface, Elements(centre.reshape(-1, 3), normal.reshape(-1, 3), area))


def heliogyro(
    blades: int, length: float, chord: float, surface: Surface, pitch: float = 0.0, twist: float = 0.0, rows: int = 50
) -> Part:
    """Blades from the hub outwards, the first along +x, each pitched about its own axis by pitch + twist x / length,
    rad, so that light from -z pushes it round towards its left hand as seen from -z.

    The quadrature takes strips of the local pitch, as the field's closed forms do; what the twist adds to a strip's
    slope, (chord twist / 2 length)^2, some 1e-6, is in the facets alone.
    """
    x, weight = gauss(0.0, length)
    zero = np.zeros_like(x)

    def frame(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        angle = pitch + twist * s / length
        none = np.zeros_like(s)
        across = np.stack([none, np.cos(angle), -np.sin(angle)], axis=-1)
        return across, np.stack([none, np.sin(angle), np.cos(angle)], axis=-1)

    away = frame(x)[1]
    one = Elements(np.stack([x, zero, zero], axis=-1), -away, chord * weight)
    s = np.linspace(0.0, length, rows + 1)
    spine, across = np.stack([s, 0 * s, 0 * s], axis=-1), frame(s)[0]
    grid = np.stack([spine - across * chord / 2, spine + across * chord / 2], axis=1)
    turns = 2 * np.pi / blades * np.arange(blades)
    mesh = fronts_sunwards(joined([sheet(turned_about_z(grid, angle)) for angle in turns]))
    elements = Elements(
        np.concatenate([turned_about_z(one.centre, angle) for angle in turns]),
        np.concatenate([turned_about_z(one.normal, angle) for angle in turns]),
        np.tile(one.area, blades),
    )
    return Part("film", mesh, surface, elements)


def pyramid(boom: float, surface: Surface, cone: float, opening: float = np.pi / 2, rows: int = 10) -> Part:
    """A quasi-rhombic pyramid, its apex, the origin, towards the Sun: four plane films between booms that bend
    downwind by `cone`, rad, and stand at half the opening, rad, to both sides of +x and of -x; a quarter turn makes it
    square."""
    bearings = np.array([-opening / 2, opening / 2, np.pi - opening / 2, np.pi + opening / 2])
    tips = boom * np.stack([np.cos(cone) * np.cos(bearings), np.cos(cone) * np.sin(bearings), 0 * bearings], axis=-1)
    tips[:, 2] = boom * np.sin(cone)
    out = np.linspace(0, 1, rows + 1)
    along = np.linspace(0, 1, rows + 1)
    sheets = []
    for first, second in zip(tips, np.roll(tips, -1, axis=0), strict=True):
        edge = first + along[:, None] * (second - first)
        sheets.append(without_slivers(sheet(out[:, None, None] * edge[None])))
    return Part("film", fronts_sunwards(joined(sheets)), surface)
