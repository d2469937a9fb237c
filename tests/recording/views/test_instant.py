"""Moments of a run, as people type them."""

import numpy as np
import pytest

from sailviz.errors import RecordingError
from sailviz.recording import record
from sailviz.recording.views.instant import fraction_of, moment

DAY = 86_400.0


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("start", 0.0),
        ("END", 1.0),
        ("0.6", 0.6),
        (0.25, 0.25),
        (1, 1.0),
        ("120d", (120 * DAY, "120d")),
        ("0.5 yr", (0.5 * 365.25 * DAY, "0.5 yr")),
        ("36h", (36 * 3600.0, "36h")),
        ("1e3 s", (1000.0, "1e3 s")),
    ],
)
def test_a_moment_is_a_word_a_fraction_or_a_time_with_its_unit(text, meaning):
    assert moment(text) == meaning


@pytest.mark.parametrize(
    ("text", "said"),
    [("soon", "start, end, a fraction"), ("3w", "yr"), ("2", "between 0 and 1"), ("nan", "start, end")],
)
def test_anything_else_is_refused_with_what_was_allowed(text, said):
    with pytest.raises(RecordingError, match=said):
        moment(text)


def test_a_time_becomes_a_place_in_the_run(run, tmp_path):
    path = tmp_path / "run.rrd"
    record(run, path)
    span = run.time[-1] - run.time[0]
    assert fraction_of(path, f"{span / 4}s") == pytest.approx(0.25, abs=1e-12)
    assert fraction_of(path, "0.25") == 0.25
    with pytest.raises(RecordingError, match="outside the run, which goes from 0 s to"):
        fraction_of(path, f"{np.nextafter(span, np.inf) * 1.01}s")
