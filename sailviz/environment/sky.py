"""The sky in compiled code: where bodies and the light stand, how they pull, and how far they hide the light.

Places come from Chebyshev tables (`sailviz.sky.tables`) and are kept until another time is asked for: gravity, thrust
and steering of one moment share them. They stand in the array of tables from `places.sky` on: the time and the place of
the light, then a row of BODY numbers for each body, then the coefficients.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sailviz.compiled import called, inlined
from sailviz.constants import RADIUS_SUN

CENTRE, TABLED, EVEN, FIXED = range(4)  # where the light is: at the centre, as a body, on a circle, in one direction
TIME, LIGHT, HEAD = 0, 1, 4  # places in the tables: time s, light m, where the rows of the bodies begin
BODY = 10  # numbers of a body's row: mu m3/s2 (0: it does not pull), radius m (0: it casts no shadow), begin s, ...
MU, RADIUS, BEGIN, INVERSE, GRANULES, TERMS, FIRST, X = range(8)  # ... 1 / granule, and the place, m


class Parameters(NamedTuple):
    """Bodies and light of a sky."""

    bodies: int = 0  # that have tables
    light: int = CENTRE
    light_body: int = 0  # which of them, of TABLED
    light_radius: float = RADIUS_SUN  # m
    distance: float = 0.0  # m, of EVEN and FIXED
    longitude: float = 0.0  # rad, of EVEN at the start
    rate: float = 0.0  # rad/s, of EVEN
    towards_x: float = 1.0  # of EVEN where its longitude is 0; of FIXED the direction of the light
    towards_y: float = 0.0
    towards_z: float = 0.0
    ahead_x: float = 0.0  # of EVEN where its longitude is a quarter of a turn
    ahead_y: float = 1.0
    ahead_z: float = 0.0
    shadow: int = 0  # a kind of eclipse, that acts on the device
    moon: int = -1  # which of the bodies is the Moon
    centre_radius: float = 0.0  # m, of the central body where it casts a shadow


class Sides(NamedTuple):
    """What a step keeps to where forces jump; valid while `held.active` is set. See sky_edges."""

    lit: int = 1  # sunlight, of a shadow with a sharp edge
    receding: int = 1  # the craft flies away from the light
    windy: int = 1  # outside the magnetosphere
    facing: int = 1  # the air meets the sail's back; -1: its front, where drag goes by the attitude
    needed: int = 0  # steps keep to edges whatever the tolerance


def packed(bodies):
    """The array of tables of bodies, (k,). bodies : (mu, radius, `sailviz.sky.tables.Table`) of each."""
    first = HEAD + BODY * len(bodies)
    rows, parts = [], []
    for mu, radius, table in bodies:
        granules, terms, _ = table.coefficients.shape
        rows.append([mu, radius, table.begin, 1.0 / table.granule, granules, terms, first, 0.0, 0.0, 0.0])
        parts.append(table.coefficients.ravel())
        first += table.coefficients.size
    return np.concatenate([[np.nan, 0.0, 0.0, 0.0], *rows, *parts])


@inlined
def chebyshev(tables, place, terms, x):
    """Sum of three series at once, [term][x, y, z] from a place on, at x in -1 to 1: Clenshaw's recurrence."""
    twice = 2.0 * x
    a0, a1, a2, b0, b1, b2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    at = place + 3 * (terms - 1)
    for _ in range(terms - 1):
        n0, n1, n2 = tables[at] + twice * a0 - b0, tables[at + 1] + twice * a1 - b1, tables[at + 2] + twice * a2 - b2
        b0, b1, b2, a0, a1, a2 = a0, a1, a2, n0, n1, n2
        at -= 3
    return tables[at] + x * a0 - b0, tables[at + 1] + x * a1 - b1, tables[at + 2] + x * a2 - b2


@called
def set_to(t, at, p, tables):
    """Put every body and the light where they are at t s, in the tables from `at` on; beyond the run, where they are at
    its ends. p : Parameters."""
    if tables[at + TIME] == t:
        return
    for body in range(p.bodies):
        row = at + HEAD + BODY * body
        granules = tables[row + GRANULES]
        u = min(max((t - tables[row + BEGIN]) * tables[row + INVERSE], 0.0), granules)
        granule = min(np.floor(u), granules - 1.0)
        terms = int(tables[row + TERMS])
        place = at + int(tables[row + FIRST]) + int(granule) * terms * 3
        x, y, z = chebyshev(tables, place, terms, 2.0 * (u - granule) - 1.0)
        tables[row + X], tables[row + X + 1], tables[row + X + 2] = x, y, z
    if p.light == TABLED:
        row = at + HEAD + BODY * p.light_body + X
        tables[at + LIGHT], tables[at + LIGHT + 1], tables[at + LIGHT + 2] = (
            tables[row],
            tables[row + 1],
            tables[row + 2],
        )
    elif p.light == EVEN:
        angle = p.longitude + p.rate * t
        c, s = p.distance * np.cos(angle), p.distance * np.sin(angle)
        tables[at + LIGHT] = c * p.towards_x + s * p.ahead_x
        tables[at + LIGHT + 1] = c * p.towards_y + s * p.ahead_y
        tables[at + LIGHT + 2] = c * p.towards_z + s * p.ahead_z
    elif p.light == FIXED:
        d = p.distance
        tables[at + LIGHT], tables[at + LIGHT + 1] = d * p.towards_x, d * p.towards_y
        tables[at + LIGHT + 2] = d * p.towards_z
    tables[at + TIME] = t


@inlined
def from_light(x, y, z, at, tables):
    """Unit vector from the light to a place (m), and 1 / their distance in 1/m; after `set_to`."""
    rx, ry, rz = x - tables[at + LIGHT], y - tables[at + LIGHT + 1], z - tables[at + LIGHT + 2]
    inverse = 1.0 / np.sqrt(rx * rx + ry * ry + rz * rz)
    return rx * inverse, ry * inverse, rz * inverse, inverse


@inlined
def pull(x, y, z, dx, dy, dz, mu):
    """Acceleration, m/s2, relative to the central body at a place (m), by a body at d (m): its pull on the craft less
    that on the central body, mu [(d - r) / |d - r|^3 - d / d^3], in the form that loses no digits close to the centre:
    see `third_body.third_body_gravity`."""
    d2 = dx * dx + dy * dy + dz * dz
    q = (x * (x - 2.0 * dx) + y * (y - 2.0 * dy) + z * (z - 2.0 * dz)) / d2
    s2 = 1.0 + q
    s3 = s2 * np.sqrt(s2)
    f = q * (3.0 + q * (3.0 + q)) / (1.0 + s3)
    k = -mu / (d2 * np.sqrt(d2) * s3)
    return k * (x + f * dx), k * (y + f * dy), k * (z + f * dz)


@inlined
def pulls(x, y, z, at, bodies, tables):
    """The same of all bodies that pull; after `set_to`."""
    ax, ay, az = 0.0, 0.0, 0.0
    for body in range(bodies):
        row = at + HEAD + BODY * body
        mu = tables[row + MU]
        if mu != 0.0:
            bx, by, bz = pull(x, y, z, tables[row + X], tables[row + X + 1], tables[row + X + 2], mu)
            ax, ay, az = ax + bx, ay + by, az + bz
    return ax, ay, az
