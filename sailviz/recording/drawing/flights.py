"""A craft in open space with its push; and flights beside the first one, each in a colour of its own.

Everything of a companion hangs under /world/flight/NAME, in its own rows: its trail, its craft and its push.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sailviz.frames import body_axes, quaternion, unit
from sailviz.recording import timelines
from sailviz.recording.companions import Companion
from sailviz.recording.contract import word
from sailviz.recording.drawing import style
from sailviz.recording.drawing.craft import Glow, log_stowing
from sailviz.recording.drawing.devices import drawing_of
from sailviz.recording.drawing.layout import Span
from sailviz.recording.drawing.log import Color, Picture
from sailviz.recording.drawing.names import Names
from sailviz.recording.drawing.near import axes_rtn, is_given
from sailviz.recording.drawing.samples import Frame, Samples
from sailviz.recording.drawing.shares import log_shares, own_on
from sailviz.recording.drawing.story import Story
from sailviz.recording.drawing.trail import log_trail, trail_colors
from sailviz.run.arrays import Run

FLIGHT = -1  # rank of a flight's name: what is compared matters most
BESIDE, OVER = 0.6, 0.85  # craft's sizes that a name hangs below a craft, and that it begins above one

STEEP = 0.4  # sine of a push's elevation, on average, from which a name keeps clear of it


@dataclass(frozen=True)
class Flight:
    """One of several flights that are drawn together."""

    name: str
    color_word: str
    run: Run  # all of its rows, on the first flight's clock
    story: Story

    @property
    def color(self) -> Color:
        """Of its trail, its name and its curves."""
        return style.FLIGHTS[self.color_word]

    @property
    def path(self) -> str:
        """Above what is drawn of a companion."""
        return f"/world/flight/{word(self.name)}"


def frame_beside(first: Frame, run: Run) -> Frame:
    """The first flight's frame for the rows of another: its unit and, where it is drawn slowed, its pace."""
    own = Frame.of(run)
    return replace(
        own,
        unit=first.unit,
        unit_name=first.unit_name,
        low=first.low,
        sparse=first.sparse,
        duration=first.duration,
        turns=first.turns,
    )


def story_beside(companion: Companion, first: Frame) -> Story:
    """The drawn rows of a companion, as far as they are known before all are."""
    run = companion.shown
    frame = frame_beside(first, run)
    picked = timelines.Picker(frame.rows, frame.most, run.setting.duration).pick(run)
    rows = np.unique(np.append(picked, len(run) - 1))
    samples = Samples.of(timelines.take(run, rows), rows, frame)
    return Story(samples, frame, drawing_of(run.setting.craft), run.events, 0.0)


def log_body(picture: Picture, story: Story, path: str, size: float) -> None:
    """The craft where it is, in its attitude, with its push. size : of its shape, view units; 0 for a dot."""
    samples, index, craft = story.samples, story.index, story.craft
    picture.log_pose(path, index, translation=samples.position)
    body = body_axes(story.stance, samples.axes[..., 1])
    turn = quaternion(samples.axes @ axes_rtn(samples) if is_given(samples) else body)
    picture.log_pose(f"{path}/body", index, quaternion=turn)
    craft.log_shape(picture, f"{path}/body/shape", False)
    if size > 0:
        picture.log_scale(f"{path}/body/shape", size)
    log_stowing(picture, f"{path}/body/shape", craft, index, story.stowed, False)
    Glow(picture, f"{path}/body", craft).add(samples.index_of, own_on(samples.run))
    if story.most > 0:
        picture.log_arrow_style(f"{path}/push", style.PUSH, style.WIDTH["push"])
        picture.log_arrows(f"{path}/push", index, story.arrow())


def log_flights(picture: Picture, flights: Sequence[Flight], size: float, names: Names) -> dict[str, Span]:
    """Write /world/flight of the companions, and the names of all -> the spans of their trails. size : of the first
    one's craft."""
    spans: dict[str, Span] = {}
    for flight in flights[1:]:
        log_body(picture, flight.story, f"{flight.path}/craft", size if flight.story.craft.size > 0 else 0.0)
        if flight.story.most > 0:
            log_shares(picture, flight.story, flight.story.arrow(), None, f"{flight.path}/craft")
        spans |= log_trail(picture, flight.story, flight.path, trail_colors(flight.color))
    for number, flight in enumerate(flights):
        story = flight.story
        off = -BESIDE * size if hangs(story, number) else OVER * size + 0.5 * style.RAISED * story.reach
        place = story.position + np.array([0.0, 0.0, off])
        names.add(f"/world/names/flight/{word(flight.name)}", flight.name, flight.color, place, FLIGHT, story=story)
    return spans


def hangs(story: Story, number: int) -> bool:
    """Whether the name of the flight of that number hangs below its craft: in turn, but away from a push that goes up
    or down."""
    upward = float(unit(story.thrust)[:, 2].mean())
    return number % 2 == 0 if abs(upward) < STEEP else upward > 0
