"""Eight numbers that compiled code computes with like one: the type `lanes`, LLVM's <8 x double>. Imports numba; the
modules that use these names import them late, when code is compiled.

Sums, products, quotients, powers and square roots of lanes, and of lanes and numbers, mean what they mean for numbers.
Physics written for one state, `gravity` or `orbital_direction`, so works on eight states at once as it stands, provided
that it branches on numbers only. LLVM makes of it one register of AVX-512, two of AVX2 or four of NEON.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from hashlib import sha256
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.core.datamodel import models
from numba.core.extending import register_model
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin
from numba.np.arrayobj import populate_array

COUNT = 8
REAL, WORD, SHORT = ir.DoubleType(), ir.IntType(64), ir.IntType(32)
VECTOR, WORDS = ir.VectorType(REAL, COUNT), ir.VectorType(WORD, COUNT)
FREE = ("contract", "nsz")  # as all compiled code: a product and a sum may become one, and zero has no sign
NUMBERS = (types.Float, types.Integer)


class Lanes(types.Type):
    """The type, for numba."""

    def __init__(self) -> None:
        super().__init__(name="lanes")


lanes = Lanes()


@register_model(Lanes)
class _Model(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, VECTOR)


def _shuffled(builder, a, b, places):
    return builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(SHORT, len(places)), list(places)))


def _spread(builder, value):
    undefined = ir.Constant(VECTOR, ir.Undefined)
    return _shuffled(builder, builder.insert_element(undefined, value, ir.Constant(SHORT, 0)), undefined, [0] * COUNT)


def _as_lanes(builder, value, kind):
    if kind == lanes:
        return value
    return _spread(builder, builder.sitofp(value, REAL) if isinstance(kind, types.Integer) else value)


def _llvm(builder, name, *arguments):
    """Call one of LLVM's own functions of vectors or numbers."""
    function = builder.module.globals.get(name)
    if function is None:
        function = ir.Function(builder.module, ir.FunctionType(arguments[0].type, [a.type for a in arguments]), name)
    return builder.call(function, arguments)


def _between_two(operation: Callable[..., Any], make: Callable[..., Any]) -> None:
    """Teach numba an operator; make (builder, a, b) -> the instruction."""

    @infer_global(operation)
    class Typing(AbstractTemplate):
        def generic(self, arguments, keywords):
            if len(arguments) == 2 and lanes in arguments and all(isinstance(a, (Lanes, *NUMBERS)) for a in arguments):
                return signature(lanes, *arguments)
            return None

    def lower(context, builder, sig, arguments):
        return make(builder, *(_as_lanes(builder, v, k) for v, k in zip(arguments, sig.args, strict=True)))

    for pair in [(lanes, lanes)] + [p for number in NUMBERS for p in ((lanes, number), (number, lanes))]:
        lower_builtin(operation, *pair)(lower)


for _operations, _name in (
    ((operator.add, operator.iadd), "fadd"),
    ((operator.sub, operator.isub), "fsub"),
    ((operator.mul, operator.imul), "fmul"),
    ((operator.truediv, operator.itruediv), "fdiv"),
):
    for _operation in _operations:
        _between_two(_operation, lambda builder, a, b, name=_name: getattr(builder, name)(a, b, flags=FREE))
_between_two(operator.pow, lambda builder, a, b: _llvm(builder, "llvm.pow.v8f64", a, b))


def _of_one(operation: Callable[..., Any], make: Callable[..., Any]) -> None:
    @infer_global(operation)
    class Typing(AbstractTemplate):
        def generic(self, arguments, keywords):
            return signature(lanes, lanes) if tuple(arguments) == (lanes,) else None

    lower_builtin(operation, lanes)(lambda context, builder, sig, arguments: make(builder, arguments[0]))


def _exp(builder, x):
    """e^x by x = n ln 2 + r and the Taylor polynomial of r up to its thirteenth power, which is good to 4e-18 for
    |r| < ln 2 / 2; beyond 700 it stays as it is."""

    def number(value):
        return ir.Constant(VECTOR, [value] * COUNT)

    def sum_of(a, b):
        return builder.fadd(a, b, flags=FREE)

    def product_of(a, b):
        return builder.fmul(a, b, flags=FREE)

    for sense, bound in ((">", 700.0), ("<", -700.0)):
        x = builder.select(builder.fcmp_ordered(sense, x, number(bound)), number(bound), x)
    shift = number(1.5 * 2.0**52)  # a number of this size has no fraction: its last bits are n
    shifted = builder.fadd(builder.fmul(x, number(1 / math.log(2))), shift)
    n = builder.fsub(shifted, shift)
    r = sum_of(x, product_of(n, number(-0.693147180369123816490)))  # ln 2 in two parts, the first with 32 bits
    r = sum_of(r, product_of(n, number(-1.90821492927058770002e-10)))
    # neighbours first, then their sums: four products one after the other in place of thirteen
    terms: list[Any] = [number(1 / math.factorial(k)) for k in range(14)]
    power = r
    while len(terms) > 1:
        pairs = zip(terms[::2], terms[1::2], strict=False)
        terms = [sum_of(a, product_of(b, power)) for a, b in pairs] + terms[len(terms) // 2 * 2 :]
        power = product_of(power, power)
    value = terms[0]
    exponent = builder.shl(builder.bitcast(shifted, WORDS), ir.Constant(WORDS, [52] * COUNT))
    return builder.bitcast(builder.add(builder.bitcast(value, WORDS), exponent), VECTOR)


_of_one(np.exp, _exp)
_of_one(operator.neg, lambda builder, a: builder.fneg(a))
_of_one(np.sqrt, lambda builder, a: _llvm(builder, "llvm.sqrt.v8f64", a))


def _place(context, builder, sig, arguments):
    array = context.make_array(sig.args[0])(context, builder, arguments[0])
    place = builder.gep(array.data, [arguments[1]], source_etype=REAL)
    return builder.bitcast(place, VECTOR.as_pointer())


@intrinsic
def in_one_row(typing, array, first):
    """The numbers of a contiguous array (n, m) from this one on, as an array of one axis that shares them."""

    def generate(context, builder, sig, arguments):
        whole = context.make_array(sig.args[0])(context, builder, arguments[0])
        row = context.make_array(sig.return_type)(context, builder)
        length = builder.sub(whole.nitems, arguments[1])
        data = builder.gep(whole.data, [arguments[1]], source_etype=REAL)
        populate_array(row, data, [length], [ir.Constant(WORD, 8)], ir.Constant(WORD, 8), None)
        return row._getvalue()

    return types.Array(types.float64, 1, "C")(array, types.int64), generate


@intrinsic
def load(typing, array, first):
    """array[first : first + 8] of a contiguous array of floats, whatever its length."""

    def generate(context, builder, sig, arguments):
        value = builder.load(_place(context, builder, sig, arguments), typ=VECTOR)
        value.align = 8
        return value

    return lanes(array, types.int64), generate


@intrinsic
def store(typing, array, first, value):
    """array[first : first + 8] = value."""

    def generate(context, builder, sig, arguments):
        builder.store(arguments[2], _place(context, builder, sig, arguments)).align = 8
        return context.get_dummy_value()

    return types.void(array, types.int64, lanes), generate


@intrinsic
def spread(typing, number):
    """Eight times the same number."""

    def generate(context, builder, sig, arguments):
        return _spread(builder, arguments[0])

    return lanes(types.float64), generate


@intrinsic
def first(typing, a):
    """The first of eight."""

    def generate(context, builder, sig, arguments):
        return builder.extract_element(arguments[0], ir.Constant(SHORT, 0))

    return types.float64(lanes), generate


@intrinsic
def aligned_stack(typing):
    """Let the function keep what has no room in registers at multiples of 64 bytes: else LLVM may place eight numbers
    across two pages of memory, where each time that they are written or read costs tens of cycles. To be called once in
    a function that computes with lanes."""

    def generate(context, builder, sig, arguments):
        with builder.goto_entry_block():
            place = builder.alloca(VECTOR)
            place.align = 64
        # an instruction that is none, but could read the place: so it stays
        builder.asm(ir.FunctionType(ir.VoidType(), [place.type]), "", "r", [place], True)
        return context.get_dummy_value()

    return types.void(), generate


def constant(values: Callable[[], np.ndarray]) -> Any:
    """An inlined function () -> eight numbers (8,), asked for when something is compiled."""

    @intrinsic
    def made(typing):
        def generate(context, builder, sig, arguments):
            return ir.Constant(VECTOR, [float(value) for value in values()])

        return lanes(), generate

    return made


@intrinsic
def product_left(typing, a, b, product):
    """a b - product, of lanes or of numbers, without rounding in between."""
    kind = lanes if lanes in (a, b, product) else types.float64

    def generate(context, builder, sig, arguments):
        if kind == lanes:
            a, b, c = (_as_lanes(builder, v, k) for v, k in zip(arguments, sig.args, strict=True))
            return _llvm(builder, "llvm.fma.v8f64", a, b, builder.fneg(c))
        return builder.fma(arguments[0], arguments[1], builder.fneg(arguments[2]))

    return kind(a, b, product), generate


def taken(*places: int) -> Any:
    """An inlined function (a, b) -> eight of the sixteen numbers of both: those of a are 0 to 7, those of b 8 to 15."""

    @intrinsic
    def take(typing, a, b):
        def generate(context, builder, sig, arguments):
            return _shuffled(builder, *arguments, places)

        return lanes(lanes, lanes), generate

    return take


def _folded(fold: Callable[..., Any]) -> Any:
    """An inlined function: lanes -> one number; fold (builder, low half, high half)."""

    @intrinsic
    def folded(typing, a):
        def generate(context, builder, sig, arguments):
            value = arguments[0]
            for half in (4, 2, 1):
                low = _shuffled(builder, value, value, range(half))
                value = fold(builder, low, _shuffled(builder, value, value, range(half, 2 * half)))
            return builder.extract_element(value, ir.Constant(SHORT, 0))

        return types.float64(lanes), generate

    return folded


total = _folded(lambda builder, a, b: builder.fadd(a, b))
smallest = _folded(lambda builder, a, b: builder.select(builder.fcmp_ordered("<", a, b), a, b))  # of numbers: not a NaN


def product_with(table: Callable[[], np.ndarray], chains: int = 2) -> Any:
    """An inlined function (array, first): the sum over j of table[:, j] array[first + j], for a table (8, n) that
    becomes part of the code when something is compiled. chains : independent sums, which the processor works on at
    once."""

    @intrinsic
    def product(typing, array, start):
        def generate(context, builder, sig, arguments):
            data = context.make_array(sig.args[0])(context, builder, arguments[0]).data
            sums: list[Any] = [None] * chains
            for j, column in enumerate(np.asarray(table(), float).T.tolist()):
                place = builder.gep(data, [builder.add(arguments[1], ir.Constant(WORD, j))], source_etype=REAL)
                value = _spread(builder, builder.load(place, typ=REAL))
                term = builder.fmul(ir.Constant(VECTOR, column), value, flags=FREE)
                before = sums[j % chains]
                sums[j % chains] = term if before is None else builder.fadd(before, term, flags=FREE)
            while len(sums) > 1:
                sums = [builder.fadd(a, b) for a, b in zip(sums[::2], sums[1::2], strict=True)]
            return sums[0]

        return lanes(array, types.int64), generate

    return product


def products_with(table: Callable[[], np.ndarray]) -> Any:
    """An inlined function (array, first): the same for three rows of n numbers, one after the other, at once. The table
    is read from memory, column by column, and what is computed before and after stays apart: mixed, it would take more
    registers than there are."""

    @intrinsic
    def products(typing, array, start):
        def generate(context, builder, sig, arguments):
            data = context.make_array(sig.args[0])(context, builder, arguments[0]).data
            columns = np.asarray(table(), float).T
            kept = _in_memory(builder.module, columns)
            _apart(builder)
            sums: list[Any] = [None] * 3
            for j in range(len(columns)):
                place = builder.gep(kept, [ir.Constant(WORD, 0), ir.Constant(WORD, j * COUNT)])
                column = builder.load(builder.bitcast(place, VECTOR.as_pointer()), typ=VECTOR)
                column.align = 64
                for i in range(3):
                    offset = builder.add(arguments[1], ir.Constant(WORD, j + i * len(columns)))
                    value = _spread(builder, builder.load(builder.gep(data, [offset], source_etype=REAL), typ=REAL))
                    term = builder.fmul(column, value, flags=FREE)
                    sums[i] = term if sums[i] is None else builder.fadd(sums[i], term, flags=FREE)
            _apart(builder)
            return context.make_tuple(builder, sig.return_type, sums)

        return types.UniTuple(lanes, 3)(array, types.int64), generate

    return products


def _apart(builder):
    """Nothing that reads or writes memory is moved from one side of this to the other."""
    builder.asm(ir.FunctionType(ir.VoidType(), []), "", "~{memory}", [], True)


def _in_memory(module, columns):
    """A table (n, 8) as numbers in memory, beside the code: they are then read by their place in it."""
    numbers = columns.ravel().tolist()
    name = "sailviz.table." + sha256(columns.tobytes()).hexdigest()[:16]
    known = module.globals.get(name)
    if known is not None:
        return known
    kind = ir.ArrayType(REAL, len(numbers))
    kept = ir.GlobalVariable(module, kind, name)
    kept.initializer = ir.Constant(kind, numbers)
    kept.linkage = "linkonce_odr"
    kept.align = 64
    return kept
