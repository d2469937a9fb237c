"""The accuracy that a recording states is the one that its rows have, as far as it says."""

from __future__ import annotations

import re

import numpy as np
import pytest

import sailviz
from sailviz.errors import SceneError
from sailviz.shipped import shipped_scenes
from sailviz.simulation.accuracy import measured, rounded_up
from sailviz.simulation.plan import plan


def flown(name, tolerance, **propagation):
    """A scene, with a section [propagation] of its own where one is given, and its run."""
    values = {"propagation": {"tolerance": tolerance} | propagation} if propagation else {}
    scene = sailviz.load_scene(name).with_values({"expect": [], "propagation.tolerance": tolerance} | values)
    return scene, sailviz.simulate(scene)


@pytest.mark.parametrize("tolerance", [1e-7, 1e-9, 1e-11])
@pytest.mark.parametrize("name", ["displaced/circular", "spirals/radial-bounded", "deorbit/drag-only"])
def test_what_is_measured_is_the_distance_from_the_right_flight(name, tolerance):
    p = plan(sailviz.load_scene(name).with_values({"propagation.tolerance": tolerance}))
    found = measured(p)
    grid = {"duration_s": found.until, "outputs": 400}
    _, run = flown(name, tolerance, **grid, integrator=p.choice.integrator)
    _, exact = flown(name, 1e-14, **grid, integrator="dop853")
    away = np.linalg.norm(run.position - exact.position, axis=1) / np.linalg.norm(exact.position, axis=1)
    assert 0.5 * found.error < away.max() < 2 * found.error


def test_the_words_say_it_and_a_recording_opened_later_says_it_too(tmp_path):
    scene, run = flown("displaced/circular", 1e-9)
    said = re.search(
        r"Within (\S+) of the distance of a flight in steps half as long, over all of the flight\.",
        run.setting.accuracy,
    )
    assert float(said[1]) >= measured(plan(scene)).error > 0.1 * float(said[1])
    sailviz.record(run, tmp_path / "a.rrd")
    assert sailviz.read(tmp_path / "a.rrd").accuracy == run.setting.accuracy


def test_a_long_flight_says_how_far_it_was_measured():
    run = next(iter(sailviz.simulate_blocks("deorbit/estcube-2-maximum", block_rows=20)))
    hours = float(re.search(r"over the first (\S+) h\.$", run.setting.accuracy)[1])
    assert 5 < hours < 24


@pytest.mark.parametrize("name", sorted(shipped_scenes()))
def test_the_error_of_every_scene_is_measured(name):
    p = plan(sailviz.load_scene(name))
    found = measured(p)
    assert 0.0 <= found.error < 1e-8
    assert found.until > 0.0


@pytest.mark.parametrize("name", ["wind/held-displaced", "wind/voltage-limits", "deorbit/power-limited"])
def test_measuring_changes_no_bit_of_the_flight(name):
    scene = sailviz.load_scene(name).with_values({"expect": []})
    measuring, plain = (list(sailviz.simulate_blocks(scene, drawn=drawn)) for drawn in (True, False))
    for one, other in zip(measuring, plain, strict=True):
        assert np.array_equal(one.position, other.position)
        for column, values in other.environment.items():
            assert np.array_equal(one.environment[column], values, equal_nan=True), column
    assert "half as long" in measuring[0].setting.accuracy
    assert "half as long" not in plain[0].setting.accuracy


@pytest.mark.parametrize(
    ("error", "said"), [(0.0, "1e-13"), (1e-9, "1e-9"), (1.01e-9, "2e-9"), (9.5e-10, "1e-9"), (0.3, "3e-1")]
)
def test_figures_are_rounded_up(error, said):
    assert rounded_up(error) == said


@pytest.mark.parametrize("name", ["deorbit/cubesat", "deorbit/elliptic"])
@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13])
def test_gauss_jackson_keeps_to_the_tolerance(name, tolerance):
    """Over twenty revolutions, from 1e-10 to 1e-12 within a factor of five; 1e-13 is what rounding leaves of it."""
    grid = {"duration_d": 1.37, "outputs": 700}
    _, run = flown(name, tolerance, integrator="gauss-jackson", **grid)
    _, exact = flown(name, 1e-15, integrator="dop853", largest_step_s=60, **grid)
    away = np.linalg.norm(run.position - exact.position, axis=1) / np.linalg.norm(exact.position, axis=1)
    assert "Gauss-Jackson" in run.setting.accuracy
    assert away.max() < max(tolerance, 3e-12)
    if 1e-11 <= tolerance <= 1e-10:
        assert away.max() > 0.2 * tolerance


def test_gauss_jackson_is_not_asked_for_what_it_cannot_reach():
    values = {"propagation.tolerance": 1e-14}
    assert plan(sailviz.load_scene("deorbit/cubesat").with_values(values)).choice.integrator == "collocation"
    asked = sailviz.load_scene("deorbit/cubesat").with_values(values | {"propagation.integrator": "gauss-jackson"})
    with pytest.raises(SceneError, match="rounding reaches 1e-13 of the distance at best, not a tolerance of 1e-14"):
        plan(asked)
