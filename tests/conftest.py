"""What several test modules share: one propagation in canonical units, and the runs that would be dear to repeat."""

from __future__ import annotations

import os
import random
import signal
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import settings

import sailviz
from sailviz.propagate import dop853, dynamics
from sailviz.propagate.events import watch
from sailviz.shipped import shipped_scenes

# The same examples every time: a run of the tests must not depend on luck, nor on how busy the machine is. Look further
# with `pytest --hypothesis-profile=default`.
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile("repeatable")


# Processes that tests begin import sailviz as the tests do, not from the folder in which they are begun:
# else all that is compiled is compiled once more for that copy.
os.environ["PYTHONSAFEPATH"] = "1"

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # begun in the background by a shell, as are then all commands
    signal.signal(signal.SIGINT, signal.default_int_handler)


# Modules of few tests that take or wait long: begun early, lest one process ends with them while others have nothing
LONG = (
    "tests/simulation/test_interrupts.py",
    "tests/cli/test_endings.py",
    "tests/simulation/test_accuracy.py",
    "tests/compiled/test_machine_code.py",
    "tests/recording/views/test_viewers.py",
    "tests/cli/test_time_limit.py",
    "tests/compiled/test_waiting.py",
    "tests/simulation/test_no_progress.py",
    "tests/sweeps/test_loop.py",
    "tests/reports/test_reports.py",
    "tests/design/minimum_time/test_to_ends.py",
    "tests/design/asymptotic/test_solution.py",
)
EXTRAS = {"deorbit/drag-sail": "sgp4"}  # shipped scene -> what has to be installed to fly it


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Tests that need the same machine code, fixtures or flights go to one process. Not by `xdist_group`, which does
    nothing under pytest 9.2 (pytest-xdist issue 1386)."""
    from xdist.scheduler import LoadScopeScheduling

    class Together(LoadScopeScheduling):
        def _split_scope(self, nodeid):
            return belongs_to(nodeid)

        def schedule(self):
            first = self.collection is None
            super().schedule()
            for module in reversed(LONG) if first else ():
                if module in self.workqueue:
                    self.workqueue.move_to_end(module, last=False)

    return Together(config, log)


def belongs_to(test):
    """What the tests of one process are: those of a module; of a shipped scene; of what is drawn of the flights."""
    module, _, name = test.partition("::")
    if module.startswith("tests/scenes/") or module.endswith("/test_scene_names.py"):
        return name.partition("[")[2] or module
    return "truth" if module.startswith("tests/recording/truth/") else module


def pytest_runtest_setup(item):
    given = item.callspec.params.values() if hasattr(item, "callspec") else ()
    for extra in {EXTRAS[value] for value in given if isinstance(value, str) and value in EXTRAS}:
        pytest.importorskip(extra)


class Flight(NamedTuple):
    """states (6 or 7, n) at the times asked for, as far as they were reached; events [(index, time, state (7,))]."""

    states: np.ndarray
    events: list
    status: int
    integration: dop853.Integration

    @property
    def position(self):
        return self.states[:3].T

    @property
    def velocity(self):
        return self.states[3:6].T


def _fly(
    model=None,
    position=(1.0, 0.0, 0.0),
    velocity=(0.0, 1.0, 0.0),
    times=(1.0,),
    *,
    mass=1.0,
    tolerance=1e-13,
    events=(),
    breaks=(0.0,),
    factors=(1.0,),
    block=None,
    components=6,
    largest_step=np.inf,
    method=dop853,
):
    """Propagate in canonical units (mu = 1 unless the model says otherwise); events as (kind, level, sense, action)."""
    model = dynamics.model(1.0) if model is None else model
    times = np.asarray(times, dtype=float)
    s = method.start(0.0, position, velocity, mass, events=len(events))
    out, found, status, done = np.full((components, len(times)), np.nan), [], dop853.DONE, 0
    size = block or len(times)
    for first in range(0, len(times), size):
        part = times[first : first + size]
        chunk = np.empty((components, len(part)))
        arguments = (np.asarray(breaks, float), np.asarray(factors, float), watch(events), part, chunk, times[-1])
        status = method.EVENTS_FULL
        while status == method.EVENTS_FULL:
            status = method.advance(s, model, *arguments, tolerance, largest_step)
            found += method.drain_events(s)
        rows = method.rows_done(s)
        out[:, first : first + rows] = chunk[:, :rows]
        done = first + rows
        if status != method.DONE:
            break
    return Flight(out[:, :done], found, status, s)


@pytest.fixture(scope="session")
def fly():
    return _fly


@pytest.fixture(scope="session")
def shipped_run():
    """shipped_run(name) -> (Scene, Run) of a shipped scene, computed once."""
    runs = {}

    def run(name):
        if name not in runs:
            scene = sailviz.load_scene(str(shipped_scenes()[name]))
            runs[name] = scene, sailviz.simulate(scene)
        return runs[name]

    return run


@pytest.fixture(scope="session")
def harmed():
    """A function: the content of a file, and chance -> the content as a disk, a network or an editor may leave it."""
    return _harmed


def _harmed(content: bytes, chance: random.Random) -> bytes:
    while (changed := _with_one_harm(bytearray(content), chance)) == content:
        continue
    return changed


def _with_one_harm(content: bytearray, chance: random.Random) -> bytes:
    place, length = chance.randrange(len(content)), chance.randrange(1, 300)
    match chance.randrange(6):
        case 0:
            for _ in range(chance.choice((1, 1, 3, 20))):
                content[chance.randrange(len(content))] ^= 1 << chance.randrange(8)
        case 1:
            del content[place:]
        case 2:
            content += chance.randbytes(length)
        case 3:
            size = max(1, len(content) // chance.choice((4, 16, 50)))
            other = chance.randrange(len(content) - size + 1)
            place = min(place, len(content) - size)
            content[place : place + size], content[other : other + size] = (
                content[other : other + size],
                content[place : place + size],
            )
        case 4:
            content[place : place + length] = bytes(len(content[place : place + length]))
        case _:
            del content[place : place + length]
    return bytes(content)
