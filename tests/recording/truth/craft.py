"""The craft and what hangs on it: pose against /attitude/quaternion, sides against the light, arrows against rows."""

from __future__ import annotations

import numpy as np

from .measure import hue, proportional, same_direction, same_place, same_turn
from .outlines import outline, same_surface
from .seen import arrows, body, home, in_body, lines_in_body, outward, poses, seen, some

FRONT, BACK = 2, 3  # of rerun's face_rendering
GONE = 1e-3  # a scale at which nothing is to be seen


def body_pose(f, entity):
    """A frame at the craft that is turned as /attitude/quaternion says, its z along /attitude/normal."""
    pose = poses(f, entity)
    there = ~f.truth.stowed
    same_direction(pose[there][:, :3, 2], seen(f, entity, f.truth.normal)[there])
    same_turn(pose[:, :3, :3], body(f, entity))
    same_place(pose[:, :3, 3], home(f, entity))


def place_only(f, entity):
    """A frame at the craft that does not turn."""
    pose = poses(f, entity)
    same_place(pose[:, :3, 3], f.truth.place, f.truth.length)
    assert np.array_equal(pose[:, :3, :3], np.broadcast_to(np.eye(3), (len(pose), 3, 3)))


def orbital_pose(f, entity):
    """A frame at the craft with x radial, y transverse, z normal to the orbit."""
    pose = poses(f, entity)
    same_place(pose[:, :3, 3], f.truth.place, f.truth.length)
    same_turn(pose[:, :3, :3], np.swapaxes(f.truth.drawn_frame, 1, 2))


def scale_only(f, entity):
    """A frame that makes its contents larger, alike in all directions, and neither moves them nor, but for what spins,
    turns them."""
    for row in some(f, 3):
        own = f.picture.pose(entity, f.truth.steps[row], entity.rsplit("/", 1)[0] or "/")
        large = np.linalg.norm(own[:3, 0])
        assert large > 0
        same_turn(own[None, :3, :3] / large, f.truth.spin[row : row + 1])
        assert not own[:3, 3].any()


def size(f, entity, row: int = 0) -> float:
    """How large the craft's shape is drawn, view units: its frame's scale."""
    parent = "/".join(entity.split("/")[: 2 + entity.split("/").index("body")])
    return float(np.linalg.norm(f.picture.pose(parent, f.truth.steps[row])[:3, 0]))


def facing(f, entity, row) -> np.ndarray:
    """Sum of a mesh's area vectors in the view, by the order of its corners."""
    points = f.picture.place(entity, "Mesh3D:vertex_positions", row)
    corners = points[f.picture.at(entity, "Mesh3D:triangle_indices", row)]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(0) / 2


def out(f, rows) -> list[int]:
    """Of some rows those in which the sail is not stowed."""
    return [int(row) for row in rows if not f.truth.stowed[row]]


def stowing(f, entity):
    """A part of the sail is there in every row in which it is out, and in none in which it is stowed."""
    parent = entity.rsplit("/", 1)[0]
    shown = np.array([f.picture.pose(entity, step, parent)[0, 0] for step in f.truth.steps])
    assert np.all(shown[~f.truth.stowed] == 1), "a sail that is out is not drawn"
    assert np.all(shown[f.truth.stowed] < GONE), "a stowed sail is drawn"


def film(f, entity):
    """The side of the film that is visible from the Sun is golden, the other one blue; its normal is /attitude/normal;
    it bulges away from the light and has the side of the square that is told."""
    if has_own_shape(f):
        own_part(f, entity)
        return
    normal = seen(f, entity, f.truth.normal)
    side = {FRONT: 1.0, BACK: -1.0}[int(f.picture.fixed(entity, "Mesh3D:face_rendering")[0])]
    word = hue(f.picture.color(entity, "Mesh3D:albedo_factor")[0])
    stowing(f, entity)
    for row in out(f, some(f)):
        drawn = facing(f, entity, row)
        same_direction(drawn, normal[row], 0.05)  # a smooth mesh of a few hundred triangles
        light = normal[row] if f.truth.round_planet else outward(f, entity)[row]  # there the film's own word counts
        sunward = side * drawn @ -light
        assert word == ("yellow" if sunward > 0 else "blue"), f"the side towards the Sun is {word}"
        points = in_body(f, entity, "Mesh3D:vertex_positions", row)
        same_place(np.abs(points[:, :2]).max(), size(f, entity) * np.sqrt(0.5), size=100 * size(f, entity))
        assert points[:, 2].min() > -1e-4 * size(f, entity), "the film is drawn below its corners"
        assert points[:, 2].max() > 0.03 * size(f, entity)


def has_own_shape(f) -> bool:
    """Whether a craft is drawn as its scene, or its arrays, say its shape."""
    return "mesh" in f.truth.resolved or outline(f) is not None


def own_part(f, entity):
    """Of a shape that a scene tells the film lies on its surface, and the bus on its box, out to their edges; of a mesh
    that came with arrays all parts together fill the box that is told. In m over the longest side, in the attitude of
    the row; the lit side of a film looks along -z of the body."""
    own, side = outline(f), float(f.truth.scene["craft_side_m"])
    top = entity.rsplit("/", 1)[0]
    if own is None:
        told = f.truth.resolved["mesh"]
        drawn = [each for each in (f"{top}/film_lit", f"{top}/bus") if each in f.picture.entities]
        low, high = np.array(told["low_m"]), np.array(told["high_m"])
    assert abs(side - (own.length if own else (high - low).max())) < 1e-9 * side
    for row in some(f, 4):
        if own is not None:
            same_surface(own, parts(f, entity, row) * side / size(f, entity), film="/film_" in entity)
            continue
        points = np.concatenate([parts(f, each, row) for each in drawn]) * side / size(f, entity)
        same_place(points.min(0), low, size=10 * side)
        same_place(points.max(0), high, size=10 * side)
    if "/film_" in entity:
        visible = {FRONT: 1.0, BACK: -1.0}[int(f.picture.fixed(entity, "Mesh3D:face_rendering")[0])]
        seen_from = visible * facing(f, entity, 0) @ body(f, entity)[0][:, 2]
        word = hue(f.picture.color(entity, "Mesh3D:albedo_factor")[0])
        assert word == ("yellow" if seen_from < 0 else "blue"), f"the side towards the Sun is {word}"


def flat(f, entity, thickness=0.03, reach=(0.0, 1.1)):
    """A part that lies in the plane across the normal; reach : bounds of its farthest point, in sizes."""
    if not entity.endswith("/hub"):
        stowing(f, entity)
    for row in out(f, some(f, 4)):
        points = parts(f, entity, row) / size(f, entity)
        assert np.abs(points[:, 2]).max() < thickness
        assert reach[0] < np.linalg.norm(points[:, :2], axis=1).max() < reach[1]


def parts(f, entity, row) -> np.ndarray:
    """Points of whatever a part of the craft is made of, body frame."""
    if "LineStrips3D:strips" in f.picture.components(entity):
        return np.concatenate(lines_in_body(f, entity, row))
    if "GaussianSplats3D:centers" in f.picture.components(entity):
        return in_body(f, entity, "GaussianSplats3D:centers", row)
    if "InstancePoses3D:translations" in f.picture.components(entity):
        return in_body(f, entity, "InstancePoses3D:translations", row)
    if "Points3D:positions" in f.picture.components(entity):
        return in_body(f, entity, "Points3D:positions", row)
    return in_body(f, entity, "Mesh3D:vertex_positions", row)


def booms(f, entity):
    """Booms end at the corners of the film."""
    flat(f, entity, 0.02, (0.69, 0.74))


def vanes(f, entity):
    """Vanes stand beyond the corners of the film."""
    flat(f, entity, 0.02, (0.72, 0.80))
    assert np.linalg.norm(parts(f, entity, 0), axis=1).min() > 0.69 * size(f, entity)


def seams(f, entity):
    """Seams lie on the film."""
    flat(f, entity, 0.08, (0.6, 0.75))


def wheel_of(f) -> dict:
    """What a scene tells of a wheel that is a body."""
    device = f.truth.resolved.get("device")
    return (device.get("wheel") if isinstance(device, dict) else None) or {}


def downwind(f, reach) -> np.ndarray:
    """How far downwind of its hub a wheel is, like reach, both over the length of a tether: not at all, by its cone
    angle, or as a parabola."""
    wheel = wheel_of(f)
    if not wheel.get("rise"):
        return np.tan(wheel.get("cone", 0.0)) * reach
    x = np.linspace(0, 1, 20001)
    length = np.trapezoid(np.hypot(1, 2 * wheel["rise"] * x), x)
    return wheel["rise"] * length * np.asarray(reach) ** 2


def rim_of(f) -> tuple[float, float]:
    """Radius of the rim and how far downwind it is, over the length of a tether."""
    wheel = wheel_of(f)
    if not wheel.get("rise"):
        return float(np.cos(wheel.get("cone", 0.0))), float(np.sin(wheel.get("cone", 0.0)))
    x = np.linspace(0, 1, 20001)
    reach = 1 / np.trapezoid(np.hypot(1, 2 * wheel["rise"] * x), x)
    return reach, wheel["rise"] * reach


def on_wheel(f, points) -> None:
    """Points (n, 3), over the length of a tether, that lie on the surface which the tethers sweep out."""
    reach = np.linalg.norm(points[:, :2], axis=1)
    same_place(points[:, 2], downwind(f, reach), size=10)


def tethers(f, entity):
    """Tethers of an electric sail reach from the hub to its rim, evenly all round, across the normal, or bent downwind
    by the angle that the scene tells."""
    stowing(f, entity)
    radius, depth = rim_of(f)
    for row in out(f, some(f, 4)):
        lines = np.array(lines_in_body(f, entity, row)) / size(f, entity)
        on_wheel(f, lines[:, [0, -1]].reshape(-1, 3))
        same_place(np.linalg.norm(lines[:, -1, :2], axis=1), np.full(len(lines), radius), size=10)
        same_place(lines[:, -1, 2], np.full(len(lines), depth), size=10)
        angle = np.sort(np.arctan2(lines[:, -1, 1], lines[:, -1, 0]))
        assert np.allclose(np.diff(angle), 2 * np.pi / len(lines), atol=1e-4)


def rim(f, entity):
    """A circle across the normal, through the ends of the tethers."""
    stowing(f, entity)
    radius, depth = rim_of(f)
    for row in out(f, some(f, 4)):
        (line,) = lines_in_body(f, entity, row)
        line = line / size(f, entity)
        same_place(line[:, 2], np.full(len(line), depth), size=10)
        same_place(np.linalg.norm(line[:, :2], axis=1), np.full(len(line), radius), size=10)


def at_tips(f, entity):
    """A box at the end of each tether."""
    stowing(f, entity)
    for row in out(f, some(f, 4)):
        points = parts(f, entity, row) / size(f, entity)
        on_wheel(f, points)
        same_place(np.linalg.norm(points[:, :2], axis=1), np.full(len(points), rim_of(f)[0]), size=10)


def hub(f, entity):
    """In the middle, small."""
    flat(f, entity, 0.05, (0.0, 0.1))


def shade_bus(f, entity):
    """The bus is on the dark side of the film, in its middle."""
    for row in some(f, 4):
        points = parts(f, entity, row) / size(f, entity)
        assert points[:, 2].mean() > 0.02
        assert np.abs(points[:, :2]).max() < 0.1


def middle(f, entity):
    """A body about the craft's place."""
    for row in some(f, 4):
        points = parts(f, entity, row) / size(f, entity)
        assert np.linalg.norm(points.mean(0)) < 0.02
        assert np.linalg.norm(points, axis=1).max() < 1.0


def panels(f, entity):
    """Panels to both sides of the satellite, across the direction of flight and the vertical, or of a thruster."""
    middle(f, entity)
    points = parts(f, entity, 0)
    spread = np.ptp(points, axis=0)
    assert np.argmax(spread) == (1 if f.truth.kind in ("plasma-brake", "none") else 0)


def nozzle(f, entity):
    """The nozzle points against the thrust."""
    for row in some(f, 4):
        points = parts(f, entity, row) / size(f, entity)
        assert -0.4 < points[:, 2].min() < points[:, 2].max() < -0.2
        assert np.abs(points[:, :2]).max() < 0.2


def tether(f, entity):
    """A tether hangs from the satellite along minus the normal of /attitude, as long as its frame."""
    for row in range(len(f.truth)):
        (line,) = lines_in_body(f, entity, row)
        line = line / size(f, entity, row)
        same_place(line[:, :2], 0 * line[:, :2], size=10)
        assert line[0, 2] > -0.1
        same_place(line[-1, 2], np.array(-1.0), size=10)


def tether_end(f, entity):
    """Its tip is at its lower end."""
    for row in some(f):
        same_place(parts(f, entity, row)[0] / size(f, entity, row), np.array([0.0, 0.0, -1.0]), size=10)


def shown_while_on(f, entity):
    """What glows is drawn while /thrust says on, and not at other times."""
    parent = entity.rsplit("/", 1)[0]
    shown = np.array([f.picture.pose(entity, row, parent)[0, 0] > GONE for row in range(len(f.truth))])
    assert np.array_equal(shown, f.truth.on)


def sheath(f, entity):
    """The charged sheath lies along the tethers."""
    shown_while_on(f, entity)
    for row in np.flatnonzero(f.truth.on)[:3]:
        points = parts(f, entity, row) / size(f, entity)
        if f.truth.kind == "plasma-brake":
            same_place(points[:, :2], 0 * points[:, :2], size=10)
            assert -1 < points[:, 2].min() < points[:, 2].max() < 0
        else:
            chord = np.linalg.norm(points[:, :2], axis=1) * np.divide(*rim_of(f)[::-1])
            same_place(points[:, 2], chord, size=10)
            assert np.all(np.linalg.norm(points, axis=1) < 1)


def plume(f, entity):
    """The plume leaves against the thrust."""
    shown_while_on(f, entity)
    thrust = seen(f, entity, f.truth.thrust)
    for row in np.flatnonzero(f.truth.on)[:5]:
        centers = f.picture.place(entity, "GaussianSplats3D:centers", row) - home(f, entity)[row]
        same_direction(centers, np.broadcast_to(-thrust[row], centers.shape), 0.01)


def dot(f, entity):
    """A dot in the craft's place."""
    for row in some(f):
        same_place(f.picture.place(entity, "Points3D:positions", row)[0], home(f, entity)[row])


def still(f) -> np.ndarray:
    """Rows in which the craft hardly moves: slower than a 300th of the circular speed."""
    circular = np.sqrt(f.truth.mu / np.linalg.norm(f.truth.position, axis=1))
    return np.linalg.norm(f.truth.velocity, axis=1) < 3e-3 * circular


def velocity_arrow(f, entity):
    """From the craft along its velocity, always of the same length; none where it stands still."""
    origin, vector = arrows(f, entity)
    same_place(origin, home(f, entity))
    true = seen(f, entity, f.truth.velocity)
    true = np.where(still(f)[:, None], 0.0, true / np.linalg.norm(true, axis=1, keepdims=True))
    proportional(vector, true)


def primer_arrow(f, entity):
    """From the craft along the primer vector; of runs without one, nothing."""
    primer = f.truth.environment.get("primer_direction")
    if primer is None:
        assert not f.picture.moves(entity, "Arrows3D:vectors")
        return
    origin, vector = arrows(f, entity)
    same_place(origin, home(f, entity))
    proportional(vector, seen(f, entity, primer))


def disc(f, entity):
    """A faint disc as wide as the rim, across the normal or bent as the tethers are."""
    stowing(f, entity)
    for row in out(f, some(f, 4)):
        points = parts(f, entity, row) / size(f, entity)
        on_wheel(f, points)
        assert abs(np.linalg.norm(points[:, :2], axis=1).max() - rim_of(f)[0]) < 0.01
    assert f.picture.color(entity, "Mesh3D:albedo_factor")[0][3] < 20


def ballistic_name(f, entity):
    """The craft's kind where nothing pushes it."""
    assert f.picture.fixed(entity, "Points3D:labels")[0] in ("Spacecraft", "Solar sail", "E-sail", "Thruster")
    assert not np.any(f.truth.thrust)
