"""What a command cannot do is refused before any work: one sentence, exit code 2, nothing written."""

from __future__ import annotations

import os

import pytest
from click.testing import CliRunner

from sailviz.cli import main

LONG = "x" * 5000
SWEEP = ("sweep", "spirals/optical-sail", "--vary", "device.mass_kg=1,2")
RUN = ("run", "displaced/circular")


@pytest.fixture
def shell(tmp_path, monkeypatch):
    """Call sailviz in a folder that holds a file and a folder; whatever would be work fails the test."""

    def never(*_, **__):
        raise AssertionError("the work was begun")

    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.rrd").mkdir()
    (tmp_path / "file").touch()
    for work in ("simulation.simulate_blocks", "sweeps.loop.fly_all", "transfers.find", "figures.draw"):
        monkeypatch.setattr(f"sailviz.{work}", never)
    return lambda *words: CliRunner().invoke(main, [str(word) for word in words], catch_exceptions=False)


def check_refused(result, folder, said):
    assert result.exit_code == 2, result.output
    assert said in result.stderr
    assert "Traceback" not in result.stderr
    assert len(result.stderr) < 1500
    assert sorted(path.name for path in folder.iterdir()) == ["file", "folder.rrd"]


BAD_FILES = [
    (LONG, "file name too long"),
    ("", "the name of the"),
    ("  ", "the name of the"),
    ("nowhere/x{}", "there is no directory nowhere"),
    ("file/x{}", "no directory"),
    ("a\0b", "null"),
]


@pytest.mark.parametrize(("words", "ending"), [(RUN, ".rrd"), (SWEEP, ".parquet"), (("figure", "escape"), ".png"),
                                               (("transfer", "earth", "mars"), ".toml")])  # fmt: skip
@pytest.mark.parametrize(("given", "said"), BAD_FILES)
def test_a_file_that_cannot_be_written_is_refused_before_any_work(shell, tmp_path, words, ending, given, said):
    check_refused(shell(*words, "-o", given.format(ending)), tmp_path, said)


@pytest.mark.parametrize(
    ("given", "said"), [("nowhere/x.csv", "no directory nowhere"), (LONG, "too long"), ("", "empty")]
)
def test_an_export_is_refused_before_the_recording_is_read(shell, tmp_path, given, said):
    check_refused(shell("export", "none.rrd", "--to", "csv", "-o", given), tmp_path, said)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_may_not_be_written_to_is_refused(shell, tmp_path):
    (tmp_path / "folder.rrd").chmod(0o500)
    check_refused(shell(*RUN, "-o", "folder.rrd"), tmp_path, "permission denied")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((*RUN, "--connect", "rerun+http://127.0.0.1:99999/proxy"), "its port 1 to 65535"),
        ((*RUN, "--connect", "rerun+http://127.0.0.1:x/proxy"), "is no address of a viewer"),
        ((*RUN, "--connect", "rerun+http://127.0.0.1:-1/proxy"), "is no address of a viewer"),
        ((*RUN, "--connect", ""), "is no address of a viewer"),
        ((*RUN, "--connect", "rerun+http://[::1"), "is no address of a viewer"),
        ((*RUN, "--connect", "rerun+http://" + LONG), "no viewer answers"),
        ((*RUN, "--connect", "rerun+http://127.0.0.1:1/proxy"), "no viewer answers"),
        (("web", "file", "--port", 99999), "--port"),
        (("web", "file", "--port", -1), "--port"),
        (("web", "file", "--data-port", "1e4"), "--data-port"),
        ((*SWEEP, "-o", "table.xlsx"), "must end in"),
        ((*SWEEP, "-o", "folder.rrd"), "it is a directory"),
        ((*SWEEP, "--workers", 10**9), "--workers"),
        ((*SWEEP, "--draws", LONG), "--draws"),
        (("transfer", "earth", "mars", "-a", "nan"), "a finite number of mm/s²"),
        (("transfer", "earth", "mars", "-a", "0"), "above 0"),
        (("transfer", "earth", "--radius-au", "inf"), "a finite number of au"),
        (("transfer", "earth", "--radius-au", "1.2", "--inclination-deg", "nan"), "a finite number of degrees"),
        (("transfer", "earth", "mars", "--date", "2030-01-01", "--window", "-3"), "a finite number of days"),
        (("transfer", "earth", "mars", "--date", "now"), "--date"),
        (("transfer", "earth", "mars", "--date", "99999-01-01"), "--date"),
        (("compare", "a.rrd", "b.rrd", "--atol", "nan"), "a number of at least 0"),
        (("compare", "a.rrd", "b.rrd", "--rtol", "/state=-1"), "a number of at least 0"),
        (("picture", "displaced/circular", "--fps", "nan"), "a finite number above 0 and up to 60"),
        (("picture", "displaced/circular", "--fps", "1e9"), "a finite number above 0 and up to 60"),
        (("picture", "displaced/circular", "--seconds", "inf"), "a finite number of seconds"),
        (("picture", "displaced/circular", "--seconds", "0"), "a finite number of seconds"),
        (("picture", "displaced/circular", "--seconds", LONG), "a finite number of seconds"),
        ((LONG,), "No such command"),
        ((*RUN, f"--{LONG}"), "No such option"),
        (("check", LONG), "file"),
        (("check", "displaced/circular", "--set", LONG), "is not KEY=VALUE"),
        (("check", "displaced/circular", "--set", f"{LONG}=1"), "--set"),
        (("check", "displaced/circular", "--set", "start.radius_aw=1"), "--set start.radius_aw"),
        (("info", LONG), "xxx"),
        (("export", LONG, "--to", "csv"), "xxx"),
    ],
)  # fmt: skip
def test_a_value_that_cannot_be_is_refused_before_any_work(shell, tmp_path, words, said):
    check_refused(shell(*words), tmp_path, said)


def test_a_movie_that_is_too_long_is_refused_before_the_scene_is_flown(shell, tmp_path, monkeypatch):
    monkeypatch.setattr("sailviz.recording.views.screenshot.has_vulkan", lambda: True)
    words = ("picture", "displaced/circular", "--movie", "a.gif", "--seconds", 3000, "--fps", 60)
    check_refused(shell(*words), tmp_path, "2 to 3,000 frames")
    check_refused(shell(*words[:3], "nowhere/a.gif"), tmp_path, "no directory nowhere")


def test_a_folder_of_recordings_is_made_where_its_parent_is(shell, tmp_path):
    from sailviz.cli.outputs import file_or_folder, folder_at, make_folder

    assert file_or_folder("new", "a.rrd", "recording").parts == ("new", "a.rrd")
    make_folder(folder_at("new", "recordings"))
    assert (tmp_path / "new").is_dir()
