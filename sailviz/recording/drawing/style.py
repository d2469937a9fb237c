"""Colours, sizes and lengths of everything that is drawn, by the role it plays.

Bright is what is now and what is data; dim (0.4 to 0.6 of the colour, opaque) is context. Never transparency on lines
or points: Rerun darkens the colour and still hides what is behind. A quantity has the same colour in space and in its
plot.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import rerun as rr

BACKGROUND = [7, 10, 18]

TRAIL_RECENT = [130, 222, 255]
TRAIL_PAST = [70, 140, 180]
TRAIL_FUTURE = [38, 62, 84]
CRAFT = [255, 255, 255]
THRUST = [255, 112, 67]
VELOCITY = [126, 224, 129]
NORMAL = [235, 241, 255]
SUN = [255, 206, 84]
SUN_DISC = [255, 238, 190]
SUN_LINE = [92, 74, 34]
RADIAL = [130, 104, 44]
WIND = [186, 140, 255]
PITCH = [255, 206, 84]
CONE = [255, 112, 67]
CLOCK = [255, 150, 220]
CLOCK_CIRCLE = [104, 64, 94]
TARGET = [190, 82, 134]
TARGET_LABEL = [255, 110, 180]
INITIAL = [92, 120, 150]
HEIGHT = [110, 48, 78]
REFERENCE = [120, 136, 165]
APPROXIMATION = [255, 176, 66]
NOMINAL = [255, 255, 255]
AXES = [110, 126, 155]
PRIMER = [64, 224, 208]
FAULT = [255, 84, 84]
ECLIPTIC = [60, 90, 150, 6]

FILM_SUN = [255, 200, 92]
FILM_DARK = [84, 100, 146]
SEAM = [150, 112, 46]
BOOM = [206, 214, 228]
BUS = [196, 164, 92]
PANEL = [38, 64, 140]
TETHER = [168, 196, 255]
TETHER_BRAKE = [226, 232, 255]
SHEATH = [150, 110, 255]
PLUME = [120, 190, 255]

NIGHT = [3, 5, 14]
AIR = [110, 175, 255]
UMBRA = [50, 70, 130, 5]
OCEAN = [38, 84, 150]
ROCK = [150, 140, 126]

SERIES = ([100, 190, 255], [255, 176, 66], [98, 214, 160], [236, 124, 190], [190, 160, 255])
HIGH, BETWEEN, LOW = [100, 190, 255], [226, 206, 196], [255, 112, 67]  # the ramp that colours a descent
PLASMA = [34, 26, 84], [104, 58, 190], [196, 112, 240], [255, 190, 250]  # the ramp of a band of plasma
PLASMA_ALPHA = 64
UNKNOWN = [22, 26, 36]
LANES = {
    "thrust": {"on": ("Thrust on", [190, 160, 255]), "off": ("Coast", [120, 136, 165])},
    "brake": {"on": ("Brake on", [190, 160, 255]), "off": ("Brake off", [120, 136, 165])},
    "light": {"on": ("Sunlit", [255, 206, 84]), "off": ("Eclipse", [36, 46, 84])},
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
PLANET_DOTS = {"Mercury": 4.2, "Venus": 5.2, "Earth": 5.6, "Mars": 4.6, "Jupiter": 7.0, "Saturn": 6.4}  # ui points

WIDTH = {  # half the width of a line in ui points
    "future": 0.9,
    "past": 1.25,
    "recent": 2.4,
    "orbit": 0.8,
    "target": 1.0,
    "helper": 0.8,
    "thrust": 1.9,
    "velocity": 1.4,
    "close thrust": 2.6,
    "close arrow": 1.5,
    "flow": 1.0,
    "arc": 1.4,
    "ladder": 0.6,
    "flight": 0.6,
    "nominal": 1.6,
    "seam": 0.5,
    "plot": 1.6,
    "dense plot": 1.0,
}
FLIGHT_DOT = 1.3
ANCHOR = 0.01  # ui points: a dot too small to see that carries a label

# lengths in the system view as fractions of S, the largest distance from the centre that is drawn
AMONG_MANY = 0.6  # of the craft and its thrust where there is an ensemble to be seen
THRUST_LENGTH = 0.34
VELOCITY_LENGTH = 0.26
PRIMER_LENGTH = 0.30
SUN_RADIUS = 0.035
DISC_RADIUS = 1.12
STARS_RADIUS = 60.0
LABEL_HEIGHT = 0.20
PLANETS_WITHIN = 1.15
NAMES_FROM = 0.18


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


def planet_color(name: str) -> list[int]:
    """Of a planet, or of anything else that moves."""
    return PLANETS.get(name, REFERENCE)
