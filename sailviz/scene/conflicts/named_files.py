"""Whether the files that a scene names lie in its folder and can be read."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.conflicts.ensembles import placed_ensembles
from sailviz.scene.device import SolarSail
from sailviz.scene.environment import ReplayedWind
from sailviz.scene.named_files import folder_of, outside, unreadable
from sailviz.scene.shape import FileShape

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene


def files(scene: Scene) -> Faults:
    """Measured winds, the scene's own and those of its ensembles, and measured space weather."""
    placed = [("environment.solar_wind", scene.environment.solar_wind)]
    placed += [(f"{place}.solar_wind", item.solar_wind) for place, item in placed_ensembles(scene) if item.solar_wind]
    named = [(f"{place}.file", wind.file) for place, wind in placed if isinstance(wind, ReplayedWind)]
    if scene.environment.space_weather is not None:
        named.append(("environment.space_weather.file", scene.environment.space_weather.file))
    device = scene.device
    if isinstance(device, SolarSail) and isinstance(device.shape, FileShape):
        named.append(("device.shape.file", device.shape.file))
    folder = folder_of(scene)
    return [(place, what) for place, name in named if (what := outside(folder, name) or unreadable(folder, name))]
