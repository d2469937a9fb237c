"""The few ways in which the picture is written: what never moves, and columns of what does. float32, view units."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pyarrow as pa
import rerun as rr
from numpy.typing import ArrayLike

from sailviz.recording.drawing.style import ANCHOR, points, rgba
from sailviz.recording.timelines import MixedIndex
from sailviz.shapes.primitives import Trimesh, vertex_normals

Color = Sequence[int]  # red, green, blue and perhaps alpha, 0 to 255
Index = list[rr.TimeColumn]  # the timelines of some rows


def f4(values: ArrayLike) -> np.ndarray:
    """The values as float32, which is what Rerun draws."""
    return np.ascontiguousarray(values, dtype=np.float32)


class ArrowBatch:
    """An Arrow array where rerun wants a batch of components."""

    def __init__(self, array: pa.Array):
        self._array = array

    def as_arrow_array(self) -> pa.Array:
        """The array."""
        return self._array


def taken(column: rr.ComponentColumn, rows: np.ndarray) -> rr.ComponentColumn:
    """Some rows of a column."""
    lists = column.as_arrow_array().take(pa.array(rows))
    return rr.ComponentColumn(
        column.component_descriptor(), ArrowBatch(lists.flatten()), lengths=lists.value_lengths().to_numpy()
    )


class Picture:
    """Writes to a stream. Style is static, data have rows: a static value would hide the rows of the same component."""

    def __init__(self, stream: rr.RecordingStream):
        self._stream = stream

    def log_static(self, path: str, *what: Any) -> None:
        """What has no rows: archetypes, or batches of components."""
        self._stream.log(path, *what, static=True)

    def log_columns(self, path: str, index: Index, columns: Iterable[Any]) -> None:
        """Columns of components, a value for each row of the index; points between rows in a chunk of their own."""
        if not isinstance(index, MixedIndex):
            self._stream.send_columns(path, index, columns)
            return
        given = list(columns)
        for times, some in ((index.rows, ~index.filled), (index.between, index.filled)):
            if some.any():
                self._stream.send_columns(path, times, [taken(column, np.flatnonzero(some)) for column in given])

    def log_mesh(self, path: str, mesh: Trimesh, color: Color, shaded: bool = True, side: str | None = None) -> None:
        """A mesh of one colour, `side` "front" or "back" alone if given. Unshaded is flat: what glows, and air."""
        more: dict[str, Any] = {"vertex_normals": f4(vertex_normals(mesh))} if shaded else {}
        if side:
            more["face_rendering"] = side
        faces = np.ascontiguousarray(mesh.faces, np.uint32)
        self.log_static(
            path,
            rr.Mesh3D(vertex_positions=f4(mesh.vertices), triangle_indices=faces, albedo_factor=list(color), **more),
        )

    def log_lines(self, path: str, strips: Iterable[ArrayLike], color: Color, width: float) -> None:
        """Lines (k, 3) that stay; width in ui points."""
        self.log_static(
            path, rr.LineStrips3D([f4(strip) for strip in strips], colors=[list(color)], radii=points(width))
        )

    def log_bars(
        self, path: str, index: Index, heights: ArrayLike, centers: np.ndarray, color: Color, wide: float
    ) -> None:
        """heights (n, b): one bar chart a row, its bars `wide` over centers (b,)."""
        width = np.full(len(centers), wide)
        charts = [rr.BarChart(row, abscissa=centers, widths=width, color=list(color)) for row in np.asarray(heights)]
        batches = [{b.component_descriptor(): b for b in chart.as_component_batches()} for chart in charts]
        constant = [d for d in batches[0] if d.component != "BarChart:values"]
        self.log_static(path, *([batches[0][d]] for d in constant))
        values = next(d for d in batches[0] if d.component == "BarChart:values")
        column = ArrowBatch(pa.concat_arrays([batch[values].as_arrow_array() for batch in batches]))
        self.log_columns(path, index, [rr.ComponentColumn(values, column)])

    def log_triangles(self, path: str, faces: np.ndarray, color: Color) -> None:
        """Faces (m, 3) and colour of a mesh whose corners have rows.

        As a column, because what is logged waits a moment and a live viewer complains about corners without triangles.
        """
        indices = rr.Mesh3D.columns(triangle_indices=faces).partition([len(faces)])
        self.log_columns(path, [], [*indices, *rr.Mesh3D.columns(albedo_factor=[rgba(color, color[3])])])

    def log_scale(self, path: str, factor: ArrayLike) -> None:
        """How large everything below `path` is drawn. factor : float or (3,)."""
        self.log_static(path, rr.Transform3D(scale=f4(np.broadcast_to(np.asarray(factor, float), 3))))

    def log_pose(
        self,
        path: str,
        index: Index,
        *,
        translation: ArrayLike | None = None,
        quaternion: ArrayLike | None = None,
        scale: ArrayLike | None = None,
    ) -> None:
        """translation (n, 3), quaternion (n, 4) xyzw, scale (n, 3); what never changes stands there once."""
        given = {"translation": translation, "quaternion": quaternion, "scale": scale}
        values: dict[str, Any] = {name: f4(value) for name, value in given.items() if value is not None}
        if all(len(value) and np.all(value == value[0]) for value in values.values()):
            still: dict[str, Any] = {name: value[0] for name, value in values.items()}
            if quaternion is not None:
                still["quaternion"] = rr.Quaternion(xyzw=still["quaternion"])
            self.log_static(path, rr.Transform3D(**still))
            return
        self.log_columns(path, index, rr.Transform3D.columns(**values))

    def log_arrow_style(self, path: str, color: Color, width: float) -> None:
        """Colour and width, in ui points, of the arrows of an entity."""
        self.log_static(path, rr.Arrows3D.from_fields(colors=[list(color)], radii=points(width)))

    def log_arrows(self, path: str, index: Index, vectors: ArrayLike, origins: ArrayLike | None = None) -> None:
        """vectors (n, 3): one arrow a row, from the origin of its parent's frame or from origins (n, 3)."""
        more: dict[str, Any] = {} if origins is None else {"origins": f4(origins)}
        self.log_columns(path, index, rr.Arrows3D.columns(vectors=f4(vectors), **more))

    def log_strip_style(self, path: str, color: Color | None, width: float) -> None:
        """Colour, unless it has rows, and width, in ui points, of the lines of an entity."""
        more: dict[str, Any] = {} if color is None else {"colors": [list(color)]}
        self.log_static(path, rr.LineStrips3D.from_fields(radii=points(width), **more))

    def log_strips(self, path: str, index: Index, strips: ArrayLike, colors: ArrayLike | None = None) -> None:
        """strips (n, k, 3): one line of k points a row; colors (n,) 0xRRGGBBAA."""
        more: dict[str, Any] = {} if colors is None else {"colors": np.asarray(colors, np.uint32)}
        self.log_columns(path, index, rr.LineStrips3D.columns(strips=f4(strips), **more))

    def log_broken_strips(
        self, path: str, index: Index, groups: Sequence[Sequence[np.ndarray]], colors: ArrayLike | None = None
    ) -> None:
        """groups : for each row a list of lines (k, 3); colors (n,) 0xRRGGBBAA."""
        lines = [f4(line) for group in groups for line in group]
        if not lines:
            return
        columns = [*rr.LineStrips3D.columns(strips=lines).partition([len(group) for group in groups])]
        if colors is not None:
            columns += rr.LineStrips3D.columns(colors=np.asarray(colors, np.uint32))
        self.log_columns(path, index, columns)

    def log_label(self, path: str, text: str, color: Color, position: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """A text that stays where it is in its parent's frame. It hangs below its point."""
        self.log_static(
            path,
            rr.Points3D([f4(position)], radii=points(ANCHOR), colors=[list(color)], labels=[text], show_labels=True),
        )

    def log_label_style(self, path: str, color: Color, text: str | None = None) -> None:
        """Colour of the labels of an entity, and their text where it is always the same."""
        more: dict[str, Any] = {} if text is None else {"labels": [text]}
        self.log_static(
            path, rr.Points3D.from_fields(radii=points(ANCHOR), colors=[list(color)], show_labels=True, **more)
        )

    def log_labels(self, path: str, index: Index, positions: np.ndarray, texts: Sequence[str] | None = None) -> None:
        """positions (n, 3), texts (n): one label a row, none where a position is NaN."""
        known = np.all(np.isfinite(positions), axis=1)
        columns = [*rr.Points3D.columns(positions=f4(positions[known])).partition(known.astype(int))]
        if texts is not None:
            columns += rr.Points3D.columns(labels=list(texts))
        self.log_columns(path, index, columns)
