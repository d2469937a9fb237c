"""What a scene says of its steering: one record for each kind, keyed by the class of its section.

A new law: its formula in sailviz/steering, its section in scene/steering.py, its record here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

import numpy as np

from sailviz import elements as orbital
from sailviz import frames
from sailviz.constants import AU, MU_SUN
from sailviz.design.displaced.holding import Track
from sailviz.errors import Fault, SceneError
from sailviz.propagate.dynamics import Model
from sailviz.propagate.primer_callback import observe_primer, observe_throttle, primer_steering
from sailviz.propagate.sky_callback import observe_sky_primer
from sailviz.propulsion import plasma_brake
from sailviz.propulsion.devices import SOLAR_SAIL, sail
from sailviz.propulsion.film_ageing import coolness
from sailviz.scene.device import SolarSail
from sailviz.scene.start import CircularStart
from sailviz.scene.steering import (
    FrameSteering,
    InertialSteering,
    LocalSteering,
    LyapunovSteering,
    OnOffSteering,
    OptimalSteering,
    PlainSteering,
    PrimerSteering,
    SmoothedSteering,
    SpinningSteering,
    SunFrameSteering,
    TableSteering,
)
from sailviz.scene.values import Section
from sailviz.simulation.film import irradiance_of, optics
from sailviz.simulation.lowered import (
    Array,
    Columns,
    Flight,
    LoweredSteering,
    Switches,
    Words,
    no_columns,
    no_words,
)
from sailviz.steering import attitude, by_light, primers
from sailviz.words import angle

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

S = TypeVar("S", bound=Section)
SPIN_AXES = {"along-track": 0.0, "across-track": np.pi / 2}  # rad between the velocity and the plane of spin


class Tether(NamedTuple):
    """How a plasma brake's tether lies."""

    attitude: int = plasma_brake.VERTICAL
    spin_factor: float = 1.0  # mean force of a spinning tether over that of one across the flow
    spin: str = ""  # the plane in which it spins


def _hanging(steering: Section) -> Tether:
    return Tether()


def _no_target(steering: Section) -> orbital.Elements | None:
    return None


@dataclass(frozen=True)
class Steering(Generic[S]):
    """A kind of steering."""

    lower: Callable[[S, Flight], LoweredSteering]
    words: Callable[[S, Any], Words] = no_words  # from the section and the scene's design
    watches: Callable[[Model, Array, Array], Columns] = no_columns  # at times (n,) s and states (7, n)
    tether: Callable[[S], Tether] = _hanging
    target: Callable[[S], orbital.Elements | None] = _no_target  # the orbit that a law steers towards


# ---------------------------------------------------------------- laws without parameters, and as designed
def _plain(steering: PlainSteering, flight: Flight) -> LoweredSteering:
    if steering.kind != "as designed":
        return LoweredSteering(attitude.LAWS[steering.kind])
    design = flight.design
    if isinstance(design, Track):
        time, clock = design.time - design.time[0], np.unwrap(design.clock)
        table = attitude.table(time, design.pitch, clock, design.throttle, "cubic")
        return LoweredSteering(attitude.TABLE_ORBITAL, table=table, interpolation=attitude.CUBIC)
    if np.ndim(design.pitch) == 0 and design.pitch == 0:  # Sun-facing needs no orbit plane, and may have none
        return LoweredSteering()
    direction = attitude.direction_parameters(float(design.pitch), float(design.clock))
    return LoweredSteering(attitude.ORBITAL, direction)


def _plain_words(steering: PlainSteering, design: Any) -> Words:
    if steering.kind != "as designed" or getattr(design.pitch, "ndim", 0) != 0:
        return []
    return [("pitch", angle(float(design.pitch)))]


def _plain_tether(steering: PlainSteering) -> Tether:
    return Tether(plasma_brake.TILTED if steering.kind == "gravity-gradient" else plasma_brake.VERTICAL)


def _spinning_tether(steering: SpinningSteering) -> Tether:
    factor = float(plasma_brake.spin_factor(SPIN_AXES[steering.plane]))
    return Tether(plasma_brake.SPINNING, factor, steering.plane)


# ---------------------------------------------------------------- fixed angles, and tables of them
def _frame(steering: FrameSteering, flight: Flight) -> LoweredSteering:
    direction = attitude.direction_parameters(steering.pitch, steering.clock)
    return LoweredSteering(attitude.LAWS[steering.kind], direction)


def _sun_frame(steering: SunFrameSteering, flight: Flight) -> LoweredSteering:
    c = attitude.direction_parameters(steering.pitch, steering.clock)
    by_orbit = int(steering.reference == "orbit")
    law = by_light.Parameters(by_light.FRAME, float(c.radial), float(c.transverse), float(c.normal), by_orbit=by_orbit)
    return LoweredSteering(attitude.CALLED, by_light=law)


def _on_off(steering: OnOffSteering, flight: Flight) -> LoweredSteering:
    return LoweredSteering(attitude.CALLED, by_light=by_light.Parameters(by_light.ON_OFF))


def _inertial(steering: InertialSteering, flight: Flight) -> LoweredSteering:
    return LoweredSteering(attitude.INERTIAL, attitude.Inertial(*frames.unit(steering.direction)))


def _table(steering: TableSteering, flight: Flight) -> LoweredSteering:
    time = np.asarray(steering.time, dtype=float) + flight.begin
    rows = attitude.table(time, steering.pitch, steering.clock, steering.throttle, steering.interpolation)
    kind = attitude.TABLE_ORBITAL if steering.frame == "orbital" else attitude.TABLE_MERIDIAN
    interpolation = attitude.INTERPOLATIONS[steering.interpolation]
    return LoweredSteering(kind, table=rows, interpolation=interpolation, switches=_throttled(steering, flight.begin))


def _throttled(steering: TableSteering, begin: float) -> Switches:
    """(time s, word) of every row at which a table's throttle leaves 0 or comes to it."""
    on = np.array(steering.throttle or [1.0]) > 0
    rows = np.nonzero(on[1:] != on[:-1])[0] + 1
    words = ("thrust off", "thrust on")
    return tuple((begin + steering.time[i], words[int(on[i])]) for i in rows if steering.time[i] > 0)


# ---------------------------------------------------------------- towards a primer
def _towards_primer(
    steering: PrimerSteering, flight: Flight, lowered: LoweredSteering, cool: float = 0.0
) -> LoweredSteering:
    """A law that follows a primer, and the sail with which it reckons; cool : coolness as of `canonical_sail`."""
    other = steering.reckons_with
    kind, numbers = (flight.device.kind, flight.device.parameters) if other is None else sail(other, 1.0)
    steer_as = (kind, (*numbers, cool / AU**2) if kind == SOLAR_SAIL else numbers)
    return lowered._replace(steer_as=steer_as, primer_kind=lowered.kind, callback=primer_steering())


def _coolness(steering: OptimalSteering, scene: Scene) -> float:
    """Largest cosine of the pitch at 1 au that keeps the film below the steering's limit; 0 without one."""
    if steering.hottest is None:
        return 0.0
    assert isinstance(scene.device, SolarSail)  # or the scene would not have been accepted
    return coolness(steering.hottest, optics(scene.device), irradiance_of(scene))


def _optimal(steering: OptimalSteering, flight: Flight) -> LoweredSteering:
    from sailviz.simulation.optimal_steering import primer_table

    sail_of_law, cool = steering.reckons_with or flight.sail, _coolness(steering, flight.scene)
    rows, switches, breaks, phases = primer_table(
        flight.scene, flight.position, flight.velocity, sail_of_law, flight.strength, flight.begin, cool
    )
    # the times of another sail's switches are not quite those of this flight
    switches = switches if steering.reckons_with is None else ()
    lowered = LoweredSteering(
        attitude.PRIMER, table=rows, interpolation=attitude.CUBIC, switches=switches, breaks=breaks, phases=phases
    )
    lowered = _towards_primer(steering, flight, lowered, cool)
    return lowered if steering.arcs is None else lowered._replace(primer_kind=attitude.ARCS)


def _local(steering: LocalSteering, flight: Flight) -> LoweredSteering:
    sense = 1.0 if steering.sense == "increase" else -1.0
    lowered = LoweredSteering(attitude.LOCAL, attitude.Local(primers.GOALS[steering.goal], sense))
    return _towards_primer(steering, flight, lowered)


def _lyapunov(steering: LyapunovSteering, flight: Flight) -> LoweredSteering:
    """Targets, weights, scales and nearness of the law, as `primers.lyapunov_primer` reads them."""
    a, e = steering.semi_major_axis, steering.eccentricity
    longitude, tangent = steering.raan + steering.argument, np.tan(steering.inclination / 2)
    p = a * (1 - e * e)
    shape = (p, e * np.cos(longitude), e * np.sin(longitude))
    plane = (tangent * np.cos(steering.raan), tangent * np.sin(steering.raan))
    rows = np.array([*shape, *plane, *steering.weights, p, 1.0, 1.0, 1.0, 1.0, steering.within**2])
    return _towards_primer(steering, flight, LoweredSteering(attitude.LYAPUNOV, table=rows))


def _lyapunov_target(steering: LyapunovSteering) -> orbital.Elements:
    s = steering
    numbers = (s.semi_major_axis, s.eccentricity, s.inclination, s.raan, s.argument, 0.0)
    return orbital.Elements(*map(np.float64, numbers))


def _primer_columns(model: Model, time: Array, states: Array) -> Columns:
    """The primer's direction, and the thrust that the law expects along it as a share of the full one."""
    follows = observe_sky_primer if model.named.by_light.law == by_light.PRIMER else observe_primer
    direction, support = follows(time, states, model.parameters)
    columns = {"primer_direction": direction, "switching_function": support}
    if model.parameters["primer"]["kind"][0] == attitude.ARCS:
        columns["throttle"] = observe_throttle(time, model.parameters)
    return columns


def _smoothed(steering: SmoothedSteering, flight: Flight) -> LoweredSteering:
    """A smoothed transfer from the start's circle; off once it has arrived."""
    from sailviz.design.minimum_time.smoothed import smoothed_transfer

    scene, start = flight.scene, flight.scene.start
    assert isinstance(start, CircularStart)  # these three, or the scene would not have been accepted
    assert start.radius is not None
    assert flight.strength is not None
    r0 = start.radius
    clock = np.sqrt(r0**3 / MU_SUN)
    found = smoothed_transfer(
        steering.radius / r0,
        flight.strength * (AU / r0) * r0**2 / MU_SUN,
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
    rows = attitude.table(time, pitch, np.full(steps + 1, np.pi / 2), throttle, "hold")
    return LoweredSteering(attitude.TABLE_ORBITAL, table=rows, interpolation=attitude.HOLD)


STEERINGS: dict[type[Section], Steering[Any]] = {  # the functions of each record take the class that it stands under
    PlainSteering: Steering[PlainSteering](_plain, words=_plain_words, tether=_plain_tether),
    SpinningSteering: Steering[SpinningSteering](lambda steering, flight: LoweredSteering(), tether=_spinning_tether),
    FrameSteering: Steering[FrameSteering](_frame, words=lambda steering, design: [("pitch", angle(steering.pitch))]),
    SunFrameSteering: Steering[SunFrameSteering](
        _sun_frame, words=lambda steering, design: [("pitch", angle(steering.pitch)), ("clock", angle(steering.clock))]
    ),
    OnOffSteering: Steering[OnOffSteering](_on_off),
    InertialSteering: Steering[InertialSteering](_inertial),
    TableSteering: Steering[TableSteering](_table),
    OptimalSteering: Steering[OptimalSteering](_optimal, watches=_primer_columns),
    SmoothedSteering: Steering[SmoothedSteering](_smoothed),
    LocalSteering: Steering[LocalSteering](_local, watches=_primer_columns),
    LyapunovSteering: Steering[LyapunovSteering](_lyapunov, watches=_primer_columns, target=_lyapunov_target),
}
NO_STEERING = Steering[Any](lambda steering, flight: LoweredSteering())  # a sail faces the Sun, a tether hangs


def steering_of(steering: Section | None) -> Steering[Any]:
    """The record of a scene's steering, or that of having none."""
    return NO_STEERING if steering is None else STEERINGS[type(steering)]
