"""Scene -> Plan: what a scene's words mean to the propagator.

A Model, an initial state, a schedule of thrust factors and a list of events; nothing is propagated here.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sailviz import elements as orbital
from sailviz import ephemeris, frames
from sailviz.constants import AU, DAY, J2_EARTH, MU_EARTH, MU_SUN, RADIUS_EARTH, RADIUS_SUN, STANDARD_GRAVITY
from sailviz.design import spirals
from sailviz.design.displaced import orbits as displaced
from sailviz.design.displaced.holding import Track
from sailviz.environment.sun import sun_parameters
from sailviz.errors import Fault, SceneError
from sailviz.propagate import dop853, dynamics
from sailviz.propagate import events as happening
from sailviz.propagate.callbacks import user_address
from sailviz.propagate.choice import Choice, choose
from sailviz.propagate.voltage_callback import R_REF, U_REF, WANTED, factor_plug
from sailviz.propulsion import electric_sail
from sailviz.propulsion.devices import sail
from sailviz.propulsion.solar_sail import FILMS, Film
from sailviz.run.arrays import Body
from sailviz.scene.loading import Scene
from sailviz.scene.sections import HELD_STARTS
from sailviz.simulation.low_orbit import brake_device, low_orbit_parts
from sailviz.simulation.thrust_history import Schedule, schedule
from sailviz.steering import attitude as law
from sailviz.steering import primers

if TYPE_CHECKING:
    from sailviz.simulation.first_order import FirstOrder
    from sailviz.simulation.quasi_circular import QuasiCircular

BODIES = {
    "sun": Body("Sun", MU_SUN, RADIUS_SUN),
    "earth": Body("Earth", MU_EARTH, RADIUS_EARTH),
}


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


def _custom_body(scene):
    return scene.body.name, scene.body.mu, scene.body.radius


def _identity(scene, **functions) -> str:
    """Hash of the scene and of the user's functions, each under the name of its part."""
    digest = hashlib.sha256(scene.identity().encode())
    for part, function in functions.items():
        if function is not None:
            digest.update(f"{part} {_written(function)}".encode())
    return digest.hexdigest()[:16]


def _written(function, seen=()) -> str:
    """What a user's function is made of: its code, its constants and what it takes from around it, functions too."""
    function = getattr(function, "py_func", getattr(function, "__wrapped__", function))
    code = getattr(function, "__code__", None)
    if isinstance(function, (int, float, complex, str, tuple, np.ndarray)):
        return repr(np.asarray(function).tolist())
    if code is None:
        return type(function).__name__
    if code in seen:
        return code.co_name
    around = {name: function.__globals__[name] for name in code.co_names if name in function.__globals__}
    around |= dict(zip(code.co_freevars, (cell.cell_contents for cell in function.__closure__ or ()), strict=True))
    names = [f"{name} = {_written(value, (*seen, code))}" for name, value in around.items()]
    return f"{code.co_code.hex()} {code.co_consts} {code.co_names} {names}"


def film_of(scene) -> Film:
    """Force coefficients of the scene's solar sail."""
    given = scene.device.film
    if isinstance(given, str):
        return FILMS[given]
    values = given.model_dump()
    return Film(**values) if "b1" in values else Film.from_optics(**values)


def _design(scene):
    """The closed form behind a start "on the designed orbit"; SceneError where it does not exist."""
    start = scene.start
    if start.kind in HELD_STARTS:
        device = "electric-sail" if scene.device.kind == "electric-sail" else film_of(scene)
        third = scene.environment.third_body
        if start.kind == "displaced":
            found = displaced.circular(start.radius, start.elevation, start.rate_ratio, device)
        elif start.kind == "heliostationary":
            found = displaced.heliostationary(start.radius, device)
        elif start.kind == "lagrange-point":
            planet = {} if third is None else {"planet_mu": third.mu, "planet_orbit": third.radius}
            found = displaced.lagrange_point(start.radius, device, **planet)
        else:
            return _track(scene, device)
    elif start.kind == "spiral":
        found = spirals.logarithmic(
            film_of(scene).lightness(sail_strength(scene, None)),
            scene.steering.pitch * np.sign(np.sin(scene.steering.clock)),
            film_of(scene),
        )
    else:
        return None
    if not found.feasible:
        raise SceneError([Fault("start", f"this orbit is infeasible: {found.reason}.")], scene.source)
    return found


TRACK_POINTS = 720  # of the steering table, per revolution: its cubic is then good to 1e-10


def _track(scene, device):
    """The Track of an elliptic displaced orbit over the whole run, at equal steps of true anomaly."""
    from sailviz.design.displaced import tracks as displaced_tracks

    start = scene.start
    if start.kind == "planet-following":
        a, e = start.semi_major_axis, start.eccentricity
        if start.planet is not None:
            a, e, *_ = (float(value[0]) for value in ephemeris.planet_elements(start.planet.capitalize(), 0.0))
        period = 2 * np.pi * np.sqrt(a**3 / MU_SUN)
    else:
        e = start.eccentricity
        period = 2 * np.pi * np.sqrt((start.semi_latus_rectum / (1 - e * e)) ** 3 / (start.mu_ratio * MU_SUN))
    turns = scene.propagation.duration / period + 1.1
    anomaly = start.true_anomaly + 2 * np.pi * np.arange(int(turns * TRACK_POINTS)) / TRACK_POINTS

    def track(nu):
        if start.kind == "planet-following":
            return displaced_tracks.planet_following(a, e, nu, start.elevation, start.radius_ratio, device)
        return displaced_tracks.flat_ellipse(start.semi_latus_rectum, e, nu, start.height, start.mu_ratio, device)

    found = track(anomaly)
    if not np.all(found.feasible):
        reason = track(anomaly[np.argmin(found.feasible)]).reason
        raise SceneError([Fault("start", f"this orbit is infeasible: {reason}.")], scene.source)
    return found


def _initial_state(scene, body, design):
    start = scene.start
    if start.kind in HELD_STARTS:
        if start.kind == "displaced":
            position, velocity = displaced.state(start.radius, start.elevation, start.rate_ratio, start.azimuth)
        elif start.kind == "heliostationary":
            position, velocity = displaced.state(start.radius, start.elevation, 0.0, start.azimuth)
        elif start.kind == "lagrange-point":
            third = scene.environment.third_body
            orbit, azimuth = (AU, 0.0) if third is None else (third.radius, third.azimuth)
            position, velocity = displaced.state(start.radius, 0.0, (start.radius / orbit) ** 1.5, azimuth)
        else:
            position, velocity = design.position[0], design.velocity[0]
        return position + start.position_offset, velocity + start.velocity_offset
    if start.kind == "cartesian":
        return np.array(start.position), np.array(start.velocity)
    if start.kind == "spiral":
        return design.state(start.radius, start.azimuth, body.mu)
    if start.kind == "circular":
        shape = (_circle(start, scene, body), 0.0, start.inclination, _node(scene), 0.0, start.argument_of_latitude)
    else:
        shape = (
            start.semi_major_axis,
            start.eccentricity,
            start.inclination,
            start.raan,
            start.argument,
            start.true_anomaly,
        )
    position, velocity = orbital.state(*shape, body.mu)
    if not np.isfinite(position).all() or np.linalg.norm(position) <= body.radius:
        raise SceneError([Fault("start", f"this point is not above the surface of the {body.name}.")], scene.source)
    return position, velocity


def _circle(start, scene, body) -> float:
    """Radius, m, of a circular start; for a mean altitude the one whose mean semi-major axis lies there."""
    if start.radius is not None:
        return start.radius
    if start.mean_altitude is None:
        return body.radius + start.altitude
    return orbital.osculating_radius(
        body.radius + start.mean_altitude,
        start.inclination,
        start.argument_of_latitude,
        J2_EARTH * RADIUS_EARTH**2 if scene.environment.j2 else 0.0,
    )


def _node(scene) -> float:
    """Right ascension of the ascending node, rad, from itself or from the local time of passing it."""
    start = scene.start
    if start.ltan is None:
        return start.raan or 0.0
    sun = sun_parameters(epoch_of(scene), scene.environment.sun_right_ascension or 0.0)
    return float(np.remainder(sun[0] + 2 * np.pi * (start.ltan / DAY - 0.5), 2 * np.pi))


def _sail_name(scene):
    """The scene's sail as design functions take it: a Film, or the name of an E-sail model."""
    if scene.device.kind == "solar-sail":
        return film_of(scene)
    return "electric-sail" if scene.device.model == "final" else f"electric-sail-{scene.device.model}"


def sail_strength(scene, design) -> float:
    """Characteristic acceleration, m/s2, of either sail."""
    device = scene.device
    if device.characteristic_acceleration == "as designed":
        return float(np.max(design.characteristic_acceleration))  # of a track: at full throttle
    if device.characteristic_acceleration is not None:
        return device.characteristic_acceleration
    if device.kind == "electric-sail":
        return float(
            electric_sail.characteristic_acceleration(
                device.tethers,
                device.tether_length,
                device.voltage,
                device.mass,
                device.wind_pressure,
                device.wind_potential,
            )
        )
    return film_of(scene).characteristic_acceleration(
        lightness=device.lightness_number, area=device.area, mass=device.mass
    )


def _device(scene, design):
    """(id, parameters) for the right-hand side."""
    device = scene.device
    if device.kind == "solar-sail":
        film = film_of(scene)
        strength = sail_strength(scene, design) * AU**2 / film.total
        return dynamics.SOLAR_SAIL, (strength, film.b1, film.b2, film.b3)
    if device.kind == "electric-sail":
        model = electric_sail.MODELS[device.model]
        return dynamics.ELECTRIC_SAIL, (sail_strength(scene, design), model, device.pitch_limit)
    if device.kind == "plasma-brake":
        return dynamics.PLASMA_BRAKE, brake_device(scene)
    if device.kind == "thruster":
        size = device.thrust if device.thrust is not None else device.acceleration
        exhaust = device.specific_impulse
        inverse = 0.0 if exhaust is None else 1.0 / (STANDARD_GRAVITY * exhaust)
        return dynamics.THRUSTER, (size, float(device.thrust is not None), inverse)
    return dynamics.NO_DEVICE, ()


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


def third_body(scene):
    third = scene.environment.third_body
    if third is None:
        return ()
    return third.mu, third.radius, np.sqrt(MU_SUN / third.radius**3), third.azimuth


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


_SENSE = {"up": 1, "down": -1, "both": 0}


def _watched(scene, body):
    """Names and Watch of the scene's events and of those that come with a device."""
    names, rows = [], []
    for event in scene.event:
        sense = _SENSE[event.sense]
        kind = {"radius": happening.RADIUS, "altitude": happening.RADIUS, "node": happening.NODE}.get(event.kind)
        level = event.radius or (body.radius + event.altitude if event.altitude else 0.0)
        if event.kind == "mean-altitude":
            kind = happening.MEAN_AXIS if scene.environment.j2 else happening.AXIS
        elif event.kind == "escape":
            kind, sense = happening.ENERGY, 1
        elif event.kind in ("periapsis", "apoapsis"):
            kind, sense = happening.APSIS, 1 if event.kind == "periapsis" else -1
        names.append(event.name or event.kind)
        rows.append((kind, level, sense, happening.STOP if event.stop else happening.RECORD))
    if scene.device.kind == "plasma-brake":
        names.append("brake off")
        rows.append((happening.RADIUS, body.radius + scene.device.off_below, -1, happening.END_OF_USE))
    return tuple(names), happening.watch(rows)


def _approximations(scene, body, position, velocity, design) -> dict[str, FirstOrder]:
    """The analytic trajectories that a scene wants recorded beside its own."""
    wanted = [item for item in scene.approximation if item.kind == "first-order"]
    if not wanted:
        return {}
    from sailviz.simulation.first_order import FirstOrder

    r0, mu = float(np.linalg.norm(position)), body.mu
    device, steering = scene.device, scene.steering
    law = steering.kind if steering is not None else "radial"
    pitch = steering.pitch * np.sign(np.sin(steering.clock)) if law == "orbital" else 0.0
    if device.kind == "thruster":
        size = device.acceleration * r0**2 / mu
        if law == "circumferential":
            pitch = np.pi / 2
        thrust = (size * np.cos(pitch), size * np.sin(pitch), 0)
    else:
        from sailviz.design.asymptotic import solution as asymptotic

        shape = "electric-sail" if device.kind == "electric-sail" else film_of(scene)
        thrust = asymptotic.thrust(shape, sail_strength(scene, design), pitch, r0, mu)
    return {
        item.name: FirstOrder(
            position, velocity, mu, scene.propagation.duration, thrust, item.leg, item.scheme, scene.source
        )
        for item in wanted
    }


def _quasi_circular(scene, position, velocity) -> QuasiCircular | None:
    """The analytic decay that a scene wants recorded beside its own."""
    if all(item.kind != "quasi-circular" for item in scene.approximation):
        return None
    from sailviz.simulation.quasi_circular import QuasiCircular

    return QuasiCircular(scene, position, velocity)


def epoch_of(scene) -> np.datetime64 | None:
    return None if scene.epoch_utc is None else np.datetime64(scene.epoch_utc, "ns")
