"""Tables of the collocation on the eight Gauss-Legendre nodes of a step, computed to fifty digits when asked for.

A step is x in [0, 1]; s = 2 x - 1 runs over [-1, 1], where the polynomials of an interpolation are well conditioned.
Source of the method: Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I (1993), section II.7; the
tables are derived here from the nodes, which are the zeros of the Legendre polynomial.
"""

from __future__ import annotations

from decimal import Decimal, localcontext
from functools import cache
from typing import NamedTuple

import numpy as np

NODES = 8
DIGITS = 50
FITTED = 13  # degree of the polynomial that continues two steps

Polynomial = list[Decimal]  # coefficients, the constant first


class Tables(NamedTuple):
    """Accelerations a (8,) at the nodes, times these, give what a step needs; lengths in units of the step."""

    node: np.ndarray  # (8,) x of the nodes
    velocity: np.ndarray  # (8, 8) velocity at the nodes: velocity @ a, less that at the start
    position: np.ndarray  # (8, 8) position at the nodes: position @ a, less that of a straight flight
    end_velocity: np.ndarray  # (8,) the same at the end of the step
    end_position: np.ndarray  # (8,)
    monomial: np.ndarray  # (8, 8) coefficients in s of the polynomial through a: monomial @ a
    following: np.ndarray  # (8, 16) a of the next step from those of the last two, the older first, all as long
    # what the doubles above lack
    node_left: np.ndarray
    position_left: np.ndarray
    end_velocity_left: np.ndarray
    end_position_left: np.ndarray


@cache
def tables() -> Tables:
    """The tables, rounded to doubles once."""
    with localcontext() as context:
        context.prec = DIGITS
        nodes = _nodes()
        one = Decimal(1)
        basis = [_through(nodes, j) for j in range(NODES)]
        once = [_integral(p) for p in basis]
        twice = [_integral(p) for p in once]
        node = [(s + 1) / 2 for s in nodes]
        position = [[_value(p, s) / 4 for p in twice] for s in nodes]
        end_velocity, end_position = [_value(p, one) / 2 for p in once], [_value(p, one) / 4 for p in twice]
        return Tables(
            node=_rounded(node),
            velocity=_rounded([[_value(p, s) / 2 for p in once] for s in nodes]),
            position=_rounded(position),
            end_velocity=_rounded(end_velocity),
            end_position=_rounded(end_position),
            monomial=_rounded([[p[k] for p in basis] for k in range(NODES)]),
            following=_rounded(_following(node)),
            node_left=_left(node),
            position_left=np.array([_left(row) for row in position]),
            end_velocity_left=_left(end_velocity),
            end_position_left=_left(end_position),
        )


def _nodes() -> list[Decimal]:
    p = _legendre(NODES)
    slope = [k * c for k, c in enumerate(p)][1:]
    nodes = []
    for start in np.polynomial.legendre.leggauss(NODES)[0]:
        s = Decimal(float(start))
        for _ in range(3):  # Newton: 15, 30, 60 digits
            s -= _value(p, s) / _value(slope, s)
        nodes.append(s)
    return nodes


def _through(nodes: list[Decimal], j: int) -> Polynomial:
    """The polynomial that is 1 at the node j and 0 at the others."""
    p = [Decimal(1)]
    for i, node in enumerate(nodes):
        if i != j:
            p = [c / (nodes[j] - node) for c in _product(p, [-node, Decimal(1)])]
    return p


def _legendre(degree: int) -> Polynomial:
    before, p = [Decimal(1)], [Decimal(0), Decimal(1)]
    for k in range(2, degree + 1):
        following = [(2 * k - 1) * c / k for c in [Decimal(0), *p]]
        for i, c in enumerate(before):
            following[i] -= (k - 1) * c / k
        before, p = p, following
    return p


def _following(node: list[Decimal]) -> list[list[Decimal]]:
    """Values at 2 + node of the polynomial of degree FITTED that is closest to values at node and 1 + node.

    Through all sixteen it would make rounding 6e10 times larger."""
    old, new = [*node, *(x + 1 for x in node)], [x + 2 for x in node]
    rows = [[Decimal(0)] * len(old) for _ in new]
    # polynomials that are orthogonal over the old nodes, by their recurrence of three terms
    before, here, size_before = [Decimal(0)] * len(old), [Decimal(1)] * len(old), Decimal(1)
    ahead_before, ahead = [Decimal(0)] * len(new), [Decimal(1)] * len(new)
    for _ in range(FITTED + 1):
        size = sum((p * p for p in here), Decimal(0))
        for row, value in zip(rows, ahead, strict=True):
            for j, p in enumerate(here):
                row[j] += value * p / size
        centre = sum((x * p * p for x, p in zip(old, here, strict=True)), Decimal(0)) / size
        ratio = size / size_before
        before, here = here, [(x - centre) * p - ratio * q for x, p, q in zip(old, here, before, strict=True)]
        further = [(x - centre) * p - ratio * q for x, p, q in zip(new, ahead, ahead_before, strict=True)]
        ahead_before, ahead = ahead, further
        size_before = size
    return rows


def _product(p: Polynomial, q: Polynomial) -> Polynomial:
    out = [Decimal(0)] * (len(p) + len(q) - 1)
    for i, a in enumerate(p):
        for j, b in enumerate(q):
            out[i + j] += a * b
    return out


def _integral(p: Polynomial) -> Polynomial:
    """That from -1 on."""
    whole = [Decimal(0)] + [c / (k + 1) for k, c in enumerate(p)]
    whole[0] = -_value(whole, Decimal(-1))
    return whole


def _value(p: Polynomial, s: Decimal) -> Decimal:
    value = Decimal(0)
    for c in reversed(p):
        value = value * s + c
    return value


def _rounded(values: list[Decimal] | list[list[Decimal]]) -> np.ndarray:
    return np.array(values, dtype=float)


def _left(values: list[Decimal]) -> np.ndarray:
    return np.array([float(value - Decimal(float(value))) for value in values])
