"""The compiler's side: numba is imported here, and only where something has to be compiled."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numba
from numba.core import registry, sigutils
from numba.core.ccallback import CFunc
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler_lock import global_compiler_lock

from sailviz.compiled.decorators import BARE, OPTIONS, WITHIN, stamp
from sailviz.compiled.machine_code import MachineCode

KNOWN_WITHOUT_NUMBA = ("numba_nextafter",)  # of numba's own functions: see machine_code


def compile_native(function: Callable[..., Any], signature: Any) -> MachineCode | None:
    """Machine code of a function in numba's own convention, int status(*result, **error, arguments ...). None where it
    would call functions of numba's, such as those that count references.

    function : compiled without reference counting. signature : of numba, or how numba writes it.
    """
    njit: Any = numba.njit
    with global_compiler_lock, _object_only():
        dispatcher = njit(signature, **BARE, **WITHIN)(function)
        (result,) = dispatcher.overloads.values()
        library = result.library
        library._ensure_finalized()
    module = library._final_module
    needs = [one.name for one in module.functions if one.is_declaration and not one.name.startswith("llvm.")]
    if any(name.startswith(("numba_", "NRT_", "Py")) and name not in KNOWN_WITHOUT_NUMBA for name in needs):
        return None
    return MachineCode(result.fndesc.llvm_func_name, tuple(needs), library._codegen._tm.emit_object(module))


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
def _object_only() -> Iterator[None]:
    """Let numba neither make machine code of each function that is called, all of which are merged into the one that is
    wanted, nor ways into them for Python: a quarter of the time."""
    library_class: Any = JITCodeLibrary
    whole = library_class._finalize_final_module
    context = registry.cpu_target.target_context

    def merged(library: Any) -> None:
        library._finalized = True

    library_class._finalize_final_module = merged
    context.get_executable = lambda library, description, environment: [].append  # something that can be kept
    try:
        yield
    finally:
        library_class._finalize_final_module = whole
        del context.get_executable
