"""What events watch of a film, its dose and its temperature, beside the quantities that every sail has.

Callbacks: compiled when the first scene needs them.
"""

from __future__ import annotations

from sailviz.compiled import STATE, called
from sailviz.propagate.callbacks import Callback, callback
from sailviz.propagate.film_callback import temperature_of
from sailviz.propagate.parameters import PARAMETERS, array_at, record_at
from sailviz.propagate.quantity_callback import DOSE, FILM_TEMPERATURE, PITCH, of_craft, of_state
from sailviz.propagate.sky_quantities import under_a_sky


@called
def of_film(number, t, x, y, z, vx, vy, vz, m, factor, p, tables):
    """(value, its size) of a quantity of OF_FILM."""
    if number == DOSE:
        return m, max(m, 1.0)
    held = p.held.active
    p.held.active = 0  # a row is looked up where it is, whatever side the step keeps to
    warm = temperature_of(t, x, y, z, vx, vy, vz, m, factor, p, tables)
    p.held.active = held
    return warm, warm


def _film_alone(time, state, parameters, own, number, out):
    p, y, found = record_at(parameters, PARAMETERS), array_at(state, STATE), array_at(out, 4)
    tables = array_at(p.places.address, p.places.end)
    value, size = of_film(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p, tables)
    found[0], found[1], found[2], found[3] = value, size, 0.0, 0.0


def _of_film(time, state, parameters, own, number, out):
    p, y, found = record_at(parameters, PARAMETERS), array_at(state, STATE), array_at(out, 4)
    tables = array_at(p.places.address, p.places.end)
    if number in (DOSE, FILM_TEMPERATURE):
        value, size = of_film(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p, tables)
    elif number < PITCH:
        value, size = of_state(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p)
    else:
        value, size = of_craft(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p)
    found[0], found[1], found[2], found[3] = value, size, 0.0, 0.0


def _of_film_under_sky(time, state, parameters, own, number, out):
    p, y, found = record_at(parameters, PARAMETERS), array_at(state, STATE), array_at(out, 4)
    tables = array_at(p.places.address, p.places.end)
    if number in (DOSE, FILM_TEMPERATURE):
        value, size = of_film(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p, tables)
    else:
        value, size = under_a_sky(number, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], p, tables)
    found[0], found[1], found[2], found[3] = value, size, 0.0, 0.0


def film_quantities(alone: bool, under_sky: bool) -> Callback:
    """Whatever is watched where a film's dose or temperature is, for `dynamics.model`. alone : nothing else is watched,
    for which far less has to be compiled."""
    if alone:
        return callback(_film_alone)
    return callback(_of_film_under_sky if under_sky else _of_film)
