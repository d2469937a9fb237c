"""What a picture of a run needs to know beside its rows: words, the craft, orbits drawn from the start, planets."""

from __future__ import annotations

import platform
from functools import cache
from importlib.metadata import version
from typing import Any

import numpy as np

import sailviz
from sailviz import elements as orbital
from sailviz import ephemeris, frames
from sailviz.environment import ionosphere
from sailviz.environment.magnetosphere import NONE, SHUE
from sailviz.environment.magnetosphere import Parameters as Magnetosphere
from sailviz.propagate import stepping
from sailviz.propagate.patience import Patience
from sailviz.run.arrays import Reference, Setting, Shell
from sailviz.scene.sky import SERIES, frame_of, is_sail, light_away
from sailviz.scene.start import DesignedStart
from sailviz.simulation.accuracy import accuracy_in_words
from sailviz.simulation.bodies import epoch_of
from sailviz.simulation.device import craft
from sailviz.simulation.environment import ENVIRONMENT, drawn_bodies
from sailviz.simulation.integration import INTEGRATORS, begun
from sailviz.simulation.parameters_in_words import parameters_in_words
from sailviz.simulation.plan import Plan
from sailviz.simulation.sky import SceneSky, body_places
from sailviz.simulation.start import departure
from sailviz.simulation.steering import steering_of
from sailviz.simulation.targets import moving_target

MOST_STEPS_AHEAD = 300_000  # of the coarse run that tells which planets come into view
SHELL_ANGLES, SHELL_STEP = 120, 25e3  # round the orbit; m between altitudes


def setting_of(p: Plan, planets, rows, ensembles=(), measure=True) -> Setting:
    """measure : whether to find out how accurate the run is."""
    scene = p.scene
    duration = scene.propagation.duration
    return Setting(
        title=scene.title,
        family=family_of(scene),
        about=scene.about,
        look_for=tuple(scene.look_for),
        thesis=scene.thesis,
        body=p.body,
        craft=craft(scene),
        duration=duration,
        rows=rows,
        epoch=epoch_of(scene),
        references=_references(p, planets),
        parameters=tuple(parameters_in_words(scene, p.design)),
        text=scene.text,
        resolved=scene.resolved(),
        versions={
            "sailviz": sailviz.__version__,
            "python": platform.python_version(),
            "numpy": np.__version__,
            "numba": _numba_version(),
        },
        accuracy=accuracy_in_words(p, measure),
        identity=p.identity,
        play_duration=scene.recording.play_duration,
        plots=tuple(scene.recording.plots),
        magnetopause=None if p.sky is None else magnetopause(p.model.named.magnetosphere),
        shells=_shells(p),
        ensembles=ensembles,
        phases=p.phases,
    )


@cache
def _numba_version() -> str:
    return version("numba")  # read from a file: of a sweep's flight it would be a tenth


def magnetopause(p: Magnetosphere) -> np.ndarray | None:
    """(k, 2) angle from the Sun's direction, rad, and distance, m, of the surface round the central body that keeps the
    wind away; None where there is none."""
    if p.kind == NONE or p.body >= 0:
        return None
    angle = np.radians(np.linspace(0.0, 130.0 if p.kind == SHUE else 180.0, 40))
    flare = (2.0 / (1.0 + np.cos(angle))) ** p.flare if p.kind == SHUE else np.ones(len(angle))
    return np.stack([angle, p.radius * flare], 1)


def family_of(scene) -> str:
    """The family in whose way a scene is drawn: its own word, or what its sections suggest."""
    if scene.family:
        return str(scene.family)
    if is_sail(scene) and light_away(scene):
        return "planets"
    if scene.body == "earth":
        return "deorbit"
    if scene.environment.solar_wind.kind != "steady" or scene.ensemble or scene.chaos:
        return "wind"
    return "displaced" if isinstance(scene.start, DesignedStart) else "spirals"


def _references(p: Plan, planets) -> tuple[Reference, ...]:
    """Curves that are there from the start: the orbit designed, the orbit departed from, the planets' orbits."""
    found = []
    start, begins = p.scene.start, departure(p.scene)
    turn = np.linspace(0, 2 * np.pi, 361)
    designed = begins.designed_curve(start, p.design)
    if designed is not None:
        found.append(Reference("designed orbit", "target", designed))
    aim = _target(p)
    if begins.initial_orbit or (aim is not None and begins.towards):
        e = orbital.elements(p.position, p.velocity, p.body.mu)
        if e.eccentricity < 1:
            found.append(Reference("initial orbit", "initial", _ellipse(e, turn, p.body.mu)))
    if aim is not None:
        found.append(Reference(aim[0], "target", _ellipse(aim[1], turn, p.body.mu)))
    time = np.linspace(0.0, p.scene.propagation.duration, 2000)
    found += [Reference(name, "approximation", way.positions(time)) for name, way in p.approximations.items()]
    found += [Reference(name, "planet", orbit) for name, orbit in planets.items()]
    return tuple(found)


def _ellipse(orbit: orbital.Elements, turn, mu):
    """Points (n, 3) m of an orbit at true anomalies (n,) rad."""
    e = orbit
    return orbital.state(e.semi_major_axis, e.eccentricity, e.inclination, e.raan, e.argument, turn, mu)[0]


def _target(p: Plan) -> tuple[str, orbital.Elements] | None:
    """Name and elements of the orbit that a scene wants to reach, or that its law steers towards."""
    wanted = p.scene.target
    if wanted is None:
        aim = steering_of(p.scene.steering).target(p.scene.steering)
        return None if aim is None else ("target orbit", aim)
    if wanted.planet is not None:
        name = wanted.planet.capitalize()
        return wanted.name or f"orbit of {name}", _in_frame(p, ephemeris.planet_ellipse(name, epoch_of(p.scene)))
    size = wanted.radius or wanted.semi_major_axis
    scalars: list[Any] = [size, wanted.eccentricity, wanted.inclination, wanted.raan, wanted.argument, 0.0]
    return wanted.name or "target orbit", orbital.Elements(*scalars)


def _turn(p: Plan) -> np.ndarray:
    """Rotation (3, 3) from the ecliptic of J2000, in which orbits of planets are known, to the frame of a heliocentric
    scene."""
    return frames.icrf_to(frame_of(p.scene)) @ frames.icrf_to("ecliptic-j2000").T


def _in_frame(p: Plan, orbit: orbital.Elements) -> orbital.Elements:
    """An orbit about the Sun in the scene's frame, its true anomaly left 0."""
    if frame_of(p.scene) == "ecliptic-j2000":
        return orbit
    e = orbit
    r, v = orbital.state(e.semi_major_axis, e.eccentricity, e.inclination, e.raan, e.argument, 0.0, p.body.mu)
    e = orbital.elements(_turn(p) @ r, _turn(p) @ v, p.body.mu)
    scalars: list[Any] = [float(x) for x in (e.semi_major_axis, e.eccentricity, e.inclination, e.raan, e.argument)]
    return orbital.Elements(*[*scalars, 0.0])


def _shells(p: Plan) -> tuple[Shell, ...]:
    """The plasma that a tether meets, in the plane of its first orbit."""
    plasma, earth = p.scene.environment.ionosphere, p.body.radius
    record = None if plasma is None else ENVIRONMENT[type(plasma)].density
    if p.body.name != "Earth" or record is None:
        return ()
    normal = np.cross(p.position, p.velocity)
    normal /= np.linalg.norm(normal)
    towards = p.position / np.linalg.norm(p.position)
    angle = np.linspace(0.0, 2 * np.pi, SHELL_ANGLES, endpoint=False)
    axis = orbital.elements(p.position, p.velocity, p.body.mu)
    highest = float(axis.semi_major_axis * (1 + axis.eccentricity)) - earth
    altitude = np.arange(ionosphere.LOWEST, min(highest + 100e3, ionosphere.HIGHEST) + 1.0, SHELL_STEP)
    place = np.outer(np.cos(angle), towards) + np.outer(np.sin(angle), np.cross(normal, towards))
    density = record(plasma, p.model.named, place, angle, altitude)
    return (Shell("plasma density", "1/m³", normal, towards, angle, altitude, density),)


def planets_in_view(p: Plan, farthest: float | None = None) -> dict[str, np.ndarray]:
    """Name -> orbit (k, 3) m of the planets that a heliocentric run comes near. farthest : its largest distance from
    the centre, m, where that is known."""
    if p.body.name != "Sun":
        return {}
    if drawn := drawn_bodies(p.scene):  # the planets of this scene are those whose gravity acts
        return {body.name: body.orbit for body in drawn}
    reach = 1.15 * (_farthest(p) if farthest is None else farthest)
    orbits = {name: ephemeris.planet_orbit(name, epoch_of(p.scene)) for name in ephemeris.PLANETS}
    if frame_of(p.scene) != "ecliptic-j2000":
        orbits = {name: orbit @ _turn(p).T for name, orbit in orbits.items()}
    return {name: orbit for name, orbit in orbits.items() if np.linalg.norm(orbit, axis=1).min() <= reach}


def _farthest(p: Plan) -> float:
    """Largest distance from the centre, m, from a coarse run ahead: a millisecond, and the same for blocks of any
    size. What would take long is told by its beginning."""
    if p.turning is not None:  # whose turns would take the steps: how far the orbit of its start goes
        orbit = orbital.elements(p.position, p.velocity, p.body.mu)
        far = float(orbit.semi_major_axis * (1 + orbit.eccentricity))
        return max(far, float(np.linalg.norm(p.position))) if np.isfinite(far) else float(np.linalg.norm(p.position))
    times = np.linspace(0.0, p.scene.propagation.duration, 256)
    out = np.empty((6, len(times)))
    method, state = INTEGRATORS[p.choice.integrator], begun(p)
    arguments = p.schedule.breaks, p.schedule.factors.copy(), p.watch, times, out, times[-1]
    kept = p.model.tables.copy()
    method.advance(state, p.model, *arguments, 1e-7, np.inf, Patience(MOST_STEPS_AHEAD))
    p.model.tables[:] = kept  # where a voltage controller notes what it does
    return float(np.linalg.norm(out[:3, : stepping.rows_done(state)], axis=0).max())


def bodies(p: Plan, planets, time) -> dict[str, np.ndarray]:
    """Positions (n, 3) m of what is drawn beside the craft; nothing without an epoch."""
    return _known_bodies(p, planets, time) | moving_target(p.scene, p.body, time)


def _known_bodies(p: Plan, planets, time) -> dict[str, np.ndarray]:
    if drawn := drawn_bodies(p.scene):
        return {body.name: body.position(time) for body in drawn}
    if p.sky is not None and p.body.name != "Sun":
        return body_places(p.sky, time)
    epoch = epoch_of(p.scene)
    if epoch is None:
        return {}
    if p.body.name == "Earth":
        return {"Sun": ephemeris.sun_position(epoch, time)}
    plain = frame_of(p.scene) == "ecliptic-j2000" and p.scene.ephemeris in (SERIES, "de421")
    if p.sky is None and plain:
        return {name: ephemeris.planet_position(name, epoch, time, p.scene.ephemeris) for name in planets}
    sky = p.sky or SceneSky(p.scene, p.body, epoch)
    assert sky.places is not None
    alone = "earth" if "earth" in sky.words else "earth-moon"  # an Earth without its Moon is drawn where both are
    words = {name: alone if name == "Earth" else name.lower() for name in planets}
    return {name: sky.places.position(word, "sun", time) for name, word in words.items()}
