"""When a scene's thrust changes: the times at which wind, sunlight, switches or a controller act, and how much."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz.calendar import naive_utc
from sailviz.constants import SOLAR_IRRADIANCE, WIND_POTENTIAL, WIND_PRESSURE
from sailviz.environment import irradiance
from sailviz.environment.solar_wind import laws
from sailviz.environment.solar_wind.pressure import history, replay, thrust_factor, wind_potential, yearly_factor
from sailviz.errors import Fault, SceneError
from sailviz.propagate import voltage_callback
from sailviz.scene.device import DistanceControl, ElectricSail, ElectrochromicControl, PressureControl, control_of
from sailviz.scene.environment import (
    BurrWind,
    CyclicIrradiance,
    GammaWind,
    LognormalWind,
    ReplayedWind,
    SteadyWind,
)
from sailviz.scene.named_files import folder_of
from sailviz.scene.values import Section

if TYPE_CHECKING:
    from sailviz.environment.solar_wind.series import Series
    from sailviz.scene.loading import Scene
from sailviz.propulsion import voltage_control

Drawn = GammaWind | LognormalWind | BurrWind
NOMINAL_VOLTAGE = 20e3  # V, of an electric sail that does not say its own


@dataclass(frozen=True)
class Schedule:
    """The thrust factor of a whole run, piecewise constant. All arrays (k,), one value per break."""

    breaks: np.ndarray  # s
    factors: np.ndarray  # thrust over nominal thrust from each break on; a controller overwrites it as the run goes
    switches: tuple[tuple[float, str], ...]  # (time s, "thrust on" | "thrust off")
    histories: dict[str, np.ndarray] = field(default_factory=dict)  # column of the environment -> values
    lines: np.ndarray | None = None  # (k, 8) what a controller knows at each break, see propagate.voltage_callback
    law: np.ndarray | None = None  # the controller's row


def schedule(scene: Scene, table: np.ndarray | None, jumps: tuple[float, ...] = ()) -> Schedule:
    """Everything in a scene that makes its thrust jump. table, or None, and jumps s : of the steering. SceneError for a
    wind file that cannot be used."""
    duration = scene.propagation.duration
    intervals = scene.device.active
    edges = [edge for pair in intervals or [] for edge in pair]
    smooth = table is None or getattr(scene.steering, "interpolation", "cubic") == "cubic"
    weather = _weather(scene, duration)
    law = control_of(scene.device)
    updates: np.ndarray = np.zeros(1)
    if isinstance(law, (PressureControl, DistanceControl)):
        updates = law.interval * np.arange(int(np.ceil(duration / law.interval * (1 - 1e-12))))
    breaks = np.unique(
        np.concatenate([[0.0], weather.times, updates, edges, jumps, [] if table is None or smooth else table[:, 0]])
    )
    breaks = breaks[(breaks >= 0) & (breaks < duration)]
    now = np.searchsorted(weather.times, breaks, side="right") - 1
    on = np.ones(len(breaks), dtype=bool)
    if intervals is not None:
        on = np.array([any(a <= t < b for a, b in intervals) for t in breaks])
    switches = tuple(
        (time, word)
        for pair in intervals or []
        for time, word in zip(pair, ("thrust on", "thrust off"), strict=True)
        if 0 < time <= duration
    )
    histories = {name: values[now] for name, values in weather.columns.items()}
    if not isinstance(law, (PressureControl, DistanceControl)):
        return Schedule(breaks, weather.factors[now] * on, switches, histories)
    lines = np.zeros((len(breaks), voltage_callback.COLUMNS))
    lines[:, voltage_callback.PRESSURE], lines[:, voltage_callback.DENSITY] = (
        weather.pressure[now],
        weather.density[now],
    )
    lines[:, voltage_callback.POTENTIAL], lines[:, voltage_callback.UPDATE] = (
        weather.potential[now],
        np.isin(breaks, updates),
    )
    lines[:, voltage_callback.WANTED] = on
    return Schedule(breaks, on.astype(float), switches, histories, lines, control_row(law, scene, weather.reference))


@dataclass(frozen=True)
class _Weather:
    """What blows or shines from each time on, (m,)."""

    times: np.ndarray
    factors: np.ndarray  # of the thrust, without a controller
    columns: dict[str, np.ndarray]
    pressure: np.ndarray  # Pa
    density: np.ndarray  # 1/m3
    potential: np.ndarray  # V
    reference: float  # Pa


def control_row(law: PressureControl | DistanceControl | None, scene: Scene, reference: float) -> np.ndarray:
    """The row of `voltage_control` for a controller of the scene's craft, None for constant voltage; reference Pa."""
    potential = _potential(scene)
    if law is None:
        nominal = _voltage(scene)
        highest = max(nominal, 2 * NOMINAL_VOLTAGE)
        return voltage_control.row(
            nominal_voltage=nominal, maximum_voltage=highest, wind_potential=potential, reference_pressure=reference
        )
    return voltage_control.row(
        law.kind,
        nominal_voltage=law.nominal_voltage,
        maximum_voltage=law.maximum_voltage,
        minimum_voltage=law.minimum_voltage,
        wind_potential=potential,
        reference_pressure=reference,
        interval=law.interval,
        dead_band=law.dead_band,
        position_gain=law.position_gain if isinstance(law, DistanceControl) else 0.0,
        speed_gain=law.speed_gain if isinstance(law, DistanceControl) else 0.0,
    )


def _voltage(scene: Scene) -> float:
    """Nominal, V: of an electric sail that does not say its own too."""
    own = scene.device.voltage if isinstance(scene.device, ElectricSail) else None
    return own or NOMINAL_VOLTAGE


def _weather(scene: Scene, duration: float) -> _Weather:
    wind, light = scene.environment.solar_wind, scene.environment.irradiance
    if isinstance(light, CyclicIrradiance):
        return _sunlight(scene, light, duration)
    return WINDS[type(wind)](scene, wind, duration)


def _potential(scene: Scene) -> float:
    """Of the solar wind's ions, V."""
    return scene.device.wind_potential if isinstance(scene.device, ElectricSail) else WIND_POTENTIAL


def _steady(scene: Scene, wind: SteadyWind, duration: float) -> _Weather:
    pressure = scene.device.wind_pressure if isinstance(scene.device, ElectricSail) else WIND_PRESSURE
    one = np.ones(1)
    return _Weather(np.zeros(1), one, {}, pressure * one, np.nan * one, _potential(scene) * one, pressure)


def _drawn(scene: Scene, wind: Drawn, duration: float) -> _Weather:
    law = wind_law(wind)
    times: np.ndarray = np.zeros(1)
    if wind.variation != "constant":
        times = wind.redraw * np.arange(int(np.ceil(duration / wind.redraw)))
    memory = {"correlation_time": wind.correlation_time} if wind.variation == "correlated" else {}
    pressure = history(law, times, wind.seed, wind.variation, **memory)
    if wind.yearly_deviation:
        pressure = pressure * yearly_factor(times, wind.seed, wind.yearly_deviation)
    reference = reference_pressure(wind, law)
    factors = thrust_factor(pressure, reference)
    flat = np.ones_like(pressure)
    columns = {"solar_wind_pressure_Pa": pressure}
    return _Weather(times, factors, columns, pressure, np.nan * flat, _potential(scene) * flat, reference)


def reference_pressure(wind: Drawn | ReplayedWind, law: laws.Law | Series) -> float:
    """Pressure of nominal thrust, Pa: as a wind says, or from its law or series."""
    given = wind.reference
    return float(law.reference_pressure(given == "unbiased")) if isinstance(given, str) else given


def wind_law(wind: Drawn) -> laws.Law:
    """The law of a drawn wind."""
    values = {name: getattr(wind, name) for name in ("shape", "scale", "sigma", "c", "d") if hasattr(wind, name)}
    return laws.named(wind.kind, **values)


@cache
def _series(path: str, repair: bool, most_rows: int) -> Series:
    """A measured series from any file that the readers know; read once per process. most_rows : with its gaps."""
    from sailviz.environment.solar_wind import series as wind_series

    text = Path(path).suffix.lower() in ("", ".dat", ".txt", ".lst", ".asc")
    return (wind_series.read_omni if text else wind_series.read_series)(path, repair=repair, most_rows=most_rows)


def wind_file(scene: Scene, wind: ReplayedWind) -> Path:
    """Where a wind's series lies: in the folder of the scene file, or below it."""
    return folder_of(scene) / wind.file


def measured_wind(scene: Scene, wind: ReplayedWind, place: str = "environment.solar_wind") -> Series:
    """The measured series of a wind of the scene. SceneError where it cannot be used."""
    try:
        return _series(str(wind_file(scene, wind)), wind.repair, scene.limits.draws)
    except (OSError, ValueError) as error:
        what = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise SceneError([Fault(f"{place}.file", f"{what}.")], scene.source) from None


def _replayed(scene: Scene, wind: ReplayedWind, duration: float) -> _Weather:
    potential = _potential(scene)
    series = measured_wind(scene, wind)
    times = series.step * np.arange(int(np.ceil(duration / series.step * (1 - 1e-12))))
    start = None if wind.start is None else naive_utc(wind.start).isoformat()
    try:
        met = replay(series, times, start=start, seed=wind.seed)
    except ValueError as error:
        raise SceneError([Fault("environment.solar_wind.start", f"{error}.")], scene.source) from None
    if wind.potential == "from speed" and met.speed is None:
        what = "the series has no speed to make a potential of."
        raise SceneError([Fault("environment.solar_wind.potential", what)], scene.source)
    reference = reference_pressure(wind, series)
    v_w = potential * np.ones(len(times))
    factors = thrust_factor(met.pressure, reference)
    columns = {"solar_wind_pressure_Pa": met.pressure}
    if wind.potential == "from speed":
        v_w = wind_potential(met.speed)
        nominal = _voltage(scene)
        factors = factors * np.maximum(0.0, nominal - v_w) / (nominal - potential)
        columns["wind_potential_V"] = v_w
    density = met.density if met.density is not None else np.nan * v_w
    return _Weather(times, factors, columns, met.pressure, density, v_w, reference)


WINDS: dict[type[Section], Callable[[Scene, Any, float], _Weather]] = {
    SteadyWind: _steady,
    GammaWind: _drawn,
    LognormalWind: _drawn,
    BurrWind: _drawn,
    ReplayedWind: _replayed,
}


def _sunlight(scene: Scene, light: CyclicIrradiance, duration: float) -> _Weather:
    times, share = sunlight(scene, light, duration, light.seed)
    columns, factors = {"irradiance_W_m2": SOLAR_IRRADIANCE * share}, share
    law = control_of(scene.device)
    if isinstance(law, ElectrochromicControl):
        factors, columns["electrochromic_state"] = electrochromic(share, law.fraction)
    flat = np.ones_like(share)
    return _Weather(times, factors, columns, flat, flat, flat, 1.0)


def sunlight(
    scene: Scene, light: CyclicIrradiance, duration: float, seed: int, flight: int | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """(times (k,) s, S / S0 (k,)) of a scene's varying Sun."""
    times = light.redraw * np.arange(int(np.ceil(duration / light.redraw)))
    since = 0.0 if scene.epoch is None else irradiance.since_maximum(np.datetime64(scene.epoch_utc, "s"))
    noise = irradiance.flicker(times, seed, light.flicker, flight=flight)
    return times, irradiance.cycle(times, since, light.amplitude) + noise


def electrochromic(share: np.ndarray, fraction: float) -> tuple[np.ndarray, np.ndarray]:
    """(thrust factor, state) (k,) of a sail that pushes as under the smallest S / S0 (k,) of its flight."""
    from sailviz.uncertainty.control import electrochromic_factor, electrochromic_state

    state = electrochromic_state(share, fraction, share.min())
    return share / share.min() * electrochromic_factor(state, fraction), state
