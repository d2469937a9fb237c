"""What the commands share that read flights of others: about which body they are, and what the craft looks like."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import click

if TYPE_CHECKING:
    from sailviz.run.arrays import Run

body_option = click.option(
    "--body",
    default="",
    metavar="WORD",
    help="About which flights of others are, where their files do not say it: sun, earth, moon, mars...",
)


def mesh_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """--mesh, --unit and --front."""
    for option in (
        click.option(
            "--front", metavar="AXIS", help="Of the mesh, towards the Sun: +x, -y...; -z, as it is, by default."
        ),
        click.option(
            "--unit", metavar="WORD", help="In which the mesh counts: m, cm, mm, in, ft; of STL, OBJ and PLY."
        ),
        click.option("--mesh", metavar="FILE", help="What the craft looks like: STL, OBJ, GLB, PLY or 3MF."),
    ):
        command = option(command)
    return command


class FlightOptions(NamedTuple):
    """What is said of flights of others."""

    body: str = ""
    mesh: str | None = None
    unit: str | None = None
    front: str | None = None

    def check(self, files: tuple[str, ...]) -> None:
        """UsageError for what goes with none of the files; RecordingError for a body that is none."""
        from sailviz.recording.flights import is_flight

        if self.mesh is None and (self.unit or self.front):
            raise click.UsageError("--unit and --front are those of a mesh: give --mesh as well.")
        said = [f"--{name}" for name in ("body", "mesh") if getattr(self, name)]
        if said and not any(map(is_flight, files)):
            raise click.UsageError(f"{' and '.join(said)} are for flights of others, and all of these are recordings.")
        if self.body:
            from sailviz.recording.flights.centre import body_of

            body_of(self.body)

    def read(self, file: str) -> Run:
        """A flight of others as a run. RecordingError, in one sentence, where it is none."""
        from sailviz.recording.flights import Look, read_flight

        return read_flight(file, self.body, Look(self.mesh, self.unit, self.front))


NOTHING_SAID = FlightOptions()
