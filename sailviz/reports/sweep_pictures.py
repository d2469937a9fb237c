"""The picture of a sweep: each quantity over what was varied, or how it is spread where many things were drawn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz.errors import RecordingError
from sailviz.reports.page import Picture
from sailviz.sweeps.censoring import AT_LEAST, statistics

if TYPE_CHECKING:
    import pyarrow as pa

    from sailviz.figures.swept import Panel

MOST_PANELS, MOST_SERIES = 6, 6
MARKED = {"p5": "5 %", "median": "median", "p95": "95 %"}
LEAST_SPREAD = 8  # flights from which percentiles are marked


def sweep_pictures(
    table: pa.Table, facts: dict[str, Any], asked: Sequence[str], title: str
) -> tuple[tuple[Picture, ...], str]:
    """The picture, and a sentence where it cannot be drawn here."""
    from sailviz.recording.views.scratch import scratch

    try:
        from sailviz.figures.drawing import FigureError
        from sailviz.figures.swept import draw_swept
    except ImportError:
        return (), 'No picture: figures need matplotlib: pip install "sailviz[plot]".'
    panels = panels_of(table, facts, asked)
    if not panels:
        return (), ""
    left = len(asked) - len(panels)
    more = f" The other {left} quantities are in the table." if left > 0 else ""
    try:
        with scratch() as folder:
            note = f"{table.num_rows:,} flights"
            png = draw_swept(panels, title, note, folder / "swept.png")
            return (Picture(png.read_bytes(), f"{caption(panels)}.{more}"),), ""
    except (FigureError, RecordingError) as error:
        return (), f"No picture: {error}."


def caption(panels: Sequence[Panel]) -> str:
    """What a picture of panels shows."""
    from sailviz.figures.swept import OverPanel

    first = panels[0]
    if isinstance(first, OverPanel):
        return f"What came of each flight over {first.key}"
    return "How the flights are spread; lines at the percentiles"


def panels_of(table: pa.Table, facts: dict[str, Any], asked: Sequence[str]) -> tuple[Panel, ...]:
    """A panel for each of the first quantities that any flight tells."""
    from sailviz.figures.swept import OverPanel, SpreadPanel

    keys = axes_of(table, facts)
    found: list[Panel] = []
    for name in asked:
        values, least = column(table, name), column(table, name + AT_LEAST)
        least = np.where(np.isfinite(values), np.nan, least)
        if not (np.isfinite(values) | np.isfinite(least)).any() or len(found) == MOST_PANELS:
            continue
        if keys:
            found.append(OverPanel(name, keys[0], series_of(table, keys, values, least)))
        else:
            known, open_ = values[np.isfinite(values)], least[np.isfinite(least)]
            numbers = statistics(known, open_) if len(known) + len(open_) >= LEAST_SPREAD else {}
            marks = tuple((word, numbers[key].value) for key, word in MARKED.items() if key in numbers
                          and not numbers[key].at_least)  # fmt: skip
            found.append(SpreadPanel(name, known, open_, marks))
    return tuple(found)


def axes_of(table: pa.Table, facts: dict[str, Any]) -> tuple[str, ...]:
    """The key over which quantities are drawn and, of a second one, that which tells series apart; () where values were
    drawn at random, or where nothing or too much was varied."""
    varied = list(facts["vary"])
    if facts["draws"] or facts["together"] or not 1 <= len(varied) <= 2:
        return ()
    numbers = [key for key in varied if is_number(table, key)]
    if not numbers:
        return ()
    counts = {key: len(set(map(str, table[key].to_pylist()))) for key in varied}
    along = max(numbers, key=lambda key: counts[key])
    rest = tuple(key for key in varied if key != along)
    return (along, *rest) if all(counts[key] <= MOST_SERIES for key in rest) else ()


def is_number(table: pa.Table, key: str) -> bool:
    """Whether every value of a key is a number."""
    return all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in table[key].to_pylist())


def series_of(table: pa.Table, keys: tuple[str, ...], values: np.ndarray, least: np.ndarray) -> tuple[Any, ...]:
    """The flights in order of the first key, one series for each value of the second."""
    from sailviz.figures.swept import Series

    over = np.asarray(table[keys[0]].to_pylist(), float)
    apart = table[keys[1]].to_pylist() if len(keys) > 1 else [""] * len(over)
    found = []
    for value in dict.fromkeys(apart):
        some = np.flatnonzero([each == value for each in apart])
        some = some[np.argsort(over[some], kind="stable")]
        name = f"{keys[1]} {value:.6g}" if isinstance(value, float) else f"{keys[1]} {value}" if len(keys) > 1 else ""
        found.append(Series(name, over[some], values[some], least[some]))
    return tuple(found)


def column(table: pa.Table, name: str) -> np.ndarray:
    """A column as numbers, NaN where there is none."""
    if name not in table.column_names:
        return np.full(table.num_rows, np.nan)
    return np.asarray(table[name].to_numpy(), dtype=float)
