"""Light on a sail of any shape: force and torque read from tensors and a table over the directions of the light.

The numbers are those of `shapes.light_table`: a head, 55 tensor numbers for either side of the films, and nodes of
eight numbers on the six faces of a cube. In body axes, over 2 P: forces m2, torques m3 about the origin. Of a film
that ages tables of one coefficient each follow, all of one size; what each counts for is set where its dose is known.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from sailviz.compiled import called, entry, inlined

N, RING, STEEPNESS, FRONT, BACK, NODES = 0, 1, 2, 3, 58, 120  # as `shapes.light_table` writes them
GROUPS, CHANGES, AREA = 113, 114, 118
J0, J1, J2, L, K1, K2, COLUMNS = 0, 3, 9, 19, 28, 37, 8


@inlined
def fade(c, steepness):
    """S(c) for c >= 0: 1 from c = 1 / steepness on."""
    x = min(c * steepness, 1.0)
    return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)


@inlined
def tensor_force(x, y, z, a, at):
    """J2 : u u + J1 u + u (j0 . u), from the 55 numbers in a from place `at` on."""
    j, k = at + J1, at + J2
    xx, xy, xz, yy, yz, zz = x * x, x * y, x * z, y * y, y * z, z * z
    along = a[at] * x + a[at + 1] * y + a[at + 2] * z
    # of the symmetric J2: xxx xxy xxz xyy xyz xzz yyy yyz yzz zzz
    fx = a[k] * xx + 2.0 * (a[k + 1] * xy + a[k + 2] * xz + a[k + 4] * yz) + a[k + 3] * yy + a[k + 5] * zz
    fy = a[k + 1] * xx + 2.0 * (a[k + 3] * xy + a[k + 4] * xz + a[k + 7] * yz) + a[k + 6] * yy + a[k + 8] * zz
    fz = a[k + 2] * xx + 2.0 * (a[k + 4] * xy + a[k + 5] * xz + a[k + 8] * yz) + a[k + 7] * yy + a[k + 9] * zz
    return (
        fx + a[j] * x + a[j + 1] * y + a[j + 2] * z + along * x,
        fy + a[j + 1] * x + a[j + 3] * y + a[j + 4] * z + along * y,
        fz + a[j + 2] * x + a[j + 4] * y + a[j + 5] * z + along * z,
    )


@inlined
def row_of_three(a, at, x, y, z):
    """Product of three numbers from place `at` on with a vector."""
    return a[at] * x + a[at + 1] * y + a[at + 2] * z


@inlined
def row_of_six(a, at, xx, xy, xz, yy, yz, zz):
    """A symmetric form: six numbers from place `at` on."""
    return a[at] * xx + a[at + 3] * yy + a[at + 5] * zz + 2.0 * (a[at + 1] * xy + a[at + 2] * xz + a[at + 4] * yz)


@inlined
def tensor_torque(x, y, z, a, at):
    """K2 : u u + K1 u + (L u) x u."""
    xx, xy, xz, yy, yz, zz = x * x, x * y, x * z, y * y, y * z, z * z
    lx, ly, lz = (
        row_of_three(a, at + L, x, y, z),
        row_of_three(a, at + L + 3, x, y, z),
        row_of_three(a, at + L + 6, x, y, z),
    )
    tx = row_of_six(a, at + K2, xx, xy, xz, yy, yz, zz) + row_of_three(a, at + K1, x, y, z)
    ty = row_of_six(a, at + K2 + 6, xx, xy, xz, yy, yz, zz) + row_of_three(a, at + K1 + 3, x, y, z)
    tz = row_of_six(a, at + K2 + 12, xx, xy, xz, yy, yz, zz) + row_of_three(a, at + K1 + 6, x, y, z)
    return tx + ly * z - lz * y, ty + lz * x - lx * z, tz + lx * y - ly * x


@inlined
def face_of(x, y, z):
    """(face, p, q): the largest component's, x, -x, y, -y, z, -z, and the other two over it. No branch: which face it
    is going to be cannot be foretold, and a wrong guess costs as much as the rest."""
    ax, ay, az = abs(x), abs(y), abs(z)
    upright = az >= max(ax, ay)
    ahead = ax >= ay
    main = z if upright else (x if ahead else y)
    first = x if upright else (y if ahead else x)
    second = y if upright else z
    face = (4 if upright else (0 if ahead else 2)) + (1 if main < 0.0 else 0)
    inverse = 1.0 / abs(main)
    return face, first * inverse, second * inverse


@inlined
def cell_of(p, half, n):
    """(cell, place in it 0 to 1) of a coordinate from -1 to 1; half : n / 2."""
    at = (p + 1.0) * half
    i = min(int(at), n - 1)
    return i, at - i


@inlined
def mixed(a, i, j, k, m, wi, wj, wk, wm):
    """Weighted sum of four numbers."""
    return wi * a[i] + wj * a[j] + wk * a[k] + wm * a[m]


@called
def bicubic(x, y, z, a, at, n):
    """Six numbers of the table, by Catmull and Rom's cubics."""
    face, p, q = face_of(x, y, z)
    half = 0.5 * n
    i, s = cell_of(p, half, n)
    j, t = cell_of(q, half, n)
    rows = n + 3
    first = at + COLUMNS * ((face * rows + i) * rows + j)
    w0, w1 = ((2.0 - s) * s - 1.0) * s * 0.5, ((3.0 * s - 5.0) * s * s + 2.0) * 0.5
    w2, w3 = ((4.0 - 3.0 * s) * s + 1.0) * s * 0.5, (s - 1.0) * s * s * 0.5
    v0, v1 = ((2.0 - t) * t - 1.0) * t * 0.5, ((3.0 * t - 5.0) * t * t + 2.0) * 0.5
    v2, v3 = ((4.0 - 3.0 * t) * t + 1.0) * t * 0.5, (t - 1.0) * t * t * 0.5
    fx, fy, fz, tx, ty, tz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for row in range(4):
        w = w0 if row == 0 else (w1 if row == 1 else (w2 if row == 2 else w3))
        b = first + COLUMNS * rows * row
        c, d, e = b + COLUMNS, b + 2 * COLUMNS, b + 3 * COLUMNS
        fx += w * mixed(a, b, c, d, e, v0, v1, v2, v3)
        fy += w * mixed(a, b + 1, c + 1, d + 1, e + 1, v0, v1, v2, v3)
        fz += w * mixed(a, b + 2, c + 2, d + 2, e + 2, v0, v1, v2, v3)
        tx += w * mixed(a, b + 3, c + 3, d + 3, e + 3, v0, v1, v2, v3)
        ty += w * mixed(a, b + 4, c + 4, d + 4, e + 4, v0, v1, v2, v3)
        tz += w * mixed(a, b + 5, c + 5, d + 5, e + 5, v0, v1, v2, v3)
    return fx, fy, fz, tx, ty, tz


@inlined
def bilinear(x, y, z, a, at, n):
    """Six numbers of the table, by straight lines."""
    face, p, q = face_of(x, y, z)
    half = 0.5 * n
    i, s = cell_of(p, half, n)
    j, t = cell_of(q, half, n)
    rows = n + 1
    b = at + COLUMNS * ((face * rows + i) * rows + j)
    c, d = b + COLUMNS, b + COLUMNS * rows
    e = d + COLUMNS
    wb, wc, wd, we = (1.0 - s) * (1.0 - t), (1.0 - s) * t, s * (1.0 - t), s * t
    return (
        mixed(a, b, c, d, e, wb, wc, wd, we),
        mixed(a, b + 1, c + 1, d + 1, e + 1, wb, wc, wd, we),
        mixed(a, b + 2, c + 2, d + 2, e + 2, wb, wc, wd, we),
        mixed(a, b + 3, c + 3, d + 3, e + 3, wb, wc, wd, we),
        mixed(a, b + 4, c + 4, d + 4, e + 4, wb, wc, wd, we),
        mixed(a, b + 5, c + 5, d + 5, e + 5, wb, wc, wd, we),
    )


@inlined
def push(x, y, z, a, at):
    """(force m2, torque m3 about the origin) over 2 P for light along u in body axes. a : an array in which the table's
    numbers begin at place `at`."""
    n = int(a[at + N])
    if a[at + RING] == 0.0:
        fx, fy, fz, tx, ty, tz = bilinear(x, y, z, a, at + NODES, n)
    else:
        fx, fy, fz, tx, ty, tz = bicubic(x, y, z, a, at + NODES, n)
    w = fade(abs(z), a[at + STEEPNESS])
    side = at + (FRONT if z > 0.0 else BACK)
    gx, gy, gz = tensor_force(x, y, z, a, side)
    hx, hy, hz = tensor_torque(x, y, z, a, side)
    return fx + w * gx, fy + w * gy, fz + w * gz, tx + w * hx, ty + w * hy, tz + w * hz


@inlined
def stride(a, at):
    """How many numbers a table has."""
    rows = int(a[at + N] + 1.0 + 2.0 * a[at + RING])
    return NODES + 6 * rows * rows * COLUMNS


@called
def aged_push(x, y, z, a, at):
    """As `push`, of a film that ages: what its coefficients have changed by counts too."""
    fx, fy, fz, tx, ty, tz = push(x, y, z, a, at)
    step = stride(a, at)
    for i in range(int(a[at + GROUPS])):
        k = a[at + CHANGES + i]
        if k != 0.0:
            gx, gy, gz, hx, hy, hz = push(x, y, z, a, at + (i + 1) * step)
            fx, fy, fz, tx, ty, tz = fx + k * gx, fy + k * gy, fz + k * gz, tx + k * hx, ty + k * hy, tz + k * hz
    return fx, fy, fz, tx, ty, tz


@called
def exposure(x, y, z, a, at):
    """Share of a film that ages on whose front light along u falls, across the light: cos(alpha) of a flat one."""
    fx, fy, fz, _, _, _ = push(x, y, z, a, at + stride(a, at))
    return max(0.0, fx * x + fy * y + fz * z) / a[at + AREA]


@entry("d2 d1 D2")
def _read(u, numbers, out):
    for i in range(len(u)):
        out[i, 0], out[i, 1], out[i, 2], out[i, 3], out[i, 4], out[i, 5] = push(u[i, 0], u[i, 1], u[i, 2], numbers, 0)
    return 0


def force_and_torque(u: npt.ArrayLike, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(force (..., 3) m2, torque (..., 3) m3 about the origin) over 2 P, in body axes, of light along unit vectors u
    (..., 3). numbers : of `shapes.light_table.LightTable`."""
    given = np.asarray(u, float)
    rows = np.ascontiguousarray(given.reshape(-1, 3))
    out = np.empty((len(rows), 6))
    _read(rows, numbers, out)
    return out[:, :3].reshape(given.shape), out[:, 3:].reshape(given.shape)


def aged_force_and_torque(u: np.ndarray, numbers: np.ndarray, changes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same of a film that ages. u (n, 3), changes (n, k) of its coefficients, see GROUPS."""
    one = numbers[: stride.py_func(numbers, 0)]
    force, torque = force_and_torque(u, one)
    for i in range(int(numbers[GROUPS])):
        more, turn = force_and_torque(u, numbers[(i + 1) * len(one) :][: len(one)])
        force, torque = force + changes[:, i, None] * more, torque + changes[:, i, None] * turn
    return force, torque
