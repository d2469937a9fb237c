"""What each row of a run says of a craft that turns, and of one that stands as prescribed the torque that it takes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sailviz import frames
from sailviz.propagate.body_motion import AVERAGED, RATE, SLIDE, WHEELS, Q
from sailviz.simulation.lowered import Array, Columns
from sailviz.simulation.mass_properties import mass_properties

if TYPE_CHECKING:
    from sailviz.run.arrays import Event
    from sailviz.simulation.plan import Plan
    from sailviz.simulation.turning import TurningPlan

AxesAt = Callable[[Array, Array], Array]  # of times (n,) s and states (7, n)
APART = 1e-3  # of a radian along the orbit: the step of differences that tell how a prescribed attitude turns


class Turned(NamedTuple):
    """Rows of a craft that turns."""

    axes: Array  # (n, 3, 3) of the body, as columns
    acceleration: Array  # (n, 3) m/s2 of light and actuators, inertial
    motion: Columns  # columns of the attitude
    columns: Columns  # of the environment: torques along the body's axes, what actuators are set to


def turned_rows(p: Plan, craft: TurningPlan, time: Array, states: Array, factor: Array) -> Turned:
    """Of states (SIZE, n) at times (n,) s."""
    from sailviz.propagate import body_observe as observed  # machine code that other flights do without

    body, names = craft.body, craft.turning.names
    values = observed.observe_body(time, states, factor, p.model.parameters, len(names))
    averaged = body.motion == AVERAGED
    if averaged:
        orbit = frames.rtn(states[:3].T, states[3:6].T)
        axes = frames.body_axes(states[Q : Q + 3].T, orbit[..., 1])
    else:
        axes = frames.rotation(frames.unit(states[Q : Q + 4].T))

    def along_body(first: int) -> Array:
        given = values[:, first : first + 3]
        return frames.to_frame(axes, given) if averaged else given

    rate, wheels = states[RATE : RATE + 3].T.copy(), states[WHEELS : WHEELS + 3].T.copy()
    inertia = np.array(
        [[body.xx, body.xy, body.xz], [body.xy, body.yy, body.yz], [body.xz, body.yz, body.zz]],
    )
    momentum = frames.from_frame(axes, rate @ inertia + wheels)
    motion = {"rate_rad_s": rate, "angular_momentum_N_m_s": momentum}
    if body.wheel_torque > 0 or np.any(craft.motion[WHEELS - Q : WHEELS - Q + 3]):
        motion["wheels_N_m_s"] = wheels
    columns: Columns = {}
    if body.lit:
        columns |= by_axis("light_torque", along_body(observed.LIGHT_TORQUE))
    if body.air:
        force, drag = values[:, observed.AIR_FORCE : observed.AIR_FORCE + 3], values[:, observed.AIR_DRAG].copy()
        columns |= {"air_density_kg_m3": values[:, observed.AIR_DENSITY].copy(), "air_drag_N": drag}
        columns["air_lift_N"] = np.sqrt(np.maximum(0.0, np.sum(force * force, axis=1) - drag * drag))
        columns |= by_axis("air_torque", along_body(observed.AIR_TORQUE))
    if body.gradient:
        columns |= by_axis("gravity_torque", along_body(observed.GRAVITY_TORQUE))
    if craft.turning.rows or body.wheel_torque > 0 or body.slide_share > 0:
        columns |= by_axis("control_torque", along_body(observed.CONTROL_TORQUE))
    if body.slide_share > 0:
        columns |= {"slide_x_m": states[SLIDE].copy(), "slide_y_m": states[SLIDE + 1].copy()}
    columns |= {name: values[:, observed.SETTINGS + i].copy() for i, name in enumerate(names)}
    force = values[:, observed.FORCE : observed.FORCE + 3]
    push = (force if averaged else frames.from_frame(axes, force)) / p.masses(states)[:, None]
    return Turned(axes, push, motion, columns)


def by_axis(name: str, vectors: Array) -> Columns:
    """Columns (n,) N m of vectors (n, 3)."""
    return {f"{name}_{axis}_N_m": vectors[:, i].copy() for i, axis in enumerate("xyz")}


class Load(NamedTuple):
    """What light or air does in each row: force (n, 3) N in space, torque (n, 3) N m along the body's axes, about the
    origin of its shape."""

    force: Array
    torque: Array


def torque_needed(p: Plan, time: Array, states: Array, axes_at: AxesAt, push: Array, loads: list[Load]) -> Columns:
    """Torque about the centre of mass, N m along the body's axes, that holding the prescribed attitude takes:
    I w' + w x I w less what light, air and gravity give. Turning is told by differences to either side; NaN where the
    steering jumps there. axes_at : the body's axes (n, 3, 3) at times (n,) and states (7, n); push (n, 3) m/s2 of the
    device; loads : of light and air, where they push a shape."""
    inertia, centre = mass_properties(p.scene)
    x, v = states[:3].T, states[3:6].T
    r, mu = np.linalg.norm(x, axis=1)[:, None], p.body.mu
    a = push - mu * x / r**3
    jerk = -mu * (v / r**3 - 3 * np.sum(x * v, axis=1)[:, None] * x / r**5)
    h = APART * r / np.maximum(np.linalg.norm(v, axis=1)[:, None], np.sqrt(mu / r))
    now, turns = axes_at(time, states), []
    for step in (h, -h):
        place = x + step * (v + step * (a / 2 + step * jerk / 6))
        speed = v + step * (a + step * jerk / 2)
        there = axes_at(time + step[:, 0], np.vstack([place.T, speed.T, states[6:7]]))
        turns.append(rotation_vector(np.swapaxes(now, 1, 2) @ there))
    ahead, behind = turns
    jumps = np.maximum(np.linalg.norm(ahead, axis=1), np.linalg.norm(behind, axis=1)) > 100 * APART
    rate, change = (ahead - behind) / (2 * h), (ahead + behind) / h**2
    torque = change @ inertia + np.cross(rate, rate @ inertia)
    for load in loads:
        torque -= load.torque - np.cross(centre, frames.to_frame(now, load.force))
    section = p.scene.attitude
    if section is not None and section.gravity_gradient:
        up = frames.to_frame(now, x / r)
        torque -= 3 * mu / r**3 * np.cross(up, up @ inertia)
    torque[jumps] = np.nan
    return by_axis("control_torque_needed", torque) | {"prescribed_rate_rad_s": np.where(jumps[:, None], np.nan, rate)}


def rotation_vector(turn: Array) -> Array:
    """Axis times angle (n, 3), rad, of rotations (n, 3, 3)."""
    twice = np.stack([turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]], -1)
    sine = np.linalg.norm(twice, axis=1) / 2
    angle = np.arctan2(sine, (np.trace(turn, axis1=1, axis2=2) - 1) / 2)
    return np.asarray(twice * np.where(sine > 1e-12, angle / np.maximum(2 * sine, 1e-300), 0.5)[:, None])


def has_tumbled(state: Any) -> bool:
    """Whether a craft that turns has turned its back."""
    from sailviz.propagate.body_steps import TUMBLED

    return bool(state.counter[TUMBLED])


def tumbled_once(state: Any, events: list[Event]) -> list[Event]:
    """The events but for tumbling that is not the first: a craft that has turned its back goes on tumbling."""
    from sailviz.propagate.body_steps import TUMBLED

    kept = []
    for event in events:
        if event.name == "tumbling":
            if state.counter[TUMBLED]:
                continue
            state.counter[TUMBLED] = 1
        kept.append(event)
    return kept
