"""The few ways in which the picture is written: what never moves, and columns of what does. float32, view units."""

from __future__ import annotations

import numpy as np
import pyarrow as pa
import rerun as rr

from sailviz.recording.drawing.meshes import Mesh
from sailviz.recording.drawing.style import ANCHOR, points, rgba


def f4(values) -> np.ndarray:
    return np.ascontiguousarray(values, dtype=np.float32)


class Arrow:
    """An Arrow array where rerun wants a batch of components."""

    def __init__(self, array: pa.Array):
        self._array = array

    def as_arrow_array(self) -> pa.Array:
        return self._array


class Pen:
    """Writes to a stream. Style is static, data have rows: a static value would hide the rows of the same component."""

    def __init__(self, stream: rr.RecordingStream):
        self._stream = stream

    def static(self, path: str, *what) -> None:
        self._stream.log(path, *what, static=True)

    def columns(self, path: str, index, columns) -> None:
        self._stream.send_columns(path, index, columns)

    def mesh(self, path: str, mesh: Mesh, color, shaded: bool = True, side: str | None = None) -> None:
        """A mesh of one colour, `side` "front" or "back" alone if given. Unshaded is flat: what glows, and air."""
        more = {"vertex_normals": f4(mesh.normals)} if shaded else {}
        if side:
            more["face_rendering"] = side
        faces = np.ascontiguousarray(mesh.faces, np.uint32)
        self.static(
            path,
            rr.Mesh3D(vertex_positions=f4(mesh.vertices), triangle_indices=faces, albedo_factor=list(color), **more),
        )

    def lines(self, path: str, strips, color, width: float) -> None:
        self.static(path, rr.LineStrips3D([f4(strip) for strip in strips], colors=[list(color)], radii=points(width)))

    def bars(self, path: str, index, heights, centers, color) -> None:
        """heights (n, b): one bar chart a row, its bars over centers (b,), evenly spaced."""
        width = np.full(len(centers), 0.92 * (centers[1] - centers[0]))
        charts = [rr.BarChart(row, abscissa=centers, widths=width, color=list(color)) for row in np.asarray(heights)]
        batches = [{b.component_descriptor(): b for b in chart.as_component_batches()} for chart in charts]
        style = [d for d in batches[0] if d.component != "BarChart:values"]
        self.static(path, *([batches[0][d]] for d in style))
        values = next(d for d in batches[0] if d.component == "BarChart:values")
        column = Arrow(pa.concat_arrays([batch[values].as_arrow_array() for batch in batches]))
        self.columns(path, index, [rr.ComponentColumn(values, column)])

    def ribbon(self, path: str, one, other, color) -> None:
        """The band between two lines (k, 3), seen from both sides; color with alpha."""
        k = np.arange(len(one) - 1)
        corners = np.concatenate([one, other])
        a, b, c, d = k, k + 1, len(one) + k, len(one) + k + 1
        faces = np.concatenate([np.stack([a, b, c], 1), np.stack([b, d, c], 1)]).astype(np.uint32)
        self.static(path, rr.Mesh3D(vertex_positions=f4(corners), triangle_indices=faces, albedo_factor=list(color)))

    def triangles(self, path: str, faces, color) -> None:
        """Faces (m, 3) and colour of a mesh whose corners have rows.

        As a column, because what is logged waits a moment and a live viewer complains about corners without triangles.
        """
        indices = rr.Mesh3D.columns(triangle_indices=faces).partition([len(faces)])
        self.columns(path, [], [*indices, *rr.Mesh3D.columns(albedo_factor=[rgba(color, color[3])])])

    def scale(self, path: str, factor) -> None:
        """How large everything below `path` is drawn. factor : float or (3,)."""
        factor = np.broadcast_to(np.asarray(factor, float), 3)
        self.static(path, rr.Transform3D(scale=f4(factor)))

    def move(self, path: str, index, *, translation=None, quaternion=None) -> None:
        """translation (n, 3), quaternion (n, 4) xyzw."""
        given = {"translation": translation, "quaternion": quaternion}
        values = {name: f4(value) for name, value in given.items() if value is not None}
        self.columns(path, index, rr.Transform3D.columns(**values))

    def arrow_style(self, path: str, color, width: float) -> None:
        self.static(path, rr.Arrows3D.from_fields(colors=[list(color)], radii=points(width)))

    def arrows(self, path: str, index, vectors, origins=None) -> None:
        """vectors (n, 3), origins (n, 3): one arrow a row."""
        more = {} if origins is None else {"origins": f4(origins)}
        self.columns(path, index, rr.Arrows3D.columns(vectors=f4(vectors), **more))

    def strip_style(self, path: str, color, width: float) -> None:
        more = {} if color is None else {"colors": [list(color)]}
        self.static(path, rr.LineStrips3D.from_fields(radii=points(width), **more))

    def strips(self, path: str, index, strips, colors=None) -> None:
        """strips (n, k, 3): one line of k points a row; colors (n,) 0xRRGGBBAA."""
        more = {} if colors is None else {"colors": np.asarray(colors, np.uint32)}
        self.columns(path, index, rr.LineStrips3D.columns(strips=f4(strips), **more))

    def broken_strips(self, path: str, index, groups, colors=None) -> None:
        """groups : for each row a list of lines (k, 3); colors (n,) 0xRRGGBBAA."""
        lines = [f4(line) for group in groups for line in group]
        if not lines:
            return
        columns = [*rr.LineStrips3D.columns(strips=lines).partition([len(group) for group in groups])]
        if colors is not None:
            columns += rr.LineStrips3D.columns(colors=np.asarray(colors, np.uint32))
        self.columns(path, index, columns)

    def label(self, path: str, text: str, color, position=(0.0, 0.0, 0.0)) -> None:
        """A text that stays where it is in its parent's frame. It hangs below its point."""
        self.static(
            path,
            rr.Points3D([f4(position)], radii=points(ANCHOR), colors=[list(color)], labels=[text], show_labels=True),
        )

    def label_style(self, path: str, color, text: str | None = None) -> None:
        more = {} if text is None else {"labels": [text]}
        self.static(path, rr.Points3D.from_fields(radii=points(ANCHOR), colors=[list(color)], show_labels=True, **more))

    def labels(self, path: str, index, positions, texts=None) -> None:
        """positions (n, 3), texts (n): one label a row, none where a position is NaN."""
        known = np.all(np.isfinite(positions), axis=1)
        columns = [*rr.Points3D.columns(positions=f4(positions[known])).partition(known.astype(int))]
        if texts is not None:
            columns += rr.Points3D.columns(labels=list(texts))
        self.columns(path, index, columns)
