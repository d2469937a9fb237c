"""A shape in the light as a recording of its own: facets coloured by their pressure, the arrow of the force, the
Sun's; one moment of the timeline `pitch` for each angle. Draws what it is given and computes no physics."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from sailviz.errors import RecordingError
from sailviz.recording.drawing import style
from sailviz.recording.drawing.lit_shape import colors_of, packed
from sailviz.recording.drawing.log import f4
from sailviz.recording.sinks import attach, discard, resolve

TIMELINE = "pitch"  # whole degrees


@dataclass(frozen=True)
class LitShape:
    """A shape in light from n directions. corners (k, 3, 3) m, pressure (n, k) over the largest there is, pitch (n,)
    whole degrees, light (n, 3) the way it travels, centre (n, 3) m where the force's line meets the shape, force (n, 3)
    over the largest."""

    title: str
    corners: np.ndarray
    pressure: np.ndarray
    pitch: np.ndarray
    light: np.ndarray
    centre: np.ndarray
    force: np.ndarray
    words: str


def record_shape(shape: LitShape, path: str | os.PathLike[str]) -> None:
    """Write the recording. RecordingError, in a sentence, where that cannot be."""
    sinks = resolve([path])
    corners = shape.corners.reshape(-1, 3)
    size = float(np.ptp(corners, axis=0).max())
    identity = hashlib.sha256(shape.title.encode() + f4(corners).tobytes() + f4(shape.pressure).tobytes()).hexdigest()[
        :16
    ]
    stream = rr.RecordingStream(f"sailviz_shape_{identity[:8]}", recording_id=identity, send_properties=False)
    stream.set_log_time_enabled(False)
    stream.set_log_tick_enabled(False)
    attached = attach(stream, sinks)
    try:
        stream.send_recording_name(shape.title)
        stream.send_blueprint(blueprint(size))
        log_shape(stream, shape, size)
        stream.flush()
        for drain in attached.drains:
            drain.settle()
        stream.disconnect()
        for drain in attached.drains:
            drain.close()
        for sink in sinks:
            if not isinstance(sink, str) and hasattr(sink, "publish"):
                sink.publish()
    except (OSError, RuntimeError, ValueError) as error:
        raise RecordingError(f"cannot write the recording {path}: {str(error).splitlines()[0]}") from None
    finally:
        discard(sinks)


def log_shape(stream: rr.RecordingStream, shape: LitShape, size: float) -> None:
    """The facets, each with corners of its own so that it has one colour; then what changes with the pitch."""
    corners = f4(shape.corners.reshape(-1, 3))
    faces = np.arange(len(corners), dtype=np.uint32).reshape(-1, 3)
    stream.log("/shape/facets", rr.Mesh3D(vertex_positions=corners, triangle_indices=faces), static=True)
    stream.log("/shape/words", rr.TextDocument(shape.words, media_type="text/markdown"), static=True)
    index = [rr.TimeColumn(TIMELINE, sequence=shape.pitch)]
    colors = np.repeat(packed(colors_of(shape.pressure)), 3, axis=1)
    columns = rr.Mesh3D.columns(vertex_colors=colors.ravel())
    stream.send_columns("/shape/facets", index, columns.partition([len(corners)] * len(shape.pitch)))
    arrows = {
        "/shape/force": (shape.centre, 0.6 * size * shape.force, style.PUSH),
        "/shape/light": (shape.centre - 0.9 * size * shape.light, 0.35 * size * shape.light, style.SUN),
    }
    for path, (origins, vectors, color) in arrows.items():
        stream.log(path, rr.Arrows3D.from_fields(colors=[list(color)], radii=style.points(2.5)), static=True)
        stream.send_columns(path, index, rr.Arrows3D.columns(origins=f4(origins), vectors=f4(vectors)))
    stream.log(
        "/shape/axes",
        rr.Arrows3D(
            origins=np.zeros((3, 3)),
            vectors=0.25 * size * np.eye(3),
            colors=[style.AXES] * 3,
            labels=["x", "y", "z"],
            radii=style.points(1.2),
        ),
        static=True,
    )


def blueprint(size: float) -> rrb.Blueprint:
    """One view of the shape from the Sun's side, and the words."""
    view = rrb.Spatial3DView(
        origin="/shape",
        name="The shape in the light",
        background=style.BACKGROUND,
        eye_controls=rrb.EyeControls3D(
            position=[-0.9 * size, -0.9 * size, -1.1 * size], look_target=[0, 0, 0], eye_up=[0, 1, 0]
        ),
        line_grid=rrb.LineGrid3D(visible=False),
    )
    words = rrb.TextDocumentView(origin="/shape/words", name="What it says")
    return rrb.Blueprint(
        rrb.Horizontal(view, words, column_shares=[3, 1]),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE),
        rrb.SelectionPanel(state="hidden"),
        rrb.BlueprintPanel(state="hidden"),
        auto_views=False,
    )
