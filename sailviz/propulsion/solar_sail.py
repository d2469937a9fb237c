"""Solar radiation pressure on a flat sail: ideal, imperfectly reflecting and optical films.

Source: thesis, section 3.2, (3.2)-(3.23), read in excerpt; coefficients of the named films from its table 3.1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sailviz.compiled import entry, inlined
from sailviz.constants import AU, GRAVITY_AT_1_AU, RADIATION_PRESSURE
from sailviz.propulsion.rows import as_rows


class Parameters(NamedTuple):
    """A solar sail in compiled code."""

    strength: float  # a_c r_E^2 / (b1 + b2 + b3), m3/s2
    b1: float
    b2: float
    b3: float


@dataclass(frozen=True)
class Film:
    """Force coefficients of a film: b1 along the sunlight, b2 and b3 along the normal; efficiency scales all of them.

    acceleration = (a_c / (b1 + b2 + b3)) (r_E / r)^2 cos(alpha) [b1 r_hat + (b2 cos(alpha) + b3) n_hat]  (3.17), (3.23)
    """

    b1: float
    b2: float
    b3: float
    efficiency: float = 1.0

    @classmethod
    def from_optics(cls, cr: float, cs: float, Bf: float, Bb: float, ef: float, eb: float) -> Film:
        """Film from optical properties: reflectivity cr, specular share cs, non-Lambertian coefficients Bf and Bb,
        emissivities ef and eb of front and back. (3.18)-(3.20)"""
        emission = 0.0 if ef + eb == 0 else (1 - cr) * (ef * Bf - eb * Bb) / (ef + eb)
        b1 = (1 - cr * cs) / 2  # (3.18)
        b2 = cr * cs  # (3.19)
        b3 = (Bf * cr * (1 - cs) + emission) / 2  # (3.20)
        return cls(b1, b2, b3)

    @property
    def total(self) -> float:
        """b1 + b2 + b3, 1 for an ideal film."""
        return self.b1 + self.b2 + self.b3

    def characteristic_acceleration(
        self,
        *,
        lightness: float | None = None,
        area: float | None = None,
        mass: float | None = None,
        pressure: float = RADIATION_PRESSURE,
    ) -> float:
        """a_c in m/s2 at 1 au, facing the Sun, from the lightness number or from area m2 and mass kg in a radiation
        pressure N/m2 at 1 au, the thesis' 4.563e-6 by default.

        (3.3), (3.5), (3.13), (3.22). For an imperfect film of given efficiency the lightness number is that of the
        ideal film of the same loading, as in (3.12). ValueError for a size that is no positive number.
        """
        if lightness is not None:
            return self.efficiency * lightness * GRAVITY_AT_1_AU
        if area is None or mass is None:
            raise TypeError("a characteristic acceleration takes a lightness number, or an area and a mass")
        for name, size in (("area", area), ("mass", mass), ("pressure", pressure)):
            if isinstance(size, complex) or not 0 < size < np.inf:
                raise ValueError(f"the {name} must be a positive number, not {size!r}")
        return self.efficiency * 2 * pressure * (area / mass) * self.total

    def lightness(self, characteristic_acceleration: float) -> float:
        """Lightness number beta of a_c in m/s2: (3.3), (3.13), (3.22)."""
        return characteristic_acceleration / (self.efficiency * GRAVITY_AT_1_AU)

    def components(self, pitch: npt.ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Radial and transverse force factors at a pitch in rad: a_r = a_c (r_E/r)^2 k_r, a_t = a_c (r_E/r)^2 k_t.

        k_r = (b1 c + b2 c^3 + b3 c^2) / total, k_t = (b2 c^2 s + b3 c s) / total: (3.21) resolved along r_hat and
        t_hat. Zero where the sail shows its back to the Sun.
        """
        c, s = np.cos(pitch), np.sin(pitch)
        lit = c > 0
        k_r = np.where(lit, (self.b1 * c + self.b2 * c**3 + self.b3 * c**2) / self.total, 0.0)
        k_t = np.where(lit, (self.b2 * c**2 * s + self.b3 * c * s) / self.total, 0.0)
        return k_r, k_t


FILMS = {
    "ideal": Film(0.0, 1.0, 0.0),
    "eta-perfect": Film(0.0, 1.0, 0.0, efficiency=0.85),  # (3.12), the thesis' value
    "jpl-1978": Film(0.0864, 0.8272, -0.0055),  # table 3.1 as printed
    "jpl-2015": Film(0.0723, 0.8554, -0.0030),  # table 3.1 as printed
}


# table 3.1: cr, cs, Bf, Bb, ef, eb of the front
OPTICS = {
    "ideal": (1.0, 1.0, 2 / 3, 2 / 3, 0.0, 0.0),
    "jpl-1978": (0.88, 0.94, 0.79, 0.55, 0.05, 0.55),
    "jpl-2015": (0.91, 0.94, 0.79, 0.67, 0.025, 0.27),
}


def black_back(optics: tuple[float, float, float, float, float, float]) -> Film:
    """The back of a film, given the optics of its front, where it mirrors nothing, cr = 0: (3.18)-(3.20) with the roles
    of front and back swapped. Of the backs of the named films table 3.1 says no more than eb and Bb."""
    _, _, Bf, Bb, ef, eb = optics
    return Film.from_optics(0.0, 0.0, Bb, Bf, eb, ef)


def film(name: str) -> Film:
    """A film by name: "ideal", "eta-perfect", "jpl-1978" or "jpl-2015". KeyError for another name."""
    return FILMS[name]


@inlined
def sail_force(ux, uy, uz, inverse, nx, ny, nz, c, strength, b1, b2, b3):
    """Acceleration of an optical film. u = r_hat, inverse = 1/r in 1/m, c = u . n;
    strength = a_c r_E^2 / (b1 + b2 + b3), m3/s2. (3.17), (3.23)"""
    along_light, along_normal = sail_parts(c, strength * inverse * inverse, b1, b2, b3)
    return (
        along_light * ux + along_normal * nx,
        along_light * uy + along_normal * ny,
        along_light * uz + along_normal * nz,
    )


@inlined
def sail_parts(c, q, b1, b2, b3):
    """What `sail_force` has along the sunlight and along the normal; q is its strength over the distance's square."""
    if c <= 0.0:  # the back of the sail: the models describe the front only
        return 0.0, 0.0
    q = q * c
    return q * b1, q * (b2 * c + b3)


@entry("d2 d2 d d d d D2")
def _accelerations(position, normal, strength, b1, b2, b3, out):
    for i in range(len(position)):
        x, y, z = position[i, 0], position[i, 1], position[i, 2]
        nx, ny, nz = normal[i, 0], normal[i, 1], normal[i, 2]
        r = np.sqrt(x * x + y * y + z * z)
        out[i, 0], out[i, 1], out[i, 2] = sail_force(
            x / r, y / r, z / r, 1 / r, nx, ny, nz, (x * nx + y * ny + z * nz) / r, strength, b1, b2, b3
        )
    return 0


def acceleration(
    position: npt.ArrayLike, normal: npt.ArrayLike, characteristic_acceleration: float, film: Film | str = "ideal"
) -> np.ndarray:
    """Acceleration of a solar sail, m/s2, (3,) or (n, 3) as the input.

    position : (..., 3) m from the Sun. normal : (..., 3) unit vector away from the Sun; a sail turned backwards
    (cos(alpha) <= 0) feels nothing. characteristic_acceleration : m/s2 at 1 au facing the Sun.
    film : a Film or the name of one. Source: (3.17), (3.23); ideal (3.2), imperfect (3.12).
    """
    film = FILMS[film] if isinstance(film, str) else film
    (position, normal), shape = as_rows(position, normal)
    strength = characteristic_acceleration * AU**2 / film.total
    out = np.empty_like(position)
    _accelerations(position, normal, strength, film.b1, film.b2, film.b3, out)
    return out.reshape(shape)
