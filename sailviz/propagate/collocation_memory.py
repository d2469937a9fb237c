"""What a step of the collocation keeps, and the tables that it is made with, as compiled code sees them."""

from __future__ import annotations

import numpy as np

from sailviz.compiled import late
from sailviz.propagate.gauss_legendre import tables

POWERS = 10  # of s = 2 x - 1 in the polynomial of a step, x its share that is over

# places in the row of numbers `nodes`, eight numbers each
FORCE = 0  # accelerations x, y, z at the nodes and the mass rate
BEFORE = 32  # of the last step: monomial coefficients in s of the accelerations, the mass rate at the nodes
PLACE = 64  # positions and velocities at the nodes, where the force is evaluated one by one
PARTS = 112  # of the thrust at the nodes: along r_hat and along the normal, as at unit distance; the normal's direction
REST = 152  # what rounding left of position, velocity and mass at the start of the step
MIDDLE, HALF = 160, 161  # of the last step: its middle, s, half of its length, s
HELD = 162  # how many steps are kept: 0, 1, or 2 where the last two are as long as each other
JUMPED = 0.5  # in this place: one is kept, but the thrust has jumped at its end
CLOSEST = 163  # m, least distance from the centre of the last step's nodes
LAST_STEP, LAST_ERROR = 164, 165  # of the last step that was not cut: its length, s, its error over what is bearable
SPAN, SCALE = 166, 167  # s, of the whole run; m, distance from the centre at its start
NODE = 168  # x of the nodes
MASS = 176  # mass and its rate at the nodes
CHANGE = 192  # of the accelerations at the nodes
DENSE = 216  # (SIZE, POWERS) monomial coefficients in s of the last step's polynomial
FOUND = 288  # monomial coefficients in s of accelerations and mass rate of the step that is being made
PAST = 320  # accelerations of the last step but one, and of the last, of each component
PEAK, SINCE = 368, 369  # of steps of one length: the largest error over what is bearable, since which time, s
LENGTH = 376


LANES = "sailviz.propagate.lanes"
aligned_stack, in_one_row = late(LANES, "aligned_stack"), late(LANES, "in_one_row")
load, store, spread, lane = (late(LANES, name) for name in ("load", "store", "spread", "first"))
total, smallest, product_left = (late(LANES, name) for name in ("total", "smallest", "product_left"))
# of two halves, quarters, eighths: the numbers that are added when the sums of several lanes are made at once
first_halves, second_halves = (late(LANES, "taken", *(i + 8 * j + k for j in (0, 1) for i in range(4))) for k in (0, 4))
first_quarters, second_quarters = (
    late(LANES, "taken", *(i + 4 * j + k for j in range(4) for i in (0, 1))) for k in (0, 2)
)
first_eighths, second_eighths = (late(LANES, "taken", *(2 * j + k for j in range(8))) for k in (0, 1))
moved_up = late(LANES, "taken", 3, 4, 5, 8, 8, 8, 8, 8)  # the fourth to sixth of a in the first places, then what b has
half_and_half = late(LANES, "taken", 0, 1, 2, 8, 8, 8, 8, 8)

node = late(LANES, "constant", lambda: tables().node)
end_velocity = late(LANES, "constant", lambda: tables().end_velocity)
end_position = late(LANES, "constant", lambda: tables().end_position)
velocity_sum = late(LANES, "product_with", lambda: tables().velocity)
velocity_sums = late(LANES, "products_with", lambda: tables().velocity)
position_sums = late(LANES, "products_with", lambda: tables().position)
node_left = late(LANES, "constant", lambda: tables().node_left)
end_velocity_left = late(LANES, "constant", lambda: tables().end_velocity_left)
end_position_left = late(LANES, "constant", lambda: tables().end_position_left)
position_sums_left = late(LANES, "products_with", lambda: tables().position_left)
monomials = late(LANES, "product_with", lambda: tables().monomial)
monomials_of_three = late(LANES, "products_with", lambda: tables().monomial)
following = late(LANES, "products_with", lambda: tables().following)
# integrals of s^k, and what makes them begin at s = -1
once = late(LANES, "constant", lambda: 1 / np.arange(1.0, 9.0))
twice = late(LANES, "constant", lambda: 1 / (np.arange(1.0, 9.0) * np.arange(2.0, 10.0)))
once_left = late(LANES, "constant", lambda: (-1.0) ** np.arange(8) / np.arange(1.0, 9.0))
twice_left = late(LANES, "constant", lambda: (-1.0) ** np.arange(8) / (np.arange(1.0, 9.0) * np.arange(2.0, 10.0)))
