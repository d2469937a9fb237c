"""Temperature of the hottest facet of a shape's films, in the attitude that the craft has: as its steering holds it, or
as it has turned. Of a spin that is averaged over, that of the hottest facet in a turn: a thin film follows in seconds.

Rows are observed here, and events watch here what else they watch of such a craft. Callbacks: compiled when the first
scene needs them.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import STATE, called, entry
from sailviz.propagate.body_motion import AVERAGED, WORK, Q, Y, body_of
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.dynamics import direction
from sailviz.propagate.film_callback import light_at
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propagate.quantity_callback import DOSE, FILM_TEMPERATURE, PITCH, of_craft, of_state
from sailviz.propagate.shape_callback import rolled_axes
from sailviz.propagate.sky_quantities import under_a_sky
from sailviz.propulsion.rigid_body import axes_of
from sailviz.propulsion.shaped_heat import COS, SIN, warmest

AZIMUTHS = 64  # of a turn in which the hottest facet is looked for


@called
def warmest_of_a_turn(ux, uy, uz, zx, zy, zz, dose, p, tables):
    """`warmest` over a turn about an axis z, for light along u, both in space."""
    size = 1.0 / np.sqrt(zx * zx + zy * zy + zz * zz)
    axial, most = (ux * zx + uy * zy + uz * zz) * size, 0.0
    across = np.sqrt(max(0.0, 1.0 - axial * axial))
    for i in range(AZIMUTHS):
        a = 2.0 * np.pi * i / AZIMUTHS
        found = warmest(across * np.cos(a), across * np.sin(a), axial, dose, p.film, tables, p.places.heat)
        if found < 0.0:
            return found
        most = max(most, found)
    return most


@called
def hottest_facet(t, x, y, z, vx, vy, vz, m, factor, q1, q2, q3, q4, p, tables):
    """Temperature, K; 0 in the dark, of a sail that is stowed or off, and where light falls on a back that is not
    known. q : the quaternion of a craft that turns, its axis where that is averaged over a spin; not read of others."""
    ux, uy, uz, near, share = light_at(t, x, y, z, p, tables)
    shines, dose = factor / p.film.level * share, m if p.film.ages != 0.0 else 0.0
    if shines <= 0.0:
        return 0.0
    if p.places.body != 0:
        if body_of(p).motion == AVERAGED:
            found = warmest_of_a_turn(ux, uy, uz, q1, q2, q3, dose, p, tables)
            return np.sqrt(np.sqrt(max(p.film.heat * shines * near * near * found, 0.0)))
        ex, ey, ez, gx, gy, gz, nx, ny, nz = axes_of(q1, q2, q3, q4)
    else:
        inverse = 1.0 / np.sqrt(x * x + y * y + z * z)
        nx, ny, nz, _, throttle = direction(t, x, y, z, vx, vy, vz, m, x * inverse, y * inverse, z * inverse, p)
        if throttle == 0.0 or nx * nx + ny * ny + nz * nz == 0.0:
            return 0.0
        c, s = tables[p.places.heat + COS], tables[p.places.heat + SIN]
        ex, ey, ez, gx, gy, gz = rolled_axes(x, y, z, vx, vy, vz, nx, ny, nz, c, s)
    found = warmest(
        ux * ex + uy * ey + uz * ez, ux * gx + uy * gy + uz * gz, ux * nx + uy * ny + uz * nz,
        dose, p.film, tables, p.places.heat,
    )  # fmt: skip
    return np.sqrt(np.sqrt(max(p.film.heat * shines * near * near * found, 0.0)))


def observe_heat(time: np.ndarray, states: np.ndarray, factor: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    """Temperature (n,), K, as `hottest_facet`. time (n,), states (7, n) or those of a craft that turns, factor (n,) of
    the thrust."""
    out = np.zeros(len(time))
    _observe(time, np.ascontiguousarray(states), factor, parameters, out)
    return out


@entry("d1 d2 d1 r1 D1", PARAMETERS)
def _observe(time, states, factor, parameters, out):
    """`observe_heat` into zeros."""
    p = parameters[0]
    tables = array_at(p.places.address, p.places.end)
    for i in range(len(time)):
        q1, q2, q3, q4 = 0.0, 0.0, 0.0, 1.0
        if p.places.body != 0:
            q1, q2, q3, q4 = states[Q, i], states[Q + 1, i], states[Q + 2, i], states[Q + 3, i]
        out[i] = hottest_facet(
            time[i], states[0, i], states[1, i], states[2, i], states[3, i], states[4, i], states[5, i], states[6, i],
            factor[i], q1, q2, q3, q4, p, tables,
        )  # fmt: skip
    return 0


@called
def watched(number, t, x, y, z, vx, vy, vz, m, factor, p, tables):
    """(value, its size) of the dose or the temperature; a craft that turns stands as `body_motion.point_normal` has
    left it."""
    if number == DOSE:
        return m, max(m, 1.0)
    q1, q2, q3, q4 = 0.0, 0.0, 0.0, 1.0
    if p.places.body != 0:
        k = p.places.body + WORK + Y + Q
        q1, q2, q3, q4 = tables[k], tables[k + 1], tables[k + 2], tables[k + 3]
    held = p.held.active
    p.held.active = 0  # a row is looked up where it is, whatever side the step keeps to
    warm = hottest_facet(t, x, y, z, vx, vy, vz, m, factor, q1, q2, q3, q4, p, tables)
    p.held.active = held
    return warm, warm


def _alone(time, state, parameters, own, number, out):
    p, y, found = record_at(parameters, PARAMETERS), array_at(state, STATE), array_at(out, 4)
    tables = array_at(p.places.address, p.places.end)
    value, size = watched(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p, tables)
    found[0], found[1], found[2], found[3] = value, size, 0.0, 0.0


def _with_others(time, state, parameters, own, number, out):
    p, y, found = record_at(parameters, PARAMETERS), array_at(state, STATE), array_at(out, 4)
    tables = array_at(p.places.address, p.places.end)
    if number in (DOSE, FILM_TEMPERATURE):
        value, size = watched(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p, tables)
    elif number < PITCH:
        value, size = of_state(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p)
    else:
        value, size = of_craft(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p)
    found[0], found[1], found[2], found[3] = value, size, 0.0, 0.0


def _under_sky(time, state, parameters, own, number, out):
    p, y, found = record_at(parameters, PARAMETERS), array_at(state, STATE), array_at(out, 4)
    tables = array_at(p.places.address, p.places.end)
    if number in (DOSE, FILM_TEMPERATURE):
        value, size = watched(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p, tables)
    else:
        value, size = under_a_sky(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p, tables)
    found[0], found[1], found[2], found[3] = value, size, 0.0, 0.0


def shape_heat_quantities(alone: bool, under_sky: bool) -> Callback:
    """Whatever is watched where the dose or the temperature of a shape's film is, for `dynamics.model`; as
    `film_quantities`."""
    if alone:
        return callback(_alone)
    return callback(_under_sky if under_sky else _with_others)
