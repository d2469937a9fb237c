"""Machine code that the right-hand side calls by its address: what only some scenes need, and what a user brings.

The propagator itself stays one cached piece of machine code, compiled once; a callback is compiled, and cached, when
the first scene asks for it. So a steering law, a device or a force of the environment need not touch dynamics.py: a
module-level function of SIGNATURE beside its formula, and `callback(function, numbers)` in the record of its kind.

    NUMBERS = layout(Parameters)

    def force(time, state, parameters, own, number, out):
        s, p, a = carray(state, (STATE,)), carray(own, (1,), NUMBERS)[0], carray(out, (4,))

`layout` and STATE come from sailviz.compiled; Parameters is a NamedTuple of floats, the callback's own numbers. What
comes out, four numbers: of a steering law the normal, made a unit vector (zero: no thrust), and the throttle; of a
device the acceleration m/s2 at thrust factor `number` and the mass flow kg/s; of a force the acceleration m/s2 and
nothing, `number` the thrust factor; of a voltage control the thrust factor from break `number` on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numba
from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from sailviz.compiled import cached_c_function, inlined
from sailviz.propagate.parameters import PARAMETERS

_VECTOR = types.CPointer(types.float64)
USER_SIGNATURE = types.void(types.float64, _VECTOR, _VECTOR)  # time, state (7,) in, vector (3,) out
# time s, state (STATE,), record of PARAMETERS, the callback's own numbers, number; out (4,)
SIGNATURE = types.void(
    types.float64, _VECTOR, types.CPointer(numba.from_dtype(PARAMETERS)), types.voidptr, types.float64, _VECTOR
)


class Callback(NamedTuple):
    """A C function of SIGNATURE and the numbers that are its own."""

    address: int
    numbers: Sequence[float] = ()


def callback(function: Callable[..., None], numbers: Sequence[float] = ()) -> Callback:
    """A function of SIGNATURE, compiled on first use."""
    return Callback(int(cached_c_function(function, SIGNATURE).address or 0), numbers)


def _stored(builder, values):
    """Numbers on the stack."""
    real = ir.DoubleType()
    place = cgutils.alloca_once(builder, real, size=len(values))
    for i, value in enumerate(values):
        builder.store(value, builder.gep(place, [ir.Constant(ir.IntType(64), i)], source_etype=real))
    return place


def _results(context, builder, signature, out, count):
    real = ir.DoubleType()
    places = [builder.gep(out, [ir.Constant(ir.IntType(64), i)], source_etype=real) for i in range(count)]
    return context.make_tuple(builder, signature.return_type, [builder.load(place, typ=real) for place in places])


@intrinsic
def user_vector(typing, address, t, x, y, z, vx, vy, vz, m):
    """Three numbers from the C function of USER_SIGNATURE at an integer address."""

    def generate(context, builder, signature, arguments):
        real = ir.DoubleType()
        pointer = real.as_pointer()
        state = _stored(builder, arguments[2:])
        out = cgutils.alloca_once(builder, real, size=3)
        function = builder.inttoptr(arguments[0], ir.FunctionType(ir.VoidType(), [real, pointer, pointer]).as_pointer())
        builder.call(function, [arguments[1], state, out])
        return _results(context, builder, signature, out, 3)

    return types.UniTuple(types.float64, 3)(types.int64, *([types.float64] * 8)), generate


@intrinsic
def _call(typing, address, own, t, x, y, z, vx, vy, vz, m, nx, ny, nz, p, number):
    """Four numbers from the C function of SIGNATURE at an integer address; `own` is the address of its numbers."""

    def generate(context, builder, signature, arguments):
        real, byte = ir.DoubleType(), ir.IntType(8).as_pointer()
        pointer = real.as_pointer()
        state = _stored(builder, arguments[3:13])
        out = cgutils.alloca_once(builder, real, size=4)
        own = builder.inttoptr(arguments[1], byte)
        kind = ir.FunctionType(ir.VoidType(), [real, pointer, byte, byte, real, pointer])
        function = builder.inttoptr(arguments[0], kind.as_pointer())
        record = builder.bitcast(arguments[13], byte)
        builder.call(function, [arguments[2], state, record, own, arguments[14], out])
        return _results(context, builder, signature, out, 4)

    numbers = [types.float64] * 11
    return types.UniTuple(types.float64, 4)(types.int64, types.int64, *numbers, p, types.float64), generate


@inlined
def call(address, place, t, x, y, z, vx, vy, vz, m, nx, ny, nz, p, number):
    """Four numbers from the C function of SIGNATURE at an integer address, its own numbers at a place of the tables."""
    own = p.places.address + 8 * place
    return _call(address, own, t, x, y, z, vx, vy, vz, m, nx, ny, nz, p, number)


def user_address(function: Any, kind: str) -> tuple[int, object]:
    """Address of a user's law or force as a C function, and the object that keeps it alive.

    function : a numba.cfunc of USER_SIGNATURE, or an @njit function (t, x, y, z, vx, vy, vz, m) -> three floats.
    kind : word for the error message. TypeError for anything else, and for what does not compile.
    """
    if hasattr(function, "address") and hasattr(function, "native_name"):
        return int(function.address), function
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
    return int(handle.address or 0), handle
