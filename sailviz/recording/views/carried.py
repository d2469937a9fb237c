"""What a person changed in the views of one flight, carried over to the views of the next one.

A blueprint as a viewer tells it: path -> archetype -> field -> value. Its views and containers have random ids, so
those of two flights are paired by what they show.
"""

from __future__ import annotations

import copy
import re
from typing import Any

Blueprint = dict[str, dict[str, dict[str, Any]]]
NAMED = ("3D", "2D", "TimeSeries", "BarChart")  # kinds of views of which several may have one origin
FAULTS = "/faults"
VIEW, FRAME = "5a11f2e0-0000-4000-8000-000000000001", "5a11f2e0-0000-4000-8000-000000000002"


def carried(given: Blueprint, left: Blueprint, fresh: Blueprint) -> Blueprint:
    """The blueprint of a new flight as its person would have it.

    given : the earlier flight's own; left : what the person made of that; fresh : the new flight's own, which holds
    wherever the person changed nothing. Tabs and places of views are carried over as far as the views are the same.
    """
    out = copy.deepcopy(fresh)
    pairs = _pairs(left, fresh)
    for path, parts in left.items():
        target = _translated(path, pairs)
        if target is None or path.startswith("/container/") or path == "/viewport":
            continue
        for archetype, fields in parts.items():
            before = given.get(path, {}).get(archetype, {})
            changed = {field: value for field, value in fields.items() if before.get(field) != value}
            if changed:
                out.setdefault(target, {}).setdefault(archetype, {}).update(copy.deepcopy(changed))
    return _layout(given, left, out, pairs)


def with_faults(blueprint: Blueprint, title: str) -> Blueprint:
    """The same views under a text that tells faults."""
    out = without_faults(blueprint)
    viewport = out["/viewport"]["ViewportBlueprint"]
    out[f"/view/{VIEW}"] = {
        "ViewBlueprint": {"class_identifier": "TextDocument", "display_name": title, "space_origin": FAULTS}
    }
    out[f"/view/{VIEW}/ViewContents"] = {"ViewContents": {"query": "$origin/**"}}
    out[f"/container/{FRAME}"] = {
        "ContainerBlueprint": {
            "container_kind": "Vertical",
            "contents": [f"view/{VIEW}", f"container/{viewport['root_container']}"],
            "row_shares": [1.0, 4.0],
        }
    }
    viewport["root_container"] = FRAME
    viewport.pop("maximized", None)  # a view that fills the window would hide the text
    return out


def without_faults(blueprint: Blueprint) -> Blueprint:
    """The views alone again."""
    out = {path: copy.deepcopy(parts) for path, parts in blueprint.items() if not path.startswith(f"/view/{VIEW}")}
    frame = out.pop(f"/container/{FRAME}", None)
    viewport = out["/viewport"]["ViewportBlueprint"]
    if frame is None or viewport.get("root_container") != FRAME:
        return out
    inside = [part for part in _listed(frame["ContainerBlueprint"].get("contents")) if part.startswith("container/")]
    if inside:
        viewport["root_container"] = inside[0].removeprefix("container/")
    return out


def _pairs(left: Blueprint, fresh: Blueprint) -> dict[str, str]:
    """Id of a view -> id of the view that shows the same of the new flight."""
    new = {key: identity for identity, key in _views(fresh).items()}
    return {identity: new[key] for identity, key in _views(left).items() if key in new}


def _views(blueprint: Blueprint) -> dict[str, tuple[str, str, str]]:
    """Id of each view -> what it shows: its kind, its origin and, where that leaves a doubt, its name less its unit."""
    found = {}
    for path, parts in blueprint.items():
        view = parts.get("ViewBlueprint")
        if view:
            kind, name = view.get("class_identifier", ""), view.get("display_name", "")
            stem = re.split(r" [\[(]", name)[0] if kind in NAMED else ""
            found[path.removeprefix("/view/")] = (kind, view.get("space_origin", ""), stem)
    return found


def _translated(path: str, pairs: dict[str, str]) -> str | None:
    """A path of the old blueprint as one of the new; None for what belongs to a view that is no more."""
    if not path.startswith("/view/"):
        return path
    identity, slash, rest = path.removeprefix("/view/").partition("/")
    return f"/view/{pairs[identity]}{slash}{rest}" if identity in pairs else None


def _layout(given: Blueprint, left: Blueprint, out: Blueprint, pairs: dict[str, str]) -> Blueprint:
    """Put containers and tabs as the person had them."""
    own = {f"view/{view}": f"view/{other}" for view, other in pairs.items()}
    place = left["/viewport"]["ViewportBlueprint"]
    whole = set(pairs) == set(_views(left)) and set(pairs.values()) == set(_views(out))
    if whole and _containers(left) != _containers(given):
        for path in _containers(out):
            del out[path]
        for path, parts in _containers(left).items():
            box = copy.deepcopy(parts)
            fields = box["ContainerBlueprint"]
            fields["contents"] = [own.get(part, part) for part in _listed(fields.get("contents"))]
            if "active_tab" in fields:
                fields["active_tab"] = own.get(fields["active_tab"], fields["active_tab"])
            out[path] = box
        out["/viewport"]["ViewportBlueprint"]["root_container"] = place["root_container"]
    else:
        for path, parts in _containers(left).items():
            front = parts["ContainerBlueprint"].get("active_tab")
            if front in own and front != given.get(path, {}).get("ContainerBlueprint", {}).get("active_tab"):
                _bring_forward(out, own[front])
    if place.get("maximized") in pairs:
        out["/viewport"]["ViewportBlueprint"]["maximized"] = pairs[place["maximized"]]
    return out


def _bring_forward(blueprint: Blueprint, view: str) -> None:
    for parts in _containers(blueprint).values():
        fields = parts["ContainerBlueprint"]
        if "active_tab" in fields and view in _listed(fields.get("contents")):
            fields["active_tab"] = view


def _containers(blueprint: Blueprint) -> Blueprint:
    return {path: parts for path, parts in blueprint.items() if "ContainerBlueprint" in parts}


def _listed(value: Any) -> list[str]:
    """A viewer tells a list of one as its only member."""
    return [] if value is None else [value] if isinstance(value, str) else list(value)
