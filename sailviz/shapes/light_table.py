"""Force and torque of a shape for light from every direction: tensors, and a table of what they leave.

    F(u) = S_f(c) T_front(u) + S_b(-c) T_back(u) + table(u),     c = u_z

S rises from 0 at c = 0 to 1 at c = w as x^3 (10 - 15 x + 6 x^2), a step for a flat film, whose force vanishes there.
The table stands on the six faces of a cube, each with n x n cells even in the gnomonic coordinates: no trigonometry,
and, n being even, the terminator of a flat film runs along lines of the grid. Between them it is read bilinearly or, as
an option, bicubically. A bare sail inside its cone is exact: the tensors have it all.

Everything over 2 P: forces m2, torques m3 about the origin. The numbers are those that
`propulsion.shaped_sail` reads.

The force of a film is linear in its coefficients, and shadows do not ask for them: of a film that ages, tables of one
coefficient each follow that of the fresh one, and what they count for is what the coefficient has changed by.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sailviz.shapes.facets import Coefficients, Shape, Surface
from sailviz.shapes.light_force import LIGHT, Law, Tensors, force_and_torque, tensors
from sailviz.shapes.shadows import Shadows

BILINEAR, BICUBIC = 0, 1
INTERPOLATIONS = {"bilinear": BILINEAR, "bicubic": BICUBIC}
WIDTH = 0.4  # least w of a film that is not flat, where its tensors begin to fade
CELLS = 32
MOST_FACETS = 200_000
COLUMNS = 8  # of a node: force, torque, two that fill a cache line
# places in the numbers: cells along a side, ring outside a face, 1 / w; then the tensors of front and back, the nodes
N, RING, STEEPNESS, FRONT, BACK, NODES = 0, 1, 2, 3, 58, 120
# of a film that ages: how many tables of one coefficient follow, what each counts for, m2 of the film
GROUPS, CHANGES, AREA = 113, 114, 118
STEP = 1e300  # 1 / w where w = 0
# the axes of p and q of the faces x, -x, y, -y, z, -z
ACROSS = ((1, 2), (1, 2), (0, 2), (0, 2), (0, 1), (0, 1))


class TableError(ValueError):
    """A table that cannot be made, in a sentence."""


@dataclass(frozen=True)
class LightTable:
    """numbers (NODES + 6 (n + 1 + 2 ring)^2 COLUMNS,), see above; backend : what cast the rays, "none" for no rays."""

    numbers: np.ndarray
    backend: str

    @property
    def cells(self) -> int:
        """Along a side of a face of the cube."""
        return int(self.numbers[N])


def directions(cells: int, ring: int = 0) -> np.ndarray:
    """Unit vectors of the nodes (6, n + 1 + 2 ring, same, 3), faces x, -x, y, -y, z, -z, p before q."""
    p = (np.arange(cells + 1 + 2 * ring) - ring) * (2.0 / cells) - 1.0
    found = np.empty((6, len(p), len(p), 3))
    for face, (first, second) in enumerate(ACROSS):
        found[face, ..., face // 2] = 1.0 if face % 2 == 0 else -1.0
        found[face, ..., first], found[face, ..., second] = p[:, None], p[None, :]
    return np.asarray(found / np.linalg.norm(found, axis=-1, keepdims=True))


def share(c: np.ndarray, width: float) -> np.ndarray:
    """S(c): 0 where c <= 0, 1 from the width on."""
    if width == 0.0:
        return np.where(c > 0, 1.0, 0.0)
    x = np.clip(c / width, 0.0, 1.0)
    return np.asarray(x**3 * (10 - 15 * x + 6 * x * x))


def width_of(shape: Shape) -> float:
    """w of a shape: the sine of its films' steepest slope, and not less than WIDTH; 0 where all are flat across z."""
    slope = shape.steepest
    return 0.0 if slope < 1e-9 else max(slope, WIDTH)


def by_tensors(front: Tensors, back: Tensors, width: float, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(force m2, torque m3) (n, 3) of what the tensors say of directions u (n, 3)."""
    lit, dark = share(u[:, 2], width)[:, None], share(-u[:, 2], width)[:, None]
    return lit * front.force(u) + dark * back.force(u), lit * front.torque(u) + dark * back.torque(u)


def check(shape: Shape, cells: int) -> None:
    """TableError for what is not going to be a table."""
    if cells < 2 or cells % 2 or cells > 256:
        raise TableError(f"a table has an even number of cells, 2 to 256, along a side of its cube, not {cells}")
    if len(shape.elements) > MOST_FACETS:
        raise TableError(
            f"the shape has {len(shape.elements)} facets, more than the {MOST_FACETS} for which a table is made: "
            "decimate it"
        )


def batches(count: int, facets: int) -> Iterator[slice]:
    """Pieces of work of some megabytes."""
    step = max(1, min(count, 1_000_000 // max(facets, 1)))
    return (slice(first, first + step) for first in range(0, count, step))


def exact(
    shape: Shape,
    u: np.ndarray,
    shadows: Shadows | None,
    law: Law = LIGHT,
    progress: Callable[[float], None] | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """(force (n, 3) m2, torque (n, 3) m3) over 2 P of the facets, shaded where `shadows` is given. u (n, 3)."""
    return exact_of([shape], u, shadows, law, progress)[0]


def exact_of(
    shapes: Sequence[Shape],
    u: np.ndarray,
    shadows: Shadows | None,
    law: Law = LIGHT,
    progress: Callable[[float], None] | None = None,
) -> list[tuple[np.ndarray, np.ndarray]]:
    """The same of shapes that differ in what their surfaces are, and cast the same shadows."""
    found = [(np.empty((len(u), 3)), np.empty((len(u), 3))) for _ in shapes]
    for batch in batches(len(u), len(shapes[0].elements)):
        visible = None if shadows is None else shadows.visible(u[batch], float(law.all_round))
        for shape, (force, torque) in zip(shapes, found, strict=True):
            force[batch], torque[batch] = force_and_torque(shape, u[batch], visible, law)
        if progress is not None:
            progress(min(1.0, batch.stop / len(u)))
    return found


def build(
    shape: Shape,
    cells: int = CELLS,
    *,
    shadow: bool = True,
    interpolation: str = "bilinear",
    law: Law = LIGHT,
    samples: int = 1,
    progress: Callable[[float], None] | None = None,
) -> LightTable:
    """The table of a shape. cells : along a side of the cube, even; shadow : whether parts shade each other; samples :
    rays along each side of a facet; progress : hears the share that is done. TableError, NoRaysError (both ValueError)
    where it cannot be made."""
    return build_all(
        [shape], cells, shadow=shadow, interpolation=interpolation, law=law, samples=samples, progress=progress
    )[0]


def build_all(
    shapes: Sequence[Shape],
    cells: int = CELLS,
    *,
    shadow: bool = True,
    interpolation: str = "bilinear",
    law: Law = LIGHT,
    samples: int = 1,
    progress: Callable[[float], None] | None = None,
) -> list[LightTable]:
    """The tables of shapes that differ in what their surfaces are, their rays cast once."""
    for shape in shapes:
        check(shape, cells)
    ring = INTERPOLATIONS[interpolation]
    shadows = Shadows(shapes[0], samples) if shadow else None
    nodes = directions(cells, ring)
    u, again = distinct(nodes.reshape(-1, 3))
    found = exact_of(shapes, u, shadows, law, progress)
    backend = "none" if shadows is None else shadows.backend
    return [
        LightTable(_numbers(shape, cells, ring, u, again, *loads), backend)
        for shape, loads in zip(shapes, found, strict=True)
    ]


def _numbers(
    shape: Shape, cells: int, ring: int, u: np.ndarray, again: np.ndarray, force: np.ndarray, torque: np.ndarray
) -> np.ndarray:
    """Of a table, from force m2 and torque m3 (n, 3) over 2 P in directions u (n, 3), the nodes' places among them."""
    width = width_of(shape)
    front, back = tensors(shape, "front"), tensors(shape, "back")
    of_facets = tensors(shape, "front", smooth=False), tensors(shape, "back", smooth=False)
    # what the facets leave over their own tensors is added to the tensors of the surface that they stand for
    part, turn = by_tensors(*of_facets, width, u)
    rows = np.zeros((len(u), COLUMNS))
    rows[:, :3], rows[:, 3:6] = force - part, torque - turn
    head = np.zeros(NODES)
    head[:FRONT] = cells, ring, 1.0 / width if width else STEP
    head[FRONT:BACK], head[BACK : BACK + 55] = front.numbers(), back.numbers()
    return np.concatenate([head, rows[again].ravel()])


def of_one_coefficient(shape: Shape, back: bool) -> list[Shape]:
    """The shape with one coefficient 1 and all others 0: of its films' fronts b1, b2, b3, and of their backs b3 where
    asked for."""
    none = Coefficients(0.0, 0.0, 0.0)
    pairs = [(Coefficients(*row), none) for row in np.eye(3).tolist()]
    if back:
        pairs.append((none, Coefficients(0.0, 0.0, 1.0)))
    return [
        Shape(tuple(replace(part, surface=Surface(*pair) if part.is_film else Surface(none)) for part in shape.parts))
        for pair in pairs
    ]


def with_age(fresh: LightTable, groups: Sequence[LightTable], area: float) -> LightTable:
    """The table of a film that ages: the fresh one, then those of `of_one_coefficient`, which count for nothing until a
    dose is said. area : m2 of the film."""
    numbers = np.concatenate([fresh.numbers, *(one.numbers for one in groups)])
    numbers[GROUPS], numbers[AREA] = len(groups), area
    return LightTable(numbers, fresh.backend)


def without_ring(table: LightTable) -> LightTable:
    """A table for bicubic reading as the one that is read bilinearly: the nodes of the faces alone."""
    ring, cells = int(table.numbers[RING]), table.cells
    head, width = table.numbers[:NODES].copy(), cells + 1 + 2 * ring
    head[RING] = 0.0
    nodes = table.numbers[NODES:].reshape(6, width, width, COLUMNS)[:, ring : width - ring, ring : width - ring]
    return LightTable(np.concatenate([head, nodes.ravel()]), table.backend)


def distinct(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(different directions (m, 3), for each of u (n, 3) its place among them)."""
    _, first, again = np.unique(np.round(u, 13) + 0.0, axis=0, return_index=True, return_inverse=True)
    return u[first], again.ravel()
