"""What a report says of the ensembles of a recording: how many flights, through what, and how far apart they end."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from sailviz.constants import AU
from sailviz.recording import Recording
from sailviz.reports.page import Section, Table

METHODS = {"monte-carlo": "drawn at random", "polynomial-chaos": "an expansion in polynomials (chaos)"}
FEW = 2  # ends from which anything is said of how they are spread


def spreads(recording: Recording) -> Iterator[str]:
    """A sentence for each ensemble: how far from the calm flight it ends."""
    for facts in facts_of(recording):
        far = distances(facts)
        if len(far) < FEW:
            continue
        half, most = (far_words(float(np.quantile(far, share))) for share in (0.5, 0.95))
        yield (
            f"{facts['name'][0]}: of {int(facts['flights'][0]):,} flights half end within {half} of the calm flight, "
            f"95 % within {most}."
        )


def uncertainty(recording: Recording) -> Iterator[Section]:
    """What was varied in each ensemble and what came of it; nothing where there is none."""
    every = facts_of(recording)
    if not every:
        return
    rows = [row_of(facts) for facts in every]
    names = list(dict.fromkeys(key for row in rows for key in row))
    table = tuple((name, *(row.get(name, "-") for row in rows)) for name in names)
    head = ("", *(str(facts["name"][0]) for facts in every))
    said = "Each flight has its own draw; all else is as in the calm flight, which is the one that is recorded in full."
    yield Section("Uncertainty", (said,), (Table(table, head),))


def facts_of(recording: Recording) -> list[dict[str, np.ndarray]]:
    """What stands of each ensemble beside its columns."""
    paths = [name for name in recording.entities if name.startswith("/ensemble/") and name.endswith("/facts")]
    return [{name: np.ravel(values) for name, values in recording[path].items()} for path in paths]


def row_of(facts: dict[str, np.ndarray]) -> dict[str, str]:
    """Words and their numbers, of one ensemble."""

    def one(name: str) -> Any:
        return facts[name][0]

    told = {
        "what the craft does": str(one("words")),
        "through": str(one("wind")),
        "method": METHODS.get(str(one("method")), str(one("method"))),
        "flights": f"{int(one('flights')):,}",
        "seed": str(int(one("seed"))),
        "mean thrust over that of the calm flight": f"{float(one('mean_factor')):.4g}",
    }
    if np.isfinite(one("mean_voltage")):
        told["mean voltage"] = f"{float(one('mean_voltage')) / 1e3:.4g} kV"
        told["share of time at the largest voltage"] = f"{float(one('mean_saturated')):.2%}"
    radius = facts.get("end_radius_m", np.zeros(0))
    if len(radius) >= FEW:
        off = radius - float(one("nominal_end_radius_m"))
        told["distance at the end, less the calm flight's"] = f"{far_words(float(off.mean()))} on average"
        told["its standard deviation"] = far_words(float(off.std(ddof=1)))
        low, high = (far_words(float(np.quantile(off, share))) for share in (0.05, 0.95))
        told["5 % and 95 % of it"] = f"{low} and {high}"
        for share, word in ((0.5, "half"), (0.95, "95 %")):
            told[f"{word} end within, of the calm flight"] = far_words(float(np.quantile(distances(facts), share)))
    if np.isfinite(one("error")):
        told["error of integration, of the distance"] = f"{float(one('error')):.2g}"
    return told


def distances(facts: dict[str, np.ndarray]) -> np.ndarray:
    """m between the end of each flight and that of the calm one, (n,)."""
    if "end_radius_m" not in facts:
        return np.zeros(0)
    r, angle, height = (facts[f"end_{name}"] for name in ("radius_m", "azimuth_rad", "height_m"))
    r0, angle0, height0 = (float(facts[f"nominal_end_{n}"][0]) for n in ("radius_m", "azimuth_rad", "height_m"))
    across = r**2 + r0**2 - 2 * r * r0 * np.cos(angle - angle0)
    return np.asarray(np.sqrt(np.maximum(across, 0.0) + (height - height0) ** 2))


def far_words(value: float) -> str:
    """A distance in m, of either sign, as it is read."""
    return f"{value / AU:.4g} au" if abs(value) >= 1e-3 * AU else f"{value / 1e3:,.4g} km"
