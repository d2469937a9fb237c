"""What we start ends with us, and what we leave when killed is swept away by the next run."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from sailviz.errors import RecordingError
from sailviz.recording.children import Child
from sailviz.recording.views import scratch as scratches
from sailviz.recording.views import screenshot
from sailviz.recording.views.scratch import scratch
from sailviz.recording.views.screenshot import Studio

posix = pytest.mark.skipif(sys.platform == "win32", reason="kills a POSIX process")
SLEEPER = [sys.executable, "-c", "import time; time.sleep(60)"]
PARENT = f"""
import time
from sailviz.recording.children import Child
from sailviz.recording.views.scratch import scratch
with scratch() as folder:
    child = Child({SLEEPER!r})
    print(child.pid, folder, flush=True)
    time.sleep(60)
"""


def alive(number):
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return False
    state = Path(f"/proc/{number}/stat")
    return not state.exists() or state.read_text().rsplit(")", 1)[1].split()[0] != "Z"


def until(question, patience=20.0):
    deadline = time.monotonic() + patience
    while not question() and time.monotonic() < deadline:
        time.sleep(0.02)
    return question()


@posix
def test_a_child_ends_with_its_parent_even_by_kill_9_and_the_next_run_sweeps(tmp_path, monkeypatch):
    environment = dict(os.environ, TMPDIR=str(tmp_path))
    parent = subprocess.Popen([sys.executable, "-c", PARENT], stdout=subprocess.PIPE, text=True, env=environment)
    number, folder = parent.stdout.readline().split()
    assert alive(int(number))
    parent.send_signal(signal.SIGKILL)
    parent.communicate()
    assert until(lambda: not alive(int(number)))
    assert Path(folder).is_dir()
    monkeypatch.setattr(scratches.tempfile, "tempdir", str(tmp_path))
    with scratch() as mine:
        assert Path(folder).is_dir()  # too young to be sure of
    os.utime(folder, (0, 0))
    with scratch() as mine:
        assert list(tmp_path.iterdir()) == [mine]
        os.utime(mine, (0, 0))
        with scratch():
            assert mine.is_dir()  # held by the living
    assert list(tmp_path.iterdir()) == []


def test_a_child_that_is_ended_leaves_no_process():
    child = Child(SLEEPER)
    assert child.poll() is None
    child.end()
    assert child.poll() is not None
    assert child._watchman.returncode == 0
    child.end()


class Busy:
    """A viewer that does not answer the first times it is asked."""

    def __init__(self, misses):
        self.misses, self.asked = misses, 0

    def get_state(self):
        self.asked += 1
        if self.asked <= self.misses:
            raise TimeoutError("no answer within 15 seconds")
        return "state"


class Living:
    returncode = None

    def poll(self):
        return self.returncode


def studio(monkeypatch, process):
    monkeypatch.setattr(screenshot.time, "sleep", lambda seconds: None)
    made = Studio.__new__(Studio)
    made._path, made._process = Path("run.rrd"), process
    return made


def test_a_viewer_that_does_not_answer_in_time_is_asked_again_then_named(monkeypatch):
    made = studio(monkeypatch, Living())
    assert made._asked("for its state", Busy(2).get_state) == "state"
    with pytest.raises(RecordingError, match=r"of run.rrd was asked for its state three times .*within 15 seconds"):
        made._asked("for its state", Busy(9).get_state)
    died = Living()
    died.returncode = -9
    with pytest.raises(RecordingError, match="ended by itself with code -9"):
        studio(monkeypatch, died)._asked("for its state", Busy(1).get_state)
