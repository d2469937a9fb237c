"""A low orbit: the craft over the ground with what brakes it, and the globe with the orbit of the moment.

/world/rtn moves and turns with the orbit (radial, transverse, normal); riding along it, the ground passes below. The
craft and its tether are drawn far too large, which the view's name says; orbits and heights are to scale.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import rerun as rr

from sailviz.frames import body_axes, quaternion, to_frame, unit
from sailviz.recording.drawing import cameras, lit_shape, style
from sailviz.recording.drawing.cameras import Camera
from sailviz.recording.drawing.craft import Glow, log_stowing, log_tether
from sailviz.recording.drawing.flights import Flight
from sailviz.recording.drawing.layout import ALL, Space, Span
from sailviz.recording.drawing.log import Color, Picture, f4
from sailviz.recording.drawing.low_flights import in_front, log_low_flights, season
from sailviz.recording.drawing.names import Names
from sailviz.recording.drawing.near import axes_rtn, is_given
from sailviz.recording.drawing.orbit_plane import OrbitPlane, shell_words
from sailviz.recording.drawing.phrases import push_words
from sailviz.recording.drawing.planet import Planet
from sailviz.recording.drawing.samples import PLANE_TURNS, rings
from sailviz.recording.drawing.sky import log_stars
from sailviz.recording.drawing.story import Story
from sailviz.recording.drawing.style import points
from sailviz.shapes import sails
from sailviz.shapes.primitives import circle

GROUND, DRAG, FLIGHT = range(3)  # names; what matters more has the lower rank
LADDER = 12  # orbits that show a descent
SATELLITE, SMALL = 0.062, 0.05  # size of a satellite with a tether, and with air alone, in radii of the planet
FILM = 0.075  # side of a drag sail
TETHER, CLEARANCE = 0.075, 0.75  # length of a tether, and how much of the altitude it may take at most
LEAST_TETHER = 0.004
MANY = 7  # arrows along a tether
LEAST, MORE = 0.035, 0.075  # length of a drag arrow, and what the root of its share of the largest adds
UNBRAKED = 0.075  # behind the arrows, or the craft, where the drag is told
TAIL = 0.9  # rad of the orbit behind the craft that are bright
BESIDE = 1.0004  # radii: the tail lies over the ring
EYE, TARGET = np.array([0.105, -0.085, 0.315]), (-0.066, -0.010, 0.0)  # riding along, radii of the planet
FARTHER = 1.3  # times as far, where the push may point anywhere
FAR = 2.2  # distances of the start from which the globe is seen
SEASON_MISS = -0.02  # mean of the Sun's height over the orbit from which its other side is taken
SINKS = 1.0  # km, a descent whose colours are worth a line
CIRCLE = 241  # points of the ring
DESCENT = "Descent (orbits in one plane, to scale)"


def log_low_orbit(
    picture: Picture, story: Story, flights: Sequence[Flight] = ()
) -> tuple[list[Space], Space, dict[str, Span]]:
    """Write /world -> the tabs of the main view, the globe, and the spans that they show. flights : all that are drawn
    together, the first one first; then what compares them is in front, and old orbits are left out."""
    run = story.samples.run
    picture.log_static("/world", rr.ViewCoordinates.RIGHT_HAND_Z_UP)
    log_stars(picture, "/world/stars", style.STARS_RADIUS * story.reach)
    Planet(picture, story.setting, "Sun" in run.bodies, story.reach).add(story.samples)
    log_orbit(picture, story, *orbit_colors(story, flights))
    plane = log_plane(picture, story, flights)
    riding, names = riding_along(story), Names(story)
    log_craft(picture, story, names)
    names.write(picture, riding.camera)
    spans: dict[str, Span] = dict.fromkeys(("/world/plane/ladder", "/world/plane/rungs"), ALL) if plane else {}
    globe = log_globe_eye(picture, story, flights[0].color if flights else style.CRAFT)
    tabs = [riding, from_afar(globe), *(descent(story) if plane else [])]
    if flights:
        log_low_flights(picture, flights, np.array(globe.camera.position), plane)
        return tabs[::-1], globe, {}
    return tabs, globe, spans


def orbit_words(story: Story) -> list[str]:
    """What the colour of the orbit means, how many turns are shown, and what the maps are."""
    start, far = story.altitude[0] / 1e3, farthest_altitude(story) / 1e3
    if abs(start - far) < SINKS and story.frame.slowed <= 1.5:
        return shell_words(story.samples.run)
    words = f"orbit: **blue** at {start:.0f} km to **pink** at {far:.0f} km"
    if story.frame.slowed > 1.5:
        turns = story.frame.turns * story.duration / story.frame.duration
        words += f"; of {turns:,.0f} turns {turns / story.frame.slowed:.0f} are shown"
    return [words, *shell_words(story.samples.run)]


def descent_colors(story: Story, rows: np.ndarray | slice = slice(None), factor: float = 1.0) -> np.ndarray:
    """Colours 0xRRGGBBAA (n,) by altitude, from that of the start to the lowest, or highest, of the run."""
    altitude = story.altitude
    change = farthest_altitude(story) - altitude[0]
    change = change if abs(change) > 1e3 else -1e3
    return style.ramp(np.clip((altitude[rows] - altitude[0]) / change, 0, 1), style.ALTITUDE_RAMP, factor)


def farthest_altitude(story: Story) -> float:
    """m, the lowest of a run, or the highest of one that climbs more than it sinks."""
    low, high = float(story.altitude.min()), float(story.altitude.max())
    return high if high - story.altitude[0] > story.altitude[0] - low else low


def orbit_colors(story: Story, flights: Sequence[Flight]) -> tuple[np.ndarray, np.ndarray]:
    """Colours (n,) of the bright and of the dim part of the orbit: by altitude, or among flights the flight's own."""
    if not flights:
        return descent_colors(story), descent_colors(story, factor=0.8)
    own = flights[0].color
    bright, dim = (np.full(len(story.time), style.rgba(color), np.uint32) for color in (own, style.dim(own, 0.8)))
    return bright, dim


def log_orbit(picture: Picture, story: Story, colors: np.ndarray, faint: np.ndarray) -> None:
    """The orbit of the moment as a ring, bright behind the craft."""
    samples = story.samples
    line = rr.LineStrips3D.from_fields(strips=[f4(circle(CIRCLE))], radii=points(style.WIDTH["ring"]))
    picture.log_static("/world/orbit", line)
    inertial = np.broadcast_to(np.eye(3), samples.axes.shape)
    placed: dict[str, Any] = {name: f4(value) for name, value in rings(samples.run, inertial, story.frame).items()}
    columns = [*rr.Transform3D.columns(**placed), *rr.LineStrips3D.columns(colors=faint)]
    picture.log_columns("/world/orbit", story.index, columns)
    picture.log_strip_style("/world/tail", None, style.WIDTH["tail"])
    picture.log_strips("/world/tail", story.index, tails(story), colors)


def tails(story: Story, count: int = 14) -> np.ndarray:
    """The part of the orbit behind the craft, (n, count, 3)."""
    run, axes = story.samples.run, story.samples.axes
    back = -TAIL * np.linspace(1.0, 0.0, count) ** 1.3  # closer to each other near the craft, where the eye is
    e = run.elements
    # the orbit's own distance there: r = p / (1 + e cos nu), with the anomaly of the drawn place
    radial = axes[..., 0]
    node = np.stack([np.cos(e.raan), np.sin(e.raan), 0 * e.raan], 1)
    ahead = np.cross(axes[..., 2], node)
    longitude = np.arctan2(np.sum(radial * ahead, 1), np.sum(radial * node, 1))
    anomaly = (longitude - e.argument)[:, None] + back
    rectum = e.semi_major_axis * (1 - e.eccentricity**2) / story.frame.unit
    distance = rectum[:, None] / (1 + e.eccentricity[:, None] * np.cos(anomaly))
    distance = np.where(np.isfinite(distance) & (distance > 0), distance, story.distance[:, None])
    distance *= (story.distance / distance[:, -1])[:, None] * BESIDE
    circle = np.stack([np.cos(back), np.sin(back), 0 * back], 1)
    return np.asarray(np.einsum("nij,kj->nki", axes, circle) * distance[..., None])


def log_plane(picture: Picture, story: Story, flights: Sequence[Flight]) -> bool:
    """What lies in the orbit's plane, to scale, where a flight is long enough to be compared with itself; among flights
    without its old orbits."""
    if story.frame.turns <= PLANE_TURNS:
        return False
    name, color = (f"{flights[0].name} ", flights[0].color) if flights else ("", style.CRAFT)
    plane = OrbitPlane(picture, story.samples.run, story.frame, color)
    plane.add(story.samples, orbit_colors(story, flights)[0], name)
    if not flights:
        rows, samples = story.ladder(LADDER), story.samples
        plane.add_ladder(samples.taken(rows), samples.index_of, rows, descent_colors(story, rows), LADDER)
    return True


def log_craft(picture: Picture, story: Story, names: Names) -> None:
    """The satellite with its tether or its drag sail, what brakes it, the way it flies, the plumb line."""
    samples, craft, index = story.samples, story.craft, story.index
    count = len(samples)
    picture.log_pose("/world/rtn", index, translation=samples.position, quaternion=quaternion(samples.axes))
    ahead = np.tile([0.0, 1.0, 0.0], (count, 1))
    body = axes_rtn(samples) if is_given(samples) else body_axes(samples.stance_rtn, ahead)
    picture.log_pose("/world/rtn/body", index, quaternion=quaternion(body))
    tether = tether_length(story)
    if craft.tether:
        craft.log_shape(picture, "/world/rtn/body/shape", True)
        log_tether(picture, "/world/rtn/body/tether", 0.02, 1.8, 0.05)
        picture.log_pose("/world/rtn/body/tether", index, quaternion=story.spin, scale=np.repeat(tether[:, None], 3, 1))
        if story.spin is None:
            picture.log_scale("/world/rtn/body/shape", SATELLITE)
        else:
            same = np.full((count, 3), SATELLITE)
            picture.log_pose("/world/rtn/body/shape", index, quaternion=story.spin, scale=same)
    elif craft.pushes or story.setting.craft.parts:
        if lit_shape.is_lit(story):
            lit_shape.log_facets(picture, story, "/world/rtn/body/shape/facets")
        else:
            craft.log_shape(picture, "/world/rtn/body/shape", True)
        picture.log_scale("/world/rtn/body/shape", FILM)
        log_stowing(picture, "/world/rtn/body/shape", craft, index, story.stowed, True)
    else:
        log_drag_sail(picture, story)
    Glow(picture, "/world/rtn/body", craft).add(samples.index_of, samples.run.thrust.on)
    log_drag(picture, story, tether, names)
    if np.any(samples.velocity_rtn):
        picture.log_static(
            "/world/rtn/flight",
            rr.Arrows3D(origins=[[0, 0.012, 0]], vectors=[[0, 0.085, 0]], colors=[style.SPEED], radii=points(1.6)),
        )
        spots = [np.array([up, 0.115, 0.0]) for up in (0.0, 0.022, -0.022)]
        names.add("/world/rtn/flight/name", "flies this way", style.SPEED, spots[0], FLIGHT, spots[1:])
    log_plumb(picture, story, tether, names)
    dot = rr.Points3D.from_fields(radii=points(5.5), colors=[style.CRAFT])
    picture.log_static("/world/craft", dot)
    picture.log_columns("/world/craft", index, rr.Points3D.columns(positions=f4(samples.position)))


def tether_length(story: Story) -> np.ndarray:
    """(n,) view units: as long as the altitude allows, so that it never enters the ground; 0 without one."""
    if not story.craft.tether:
        return np.zeros(len(story.time))
    return np.clip(CLEARANCE * (story.distance - 1), LEAST_TETHER, TETHER)


def log_drag_sail(picture: Picture, story: Story) -> None:
    """A satellite whose film stands across the flight, whatever its attitude: how it tumbles is not known."""
    from sailviz.recording.drawing.devices import log_satellite

    log_satellite(picture, "/world/rtn/body/shape", True)
    picture.log_scale("/world/rtn/body/shape", SMALL)
    film = sails.film()
    for side, shade in (("back", 1.0), ("front", 0.88)):
        picture.log_mesh(f"/world/rtn/drag_sail/{side}", film, style.dim(style.DRAG_FILM, shade), side=side)
    across = quaternion(body_axes(np.array([[0.0, 1.0, 0.0]]), np.array([[1.0, 0.0, 0.0]])))[0]
    picture.log_static(
        "/world/rtn/drag_sail", rr.Transform3D(quaternion=rr.Quaternion(xyzw=f4(across)), scale=[FILM] * 3)
    )


def log_drag(picture: Picture, story: Story, tether: np.ndarray, names: Names) -> None:
    """Arrows against the flight: many along a tether, one of the air; with its number."""
    drag, most = story.drag, float(story.drag.max())
    if most <= 0:
        return
    samples, count = story.samples, len(story.time)
    down = unit(samples.thrust_rtn) if story.craft.tether or story.craft.pushes else -samples.velocity_rtn
    length = np.where(drag > 0, LEAST + MORE * np.sqrt(np.maximum(drag, 0.0) / most), 0.0)
    vectors = length[:, None] * down
    hanging = story.craft.tether
    places = np.linspace(0.12, 0.96, MANY) if hanging else np.zeros(1)
    axis = story.tether_rtn if hanging else np.zeros((count, 3))
    origins = -tether[:, None, None] * places[None, :, None] * axis[:, None]
    shown = np.repeat(vectors * (0.75 if hanging else 1.0), len(places), axis=0)
    picture.log_arrow_style("/world/rtn/drag", style.PUSH, style.WIDTH["many drags" if hanging else "drag"])
    columns = rr.Arrows3D.columns(origins=f4(origins.reshape(-1, 3)), vectors=f4(shown))
    picture.log_columns("/world/rtn/drag", story.index, columns.partition([len(places)] * count))
    below = 0.55 if story.spin is None else 1.02  # out of the way of what turns
    away = 0.75 * length + UNBRAKED if hanging else np.where(drag > 0, 1.25 * length, UNBRAKED)
    back = np.where((drag > 0)[:, None], down, -samples.velocity_rtn)  # "no drag" stands off the craft as well
    place = away[:, None] * back - below * tether[:, None] * (samples.normal_rtn if hanging else axis)
    names.add("/world/rtn/drag_name", drag_texts(story), style.PUSH, place, DRAG)


def drag_texts(story: Story) -> list[str]:
    """What stands beside the arrows."""
    force = story.samples.run.environment.get("plasma_force_N_m")
    if force is not None:
        return [f"drag {1e9 * f:.0f} nN per metre" if f > 0 else "no drag" for f in force.tolist()]
    return push_words(story.drag, story.drag_word)


def log_plumb(picture: Picture, story: Story, tether: np.ndarray, names: Names) -> None:
    """A line straight down to the ground, with the height there."""
    height = story.distance - 1
    zero = np.zeros_like(height)
    foot = np.stack([-height, zero, zero], 1)
    hangs = story.craft.tether and story.spin is None
    top = np.stack([-(tether if hangs else zero + min(0.03, 0.3 * height.min())), zero, zero], 1)
    picture.log_strip_style("/world/rtn/plumb", style.PLUMB, 0.8)
    picture.log_strips("/world/rtn/plumb", story.index, np.stack([top, foot], 1))
    ground = rr.Points3D.from_fields(radii=points(style.MARK_DOT), colors=[style.CRAFT], show_labels=True)
    picture.log_static("/world/rtn/ground", ground)
    texts = [f"{h * story.frame.unit / 1e3:.0f} km" for h in height.tolist()]
    picture.log_columns("/world/rtn/ground", story.index, rr.Points3D.columns(positions=f4(foot), labels=texts))
    names.add("", texts, style.CRAFT, foot, GROUND)


def log_globe_eye(picture: Picture, story: Story, color: Color) -> Space:
    """The globe from afar, on its day side, in a frame that turns with the Sun; the craft is named, in a colour, while
    it is in front."""
    samples, sun = story.samples, story.samples.run.bodies.get("Sun")
    pole = samples.axes[0, :, 2]
    towards = cameras.over_planet(pole, None if sun is None else unit(sun[0]))
    distance = FAR * float(story.distance[0])
    origin = "/" if sun is None else "/world/season"
    azimuth = season(story, story.time)
    c, s = np.cos(azimuth[0]), np.sin(azimuth[0])
    x, y, z = distance * towards
    eye = np.array([c * x + s * y, c * y - s * x, z])
    picture.log_label_style("/world/craft/name", color, story.setting.craft.label or "craft")
    place = in_front(samples.position, eye, azimuth)
    picture.log_labels("/world/craft/name", story.index, place)
    hidden = ("drag", "drag_name", "flight", "ground", "plumb", "body", "drag_sail")
    contents = (
        "+ /world/**",
        *(f"- /world/rtn/{name}/**" for name in hidden),
        "- /world/plane/**",
        "- /world/night/sunlight/**",
    )
    return Space(Camera("Where it is", origin, tuple(eye.tolist())), contents)


def from_afar(globe: Space) -> Space:
    """The globe, large, and from where the Sun shines."""
    camera = globe.camera
    contents = tuple(rule for rule in globe.contents if "sunlight" not in rule)
    return Space(Camera("From afar", camera.origin, camera.position), contents)


def riding_along(story: Story) -> Space:
    """From the side on which the Sun is on average, high enough to see the ground and the edge of the planet."""
    sun, samples = story.samples.run.bodies.get("Sun"), story.samples
    side = 1.0
    if sun is not None:
        side = 1.0 if to_frame(samples.axes, unit(sun))[:, 2].mean() >= SEASON_MISS else -1.0
    back = FARTHER if story.craft.pushes and not story.craft.tether else 1.0
    eye, target = back * EYE * [1.0, 1.0, side], back * np.array(TARGET)
    contents = (
        "+ /world/**",
        "- /world/craft/**",
        "- /world/plane/**",
        "- /world/night/umbra",
        "- /world/night/penumbra",
        "- /world/night/sunlight/**",
    )
    camera = Camera(riding_name(story), "/world/rtn", tuple(eye.tolist()), tuple(target.tolist()), (1.0, 0.0, 0.0))
    return Space(camera, contents)


def riding_name(story: Story) -> str:
    """What is not to scale, and how much slower than the run the craft goes round."""
    notes = ["craft not to scale"]
    true = story.craft.true_size(story.setting.craft)
    if story.craft.tether and true:
        drawn = float(np.median(tether_length(story))) * story.frame.unit
        notes = [f"tether drawn about {float(f'{drawn / true:.2g}'):,.0f} times too long"]
        notes += ["its spin slowed"] if story.spin is not None else []
    return f"Riding along ({', '.join(notes)})"


def descent(story: Story) -> list[Space]:
    """Over the orbits' plane, at the edge of a planet of radius 1, up to the highest orbit; up is away from it."""
    high = story.reach
    middle, distance = 0.5 * (0.98 + high), 1.15 * (high - 0.98)
    contents = [f"+ /world/{name}/**" for name in ("stars", "plane", "center", "night")]
    contents += ["- /world/night/umbra", "- /world/night/penumbra", "- /world/night/sunlight/**"]
    contents += ["- /world/center/air/halo"]  # its heights are for the eye only
    camera = Camera(DESCENT, "/world/plane", (middle, 0.0, distance), (middle, 0.0, 0.0), (1.0, 0.0, 0.0))
    return [Space(camera, tuple(contents))]
