"""Machine code on disk is used again only while every source that it was made of stands as it stood."""

import ast
import importlib.util
from pathlib import Path

import numpy as np
import pytest

import sailviz
from sailviz import compiled as compiling

PACKAGE = Path(sailviz.__file__).parent
DECORATORS = {"compiled", "inlined", "called", "cached_c_function"}

SOURCE = """
from sailviz.compiled import compiled

def twice(x):
    return 2.0 * x
"""


def imports(file):
    """(module, name) of everything that a source file imports from sailviz, wherever in it."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "sailviz":
            yield from ((node.module, alias.name) for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from ((alias.name, "") for alias in node.names if alias.name.partition(".")[0] == "sailviz")


def compiles(file):
    """Whether a source file takes a decorator that compiles, or the module that has them."""
    return any(
        (module == "sailviz.compiled" and name in DECORATORS | {""}) or (module, name) == ("sailviz", "compiled")
        for module, name in imports(file)
    )


COMPILING = sorted(file for file in PACKAGE.rglob("*.py") if compiles(file))


def test_modules_that_compile_are_found():
    names = {file.relative_to(PACKAGE).as_posix() for file in COMPILING}
    assert {"propagate/dop853.py", "propulsion/solar_sail.py", "environment/eclipse.py", "steering/optimal.py"} <= names


@pytest.mark.parametrize("file", COMPILING, ids=lambda file: file.relative_to(PACKAGE).as_posix())
def test_a_module_that_compiles_and_what_it_reads_are_stamped(file):
    stamped = {PACKAGE / name for name, _, _ in compiling._SOURCES}
    assert file in stamped
    for module, name in imports(file):  # constants and functions from there are frozen into the machine code
        place = PACKAGE.joinpath(*module.split(".")[1:])
        homes = [place / f"{name}.py", place.with_suffix(".py"), place / "__init__.py"]
        home = next((home for home in homes if home.is_file()), None)
        assert home in stamped, f"{module} {name}"


@pytest.fixture
def twice(tmp_path, monkeypatch):
    """A function of a module of its own, whose machine code goes to a folder of its own."""
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path / "cache"))
    file = tmp_path / "doubling.py"
    file.write_text(SOURCE)
    spec = importlib.util.spec_from_file_location("doubling", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.twice


def test_machine_code_is_found_again_until_a_stamped_source_changes(twice, monkeypatch):
    first = compiling.compiled(twice)
    assert not compiling.is_compiled(first)
    assert first(np.pi) == 2 * np.pi
    assert compiling.is_compiled(compiling.compiled(twice))
    for i in (0, len(compiling._SOURCES) // 2, len(compiling._SOURCES) - 1):
        name, time, size = compiling._SOURCES[i]
        for changed in ((name, time + 1, size), (name, time, size + 1)):
            sources = (*compiling._SOURCES[:i], changed, *compiling._SOURCES[i + 1 :])
            with monkeypatch.context() as patched:
                patched.setattr(compiling, "_SOURCES", sources)
                assert not compiling.is_compiled(compiling.compiled(twice))
    assert compiling.is_compiled(compiling.compiled(twice))
