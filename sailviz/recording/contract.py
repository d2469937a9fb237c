"""The numbers of a run as they are: float64, SI, radians, every row. This is the contract `sailviz/1`.

/state        time_s, position_m (3), velocity_m_s (3), mass_kg
/attitude     pitch_rad, cone_rad, clock_rad, normal (3), quaternion (xyzw, body to inertial); of a stowed sail the
              normal is 0, pitch and clock are NaN. Of a craft whose attitude moves by itself also rate_rad_s (body
              axes, 3), angular_momentum_N_m_s (inertial, 3) and, with wheels, wheels_N_m_s (body axes, 3); of a spin
              that is averaged the quaternion has the axis right, and the turn about it by convention
/thrust       acceleration_m_s2 (inertial, 3), acceleration_rtn_m_s2 (3), magnitude_m_s2, on (bool)
/thrust/NAME  the same of each device of a list of them; /thrust is their sum, on where one of them is, and /attitude
              that of the first sail, or without one of the first device; the cone angle is that of the whole thrust
/elements     semi_major_axis_m, eccentricity, inclination_rad, raan_rad, argument_rad, true_anomaly_rad
/environment  whatever acted, the unit in each name, (n,) or (n, 3); absent where nothing did
/film         of a solar sail whose film ages or whose temperature is told: dose_yr, temperature_K, b1, b2, b3; absent
              where nothing of it is asked, b1 to b3 and dose of a film that does not age; NaN where it is not known
/phases       number of the phase, 1 for the first; absent in flights without. Their names and spans stand in /scene
/approximation  NAME_position_m (3) and NAME_error_m of every other answer that was asked for; absent without any
/ensemble/NAME  of every ensemble, at times of some of the rows: nominal_position_m and mean_position_m (3),
              covariance_m2 (9: radial, along and across the orbit, about the mean); percentiles at `levels`, columns of
              that many numbers, unit in each name; kept_position_m (3 per flight drawn); one_NAME of the first flight;
              saturated and histogram, shares. /ensemble/NAME/facts, static: levels, ends of the flights, words
/attitude_ensemble/NAME  of every ensemble of a craft that turns: see `recording.attitude_ensembles`
/events       name, time_s, state (position m, velocity m/s, mass kg: 7), at the first row not before the event
/scene        static: what the run was made from and how far it got; gaps_s (start, end) of each span without data;
              phases, names, phases_s (start, end), NaN of one that never came, and phases_words, what held;
              `flights`, the names of all, where several were recorded together
/filled       points between rows that lie far apart, for the eye alone: row, the number of the row before, time_s,
              position_m and velocity_m_s (3), coast (bool), whether gravity alone leads to the next row. They have no
              step, are no rows and are neither compared nor exported; absent where nothing was filled
/flight/NAME  of each flight beside the first of those: the same entities below it, /flight/NAME/state and so on, with
              the numbers of its own rows, on the first one's clock; and, of the first as well, /flight/NAME/scene, with
              its `name` and `start_s`, when its own time is 0 on that clock

Each is one archetype `sailviz.<Entity>` on the timelines step (the row's number), sim_time and, with an epoch, utc.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pyarrow as pa
import rerun as rr
from numpy.typing import ArrayLike

from sailviz.run.arrays import EnsembleStatistics, Event, Run, Setting, Thrust
from sailviz.run.filling import Points

CONTRACT = "sailviz/1"
FILLED = "/filled"


def archetype(entity: str) -> str:
    """Name of the archetype of an entity: /state -> sailviz.State, /ensemble/calm -> sailviz.Ensemble."""
    return "sailviz." + "".join(part.capitalize() for part in entity.strip("/").split("/")[0].split("_"))


def flight_path(name: str) -> str:
    """Above the entities of one of several flights."""
    return f"/flight/{word(name)}"


def thrust_path(name: str) -> str:
    """The entity of what one of several devices does."""
    return f"/thrust/{word(name)}"


def thrust_table(thrust: Thrust) -> dict[str, np.ndarray]:
    """The columns of /thrust, (n,) or (n, 3)."""
    return {
        "acceleration_m_s2": thrust.acceleration,
        "acceleration_rtn_m_s2": thrust.acceleration_rtn,
        "magnitude_m_s2": thrust.magnitude,
        "on": thrust.on,
    }


def tables(run: Run) -> dict[str, dict[str, np.ndarray]]:
    """The f64 columns of a run by entity and name, in the order of the contract. Arrays (n,) or (n, k)."""
    attitude, thrust, elements = run.attitude, run.thrust, run.elements
    return {
        "/state": {
            "time_s": run.time,
            "position_m": run.position,
            "velocity_m_s": run.velocity,
            "mass_kg": run.mass,
        },
        "/attitude": {
            "pitch_rad": attitude.pitch,
            "cone_rad": attitude.cone,
            "clock_rad": attitude.clock,
            "normal": attitude.normal,
            "quaternion": attitude.quaternion,
            **attitude.motion,
        },
        "/thrust": thrust_table(thrust),
        **{thrust_path(name): thrust_table(device) for name, device in run.devices.items()},
        "/elements": {
            "semi_major_axis_m": elements.semi_major_axis,
            "eccentricity": elements.eccentricity,
            "inclination_rad": elements.inclination,
            "raan_rad": elements.raan,
            "argument_rad": elements.argument,
            "true_anomaly_rad": elements.true_anomaly,
        },
        "/environment": dict(run.environment),
        "/film": dict(run.film),
        "/phases": {"number": 1.0 + run.setting.phase_of(run.time)} if run.setting.phases else {},
        "/approximation": {
            key: value
            for name, position in run.approximations.items()
            for key, value in (
                (f"{word(name)}_position_m", position),
                (f"{word(name)}_error_m", np.linalg.norm(position - run.position, axis=1)),
            )
        },
    }


ENDS = 10_000  # flights whose ends are recorded


def ensemble_path(ensemble: EnsembleStatistics) -> str:
    """The entity of an ensemble."""
    return f"/ensemble/{word(ensemble.name)}"


def ensemble_table(ensemble: EnsembleStatistics) -> dict[str, np.ndarray]:
    """The columns of /ensemble/NAME, (n,) or (n, k)."""
    length = np.ones((len(ensemble.time), 3))
    length[:, 1] = ensemble.mean[:, 0]  # azimuth becomes a way along the orbit
    along = ensemble.covariance[:, :3, :3] * length[:, :, None] * length[:, None, :]
    places = ensemble.places(ensemble.kept)
    return {
        "time_s": ensemble.time,
        "nominal_position_m": ensemble.places(ensemble.nominal),
        "mean_position_m": ensemble.places(ensemble.mean),
        "covariance_m2": along.reshape(-1, 9),
        **{name: values.T for name, values in ensemble.percentiles.items()},
        **{f"one_{name}": values for name, values in ensemble.one.items()},
        "saturated": ensemble.saturated,
        "histogram": ensemble.histogram,
        "kept_position_m": places.transpose(1, 0, 2).reshape(len(ensemble.time), -1),
    }


def ensemble_facts(ensemble: EnsembleStatistics) -> rr.DynamicArchetype:
    """The static entity /ensemble/NAME/facts."""
    names = ("radius_m", "azimuth_rad", "height_m", "radial_speed_m_s", "transverse_speed_m_s", "axis_speed_m_s")
    ends = ensemble.end[:ENDS]
    values = {
        **{
            name: [getattr(ensemble, name)]
            for name in ("name", "words", "wind", "method", "control", "flights", "seed")
        },
        **{
            name: [float(getattr(ensemble, name))]
            for name in ("mean_factor", "mean_voltage", "mean_saturated", "error")
        },
        **{name: [value] for name, value in ensemble.limits.items()},
        "tail": [float(ensemble.tail)],
        "levels": ensemble.levels,
        "histogram_edges_m": ensemble.histogram_edges,
        **{f"end_{name}": ends[:, k] for k, name in enumerate(names)},
        **{f"nominal_end_{name}": ensemble.nominal[-1:, k] for k, name in enumerate(names)},
    }
    return rr.DynamicArchetype(archetype("/ensemble"), components={name: pa.array(v) for name, v in values.items()})


def word(name: str) -> str:
    """A name as part of a column's or an entity's: "first order" -> first_order."""
    return "".join(letter if letter.isalnum() else "_" for letter in name.lower())


def arrow_column(given: ArrayLike) -> pa.Array:
    """(n,) or (n, k) -> an Arrow column of n rows, f64, or bool where the values are."""
    values = np.asarray(given)
    values = np.ascontiguousarray(values, dtype=bool if values.dtype == bool else np.float64)
    flat = pa.array(values.ravel())
    return flat if values.ndim == 1 else pa.FixedSizeListArray.from_arrays(flat, values.shape[1])


def columns(entity: str, table: dict[str, np.ndarray]) -> Iterable[rr.ComponentColumn]:
    """A table of numpy arrays as columns that a stream takes."""
    return rr.DynamicArchetype.columns(
        archetype=archetype(entity), components={name: arrow_column(values) for name, values in table.items()}
    )


def filled_table(points: Points) -> dict[str, np.ndarray]:
    """The columns of /filled."""
    return {
        "row": points.row.astype(float),
        "time_s": points.time,
        "position_m": points.position,
        "velocity_m_s": points.velocity,
        "coast": points.coast,
    }


def event_columns(events: list[Event]) -> Iterable[rr.ComponentColumn]:
    """The table of events as columns that a stream takes."""
    return rr.DynamicArchetype.columns(
        archetype=archetype("/events"),
        components={
            "name": pa.array([event.name for event in events]),
            "time_s": arrow_column([event.time for event in events]),
            "state": arrow_column(np.array([np.broadcast_to(event.state, 7) for event in events], float)),
        },
    )


def scene(
    setting: Setting,
    *,
    rows: int,
    complete: bool,
    ended: str,
    flights: Sequence[str] = (),
    name: str = "",
    start: float = 0.0,
) -> rr.DynamicArchetype:
    """The static entity /scene, with the names of flights recorded together; or of one of those /flight/NAME/scene,
    with its name and the s of the first one's clock at its own time 0."""
    craft = setting.craft
    sizes = {"craft_side_m": craft.side, "craft_tethers": craft.tethers, "craft_tether_length_m": craft.tether_length}
    values = {
        "contract": CONTRACT,
        "title": setting.title,
        "family": setting.family,
        "text": setting.text,
        "resolved": json.dumps(setting.resolved, sort_keys=True, default=plain),
        "versions": json.dumps(setting.versions, sort_keys=True),
        "accuracy": setting.accuracy,
        "identity": setting.identity,
        "body": setting.body.name,
        "body_mu_m3_s2": float(setting.body.mu),
        "body_radius_m": float(setting.body.radius),
        "craft_kind": craft.kind,
        **{key: float(size) for key, size in sizes.items() if size is not None},
        **({"craft_shape": craft.shape} if craft.shape else {}),
        "rows": int(rows),
        "complete": bool(complete),
        "ended": ended,
        **({"name": name, "start_s": float(start)} if name else {}),
    }
    components = {key: pa.array([value]) for key, value in values.items()}
    if flights:
        components["flights"] = pa.array(list(flights))
    if setting.phases:
        components["phases"] = pa.array([phase.name for phase in setting.phases])
        components["phases_s"] = arrow_column(np.array([(phase.start, phase.end) for phase in setting.phases]))
        components["phases_words"] = pa.array([phase.words for phase in setting.phases])
    if setting.gaps:
        components["gaps_s"] = arrow_column(np.array(setting.gaps))
    return rr.DynamicArchetype(archetype("/scene"), components=components)


def plain(value: Any) -> Any:
    """What JSON has no word for, as something it has: arrays, dates, numpy numbers, dataclasses."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item() if not isinstance(value, np.datetime64) else str(value)
    return str(value)
