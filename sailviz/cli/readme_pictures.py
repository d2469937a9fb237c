"""The pictures of the README: one of every shipped scene, where it shows best, small enough for a repository."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from sailviz import files
from sailviz.errors import RecordingError
from sailviz.recording.views.movie import palette_of
from sailviz.recording.views.scratch import scratch
from sailviz.recording.views.screenshot import FRAME, Studio, check_vulkan
from sailviz.shipped import shipped_scenes

SIZE = (1280, 720)
LARGEST = 300_000  # bytes
COLUMNS = 3


@dataclass(frozen=True)
class Pose:
    """What a picture shows: the start of a view's name, "" for the whole window, and a fraction of the run."""

    view: str = "Flight"
    at: float = 0.7


POSES = {  # chosen by eye; a scene that is not here is shown as `Pose()` says, a low orbit from the craft
    "deorbit/satellite-100kg": Pose("", 0.5),
    "displaced/circular": Pose("", 0.7),
    "displaced/polar-observer": Pose("Flight", 0.5),
    "displaced/unstable": Pose("Flight", 1.0),
    "transfers/earth-mars-jpl-2015": Pose("", 0.2),
    "transfers/solar-polar": Pose("Flight", 0.95),
    "wind/mars": Pose("", 1.0),
}


def take(
    folder: str | Path,
    names: Sequence[str] = (),
    *,
    size: tuple[int, int] = SIZE,
    progress: Callable[[float], object] | None = None,
) -> dict[str, Path]:
    """Fly and photograph shipped scenes, all of them unless named -> name: picture. Raises RecordingError where a view
    complains, and as `picture` does.
    """
    from sailviz.recording import record
    from sailviz.scene import load_scene
    from sailviz.simulation import simulate_blocks

    check_vulkan()
    scenes = shipped_scenes()
    unknown = [name for name in names if name not in scenes]
    if unknown:
        raise RecordingError(f"there is no shipped scene {unknown[0]}; `sailviz list` names them")
    files = file_names(names or scenes)
    for number, (name, file) in enumerate(files.items()):
        with scratch() as place:
            path = place / "scene.rrd"
            record(simulate_blocks(load_scene(name)), path)
            photograph(path, Path(folder) / file, pose_of(name), size)
        if progress:
            progress((number + 1) / len(files))
    return {name: Path(folder) / file for name, file in files.items()}


def pose_of(name: str) -> Pose:
    """How a scene is shown."""
    return POSES.get(name, Pose("Riding along") if name.startswith("deorbit/") else Pose())


def file_names(names: Iterable[str]) -> dict[str, str]:
    """Scene -> file: the last part of its name, or all of it where two scenes share that."""
    last = [name.rsplit("/", 1)[-1] for name in shipped_scenes()]
    short = {name: name.rsplit("/", 1)[-1] for name in names}
    return {name: f"{end if last.count(end) == 1 else name.replace('/', '-')}.png" for name, end in short.items()}


def photograph(recording: Path, out: Path, pose: Pose, size: tuple[int, int]) -> None:
    """One picture of a recording, squeezed."""
    framed = (size[0] + FRAME[0], size[1] + FRAME[1]) if pose.view else size
    shot = recording.with_suffix(".png")
    with Studio(recording, size=framed, panels=False) as studio:
        report = studio.shoot(shot, view=pose.view or None, at=pose.at)
    if report.errors:
        raise RecordingError(f"a view complains while {out} is taken: {report.errors[0]}")
    with files.writing(out, "picture") as part:
        part.write_bytes(squeezed(shot.read_bytes()))


def squeezed(png: bytes, largest: int = LARGEST) -> bytes:
    """A PNG with a palette, of as many colours as its size allows; dithered, or the Sun's glow would show rings."""
    from PIL import Image

    image = Image.open(io.BytesIO(png)).convert("RGB")
    for colours in (256, 128, 64, 32):
        out = io.BytesIO()
        few = image.quantize(palette=palette_of(image, colours), dither=Image.Dither.FLOYDSTEINBERG)
        few.save(out, "PNG", optimize=True)
        if out.tell() <= largest:
            break
    return out.getvalue()


def markdown(pictures: dict[str, Path]) -> str:
    """A table of the pictures, each with the title of its scene and linked to its file."""
    from sailviz.scene import load_scene

    cells = [
        f"[![{load_scene(name).title}]({path.as_posix()})](scenes/{name}.toml)<br>{load_scene(name).title}"
        for name, path in pictures.items()
    ]
    cells += [""] * (-len(cells) % COLUMNS)
    rows = ["| " + " | ".join(cells[start : start + COLUMNS]) + " |" for start in range(0, len(cells), COLUMNS)]
    return "\n".join(["|" + "  |" * COLUMNS, "|" + "---|" * COLUMNS, *rows])
