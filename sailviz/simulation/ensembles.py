"""Scene -> ensembles: the flights that a scene wants beside its own, each through a wind or sunshine of its own.

Every ensemble starts, steers and pushes as the scene's craft does. What differs is the wind and what the voltage does
about it. Statistics come from all flights, the picture from those kept.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz.constants import AU, SOLAR_IRRADIANCE
from sailviz.design.displaced.holding import Holding
from sailviz.errors import Fault, SceneError
from sailviz.run.arrays import EnsembleStatistics
from sailviz.scene.device import (
    DistanceControl,
    ElectricSail,
    ElectrochromicControl,
    PressureControl,
    SolarSail,
    control_of,
)
from sailviz.scene.environment import CyclicIrradiance, GammaWind, ReplayedWind, SteadyWind
from sailviz.scene.sections import Chaos, Ensemble, ManyFlights
from sailviz.scene.steering import FrameSteering, PlainSteering, SmoothedSteering, TableSteering
from sailviz.scene.values import Section
from sailviz.simulation.device import film_of, radiation_pressure, sail_strength
from sailviz.simulation.plan import Plan
from sailviz.simulation.start import held_radius
from sailviz.simulation.thrust_history import (
    control_row,
    electrochromic,
    measured_wind,
    reference_pressure,
    sunlight,
    wind_law,
)

if TYPE_CHECKING:
    from sailviz.simulation.output_times import OutputTimes
    from sailviz.uncertainty.ensembles import Ensemble as Flown
    from sailviz.uncertainty.ensembles import GivenWind, RandomWind
    from sailviz.uncertainty.ensembles import ReplayedWind as ReplayedSeries

OUTPUTS = 181  # rows of the run at which ensembles are known
RECORDED = 1024  # flights known at every one of them, for histograms
BINS = 48
Options = dict[str, Any]  # keywords of `fly_ensemble`
Control = PressureControl | DistanceControl | ElectrochromicControl | None


def ensembles_of(p: Plan, output: OutputTimes) -> tuple[EnsembleStatistics, ...]:
    """The ensembles of a plan, at some of the times of its output rows. SceneError where flights cannot be flown."""
    scene = p.scene
    if not scene.ensemble and not scene.chaos:
        return ()
    if p.keep:
        raise SceneError([Fault("ensemble", "flies the scene's own steering and forces, no functions.")], scene.source)
    step = np.unique(np.round(np.linspace(0, output.rows - 1, min(OUTPUTS, output.rows))).astype(int))
    times = np.array([output.between(int(k), 1)[0] for k in step])
    makers: list[tuple[str, Any, Callable[..., EnsembleStatistics]]]
    makers = [(f"ensemble[{i}]", item, _drawn) for i, item in enumerate(scene.ensemble)]
    makers += [(f"chaos[{i}]", item, _expanded) for i, item in enumerate(scene.chaos)]
    found = []
    for place, item, make in makers:
        try:
            found.append(make(p, item, place, step, times))
        except ValueError as error:
            raise SceneError([Fault(place, f"{error}.")], scene.source) from None
    return _with_histograms(found)


def _craft(p: Plan) -> Options:
    """Keywords of `fly_ensemble` for the scene's craft and its steering."""
    scene, design = p.scene, p.design
    electric = isinstance(scene.device, ElectricSail)
    options: Options = {
        "device": "electric-sail" if electric else film_of(scene),
        "characteristic_acceleration": sail_strength(scene, design),
        "mu": p.body.mu,
    }
    if isinstance(scene.device, ElectricSail):
        options["model"] = scene.device.model
    if isinstance(scene.device, SolarSail) and scene.device.shape is not None:
        from sailviz.simulation.sail_shape import acceleration_in_orbit

        pressure = radiation_pressure(scene)
        assert pressure is not None  # as for every sail that does not say its strength
        options["device"] = acceleration_in_orbit(scene, pressure)
    steering = scene.steering
    if steering is not None:
        options |= STEERINGS[type(steering)](p, steering)
    held = held_radius(scene)
    if held is not None:
        options["aim"] = (held, 0.0)  # of the distance law; else the nominal flight
    return options


def _plain(p: Plan, steering: PlainSteering) -> Options:
    if steering.kind != "as designed":
        return {}  # facing the Sun
    design = p.design
    assert isinstance(design, Holding)  # the scene's check says so
    return {"pitch": float(design.pitch), "clock": float(design.clock) if design.pitch else np.pi / 2}


def _fixed(p: Plan, steering: FrameSteering) -> Options:
    return {"pitch": steering.pitch, "clock": steering.clock, "frame": steering.kind}


def _tabled(p: Plan, steering: TableSteering) -> Options:
    return {"table": p.table, "frame": steering.frame}


def _smoothed(p: Plan, steering: SmoothedSteering) -> Options:
    return {"table": p.table, "frame": "orbital"}


STEERINGS: dict[type[Section], Callable[[Plan, Any], Options]] = {  # that flights can follow side by side
    PlainSteering: _plain,
    FrameSteering: _fixed,
    TableSteering: _tabled,
    SmoothedSteering: _smoothed,
}


def _control(p: Plan, item: ManyFlights) -> Control:
    if isinstance(item.control, str):
        return control_of(p.scene.device) if item.control == "device" else None
    return item.control


def _voltage_law(p: Plan, item: ManyFlights) -> PressureControl | DistanceControl | None:
    law = _control(p, item)
    return None if isinstance(law, ElectrochromicControl) else law


def _wind(p: Plan, item: Ensemble, place: str) -> tuple[RandomWind | ReplayedSeries, int, float, str]:
    """(wind of the ensemble, seed, reference pressure Pa, wind in words)."""
    from sailviz.uncertainty.ensembles import RandomWind
    from sailviz.uncertainty.ensembles import ReplayedWind as ReplayedSeries

    scene = p.scene
    wind = item.solar_wind or scene.environment.solar_wind
    assert not isinstance(wind, SteadyWind)  # the scene's check says so
    seed = item.seed if item.seed is not None else wind.seed or 0
    if isinstance(wind, ReplayedWind):
        series = measured_wind(scene, wind, "environment.solar_wind" if item.solar_wind is None else place)
        made = ReplayedSeries(series.pressure, series.step)
        return made, seed, reference_pressure(wind, series), f"replayed from {wind.file}"
    law = wind_law(wind)
    random = RandomWind(law, wind.variation, wind.redraw, wind.correlation_time, wind.yearly_deviation)
    words = f"{wind.kind}, {law.mean * 1e9:.3g} nPa, {wind.variation}"
    return random, seed, reference_pressure(wind, law), words


def _drawn(p: Plan, item: Ensemble, place: str, step: np.ndarray, times: np.ndarray) -> EnsembleStatistics:
    """Monte Carlo."""
    from sailviz.uncertainty.ensembles import fly_ensemble

    options = _craft(p)
    flights, law = item.flights, _control(p, item)
    more: dict[str, np.ndarray] = {}
    wind: Any
    if isinstance(p.scene.device, SolarSail):
        wind, seed, row, words, more = _sunshine(p, item, law, times)
    else:
        wind, seed, reference, words = _wind(p, item, place)
        row = control_row(_voltage_law(p, item), p.scene, reference)
    ensemble = fly_ensemble(
        p.position,
        p.velocity,
        p.scene.propagation.duration,
        wind=wind,
        control=row,
        flights=flights,
        seed=seed,
        outputs=times,
        keep=min(flights, RECORDED),
        **options,
    )
    ensemble = replace(ensemble, time=times)
    return _statistics(p, item, law, words, step, ensemble, "monte-carlo", more)


def _sunshine(
    p: Plan, item: Ensemble, law: Control, times: np.ndarray
) -> tuple[GivenWind, int, np.ndarray, str, dict[str, np.ndarray]]:
    """(wind, seed, control row, words, more quantities) of a solar sail under many Suns, with its own control."""
    from sailviz.propulsion import voltage_control
    from sailviz.uncertainty.ensembles import GivenWind

    scene, light = p.scene, p.scene.environment.irradiance
    assert isinstance(light, CyclicIrradiance)  # the scene's check says so
    seed = item.seed if item.seed is not None else light.seed
    drawn = [sunlight(scene, light, scene.propagation.duration, seed, flight) for flight in range(item.flights)]
    share = np.array([one for _, one in drawn])
    now = np.searchsorted(drawn[0][0], times, side="right") - 1
    more = {"irradiance_W_m2": SOLAR_IRRADIANCE * share[:, now]}
    factors = share
    if isinstance(law, ElectrochromicControl):
        pairs = [electrochromic(one, law.fraction) for one in share]
        factors = np.array([factor for factor, _ in pairs])
        more["electrochromic_state"] = np.array([state for _, state in pairs])[:, now]
    row = voltage_control.row(reference_pressure=SOLAR_IRRADIANCE)
    return GivenWind(SOLAR_IRRADIANCE * factors, light.redraw), seed, row, "the Sun's cycle and flicker", more


def _expanded(p: Plan, item: Chaos, place: str, step: np.ndarray, times: np.ndarray) -> EnsembleStatistics:
    """Polynomial chaos: the flights at the nodes, and what they tell of all."""
    from sailviz.uncertainty import chaos
    from sailviz.uncertainty.ensembles import LEVELS, GivenWind, fly_ensemble

    wind = item.solar_wind or p.scene.environment.solar_wind
    assert isinstance(wind, GammaWind)  # the scene's check says so
    law, drawn = _voltage_law(p, item), wind_law(wind)
    row = control_row(law, p.scene, reference_pressure(wind, drawn))
    flights: list[Flown] = []

    def fly(pressures: np.ndarray) -> np.ndarray:
        given = GivenWind(pressures[:, None], np.inf)
        duration = p.scene.propagation.duration
        flown = fly_ensemble(
            p.position,
            p.velocity,
            duration,
            wind=given,
            control=row,
            flights=len(pressures),
            outputs=times,
            keep=len(pressures),
            **_craft(p),
        )
        flights.append(flown)
        parts = [flown.kept, *(q.kept[..., None] for q in (flown.factor, flown.voltage, flown.pressure))]
        return np.concatenate(parts, axis=-1)

    found = chaos.expand(fly, wind.shape, wind.scale, item.order, item.basis)
    flown = flights[0]
    spread = found.coefficients[1:, :, :6]
    at = found.percentile(np.array(LEVELS))
    ensemble = replace(
        flown,
        time=times,
        mean=found.mean[:, :6],
        covariance=np.einsum("ntk,ntl->tkl", spread, spread),
        percentiles=at[..., :6],
        factor=replace(flown.factor, percentiles=at[..., 6]),
        voltage=replace(flown.voltage, percentiles=at[..., 7]),
        pressure=replace(flown.pressure, percentiles=at[..., 8]),
    )
    words = f"gamma, {drawn.mean * 1e9:.3g} nPa, constant"
    return _statistics(p, item, law, words, step, ensemble, "polynomial-chaos", {}, float(np.max(found.tail[-1, :2])))


def _statistics(
    p: Plan,
    item: Ensemble | Chaos,
    law: Control,
    wind: str,
    step: np.ndarray,
    flown: Flown,
    method: str,
    more: dict[str, np.ndarray],
    tail: float = 0.0,
) -> EnsembleStatistics:
    """What a recording says of flights. more : further quantities of the recorded flights, name with unit -> (k, n)."""
    electric = isinstance(p.scene.device, ElectricSail)
    planar = not np.any(flown.nominal[:, [2, 5]]) and not np.any(flown.kept[..., 2])
    places = ("radius_m" if planar else "axis_distance_m", "azimuth_rad", "height_m")
    names = (*places, "radial_speed_m_s", "transverse_speed_m_s", "axis_speed_m_s")
    wanted = [k for k in range(6) if not planar or k not in (2, 5)]
    bands = {names[k]: flown.percentiles[..., k] for k in wanted}
    one = {"thrust_factor": flown.factor.kept[0]}
    bands["thrust_factor"] = flown.factor.percentiles
    if electric:
        bands |= {"thrust_voltage_V": flown.voltage.percentiles, "solar_wind_pressure_Pa": flown.pressure.percentiles}
        one |= {"thrust_voltage_V": flown.voltage.kept[0], "solar_wind_pressure_Pa": flown.pressure.kept[0]}
    for name, values in more.items():
        bands[name] = np.percentile(values, flown.levels, axis=0)
        one[name] = values[0]
    miss = flown.kept - flown.nominal
    across = flown.nominal[:, 0]
    distance = np.sqrt(miss[..., 0] ** 2 + (across * miss[..., 1]) ** 2 + miss[..., 2] ** 2)
    keep = min(item.keep, len(flown.kept)) if isinstance(item, Ensemble) else len(flown.kept)
    control = None if law is None else law.kind
    mean, deviation = flown.mean, flown.standard_deviation
    end_mean, end_deviation = flown.mean[-1], deviation[-1]
    if method == "monte-carlo":
        end_mean, end_deviation = flown.end.mean(axis=0), flown.end.std(axis=0, ddof=1)
    limits = _limits(law, flown) if electric else {}
    return EnsembleStatistics(
        name=item.name,
        words=_words(law, electric),
        wind=wind,
        method=method,
        control=control or "none",
        flights=flown.flights,
        seed=int(flown.seed),
        planar=bool(planar),
        step=step,
        time=flown.time,
        axes=flown.axes,
        nominal=flown.nominal,
        kept=flown.kept[:keep],
        mean=mean,
        covariance=flown.covariance,
        levels=flown.levels,
        percentiles=bands,
        one=one,
        saturated=flown.saturated,
        end=flown.end,
        end_mean=end_mean,
        end_deviation=end_deviation,
        mean_factor=float(np.mean(flown.flight_factor)),
        mean_voltage=float(np.mean(flown.flight_voltage)) if electric else float("nan"),
        mean_saturated=float(np.mean(flown.flight_saturated)) if electric else 0.0,
        limits=limits,
        miss=distance,
        error=float(max(flown.error, 0.0)),
        tail=tail,
    )


def _limits(law: Control, flown: Flown) -> dict[str, float]:
    """What bounds the voltage, V and Pa."""
    from sailviz.propulsion.voltage_control import MAXIMUM, NOMINAL, WIND

    row = flown.control
    found = {"nominal_voltage_V": float(row[NOMINAL]), "reference_pressure_Pa": flown.reference_pressure}
    if law is not None:
        found["maximum_voltage_V"] = float(row[MAXIMUM])
        slope = (row[MAXIMUM] - row[WIND]) / (row[NOMINAL] - row[WIND])
        found["saturation_pressure_Pa"] = flown.reference_pressure / slope**2
    return found


def _words(law: Control, electric: bool) -> str:
    if law is None:
        return "constant voltage" if electric else "no control"
    if isinstance(law, ElectrochromicControl):
        return f"{100 * law.fraction:.2g} % of the sail turns black"
    return f"{law.kind} law, at most {law.maximum_voltage / 1e3:g} kV"


def _with_histograms(found: list[EnsembleStatistics]) -> tuple[EnsembleStatistics, ...]:
    """The same ensembles with histograms of how far flights are from the nominal one, all in the same bins."""
    top = max(float(np.percentile(one.miss[:, -1], 99)) for one in found)
    edges = np.linspace(0.0, 1.05 * max(top, 1e-9 * AU), BINS + 1)
    done = []
    for one in found:
        place = np.minimum(np.searchsorted(edges, one.miss, side="right") - 1, BINS - 1)
        counts = np.array([np.bincount(column, minlength=BINS) for column in place.T])
        done.append(replace(one, histogram_edges=edges, histogram=counts / len(one.miss)))
    return tuple(done)
