"""Flights beside the first one in a low orbit: each one's orbit of the moment, round the globe and, turned into the
plane of the first one's, to scale; its place and its name.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import rerun as rr

from sailviz.frames import unit
from sailviz.recording.contract import word
from sailviz.recording.drawing import style
from sailviz.recording.drawing.flights import Flight
from sailviz.recording.drawing.log import Picture, f4
from sailviz.recording.drawing.names import wide
from sailviz.recording.drawing.orbit_plane import CIRCLE, plane_axes
from sailviz.recording.drawing.samples import rings
from sailviz.recording.drawing.story import Story
from sailviz.recording.drawing.style import points
from sailviz.shapes.primitives import circle

OVER = 1.06  # distances from the centre at which a craft's name hangs
PIXELS = 370.0  # of the height of the highest orbit in the view of the descent
GAP = 12.0  # pixels between the names of altitudes
MEET = 0.35  # radii of the planet between two craft, within which one is named


def log_low_flights(picture: Picture, flights: Sequence[Flight], eye: np.ndarray, plane: bool) -> None:
    """Write /world/flight of the companions and, where there is a plane, /world/plane/flight. eye : (3,) of the view of
    the globe, in the frame that turns with the Sun."""
    first = flights[0].story
    shifts = shifts_of(flights)
    for number, flight in enumerate(flights[1:], 1):
        story, path = flight.story, flight.path
        inertial = np.broadcast_to(np.eye(3), story.samples.axes.shape)
        log_ring(picture, flight, f"{path}/orbit", inertial, style.WIDTH["ring"])
        dot = rr.Points3D.from_fields(radii=points(5.5), colors=[list(flight.color)])
        picture.log_static(f"{path}/craft", dot)
        picture.log_columns(f"{path}/craft", story.index, rr.Points3D.columns(positions=f4(story.position)))
        picture.log_label_style(f"{path}/craft/name", flight.color, flight.name)
        place = in_front(story.position, eye, season(first, story.time))
        place[beside_another(flight, flights[:number])] = np.nan
        picture.log_labels(f"{path}/craft/name", story.index, place)
        if plane:
            top = f"/world/plane/flight/{word(flight.name)}"
            log_ring(picture, flight, f"{top}/orbit", plane_axes(story.samples.run), style.WIDTH["recent"] * 0.8)
            log_altitude(picture, flight, f"{top}/now", shifts[number])


def log_ring(picture: Picture, flight: Flight, path: str, axes: np.ndarray, width: float) -> None:
    """The orbit of the moment in a frame with axes (n, 3, 3)."""
    line = rr.LineStrips3D.from_fields(
        strips=[f4(circle(CIRCLE))], radii=points(width), colors=[list(style.dim(flight.color, 0.8))]
    )
    picture.log_static(path, line)
    story = flight.story
    placed: dict[str, Any] = {name: f4(v) for name, v in rings(story.samples.run, axes, story.frame).items()}
    picture.log_columns(path, story.index, rr.Transform3D.columns(**placed))


def altitude_name(flight: Flight) -> list[str]:
    """Of each drawn row: the flight's name and the altitude of its orbit."""
    radius, frame = flight.story.samples.run.elements.semi_major_axis / flight.story.frame.unit, flight.story.frame
    return [f"{flight.name} {height:.0f} km" for height in ((radius - 1) * frame.unit / 1e3).tolist()]


def shifts_of(flights: Sequence[Flight]) -> list[float]:
    """How far aside the name of each altitude stands, in heights of the highest orbit: the first in the middle, the
    others on either side in turn, none on another."""
    widths = [wide(f"{flight.name} 1000 km") for flight in flights]
    edge = {1: 0.5 * widths[0], -1: 0.5 * widths[0]}
    found = [0.0]
    for number, width in enumerate(widths[1:], 1):
        side = 1 if number % 2 else -1
        found.append(side * (edge[side] + GAP + 0.5 * width) / PIXELS)
        edge[side] += GAP + width
    return found


def beside_another(flight: Flight, others: Sequence[Flight]) -> np.ndarray:
    """(n,) whether a craft is so near to one of the others that names would meet."""
    place, time = flight.story.position, flight.story.time
    near = np.zeros(len(time), bool)
    for other in others:
        row = np.clip(np.searchsorted(other.story.time, time, side="right") - 1, 0, None)
        near |= np.linalg.norm(place - other.story.position[row], axis=1) < MEET
    return near


def log_altitude(picture: Picture, flight: Flight, path: str, shift: float) -> None:
    """The altitude of the moment on the ring, aside by so many heights of the highest orbit."""
    radius = flight.story.samples.run.elements.semi_major_axis / flight.story.frame.unit
    across = shift * (flight.story.reach - 1) + 0 * radius
    along = np.sqrt(np.clip(radius**2 - across**2, 0, None))
    picture.log_label_style(path, flight.color)
    place = np.stack([along, across, 0 * along], 1)
    picture.log_labels(path, flight.story.index, place, altitude_name(flight))


def season(story: Story, times: np.ndarray) -> np.ndarray:
    """(m,) rad at times (m,) s: by how much the frame of the globe's view has turned with the Sun; 0 without her."""
    sun = story.samples.run.bodies.get("Sun")
    if sun is None:
        return np.zeros(len(times))
    return np.asarray(np.interp(times, story.time, np.unwrap(np.arctan2(sun[:, 1], sun[:, 0]))))


def in_front(position: np.ndarray, eye: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Where names of craft at positions (n, 3) hang, NaN while the planet hides them from an eye (3,) in a frame that
    has turned by (n,) rad."""
    c, s = np.cos(turn), np.sin(turn)
    eyes = np.stack([c * eye[0] - s * eye[1], s * eye[0] + c * eye[1], 0 * c + eye[2]], 1)
    ray = unit(position - eyes)
    along = -np.sum(eyes * ray, 1)
    missed = np.linalg.norm(eyes + along[:, None] * ray, axis=1)
    behind = (missed < 1) & (np.linalg.norm(position - eyes, axis=1) > along)
    return np.where(behind[:, None], np.nan, OVER * position)
