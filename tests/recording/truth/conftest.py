"""Every flight is flown and recorded once a session, when a test first looks at it, by the tests of one
process."""

from pathlib import Path

import pytest

from sailviz.recording import record
from sailviz.recording.overlay import record_together

from .flights import FLIGHTS, Flight


def pytest_collection_modifyitems(items):
    for item in items:
        if Path(item.path).parent == Path(__file__).parent and "flights" in item.fixturenames:
            item.add_marker(pytest.mark.xdist_group("truth"))


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
