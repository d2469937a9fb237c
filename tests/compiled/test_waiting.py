"""Who waits because something is compiled is told so, once; who does not wait is told nothing."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import sailviz
from sailviz.cli.shared import say_if_compiling
from sailviz.compiled import entries, entry, machine_code, waiting
from sailviz.propagate import collocation, dynamics
from sailviz.sweeps import engines


@entry("d1 D1")
def doubled(x, out):
    for i in range(len(x)):
        out[i] = 2.0 * x[i]
    return len(x)


@pytest.fixture
def told(monkeypatch):
    """What a listener hears; compilation of a tenth of a second is long."""
    monkeypatch.setattr(waiting, "LONG", 0.1)
    monkeypatch.setattr(waiting, "_listening", [])
    heard = []
    waiting.when_long(lambda: heard.append("compiling"))
    return heard


def test_a_long_compilation_is_told_once_and_a_short_one_is_not(told):
    with waiting.compiling():
        pass
    time.sleep(0.2)
    assert told == []
    for _ in range(2):
        with waiting.compiling():
            time.sleep(0.3)
    assert told == ["compiling"]


def test_only_what_is_not_on_disk_is_compiled_and_told(told, monkeypatch):
    made = doubled._compiled()

    def slowly():
        time.sleep(0.3)
        return made

    monkeypatch.setattr(entries.machine_code, "kept", lambda function: made)
    assert entries._address(doubled.py_func, slowly)
    assert told == []
    monkeypatch.setattr(entries.machine_code, "kept", lambda function: None)
    monkeypatch.setattr(entries.machine_code, "keep", lambda function, code: None)
    assert entries._address(doubled.py_func, slowly)
    assert told == ["compiling"]
    out = np.zeros(2)
    assert doubled(np.array([1.0, 2.5]), out) == 2
    assert out.tolist() == [2.0, 5.0]


def test_a_scene_that_needs_other_machine_code_than_there_is_says_why_it_takes_so_long(tmp_path, monkeypatch):
    scene = sailviz.load_scene("displaced/circular")
    sailviz.simulate(scene)
    kernels = collocation.advance_compiled.py_func, dynamics.observe_compiled.py_func
    there = [(kernel, machine_code.kept(kernel)) for kernel in kernels]
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "code"))
    for kernel, code in there:
        machine_code.keep(kernel, code)

    def said(*more):
        command = [sys.executable, "-m", "sailviz", "run", "displaced/circular", "--set", "propagation.duration_d=30"]
        command += ["--set", "expect=[]", "--set", "propagation.outputs=30", *more]
        process = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
        assert process.returncode == 0, process.stderr
        return "Compiling for this machine" in process.stderr

    other = ("--set", "propagation.integrator=dop853")
    assert [said(), said(*other), said(*other)] == [False, True, False]


def _compiles() -> None:
    with waiting.compiling():
        time.sleep(waiting.LONG + 0.5)


@pytest.fixture
def listening(monkeypatch):
    """As after `sailviz sweep` has begun."""
    monkeypatch.setattr(waiting, "_listening", [])
    say_if_compiling(False)


@pytest.fixture
def importable(monkeypatch):
    """Processes that start afresh find what they are to do in this file, and sailviz where it was found before."""
    monkeypatch.setattr(sys, "path", [*sys.path, str(Path(__file__).parents[2])])


@pytest.mark.parametrize("name", ["threads", "processes", "dask"])
def test_of_several_workers_of_a_sweep_that_compile_at_the_same_time_one_says_so(name, listening, importable, capfd):
    if name == "dask":
        pytest.importorskip("distributed")
    with engines.engine(name, 2) as executor, executor or engines.processes(2) as pool:
        for done in [pool.submit(_compiles) for _ in range(2)]:
            done.result(timeout=120)
    assert capfd.readouterr().err.count("Compiling for this machine") == 1


def test_workers_of_a_sweep_that_nobody_listens_to_say_nothing(monkeypatch, importable, capfd):
    monkeypatch.setattr(waiting, "_listening", [])
    say_if_compiling(True)
    with engines.processes(1) as pool:
        pool.submit(_compiles).result(timeout=120)
    assert "Compiling" not in capfd.readouterr().err
