"""Tables of places for compiled code, against the source that they were made of."""

import numpy as np
import pytest

from sailviz.constants import DAY, YEAR
from sailviz.sky import Sky, table
from sailviz.sky.tables import evaluate

EPOCH = np.datetime64("2026-03-20T00:00:00", "ns")


@pytest.mark.parametrize(
    ("body", "centre", "most"),
    [
        ("moon", "earth", 0.002),
        ("sun", "earth", 0.024),
        ("earth", "sun", 0.024),
        ("mercury", "earth", 0.06),
        ("venus", "moon", 0.03),
        ("mercury", "sun", 0.045),
        ("sun", "mars", 0.01),
        ("jupiter", "sun", 0.005),
        ("saturn", "sun", 0.005),
    ],
)
def test_a_table_misses_de421_by_less_than_is_said(body, centre, most):
    pytest.importorskip("jplephem")
    pytest.importorskip("skyfield_data")
    sky, time = Sky(EPOCH, "icrf", "de421"), np.linspace(0.0, YEAR, 20_001)
    off = evaluate(table(sky, body, centre, YEAR), time) - sky.position(body, centre, time)
    assert np.linalg.norm(off, axis=1).max() < most


def test_a_table_serves_the_series_as_well():
    sky, time = Sky(EPOCH, "equator-of-date"), np.linspace(0.0, 100 * DAY, 5_001)
    off = evaluate(table(sky, "moon", "earth", 100 * DAY), time) - sky.position("moon", "earth", time)
    assert np.linalg.norm(off, axis=1).max() < 0.02  # its own short terms and rounding


def test_a_table_ends_with_the_run():
    """So that a kernel which ends there is not asked for more."""
    asked = []

    class Noted(Sky):
        def position(self, name, centre, time):
            asked.append(np.asarray(time))
            return super().position(name, centre, time)

    table(Noted(EPOCH), "venus", "sun", 11.3 * DAY)
    assert asked[0].min() >= 0.0
    assert asked[0].max() <= 11.3 * DAY
