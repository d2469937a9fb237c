"""Runs held to baselines: some rows of the truth as float64, all events, and beside them what may differ."""

from __future__ import annotations

import difflib
import os
import shutil
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from sailviz import files
from sailviz.errors import RecordingError
from sailviz.recording.comparison.comparer import compare
from sailviz.recording.comparison.differences import default_tolerance
from sailviz.recording.comparison.result import Comparison
from sailviz.recording.comparison.tables import Evidence, evidence
from sailviz.recording.exports import arrays, write_npz, written_whole
from sailviz.run import gaps, resample
from sailviz.run.arrays import Run

if TYPE_CHECKING:
    from sailviz.recording import Recording
    from sailviz.scene import Scene

# What a comparison reads; a name, or the path of anything else than a recording or an archive, is a scene to be flown
Flown: TypeAlias = "Run | Recording | str | os.PathLike[str]"
Tolerance = float | Mapping[str, float] | None

SMOOTH = 0.7  # rad: where rows are closer on the orbit than this, a picture may draw a curve through them
HEAD = """\
# How far a run may differ from {name}.npz, column by column, each in its own unit.
# Made with 1e-9 of the largest value; edit freely, --sailviz-update keeps what stands here.

rtol = 0.0
"""


@dataclass(frozen=True)
class Outcome:
    """What came of a check. `comparison` is None where there was no baseline."""

    passed: bool
    comparison: Comparison | None
    report: str
    folder: Path | None = None


class Regression:
    """A baseline: NAME.npz with the numbers, NAME.toml with the allowed differences."""

    def __init__(self, folder: Path, name: str, *, rows: int = 60, atol: Tolerance = None, rtol: Tolerance = None):
        self.baseline = Path(folder) / f"{name}.npz"
        self.tolerances = Path(folder) / f"{name}.toml"
        self.name, self.rows = name, rows
        self._atol, self._rtol = _named(atol), _named(rtol)

    def update(self, source: Flown | Scene, values: Mapping[str, Any] | None = None) -> None:
        """Write the baseline from a scene or run. Tolerances that stand in the file stay."""
        data = evidence(self._run(source, values))
        self.baseline.parent.mkdir(parents=True, exist_ok=True)
        written_whole(self.baseline, lambda part: write_npz(part, self._thinned(data), compressed=True))
        kept = self._read_tolerances()
        text = self.tolerances.read_text() if kept else HEAD.format(name=self.name)
        if "atol" not in kept:
            text += "\n[atol]\n"
        missing = [(name, value) for name, value in _defaults(data).items() if name not in kept.get("atol", {})]
        text += "".join(f'"{name}" = {_number(value)}\n' for name, value in missing)
        files.write_text(self.tolerances, text, "tolerances")

    def check(
        self,
        source: Flown | Scene,
        values: Mapping[str, Any] | None,
        leave_in: Callable[[], Path],
        pictures: bool = True,
    ) -> Outcome:
        """Compare a scene or run with the baseline; where they differ, leave everything that helps in a folder."""
        flown = self._run(source, values)
        data = evidence(flown)
        if not self.baseline.exists():
            folder = leave_in()
            self._keep_new(folder, data, flown)
            hint = f"there is no baseline {self.baseline}; look at {folder}, then run pytest --sailviz-update"
            return Outcome(False, None, hint, folder)
        kept = self._read_tolerances()
        comparison = compare(
            self.baseline,
            data,
            on="step",
            atol={**_known(kept.get("atol", {}), data), **self._atol},
            rtol={"": kept.get("rtol", 0.0), **self._rtol},
            picture=False,
        )
        if comparison.equal:
            return Outcome(True, comparison, str(comparison))
        folder = leave_in()
        files.write_text(folder / "difference.txt", f"{comparison}\n", "comparison")
        shutil.copy(self.baseline, folder / "baseline.npz")
        if self.tolerances.exists():
            shutil.copy(self.tolerances, folder / "baseline.toml")
        self._keep_new(folder, data, flown)
        said = _pictures(folder) if pictures else ""
        report = f"{comparison}\n\nA is the baseline, B the new run. {folder} holds both and this table{said}."
        return Outcome(False, comparison, report, folder)

    @staticmethod
    def _run(source: Flown | Scene, values: Mapping[str, Any] | None) -> Flown:
        """A scene is run, everything else is taken as it is."""
        if isinstance(source, str | os.PathLike) and Path(source).suffix in (".rrd", ".npz"):
            return source
        from sailviz.scene.loading import Scene, load_scene

        if isinstance(source, str | os.PathLike):
            source = load_scene(source)
        if not isinstance(source, Scene):
            return source
        from sailviz.simulation.loop import simulate

        return simulate(source.with_values(values) if values else source)

    def _thinned(self, data: Evidence) -> dict[str, np.ndarray]:
        count = len(data.table("/state"))
        if count <= self.rows:
            return arrays(data)
        return arrays(data, rows=np.unique(np.round(np.linspace(0, count - 1, self.rows)).astype(int)))

    def _keep_new(self, folder: Path, data: Evidence, source: Flown) -> None:
        """The new rows, and the whole recording of a run."""
        write_npz(folder / "new.npz", self._thinned(data), compressed=True)
        if isinstance(source, Run):
            from sailviz.recording import record

            record(source, folder / "new.rrd")

    def _read_tolerances(self) -> dict[str, Any]:
        try:
            return tomllib.loads(self.tolerances.read_text())
        except FileNotFoundError:
            return {}
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise RecordingError(f"{self.tolerances} is not valid TOML: {error}") from None


def _named(tolerance: Tolerance) -> dict[str, float]:
    if tolerance is None:
        return {}
    return dict(tolerance) if isinstance(tolerance, Mapping) else {"": float(tolerance)}


def _known(atol: dict[str, float], data: Evidence) -> dict[str, float]:
    """Tolerances of columns that are gone say nothing: the comparison will tell that they are gone."""
    names = set(_defaults(data))
    for name in atol:
        if name not in names and not name.startswith("/"):
            near = difflib.get_close_matches(name, names, 1)
            raise RecordingError(f"a tolerance is given for {name}" + (f"; did you mean {near[0]}?" if near else ""))
    return {name: value for name, value in atol.items() if name in names}


def _defaults(data: Evidence) -> dict[str, float]:
    """Default tolerance of every column, two digits."""
    found = {}
    for entity in data.entities:
        for name, values in data.table(entity).columns.items():
            if values.dtype.kind == "f":
                found[f"{entity}:{name}"] = float(f"{default_tolerance(name, values):.2g}")
    if data.events:
        states = np.array([event.state for event in data.events])
        times = np.array([event.time for event in data.events])
        for name, values in (
            ("time_s", times),
            ("position_m", states[:, :3]),
            ("velocity_m_s", states[:, 3:6]),
            ("mass_kg", states[:, 6]),
        ):
            found[f"/events:{name}"] = float(f"{default_tolerance(name, values):.2g}")
    return found


def _number(value: float) -> str:
    text = f"{value:g}"
    return text if any(c in text for c in ".en") else f"{text}.0"  # n: inf and nan are TOML as they are


def _pictures(folder: Path) -> str:
    """Pictures of the same rows of both, where there is Vulkan -> what to say about them."""
    from sailviz.recording.views.screenshot import has_vulkan, picture

    if not has_vulkan():
        return "; no pictures, for want of Vulkan"
    try:
        for side in ("baseline", "new"):
            from sailviz.recording import record

            record(_run_of(folder / f"{side}.npz", side), folder / f"{side}_rows.rrd")
            picture(folder / f"{side}_rows.rrd", folder / f"{side}.png", size=(1280, 720))
    except RecordingError as error:
        return f"; no pictures: {error}"
    return ", and two pictures"


def _run_of(path: Path, side: str) -> Run:
    """The rows of an archive as a Run, to be looked at."""
    from sailviz.run.from_arrays import trajectory

    data = evidence(path)
    tables = {entity: data.table(entity).columns for entity in data.entities}
    state, facts = tables["/state"], data.facts
    rows, time = len(state["time_s"]), state["time_s"]
    turn = np.linalg.norm(state["velocity_m_s"], axis=1) / np.linalg.norm(state["position_m"], axis=1)
    if rows > 3 and np.max(turn[1:] * np.diff(time)) < SMOOTH:  # or a few rows would be taken for an orbit's ellipses
        time = np.interp(np.arange(16 * rows - 15) / 16, np.arange(rows), time)
        time = time[~gaps.inside(time, data.gaps)]

    def column(entity: str, name: str) -> np.ndarray:
        return resample.at(time, name, state["time_s"], tables[entity][name], state, data.gaps)

    return trajectory(
        time,
        column("/state", "position_m"),
        column("/state", "velocity_m_s"),
        normal=column("/attitude", "normal"),
        thrust=column("/thrust", "acceleration_m_s2"),
        mass=None if np.isnan(state["mass_kg"]).any() else column("/state", "mass_kg"),
        mu=facts["body_mu_m3_s2"],
        radius=facts.get("body_radius_m"),
        epoch=data.epoch,
        device=facts["craft_kind"],
        gaps=data.gaps,
        title=f"{facts['title']} ({side}, {rows} rows)",
    )
