"""A flight as a folder that Cosmographia opens: NAIF's viewer of the solar system, or its open-source forebear.

load.json      what is opened: it names the two catalogues
kernels.json   the kernels of SPICE beside it: craft.bsp, and of a craft with an attitude craft.bc, .tsc, .tf
craft.json     the craft: where it is and how it stands by the kernels, its mesh craft.obj, its name and trail
README.txt     how to open it

Files have names of their own, whatever the flight is called; what people wrote is text in JSON. Source: cosmoguide.org,
pages on catalogue files and geometry types (keys and units; read).
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from sailviz import files
from sailviz.calendar import DateError, tai
from sailviz.errors import RecordingError
from sailviz.exchange import ck, spk
from sailviz.recording.comparison.tables import Evidence, Source, evidence
from sailviz.recording.craft_mesh import CraftMesh, craft_mesh, materials_text, obj_text, textures
from sailviz.recording.drawing import style
from sailviz.recording.orbit_files import write_orbit
from sailviz.recording.reader import Recording, read
from sailviz.run import dates
from sailviz.run.arrays import Run

CENTRES = {  # what flies round what: Cosmographia's word, SPICE's for the centre of our kernels
    "Sun": ("Sun", "SUN"),
    "Mercury": ("Mercury", "MERCURY BARYCENTER"),
    "Venus": ("Venus", "VENUS BARYCENTER"),
    "Earth": ("Earth", "EARTH"),
    "Moon": ("Moon", "MOON"),
    "Mars": ("Mars", "MARS BARYCENTER"),
    "Jupiter": ("Jupiter", "JUPITER BARYCENTER"),
    "Saturn": ("Saturn", "SATURN BARYCENTER"),
    "Uranus": ("Uranus", "URANUS BARYCENTER"),
    "Neptune": ("Neptune", "NEPTUNE BARYCENTER"),
}
TAKEN = (*CENTRES, "Pluto", "Ceres", "Vesta", "Phobos", "Deimos", "Io", "Europa", "Ganymede",
         "Callisto", "Titan", "Enceladus", "Rhea", "Dione", "Tethys", "Mimas", "Iapetus", "Triton", "Charon",
         "Milky Way")  # fmt: skip
MARK = "A flight by sailviz, for Cosmographia"
FILES = ("load.json", "kernels.json", "craft.json", "README.txt", "craft.bsp", "craft.bc", "craft.tsc", "craft.tf",
         "craft.obj", "craft.mtl", "film_lit.png", "film_dark.png")  # fmt: skip
LONGEST_NAME = 60
TOGETHER = 1e-3  # s between two segments between which there is no gap
MANY_TURNS, SHOWN_TURNS = 30.0, 3.0  # of a longer flight the trail shows so many revolutions
SAMPLES, FEWEST, MOST = 100, 200, 3000  # of the trail: of a revolution, and in all
MS = 1_000_000  # ns
J2000 = "2000-01-01T12:00:00"


def write_cosmographia(source: Source, folder: Path, frame: str, craft_id: int) -> Path:
    """Write the folder, whole or not at all -> load.json. RecordingError for what is no dated flight round a body that
    Cosmographia shows, OutputError for a folder in which something else lies."""
    data = evidence(source)
    centre = CENTRES.get(str(data.facts.get("body", "")))
    if centre is None:
        known = ", ".join(CENTRES)
        raise RecordingError(f"{data.label} is a flight round {data.facts.get('body') or 'an unnamed body'}; "
                             f"Cosmographia shows those round: {known}")  # fmt: skip
    ck.instrument(craft_id)
    with files.writing_folder(folder, "catalogue", _against) as part:
        kernels = [path.name for path in write_orbit(data, part / "craft.bsp", "spk", frame, craft_id, None)]
        pieces = _pieces(spk.read_spk(part / "craft.bsp"))
        stands = data.facts.get("craft_kind") != "none" and _has_attitude(data)
        if stands:
            bc, tsc, tf = write_orbit(data, part / "craft.bc", "ck", frame, craft_id, None)
            kernels = [tf.name, tsc.name, *kernels, bc.name]
        mesh = _mesh(source)
        if mesh is not None:
            (part / "craft.obj").write_text(obj_text(mesh, "craft.mtl"), encoding="ascii")
            (part / "craft.mtl").write_text(materials_text(mesh), encoding="ascii")
            for name, image in textures(mesh).items():
                (part / name).write_bytes(image)
        title = shown_name(str(data.facts.get("title", "")))
        items = [
            _item(data, f"{title} ({k + 1})" if k else title, piece, centre, craft_id, stands, mesh)
            for k, piece in enumerate(pieces)
        ]
        catalogues: dict[str, dict[str, Any]] = {
            "craft.json": {"version": "1.0", "name": title, "items": items},
            # without items the open-source forebear looks for no kernels
            "kernels.json": {"version": "1.0", "name": f"{title}: kernels", "spiceKernels": kernels, "items": []},
            "load.json": {"version": "1.0", "name": title, "require": ["kernels.json", "craft.json"]},
        }
        for name, content in catalogues.items():
            (part / name).write_text(json.dumps(content, indent=1) + "\n", encoding="ascii")
        (part / "README.txt").write_text(_readme(title, mesh, len(pieces)), encoding="utf-8")
    return folder / "load.json"


def shown_name(title: str) -> str:
    """A title as a name that a viewer shows as it is: no control characters, nothing that reads as markup, and not that
    of a body, which it would take the place of."""
    kept = "".join(letter if letter.isprintable() and letter not in '<>&"\\' else " " for letter in title)
    name = " ".join(kept.split())[:LONGEST_NAME].strip() or "Flight"
    return f"{name} (flight)" if name.casefold() in {word.casefold() for word in TAKEN} else name


def _against(folder: Path) -> str:
    """Why a folder must not be replaced, "" for one that was written here."""
    strange = sorted(path.name for path in folder.iterdir() if path.name not in FILES)
    if strange:
        return f"{strange[0]} lies there, which is none of its files: name a folder that is new or empty"
    try:
        with open(folder / "README.txt", encoding="utf-8", errors="replace") as file:
            mine = file.readline(200).startswith(MARK)
    except FileNotFoundError:
        mine = False
    return "" if mine else "what lies there is not by sailviz: name a folder that is new or empty"


def _has_attitude(data: Evidence) -> bool:
    return "/attitude" in data.entities and bool(np.any(data.table("/attitude").columns["normal"]))


def _mesh(source: Source) -> CraftMesh | None:
    """The craft as it is drawn: a run is recorded for it, of a table there is none."""
    if isinstance(source, Recording):
        return craft_mesh(source)
    if isinstance(source, Run):
        from sailviz.recording.views.scratch import scratch
        from sailviz.recording.writer import record

        with scratch() as place:
            record(source, place / "run.rrd")
            return craft_mesh(read(place / "run.rrd"))
    if Path(source).suffix.lower() == ".npz":
        return None
    from sailviz.recording.flights import is_flight, read_flight

    return _mesh(read_flight(Path(source))) if is_flight(source) else craft_mesh(read(source))


def _pieces(segments: Sequence[spk.Segment]) -> list[tuple[float, float]]:
    """Spans without a gap (start, end), s of TDB after J2000: a jump of the velocity is none."""
    spans = [(float(one.et[0]), float(one.et[-1])) for one in segments]
    begins = [0, *(k + 1 for k, (a, b) in enumerate(pairwise(spans)) if b[0] - a[1] > TOGETHER)]
    return [(spans[a][0], spans[b - 1][1]) for a, b in zip(begins, [*begins[1:], len(spans)], strict=True)]


def _item(
    data: Evidence,
    name: str,
    piece: tuple[float, float],
    centre: tuple[str, str],
    craft_id: int,
    stands: bool,
    mesh: CraftMesh | None,
) -> dict[str, Any]:
    """The craft over one span, by the keys of a spacecraft catalogue."""
    color = [round(part / 255, 3) for part in style.TRAIL_RECENT]
    shown, samples = _trail(data, piece[1] - piece[0])
    item: dict[str, Any] = {
        "class": "spacecraft",
        "name": name,
        "startTime": _label(data, piece[0], 1),
        "endTime": _label(data, piece[1], -1),
        "center": centre[0],
        "trajectory": {"type": "Spice", "target": str(craft_id), "center": centre[1]},
    }
    if stands:
        item["bodyFrame"] = {"type": "Spice", "name": ck.frame_name(craft_id)}
    if mesh is not None:
        item["geometry"] = {"type": "Mesh", "size": float(f"{0.5e-3 * mesh.extent:.6g}"), "source": "craft.obj"}
    item["label"] = {"color": color, "showText": True}
    item["trajectoryPlot"] = {
        "visible": True,
        "color": color,
        "lineWidth": 1,
        "duration": f"{shown / 86_400.0:.6g} d",
        "lead": "0 d",
        "fade": 0.5,
        "sampleCount": samples,
    }
    return item


def _trail(data: Evidence, span: float) -> tuple[float, int]:
    """(s that the trail shows, points of it): all of a flight, or the last revolutions of one that has many."""
    axis = data.table("/elements").columns["semi_major_axis_m"] if "/elements" in data.entities else np.zeros(0)
    mu = float(data.facts.get("body_mu_m3_s2", 0.0))
    bound = axis[np.isfinite(axis) & (axis > 0.0)]
    if not len(bound) or not mu > 0.0:
        return span, FEWEST
    turns = span / (2.0 * np.pi * float(np.sqrt(np.median(bound) ** 3 / mu)))
    shown = min(turns, SHOWN_TURNS) if turns > MANY_TURNS else turns
    return span * shown / turns, int(np.clip(SAMPLES * shown, FEWEST, MOST))


def _label(data: Evidence, et: float, way: int) -> str:
    """A moment as a catalogue has it, UTC, to the next ms within the span. way : 1 at its start, -1 at its end."""
    ns = tai(J2000, "TT") + round((et - spk.tdb_less_tt(et)) * 1e9)
    ms = ns // MS + 1 if way > 0 else -(-ns // MS) - 1
    try:
        (text,) = dates.utc_texts(np.array([ms * MS]))
        if text[17:19] == "60":  # no viewer's calendar has it
            (text,) = dates.utc_texts(np.array([ms * MS + way * 1000 * MS]))
    except DateError as error:
        raise RecordingError(f"{data.label}: {error}") from None
    return f"{text[:10]} {text[11:23]} UTC"


def _readme(title: str, mesh: CraftMesh | None, pieces: int) -> str:
    lines = [
        f"{MARK}: {title}",
        "",
        "In Cosmographia choose File, Open Catalog, and load.json in this folder; or start it with",
        "    Cosmographia load.json",
        "Then go to the start of the flight: the name of the craft is in the list of spacecraft.",
    ]
    if pieces > 1:
        lines.append(f"The flight has gaps: each of its {pieces} stretches is a spacecraft of its own.")
    if mesh is not None and mesh.nominal:
        lines.append(f"The scene does not say how large the craft is: it is shown {mesh.extent:,.4g} m wide.")
    return "\n".join([*lines, ""])
