"""Machine code that the right-hand side calls by its address: what only some scenes need, and what a user brings.

The propagator itself stays one cached piece of machine code, compiled once; a plug is compiled, and cached, when the
first scene asks for it. The address stands in the parameter row, exact since addresses stay below 2^53.
"""

from __future__ import annotations

import numba
from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

from sailviz.compiled import cached_c_function

_VECTOR = types.CPointer(types.float64)
USER_SIGNATURE = types.void(types.float64, _VECTOR, _VECTOR)  # time, state (7,) in, vector (3,) out
# time, state (7,), parameter row, its length, thrust factor in; four numbers out
PLUG_SIGNATURE = types.void(types.float64, _VECTOR, _VECTOR, types.int64, types.float64, _VECTOR)


def _store_state(builder, values):
    """A state on the stack, from its seven numbers."""
    real = ir.DoubleType()
    state = cgutils.alloca_once(builder, real, size=7)
    for i, value in enumerate(values):
        builder.store(value, builder.gep(state, [ir.Constant(ir.IntType(64), i)], source_etype=real))
    return state


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
        state = _store_state(builder, arguments[2:])
        out = cgutils.alloca_once(builder, real, size=3)
        function = builder.inttoptr(arguments[0], ir.FunctionType(ir.VoidType(), [real, pointer, pointer]).as_pointer())
        builder.call(function, [arguments[1], state, out])
        return _results(context, builder, signature, out, 3)

    return types.UniTuple(types.float64, 3)(types.int64, *([types.float64] * 8)), generate


@intrinsic
def plugged(typing, address, t, x, y, z, vx, vy, vz, m, p, factor):
    """Four numbers from the C function of PLUG_SIGNATURE at an integer address."""

    def generate(context, builder, signature, arguments):
        real, whole = ir.DoubleType(), ir.IntType(64)
        pointer = real.as_pointer()
        state = _store_state(builder, arguments[2:9])
        out = cgutils.alloca_once(builder, real, size=4)
        row = context.make_array(signature.args[9])(context, builder, arguments[9])
        kind = ir.FunctionType(ir.VoidType(), [real, pointer, pointer, whole, real, pointer])
        function = builder.inttoptr(arguments[0], kind.as_pointer())
        builder.call(function, [arguments[1], state, row.data, row.nitems, arguments[10], out])
        return _results(context, builder, signature, out, 4)

    row = types.Array(types.float64, 1, "C")
    numbers = [types.float64] * 8
    return types.UniTuple(types.float64, 4)(types.int64, *numbers, row, types.float64), generate


def plug_address(function) -> int:
    """Address of a function of PLUG_SIGNATURE, compiled on first use."""
    return cached_c_function(function, PLUG_SIGNATURE).address


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
