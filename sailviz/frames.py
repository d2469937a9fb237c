"""Frames of a spacecraft in orbit and rotations between them. Vectors are (3,) or (n, 3); frames are right-handed.

RTN, the orbital frame: r_hat from the central body, t_hat = h_hat x r_hat, h_hat the osculating angular momentum.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def length(vectors: np.ndarray) -> np.ndarray:
    """Lengths (...) of vectors (..., k): what np.linalg.norm makes of them to the last bit, in a third of its time."""
    square = vectors[..., 0] * vectors[..., 0]
    for i in range(1, vectors.shape[-1]):
        square = square + vectors[..., i] * vectors[..., i]
    found: np.ndarray = np.sqrt(square)
    return found


def cross(a: ArrayLike, b: ArrayLike) -> np.ndarray:
    """a x b of vectors (..., 3): what np.cross makes of them to the last bit, in a third of its time."""
    a, b = np.asarray(a), np.asarray(b)
    found = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        found[..., i] = a[..., j] * b[..., k] - a[..., k] * b[..., j]
    return found


def unit(vectors: ArrayLike) -> np.ndarray:
    """Vectors of length one. vectors : (..., 3) -> (..., 3); a zero vector stays zero."""
    vectors = np.asarray(vectors, dtype=float)
    size = length(vectors)[..., None]
    found: np.ndarray = np.divide(vectors, size, out=np.zeros_like(vectors), where=size > 0)
    return found


def rtn(position: ArrayLike, velocity: ArrayLike) -> np.ndarray:
    """Axes of the orbital frame. position m, velocity m/s : (..., 3) -> R_rtn_to_inertial (..., 3, 3), axes as columns.

    Without angular momentum (a craft at rest, or falling straight down) the orbit has no plane: t_hat is then the
    direction of increasing longitude and h_hat completes the frame towards the pole (x serves as longitude on the
    pole).
    """
    position, velocity = np.broadcast_arrays(np.asarray(position, float), np.asarray(velocity, float))
    r_hat = unit(position)
    h = cross(position, velocity)
    scale = length(position)[..., None] * length(velocity)[..., None]
    east = cross([0.0, 0.0, 1.0], r_hat)
    east = np.where(length(east)[..., None] > 1e-12, east, [0.0, 1.0, 0.0])
    planeless = length(h)[..., None] <= 1e-14 * scale
    h_hat = unit(np.where(planeless, cross(r_hat, east), h))
    t_hat = unit(cross(h_hat, r_hat))  # of length one, and h_hat again: on a nearly radial line h has few digits
    return np.stack([r_hat, t_hat, cross(r_hat, t_hat)], axis=-1)


def to_frame(axes: ArrayLike, vectors: ArrayLike) -> np.ndarray:
    """Components of inertial vectors along the columns of axes. (..., 3, 3), (..., 3) -> (..., 3)."""
    found: np.ndarray = np.einsum("...ji,...j->...i", np.asarray(axes), np.asarray(vectors))
    return found


def from_frame(axes: ArrayLike, components: ArrayLike) -> np.ndarray:
    """Inertial vectors from components along the columns of axes. (..., 3, 3), (..., 3) -> (..., 3)."""
    found: np.ndarray = np.einsum("...ij,...j->...i", np.asarray(axes), np.asarray(components))
    return found


def body_axes(normal: ArrayLike, hint: np.ndarray) -> np.ndarray:
    """Frame of a sail: z along the normal, x as close to `hint` as possible. (n, 3), (n, 3) -> (n, 3, 3), columns. A
    zero normal, of a stowed sail, stands for the z axis."""
    z = unit(normal)
    z = np.where(np.any(z != 0, axis=-1, keepdims=True), z, [0.0, 0.0, 1.0])
    x = hint - np.sum(hint * z, axis=-1, keepdims=True) * z
    weak = length(x)[..., None] < 1e-9
    spare = np.where(np.abs(z[..., 2:3]) < 0.9, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    x = unit(np.where(weak, cross(spare, z), x))
    x = unit(x - np.sum(x * z, axis=-1, keepdims=True) * z)  # once more: a hint almost along z has left few digits
    return np.stack([x, cross(z, x), z], axis=-1)


def stance(axes: ArrayLike, normal: ArrayLike) -> np.ndarray:
    """How a craft stands: its normal (n, 3) or, of a stowed sail, whose normal is zero, the first column of axes
    (n, 3, 3): away from the central body."""
    normal = np.asarray(normal, dtype=float)
    return np.where(np.any(normal, axis=-1, keepdims=True), normal, np.asarray(axes)[..., 0])


def quaternion(axes: ArrayLike) -> np.ndarray:
    """Unit quaternions (x, y, z, w) of rotation matrices, w >= 0. (..., 3, 3) -> (..., 4).

    Shepperd's method (J. Guidance and Control 1, 1978): the largest of the four components is computed first.
    """
    m = np.asarray(axes, dtype=float)
    xx, yy, zz = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    squares = np.stack([1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz, 1 + xx + yy + zz], axis=-1)
    yx, xy = m[..., 1, 0], m[..., 0, 1]
    zx, xz = m[..., 2, 0], m[..., 0, 2]
    zy, yz = m[..., 2, 1], m[..., 1, 2]
    table = np.stack(
        [
            np.stack([squares[..., 0], yx + xy, zx + xz, zy - yz], axis=-1),
            np.stack([yx + xy, squares[..., 1], zy + yz, xz - zx], axis=-1),
            np.stack([zx + xz, zy + yz, squares[..., 2], yx - xy], axis=-1),
            np.stack([zy - yz, xz - zx, yx - xy, squares[..., 3]], axis=-1),
        ],
        axis=-2,
    )
    best = np.argmax(squares, axis=-1)
    q = np.take_along_axis(table, best[..., None, None], axis=-2)[..., 0, :]
    q = q / length(q)[..., None]
    found: np.ndarray = np.where(q[..., 3:4] < 0, -q, q)
    return found


def rotation(quaternions: ArrayLike) -> np.ndarray:
    """Rotation matrices (..., 3, 3) of unit quaternions (..., 4) x y z w: their columns are the turned axes."""
    x, y, z, w = np.moveaxis(np.asarray(quaternions, dtype=float), -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, -1) for row in rows], -2)


def pitch_cone_clock(
    axes: ArrayLike, normal: ArrayLike, thrust: ArrayLike
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Attitude angles, rad. axes (n, 3, 3) RTN columns, normal and thrust (n, 3) inertial -> pitch, cone, clock,
    each (n,).

    Pitch is the angle from r_hat to the normal, cone the angle from r_hat to the thrust, clock the angle of the
    normal's projection on the local horizon, from h_hat towards t_hat, in [0, 2 pi). Clock is 0 where the normal is
    radial, cone is 0 without thrust. Source: thesis, figures 3.1 and 3.2, as in (3.6)-(3.8).
    """
    n_r, n_t, n_h = np.moveaxis(to_frame(axes, normal), -1, 0)
    a_r, a_t, a_h = np.moveaxis(to_frame(axes, thrust), -1, 0)
    sideways = np.hypot(n_t, n_h)
    pitch = np.arctan2(sideways, n_r)
    cone = np.arctan2(np.hypot(a_t, a_h), a_r)
    clock = np.where(sideways > 1e-12, np.mod(np.arctan2(n_t, n_h), 2 * np.pi), 0.0)
    clock = np.where(clock > 2 * np.pi - 1e-12, 0.0, clock)  # a rounding error below zero is zero
    return pitch, cone, clock


OBLIQUITY = np.radians(84_381.448 / 3600)  # of the ecliptic of J2000: IAU 1976, as in JPL's ECLIPJ2000
EQUATOR_FROM_ECLIPTIC = np.array(
    [
        [1.0, 0.0, 0.0],
        [0.0, np.cos(OBLIQUITY), -np.sin(OBLIQUITY)],
        [0.0, np.sin(OBLIQUITY), np.cos(OBLIQUITY)],
    ]
)
_ARCSECOND = np.pi / 180 / 3600


def centuries_since_j2000(utc: np.datetime64) -> float:
    """Julian centuries of TT since J2000 of a UTC date; the minute between the two turns the equator by 1e-4 arcsec."""
    return float((utc - np.datetime64("2000-01-01T11:58:55.816", "ns")) / np.timedelta64(1, "s")) / (36_525 * 86_400)


def precession(centuries: ArrayLike) -> np.ndarray:
    """Rotation (..., 3, 3) from the mean equator and equinox of J2000 to that of a date, Julian centuries (...,) of TT
    since J2000.

    IAU 2006 precession, the angles zeta, z, theta of N. Capitaine, P. T. Wallace, J. Chapront, A&A 412, 567 (2003),
    equation (40); nutation (up to 19 arcsec) and the frame bias (0.02 arcsec) are neglected.
    """
    t = np.asarray(centuries, dtype=float)
    zeta = 2.650545 + t * (2306.083227 + t * (0.2988499 + t * (0.01801828 - t * (5.971e-6 + t * 3.173e-7))))
    z = -2.650545 + t * (2306.077181 + t * (1.0927348 + t * (0.01826837 - t * (2.8596e-5 + t * 2.904e-7))))
    theta = t * (2004.191903 - t * (0.4294934 + t * (0.04182264 + t * (7.089e-6 + t * 1.274e-7))))
    found: np.ndarray = turn_z(-z * _ARCSECOND) @ turn_y(theta * _ARCSECOND) @ turn_z(-zeta * _ARCSECOND)
    return found


def _turns(rows: list[list[np.ndarray]]) -> np.ndarray:
    """Matrices (..., 3, 3) from their elements (...,), row by row."""
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def turn_x(angle: ArrayLike) -> np.ndarray:
    """Components (..., 3, 3) of a vector in axes turned by angles (...,) rad about x."""
    c, s = np.cos(angle), np.sin(angle)
    zero, one = np.zeros_like(c), np.ones_like(c)
    return _turns([[one, zero, zero], [zero, c, s], [zero, -s, c]])


def turn_y(angle: ArrayLike) -> np.ndarray:
    """The same about y."""
    c, s = np.cos(angle), np.sin(angle)
    zero, one = np.zeros_like(c), np.ones_like(c)
    return _turns([[c, zero, -s], [zero, one, zero], [s, zero, c]])


def turn_z(angle: ArrayLike) -> np.ndarray:
    """The same about z."""
    c, s = np.cos(angle), np.sin(angle)
    zero, one = np.zeros_like(c), np.ones_like(c)
    return _turns([[c, s, zero], [-s, c, zero], [zero, zero, one]])


FRAMES = ("ecliptic-j2000", "icrf", "equator-of-date")


def icrf_to(frame: str, centuries: float = 0.0) -> np.ndarray:
    """R (3, 3) that takes vectors of the ICRF, which counts as equator and equinox of J2000, to a frame of FRAMES.

    "equator-of-date" is the mean equator and equinox at that many Julian centuries of TT since J2000, held fixed: the
    pole moves 20 arcsec a year in it. ValueError for another word.
    """
    if frame == "icrf":
        return np.eye(3)
    if frame == "ecliptic-j2000":
        return EQUATOR_FROM_ECLIPTIC.T
    if frame == "equator-of-date":
        return precession(centuries)
    raise ValueError(f"{frame!r} is no frame; there are {', '.join(FRAMES)}")


def obliquity_of_date(centuries: ArrayLike) -> np.ndarray:
    """Angle (...,) rad between the mean equator and the ecliptic of date, Julian centuries (...,) of TT after J2000:
    IAU 2006, without terms below 1e-6 arcsec in this century."""
    t = np.asarray(centuries, dtype=float)
    found: np.ndarray = (84381.406 + t * (-46.836769 + t * (-0.0001831 + t * 0.00200340))) * _ARCSECOND
    return found


def ecliptic_of_date_to_icrf(centuries: ArrayLike) -> np.ndarray:
    """R (..., 3, 3) that takes vectors of the ecliptic and mean equinox of date to the ICRF, centuries as above."""
    to_date = turn_x(obliquity_of_date(centuries)) @ precession(centuries)
    found: np.ndarray = np.swapaxes(to_date, -1, -2)
    return found
