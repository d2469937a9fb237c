"""Vectors and frames as each view shows them.

/world is inertial, in units of `length`; the craft may be carried along its orbit. /sail of a sail round the Sun has x
radial, y transverse, z normal to the orbit, round a planet x from the light; that of a tether x transverse, y normal,
z up. /axis is inertial, of the rows themselves.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from .picture import turn


def near(entity: str) -> bool:
    """Whether an entity belongs to the close-up."""
    return entity == "/sail" or entity.startswith("/sail/")


def on_sphere(entity: str) -> bool:
    """Whether an entity stands on or in the sphere of directions."""
    return entity == "/axis" or entity.startswith("/axis/")


def hanging(flight) -> bool:
    return flight.truth.kind == "plasma-brake"


def seen(flight, entity: str, vectors) -> np.ndarray:
    """Inertial vectors (n, 3) as the view of an entity shows their directions."""
    if on_sphere(entity):
        return np.asarray(vectors, float)
    if not near(entity):
        return flight.truth.carried(vectors)
    close = np.einsum("nij,nj->ni", flight.truth.close_frame, vectors)
    return close[:, [1, 2, 0]] if hanging(flight) else close


def fixed(flight, entity: str, vectors) -> np.ndarray:
    """The same of directions that are not carried along with the craft, such as the Sun's."""
    if not near(entity):
        return np.asarray(vectors, float)
    rtn = np.einsum("nij,nj->ni", flight.truth.drawn_frame, vectors)
    return rtn[:, [1, 2, 0]] if hanging(flight) else rtn


def body(flight, entity: str) -> np.ndarray:
    """(n, 3, 3), columns: the body's axes of /attitude/quaternion in the view of an entity; of what spins in the body
    those that spin."""
    axes = _body(flight, "/axis" if on_sphere(entity) else "/sail" if near(entity) else "/world")
    return axes @ flight.truth.spin if "/body/shape" in entity or "/body/tether" in entity else axes


@cache
def _body(flight, view: str) -> np.ndarray:
    axes = np.array([turn(q) for q in flight.truth.quaternion])
    return np.stack([seen(flight, view, axes[:, :, k]) for k in range(3)], -1)


def home(flight, entity: str) -> np.ndarray:
    """(n, 3) where the craft is drawn."""
    there = near(entity) or on_sphere(entity)
    return np.zeros((len(flight.truth), 3)) if there else flight.truth.place / flight.truth.length


def outward(flight, entity: str) -> np.ndarray:
    """(n, 3) the direction from the central body, or from the light."""
    return seen(flight, entity, flight.truth.outward)


def poses(flight, entity: str, steps=None) -> np.ndarray:
    """(n, 4, 4) of every row, or of some."""
    steps = range(len(flight.truth)) if steps is None else steps
    return np.array([flight.picture.pose(entity, step) for step in steps])


def some(flight, count: int = 9) -> np.ndarray:
    """Rows spread over the run, the first and the last among them."""
    return np.unique(np.linspace(0, len(flight.truth) - 1, count).round().astype(int))


def in_body(flight, entity: str, component: str, row: int) -> np.ndarray:
    """Points of a component in the true body frame of a row, about the craft, view units."""
    drawn = flight.picture.place(entity, component, row)
    return (drawn - home(flight, entity)[row]) @ body(flight, entity)[row]


def lines_in_body(flight, entity: str, row: int) -> list[np.ndarray]:
    axes, centre = body(flight, entity)[row], home(flight, entity)[row]
    return [(line - centre) @ axes for line in flight.picture.line(entity, row)]


def arrows(flight, entity: str):
    """Origins and vectors (n, 3) of an entity with one arrow a row."""
    steps, _ = flight.picture.rows(entity, "Arrows3D:vectors")
    assert np.array_equal(steps, flight.truth.steps), "not one arrow for each row"
    pairs = [flight.picture.arrow(entity, step) for step in steps]
    return np.array([origin[0] for origin, _ in pairs]), np.array([vector[0] for _, vector in pairs])


def strips(flight, entity: str) -> np.ndarray:
    """(n, k, 3) of an entity with one strip a row."""
    steps, _ = flight.picture.rows(entity, "LineStrips3D:strips")
    assert np.array_equal(steps, flight.truth.steps), "not one line for each row"
    lines = [flight.picture.line(entity, step) for step in steps]
    assert all(len(line) == 1 for line in lines)
    return np.array([line[0] for line in lines])


def spots(flight, entity: str) -> list[np.ndarray]:
    """Points of each row, (k, 3), of an entity whose points have rows."""
    steps, _ = flight.picture.rows(entity, "Points3D:positions")
    assert np.array_equal(steps, flight.truth.steps), "not one label for each row"
    return [flight.picture.place(entity, "Points3D:positions", step) for step in steps]


def texts(flight, entity: str) -> list[str]:
    """The label that is shown at each row."""
    return [flight.picture.at(entity, "Points3D:labels", step)[0] for step in flight.truth.steps]


def shown(flight, entity: str) -> list[tuple[int, np.ndarray]]:
    """Row and place (3,) of a name that is left out where another would lie on it; it is shown somewhere."""
    if not flight.picture.moves(entity, "Points3D:positions"):
        return [(row, flight.picture.place(entity, "Points3D:positions", 0)[0]) for row in range(len(flight.truth))]
    found = []
    for row, step in enumerate(flight.truth.steps):
        spot = flight.picture.place(entity, "Points3D:positions", step)
        assert len(spot) <= 1
        found += [(row, spot[0])] if len(spot) else []
    assert found, "a name that is never shown"
    return found
