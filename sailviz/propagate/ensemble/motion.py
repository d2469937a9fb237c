"""One Runge-Kutta step for many flights at once: cylindrical coordinates, one flight per lane of a vector register.

State rows: rho (distance from the axis), theta (azimuth, counted on without a jump), z (height), and the speeds
u = rho', v = rho theta', w = z'. In these coordinates a low-thrust orbit bends slowly, so that a fourth-order step of a
day errs by less than 1e-8; in the plane a step needs four divisions and no
root. Classical Runge-Kutta rule; re-derived equations.

Thrust at fixed pitch and clock: components (radial, transverse, normal) that scale as 1/r (k) and as 1/r2 (j).
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import inlined

PLANE, ORBITAL, MERIDIAN = range(3)  # motion in the plane z = 0, or in space with the normal in one of two frames


@inlined
def _plane_rates(rho, u, v, k_r, k_t, j_r, j_t, mu):
    """theta', u', v' in the plane."""
    q = 1.0 / rho
    return v * q, q * (v * v + k_r + q * (j_r - mu)), q * (k_t - u * v + q * j_t)


@inlined
def step_in_plane(s, f, lanes, h, k_r, k_t, j_r, j_t, mu):
    """One step of h for all lanes. s (>= 6, lanes) state rows, f (lanes) thrust factors."""
    rho_row, theta_row, u_row, v_row = s[0], s[1], s[3], s[4]
    half, sixth = 0.5 * h, h / 6.0
    for i in range(lanes):
        a, b, c, d = f[i] * k_r, f[i] * k_t, f[i] * j_r, f[i] * j_t
        rho, u, v = rho_row[i], u_row[i], v_row[i]
        t1, u1, v1 = _plane_rates(rho, u, v, a, b, c, d, mu)
        p2, p3 = u + half * u1, v + half * v1
        t2, u2, v2 = _plane_rates(rho + half * u, p2, p3, a, b, c, d, mu)
        q2, q3 = u + half * u2, v + half * v2
        t3, u3, v3 = _plane_rates(rho + half * p2, q2, q3, a, b, c, d, mu)
        e2, e3 = u + h * u3, v + h * v3
        t4, u4, v4 = _plane_rates(rho + h * q2, e2, e3, a, b, c, d, mu)
        rho_row[i] = rho + sixth * (u + 2.0 * (p2 + q2) + e2)
        theta_row[i] += sixth * (t1 + 2.0 * (t2 + t3) + t4)
        u_row[i] = u + sixth * (u1 + 2.0 * (u2 + u3) + u4)
        v_row[i] = v + sixth * (v1 + 2.0 * (v2 + v3) + v4)


@inlined
def _space_rates(rho, z, u, v, w, k_r, k_t, k_n, j_r, j_t, j_n, mu, meridian):
    """theta', u', v', w' in space."""
    near = 1.0 / rho
    q = 1.0 / np.sqrt(rho * rho + z * z)
    a_r, a_t, a_n = q * (k_r + q * (j_r - mu)), q * (k_t + q * j_t), q * (k_n + q * j_n)
    up_rho, up_z = rho * q, z * q
    if meridian:  # t_hat along the azimuth, n_hat towards the pole
        g_rho, g_theta, g_z = a_r * up_rho - a_n * up_z, a_t, a_r * up_z + a_n * up_rho
    else:  # t_hat and h_hat of the osculating orbit
        x, y = up_rho * w - up_z * u, v  # speed in the meridian plane across r_hat, and along the azimuth
        size = np.sqrt(x * x + y * y)
        inverse = 1.0 / size if size > 0.0 else 0.0  # without angular momentum there is no transverse direction
        x, y = x * inverse, y * inverse
        across, along = a_t * x + a_n * y, a_t * y - a_n * x  # t_hat = x m + y e, h_hat = y m - x e, m = e x r_hat
        g_rho, g_theta, g_z = a_r * up_rho - across * up_z, along, a_r * up_z + across * up_rho
    return v * near, v * v * near + g_rho, g_theta - u * v * near, g_z


@inlined
def step_in_space(s, f, lanes, h, k_r, k_t, k_n, j_r, j_t, j_n, mu, meridian):
    """As `step_in_plane`, with height."""
    rho_row, theta_row, z_row, u_row, v_row, w_row = s[0], s[1], s[2], s[3], s[4], s[5]
    half, sixth = 0.5 * h, h / 6.0
    for i in range(lanes):
        a, b, c = f[i] * k_r, f[i] * k_t, f[i] * k_n
        d, e, g = f[i] * j_r, f[i] * j_t, f[i] * j_n
        rho, z, u, v, w = rho_row[i], z_row[i], u_row[i], v_row[i], w_row[i]
        t1, u1, v1, w1 = _space_rates(rho, z, u, v, w, a, b, c, d, e, g, mu, meridian)
        pu, pv, pw = u + half * u1, v + half * v1, w + half * w1
        t2, u2, v2, w2 = _space_rates(rho + half * u, z + half * w, pu, pv, pw, a, b, c, d, e, g, mu, meridian)
        qu, qv, qw = u + half * u2, v + half * v2, w + half * w2
        t3, u3, v3, w3 = _space_rates(rho + half * pu, z + half * pw, qu, qv, qw, a, b, c, d, e, g, mu, meridian)
        eu, ev, ew = u + h * u3, v + h * v3, w + h * w3
        t4, u4, v4, w4 = _space_rates(rho + h * qu, z + h * qw, eu, ev, ew, a, b, c, d, e, g, mu, meridian)
        rho_row[i] = rho + sixth * (u + 2.0 * (pu + qu) + eu)
        z_row[i] = z + sixth * (w + 2.0 * (pw + qw) + ew)
        theta_row[i] += sixth * (t1 + 2.0 * (t2 + t3) + t4)
        u_row[i] = u + sixth * (u1 + 2.0 * (u2 + u3) + u4)
        v_row[i] = v + sixth * (v1 + 2.0 * (v2 + v3) + v4)
        w_row[i] = w + sixth * (w1 + 2.0 * (w2 + w3) + w4)
