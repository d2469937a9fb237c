"""Every shipped scene still flies as it did: tight tolerance, a few rows of every column, float64.

What differs is shown with both sides and pictures. After a change that is meant: pytest tests/scenes/test_goldens.py
--sailviz-update, and say in the commit why the numbers moved.
"""

from pathlib import Path

import pytest

from sailviz.shipped import shipped_scenes

DATA = Path(__file__).parents[1] / "data"
TIGHT = {"propagation.tolerance": 1e-13}
# Of a low orbit the first hours, in equal steps: over months the rounding of one machine, magnified at the kinks of
# tables and the edges of the shadow, decides where on its orbit a craft is. What comes of it all, the scene expects.
LOW_ORBIT = {
    "propagation": {
        "duration_h": 6,
        "outputs": 40,
        "tolerance": 1e-13,
        "largest_step_s": 10,
        "integrator": "dop853",
    }
}


@pytest.mark.parametrize("name", shipped_scenes())
def test_a_shipped_scene_flies_as_it_did(name, recording_regression):
    values = LOW_ORBIT if name.startswith(("deorbit/", "earth/lightsail")) else TIGHT
    recording_regression(name, name=name.replace("/", "-"), folder=DATA, rows=40, set=values)


def test_the_goldens_belong_to_scenes_and_stay_small():
    goldens = {path.stem for path in DATA.glob("*.npz")}
    assert goldens == {name.replace("/", "-") for name in shipped_scenes()}
    assert sum(path.stat().st_size for path in DATA.iterdir()) < 25_000 * len(goldens)
