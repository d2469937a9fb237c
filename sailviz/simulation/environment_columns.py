"""What acted on a craft in each row of a run: the columns of its environment, unit in each name."""

from __future__ import annotations

import numpy as np

from sailviz import elements as orbital
from sailviz import ephemeris, frames
from sailviz.constants import AU, J2_EARTH, RADIUS_EARTH
from sailviz.environment import magnetosphere
from sailviz.environment.eclipse import CONE, NO_SHADOW
from sailviz.environment.sky import CENTRE
from sailviz.propagate import dynamics, sky_callback, voltage_callback
from sailviz.propagate import low_orbit_callback as low_orbit
from sailviz.scene.device import SolarSail
from sailviz.scene.film import ages
from sailviz.scene.sky import shadow_kind
from sailviz.simulation.bodies import epoch_of
from sailviz.simulation.device import device_of, radiation_pressure, sail_strength
from sailviz.simulation.environment import parts_of, watches_shadow
from sailviz.simulation.lowered import Array, Columns, Place
from sailviz.simulation.plan import Plan
from sailviz.simulation.sky import body_places
from sailviz.simulation.steering import steering_of
from sailviz.simulation.turned_rows import Turned
from sailviz.steering import attitude


def observe(
    p: Plan, time: Array, states: Array, factor: Array, turned: Turned | None = None
) -> tuple[Array, Array, Array, Columns]:
    """(normal (n, 3), acceleration (n, 3) m/s2, throttle (n,), columns of the environment) of a run. time (n,) s,
    states (7, n), factor (n,) the thrust factor of each row; turned : what a craft that turns did."""
    states = np.ascontiguousarray(states)
    if turned is None:
        normal, acceleration, throttle = dynamics.observe(time, states, factor, p.model)
    else:
        normal, acceleration, throttle = turned.axes[..., 2].copy(), turned.acceleration, np.ones(len(time))
    columns: Columns = {}
    if p.model.steering != attitude.USER and turned is None:
        columns |= steering_of(p.scene.steering).watches(p.model, time, states)
    place = Place(p.scene, p.body, epoch_of(p.scene))
    for part, record in parts_of(p.scene):
        columns |= record.columns(part, place, time, states)
    if p.body.name == "Earth":
        values = low_orbit.observe_low_orbit(time, states, factor, p.model.parameters)
        columns |= low_orbit_columns(p, time, states, values)
        pull = device_of(p.scene).pull
        if pull is not None:
            normal, more = pull(values, states, factor)
            acceleration = acceleration + more
    if p.sky is not None:
        columns |= sky_columns(p, time, states, normal)
    columns |= push_along_primer(p, states, acceleration, columns)
    return normal, acceleration, throttle, columns


def sky_columns(p: Plan, time: Array, states: Array, normal: Array) -> Columns:
    """Columns (n,) of a run under a sky: how far light and Moon are, and what of light and wind comes through."""
    assert p.sky is not None
    values, named = sky_callback.observe_sky(time, states, normal, p.model.parameters), p.model.named
    columns: Columns = {}
    if named.sky.light != CENTRE:
        columns["sun_distance_m"] = values[sky_callback.DISTANCE]
    moon = body_places(p.sky, time).get("Moon")
    if moon is not None:
        columns["moon_distance_m"] = np.linalg.norm(states[:3].T - moon, axis=1)
    if named.sky.shadow != NO_SHADOW:
        columns["sunlit"] = values[sky_callback.SHARE] > 0.5
        if named.sky.shadow == CONE:
            columns["sunlit_fraction"] = values[sky_callback.SHARE]
    if named.magnetosphere.kind != magnetosphere.NONE:
        columns["in_solar_wind"] = values[sky_callback.WIND] > 0.5
    if named.pushed.blown == 1:  # what air does to a craft that turns, its own columns say
        from sailviz.propagate import shape_air_callback as shape_air

        blown = shape_air.observe_air(time, states, normal, p.model.parameters)
        columns["air_density_kg_m3"], columns["air_drag_N"] = blown[shape_air.DENSITY], blown[shape_air.DRAG]
        size = np.sum(blown[shape_air.FORCE : shape_air.FORCE + 3] ** 2, axis=0)
        columns["air_lift_N"] = np.sqrt(np.maximum(0.0, size - blown[shape_air.DRAG] ** 2))
        columns |= {f"air_torque_{axis}_N_m": blown[shape_air.TORQUE + i].copy() for i, axis in enumerate("xyz")}
    if named.pushed.drag_area > 0.0:
        columns["air_density_kg_m3"] = values[sky_callback.AIR_DENSITY]
        columns["air_drag_N"] = values[sky_callback.AIR_DRAG]
    return columns


def axes_of_light(p: Plan, time: Array, states: Array, normal: Array) -> Array | None:
    """Axes (n, 3, 3), as columns, in which pitch and clock are counted where the light is not at the centre: from the
    light, along N x u, towards N."""
    if p.sky is None or p.model.named.sky.light == CENTRE:
        return None
    values = sky_callback.observe_sky(time, states, normal, p.model.parameters)
    rows = (sky_callback.FROM_LIGHT, sky_callback.EAST, sky_callback.NORTH)
    return np.stack([values[row : row + 3].T for row in rows], axis=-1)


def push_along_primer(p: Plan, states: Array, acceleration: Array, columns: Columns) -> Columns:
    """What a sail with a shape, steered as the flat film would be, gives along its law's primer (n,), over its full
    thrust where it is: beside the `switching_function`, which is what the law expects of a flat film."""
    device, primer = p.scene.device, columns.get("primer_direction")
    if primer is None or not isinstance(device, SolarSail) or device.shape is None:
        return {}
    distance = columns.get("sun_distance_m", np.linalg.norm(states[:3], axis=0))
    full = sail_strength(p.scene, p.design) * (AU / distance) ** 2
    return {"push_along_primer": np.sum(acceleration * primer, axis=1) / full}


def rolled(p: Plan, body: Array) -> Array:
    """Body axes (n, 3, 3), as columns, turned about z by the roll of a sail with a shape."""
    device = p.scene.device
    if not isinstance(device, SolarSail) or not device.roll:
        return body
    turned: Array = body @ frames.turn_z(device.roll).T
    return turned


def torques_of_light(p: Plan, time: Array, states: Array, factor: Array, body: Array) -> Columns:
    """Torque of the light (n,) N m about the origin of a sail with a shape, along its axes: what its control has to
    hold. factor (n,) of its thrust; body (n, 3, 3) its axes as columns."""
    device = p.scene.device
    if not isinstance(device, SolarSail) or device.shape is None:
        return {}
    from sailviz.simulation.sail_shape import light_torque

    towards, distance = frames.unit(states[:3].T), np.linalg.norm(states[:3], axis=0)
    if p.sky is not None:
        values = sky_callback.observe_sky(time, states, body[..., 2].copy(), p.model.parameters)
        towards, distance = (
            values[sky_callback.FROM_LIGHT : sky_callback.FROM_LIGHT + 3].T,
            values[sky_callback.DISTANCE],
        )
        factor = factor * values[sky_callback.SHARE]
    pressure = radiation_pressure(p.scene)
    assert pressure is not None  # as for every sail that does not say its strength
    dose = states[6] if ages(p.scene) else None
    torque = light_torque(p.scene, factor * pressure * (AU / distance) ** 2, towards, body, dose)
    return {f"light_torque_{axis}_N_m": torque[:, i].copy() for i, axis in enumerate("xyz")}


def voltages(model: dynamics.Model) -> Array:
    """Voltages (k,) V that a run's controller has set at its breaks, so far."""
    places = model.named.places
    lines = model.tables[places.control : places.control_law].reshape(-1, voltage_callback.COLUMNS)
    return lines[:, voltage_callback.VOLTAGE]


def low_orbit_columns(p: Plan, time: Array, states: Array, values: Array) -> Columns:
    """Columns (n,) of a run round the Earth from the values of `observe_low_orbit`."""
    scene, around = p.scene, p.scene.environment
    position, velocity = states[:3].T, states[3:6].T
    oblateness = J2_EARTH * RADIUS_EARTH**2 if around.j2 else 0.0
    axis = orbital.mean_semi_major_axis(position, velocity, p.body.mu, oblateness)
    columns = {"mean_altitude_m": axis - p.body.radius}
    if p.quasi_circular is not None:
        columns["quasi_circular_altitude_m"] = p.quasi_circular.altitude(time)
    epoch = epoch_of(scene)
    if epoch is not None:
        columns["earth_rotation_rad"] = ephemeris.greenwich_sidereal_time(epoch, time)
    if watches_shadow(scene):
        columns["sunlit"] = values[low_orbit.LIGHT] > 0.5
        if shadow_kind(scene) == "cone":
            columns["sunlit_fraction"] = values[low_orbit.LIGHT]
    if around.solar_flux is not None:
        columns["solar_flux_sfu"] = values[low_orbit.SOLAR_FLUX]
    if around.atmosphere is not None:
        columns["air_density_kg_m3"] = values[low_orbit.AIR_DENSITY]
        columns["air_drag_N"] = values[low_orbit.AIR_DRAG]
    columns |= device_of(scene).columns(scene.device, scene, p.model, values, velocity)
    if around.height_above == "ellipsoid":
        columns["altitude_over_ellipsoid_m"] = values[low_orbit.ALTITUDE]
    return columns
