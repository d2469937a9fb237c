"""The compiler's side: numba is imported here, and only where something has to be compiled."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import llvmlite.binding as llvm
import numba
from llvmlite import ir
from numba.core import registry, sigutils, types
from numba.core.ccallback import CFunc
from numba.core.codegen import CPUCodeLibrary, JITCodeLibrary
from numba.core.compiler_lock import global_compiler_lock
from numba.core.types.functions import BaseFunction

from sailviz.compiled.decorators import BARE, OPTIONS, WITHIN, stamp
from sailviz.compiled.machine_code import MachineCode

KNOWN_WITHOUT_NUMBA = ("numba_nextafter",)  # of numba's own functions: see machine_code
WORD, STATUS, POINTER = ir.IntType(64), ir.IntType(32), ir.IntType(8).as_pointer()
MISFIT, FAILED = -1, -2  # what a function for Python returns where it was not called, and where it failed


def compile_native(function: Callable[..., Any], signature: Any, merged: str = "") -> MachineCode | None:
    """Machine code of a function in numba's own convention, int status(*result, **error, arguments ...). None where it
    would call functions of numba's, such as those that count references.

    function : compiled without reference counting. signature : of numba, or how numba writes it. merged : name of one
    that it alone calls, which is optimised as part of it only.
    """
    made = _compile(function, signature, merged)
    return None if made is None else MachineCode(made[0], _needs(made[1]), made[2].emit_object(made[1]))


def compile_for_python(function: Callable[..., Any], merged: str, count: int) -> MachineCode | None:
    """Machine code of a function of Python's own, of `count` arguments, which returns an integer; None as above.

    function : int64(int64, int64), of the address of a tuple and of that where the arguments stand; merged : as above.
    """
    made = _compile(function, "int64(int64, int64)", merged)
    if made is None:
        return None
    name, module, machine = made
    way_in = _way_in(name, count)
    way_in.triple, way_in.data_layout = module.triple, module.data_layout
    module.link_in(llvm.parse_assembly(str(way_in)))
    return MachineCode(way_in.name, _needs(module), machine.emit_object(module))


def _way_in(name: str, count: int) -> ir.Module:
    """A function as Python calls those that are built in, PyObject *(PyObject *self, PyObject **arguments, n), which
    calls the compiled one with the addresses of both while other threads of Python may run."""
    module = ir.Module(name + ".from_python")

    def known(name: str, result: ir.Type, *arguments: ir.Type) -> ir.Function:
        return ir.Function(module, ir.FunctionType(result, arguments), name)

    compiled = known(name, STATUS, WORD.as_pointer(), POINTER.as_pointer(), WORD, WORD)
    pause, go_on = known("PyEval_SaveThread", POINTER), known("PyEval_RestoreThread", ir.VoidType(), POINTER)
    number = known("PyLong_FromLongLong", POINTER, WORD)
    way_in = known(module.name, POINTER, POINTER, POINTER, WORD)
    builder = ir.IRBuilder(way_in.append_basic_block())
    answer, error = builder.alloca(WORD), builder.alloca(POINTER)
    builder.store(ir.Constant(WORD, MISFIT), answer)
    itself, arguments, given = way_in.args
    with builder.if_then(builder.icmp_signed("==", given, ir.Constant(WORD, count))):
        thread = builder.call(pause, ())
        places = builder.ptrtoint(itself, WORD), builder.ptrtoint(arguments, WORD)
        status = builder.call(compiled, (answer, error, *places))
        builder.call(go_on, (thread,))
        with builder.if_then(builder.icmp_signed("!=", status, ir.Constant(STATUS, 0))):
            builder.store(ir.Constant(WORD, FAILED), answer)
    builder.ret(builder.call(number, (builder.load(answer),)))
    return module


def _needs(module: Any) -> tuple[str, ...]:
    return tuple(one.name for one in module.functions if one.is_declaration and not one.name.startswith("llvm."))


def _compile(function: Callable[..., Any], signature: Any, merged: str) -> tuple[str, Any, Any] | None:
    """(name, its module, what makes machine code of it)."""
    njit: Any = numba.njit
    with global_compiler_lock, _object_only(), _remembered_types(), _optimised_once(merged):
        dispatcher = njit(signature, **BARE, **WITHIN)(function)
        (result,) = dispatcher.overloads.values()
        library = result.library
        library._ensure_finalized()
    module = library._final_module
    needs = _needs(module)
    if any(name.startswith(("numba_", "NRT_", "Py")) and name not in KNOWN_WITHOUT_NUMBA for name in needs):
        return None
    return result.fndesc.llvm_func_name, module, library._codegen._tm


def compile_by_numba(function: Callable[..., Any], signature: Any) -> tuple[int, object]:
    """(address, what keeps it alive) of a function in numba's convention, which numba keeps on disk and finds again,
    for a function that does not do without numba."""
    options = {option: value for option, value in OPTIONS.items() if option != "nogil"}
    made: Any = CFunc(function, sigutils.normalize_signature(signature), {}, options)
    try:
        made.enable_caching()
    except RuntimeError:  # nowhere to write
        made = CFunc(function, sigutils.normalize_signature(signature), {}, options)
    stamp(made)
    made.compile()
    native = made._wrapper_name.removeprefix("cfunc.")  # beside the C function stands the one that it calls
    return int(made._library.get_pointer_to_function(native)), made


@contextmanager
def _replaced(owner: type, name: str, other: Callable[..., Any]) -> Iterator[None]:
    """Let a class have another method for a while."""
    inherited, own = name not in owner.__dict__, getattr(owner, name)
    setattr(owner, name, other)
    try:
        yield
    finally:
        if inherited:
            delattr(owner, name)
        else:
            setattr(owner, name, own)


@contextmanager
def _object_only() -> Iterator[None]:
    """Let numba neither make machine code of each function that is called, all of which are merged into the one that is
    wanted, nor ways into them for Python: a quarter of the time."""

    def merged(library: Any) -> None:
        library._finalized = True

    def none(context: Any, library: Any, description: Any, environment: Any) -> Callable[[Any], None]:
        return [].append  # something that can be kept

    context: type = type(registry.cpu_target.target_context)
    with (
        _replaced(JITCodeLibrary, "_finalize_final_module", merged),
        _replaced(context, "get_executable", none),
    ):
        yield


@contextmanager
def _optimised_once(name: str) -> Iterator[None]:
    """Leave the function of this name to the optimiser of the one that calls it: a tenth of the time."""
    optimise: Callable[[Any], None] = CPUCodeLibrary._optimize_final_module

    def others(library: Any) -> None:
        if library.name != name:
            optimise(library)

    with _replaced(CPUCodeLibrary, "_optimize_final_module", others):
        yield


@contextmanager
def _remembered_types() -> Iterator[None]:
    """Let numba find once what an operator or a function of its own makes of arguments of given types, where it would
    try all that it knows at every place in the code: a sixth of the time."""
    known: dict[Any, tuple[Any, Any]] = {}
    find: Callable[..., Any] = BaseFunction.get_call_type

    def remembered(function: Any, context: Any, arguments: tuple[types.Type, ...], named: dict[str, types.Type]) -> Any:
        at = id(function), arguments, tuple(sorted(named.items()))
        if at not in known:
            known[at] = find(function, context, arguments, named), function  # kept, lest its id become another's
        return known[at][0]

    with _replaced(BaseFunction, "get_call_type", remembered):
        yield
