"""Coulomb drag on a charged tether in the ionosphere.

Force law after Janhunen, Ann. Geophys. 32, 1207 (2014); its form and its constant 3.864 were reconstructed and
checked against the abstract (0.43 mN on 5 km), its text was not read. Current: orbital-motion-limited theory of a
thin cylinder.
"""

from __future__ import annotations

import numpy as np

from sailviz.compiled import inlined
from sailviz.constants import ELEMENTARY_CHARGE, MASS_ELECTRON, VACUUM_PERMITTIVITY


def force_per_length(density, ion_mass, speed, voltage, wire_radius=1e-3, polarity="negative"):
    """Drag per length of tether, N/m; scalars or arrays, broadcast.

    density : ions, 1/m3. ion_mass : mean, kg. speed : m/s, relative to the plasma and perpendicular to the tether.
    voltage : V, absolute value. wire_radius : m, effective electric radius of the multi-wire tether.
    polarity : "negative" (plasma brake) or "positive" (the E-sail's law, the ion ram energy in place of V_w, (3.41)).
    Valid for voltage far above the ram energy (4.7 V for oxygen in low orbit) and a sheath much wider than the tether;
    NaN where ln(sheath / wire_radius) is not above 1. The sheath width uses |V0|, not |V0| - V_i: 0.02 % of the force.
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
    sheath = np.sqrt(VACUUM_PERMITTIVITY * voltage / (ELEMENTARY_CHARGE * density))
    log = np.log(sheath / wire_radius)
    v_t = voltage / np.where(log > 1, log, np.nan)
    width = np.sqrt(VACUUM_PERMITTIVITY * v_t / (ELEMENTARY_CHARGE * density))
    return 3.864 * ram_pressure * width * np.exp(-ram_energy / v_t)


@inlined
def negative_force_per_length(density, ion_mass, speed, voltage, wire_radius):
    """`force_per_length` for scalars inside the propagator, negative polarity; NaN outside its range as there."""
    ram_pressure = ion_mass * density * speed * speed
    ram_energy = ion_mass * speed * speed / (2 * ELEMENTARY_CHARGE)
    sheath = np.sqrt(VACUUM_PERMITTIVITY * voltage / (ELEMENTARY_CHARGE * density))
    log = np.log(sheath / wire_radius)
    v_t = voltage / log if log > 1.0 else np.nan
    width = np.sqrt(VACUUM_PERMITTIVITY * v_t / (ELEMENTARY_CHARGE * density))
    return 3.864 * ram_pressure * width * np.exp(-ram_energy / v_t)


def current(density, ion_mass, speed, voltage, length, wire_diameter, polarity="negative"):
    """Current that the tether collects, A; scalars or arrays.

    density 1/m3, ion_mass kg, speed m/s, voltage V (absolute), length m, wire_diameter m (sum over the wires of a
    multi-wire tether, geometric). Ions for a negative tether, electrons for a positive one. Source:
    orbital-motion-limited cylinder, dI/dz = e n D sqrt(2 e V / m + v^2), from memory of the textbook form.
    """
    carrier = {"negative": ion_mass, "positive": MASS_ELECTRON}[polarity]
    ram = np.asarray(speed, dtype=float) ** 2 if polarity == "negative" else 0.0
    rate = np.sqrt(2 * ELEMENTARY_CHARGE * np.asarray(voltage, dtype=float) / carrier + ram)
    return ELEMENTARY_CHARGE * density * wire_diameter * length * rate


def power(density, ion_mass, speed, voltage, length, wire_diameter, efficiency=1.0, polarity="negative"):
    """Power of the high-voltage supply, W: voltage times `current` over its efficiency. Same arguments."""
    drawn = current(density, ion_mass, speed, voltage, length, wire_diameter, polarity)
    return np.asarray(voltage, dtype=float) * drawn / efficiency
