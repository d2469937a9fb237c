"""What each kind of [[approximation]] goes together with, and whether a scene's own do."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.conflicts.records import device_of, start_of, steering_of
from sailviz.scene.conflicts.surroundings import WINDS
from sailviz.scene.device import air_on_facets
from sailviz.scene.sections import FirstOrderApproximation, QuasiCircularApproximation
from sailviz.scene.start import CircularStart
from sailviz.scene.values import Section

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

A = TypeVar("A", bound=Section)


class ApproximationFits(NamedTuple, Generic[A]):
    """Facts of a kind of approximation. Functions take a section of the kind."""

    name: Callable[[A], str]
    twice: Callable[[A], tuple[str, str]]  # (place after its own, sentence) where another has its name already
    beyond: Callable[[Scene], list[str]]  # what of a scene it does not know


def _beyond_quasi_circular(scene: Scene) -> list[str]:
    """What keeps a scene from the quasi-circular decay, which knows a mean force over the altitude and nothing else."""
    device, around, found, fits = scene.device, scene.environment, [], device_of(scene)
    if not isinstance(scene.start, CircularStart) or scene.body != "earth":
        found.append('the quasi-circular decay begins on a circular orbit: body = "earth", start.kind = "circular"')
    if not fits.tether and around.atmosphere is None:
        found.append("the quasi-circular decay needs a plasma brake or the drag of an atmosphere")
    if air_on_facets(device):
        found.append("the quasi-circular decay knows drag on an area, not on a shape")
    if not fits.decays or device.active is not None:
        found.append("the quasi-circular decay knows a plasma brake that is always on, and drag")
    if around.solar_flux == "cycle":
        found.append("the quasi-circular decay needs a constant solar flux")
    if around.space_weather is not None:
        found.append("the quasi-circular decay knows no space weather that changes: solar_flux_sfu is its level")
    return found + fits.decay(scene, device)


def _beyond_first_order(scene: Scene) -> list[str]:
    """What keeps a scene from the first-order solution, which is planar and has one thrust law at fixed pitch."""
    device, found, start, fits = scene.device, [], start_of(scene), device_of(scene)
    wind = scene.environment.solar_wind
    if not start.keplerian or start.inclined(scene.start):
        found.append('the first-order solution is planar: start.kind "circular" or "elements" without inclination')
    if not steering_of(scene).in_plane(scene.steering):
        words = "the first-order solution needs a fixed pitch in the orbit plane, or radial or circumferential thrust"
        found.append(words)
    if device.active is not None or not WINDS[type(wind)].steady or fits.tether:
        found.append("the first-order solution needs thrust that is always on and never disturbed")
    return found + fits.first_order(device)


APPROXIMATIONS: dict[type[Section], ApproximationFits[Any]] = {
    FirstOrderApproximation: ApproximationFits[FirstOrderApproximation](
        name=lambda item: item.name,
        twice=lambda item: (".name", "two approximations have the same name"),
        beyond=_beyond_first_order,
    ),
    QuasiCircularApproximation: ApproximationFits[QuasiCircularApproximation](
        name=lambda item: item.kind,
        twice=lambda item: ("", f"{item.kind} stands twice"),
        beyond=_beyond_quasi_circular,
    ),
}


def approximations(scene: Scene) -> Faults:
    """Whether a scene's analytic solutions have names of their own and know the scene."""
    found: Faults = []
    names: set[str] = set()
    for i, item in enumerate(scene.approximation):
        place, fits = f"approximation[{i}]", APPROXIMATIONS[type(item)]
        name = fits.name(item)
        if name in names:
            after, sentence = fits.twice(item)
            found.append((f"{place}{after}", sentence))
        names.add(name)
        found += [(place, sentence) for sentence in fits.beyond(scene)]
    return found
