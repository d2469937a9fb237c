"""A disk that is full at any point: the old file stays, nothing is left behind, a sentence says what is missing."""

import os
import resource
import signal
import subprocess
import sys

import pytest

from sailviz.errors import RecordingError
from sailviz.recording import export, read, record


@pytest.fixture
def small_disk(tmp_path):
    """A function that makes a disk of so many bytes, which is gone after the test."""
    made = []

    def disk(size):
        folder = tmp_path / f"disk-{len(made)}"
        folder.mkdir()
        command = ["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(folder)]
        try:
            done = subprocess.run(command, capture_output=True, check=False).returncode if os.geteuid() == 0 else 1
        except OSError:
            done = 1
        if done:
            pytest.skip("no small disk can be made here")
        made.append(folder)
        return folder

    yield disk
    for folder in made:
        subprocess.run(["umount", str(folder)], check=True)


def test_a_recording_on_a_full_disk_leaves_the_old_file_and_says_what_is_missing(runs, run, small_disk, tmp_path):
    record(run, tmp_path / "whole.rrd")
    size = (tmp_path / "whole.rrd").stat().st_size
    page = resource.getpagesize()
    for share in (0.3, 0.9, 0.97, 0.99):
        disk = small_disk(int(share * size) + page)
        (disk / "a.rrd").write_bytes(b"older")
        with pytest.raises(RecordingError, match=r"no space is left on the disk: [\d,]+ bytes are written") as error:
            record(runs.in_blocks(run, 50), disk / "a.rrd")
        assert "\n" not in str(error.value)
        assert [path.name for path in disk.iterdir()] == ["a.rrd"], share
        assert (disk / "a.rrd").read_bytes() == b"older"


def test_a_recording_that_just_fits_is_whole(run, small_disk, tmp_path):
    record(run, tmp_path / "whole.rrd")
    disk = small_disk(int(1.05 * (tmp_path / "whole.rrd").stat().st_size) + 64 * 1024)
    record(run, disk / "a.rrd")
    assert read(disk / "a.rrd").complete


@pytest.mark.parametrize("form", ["csv", "parquet", "npz", "oem"])
def test_a_table_on_a_full_disk_leaves_the_old_file(form, run, small_disk, tmp_path):
    export(run, tmp_path / f"a.{form}")
    disk = small_disk((tmp_path / f"a.{form}").stat().st_size // 2)
    (disk / f"a.{form}").write_bytes(b"older")
    with pytest.raises(RecordingError, match="no space is left"):
        export(run, disk / f"a.{form}")
    assert [path.name for path in disk.iterdir()] == [f"a.{form}"]
    assert (disk / f"a.{form}").read_bytes() == b"older"


@pytest.mark.skipif(not hasattr(signal, "SIGXFSZ"), reason="no limit on the size of files")
@pytest.mark.parametrize("share", [0.4, 0.99])
def test_a_recording_beyond_the_limit_of_the_shell_leaves_the_old_file(share, run, tmp_path):
    record(run, tmp_path / "a.rrd")
    older = (tmp_path / "a.rrd").read_bytes()
    program = (
        "import resource, sys\n"
        "from sailviz.errors import RecordingError\n"
        "from sailviz.recording import read, record_trajectory\n"
        "state = read(sys.argv[1])['/state']\n"
        "limit = int(sys.argv[2])\n"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))\n"
        "try:\n"
        "    record_trajectory(state['time_s'], state['position_m'], state['velocity_m_s'], sys.argv[1])\n"
        "except RecordingError as error:\n"
        "    print(error)\n"
    )
    path = tmp_path / "b.rrd"
    words = [sys.executable, "-c", program, str(tmp_path / "a.rrd"), str(1 << 40)]
    path.write_bytes(older)
    words[3] = str(path)
    subprocess.run(words, check=True)
    limit = int(share * path.stat().st_size)
    path.write_bytes(older)
    done = subprocess.run([*words[:4], str(limit)], capture_output=True, text=True, check=True)
    assert "grows beyond what this system or shell allows" in done.stdout, done
    assert path.read_bytes() == older
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.rrd", "b.rrd"]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names")
def test_a_recording_goes_through_a_pipe_which_remains_a_pipe(run, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with open(tmp_path / "through.rrd", "wb") as out, subprocess.Popen(["cat", tmp_path / "pipe"], stdout=out) as cat:
        try:
            record(run, tmp_path / "pipe")
        except BaseException:
            cat.kill()  # which otherwise waits for a writer
            raise
    assert (tmp_path / "pipe").is_fifo()
    assert read(tmp_path / "through.rrd").complete
