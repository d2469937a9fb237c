"""When a scene's thrust changes: the times at which wind, sunlight, switches or a controller act, and how much."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime
from functools import cache
from pathlib import Path

import numpy as np

from sailviz.constants import SOLAR_IRRADIANCE, WIND_POTENTIAL, WIND_PRESSURE
from sailviz.environment import irradiance
from sailviz.environment.solar_wind import laws as wind_laws
from sailviz.environment.solar_wind import pressure as solar_wind
from sailviz.errors import Fault, SceneError
from sailviz.propagate import voltage_callback as knows
from sailviz.propulsion import voltage_control as control

NOMINAL_VOLTAGE = 20e3  # V, of an electric sail that does not say its own


@dataclass(frozen=True)
class Schedule:
    """The thrust factor of a whole run, piecewise constant. All arrays (k,), one value per break."""

    breaks: np.ndarray  # s
    factors: np.ndarray  # thrust over nominal thrust from each break on; a controller overwrites it as the run goes
    switches: tuple[tuple[float, str], ...]  # (time s, "thrust on" | "thrust off")
    histories: dict[str, np.ndarray] = field(default_factory=dict)  # column of the environment -> values
    lines: np.ndarray | None = None  # (k, 8) what a controller knows at each break, see propagate.control_plug
    law: np.ndarray | None = None  # the controller's row


def schedule(scene, table) -> Schedule:
    """Everything in a scene that makes its thrust jump. table : of the steering, or None. SceneError for a wind file
    that cannot be used."""
    duration = scene.propagation.duration
    intervals = scene.device.active
    edges = [edge for pair in intervals or [] for edge in pair]
    smooth = table is None or getattr(scene.steering, "interpolation", "cubic") == "cubic"
    weather = _weather(scene, duration)
    law = getattr(scene.device, "control", None)
    updates = np.zeros(1)
    if law is not None and law.kind != "electrochromic":
        updates = law.interval * np.arange(int(np.ceil(duration / law.interval * (1 - 1e-12))))
    breaks = np.unique(np.concatenate([[0.0], weather.times, updates, edges, [] if smooth else table[:, 0]]))
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
    if law is None or law.kind == "electrochromic":
        return Schedule(breaks, weather.factors[now] * on, switches, histories)
    lines = np.zeros((len(breaks), knows.COLUMNS))
    lines[:, knows.PRESSURE], lines[:, knows.DENSITY] = weather.pressure[now], weather.density[now]
    lines[:, knows.POTENTIAL], lines[:, knows.UPDATE] = weather.potential[now], np.isin(breaks, updates)
    lines[:, knows.WANTED] = on
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


def control_row(law, scene, reference):
    """The row of propagate.control for a controller of the scene's craft, None for constant voltage; reference Pa."""
    potential = getattr(scene.device, "wind_potential", WIND_POTENTIAL)
    if law is None:
        nominal = getattr(scene.device, "voltage", None) or NOMINAL_VOLTAGE
        highest = max(nominal, 2 * NOMINAL_VOLTAGE)
        return control.row(
            nominal_voltage=nominal, maximum_voltage=highest, wind_potential=potential, reference_pressure=reference
        )
    return control.row(
        law.kind,
        nominal_voltage=law.nominal_voltage,
        maximum_voltage=law.maximum_voltage,
        minimum_voltage=law.minimum_voltage,
        wind_potential=potential,
        reference_pressure=reference,
        interval=law.interval,
        dead_band=law.dead_band,
        position_gain=getattr(law, "position_gain", 0.0),
        speed_gain=getattr(law, "speed_gain", 0.0),
    )


def _weather(scene, duration) -> _Weather:
    wind, light = scene.environment.solar_wind, scene.environment.irradiance
    one = np.ones(1)
    potential = getattr(scene.device, "wind_potential", WIND_POTENTIAL)
    if light.kind != "steady":
        return _sunlight(scene, light, duration)
    if wind.kind == "steady":
        pressure = getattr(scene.device, "wind_pressure", WIND_PRESSURE)
        return _Weather(np.zeros(1), one, {}, pressure * one, np.nan * one, potential * one, pressure)
    if wind.kind == "replay":
        return _replayed(scene, wind, duration, potential)
    law = wind_law(wind)
    times = np.zeros(1)
    if wind.variation != "constant":
        times = wind.redraw * np.arange(int(np.ceil(duration / wind.redraw)))
    memory = {"correlation_time": wind.correlation_time} if wind.variation == "correlated" else {}
    pressure = solar_wind.history(law, times, wind.seed, wind.variation, **memory)
    if wind.yearly_deviation:
        pressure = pressure * solar_wind.yearly_factor(times, wind.seed, wind.yearly_deviation)
    reference = reference_pressure(wind, law)
    factors = solar_wind.thrust_factor(pressure, reference)
    flat = np.ones_like(pressure)
    columns = {"solar_wind_pressure_Pa": pressure}
    return _Weather(times, factors, columns, pressure, np.nan * flat, potential * flat, reference)


def reference_pressure(wind, law) -> float:
    """Pressure of nominal thrust, Pa: as a wind says, or from its law or series."""
    given = wind.reference
    return law.reference_pressure(given == "unbiased") if isinstance(given, str) else given


def wind_law(wind) -> wind_laws.Law:
    """The law of a drawn wind."""
    values = {name: getattr(wind, name) for name in ("shape", "scale", "sigma", "c", "d") if hasattr(wind, name)}
    return wind_laws.named(wind.kind, **values)


@cache
def _series(path, repair):
    """A measured series from any file that the readers know; read once per process."""
    from sailviz.environment.solar_wind import series as wind_series

    text = Path(path).suffix.lower() in ("", ".dat", ".txt", ".lst", ".asc")
    return (wind_series.read_omni if text else wind_series.read_series)(path, repair=repair)


def wind_file(scene, wind) -> Path:
    """Where a wind's series lies: beside the scene file, or an absolute path."""
    here = Path(scene.source).parent if Path(scene.source).is_file() else Path()
    return here / wind.file


def measured_wind(scene, wind, place="environment.solar_wind"):
    """The measured series of a wind of the scene. SceneError where it cannot be used."""
    try:
        return _series(str(wind_file(scene, wind)), wind.repair)
    except (OSError, ValueError) as error:
        what = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise SceneError([Fault(f"{place}.file", f"{what}.")], scene.source) from None


def _replayed(scene, wind, duration, potential) -> _Weather:
    series = measured_wind(scene, wind)
    times = series.step * np.arange(int(np.ceil(duration / series.step * (1 - 1e-12))))
    start = wind.start
    if start is not None:
        start = start.isoformat() if not isinstance(start, datetime) else start.replace(tzinfo=None).isoformat()
    try:
        met = solar_wind.replay(series, times, start=start, seed=wind.seed)
    except ValueError as error:
        raise SceneError([Fault("environment.solar_wind.start", f"{error}.")], scene.source) from None
    if wind.potential == "from speed" and met.speed is None:
        what = "the series has no speed to make a potential of."
        raise SceneError([Fault("environment.solar_wind.potential", what)], scene.source)
    reference = reference_pressure(wind, series)
    v_w = potential * np.ones(len(times))
    factors = solar_wind.thrust_factor(met.pressure, reference)
    columns = {"solar_wind_pressure_Pa": met.pressure}
    if wind.potential == "from speed":
        v_w = solar_wind.wind_potential(met.speed)
        nominal = scene.device.voltage or NOMINAL_VOLTAGE
        factors = factors * np.maximum(0.0, nominal - v_w) / (nominal - potential)
        columns["wind_potential_V"] = v_w
    density = met.density if met.density is not None else np.nan * v_w
    return _Weather(times, factors, columns, met.pressure, density, v_w, reference)


def _sunlight(scene, light, duration) -> _Weather:
    times, share = sunlight(scene, light, duration, light.seed)
    columns, factors = {"irradiance_W_m2": SOLAR_IRRADIANCE * share}, share
    law = scene.device.control
    if law is not None:
        factors, columns["electrochromic_state"] = electrochromic(share, law.fraction)
    flat = np.ones_like(share)
    return _Weather(times, factors, columns, flat, flat, flat, 1.0)


def sunlight(scene, light, duration, seed, flight=None):
    """(times (k,) s, S / S0 (k,)) of a scene's varying Sun."""
    times = light.redraw * np.arange(int(np.ceil(duration / light.redraw)))
    since = 0.0 if scene.epoch is None else irradiance.since_maximum(np.datetime64(scene.epoch_utc, "s"))
    noise = irradiance.flicker(times, seed, light.flicker, flight=flight)
    return times, irradiance.cycle(times, since, light.amplitude) + noise


def electrochromic(share, fraction):
    """(thrust factor, state) (k,) of a sail that pushes as under the smallest S / S0 (k,) of its flight."""
    from sailviz.uncertainty.control import electrochromic_factor, electrochromic_state

    state = electrochromic_state(share, fraction, share.min())
    return share / share.min() * electrochromic_factor(state, fraction), state
