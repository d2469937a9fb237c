"""What compiled code cannot say in Python: memory by its address, calls by address, sums as vectors. Imports numba; the
modules that use these names import them late, when code is compiled."""

from __future__ import annotations

import numba
from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic
from numba.np import arrayobj

from sailviz.propagate import gauss_jackson_coefficients as c
from sailviz.propagate.parameters import PARAMETERS

REAL, WORD, BYTES = ir.DoubleType(), ir.IntType(64), ir.IntType(8).as_pointer()
VECTOR = types.CPointer(types.float64)
# time s, state (STATE,), record of PARAMETERS, the callback's own numbers, number; out (4,)
SIGNATURE = types.void(
    types.float64, VECTOR, types.CPointer(numba.from_dtype(PARAMETERS)), types.voidptr, types.float64, VECTOR
)


@intrinsic
def array_at(typing, place, length):
    """The float64 array (length,) at an integer address or a pointer."""

    def generate(context, builder, signature, arguments):
        array = context.make_array(signature.return_type)(context, builder)
        cast = builder.inttoptr if isinstance(signature.args[0], types.Integer) else builder.bitcast
        itemsize = ir.Constant(WORD, 8)
        data = cast(arguments[0], REAL.as_pointer())
        arrayobj.populate_array(array, data, [arguments[1]], [itemsize], itemsize, None)
        return array._getvalue()

    return types.Array(types.float64, 1, "C")(place, types.int64), generate


@intrinsic
def record_at(typing, pointer, dtype):
    """The record of a structured type at an integer address or a pointer."""

    def generate(context, builder, signature, arguments):
        cast = builder.inttoptr if isinstance(signature.args[0], types.Integer) else builder.bitcast
        return cast(arguments[0], context.get_value_type(signature.return_type))

    return dtype.dtype(pointer, dtype), generate


def _stored(builder, values):
    """Numbers on the stack."""
    place = cgutils.alloca_once(builder, REAL, size=len(values))
    for i, value in enumerate(values):
        builder.store(value, builder.gep(place, [ir.Constant(WORD, i)], source_etype=REAL))
    return place


def _results(context, builder, signature, out, count):
    places = [builder.gep(out, [ir.Constant(WORD, i)], source_etype=REAL) for i in range(count)]
    return context.make_tuple(builder, signature.return_type, [builder.load(place, typ=REAL) for place in places])


@intrinsic
def user_vector(typing, address, t, x, y, z, vx, vy, vz, m):
    """Three numbers from the C function of callbacks.USER_SIGNATURE at an integer address."""

    def generate(context, builder, signature, arguments):
        pointer = REAL.as_pointer()
        state = _stored(builder, arguments[2:])
        out = cgutils.alloca_once(builder, REAL, size=3)
        function = builder.inttoptr(arguments[0], ir.FunctionType(ir.VoidType(), [REAL, pointer, pointer]).as_pointer())
        builder.call(function, [arguments[1], state, out])
        return _results(context, builder, signature, out, 3)

    return types.UniTuple(types.float64, 3)(types.int64, *([types.float64] * 8)), generate


@intrinsic
def call_at(typing, address, own, t, x, y, z, vx, vy, vz, m, nx, ny, nz, p, number):
    """Four numbers from the function of SIGNATURE, in numba's convention, at an integer address; `own` : address of
    its numbers. NaN where it raises before it has said any."""

    def generate(context, builder, signature, arguments):
        pointer, whole = REAL.as_pointer(), ir.IntType(32)
        state = _stored(builder, arguments[3:13])
        # looking whether it has raised would cost every flight a tenth, also those without callbacks
        out = _stored(builder, [ir.Constant(REAL, float("nan"))] * 4)
        result, error = (cgutils.alloca_once(builder, BYTES) for _ in range(2))
        own = builder.inttoptr(arguments[1], BYTES)
        kind = ir.FunctionType(whole, [result.type, error.type, REAL, pointer, BYTES, BYTES, REAL, pointer])
        function = builder.inttoptr(arguments[0], kind.as_pointer())
        record = builder.bitcast(arguments[13], BYTES)
        builder.call(function, [result, error, arguments[2], state, record, own, arguments[14], out])
        return _results(context, builder, signature, out, 4)

    numbers = [types.float64] * 11
    return types.UniTuple(types.float64, 4)(types.int64, types.int64, *numbers, p, types.float64), generate


def weighted_rows(terms):
    """An intrinsic of (array, j): the sum over terms (row, coefficient) of coefficient * array[row, j], from left to
    right. j is not negative."""

    @intrinsic
    def total(typing, rows, j):
        def generate(context, builder, signature, arguments):
            array = context.make_array(signature.args[0])(context, builder, arguments[0])
            columns = builder.extract_value(array.shape, 1)
            fast = ("contract", "nsz")  # as OPTIONS of sailviz.compiled
            so_far = None
            for row, coefficient in terms:
                place = builder.add(builder.mul(columns, ir.Constant(WORD, row)), arguments[1])
                value = builder.load(builder.gep(array.data, [place], source_etype=REAL), typ=REAL)
                product = builder.fmul(ir.Constant(REAL, coefficient), value, flags=fast)
                so_far = product if so_far is None else builder.fadd(so_far, product, flags=fast)
            return so_far

        return types.float64(rows, types.int64), generate

    return total


@intrinsic
def weighted_sums(typing, history, newest):
    """The twelve sums over the accelerations up to row newest that a Gauss-Jackson step needs: x, y, z of POSITION,
    VELOCITY, EXTRAPOLATION, POSITION_OTHERS. Written as vectors of four, which the compiler does not find by itself."""

    def generate(context, builder, signature, arguments):
        array = context.make_array(signature.args[0])(context, builder, arguments[0])
        vector = ir.VectorType(REAL, 4)
        tables = (c.POSITION, c.VELOCITY, c.EXTRAPOLATION, c.POSITION_OTHERS)
        sums = [ir.Constant(vector, [0.0] * 4)] * len(tables)
        for lag in range(c.LAGS - 1, -1, -1):
            place = builder.mul(builder.sub(arguments[1], ir.Constant(WORD, lag)), ir.Constant(WORD, 4))
            row = builder.bitcast(builder.gep(array.data, [place], source_etype=REAL), vector.as_pointer())
            acceleration = builder.load(row, typ=vector)
            acceleration.align = 8
            for i, table in enumerate(tables):
                product = builder.fmul(acceleration, ir.Constant(vector, [table[lag]] * 4), flags=("contract",))
                sums[i] = builder.fadd(sums[i], product, flags=("contract",))
        parts = [builder.extract_element(s, ir.Constant(ir.IntType(32), j)) for s in sums for j in range(3)]
        return context.make_tuple(builder, signature.return_type, parts)

    return types.UniTuple(types.float64, 12)(history, types.int64), generate


@intrinsic
def product_left(typing, a, b, product):
    """a b - product without rounding in between."""

    def generate(context, builder, signature, arguments):
        return builder.fma(arguments[0], arguments[1], builder.fneg(arguments[2]))

    return types.float64(types.float64, types.float64, types.float64), generate
