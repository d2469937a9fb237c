"""JSON Schema of sweep files, whose table [set] takes the keys of scenes."""

from __future__ import annotations

from functools import cache
from typing import Any

from sailviz.scene.json_schema import partial, schema_of
from sailviz.scene.loading import schema as scene_schema
from sailviz.sweeps.sweep_file import SweepFile


@cache
def schema() -> dict[str, Any]:
    """JSON Schema of the sweep file, for editors and other tools; in [set] any of a scene's keys, as tables or with
    dots in a quoted key."""
    made = schema_of(SweepFile, "sweep")
    of_scenes = partial(scene_schema())
    made["$defs"] |= of_scenes["$defs"]
    of_set = {"properties": of_scenes["properties"], "patternProperties": {r"\.": {}}, "additionalProperties": False}
    made["properties"]["set"] |= of_set
    return made
