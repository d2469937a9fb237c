"""Light on a film that ages: the force of what it has become, and its dose, which the state carries in its seventh
place, where other crafts have their mass.

A device's callback: compiled when the first scene needs it. Its numbers: `p.film`. What a row shows of a film, whether
it ages or not, is observed here too.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import STATE, called, entry
from sailviz.constants import AU
from sailviz.environment import sky
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.dynamics import direction
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propagate.sky_callback import sunlit_share
from sailviz.propulsion.film_ageing import aged_coefficients, balance
from sailviz.propulsion.solar_sail import sail_force

AU2 = AU * AU
DOSE, TEMPERATURE, B1, B2, B3, COLUMNS = 0, 1, 2, 3, 4, 5  # of `observe_film`


@called
def light_at(t, x, y, z, p, tables):
    """(direction in which the light travels, one over the distance from it, 1/m, share of it that comes through)."""
    near = 1.0 / np.sqrt(x * x + y * y + z * z)
    ux, uy, uz, share = x * near, y * near, z * near, 1.0
    if p.film.under_sky != 0.0:
        sky.set_to(t, p.places.sky, p.sky, tables)
        ux, uy, uz, near = sky.from_light(x, y, z, p.places.sky, tables)
        share = sunlit_share(x, y, z, p, tables)
    return ux, uy, uz, near, share


def _thrust(time, state, parameters, own, number, out):
    """Acceleration, m/s2, and the rate of the dose, s of full sunlight at 1 au for each s."""
    p = record_at(parameters, PARAMETERS)
    y, tables, a = array_at(state, STATE), array_at(p.places.address, p.places.end), array_at(out, 4)
    a[0], a[1], a[2], a[3] = 0.0, 0.0, 0.0, 0.0
    ux, uy, uz, near, share = light_at(time, y[0], y[1], y[2], p, tables)
    nx, ny, nz = y[7], y[8], y[9]
    c = ux * nx + uy * ny + uz * nz
    if share > 0.0 and c > 0.0:
        film = p.film
        b1, b2, b3 = aged_coefficients(y[6], film)
        k = number * share * film.strength
        a[0], a[1], a[2] = sail_force(ux, uy, uz, near, nx, ny, nz, c, k, b1, b2, b3)
        a[3] = number / film.level * share * film.brightness * AU2 * near * near * c


def film_thrust() -> Callback:
    """A flat sail whose film ages."""
    return callback(_thrust)


@called
def temperature_of(t, x, y, z, vx, vy, vz, m, factor, p, tables):
    """Temperature, K, of the film; 0 in the dark and of a sail that is stowed or switched off."""
    ux, uy, uz, near, share = light_at(t, x, y, z, p, tables)
    inverse = 1.0 / np.sqrt(x * x + y * y + z * z)
    nx, ny, nz, _, throttle = direction(t, x, y, z, vx, vy, vz, m, x * inverse, y * inverse, z * inverse, p)
    shines = factor / p.film.level * share
    if throttle == 0.0 or shines <= 0.0:
        return 0.0
    return balance(ux * nx + uy * ny + uz * nz, near, shines, m if p.film.ages != 0.0 else 0.0, p.film)


def observe_film(time: np.ndarray, states: np.ndarray, factor: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    """What rows show of a film: (COLUMNS, n) dose s, temperature K, b1, b2, b3. time (n,), states (7, n), their last
    the dose where it ages, factor (n,) of the thrust."""
    out = np.zeros((COLUMNS, len(time)))
    _observe(time, states, factor, parameters, out)
    return out


@entry("d1 d2 d1 r1 D2", PARAMETERS)
def _observe(time, states, factor, parameters, out):
    """`observe_film` into zeros."""
    p = parameters[0]
    tables = array_at(p.places.address, p.places.end)
    for i in range(len(time)):
        x, y, z, vx, vy, vz = states[0, i], states[1, i], states[2, i], states[3, i], states[4, i], states[5, i]
        m = states[6, i]
        out[DOSE, i] = m if p.film.ages != 0.0 else 0.0
        out[TEMPERATURE, i] = temperature_of(time[i], x, y, z, vx, vy, vz, m, factor[i], p, tables)
        out[B1, i], out[B2, i], out[B3, i] = aged_coefficients(out[DOSE, i], p.film)
    return 0
