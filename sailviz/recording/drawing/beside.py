"""A flight that stays beside a planet on its way round the Sun, seen from there: the planet stands still, and the
light comes from one side.

Both would be one dot in a view of the whole orbit. Length 1 is the flight's largest distance from the planet.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import rerun as rr

from sailviz.frames import quaternion, to_frame, unit
from sailviz.recording.contract import word
from sailviz.recording.drawing import cameras, style
from sailviz.recording.drawing.cameras import Camera
from sailviz.recording.drawing.influence import MASSES
from sailviz.recording.drawing.layout import Space
from sailviz.recording.drawing.log import Picture, f4
from sailviz.recording.drawing.phrases import body_words
from sailviz.recording.drawing.story import Story
from sailviz.recording.drawing.style import points

STAYS = 0.1  # of the planet's distance from the Sun: a flight that never gets farther away is beside it
EYE = cameras.direction(np.radians(-62.0), np.radians(18.0))
ASPECT = 1.0  # of the view that must hold all, in whichever place it stands
SUNLIGHT = (-0.9, 0.0, -0.45)  # where its arrow begins, clear of the line from the Sun
ARROW = 0.18  # of a weak push; the strongest is twice as long


class Neighbour(NamedTuple):
    """places (n, 3) view units of a planet; axes (n, 3, 3): x away from the Sun, z the normal of its orbit; size : the
    flight's largest distance from it, view units."""

    name: str
    places: np.ndarray
    axes: np.ndarray
    size: float

    @property
    def path(self) -> str:
        """Above what is drawn in its frame."""
        return f"/world/near/{word(self.name)}"


def neighbour_of(story: Story) -> Neighbour | None:
    """The heaviest body beside which a flight stays; None where it has none."""
    run = story.samples.run
    if not story.frame.sun or story.setting.ensembles or len(run) < 3:
        return None
    for name in sorted((name for name in run.bodies if name in MASSES and name != "Sun"), key=lambda n: -MASSES[n]):
        places = run.bodies[name]
        away = np.linalg.norm(run.position - places, axis=1)
        if 0 < away.max() < STAYS * np.linalg.norm(places, axis=1).min():
            out = unit(places)
            normal = unit(np.cross(places, np.gradient(places, run.time, axis=0)))
            axes = np.stack([out, np.cross(normal, out), normal], -1)
            return Neighbour(name, places / story.frame.unit, axes, float(away.max()) / story.frame.unit)
    return None


def log_beside(picture: Picture, story: Story, there: Neighbour) -> Space:
    """Write /world/near -> its view."""
    path, index = there.path, story.index
    size = np.full((len(story.time), 3), there.size)
    picture.log_pose(path, index, translation=there.places, quaternion=quaternion(there.axes), scale=size)
    own = to_frame(there.axes, story.position - there.places) / there.size
    picture.log_lines(f"{path}/way", [own], style.dim(style.TRAIL_RECENT, 0.6), style.WIDTH["past"])
    dot = rr.Points3D.from_fields(
        radii=points(5.5), colors=[style.CRAFT], labels=[story.setting.craft.label or "craft"], show_labels=True
    )
    picture.log_static(f"{path}/craft", dot)
    picture.log_columns(f"{path}/craft", index, rr.Points3D.columns(positions=f4(own)))
    picture.log_strip_style(f"{path}/line", style.dim(style.planet_color(there.name), 0.5), style.WIDTH["helper"])
    picture.log_strips(f"{path}/line", index, np.stack([0 * own, own], 1))
    color = style.planet_color(there.name)
    body = rr.Points3D([[0, 0, 0]], radii=points(7.0), colors=[color], labels=[there.name], show_labels=True)
    picture.log_static(f"{path}/body", body)
    light = rr.Arrows3D(
        origins=[SUNLIGHT],
        vectors=[[0.35, 0, 0]],
        colors=[style.SUN],
        radii=points(2.0),
        labels=["sunlight"],
        show_labels=True,
    )
    picture.log_static(f"{path}/sunlight", light)
    seen = [own, np.zeros((1, 3)), np.array([SUNLIGHT])]
    if story.most > 0:
        length = np.where(story.push > 0, ARROW + ARROW * story.push / story.most, 0.0)
        arrow = length[:, None] * to_frame(there.axes, unit(story.thrust))
        picture.log_static(f"{path}/push", rr.Arrows3D.from_fields(colors=[style.PUSH], radii=points(2.6)))
        columns = rr.Arrows3D.columns(origins=f4(own), vectors=f4(arrow))
        picture.log_columns(f"{path}/push", index, columns)
        seen.append(own + 1.1 * arrow)
    at, target = cameras.fit(np.concatenate(seen), EYE, ASPECT, 0.75)
    camera = Camera(f"Beside {body_words(there.name)}", path, tuple(at.tolist()), tuple(target.tolist()))
    return Space(camera, (f"+ {path}/**", "+ /world/stars"))
