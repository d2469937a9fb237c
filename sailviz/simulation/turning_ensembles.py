"""Scene -> ensembles of a craft that turns: its flights one after the other, each by the way a single flight takes.

A flight has what it drew put over the scene's values and is flown whole; so one that draws nothing else than the scene
says is the scene's own flight, to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sailviz.errors import Fault, PropagationError, SceneError
from sailviz.frames import rotation
from sailviz.run.arrays import AttitudeEnsemble, Run
from sailviz.run.quantities import VALUES
from sailviz.scene.attitude import ControlledAttitude
from sailviz.scene.conflicts.turning_ensembles import draws_of, varies, without_ensembles
from sailviz.scene.device import SolarSail
from sailviz.scene.draws import Draw
from sailviz.scene.loading import Scene, build_scene
from sailviz.scene.overrides import place_of
from sailviz.scene.quantities import spellings
from sailviz.scene.sections import Ensemble
from sailviz.simulation.output_times import OutputTimes
from sailviz.uncertainty.draws import value_of

OUTPUTS = 181  # rows of the run at which ensembles are known
LEVELS = (1.0, 5.0, 25.0, 50.0, 75.0, 95.0, 99.0)
SUNSHINE = "environment.irradiance.seed"

Fly = Callable[[Scene], Iterator[Run]]


def turning_ensembles(
    scene: Scene, output: OutputTimes, fly: Fly, progress: Callable[[float], None], own: bool
) -> tuple[AttitudeEnsemble, ...]:
    """The ensembles of a scene, at some of the times of its output rows. fly : gives the blocks of a flight; progress :
    called with the share that is done; own : whether the scene flies functions of the user's. SceneError for drawn
    values that are none of a craft, PropagationError for a flight that breaks down."""
    if own:
        raise SceneError([Fault("ensemble", "flies the scene's own steering and forces, no functions.")], scene.source)
    step = np.unique(np.round(np.linspace(0, output.rows - 1, min(OUTPUTS, output.rows))).astype(int))
    whole, done, found = sum(item.flights + 1 for item in scene.ensemble), 0, []
    for i, item in enumerate(scene.ensemble):

        def told(flight: int, before: int = done) -> None:
            progress((before + flight) / whole)

        found.append(_Members(scene, item, f"ensemble[{i}]", output, step).flown(fly, told))
        done += item.flights + 1
    return tuple(found)


def columns_of(scene: Scene) -> dict[str, str]:
    """Quantity with its unit -> its name in the table of values, of what a craft that turns has."""
    found = {"pitch_rad": "pitch", "body_rate_rad_s": "body_rate", "nutation_rad": "nutation"}
    lit, said = isinstance(scene.device, SolarSail), scene.attitude
    if lit:
        found["light_torque_N_m"] = "light_torque"
    if lit and getattr(getattr(scene.device, "shape", None), "air", None) is not None:
        found["air_torque_N_m"] = "air_torque"
    if isinstance(said, ControlledAttitude):
        found["control_torque_N_m"] = "control_torque"
        if any(one.kind == "wheels" for one in said.actuators):
            found["wheel_momentum_N_m_s"] = "wheel_momentum"
    found["radius_m"] = "radius"
    return found


@dataclass
class _Flown:
    """What is kept of one flight."""

    columns: dict[str, np.ndarray]  # quantity -> (n,)
    axis: np.ndarray  # (n, 3)
    position: np.ndarray  # (n, 3)
    values: dict[str, float]
    met: dict[str, float] = field(default_factory=dict)


class _Members:
    """The flights of one ensemble."""

    def __init__(self, scene: Scene, item: Ensemble, place: str, output: OutputTimes, step: np.ndarray) -> None:
        self.scene, self.item, self.place, self.output, self.step = scene, item, place, output, step
        self.time = np.array([output.between(int(k), 1)[0] for k in step])
        self.columns, self.draws = columns_of(scene), draws_of(item)
        if varies(scene) and all(one.key != SUNSHINE for one in self.draws):
            self.draws = (*self.draws, Draw(SUNSHINE, "seed"))
        self.seed = int(item.seed if item.seed is not None else getattr(scene.environment.irradiance, "seed", 0) or 0)
        asked = [(spellings()[one.quantity].stem, one.at) for one in scene.expect if one.ensemble == item.name]
        self.asked = [(stem, at) for stem, at in dict.fromkeys(asked) if stem != "share"]
        self.written = {one.key: one.distribution for one in item.draw or ()}
        self.raw = without_ensembles(scene)

    def flown(self, fly: Fly, told: Callable[[int], None]) -> AttitudeEnsemble:
        """All of them, and the scene's own flight after them."""
        flights = self.item.flights
        drawn = {one.key: np.array([value_of(one, self.seed, 0, k) for k in range(flights)]) for one in self.draws}
        found = []
        for k in range(flights):
            values = {one.key: value_of(one, self.seed, 0, k) for one in self.draws}
            found.append(self._one(fly, values, f"flight {k}"))
            told(k + 1)
        nominal = self._one(fly, {}, "the nominal flight")
        told(flights + 1)
        return self._statistics(found, nominal, drawn)

    def _one(self, fly: Fly, values: dict[str, Any], who: str) -> _Flown:
        try:
            scene = build_scene(self.raw, values, self.scene.text, self.scene.source)
            # it keeps the rows that were planned, as the scene's own flight does
            scene = scene.model_copy(update={"ensemble": self.scene.ensemble})
            return self._gathered(fly(scene))
        except SceneError as error:
            told = [self._said(fault, values, who) for fault in error.faults]
            raise SceneError([Fault(self.place, words) for words in told], self.scene.source) from None
        except PropagationError as error:
            words = f"{who} of the ensemble {self.item.name}: {error.args[0]}"
            raise PropagationError(words, error.time, error.state) from None

    def _said(self, fault: Fault, values: dict[str, Any], who: str) -> str:
        near = {key: value for key, value in values.items() if place_of(key).partition(".")[0] in fault.where}
        drew = ", ".join(f"{key} = {value:.6g}" for key, value in near.items())
        return f"{who}{f' drew {drew}' if drew else ''}: {fault.where} {fault.what}"

    def _gathered(self, blocks: Iterator[Run]) -> _Flown:
        columns: dict[str, list[np.ndarray]] = {name: [] for name in self.columns}
        series: dict[str, list[np.ndarray]] = {stem: [] for stem, _ in self.asked}
        time, axis, position = list[np.ndarray](), list[np.ndarray](), list[np.ndarray]()
        met: dict[str, float] = {}
        for run in blocks:
            mine = self.step[(self.step >= run.first) & (self.step < run.first + len(run))] - run.first
            mine = mine[np.isin(run.time[mine], self.time)]
            for name, stem in self.columns.items():
                columns[name].append(VALUES[stem](run)[mine])
            axis.append(rotation(run.attitude.quaternion[mine])[..., 2])
            position.append(run.position[mine])
            time.append(run.time)
            for stem in series:
                series[stem].append(VALUES[stem](run))
            for event in run.events:
                met.setdefault(event.name, event.time)
        values = {}
        for stem, at in self.asked:
            values[f"{stem}@{at}"] = statistic_of(np.concatenate(series[stem]), np.concatenate(time), str(at))
        rows = len(self.step)
        whole = {name: _to(rows, np.concatenate(parts)) for name, parts in columns.items()}
        return _Flown(whole, _to(rows, np.concatenate(axis)), _to(rows, np.concatenate(position)), values, met)

    def _statistics(self, found: list[_Flown], nominal: _Flown, drawn: dict[str, np.ndarray]) -> AttitudeEnsemble:
        keep = min(self.item.keep, len(found))
        events = sorted({name for one in found for name in one.met})
        percentiles, mean, deviation = {}, {}, {}
        for name in self.columns:
            values = np.array([one.columns[name] for one in found])  # (flights, n)
            flying = ~np.all(np.isnan(values), axis=0)
            percentiles[name] = np.full((len(LEVELS), len(self.step)), np.nan)
            percentiles[name][:, flying] = np.nanpercentile(values[:, flying], LEVELS, axis=0)
            mean[name], deviation[name] = np.full((2, len(self.step)), np.nan)
            mean[name][flying] = np.nanmean(values[:, flying], axis=0)
            deviation[name][flying] = np.nanstd(values[:, flying], axis=0, ddof=1)
        return AttitudeEnsemble(
            name=self.item.name,
            words="; ".join(f"{one.key} {self.written.get(one.key, one.words())}" for one in self.draws),
            flights=len(found),
            seed=self.seed,
            step=self.step,
            time=self.time,
            levels=np.array(LEVELS),
            percentiles=percentiles,
            mean=mean,
            deviation=deviation,
            nominal=nominal.columns,
            kept_axis=np.array([one.axis for one in found[:keep]]),
            kept_position=np.array([one.position for one in found[:keep]]),
            drawn=drawn,
            met={name: np.array([one.met.get(name, np.nan) for one in found]) for name in events},
            values={name: np.array([one.values[name] for one in [*found, nominal]]) for name in nominal.values},
        )


def _to(rows: int, values: np.ndarray) -> np.ndarray:
    """As many rows (rows, ...), NaN where a flight ended before."""
    found = np.full((rows, *values.shape[1:]), np.nan)
    found[: len(values)] = values[:rows]
    return found


def statistic_of(values: np.ndarray, time: np.ndarray, at: str) -> float:
    """What a flight's values (n,) at times (n,) s are at its "start" and "end", at their "min" and "max", and in their
    "mean" over time."""
    known = ~np.isnan(values)
    if not known.any():
        return float("nan")
    values, time = values[known], time[known]
    if at == "mean":
        span = time[-1] - time[0]
        return float(np.trapezoid(values, time) / span) if span > 0 else float(values[0])
    ways: dict[str, Callable[[np.ndarray], Any]] = {
        "start": lambda v: v[0],
        "end": lambda v: v[-1],
        "min": np.min,
        "max": np.max,
    }
    return float(ways[at](values))
