"""Ensembles of a craft that turns as a recording holds them.

/attitude_ensemble/NAME  at times of some of the rows: of each quantity its percentiles at the levels of the facts,
              mean_, deviation_ of the flights and nominal_ of the scene's own flight; share_EVENT, of the flights that
              have met an event up to then; kept_axis (3 for each flight that is kept), z of the body, and
              kept_position_m. /attitude_ensemble/NAME/facts, static: levels, drawn_KEY of each flight in the key's
              unit, met_EVENT_s, when each met it first (NaN: it did not), of QUANTITY at a MOMENT what [[expect]] asked
              of each flight, SI
"""

from __future__ import annotations

import numpy as np
import pyarrow as pa
import rerun as rr

from sailviz.recording.contract import ENDS, archetype, word
from sailviz.run.arrays import AttitudeEnsemble

ENTITY = "/attitude_ensemble"


def attitude_ensemble_path(ensemble: AttitudeEnsemble) -> str:
    """The entity of an ensemble."""
    return f"{ENTITY}/{word(ensemble.name)}"


def attitude_ensemble_table(ensemble: AttitudeEnsemble) -> dict[str, np.ndarray]:
    """Its columns, (n,) or (n, k)."""
    rows = len(ensemble.time)
    found: dict[str, np.ndarray] = {"time_s": ensemble.time}
    found |= {name: values.T for name, values in ensemble.percentiles.items()}
    for how in ("mean", "deviation", "nominal"):
        found |= {f"{how}_{name}": values for name, values in getattr(ensemble, how).items()}
    found |= {f"share_{word(event)}": ensemble.share(event) for event in ensemble.met}
    for name, values in (("kept_axis", ensemble.kept_axis), ("kept_position_m", ensemble.kept_position)):
        found[name] = values.transpose(1, 0, 2).reshape(rows, -1)
    return found


def attitude_ensemble_facts(ensemble: AttitudeEnsemble) -> rr.DynamicArchetype:
    """Its static entity of facts."""
    values = {
        **{name: [getattr(ensemble, name)] for name in ("name", "words", "flights", "seed")},
        "levels": ensemble.levels,
        "events": list(ensemble.met),
        **{f"drawn_{key}": drawn[:ENDS] for key, drawn in ensemble.drawn.items()},
        **{f"met_{word(event)}_s": times[:ENDS] for event, times in ensemble.met.items()},
        **{name.replace("@", "_at_"): flights[:-1][:ENDS] for name, flights in ensemble.values.items()},
    }
    components = {name: pa.array(v, pa.string()) if name == "events" else pa.array(v) for name, v in values.items()}
    return rr.DynamicArchetype(archetype(ENTITY), components=components)
