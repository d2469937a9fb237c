"""A craft that turns: Euler's equations, the quaternion's rate, the torque of gravity that differs across it.

Axes of the body; the quaternion (x, y, z, w) turns them into inertial ones, the body rate w rad/s counts along them:

    q' = q * (w, 0) / 2          I w' = torque - w x (I w + h)          h' = - torque of the wheels

h N m s the momentum of wheels, along the body's axes. A quaternion is made unit where it is used: as a state it has
four components without a constraint. Symmetric matrices are six numbers: xx, yy, zz, xy, xz, yz.
"""

from __future__ import annotations

from sailviz.compiled import inlined


@inlined
def axes_of(x, y, z, w):
    """The body's x, y and z axes in inertial components, nine numbers, of a quaternion of any length."""
    k = 2.0 / (x * x + y * y + z * z + w * w)
    xx, yy, zz, xy, xz, yz = k * x * x, k * y * y, k * z * z, k * x * y, k * x * z, k * y * z
    wx, wy, wz = k * w * x, k * w * y, k * w * z
    return (
        1.0 - yy - zz, xy + wz, xz - wy,
        xy - wz, 1.0 - xx - zz, yz + wx,
        xz + wy, yz - wx, 1.0 - xx - yy,
    )  # fmt: skip


@inlined
def quaternion_rate(x, y, z, w, p, q, r):
    """Derivative of a quaternion at the body rate (p, q, r), rad/s."""
    return (
        0.5 * (w * p + y * r - z * q),
        0.5 * (w * q + z * p - x * r),
        0.5 * (w * r + x * q - y * p),
        -0.5 * (x * p + y * q + z * r),
    )


@inlined
def cross(ax, ay, az, bx, by, bz):
    """a x b."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@inlined
def symmetric(xx, yy, zz, xy, xz, yz, x, y, z):
    """A symmetric matrix times a vector."""
    return xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z


@inlined
def gravity_gradient(strength, x, y, z, xx, yy, zz, xy, xz, yz):
    """Torque, N m, of gravity on an inertia, kg m2, at the unit vector from the centre in body axes: strength x
    (r_hat x I r_hat), strength = 3 mu / r^3, 1/s2."""
    ix, iy, iz = symmetric(xx, yy, zz, xy, xz, yz, x, y, z)
    return strength * (y * iz - z * iy), strength * (z * ix - x * iz), strength * (x * iy - y * ix)


@inlined
def flat_plate(ux, uy, uz, nx, ny, nz, f1, f2, f3, g1, g2, g3):
    """Force of light along u over 2 P A on a plate whose normal away from the light, for a craft that faces it, is n:
    (3.17) with coefficients f on the front, the side that n leaves behind, and g on the back."""
    c = nx * ux + ny * uy + nz * uz
    b1, b2, b3, side = (f1, f2, f3, 1.0) if c > 0.0 else (g1, g2, g3, -1.0)
    c = abs(c)
    along, across = c * b1, c * (b2 * c + b3) * side
    return along * ux + across * nx, along * uy + across * ny, along * uz + across * nz
