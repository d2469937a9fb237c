"""A hash of what a run is made of."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene


def identity_of(scene: Scene, *, shape: dict[str, Any] | None = None, **functions: Any) -> str:
    """Hash of the scene and of the user's functions, each under the name of its part; and of a sail's shape, which a
    file beside the scene may hold."""
    digest = hashlib.sha256(scene.identity().encode())
    for part, function in functions.items():
        if function is not None:
            digest.update(f"{part} {_written(function)}".encode())
    if shape is not None:
        digest.update(json.dumps(shape, sort_keys=True).encode())
    return digest.hexdigest()[:16]


def _written(function: Any, seen: tuple[Any, ...] = ()) -> str:
    """What a user's function is made of: its code, its constants and what it takes from around it, functions too."""
    function = getattr(function, "py_func", getattr(function, "__wrapped__", function))
    code = getattr(function, "__code__", None)
    if isinstance(function, (int, float, complex, str, tuple, np.ndarray)):
        return repr(np.asarray(function).tolist())
    if code is None:
        return type(function).__name__
    if code in seen:
        return str(code.co_name)
    around = {name: function.__globals__[name] for name in code.co_names if name in function.__globals__}
    around |= dict(zip(code.co_freevars, (cell.cell_contents for cell in function.__closure__ or ()), strict=True))
    names = [f"{name} = {_written(value, (*seen, code))}" for name, value in around.items()]
    return f"{code.co_code.hex()} {code.co_consts} {code.co_names} {names}"
