"""What a question may say, and which search answers it."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz import transfers
from sailviz.constants import AU
from sailviz.design.minimum_time import circle_to_circle


def test_a_question_between_planets_means_circles_at_their_mean_distances():
    found = transfers.find("earth", "mars")
    assert found.kind == "circles"
    assert (found.origin.orbit.eccentricity, found.target.orbit.eccentricity) == (0.0, 0.0)
    r0, r1 = found.origin.orbit.semi_major_axis, found.target.orbit.semi_major_axis
    assert found.flight.time == circle_to_circle(r0, r1, "ideal", 1e-3).time


def test_a_lower_acceleration_takes_longer_for_every_sail():
    table = transfers.flight_times("earth", transfers.circle(0.9 * AU), ("ideal", "electric-sail"), [2e-3, 1e-3])
    assert table.time.shape == (2, 2)
    assert (table.time[1] > table.time[0]).all()


def test_a_place_is_the_planets_ellipse_and_a_circle_is_round():
    assert transfers.place("mercury").orbit.eccentricity == pytest.approx(0.2056, abs=1e-4)
    there = transfers.circle(AU, np.radians(5))
    assert (there.orbit.eccentricity, there.orbit.inclination) == (0.0, np.radians(5))


@pytest.mark.parametrize(
    ("ask", "answer"),
    [
        (lambda: transfers.place("mras"), 'Did you mean "mars"?'),
        (lambda: transfers.circle(-AU), "positive"),
        (lambda: transfers.circle(AU, 4.0), "between 0 and 180 deg"),
        (lambda: transfers.find("earth", "mars", "idael"), 'Did you mean "ideal"?'),
        (lambda: transfers.find("earth", "earth"), "nothing to fly"),
        (lambda: transfers.find("earth", "mars", departure="20x0"), "is no date"),
        (lambda: transfers.find("earth", transfers.circle(AU), departure="2030-01-01"), "1 au is none of them"),
    ],
)
def test_what_cannot_be_asked_is_refused_in_words(ask, answer):
    with pytest.raises(ValueError, match=r".") as error:
        ask()
    assert answer in str(error.value)
