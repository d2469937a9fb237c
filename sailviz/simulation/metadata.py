"""What a picture of a run needs to know beside its rows: words, the craft, orbits drawn from the start, planets."""

from __future__ import annotations

import platform
from typing import Any

import numba
import numpy as np

import sailviz
from sailviz import elements as orbital
from sailviz import ephemeris
from sailviz.environment import ionosphere, solar_level, sun
from sailviz.propagate import dop853
from sailviz.propagate import parameters as row
from sailviz.propagate.choice import GAUSS_JACKSON
from sailviz.run.arrays import Craft, Reference, Setting, Shell
from sailviz.scene.body import Target
from sailviz.scene.start import DesignedStart
from sailviz.scene.steering import LyapunovSteering
from sailviz.simulation.bodies import epoch_of, third_body
from sailviz.simulation.device import sail_strength
from sailviz.simulation.parameters_in_words import parameters_in_words
from sailviz.simulation.plan import Plan
from sailviz.simulation.start import departure

SHELL_ANGLES, SHELL_STEP = 120, 25e3  # round the orbit; m between altitudes


def setting_of(p: Plan, planets, rows, ensembles=()) -> Setting:
    scene = p.scene
    duration = scene.propagation.duration
    return Setting(
        title=scene.title,
        family=scene.family or _family(scene),
        about=scene.about,
        look_for=tuple(scene.look_for),
        thesis=scene.thesis,
        body=p.body,
        craft=_craft(scene),
        duration=duration,
        rows=rows,
        epoch=epoch_of(scene),
        references=_references(p, planets),
        parameters=tuple(parameters_in_words(scene, p.design, _words_strength(scene, p.design))),
        text=scene.text,
        resolved=scene.resolved(),
        versions={
            "sailviz": sailviz.__version__,
            "python": platform.python_version(),
            "numpy": np.__version__,
            "numba": numba.__version__,
        },
        accuracy=_accuracy(p),
        identity=p.identity,
        play_duration=scene.recording.play_duration,
        shells=_shells(p),
        ensembles=ensembles,
    )


def _accuracy(p: Plan) -> str:
    if p.choice.integrator == GAUSS_JACKSON:
        return (
            "Summed Gauss-Jackson, fixed step, compensated sums, quintic output between the steps, float64; started "
            "and restarted by Dormand-Prince 8(5,3). About 1e-9 of the radius in a year under smooth forces."
        )
    return (
        f"Dormand-Prince 8(5,3) with dense output, relative tolerance {p.scene.propagation.tolerance:g} per step "
        "(position against distance, velocity against the larger of speed and circular speed), float64."
    )


def _family(scene) -> str:
    if scene.body == "earth":
        return "deorbit"
    if scene.environment.solar_wind.kind != "steady" or scene.ensemble or scene.chaos:
        return "wind"
    return "displaced" if isinstance(scene.start, DesignedStart) else "spirals"


def _craft(scene) -> Craft:
    device = scene.device
    labels = {
        "solar-sail": "Solar sail",
        "electric-sail": "E-sail",
        "plasma-brake": "Plasma brake",
        "thruster": "Thruster",
        "none": "Spacecraft",
    }
    area = getattr(device, "area", None)
    return Craft(
        device.kind,
        labels[device.kind],
        side=None if area is None else float(np.sqrt(area)),
        tethers=getattr(device, "tethers", None),
        tether_length=getattr(device, "tether_length", None),
    )


def _words_strength(scene, design):
    return sail_strength(scene, design) if scene.device.kind in ("solar-sail", "electric-sail") else None


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
    wanted, steering = p.scene.target, p.scene.steering
    if wanted is None:
        return _aim_of_law(steering) if isinstance(steering, LyapunovSteering) else None
    if wanted.planet is not None:
        name = wanted.planet.capitalize()
        return wanted.name or f"orbit of {name}", ephemeris.planet_ellipse(name, epoch_of(p.scene))
    return wanted.name or "target orbit", _elements_of(wanted, wanted.radius or wanted.semi_major_axis)


def _aim_of_law(steering: LyapunovSteering) -> tuple[str, orbital.Elements]:
    return "target orbit", _elements_of(steering, steering.semi_major_axis)


def _elements_of(orbit: Target | LyapunovSteering, size: float | None) -> orbital.Elements:
    """Elements of an orbit of a scene, scalars, at its periapsis. size : semi-major axis m."""
    scalars: list[Any] = [size, orbit.eccentricity, orbit.inclination, orbit.raan, orbit.argument, 0.0]
    return orbital.Elements(*scalars)


def _shells(p: Plan) -> tuple[Shell, ...]:
    """The plasma that a tether meets, in the plane of its first orbit."""
    plasma, earth = p.scene.environment.ionosphere, p.body.radius
    if p.body.name != "Earth" or plasma is None or plasma.kind == "exponential-force":
        return ()
    normal = np.cross(p.position, p.velocity)
    normal /= np.linalg.norm(normal)
    towards = p.position / np.linalg.norm(p.position)
    angle = np.linspace(0.0, 2 * np.pi, SHELL_ANGLES, endpoint=False)
    axis = orbital.elements(p.position, p.velocity, p.body.mu)
    highest = float(axis.semi_major_axis * (1 + axis.eccentricity)) - earth
    altitude = np.arange(ionosphere.LOWEST, min(highest + 100e3, ionosphere.HIGHEST) + 1.0, SHELL_STEP)
    if plasma.kind == "iri-2020":
        place = np.outer(np.cos(angle), towards) + np.outer(np.sin(angle), np.cross(normal, towards))
        model = p.model.parameters
        hour = np.arctan2(place[:, 1], place[:, 0]) - sun.mean_right_ascension.py_func(0.0, model, row.SUN) + np.pi
        flux = solar_level.flux.py_func(0.0, model, row.FLUX)
        density, _ = ionosphere.density(np.arcsin(place[:, 2])[:, None], hour[:, None], altitude, flux)
        density = density * plasma.density_factor
    else:
        fade = ionosphere.exponential.py_func(altitude, plasma.reference_altitude, plasma.density, plasma.scale_height)
        density = np.tile(fade, (len(angle), 1))
    return (Shell("plasma density", "1/m³", normal, towards, angle, altitude, density),)


def planets_in_view(p: Plan) -> dict[str, np.ndarray]:
    """Name -> orbit (k, 3) m of the planets that a heliocentric run comes near."""
    if p.body.name != "Sun":
        return {}
    third = p.scene.environment.third_body
    if third is not None:  # the planets of this scene are the one whose gravity acts
        turn = np.linspace(0, 2 * np.pi, 361)
        return {third.name: third.radius * np.column_stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)])}
    reach = 1.15 * _farthest(p)
    orbits = {name: ephemeris.planet_orbit(name, epoch_of(p.scene)) for name in ephemeris.PLANETS}
    return {name: orbit for name, orbit in orbits.items() if np.linalg.norm(orbit, axis=1).min() <= reach}


def _farthest(p: Plan) -> float:
    """Largest distance from the centre, m, from a coarse run ahead: a millisecond, and the same for blocks of any
    size."""
    times = np.linspace(0.0, p.scene.propagation.duration, 256)
    out = np.empty((6, len(times)))
    state = dop853.start(0.0, p.position, p.velocity, p.mass, events=len(p.names))
    dop853.advance(state, p.model, p.schedule.breaks, p.schedule.factors, p.watch, times, out, times[-1], 1e-7, np.inf)
    return float(np.linalg.norm(out[:3, : dop853.rows_done(state)], axis=0).max())


def bodies(p: Plan, planets, time) -> dict[str, np.ndarray]:
    """Positions (n, 3) m of what is drawn beside the craft; nothing without an epoch."""
    third = p.scene.environment.third_body
    if third is not None:
        _, radius, rate, azimuth = third_body(p.scene)
        angle = azimuth + rate * time
        return {third.name: radius * np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])}
    epoch = epoch_of(p.scene)
    if epoch is None:
        return {}
    if p.body.name == "Earth":
        return {"Sun": ephemeris.sun_position(epoch, time)}
    return {name: ephemeris.planet_position(name, epoch, time, p.scene.ephemeris) for name in planets}
