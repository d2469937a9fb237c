"""How fast a sail gets there, asked in words."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.transfers.direct import limits as limits
    from sailviz.transfers.ends import Arrival as Arrival
    from sailviz.transfers.ends import Bounds as Bounds
    from sailviz.transfers.ends import Distance as Distance
    from sailviz.transfers.ends import Escape as Escape
    from sailviz.transfers.ends import FlyBy as FlyBy
    from sailviz.transfers.places import Place as Place
    from sailviz.transfers.places import circle as circle
    from sailviz.transfers.places import place as place
    from sailviz.transfers.places import place_of_file as place_of_file
    from sailviz.transfers.scene_text import device_words as device_words
    from sailviz.transfers.scene_text import path_of as path_of
    from sailviz.transfers.scene_text import scene_of as scene_of
    from sailviz.transfers.search import FlightTimes as FlightTimes
    from sailviz.transfers.search import Solution as Solution
    from sailviz.transfers.search import find as find
    from sailviz.transfers.search import flight_times as flight_times

_HOMES = {
    "Arrival": "ends",
    "Distance": "ends",
    "Escape": "ends",
    "FlyBy": "ends",
    "Bounds": "ends",
    "Place": "places",
    "Solution": "search",
    "FlightTimes": "search",
    "find": "search",
    "limits": "direct",
    "flight_times": "search",
    "place": "places",
    "place_of_file": "places",
    "circle": "places",
    "scene_of": "scene_text",
    "path_of": "scene_text",
    "device_words": "scene_text",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
