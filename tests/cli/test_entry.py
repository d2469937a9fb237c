"""The shell's promises: exit codes, messages, whole files or none, and what is not imported."""

import ast
import importlib
import json
import pkgutil
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import click
import jsonschema
import pytest
from click.testing import CliRunner

import sailviz
from sailviz import cli
from sailviz.cli import entry, main
from sailviz.scene import load_scene
from sailviz.shipped import shipped_scenes

SHORT = ("--set", "propagation.duration_d=30", "--set", "propagation.outputs=20", "--set", "expect=[]")

FALLING = """
title = "Straight into a point mass"
body = {mu_km3_s2 = 1}
[start]
kind = "cartesian"
position_km = [1, 0, 0]
velocity_km_s = [0, 0, 0]
[device]
kind = "none"
[propagation]
duration_s = 10
outputs = 50
"""


@pytest.fixture
def shell(tmp_path, monkeypatch):
    """Call sailviz in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return lambda *words: CliRunner().invoke(main, [str(word) for word in words], catch_exceptions=False)


def test_the_entry_is_one_function_however_it_is_reached():
    for module in pkgutil.iter_modules(cli.__path__):  # a module called main would take the function's place
        importlib.import_module(f"sailviz.cli.{module.name}")
    assert cli.main is main is entry.main
    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]
    assert project["scripts"] == {"sailviz": "sailviz.cli.entry:main"}
    done = subprocess.run([sys.executable, "-m", "sailviz", "list"], capture_output=True, text=True, check=True)
    assert any(line.startswith("deorbit/aalto-1 ") for line in done.stdout.splitlines())


def test_every_command_lives_in_a_file_of_its_name_which_is_read_when_it_is_asked_for():
    context = click.Context(main)
    for name in main.list_commands(context):
        command = main.get_command(context, name)
        assert (command.name, command.callback.__module__) == (name, f"sailviz.cli.{name}")
    program = (
        "import sys; from sailviz.cli import main; main(['check', 'displaced/circular'], standalone_mode=False);"
        "print(*(m for m in sys.modules if m.startswith('sailviz.cli.')))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert set(done.stdout.split("\n")[-2].split()) == {f"sailviz.cli.{name}" for name in ("entry", "check", "shared")}


def test_a_command_that_there_is_not_is_answered_with_the_nearest(shell):
    result = shell("chek")
    assert result.exit_code == 2
    assert "check" in result.stderr


def test_click_is_known_to_the_command_line_only():
    package = Path(sailviz.__file__).parent
    knowing = {file.relative_to(package).parts[0] for file in package.rglob("*.py") if "click" in imported_by(file)}
    assert knowing == {"cli"}


def imported_by(file):
    """Top-level names of what a source file imports, anywhere in it."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.add(node.module.partition(".")[0])
    return found


def test_a_run_records_judges_and_says_how_to_look(shell, tmp_path):
    result = shell("run", "displaced/circular")
    assert result.exit_code == 0
    assert "elevation_deg" in result.output
    assert "rerun" in result.output
    assert [path.name for path in tmp_path.iterdir()] == ["circular.rrd"]


def test_a_failed_expectation_is_exit_code_1_and_still_recorded(shell, tmp_path):
    result = shell("run", "displaced/circular", "--set", "expect.0.value=11")
    assert result.exit_code == 1
    assert (tmp_path / "circular.rrd").exists()


def test_bad_input_is_exit_code_2_with_every_fault_and_writes_nothing(shell, tmp_path):
    result = shell("run", "displaced/circular", "--set", "start.radius_aw=1", "--set", "propagation.duration_yr=-1")
    assert result.exit_code == 2
    assert "start.radius_aw" in result.stderr
    assert "propagation.duration_yr" in result.stderr
    assert "greater than 0" in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_an_infeasible_design_is_bad_input_and_names_the_nearest_feasible_value(shell, tmp_path):
    result = shell("run", "displaced/circular", "--set", "start.rate_ratio=0.9")
    assert result.exit_code == 2
    assert "0.8294" in result.stderr  # D1's bound at 10 deg: 0.829444
    assert list(tmp_path.iterdir()) == []


def test_a_broken_propagation_is_exit_code_3_and_leaves_a_recording_that_says_so(shell, tmp_path):
    from sailviz.recording import read

    (tmp_path / "falling.toml").write_text(FALLING)
    result = shell("run", "falling.toml")
    assert result.exit_code == 3
    assert "t = " in result.stderr
    recording = read(tmp_path / "falling.rrd")
    assert not recording.complete
    fall = 3.141592653589793 / (2 * 2**0.5)  # s, free fall from rest at r = mu = 1
    last = recording["/state"]["time_s"][-1]
    assert fall - 0.21 < last < fall


def test_one_bad_scene_does_not_keep_the_good_one_from_being_recorded(shell, tmp_path):
    result = shell("run", "no-such-scene", "displaced/circular", *SHORT, "-o", "out")
    assert result.exit_code == 2
    assert (tmp_path / "out" / "circular.rrd").exists()


def test_json_tells_a_script_what_happened(shell):
    result = shell("run", "spirals/radial-escape", "--json")
    (summary,) = json.loads(result.stdout)
    assert summary["ended"] == "escape"
    assert all(item["passed"] for item in summary["expectations"])
    assert summary["recording"] == ["radial-escape.rrd"]


def test_quiet_prints_nothing_when_all_is_well(shell):
    result = shell("run", "displaced/circular", "-q")
    assert (result.exit_code, result.output) == (0, "")


def test_standard_output_takes_a_recording(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "sailviz", "run", "displaced/circular", *SHORT, "-o", "-"],
        cwd=tmp_path,
        capture_output=True,
        check=True,
    )
    assert done.stdout[:4] == b"RRF2"
    assert list(tmp_path.iterdir()) == []


def test_a_value_set_in_another_unit_replaces_the_one_in_the_file(shell):
    result = shell("show", "displaced/circular", "--set", "start.radius_km=1e8")
    assert "start.radius = 100000000000 m   (0.668459 au)" in result.output


def test_show_prints_defaults_in_si_and_in_words(shell):
    result = shell("show", "displaced/circular")
    assert "propagation.tolerance = 1e-10" in result.output
    assert "start.elevation = 0.174532925199 rad   (10°)" in result.output


def test_the_schema_accepts_every_shipped_scene_and_rejects_a_misspelt_key(shell):
    validator = jsonschema.Draft202012Validator(json.loads(shell("schema").output))
    for path in shipped_scenes().values():
        scene = tomllib.loads(path.read_text())
        if "epoch" in scene:
            scene["epoch"] = scene["epoch"].isoformat()
        validator.validate(scene)
        assert not validator.is_valid(scene | {"titel": "misspelt"})


def test_every_shipped_scene_is_listed_by_name_and_title(shell):
    lines = shell("list").output.splitlines()
    width = max(map(len, shipped_scenes()))
    assert [line[:width].strip() for line in lines] == list(shipped_scenes())
    assert [line[width:].strip() for line in lines] == [load_scene(name).title for name in shipped_scenes()]


def test_check_imports_nothing_heavy(tmp_path):
    program = (
        "import sys; from sailviz.cli import main; main(['check', 'displaced/circular'], standalone_mode=False);"
        "print([m for m in ('rerun', 'numba', 'scipy', 'numpy', 'trimesh') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.skipif(sys.platform == "win32", reason="sends a POSIX signal")
def test_ctrl_c_leaves_a_recording_that_is_valid_up_to_there(tmp_path):
    from sailviz.recording import read

    words = [
        "run",
        "deorbit/debris-260kg",
        "--set",
        "propagation.duration_yr=40",
        "--set",
        "propagation.outputs=2000000",
    ]
    process = subprocess.Popen(
        [sys.executable, "-m", "sailviz", *words], cwd=tmp_path, stderr=subprocess.PIPE, text=True
    )
    deadline = time.monotonic() + 600  # the first run ever compiles
    while time.monotonic() < deadline:  # until rows have been written
        if any(path.stat().st_size > 5_000_000 for path in tmp_path.glob(".*.part")):
            break
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "valid up to" in said
    assert [path.name for path in tmp_path.iterdir()] == ["debris-260kg.rrd"]
    recording = read(tmp_path / "debris-260kg.rrd")
    assert not recording.complete
    assert len(recording["/state"]["time_s"]) > 1000
