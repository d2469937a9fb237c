"""How to hold a sail so that its thrust does the most along a wanted direction, the primer.

Every sail here is a body of revolution about the Sun line. With the primer at the angle alpha_l from r_hat, c and s
its cosine and sine, and thrust a_c (r_E / r)^k (f_r r_hat + f_t t_hat), t_hat the primer's transverse direction, the
optimal pitch maximises c f_r + s f_t; the maximum h(c) is the support function of the set of possible thrusts. With
h at hand the costate equations of a minimum-time flight need no derivative of the pitch.

Source: thesis, chapter 6, and its paper J.7, of which the text was not readable: re-derived, and checked against
brute-force maximisation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sailviz.compiled import entry, inlined
from sailviz.propulsion.devices import SOLAR_SAIL, sail
from sailviz.propulsion.electric_sail import FINAL, ORIGINAL, POLYNOMIAL
from sailviz.propulsion.solar_sail import FILMS, Film

POLYNOMIAL_LIMIT = np.radians(70.0)  # the fit's range; the largest cone angle lies at 54.84 deg
NEARLY_AXIAL = 1e-9  # sine of the primer angle below which the tangent of the pitch is linear in it


# Places in the numbers of a sail, see `devices.sail`: its strength comes first, then those of a film or of an E-sail
STRENGTH = 0
B1, B2, B3 = 1, 2, 3
COOL = 4  # behind those of a film that a primer law steers: largest cosine of the pitch over r^2 that it bears, 0: any
MODEL, LARGEST_PITCH = 1, 2


@inlined
def ideal_pitch(c, s):
    """cos and sin of the pitch of an ideal film: tan = (-3c + sqrt(8 + c^2)) / (4s), or 2s / (3c + sqrt(8 + c^2))
    where that cancels. Never off."""
    q = np.sqrt(8.0 + c * c)
    if c > 0.0:
        along, across = 3.0 * c + q, 2.0 * s
    else:
        along, across = 4.0 * s, q - 3.0 * c
    size = np.sqrt(along * along + across * across)
    return along / size, across / size


@inlined
def analytic_tangent(b1, b2, c, s):
    """Tangent of the pitch of an optical film with b3 neglected, and whether it has a root:
    b1 c T^3 + 2 b2 s T^2 + (b1 + 3 b2) c T - b2 s = 0.

    Solved for X = 1 / T, of which the largest root is the maximum; its leading coefficient b2 s does not vanish
    where the primer is transverse.
    """
    if s < NEARLY_AXIAL:
        return b2 * s / ((b1 + 3.0 * b2) * c), c > 0.0
    p = (b1 + 3.0 * b2) * c / (b2 * s)
    q = b1 * c / (b2 * s)
    third = p / 3.0
    big_p = 2.0 + 3.0 * third * third
    root = np.sqrt(big_p / 3.0)
    ratio = (third * third * third + third + 0.5 * q) / (root * root * root)
    if ratio < -1.0:
        return 0.0, False
    if ratio <= 1.0:
        x = third + 2.0 * root * np.cos(np.arccos(ratio) / 3.0)
    else:
        x = third + 2.0 * root * np.cosh(np.arccosh(ratio) / 3.0)
    return 1.0 / x, x > 0.0


@inlined
def _film_thrust(b1, b2, b3, along, across):
    """(f_r, f_t) of a film at the pitch of given cosine and sine: (3.21)."""
    k = along / (b1 + b2 + b3)
    n = b2 * along + b3
    return k * (b1 + n * along), k * n * across


@inlined
def _best_of_samples(b1, b2, b3, c, s):
    """Tangent of the best of 64 pitches, and whether it gives any thrust along the primer: a start for films that
    mostly scatter, which the cubic does not describe."""
    best, tangent = 0.0, 0.0
    for i in range(64):
        alpha = i * (0.5 * np.pi / 64)
        along, across = np.cos(alpha), np.sin(alpha)
        f_r, f_t = _film_thrust(b1, b2, b3, along, across)
        h = c * f_r + s * f_t
        if h > best:
            best, tangent = h, across / along
    return tangent, best > 0.0


@inlined
def _film_pitch(b1, b2, b3, c, s):
    """cos and sin of the pitch of an optical film and whether the root was found: the cubic's root, then Newton on
    the whole condition, b3 sqrt(1 + T^2) (s T^2 + 2 c T - s) added to the cubic."""
    if b1 == 0.0 and b3 == 0.0:
        along, across = ideal_pitch(c, s)
        return along, across, True
    if b2 > 4.0 * abs(b3):
        t, found = analytic_tangent(b1, b2, c, s)
    else:
        t, found = _best_of_samples(b1, b2, b3, c, s)
    if not found:
        return 0.0, 1.0, False
    if b3 != 0.0:
        for _ in range(30):
            w = np.sqrt(1.0 + t * t)
            inner = s * t * t + 2.0 * c * t - s
            g = ((b1 * c * t + 2.0 * b2 * s) * t + (b1 + 3.0 * b2) * c) * t - b2 * s + b3 * w * inner
            slope = (3.0 * b1 * c * t + 4.0 * b2 * s) * t + (b1 + 3.0 * b2) * c
            slope += b3 * (t / w * inner + 2.0 * w * (s * t + c))
            if slope <= 0.0:  # past the last maximum, and so past the switch
                return 0.0, 1.0, False
            step = min(max(g / slope, -0.5 * (1.0 + t)), 0.5 * (1.0 + t))
            t = max(t - step, 0.0)
            if abs(step) <= 4e-16 * (1.0 + t):
                break
    w = 1.0 / np.sqrt(1.0 + t * t)
    return w, t * w, True


@inlined
def _polynomial(d):
    """phi deg with its first and second slope and gamma with its own, per degree, at a pitch of d deg: (3.36)-(3.38),
    table 3.2, clamped as in the force model."""
    phi = d * (4.853e-1 + d * (3.652e-3 + d * (-2.661e-4 + d * (6.322e-6 + d * (-8.295e-8 + d * 3.681e-10)))))
    phi1 = 4.853e-1 + d * (
        2 * 3.652e-3 + d * (-3 * 2.661e-4 + d * (4 * 6.322e-6 + d * (-5 * 8.295e-8 + d * 6 * 3.681e-10)))
    )
    phi2 = 2 * 3.652e-3 + d * (-6 * 2.661e-4 + d * (12 * 6.322e-6 + d * (-20 * 8.295e-8 + d * 30 * 3.681e-10)))
    gamma = 1.0 + d * (6.904e-5 + d * (-1.271e-4 + d * (7.027e-7 + d * (-1.261e-8 + d * (1.943e-10 - d * 5.896e-13)))))
    gamma1 = 6.904e-5 + d * (
        -2 * 1.271e-4 + d * (3 * 7.027e-7 + d * (-4 * 1.261e-8 + d * (5 * 1.943e-10 - d * 6 * 5.896e-13)))
    )
    gamma2 = -2 * 1.271e-4 + d * (6 * 7.027e-7 + d * (-12 * 1.261e-8 + d * (20 * 1.943e-10 - d * 30 * 5.896e-13)))
    if gamma > 1.0:
        return phi, phi1, phi2, 1.0, 0.0, 0.0
    return phi, phi1, phi2, gamma, gamma1, gamma2


@inlined
def _polynomial_pitch(c, s):
    """Pitch deg that maximises gamma cos(alpha_l - phi): the zero of its falling slope, by Newton kept in a bracket;
    the clamp on gamma puts a kink near half a degree."""
    primer = np.degrees(np.arctan2(s, c))
    low, high = 0.0, np.degrees(POLYNOMIAL_LIMIT)
    d = min(0.5 * primer, high)
    for _ in range(60):
        phi, phi1, phi2, gamma, gamma1, gamma2 = _polynomial(d)
        away = np.radians(primer - phi)
        cosine, sine = np.cos(away), np.sin(away)
        rise = np.degrees(gamma1) * cosine + gamma * phi1 * sine
        curve = (np.degrees(gamma2) - np.radians(gamma) * phi1 * phi1) * cosine
        curve += (2.0 * gamma1 * phi1 + gamma * phi2) * sine
        if rise > 0.0:
            low = d
        else:
            high = d
        following = d - rise / min(curve, -1e-4)
        if abs(following - d) < 1e-13 * (1.0 + d):
            break
        if not (low < following < high):
            following = 0.5 * (low + high)
        d = following
    return d


@inlined
def _smooth(h, f_r, f_t, c, s, eps):
    """The support function rounded off where the thrust switches, eps log(1 + exp(h / eps)), and its thrust: again
    the exact support function of a convex set of thrusts, so the Hamiltonian system stays one."""
    x = h / eps
    if x > 40.0:
        return h, f_r, f_t
    if x < -700.0:
        return 0.0, 0.0, 0.0
    e = np.exp(x)
    share = e / (1.0 + e)
    rounded = eps * np.log1p(e)
    more = rounded - share * h
    return rounded, share * f_r + more * c, share * f_t + more * s


@inlined
def steer(device, p, at, c, s, eps):
    """(cos alpha, sin alpha, h, f_r, f_t) of the sail of parameters p[at:] for a primer at the angle of cosine c and
    sine s >= 0 from r_hat. eps rounds the switching off; 0 is the true law; below 0 an E-sail is never switched off.

    Off is h = f_r = f_t = 0: a film then stands edge-on, an E-sail keeps the pitch it would thrust with.
    """
    if device == SOLAR_SAIL:
        b1, b2, b3 = p[at + B1], p[at + B2], p[at + B3]
        along, across, found = _film_pitch(b1, b2, b3, c, s)
        if not found:
            return 0.0, 1.0, 0.0, 0.0, 0.0
        f_r, f_t = _film_thrust(b1, b2, b3, along, across)
        h = c * f_r + s * f_t
        if h <= 0.0 and eps == 0.0:
            return 0.0, 1.0, 0.0, 0.0, 0.0
    elif p[at + MODEL] == FINAL:
        along, across = np.sqrt(0.5 * (1.0 + c)), np.sqrt(0.5 * (1.0 - c))
        if c > 0.0:
            across = 0.5 * s / along  # no cancellation where the primer is nearly radial
        elif across > 0.0:
            along = 0.5 * s / across
        h, f_r, f_t = 0.25 * (1.0 + 3.0 * c), 0.25 * (3.0 + c), 0.25 * s
    elif p[at + MODEL] == POLYNOMIAL:
        d = _polynomial_pitch(c, s)
        phi, _, _, gamma, _, _ = _polynomial(d)
        along, across = np.cos(np.radians(d)), np.sin(np.radians(d))
        f_r, f_t = gamma * np.cos(np.radians(phi)), gamma * np.sin(np.radians(phi))
        h = c * f_r + s * f_t
    else:
        f_r, f_t = np.cos(0.5 * p[at + LARGEST_PITCH]), np.sin(0.5 * p[at + LARGEST_PITCH])
        if c > f_r:  # the thrust reaches the primer itself
            f_r, f_t = c, s
        along, across = f_r * f_r - f_t * f_t, 2.0 * f_r * f_t  # (3.34): the pitch is twice the cone angle
        h = c * f_r + s * f_t
    if eps > 0.0:
        h, f_r, f_t = _smooth(h, f_r, f_t, c, s, eps)
    elif h <= 0.0 and eps == 0.0:
        h, f_r, f_t = 0.0, 0.0, 0.0
    return along, across, h, f_r, f_t


@inlined
def cooled(p, at, most, c, s):
    """(cos alpha, sin alpha, h, f_r, f_t, dh / d cos alpha) of a film of parameters p[at:] at the largest cosine of the
    pitch that its heat allows, for a primer as of `steer` that asks for more; h <= 0 asks for none, and edge-on."""
    b1, b2, b3 = p[at + B1], p[at + B2], p[at + B3]
    across = np.sqrt(1.0 - most * most)
    f_r, f_t = _film_thrust(b1, b2, b3, most, across)
    rise_r = b1 + (2.0 * b3 + 3.0 * b2 * most) * most
    rise_t = (2.0 * b2 * most + b3) * across - (b2 * most + b3) * most * most / across
    return most, across, c * f_r + s * f_t, f_r, f_t, (c * rise_r + s * rise_t) / (b1 + b2 + b3)


@inlined
def full_thrust(device, p, at, r, au):
    """a_c (r_E / r)^k and the exponent k of the sail of parameters p[at:] at the distance r; au in the unit of r."""
    if device == SOLAR_SAIL:
        return p[at + STRENGTH] * (p[at + B1] + p[at + B2] + p[at + B3]) / (r * r), 2.0
    near = au / r
    if p[at + MODEL] == ORIGINAL:
        return p[at + STRENGTH] * near ** (7.0 / 6.0), 7.0 / 6.0
    return p[at + STRENGTH] * near, 1.0


@inlined
def _across(ux, uy, uz, lx, ly, lz):
    """c, s and the transverse unit vector of a primer; any transverse vector where it is radial, c = 0 and s = 0
    where it vanishes."""
    along = ux * lx + uy * ly + uz * lz
    wx, wy, wz = lx - along * ux, ly - along * uy, lz - along * uz
    across = np.sqrt(wx * wx + wy * wy + wz * wz)
    size = np.sqrt(along * along + across * across)
    if across > 1e-15 * size:
        return along / size, across / size, wx / across, wy / across, wz / across
    if abs(uz) < 0.9:
        inverse = 1.0 / np.sqrt(ux * ux + uy * uy)
        tx, ty, tz = -uy * inverse, ux * inverse, 0.0
    else:
        inverse = 1.0 / np.sqrt(uy * uy + uz * uz)
        tx, ty, tz = 0.0, -uz * inverse, uy * inverse
    if size == 0.0:
        return 0.0, 0.0, tx, ty, tz
    return np.sign(along), 0.0, tx, ty, tz


@inlined
def steer_cool(device, p, at, r2, c, s):
    """(cos alpha, sin alpha, h) as `steer`, at the square r2 of the distance: a film does not face the light more than
    its heat allows, where that is limited."""
    along, across, h, _, _ = steer(device, p, at, c, s, 0.0)
    if device == SOLAR_SAIL and p[at + COOL] > 0.0 and h > 0.0 and along > p[at + COOL] * r2:
        along, across, h, _, _, _ = cooled(p, at, p[at + COOL] * r2, c, s)
        if h <= 0.0:
            return 0.0, 1.0, 0.0
    return along, across, h


@inlined
def towards_primer(device, p, at, r2, ux, uy, uz, lx, ly, lz):
    """Sail normal n and h, the thrust along a primer vector l of any length as a share of the full one, 0 for thrust
    off; u = r_hat, r2 the square of the distance. A film's parameters end with that at COOL.

    A vanished primer asks for no thrust: off, and edge-on to the Sun.
    """
    c, s, tx, ty, tz = _across(ux, uy, uz, lx, ly, lz)
    if c == 0.0 and s == 0.0:
        return tx, ty, tz, 0.0
    along, across, h = steer_cool(device, p, at, r2, c, s)
    return along * ux + across * tx, along * uy + across * ty, along * uz + across * tz, max(h, 0.0)


@inlined
def analytic_film(b1, b2, c, s):
    """(cos alpha, sin alpha, on) of the analytic law of an optical film: b3 neglected in the pitch and in the switch,
    cos alpha_l = -b2 / (2 b1 + b2)."""
    if c <= -b2 / (2.0 * b1 + b2):
        return 0.0, 1.0, False
    t, _ = analytic_tangent(b1, b2, c, s)
    w = 1.0 / np.sqrt(1.0 + t * t)
    return w, t * w, True


@inlined
def towards_primer_analytic(p, at, ux, uy, uz, lx, ly, lz):
    """`towards_primer` of a film by the analytic law, with 1.0 or 0.0 for thrust on or off."""
    c, s, tx, ty, tz = _across(ux, uy, uz, lx, ly, lz)
    if c == 0.0 and s == 0.0:
        return tx, ty, tz, 0.0
    along, across, on = analytic_film(p[at + B1], p[at + B2], c, s)
    return along * ux + across * tx, along * uy + across * ty, along * uz + across * tz, 1.0 if on else 0.0


@entry("d1 d1 i d1 i d D1 D1")
def _pitches(primer, facing, device, p, analytic, eps, pitch, h):
    for i in range(len(primer)):
        c, s = np.cos(primer[i]), abs(np.sin(primer[i]))
        if analytic:
            along, across, on = analytic_film(p[B1], p[B2], c, s)
            f_r, f_t = _film_thrust(p[B1], p[B2], p[B3], along, across)
            h[i] = c * f_r + s * f_t if on else -1.0
        else:
            along, across, h[i], _, _ = steer(device, p, 0, c, s, eps)
            if device == SOLAR_SAIL and h[i] > 0.0 and along > facing[i]:
                along, across, h[i], _, _, _ = cooled(p, 0, facing[i], c, s)
                if h[i] <= 0.0:
                    along, across, h[i] = 0.0, 1.0, 0.0
        pitch[i] = np.copysign(np.arctan2(across, along), np.sin(primer[i]))
    return 0


@dataclass(frozen=True)
class Pitch:
    """pitch rad with the sign of the primer's angle, on: whether there is thrust; support: h, the thrust along the
    primer as a share of a_c (r_E / r)^k. Shape of the primer angle."""

    pitch: np.ndarray
    on: np.ndarray
    support: np.ndarray

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> np.ndarray:
        return np.array(self.pitch, dtype=dtype)


def _evaluate(
    primer_angle: npt.ArrayLike, device: Film | str, analytic: bool, facing: npt.ArrayLike = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    primer = np.asarray(primer_angle, dtype=float)
    kind, parameters = sail(device, 1.0, 1.0)
    flat = np.ascontiguousarray(primer).ravel()
    most = np.array(np.broadcast_to(np.asarray(facing, dtype=float), primer.shape)).ravel()
    pitch, h = np.empty_like(flat), np.empty_like(flat)
    _pitches(flat, most, kind, np.array(parameters), analytic, 0.0, pitch, h)
    pitch, h = pitch.reshape(primer.shape), h.reshape(primer.shape)
    return pitch, h


def optimal_pitch(primer_angle: npt.ArrayLike, device: Film | str = "ideal", facing: npt.ArrayLike = 1.0) -> Pitch:
    """Pitch that makes the most of the thrust along a primer at an angle from the Sun line, rad, same shape.

    facing : largest cosine of the pitch that a film may have, e.g. for its heat, of the same shape or a number.

    device : a sail's name or a Film. Ideal and E-sail (final) in closed form; optical films by a cubic and Newton's
    method to rounding; beyond the switch angle a film stands edge-on (90 deg) and an E-sail is off. E-sails that do
    not describe pitches beyond 60 deg stay within. Re-derived.
    """
    pitch, h = _evaluate(primer_angle, device, False, facing)
    return Pitch(pitch[()], (h > 0)[()], h[()])


def analytic_pitch(primer_angle: npt.ArrayLike, film: Film | str) -> Pitch:
    """Pitch of an optical film in closed form, b3 neglected: within 0.0575 deg (JPL-1978) and 0.0305 deg (JPL-2015)
    of `optimal_pitch` up to its switch. primer_angle rad, any shape; support is the true film's at that pitch.

    Edge-on beyond cos(alpha_l) = -b2 / (2 b1 + b2), up to 0.33 deg later than optimal. Re-derived.
    """
    film = FILMS[film] if isinstance(film, str) else film
    if not film.b2 > 0:
        raise ValueError("the analytic law holds for films that reflect specularly, with b2 > 0")
    pitch, h = _evaluate(primer_angle, film, True)
    on = np.abs(pitch) < 0.5 * np.pi
    return Pitch(pitch[()], on[()], np.where(on, h, 0.0)[()])
