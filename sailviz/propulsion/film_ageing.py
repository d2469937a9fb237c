"""Films that age in the light, and how warm they are.

What a film has had of sunlight is its dose: seconds, or years, of full sunlight at 1 au. With it the film mirrors
less and its front radiates more, towards an end that a factor says, half of the way for each half dose. The form is
that of Dachwald, Macdonald, McInnes, Mengali and Quarta (J. Spacecraft and Rockets 44, 2007), known here from its
abstract; the equations are written down from memory, and no factor and no half dose here is a measurement: they are
assumptions.

The temperature is that of a thin film in balance: it takes up what its lit side does not mirror and radiates it from
both sides. No heat is kept. Formulas re-derived; the force is (3.18)-(3.20) of the thesis at every dose.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sailviz.compiled import inlined
from sailviz.constants import AU, SOLAR_IRRADIANCE, STEFAN_BOLTZMANN
from sailviz.propulsion.solar_sail import OPTICS, Film

HALF_DOSE = 0.5  # years: an assumption


class Optics(NamedTuple):
    """Of a fresh film, as `Film.from_optics` takes them: reflectivity and its specular share, non-Lambertian
    coefficients and emissivities of front and back."""

    cr: float
    cs: float
    Bf: float
    Bb: float
    ef: float
    eb: float


class Numbers(NamedTuple):
    """A film in compiled code; of the default nothing is known."""

    strength: float = 0.0  # a_c r_E^2 / (b1 + b2 + b3) of the fresh film, m3/s2
    cr: float = 0.0  # the next six: Optics
    cs: float = 0.0
    Bf: float = 0.0
    Bb: float = 0.0
    ef: float = 0.0
    eb: float = 0.0
    factor: float = 0.0  # d: 0 of a film that does not age
    rate: float = 0.0  # ln 2 over the half dose, 1/s
    back: float = -1.0  # reflectivity of the back; negative where it is not known
    heat: float = 0.0  # irradiance over sigma times the square of its distance, K4 m2
    brightness: float = 1.0  # of the light over that of the Sun
    ages: float = 0.0  # 1: the seventh number of the state is its dose, s; 0: it has none
    under_sky: float = 0.0  # 1: the light is where the sky has it, and shaded by its bodies
    level: float = 1.0  # of the thrust, in the phase: the thrust factor over it is what shines


@inlined
def worn(dose, factor, rate):
    """(reflectivity over the fresh one, emissivity of the front over the fresh one) at a dose s; rate 1/s."""
    left = np.exp(-rate * dose)
    return (1.0 + factor * left) / (1.0 + factor), 1.0 + factor * (1.0 - left)


@inlined
def coefficients(cr, cs, Bf, Bb, ef, eb):
    """(b1, b2, b3): (3.18)-(3.20), as `Film.from_optics`."""
    emission = 0.0
    if ef + eb != 0.0:
        emission = (1.0 - cr) * (ef * Bf - eb * Bb) / (ef + eb)
    return 0.5 * (1.0 - cr * cs), cr * cs, 0.5 * (Bf * cr * (1.0 - cs) + emission)


@inlined
def aged_coefficients(dose, film):
    """(b1, b2, b3) of a film of Numbers at a dose, s."""
    kept, gained = worn(dose, film.factor, film.rate)
    return coefficients(kept * film.cr, kept * film.cs, film.Bf, film.Bb, gained * film.ef, film.eb)


@inlined
def balance(c, near, share, dose, film):
    """Temperature, K, of a film of Numbers at a dose, s. c : cosine of the light's angle to the normal, negative where
    it falls on the back; near : one over the distance from the light, 1/m; share : of the light that comes through. 0
    in the dark, and where it falls on a back that is not known."""
    kept, gained = worn(dose, film.factor, film.rate)
    mirrored = kept * film.cr if c > 0.0 else film.back
    radiates = gained * film.ef + film.eb
    if mirrored < 0.0 or radiates <= 0.0:
        return 0.0
    return np.sqrt(np.sqrt(max(film.heat * share * near * near * abs(c) * (1.0 - mirrored) / radiates, 0.0)))


def optics_of(film: str | Optics) -> Optics:
    """Optics by the name of a film of table 3.1, or as they are. KeyError for another name."""
    return Optics(*OPTICS[film]) if isinstance(film, str) else film


def aged_film(film: str | Optics, dose: float, factor: float, half_dose: float = HALF_DOSE) -> Film:
    """The Film that optics become at a dose. dose, half_dose : in the same unit, e.g. years of full sunlight at 1 au;
    a dose may be infinite. Its b3 is computed, not the rounded one of table 3.1."""
    fresh = optics_of(film)
    kept, gained = worn.py_func(np.float64(dose), factor, np.log(2.0) / half_dose)
    aged = fresh._replace(cr=float(kept * fresh.cr), cs=float(kept * fresh.cs), ef=float(gained * fresh.ef))
    return Film.from_optics(*aged)


def temperature(
    distance: npt.ArrayLike,
    pitch: npt.ArrayLike,
    film: str | Optics,
    dose: npt.ArrayLike = 0.0,
    factor: float = 0.0,
    half_dose: float = HALF_DOSE,
    irradiance: float = SOLAR_IRRADIANCE,
) -> np.ndarray:
    """Temperature of a film, K, (n,) or a number, whose front is lit. distance : m from the Sun; pitch : rad, up to
    pi / 2; dose, half_dose : in the same unit; irradiance : W/m2 at 1 au.

    T^4 = (1 - cr) W (r_E / r)^2 cos(alpha) / (sigma (ef + eb)).
    """
    fresh, r = optics_of(film), np.asarray(distance, float)
    kept, gained = worn.py_func(np.asarray(dose, float), factor, np.log(2.0) / half_dose)
    taken = (1 - kept * fresh.cr) * irradiance * (AU / r) ** 2 * np.maximum(np.cos(pitch), 0.0)
    return np.asarray((taken / (STEFAN_BOLTZMANN * (gained * fresh.ef + fresh.eb))) ** 0.25)


def closest_distance(
    hottest: float,
    film: str | Optics,
    pitch: float = 0.0,
    dose: float = 0.0,
    factor: float = 0.0,
    half_dose: float = HALF_DOSE,
    irradiance: float = SOLAR_IRRADIANCE,
) -> float:
    """Distance from the Sun, m, at which a film comes to a temperature, K; the other arguments as of `temperature`."""
    at_1_au = float(temperature(AU, pitch, film, dose, factor, half_dose, irradiance))
    return float(AU * (at_1_au / hottest) ** 2)


def coolness(hottest: float, film: str | Optics, irradiance: float = SOLAR_IRRADIANCE) -> float:
    """Largest cosine of the pitch with which a fresh film stays below a temperature, K, at 1 au; it grows with the
    square of the distance, and is no limit where it is above 1."""
    return float((hottest / float(temperature(AU, 0.0, film, irradiance=irradiance))) ** 4)
