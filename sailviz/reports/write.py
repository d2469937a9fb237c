"""The report of whatever it is asked of: a recording, a scene that is flown for it, a sweep or the table of one."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sailviz import files
from sailviz.errors import RecordingError
from sailviz.reports.page import Page, html_of
from sailviz.shipped import shipped_sweeps

if TYPE_CHECKING:
    from sailviz.sweeps.definition import Definition

RECORDING, TABLE = ".rrd", ".parquet"


@dataclass(frozen=True)
class Report:
    """What was written. path : of the page; size : of it, bytes; answer : its sentences."""

    path: Path
    size: int
    answer: tuple[str, ...]


def write_report(
    source: str | Path,
    path: str | Path,
    *,
    values: Mapping[str, Any] | None = None,
    pictures: bool = True,
    others: bool = True,
    progress: Callable[[float], None] | None = None,
) -> Report:
    """Write the report of a flight or a sweep as one HTML file.

    source : recording (.rrd), table of a sweep (.parquet), sweep file, scene file or shipped name; a scene or a sweep
    is flown first. values : put over the scene's. pictures : whether they are taken, which wants Vulkan and matplotlib;
    where these are not there the page says so. others : whether a descent is flown without its device and under other
    Suns as well. progress : called with the fraction of the flight that is done. Raises SceneError, RecordingError or
    PropagationError as the flight does, OutputError where the page cannot be written.
    """
    with files.writing(path, "report") as part:
        page = page_of(source, values or {}, pictures, others, progress)
        part.write_text(html_of(page), encoding="utf-8")
    return Report(Path(path), Path(path).stat().st_size if files.regular(path) else 0, page.answer)


def page_of(
    source: str | Path,
    values: Mapping[str, Any],
    pictures: bool,
    others: bool,
    progress: Callable[[float], None] | None = None,
) -> Page:
    """The page of any source."""
    html_of(Page("", (), (), ""))  # says what is missing before anything is flown
    path = Path(source)
    if path.suffix.lower() in (RECORDING, TABLE) and values:
        raise RecordingError(f"{source} was flown already: no value can be put over its scene's")
    if path.suffix.lower() == RECORDING:
        from sailviz.reports.flight import flight_page

        return flight_page(path, pictures=pictures, others=others)
    if path.suffix.lower() == TABLE:
        return _of_table(path, pictures)
    if is_sweep(source):
        return _of_sweep(str(source), values, pictures)
    return _of_scene(source, values, pictures, others, progress)


def is_sweep(source: str | Path) -> bool:
    """Whether a name is that of a sweep: shipped, or a file with a table [sweep]."""
    if str(source) in shipped_sweeps():
        return True
    try:
        return "sweep" in tomllib.loads(Path(source).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False


def _of_scene(
    source: str | Path,
    values: Mapping[str, Any],
    pictures: bool,
    others: bool,
    progress: Callable[[float], None] | None,
) -> Page:
    from sailviz.recording import Recorder
    from sailviz.recording.views.scratch import scratch
    from sailviz.reports.flight import flight_page
    from sailviz.scene import load_scene
    from sailviz.simulation import simulate_blocks

    scene = load_scene(source, values)
    again = f"sailviz run {source}" + "".join(f" --set {key}={value}" for key, value in values.items())
    with scratch() as folder:
        made = folder / f"{Path(source).stem}.rrd"
        with Recorder(made) as recorder:
            for block in simulate_blocks(scene, progress=progress):
                recorder.add(block)
        return flight_page(made, scene, pictures=pictures, others=others, again=again)


def _of_table(path: Path, pictures: bool) -> Page:
    import pyarrow as pa
    import pyarrow.parquet as pq

    from sailviz.reports.sweep import sweep_page

    try:
        table = pq.read_table(path, partitioning=None)
    except (OSError, pa.ArrowException, ValueError) as error:
        raise RecordingError(f"{path} cannot be read as the table of a sweep: {str(error).splitlines()[0]}") from None
    return sweep_page(table, None, path=path, pictures=pictures)


def _of_sweep(source: str, values: Mapping[str, Any], pictures: bool) -> Page:
    from sailviz.reports.sweep import sweep_page
    from sailviz.sweeps.definition import define
    from sailviz.sweeps.loop import fly_all

    definition: Definition = define(source, {}, None, None, (), None, dict(values))[0]
    found = fly_all(definition)
    return sweep_page(found.to_arrow(), definition.scene(), again=f"sailviz sweep {source}", pictures=pictures)
