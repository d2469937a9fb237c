"""Scene -> Plan: what a scene's words mean to the propagator.

A Model, an initial state, a schedule of thrust factors and a list of events; nothing is propagated here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sailviz.errors import Fault, SceneError
from sailviz.propagate import dop853, dynamics
from sailviz.propagate import events as happening
from sailviz.propagate.callbacks import user_address
from sailviz.propagate.choice import Choice, choose
from sailviz.propagate.voltage_callback import R_REF, U_REF, WANTED, factor_plug
from sailviz.run.arrays import Body
from sailviz.scene.loading import Scene
from sailviz.simulation.low_orbit import low_orbit_parts
from sailviz.simulation.thrust_history import Schedule, schedule
from sailviz.steering import attitude as law

if TYPE_CHECKING:
    from sailviz.simulation.first_order import FirstOrder
    from sailviz.simulation.quasi_circular import QuasiCircular
from sailviz.simulation.approximations import _approximations, _quasi_circular
from sailviz.simulation.bodies import BODIES, _custom_body, epoch_of, third_body
from sailviz.simulation.device import _device
from sailviz.simulation.events import _watched
from sailviz.simulation.identity import _identity
from sailviz.simulation.start import _design, _initial_state
from sailviz.simulation.steering import _primer_law, _steering


@dataclass(frozen=True)
class Plan:
    """A scene as the propagator sees it."""

    scene: Scene
    body: Body
    position: np.ndarray  # (3,) m
    velocity: np.ndarray  # (3,) m/s
    mass: float  # kg
    model: dynamics.Model
    table: np.ndarray | None  # of the steering, `sailviz.steering.table`
    schedule: Schedule  # of the thrust factor
    watch: happening.Watch
    names: tuple[str, ...]  # of the watched events
    design: object | None  # the design's result for starts that ask for one
    approximations: dict[str, FirstOrder]
    quasi_circular: QuasiCircular | None
    choice: Choice  # of the integrator
    keep: tuple  # compiled user functions must live as long as the plan
    identity: str


def plan(scene: Scene, steering=None, force=None) -> Plan:
    """What a scene means. SceneError if it asks for something infeasible, TypeError for a bad user function."""
    body = BODIES[scene.body] if isinstance(scene.body, str) else Body(*_custom_body(scene))
    design = _design(scene)
    position, velocity = _initial_state(scene, body, design)
    device, device_parameters = _device(scene, design)
    law_id, law_parameters, table, interpolation, switches = _steering(scene, design, position, velocity)
    keep = []
    user_steering = user_force = 0
    if steering is not None:
        user_steering, handle = user_address(steering, "steering")
        law_id, law_parameters, table, interpolation, switches = law.USER, (), None, law.LINEAR, ()
        keep.append(handle)
    if force is not None:
        user_force, handle = user_address(force, "force")
        keep.append(handle)
    when = schedule(scene, table)
    when = replace(when, switches=tuple(sorted({*when.switches, *switches})))
    names, watch = _watched(scene, body)
    parts = dict(
        device=device,
        device_parameters=device_parameters,
        steering=law_id,
        steering_parameters=law_parameters,
        interpolation=interpolation,
        table=table,
        surface_radius=body.radius,
        third_body=third_body(scene),
        user_steering=user_steering,
        user_force=user_force,
        **_primer_law(scene, law_id, device, device_parameters),
        **low_orbit_parts(scene, body, epoch_of(scene)),
    )

    def nominal(times):
        on = when.lines[:, WANTED]
        return _flight(dynamics.model(body.mu, **parts), position, velocity, when.breaks, on, times)

    model = dynamics.model(body.mu, **parts, **_controlled(scene, when, nominal))
    return Plan(
        scene,
        body,
        position,
        velocity,
        scene.device.mass or 1.0,
        model,
        table,
        when,
        watch,
        names,
        design,
        _approximations(scene, body, position, velocity, design),
        _quasi_circular(scene, position, velocity),
        _integrator(scene, model, position, velocity, when.breaks),
        tuple(keep),
        _identity(scene, steering=steering, force=force),
    )


def _controlled(scene, when: Schedule, nominal):
    """Keywords of `dynamics.model` for a voltage controller, its reference flight filled in. nominal : the same flight
    without wind, times (k,) -> states (6, k)."""
    if when.law is None:
        return {}
    lines = when.lines.copy()
    if scene.start.kind in ("displaced", "heliostationary", "lagrange-point"):
        lines[:, R_REF] = scene.start.radius
    elif scene.device.control.kind == "distance":
        states = nominal(when.breaks)
        r = np.linalg.norm(states[:3], axis=0)
        lines[:, R_REF], lines[:, U_REF] = r, np.sum(states[:3] * states[3:], axis=0) / r
    return {"control": factor_plug(), "control_table": lines, "control_law": when.law}


def _integrator(scene, model, position, velocity, breaks) -> Choice:
    """Which integrator a scene gets. SceneError where the one asked for cannot do it."""
    run = scene.propagation
    found = choose(model, position, velocity, run.duration, breaks, run.integrator)
    if not found.possible:
        raise SceneError([Fault("propagation.integrator", f"{found.reason}.")], scene.source)
    return found


def _flight(model, position, velocity, breaks, factors, times):
    """States (6, n) at times (n,) s of a flight without events."""
    state, out = dop853.start(0.0, position, velocity, 1.0), np.empty((6, len(times)))
    dop853.advance(state, model, breaks, factors, happening.watch([]), times, out, times[-1], 1e-12, np.inf)
    return out
