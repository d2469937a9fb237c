"""What a scene's [attitude] is to the right-hand side: the numbers of the body, its state at the start, its events."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sailviz import frames
from sailviz.errors import Fault, SceneError
from sailviz.propagate import body_motion, dynamics, sky_callback
from sailviz.propagate.body_control import ReflectivityDevice, Vane, body_control
from sailviz.propagate.body_motion import AVERAGED, CONTROLLED, FREE, Body
from sailviz.propagate.dynamics import Model
from sailviz.propulsion.solar_sail import Film
from sailviz.propulsion.surfaces import side_of
from sailviz.scene import attitude as section
from sailviz.scene.device import FilmCoefficients, FilmOptics, SolarSail, air_on_facets
from sailviz.scene.film import ages
from sailviz.simulation.mass_properties import mass_properties
from sailviz.steering import attitude

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene
    from sailviz.simulation.lowered import LoweredSteering

SLIDES = 10.0  # times the controller's frequency: how fast a sliding mass follows
SPUN = 20.0  # times the rate of the orbit, at which an average over a spin begins to hold


class Turning(NamedTuple):
    """A craft that turns."""

    body: Body
    rows: tuple[tuple[float, ...], ...]  # of vanes and devices
    names: tuple[str, ...]  # of what they are set to, columns of the recording


@dataclass(frozen=True)
class TurningPlan:
    """The same with its state at the start."""

    turning: Turning
    motion: np.ndarray  # (SIZE - 7,) from the quaternion on
    tumbled: bool = False  # before, in an earlier phase

    @property
    def body(self) -> Body:
        """The numbers of the body."""
        return self.turning.body


def moves(scene: Scene) -> bool:
    """Whether the attitude has a motion of its own."""
    return isinstance(scene.attitude, section.Moving)


def nobody_follows(scene: Scene) -> None:
    """SceneError where a steering of one's own would turn a craft that follows none."""
    if moves(scene) and not isinstance(scene.attitude, section.ControlledAttitude):
        words = "your own steering is followed by a controlled craft, not by one that turns by itself"
        raise SceneError([Fault("attitude.kind", f"{words}.")], scene.source)


def turning_of(scene: Scene, steered: LoweredSteering) -> Turning | None:
    """The craft that turns; None where it stands as its steering says."""
    said = scene.attitude
    if not isinstance(said, section.Moving):
        return None
    inertia, centre = mass_properties(scene)
    lit = isinstance(scene.device, SolarSail)
    body = Body(FREE, *six(inertia), *six(np.linalg.inv(inertia)), *centre.tolist())
    body = body._replace(lit=float(lit), gradient=float(said.gravity_gradient), air=float(air_on_facets(scene.device)))
    if ages(scene):
        body = body._replace(mass=scene.device.mass or 0.0)
    if isinstance(said, section.SpinAveragedAttitude):
        return Turning(body._replace(motion=AVERAGED), (), ())
    if not isinstance(said, section.ControlledAttitude):
        return Turning(body, (), ())
    fixed = [float(value) for value in steered.parameters] if steered.kind == attitude.INERTIAL else [0.0, 0.0, 0.0]
    roll = getattr(scene.device, "roll", None) or 0.0
    body = body._replace(
        motion=CONTROLLED,
        cos_roll=float(np.cos(roll)),
        sin_roll=float(np.sin(roll)),
        law=float(steered.kind),
        law_x=fixed[0],
        law_y=fixed[1],
        law_z=fixed[2],
    )
    return _with_actuators(scene, said, body)


def turning_numbers(turning: Turning | None) -> dict[str, Any]:
    """Keywords of `dynamics.model` for a craft that turns."""
    if turning is None:
        return {}
    controlled = turning.body.motion == CONTROLLED
    return {
        "body": body_motion.packed(turning.body, turning.rows),
        "body_control": body_control() if controlled else None,
    }


def six(matrix: np.ndarray) -> tuple[float, ...]:
    """xx, yy, zz, xy, xz, yz of a symmetric matrix."""
    return tuple(float(matrix[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))


def _with_actuators(scene: Scene, said: section.ControlledAttitude, body: Body) -> Turning:
    device, control = scene.device, said.control
    if isinstance(control, section.PointingControl):
        w = control.frequency
        body = body._replace(stiffness=w * w, damping=2 * control.damping * w, fastest=w)
    else:
        body = body._replace(calm=float(np.sin(min(control.calm, np.pi / 2))))
    vanes: list[tuple[float, ...]] = []
    patches: list[tuple[float, ...]] = []
    for one in said.actuators:
        if isinstance(one, section.Wheels):
            body = body._replace(wheel_torque=one.torque, wheel_storage=one.storage)
        elif isinstance(one, section.SlidingMass):
            assert device.mass is not None
            body = body._replace(
                slide_share=one.mass / device.mass,
                slide_travel=one.travel,
                slide_speed=one.speed,
                slide_rate=SLIDES * float(np.sqrt(body.stiffness)),
            )
        else:
            from sailviz.simulation.sail_shape import surface_of_film

            assert isinstance(device, SolarSail)
            film = surface_of_film(device)
            assert film.back is not None  # a film has two sides
            x, y, z = one.position
            if isinstance(one, section.Vane):
                (f1, f2, f3), (g1, g2, g3) = film.front, film.back
                vanes.append(tuple(Vane(x, y, z, one.area, one.limit, one.rest, f1, f2, f3, g1, g2, g3)))
            else:
                off = side_of(_film(one.off))
                d1, d2, d3 = np.subtract(film.front, off).tolist()
                patches.append(tuple(ReflectivityDevice(x, y, z, one.area, d1, d2, d3, 1.0, *off)))
    names = [f"vane_{i + 1}_angle_rad" for i in range(len(vanes))]
    names += [f"device_{i + 1}_on" for i in range(len(patches))]
    body = body._replace(vanes=float(len(vanes)), devices=float(len(patches)))
    return Turning(body, (*vanes, *patches), tuple(names))


def _film(given: FilmCoefficients | FilmOptics) -> Film:
    values = given.model_dump()
    return Film(**values) if "b1" in values else Film.from_optics(**values)


def begun_turning(
    scene: Scene,
    turning: Turning | None,
    model: Model,
    under_sky: bool,
    begin: float,
    state: np.ndarray,
    before: TurningPlan | None = None,
) -> TurningPlan | None:
    """With the state at the start; state (7,) : position m, velocity m/s, mass kg; before : as it turned where a phase
    ended. SceneError for a spin that is too slow to be averaged."""
    if turning is None:
        return None
    if before is not None:
        return replace(before, turning=turning)
    said = scene.attitude
    assert isinstance(said, section.Moving)
    axes, rate = _axes_at_start(scene, said, model, under_sky, begin, state), np.zeros(3)
    motion = np.zeros(body_motion.SIZE - body_motion.Q)
    if isinstance(said, section.SpinAveragedAttitude):
        _fast_enough(scene, said, state, float(model.named.gravity.mu))
        motion[:3], motion[body_motion.RATE - body_motion.Q + 2] = axes[:, 2], said.spin
        return TurningPlan(turning, motion)
    if said.quaternion is not None:
        motion[:4] = np.array(said.quaternion) / np.linalg.norm(said.quaternion)
    else:
        motion[:4] = frames.quaternion(axes[None])[0]
    if said.rates is not None:
        rate = np.array(said.rates)
    motion[body_motion.RATE - body_motion.Q :][:3] = rate
    return TurningPlan(turning, motion)


def taken_over(turning: Turning | None, before: TurningPlan | None) -> Turning | None:
    """The craft of a phase after another, if it turns: a mass that slid there, and that nothing slides any more, stays
    where it is."""
    if turning is None or before is None or turning.body.slide_share != 0.0:
        return turning
    return turning._replace(body=turning.body._replace(slide_share=before.body.slide_share))


def _axes_at_start(
    scene: Scene, said: section.Moving, model: Model, under_sky: bool, begin: float, state: np.ndarray
) -> np.ndarray:
    """Axes of the body (3, 3), as columns."""
    if said.quaternion is not None:
        q = np.array(said.quaternion) / np.linalg.norm(said.quaternion)
        return frames.rotation(q)
    times, states, one = np.array([begin]), state[:, None].copy(), np.ones(1)
    orbit = frames.rtn(state[:3], state[3:6])
    of_device = getattr(scene.device, "roll", None) or 0.0
    if isinstance(said, section.ControlledAttitude) and said.pitch is None and said.clock is None:
        normal, roll = dynamics.observe(times, states, one, model)[0][0], of_device + (said.roll or 0.0)
    else:
        light = orbit
        if under_sky:
            seen = sky_callback.observe_sky(times, states, np.zeros((1, 3)), model.parameters)
            rows = (sky_callback.FROM_LIGHT, sky_callback.EAST, sky_callback.NORTH)
            light = np.stack([seen[row : row + 3, 0] for row in rows], axis=-1)
        pitch, clock, roll = said.pitch or 0.0, said.clock or 0.0, said.roll or 0.0
        tilt = [np.cos(pitch), np.sin(pitch) * np.sin(clock), np.sin(pitch) * np.cos(clock)]
        normal = light @ np.array(tilt)
    body = frames.body_axes(frames.stance(orbit, normal)[None], orbit[None, :, 1])[0]
    found: np.ndarray = body @ frames.turn_z(roll).T
    return found


def _fast_enough(scene: Scene, said: section.SpinAveragedAttitude, state: np.ndarray, mu: float) -> None:
    r, v = float(np.linalg.norm(state[:3])), float(np.linalg.norm(state[3:6]))
    orbit = max(v / r, float(np.sqrt(mu / r**3)))
    if abs(said.spin) < SPUN * orbit:
        words = f"is not {SPUN:g} times the {orbit:.2g} rad/s of the orbit: such a spin is no fast one. Fly it free."
        raise SceneError([Fault("attitude.spin", words)], scene.source)


def events_of_turning(scene: Scene) -> list[tuple[str, str, float]]:
    """(name, quantity, level that it passes upwards) of what comes with a craft that turns."""
    said = scene.attitude
    found: list[tuple[str, str, float]] = []
    if not isinstance(said, section.Moving):
        return found
    if isinstance(scene.device, SolarSail):
        found.append(("tumbling", "pitch", np.pi / 2))
    if said.sun_angle_limit is not None:
        found.append(("Sun angle", "pitch", said.sun_angle_limit))
    if isinstance(said, section.ControlledAttitude):
        for one in said.actuators:
            if isinstance(one, section.Wheels):
                found.append(("wheels saturated", "wheel_momentum", one.storage * (1 - 1e-9)))
    return found
