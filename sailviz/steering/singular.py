"""The throttle on a singular arc: partial voltage that keeps an electric sail's primer at the angle of its switch.

What an E-sail can push with, on or off, is not convex: nothing, or a sphere that nothing is no part of. Where a fastest
flight wants what lies between the two, its primer stands at the switch for a while, and the throttle lies between 0
and 1. With p and q the costates of velocity and position, P = |p| and c* the cosine of the angle at which the thrust
ends, the switching function is

    S = p . r_hat - c* P,    S' = -q . r_hat + p . w / r + c* q . p_hat,    S'' = D + B tau,

w the transverse velocity; B > 0, so that tau = -D / B holds S at 0 (the strengthened Kelley condition). Source:
re-derived, for any thrust a_c r^-k (f_r r_hat + f_t t_hat); with c* = -1/3 it is a third of what the final model's P +
3 p . r_hat would give.
"""

from __future__ import annotations

from sailviz.compiled import inlined


@inlined
def switching_function(px, py, pz, ux, uy, uz, size, switch):
    """S of a primer p of length `size`; u = r_hat, switch = c*."""
    return px * ux + py * uy + pz * uz - switch * size


@inlined
def switching_rates(x, y, z, vx, vy, vz, px, py, pz, qx, qy, qz, r, size, mu, switch, thrust, exponent, c, s, f_r, f_t):
    """(S', D, B): S'' = D + B tau of position, velocity and costates p of velocity, q of position.

    r = |position|, size = |p|, switch = c*; thrust : a_c r^-k at tau = 1; c and s, of the angle from r_hat to p; f_r
    and f_t, the thrust's radial and transverse part. Any consistent units.
    """
    inverse = 1.0 / r
    ux, uy, uz = x * inverse, y * inverse, z * inverse
    v_r = vx * ux + vy * uy + vz * uz
    wx, wy, wz = vx - v_r * ux, vy - v_r * uy, vz - v_r * uz
    p_r = px * ux + py * uy + pz * uz
    p_w = px * wx + py * wy + pz * wz
    q_r = qx * ux + qy * uy + qz * uz
    q_w = qx * wx + qy * wy + qz * wz
    q_p = (qx * px + qy * py + qz * pz) / size
    q_q = qx * qx + qy * qy + qz * qz
    w_w = wx * wx + wy * wy + wz * wz
    first = -q_r + p_w * inverse + switch * q_p
    pull = mu * inverse * inverse * inverse
    # without thrust: q' = mu (p - 3 (p . r_hat) r_hat) / r^3, w' = -(w . w) / r r_hat - v_r w / r
    turned = pull * (size - 3.0 * p_r * p_r / size) + (q_p * q_p - q_q) / size  # (q . p_hat)'
    drift = 2.0 * pull * p_r - 2.0 * q_w * inverse - (w_w * p_r + 2.0 * v_r * p_w) * inverse * inverse
    drift += switch * turned
    h = c * f_r + s * f_t
    sideways = c * f_t - s * f_r
    gain = exponent * h * (switch * c - 1.0) + s * (switch * sideways + f_t)
    return first, drift, thrust * size * inverse * gain
