"""Every shipped scene does what it says of itself, and an independent integration of the same physics agrees with it.

The right-hand side in `independent` is written from the models' papers in plain numpy, not from sailviz. A scene that
needs a device, a steering law or an environment that is missing there fails until its physics stands there too.
"""

from __future__ import annotations

import numpy as np
import pytest
from independent.constants import body
from independent.integration import integrate, tabled
from independent.thrust_history import schedule

import sailviz
from sailviz.checks.expectations import check
from sailviz.shipped import shipped_scenes

SCENES = sorted(shipped_scenes())
MOST_JUMPS = 150  # of the thrust, each of which begins the integration anew


@pytest.mark.parametrize("name", SCENES)
def test_scene_fulfils_its_expectations(shipped_run, name):
    verdicts = check(*shipped_run(name))
    assert verdicts, "a scene says what it expects of itself"
    assert all(verdict.passed for verdict in verdicts), "\n".join(map(str, verdicts))


@pytest.mark.parametrize("name", SCENES)
def test_scene_agrees_with_scipy(shipped_run, name):
    """Within 1e-8 of the distance over twenty revolutions or 2 % of the run, whichever is shorter, and one at least.

    Where the thrust jumps often, as far as MOST_JUMPS of its jumps. Where tables are looked up, which plain Python does
    slowly, two revolutions; and in steps of 10 s, since at the scene's own tolerance the kinks of tables and the edges
    of the shadow cost up to a metre per revolution.
    """
    scene, run = shipped_run(name)
    mu = body(scene)[0]
    r, v = run.position[0], run.velocity[0]
    a = 1 / (2 / np.linalg.norm(r) - v @ v / mu)
    last = 0.02 * scene.propagation.duration
    if a > 0:
        turn = 2 * np.pi * np.sqrt(a**3 / mu)
        last = max(turn, min((2 if tabled(scene) else 20) * turn, last))
    runs = [(run, 1e-8)]
    if tabled(scene):
        own = {"duration_s": last, "outputs": 40, "tolerance": scene.propagation.tolerance}
        fine = own | {"tolerance": 1e-13, "largest_step_s": 10, "integrator": "dop853"}
        scene = scene.with_values({"propagation": fine})  # its tables are made for these dates
        again = [sailviz.simulate(scene.with_values({"propagation": values})) for values in (own, fine)]
        runs = [(again[0], 1e-6), (again[1], 1e-8)]
    jumps = schedule(scene)[0]
    rows = runs[0][0].time <= min([last, *jumps[MOST_JUMPS : MOST_JUMPS + 1]])
    assert rows.sum() > 5
    position = integrate(scene, np.concatenate([r, v, run.mass[:1]]), runs[0][0].time[rows])
    for flown, within in runs:
        away = np.linalg.norm(flown.position[rows] - position, axis=1) / np.linalg.norm(position, axis=1)
        assert away.max() < within
