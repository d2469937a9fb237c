"""The Coulomb drag of a tether."""

from __future__ import annotations

import numpy as np
from independent.constants import CHARGE, EPSILON, MU_EARTH, body
from independent.low_orbit import place, plasma_table, solar_flux, spin_of_earth, sunlit
from scipy.optimize import brentq


def brake(scene):
    """Coulomb drag of a charged tether: Janhunen's law, or the electric sail's for a positive one."""
    craft, profile, radius = scene.device, scene.environment.ionosphere, body(scene)[1]
    assert scene.environment.magnetic_sensitivity == 0
    law = scene.steering.kind if scene.steering else "vertical"
    full = abs(craft.voltage)
    table = density_factor = None
    if profile.kind == "iri-2020":
        table, density_factor = plasma_table(), profile.density_factor
    limited = craft.power is not None or craft.eclipse != "on"

    def plasma(t, r):
        """(density, ion mass)."""
        if table is not None:
            n, mass = np.exp(table(place(scene, t, r))[:3]), table(place(scene, t, r))[3:]
            levels, flux = [70.0, 145.0, 193.0], solar_flux(scene, t)
            return density_factor * np.exp(np.interp(flux, levels, np.log(n))), np.interp(flux, levels, mass)
        fade = np.exp((profile.reference_altitude - (np.linalg.norm(r) - radius)) / profile.scale_height)
        return profile.density * fade, profile.ion_mass

    def per_length(n, m, speed, voltage):
        if voltage <= m * speed**2 / (2 * CHARGE):
            return 0.0
        if craft.polarity == "positive":
            return 0.18 * (voltage - m * speed**2 / (2 * CHARGE)) * np.sqrt(EPSILON * m * n * speed**2)
        sheath = np.sqrt(EPSILON * voltage / (CHARGE * n))
        v_t = voltage / np.log(sheath / craft.wire_radius)
        thickness = np.sqrt(EPSILON * v_t / (CHARGE * n))
        return 3.864 * m * n * speed**2 * thickness * np.exp(-m * speed**2 / (2 * CHARGE * v_t))

    def voltage_at(t, r, n, m, speed):
        lit = not limited or sunlit(scene, t, r)
        available = craft.power if lit else {"on": craft.power, "off": 0, "limited": craft.eclipse_power}[craft.eclipse]
        if available is None:
            return full
        assert craft.polarity == "negative"

        def excess(voltage):
            rate = np.sqrt(2 * CHARGE * voltage / m + speed**2)
            return (
                voltage * CHARGE * n * craft.wire_diameter * craft.tether_length * rate / craft.efficiency - available
            )

        return full if excess(full) <= 0 else brentq(excess, 0.0, full, xtol=1e-12, rtol=1e-14)

    def push(t, r, v, mass):
        up = r / np.linalg.norm(r)
        u = v - np.cross(spin_of_earth(scene), r)
        level = u - (u @ up) * up
        if profile.kind == "exponential-force":
            height = np.linalg.norm(r) - radius
            f = profile.force_per_length * np.exp((profile.reference_altitude - height) / profile.scale_height)
            return -craft.tether_length * f / mass * level / np.linalg.norm(level), 0.0
        n, m = plasma(t, r)
        voltage = voltage_at(t, r, n, m, np.linalg.norm(u))
        if law == "spinning":  # in the plane of motion: the mean of |sin|^3; about the velocity: all of it
            share = 4 / (3 * np.pi) if scene.steering.plane == "along-track" else 1.0
            return -share * craft.tether_length * per_length(
                n, m, np.linalg.norm(u), voltage
            ) / mass * u / np.linalg.norm(u), 0.0
        along = up
        if law == "gravity-gradient":  # moments about the hinge: drag of the hanging tether against 3 n^2 sin cos
            ahead = level / np.linalg.norm(level)
            force = craft.tether_length * per_length(n, m, np.linalg.norm(level), voltage)
            tether = craft.tether_mass if craft.tether_mass is not None else 11e-6 * craft.tether_length
            rate2 = MU_EARTH / np.linalg.norm(r) ** 3
            lean = np.arctan(force / (6 * rate2 * (craft.tip_mass + tether / 3) * craft.tether_length))
            along = np.cos(lean) * up + np.sin(lean) * ahead
        across = u - (u @ along) * along
        speed = np.linalg.norm(across)
        return -craft.tether_length * per_length(n, m, speed, voltage) / mass * across / speed, 0.0

    return push
