"""What stands round a flight about the Sun: planets with bodies, rings and names, the target's ring, start, end and
events.

Where a scene has a date planets stand where they were. Where it has none, the planet departed from stands where the
craft starts and the one arrived at where it ends, both on circles at their own pace: the words say so.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import rerun as rr

from sailviz.constants import AU, MU_SUN
from sailviz.recording.drawing import style
from sailviz.recording.drawing.log import Color, Picture, f4
from sailviz.recording.drawing.names import Names
from sailviz.recording.drawing.phases import at_a_switch, reached, switches
from sailviz.recording.drawing.phrases import on_day
from sailviz.recording.drawing.samples import orbits
from sailviz.recording.drawing.story import Story
from sailviz.recording.drawing.style import points
from sailviz.run.arrays import Event, Reference

MARK, SUN, ENSEMBLE, PLANET, CRAFT, TARGET_RING, RING = range(7)  # what matters more has the lower rank
MET = 0.12  # relative distance from a planet's orbit within which a flight starts or ends at it
LARGER = 1.004  # a ring beside the trail: lines on one another tear
MOST_EVENTS = 2  # named between start and end
THERE = 0.02  # of S: closer than this is the same place or the same line
MEET = 0.06  # of S: start and end closer than this have one name
WAYS_WITHIN = 1.5  # of S: farther away the way of a moon is not drawn
FLYBY, VIOLATION = "flyby of ", "violation"  # how events begin that have marks of their own
NEAR_END = 0.97  # of the time from which an event is what the flight ends with


@dataclass
class Landmarks:
    """places (n, 3) of the planets that move, rings (k, 3) of those that are drawn, view units; nominal: those whose
    places are made up for want of a date; spots: places that names should keep away from."""

    places: dict[str, np.ndarray] = field(default_factory=dict)
    rings: dict[str, np.ndarray] = field(default_factory=dict)
    nominal: list[str] = field(default_factory=list)
    target: Reference | None = None
    length: float = 1.0

    def ways(self, reach: float) -> dict[str, np.ndarray]:
        """Ways (n, 3) of the bodies without a ring that stay within what is seen: of a moon."""
        return {
            name: place
            for name, place in self.places.items()
            if name not in self.rings and np.linalg.norm(place, axis=1).max() < WAYS_WITHIN * reach
        }

    def farthest(self, reach: float) -> list[np.ndarray]:
        """Rings that must be in sight: those that the flight comes near, and the target."""
        inner = [ring for ring in self.rings.values() if np.linalg.norm(ring, axis=1).max() < 1.06 * reach]
        return inner + ([self.target.points / self.length] if self.target is not None else [])


def landmarks_of(story: Story) -> Landmarks:
    """The planets and the target of a flight."""
    setting, run, length = story.setting, story.samples.run, story.frame.unit
    found = Landmarks(length=length)
    found.target = next((r for r in setting.references if r.role == "target"), None)
    rings = {r.name: r.points / length for r in setting.references if r.role == "planet"}
    found.places = {name: place / length for name, place in run.bodies.items() if name != "Sun"}
    if not found.places and setting.body.name == "Sun":
        found.places = nominal_places(story, rings)
        found.nominal = list(found.places)
    near = {
        name: ring
        for name, ring in rings.items()
        if np.linalg.norm(ring, axis=1).max() < style.PLANETS_WITHIN * story.reach
    }
    same = found.target.name.removeprefix("orbit of ") if found.target is not None else ""
    found.rings = {name: ring for name, ring in near.items() if not (found.nominal and name == same)}
    found.places = {
        name: place
        for name, place in found.places.items()
        if name not in rings or name in near or np.linalg.norm(place, axis=1).min() < style.PLANETS_WITHIN * story.reach
    }
    return found


def nominal_places(story: Story, rings: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Places (n, 3) on circles of the planets at which a flight without a date starts and ends."""
    found = {}
    start, end = story.distance[0], story.distance[-1]
    longitude = np.unwrap(np.arctan2(story.position[:, 1], story.position[:, 0]))
    for name, ring in rings.items():
        a = float(np.linalg.norm(ring, axis=1).mean())
        rate = np.sqrt(MU_SUN / (a * AU) ** 3)
        if abs(a - start) < MET * a:
            phase = longitude[0]
        elif abs(a - end) < MET * a:
            phase = longitude[-1] - rate * story.duration
        else:
            continue
        angle = phase + rate * (story.time - story.time[0])
        found[name] = a * np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    return found


def nominal_words(found: Landmarks, whose: str = "this flight") -> str:
    """What a description says about planets whose places are made up; "" where none are. whose : flight they suit."""
    if not found.nominal:
        return ""
    names = " and ".join(name for name in found.nominal if name in found.places)
    return f"No date is given: {names} placed where {whose} would meet {'it' if ' and ' not in names else 'them'}."


def log_landmarks(picture: Picture, story: Story, found: Landmarks, eye: np.ndarray, names: Names) -> None:
    """Write /world/planets and /world/marks, seen from the direction `eye` (3,), and say what has which name."""
    log_planets(picture, story, found, names)
    add_ring_names(story, found, eye, names)
    log_marks(picture, story, eye, names)


def log_planets(picture: Picture, story: Story, found: Landmarks, names: Names) -> None:
    """Bodies that move, with their names, and rings."""
    for name, ring in found.rings.items():
        color = style.dim(style.planet_color(name), 0.5)
        picture.log_lines(f"/world/planets/{name}/orbit", [ring], color, style.WIDTH["orbit"])
    if not story.frame.sun:
        for name, way in found.ways(story.reach).items():
            color = style.dim(style.planet_color(name), 0.5)
            picture.log_lines(f"/world/planets/{name}/way", [way], color, style.WIDTH["orbit"])
    for name, place in found.places.items():
        color = style.planet_color(name)
        dot = rr.Points3D.from_fields(radii=points(style.PLANET_DOTS.get(name, 5.6)), colors=[color])
        picture.log_static(f"/world/planets/{name}/body", dot)
        picture.log_columns(f"/world/planets/{name}/body", story.index, rr.Points3D.columns(positions=f4(place)))
        if np.linalg.norm(place, axis=1).max() >= style.NAMES_FROM * story.reach:
            names.add(f"/world/names/{name}", name, color, place, PLANET)


def add_ring_names(story: Story, found: Landmarks, eye: np.ndarray, names: Names) -> None:
    """Each ring's name where it is farthest on the screen from everything that has another."""
    moments = [0, len(story.time) // 2, -1]
    avoid = [np.zeros(3), *story.position[moments]]
    avoid += [place[k] for place in found.places.values() for k in moments]
    rings: list[tuple[str, str, Color, np.ndarray]] = []
    if found.target is not None:
        line = np.asarray(found.target.points, float) / found.length
        rings.append(("target", target_words(story, found.target), style.TARGET_NAME, line))
    for name, ring in found.rings.items():
        if name not in found.places and np.linalg.norm(ring, axis=1).mean() >= 0.3 * story.reach:
            rings.append((name, f"orbit of {name}", style.dim(style.planet_color(name), 0.8), ring))
    for key, words, color, ring in rings:
        spot = farthest_on_screen(ring[::4], np.array(avoid), eye)
        avoid.append(spot)
        names.add(f"/world/names/orbits/{key}", words, color, spot, TARGET_RING if key == "target" else RING)


def target_words(story: Story, target: Reference) -> str:
    """A ring's name: what it is the orbit of, or what the flight does with it."""
    if target.name.startswith("orbit of"):
        return target.name
    return "designed orbit" if target.name == "designed orbit" else "target orbit"


def farthest_on_screen(line: np.ndarray, avoid: np.ndarray, eye: np.ndarray) -> np.ndarray:
    """The point of a line (k, 3) whose distance across the line of sight to the nearest of `avoid` (m, 3) is most."""
    off = line[:, None] - avoid[None]
    flat = off - (off @ eye)[..., None] * eye
    best: np.ndarray = line[np.argmax(np.linalg.norm(flat, axis=-1).min(1))]
    return best


def marked_events(story: Story) -> list[tuple[str, np.ndarray]]:
    """Words and places of what is marked between the start and the end, and of the end in the event's own words: the
    distance of Mars is not Mars."""
    duration, first = story.duration, float(story.time[0])
    events = [e for e in story.events if not at_a_switch(story.setting, e) and not is_passage(e)]
    inside = [e for e in events if 0.02 * duration < e.time - first < NEAR_END * duration]
    last = [e for e in events if e.time - first >= NEAR_END * duration]
    named = [(e.name, e) for e in told_once(inside)[:MOST_EVENTS]]
    named = sorted([*named, *switches(story.setting, story.events)], key=lambda pair: pair[1].time)
    found = [(f"{words}, {on_day(e.time - first, duration)}", place_of(story, e)) for words, e in named]
    found.append((f"{end_words(story, last)}, {on_day(duration, duration)}", story.position[-1]))
    return found


def is_passage(event: Event) -> bool:
    """Whether an event is a body passed or a rule broken, which `passages.py` marks."""
    return event.name.startswith((FLYBY, VIOLATION))


def place_of(story: Story, event: Event) -> np.ndarray:
    """Where an event is drawn, (3,): where it was, or where a slowed run draws the row before it."""
    if story.frame.sparse:
        place: np.ndarray = story.position[max(int(np.searchsorted(story.time, event.time, "right")) - 1, 0)]
        return place
    return np.asarray(event.state[:3] / story.frame.unit)


def told_once(events: list[Event]) -> list[Event]:
    """The events whose name comes but once: what happens in every revolution is not a mark."""
    names = [e.name for e in events]
    return [e for e in events if names.count(e.name) == 1]


def end_words(story: Story, last: list[Event]) -> str:
    """What a flight ends with: an event in its own words, or an orbit that it is on. A planet is only reached where it
    is."""
    if last and " at t = " not in last[-1].name:
        return last[-1].name
    target = next((r for r in story.setting.references if r.role == "target"), None)
    if target is None or not reaches(story, target):
        return "end"
    planet = story.samples.run.bodies.get(target.name.removeprefix("orbit of "))
    if planet is not None and np.linalg.norm(planet[-1] / story.frame.unit - story.position[-1]) < THERE * story.reach:
        return f"reaches {target.name.removeprefix('orbit of ')}"
    return f"reaches the {target.name}"


def reaches(story: Story, target: Reference) -> bool:
    """Whether the orbit of the last row is that of a target, as far as the eye can tell."""
    aim = np.asarray(target.points, float) / story.frame.unit
    line = orbits(story.samples.taken(np.array([-1])), story.frame, 121)[0]
    gaps = np.linalg.norm(line[:, None] - aim[None], axis=-1).min(1)
    return bool(gaps.max() < THERE * story.reach)


def log_marks(picture: Picture, story: Story, eye: np.ndarray, names: Names) -> None:
    """Dots and names at the start, at the end and at one or two events between; a ring has neither start nor end."""
    away = np.linalg.norm(story.position - story.position[0], axis=1)
    if story.ring or away.max() < 1e-2 * story.reach:
        return
    phases = reached(story.setting)
    begins = f"start: {phases[0].name}" if phases else "start"
    marks = [(begins, story.position[0]), *marked_events(story)]
    if story.setting.ensembles:
        marks = marks[:1]
    elif away[-1] < MEET * story.reach < 0.5 * away.max():  # it has been elsewhere meanwhile
        marks = [*marks[:-1], (f"{marks[-1][0]}: where it began", story.position[-1])][1:]
    rise = np.array([0.0, 0.0, style.RAISED * story.reach / max(np.sqrt(1 - eye[2] ** 2), 0.3)])
    dots = np.array([place for _, place in marks])
    picture.log_static("/world/marks", rr.Points3D(f4(dots), radii=points(style.MARK_DOT), colors=[style.CRAFT]))
    for number, (words, place) in enumerate(marks):
        names.add(f"/world/marks/{number}", words, style.CRAFT, place + rise, MARK)
