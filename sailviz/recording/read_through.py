"""The program of the process in which a file without checksums is read from end to end: it may end of what it reads."""

from __future__ import annotations

import sys
from pathlib import Path

from sailviz.recording.comparison.tables import epoch_of, truth_of, views_of
from sailviz.recording.probe import UNREADABLE
from sailviz.recording.reader import Recording


def read_through(path: Path) -> None:
    """Read all that a file holds, as the rest of sailviz does. Raises whatever that raises."""
    recording = Recording(path, trusted=True)
    for chunk in recording.chunks():
        chunk.to_record_batch().validate(full=True)
    for layout in recording.blueprints():
        for chunk in layout:
            chunk.to_record_batch().validate(full=True)
    for name in recording.entities:
        entity = recording.fresh(name)
        for column in entity if recording.contract else ():
            entity.arrow(column).to_pylist() if name == "/scene" else entity[column]
    views_of(recording), epoch_of(recording), truth_of(recording)
    _ = recording.events, recording.resolved, recording.versions, recording.complete, recording.application_id


def main() -> int:
    """The process: exit code 0 for a file that can be read, UNREADABLE and a few words for one that cannot."""
    try:
        read_through(Path(sys.argv[1]))
    except BaseException as error:  # a panic of Rust is no Exception
        words = (str(error).splitlines() or [""])[0]
        sys.stdout.buffer.write(f"{words or type(error).__name__}"[:160].encode())
        return UNREADABLE
    return 0


if __name__ == "__main__":
    sys.exit(main())
