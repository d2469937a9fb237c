"""The names in scenes of low orbits and of many flights can be read when they open, half way and at their end. One
scene of each kind; all that are shipped take six minutes: SAILVIZ_ALL_SCENES=1."""

from __future__ import annotations

import os

import pytest

from sailviz.recording import record
from sailviz.shipped import shipped_scenes

from .picture import Picture
from .screen import meetings

FEW = [
    "deorbit/aalto-1",
    "deorbit/drag-only",
    "deorbit/elliptic",
    "deorbit/foresail-1",
    "wind/held-displaced",
    "wind/transfer-arc",
    "wind/windy-or-calm",
]
ALL = [name for name in sorted(shipped_scenes()) if name.startswith(("deorbit/", "wind/"))]


@pytest.mark.parametrize("scene", ALL if os.environ.get("SAILVIZ_ALL_SCENES") else FEW)
def test_no_name_of_a_shipped_scene_lies_on_another(shipped_run, scene, tmp_path):
    _, run = shipped_run(scene)
    record(run, tmp_path / "run.rrd")
    picture = Picture(tmp_path / "run.rrd")
    moved = "/world/rtn" if "/world/rtn" in picture.entities else "/now"
    steps, _ = picture.rows(moved, "Transform3D:quaternion" if moved == "/world/rtn" else "TextDocument:text")
    assert meetings(picture, [int(steps[k]) for k in (0, len(steps) // 2, -1)]) == []
