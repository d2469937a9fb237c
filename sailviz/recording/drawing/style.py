"""Colours, sizes and lengths of everything that is drawn, by what they mean: looked up by name, never by number.

Bright is what is now and what is data; dim (0.4 to 0.6 of the colour, opaque) is context. Never transparency on lines
or points: Rerun darkens the colour and still hides what is behind. A quantity has the same colour in space, in its
plot and in the figures.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import rerun as rr

from sailviz.run.arrays import EnsembleStatistics

BACKGROUND = [7, 10, 18]

PUSH = [255, 112, 67]
SPEED = [126, 224, 129]
DISTANCE = [100, 190, 255]
SUN = [255, 206, 84]
WIND = [186, 140, 255]
INCLINATION = [77, 208, 192]
ECCENTRICITY = [217, 199, 163]
REFERENCE = [120, 136, 165]
FAULT = [255, 84, 84]

QUANTITY = {  # what a curve shows, by the words of its plot
    "distance": DISTANCE,
    "altitude": DISTANCE,
    "semi-major axis": [150, 170, 255],
    "distance from the Earth": [92, 160, 255],
    "push": PUSH,
    "drag": PUSH,
    "torque": [232, 232, 255],
    "momentum": [186, 140, 255],
    "cone angle": PUSH,
    "sail angle": SUN,
    "clock angle": [255, 150, 220],
    "speed": SPEED,
    "inclination": INCLINATION,
    "height": INCLINATION,
    "eccentricity": ECCENTRICITY,
    "wind": WIND,
    "plasma": WIND,
    "air": [255, 150, 90],
    "voltage": [168, 196, 255],
    "current": [120, 224, 232],
    "power": [242, 228, 140],
    "sunlight": SUN,
    "heat": [255, 190, 92],
    "dose": [176, 200, 120],
    "lowest": [98, 214, 160],
    "highest": [236, 124, 190],
    "analytic": [255, 176, 66],
    "switch": [190, 160, 255],
}
DEVICES = {  # of several on one craft, what each adds
    "solar-sail": [255, 206, 84],
    "electric-sail": [186, 140, 255],
    "thruster": [120, 190, 255],
}
CONTROL = {  # what decides the thrust of an ensemble's flights
    "none": [255, 176, 66],
    "pressure": [98, 214, 160],
    "distance": [236, 124, 190],
    "electrochromic": [120, 224, 232],
}
COLOR_WORDS = {"none": "orange", "pressure": "green", "distance": "pink", "electrochromic": "turquoise"}
SPARE = {"violet": [190, 160, 255], "blue": [100, 150, 255], "yellow": [242, 228, 140]}  # further ones of one control
PUSH_RAMP = ([74, 56, 140], [176, 60, 140], [255, 96, 72], [255, 176, 84])  # weak to strong
ALTITUDE_RAMP = ([100, 190, 255], [170, 140, 255], [244, 92, 150])  # of a descent, from its start to its end

FLIGHTS = {  # of flights in one picture, in their order; apart from each other on the ground of the night
    "cyan": [150, 230, 255],
    "yellow": [242, 228, 140],
    "pink": [236, 124, 190],
    "green": [98, 214, 160],
    "violet": [190, 160, 255],
    "orange": [255, 176, 66],
}
PHASES = {word: FLIGHTS[word] for word in ("cyan", "yellow", "green", "violet", "pink")}  # of a flight, in their order
TRAIL_RECENT = FLIGHTS["cyan"]
TRAIL_PAST = [86, 160, 200]
TRAIL_FUTURE = [44, 70, 96]
FENCE_EDGE = {"past": [255, 170, 110], "future": [96, 52, 52], "ring": [205, 110, 74]}
CRAFT = [255, 255, 255]
FLYBY = [242, 228, 140]
SUN_DISC = [255, 238, 190]
SUN_LINE = [92, 74, 34]
MIRRORED = [150, 118, 60]
RADIAL = [110, 92, 44]
NORMAL = [150, 158, 180]
CLOCK_CIRCLE = [104, 64, 94]
TARGET = [190, 82, 134]
TARGET_NAME = [255, 110, 180]
INITIAL = [92, 120, 150]
HEIGHT = [110, 48, 78]
APPROXIMATION = [255, 176, 66]
NOMINAL = [255, 255, 255]
AXES = [110, 126, 155]
PRIMER = [64, 224, 208]
ECLIPTIC = [60, 90, 150, 6]
DIRECTIONS = [20, 28, 50, 200]  # the unit sphere
GRID = [52, 66, 98]  # its parallels and meridians
PLUMB = [150, 166, 190]

FILM_LIT = [255, 200, 92]
FILM_DARK = [104, 124, 178]
DRAG_FILM = [222, 226, 236]
SEAM = [150, 112, 46]
BOOM = [206, 214, 228]
BUS = [196, 164, 92]
PANEL = [38, 64, 140]
TETHER = [168, 196, 255]
TETHER_BRAKE = [226, 232, 255]
WHEEL = [140, 110, 255, 9]
SHEATH = [150, 110, 255]
PLUME = [120, 190, 255]
GHOST = 0.62  # of the craft's colours
GHOST_WHEEL = [93, 99, 146]
GHOST_DISC = [150, 120, 255, 8]

NIGHT = [8, 14, 34]
AIR = [110, 175, 255]
UMBRA = [50, 70, 130, 5]
PENUMBRA = [50, 70, 130, 3]
TERMINATOR = [104, 98, 84]
OCEAN = [38, 84, 150]
ROCK = [150, 140, 126]

PLASMA = [34, 26, 84], [104, 58, 190], [196, 112, 240], [255, 190, 250]  # the ramp of a band of plasma
PLASMA_ALPHA = 64
UNKNOWN = [22, 26, 36]
LANES = {
    "thrust": {"on": ("Thrust on", [190, 160, 255]), "off": ("Coast", REFERENCE)},
    "brake": {"on": ("Brake on", [190, 160, 255]), "off": ("Brake off", REFERENCE)},
    "light": {"on": ("Sunlit", SUN), "off": ("Eclipse", [36, 46, 84])},
    "stowed": {"on": ("Sail stowed", REFERENCE), "off": ("Sail out", FILM_LIT)},
    "force_law_valid": {"on": ("Force law valid", [98, 214, 160]), "off": ("Outside its range", FAULT)},
}

PLANETS = {
    "Mercury": [168, 160, 150],
    "Venus": [226, 190, 120],
    "Earth": [92, 160, 255],
    "Mars": [226, 106, 72],
    "Jupiter": [214, 176, 140],
    "Saturn": [222, 200, 150],
    "Uranus": [150, 210, 216],
    "Neptune": [100, 130, 230],
    "Moon": [190, 190, 196],
}
PLANET_DOTS = {"Mercury": 5.8, "Venus": 6.8, "Earth": 7.2, "Mars": 6.2, "Jupiter": 8.6, "Saturn": 8.0, "Uranus": 7.6,
               "Neptune": 7.6}  # fmt: skip  # ui points

WIDTH = {  # half the width of a line in ui points
    "future": 0.9,
    "past": 1.3,
    "recent": 2.6,
    "orbit": 0.8,
    "target": 1.2,
    "helper": 0.7,
    "push": 2.6,
    "drag": 4.6,
    "many drags": 2.2,
    "tail": 3.0,
    "ring": 1.5,
    "share": 1.5,
    "close push": 3.4,
    "close share": 2.0,
    "close arrow": 1.6,
    "flow": 1.3,
    "arc": 1.5,
    "ladder": 0.6,
    "flight": 0.5,
    "nominal": 1.6,
    "seam": 0.5,
    "ghost": 0.6,
    "fence past": 0.9,
    "fence future": 0.6,
    "fence ring": 0.8,
    "plot": 2.0,
}
FLIGHT_DOT = 2.2
MARK_DOT = 3.2
ANCHOR = 0.01  # ui points: a dot too small to see that carries a label

# lengths in the system view as fractions of S, the largest distance from the centre that is drawn
AMONG_MANY = 0.6  # of the craft and its thrust where there is an ensemble to be seen
SUN_RADIUS = 0.036
DISC_RADIUS = 1.10
STARS_RADIUS = 60.0
PLANETS_WITHIN = 1.20
NAMES_FROM = 0.28
RAISED = 0.085  # events' names stand above their places, planets' hang below


def points(size: float | np.ndarray) -> Any:
    """A radius in ui points, which does not shrink with distance."""
    return rr.Radius.ui_points(size)


def dim(color: Sequence[int], factor: float = 0.55) -> list[int]:
    """The colour as context."""
    return [int(factor * channel) for channel in color[:3]]


def rgba(color: Sequence[int], alpha: int = 255) -> int:
    """0xRRGGBBAA, as columns of colours want it."""
    red, green, blue = (int(channel) for channel in color[:3])
    return (red << 24) | (green << 16) | (blue << 8) | int(alpha)


def family(color: Sequence[int], count: int) -> list[list[int]]:
    """Shades of one colour, for several answers of one kind."""
    return [dim(color, 1 - 0.35 * k / max(count - 1, 1)) for k in range(count)]


def ramp(share: np.ndarray, stops: Sequence[Sequence[int]], factor: float = 1.0) -> np.ndarray:
    """Colours 0xRRGGBBAA (n,) between evenly spaced stops for shares (n,) of 0 to 1."""
    at = np.linspace(0, 1, len(stops))
    table = factor * np.array(stops, float)
    red, green, blue = (np.interp(share, at, table[:, k]).astype(np.uint32) for k in range(3))
    packed: np.ndarray = (red << 24) | (green << 16) | (blue << 8) | np.uint32(255)
    return packed


def ensemble_words(ensembles: Sequence[EnsembleStatistics]) -> dict[str, str]:
    """The colour of each ensemble by its name, in a word: that of what decides its thrust, while it is not taken."""
    found: dict[str, str] = {}
    for ensemble in ensembles:
        own = [COLOR_WORDS.get(ensemble.control, ""), *SPARE, *COLOR_WORDS.values()]
        found[ensemble.name] = next((word for word in own if word and word not in found.values()), "grey")
    return found


def ensemble_color(word: str) -> list[int]:
    """The colour that a word of `ensemble_words` stands for."""
    control = next((key for key, said in COLOR_WORDS.items() if said == word), None)
    return SPARE.get(word, REFERENCE) if control is None else CONTROL[control]


def planet_color(name: str) -> list[int]:
    """Of a planet, or of anything else that moves."""
    return PLANETS.get(name, REFERENCE)
