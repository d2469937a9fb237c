"""What a scene says of its environment: one record for each kind of part, keyed by the class of its section.

A new body or force: its formula in sailviz/environment, its section in scene/environment.py, its record here. A field
of [environment] whose section has a record is lowered, said in words, recorded and drawn as that says.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

import numpy as np

from sailviz import ephemeris
from sailviz.constants import J2_EARTH, J3_EARTH, J4_EARTH, MU_EARTH, MU_SUN, RADIUS_EARTH, ROTATION_EARTH
from sailviz.environment import atmosphere, ionosphere, solar_level, sun, third_body
from sailviz.environment.eclipse import CONE, CYLINDER, NO_SHADOW
from sailviz.environment.gravity import strengths
from sailviz.environment.sun import sun_parameters
from sailviz.propagate.edges_callback import low_orbit_edges
from sailviz.propagate.low_orbit_callback import low_orbit_forces
from sailviz.propagate.parameters import Parameters
from sailviz.scene.conflicts.moments import lit_and_dark
from sailviz.scene.environment import (
    BurrWind,
    CyclicIrradiance,
    DensityProfile,
    ExponentialAtmosphere,
    ForceProfile,
    GammaWind,
    IonosphereTable,
    LognormalWind,
    MagneticSphere,
    MsisAtmosphere,
    ReplayedWind,
    SpaceWeather,
    SteadyIrradiance,
    SteadyWind,
    ThirdBody,
)
from sailviz.scene.sky import shadow_kind
from sailviz.scene.values import Section
from sailviz.simulation import space_weather
from sailviz.simulation.lowered import Array, Columns, Place, Words, no_columns, no_words
from sailviz.words import duration

if TYPE_CHECKING:
    from sailviz.run.arrays import Body
    from sailviz.scene.loading import Scene

P = TypeVar("P", bound=Section)
Density = Callable[[Any, Parameters, Array, Array, Array], Array]


class DrawnBody(NamedTuple):
    """A body that a part of the environment stands for, as it is drawn."""

    name: str
    orbit: Array  # (k, 3) m, there from the start
    position: Callable[[Array], Array]  # times (n,) s -> (n, 3) m


def _nothing(part: Section, place: Place) -> dict[str, Any]:
    return {}


@dataclass(frozen=True)
class Part(Generic[P]):
    """A kind of part of the environment."""

    lower: Callable[[P, Place], dict[str, Any]] = _nothing  # keywords of `dynamics.model`
    words: Callable[[P, Place], Words] = no_words
    columns: Callable[[P, Place, Array, Array], Columns] = no_columns  # at times (n,) s and states (7, n)
    body: Callable[[P], DrawnBody] | None = None
    density: Density | None = None  # of plasma, 1/m3, drawn as a shell; at places on a circle, see `plasma_density`


# ---------------------------------------------------------------- plasma
def _profile(
    kind: int, part: ForceProfile | DensityProfile, value: float, ion_mass: float, place: Place
) -> dict[str, Any]:
    numbers = (part.reference_altitude, value, part.scale_height, ion_mass, place.body.radius)
    return {"plasma": ionosphere.Parameters(kind, *numbers)}


def _force_profile(part: ForceProfile, place: Place) -> dict[str, Any]:
    return _profile(ionosphere.FORCE_PROFILE, part, part.force_per_length, 0.0, place)


def _density_profile(part: DensityProfile, place: Place) -> dict[str, Any]:
    return _profile(ionosphere.DENSITY_PROFILE, part, part.density, part.ion_mass, place)


def _plasma_table(part: IonosphereTable, place: Place) -> dict[str, Any]:
    found: dict[str, Any] = {
        "plasma": ionosphere.Parameters(ionosphere.TABLE_PROFILE, density_factor=part.density_factor),
        "edges": low_orbit_edges(),
    }
    around = place.scene.environment
    if around.space_weather is not None:
        return found | {"plasma_table": ionosphere.table()}
    flux = around.solar_flux
    return found if flux is None else found | {"plasma_table": ionosphere.table(None if flux == "cycle" else flux)}


def _density_of_profile(part: DensityProfile, named: Parameters, place: Array, angle: Array, altitude: Array) -> Array:
    fade = ionosphere.exponential.py_func(altitude, part.reference_altitude, part.density, part.scale_height)
    return np.tile(fade, (len(angle), 1))


def _density_of_table(part: IonosphereTable, named: Parameters, place: Array, angle: Array, altitude: Array) -> Array:
    hour = np.arctan2(place[:, 1], place[:, 0]) - sun.mean_right_ascension.py_func(0.0, named.sun) + np.pi
    flux = solar_level.flux.py_func(0.0, named.solar_level)  # real space weather puts its first value there
    density, _ = ionosphere.density(np.arcsin(place[:, 2])[:, None], hour[:, None], altitude, flux)
    return density * part.density_factor


# ---------------------------------------------------------------- air
def _drag_area(scene: Scene) -> float:
    area = scene.device.drag_area
    if area is None or isinstance(area, str):
        return 0.0  # by facets or by attitude: a callback's
    return area * scene.device.drag_coefficient


def _exponential_air(part: ExponentialAtmosphere, place: Place) -> dict[str, Any]:
    numbers = (place.body.radius + part.reference_altitude, part.density, part.scale_height)
    return {"air": atmosphere.Parameters(atmosphere.EXPONENTIAL, _drag_area(place.scene), *numbers)}


def _tabled_air(part: MsisAtmosphere, place: Place) -> dict[str, Any]:
    found = {
        "air": atmosphere.Parameters(atmosphere.TABLED, _drag_area(place.scene)),
        "forces": (low_orbit_forces(),),
        "edges": low_orbit_edges(),
    }
    if place.scene.environment.space_weather is not None:
        return found  # whose record makes the table
    flux = place.scene.environment.solar_flux
    if flux is None:
        return found
    levels = atmosphere.LEVELS if flux == "cycle" else flux
    dates = season_start(place.scene, place.epoch), place.scene.propagation.duration
    return found | {"air_table": atmosphere.table_over(*dates, levels, part.ap)}


def season_start(scene: Scene, epoch: np.datetime64 | None) -> np.datetime64:
    """Date of a run's start; without an epoch one on which the mean Sun stands where the scene says."""
    return sun.date_of(scene.environment.sun_right_ascension or 0.0) if epoch is None else epoch


# ---------------------------------------------------------------- bodies
def _orbit_of_third_body(part: ThirdBody) -> third_body.Parameters:
    return third_body.Parameters(
        part.mu, part.radius, third_body.circular_rate(MU_SUN, part.mu, part.radius), part.azimuth
    )


def _third_body_drawn(part: ThirdBody) -> DrawnBody:
    p = _orbit_of_third_body(part)

    def position(time: Array) -> Array:
        angle = p.azimuth + p.rate * time
        return p.radius * np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])

    turn = np.linspace(0, 2 * np.pi, 361)
    orbit = p.radius * np.column_stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)])
    return DrawnBody(part.name, orbit, position)


# ---------------------------------------------------------------- wind
def _gamma_words(part: GammaWind, place: Place) -> Words:
    mean = f"{part.shape * part.scale * 1e9:.4g} nPa"
    return [("mean pressure", mean), ("redrawn every", duration(part.redraw))]


ENVIRONMENT: dict[type[Section], Part[Any]] = {  # the functions of each record take the class that it stands under
    SteadyWind: Part[SteadyWind](),  # winds and irradiance act through the thrust factor: see thrust_history
    GammaWind: Part[GammaWind](words=_gamma_words),
    LognormalWind: Part[LognormalWind](),
    BurrWind: Part[BurrWind](),
    ReplayedWind: Part[ReplayedWind](),
    SteadyIrradiance: Part[SteadyIrradiance](),
    CyclicIrradiance: Part[CyclicIrradiance](),
    ForceProfile: Part[ForceProfile](_force_profile),
    DensityProfile: Part[DensityProfile](_density_profile, density=_density_of_profile),
    IonosphereTable: Part[IonosphereTable](_plasma_table, density=_density_of_table),
    ExponentialAtmosphere: Part[ExponentialAtmosphere](_exponential_air),
    MsisAtmosphere: Part[MsisAtmosphere](_tabled_air),
    SpaceWeather: Part[SpaceWeather](
        space_weather.lowered, words=space_weather.in_words, columns=space_weather.columns
    ),
    MagneticSphere: Part[MagneticSphere](),  # it acts under the sky: see simulation/sky.py
    ThirdBody: Part[ThirdBody](
        lambda part, place: {"third_body": _orbit_of_third_body(part)},
        body=_third_body_drawn,
    ),
}


def parts_of(scene: Scene) -> Iterator[tuple[Section, Part[Any]]]:
    """The sections inside a scene's [environment], each with its record."""
    around = scene.environment
    for name in type(around).model_fields:
        part = getattr(around, name)
        if isinstance(part, Section):
            yield part, ENVIRONMENT[type(part)]


def drawn_bodies(scene: Scene) -> list[DrawnBody]:
    """The bodies that parts of the environment stand for."""
    return [record.body(part) for part, record in parts_of(scene) if record.body is not None]


def surroundings(scene: Scene, body: Body, epoch: np.datetime64 | None) -> dict[str, Any]:
    """Keywords of `dynamics.model` for what belongs to the central body itself."""
    around = scene.environment
    parts: dict[str, Any] = {"surface_radius": body.radius, "ellipsoid": int(around.height_above == "ellipsoid")}
    if scene.body != "earth":
        return parts
    parts["rotation"] = ROTATION_EARTH if around.corotation else 0.0
    use = [J2_EARTH * around.j2, J3_EARTH * around.j3, J4_EARTH * around.j4]
    parts["j2_strength"], *parts["zonal"] = strengths(MU_EARTH, RADIUS_EARTH, *use)
    parts["sun"] = sun_parameters(epoch, around.sun_right_ascension or 0.0)
    parts["shadow"] = {"cylinder": CYLINDER, "cone": CONE}[shadow_kind(scene)] if watches_shadow(scene) else NO_SHADOW
    if getattr(scene.device, "eclipse", "on") != "on":
        parts["edges"] = low_orbit_edges()
    if around.solar_flux == "cycle":
        assert epoch is not None  # or the scene would not have been accepted
        parts["solar_level"] = solar_level.cycle(ephemeris.decimal_year(epoch))
    elif around.solar_flux is not None:
        parts["solar_level"] = solar_level.constant(around.solar_flux)
    return parts


def watches_shadow(scene: Scene) -> bool:
    """Whether sunlight and shadow matter to a scene, or are at least known in it."""
    return lit_and_dark(scene)
