"""The one right-hand side: state -> its derivative, for every device, steering law and environment.

State y (7,): position m, velocity m/s, mass kg. A Model is one record of named parameters (parameters.py), of which two
integers choose the branches, and one flat array of tables; it costs nothing against specialised code and is compiled
once for all.
What is not built in here comes as a callback (callbacks.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from sailviz.compiled import called, entry, inlined
from sailviz.environment import atmosphere
from sailviz.environment.atmosphere import exponential_air_drag
from sailviz.environment.gravity import gravity
from sailviz.environment.third_body import third_body_gravity
from sailviz.propagate.callbacks import Callback, call, user_vector
from sailviz.propagate.parameters import PARAMETERS, PARTS, Parameters, Primer, array_at
from sailviz.propulsion.devices import (
    CALLED,
    ELECTRIC_SAIL,
    NO_DEVICE,
    PLASMA_BRAKE,
    SOLAR_SAIL,
    THRUSTER,
)
from sailviz.propulsion.electric_sail import esail_force
from sailviz.propulsion.solar_sail import sail_force
from sailviz.propulsion.thruster import thruster_force
from sailviz.steering import attitude

SIZE = 7  # of the state
AT_ONCE = 256  # rows observed in one piece of compiled work where a user's function is called, which may take any time

# where the numbers of a built-in device or law stand in the record
DEVICE_PARTS = {
    SOLAR_SAIL: "solar_sail",
    ELECTRIC_SAIL: "electric_sail",
    THRUSTER: "thruster",
    PLASMA_BRAKE: "brake",
}
STEERING_PARTS = {
    attitude.ORBITAL: "components",
    attitude.MERIDIAN: "components",
    attitude.INERTIAL: "inertial",
    attitude.LOCAL: "local",
}


class Model(NamedTuple):
    """What acts on the craft. Built by `model`."""

    parameters: np.ndarray[Any, Any]  # (1,) of PARAMETERS
    tables: np.ndarray[Any, Any]  # (k,) float64, whose address stands in the parameters

    @property
    def named(self) -> Parameters:
        """The parameters, `model.named.sun.mean_longitude`, for Python: a copy."""
        values = zip(PARTS.values(), self.parameters[0].tolist(), strict=True)
        return Parameters(*(part(*numbers) for part, numbers in values))

    @property
    def device(self) -> int:
        """Which of propulsion.devices."""
        return int(self.parameters["kinds"]["device"][0])

    @property
    def steering(self) -> int:
        """Which of steering.attitude."""
        return int(self.parameters["kinds"]["steering"][0])


def model(
    mu: float,
    *,
    device: int = NO_DEVICE,
    device_parameters: Sequence[float] = (),
    steering: int = attitude.RADIAL,
    steering_parameters: Sequence[float] = (),
    interpolation: int = attitude.LINEAR,
    table: np.ndarray[Any, Any] | None = None,
    j2_strength: float = 0.0,
    zonal: Sequence[float] = (),
    surface_radius: float = 0.0,
    rotation: float = 0.0,
    ellipsoid: int = 0,
    shadow: int = 0,
    third_body: Sequence[float] = (),
    sun: Sequence[float] = (),
    solar_level: Sequence[float] = (),
    solar_level_table: Sequence[float] | None = None,
    air: Sequence[float] = (),
    air_table: np.ndarray[Any, Any] | None = None,
    plasma: Sequence[float] = (),
    plasma_table: np.ndarray[Any, Any] | None = None,
    primer_kind: int = 0,
    steer_as: tuple[int, Sequence[float]] = (NO_DEVICE, ()),
    steering_callback: Callback | None = None,
    device_callback: Callback | None = None,
    forces: Sequence[Callback] = (),
    burns: bool = False,
    edges: Callback | None = None,
    quantity: Callback | None = None,
    control: Callback | None = None,
    control_table: np.ndarray[Any, Any] | None = None,
    control_law: np.ndarray[Any, Any] | None = None,
    sky: dict[str, Sequence[float]] | None = None,
    sky_table: np.ndarray[Any, Any] | None = None,
    film: Sequence[float] = (),
    wheel: Sequence[float] = (),
    shape_air: Sequence[float] | None = None,
    body: Sequence[float] | None = None,
    heat: Sequence[float] | np.ndarray[Any, Any] | None = None,
    body_control: Callback | None = None,
    user_steering: int = 0,
    user_force: int = 0,
) -> Model:
    """A Model from its parts.

    mu m3/s2, j2_strength m5/s2, zonal the strengths of J3 and J4, surface_radius m, rotation rad/s about +z;
    device_parameters, steering_parameters, third_body, sun, solar_level, air, plasma : the Parameters of these in
    their order; table (k, 7) of `attitude.table`; air_table, plasma_table of the environment's modules; steer_as : the
    sail for which a primer law steers, id and parameters. The callbacks of steering and device belong to the kinds
    CALLED; forces add up; burns : one of them burns propellant. sky : Parameters of the sky's parts by name, `sky`,
    `magnetosphere`, `by_light`, `pushed`; sky_table of `environment.sky.packed`; film : Numbers of
    `propulsion.film_ageing`, of a film that ages or whose temperature is asked for; wheel : Numbers of
    `propulsion.esail_wheel`, of a wheel that is a body; shape_air of `shape_air_callback.numbers`; body : of
    `body_motion.packed`, body_control : what turns it on purpose; heat : of `propulsion.shaped_heat`, of a shape whose
    temperature is asked for.
    """
    parameters = np.zeros(1, PARAMETERS)
    p = parameters[0]
    p["kinds"] = (device, steering)
    p["gravity"] = (mu, j2_strength, *zonal, *[0.0] * (2 - len(zonal)))
    p["surface"] = (surface_radius, rotation, ellipsoid, shadow)
    p["table"] = (0 if table is None else len(table), interpolation)
    p["primer"] = Primer(primer_kind, steer_as[0], mu)
    parts: dict[str, Sequence[float]] = {
        "third_body": third_body,
        "sun": sun,
        "solar_level": solar_level,
        "air": air,
        "plasma": plasma,
        "film": film,
        "wheel": wheel,
    }
    parts |= sky or {}
    pushed = int(parts["pushed"][0]) if "pushed" in parts else NO_DEVICE
    parts |= {
        STEERING_PARTS.get(steering, ""): steering_parameters,
        DEVICE_PARTS.get(pushed or device, ""): device_parameters,
    }
    for name, values in parts.items():
        if len(values):
            p[name] = tuple(PARTS[name](*values))
    tables: list[np.ndarray[Any, Any]] = []
    places = p["places"]

    def put(values, place=None):
        """Where the values begin in the tables, noted in the place of that name."""
        begin = sum(map(len, tables))
        tables.append(np.ravel(np.asarray(values, dtype=float)))
        if place is not None:
            places[place] = begin
        return begin

    callbacks = p["callbacks"]
    callbacks["user_steering"], callbacks["user_force"] = user_steering, user_force
    given = {
        "steering": steering_callback,
        "device": device_callback,
        "control": control,
        "edges": edges,
        "quantity": quantity,
        "body": body_control,
    }
    for word, one in given.items():
        if one is not None:
            callbacks[word] = one.address
    if table is not None:
        put(table, "steering")
    elif steering_callback is not None:
        put(steering_callback.numbers, "steering")
    if device_callback is not None:
        put(device_callback.numbers, "device")
    callbacks["forces"], callbacks["burns"] = len(forces), int(burns)
    pairs = [(one.address, put(one.numbers)) for one in forces]
    put(pairs, "forces")
    named = {
        "air": air_table,
        "plasma": plasma_table,
        "solar_level": solar_level_table,
        "control": control_table,
        "control_law": control_law,
        "sky": sky_table,
        "shape_air": shape_air,
        "body": body,
        "heat": heat,
    }
    for place, rows in named.items():
        if rows is not None:
            put(rows, place)
    put(steer_as[1], "sail")
    all_tables = np.concatenate([*tables, np.zeros(1)])
    places["end"], places["address"] = len(all_tables), all_tables.ctypes.data
    return Model(parameters, all_tables)


def without_user_force(model: Model) -> Model:
    """The model as it is but for the user's own force."""
    parameters = model.parameters.copy()
    parameters["callbacks"]["user_force"] = 0
    return model._replace(parameters=parameters)


def loses_mass(model: Model) -> bool:
    """Whether the device burns propellant, or, being one's own, may."""
    if model.parameters["callbacks"]["burns"][0]:
        return True
    if model.device == CALLED:
        return model.named.pushed.device == NO_DEVICE
    return model.device == THRUSTER and model.named.thruster.inverse_exhaust != 0.0


@inlined
def direction(t, x, y, z, vx, vy, vz, m, ux, uy, uz, p):
    """Unit vector n that the steering law asks for, inertial; its component along u = r_hat; the throttle.

    That component is known to the laws that count from the Sun line before n is, which shortens the longest chain of
    dependent operations in a step.
    """
    kind = p.kinds.steering
    if kind == attitude.ORBITAL:
        n_r, n_t, n_h = p.components.radial, p.components.transverse, p.components.normal
        nx, ny, nz = attitude.orbital_direction(ux, uy, uz, x, y, z, vx, vy, vz, n_r, n_t, n_h)
        return nx, ny, nz, n_r, 1.0
    if kind == attitude.RADIAL:
        return ux, uy, uz, 1.0, 1.0
    if kind == attitude.MERIDIAN:
        nx, ny, nz = attitude.meridian_direction(
            ux, uy, uz, p.components.radial, p.components.transverse, p.components.normal
        )
        return nx, ny, nz, p.components.radial, 1.0
    if kind == attitude.TRANSVERSE:
        nx, ny, nz = attitude.orbital_direction(ux, uy, uz, x, y, z, vx, vy, vz, 0.0, 1.0, 0.0)
        return nx, ny, nz, 0.0, 1.0
    if kind == attitude.TABLE_ORBITAL or kind == attitude.TABLE_MERIDIAN:
        alpha, delta, throttle = attitude.table_row(
            t, array_at(p.places.address, p.places.end), p.places.steering, p.table.rows, p.table.interpolation
        )
        n_r, n_t, n_h = np.cos(alpha), np.sin(alpha) * np.sin(delta), np.sin(alpha) * np.cos(delta)
        if kind == attitude.TABLE_MERIDIAN:
            nx, ny, nz = attitude.meridian_direction(ux, uy, uz, n_r, n_t, n_h)
        else:
            nx, ny, nz = attitude.orbital_direction(ux, uy, uz, x, y, z, vx, vy, vz, n_r, n_t, n_h)
        return nx, ny, nz, n_r, throttle
    on = 1.0
    if kind == attitude.INERTIAL:
        nx, ny, nz = p.inertial.x, p.inertial.y, p.inertial.z
    elif kind == attitude.TANGENTIAL:
        inverse = 1.0 / np.sqrt(vx * vx + vy * vy + vz * vz)
        nx, ny, nz = vx * inverse, vy * inverse, vz * inverse
    elif kind == attitude.USER:
        nx, ny, nz = user_vector(p.callbacks.user_steering, t, x, y, z, vx, vy, vz, m)
        nx, ny, nz, on = attitude.unit_direction(nx, ny, nz, 1.0)
    else:
        nx, ny, nz, on = call(p.callbacks.steering, p.places.steering, t, x, y, z, vx, vy, vz, m, 0.0, 0.0, 0.0, p, 1.0)
        nx, ny, nz, on = attitude.unit_direction(nx, ny, nz, on)
    return nx, ny, nz, ux * nx + uy * ny + uz * nz, on


@inlined
def device_acceleration(t, x, y, z, vx, vy, vz, m, inverse, factor, p):
    """Acceleration of the device, m/s2 inertial, and m_dot, kg/s. factor multiplies both, and so does the throttle of
    the steering law; inverse = 1 / |position|. Not of a plasma brake."""
    ux, uy, uz = x * inverse, y * inverse, z * inverse
    nx, ny, nz, c, throttle = direction(t, x, y, z, vx, vy, vz, m, ux, uy, uz, p)
    factor = factor * throttle
    kind = p.kinds.device
    if kind == CALLED:
        return call(p.callbacks.device, p.places.device, t, x, y, z, vx, vy, vz, m, nx, ny, nz, p, factor)
    if kind == SOLAR_SAIL:
        sail = p.solar_sail
        ax, ay, az = sail_force(ux, uy, uz, inverse, nx, ny, nz, c, factor * sail.strength, sail.b1, sail.b2, sail.b3)
        return ax, ay, az, 0.0
    if kind == ELECTRIC_SAIL:
        esail = p.electric_sail
        ac = factor * esail.characteristic_acceleration
        ax, ay, az = esail_force(ux, uy, uz, inverse, nx, ny, nz, c, ac, int(esail.model), esail.pitch_limit)
        return ax, ay, az, 0.0
    if kind == THRUSTER:
        thruster = p.thruster
        return thruster_force(nx, ny, nz, m, factor * thruster.size, thruster.is_force, thruster.inverse_exhaust)
    return 0.0, 0.0, 0.0, 0.0  # never: but with a device for all others, or the call here, a sail costs 10 % more


@called
def environment_forces(t, x, y, z, vx, vy, vz, m, factor, p):
    """Acceleration, m/s2, of all forces that come as callbacks, and what they burn, kg/s."""
    tables = array_at(p.places.address, p.places.end)
    ax, ay, az, m_dot = 0.0, 0.0, 0.0, 0.0
    for i in range(p.callbacks.forces):
        address, own = int(tables[p.places.forces + 2 * i]), int(tables[p.places.forces + 2 * i + 1])
        bx, by, bz, flow = call(address, own, t, x, y, z, vx, vy, vz, m, 0.0, 0.0, 0.0, p, factor)
        ax, ay, az, m_dot = ax + bx, ay + by, az + bz, m_dot + flow
    return ax, ay, az, m_dot


@called
def derivative(t, y, factor, p, out):
    """out (7,) = dy/dt: (2.1)-(2.3). factor multiplies the device's thrust; 0 is off. p : a record of PARAMETERS."""
    x, yy, z, vx, vy, vz, m = y[0], y[1], y[2], y[3], y[4], y[5], y[6]
    inverse = 1.0 / np.sqrt(x * x + yy * yy + z * z)
    ax, ay, az = gravity(
        x, yy, z, inverse, p.gravity.mu, p.gravity.j2_strength, p.gravity.j3_strength, p.gravity.j4_strength
    )
    m_dot = 0.0
    if p.third_body.mu != 0.0:
        bx, by, bz = third_body_gravity(t, x, yy, z, p.third_body)
        ax, ay, az = ax + bx, ay + by, az + bz
    if p.air.kind == atmosphere.EXPONENTIAL:
        bx, by, bz = exponential_air_drag(x, yy, z, vx, vy, vz, m, 1.0 / inverse, p.surface.rotation, p.air)
        ax, ay, az = ax + bx, ay + by, az + bz
    if p.callbacks.forces != 0:
        bx, by, bz, m_dot = environment_forces(t, x, yy, z, vx, vy, vz, m, factor, p)
        ax, ay, az = ax + bx, ay + by, az + bz
    if factor != 0.0 and p.kinds.device != NO_DEVICE and p.kinds.device != PLASMA_BRAKE:
        bx, by, bz, flow = device_acceleration(t, x, yy, z, vx, vy, vz, m, inverse, factor, p)
        ax, ay, az, m_dot = ax + bx, ay + by, az + bz, m_dot + flow
    if p.callbacks.user_force != 0:
        bx, by, bz = user_vector(p.callbacks.user_force, t, x, yy, z, vx, vy, vz, m)
        ax, ay, az = ax + bx, ay + by, az + bz
    out[0], out[1], out[2], out[3], out[4], out[5], out[6] = vx, vy, vz, ax, ay, az, m_dot


@entry("d1 d2 d1 r1 D2 D2 D1", PARAMETERS)
def observe_compiled(time, states, factor, parameters, normal, acceleration, on):
    """`observe` without its arrays made."""
    p = parameters[0]
    for i in range(len(time)):
        t, x, y, z = time[i], states[0, i], states[1, i], states[2, i]
        vx, vy, vz, m = states[3, i], states[4, i], states[5, i], states[6, i]
        r = np.sqrt(x * x + y * y + z * z)
        nx, ny, nz, _, on[i] = direction(t, x, y, z, vx, vy, vz, m, x / r, y / r, z / r, p)
        ax, ay, az = 0.0, 0.0, 0.0
        if factor[i] != 0.0 and p.kinds.device != NO_DEVICE and p.kinds.device != PLASMA_BRAKE:
            ax, ay, az, _ = device_acceleration(t, x, y, z, vx, vy, vz, m, 1.0 / r, factor[i], p)
        if p.callbacks.user_force != 0:
            bx, by, bz = user_vector(p.callbacks.user_force, t, x, y, z, vx, vy, vz, m)
            ax, ay, az = ax + bx, ay + by, az + bz
        normal[i, 0], normal[i, 1], normal[i, 2] = nx, ny, nz
        acceleration[i, 0], acceleration[i, 1], acceleration[i, 2] = ax, ay, az
    return 0


def observe(
    time: np.ndarray[Any, Any], states: np.ndarray[Any, Any], factor: np.ndarray[Any, Any], model: Model
) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """What the craft did at given states. time (n,), states (7, n), factor (n,) -> normal (n, 3), acceleration of
    device (but not a plasma brake) and user force together (n, 3) m/s2, throttle of the steering law (n,)."""
    n, callbacks = len(time), model.parameters["callbacks"]
    normal, acceleration, on = np.zeros((n, 3)), np.zeros((n, 3)), np.ones(n)
    piece = AT_ONCE if callbacks["user_steering"][0] or callbacks["user_force"][0] else n
    for first in range(0, n, max(piece, 1)):
        i = slice(first, first + piece)
        part = np.ascontiguousarray(states[:, i])
        observe_compiled(time[i], part, factor[i], model.parameters, normal[i], acceleration[i], on[i])
    return normal, acceleration, on
