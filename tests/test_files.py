"""Files appear whole or not at all, and nothing but a regular file is ever replaced."""

from __future__ import annotations

import os
import resource
import stat
import subprocess
import sys
import threading

import pytest

from sailviz import files
from sailviz.errors import OutputError


def test_a_file_appears_whole_and_what_was_there_stays_until_then(tmp_path):
    target = tmp_path / "a.txt"
    target.write_text("old")
    target.chmod(0o640)
    with files.writing(target) as part:
        part.write_text("new")
        assert target.read_text() == "old"
    assert target.read_text() == "new"
    assert stat.S_IMODE(target.stat().st_mode) == 0o640
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def test_a_failure_on_the_way_leaves_the_old_file_and_nothing_else(tmp_path):
    target = tmp_path / "a.txt"
    target.write_text("old")
    with pytest.raises(ZeroDivisionError), files.writing(target) as part:
        part.write_text("half" * (1 // 0))
    with pytest.raises(OutputError, match="wrong"), files.writing(target, check=lambda part: wrong()) as part:
        part.write_text("whole, but wrong")
    assert target.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def wrong():
    raise OutputError("wrong")


def test_a_link_stays_a_link_and_its_file_is_replaced(tmp_path):
    (tmp_path / "real.txt").write_text("old")
    (tmp_path / "link.txt").symlink_to("real.txt")
    files.write_text(tmp_path / "link.txt", "new")
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "real.txt").read_text() == "new"
    (tmp_path / "round").symlink_to("round")
    with pytest.raises(OutputError, match=r"circle|too many"):
        files.write_text(tmp_path / "round", "new")


def test_a_pipe_is_written_into_and_remains_a_pipe(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    read = []
    reader = threading.Thread(target=lambda: read.append((tmp_path / "pipe").read_text()))
    reader.start()
    files.write_text(tmp_path / "pipe", "through")
    reader.join(10)
    assert read == ["through"]
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root makes device nodes")
@pytest.mark.parametrize(("name", "minor", "full"), [("null", 3, False), ("full", 7, True)])
def test_a_device_is_written_into_and_remains_a_device(name, minor, full, tmp_path):
    node = tmp_path / name
    try:
        os.mknod(node, 0o666 | stat.S_IFCHR, os.makedev(1, minor))
        node.write_bytes(b"") if full else node.write_bytes(b"x")
    except OSError:
        pytest.skip("device nodes do not work here")
    if full:
        with pytest.raises(OutputError, match="no space is left"):
            files.write_text(node, "lost")
    else:
        files.write_text(node, "swallowed")
    assert stat.S_ISCHR(node.stat().st_mode)
    assert [path.name for path in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize(
    ("path", "word"),
    [("", "is a directory"), ("nowhere/a.txt", "there is no directory"), ("x" * 300, "file name too long")],
)
def test_what_cannot_be_written_is_refused_before_anything_is_computed(path, word, tmp_path):
    with pytest.raises(OutputError, match=word):
        files.Output.reserve(tmp_path / path)


def test_a_file_cut_by_a_limit_never_gets_its_name(tmp_path):
    target = tmp_path / "a.bin"
    target.write_bytes(b"old")
    code = (
        "import resource, signal, sys\n"
        "from sailviz import files\n"
        "from sailviz.errors import OutputError\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))\n"
        "try:\n"
        "    with files.writing(sys.argv[1]) as part:\n"
        "        part.write_bytes(bytes(5000))\n"
        "except OutputError as error:\n"
        "    print(error)\n"
    )
    done = subprocess.run([sys.executable, "-c", code, target], capture_output=True, text=True)
    assert "grows beyond what this system or shell allows" in done.stdout, done
    assert target.read_bytes() == b"old"
    assert [path.name for path in tmp_path.iterdir()] == ["a.bin"]
    assert resource.getrlimit(resource.RLIMIT_FSIZE)[0] != 1000


def test_parts_of_dead_runs_are_swept_away_and_those_of_living_ones_stay(tmp_path):
    gone = subprocess.Popen([sys.executable, "-c", "pass"])
    gone.wait()
    dead = tmp_path / f".a.rrd.{gone.pid}.part"
    fresh = tmp_path / f".a.rrd.{gone.pid}0000.part"
    alive = tmp_path / f".a.rrd.{os.getppid()}.part"
    other = tmp_path / f".b.rrd.{gone.pid}.part"
    for part in (dead, fresh, alive, other):
        part.write_bytes(b"half")
    for part in (dead, alive, other):
        os.utime(part, (0, 0))
    files.write_text(tmp_path / "a.rrd", "whole")
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        ["a.rrd", *(part.name for part in (fresh, alive, other))]
    )
