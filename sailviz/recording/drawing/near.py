"""The frame of the close-up, and what acts on the craft in it.

Where the light is at the centre it is the orbital frame: x from the central body, y transverse, z along the orbit's
normal. Where it is elsewhere x is the line of the light, z as near to the pole of the run's frame as it can be.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailviz.frames import body_axes, rotation, rtn, stance, to_frame, unit
from sailviz.recording.drawing.samples import Samples

LIGHTS = ("Sun", "light")  # names of the bodies that shine


@dataclass(frozen=True)
class Near:
    """Directions in the frame of the close-up, (n, 3) each; thrust m/s2, primer None where there is none."""

    normal: np.ndarray
    body: np.ndarray  # (n, 3, 3) the craft's own axes, columns
    thrust: np.ndarray
    velocity: np.ndarray  # unit vector, zero where the craft stands still
    primer: np.ndarray | None
    devices: dict[str, np.ndarray]  # name of each device of a list -> its share of the thrust, m/s2
    by_light: bool  # x is the line of the light


def near_of(samples: Samples, sail: bool, sun: bool) -> Near:
    """sail : whether light or wind pushes the craft; sun : whether the central body is the Sun."""
    run = samples.run
    light = next((run.bodies[name] for name in LIGHTS if name in run.bodies), None)
    if sun or not sail or light is None:
        alone = sail and light is None  # an own star, at the centre
        body = axes_rtn(samples)
        parts = (samples.normal_rtn, body, samples.thrust_rtn, samples.velocity_rtn, samples.primer_rtn)
        shares = {name: device.acceleration_rtn for name, device in run.devices.items()}
        return Near(*parts, devices=shares, by_light=sun or alone)
    axes = light_axes(run.position - light)
    moving = np.any(samples.velocity_rtn, axis=1, keepdims=True)
    primer, orbital = run.environment.get("primer_direction"), rtn(run.position, run.velocity)
    body = body_axes(stance(orbital, run.attitude.normal), orbital[..., 1])
    if is_given(samples):
        body = rotation(run.attitude.quaternion)
    return Near(
        to_frame(axes, run.attitude.normal),
        np.swapaxes(axes, -1, -2) @ body,
        to_frame(axes, run.thrust.acceleration),
        np.where(moving, to_frame(axes, unit(run.velocity)), 0.0),
        None if primer is None else to_frame(axes, primer),
        {name: to_frame(axes, device.acceleration) for name, device in run.devices.items()},
        by_light=True,
    )


def is_given(samples: Samples) -> bool:
    """Whether the craft's attitude came with the arrays, is that of a shape, or moves by itself: rolled about its
    normal in a way of its own."""
    setting = samples.run.setting
    given = setting.resolved.get("attitude") == "given" or bool(setting.craft.shape)
    return given or bool(samples.run.attitude.motion)


def axes_rtn(samples: Samples) -> np.ndarray:
    """The craft's own axes (n, 3, 3), columns, in the orbital frame: x as near to the direction of flight as it can be,
    or as given."""
    if is_given(samples):
        orbital = rtn(samples.run.position, samples.run.velocity)
        turned: np.ndarray = np.swapaxes(orbital, -1, -2) @ rotation(samples.run.attitude.quaternion)
        return turned
    return body_axes(samples.stance_rtn, np.tile([0.0, 1.0, 0.0], (len(samples), 1)))


def light_axes(line: np.ndarray) -> np.ndarray:
    """Axes (n, 3, 3), columns, about lines (n, 3) from the light to the craft: x along them, z towards the pole."""
    x = unit(line)
    pole = np.where(np.abs(x[:, 2:]) < 0.999, [0.0, 0.0, 1.0], [0.0, 1.0, 0.0])
    y = unit(np.cross(pole, x))
    return np.stack([x, y, np.cross(x, y)], axis=-1)
