"""The compiled part of the first-order solution: one leg over a frozen ellipse, and the march over many legs."""

from __future__ import annotations

import numpy as np

from sailviz.compiled import called, entry, inlined
from sailviz.design.asymptotic.integrals import (
    A_2,
    A_M,
    B_3,
    B_K,
    B_M,
    J_AM_A2,
    J_BK_B3,
    J_BK_S3,
    J_BM_B3,
    J_SK_B3,
    J_SK_S3,
    J_SM_S3,
    S_3,
    S_K,
    S_M,
    a_integral,
    b_integral,
    eccentric,
    frozen,
    s_difference,
    time_terms,
)

OK, NO_MOMENTUM, ASYMPTOTE, HYPERBOLIC, NO_MASS, TOO_MANY_LEGS, PAUSED = range(7)
PLAIN, MIDPOINT = 0, 1
QUADRATURE, CLOSED, NONE = 0, 1, 2
SMALLEST_E = 1e-3  # below it the closed form of the time loses digits as 1/e^2, and quadrature takes its place
SAMPLES = 12  # per half revolution, in the search for q3 <= 0 or s <= 0
MOST_LEGS = 10_000_000
AT_ONCE = 50_000  # legs and outputs in one piece of compiled work, which hears no Ctrl-C: 0.1 s

# Gauss-Legendre with 3, 8 and 20 points in turn, for panels that are short, middling and up to a half turn
_NODES, _WEIGHTS = (np.concatenate(x) for x in zip(*map(np.polynomial.legendre.leggauss, (3, 8, 20)), strict=True))


@inlined
def _increments(n, nu, c, s, anomaly, sine, cosine, c0, a0, bk0, bm0, e, eta, b, scale, eps_r, eps_t):
    """First-order (Dp1, Dp2, Dq3) along the apse line, across it and of q3, from the start of a leg to nu."""
    k, m = 2 - n, 3 - n
    big_s, small_s = s_difference(k, c, c0, e), s_difference(m, c, c0, e)
    dbk = b_integral(k, nu, c, s, anomaly, sine, cosine, e, eta, b) - bk0
    dbm = b_integral(m, nu, c, s, anomaly, sine, cosine, e, eta, b) - bm0
    da = a_integral(m, anomaly, sine, cosine, e, eta) - a0
    return (
        scale * (eps_r * big_s + eps_t * (dbk + dbm)),
        scale * (-eps_r * dbk + eps_t * (big_s + small_s)),
        -scale * eps_t * da,
    )


@inlined
def _start(n, nu0, e, eta, b):
    """(cos(nu), E, A_m, B_k, B_m) at the start of a leg."""
    c, s = np.cos(nu0), np.sin(nu0)
    w = 1.0 + e * c
    anomaly, sine, cosine = eccentric(nu0, c, s, b), eta * s / w, (c + e) / w
    return (
        c,
        anomaly,
        a_integral(3 - n, anomaly, sine, cosine, e, eta),
        b_integral(2 - n, nu0, c, s, anomaly, sine, cosine, e, eta, b),
        b_integral(3 - n, nu0, c, s, anomaly, sine, cosine, e, eta, b),
    )


@called
def _at(n, nu, p1, p2, q3, c0, a0, bk0, bm0, e, eta, b, scale, eps_r, eps_t):
    """(p1, p2, q3, s) at a true anomaly of the frozen ellipse, for a leg that starts with p1, p2, q3."""
    c, s = np.cos(nu), np.sin(nu)
    w = 1.0 + e * c
    d1, d2, d3 = _increments(
        n, nu, c, s, eccentric(nu, c, s, b), eta * s / w, (c + e) / w, c0, a0, bk0, bm0, e, eta, b, scale, eps_r, eps_t
    )  # fmt: skip
    p1, p2, q3 = p1 + d1, p2 + d2, q3 + d3
    return p1, p2, q3, q3 + p1 * c + p2 * s


@called
def _breakdown(n, nu0, nu1, p1, p2, q3, c0, a0, bk0, bm0, e, eta, b, scale, eps_r, eps_t):
    """(status, nu) of the first place on a leg where q3 <= 0 or s <= 0; OK if there is none.

    A bound on the increments clears most legs; the others are searched, with golden sections at the minima of s.
    """
    _, _, end, _ = _at(n, nu1, p1, p2, q3, c0, a0, bk0, bm0, e, eta, b, scale, 0.0, 1.0)
    span_m = abs(end - q3)  # |scale A_m|
    span_k = (1.0 + e) * span_m
    most = (abs(eps_r) + abs(eps_t)) * span_k + 2.0 * abs(eps_t) * span_m
    if q3 - np.sqrt(p1 * p1 + p2 * p2) - most > 0.0:
        return OK, nu1
    count = int(np.ceil(SAMPLES * abs(nu1 - nu0) / np.pi)) + 2
    step = (nu1 - nu0) / count
    before, here = np.inf, np.inf
    for i in range(count + 1):
        nu = nu0 + step * i
        _, _, h, after = _at(n, nu, p1, p2, q3, c0, a0, bk0, bm0, e, eta, b, scale, eps_r, eps_t)
        if after > 0.0 and here <= before and here <= after and i >= 2:
            low, high = nu - 2.0 * step, nu
            for _ in range(30):
                x, y = high - 0.618034 * (high - low), low + 0.618034 * (high - low)
                _, _, _, fx = _at(n, x, p1, p2, q3, c0, a0, bk0, bm0, e, eta, b, scale, eps_r, eps_t)
                _, _, _, fy = _at(n, y, p1, p2, q3, c0, a0, bk0, bm0, e, eta, b, scale, eps_r, eps_t)
                if fx <= 0.0 or fy <= 0.0:
                    return ASYMPTOTE, x if fx <= 0.0 else y
                if fx < fy:
                    high = y
                else:
                    low = x
        if after <= 0.0 or h <= 0.0:  # close in on the first zero
            low, high = nu - step, nu
            for _ in range(50):
                x = 0.5 * (low + high)
                _, _, hx, sx = _at(n, x, p1, p2, q3, c0, a0, bk0, bm0, e, eta, b, scale, eps_r, eps_t)
                if sx <= 0.0 or hx <= 0.0:
                    high, h, after = x, hx, sx
                else:
                    low = x
            return (ASYMPTOTE if after <= 0.0 else NO_MOMENTUM), high
        before, here = here, after
    return OK, nu1


@called
def _quadrature(n, e0, e1, p1, p2, q3, c0, a0, bk0, bm0, e, eta, b, frozen_q3, scale, eps_r, eps_t):
    """Time between two eccentric anomalies of the frozen ellipse: Kepler's equation, and Gauss-Legendre for the rest.

    t' = 1 / (q3 s^2) with the first-order q, not expanded. Over E, and with the frozen ellipse's own time taken out,
    what is left is small and smooth even at e = 0.9.
    """
    unit = 1.0 / (frozen_q3 * eta) ** 3
    total = unit * ((e1 - e0) - e * (np.sin(e1) - np.sin(e0)))
    panels = max(int(np.ceil(abs(e1 - e0) / np.pi - 1e-12)), 1)
    half = 0.5 * (e1 - e0) / panels
    first, points = (0, 3) if abs(half) < 0.005 else (3, 8) if abs(half) < 0.25 else (11, 20)
    for j in range(panels):
        middle = e0 + (2 * j + 1) * half
        for i in range(first, first + points):
            anomaly = middle + half * _NODES[i]
            sine, cosine = np.sin(anomaly), np.cos(anomaly)
            u = 1.0 - e * cosine
            c, s = (cosine - e) / u, eta * sine / u
            nu = anomaly + 2.0 * np.arctan(b * sine / (1.0 - b * cosine)) if n > 0 else 0.0
            d1, d2, d3 = _increments(
                n, nu, c, s, anomaly, sine, cosine, c0, a0, bk0, bm0, e, eta, b, scale, eps_r, eps_t
            )
            h = q3 + d3
            v = h + (p1 + d1) * c + (p2 + d2) * s
            total += half * _WEIGHTS[i] * (eta / (u * h * v * v) - unit * u)
    return total


@called
def _closed_time(n, nu0, e0, nu, anomaly, e, eta, b, frozen_q3, scale, eps_r, eps_t):
    """The same time to first order, in closed form; for e >= SMALLEST_E and a leg frozen at its start."""
    x = time_terms(n, nu0, e0, e, eta, b)
    y = time_terms(n, nu, anomaly, e, eta, b)
    d_a2, d_b3, d_s3 = y[A_2] - x[A_2], y[B_3] - x[B_3], y[S_3] - x[S_3]
    along = (
        (y[J_AM_A2] - x[J_AM_A2] - x[A_M] * d_a2)
        - 2.0 * (y[J_BK_B3] - x[J_BK_B3] + y[J_BM_B3] - x[J_BM_B3] - (x[B_K] + x[B_M]) * d_b3)
        - 2.0 * (y[J_SK_S3] - x[J_SK_S3] + y[J_SM_S3] - x[J_SM_S3] - (x[S_K] + x[S_M]) * d_s3)
    )
    outward = -2.0 * (y[J_SK_B3] - x[J_SK_B3] - x[S_K] * d_b3) + 2.0 * (y[J_BK_S3] - x[J_BK_S3] - x[B_K] * d_s3)
    kepler = ((anomaly - e0) - e * (np.sin(anomaly) - np.sin(e0))) / eta**3
    return kepler / frozen_q3**3 + scale / frozen_q3**4 * (eps_t * along + eps_r * outward)


@called
def _end(q1, q2, q3, theta, theta1, n, eps_r, eps_t, clock, scheme):
    """(status, place, q1, q2, q3, time) at the end of one leg from theta to theta1; time measured from its start."""
    f1, f2, f3 = q1, q2, q3
    if scheme == MIDPOINT:
        middle = 0.5 * (theta + theta1)
        status, place, f1, f2, f3, _ = _plain(q1, q2, q3, q1, q2, q3, theta, middle, n, eps_r, eps_t, NONE)
        if status != OK:
            return status, place, q1, q2, q3, 0.0
    return _plain(q1, q2, q3, f1, f2, f3, theta, theta1, n, eps_r, eps_t, clock)


@called
def _plain(q1, q2, q3, f1, f2, f3, theta, theta1, n, eps_r, eps_t, clock):
    """`_end` with the increments taken over the ellipse f."""
    e, w, cos_w, sin_w, eta, b = frozen(f1, f2, f3)
    if not (e < 1.0 and f3 > 0.0):
        return HYPERBOLIC, theta, q1, q2, q3, 0.0
    nu0, nu = theta - w, theta1 - w
    scale = f3 ** (2 * n - 3)
    c0, e0, a0, bk0, bm0 = _start(n, nu0, e, eta, b)
    p1, p2 = q1 * cos_w + q2 * sin_w, q2 * cos_w - q1 * sin_w
    status, bad = _breakdown(n, nu0, nu, p1, p2, q3, c0, a0, bk0, bm0, e, eta, b, scale, eps_r, eps_t)
    if status != OK:
        return status, bad + w, q1, q2, q3, 0.0
    r1, r2, r3, _ = _at(n, nu, p1, p2, q3, c0, a0, bk0, bm0, e, eta, b, scale, eps_r, eps_t)
    elapsed = 0.0
    if clock != NONE:
        anomaly = eccentric(nu, np.cos(nu), np.sin(nu), b)
        if clock == CLOSED and e >= SMALLEST_E:
            elapsed = _closed_time(n, nu0, e0, nu, anomaly, e, eta, b, f3, scale, eps_r, eps_t)
        else:
            elapsed = _quadrature(n, e0, anomaly, p1, p2, q3, c0, a0, bk0, bm0, e, eta, b, f3, scale, eps_r, eps_t)
    return OK, theta1, r1 * cos_w - r2 * sin_w, r1 * sin_w + r2 * cos_w, r3, elapsed


def march(q, theta0, theta, leg, n, eps_r, eps_t, clock, scheme, loss, out, time, mass):
    """(status, angle of a breakdown, legs) of `_march` from the start q (3,), in pieces between which Ctrl-C is
    heard."""
    reached, done = np.array([*q, 0.0, 1.0, theta0], dtype=float), np.zeros(2, np.int64)
    place = np.empty(1)
    while True:
        status = march_compiled(
            reached, done, place, theta0, theta, leg, n, eps_r, eps_t, clock, scheme, loss, out, time, mass, AT_ONCE
        )
        if status != PAUSED:
            return status, float(place[0]), int(done[0])


@entry("D1 I1 D1 d d1 d i d d i i d D2 D1 D1 i")
def march_compiled(
    reached, done, place, theta0, theta, leg, n, eps_r, eps_t, clock, scheme, loss, out, time, mass, most
):  # fmt: skip
    """`_march`, the angle of a breakdown into place (1,)."""
    status, place[0] = _march(
        reached, done, theta0, theta, leg, n, eps_r, eps_t, clock, scheme, loss, out, time, mass, most
    )
    return status


@called
def _march(reached, done, theta0, theta, leg, n, eps_r, eps_t, clock, scheme, loss, out, time, mass, most):
    """Legs of fixed length over outputs that lie in one direction. Returns (status, angle of a breakdown), PAUSED
    after most legs and outputs.

    reached (6,) q, time, mass and angle, and done (2,) legs and outputs, from where it goes on; theta (k,) outputs,
    ordered away from theta0; leg > 0, inf for a single one. loss : canonical mass
    flow F / (m0 c); then eps are those of the initial mass. out (k, 3), time (k,), mass (k,) are filled.
    """
    q1, q2, q3, t, m, here = reached[0], reached[1], reached[2], reached[3], reached[4], reached[5]
    legs, row, count = done[0], done[1], len(theta)
    last = legs + row + most
    way = 1.0 if count == 0 or theta[count - 1] >= theta0 else -1.0
    while row < count:
        done[0], done[1] = legs, row
        if legs + row >= last:
            reached[0], reached[1], reached[2], reached[3], reached[4], reached[5] = q1, q2, q3, t, m, here
            return PAUSED, here
        stop = theta0 + way * leg * (legs + 1)
        if way * (theta[count - 1] - stop) < 1e-12 * leg:
            stop = theta[count - 1]
        legs += 1
        done[0] = legs
        er, et = eps_r / m, eps_t / m
        middle = 0.5 * (here + stop)
        if loss > 0.0 and scheme == MIDPOINT:
            status, place, _, _, _, half = _plain(q1, q2, q3, q1, q2, q3, here, middle, n, er, et, QUADRATURE)
            if status != OK:
                return status, place
            if not m - loss * half > 0.0:
                return NO_MASS, middle
            er, et = eps_r / (m - loss * half), eps_t / (m - loss * half)
        f1, f2, f3 = q1, q2, q3
        if scheme == MIDPOINT:
            status, place, f1, f2, f3, _ = _plain(q1, q2, q3, q1, q2, q3, here, middle, n, er, et, NONE)
            if status != OK:
                return status, place
        # the leg itself, output by output, on the ellipse f
        e, w, cos_w, sin_w, eta, b = frozen(f1, f2, f3)
        if not (e < 1.0 and f3 > 0.0):
            return HYPERBOLIC, here
        scale = f3 ** (2 * n - 3)
        nu0 = here - w
        c0, e0, a0, bk0, bm0 = _start(n, nu0, e, eta, b)
        p1, p2 = q1 * cos_w + q2 * sin_w, q2 * cos_w - q1 * sin_w
        status, bad = _breakdown(n, nu0, stop - w, p1, p2, q3, c0, a0, bk0, bm0, e, eta, b, scale, er, et)
        if status != OK:
            return status, bad + w
        last_e, since = e0, 0.0
        ends = False
        while not ends:
            at_output = row < count and way * (stop - theta[row]) >= 0.0
            target = theta[row] if at_output else stop
            ends = not at_output
            nu = target - w
            r1, r2, r3, _ = _at(n, nu, p1, p2, q3, c0, a0, bk0, bm0, e, eta, b, scale, er, et)
            if clock != NONE:
                anomaly = eccentric(nu, np.cos(nu), np.sin(nu), b)
                if clock == CLOSED and e >= SMALLEST_E:
                    since = _closed_time(n, nu0, e0, nu, anomaly, e, eta, b, f3, scale, er, et)
                else:
                    since += _quadrature(n, last_e, anomaly, p1, p2, q3, c0, a0, bk0, bm0, e, eta, b, f3, scale, er, et)
                last_e = anomaly
            g1, g2 = r1 * cos_w - r2 * sin_w, r1 * sin_w + r2 * cos_w
            if at_output:
                out[row, 0], out[row, 1], out[row, 2] = g1, g2, r3
                time[row] = t + since if clock != NONE else np.nan
                mass[row] = m - loss * since
                row += 1
                if row == count:
                    ends = True
            if m - loss * since <= 0.0:
                return NO_MASS, target
        q1, q2, q3 = g1, g2, r3
        t += since
        m -= loss * since
        here = stop
    return OK, here


def march_adaptive(q, theta0, theta, tolerance, cap, n, eps_r, eps_t, clock, scheme, out, time):
    """As `march`, with legs chosen by comparing one leg with two halves; returns (status, place, accepted legs,
    trials)."""
    reached, done = np.array([*q, 0.0, theta0, cap], dtype=float), np.zeros(3, np.int64)
    place = np.empty(1)
    while True:
        status = march_adaptive_compiled(
            reached, done, place, theta0, theta, tolerance, cap, n, eps_r, eps_t, clock, scheme, out, time,
            AT_ONCE // 5,
        )  # fmt: skip
        if status != PAUSED:
            return status, float(place[0]), int(done[0]), int(done[2])


@entry("D1 I1 D1 d d1 d d i d d i i D2 D1 i")
def march_adaptive_compiled(
    reached, done, place, theta0, theta, tolerance, cap, n, eps_r, eps_t, clock, scheme, out, time, most
):  # fmt: skip
    """`_march_adaptive`, the angle of a breakdown into place (1,)."""
    status, place[0] = _march_adaptive(
        reached, done, theta0, theta, tolerance, cap, n, eps_r, eps_t, clock, scheme, out, time, most
    )
    return status


@called
def _march_adaptive(reached, done, theta0, theta, tolerance, cap, n, eps_r, eps_t, clock, scheme, out, time, most):
    """`march_adaptive` from what is reached (6,), q, time, angle and length of leg, and done (3,), legs, outputs and
    trials, on.

    Accepted where max|dq| <= tolerance dtheta / (2 pi); continued from twice the halves less the whole (Richardson).
    The difference enters the outputs inside a leg with the square of the way, as the error grows there.
    """
    q1, q2, q3, t, here, wish = reached[0], reached[1], reached[2], reached[3], reached[4], reached[5]
    legs, row, trials, count = done[0], done[1], done[2], len(theta)
    last = trials + most
    way = 1.0 if count == 0 or theta[count - 1] >= theta0 else -1.0
    while row < count:
        done[0], done[1], done[2] = legs, row, trials
        if trials >= last:
            reached[0], reached[1], reached[2], reached[3], reached[4], reached[5] = q1, q2, q3, t, here, wish
            return PAUSED, here
        trials += 1
        if trials > MOST_LEGS:
            return TOO_MANY_LEGS, here
        stop = here + way * wish
        if way * (theta[count - 1] - stop) < 1e-9 * wish:
            stop = theta[count - 1]
        middle, length = 0.5 * (here + stop), abs(stop - here)
        status, place, w1, w2, w3, wt = _end(q1, q2, q3, here, stop, n, eps_r, eps_t, clock, scheme)
        if status == OK:
            status, place, h1, h2, h3, ht = _end(q1, q2, q3, here, middle, n, eps_r, eps_t, clock, scheme)
        if status == OK:
            half_t = ht
            status, place, h1, h2, h3, ht = _end(h1, h2, h3, middle, stop, n, eps_r, eps_t, clock, scheme)
            ht += half_t
        if status != OK:
            if wish < 1e-6:
                return status, place
            wish = 0.25 * length  # a leg too long for the expansion is no breakdown yet
            continue
        error = max(abs(w1 - h1), abs(w2 - h2), abs(w3 - h3))
        allowed = tolerance * length / (2.0 * np.pi)
        if error > allowed and length > 1e-9:
            wish = length * max(0.2, 0.9 * allowed / error)
            continue
        gain = 2.0 if scheme == PLAIN else 4.0 / 3.0
        g1, g2, g3, gt = gain * (h1 - w1), gain * (h2 - w2), gain * (h3 - w3), gain * (ht - wt)
        power = 2 if scheme == PLAIN else 3
        while row < count and way * (stop - theta[row]) >= 0.0:
            share = ((theta[row] - here) / (stop - here)) ** power
            status, place, r1, r2, r3, rt = _end(q1, q2, q3, here, theta[row], n, eps_r, eps_t, clock, PLAIN)
            if status != OK:
                return status, place
            if scheme == MIDPOINT:  # inside, the midpoint's ellipse is that of the whole leg
                status, place, f1, f2, f3, _ = _plain(q1, q2, q3, q1, q2, q3, here, middle, n, eps_r, eps_t, NONE)
                status, place, r1, r2, r3, rt = _plain(q1, q2, q3, f1, f2, f3, here, theta[row], n, eps_r, eps_t, clock)
            out[row, 0], out[row, 1], out[row, 2] = r1 + share * g1, r2 + share * g2, r3 + share * g3
            time[row] = t + rt + share * gt if clock != NONE else np.nan
            row += 1
        q1, q2, q3, t = w1 + g1, w2 + g2, w3 + g3, t + wt + gt
        here = stop
        legs += 1
        wish = min(cap, length * min(3.0, 0.9 * allowed / max(error, 1e-300)))
    done[0], done[1], done[2] = legs, row, trials
    return OK, here
