"""Every flight is flown and recorded once, when a test first looks at it: these tests run in one process."""

import pytest

from sailviz.recording import record
from sailviz.recording.overlay import record_together

from .flights import FLIGHTS, Flight


@pytest.fixture(scope="session")
def flights(tmp_path_factory):
    """flights(name) -> Flight."""
    folder, known = tmp_path_factory.mktemp("flights"), {}

    def flight(name: str) -> Flight:
        if name not in known:
            path = folder / f"{name.replace(' ', '_')}.rrd"
            flown = FLIGHTS[name]()
            if isinstance(flown, dict):
                record_together(flown, path)
            else:
                record(flown, path)
            known[name] = Flight(name, path)
        return known[name]

    return flight
