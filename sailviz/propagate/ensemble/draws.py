"""Random winds inside compiled code: every flight has its own stream of numbers, known from seed and flight alone.

Generator: xoshiro256++ (Blackman and Vigna, 2018; public domain, written from the published recurrence), its four words
filled by SplitMix64 from seed and flight number; 2^256 - 1 states make an overlap of streams a thing that does not
happen. Normal deviates: Wichura's AS 241 (1988), the inverse of the normal distribution to 1e-16.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import compiled, inlined

GIVEN, DRAWN, REPLAYED = range(3)  # where a flight's wind comes from

WEYL = np.uint64(0x9E3779B97F4A7C15)
_MIX_1, _MIX_2 = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_TO_UNIT = 2.0**-53

# AS 241, PPND16: numerator and denominator of the centre, the near tail and the far tail
_CENTRE = (
    (3.3871328727963666080e0, 1.3314166789178437745e2, 1.9715909503065514427e3, 1.3731693765509461125e4,
     4.5921953931549871457e4, 6.7265770927008700853e4, 3.3430575583588128105e4, 2.5090809287301226727e3),
    (1.0, 4.2313330701600911252e1, 6.8718700749205790830e2, 5.3941960214247511077e3,
     2.1213794301586595867e4, 3.9307895800092710610e4, 2.8729085735721942674e4, 5.2264952788528545610e3),
)  # fmt: skip
_NEAR = (
    (1.42343711074968357734e0, 4.63033784615654529590e0, 5.76949722146069140550e0, 3.64784832476320460504e0,
     1.27045825245236838258e0, 2.41780725177450611770e-1, 2.27238449892691845833e-2, 7.74545014278341407640e-4),
    (1.0, 2.05319162663775882187e0, 1.67638483018380384940e0, 6.89767334985100004550e-1,
     1.48103976427480074590e-1, 1.51986665636164571966e-2, 5.47593808499534494600e-4, 1.05075007164441684324e-9),
)  # fmt: skip
_FAR = (
    (6.65790464350110377720e0, 5.46378491116411436990e0, 1.78482653991729133580e0, 2.96560571828504891230e-1,
     2.65321895265761230930e-2, 1.24266094738807843860e-3, 2.71155556874348757815e-5, 2.01033439929228813265e-7),
    (1.0, 5.99832206555887937690e-1, 1.36929880922735805310e-1, 1.48753612908506148525e-2,
     7.86869131145613259100e-4, 1.84631831751005468180e-5, 1.42151175831644588870e-7, 2.04426310338993978564e-15),
)  # fmt: skip


@inlined
def _ratio(x, numerator, denominator):
    p, q = numerator, denominator
    above = p[0] + x * (p[1] + x * (p[2] + x * (p[3] + x * (p[4] + x * (p[5] + x * (p[6] + x * p[7]))))))
    below = q[0] + x * (q[1] + x * (q[2] + x * (q[3] + x * (q[4] + x * (q[5] + x * (q[6] + x * q[7]))))))
    return above / below


@inlined
def _tail_quantile(u):
    """z with Phi(z) = u for |u - 0.5| > 0.425."""
    root = np.sqrt(-np.log(min(u, 1.0 - u)))
    z = _ratio(root - 1.6, *_NEAR) if root <= 5.0 else _ratio(root - 5.0, *_FAR)
    return z if u > 0.5 else -z


@inlined
def _central_quantile(u):
    """The same for |u - 0.5| <= 0.425, without a branch or a transcendental function."""
    q = u - 0.5
    return q * _ratio(0.180625 - q * q, *_CENTRE)


@inlined
def normal_quantile(u):
    """z with Phi(z) = u, 0 < u < 1."""
    return _central_quantile(u) if abs(u - 0.5) <= 0.425 else _tail_quantile(u)


@inlined
def fill_normals(words, u, z):
    """The next normal deviate of every lane into z (lanes); u (lanes) is for scratch. As `normal_quantile`, but
    in loops of which all but the 15 % in the tails become vector code."""
    for i in range(len(z)):
        u[i] = uniform(words, i)
    for i in range(len(z)):
        z[i] = _central_quantile(u[i])
    for i in range(len(z)):
        if abs(u[i] - 0.5) > 0.425:
            z[i] = _tail_quantile(u[i])


@inlined
def _mixed(x):
    x = (x ^ (x >> np.uint64(30))) * _MIX_1
    x = (x ^ (x >> np.uint64(27))) * _MIX_2
    return x ^ (x >> np.uint64(31))


@inlined
def seed_stream(words, lane, seed, flight):
    """Fill column `lane` of words (4, lanes) uint64 with the beginning of a flight's stream."""
    x = _mixed(seed + WEYL) + flight
    x = _mixed(x)
    for j in range(4):
        x += WEYL
        words[j, lane] = _mixed(x)


@inlined
def _turned(x, bits):
    return (x << np.uint64(bits)) | (x >> np.uint64(64 - bits))


@inlined
def uniform(words, lane):
    """The next number of a stream, in (0, 1): never 0 or 1."""
    a, b, c, d = words[0, lane], words[1, lane], words[2, lane], words[3, lane]
    result = _turned(a + d, 23) + a
    t = b << np.uint64(17)
    c ^= a
    d ^= b
    b ^= c
    a ^= d
    c ^= t
    words[0, lane], words[1, lane], words[2, lane], words[3, lane] = a, b, c, _turned(d, 45)
    return (np.float64(result >> np.uint64(12)) + 0.5) * (2.0 * _TO_UNIT)


@inlined
def looked_up(z, first, inverse_step, table):
    """Linear interpolation in a table of equal steps, its ends held outside."""
    x = min(max((z - first) * inverse_step, 0.0), len(table) - 1.000001)
    i = int(x)
    return table[i] + (x - i) * (table[i + 1] - table[i])


@compiled
def normals(seed, flights, count):
    """The first `count` normal deviates (flights, count) of the streams of flights 0, 1, ...: what the kernel draws."""
    words, out = np.empty((4, 1), np.uint64), np.empty((flights, count))
    for i in range(flights):
        seed_stream(words, 0, np.uint64(seed), np.uint64(i))
        for k in range(count):
            out[i, k] = normal_quantile(uniform(words, 0))
    return out
