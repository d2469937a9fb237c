"""Machine code on disk is used again only while every source that it was made of stands as it stood, and only if it is
whole and one's own; whatever is wrong with it, it is compiled anew."""

from __future__ import annotations

import ast
import json
import os
import stat
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256
from pathlib import Path

import pytest

import sailviz
from sailviz.compiled import machine_code
from sailviz.compiled.machine_code import CannotLoadError, MachineCode

PACKAGE = Path(sailviz.__file__).parent
DECORATORS = {"compiled", "inlined", "called", "summing", "entry", "c_function", "late"}

SOURCE = """
from sailviz.compiled import called, entry

@called
def half(x):
    return 0.5 * x

@entry("d1 D1 d i")
def scaled(x, out, factor, first):
    for i in range(first, len(x)):
        out[i] = 2.0 * factor * half(x[i])
    return len(x) - first
"""
USE = """
import sys
import numpy as np
from doubling import scaled

out = np.zeros(3)
print(scaled(np.arange(3.0), out, 2.5, 1), out.tolist(), "numba" in sys.modules)
"""
GOOD = "2 [0.0, 2.5, 5.0]"


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
def test_a_module_that_compiles_and_what_it_reads_are_among_the_sources(file):
    sources = {PACKAGE / name for name, _ in machine_code.sources()}
    assert file in sources
    for module, name in imports(file):  # constants and functions from there are frozen into the machine code
        place = PACKAGE.joinpath(*module.split(".")[1:])
        homes = [place / f"{name}.py", place.with_suffix(".py"), place / "__init__.py"]
        home = next((home for home in homes if home.is_file()), None)
        assert home in sources, f"{module} {name}"


class Use:
    """A program that uses an entry of a module of its own, with a folder of its own for its machine code."""

    def __init__(self, folder):
        self.folder, self.cache = folder, folder / "cache"
        (folder / "doubling.py").write_text(SOURCE)

    def __call__(self, **environment):
        """What it prints, in a process of its own."""
        paths = [str(self.folder), str(PACKAGE.parent)]
        given = {"PYTHONPATH": os.pathsep.join(paths), "NUMBA_CACHE_DIR": str(self.cache), "HOME": str(self.folder)}
        environment = {**os.environ, **given, **environment}
        done = subprocess.run([sys.executable, "-c", USE], capture_output=True, text=True, env=environment)
        assert done.returncode == 0, done.stderr
        return done.stdout.strip()

    @property
    def file(self):
        """The one object that there is."""
        (found,) = self.cache.glob("doubling.scaled-*.object")
        return found


@pytest.fixture
def use(tmp_path):
    return Use(tmp_path)


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A Use whose machine code is on disk, and its content; what harms it puts it back."""
    use = Use(tmp_path_factory.mktemp("kept"))
    assert use() == f"{GOOD} True"
    return use, use.file, use.file.read_bytes()


def test_machine_code_is_found_again_without_the_compiler(use):
    assert use() == f"{GOOD} True"
    assert use() == f"{GOOD} False"


HARMS = {
    "cut": lambda content: content[: len(content) // 2],
    "empty": lambda content: b"",
    "longer": lambda content: content + b"x",
    "flipped": lambda content: content[:-1000] + bytes([content[-1000] ^ 4]) + content[-999:],
    "flipped head": lambda content: content[:70] + bytes([content[70] ^ 4]) + content[71:],
}


@pytest.mark.parametrize("harm", HARMS)
def test_a_harmed_object_is_compiled_anew_and_replaced(kept, harm):
    use, file, content = kept
    file.write_bytes(HARMS[harm](content))
    assert use() == f"{GOOD} True"
    assert use() == f"{GOOD} False"


def test_what_is_no_regular_file_is_not_read(kept):
    use, file, content = kept
    file.unlink()
    os.mkfifo(file)  # would be waited for
    assert use() == f"{GOOD} True"
    file.unlink()
    file.mkdir()
    assert use() == f"{GOOD} True"
    file.rmdir()
    file.write_bytes(content)
    assert use() == f"{GOOD} False"


def test_an_object_that_anybody_may_write_is_not_read(kept):
    use, file, _ = kept
    file.chmod(0o666)
    assert use() == f"{GOOD} True"
    assert not file.stat().st_mode & stat.S_IWOTH
    assert use() == f"{GOOD} False"


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root can give a file away")
def test_an_object_that_belongs_to_somebody_else_is_not_read(kept):
    use, file, _ = kept
    os.chown(file, 12345, -1)
    assert use() == f"{GOOD} True"
    assert file.stat().st_uid == os.geteuid()


def test_where_nothing_can_be_written_code_is_compiled_in_every_process(use, tmp_path):
    """Folders below a file and in /proc cannot be made, by root neither."""
    (tmp_path / "file").write_text("")
    nowhere = {"NUMBA_CACHE_DIR": "/proc/sailviz", "XDG_CACHE_HOME": str(tmp_path / "file")}
    program = "from pathlib import Path; from sailviz.compiled import machine_code\n"
    program += f"machine_code.PACKAGE = Path({str(tmp_path / 'file')!r}); machine_code.sources = lambda: ()\n"
    for _ in range(2):
        paths = os.pathsep.join([str(tmp_path), str(PACKAGE.parent)])
        done = subprocess.run(
            [sys.executable, "-c", program + USE],
            capture_output=True,
            text=True,
            env={**os.environ, **nowhere, "PYTHONPATH": paths},
        )
        assert (done.stdout.strip(), done.stderr) == (f"{GOOD} True", "")


def test_a_full_disk_leaves_nothing_half_written(use, monkeypatch, tmp_path):
    """/dev/full answers every write with ENOSPC; what stood there before is still whole."""
    assert use() == f"{GOOD} True"
    before = use.file.read_bytes()
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(use.cache))
    monkeypatch.setattr("builtins.open", lambda *_: os.fdopen(os.open("/dev/full", os.O_WRONLY), "wb", buffering=0))
    machine_code.keep(one, MachineCode("f", (), b"code"))
    monkeypatch.undo()
    assert list(use.cache.glob("*one*")) == []
    assert use.file.read_bytes() == before


def test_two_processes_that_compile_at_once_both_succeed(use):
    with ThreadPoolExecutor(2) as pool:
        assert list(pool.map(lambda _: use(), range(2))) == [f"{GOOD} True"] * 2
    assert use() == f"{GOOD} False"
    assert len(list(use.cache.glob("*object*"))) == 1


def one():
    """Somebody's function."""


def one_more():
    """And another, whose name begins alike."""


def test_somebodys_own_function_is_compiled_anew_when_its_file_changes(use):
    assert use() == f"{GOOD} True"
    (use.folder / "doubling.py").write_text(SOURCE.replace("2.0", "4.0"))
    assert use() == "2 [0.0, 5.0, 10.0] True"
    (use.folder / "doubling.py").write_text(SOURCE)
    assert use() == f"{GOOD} False"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder for machine code, in this process."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    machine_code.key.cache_clear()
    yield tmp_path
    machine_code.key.cache_clear()


def test_only_the_newest_objects_of_a_function_stay(folder, monkeypatch):
    for number in range(20):
        machine_code.key.cache_clear()
        monkeypatch.setattr(machine_code, "FORMAT", number)
        machine_code.keep(one, MachineCode("f", (), f"{number}".encode()))
        machine_code.keep(one_more, MachineCode("f", (), b"code"))
        (new,) = (file for file in folder.glob("*.one-*") if file.stat().st_mtime > 100)
        os.utime(new, (number, number))
    assert sorted(file.stat().st_mtime for file in folder.glob("*.one-*")) == list(range(14, 20))
    assert len(list(folder.glob("*.one_more-*"))) == machine_code.KEPT


def test_what_comes_back_is_what_was_kept(folder):
    made = MachineCode("_ZN3f", ("cos", "pow"), bytes(range(256)) + b"\n")
    machine_code.keep(one, made)
    assert machine_code.kept(one) == made
    assert machine_code.kept(one_more) is None


@pytest.mark.parametrize(
    "patched",
    [
        ("sources", lambda: (("compiled/entries.py", "0" * 16),)),
        ("version", lambda name: "1.0"),
        ("FORMAT", 99),
        ("platform.machine", lambda: "sparc"),
    ],
    ids=lambda patched: patched[0],
)
def test_the_key_depends_on_all_that_machine_code_depends_on(folder, monkeypatch, patched):
    before = machine_code.key()
    machine_code.key.cache_clear()
    monkeypatch.setattr(f"sailviz.compiled.machine_code.{patched[0]}", patched[1])
    assert machine_code.key() != before


def test_the_key_depends_on_the_processor_that_numba_is_told_to_compile_for_but_not_on_where_the_cache_is(
    folder, monkeypatch
):
    keys = [machine_code.key()]
    for name, value in (("NUMBA_CPU_NAME", "haswell"), ("NUMBA_CACHE_DIR", str(folder / "other"))):
        machine_code.key.cache_clear()
        monkeypatch.setenv(name, value)
        keys.append(machine_code.key())
    assert keys[0] != keys[1] == keys[2]


def test_the_sources_are_hashed_by_their_content():
    hashes = dict(machine_code.sources())
    content = (PACKAGE / "propagate" / "dop853.py").read_bytes()
    assert hashes["propagate/dop853.py"] == sha256(content).hexdigest()[:16]


def test_a_function_that_is_missing_is_told_before_the_linker_would_end_the_process():
    with pytest.raises(CannotLoadError, match="no_such_function"):
        machine_code.load(MachineCode("f", ("cos", "no_such_function"), b""))


LOW = {"propagation.duration_d": 2, "expect": []}
SCENES = {
    "displaced/circular": {},
    "spirals/optical-sail": {},
    "deorbit/foresail-1": LOW,  # tables, a spinning tether, DOP853
    "deorbit/drag-only": LOW,
    "deorbit/satellite-100kg": LOW | {"propagation.integrator": "gauss-jackson"},
    "transfers/lyapunov-spiral": {},
    "wind/held-displaced": {"expect": []},  # an ensemble
}


@pytest.mark.parametrize("scene", SCENES)
def test_the_second_run_of_a_scene_imports_no_compiler(tmp_path, scene):
    settings = [word for key, value in SCENES[scene].items() for word in ("--set", f"{key}={json.dumps(value)}")]
    words = ["sailviz", "run", scene, "-q", "-o", str(tmp_path / "run.rrd"), *settings]
    program = (
        "import runpy, sys\n"
        f"sys.argv = {words!r}\n"
        "try:\n"
        "    runpy.run_module('sailviz', run_name='__main__')\n"
        "except SystemExit as end:\n"
        "    assert not end.code, end.code\n"
        "print('numba' in sys.modules)"
    )
    sailviz.simulate(sailviz.load_scene(scene).with_values(SCENES[scene]))
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "False\n"
