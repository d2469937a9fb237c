"""What a command costs before it does anything: CPU of the standard scene, warm and for the first time ever, and of the
commands that fly nothing. The least of several runs, each a process of its own: noise only adds. On a quiet machine."""

import os
import subprocess
import sys

import pytest

RUNS = 8


def cost(folder, *words, cache=None):
    """(CPU s, largest memory MB) of a command."""
    environment = dict(os.environ)
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    if cache is not None:
        environment["NUMBA_CACHE_DIR"] = str(cache)
    process = subprocess.Popen(
        [sys.executable, "-m", "sailviz", *words], cwd=folder, env=environment, stdout=subprocess.DEVNULL
    )
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def told(capsys, title, costs, bound):
    """The least CPU of several runs, printed."""
    least, median = min(cpu for cpu, _ in costs), sorted(cpu for cpu, _ in costs)[len(costs) // 2]
    with capsys.disabled():
        print(f"\n{title}: {least:.2f} s of CPU, median {median:.2f} s, bound {bound} s,", end=" ")
        print(f"{max(memory for _, memory in costs):.0f} MB")
    return least


def test_the_standard_scene_is_flown_and_recorded_in_a_second_and_a_half(tmp_path, capsys):
    run = "run", "displaced/circular", "-q"
    cost(tmp_path, *run)
    costs = [cost(tmp_path, *run) for _ in range(RUNS)]
    assert told(capsys, "a run", costs, 1.6) < 1.6
    assert max(memory for _, memory in costs) < 300


def test_the_first_run_ever_compiles_what_it_needs(tmp_path, capsys):
    costs = [cost(tmp_path, "run", "displaced/circular", "-q", cache=tmp_path / str(i)) for i in range(3)]
    assert told(capsys, "the first run", costs, 15) < 15


@pytest.mark.parametrize("words", [("check", "displaced/circular"), ("list",), ("show", "displaced/circular")])
def test_commands_that_fly_nothing_answer_at_once(tmp_path, capsys, words):
    cost(tmp_path, *words)
    assert told(capsys, words[0], [cost(tmp_path, *words) for _ in range(RUNS)], 0.35) < 0.35
