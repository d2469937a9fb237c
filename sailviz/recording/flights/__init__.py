"""Flights of others, read from their files as runs: ephemeris messages, kernels of SPICE, tables and archives."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.recording.flights.files import Look as Look
    from sailviz.recording.flights.files import is_flight as is_flight
    from sailviz.recording.flights.files import read_flight as read_flight

_HOMES = {
    "Look": "files",
    "is_flight": "files",
    "read_flight": "files",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
