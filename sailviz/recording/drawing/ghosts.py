"""Where the sail stood on its way: still copies of the craft, darker and half as large, from the first frame on."""

from __future__ import annotations

import numpy as np
import rerun as rr

from sailviz.frames import quaternion
from sailviz.recording.drawing import style
from sailviz.recording.drawing.devices import own_meshes
from sailviz.recording.drawing.log import Picture, f4
from sailviz.recording.drawing.near import axes_rtn
from sailviz.recording.drawing.samples import TURNS
from sailviz.recording.drawing.story import Story
from sailviz.shapes import sails, tethers
from sailviz.shapes.primitives import circle, surface_of_revolution

COUNT, MANY = 12, 14  # up to three turns, and above
HALF = 0.5  # of the craft's own size
CLEAR = 1.3  # of their size that two of them keep from one another round a planet, where turns lie close
APART = 0.4  # of the way between two of them, a wheel's radius or half a film's side at most
LEAST = 0.01  # of the largest distance that is drawn, below which they would be specks under the craft
SPOKES = 4


def ghost_rows(story: Story) -> np.ndarray:
    """Rows evenly along the path, its ends left out; of a ring, or of very many turns, those of one revolution, evenly
    in time."""
    if story.ring or story.frame.sparse:
        once = story.once_round if story.ring else round(len(story.time) / TURNS) + 1
        return np.unique(np.linspace(0, once - 1, COUNT + 1).astype(int)[:-1])
    step = np.linalg.norm(np.diff(story.position, axis=0), axis=1)
    way = np.concatenate([[0.0], np.cumsum(step)])
    count = COUNT if story.turns < 3 else MANY
    if way[-1] < 1e-3 * story.reach:  # it stands still
        return np.array([], int)
    return np.unique(np.searchsorted(way, np.linspace(0, way[-1], count + 2)[1:-1]).clip(0, len(way) - 1))


def clear_of_one_another(place: np.ndarray, gap: float) -> list[int]:
    """Which of places (n, 3) to keep, the last one first, so that none is closer to another than a gap."""
    kept: list[int] = []
    for k in range(len(place) - 1, -1, -1):
        if all(np.linalg.norm(place[k] - place[other]) >= gap for other in kept):
            kept.append(k)
    return kept[::-1]


def log_ghosts(picture: Picture, story: Story, size: float) -> None:
    """Write /world/ghosts. size : of the craft, view units."""
    story = story.told
    rows = ghost_rows(story)
    rows = rows[~story.stowed[rows]]
    if len(rows) == 0 or not (story.craft.facing or story.craft.slanted):
        return
    place, axes = story.position[rows], story.samples.axes[rows] @ axes_rtn(story.samples)[rows]
    gaps = np.linalg.norm(np.diff(place, axis=0), axis=1)
    room = float(np.median(gaps)) if len(gaps) else size
    small = min(HALF * size, (APART if story.craft.slanted else 2 * APART) * room)
    if small < LEAST * story.reach:
        return
    if not story.frame.sun:
        some = clear_of_one_another(place, CLEAR * small * (2.0 if story.craft.slanted else 1.0))
        place, axes = place[some], axes[some]
    poses = rr.InstancePoses3D(
        translations=f4(place), quaternions=f4(quaternion(axes)), scales=f4(np.full((len(place), 3), small))
    )
    whole = story.setting.craft
    if whole.parts and whole.side is not None:
        for name, mesh, color, side in own_meshes(whole.parts, whole.side):
            path = f"/world/ghosts/{name.removeprefix('film_')}"
            picture.log_mesh(path, mesh, style.dim(color, style.GHOST), side=side)
            picture.log_static(path, poses)
        return
    if story.craft.facing:
        film = sails.film()
        for name, color, side in (("lit", style.FILM_LIT, "back"), ("dark", style.FILM_DARK, "front")):
            picture.log_mesh(f"/world/ghosts/{name}", film, style.dim(color, style.GHOST), side=side)
            picture.log_static(f"/world/ghosts/{name}", poses)
        return
    craft = story.setting.craft
    profile = tethers.bent(craft.cone, craft.rise)
    spokes = tethers.round_hub(profile, tethers.spokes(2 * SPOKES))
    across = [np.concatenate([spokes[k, :0:-1], spokes[k + SPOKES]]) for k in range(SPOKES)]
    wheel = [profile[-1, 0] * circle(49) + [0.0, 0.0, profile[-1, 1]], *across]
    lines = [at + small * line @ frame.T for at, frame in zip(place, axes, strict=True) for line in wheel]
    picture.log_lines("/world/ghosts/wheels", lines, style.GHOST_WHEEL, style.WIDTH["ghost"])
    surface = surface_of_revolution(profile[::-1], 40)
    picture.log_mesh("/world/ghosts/discs", surface, style.GHOST_DISC, shaded=False)
    picture.log_static("/world/ghosts/discs", poses)
