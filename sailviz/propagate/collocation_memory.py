"""What a step of the collocation keeps, and the tables that it is made with, as compiled code sees them."""

from __future__ import annotations

import numpy as np

from sailviz.compiled import late
from sailviz.propagate.gauss_legendre import tables

POWERS = 10  # of s = 2 x - 1 in the polynomial of a step, x its share that is over

# places in the row of numbers `nodes`, eight numbers each
FORCE = 0  # accelerations x, y, z at the nodes and the mass rate
BEFORE = 32  # of the last step: monomial coefficients in s of the same
PLACE = 64  # positions and velocities at the nodes, where the force is evaluated one by one
PARTS = 112  # of the thrust at the nodes: along r_hat and along the normal, as at unit distance; the normal's direction
REST = 152  # what rounding left of position, velocity and mass at the start of the step
MIDDLE, HALF, HELD = 160, 161, 162  # of the last step: its middle, s, half of its length, s; whether there is one
CLOSEST = 163  # m, least distance from the centre of the last step's nodes
LAST_STEP, LAST_ERROR = 164, 165  # of the last step that was not cut: its length, s, its error over what is bearable
SPAN, SCALE = 166, 167  # s, of the whole run; m, distance from the centre at its start
NODE = 168  # x of the nodes
MASS = 176  # mass and its rate at the nodes
CHANGE = 192  # of the accelerations at the nodes
DENSE = 216  # (SIZE, POWERS) monomial coefficients in s of the last step's polynomial
LENGTH = 288


LANES = "sailviz.propagate.lanes"
load, store, spread, lane = (late(LANES, name) for name in ("load", "store", "spread", "first"))
total, smallest, product_left = (late(LANES, name) for name in ("total", "smallest", "product_left"))
across_4, across_2, across_1 = (late(LANES, "swapped", distance) for distance in (4, 2, 1))

node = late(LANES, "constant", lambda: tables().node)
end_velocity = late(LANES, "constant", lambda: tables().end_velocity)
end_position = late(LANES, "constant", lambda: tables().end_position)
second, highest = (late(LANES, "constant", lambda k=k: tables().highest[k]) for k in (0, 1))
velocity_sum = late(LANES, "product_with", lambda: tables().velocity)
position_sum = late(LANES, "product_with", lambda: tables().position)
node_left = late(LANES, "constant", lambda: tables().node_left)
end_velocity_left = late(LANES, "constant", lambda: tables().end_velocity_left)
end_position_left = late(LANES, "constant", lambda: tables().end_position_left)
position_sum_left = late(LANES, "product_with", lambda: tables().position_left)
monomials = late(LANES, "product_with", lambda: tables().monomial)
# integrals of s^k, and what makes them begin at s = -1
once = late(LANES, "constant", lambda: 1 / np.arange(1.0, 9.0))
twice = late(LANES, "constant", lambda: 1 / (np.arange(1.0, 9.0) * np.arange(2.0, 10.0)))
once_left = late(LANES, "constant", lambda: (-1.0) ** np.arange(8) / np.arange(1.0, 9.0))
twice_left = late(LANES, "constant", lambda: (-1.0) ** np.arange(8) / (np.arange(1.0, 9.0) * np.arange(2.0, 10.0)))
