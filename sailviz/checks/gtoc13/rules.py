"""Constants and limits of GTOC13, and what breaks them. SI.

Source: JPL, GTOC13 problem statement (2025). The limits of joints, which the statement asks to be equal,
are ours.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from sailviz.constants import YEAR

MU = 139_348_062_043.343e9  # m3/s2, of the star Altaira
AU = 149_597_870_691.0  # m, the competition's own
RADIATION = 5.4026e-6  # N/m2 at 1 au
AREA, MASS = 15_000.0, 500.0  # m2, kg
CHARACTERISTIC_ACCELERATION = 2 * RADIATION * AREA / MASS  # m/s2, 3.24156e-4, of an ideal film

START_X = -200 * AU
LATEST = 200 * YEAR
PLACE, SPEED = 100.0, 1e-4  # m, m/s: start, conics, flybys
JOINT_TIME, JOINT_PLACE, JOINT_SPEED = 1e-5, 1e-3, 1e-6  # s, m, m/s
SHORTEST_STEP = 60.0  # s
STEP_ERROR = 1e-4  # of the way and of the change of velocity over a step
NORMAL_LENGTH = 1e-6
EDGE_ON = 1e-6  # cosine of a cone angle that is 90 degrees as printed
LOWEST, HIGHEST = 0.1, 100.0  # radii of the body, altitude of a flyby
FRACTION_OF_PERIOD = 1 / 3  # between two successive flybys of one body
NEAREST, NEAREST_ONCE = 0.05 * AU, 0.01 * AU  # perihelion
PERIHELION_SLACK = 1e3  # m
MASSIVE = 10  # bodies up to this number bend the way; the others do not
YANDI = 1000  # the dwarf planet; smaller bodies have higher numbers
MOST_FLYBYS = 13  # of one body that count


class Finding(NamedTuple):
    """A rule that is broken, or a note that breaks none. row : of the file, comments not counted, from 1; line : in the
    file, from 1; name : of the rule; size : what was found, in unit; limit : what is allowed."""

    row: int
    line: int
    name: str
    size: float
    limit: float | None
    unit: str
    words: str

    def as_json(self) -> dict[str, Any]:
        """For a script; what is not finite becomes null."""
        size = self.size if abs(self.size) < float("inf") else None
        return {**self._asdict(), "size": size}
