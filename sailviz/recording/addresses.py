"""Addresses of viewers that run already, e.g. `rerun+http://192.168.0.5:9876/proxy`."""

from __future__ import annotations

import socket
from urllib.parse import urlsplit

from sailviz.errors import RecordingError

PORT = 9876  # of a viewer, unless the address says another
ANSWER = 3.0  # s


def host_and_port(url: str) -> tuple[str, int]:
    """(host, port) of a viewer's address. RecordingError for what is none."""
    try:
        parts = urlsplit(url)
        port = PORT if parts.port is None else parts.port
        if not parts.scheme.startswith("rerun") or not parts.hostname or port == 0 or not url.isprintable():
            raise ValueError
    except ValueError:  # also for a port that is no number up to 65535
        raise RecordingError(
            f"{url!r} is no address of a viewer, which looks like rerun+http://127.0.0.1:{PORT}/proxy, "
            "its port 1 to 65535"
        ) from None
    return parts.hostname, port


def check_answer(url: str) -> None:
    """Raise RecordingError unless something listens at a viewer's address: a stream to it would wait for ever."""
    try:
        socket.create_connection(host_and_port(url), timeout=ANSWER).close()
    except (OSError, UnicodeError) as error:  # UnicodeError: a name that no host can have
        raise RecordingError(f"no viewer answers at {url}: {getattr(error, 'strerror', None) or error}") from None
