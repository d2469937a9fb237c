"""What each kind of [steering] goes together with. Kinds without parameters share a class: records stand by word."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import pi
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from sailviz.constants import DAY
from sailviz.scene.conflicts.answers import Faults, always, never, no_angles, no_sentences, nothing
from sailviz.scene.conflicts.starts import STARTS
from sailviz.scene.device import ElectricSail, PlasmaBrake
from sailviz.scene.environment import ForceProfile
from sailviz.scene.start import CircularStart
from sailviz.scene.steering import (
    FrameSteering,
    InertialSteering,
    LocalSteering,
    LyapunovSteering,
    OnOffSteering,
    OptimalSteering,
    PlainSteering,
    SmoothedSteering,
    SpinningSteering,
    SunFrameSteering,
    TableSteering,
)
from sailviz.scene.values import Section

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

S = TypeVar("S", bound=Section)
SAME_END = 1e-6  # of a run: arcs that end so near its end last as long


class SteeringFits(NamedTuple, Generic[S]):
    """Facts of a kind of steering. Functions take a section of the kind."""

    directs: bool = True  # says where a thruster pushes
    sail: bool = True  # turns a sail
    tether: bool = False  # how a plasma brake's tether lies
    tether_only: bool = False
    primer: bool = False  # makes the most of a sail's thrust along a primer
    as_designed: bool = False  # that of the start's design
    frame: Callable[[S], str] = lambda steering: ""  # in which it counts: "orbital", "meridian", "velocity"
    planar: Callable[[S], bool] = never  # meant for flights in one plane
    pitch: Callable[[S], Sequence[float]] = no_angles  # every angle that it gives, rad
    in_plane: Callable[[S], bool] = never  # holds one pitch in the orbit plane, as the first-order solution wants
    ensemble: Callable[[Scene, S], list[str]] = no_sentences  # why many cannot fly side by side
    transfer: Callable[[Scene, S], Faults] = nothing  # what a law that solves for a transfer asks of the scene
    brake: Callable[[Scene, PlasmaBrake], Faults] = nothing  # what it asks of a plasma brake


def _held_pitch_in_plane(steering: FrameSteering) -> bool:
    return steering.kind == "orbital" and abs(abs(steering.clock) % pi - pi / 2) < 1e-9


def _alone(scene: Scene, steering: Section) -> list[str]:
    words = getattr(steering, "kind", "")
    return [f'an ensemble cannot fly "{words}" steering, which depends on where each flight is']


def _held_rows(scene: Scene, steering: TableSteering) -> list[str]:
    words = 'an ensemble holds each row of a steering table: interpolation = "hold"'
    return [] if steering.interpolation == "hold" else [words]


def _designed_for_many(scene: Scene, steering: PlainSteering) -> list[str]:
    start = scene.start
    changes = STARTS[type(start)].track
    return [f"an ensemble cannot fly {start.kind}: its steering changes all the time"] if changes else []


def _smoothed(scene: Scene, steering: SmoothedSteering) -> Faults:
    found, start, device = [], scene.start, scene.device
    if not isinstance(start, CircularStart) or start.radius is None:
        found.append(("steering.kind", "a smoothed transfer begins on a circle: start.kind circular with radius"))
    if not isinstance(device, ElectricSail) or device.model != "final":
        found.append(("steering.kind", 'a smoothed transfer is flown by an electric sail, model "final"'))
    return found


def _arcs(scene: Scene, steering: OptimalSteering) -> Faults:
    if steering.arcs is None:
        return []
    reckoned = steering.reckons_with
    if not (isinstance(scene.device, ElectricSail) if reckoned is None else reckoned.startswith("electric-sail")):
        words = "arcs are an electric sail's: a film is steered by its attitude alone and has no singular arc"
        return [("steering.arcs", words)]
    total, duration = sum(arc.duration for arc in steering.arcs), scene.propagation.duration
    if not scene.phase and abs(total - duration) > SAME_END * duration:
        words = f"the arcs last {total / DAY:.10g} d together, and the run {duration / DAY:.10g} d"
        return [("steering.arcs", f"{words}: they have to last as long")]
    return []


def _tilted_brake(scene: Scene, device: PlasmaBrake) -> Faults:
    words = "how far the drag tilts the tether depends on the mass at its tip"
    return [("device.tip_mass", words)] if device.tip_mass is None else []


def _spinning_brake(scene: Scene, device: PlasmaBrake) -> Faults:
    words = "a spinning tether needs a density, from which its mean force is made"
    given = isinstance(scene.environment.ionosphere, ForceProfile)
    return [("environment.ionosphere", words)] if given else []


def _orbital(steering: Section) -> str:
    return "orbital"


def _frame_of_goal(steering: LocalSteering) -> str:
    return "" if steering.goal in ("energy", "semi-major-axis") else "orbital"


_FRAME = SteeringFits[FrameSteering](
    frame=lambda steering: steering.kind, pitch=lambda steering: [steering.pitch], in_plane=_held_pitch_in_plane
)
STEERINGS: dict[str, SteeringFits[Any]] = {  # the functions of each record take the class whose word it stands under
    "sun-facing": SteeringFits[PlainSteering](directs=False, in_plane=always),
    "radial": SteeringFits[PlainSteering](in_plane=always),
    "circumferential": SteeringFits[PlainSteering](sail=False, in_plane=always, frame=_orbital),
    "tangential": SteeringFits[PlainSteering](sail=False, frame=lambda steering: "velocity"),
    "vertical": SteeringFits[PlainSteering](directs=False, sail=False, tether=True),
    "gravity-gradient": SteeringFits[PlainSteering](tether=True, tether_only=True, brake=_tilted_brake),
    "as designed": SteeringFits[PlainSteering](directs=False, as_designed=True, ensemble=_designed_for_many),
    "spinning": SteeringFits[SpinningSteering](tether=True, tether_only=True, brake=_spinning_brake),
    "orbital": _FRAME,
    "meridian": _FRAME,
    "sun-frame": SteeringFits[SunFrameSteering](pitch=lambda steering: [steering.pitch], ensemble=_alone),
    "on-off": SteeringFits[OnOffSteering](directs=False, ensemble=_alone),
    "inertial": SteeringFits[InertialSteering](ensemble=_alone),
    "table": SteeringFits[TableSteering](
        frame=lambda steering: steering.frame, pitch=lambda steering: steering.pitch, ensemble=_held_rows
    ),
    "optimal": SteeringFits[OptimalSteering](
        primer=True, planar=lambda steering: len(steering.costates) == 3, ensemble=_alone, transfer=_arcs
    ),
    "smoothed-transfer": SteeringFits[SmoothedSteering](transfer=_smoothed),
    "locally-optimal": SteeringFits[LocalSteering](primer=True, frame=_frame_of_goal, ensemble=_alone),
    "lyapunov": SteeringFits[LyapunovSteering](primer=True, frame=_orbital, ensemble=_alone),
}
OTHER_STEERING = SteeringFits[Any](ensemble=_alone)  # a law that says nothing here points whatever pushes
NO_STEERING = SteeringFits[Any](directs=False, tether=True, in_plane=always)  # a sail faces the Sun, a tether hangs
