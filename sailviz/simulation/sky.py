"""What a scene's sky is to the right-hand side: bodies and light with their places, and the callbacks that use them.

Scenes whose light is at the centre and where nothing else pulls have none of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sailviz import frames
from sailviz.constants import AU, MU_SUN
from sailviz.environment import magnetosphere, sky
from sailviz.environment.eclipse import CONE, CYLINDER, NO_SHADOW
from sailviz.errors import Fault, SceneError
from sailviz.propagate.parameters import Pushed
from sailviz.propagate.sky_callback import sky_drag, sky_gravity, sky_steering, sky_thrust
from sailviz.propagate.sky_edges import sky_edges
from sailviz.propulsion.devices import CALLED, ELECTRIC_SAIL, NO_DEVICE, SOLAR_SAIL
from sailviz.scene.attitude import Moving
from sailviz.scene.body import CustomBody
from sailviz.scene.device import SolarSail, air_on_facets
from sailviz.scene.environment import MagneticSphere
from sailviz.scene.named_files import folder_of
from sailviz.scene.sky import (
    EVEN_PERIOD,
    SERIES,
    even_longitude,
    even_obliquity,
    frame_of,
    has_sky,
    kernel_bodies,
    light_away,
    light_kind,
    magnetosphere_of,
    shades,
    shadow_kind,
)
from sailviz.scene.steering import LocalSteering
from sailviz.sky import BODIES, Sky, table
from sailviz.steering import attitude, by_light

if TYPE_CHECKING:
    from sailviz.run.arrays import Body
    from sailviz.scene.loading import Scene
    from sailviz.simulation.lowered import Array, LoweredDevice, LoweredSteering

MARGIN = 100e3  # m over the lowest perigee, in which the law gives way
NORTH = frames.icrf_to("ecliptic-j2000")[2]  # of the ecliptic, ICRF
KINDS = {"centre": sky.CENTRE, "ephemeris": sky.TABLED, "circular": sky.EVEN, "fixed": sky.FIXED}


class Seen(NamedTuple):
    """A body of the sky that is recorded and drawn."""

    word: str  # of sailviz.sky.BODIES
    name: str


@dataclass(frozen=True)
class SceneSky:
    """The sky of a scene."""

    scene: Scene
    body: Body
    epoch: np.datetime64 | None

    @cached_property
    def places(self) -> Sky | None:
        """Where bodies stand; None without an epoch."""
        if self.epoch is None:
            return None
        name = self.scene.ephemeris
        source = name if name in (SERIES, "de421") else str(folder_of(self.scene) / name)
        return Sky(self.epoch, frame_of(self.scene), source)

    @cached_property
    def centre(self) -> str:
        """The central body's word."""
        return self.scene.body if isinstance(self.scene.body, str) else ""

    @cached_property
    def words(self) -> list[str]:
        """Of the bodies that have tables, in their order there."""
        return kernel_bodies(self.scene)

    @cached_property
    def table(self) -> Array:
        """Places of all bodies, `environment.sky.packed`. SceneError where the source does not reach."""
        around, duration = self.scene.environment, self.scene.propagation.duration
        pulling, shading = set(around.gravity_of_bodies), set(shades(self.scene))
        rows = []
        for word in self.words:
            body = BODIES[word]
            mu, radius = body.mu * (word in pulling), body.radius * (word in shading)
            assert self.places is not None  # or the scene would not have been accepted
            try:
                rows.append((mu, radius, table(self.places, word, self.centre, duration)))
            except (ValueError, ModuleNotFoundError) as error:
                raise SceneError([Fault("ephemeris", f"{error}.")], self.scene.source) from None
        found: Array = sky.packed(rows)
        return found

    @cached_property
    def north(self) -> Array:
        """North pole of the ecliptic, or of the circle of an even light, in the scene's frame (3,)."""
        if light_kind(self.scene) == "circular" or self.epoch is None:
            tilt = even_obliquity(self.scene)
            return np.array([0.0, -np.sin(tilt), np.cos(tilt)])
        assert self.places is not None
        found: Array = self.places.axes @ NORTH
        return found

    @property
    def parameters(self) -> sky.Parameters:
        """Bodies and light."""
        kind = light_kind(self.scene)
        found = sky.Parameters(bodies=len(self.words), light=KINDS[kind])
        if "moon" in self.words:
            found = found._replace(moon=self.words.index("moon"))
        said = self.scene.light
        if said is not None and said.radius is not None:
            found = found._replace(light_radius=said.radius)
        elif kind == "centre":
            found = found._replace(light_radius=self.body.radius)
        if kind == "ephemeris":
            found = found._replace(light_body=self.words.index("sun") if "sun" in self.words else 0)
        elif kind == "circular":
            found = self._even(found)
        elif kind == "fixed":
            found = self._fixed(found)
        shading = shades(self.scene)
        if shading:
            central = self.body.radius if self.centre in shading else 0.0
            shadow = CONE if shadow_kind(self.scene) == "cone" else CYLINDER
            found = found._replace(shadow=shadow, centre_radius=central)
        return found

    def _even(self, found: sky.Parameters) -> sky.Parameters:
        """With a light that goes evenly round on a circle: by Kepler's period where its distance is said, else once a
        year."""
        said = self.scene.light
        far = None if said is None else said.distance
        distance, period = AU if far is None else far, None if said is None else said.period
        if period is None:
            mu = MU_SUN if said is None or said.mu is None else said.mu
            period = EVEN_PERIOD if far is None else 2 * np.pi * np.sqrt(distance**3 / mu)
        tilt = even_obliquity(self.scene)
        return found._replace(
            distance=distance,
            longitude=even_longitude(self.scene),
            rate=2 * np.pi / period,
            ahead_y=float(np.cos(tilt)),
            ahead_z=float(np.sin(tilt)),
        )

    def _fixed(self, found: sky.Parameters) -> sky.Parameters:
        """With a light that stays where it is."""
        said = self.scene.light
        assert said is not None
        assert said.direction is not None
        assert said.distance is not None
        x, y, z = frames.unit(said.direction)
        return found._replace(distance=said.distance, towards_x=x, towards_y=y, towards_z=z)

    @property
    def magnetosphere(self) -> magnetosphere.Parameters:
        """What keeps the wind away."""
        kind = magnetosphere_of(self.scene)
        if kind == "none":
            return magnetosphere.Parameters()
        if kind == "shue-1998":
            return magnetosphere.shue(body=-1 if self.centre == "earth" else self.words.index("earth"))
        given = self.scene.environment.magnetosphere
        assert isinstance(given, MagneticSphere)
        return magnetosphere.Parameters(magnetosphere.SPHERE, -1, given.radius)


def sky_of(scene: Scene, body: Body, epoch: np.datetime64 | None) -> SceneSky | None:
    """The sky of a scene; None where only the central body and its own light matter."""
    return SceneSky(scene, body, epoch) if has_sky(scene) else None


def under_sky(
    found: SceneSky | None, device: LoweredDevice, steered: LoweredSteering
) -> tuple[LoweredDevice, LoweredSteering, dict[str, Any]]:
    """Device and steering as they are under a sky, and the keywords of `dynamics.model` that are the sky's own."""
    if found is None:
        return device, steered, {}
    scene = found.scene
    away, shading = light_away(scene), found.parameters.shadow != NO_SHADOW
    dragged = scene.device.drag_area == "attitude"
    blown = found.magnetosphere.kind != magnetosphere.NONE
    law, steered = _by_light(found, steered, device.kind)
    pushed = Pushed()
    forces = list(device.forces)
    if device.kind in (SOLAR_SAIL, ELECTRIC_SAIL) and (away or shading or blown):
        pushed = pushed._replace(device=device.kind)
        device = device._replace(kind=CALLED, callback=device.callback or sky_thrust())
    if scene.environment.gravity_of is not None:
        forces.append(sky_gravity())
    if dragged:
        assert isinstance(scene.device, SolarSail)
        assert scene.device.area is not None
        k = scene.device.drag_coefficient
        pushed = pushed._replace(drag_area=k * scene.device.area, edge_area=k * (scene.device.edge_area or 0.0))
        forces.append(sky_drag())
    jumps = shading or blown or dragged or law.law == by_light.ON_OFF
    sides = sky.Sides(needed=int(jumps))
    parts = {
        "sky": found.parameters,
        "sides": sides,
        "magnetosphere": found.magnetosphere,
        "by_light": law,
        "pushed": pushed,
    }
    keywords: dict[str, Any] = {"sky": parts, "sky_table": found.table}
    if jumps:
        keywords["edges"] = sky_edges()
    return device._replace(forces=tuple(forces)), steered, keywords


def pushed_by_shape(
    device: LoweredDevice, steered: LoweredSteering, keywords: dict[str, Any]
) -> tuple[LoweredDevice, LoweredSteering, dict[str, Any]]:
    """A sail whose force a callback of its own knows, under a sky or without one; every other device as it is."""
    if device.callback is None or device.kind not in (SOLAR_SAIL, ELECTRIC_SAIL):
        return device, steered, keywords
    parts = dict(keywords.get("sky", {}))
    parts["pushed"] = parts.get("pushed", Pushed())._replace(device=device.kind)
    return device._replace(kind=CALLED), steered, keywords | {"sky": parts}


def blown_by_air(scene: Scene, device: LoweredDevice, keywords: dict[str, Any]) -> tuple[LoweredDevice, dict[str, Any]]:
    """A sail whose shape the air of the scene pushes; every other device as it is."""
    if not air_on_facets(scene.device):
        return device, keywords
    from sailviz.propagate.shape_air_callback import shape_air
    from sailviz.simulation.sail_shape import air_on_shape

    parts = dict(keywords.get("sky", {}))
    if isinstance(scene.attitude, Moving):  # whose sides turn within a step, as no law would tell
        from sailviz.propagate.body_air import body_air

        parts["pushed"] = parts.get("pushed", Pushed())._replace(blown=2)
        forces = (*device.forces, body_air())
        return device._replace(forces=forces), keywords | {"sky": parts, "shape_air": air_on_shape(scene)}
    parts["pushed"] = parts.get("pushed", Pushed())._replace(blown=1)
    parts["sides"] = sky.Sides(needed=1)
    forces = (*device.forces, shape_air())
    more = {"sky": parts, "shape_air": air_on_shape(scene), "edges": sky_edges()}
    return device._replace(forces=forces), keywords | more


def _by_light(found: SceneSky, steered: LoweredSteering, device: int) -> tuple[by_light.Parameters, LoweredSteering]:
    """The law that counts from the light, and the steering that calls it, where there is one."""
    scene, section = found.scene, found.scene.steering
    law = steered.by_light._replace(edge_on=int(getattr(section, "in_shadow", None) == "edge-on"))
    north = found.north
    law = law._replace(pole_x=float(north[0]), pole_y=float(north[1]), pole_z=float(north[2]))
    if isinstance(section, LocalSteering) and section.minimum_perigee is not None:
        law = law._replace(lowest=section.minimum_perigee, margin=section.margin or MARGIN)
    counts = light_away(scene) or law.edge_on or law.lowest
    if law.law != by_light.NO_LAW:
        return law, replace_callback(steered, attitude.CALLED)
    if not counts or device == NO_DEVICE:
        return law, steered
    if steered.kind in (attitude.LOCAL, attitude.LYAPUNOV, attitude.PRIMER):
        return law._replace(law=by_light.PRIMER), replace_callback(steered, steered.kind)
    if steered.kind == attitude.RADIAL and device in (SOLAR_SAIL, ELECTRIC_SAIL):
        return law._replace(law=by_light.FACING), replace_callback(steered, attitude.CALLED)
    return law, steered


def replace_callback(steered: LoweredSteering, kind: int) -> LoweredSteering:
    """The steering as a kind that calls the sky's law."""
    return steered._replace(kind=kind, callback=sky_steering())


def sky_bodies(found: SceneSky | None) -> list[Seen]:
    """The bodies of a sky that are recorded and drawn."""
    if found is None:
        return []
    return [Seen(word, BODIES[word].name) for word in found.words]


def body_places(found: SceneSky, time: Array) -> dict[str, Array]:
    """Name -> positions (n, 3) m of the sky's bodies, and of a light that is none of them, from the central body."""
    seen: dict[str, Array] = {}
    if found.places is not None:
        for word, name in sky_bodies(found):
            seen[name] = found.places.position(word, found.centre, time)
    light = light_place(found, time)
    if light is not None and "Sun" not in seen:
        seen["Sun" if not isinstance(found.scene.body, CustomBody) else "light"] = light
    return seen


def light_place(found: SceneSky, time: Array) -> Array | None:
    """Positions (n, 3) m of a light that is not at the centre and has no table."""
    p = found.parameters
    if p.light in (sky.CENTRE, sky.TABLED):
        return None
    towards = np.array([p.towards_x, p.towards_y, p.towards_z])
    if p.light == sky.FIXED:
        return np.tile(p.distance * towards, (len(time), 1))
    angle = p.longitude + p.rate * np.asarray(time)
    ahead = np.array([p.ahead_x, p.ahead_y, p.ahead_z])
    found_places: Array = p.distance * (np.outer(np.cos(angle), towards) + np.outer(np.sin(angle), ahead))
    return found_places
