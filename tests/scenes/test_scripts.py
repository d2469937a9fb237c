"""Every scripting example runs by itself, from anywhere, and leaves the recording that it says it leaves."""

import subprocess
import sys

import pytest

from sailviz.recording import read
from sailviz.shipped import shipped_folder

SCRIPTS = sorted((shipped_folder("scenes") / "scripts").glob("*.py"))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_script_runs_and_records(script, tmp_path):
    done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    (file,) = tmp_path.glob("*.rrd")
    assert file.name in done.stdout
    assert read(file).complete


def test_a_prescribed_track_is_held_to_metres(tmp_path):
    script = next(path for path in SCRIPTS if path.stem == "prescribed_track")
    done = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=True)
    off = float(done.stdout.split("after three years ")[1].split(" km")[0])
    assert off < 0.1  # km; the cubic between 1,300 rows a year, after half a billion kilometres
