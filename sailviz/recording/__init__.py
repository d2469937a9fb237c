"""Recordings: Run -> .rrd, and back. Computes no physics; draws anybody's arrays.

Names are imported when first used: rerun alone costs a second.
"""

from importlib import import_module

_HOMES = {
    "record": "write",
    "Recorder": "write",
    "Recorded": "write",
    "STDOUT": "sinks",
    "VIEWER": "sinks",
    "WEB": "sinks",
    "Viewer": "sinks",
    "Web": "sinks",
    "Connect": "sinks",
    "Memory": "sinks",
    "read": "reader",
    "Recording": "reader",
    "digest": "fingerprint",
    "compare": "comparison",
    "Comparison": "comparison",
    "export": "exporter",
    "info": "summary",
    "picture": "shot",
    "PictureReport": "shot",
    "make_movie": "movie",
    "MovieReport": "movie",
}
__all__ = list(_HOMES)


def __getattr__(name):
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__():
    return sorted([*globals(), *__all__])
