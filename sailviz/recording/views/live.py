"""A viewer that stays open while one flight after another is shown in it.

Each flight comes with views of its own. What its person changed in the last ones (the eye, the tabs, what was zoomed
or hidden) is carried over, and so is the moment; then the last flight is closed. A flight is never sent into the
recording of the one before: rows beyond its own end would stay.
"""

from __future__ import annotations

import contextlib
import time
from pathlib import Path
from typing import TYPE_CHECKING, Self

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from sailviz.errors import RecordingError
from sailviz.recording.children import Child
from sailviz.recording.reader import read
from sailviz.recording.sinks import viewer_binary
from sailviz.recording.views.asking import ask, place_on
from sailviz.recording.views.carried import FAULTS, Blueprint, carried, with_faults, without_faults
from sailviz.recording.views.scratch import scratch
from sailviz.recording.views.viewers import check_screen
from sailviz.recording.web_page import HOST, check_free, free_port, viewer_environment

if TYPE_CHECKING:
    from rerun.experimental import Recording, ViewerClient, ViewerState

START, LOAD = 60.0, 60.0  # s to wait for the viewer, and for a flight to appear in it
TRIES, PAUSE = 10, 0.2  # a viewer that has just opened a flight may still go to its start; s between two tries
HERE = 0.02  # of the flight: so near to the moment it is there; it may be playing
WAITING = "sailviz_watch"  # the application of a text that stands where no flight could be shown yet


class LiveViewer:
    """The native viewer, started and ended with the body: `with LiveViewer() as viewer: viewer.show("a.rrd")`.

    port : on which it listens to this machine, 0 takes a free one. Raises RecordingError where there is no screen, the
    port is taken, or the viewer does not come up.
    """

    def __init__(self, port: int = 0):
        check_screen()
        if port:
            check_free(HOST, port)
        self._port = port or free_port()
        self._url = f"rerun+http://{HOST}:{self._port}/proxy"
        self._store: str | None = None  # of what is shown
        self._flown = False  # whether that is a flight, not a text alone
        self._given: Blueprint = {}  # the views that the flight brought
        self._counts: dict[str, np.ndarray] = {}  # first and last on each timeline; the viewer may know a part only

    def __enter__(self) -> Self:
        with contextlib.ExitStack() as begun:
            self.folder = begun.enter_context(scratch())
            command = [viewer_binary(), "--bind", HOST, "--port", str(self._port), "--hide-welcome-screen"]
            self._process = Child(command, viewer_environment())
            begun.callback(self._process.end)
            self._client = self._connected()
            self._begun = begun.pop_all()
        return self

    def __exit__(self, *_: object) -> None:
        self._begun.close()

    @property
    def is_open(self) -> bool:
        """Whether its window has not been closed."""
        return self._process.poll() is None

    def show(self, path: Path) -> None:
        """Show the flight of a recording in place of the last one. The file may go when the next one is shown."""
        before, last, moment = self._left(), self._store, self._moment()
        rows = read(path)["/state"]
        ask(self._process, "to open a flight", lambda: self._client.open(str(path)))
        self._store = self._until_shown(other_than=last)
        given = self._blueprint()
        self._counts = {name: rows.timeline(name).astype(np.int64)[[0, -1]] for name in rows.timelines}
        if before is not None:
            self._put(carried(self._given, before, given), moment)
        self._given, self._flown = given, True
        self._close(last)

    def tell(self, title: str, words: str) -> None:
        """Show a text above the flight, or alone where there is none; the next flight takes it away."""
        before, moment = self._left(), self._moment()
        # the viewer gives a file that it opens an application of its own, which the store's name tells
        names = (WAITING, WAITING) if before is None or self._store is None else self._store.split(":")[1:]
        stream = rr.RecordingStream(names[0], recording_id=names[1], send_properties=False)
        stream.set_log_time_enabled(False)
        stream.set_log_tick_enabled(False)
        stream.connect_grpc(self._url)
        stream.log(FAULTS, rr.TextDocument(words, media_type=rr.MediaType.MARKDOWN), static=True)
        if before is None:
            view = rrb.TextDocumentView(origin=FAULTS, name=title)
            stream.send_blueprint(rrb.Blueprint(view, auto_views=False, collapse_panels=True), make_active=True)
        stream.flush(timeout_sec=LOAD)
        stream.disconnect()
        if before is not None:
            self._put(with_faults(before, title), moment)
        else:
            self._store, self._flown = self._until_shown(other_than=None), False

    def _connected(self) -> ViewerClient:
        from rerun.experimental import ViewerClient

        started = time.monotonic()
        client: ViewerClient | None = None
        while time.monotonic() - started < START:
            if self._process.poll() is not None:
                raise RecordingError(f"the viewer ended at once with code {self._process.returncode}")
            with contextlib.suppress(OSError, RuntimeError):  # not up yet
                client = client or ViewerClient.connect(self._url)
                client.get_state()
                return client
            time.sleep(0.05)
        raise RecordingError(f"the viewer did not answer within {START:.0f} s")

    def _state(self) -> ViewerState:
        return ask(self._process, "for its state", lambda: self._client.get_state())

    def _recording(self) -> Recording | None:
        """What is shown, as the viewer knows it; None where its person closed it."""
        return next((known for known in self._state().recordings if known.store_id == self._store), None)

    def _blueprint(self) -> Blueprint:
        wanted = ask(self._process, "for its views", lambda: self._client.get_blueprint(store_id=self._store))
        found: Blueprint = wanted.blueprint
        return found

    def _left(self) -> Blueprint | None:
        """The views of the flight as its person left them; None where none is shown."""
        if not self._flown or self._recording() is None:
            return None
        return without_faults(self._blueprint())

    def _put(self, blueprint: Blueprint, moment: tuple[str, int] | None) -> None:
        """Arrange the views, and go to a moment, or to the end of a flight that is over by then: the viewer plays on
        where it is given views, also where it was told to pause."""
        ask(self._process, "to arrange its views", lambda: self._client.set_blueprint(blueprint, store_id=self._store))
        shown = self._recording()
        if moment is None or shown is None:
            return
        name, value = moment
        timeline = next((known for known in shown.timelines if known.name == name), None)
        if timeline is None or name not in self._counts:
            return
        first, last = self._counts[name].tolist()
        value = min(max(value, first), last)
        place = place_on(timeline.time_type, value)
        paused = blueprint.get("/time_panel", {}).get("TimePanelBlueprint", {}).get("play_state") == "Paused"
        place |= {"play_state": "paused"} if paused else {}
        for _ in range(TRIES):
            ask(self._process, "for a moment", lambda: self._client.set_time(name, **place))
            time.sleep(PAUSE)
            shown = self._recording()
            if shown is None or shown.current_time is None or abs(shown.current_time - value) <= HERE * (last - first):
                return

    def _moment(self) -> tuple[str, int] | None:
        """Timeline and count of the flight that is shown."""
        shown = self._recording() if self._flown else None
        if shown is None or shown.current_timeline is None or shown.current_time is None:
            return None
        return shown.current_timeline, shown.current_time

    def _until_shown(self, other_than: str | None) -> str:
        """The store of what has just been opened, once it is loaded and in front."""
        started = time.monotonic()
        while time.monotonic() - started < LOAD:
            state = self._state()
            shown = state.active_recording
            if shown and shown != other_than and not state.loading and state.views:
                return str(shown)
            time.sleep(0.05)
        raise RecordingError(f"the viewer did not show the flight within {LOAD:.0f} s")

    def _close(self, store: str | None) -> None:
        if store is not None and any(known.store_id == store for known in self._state().recordings):
            ask(self._process, "to close the last flight", lambda: self._client.close(store_ids=[store]))
