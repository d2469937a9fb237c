"""Pictures on white, for paper: a picture of the dark viewer with every lightness turned round and every hue kept, so
that lines, names, axes and panels are as far from white as they were from black.

Whatever is a body keeps its own colours: the film, the craft, the Sun, a planet with its map and its night. They are
given the colours beforehand that turning round makes right. Stars are left out.
"""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np
import pyarrow as pa
import rerun as rr

from sailviz.recording.drawing import style
from sailviz.recording.reader import FilePath, read
from sailviz.shapes.planets import joined, parts_of

WHITE_FROM = 0.925  # lightness of the viewer's own dark grounds, turned round: from there on paper is white
DARKER = 0.2  # how much darker than turned round what is nearly black becomes, and half as much what is half as light
BODIES = re.compile(
    r"/shape/(film_lit|film_dark|vanes|booms|bus|panels|hub|tips)$|/drag_sail/(front|back)$|/tether/tip$"
    r"|/world/sun/(ball|glow)$|/globe/ball$|/world/night/zone\d+$|/world/ghosts/(lit|dark)$"
)
STARS = re.compile(r"/stars$")
JPEG_QUALITY = 88


def turned(color: np.ndarray) -> np.ndarray:
    """Colours (..., 3) of 0 to 1 with the other lightness, (largest + smallest) / 2, and the same hue."""
    return np.asarray(color + 1 - color.max(-1, keepdims=True) - color.min(-1, keepdims=True))


def lightness(color: np.ndarray) -> np.ndarray:
    """(..., 1) half of the largest and the smallest part of colours (..., 3)."""
    return np.asarray((color.max(-1, keepdims=True) + color.min(-1, keepdims=True)) / 2)


def on_paper(png: bytes) -> bytes:
    """A picture of the dark viewer, on white."""
    from PIL import Image

    dark = np.asarray(Image.open(io.BytesIO(png)).convert("RGB"))
    light = np.minimum(turned(dark / np.float32(255)) / WHITE_FROM, 1)
    light *= 1 - DARKER + DARKER * lightness(light)
    out = io.BytesIO()
    Image.fromarray(np.rint(255 * light).astype(np.uint8)).save(out, "PNG")
    return out.getvalue()


def before(color: np.ndarray) -> np.ndarray:
    """What a colour (..., 3) of 0 to 255 must be in the dark viewer to be itself on paper; what is bright and has much
    colour is a little darker."""
    wanted = np.asarray(color, np.float32) / 255
    least = 1 - DARKER  # of h in h (least + DARKER h) = lightness
    h = (np.sqrt(least**2 + 4 * DARKER * lightness(wanted)) - least) / (2 * DARKER)
    light = np.minimum(wanted / (least + DARKER * h), 1)
    return np.asarray(np.rint(255 * turned(WHITE_FROM * light)).astype(np.uint8))


def write_changes(path: FilePath, out: Path) -> Path:
    """A file with what is drawn otherwise for paper, to be opened beside the recording -> its path."""
    recording = read(path)
    changes: dict[str, rr.AsComponents] = {}
    for chunk in recording.chunks():
        if not chunk.is_static:
            continue
        change = change_of(chunk.entity_path, chunk.to_record_batch())
        if change is not None:
            changes[chunk.entity_path] = change
    identity = recording.recording_id
    with rr.RecordingStream(recording.application_id, recording_id=identity, send_properties=False) as stream:
        stream.set_log_time_enabled(False)
        stream.save(str(out))
        for entity, change in changes.items():
            stream.log(entity, change, static=True)
    return out


def change_of(entity: str, batch: pa.RecordBatch) -> rr.AsComponents | None:
    """What of an entity is other on paper, from a static piece of it; None where nothing is."""
    if STARS.search(entity) and "Points3D:colors" in batch.schema.names:
        return rr.Points3D.from_fields(colors=[style.BACKGROUND])
    if not BODIES.search(entity):
        return None
    if "Mesh3D:albedo_factor" in batch.schema.names:
        return rr.Mesh3D.from_fields(albedo_factor=colors_before(batch.column("Mesh3D:albedo_factor"))[0])
    if "GaussianSplats3D:colors" in batch.schema.names:
        return rr.GaussianSplats3D.from_fields(colors=colors_before(batch.column("GaussianSplats3D:colors")))
    if "Asset3D:blob" in batch.schema.names:
        return rr.Asset3D.from_fields(
            blob=map_before(batch.column("Asset3D:blob").flatten().values.to_numpy().tobytes())
        )
    return None


def colors_before(column: pa.Array) -> np.ndarray:
    """Colours (n, 4) of a column of 0xRRGGBBAA, as they must be in the dark viewer; how much they cover stays."""
    packed = column.flatten().to_numpy(zero_copy_only=False).astype(np.uint32)
    red, green, blue, alpha = (packed >> shift & 255 for shift in (24, 16, 8, 0))
    return np.concatenate([before(np.stack([red, green, blue], 1)), alpha[:, None].astype(np.uint8)], 1)


def map_before(glb: bytes) -> bytes:
    """A planet, a binary glTF file, whose map has the colours that turning round makes right."""
    from PIL import Image

    described, parts = parts_of(glb)
    own = described["images"][0]["bufferView"]
    out = io.BytesIO()
    Image.fromarray(before(np.asarray(Image.open(io.BytesIO(parts[own])).convert("RGB")))).save(
        out, "JPEG", quality=JPEG_QUALITY
    )
    parts[own] = out.getvalue()
    return joined(described, parts)
