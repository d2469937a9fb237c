"""What the commands share that show several flights in one picture: what these are called, and how they get there."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import click

from sailviz.cli.flight_options import NOTHING_SAID, FlightOptions
from sailviz.cli.shared import tell
from sailviz.errors import RecordingError

name_option = click.option(
    "--name",
    "names",
    multiple=True,
    metavar="NAME",
    help="What a flight is called in one picture; once for each.",
)
together_option = click.option(
    "--together/--apart",
    default=None,
    help="In one picture, or else an error; or each by itself. By default in one picture where that can be.",
)
OTHERWISE = "; --name NAME, once for each flight, calls them otherwise"


def flight_names(sources: Sequence[str], given: Sequence[str]) -> list[str]:
    """What flights are called: as was said, or after their files, with the folder where two have one name. UsageError
    for more or fewer names than flights."""
    if given and len(given) != len(sources):
        raise click.UsageError(
            f"--name is given {len(given)} times for {len(sources)} flights: once for each, in order."
        )
    if given:
        return list(given)
    stems = [Path(source).stem.replace("-", " ") for source in sources]
    longer = [f"{Path(source).absolute().parent.name}/{stem}" for source, stem in zip(sources, stems, strict=True)]
    count, apart = Counter(stems), len(set(longer)) == len(longer)
    return [more if apart and count[stem] > 1 else stem for stem, more in zip(stems, longer, strict=True)]


def check_asked_for(files: Sequence[str], together: bool | None, given: Sequence[str]) -> None:
    """UsageError for what makes no one picture."""
    if given and (together is False or len(files) < 2):
        raise click.UsageError("--name is for several flights in one picture.")
    if together and len(files) < 2:
        raise click.UsageError("--together takes two recordings or more.")
    flight_names(files, given)


@contextmanager
def recorded(files: Sequence[str], said: FlightOptions = NOTHING_SAID) -> Iterator[list[str]]:
    """The files, and in the place of each flight of others a recording of it that is gone afterwards. said : of these
    flights."""
    from sailviz.recording.flights import is_flight

    if not any(map(is_flight, files)):
        yield list(files)
        return
    from sailviz.recording.views.scratch import scratch
    from sailviz.recording.writer import record

    with scratch() as folder:
        shown: list[str] = []
        for number, file in enumerate(files):
            if is_flight(file):
                place = folder / str(number)
                place.mkdir()
                made = place / f"{Path(file).stem or 'flight'}.rrd"
                record(said.read(file), made)
                shown.append(str(made))
            else:
                shown.append(file)
        yield shown


@contextmanager
def one_picture(files: Sequence[str], together: bool | None, given: Sequence[str]) -> Iterator[tuple[str | Path, ...]]:
    """What is to be shown of recordings: one of them all where that was asked for, or where nothing was and it can be;
    else they themselves, and why. RecordingError where it cannot be and was asked for."""
    if together is False or len(files) < 2:
        yield tuple(files)
        return
    from sailviz.recording.views.scratch import scratch

    with scratch() as folder:
        made = folder / "together.rrd"
        try:
            put_together(files, flight_names(files, given), made)
        except RecordingError as error:
            if together or given:
                raise
            tell(f"Shown apart: {error}")
            yield tuple(files)
            return
        if together is None:
            tell(f"{len(files)} flights in one picture; --apart shows each by itself.")
        yield (made,)


def check_files(files: Sequence[str]) -> None:
    """Raise RecordingError, in one sentence, for a file that is no recording."""
    from sailviz.recording.reader import read

    for file in files:
        read(file)


def put_together(files: Sequence[str], names: Sequence[str], made: Path) -> None:
    """Record the flights of recordings in one picture. RecordingError where that cannot be."""
    from sailviz.recording.companions import name_faults
    from sailviz.recording.overlay import record_together
    from sailviz.recording.reader import read
    from sailviz.recording.recorded_run import drawn_run_of

    refuse_names(name_faults(names))
    record_together({name: drawn_run_of(read(file)) for name, file in zip(names, files, strict=True)}, made)


def refuse_names(faults: Sequence[str]) -> None:
    """Raise RecordingError for faulty names, with how to give others."""
    if faults:
        raise RecordingError("these flights cannot be put in one picture: " + "; ".join(faults) + OTHERWISE)
