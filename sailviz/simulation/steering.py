"""What a scene says of its steering, as numbers of the right-hand side."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sailviz import frames
from sailviz.constants import AU, MU_SUN
from sailviz.design.displaced.holding import Track
from sailviz.errors import Fault, SceneError
from sailviz.propulsion.devices import sail
from sailviz.steering import attitude as law
from sailviz.steering import primers

if TYPE_CHECKING:
    pass
from sailviz.simulation.device import _sail_name, sail_strength


def _steering(scene, design, position, velocity):
    """(id, parameters, table or None, interpolation) for the right-hand side, and (time s, "thrust on" | "thrust off")
    of every switch."""
    steering = scene.steering
    plain = (None, law.LINEAR, ())
    if steering is None or scene.device.kind == "plasma-brake":  # a tether's attitude is among its device's numbers
        return law.RADIAL, (), *plain
    if steering.kind == "as designed" and isinstance(design, Track):
        table = law.table(design.time - design.time[0], design.pitch, np.unwrap(design.clock), design.throttle, "cubic")
        return law.TABLE_ORBITAL, (), table, law.CUBIC, ()
    if steering.kind == "as designed":
        if np.ndim(design.pitch) == 0 and design.pitch == 0:  # Sun-facing needs no orbit plane, and may have none
            return law.RADIAL, (), *plain
        return law.ORBITAL, law.direction_parameters(float(design.pitch), float(design.clock)), *plain
    if steering.kind == "table":
        table = law.table(steering.time, steering.pitch, steering.clock, steering.throttle, steering.interpolation)
        kind = law.TABLE_ORBITAL if steering.frame == "orbital" else law.TABLE_MERIDIAN
        return kind, (), table, law.INTERPOLATIONS[steering.interpolation], _throttled(steering)
    if steering.kind == "optimal":
        from sailviz.simulation.optimal_steering import primer_table

        sail_of_law = steering.reckons_with or _sail_name(scene)
        table, switches = primer_table(scene, position, velocity, sail_of_law, sail_strength(scene, design))
        # the times of another sail's switches are not quite those of this flight
        return law.PRIMER, (), table, law.CUBIC, switches if steering.reckons_with is None else ()
    if steering.kind == "smoothed-transfer":
        return law.TABLE_ORBITAL, (), _smoothed_table(scene), law.HOLD, ()
    if steering.kind == "locally-optimal":
        return law.LOCAL, (primers.GOALS[steering.goal], 1.0 if steering.sense == "increase" else -1.0), *plain
    if steering.kind == "lyapunov":
        return law.LYAPUNOV, (), _lyapunov_row(steering), law.LINEAR, ()
    if steering.kind == "inertial":
        return law.INERTIAL, tuple(frames.unit(steering.direction)), *plain
    if steering.kind in ("orbital", "meridian"):
        return law.LAWS[steering.kind], law.direction_parameters(steering.pitch, steering.clock), *plain
    return law.LAWS[steering.kind], (), *plain


def _throttled(steering):
    """(time s, word) of every row at which a table's throttle leaves 0 or comes to it."""
    on = np.array(steering.throttle or [1.0]) > 0
    rows = np.nonzero(on[1:] != on[:-1])[0] + 1
    return tuple((steering.time[i], "thrust on" if on[i] else "thrust off") for i in rows if steering.time[i] > 0)


def _smoothed_table(scene):
    """The steering table of a smoothed transfer from the start's circle; off once it has arrived."""
    from sailviz.design.minimum_time.smoothed import smoothed_transfer

    steering, r0, strength = scene.steering, scene.start.radius, sail_strength(scene, None)
    clock = np.sqrt(r0**3 / MU_SUN)
    found = smoothed_transfer(
        steering.radius / r0,
        strength * (AU / r0) * r0**2 / MU_SUN,
        np.array(steering.costates),
        scene.propagation.duration / clock,
        steering.hold / clock,
        steering.width,
    )
    if not found.residual < 1e-6:
        words = (
            f"the shooting did not converge (it misses the circle by {found.residual:.1g}): begin from other costates"
        )
        raise SceneError([Fault("steering.costates", f"{words}, or with another duration.")], scene.source)
    steps = len(found.pitch)
    time = found.time * clock / steps * np.arange(steps + 1)
    pitch, throttle = np.append(found.pitch, 0.0), np.append(found.throttle, 0.0)
    return law.table(time, pitch, np.full(steps + 1, np.pi / 2), throttle, "hold")


def _lyapunov_row(steering):
    """Targets, weights, scales and nearness of the law, as `primers.lyapunov_primer` reads them."""
    a, e = steering.semi_major_axis, steering.eccentricity
    longitude, tangent = steering.raan + steering.argument, np.tan(steering.inclination / 2)
    p = a * (1 - e * e)
    target = (p, e * np.cos(longitude), e * np.sin(longitude))
    target += (tangent * np.cos(steering.raan), tangent * np.sin(steering.raan))
    return np.array([*target, *steering.weights, p, 1.0, 1.0, 1.0, 1.0, steering.within**2])


def _primer_law(scene, law_id, device, device_parameters):
    """Keywords of `dynamics.model` for a law that follows a primer."""
    if law_id not in (law.PRIMER, law.LOCAL, law.LYAPUNOV):
        return {}
    from sailviz.propagate.primer_callback import normal_plug

    other = scene.steering.reckons_with
    kind, parameters = (device, device_parameters) if other is None else sail(other, 1.0)
    return {"steer_as": (kind, *parameters), "primer_kind": law_id, "primer_law": normal_plug()}
