"""How an `Entry` gets at its arguments: compiled code reads arrays and floats where they lie."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numba
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array

from sailviz.compiled import memory

if TYPE_CHECKING:
    from sailviz.compiled.entries import Kind

TYPES = 3  # in the tuple: `entries.TYPES`
WORD, REAL, SMALL, BYTE, BIT = ir.IntType(64), ir.DoubleType(), ir.IntType(32), ir.IntType(8), ir.IntType(1)


def unpacking(kinds: Sequence[Kind]) -> tuple[Any, Any]:
    """(fits, arguments) for compiled code. fits (tuple, place) : whether the arguments at a place are of these kinds;
    the tuple, by its address too, has the types of arrays, of floats and of numpy's floats, which lie alike.
    arguments (place) : what they are, to be asked only if they are."""
    wanted = [_type(kind) for kind in kinds]

    @intrinsic
    def fits(typing: Any, tuple_: Any, place: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            array_type, *float_types = (_at(builder, values[0], memory.ITEMS + 8 * n, WORD) for n in range(TYPES))
            good = ir.Constant(BIT, 1)
            for n, kind in enumerate(kinds):
                item = _at(builder, values[1], 8 * n, WORD)
                if kind.is_array:
                    # a subclass of ndarray may lie otherwise: what is no array is not looked into
                    is_one = builder.icmp_signed("==", _at(builder, item, memory.TYPE, WORD), array_type)
                    with builder.if_else(is_one) as (then, otherwise):
                        with then:
                            as_wanted = _fits(builder, item, kind)
                            looked = builder.block
                        with otherwise:
                            not_looked = builder.block
                    fit = builder.phi(BIT)
                    fit.add_incoming(as_wanted, looked)
                    fit.add_incoming(ir.Constant(BIT, 0), not_looked)
                else:
                    own_type = _at(builder, item, memory.TYPE, WORD)
                    one, other = (builder.icmp_signed("==", own_type, known) for known in float_types)
                    fit = builder.or_(one, other)
                good = builder.and_(good, fit)
            return good

        return types.boolean(types.int64, types.int64), generate

    @intrinsic
    def arguments(typing: Any, place: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            found = []
            for n, (kind, numba_type) in enumerate(zip(kinds, wanted, strict=True)):
                item = _at(builder, values[0], 8 * n, WORD)
                if kind.is_array:
                    found.append(_array(context, builder, item, kind, numba_type))
                else:
                    number = _at(builder, item, memory.NUMBER, REAL)
                    found.append(builder.bitcast(number, WORD) if kind.word == "i" else number)
            return context.make_tuple(builder, signature.return_type, found)

        return types.Tuple(wanted)(types.int64), generate

    return fits, arguments


def _type(kind: Kind) -> Any:
    """numba's type of an argument."""
    number = numba.from_dtype(kind.dtype)
    return types.Array(number, kind.axes, "C") if kind.is_array else number


def _at(builder: Any, address: Any, offset: int, kind: Any) -> Any:
    """What stands so many bytes behind an address."""
    place = builder.inttoptr(builder.add(address, ir.Constant(WORD, offset)), kind.as_pointer())
    return builder.load(place, typ=kind)


def _fits(builder: Any, array: Any, kind: Kind) -> Any:
    """Whether an array has the axes, the dtype and the order of a kind."""
    flags = memory.C_ORDER | memory.ALIGNED | (memory.WRITEABLE if kind.written else 0)
    dtype = _at(builder, array, memory.DTYPE, WORD)
    good = ir.Constant(BIT, 1)
    for found, right in (
        (_at(builder, array, memory.AXES, SMALL), ir.Constant(SMALL, kind.axes)),
        (builder.and_(_at(builder, array, memory.FLAGS, SMALL), ir.Constant(SMALL, flags)), ir.Constant(SMALL, flags)),
        (_at(builder, dtype, memory.LETTER, BYTE), ir.Constant(BYTE, ord(kind.dtype.kind))),
        (_at(builder, dtype, memory.ORDER, BYTE), ir.Constant(BYTE, ord(kind.dtype.byteorder))),
        (_at(builder, dtype, memory.SIZE, WORD), ir.Constant(WORD, kind.dtype.itemsize)),
    ):
        good = builder.and_(good, builder.icmp_signed("==", found, right))
    return good


def _array(context: Any, builder: Any, item: Any, kind: Kind, numba_type: Any) -> Any:
    """An array as numba hands it on."""
    array = context.make_array(numba_type)(context, builder)
    shape, strides = _at(builder, item, memory.SHAPE, WORD), _at(builder, item, memory.STRIDES, WORD)
    populate_array(
        array,
        builder.inttoptr(_at(builder, item, memory.DATA, WORD), array.data.type),
        [_at(builder, shape, 8 * i, WORD) for i in range(kind.axes)],
        [_at(builder, strides, 8 * i, WORD) for i in range(kind.axes)],
        ir.Constant(WORD, kind.dtype.itemsize),
        meminfo=None,
    )
    return array._getvalue()
