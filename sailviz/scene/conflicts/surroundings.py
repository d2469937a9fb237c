"""What each kind of part of [environment] goes together with."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, NamedTuple, TypeVar

from sailviz.scene.conflicts.answers import Faults, never, nothing, unknown
from sailviz.scene.environment import (
    BurrWind,
    CyclicIrradiance,
    DensityProfile,
    DrawnWind,
    ExponentialAtmosphere,
    ForceProfile,
    GammaWind,
    IonosphereTable,
    LognormalWind,
    MsisAtmosphere,
    ReplayedWind,
    SteadyIrradiance,
    SteadyWind,
)
from sailviz.scene.sections import Ensemble
from sailviz.scene.values import Section

P = TypeVar("P", bound=Section)
SERIES_STEP = 3600.0  # s, of a measured wind


class VariesFits(NamedTuple, Generic[P]):
    """Facts of a kind of solar wind or irradiance. Functions take a section of the kind."""

    steady: bool = False
    redraw: Callable[[P], float | None] = unknown  # s between draws
    step: Callable[[P], float | None] = unknown  # s between changes in an ensemble's flights
    expands: Callable[[P], bool] = never  # polynomial chaos knows it
    ensemble: Callable[[P, Ensemble, str], Faults] = nothing  # what an ensemble, at a place, lacks to draw from it


def _redraw(part: DrawnWind | CyclicIrradiance) -> float:
    return part.redraw


def _replayed_side_by_side(wind: ReplayedWind, ensemble: Ensemble, place: str) -> Faults:
    found = []
    if wind.potential != "fixed":
        found.append((f"{place}.solar_wind", 'an ensemble replays pressures alone: potential = "fixed"'))
    if ensemble.seed is None and wind.seed is None:
        found.append((f"{place}.seed", "where in the series each flight begins is drawn: give a seed"))
    return found


WINDS: dict[type[Section], VariesFits[Any]] = {  # the functions of each record take the class that it stands under
    SteadyWind: VariesFits[SteadyWind](steady=True),
    GammaWind: VariesFits[GammaWind](redraw=_redraw, step=_redraw, expands=lambda wind: wind.variation == "constant"),
    LognormalWind: VariesFits[LognormalWind](redraw=_redraw, step=_redraw),
    BurrWind: VariesFits[BurrWind](redraw=_redraw, step=_redraw),
    ReplayedWind: VariesFits[ReplayedWind](step=lambda wind: SERIES_STEP, ensemble=_replayed_side_by_side),
}
IRRADIANCES: dict[type[Section], VariesFits[Any]] = {
    SteadyIrradiance: VariesFits[SteadyIrradiance](steady=True),
    CyclicIrradiance: VariesFits[CyclicIrradiance](step=_redraw),
}


class LayerFits(NamedTuple):
    """Facts of a kind of ionosphere or atmosphere."""

    density: bool = True  # known, not only the force that comes of it
    flux: tuple[float, float, str] | None = None  # lowest and highest solar flux, sfu, of a table, and its name
    highest: Callable[[Any], float | None] = unknown  # m, where a table ends that refuses what lies above


def _end_of_table(ionosphere: IonosphereTable) -> float | None:
    return 1500e3 if ionosphere.above_table == "refuse" else None


IONOSPHERES: dict[type[Section], LayerFits] = {
    ForceProfile: LayerFits(density=False),
    DensityProfile: LayerFits(),
    IonosphereTable: LayerFits(flux=(70.0, 193.0, "the ionosphere table reaches"), highest=_end_of_table),
}
ATMOSPHERES: dict[type[Section], LayerFits] = {
    ExponentialAtmosphere: LayerFits(),
    MsisAtmosphere: LayerFits(flux=(60.0, 300.0, "the atmosphere model is meant")),
}
