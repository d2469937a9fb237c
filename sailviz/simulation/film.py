"""The film of a scene's sail beside its push: what it is to the right-hand side, what is recorded and said of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from sailviz.constants import AU, SOLAR_IRRADIANCE, SPEED_OF_LIGHT, STEFAN_BOLTZMANN, YEAR
from sailviz.propagate import film_callback
from sailviz.propulsion.film_ageing import Numbers, Optics, closest_distance, optics_of, temperature
from sailviz.propulsion.solar_sail import Film
from sailviz.scene.device import FilmOptics, SolarSail
from sailviz.scene.film import ages, tells_film, tells_temperature
from sailviz.scene.sky import has_sky
from sailviz.words import length

if TYPE_CHECKING:
    from sailviz.propagate.dynamics import Model
    from sailviz.scene.loading import Scene
    from sailviz.simulation.lowered import Array, Columns, Words


def optics(device: SolarSail) -> Optics:
    """Of a fresh film, whose scene has been accepted."""
    if isinstance(device.film, FilmOptics):
        return Optics(**device.film.model_dump())
    assert isinstance(device.film, str)
    return optics_of(device.film)


def irradiance_of(scene: Scene) -> float:
    """W/m2 of the light at 1 au."""
    light = scene.light
    pressure = None if light is None else light.radiation_pressure
    if light is None or pressure is None:
        return SOLAR_IRRADIANCE
    distance = light.reference_distance
    return pressure * SPEED_OF_LIGHT * (1.0 if distance is None else (distance / AU) ** 2)


def mirrored_by_back(device: SolarSail) -> float:
    """Reflectivity of the back; negative where it is not known."""
    back = device.back
    if back == "same":
        return optics(device).cr
    if back == "black":
        return 0.0
    return back.cr if isinstance(back, FilmOptics) else -1.0


def film_numbers(scene: Scene, strength: float, level: float) -> Numbers | tuple[()]:
    """Numbers of the film for `dynamics.model`; none where nothing is asked of it. strength : a_c, m/s2; level : of the
    thrust in the phase."""
    if not tells_film(scene):
        return ()
    device = scene.device
    assert isinstance(device, SolarSail)
    fresh, age, shines = optics(device), device.ageing, irradiance_of(scene)
    return Numbers(
        strength * AU**2 / Film.from_optics(*fresh).total,
        *fresh,
        factor=0.0 if age is None else age.factor,
        rate=0.0 if age is None else float(np.log(2.0) / age.half_dose),
        back=mirrored_by_back(device),
        heat=shines * AU**2 / STEFAN_BOLTZMANN,
        brightness=shines / SOLAR_IRRADIANCE,
        ages=float(age is not None),
        under_sky=float(has_sky(scene)),
        level=level or 1.0,
    )


def dose_at_start(scene: Scene) -> float | None:
    """s of full sunlight at 1 au; None of a film that does not age."""
    device = scene.device
    return device.ageing.dose if isinstance(device, SolarSail) and device.ageing is not None else None


def film_columns(scene: Scene, model: Model, time: Array, states: Array, factor: Array) -> Columns:
    """Columns (n,) of /film. time (n,) s, states (7, n), their last the dose where the film ages, or those of a craft
    that turns, factor (n,) of the thrust. The temperature is that of the hottest facet of a shape's films. One that is
    not known is NaN: that of a sail that is stowed or switched off, and of a film whose back is lit and not told."""
    if not tells_film(scene):
        return {}
    values = film_callback.observe_film(time, np.ascontiguousarray(states[:7]), factor, model.parameters)
    columns: Columns = {}
    if ages(scene):
        columns["dose_yr"] = values[film_callback.DOSE] / YEAR
    if tells_temperature(scene):
        warm = values[film_callback.TEMPERATURE]
        if model.named.places.heat:
            from sailviz.propagate.shape_heat_callback import observe_heat  # machine code that other sails do without

            warm = observe_heat(time, states, factor, model.parameters)
        columns["temperature_K"] = np.where(warm > 0.0, warm, np.nan)
    if ages(scene):
        columns |= {name: values[row] for row, name in ((film_callback.B1, "b1"), (film_callback.B2, "b2"))}
        columns["b3"] = values[film_callback.B3]
    return columns


def film_words(scene: Scene) -> Words:
    """Rows of the parameter table: how the film ages, and how near the light it may come."""
    device = scene.device
    if not isinstance(device, SolarSail) or not tells_film(scene):
        return []
    rows, age = [], device.ageing
    if age is not None:
        said = f"factor {age.factor:g}, half dose {age.half_dose / YEAR:.6g} yr of full sunlight at 1 au"
        begun = f", {age.dose / YEAR:.6g} yr of it at the start" if age.dose else ""
        rows.append(("ageing", f"{said}{begun}; assumed, not measured"))
    if tells_temperature(scene):
        warm = float(temperature(AU, 0.0, optics(device), irradiance=irradiance_of(scene)))
        rows.append(("film at 1 au", f"{warm:.4g} K facing the light"))
    if device.hottest is not None:
        counts = "" if device.shape is None else "; of a shape's films the hottest facet counts"
        rows.append(("film limit", f"{device.hottest:g} K: {_limit(device, irradiance_of(scene))}{counts}"))
    return rows


def _limit(device: SolarSail, shines: float) -> str:
    """How near the light a film may come, facing it, in words."""
    assert device.hottest is not None
    fresh = optics(device)
    near = closest_distance(device.hottest, fresh, irradiance=shines)
    words = f"not nearer than {length(near)} facing the light"
    if device.ageing is None or device.ageing.factor == 0.0:
        return words
    end = closest_distance(device.hottest, fresh, dose=np.inf, factor=device.ageing.factor, irradiance=shines)
    return f"{words} when fresh, {length(end)} in the end"
