"""How a command ends that does not end by itself: signals, consoles that cannot print, faults of sailviz itself."""

from __future__ import annotations

import os
import signal
import stat
import subprocess
import sys
import time

import pytest
from click.testing import CliRunner

from sailviz import files
from sailviz.cli import main

LONG = (
    "run", "deorbit/debris-260kg", "--set", "propagation.duration_yr=40", "--set", "propagation.outputs=2000000",
)  # fmt: skip
posix = pytest.mark.skipif(sys.platform == "win32", reason="sends a POSIX signal")
ROWS_ARE_WRITTEN = 3_000_000  # bytes


def begun(folder, *words, **more):
    """A sailviz of its own, and the time when rows were written."""
    process = subprocess.Popen(
        [sys.executable, "-m", "sailviz", *words], cwd=folder, stderr=subprocess.PIPE, text=True, **more
    )
    deadline = time.monotonic() + 600  # the first run ever compiles
    while time.monotonic() < deadline and process.poll() is None:
        if any(path.stat().st_size > ROWS_ARE_WRITTEN for path in folder.glob(".*.part")):
            break
        time.sleep(0.05)
    return process


@posix
@pytest.mark.parametrize("names", [("SIGTERM",), ("SIGHUP",), ("SIGHUP", "SIGTERM")])
def test_signals_to_end_leave_a_recording_that_is_valid_up_to_there(tmp_path, names):
    from sailviz.recording import read

    process = begun(tmp_path, *LONG)
    for name in names:  # a closed session sends both
        process.send_signal(getattr(signal, name))
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "valid up to" in said
    assert "Traceback" not in said
    assert [path.name for path in tmp_path.iterdir()] == ["debris-260kg.rrd"]
    assert not read(tmp_path / "debris-260kg.rrd").complete


@posix
def test_a_hangup_that_is_ignored_ends_nothing(tmp_path):
    """What `nohup` does."""
    process = begun(tmp_path, *LONG, preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    process.send_signal(signal.SIGHUP)
    time.sleep(0.5)
    assert process.poll() is None
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=60)
    assert process.returncode == 130


def test_what_a_console_cannot_print_is_replaced(tmp_path):
    """cp1252 is what a redirected console of Windows speaks; the title is Greek."""
    words = ["show", "displaced/circular", "--set", "title=Ηλιακό ιστίο"]
    done = subprocess.run(
        [sys.executable, "-m", "sailviz", *words],
        cwd=tmp_path,
        capture_output=True,
        env=dict(os.environ, PYTHONIOENCODING="cp1252"),
    )
    assert done.returncode == 0, done.stderr
    assert b"title = '??????" in done.stdout


def test_a_fault_of_sailviz_is_exit_code_4_and_says_what_to_do(monkeypatch):
    def broken(*_, **__):
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("sailviz.scene.load_scene", broken)
    for command in ("check", "run", "show"):
        result = CliRunner().invoke(main, [command, "displaced/circular"], catch_exceptions=False)
        assert result.exit_code == 4
        assert "ZeroDivisionError" in result.stderr
        assert "Please report it" in result.stderr.splitlines()[-1]


def test_want_of_memory_is_a_sentence(monkeypatch):
    def full(*_, **__):
        raise MemoryError

    monkeypatch.setattr("sailviz.scene.load_scene", full)
    result = CliRunner().invoke(main, ["run", "displaced/circular"], catch_exceptions=False)
    assert result.exit_code == 3
    assert result.stderr == "There is not enough memory for this.\n"


def test_ctrl_c_outside_of_the_work_is_130_too(monkeypatch):
    def pressed(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("sailviz.scene.load_scene", pressed)
    monkeypatch.setattr("sailviz.cli.list.title_of", pressed)
    for words in (["list"], ["show", "displaced/circular"]):
        result = CliRunner().invoke(main, words, catch_exceptions=False)
        assert result.exit_code == 130
        assert "Interrupted." in result.stderr


@posix
def test_a_list_that_nobody_reads_to_its_end_is_no_failed_expectation(tmp_path):
    done = subprocess.run(
        ["bash", "-o", "pipefail", "-c", f"{sys.executable} -m sailviz schema | head -c 10"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode in (0, 141)
    assert "Traceback" not in done.stderr


def piped(stdout):
    """A run whose recording goes to a standard output -> exit code, what it said."""
    words = [sys.executable, "-m", "sailviz", "run", "spirals/optical-sail", "-o", "-"]
    done = subprocess.run(words, stdout=stdout, stderr=subprocess.PIPE, text=True, timeout=600)
    return done.returncode, done.stderr


@posix
def test_a_recording_that_nobody_reads_ends_at_once():
    source, held = os.pipe()
    os.close(source)
    code, said = piped(held)
    os.close(held)
    assert (code, said) == (2, "cannot write the recording to standard output: nobody reads what is written\n")


@posix
def test_a_recording_into_a_full_device_ends_at_once_and_the_device_remains(tmp_path):
    node = tmp_path / "full"
    try:
        os.mknod(node, 0o666 | stat.S_IFCHR, os.makedev(1, 7))
        device = open(node, "wb")  # noqa: SIM115
    except OSError:
        pytest.skip("no device can be made here")
    with device:
        code, said = piped(device)
    assert code == 2
    assert said.startswith("cannot write the recording to standard output: no space is left (all ")
    assert said.count("\n") == 1
    named = subprocess.run(
        [sys.executable, "-m", "sailviz", "run", "spirals/optical-sail", "-q", "-o", str(node)],
        capture_output=True, text=True, timeout=600,
    )  # fmt: skip
    assert (named.returncode, named.stderr) == (2, f"cannot write the recording {node}: no space is left\n")
    assert node.is_char_device()


@posix
def test_a_run_that_is_killed_leaves_the_older_file_as_it_was(tmp_path):
    (tmp_path / "debris-260kg.rrd").write_bytes(b"older")
    process = begun(tmp_path, *LONG)
    process.kill()
    process.communicate(timeout=60)
    assert (tmp_path / "debris-260kg.rrd").read_bytes() == b"older"
    parts = list(tmp_path.glob(".*.part"))
    assert len(parts) == 1
    os.utime(parts[0], (0, 0))  # a minute later
    files.check(tmp_path / "debris-260kg.rrd")
    assert [path.name for path in tmp_path.iterdir()] == ["debris-260kg.rrd"]
