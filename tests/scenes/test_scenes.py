"""Every shipped scene does what it says of itself, and an independent integration of the same physics agrees with it.

The right-hand side in `independent` is written from the models' papers in plain numpy, not from sailviz. A scene that
needs a device, a steering law or an environment that is missing there fails until its physics stands there too.
"""

from __future__ import annotations

import numpy as np
import pytest
from independent.bodies import seventh
from independent.constants import body
from independent.integration import integrate, tabled
from independent.thrust_history import schedule
from independent.turning import integrate_turning

import sailviz
from sailviz.checks.expectations import check
from sailviz.scene.phases import scene_of
from sailviz.shipped import shipped_scenes

SCENES = sorted(shipped_scenes())
MOST_JUMPS = 60  # of the thrust, each of which begins the integration anew

MOST_HOURS = 2  # of a craft that turns, whose turns plain Python follows slowly


@pytest.mark.parametrize("name", SCENES)
def test_scene_fulfils_its_expectations(shipped_run, name):
    verdicts = check(*shipped_run(name))
    assert verdicts, "a scene says what it expects of itself"
    assert all(verdict.passed for verdict in verdicts), "\n".join(map(str, verdicts))


def first_phase(scene):
    """The scene that holds in the first of its phases, where it has any: later ones are for its expectations to say."""
    if not scene.phase:
        return scene
    one = scene_of(scene, scene.phase[0])
    off = {"active": [[1e12, 2e12]]} if scene.phase[0].device.level == 0 else {}
    return one.model_copy(update={"device": one.device.model_copy(update=off), "phase": []})


@pytest.mark.parametrize("name", SCENES)
def test_scene_agrees_with_scipy(shipped_run, name):
    """Within 1e-8 of the distance over twenty revolutions or 2 % of the run, whichever is shorter, and one at least.

    Where the thrust jumps often, as far as MOST_JUMPS of its jumps or six rows; where tables are looked up, which plain
    Python does slowly, one revolution. How far this holds beyond is for test_accuracy to say.
    """
    scene, run = shipped_run(name)
    scene = first_phase(scene)
    mu = body(scene)[0]
    r, v = run.position[0], run.velocity[0]
    a = 1 / (2 / np.linalg.norm(r) - v @ v / mu)
    last = 0.02 * scene.propagation.duration
    if a > 0:
        turn = 2 * np.pi * np.sqrt(a**3 / mu)
        last = max(turn, min((1 if tabled(scene) else 20) * turn, last))
    if tabled(scene):  # more rows, and tables made for these dates
        own = {"duration_s": last, "outputs": 40, "tolerance": scene.propagation.tolerance}
        scene = scene.with_values({"propagation": own})
        run = sailviz.simulate(scene)
    jumps = [] if run.attitude.motion else schedule(scene)[0]
    last = min([last, *(phase.end for phase in run.setting.phases[:1])])
    if run.attitude.motion and scene.attitude.kind != "spin-averaged":
        last = min(last, MOST_HOURS * 3600)
    rows = run.time <= min([last, *(max(jump, run.time[5]) for jump in jumps[MOST_JUMPS : MOST_JUMPS + 1])])
    assert rows.sum() > 5
    if run.attitude.motion:
        position = integrate_turning(scene, run, run.time[rows])
    else:
        position = integrate(scene, np.concatenate([r, v, [seventh(scene)]]), run.time[rows])
    away = np.linalg.norm(run.position[rows] - position, axis=1) / np.linalg.norm(position, axis=1)
    assert away.max() < 1e-8
