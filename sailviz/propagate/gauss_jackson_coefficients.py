"""Coefficients of the summed Gauss-Jackson (Stoermer-Cowell) and Adams methods, exactly from generating functions.

With the backward difference D = 1 - E^-1 and a step h, h d/dt = -ln(1 - D). So the predictors are
r(n+1) = h^2 (sum2(n) + sigma_2 a + sigma_3 D a + ...) and v(n+1) = h (sum1(n) + gamma_1 a + gamma_2 D a + ...) with
sum gamma_j x^j = -x / ((1 - x) ln(1 - x)) and sum sigma_j x^j = x^2 / ((1 - x) ln(1 - x)^2); the correctors at n + 1
lack the factor 1 / (1 - x). Re-derived; a textbook matter, from memory in Henrici, Discrete Variable Methods in
Ordinary Differential Equations (1962), chapters 5 and 6.

The sums are formed over the accelerations themselves, with large alternating ordinate coefficients c_i. Those of the
position's corrector must not be rounded one by one: errors of 1e-14 in them push along the track and cost 1e-7 of the
radius in a year. So its difference coefficients are rounded to multiples of 2^-q, for which every c_i is exact, and
what that leaves of the first two is added back.
"""

from __future__ import annotations

from fractions import Fraction
from math import ceil, comb, log2

LAGS = 15  # accelerations behind a step; 14 needs 10 % shorter steps for the same error, 16 is unstable at 80 a turn


def _series(n):
    """First n coefficients of x / -ln(1 - x) and of its square."""
    once = [Fraction(1)]
    for i in range(1, n):
        once.append(-sum(once[i - j] / (j + 1) for j in range(1, i + 1)))
    return once, [sum(once[j] * once[i - j] for j in range(i + 1)) for i in range(n)]


def _running(series):
    """Multiplied by 1 / (1 - x)."""
    return [sum(series[: i + 1]) for i in range(len(series))]


def _ordinates(differences):
    """sum_j d_j D^j a(n) as coefficients of a(n), a(n-1), ..."""
    n = len(differences)
    return [sum(differences[j] * (-1) ** i * comb(j, i) for j in range(i, n)) for i in range(n)]


def _rounded(differences):
    """(ordinate coefficients that are exact doubles, difference coefficients that those leave out)."""
    exact = _ordinates(differences)
    bits = 52 - ceil(log2(max(abs(float(c)) for c in exact)))
    near = [Fraction(round(d * 2**bits), 2**bits) for d in differences]
    return tuple(float(c) for c in _ordinates(near)), [d - e for d, e in zip(differences, near, strict=True)]


_MOULTON, _COWELL = _series(LAGS + 2)
_BASHFORTH, _STOERMER = _running(_MOULTON), _running(_COWELL)

POSITION = tuple(float(c) for c in _ordinates(_STOERMER[2 : 2 + LAGS]))
VELOCITY = tuple(float(c) for c in _ordinates(_BASHFORTH[1 : 1 + LAGS]))
EXTRAPOLATION = tuple(float(c) for c in _ordinates([Fraction(1)] * LAGS))  # of the acceleration itself: binomials

# The corrector of the position: the coefficient of the new acceleration, those of the others, and what the rounding of
# these leaves out, to be added through the new acceleration and the one before. The velocity's is its predictor plus
# VELOCITY_CORRECTION times what the acceleration is above its extrapolation.
_corrector, _left = _rounded(_COWELL[2 : 2 + LAGS])
POSITION_NEW, POSITION_OTHERS = _corrector[0], (*_corrector[1:], 0.0)
POSITION_NEW_LEFT, POSITION_SECOND_LEFT = float(_left[0] + _left[1]), float(-_left[1])
VELOCITY_CORRECTION = float(_BASHFORTH[LAGS])

# to begin the sums: the corrector at the middle of the LAGS accelerations, where its coefficients are below 1/10 and
# rounding does no harm
MIDDLE = LAGS // 2


def _at_middle(series):
    """Ordinate coefficients of the series of differences of a(n - MIDDLE), through the accelerations up to a(n)."""
    back = [(-1) ** i * comb(MIDDLE, i) for i in range(MIDDLE + 1)]  # (1 - x)^MIDDLE
    shifted = [sum(back[i] * series[j - i] for i in range(min(j, MIDDLE) + 1)) for j in range(LAGS)]
    return tuple(float(c) for c in _ordinates(shifted))


POSITION_START = _at_middle(_COWELL[2 : 2 + LAGS])
VELOCITY_START = _at_middle(_MOULTON[1 : 1 + LAGS])
