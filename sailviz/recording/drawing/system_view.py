"""Flights in open space: the centre, the trail, the push along it, the craft and what stands round, in units of order 1
to 100 (never metres: Rerun draws in float32).

Craft and arrow hang under /world/craft, which moves with the craft without turning; /world/rtn turns with its orbit.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr

from sailviz.frames import quaternion, unit
from sailviz.recording.contract import word
from sailviz.recording.drawing import cameras, style
from sailviz.recording.drawing.beside import log_beside, neighbour_of
from sailviz.recording.drawing.cameras import Camera
from sailviz.recording.drawing.ensemble_names import add_ensemble_names
from sailviz.recording.drawing.fence import Fence, fence_of, fence_spans, log_fence
from sailviz.recording.drawing.flights import Flight, log_body, log_flights
from sailviz.recording.drawing.ghosts import log_ghosts
from sailviz.recording.drawing.influence import (
    at_the_bodies,
    log_influence,
    passages_of,
    paths_of_passages,
    spheres_in_sight,
    spheres_of,
)
from sailviz.recording.drawing.landmarks import (
    CRAFT,
    MARK,
    RING,
    SUN,
    Landmarks,
    landmarks_of,
    log_landmarks,
    nominal_words,
    reaches,
)
from sailviz.recording.drawing.layout import ALL, Space, Span
from sailviz.recording.drawing.log import Picture, f4
from sailviz.recording.drawing.names import MAIN, MAIN_OVER_TABLE, Names
from sailviz.recording.drawing.passages import log_passages
from sailviz.recording.drawing.planet import (
    MAGNETOPAUSE_NAME,
    SUNLIGHT_NAME,
    Planet,
    about_axis,
    sunlight_scale,
)
from sailviz.recording.drawing.samples import orbits
from sailviz.recording.drawing.shares import log_shares
from sailviz.recording.drawing.sky import log_stars, log_sun
from sailviz.recording.drawing.story import Story
from sailviz.recording.drawing.style import points
from sailviz.recording.drawing.trail import log_trail
from sailviz.run.arrays import Reference
from sailviz.shapes.primitives import disc

SWEEP_TURNS = 1.25  # revolutions up to which the eye goes along
ASPECT = 1005 / 576  # of the main view in a window of 1600 x 900
SWEPT = 5  # angles of a sweep at which everything must fit
LADDER = 12  # osculating orbits that show a flight of many turns
SMALLEST = 0.35  # of its size that a craft keeps near a planet
NAME_BEYOND = 1.15  # lengths of the arrow of the push that must be in sight, so that its name is
EDGES = 0.10  # of the time at either end, whose pictures count more
FLAT, HIGH = (30.0, 38.0, 42.0), (38.0, 44.0)  # deg, elevations of the eye over flights of few and of many turns
LIFTED_FILM, LIFTED_WHEEL = (-24.0, -14.0, -4.0, 8.0, 20.0, 26.0), (20.0, 24.0, 28.0)


def log_system(
    picture: Picture, story: Story, flights: Sequence[Flight] = ()
) -> tuple[list[Space], dict[str, Span], str]:
    """Write /world -> its views, the spans that they show of what is past and to come, and what is made up. flights :
    all that are drawn together, the first one first; then there are no walls nor still copies, which would hide them.
    """
    found, fence = landmarks_of(story), None if flights else fence_of(story)
    names = Names(story, MAIN_OVER_TABLE if story.setting.ensembles else MAIN)
    size = craft_size(story, bool(flights))
    log_backdrop(picture, story, names)
    if story.most > 0:
        log_shares(picture, story, story.arrow(), None if flights else names)
    log_references(picture, story, found)
    log_craft(picture, story, size, names)
    log_approximations(picture, story, names)
    spans = log_trail(picture, story, alone=not flights) | log_flights(picture, flights, size, names)
    if fence is not None:
        log_fence(picture, story, fence)
        spans |= fence_spans(story)
        log_ghosts(picture, story, size)
    camera, turn = main_camera(story, found, fence, size, flights)
    if np.any(turn):
        picture.log_pose("/world/pan", story.index, quaternion=about_axis(turn))
    log_landmarks(picture, story, found, first_eye(camera), names)
    log_passages(picture, story, first_eye(camera), names)
    spheres = spheres_of(story)
    log_influence(picture, story, names, spheres)
    if story.setting.ensembles:
        add_ensemble_names(story, names)
    add_push_name(story, size, turned(np.tile(first_eye(camera), (len(turn), 1)), -turn), names)
    names.write(picture, camera, turn)
    if story.frame.sparse:
        log_ladder(picture, story)
        spans["/world/ladder"] = ALL
    there = None if flights else neighbour_of(story)
    hidden = [*paths_of_passages(spheres), *([f"{there.path}/**"] if there is not None else [])]
    spaces = [*views_of(story, camera, hidden), *at_the_bodies(story, spheres, first_eye(camera))]
    if there is not None:
        spaces.insert(1, log_beside(picture, story, there))
    return spaces, spans, nominal_words(found, flights[0].name if flights else "this flight")


def system_words(story: Story) -> list[str]:
    """What colours of lines mean, where a scene has such lines."""
    words = []
    if any(r.role == "target" and misses(story, r) for r in story.setting.references):
        words.append("orbits: **pink** the target, thin **cyan** the one reached")
    if story.samples.primer_rtn is not None and story.about("primer"):
        words.append("close up, the **turquoise** arrow is the primer: where the fastest flight would push")
    return words


def craft_size(story: Story, several: bool = False) -> float:
    """Side of a film, radius of a wheel, in view units; 0 where there is only a dot."""
    among = style.AMONG_MANY if several or story.setting.ensembles else 1.0
    return story.craft.size * story.reach * among * beside_a_planet(story)


def beside_a_planet(story: Story) -> float:
    """How much smaller a craft is drawn that begins near a planet and leaves it far behind, 0.35 to 1: at its full size
    it would hide the planet and the turns around it."""
    if story.frame.sun or story.setting.body.radius <= 0:
        return 1.0
    return float(np.clip(2.0 * np.sqrt(story.distance.min() / story.reach), SMALLEST, 1.0))


def log_backdrop(picture: Picture, story: Story, names: Names) -> None:
    """Stars, the centre and the plane x, y."""
    picture.log_static("/world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    log_stars(picture, "/world/stars", style.STARS_RADIUS * story.reach)
    body = story.setting.body
    if story.frame.sun:
        log_sun(picture)
        picture.log_scale("/world/sun", style.SUN_RADIUS * story.reach)
        below = np.array([0.0, 0.0, -2.1 * style.SUN_RADIUS * story.reach])
        names.add("/world/names/Sun", "Sun", style.SUN, below, SUN)
    elif body.radius > 0:
        sun = story.samples.run.bodies.get("Sun")
        Planet(picture, story.setting, sun is not None, story.reach, named=False).add(story.samples)
        names.add("/world/names/central", body.name, style.planet_color(body.name), np.array([0.0, 0.0, -1.0]), SUN)
        if sun is not None:
            place = SUNLIGHT_NAME * sunlight_scale(story.reach) * unit(sun)
            names.add("/world/names/sunlight", "sunlight", style.SUN, place, CRAFT)
            if story.setting.magnetopause is not None:
                nose = MAGNETOPAUSE_NAME * float(story.setting.magnetopause[:, 1].min()) / body.radius * unit(sun)
                names.add("/world/names/magnetopause", "magnetopause", style.dim(style.WIND, 0.8), nose, RING)
    else:
        picture.log_static("/world/center", rr.Points3D([[0, 0, 0]], radii=points(7), colors=[style.SUN]))
        if story.frame.unit_name == "au":  # a star
            below = np.array([0.0, 0.0, -2.1 * style.SUN_RADIUS * story.reach])
            names.add("/world/names/star", body.name, style.SUN, below, MARK)  # nothing else says what it is
    if story.frame.sun or body.radius == 0:
        picture.log_mesh("/world/ecliptic", disc(0.06, style.DISC_RADIUS), style.ECLIPTIC, shaded=False)
        picture.log_scale("/world/ecliptic", story.reach)


def log_references(picture: Picture, story: Story, found: Landmarks) -> None:
    """Orbits that are there from the start, and the one that a transfer reached."""
    for reference in story.setting.references:
        if reference.role != "planet":
            log_reference(picture, reference, story.frame.unit)
    if found.target is not None and misses(story, found.target):
        line = orbits(story.samples.taken(np.array([-1])), story.frame, 361)[-1]
        color = style.dim(style.TRAIL_RECENT, 0.75)
        picture.log_lines("/world/references/reached", [line], color, style.WIDTH["orbit"])


def misses(story: Story, target: Reference) -> bool:
    """Whether a transfer ends on another orbit than the one it aimed at, as far as the eye can tell."""
    return story.setting.family == "transfers" and story.frame.sun and not story.ring and not reaches(story, target)


def log_reference(picture: Picture, reference: Reference, length: float) -> None:
    """An orbit or a way that is known before the flight. A target is drawn a little large: on the trail it would
    tear."""
    line = np.asarray(reference.points, float) / length
    target = reference.role == "target"
    color, width = (style.TARGET, "target") if target else (style.INITIAL, "orbit")
    if reference.role == "approximation":
        color = style.dim(style.APPROXIMATION)
    name = reference.name.lower().replace(" ", "_").replace("/", "_")
    picture.log_lines(f"/world/references/{name}", [1.004 * line if target else line], color, style.WIDTH[width])


def log_craft(picture: Picture, story: Story, size: float, names: Names) -> None:
    """The craft in its attitude, its push, the line from the Sun."""
    samples, index = story.samples, story.index
    log_body(picture, story, "/world/craft", size)
    picture.log_pose("/world/rtn", index, translation=samples.position, quaternion=quaternion(samples.axes))
    if story.frame.sun:
        picture.log_strip_style("/world/sun_line", style.SUN_LINE, style.WIDTH["helper"])
        near = 0.06 * story.reach * unit(samples.position)
        picture.log_strips("/world/sun_line", index, np.stack([near, samples.position], 1))
    if story.lifted and story.frame.sun:
        picture.log_strip_style("/world/height", style.HEIGHT, style.WIDTH["helper"])
        foot = samples.position * [1.0, 1.0, 0.0]
        picture.log_strips("/world/height", index, np.stack([foot, samples.position], 1))
    if story.most <= 0 and not story.setting.ensembles:
        below = samples.position - [0.0, 0.0, 0.6 * size]
        names.add("/world/names/craft", story.setting.craft.label or "craft", style.CRAFT, below, CRAFT)


def log_approximations(picture: Picture, story: Story, names: Names) -> None:
    """Where other answers to the same question put the craft."""
    for name, position in story.samples.run.approximations.items():
        path, place = f"/world/approximation/{word(name)}", position / story.frame.unit
        dot = rr.Points3D.from_fields(radii=points(4.2), colors=[style.APPROXIMATION])
        picture.log_static(f"{path}/place", dot)
        picture.log_columns(f"{path}/place", story.index, rr.Points3D.columns(positions=f4(place)))
        names.add(f"{path}/name", name, style.APPROXIMATION, place, CRAFT)


def log_ladder(picture: Picture, story: Story) -> None:
    """Osculating orbits of a few rows far apart, always in sight: a flight of many turns at a glance."""
    rows = story.ladder(LADDER)
    color = np.full(len(rows), style.rgba(style.TRAIL_FUTURE))
    picture.log_strip_style("/world/ladder", None, style.WIDTH["ladder"])
    lines = orbits(story.samples.taken(rows), story.frame, 241)
    picture.log_strips("/world/ladder", story.samples.index_of(rows), lines, color)


def main_camera(
    story: Story, found: Landmarks, fence: Fence | None, size: float, flights: Sequence[Flight] = ()
) -> tuple[Camera, np.ndarray]:
    """The eye over the flight: on its lit side, and in a flight of up to a turn and a quarter slowly going along; and
    by how much it has turned in each row (n,), rad."""
    film = story.craft.facing
    moments = story.moments
    weights = moment_weights(story, *((5.0, 2.0) if film else (2.0, 4.0)))[moments]
    normals, thrusts = story.normal[moments], unit(story.thrust[moments])
    if not (film or story.craft.slanted):
        normals = np.tile([0.0, 0.0, 1.0], (len(moments), 1))
    turn = np.zeros(len(story.time))
    passed = passages_of(story)
    if passed:  # the bodies apart, and the way from one to the other across the view
        eye = cameras.over_plane(np.cross(story.position, story.samples.velocity).sum(0), passed[0])
    elif story.turns <= SWEEP_TURNS and not story.ring and story.turns > 0.02:
        places = unit(story.position[moments])
        sails = cameras.Moments(normals, thrusts, places, story.share[moments], weights)
        going = cameras.sweep(sails, film, FLAT[1])
        eye, turn = going.eye, going.turn * story.share
    else:
        near = (0.25 if film else 0.55) * unit(story.position[0])
        spots = np.array([np.zeros(3), story.position[0], *near_planets(story, found)]) / story.reach
        eye = cameras.fixed_eye(normals, thrusts, weights, film, elevations(story), near=near, spots=spots)
    places = places_in_sight(story, found, fence, size, turn)
    places = np.concatenate([places, *(beside_in_sight(story, flight.story, size, turn) for flight in flights[1:])])
    at, target = cameras.fit(places, eye, ASPECT, 0.93 if np.any(turn) else 0.90)
    origin = "/world/pan" if np.any(turn) else "/"
    return Camera("Flight", origin, tuple(at.tolist()), tuple(target.tolist())), turn


def first_eye(camera: Camera) -> np.ndarray:
    """The direction (3,) from which a camera looks, at the start."""
    eye: np.ndarray = unit(np.array(camera.position) - np.array(camera.target))
    return eye


def moment_weights(story: Story, first: float, last: float) -> np.ndarray:
    """What each row counts when an eye is chosen, (n,): its time, the ends more."""
    share = story.share
    weights = np.where(share < EDGES, first, np.where(share > 1 - EDGES, last, 1.0))
    if len(share) < 2:
        return np.ones(len(share))
    return np.asarray(weights * np.maximum(np.gradient(share), 1e-12))


def elevations(story: Story) -> tuple[float, ...]:
    """Heights of the eye, deg, that are tried for a fixed one."""
    if story.lifted:
        return LIFTED_FILM if story.craft.facing else LIFTED_WHEEL
    return HIGH if story.turns > 3 and not story.ring else FLAT


def near_planets(story: Story, found: Landmarks) -> list[np.ndarray]:
    """First places of the planets whose names are written, those on the craft left out."""
    first = [place[0] for place in found.places.values()]
    return [
        place
        for place in first
        if np.linalg.norm(place) >= 0.18 * story.reach and np.linalg.norm(place - story.position[0]) > 0.1 * story.reach
    ]


def places_in_sight(story: Story, found: Landmarks, fence: Fence | None, size: float, turn: np.ndarray) -> np.ndarray:
    """Everything that must fit, (k, 3), in the frame of the eye, which turns by `turn` (n,) rad."""
    position, arrow = story.position, story.arrow()
    still = [position, *found.farthest(story.reach), *spheres_in_sight(story)]
    still += [way for way in found.ways(story.reach).values() if not story.frame.sun]
    if fence is not None:
        still.append(fence.top)
    still += [
        reference.points / story.frame.unit for reference in story.setting.references if reference.role == "initial"
    ]
    for ensemble in story.setting.ensembles:
        still.append(ensemble.places(ensemble.kept[:, -1]).reshape(-1, 3) / story.frame.unit)
    if not np.any(turn):
        arrows = position + arrow if story.ring else (position + NAME_BEYOND * arrow)[story.moments]
        around = position[[0, -1], None] + size * np.array([[0, 0, -1.0], [0, 0, 1.0]])
        return np.concatenate([*still, arrows, around.reshape(-1, 3)])
    fixed = np.concatenate(still)
    swept = [turned(fixed, np.full(len(fixed), angle)) for angle in np.linspace(0, turn[-1], SWEPT)]
    edge = np.array([0.0, 0.0, size])
    moving = [position + NAME_BEYOND * arrow, position - edge, position + edge]
    return np.concatenate(swept + [turned(part, turn) for part in moving])


def beside_in_sight(first: Story, story: Story, size: float, turn: np.ndarray) -> np.ndarray:
    """What must fit of a flight beside the first, (k, 3), in the frame of the eye, which turns by `turn` in the first
    one's rows: its way seen at any time, its craft when it is there."""
    way = story.position
    edge = np.array([0.0, 0.0, size])
    now = np.interp(story.time, first.time, turn)
    moving = [turned(part, now) for part in (way + 1.15 * story.arrow(), way - edge, way + edge)]
    angles = np.linspace(0, turn[-1], SWEPT) if np.any(turn) else [0.0]
    return np.concatenate([turned(way, np.full(len(way), angle)) for angle in angles] + moving)


def turned(places: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Places (n, 3) in a frame that has turned about z by angles (n,) rad."""
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = places.T
    return np.stack([c * x + s * y, c * y - s * x, z], 1)


def add_push_name(story: Story, size: float, eye: np.ndarray, names: Names) -> None:
    """The word "push" beyond the tip of its arrow as seen from directions (n, 3), clear of the film."""
    if story.most <= 0:
        return
    arrow = story.arrow()
    flat = arrow - np.sum(arrow * eye, 1, keepdims=True) * eye
    length = np.linalg.norm(flat, axis=1, keepdims=True)
    place = story.position + unit(flat) * np.maximum(length + 0.045 * story.reach, 0.9 * size)
    names.add("/world/names/push", "push", style.PUSH, np.where((story.push > 0)[:, None], place, np.nan), CRAFT)


def views_of(story: Story, camera: Camera, hidden: Sequence[str] = ()) -> list[Space]:
    """The main view, from above, and riding along. hidden : what only other views show."""
    reach = story.reach
    everything = ("+ /world/**", *(f"- {path}" for path in hidden))
    top = float(max(2.35 * reach, 1.5 * story.position[:, 2].max() + 1.2 * reach))
    ride = riding_eye(story) * 0.75 * reach
    along = (*everything, "- /world/names/**", "- /world/marks/**")
    return [
        Space(camera, everything),
        Space(Camera("From above", "/", (0.0, -0.01 * reach, top)), everything),
        Space(Camera("Riding along", "/world/rtn", tuple(ride.tolist())), along),
    ]


def riding_eye(story: Story) -> np.ndarray:
    """Where the view along with the craft looks from, in its orbital frame."""
    moments, samples = story.moments, story.samples
    normals, thrusts = samples.normal_rtn[moments], unit(samples.thrust_rtn[moments])
    weights = moment_weights(story, 5.0, 2.0)[moments]
    return cameras.fixed_eye(normals, thrusts, weights, story.craft.facing, (14.0, 22.0, 30.0))
