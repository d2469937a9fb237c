"""Real space weather of a scene: its file read, continued as the scene says, and made into tables for its dates."""

from __future__ import annotations

from functools import cache, lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sailviz.environment import atmosphere, solar_level
from sailviz.environment.space_weather import CONTINUED, DAYS_BEFORE, SpaceWeather, cycle_flux, read
from sailviz.errors import Fault, SceneError
from sailviz.scene import environment
from sailviz.scene.environment import MsisAtmosphere
from sailviz.scene.named_files import folder_of
from sailviz.simulation.lowered import Array, Columns, Place, Words

HERE = "environment.space_weather"
CONTINUED_BY = {
    "cycle": "the smooth cycle of solar_level.py",
    "11 years earlier": "the days of 11 years earlier",
}


class Source(NamedTuple):
    """What days are made of: a file as it was at a time (ns), and what holds after its last day, until another."""

    path: str
    changed: int
    continuation: str | None
    flux: float | None  # sfu
    ap: float
    until: str


@cache
def _read(path: str, changed: int) -> SpaceWeather:
    return read(path)


@lru_cache(8)
def _continued(source: Source) -> SpaceWeather:
    weather, constant = _read(source.path, source.changed), source.flux
    if source.continuation is None:
        return weather
    flux_of = cycle_flux if source.continuation == "cycle" else None
    if constant is not None:
        flux_of = lambda days: np.full(len(days), constant)  # noqa: E731
    return weather.continued(np.datetime64(source.until), flux_of, source.ap)


@lru_cache(1)  # a scene is planned more than once, and a table may have a gigabyte
def _air(source: Source, start: np.datetime64, duration: float, storms: bool) -> Array:
    table: Array = atmosphere.table_of_weather(start, duration, _continued(source).given, storms)
    return table


def _source(part: environment.SpaceWeather, place: Place) -> Source:
    """The days that a scene names. SceneError where its file is none, or does not reach."""
    scene, epoch = place.scene, place.epoch
    assert epoch is not None  # or the scene would not have been accepted
    path = folder_of(scene) / part.file
    try:
        changed = path.stat().st_mtime_ns
        weather = _read(str(path), changed)
    except (OSError, ValueError) as error:
        what = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise SceneError([Fault(f"{HERE}.file", f"{path.name}: {what}.")], scene.source) from None
    needed = atmosphere.moments_of_weather(epoch, scene.propagation.duration, part.storms).astype("datetime64[D]")
    earliest = needed[0] - DAYS_BEFORE
    if earliest < weather.first:
        words = f"the file begins on {weather.first}, and this run needs it from {earliest} on."
        raise SceneError([Fault(f"{HERE}.file", words)], scene.source)
    if needed[-1] > weather.last and part.continuation is None:
        words = (
            f"the file ends on {weather.last}, and this run needs it until {needed[-1]}: say what holds then, "
            '"cycle", "constant" or "11 years earlier".'
        )
        raise SceneError([Fault(f"{HERE}.continuation", words)], scene.source)
    until = str(needed[-1])
    return Source(str(path), changed, part.continuation, part.continued_solar_flux, part.continued_ap, until)


def _weather(part: environment.SpaceWeather, place: Place) -> SpaceWeather:
    try:
        return _continued(_source(part, place))
    except ValueError as error:
        raise SceneError([Fault(f"{HERE}.continuation", f"{error}.")], place.scene.source) from None


def lowered(part: environment.SpaceWeather, place: Place) -> dict[str, Any]:
    """Keywords of `dynamics.model`: the air of the run's days, and the solar level of its ionosphere, which takes the
    mean flux of 81 days."""
    weather, scene, start = _weather(part, place), place.scene, place.epoch
    assert start is not None
    duration = scene.propagation.duration
    noons = atmosphere.moments_of_weather(start, duration)
    _, mean_flux, _ = weather.given(noons)
    first = (noons[0].astype("datetime64[ns]") - start) / np.timedelta64(1, "ns") * 1e-9
    found: dict[str, Any] = {
        "solar_level": solar_level.daily(len(noons), float(first)),
        "solar_level_table": mean_flux,
    }
    if isinstance(scene.environment.atmosphere, MsisAtmosphere):
        found["air_table"] = _air(_source(part, place), start, duration, part.storms)
    return found


def in_words(part: environment.SpaceWeather, place: Place) -> Words:
    """Where the numbers are from, and how many of the run's days are measured and how many are not."""
    weather, start, duration = _weather(part, place), place.epoch, place.scene.propagation.duration
    assert start is not None
    counts = weather.counts(start, duration)
    words = ", ".join(f"{count} {kind}" for kind, count in counts.items())
    if CONTINUED in counts and part.continuation is not None:
        constant = f"a constant {part.continued_solar_flux or 0.0:g} sfu"
        words += f" by {CONTINUED_BY.get(part.continuation, constant)}"
    rows = [("space weather", Path(part.file).name), ("days of it", words)]
    if short := weather.short_means(start, duration):
        rows.append(("mean of F10.7", f"over fewer than 81 days on {short} of them"))
    return rows


def columns(part: environment.SpaceWeather, place: Place, time: Array, states: Array) -> Columns:
    """F10.7 of the day before, its mean over 81 days, and ap, as the air is given them at times (n,) s."""
    assert place.epoch is not None
    dates = place.epoch + np.round(time * 1e9).astype("timedelta64[ns]")
    flux, mean_flux, ap = _weather(part, place).given(dates)
    return {
        "solar_flux_sfu": flux,
        "solar_flux_mean_sfu": mean_flux,
        "geomagnetic_ap": ap[:, 1] if part.storms else ap[:, 0],
    }
