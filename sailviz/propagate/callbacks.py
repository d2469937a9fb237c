"""Machine code that the right-hand side calls by its address: what only some scenes need, and what a user brings.

The propagator itself stays one cached piece of machine code, compiled once; a callback is compiled, and cached, when
the first scene asks for it. So a steering law, a device or a force of the environment need not touch dynamics.py: a
module-level function of SIGNATURE beside its formula, and `callback(function, numbers)` in the record of its kind.

    NUMBERS = layout(Parameters)

    def force(time, state, parameters, own, number, out):
        s, p, a = array_at(state, STATE), record_at(own, NUMBERS), array_at(out, 4)

`layout` and STATE come from sailviz.compiled, array_at and record_at from parameters.py; Parameters is a NamedTuple of
floats, the callback's own numbers. Like an `entry`, a callback creates no array and raises nothing.

What comes out, four numbers: of a steering law the normal, made a unit vector (zero: no thrust), and the throttle; of a
device the acceleration m/s2 at thrust factor `number` and the mass flow kg/s; of a force the acceleration m/s2 and
the mass flow kg/s, `number` the thrust factor; of a voltage control the thrust factor from break `number` on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from sailviz.compiled import c_function, inlined, late

# how numba writes it: time, state (7,) in, vector (3,) out
USER_SIGNATURE = "void(float64, CPointer(float64), CPointer(float64))"

call_at = late("sailviz.propagate.intrinsics", "call_at")
user_vector = late("sailviz.propagate.intrinsics", "user_vector")


def _signature() -> Any:
    from sailviz.propagate.intrinsics import SIGNATURE

    return SIGNATURE


class Callback(NamedTuple):
    """A function of SIGNATURE (intrinsics.py), in numba's convention, and the numbers that are its own."""

    address: int
    numbers: Sequence[float] = ()


def callback(function: Callable[..., None], numbers: Sequence[float] = ()) -> Callback:
    """A function of SIGNATURE, compiled on first use."""
    return Callback(c_function(function, _signature)[0], numbers)


@inlined
def call(address, place, t, x, y, z, vx, vy, vz, m, nx, ny, nz, p, number):
    """Four numbers from the function of SIGNATURE at an integer address, its own numbers at a place of the tables."""
    own = p.places.address + 8 * place
    return call_at(address, own, t, x, y, z, vx, vy, vz, m, nx, ny, nz, p, number)


def user_address(function: Any, kind: str) -> tuple[int, object]:
    """Address of a user's law or force as a C function, and the object that keeps it alive.

    function : a numba.cfunc of USER_SIGNATURE, or an @njit function (t, x, y, z, vx, vy, vz, m) -> three floats.
    kind : word for the error message. TypeError for anything else, and for what does not compile.
    """
    if hasattr(function, "address") and hasattr(function, "native_name"):
        return int(function.address), function
    import numba

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
