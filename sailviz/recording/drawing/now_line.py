"""The line on top: when it is, where the craft is, how fast, what pushes it and how the sail stands, in words and units
of people. It is the clock of a recording.
"""

from __future__ import annotations

import numpy as np
import rerun as rr

from sailviz.recording.drawing.log import Index, Picture
from sailviz.recording.drawing.phases import names_in_rows
from sailviz.recording.drawing.phrases import body_words, digits, moments, on_day, push_words
from sailviz.recording.drawing.shares import share_words
from sailviz.recording.drawing.story import GROUND, Story
from sailviz.run import gaps as spans
from sailviz.run.arrays import EnsembleStatistics

ROWS = 700
OVAL = 0.15  # typical difference of the highest and the lowest altitude, of the mean one, from which both are told
NARROW = 1e-4  # au, a spread that is told in km
BETWEEN = " · "


def now_texts(story: Story) -> list[str]:
    """What is said of each drawn row (n,)."""
    several = len(story.samples.run.devices) > 1
    if story.frame.low:
        acting = share_words(story) if several else drag_words(story)
        parts = [altitude_words(story), speed_words(story, 2), acting, *light_words(story)]
    else:
        parts = [distance_words(story)]
        if story.setting.ensembles:
            parts += [push_words(story.push)] if story.most > 0 else []
            parts += [ensemble_words(story)]
        elif several:  # whose shares need the room of the speed
            parts += [share_words(story)]
            parts += [angle_words(story)] if story.craft.flow_word else []
        else:
            parts += [speed_words(story, 1)]
            parts += [push_words(story.push)] if story.craft.pushes else []
            parts += [angle_words(story)] if story.craft.flow_word else []
    if story.setting.phases:
        parts.insert(0, names_in_rows(story.setting, story.time))
    when = moments(story.time, story.setting.epoch)
    return [BETWEEN.join(row) for row in zip(when, *parts, strict=True)]


def log_now(picture: Picture, story: Story) -> None:
    """Write /now: about ROWS rows, the first and the last among them."""
    some = np.linspace(0, len(story.time) - 1, min(ROWS, len(story.time))).astype(int)
    some = np.unique(np.concatenate([some, story.breaks, story.breaks + 1]))
    texts = now_texts(story)
    log_lines(picture, story.samples.index_of(some), [texts[k] for k in some.tolist()])
    if len(story.breaks):
        log_lines(picture, story.gap_index, gap_texts(story))


def log_lines(picture: Picture, index: Index, texts: list[str]) -> None:
    """Write lines of the moment."""
    lines = ["### " + text.replace(BETWEEN, "   ·   ") for text in texts]
    columns = rr.TextDocument.columns(text=lines, media_type=["text/markdown"] * len(lines))
    picture.log_columns("/now", index, columns)


def gap_texts(story: Story) -> list[str]:
    """What is said where data ends: until when, and that what is seen is older."""
    gaps, time = story.gaps, story.time
    when = moments(np.concatenate([time[:1], spans.moments(gaps), time[-1:]]), story.setting.epoch)[1:-1]
    until = [on_day(end - float(time[0]), story.duration) for _, end in gaps]
    said = zip(when, until, strict=True)
    return [BETWEEN.join([now, f"no data until {then}", "seen as it last was"]) for now, then in said]


def distance_words(story: Story) -> list[str]:
    """From the Sun, or from another body without a surface."""
    body = story.setting.body.name
    run, unit_name = story.samples.run, story.frame.unit_name
    named = body == "Sun" or story.setting.body.radius or unit_name == "au"
    whose = body_words(body) if named else "the centre"
    away = np.linalg.norm(run.position, axis=1) / story.frame.unit
    if unit_name.endswith("radii"):
        return [f"{km:,.0f} km from the centre of {whose}" for km in (away * story.frame.unit / 1e3).tolist()]
    decimals = 2 if unit_name == "au" and away.max() < 99.5 else digits(float(away.max()))
    name = unit_name if unit_name == "au" else f"× {unit_name}"
    return [f"{value:.{decimals}f} {name} from {whose}" for value in away.tolist()]


def speed_words(story: Story, decimals: int) -> list[str]:
    """km/s, or m/s of what hardly moves."""
    speed = np.linalg.norm(story.samples.run.velocity, axis=1)
    if speed.max() < 100.0:
        return [f"{v:.1f} m/s" for v in speed.tolist()]
    return [f"{v / 1e3:.{decimals}f} km/s" for v in speed.tolist()]


def angle_words(story: Story) -> list[str]:
    """How far the sail is turned off what comes from the Sun."""
    sail, flow = story.craft.sail_word, story.craft.flow_word
    angles = np.degrees(story.samples.run.attitude.pitch).tolist()
    words = zip(angles, story.stowed.tolist(), strict=True)
    return [f"{sail} stowed" if stowed else f"{sail} {angle:.0f}° off the {flow}" for angle, stowed in words]


def altitude_words(story: Story) -> list[str]:
    """Of the drawn row: of an ellipse its lowest and highest, else the mean one, and near re-entry the height over the
    ground."""
    e, radius = story.samples.run.elements, story.setting.body.radius
    low = e.semi_major_axis * (1 - e.eccentricity) - radius
    high = e.semi_major_axis * (1 + e.eccentricity) - radius
    oval = (np.median(high - low) > OVAL * np.median(story.altitude)) & (low > GROUND)
    return [
        f"{a / 1e3:.0f} to {b / 1e3:.0f} km up" if long else f"{mean / 1e3:.0f} km up"
        for a, b, long, mean in zip(low.tolist(), high.tolist(), oval.tolist(), story.altitude.tolist(), strict=True)
    ]


def drag_words(story: Story) -> list[str]:
    """What brakes: the force on each metre of a tether, or the deceleration by air."""
    force = story.samples.run.environment.get("plasma_force_N_m")
    if force is not None:
        return [f"drag {1e9 * f:.0f} nN per metre" if f > 0 else "no drag" for f in force.tolist()]
    return push_words(story.drag, story.drag_word)


def light_words(story: Story) -> list[list[str]]:
    """In sunlight or in shadow, where the run knows the Sun; not of a film that is pushed there
    too, since shadow was left out."""
    if story.craft.facing and "sunlit" not in story.samples.run.environment:
        return []
    if "Sun" not in story.samples.run.bodies and "sunlit" not in story.samples.run.environment:
        return []
    return [["in sunlight" if lit else "in shadow" for lit in story.samples.lit.tolist()]]


def ensemble_words(story: Story) -> list[str]:
    """How far the flights have spread: without control and with the best one, or the widest and the narrowest."""
    ensembles = sorted(story.setting.ensembles, key=lambda e: -e.end_deviation[0])
    widest, narrowest = ensembles[0], ensembles[-1]

    def spread(ensemble: EnsembleStatistics) -> np.ndarray:
        sigma = np.sqrt(np.maximum(ensemble.covariance[:, 0, 0], 0.0)) / story.frame.unit
        return np.asarray(np.interp(story.time, ensemble.time, sigma))

    apart = widest.control == "none" and narrowest.control != "none"

    def said(values: np.ndarray, how: str) -> list[str]:
        if values.max() < NARROW:
            return [f"±{value * story.frame.unit / 1e3:,.0f} km{how}" for value in values.tolist()]
        decimals = int(np.clip(1 - np.floor(np.log10(float(values.max()))), 2, 6))
        return [f"±{value:.{decimals}f} au{how}" for value in values.tolist()]

    first = said(spread(widest), " without control" if apart else f", {widest.name}")
    if len(ensembles) == 1:
        return [f"spread {text.split(',')[0]}" for text in first]
    second = said(spread(narrowest), " with" if apart else f", {narrowest.name}")
    return [f"spread {a}, {b}" for a, b in zip(first, second, strict=True)]
