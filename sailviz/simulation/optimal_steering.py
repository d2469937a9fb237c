"""A minimum-time flight of a scene: from its initial costates to the primer that its sail follows in time, and to the
arcs that it flies, where it says so."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from sailviz import frames
from sailviz.constants import AU, MU_SUN
from sailviz.design.minimum_time.replay import Solved, from_planar, primer_history
from sailviz.design.minimum_time.singular_arcs import Arc
from sailviz.design.minimum_time.touches import Touch
from sailviz.errors import Fault, SceneError
from sailviz.propagate.primer_callback import ARC_KINDS
from sailviz.run.arrays import Phase
from sailviz.steering import attitude
from sailviz.steering.optimal import optimal_pitch

NAMES = {"thrust": "full thrust", "coast": "coast", "singular": "partial thrust"}  # of phases, by the kind of arc


def primer_table(scene, position, velocity, device, characteristic_acceleration, begin=0.0, coolness=0.0):
    """Rows (n, 7): time s, primer (3), its rate (3), inertial, from `begin` s to the end of the run, or of its arcs;
    (time s, word) of every switch; times, s, at which the thrust jumps otherwise; and the arcs as phases of a flight.

    Of a flight in arcs the rows that `primer_callback` reads of them stand first.

    position m, velocity m/s (3,) at `begin`; device : the sail that the law reckons with, a name or a Film; coolness :
    what its heat allows, see `canonical_sail`. SceneError where the costates lead nowhere.
    """
    duration, numbers = scene.propagation.duration - begin, np.asarray(scene.steering.costates, dtype=float)
    arcs = _arcs(scene.steering.arcs or [])
    if arcs:
        duration = arcs[-1].end
    try:
        if len(numbers) == 3:
            start, radius = planar_start(position, velocity, numbers), float(np.linalg.norm(position))
            touches = _touches(scene, duration, radius)
            solved = from_planar(start, radius, duration, device, characteristic_acceleration, arcs, touches, coolness)
        else:
            touches = _touches(scene, duration, AU)
            solved = Solved(
                position, velocity, numbers, duration, device, characteristic_acceleration, arcs, touches, coolness
            )
        found = primer_history(solved)
    except ValueError as error:
        raise SceneError([Fault("steering.costates", f"{error}.")], scene.source) from None
    rows = np.column_stack([begin + found.time, found.primer, found.rate])
    if not arcs:
        touched = tuple(begin + one.time for one in scene.steering.touches or ())
        return rows, _switches(found, device, begin), touched, ()
    phases = _phases(arcs, found, begin)
    switches = _arc_switches(arcs, phases, begin)
    return np.vstack([_arc_rows(arcs, found, begin), rows]), switches, _arc_breaks(arcs, begin), phases


def _arcs(given):
    """Arcs of a scene with their starts and ends, s."""
    edges = np.concatenate([[0.0], np.cumsum([arc.duration for arc in given])]).tolist()
    return tuple(Arc(arc.kind, a, b) for arc, (a, b) in zip(given, pairwise(edges), strict=True))


def _phases(arcs, found, begin):
    """The arcs as phases, with what is between the lowest and the highest throttle."""
    throttle = iter(found.throttle)
    phases = []
    for arc in arcs:
        words = ""
        if arc.kind == "singular":
            _, share = next(throttle)
            words = f"throttle {share.min():.2f}-{share.max():.2f}"
        phases.append(Phase(NAMES[arc.kind], begin + arc.start, begin + arc.end, words))
    return tuple(phases)


def _arc_switches(arcs, phases, begin):
    """(time s, word) where arcs end, and where thrust begins and ends, whatever share of it there is between."""
    ends = [(phase.end, f"end of {phase.name}") for phase in phases[:-1]]
    pairs = [(a, b) for a, b in pairwise(arcs) if (a.kind == "coast") != (b.kind == "coast")]
    thrust = [(begin + b.start, "thrust off" if b.kind == "coast" else "thrust on") for _, b in pairs]
    return (*ends, *thrust)


def _arc_rows(arcs, found, begin):
    """Rows (1 + k + m, 7) before those of the primer: the numbers k and m; the end, s, and the kind of each arc; and
    over time the throttle on all that are singular.

    In time rather than by the craft's state: the throttle that keeps the primer of this table at its switch answers a
    small error of the place so that it grows, a thousandfold on the way to Saturn.
    """
    throttle = [attitude.table(begin + time, share, 0 * time, 0 * time, "cubic") for time, share in found.throttle]
    m = sum(map(len, throttle))
    head = np.zeros((1 + len(arcs), attitude.COLUMNS))
    head[0, :2] = len(arcs), m
    for row, arc in zip(head[1:], arcs, strict=True):
        row[:2] = begin + arc.end, ARC_KINDS.index(arc.kind)
    return np.vstack([head, *throttle])


def _arc_breaks(arcs, begin):
    """Times, s, at which steps begin and end so that only a short one has an arc's end in it: a moment before and a
    moment after, where nothing depends on which of two arcs a step's last stage takes for its own."""
    beside = 1e-12 * arcs[-1].end
    return tuple(begin + arc.end + side * beside for arc in arcs[:-1] for side in (-1, 1))


def _touches(scene, duration, radius):
    """Those that come within a duration s, in units of mu = 1 and a radius in m."""
    unit = float(np.sqrt(radius**3 / MU_SUN))
    said = scene.steering.touches or ()
    return tuple(Touch(one.time / unit, one.jump) for one in said if one.time < duration)


def _switches(found, device, begin):
    """(time s, word) of a flight's switches, from whether it begins with thrust."""
    r, primer = found.position, found.primer[0]
    on = bool(optimal_pitch(np.arctan2(np.linalg.norm(np.cross(r, primer)), r @ primer), device).on)
    words = ("thrust off", "thrust on") if on else ("thrust on", "thrust off")
    return tuple((begin + float(time), words[i % 2]) for i, time in enumerate(found.switches))


def planar_start(position, velocity, costates):
    """State and costates (12,), Cartesian, in units of mu = 1 and the distance |position|, from the costates of
    radius, radial and transverse speed."""
    r = np.linalg.norm(position)
    axes = frames.rtn(position, velocity)
    speed = np.asarray(velocity) / np.sqrt(MU_SUN / r)
    lam_r, lam_u, lam_v = costates
    u, v = speed @ axes[0], speed @ axes[1]
    lam_position = lam_r * axes[0] + (lam_u * v - lam_v * u) * axes[1]
    return np.concatenate([np.asarray(position) / r, speed, lam_position, lam_u * axes[0] + lam_v * axes[1]])
