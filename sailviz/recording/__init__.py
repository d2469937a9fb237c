"""Recordings: Run -> .rrd, and back; computes no physics and draws anybody's arrays."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.recording.comparison.comparer import compare as compare
    from sailviz.recording.comparison.digest import digest as digest
    from sailviz.recording.comparison.result import Comparison as Comparison
    from sailviz.recording.exports import export as export
    from sailviz.recording.reader import Recording as Recording
    from sailviz.recording.reader import read as read
    from sailviz.recording.sinks import STDOUT as STDOUT
    from sailviz.recording.sinks import VIEWER as VIEWER
    from sailviz.recording.sinks import WEB as WEB
    from sailviz.recording.sinks import Connect as Connect
    from sailviz.recording.sinks import Memory as Memory
    from sailviz.recording.sinks import Viewer as Viewer
    from sailviz.recording.sinks import Web as Web
    from sailviz.recording.views.info import info as info
    from sailviz.recording.views.info import verify as verify
    from sailviz.recording.views.movie import MovieReport as MovieReport
    from sailviz.recording.views.movie import make_movie as make_movie
    from sailviz.recording.views.screenshot import PictureReport as PictureReport
    from sailviz.recording.views.screenshot import picture as picture
    from sailviz.recording.writer import Recorded as Recorded
    from sailviz.recording.writer import Recorder as Recorder
    from sailviz.recording.writer import record as record
    from sailviz.recording.writer import record_trajectory as record_trajectory

_HOMES = {
    "record": "writer",
    "record_trajectory": "writer",
    "Recorder": "writer",
    "Recorded": "writer",
    "STDOUT": "sinks",
    "VIEWER": "sinks",
    "WEB": "sinks",
    "Viewer": "sinks",
    "Web": "sinks",
    "Connect": "sinks",
    "Memory": "sinks",
    "read": "reader",
    "Recording": "reader",
    "digest": "comparison.digest",
    "compare": "comparison.comparer",
    "Comparison": "comparison.result",
    "export": "exports",
    "info": "views.info",
    "verify": "views.info",
    "picture": "views.screenshot",
    "PictureReport": "views.screenshot",
    "make_movie": "views.movie",
    "MovieReport": "views.movie",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
