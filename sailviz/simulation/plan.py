"""Scene -> Plan: what a scene's words mean to the propagator.

A Model, an initial state, a schedule of thrust factors and a list of events; nothing is propagated here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sailviz.errors import Fault, SceneError
from sailviz.propagate import dop853, dynamics
from sailviz.propagate.callbacks import user_address
from sailviz.propagate.choice import DOP853, TURNING, Choice, choose
from sailviz.propagate.events import Watch, watch
from sailviz.propagate.voltage_callback import R_REF, U_REF, WANTED, voltage_callback
from sailviz.run.arrays import Body, Phase
from sailviz.scene.device import DistanceControl, SolarSail, control_of
from sailviz.scene.film import ages, heats_shape
from sailviz.scene.loading import Scene
from sailviz.scene.phases import Phase as PhaseSection
from sailviz.scene.phases import scene_of
from sailviz.simulation.environment import parts_of, surroundings
from sailviz.simulation.lowered import Flight, LoweredSteering, Place, merged
from sailviz.simulation.thrust_history import Schedule
from sailviz.steering import attitude

if TYPE_CHECKING:
    from sailviz.simulation.first_order import FirstOrder
    from sailviz.simulation.quasi_circular import QuasiCircular
    from sailviz.simulation.start import Design
from sailviz.simulation.approximations import first_orders, quasi_circular_decay
from sailviz.simulation.beside import BesideDevice, by_its_force, devices_beside, in_phase, named_switches, schedules
from sailviz.simulation.bodies import body_of, epoch_of
from sailviz.simulation.device import device_of, shape_facts, strength_or_none
from sailviz.simulation.events import latest_end, quantities_watched, watched
from sailviz.simulation.film import dose_at_start, film_numbers
from sailviz.simulation.identity import identity_of
from sailviz.simulation.sky import SceneSky, blown_by_air, pushed_by_shape, sky_of, under_sky
from sailviz.simulation.start import design_of, held_radius, initial_state
from sailviz.simulation.steering import steering_of
from sailviz.simulation.turning import (
    TurningPlan,
    begun_turning,
    moves,
    nobody_follows,
    taken_over,
    turning_numbers,
    turning_of,
)
from sailviz.simulation.wheel import refuse_saturated, spins, wheel_numbers, wheel_of


class Handover(NamedTuple):
    """Where a phase takes over."""

    number: int  # of the phase
    time: float  # s
    position: np.ndarray  # (3,) m
    velocity: np.ndarray  # (3,) m/s
    seventh: float  # number of the state: see Plan
    in_use: bool  # whether the device has not been switched off for good
    turning: TurningPlan | None = None  # of a craft that turns, its state there


@dataclass(frozen=True)
class Plan:
    """A scene as the propagator sees it; of a scene in phases, one of them."""

    scene: Scene
    body: Body
    position: np.ndarray  # (3,) m
    velocity: np.ndarray  # (3,) m/s
    # number of the state: mass kg, 1 where the scene gives none, so that forces are accelerations; of a film that ages
    # the dose, s of full sunlight at 1 au, of a wheel that spins how far its spin has drifted: nothing burns beside
    seventh: float
    model: dynamics.Model
    table: np.ndarray | None  # of the steering, `sailviz.steering.table`
    schedule: Schedule  # of the thrust factor
    watch: Watch
    names: tuple[str, ...]  # of the watched events
    design: Design  # the design's result for starts that ask for one
    approximations: dict[str, FirstOrder]
    quasi_circular: QuasiCircular | None
    choice: Choice  # of the integrator
    sky: SceneSky | None  # None where only the central body and its own light matter
    beside: list[BesideDevice]  # what pushes beside the first device
    keep: tuple[object, ...]  # compiled user functions must live as long as the plan
    phases: tuple[Phase, ...]  # what its steering flies one after the other
    turning: TurningPlan | None  # of a craft whose attitude has a motion of its own
    identity: str
    begin: float  # s
    limit: float  # s, at which it ends if nothing ends it before
    in_use: bool  # whether its device is, at the beginning

    @property
    def mass_known(self) -> bool:
        """Whether the scene gives a mass."""
        return self.scene.device.mass is not None

    def masses(self, states: np.ndarray) -> np.ndarray:
        """Mass (n,) kg in states (7, n): 1 where the scene gives none."""
        if dose_at_start(self.scene) is None and not spins(self.scene):
            found: np.ndarray = states[6]
            return found
        return np.full(states.shape[1], self.scene.device.mass or 1.0)


def plan(scene: Scene, steering: object = None, force: object = None, taken: Handover | None = None) -> Plan:
    """What a scene means. SceneError if it asks for something infeasible, TypeError for a bad user function.

    steering, force : functions of the user's own, see `simulate`. taken : where a later phase takes over; without it a
    scene in phases means its first.
    """
    body, design, whole = body_of(scene), design_of(scene), scene
    position, velocity = initial_state(scene, body, design) if taken is None else (taken.position, taken.velocity)
    begin = 0.0 if taken is None else taken.time
    phase = scene.phase[0 if taken is None else taken.number] if scene.phase else None
    limit = scene.propagation.duration
    if phase is not None:
        scene, limit = scene_of(scene, phase), latest_end(phase, begin, limit)
    device = device_of(scene).lower(scene.device, scene, design)
    sail, strength = device_of(scene).sail, strength_or_none(scene, design)
    shape = None if sail is None else sail(scene.device)
    flight = Flight(scene, design, position, velocity, device, shape, strength, begin)
    steered = steering_of(scene.steering).lower(scene.steering, flight)
    sky = sky_of(scene, body, epoch_of(scene))
    device, steered, overhead = pushed_by_shape(*under_sky(sky, device, steered))
    device, overhead = blown_by_air(scene, device, overhead)
    device, overhead = by_its_force(scene, device, overhead)
    addresses, keep = _own_of(scene, steering, force)
    if steering is not None:
        steered = LoweredSteering(attitude.USER)
    turned = None if taken is None else taken.turning
    turning = taken_over(turning_of(scene, steered), turned)
    when, times_beside = schedules(scene, steered.table, steered.breaks)
    if phase is not None:
        times_beside = in_phase(times_beside, [phase.state_of(device).level for device in scene.beside])
    own_switches = named_switches(scene, steered.switches)
    when = replace(when, switches=tuple(sorted({*when.switches, *own_switches})))
    beside = devices_beside(scene, position, velocity, times_beside, sky is not None)
    level = _level(scene, phase)
    when = replace(when, factors=level * when.factors)
    names, watching = watched(scene, body, phase)
    place = Place(scene, body, epoch_of(scene))
    around = [record.lower(part, place) for part, record in parts_of(scene)]
    parts: dict[str, Any] = dict(
        device=device.kind,
        device_parameters=device.parameters,
        device_callback=device.callback,
        steering=steered.kind,
        steering_parameters=steered.parameters,
        steering_callback=steered.callback,
        steer_as=steered.steer_as,
        primer_kind=steered.primer_kind,
        interpolation=steered.interpolation,
        table=steered.table,
        burns=any(one.burns for one in beside),
        **turning_numbers(turning),
        quantity=quantities_watched(scene, device.kind, phase),
        wheel=wheel_numbers(scene, strength or 0.0),
        film=film_numbers(scene, strength or 0.0, level),
        heat=_heat_of(scene),
        **addresses,
        **merged(
            {"forces": device.forces},
            {"forces": tuple(one.callback for one in beside)},
            surroundings(scene, body, place.epoch),
            *around,
            overhead,
        ),
    )

    def nominal(times: np.ndarray) -> np.ndarray:
        assert when.lines is not None  # asked for by a controller only
        on = when.lines[:, WANTED]
        return _flight(dynamics.model(body.mu, **parts), position, velocity, when.breaks, on, times)

    model = dynamics.model(body.mu, **parts, **_controlled(scene, when, nominal))
    seventh = _seventh(scene) if taken is None else taken.seventh
    start = np.array([*position, *velocity, seventh])
    if taken is None:
        refuse_saturated(scene, model, start)
    begun = begun_turning(scene, turning, model, sky is not None, begin, start, turned)
    if begun is not None:  # from here on its steering points where it stands
        model.parameters["kinds"]["steering"] = attitude.INERTIAL
    return Plan(
        scene,
        body,
        position,
        velocity,
        seventh,
        model,
        steered.table,
        when,
        watching,
        names,
        design,
        first_orders(scene, body, position, velocity, design),
        quasi_circular_decay(scene, position, velocity),
        _integrator(scene, model, position, velocity, when.breaks - begin, limit - begin, len(beside)),
        sky,
        beside,
        keep,
        steered.phases,
        begun,
        identity_of(whole, steering=steering, force=force, shape=shape_facts(whole)),
        begin,
        limit,
        taken is None or taken.in_use,
    )


def _heat_of(scene: Scene) -> np.ndarray | None:
    """Numbers of the films of a shape whose temperature is asked for."""
    if not heats_shape(scene):
        return None
    from sailviz.simulation.shape_heat import shape_heat  # trimesh, which flat sails do without

    return shape_heat(scene)


def _level(scene: Scene, phase: PhaseSection | None) -> float:
    """How hard the device works in a phase, of its full thrust."""
    return 1.0 if phase is None else phase.state_of(scene.device).level


def _seventh(scene: Scene) -> float:
    """The last number of the state at the start of a flight."""
    dose = dose_at_start(scene)
    if dose is None:
        return 0.0 if spins(scene) else scene.device.mass or 1.0
    return dose


def _own_of(scene: Scene, steering: object, force: object) -> tuple[dict[str, int], tuple[object, ...]]:
    """(keywords of `dynamics.model`, what must stay alive) of the user's functions. SceneError where they cannot be."""
    if steering is not None:
        nobody_follows(scene)
    functions = {"steering": steering, "force": force}
    compiled = {part: user_address(function, part) for part, function in functions.items() if function is not None}
    if compiled and (ages(scene) or wheel_of(scene) is not None):
        words = "a function of one's own gets the mass, which a film that ages or a wheel as a body does not carry."
        raise SceneError([Fault("device.ageing" if ages(scene) else "device.wheel", words)], scene.source)
    addresses = {f"user_{part}": address for part, (address, _) in compiled.items()}
    return addresses, tuple(handle for _, handle in compiled.values())


def _controlled(scene: Scene, when: Schedule, nominal: Callable[[np.ndarray], np.ndarray]) -> dict[str, Any]:
    """Keywords of `dynamics.model` for a voltage controller, its reference flight filled in. nominal : the same flight
    without wind, times (k,) -> states (6, k)."""
    if when.law is None or when.lines is None:
        return {}
    lines = when.lines.copy()
    held = held_radius(scene)
    if held is not None:
        lines[:, R_REF] = held
    elif isinstance(control_of(scene.device), DistanceControl):
        states = nominal(when.breaks)
        r = np.linalg.norm(states[:3], axis=0)
        lines[:, R_REF], lines[:, U_REF] = r, np.sum(states[:3] * states[3:], axis=0) / r
    return {"control": voltage_callback(), "control_table": lines, "control_law": when.law}


def _integrator(
    scene: Scene,
    model: dynamics.Model,
    position: np.ndarray,
    velocity: np.ndarray,
    breaks: np.ndarray,
    duration: float,
    beside: int,
) -> Choice:
    """Which integrator a scene gets. SceneError where the one asked for cannot do it."""
    run = scene.propagation
    if moves(scene):
        return Choice(TURNING, "position and attitude move together")
    shaped = isinstance(scene.device, SolarSail) and scene.device.shape is not None
    if shaped and run.integrator == "auto":
        return Choice(DOP853, "the force of a shape, read from a table, has kinks")
    if ages(scene):
        return Choice(DOP853, "it carries the dose of a film that ages along with the state")
    if spins(scene):
        return Choice(DOP853, "it carries the drift of the wheel's spin along with the state")
    found = choose(model, position, velocity, duration, breaks, run.integrator, run.tolerance, beside)
    if not found.possible:
        raise SceneError([Fault("propagation.integrator", f"{found.reason}.")], scene.source)
    return found


def _flight(
    model: dynamics.Model,
    position: np.ndarray,
    velocity: np.ndarray,
    breaks: np.ndarray,
    factors: np.ndarray,
    times: np.ndarray,
) -> np.ndarray:
    """States (6, n) at times (n,) s of a flight without events."""
    state, out = dop853.start(0.0, position, velocity, 1.0), np.empty((6, len(times)))
    dop853.advance(state, model, breaks, factors, watch([]), times, out, times[-1], 1e-12, np.inf)
    return out
