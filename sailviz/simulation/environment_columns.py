"""What acted on a craft in each row of a run: the columns of its environment, unit in each name."""

from __future__ import annotations

import numpy as np

from sailviz import elements as orbital
from sailviz import ephemeris
from sailviz.constants import ATOMIC_MASS, J2_EARTH, RADIUS_EARTH
from sailviz.propagate import dynamics
from sailviz.propagate import low_orbit_callback as seen
from sailviz.propagate import parameters as row
from sailviz.propagate import voltage_callback as control_plug
from sailviz.propagate.primer_callback import observe_primer
from sailviz.propulsion.plasma_brake import validity
from sailviz.simulation.bodies import epoch_of
from sailviz.simulation.low_orbit import watches_shadow
from sailviz.simulation.plan import Plan
from sailviz.steering import attitude as law


def observe(p: Plan, time, states, factor):
    """(normal (n, 3), acceleration (n, 3) m/s2, throttle (n,), columns of the environment) of a run. time (n,) s,
    states (7, n), factor (n,) the thrust factor of each row."""
    normal, acceleration, throttle = dynamics.observe(time, states, factor, p.model)
    columns = {}
    if p.model.steering in (law.PRIMER, law.LOCAL, law.LYAPUNOV):
        columns["primer_direction"], support = observe_primer(time, states, p.model.parameters)
        columns["switching_function"] = support  # thrust that the law expects along the primer, share of the full one
    if p.body.name == "Earth":
        values = seen.observe_low_orbit(time, states, factor, p.model.parameters)
        columns = low_orbit_columns(p, time, states, values)
        if p.model.device == dynamics.PLASMA_BRAKE:
            force = values[seen.FORCE_X : seen.FORCE_X + 3]
            acceleration = acceleration + (factor / states[6] * force).T
            normal = values[seen.TETHER_X : seen.TETHER_X + 3].T.copy()
    return normal, acceleration, throttle, columns


def voltages(model) -> np.ndarray:
    """Voltages (k,) V that a run's controller has set at its breaks, so far."""
    p = model.parameters
    first = int(p[row.CONTROL_TABLE])
    last = int(p[row.CONTROL_LAW])
    return p[first:last].reshape(-1, control_plug.COLUMNS)[:, control_plug.VOLTAGE]


def low_orbit_columns(p: Plan, time, states, values) -> dict[str, np.ndarray]:
    """Columns (n,) of a run round the Earth from the values of `observe_low_orbit`."""
    scene, around = p.scene, p.scene.environment
    position, velocity = states[:3].T, states[3:6].T
    oblateness = J2_EARTH * RADIUS_EARTH**2 if around.j2 else 0.0
    axis = orbital.mean_semi_major_axis(position, velocity, p.body.mu, oblateness)
    columns = {"mean_altitude_m": axis - p.body.radius}
    if p.quasi_circular is not None:
        columns["quasi_circular_altitude_m"] = p.quasi_circular.altitude(time)
    if scene.epoch is not None:
        columns["earth_rotation_rad"] = ephemeris.greenwich_sidereal_time(epoch_of(scene), time)
    if watches_shadow(scene):
        columns["sunlit"] = values[seen.LIGHT] > 0.5
    if around.solar_flux is not None:
        columns["solar_flux_sfu"] = values[seen.SOLAR_FLUX]
    if around.atmosphere is not None:
        columns["air_density_kg_m3"] = values[seen.AIR_DENSITY]
        columns["air_drag_N"] = values[seen.AIR_DRAG]
    if scene.device.kind == "plasma-brake":
        columns |= _brake_columns(scene, values, velocity)
    if around.height_above == "ellipsoid":
        columns["altitude_over_ellipsoid_m"] = values[seen.ALTITUDE]
    return columns


def _brake_columns(scene, values, velocity):
    columns = {"plasma_force_N_m": values[seen.FORCE]}
    if scene.environment.ionosphere.kind == "exponential-force":
        return columns
    density, ion_mass, voltage = values[seen.PLASMA_DENSITY], values[seen.ION_MASS], values[seen.VOLTAGE]
    columns |= {
        "plasma_density_per_m3": density,
        "mean_ion_mass_u": ion_mass / ATOMIC_MASS,
        "tether_voltage_V": voltage if scene.device.polarity == "positive" else 0.0 - voltage,  # never -0
        "tether_current_A": values[seen.CURRENT],
        "tether_power_W": values[seen.POWER],
    }
    if scene.steering is not None and scene.steering.kind == "gravity-gradient":
        columns["tether_tilt_rad"] = values[seen.TILT]
    device, speed = scene.device, np.linalg.norm(velocity, axis=1)
    holds = validity(
        density, ion_mass, speed, abs(device.voltage), device.tether_length, values[seen.ALTITUDE], device.wire_radius
    )
    columns["force_law_valid"] = np.asarray(holds.all)
    return columns
