"""Several flights in one picture, from a shell: `run --together`, `view` and `web` of recordings."""

from __future__ import annotations

import json

import numpy as np
import pytest
from click.testing import CliRunner

import sailviz
from sailviz.cli.entry import main

SMALL = ["--set", "propagation.outputs=40", "--set", "expect=[]"]
PAIR = ["transfers/earth-mars-ideal", "transfers/earth-mars-jpl-2015"]


def shell(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_scenes_are_flown_judged_and_recorded_in_one_picture(folder):
    done = shell("run", *PAIR, "--together", "-o", "both.rrd", "--name", "ideal", "--name", "real film", *SMALL)
    assert done.exit_code == 0, done.output
    assert "ideal: To Mars in 408 days" in done.stdout
    assert "real film: To Mars with a real film" in done.stdout
    recording = sailviz.read("both.rrd")
    assert [flight.name for flight in recording.flights] == ["ideal", "real film"]
    for top, name in zip(("", "/flight/real_film"), PAIR, strict=True):
        run = sailviz.simulate(sailviz.load_scene(name, {"propagation.outputs": 40, "expect": []}))
        assert np.array_equal(recording[f"{top}/state"]["position_m"], run.position)
    assert [path.name for path in folder.iterdir()] == ["both.rrd"]


def test_without_names_flights_are_called_after_their_scenes(folder):
    done = shell("run", *PAIR, "--together", "--json", *SMALL)
    assert done.exit_code == 0, done.output
    summaries = json.loads(done.stdout)
    assert [flight["name"] for flight in summaries] == ["earth mars ideal", "earth mars jpl 2015"]
    assert all(flight["recording"] == ["together.rrd"] for flight in summaries)


def test_an_expectation_that_fails_is_exit_code_1_and_the_picture_is_there(folder):
    done = shell("run", *PAIR, "--together", "-q", "--set", "propagation.duration_d=300")
    assert done.exit_code == 1
    assert "transfers/earth-mars-ideal" in done.stderr
    assert (folder / "together.rrd").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([PAIR[0], "--together"], "takes two scenes or more"),
        ([*PAIR, "--name", "a", "--name", "b"], "with --together"),
        ([*PAIR, "--together", "--name", "a"], "--name is given 1 times for 2 flights"),
        ([*PAIR, "--together", "-o", "."], "-o names its file"),
        ([*PAIR, "--together", "-o", "folder"], "-o names its file"),
        ([*PAIR, "--together", "-o", "nowhere/both.rrd"], "nowhere"),
        ([*PAIR, "--together", "-o", "-", "--json"], "takes one recording and no viewer"),
        ([*PAIR, "--together", "--view", "--web"], "exclude each other"),
        ([PAIR[0], PAIR[0], "--together"], "two flights are called earth mars ideal; --name NAME"),
        ([*PAIR, "--together", "--name", "[a]", "--name", "[b]"], "'[a]' has to be a letter or a digit"),
        (
            [PAIR[0], "spirals/logarithmic", "--together"],
            "earth mars ideal transfers about the Sun, logarithmic spirals",
        ),
        ([PAIR[0], "deorbit/cubesat", "--together"], "cubesat deorbit about the Earth"),
        (["wind/mars", "wind/venus", "--together"], "an ensemble of flights"),
        ([PAIR[0], "nosuch", "--together"], "nosuch: 1 fault"),
        ([*PAIR, "--together", "--time-limit", "1e-9"], "nothing was recorded"),
    ],
)
def test_what_makes_no_one_picture_is_refused_and_nothing_is_written(folder, arguments, words):
    done = shell("run", *arguments)
    assert done.exit_code == 2, done.output
    assert words in done.stderr
    assert "Traceback" not in done.output
    assert not list(folder.iterdir())


@pytest.fixture
def files(folder):
    """Recordings of two transfers and of a spiral."""
    for name in (*PAIR, "spirals/logarithmic"):
        assert shell("run", name, *SMALL, "-q").exit_code == 0
    return [folder / f"{name.split('/')[1]}.rrd" for name in (*PAIR, "spirals/logarithmic")]


@pytest.fixture
def opened(monkeypatch):
    """What the native viewer, or a browser, would be given: the flights of each recording."""
    from sailviz.recording.views import viewers

    seen = []

    def look(*paths, **_):
        seen.extend([[flight.name for flight in sailviz.read(path).flights] for path in paths])

    monkeypatch.setattr(viewers, "open_viewer", look)
    monkeypatch.setattr(viewers, "serve", look)
    monkeypatch.setattr(viewers, "check_screen", lambda: None)
    return seen


@pytest.mark.parametrize("verb", ["view", "web"])
def test_flights_of_one_family_are_shown_in_one_picture_unless_apart_is_asked_for(files, opened, verb):
    done = shell(verb, *files[:2])
    assert done.exit_code == 0, done.output
    assert "--apart shows each by itself" in done.stderr
    assert opened == [["earth-mars-ideal".replace("-", " "), "earth mars jpl 2015"]]
    assert shell(verb, *files[:2], "--apart").exit_code == 0
    assert shell(verb, files[0]).exit_code == 0
    assert opened[1:] == [[], [], []]


def test_what_cannot_be_put_together_is_shown_apart_with_the_reason_or_refused_where_it_was_asked_for(files, opened):
    done = shell("view", *files)
    assert done.exit_code == 0
    assert "Shown apart: these flights cannot be put in one picture: only flights of one family" in done.stderr
    assert opened == [[], [], []]
    done = shell("view", *files, "--together")
    assert done.exit_code == 2
    assert "only flights of one family" in done.stderr
    assert shell("view", files[0], "--together").exit_code == 2
    assert shell("view", *files[:2], "--apart", "--name", "a", "--name", "b").exit_code == 2
    (files[0].parent / "no.rrd").write_bytes(b"nothing")
    done = shell("view", files[0], files[0].parent / "no.rrd")
    assert done.exit_code == 2
    assert len(opened) == 3


def test_a_picture_of_several_recordings_has_the_planets_and_the_target_of_the_first(files, folder):
    from sailviz.recording.overlay import record_together
    from sailviz.recording.recorded_run import drawn_run_of

    record_together({name: drawn_run_of(sailviz.read(file)) for name, file in zip("ab", files, strict=False)}, "ab.rrd")
    one, two = sailviz.read(files[0]), sailviz.read("ab.rrd")
    for entity in ("/world/references/orbit_of_mars", "/world/planets/Venus/orbit"):
        strips = [np.stack(list(recording[entity]["strips"][0][0])) for recording in (one, two)]
        assert np.abs(strips[1] - strips[0]).max() < 1e-6
    for entity in ("/world/planets/Earth/body", "/world/planets/Mars/body"):
        places = [np.stack(list(recording[entity]["positions"])).reshape(-1, 3) for recording in (one, two)]
        assert np.abs(places[1] - places[0]).max() < 1e-6
    with pytest.raises(sailviz.RecordingError, match="holds 2 flights already"):
        drawn_run_of(two)
