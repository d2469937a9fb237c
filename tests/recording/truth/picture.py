"""A recording as a viewer sees it: what each entity draws, where its parents' transforms put it, and in which views."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections import defaultdict
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import pyarrow as pa
from rerun.chunk import RrdReader

PLACING = {"Transform3D:translation", "Transform3D:quaternion", "Transform3D:scale"}
ROW_ID = "rerun.controls.RowId"
CLOCKS = ("step", "sim_time", "utc")


def timed(batch) -> bool:
    return "sim_time" in batch.schema.names


class Picture:
    """Components of every entity by name, e.g. "Arrows3D:vectors": static ones, and rows by their step."""

    def __init__(self, path):
        reader = RrdReader(str(path))
        self._static: dict[str, dict] = defaultdict(dict)
        self._rows: dict[str, dict] = defaultdict(lambda: defaultdict(list))
        self.clocks: dict[str, set[tuple]] = defaultdict(set)  # step, sim_time and utc in ns of each row
        self.between: dict[str, dict[str, list[tuple]]] = defaultdict(lambda: defaultdict(list))  # ns, value: no step
        newest: dict[tuple, bytes] = {}
        for chunk in reader.stream():
            batch = chunk.to_record_batch()
            ids = batch.column(ROW_ID).to_pylist()
            steps = batch.column("step").to_pylist() if "step" in batch.schema.names else None
            loose = batch.column("sim_time").cast(pa.int64()).to_pylist() if steps is None and timed(batch) else None
            if steps is not None:
                self.clocks[chunk.entity_path].update(zip(*(ticks(batch, name) for name in CLOCKS), strict=True))
            for name in (name for name in batch.schema.names if ":" in name):
                column = batch.column(name)
                for row, row_id in enumerate(ids):
                    if not column[row].is_valid:
                        continue
                    value = plain(column[row].values)
                    if loose is not None:
                        self.between[chunk.entity_path][name].append((loose[row], value))
                    elif steps is not None:
                        self._rows[chunk.entity_path][name].append((steps[row], row_id, value))
                    elif row_id >= newest.get((chunk.entity_path, name), b""):
                        newest[chunk.entity_path, name] = row_id
                        self._static[chunk.entity_path][name] = value
        self._steps: dict[str, dict[str, list[int]]] = {}
        for entity, components in self._rows.items():
            for rows in components.values():
                rows.sort(key=lambda row: row[:2])
            self._steps[entity] = {name: [row[0] for row in rows] for name, rows in components.items()}
        self._poses: dict[tuple[str, int], np.ndarray] = {}
        self.views = views_of(reader)

    @cached_property
    def entities(self) -> list[str]:
        return sorted({*self._static, *self._rows})

    def components(self, entity: str) -> set[str]:
        return {*self._static.get(entity, ()), *self._rows.get(entity, ())}

    def archetypes(self, entity: str) -> set[str]:
        return {name.split(":")[0] for name in self.components(entity)}

    def moves(self, entity: str, component: str) -> bool:
        """Whether a component has rows."""
        return component in self._rows.get(entity, ()) and component not in self._static.get(entity, ())

    def fixed(self, entity: str, component: str):
        """What never changes. Fails where the component has rows or is absent."""
        return self._static[entity][component]

    def rows(self, entity: str, component: str):
        """Steps (n,) and the values of each."""
        rows = self._rows[entity][component]
        return np.array([row[0] for row in rows], int), [row[2] for row in rows]

    def at(self, entity: str, component: str, step: int, default=None):
        """What a viewer shows at a step: the static value, else the latest row."""
        if component in self._static.get(entity, ()):
            return self._static[entity][component]
        past = bisect_right(self._steps.get(entity, {}).get(component, ()), step)
        return self._rows[entity][component][past - 1][2] if past else default

    def steps(self, entity: str, component: str, otherwise) -> np.ndarray:
        """Steps at which a component changes, or `otherwise` where it is static."""
        return self.rows(entity, component)[0] if self.moves(entity, component) else np.asarray(otherwise)

    def pose(self, entity: str, step: int, origin: str = "/") -> np.ndarray:
        """The (4, 4) matrix from an entity's own coordinates to those of an ancestor."""
        whole = np.eye(4)
        parts = entity.strip("/").split("/")
        for depth in range(1, len(parts) + 1):
            path = "/" + "/".join(parts[:depth])
            if len(path) > len(origin.rstrip("/")):
                whole = whole @ self._own_pose(path, step)
        return whole

    def _own_pose(self, path: str, step: int) -> np.ndarray:
        if (path, step) not in self._poses:
            self._poses[path, step] = self._placed(path, step)
        return self._poses[path, step]

    def _placed(self, path: str, step: int) -> np.ndarray:
        unknown = {name for name in self.components(path) if name.startswith("Transform3D:")} - PLACING
        assert not unknown, f"{path} is placed by {unknown}, which this reader does not know"
        matrix = np.eye(4)
        rotation = turn(self.at(path, "Transform3D:quaternion", step, [[0.0, 0.0, 0.0, 1.0]])[0])
        matrix[:3, :3] = rotation * np.asarray(self.at(path, "Transform3D:scale", step, [[1.0] * 3])[0], float)
        matrix[:3, 3] = self.at(path, "Transform3D:translation", step, [[0.0] * 3])[0]
        return matrix

    def place(self, entity: str, component: str, step: int, origin: str = "/") -> np.ndarray:
        """Points (..., 3) of a component in the frame of an ancestor."""
        return moved(self.pose(entity, step, origin), self.at(entity, component, step))

    def line(self, entity: str, step: int, origin: str = "/") -> list[np.ndarray]:
        """The strips of an entity, each (k, 3)."""
        pose = self.pose(entity, step, origin)
        return [moved(pose, strip) for strip in self.at(entity, "LineStrips3D:strips", step)]

    def arrow(self, entity: str, step: int, origin: str = "/"):
        """Origins and vectors (k, 3) of arrows."""
        pose, vectors = self.pose(entity, step, origin), np.asarray(self.at(entity, "Arrows3D:vectors", step), float)
        origins = self.at(entity, "Arrows3D:origins", step, np.zeros_like(vectors))
        return moved(pose, origins), vectors @ pose[:3, :3].T

    def color(self, entity: str, component: str, step: int = 0) -> np.ndarray:
        """The colours (k, 4) of an entity, 0 to 255."""
        packed = np.asarray(self.at(entity, component, step), np.uint32)
        return np.stack([(packed >> shift) & 255 for shift in (24, 16, 8, 0)], -1).astype(int)


@dataclass
class View:
    """A view of the blueprint. range : (low, high) of the ordinate; trails : entity -> (start, end) s after the cursor,
    None without limit, or "hidden"."""

    kind: str = ""
    name: str = ""
    origin: str = ""
    contents: list[str] = field(default_factory=list)
    range: tuple[float, float] | None = None
    trails: dict = field(default_factory=dict)
    eye: np.ndarray | None = None
    target: np.ndarray | None = None
    up: np.ndarray | None = None

    def shows(self, entity: str) -> bool:
        """Whether the contents include an entity: the longest rule that fits it decides, a later one among equals."""
        fitting = [rule for rule in self.contents if fits(entity, rule[2:].replace("$origin", self.origin.rstrip("/")))]
        return bool(fitting) and max(fitting, key=lambda rule: len(rule.removesuffix("/**"))).startswith("+")

    @property
    def unit(self) -> str:
        """What stands in square brackets in the name."""
        found = re.search(r"\[(.*?)\]", self.name)
        return found.group(1) if found else ""


def ticks(batch: pa.RecordBatch, name: str) -> list[int]:
    """A timeline as integers, zeros where there is none."""
    return batch.column(name).cast(pa.int64()).to_pylist() if name in batch.schema.names else [0] * len(batch)


def fits(entity: str, rule: str) -> bool:
    if rule.endswith("/**"):
        return entity == rule[:-3] or entity.startswith(rule[:-2])
    return entity == rule


def views_of(reader: RrdReader) -> list[View]:
    """The views of the last blueprint of a file."""
    stores = reader.blueprints()
    if not stores:
        return []
    views: dict[str, View] = defaultdict(View)
    for chunk in reader.stream(store=stores[-1]):
        path = re.fullmatch(r"/view/([0-9a-f-]+)(.*)", chunk.entity_path)
        if not path:
            continue
        batch = chunk.to_record_batch()
        found = {name: batch.column(name).to_pylist()[-1] for name in batch.schema.names if ":" in name}
        tell(views[path.group(1)], path.group(2), found)
    return [view for view in views.values() if view.kind]


def tell(view: View, path: str, found: dict) -> None:
    """Put what one entity of the blueprint says into its view."""
    if not path:
        view.kind, view.name = found["ViewBlueprint:class_identifier"][0], found["ViewBlueprint:display_name"][0]
        view.origin = found["ViewBlueprint:space_origin"][0]
    elif path == "/ViewContents":
        view.contents = [rule if rule[:2] in ("+ ", "- ") else f"+ {rule}" for rule in found["ViewContents:query"]]
    elif path == "/ScalarAxis":
        view.range = tuple(found["ScalarAxis:range"][0])
    elif path == "/EyeControls3D":
        view.eye, view.target, view.up = (
            np.array(found[f"EyeControls3D:{name}"][0]) for name in ("position", "look_target", "eye_up")
        )
    elif path.startswith("/ViewContents/overrides"):
        entity = path.removeprefix("/ViewContents/overrides").removesuffix("/visualizers")
        if "VisibleTimeRanges:ranges" in found:
            ranges = {item["timeline"]: item["range"] for item in found["VisibleTimeRanges:ranges"]}
            ends = (ranges["sim_time"]["start"], ranges["sim_time"]["end"])
            view.trails[entity] = tuple(None if end is None else 1e-9 * end for end in ends)
        if found.get("EntityBehavior:visible") == [False]:
            view.trails[entity] = "hidden"


def plain(values: pa.Array):
    """The values of one row: numbers as arrays, lists of lists as lists of arrays, the rest as Python has it."""
    kind = values.type
    if pa.types.is_fixed_size_list(kind):
        return plain(values.flatten()).reshape(len(values), kind.list_size)
    if pa.types.is_list(kind):
        if pa.types.is_integer(kind.value_type):
            return [item.as_buffer() if hasattr(item, "as_buffer") else item.values.to_numpy() for item in values]
        return [plain(item.values) for item in values]
    if pa.types.is_floating(kind) or pa.types.is_integer(kind):
        return values.to_numpy(zero_copy_only=False)
    return values.to_pylist()


def turn(quaternion) -> np.ndarray:
    """The rotation matrix of a quaternion x, y, z, w."""
    x, y, z, w = np.asarray(quaternion, float) / np.linalg.norm(np.asarray(quaternion, float))
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def moved(pose, points) -> np.ndarray:
    return np.asarray(points, float) @ pose[:3, :3].T + pose[:3, 3]
