"""Whether a craft begins outside the body, in a frame that its steering can use, with mass enough for its thruster."""

from __future__ import annotations

from math import hypot, isfinite
from typing import TYPE_CHECKING

from sailviz.constants import STANDARD_GRAVITY
from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.conflicts.records import device_of, start_of, steering_of
from sailviz.scene.conflicts.start_points import has_plane, radius_of_body
from sailviz.scene.device import Thruster
from sailviz.scene.phases import Phase, StateOfOne, Until, steering_of_first, until_of
from sailviz.scene.start import DisplacedStart
from sailviz.scene.steering import Steering, TableSteering
from sailviz.words import duration, length

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

Burn = tuple[float, float, float, float]  # from s, to s, throttle at either end
LARGEST_RATIO = 300.0  # ln of the largest ratio of masses of a run at constant acceleration: 10^130


def outside_the_body(scene: Scene) -> Faults:
    """A craft begins above the surface."""
    point, radius = start_of(scene).point(scene, scene.start), radius_of_body(scene)
    if point is None:
        return []
    r = hypot(*point)
    if not isfinite(r):
        return [("start", "this point lies beyond all numbers")]
    if r > radius:
        return []
    if radius == 0:
        return [("start", "this point is the centre of the body, where its pull is infinite")]
    below = "on the surface" if r == radius else f"{length(radius - r)} below the surface"
    return [
        ("start", f"this point is {below} of the body, {length(r)} from its centre; its radius is {length(radius)}")
    ]


def frame_of_steering(scene: Scene) -> Faults:
    """A craft begins where the frame of its steering is defined."""
    point = start_of(scene).point(scene, scene.start)
    if point is None:
        return []
    velocity, word = start_of(scene).velocity(scene, scene.start), _frame(scene)
    if word == "meridian" and hypot(point[0], point[1]) <= 1e-14 * hypot(*point):
        return [("steering", "on the polar axis there is no meridian, so that this steering is undefined at the start")]
    if velocity is None:
        return []
    at_rest = hypot(*velocity) == 0
    moves = "is at rest" if at_rest else "moves along its radius"
    if word == "orbital" and not has_plane(point, velocity):
        what = f"the craft {moves}: without angular momentum the orbital frame, in which this steering counts, is"
        return [("steering", f'{what} undefined at the start; "sun-facing", "meridian" or "inertial" need none')]
    if word == "velocity" and at_rest:
        return [("steering", "the craft is at rest: the direction of its velocity is undefined at the start")]
    if device_of(scene).tether and at_rest:
        return [("start.velocity", "a plasma brake brakes a craft that moves: this one is at rest")]
    return []


def _frame(scene: Scene) -> str:
    """In which the scene's steering counts its angles; that of a designed orbit is the orbital one."""
    fits = steering_of(scene)
    if fits.as_designed:
        return "orbital" if isinstance(scene.start, DisplacedStart) and abs(scene.start.elevation) < 1.57 else ""
    return "" if scene.steering is None else fits.frame(scene.steering)


def propellant(scene: Scene) -> Faults:
    """A thruster does not burn more than there is."""
    device, end = scene.device, scene.propagation.duration
    if not isinstance(device, Thruster) or device.specific_impulse is None or scene.beside:
        return []  # of several devices all have to be asked: see hybrids
    exhaust, burns = STANDARD_GRAVITY * device.specific_impulse, burns_of(scene)
    if device.thrust is None:  # the thrust falls with the mass: an exponential, which has no end
        on = _impulse(burns, end)
        if (device.acceleration or 0.0) * on < LARGEST_RATIO * exhaust:
            return []
        return [("device.specific_impulse", "at this acceleration nothing of the mass is left at the end of the run")]
    enough = (device.mass or 0.0) * exhaust / device.thrust  # s at full thrust
    if _impulse(burns, end) < enough:
        return []
    low, high = 0.0, end
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _impulse(burns, middle) < enough else (low, middle)
    what = f"the whole mass is burnt after {duration(high)}: shorten the run, or end the thrust with device.active"
    return [("device.specific_impulse", what)]


def burns_of(scene: Scene) -> list[Burn]:
    """The throttle over the run, piece by piece: straight lines or steps of a table, inside the active times, at the
    level of each phase. Where a phase ends by what happens on the way, the rest counts as its thriftiest phase."""
    if not scene.phase:
        return _burns(scene, scene.steering, 0.0, scene.propagation.duration)
    begin, found = 0.0, list[Burn]()
    for i, phase in enumerate(scene.phase):
        last = _end_of_phase(scene, phase, begin)
        if last is None:
            shares = [_level(scene, one) * _least(_steered(scene, one)) for one in scene.phase[i:]]
            return found + _at_level(_burns(scene, None, begin, scene.propagation.duration), min(shares))
        found += _at_level(_burns(scene, _steered(scene, phase), begin, last), _level(scene, phase))
        begin = last
    return found


def _end_of_phase(scene: Scene, phase: Phase, begin: float) -> float | None:
    """When, s, a phase ends at the latest that the run allows; None where that is not known beforehand."""
    whole = scene.propagation.duration
    try:
        until = until_of(phase)
    except ValueError:  # which the questions about phases tell
        return None
    if until is None:
        return whole
    if isinstance(until, Until) and until.duration is not None:
        return min(begin + until.duration, whole)
    if isinstance(until, Until) and until.time is not None:
        return min(max(begin, until.time), whole)
    return None


def _steered(scene: Scene, phase: Phase) -> Steering | None:
    """The law of the scene's device in a phase."""
    if scene.device.steering is None:
        said = steering_of_first(scene, phase)
        return scene.steering if said is None else said
    state = phase.state_of(scene.device)
    own = state.steering if isinstance(state, StateOfOne) else None
    return scene.device.steering if own is None else own


def _level(scene: Scene, phase: Phase) -> float:
    return phase.state_of(scene.device).level


def _least(steering: Steering | None) -> float:
    """The lowest throttle that a law asks for."""
    return min(steering.throttle) if isinstance(steering, TableSteering) and steering.throttle else 1.0


def _at_level(burns: list[Burn], level: float) -> list[Burn]:
    return [(begin, end, level * low, level * high) for begin, end, low, high in burns] if level > 0.0 else []


def _burns(scene: Scene, steering: Steering | None, start: float, end: float) -> list[Burn]:
    """The same from a start, from which a table counts, to an end, s."""
    pieces: list[Burn] = [(start, end, 1.0, 1.0)]
    if isinstance(steering, TableSteering) and steering.throttle is not None:
        time, throttle = [start + moment for moment in steering.time], steering.throttle
        held = steering.interpolation == "hold"
        pieces = [(min(start, time[0]), time[0], throttle[0], throttle[0])]
        for i in range(len(time) - 1):
            pieces.append((time[i], time[i + 1], throttle[i], throttle[i] if held else throttle[i + 1]))
        pieces.append((time[-1], max(end, time[-1]), throttle[-1], throttle[-1]))
    windows = [(start, end)] if scene.device.active is None else scene.device.active
    return [
        cut for piece in pieces for first, last in windows if (cut := cut_to(piece, max(first, start), min(last, end)))
    ]


def cut_to(piece: Burn, first: float, last: float) -> Burn | None:
    """The part of a piece inside a window."""
    a, b, low, high = piece
    begin, end = max(a, first), min(b, last)
    if end <= begin:
        return None
    slope = (high - low) / (b - a)
    return begin, end, low + slope * (begin - a), low + slope * (end - a)


def _impulse(burns: list[Burn], until: float) -> float:
    """The throttle's integral from the start until a time, s at full thrust."""
    total = 0.0
    for piece in burns:
        if cut := cut_to(piece, piece[0], until):
            begin, end, low, high = cut
            total += 0.5 * (low + high) * (end - begin)
    return total
