"""How long a search may go on and how it ends."""

from __future__ import annotations

import os
import signal
import threading
import time

import numpy as np
import pytest

from sailviz.design.minimum_time.effort import INTERRUPTED, TIME_LIMIT, Effort, Stopped
from sailviz.design.minimum_time.shooting import solve


def test_a_search_ends_with_its_time_and_says_so():
    effort = Effort(time_limit=0.05)
    with effort.stoppable():
        while True:
            solve(effort.watched(lambda x: x**2 + 1.0), [1.0])
    assert effort.stopped == TIME_LIMIT
    assert 0.05 <= effort.seconds < 1.0
    with pytest.raises(Stopped):
        effort.part(0.0, 0.5).check()


@pytest.mark.skipif(os.name == "nt", reason="Windows sends no SIGINT to one process")
def test_the_first_ctrl_c_keeps_what_was_found_and_the_second_is_heard_as_ever():
    effort, before = Effort(), signal.getsignal(signal.SIGINT)

    def pressed_twice():
        with effort.listening():
            with effort.stoppable():
                _press_ctrl_c(effort.check)
            assert effort.stopped == INTERRUPTED
            _press_ctrl_c(lambda: None)

    with pytest.raises(KeyboardInterrupt):
        pressed_twice()
    assert signal.getsignal(signal.SIGINT) is before


def _press_ctrl_c(work):
    os.kill(os.getpid(), signal.SIGINT)
    for _ in range(1000):
        work()
        time.sleep(1e-3)


def test_what_was_tried_is_counted_over_threads_and_told_in_words():
    effort = Effort()
    threads = [threading.Thread(target=lambda: [effort.count("costates flown") for _ in range(500)]) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    effort.count("flights finished", 3)
    assert effort.not_found("none").tried == "2,000 costates flown, 3 flights finished"


def test_a_search_within_another_tells_its_share_of_the_whole():
    told = []
    effort = Effort(progress=lambda share, words: told.append(share))
    effort.part(0.5, 1.0).part(0.0, 0.5).report(0.5, "half of a quarter")
    assert told == pytest.approx(np.array([0.625]))


def test_an_effort_and_a_time_limit_beside_it_are_refused():
    with pytest.raises(ValueError, match="positive"):
        Effort(time_limit=float("nan"))
    with pytest.raises(ValueError, match="of its own"):
        Effort.of(Effort(), None, 3.0)
