"""The planet below: its rotation against sidereal time, its night against the Sun, the plane of the orbit."""

from __future__ import annotations

import io
import re
from functools import cache
from itertools import pairwise

import numpy as np
import trimesh

from .facts import unit
from .low import ramp, ramped
from .measure import hue, same_angle, same_direction, same_place, same_turn
from .seen import poses, shown, some, spots, texts
from .system import ladder, osculating

ALMANAC = 0.02  # deg: what the Almanac's Sun and sidereal times of different years differ by
NIGHT_FROM = 80.0  # deg from the point opposite the Sun inside which all is dark
DARKEST = 153  # opacity from which night grows no darker: the ground stays readable
DUSK_TO = 100.0  # deg from it beyond which nothing is


def geographic(points) -> np.ndarray:
    """Longitude and latitude, rad."""
    points = unit(points)
    return np.stack([np.arctan2(points[..., 1], points[..., 0]), np.arcsin(np.clip(points[..., 2], -1, 1))], -1)


def globe_turn(f, entity):
    """Greenwich stands at the sidereal time; of a slowed run the Earth turns as much slower as the craft. A trajectory
    of mere arrays does not turn it."""
    pose = poses(f, entity)
    if "earth_rotation_rad" not in f.truth.environment:
        same_turn(pose[:, :3, :3], np.broadcast_to(np.eye(3), (len(pose), 3, 3)))
        return
    same_angle(np.arctan2(pose[:, 1, 0], pose[:, 0, 0]), f.truth.greenwich, ALMANAC)
    same_direction(pose[:, :3, 2], np.broadcast_to([0.0, 0, 1], (len(pose), 3)))


@cache
def map_of(blob: bytes):
    """Corners (n, 3) and where on the picture they are, (n, 2): right and down, 0 to 1."""
    (mesh,) = trimesh.load(io.BytesIO(blob), file_type="glb").geometry.values()
    uv = np.asarray(mesh.visual.uv, float)
    return np.asarray(mesh.vertices, float), np.stack([uv[:, 0], 1 - uv[:, 1]], 1)


def globe(f, entity):
    """A ball of the planet's radius whose map has longitude 0 at x, east towards y, and north up."""
    corners, place = map_of(f.picture.fixed(entity, "Asset3D:blob")[0].tobytes())
    same_place(np.linalg.norm(corners, axis=1), np.ones(len(corners)))
    longitude, latitude = geographic(corners).T
    same_place(place[:, 1], 0.5 - latitude / np.pi, size=100)
    away = np.abs(np.abs(latitude) - np.pi / 2) > 1e-3  # on a pole any longitude will do
    same_angle((2 * np.pi * (place[:, 0] - 0.5))[away], longitude[away])


def air(f, entity):
    """Shells a little above the ground, lit from behind: only the far side of each is drawn."""
    pose = f.picture.pose(entity.rsplit("/air/", 1)[0], 0)
    points = f.picture.place(entity, "Mesh3D:vertex_positions", 0) - pose[:3, 3]
    radius = np.linalg.norm(points, axis=1) / np.linalg.norm(pose[:3, 0])
    assert radius.max() - radius.min() < 1e-5
    assert 1.0 < radius.min() < 1.1
    assert f.picture.fixed(entity, "Mesh3D:face_rendering")[0] == 3
    assert hue(f.picture.color(entity, "Mesh3D:albedo_factor")[0]) == "blue"


def night_turn(f, entity):
    """A frame whose z points away from the Sun."""
    same_direction(poses(f, entity)[:, :3, 2], -f.truth.sun, ALMANAC)


def zones(f) -> list[str]:
    return [name for name in f.picture.entities if re.fullmatch(r"/world/night/zone\d+", name)]


def night_zone(f, entity):
    """A dark zone on the far side from the Sun, darker the farther it is in; together they leave no gap, cover the
    point opposite the Sun and end within 10 degrees of the line between day and night."""
    for row in some(f, 5):
        points = f.picture.place(entity, "Mesh3D:vertex_positions", row)
        same_place(np.linalg.norm(points, axis=1), np.full(len(points), 1.0), size=1e4)  # 0.2 % above the ground
        angle = np.degrees(np.arccos(np.clip(-unit(points) @ f.truth.sun[row], -1, 1)))
        assert angle.max() < DUSK_TO + 0.1, f"night {180 - angle.max():.0f} deg from the Sun"
    color = f.picture.color(entity, "Mesh3D:albedo_factor")[0]
    assert color[:3].max() < 40
    bounds = sorted(zone_bounds(f, name) for name in zones(f))
    assert bounds[0][0] < 0.1
    assert bounds[0][1] > NIGHT_FROM - 5
    assert bounds[-1][1] > 90
    for (_, outer, alpha), (inner, _, weaker) in pairwise(bounds):
        assert abs(outer - inner) < 0.1
        assert alpha > weaker or alpha == weaker == DARKEST


def zone_bounds(f, name):
    """Angles from the point opposite the Sun, deg, between which a zone lies, and its opacity."""
    points = f.picture.place(name, "Mesh3D:vertex_positions", 0)
    angle = np.degrees(np.arccos(np.clip(-unit(points) @ f.truth.sun[0], -1, 1)))
    return angle.min(), angle.max(), f.picture.color(name, "Mesh3D:albedo_factor")[0, 3]


SUN = 695_700e3  # m


def shadow(f, entity, inside: bool):
    """Points of a cone on the side away from the Sun: at each depth as wide as the shadow of a ball before a larger one
    is, by similar triangles from the tip of the cone; it reaches past the flight, or to the tip."""
    radius = f.truth.radius
    for row in some(f, 4):
        sun, distance = f.truth.sun[row], f.truth.sun_distance[row]
        points = f.picture.place(entity, "Mesh3D:vertex_positions", row) * f.truth.length
        depth = -points @ sun
        off = np.linalg.norm(points + depth[:, None] * sun, axis=1)
        tip = radius * distance / (SUN - radius if inside else SUN + radius)  # behind the ball, or before it
        half = np.arcsin(radius / tip)
        wide = np.tan(half) * (tip - depth if inside else tip + depth)
        season = 0.035 * np.abs(wide - radius)  # it has one shape all year, in which the Sun's distance varies
        assert np.all(np.abs(off - wide) < 1e-4 * radius + season), f"{np.abs(off - wide).max() / radius:.3g} radii off"
        assert depth.min() > -0.01 * radius
        far = max(2.59 * radius, 1.1 * f.truth.reach * f.truth.length)
        assert depth.max() > (min(far, 0.98 * tip) if inside else far)


def umbra(f, entity):
    """Where all of the Sun is hidden: narrower and narrower."""
    shadow(f, entity, True)


def penumbra(f, entity):
    """Where some of the Sun is hidden: wider and wider."""
    shadow(f, entity, False)


def terminator(f, entity):
    """On the ground, where the Sun is on the horizon."""
    for row in some(f, 5):
        (line,) = f.picture.line(entity, row)
        same_place(np.linalg.norm(line, axis=1), np.ones(len(line)), size=1e4)
        height = np.degrees(np.arcsin(unit(line) @ f.truth.sun[row]))
        assert np.abs(height).max() < ALMANAC
        assert np.ptp(line @ np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1]]), axis=0).max() > 1.4  # all round


def halo(f, entity):
    """Shells above the ground, the densest lowest, lit from behind."""
    pose = f.picture.pose(entity, 0)
    points = f.picture.fixed(entity, "Mesh3D:vertex_positions") @ pose[:3, :3].T
    sizes = f.picture.fixed(entity, "InstancePoses3D:scales")
    assert np.all(sizes == sizes[:, :1])
    radius = np.linalg.norm(points, axis=1)
    assert np.ptp(radius) < 1e-5
    assert len(sizes) > 6
    for size in sizes[:, 0]:
        assert 1.0 < size * radius[0] < 1.06
    heights = np.sort(sizes[:, 0])
    assert np.all(np.diff(heights, 2) > -1e-6)  # closer together the lower they are
    assert f.picture.fixed(entity, "Mesh3D:face_rendering")[0] == 3
    assert hue(f.picture.color(entity, "Mesh3D:albedo_factor")[0]) == "blue"


def central_name(f, entity):
    """The planet's own name, under it."""
    for _, place in shown(f, entity):
        same_place(place, [0.0, 0.0, -1.0])
    assert f.picture.fixed(entity, "Points3D:labels") == [f.truth.body]


def sunlight(f, entity):
    """On the side of the Sun, from the Sun, yellow."""
    for row in some(f, 5):
        (origin,), (vector,) = f.picture.arrow(entity, row)
        same_direction(origin, f.truth.sun[row], ALMANAC)
        same_direction(vector, -f.truth.sun[row], ALMANAC)
        assert np.linalg.norm(origin) > np.linalg.norm(vector) + 1
    assert hue(f.picture.color(entity, "Arrows3D:colors")[0]) == "yellow"


def sunlight_name(f, entity):
    """Says sunlight, on the side of the Sun."""
    for row in some(f, 5):
        same_direction(f.picture.place(entity, "Points3D:positions", row)[0], f.truth.sun[row], ALMANAC)
    assert f.picture.fixed(entity, "Points3D:labels") == ["sunlight"]


def sunlight_word(f, entity):
    """Says sunlight, on the side of the Sun, while no other name is there."""
    for row, place in shown(f, entity):
        same_direction(place, f.truth.sun[row], ALMANAC)
    assert f.picture.fixed(entity, "Points3D:labels") == ["sunlight"]


def plane_turn(f, entity):
    """z is the orbit's normal, x lies in the orbit on the side of the Sun."""
    pose = poses(f, entity)
    normal = unit(np.cross(f.truth.position, f.truth.velocity))
    same_direction(pose[:, :3, 2], normal)
    towards = unit(f.truth.sun - np.sum(f.truth.sun * normal, 1, keepdims=True) * normal)
    slant = np.linalg.norm(np.cross(f.truth.sun, normal), axis=1).min()
    same_direction(pose[:, :3, 0], towards, ALMANAC / slant)


def plane_orbit(f, entity):
    """The orbit of the moment, in its plane."""
    osculating(f, entity)
    ramped(f, entity)


def plane_ladder(f, entity):
    """Earlier and later orbits, turned into the plane of the moment."""
    ladder(f, entity)
    ramped(f, entity)


def altitude_now(f, entity):
    """The altitude of the semi-major axis, km, written at the orbit of the moment."""
    altitude = f.truth.elements["semi_major_axis_m"] - f.truth.radius
    for row, (spot, text) in enumerate(zip(spots(f, entity), texts(f, entity), strict=True)):
        same_place(np.linalg.norm(spot[0]), f.truth.radius + altitude[row], f.truth.length)
        called = f"{f.called} " if len(f.all) > 1 else ""
        assert text == f"{called}{altitude[row] / 1e3:.0f} km"


def rungs(f, entity):
    """Age and altitude of every other ring, written on it."""
    steps, labels = f.picture.rows(entity, "Points3D:labels")
    _, places = f.picture.rows(entity, "Points3D:positions")
    a, time = f.truth.elements["semi_major_axis_m"], f.truth.time - f.truth.time[0]
    day, name = (86_400.0, "d") if f.truth.duration > 3 * 86_400 else (3600.0, "h")
    assert len(steps) > 3
    for step, label, place in zip(steps, labels, places, strict=True):
        same_place(np.linalg.norm(place[0]), a[step], f.truth.length)
        age, altitude = re.fullmatch(rf"(\d+) {name}: (\d+) km", label[0]).groups()
        assert abs(float(age) - time[step] / day) <= 0.5 + 1e-6
        assert abs(float(altitude) - (a[step] - f.truth.radius) / 1e3) <= 0.5 + 1e-6
    _, colors = f.picture.rows(entity, "Points3D:colors")
    packed = np.array([color[0] for color in colors], np.uint32)
    drawn = np.stack([(packed >> shift) & 255 for shift in (24, 16, 8)], -1)
    assert np.abs(drawn - ramp(f, steps)).max() < 1.5


RAMP = np.array([[34, 26, 84], [104, 58, 190], [196, 112, 240], [255, 190, 250]], float)  # faint to dense


def shell(f, entity):
    """A map of the plasma in the plane of the first orbit: where the craft was in its first revolution its colour is
    the density of /environment, on the logarithmic scale that the description tells."""
    points = f.picture.place(entity, "Mesh3D:vertex_positions", 0) * f.truth.length
    low, high = density_range(f)
    decades = min(3.0, np.log10(high / low))
    colors = f.picture.color(entity, "Mesh3D:vertex_colors")[:, :3].astype(float)
    share = np.interp(colors[:, 1], RAMP[:, 1], [0, 1 / 3, 2 / 3, 1])
    rows = np.flatnonzero(f.truth.at_home & (f.truth.time < f.truth.time[0] + 0.9 * f.truth.period))
    assert len(rows) > 5
    for row in rows:
        place = f.truth.position[row]
        near = np.argsort(np.linalg.norm(points - place, axis=1))[:4]
        expected = np.log10(f.truth.environment["plasma_density_per_m3"][row] / high) / decades + 1
        assert np.abs(points[near] - place).max() < 0.1 * f.truth.radius
        spread = np.ptp(share[near]) + 0.05  # a cell is 3 deg and 25 km wide; the table's ends have one digit
        assert abs(share[near].mean() - np.clip(expected, 0, 1)) < spread


def density_range(f) -> tuple[float, float]:
    """Least and largest density as the description tells them."""
    text = f.picture.fixed("/about", "TextDocument:text")[0]
    low, high = re.search(r"\*\*violet\*\* band is the plasma density: (\S+) to (\S+) 1/m³", text).groups()
    return float(low), float(high)


def magnetopause(f, entity):
    """Where Shue's surface is for 2 nPa and no field across: 10.251873 Earth radii (6371.2 km) towards the Sun,
    15.427840 beside, 23.217051 at 120 deg, open behind."""
    for row in some(f, 4):
        points = np.concatenate(f.picture.line(entity, row)) * f.truth.length / 6_371.2e3
        distance = np.linalg.norm(points, axis=1)
        cosine = points @ f.truth.sun[row] / distance
        same_place(distance, 10.251873 * (2 / (1 + cosine)) ** (0.58 * (1 + 0.024 * np.log(2.0))), size=10.0)
        for at, wanted in ((0.0, 15.427840), (-0.5, 23.217051)):
            near = np.abs(cosine - at) < 0.06
            assert near.any()
            slope = np.abs(np.log(distance[near] / wanted))
            assert slope.max() < 0.1
        assert distance.min() < 10.2519


def magnetopause_name(f, entity):
    """Its word a little before its nose."""
    assert f.picture.fixed(entity, "Points3D:labels") == ["magnetopause"]
    for row, place in shown(f, entity):
        same_direction(place, f.truth.sun[row])
        assert 1.0 < np.linalg.norm(place) * f.truth.length / 6_371.2e3 / 10.251873 < 1.1
