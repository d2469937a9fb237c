"""A sail with a shape in the close-up: its facets in the colours of the light's pressure on them, with their shadows;
where the force of the light acts, and its torque about the origin of the shape, which its control has to hold.

What tells the pressure comes with the craft (`Craft.pressure`); torques are columns of the run.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import rerun as rr

from sailviz.constants import YEAR
from sailviz.frames import unit
from sailviz.recording.drawing import style
from sailviz.recording.drawing.log import Picture, f4
from sailviz.recording.drawing.phrases import amount
from sailviz.recording.drawing.story import Story
from sailviz.run.arrays import CraftPart

RAMP = np.array([[18, 22, 40], *style.PUSH_RAMP], float)  # in the shade, then weak to strong
MOMENTS = 24  # of the colours along a flight, fewer of large meshes
MOST_MOMENTS = 240  # of a craft that turns by itself
MOST_BYTES = 1_200_000  # of all colours
MOST_FACETS = 20_000  # beyond which only films and bodies are told apart
SHORT, LONGER = 2.5, 4.0  # length of the torque: with the root of its share of the largest
FLAT = 1e-9  # of a cosine, within which facets are of one plane
NO_LEVER = 1e-6  # of the size, at which a torque is rounding
REACH = 0.75  # of the size, as far as the force's line is followed to where it meets the shape's plane
UNITS = ((1.0, "N m"), (1e-3, "mN m"), (1e-6, "µN m"), (1e-9, "nN m"))
COLUMNS = tuple(f"light_torque_{axis}_N_m" for axis in "xyz")
LEGEND = "facets: dark in the shade, violet to orange by the **pressure** of the light"
ARROW = "; the white arrow is its **torque**"


def colors_of(pressure: np.ndarray) -> np.ndarray:
    """Colours (..., 4) uint8 of pressures from 0, in the shade, to 1."""
    at = np.clip(pressure, 0.0, 1.0) * (len(RAMP) - 1)
    low = np.minimum(at.astype(int), len(RAMP) - 2)
    share = (at - low)[..., None]
    found = RAMP[low] * (1 - share) + RAMP[low + 1] * share
    return np.concatenate([np.round(found), np.full((*found.shape[:-1], 1), 255.0)], axis=-1).astype(np.uint8)


def packed(colors: np.ndarray) -> np.ndarray:
    """Colours (..., 4) uint8 as 0xRRGGBBAA, (...)."""
    r, g, b, a = np.moveaxis(colors.astype(np.uint32), -1, 0)
    return np.asarray(r << 24 | g << 16 | b << 8 | a)


def is_lit(story: Story) -> bool:
    """Whether facets are drawn in the colours of their pressure: in a low orbit where they may differ, since one plane
    of film says more by the colours of its sides, which tell how it stands."""
    craft = story.setting.craft
    facets = sum(len(part.faces) for part in craft.parts)
    if craft.pressure is None or facets > MOST_FACETS or not story.near.by_light or bool(story.stowed.any()):
        return False
    return not story.frame.low or not is_plane(craft.parts)


def is_plane(parts: tuple[CraftPart, ...]) -> bool:
    """Whether a craft is one plane of film."""
    if len(parts) != 1 or not parts[0].film:
        return False
    a, b, c = np.moveaxis(parts[0].corners[parts[0].faces], 1, 0)
    normal = unit(np.cross(b - a, c - a))
    return bool(np.all(np.abs(normal @ normal[0]) > 1 - FLAT))


def lit_words(story: Story) -> list[str]:
    """What the colours of facets mean, and the arrow of the torque, which no low orbit has."""
    return [LEGEND + ("" if story.frame.low else ARROW)] if is_lit(story) else []


def log_facets(picture: Picture, story: Story, path: str) -> None:
    """The facets, each with corners of its own so that it has one colour, over the strongest pressure of the flight's
    moments; none where the craft is in a shadow."""
    craft = story.setting.craft
    assert craft.pressure is not None
    assert craft.side is not None
    corners = np.concatenate([part.corners[part.faces] for part in craft.parts]) / craft.side
    faces = np.arange(3 * len(corners), dtype=np.uint32).reshape(-1, 3)
    picture.log_static(path, rr.Mesh3D(vertex_positions=f4(corners.reshape(-1, 3)), triangle_indices=faces))
    light = story.near.body[:, 0, :]  # x of the view, in body axes
    rows = moments(light, MOST_BYTES // (12 * len(corners)), bool(story.samples.run.attitude.motion))
    light = light[rows]
    acted = story.samples.run.environment
    share = np.asarray(acted.get("sunlit_fraction", acted.get("sunlit", np.ones(len(story.time)))), float)
    dose = story.samples.run.film.get("dose_yr")
    pressure = craft.pressure(light, None if dose is None else dose[rows] * YEAR) * share[rows, None]
    colors = np.repeat(packed(colors_of(pressure / max(float(pressure.max()), 1e-300))), 3, axis=1)
    columns = rr.Mesh3D.columns(vertex_colors=colors.ravel())
    picture.log_columns(path, story.samples.index_of(rows), columns.partition([len(faces) * 3] * len(rows)))


def moments(light: np.ndarray, most: int, turns: bool) -> np.ndarray:
    """Rows whose colours are drawn, the first and the last among them, of directions of the light (n, 3) in body axes:
    evenly in time, or, of a craft that turns by itself, by how far the light has moved over it. most : how many."""
    last, count = len(light) - 1, max(2, min(MOMENTS, most))
    if not turns:
        return np.unique(np.round(np.linspace(0, last, count)).astype(int))
    step = np.linalg.norm(np.diff(light, axis=0), axis=1)
    way = np.concatenate([[0.0], np.cumsum(step)]) + 1e-3 * np.linspace(0, 1, last + 1)
    count = max(count, min(MOST_MOMENTS, most, last + 1))
    return np.unique(np.append(np.searchsorted(way, np.linspace(0, way[-1], count)[:-1]), last))


@dataclass(frozen=True)
class Lever:
    """The light on a shape in the rows of a story, in the frame of the close-up: centre (n, 3) in view units where its
    force acts, torque (n, 3) N m, about (n, 3) in view units the point about which it turns."""

    centre: np.ndarray
    torque: np.ndarray
    about: np.ndarray


def lever_of(story: Story) -> Lever | None:
    """Where the force acts and what torque it has; None of a craft without a shape, or of several devices."""
    run, craft = story.samples.run, story.setting.craft
    if craft.side is None or run.devices or any(name not in run.environment for name in COLUMNS):
        return None
    turn, about = story.near.body, turns_about(story.setting.resolved.get("attitude"))
    torque = np.stack([run.environment[name] for name in COLUMNS], axis=-1)
    force = run.mass[:, None] * np.einsum("nij,ni->nj", turn, story.near.thrust)
    centre = np.zeros_like(force)
    if about is not None:
        centre = centre_of_pressure(force, torque + np.cross(about, force), REACH * craft.side)
    scale = story.craft.close_size / craft.side
    mass = np.zeros(3) if about is None else about
    return Lever(
        scale * np.einsum("nij,nj->ni", turn, centre),
        np.einsum("nij,nj->ni", turn, torque),
        scale * np.einsum("nij,j->ni", turn, mass),
    )


def turns_about(told: object) -> np.ndarray | None:
    """The point (3,) m in body axes about which a scene's torques are, by its attitude: the shape's origin of one that
    is prescribed, else the centre of mass; None where that is not said, or actuators move it or push beside the film,
    and the force is then drawn from the origin."""
    if not isinstance(told, dict) or told.get("kind") == "prescribed":
        return np.zeros(3)
    if told.get("film_mass") is not None or told.get("actuators"):
        return None
    return np.array(told.get("centre_of_mass") or [0.0, 0.0, 0.0], float)


def centre_of_pressure(force: np.ndarray, torque: np.ndarray, reach: float) -> np.ndarray:
    """(n, 3) m in body axes: where the force's line (n, 3) meets z = 0, no farther than the reach, m; the origin where
    there is no force."""
    square = np.sum(force * force, axis=1, keepdims=True)
    safe = np.where(square > 0, square, 1.0)
    point = np.cross(force, torque) / safe
    upright = np.abs(force[:, 2:]) > 1e-6 * np.sqrt(safe)
    point = np.where(upright, point - point[:, 2:] / np.where(upright, force[:, 2:], 1.0) * force, point)
    far = np.linalg.norm(point, axis=1, keepdims=True)
    return np.where(square > 0, point * np.minimum(1.0, reach / np.maximum(far, 1e-300)), 0.0)


def turns(story: Story, lever: Lever) -> bool:
    """Whether there is a torque to be drawn: more than rounding."""
    size = story.setting.craft.side or 1.0
    most = float(np.max(story.samples.run.mass * np.linalg.norm(story.near.thrust, axis=1), initial=0.0))
    return bool(np.linalg.norm(lever.torque, axis=1).max(initial=0.0) > NO_LEVER * size * most)


def torque_arrows(torque: np.ndarray) -> np.ndarray:
    """(n, 3) from torques (n, 3) N m."""
    size = np.linalg.norm(torque, axis=1)
    share = size / size.max()
    return np.asarray(np.where(size > 0, SHORT + LONGER * np.sqrt(share), 0.0)[:, None] * unit(torque))


def torque_words(torque: np.ndarray) -> list[str]:
    """ "torque 1.2 µN m" of each row (n, 3)."""
    sizes = np.linalg.norm(torque, axis=1)
    most = float(sizes.max())
    scale, name = next((unit for unit in UNITS if most >= unit[0]), UNITS[-1])
    return [f"torque {amount(size, scale, name, most)}" for size in sizes.tolist()]
