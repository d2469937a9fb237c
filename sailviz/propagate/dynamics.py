"""The one right-hand side: state -> its derivative, for every device, steering law and environment.

State y (7,): position m, velocity m/s, mass kg. A Model is integers that choose
branches, one flat row of parameters, a steering table and the address of a user's compiled functions; it costs nothing
against specialised code and is compiled once for all.
"""

from __future__ import annotations

from typing import NamedTuple

import numba
import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from sailviz import steering as law
from sailviz.compiled import called, compiled, inlined
from sailviz.environment.gravity import gravity
from sailviz.environment.ionosphere import FORCE_PROFILE, exponential
from sailviz.propulsion.devices import ELECTRIC_SAIL, NO_DEVICE, PLASMA_BRAKE, SOLAR_SAIL, THRUSTER  # noqa: F401
from sailviz.propulsion.electric_sail import esail_force
from sailviz.propulsion.plasma_brake import negative_force_per_length
from sailviz.propulsion.solar_sail import sail_force
from sailviz.propulsion.thruster import thruster_force

SIZE = 7  # of the state

# The parameter row: who reads which place
MU, J2_STRENGTH, SURFACE_RADIUS, ROTATION = 0, 1, 2, 3
STEERING = 4  # three numbers of the steering law
DEVICE = 8  # up to five numbers of the device
PLASMA = 14  # profile, reference altitude m, value (N/m or 1/m3), scale height m, ion mass kg, sphere radius m
USER_STEERING, USER_FORCE = 20, 21  # addresses of C functions, 0 for none; exact, since addresses stay below 2^53
INTERPOLATION, ROWS = 22, 23  # of the steering table, which begins at TABLE
THIRD_BODY = 24  # mu m3/s2 (0 for none), radius m, angular rate rad/s and initial azimuth rad of its circular orbit
AIR = (
    28  # kind (0 for none), Cd A m2, then of an exponential profile: reference radius m, density kg/m3, scale height m
)
TABLE = 80


class Model(NamedTuple):
    """What acts on the craft. Built by `model`."""

    device: int
    steering: int
    parameters: np.ndarray  # (TABLE + 7 k,), the k rows of the steering table from TABLE on


def model(
    mu,
    *,
    device=NO_DEVICE,
    device_parameters=(),
    steering=law.RADIAL,
    steering_parameters=(),
    interpolation=law.LINEAR,
    table=None,
    j2_strength=0.0,
    surface_radius=0.0,
    rotation=0.0,
    plasma=(),
    third_body=(),
    air=(),
    user_steering=0,
    user_force=0,
) -> Model:
    """A Model from its parts. mu m3/s2, j2_strength m5/s2, surface_radius m, rotation rad/s about +z; table (k, 7) of
    `steering.table`; the parameter tuples are those of the branches in `direction` and `device_acceleration`."""
    row = np.zeros(TABLE)
    row[MU], row[J2_STRENGTH], row[SURFACE_RADIUS], row[ROTATION] = mu, j2_strength, surface_radius, rotation
    parts = ((STEERING, steering_parameters), (DEVICE, device_parameters), (PLASMA, plasma), (THIRD_BODY, third_body))
    parts += ((AIR, air),)
    for start, values in parts:
        row[start : start + len(values)] = values
    row[USER_STEERING], row[USER_FORCE], row[INTERPOLATION] = user_steering, user_force, interpolation
    if table is not None:
        row[ROWS] = len(table)
        row = np.concatenate([row, np.asarray(table, dtype=float).ravel()])
    return Model(int(device), int(steering), row)


_VECTOR = types.CPointer(types.float64)
USER_SIGNATURE = types.void(types.float64, _VECTOR, _VECTOR)  # time, state (7,) in, vector (3,) out


@intrinsic
def user_vector(typing, address, t, x, y, z, vx, vy, vz, m):
    """Three numbers from the C function at an integer address, so that the propagator itself stays one cached piece
    of machine code whatever the user hands in. The buffers live on the stack."""

    def generate(context, builder, signature, arguments):
        real = ir.DoubleType()
        pointer = real.as_pointer()
        state = cgutils.alloca_once(builder, real, size=7)
        out = cgutils.alloca_once(builder, real, size=3)
        for i, value in enumerate(arguments[2:]):
            builder.store(value, builder.gep(state, [ir.Constant(ir.IntType(64), i)], source_etype=real))
        function = builder.inttoptr(arguments[0], ir.FunctionType(ir.VoidType(), [real, pointer, pointer]).as_pointer())
        builder.call(function, [arguments[1], state, out])
        places = [builder.gep(out, [ir.Constant(ir.IntType(64), i)], source_etype=real) for i in range(3)]
        result = [builder.load(place, typ=real) for place in places]
        return context.make_tuple(builder, signature.return_type, result)

    return types.UniTuple(types.float64, 3)(types.int64, *([types.float64] * 8)), generate


def user_address(function, kind):
    """Address of a user's law or force as a C function, and the object that keeps it alive.

    function : a numba.cfunc of USER_SIGNATURE, or an @njit function (t, x, y, z, vx, vy, vz, m) -> three floats.
    kind : word for the error message. TypeError for anything else, and for what does not compile.
    """
    if hasattr(function, "address") and hasattr(function, "native_name"):
        return function.address, function
    if not isinstance(function, numba.core.registry.CPUDispatcher):
        raise TypeError(f"{kind} must be a numba.cfunc or an @njit function (t, x, y, z, vx, vy, vz, m) -> (3 floats)")

    def adapter(t, state, out):
        s = numba.carray(state, (7,))
        result = numba.carray(out, (3,))
        a, b, c = function(t, s[0], s[1], s[2], s[3], s[4], s[5], s[6])
        result[0], result[1], result[2] = a, b, c

    try:
        handle = numba.cfunc(USER_SIGNATURE)(adapter)
    except numba.core.errors.NumbaError as error:
        raise TypeError(f"{kind} does not compile: {error}") from None
    return handle.address, handle


@inlined
def direction(t, x, y, z, vx, vy, vz, m, ux, uy, uz, model):
    """Unit vector n that the steering law asks for, inertial, and its component along u = r_hat.

    That component is known to the laws that count from the Sun line before n is, which shortens the longest chain of
    dependent operations in a step.
    """
    p = model.parameters
    kind = model.steering
    if kind == law.ORBITAL:
        n_r, n_t, n_h = p[STEERING], p[STEERING + 1], p[STEERING + 2]
        nx, ny, nz = law.orbital_direction(ux, uy, uz, x, y, z, vx, vy, vz, n_r, n_t, n_h)
        return nx, ny, nz, n_r
    if kind == law.RADIAL:
        return ux, uy, uz, 1.0
    if kind == law.MERIDIAN:
        nx, ny, nz = law.meridian_direction(ux, uy, uz, p[STEERING], p[STEERING + 1], p[STEERING + 2])
        return nx, ny, nz, p[STEERING]
    if kind == law.TRANSVERSE:
        nx, ny, nz = law.orbital_direction(ux, uy, uz, x, y, z, vx, vy, vz, 0.0, 1.0, 0.0)
        return nx, ny, nz, 0.0
    if kind == law.TABLE_ORBITAL or kind == law.TABLE_MERIDIAN:
        alpha, delta, _ = law.table_row(t, p, TABLE, int(p[ROWS]), p[INTERPOLATION])
        n_r, n_t, n_h = np.cos(alpha), np.sin(alpha) * np.sin(delta), np.sin(alpha) * np.cos(delta)
        if kind == law.TABLE_MERIDIAN:
            nx, ny, nz = law.meridian_direction(ux, uy, uz, n_r, n_t, n_h)
        else:
            nx, ny, nz = law.orbital_direction(ux, uy, uz, x, y, z, vx, vy, vz, n_r, n_t, n_h)
        return nx, ny, nz, n_r
    if kind == law.INERTIAL:
        nx, ny, nz = p[STEERING], p[STEERING + 1], p[STEERING + 2]
    elif kind == law.TANGENTIAL:
        inverse = 1.0 / np.sqrt(vx * vx + vy * vy + vz * vz)
        nx, ny, nz = vx * inverse, vy * inverse, vz * inverse
    else:
        nx, ny, nz = user_vector(int(p[USER_STEERING]), t, x, y, z, vx, vy, vz, m)
    return nx, ny, nz, ux * nx + uy * ny + uz * nz


@inlined
def brake_force(x, y, z, vx, vy, vz, r, sx, sy, sz, model):
    """Drag on a plasma-brake tether along the unit vector s, N, inertial, and its size per length, N/m.

    Drag opposes the component of the plasma-relative velocity perpendicular to the tether; the plasma turns with the
    body.
    """
    p = model.parameters
    w = p[ROTATION]
    qx, qy, qz = vx + w * y, vy - w * x, vz
    along = qx * sx + qy * sy + qz * sz
    qx, qy, qz = qx - along * sx, qy - along * sy, qz - along * sz
    speed = np.sqrt(qx * qx + qy * qy + qz * qz)
    value = exponential(r - p[PLASMA + 5], p[PLASMA + 1], p[PLASMA + 2], p[PLASMA + 3])
    if p[PLASMA] == FORCE_PROFILE:
        per_length = value
    else:
        per_length = negative_force_per_length(value, p[PLASMA + 4], speed, p[DEVICE + 1], p[DEVICE + 2])
    k = -per_length * p[DEVICE] / speed
    return k * qx, k * qy, k * qz, per_length


@inlined
def device_acceleration(t, x, y, z, vx, vy, vz, m, inverse, factor, model):
    """Acceleration of the device, m/s2 inertial, and m_dot, kg/s. inverse = 1 / |position|; factor multiplies
    both, and so does the throttle of a steering table."""
    p = model.parameters
    if model.steering == law.TABLE_ORBITAL or model.steering == law.TABLE_MERIDIAN:
        factor = factor * law.table_row(t, p, TABLE, int(p[ROWS]), p[INTERPOLATION])[2]
    ux, uy, uz = x * inverse, y * inverse, z * inverse
    nx, ny, nz, c = direction(t, x, y, z, vx, vy, vz, m, ux, uy, uz, model)
    kind = model.device
    if kind == SOLAR_SAIL:
        ax, ay, az = sail_force(
            ux, uy, uz, inverse, nx, ny, nz, c, factor * p[DEVICE], p[DEVICE + 1], p[DEVICE + 2], p[DEVICE + 3]
        )
        return ax, ay, az, 0.0
    if kind == ELECTRIC_SAIL:
        ac, kind_of_sail, limit = factor * p[DEVICE], int(p[DEVICE + 1]), p[DEVICE + 2]
        ax, ay, az = esail_force(ux, uy, uz, inverse, nx, ny, nz, c, ac, kind_of_sail, limit)
        return ax, ay, az, 0.0
    if kind == PLASMA_BRAKE:
        fx, fy, fz, _ = brake_force(x, y, z, vx, vy, vz, 1.0 / inverse, nx, ny, nz, model)
        k = factor / m
        return k * fx, k * fy, k * fz, 0.0
    return thruster_force(nx, ny, nz, m, factor * p[DEVICE], p[DEVICE + 1], p[DEVICE + 2])


@inlined
def third_body_gravity(t, x, y, z, p):
    """Pull of a body on a circular orbit in the x-y plane, m/s2, the central body held fixed: the fall of the
    central body towards the other, mu' / R'^2, is neglected (3e-6 of the Sun's pull for the Earth)."""
    angle = p[THIRD_BODY + 3] + p[THIRD_BODY + 2] * t
    dx, dy = p[THIRD_BODY + 1] * np.cos(angle) - x, p[THIRD_BODY + 1] * np.sin(angle) - y
    d2 = dx * dx + dy * dy + z * z
    k = p[THIRD_BODY] / (d2 * np.sqrt(d2))
    return k * dx, k * dy, -k * z


@inlined
def air_drag(x, y, z, vx, vy, vz, m, r, model):
    """Drag of the neutral atmosphere on the craft, m/s2, against its velocity through air that turns with the body."""
    p = model.parameters
    w = p[ROTATION]
    qx, qy, qz = vx + w * y, vy - w * x, vz
    density = exponential(r, p[AIR + 2], p[AIR + 3], p[AIR + 4])
    k = -0.5 * density * p[AIR + 1] / m * np.sqrt(qx * qx + qy * qy + qz * qz)
    return k * qx, k * qy, k * qz


@called
def derivative(t, y, factor, model, out):
    """out (7,) = dy/dt: (2.1)-(2.3). factor multiplies the device's thrust; 0 is off."""
    p = model.parameters
    x, yy, z, vx, vy, vz, m = y[0], y[1], y[2], y[3], y[4], y[5], y[6]
    inverse = 1.0 / np.sqrt(x * x + yy * yy + z * z)
    ax, ay, az = gravity(x, yy, z, inverse, p[MU], p[J2_STRENGTH])
    m_dot = 0.0
    if p[THIRD_BODY] != 0.0:
        bx, by, bz = third_body_gravity(t, x, yy, z, p)
        ax, ay, az = ax + bx, ay + by, az + bz
    if p[AIR] != 0.0:
        bx, by, bz = air_drag(x, yy, z, vx, vy, vz, m, 1.0 / inverse, model)
        ax, ay, az = ax + bx, ay + by, az + bz
    if factor != 0.0 and model.device != NO_DEVICE:
        bx, by, bz, m_dot = device_acceleration(t, x, yy, z, vx, vy, vz, m, inverse, factor, model)
        ax, ay, az = ax + bx, ay + by, az + bz
    if p[USER_FORCE] != 0.0:
        bx, by, bz = user_vector(int(p[USER_FORCE]), t, x, yy, z, vx, vy, vz, m)
        ax, ay, az = ax + bx, ay + by, az + bz
    out[0], out[1], out[2], out[3], out[4], out[5], out[6] = vx, vy, vz, ax, ay, az, m_dot


@compiled
def observe(time, states, factor, model):
    """What the craft did at given states. time (n,), states (7, n), factor (n,) -> normal (n, 3), acceleration of
    device and user force together (n, 3) m/s2, drag per length (n,) N/m (plasma brake only)."""
    n = len(time)
    p = model.parameters
    normal, acceleration, per_length = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(n)
    for i in range(n):
        t, x, y, z = time[i], states[0, i], states[1, i], states[2, i]
        vx, vy, vz, m = states[3, i], states[4, i], states[5, i], states[6, i]
        r = np.sqrt(x * x + y * y + z * z)
        ux, uy, uz = x / r, y / r, z / r
        nx, ny, nz, _ = direction(t, x, y, z, vx, vy, vz, m, ux, uy, uz, model)
        normal[i, 0], normal[i, 1], normal[i, 2] = nx, ny, nz
        ax, ay, az = 0.0, 0.0, 0.0
        if factor[i] != 0.0 and model.device != NO_DEVICE:
            ax, ay, az, _ = device_acceleration(t, x, y, z, vx, vy, vz, m, 1.0 / r, factor[i], model)
            if model.device == PLASMA_BRAKE:
                per_length[i] = factor[i] * brake_force(x, y, z, vx, vy, vz, r, nx, ny, nz, model)[3]
        if p[USER_FORCE] != 0.0:
            bx, by, bz = user_vector(int(p[USER_FORCE]), t, x, y, z, vx, vy, vz, m)
            ax, ay, az = ax + bx, ay + by, az + bz
        acceleration[i, 0], acceleration[i, 1], acceleration[i, 2] = ax, ay, az
    return normal, acceleration, per_length
