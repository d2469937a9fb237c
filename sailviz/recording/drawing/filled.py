"""Points between the rows of a flight from elsewhere, so that the craft goes along its way and does not leap."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sailviz.recording.drawing.samples import PICTURE_ROWS, Samples
from sailviz.recording.drawing.story import Story
from sailviz.run.filling import Points, can_be_filled, filled_run, points_between


def filled_story(story: Story) -> tuple[Story, Points | None]:
    """The drawn rows with points between those that lie far apart, and the points; the story as it is, and None, of a
    flight that was simulated, whose rows are many, or that is drawn slowed."""
    run = story.samples.run
    if story.frame.sparse or run.setting.rows > PICTURE_ROWS or len(run) < 2 or not can_be_filled(run):
        return story, None
    points = points_between(run)
    rows = replace(story, unknown=tuple(points.unknown.tolist()))
    if not len(points.row):
        return rows, None
    whole = filled_run(run, points)
    number = np.repeat(story.samples.number, np.bincount(points.row, minlength=len(run)) + 1)
    samples = Samples.of(whole.run, number, story.frame, filled=whole.filled)
    return replace(story, samples=samples, rows=replace(rows, fine=True)), points
