"""Which way thrust changes an orbit fastest: gradients of orbital elements with respect to velocity.

A sail steered to the most thrust along such a primer changes the element at the best rate of that moment,
a_c (r_E / r)^k |primer| h. Gauss' equations in vector form; source: thesis, chapter 6, of which the text was not
readable: re-derived, checked against differences of the elements.

Where the gradient vanishes its direction jumps, and where the thrust that is to be had along it does, the thrust
jumps. A law may lead to such a place and hold there, and a sail that followed it would be thrown to and fro without
end: at the bottom of a valley of the distance, on a circle that is to be round, in a plane that is to be level.
Towards it the thrust fades (`readiness`): what a sail gives that follows the law for this share of the time and stands
edge-on, or is off, for the rest.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import inlined

ENERGY, SEMI_MAJOR_AXIS, ECCENTRICITY, INCLINATION, RAAN, ARGUMENT, APOAPSIS, PERIAPSIS = range(8)
GOALS = {
    "energy": ENERGY,
    "semi-major-axis": SEMI_MAJOR_AXIS,
    "eccentricity": ECCENTRICITY,
    "inclination": INCLINATION,
    "raan": RAAN,
    "argument": ARGUMENT,
    "apogee": APOAPSIS,
    "perigee": PERIAPSIS,
}
# Places in the numbers of `lyapunov_primer`, in the first three groups of one element each: p, f, g, h, k
TARGETS, WEIGHTS, SCALES, REACHED = 0, 5, 10, 15
P, F, G, H, K = range(5)
EDGE = 0.05  # share of the most that the gradient, or the thrust along it, could be, below which the thrust fades
BAND = 0.1  # of the nearness that counts as reached: so far above it the thrust begins to fade
ROUND, FLAT = 1e-3, 1e-3  # eccentricity, and inclination in rad, below which the thrust that lessens it fades
SMALL = 1e-12  # an eccentricity, or sine of an inclination, below which there is no apsis or node


@inlined
def readiness(x):
    """Share of the best thrust that a soft edge leaves at the place x of it, 0 at its bottom, 1 and level at its
    rim."""
    return 1.0 if x >= 1.0 else x * (2.0 - x)


@inlined
def locally_optimal_readiness(kind, sense, x, y, z, vx, vy, vz, mu):
    """`readiness` of a locally optimal law. Only what lessens an eccentricity or an inclination may arrive; near the
    reference plane the node, to which the side is tied to which to push, is carried along with the craft besides, and
    so the thrust also fades a quarter of a turn from it."""
    if sense > 0.0:
        return 1.0
    if kind == INCLINATION:
        hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
        across = np.sqrt(hx * hx + hy * hy)
        if across < SMALL * abs(hz):
            return 0.0
        share = abs(x * hy - y * hx) / (across * np.sqrt(x * x + y * y + z * z))  # |cos u|
        return readiness(np.arctan2(across, abs(hz)) / FLAT) * readiness(share / EDGE)
    if kind == ECCENTRICITY:
        along = (vx * vx + vy * vy + vz * vz) / mu - 1.0 / np.sqrt(x * x + y * y + z * z)
        radial = (x * vx + y * vy + z * vz) / mu
        ex, ey, ez = along * x - radial * vx, along * y - radial * vy, along * z - radial * vz
        return readiness(np.sqrt(ex * ex + ey * ey + ez * ez) / ROUND)
    return 1.0


@inlined
def locally_optimal_primer(kind, x, y, z, vx, vy, vz, mu):
    """d(element) / d(velocity), the primer that increases an element, inertial; negate it to decrease.

    kind : one of GOALS; energy in m2/s2, semi-major axis, apogee and perigee (of whatever body) in m, angles in rad,
    per m/s. On a circle eccentricity grows
    from a periapsis here, in the reference plane inclination grows from a node here; the node's own angle and the
    argument of periapsis have no gradient there (0). On a planar orbit "argument" is the longitude of periapsis.
    """
    r = np.sqrt(x * x + y * y + z * z)
    ux, uy, uz = x / r, y / r, z / r
    v2 = vx * vx + vy * vy + vz * vz
    if kind == ENERGY:
        return vx, vy, vz
    if kind == SEMI_MAJOR_AXIS:
        a = 1.0 / (2.0 / r - v2 / mu)
        k = 2.0 * a * a / mu
        return k * vx, k * vy, k * vz
    hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    h = np.sqrt(hx * hx + hy * hy + hz * hz)
    wx, wy, wz = hx / h, hy / h, hz / h  # h_hat
    sine = np.sqrt(wx * wx + wy * wy)
    if kind in (INCLINATION, RAAN):
        if kind == RAAN and sine < SMALL:
            return 0.0, 0.0, 0.0
        node_x, node_y, node_z = ux, uy, uz
        if sine >= SMALL:
            node_x, node_y, node_z = -wy / sine, wx / sine, 0.0
        k = (x * node_x + y * node_y + z * node_z) / h
        if kind == RAAN:
            k = z / (h * sine * sine)  # r sin(u) = z / sin(i)
        return k * wx, k * wy, k * wz
    radial = x * vx + y * vy + z * vz
    along = v2 / mu - 1.0 / r
    ex, ey, ez = along * x - radial / mu * vx, along * y - radial / mu * vy, along * z - radial / mu * vz
    e = np.sqrt(ex * ex + ey * ey + ez * ez)
    if kind == ARGUMENT and e < SMALL:
        return 0.0, 0.0, 0.0
    px, py, pz = ux, uy, uz
    if e >= SMALL:
        px, py, pz = ex / e, ey / e, ez / e
    qx, qy, qz = px, py, pz
    if kind == ARGUMENT:  # the eccentricity vector turns towards h_hat x e_hat
        qx, qy, qz = wy * pz - wz * py, wz * px - wx * pz, wx * py - wy * px
    # d(e_vec) . q for fixed q: [2 (r . q) v - (v . q) r - (r . v) q] / mu
    rq, vq = x * qx + y * qy + z * qz, vx * qx + vy * qy + vz * qz
    lx = (2.0 * rq * vx - vq * x - radial * qx) / mu
    ly = (2.0 * rq * vy - vq * y - radial * qy) / mu
    lz = (2.0 * rq * vz - vq * z - radial * qz) / mu
    if kind in (APOAPSIS, PERIAPSIS):  # a (1 + e), a (1 - e)
        side = 1.0 if kind == APOAPSIS else -1.0
        a = 1.0 / (2.0 / r - v2 / mu)
        k, scale = (1.0 + side * e) * 2.0 * a * a / mu, side * a
        return k * vx + scale * lx, k * vy + scale * ly, k * vz + scale * lz
    if kind == ARGUMENT:
        lx, ly, lz = lx / e, ly / e, lz / e
        if sine >= SMALL:  # the argument counts from the node, which moves as the plane turns
            k = -wz * z / (h * sine * sine)
            lx, ly, lz = lx + k * wx, ly + k * wy, lz + k * wz
    return lx, ly, lz


@inlined
def _pull(p, at, element, value):
    """W (x - T) / S^2 and x - T of an element x."""
    off, scale = value - p[at + TARGETS + element], p[at + SCALES + element]
    return p[at + WEIGHTS + element] * off / (scale * scale), off


@inlined
def lyapunov_primer(x, y, z, vx, vy, vz, mu, p, at):
    """-dV/d(velocity) of V = sum W_i ((x_i - T_i) / S_i)^2 over the modified equinoctial elements p, f, g, h, k,
    inertial: the primer that brings the orbit towards the target elements; and the readiness of the law: from the
    gradient's share of what it would be if the misses did not cancel each other, and from what is left to be done.

    p[at:] : targets T (5), weights W (5), scales S (5), and the V at which the target counts as reached: the primer
    then vanishes, for no thrust holds an orbit on a point. Prograde orbits: h and k grow without bound at 180 deg.
    """
    r = np.sqrt(x * x + y * y + z * z)
    ux, uy, uz = x / r, y / r, z / r
    hx, hy, hz = y * vz - z * vy, z * vx - x * vz, x * vy - y * vx
    size = np.sqrt(hx * hx + hy * hy + hz * hz)
    wx, wy, wz = hx / size, hy / size, hz / size
    semi = size * size / mu
    h, k = -wy / (1.0 + wz), wx / (1.0 + wz)
    s2 = 1.0 + h * h + k * k
    fx, fy, fz = (1.0 + h * h - k * k) / s2, 2.0 * h * k / s2, -2.0 * k / s2
    gx, gy, gz = 2.0 * h * k / s2, (1.0 - h * h + k * k) / s2, 2.0 * h / s2
    cos, sin = ux * fx + uy * fy + uz * fz, ux * gx + uy * gy + uz * gz  # of the true longitude
    along = (vx * vx + vy * vy + vz * vz) / mu - 1.0 / r
    radial = (x * vx + y * vy + z * vz) / mu
    ex, ey, ez = along * x - radial * vx, along * y - radial * vy, along * z - radial * vz
    f, g = ex * fx + ey * fy + ez * fz, ex * gx + ey * gy + ez * gz
    w = 1.0 + f * cos + g * sin
    q = np.sqrt(semi / mu)
    dp, off_p = _pull(p, at, P, semi)
    df, off_f = _pull(p, at, F, f)
    dg, off_g = _pull(p, at, G, g)
    dh, off_h = _pull(p, at, H, h)
    dk, off_k = _pull(p, at, K, k)
    value = dp * off_p + df * off_f + dg * off_g
    value += dh * off_h + dk * off_k
    if value <= p[at + REACHED]:
        return 0.0, 0.0, 0.0, 0.0
    tilt = (h * sin - k * cos) / w
    l_r = q * (df * sin - dg * cos)
    l_t = q * (2.0 * semi / w * dp + ((w + 1.0) * cos + f) / w * df + ((w + 1.0) * sin + g) / w * dg)
    l_h = q * (tilt * (f * dg - g * df) + 0.5 * s2 / w * (cos * dh + sin * dk))
    tx, ty, tz = wy * uz - wz * uy, wz * ux - wx * uz, wx * uy - wy * ux
    l_r, l_t, l_h = -2.0 * l_r, -2.0 * l_t, -2.0 * l_h
    most = 2.0 * q * (2.0 * semi * abs(dp) + 2.0 * (abs(df) + abs(dg)) + 0.5 * s2 * (abs(dh) + abs(dk)))
    ready = readiness(np.sqrt(l_r * l_r + l_t * l_t + l_h * l_h) / (EDGE * most))
    ready *= readiness((np.sqrt(value / p[at + REACHED]) - 1.0) / BAND)
    return l_r * ux + l_t * tx + l_h * wx, l_r * uy + l_t * ty + l_h * wy, l_r * uz + l_t * tz + l_h * wz, ready
