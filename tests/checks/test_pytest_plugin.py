"""The fixture that ships with the package: what it stores, what it finds, what it leaves behind."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import sailviz.checks.baselines
import sailviz.recording.writer  # once out here, or every inner run would import rerun anew
import sailviz.run.from_arrays  # noqa: F401

pytest_plugins = ["pytester"]
PLAIN = ("-p", "no:cacheprovider", "-p", "no:hypothesispytest")  # which imports hypothesis, every time

TEST = """
import numpy as np
from dataclasses import replace
from sailviz.constants import AU, MU_SUN
from sailviz.elements import state
from sailviz.run.from_arrays import trajectory

def flight(factor=1.0, events=(("half", 1e7),), rows=200):
    time = np.linspace(0, 3e7, rows)
    position, velocity = state(AU, 0.0, 0.1, 0.2, 0.0, time * np.sqrt(MU_SUN / AU**3), MU_SUN)
    thrust = 1e-4 * factor * position / AU
    return trajectory(time, position, velocity, thrust=thrust, events=events, epoch="2030-01-01", planets=False)

def test_flight(recording_regression):
    recording_regression(flight(%s), %s)
"""


@pytest.fixture
def project(pytester):
    """project(call, options) writes a test, runs it and returns the result."""

    def run(call="", *options, more="rows=20"):
        pytester.makepyfile(test_it=TEST % (call, more))
        return pytester.runpytest_inprocess(*PLAIN, "--sailviz-no-pictures", *options)

    return run


def folder_of(result) -> Path:
    return Path(re.search(r"(/\S+) holds both", result.stdout.str()).group(1))


def test_a_baseline_is_made_on_request_and_then_held(project, pytester):
    project("", "--sailviz-update").assert_outcomes(passed=1)
    baseline = pytester.path / "baselines" / "test_flight.npz"
    assert baseline.stat().st_size < 20_000
    before = baseline.read_bytes()
    project("", "--sailviz-update").assert_outcomes(passed=1)
    assert baseline.read_bytes() == before  # no clock in it
    project().assert_outcomes(passed=1)
    assert '"/state:position_m" = 150' in (pytester.path / "baselines" / "test_flight.toml").read_text()


def test_without_a_baseline_it_fails_and_says_how_to_make_one(project):
    result = project()
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*there is no baseline *test_flight.npz*--sailviz-update*"])


@pytest.mark.parametrize(
    ("call", "word"),
    [
        ("1 + 1e-8", "/thrust:magnitude_m_s2"),
        ("-1.0", "/thrust:acceleration_rtn_m_s2"),
        ("events=()", 'event "half" at 115.741 d is missing in B'),
        ("rows=201", "rows: the run of A has 200, that of B 201"),
    ],
)
def test_a_change_fails_and_leaves_both_sides_and_the_table(project, call, word):
    project("", "--sailviz-update")
    result = project(call)
    result.assert_outcomes(failed=1)
    assert word in result.stdout.str()
    folder = folder_of(result)
    assert {"baseline.npz", "baseline.toml", "new.npz", "new.rrd", "difference.txt"} <= {
        file.name for file in folder.iterdir()
    }
    assert word in (folder / "difference.txt").read_text()


def test_tolerances_of_the_file_and_of_the_call_let_a_change_pass(project, pytester):
    project("", "--sailviz-update")
    call = "1 + 1e-8"
    tolerances = pytester.path / "baselines" / "test_flight.toml"
    text = tolerances.read_text()
    project(call, more="rows=20, atol={'/thrust': 1e-11}").assert_outcomes(failed=1)  # the file's are more particular
    loose = re.sub(r'("/thrust:\w+" =) .*', r"\1 1e-11", text)
    tolerances.write_text(loose)
    project(call).assert_outcomes(passed=1)
    project(call, "--sailviz-update").assert_outcomes(passed=1)
    assert tolerances.read_text() == loose  # an update keeps what was edited
    tolerances.write_text(text)
    atol = ", ".join(
        f"'/thrust:{name}': 1e-11" for name in ("magnitude_m_s2", "acceleration_m_s2", "acceleration_rtn_m_s2")
    )
    project("", more=f"rows=20, atol={{{atol}}}").assert_outcomes(passed=1)


def test_two_runs_in_one_test_need_two_names(project, pytester):
    more = "rows=20, name='a'); recording_regression(flight(), name='a'"
    result = project("", "--sailviz-update", more=more)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*the baseline a is used twice*"])
    project("", "--sailviz-update", more=more.replace("(), name='a'", "(), name='b'")).assert_outcomes(passed=1)
    assert (pytester.path / "baselines" / "b.npz").exists()


def test_folders_for_baselines_and_failures_can_be_chosen(project, pytester):
    pytester.makeini("[pytest]\nsailviz_baselines = kept/here\n")
    project("", "--sailviz-update").assert_outcomes(passed=1)
    assert (pytester.path / "kept" / "here" / "test_flight.npz").exists()
    result = project("2.0", "--sailviz-failures", "left")
    assert folder_of(result).is_relative_to(pytester.path / "left")


def test_a_broken_baseline_is_refused_in_one_sentence(project, pytester):
    project("", "--sailviz-update")
    (pytester.path / "baselines" / "test_flight.npz").write_bytes(b"PK\x03\x04")
    result = project()
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(
        ["*RecordingError: *test_flight.npz is not a table of numpy arrays, or is damaged or cut off*"]
    )


def test_pictures_of_both_are_left_where_there_is_vulkan(project, pytester):
    from sailviz.recording.views.screenshot import has_vulkan

    if not has_vulkan():
        pytest.skip("no Vulkan driver: apt-get install libvulkan1 mesa-vulkan-drivers")
    project("", "--sailviz-update")
    pytester.makepyfile(test_it=TEST % ("2.0", "rows=20"))
    result = pytester.runpytest_inprocess(*PLAIN)
    result.assert_outcomes(failed=1)
    folder = folder_of(result)
    assert (folder / "baseline.png").stat().st_size > 10_000
    assert (folder / "new.png").stat().st_size > 10_000


def test_the_plugin_costs_pytest_nothing_to_speak_of():
    code = (
        "import pytest, sys, time; before = set(sys.modules); start = time.process_time(); "
        "import sailviz.checks.pytest_plugin; seconds = time.process_time() - start; "
        "print(seconds, *(name for name in set(sys.modules) - before if '.' not in name))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    seconds, *modules = done.stdout.split()
    assert not {"numpy", "rerun", "pyarrow", "pydantic", "numba", "scipy", "click"} & set(modules)
    assert float(seconds) < 0.02
