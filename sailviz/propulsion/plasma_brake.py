"""Coulomb drag on a charged tether in the ionosphere.

Force law after Janhunen, Ann. Geophys. 32, 1207 (2014); its form and its constant 3.864 were reconstructed and
checked against the abstract (0.43 mN on 5 km), its text was not read. Current: orbital-motion-limited theory of a
thin cylinder.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from sailviz.compiled import inlined
from sailviz.constants import BOLTZMANN, ELEMENTARY_CHARGE, MASS_ELECTRON, VACUUM_PERMITTIVITY

PHOTOELECTRONS = 40e-6  # A/m2 of lit wire, the order for metals in sunlight at 1 au; from memory
MULTI_WIRE = 1.1e-5  # kg/m: 55 g on 5 km, Janhunen, Ann. Geophys. 32, 1207 (2014), abstract
ALUMINIUM = 2700.0  # kg/m3

NEGATIVE, POSITIVE = 0, 1  # polarities
VERTICAL, TILTED, SPINNING = range(3)  # attitudes of the tether


class Parameters(NamedTuple):
    """A plasma brake in compiled code."""

    length: float  # m
    voltage: float  # V, its size
    wire_radius: float  # m, effective electric radius
    polarity: int = NEGATIVE
    attitude: int = VERTICAL
    wire_diameter: float = 0.0  # m, of all wires together
    efficiency: float = 1.0  # of the high-voltage supply
    power: float = np.inf  # W, available in sunlight; inf for no limit
    eclipse_power: float = np.inf  # W, available in the shadow
    tip_mass: float = 0.0  # kg, mass at the tip and a third of the tether's
    spin_factor: float = 1.0  # mean force of a spinning tether over that of one across the flow
    magnetic_sensitivity: float = 0.0  # share of the force that is lost where the tether lies along the magnetic field
    earth_angle: float = 0.0  # rad, rotation angle of the Earth at the start
    present: int = 1  # 0 in a record without a brake


def force_per_length(
    density: npt.ArrayLike,
    ion_mass: npt.ArrayLike,
    speed: npt.ArrayLike,
    voltage: npt.ArrayLike,
    wire_radius: float = 1e-3,
    polarity: str = "negative",
) -> np.ndarray:
    """Drag per length of tether, N/m; scalars or arrays, broadcast.

    density : ions, 1/m3. ion_mass : mean, kg. speed : m/s, relative to the plasma and perpendicular to the tether.
    voltage : V, absolute value. wire_radius : m, effective electric radius of the multi-wire tether.
    polarity : "negative" (plasma brake) or "positive" (the E-sail's law, the ion ram energy in place of V_w, (3.41)).
    Valid for voltage far above the ram energy (4.7 V for oxygen in low orbit) and a sheath much wider than the tether;
    NaN where ln(sheath / wire_radius) is not above 1; no force where there is no plasma. The sheath width uses |V0|,
    not |V0| - V_i: 0.02 % of the force.
    """
    density, ion_mass, speed, voltage = np.broadcast_arrays(
        *(np.asarray(x, dtype=float) for x in (density, ion_mass, speed, voltage))
    )
    ram_pressure = ion_mass * density * speed**2
    ram_energy = ion_mass * speed**2 / (2 * ELEMENTARY_CHARGE)
    if polarity == "positive":
        return 0.18 * np.maximum(0.0, voltage - ram_energy) * np.sqrt(VACUUM_PERMITTIVITY * ram_pressure)
    if polarity != "negative":
        raise ValueError(f'polarity is "negative" or "positive", not {polarity!r}')
    plasma = np.where(density > 0.0, density, np.nan)
    sheath = np.sqrt(VACUUM_PERMITTIVITY * voltage / (ELEMENTARY_CHARGE * plasma))
    log = np.log(sheath / wire_radius)
    v_t = voltage / np.where(log > 1, log, np.nan)
    width = np.sqrt(VACUUM_PERMITTIVITY * v_t / (ELEMENTARY_CHARGE * plasma))
    return np.where(density == 0.0, 0.0, 3.864 * ram_pressure * width * np.exp(-ram_energy / v_t))


@inlined
def negative_force_per_length(density, ion_mass, speed, voltage, wire_radius):
    """`force_per_length` for scalars inside the propagator, negative polarity; NaN outside its range as there."""
    if density <= 0.0:
        return 0.0
    ram_pressure = ion_mass * density * speed * speed
    ram_energy = ion_mass * speed * speed / (2 * ELEMENTARY_CHARGE)
    sheath = np.sqrt(VACUUM_PERMITTIVITY * voltage / (ELEMENTARY_CHARGE * density))
    log = np.log(sheath / wire_radius)
    v_t = voltage / log if log > 1.0 else np.nan
    width = np.sqrt(VACUUM_PERMITTIVITY * v_t / (ELEMENTARY_CHARGE * density))
    return 3.864 * ram_pressure * width * np.exp(-ram_energy / v_t)


@inlined
def positive_force_per_length(density, ion_mass, speed, voltage):
    """`force_per_length` for scalars inside the propagator, positive polarity."""
    ram_energy = ion_mass * speed * speed / (2 * ELEMENTARY_CHARGE)
    return 0.18 * max(0.0, voltage - ram_energy) * np.sqrt(VACUUM_PERMITTIVITY * ion_mass * density) * speed


def species_force_per_length(
    densities: npt.ArrayLike,
    ion_masses: npt.ArrayLike,
    speed: npt.ArrayLike,
    voltage: npt.ArrayLike,
    wire_radius: float = 1e-3,
) -> np.ndarray:
    """Drag per length of a negative tether in several ion species, N/m: each has its own ram pressure and ram energy,
    all share one sheath. No force where there is no plasma.

    densities : (..., k) 1/m3, ion_masses : (k,) kg; the others as in `force_per_length`, of the shape (...). The mean
    ion mass instead differs by at most 2.1 % anywhere in IRI-2020 from 200 to 1500 km.
    """
    densities, ion_masses = np.asarray(densities, dtype=float), np.asarray(ion_masses, dtype=float)
    speed, voltage = (np.asarray(x, dtype=float) for x in (speed, voltage))
    empty = densities.sum(axis=-1) == 0.0
    total = np.where(empty, np.nan, densities.sum(axis=-1))
    sheath = np.sqrt(VACUUM_PERMITTIVITY * voltage / (ELEMENTARY_CHARGE * total))
    log = np.log(sheath / wire_radius)
    v_t = voltage / np.where(log > 1, log, np.nan)
    ram_energy = ion_masses * speed[..., None] ** 2 / (2 * ELEMENTARY_CHARGE)
    each = densities * ion_masses * np.exp(-ram_energy / v_t[..., None])
    width = np.sqrt(VACUUM_PERMITTIVITY * v_t / (ELEMENTARY_CHARGE * total))
    return np.where(empty, 0.0, 3.864 * speed**2 * width * each.sum(axis=-1))


def magnetic_factor(angle: npt.ArrayLike, reduction: float = 0.0) -> np.ndarray:
    """Share of the drag that is left at an angle in rad between tether and magnetic field: 1 - q cos^2(angle).

    An assumption of ours: the abstract of Janhunen 2014 says that a field along the tether reduces the thrust "by a
    modest factor", and its value was not readable. reduction : q; off by default, 0.3 for a look at the sensitivity.
    """
    return 1 - reduction * np.cos(angle) ** 2


def current(
    density: npt.ArrayLike,
    ion_mass: npt.ArrayLike,
    speed: npt.ArrayLike,
    voltage: npt.ArrayLike,
    length: npt.ArrayLike,
    wire_diameter: npt.ArrayLike,
    polarity: str = "negative",
    secondary_yield: npt.ArrayLike = 0.0,
    photoemission: npt.ArrayLike = 0.0,
) -> np.ndarray:
    """Current that the tether collects, A; scalars or arrays.

    density 1/m3, ion_mass kg, speed m/s, voltage V (absolute), length m, wire_diameter m (sum over the wires of a
    multi-wire tether, geometric). Ions for a negative tether, electrons for a positive one. Source:
    orbital-motion-limited cylinder, dI/dz = e n D sqrt(2 e V / m + v^2), from memory of the textbook form.
    secondary_yield : electrons that an impinging ion knocks out of a negative tether; photoemission : A/m2 of its lit
    cross section, D L, PHOTOELECTRONS in sunlight. Both add to the current of a negative tether; a positive one draws
    its slow electrons back.
    """
    density, mass, speed, voltage, length, wire_diameter, secondary, photo = (
        np.asarray(x, dtype=float)
        for x in (density, ion_mass, speed, voltage, length, wire_diameter, secondary_yield, photoemission)
    )
    carrier = {"negative": mass, "positive": np.asarray(MASS_ELECTRON)}[polarity]
    ram = speed**2 if polarity == "negative" else 0.0
    rate = np.sqrt(2 * ELEMENTARY_CHARGE * voltage / carrier + ram)
    collected = ELEMENTARY_CHARGE * density * wire_diameter * length * rate
    if polarity == "positive":
        return collected
    return collected * (1 + secondary) + photo * wire_diameter * length


@inlined
def tether_current(density, ion_mass, speed, voltage, length, wire_diameter, positive):
    """`current` for scalars inside the propagator, without secondary and photoelectrons; positive is 0 for a negative
    tether."""
    rate = 2 * ELEMENTARY_CHARGE * voltage / ion_mass + speed * speed
    if positive != 0.0:
        rate = 2 * ELEMENTARY_CHARGE * voltage / MASS_ELECTRON
    return ELEMENTARY_CHARGE * density * wire_diameter * length * np.sqrt(rate)


def power(
    density: npt.ArrayLike,
    ion_mass: npt.ArrayLike,
    speed: npt.ArrayLike,
    voltage: npt.ArrayLike,
    length: npt.ArrayLike,
    wire_diameter: npt.ArrayLike,
    efficiency: npt.ArrayLike = 1.0,
    polarity: str = "negative",
    secondary_yield: npt.ArrayLike = 0.0,
    photoemission: npt.ArrayLike = 0.0,
) -> np.ndarray:
    """Power of the high-voltage supply, W: voltage times `current` over its efficiency. Same arguments."""
    drawn = current(density, ion_mass, speed, voltage, length, wire_diameter, polarity, secondary_yield, photoemission)
    return np.asarray(voltage, dtype=float) * drawn / efficiency


def electron_flux(density: npt.ArrayLike, electron_temperature: npt.ArrayLike) -> np.ndarray:
    """Current density of electrons at rest that meets a surface at the plasma's potential, A/m2: e n sqrt(T / (2 pi
    m_e)), temperature in eV. The body of the craft closes the tether's circuit with it: current / electron_flux is the
    area it needs."""
    thermal = np.sqrt(ELEMENTARY_CHARGE * np.asarray(electron_temperature, dtype=float) / (2 * np.pi * MASS_ELECTRON))
    return np.multiply(ELEMENTARY_CHARGE, density) * thermal


def power_limited_voltage(
    nominal_voltage: npt.ArrayLike, nominal_power: npt.ArrayLike, available_power: npt.ArrayLike
) -> np.ndarray:
    """Voltage in V that the available power sustains, at most the nominal one: V_nom (P / P_nom)^(2/3), since the
    power of an orbital-motion-limited tether goes with V^1.5. nominal_power : W at nominal_voltage in V. The ram speed
    in the current is neglected: 0.2 % of the power at 1 kV."""
    share = np.asarray(available_power, dtype=float) / nominal_power
    return np.multiply(nominal_voltage, np.clip(share, 0.0, 1.0) ** (2 / 3))


def wire_mass(
    diameter: npt.ArrayLike, wires: npt.ArrayLike = 1, material_density: npt.ArrayLike = ALUMINIUM
) -> np.ndarray:
    """Mass per length of bare wires, kg/m: diameter in m, density in kg/m3. One 50 um aluminium wire: 5.301e-6."""
    area = np.multiply(wires, np.pi / 4) * np.asarray(diameter, dtype=float) ** 2
    return area * np.asarray(material_density, dtype=float)


def tether_mass(length: npt.ArrayLike, mass_per_length: npt.ArrayLike = MULTI_WIRE) -> np.ndarray:
    """Mass of a tether in kg: length in m, mass_per_length in kg/m, that of a published multi-wire tether unless
    given."""
    return np.asarray(length, dtype=float) * mass_per_length


@inlined
def tether_tilt(force, orbital_rate, tip_mass, mass, length):
    """`tilt` for scalars inside the propagator."""
    return np.arctan2(force, 6.0 * orbital_rate * orbital_rate * (tip_mass + mass / 3.0) * length)


def tilt(
    force: npt.ArrayLike,
    orbital_rate: npt.ArrayLike,
    tip_mass: npt.ArrayLike,
    mass: npt.ArrayLike,
    length: npt.ArrayLike,
) -> np.ndarray:
    """Angle in rad by which the drag tilts a hanging tether from the vertical, in the orbit plane: tan = F / (6 n^2
    (m_tip + m / 3) L), hinged at a heavy body.

    force : N, what the whole tether would feel if it hung straight down. orbital_rate : rad/s of the orbit. tip_mass,
    mass of the tether : kg. length : m. Rigid; the drag is across the tether and goes with cos^2 of the tilt, the
    gravity gradient 3 n^2 with sin cos. A tilt of tens of degrees says that such a tether must spin. Re-derived.
    """
    n = np.asarray(orbital_rate, dtype=float)
    masses = np.asarray(tip_mass, dtype=float) + np.asarray(mass, dtype=float) / 3
    return np.arctan2(force, 6 * n**2 * masses * np.asarray(length, dtype=float))


def tip_tension(orbital_rate: npt.ArrayLike, tip_mass: npt.ArrayLike, length: npt.ArrayLike) -> np.ndarray:
    """Tension in N that the gravity gradient of a tip mass in kg keeps in a hanging tether: 3 n^2 m L."""
    return 3 * np.asarray(orbital_rate, dtype=float) ** 2 * np.multiply(tip_mass, length)


def spin_factor(angle: npt.ArrayLike = 0.0) -> np.ndarray:
    """Mean braking of a spinning tether over that of one across the flow, for an angle in rad between the velocity and
    the spin plane: mean of (1 - cos^2(angle) cos^2(phase))^(3/2), drag going with the square of the speed across.

    4 / (3 pi) = 0.4244 with the velocity in the spin plane, 1 with it along the axis. Scalars or arrays. Re-derived.
    """
    nodes, weights = np.polynomial.legendre.leggauss(40)
    phase = np.pi / 4 * (nodes + 1)  # a quarter turn stands for all
    across = 1 - (np.cos(np.asarray(angle, dtype=float))[..., None] * np.cos(phase)) ** 2
    return np.maximum(across, 0.0) ** 1.5 @ weights / 2


REASONS = {
    "energetic": "the voltage must be far above the ions' ram energy: 20 times",
    "wide_sheath": "ln(sheath / wire radius) must exceed 1",
    "supersonic": "the flow must be faster than the ions' thermal speed: 4 times; hydrogen fails it above 1000 km",
    "slender": "the sheath must be much narrower than the tether is long: a tenth",
    "high": "below 250 km molecular ions and neutral drag take over",
    "tabled": "above 1500 km there is no ionosphere table",
}


@dataclass(frozen=True)
class Validity:
    """Where the force law holds: one bool (or array) for each assumption, named as in REASONS."""

    energetic: np.ndarray
    wide_sheath: np.ndarray
    supersonic: np.ndarray
    slender: np.ndarray
    high: np.ndarray
    tabled: np.ndarray

    @property
    def all(self) -> np.ndarray:
        """Whether every assumption holds."""
        return np.logical_and.reduce([getattr(self, name) for name in REASONS])[()]

    def broken(self) -> list[str]:
        """Sentences of the assumptions that fail anywhere."""
        return [sentence for name, sentence in REASONS.items() if not np.all(getattr(self, name))]


def validity(
    density: npt.ArrayLike,
    ion_mass: npt.ArrayLike,
    speed: npt.ArrayLike,
    voltage: npt.ArrayLike,
    length: npt.ArrayLike = np.inf,
    altitude: npt.ArrayLike = 500e3,
    wire_radius: npt.ArrayLike = 1e-3,
    ion_temperature: npt.ArrayLike = 1000.0,
) -> Validity:
    """Which assumptions of the force law hold; arguments as in `force_per_length`, broadcast.

    length : m of tether. altitude : m. ion_temperature : K. The assumptions are those of the law; the factors that
    stand for "far" and "much" are ours. Thermal speed : sqrt(2 k T / m), 1.0 km/s for oxygen, 4.1 for hydrogen at
    1000 K.
    """
    density, ion_mass, speed, voltage, length, altitude, temperature = np.broadcast_arrays(
        *(np.asarray(x, dtype=float) for x in (density, ion_mass, speed, voltage, length, altitude, ion_temperature))
    )
    with np.errstate(divide="ignore"):  # without plasma the sheath is as wide as can be
        sheath = np.sqrt(VACUUM_PERMITTIVITY * voltage / (ELEMENTARY_CHARGE * density))
    flags = (
        voltage >= 20 * ion_mass * speed**2 / (2 * ELEMENTARY_CHARGE),
        np.log(sheath / wire_radius) > 1,
        speed >= 4 * np.sqrt(2 * BOLTZMANN * temperature / ion_mass),
        sheath <= length / 10,
        altitude >= 250e3,
        altitude <= 1500e3,
    )
    return Validity(*(flag[()] for flag in flags))
