"""What rounding takes of a step: sums and products to twice the precision, by error-free transformations.

Steps of one length err by the same each time, so what tables, products and sums lose adds up over a year in low orbit
to 1e-8 of the radius; what a table lacks at the nodes alone, not fed back into the path, to 2e-9.

Source of the transformations: Ogita, Rump, Oishi, Accurate Sum and Dot Product, SIAM J. Sci. Comput. 26 (2005), which
was not read; both are re-derived: a sum of two numbers lacks a number, a product is exact in a fused multiply-add.
"""

from __future__ import annotations

from sailviz.compiled import inlined
from sailviz.propagate.collocation_memory import (
    CHANGE,
    PLACE,
    REST,
    end_position,
    end_position_left,
    end_velocity,
    end_velocity_left,
    first_eighths,
    first_halves,
    first_quarters,
    half_and_half,
    load,
    moved_up,
    node,
    node_left,
    product_left,
    second_eighths,
    second_halves,
    second_quarters,
    spread,
)
from sailviz.propagate.stepping import Y


@inlined
def two_sum(a, b):
    """The sum and what rounding takes from it."""
    s = a + b
    d = s - a
    return s, (a - (s - d)) + (b - d)


@inlined
def rounded_away(nodes, work, h, component, x, bend, bend_left):
    """What the positions x at the nodes lack by the rounding of tables, products and sums. bend : the sums,
    bend_left : what these lack by the rounding of their table."""
    place, speed = work[Y, component], work[Y, 3 + component]
    hc, h2 = h * node(), h * h
    straight, bent = hc * speed, h2 * bend
    first, e1 = two_sum(spread(place), straight)
    second, e2 = two_sum(first, bent)
    lost = product_left(hc, speed, straight) + product_left(node(), h, hc) * speed
    lost = lost + (product_left(bend, h2, bent) + product_left(h, h, h2) * bend)
    tables_lost = h * (node_left() * speed + h * bend_left)
    before = nodes[REST + component] + hc * nodes[REST + 3 + component]
    return ((second - x) + (e1 + e2 + lost)) + (tables_lost + before)


@inlined
def with_left(table, table_left, f, f_left):
    """(table f, what it lacks), given what the factors lack."""
    p = table * f
    return p, product_left(table, f, p) + (table_left * f + table * f_left)


@inlined
def halved(a, b, a_left, b_left):
    """The sums of halves of two lanes, side by side, and what they lack."""
    s, e = two_sum(first_halves(a, b), second_halves(a, b))
    return s, (first_halves(a_left, b_left) + second_halves(a_left, b_left)) + e


@inlined
def exact_end(nodes, h, y):
    """The state (8,) at the end of the step, of position and velocity, and what it lacks, to twice the precision."""
    h2, none = h * h, spread(0.0)
    fx, fy, fz = load(nodes, PLACE), load(nodes, PLACE + 8), load(nodes, PLACE + 16)
    gx, gy, gz = load(nodes, CHANGE), load(nodes, CHANGE + 8), load(nodes, CHANGE + 16)
    bx, cx = with_left(end_position(), end_position_left(), fx, gx)
    by, cy = with_left(end_position(), end_position_left(), fy, gy)
    bz, cz = with_left(end_position(), end_position_left(), fz, gz)
    px, qx = with_left(end_velocity(), end_velocity_left(), fx, gx)
    py, qy = with_left(end_velocity(), end_velocity_left(), fy, gy)
    pz, qz = with_left(end_velocity(), end_velocity_left(), fz, gz)
    a, a_left = halved(bx, by, cx, cy)
    b, b_left = halved(bz, px, cz, qx)
    c, c_left = halved(py, pz, qy, qz)
    a, e = two_sum(first_quarters(a, b), second_quarters(a, b))
    a_left = (first_quarters(a_left, b_left) + second_quarters(a_left, b_left)) + e
    c, e = two_sum(first_quarters(c, none), second_quarters(c, none))
    c_left = (first_quarters(c_left, none) + second_quarters(c_left, none)) + e
    sums, e = two_sum(first_eighths(a, c), second_eighths(a, c))
    sums_left = (first_eighths(a_left, c_left) + second_eighths(a_left, c_left)) + e
    # of positions h^2, of velocities h: h is a number without rounding, its square is not
    scale = half_and_half(spread(h2), spread(h))
    scale_left = half_and_half(spread(product_left(h, h, h2)), none)
    begin, rest = load(y, 0), load(nodes, REST)
    speed = moved_up(begin, none)
    straight, bent = h * speed, scale * sums
    left = product_left(h, speed, straight) + product_left(scale, sums, bent) + scale_left * sums
    left = left + (scale * sums_left + (rest + h * moved_up(rest, none)))
    end, e = two_sum(begin, straight)
    end, more = two_sum(end, bent)
    return two_sum(end, left + (e + more))
