"""Every shipped scene still flies as it did: tight tolerance, a few rows of every column, float64.

What differs is shown with both sides and pictures. After a change that is meant: pytest tests/scenes/test_goldens.py
--sailviz-update, and say in the commit why the numbers moved.
"""

from pathlib import Path

import pytest

from sailviz.shipped import shipped_scenes

DATA = Path(__file__).parents[1] / "data"
TIGHT = {"propagation.tolerance": 1e-13}


@pytest.mark.parametrize("name", shipped_scenes())
def test_a_shipped_scene_flies_as_it_did(name, recording_regression):
    recording_regression(name, name=name.replace("/", "-"), folder=DATA, rows=40, set=TIGHT)


def test_the_goldens_belong_to_scenes_and_stay_small():
    goldens = {path.stem for path in DATA.glob("*.npz")}
    assert goldens == {name.replace("/", "-") for name in shipped_scenes()}
    assert sum(path.stat().st_size for path in DATA.iterdir()) < 1_500_000
