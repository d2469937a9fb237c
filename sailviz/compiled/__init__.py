"""How sailviz compiles: machine code is kept on disk and found again without the compiler, which is imported only where
something has to be compiled.

A kernel that Python calls is an `entry`; what entries call is `inlined`, `called` or `apart`; what a scene brings along
is a C function (`c_function`). None of these imports numba when it is decorated, loaded or called, if its machine code
is on disk.

    @entry("F2 I1 p1 f1 i", PARAMETERS)
    def advance_compiled(work, count, parameters, times, piece):
        ...
        return status  # an integer, never negative

An entry may read and write the arrays it is given, but create none: it is compiled without reference counting. Its
arrays are made, copied and cut to size by the Python function that calls it. It raises nothing, and calls nothing that
is compiled in its own right (`compiled`). Whatever needs numba when it is written down, an intrinsic or a type of
its own, stands in a module that only `late` names import.

`compiled` is for everything else: compiled for whatever it is called with, cached in numba's own way, and so numba is
imported where it is called.
"""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.compiled.decorators import OPTIONS as OPTIONS
    from sailviz.compiled.decorators import Late as Late
    from sailviz.compiled.decorators import apart as apart
    from sailviz.compiled.decorators import called as called
    from sailviz.compiled.decorators import compiled as compiled
    from sailviz.compiled.decorators import inlined as inlined
    from sailviz.compiled.decorators import late as late
    from sailviz.compiled.decorators import summing as summing
    from sailviz.compiled.entries import Entry as Entry
    from sailviz.compiled.entries import c_function as c_function
    from sailviz.compiled.entries import entry as entry
    from sailviz.compiled.layouts import STATE as STATE
    from sailviz.compiled.layouts import layout as layout
    from sailviz.compiled.waiting import when_long as when_long

_HOMES = {
    "OPTIONS": "decorators",
    "Late": "decorators",
    "apart": "decorators",
    "called": "decorators",
    "compiled": "decorators",
    "inlined": "decorators",
    "late": "decorators",
    "summing": "decorators",
    "Entry": "entries",
    "c_function": "entries",
    "entry": "entries",
    "STATE": "layouts",
    "layout": "layouts",
    "when_long": "waiting",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
