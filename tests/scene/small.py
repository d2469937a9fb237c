"""The smallest scene that is one, and what is wrong with another."""

from __future__ import annotations

import pytest

from sailviz.errors import SceneError
from sailviz.scene.loading import load_scene

SMALL = {
    "title": "small",
    "start": {"kind": "circular", "radius_au": 1},
    "device": {"kind": "none"},
    "propagation": {"duration_d": 10},
}


def with_parts(**parts):
    """That scene with other sections, or more."""
    return {**SMALL, **parts}


def faults(source, **more) -> dict[str, str]:
    """Place -> sentence (with its hint) of everything that is wrong."""
    with pytest.raises(SceneError) as caught:
        load_scene(source, **more)
    return {fault.where: f"{fault.what} {fault.hint}" for fault in caught.value.faults}
