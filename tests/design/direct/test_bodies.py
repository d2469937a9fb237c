"""Direct flights in space to a body where it is, on a date and on the best of a window."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import AU, DAY
from sailviz.design.direct import guesses
from sailviz.design.direct.ends import Body, FromBody, ToBody, eccentric_anomaly
from sailviz.design.direct.frames_of_state import Spatial
from sailviz.design.direct.search import fastest, sail_of
from sailviz.design.direct.transcription import Question
from sailviz.design.minimum_time.kepler_orbit import KeplerOrbit
from sailviz.design.minimum_time.state_costate import TIME_UNIT
from sailviz.elements import Elements

JD = 2461123.5  # of the epoch
DAYS = DAY / TIME_UNIT


def body(epoch, a, e, *degrees):
    i, node, argument, mean = np.radians(degrees)
    orbit = KeplerOrbit.from_elements(Elements(a * AU, e, i, node, argument, 0.0))
    return Body(orbit, mean + (JD - epoch) * DAYS * a**-1.5)


EARTH = body(2451545.0, 1.00000011, 0.01671022, 0.00005, -11.26064, 114.20783, -2.48284)
KAMOOALEWA = body(2460400.5, 1.00094, 0.10269, 7.79605, 65.7907, 305.0478, 175.153)


@pytest.mark.parametrize(
    ("window", "departure", "days"),
    # an ideal sail of 1 mm/s2, by shooting with another integrator
    [(0.0, 0.0, 224.8366250), (60.0, 2461123.2778657 - JD, 224.8363449)],
)
def test_body_is_met_after_the_time_that_shooting_finds(window, departure, days):
    pytest.importorskip("casadi")
    start = FromBody(EARTH, -window * DAYS, window * DAYS, 0.0)
    question = Question(Spatial(), sail_of("ideal", 1e-3), start, ToBody(KAMOOALEWA, 225 * DAYS), intervals=20)
    guess = guesses.spatial(question, EARTH.state(0.0), KAMOOALEWA.state(225 * DAYS), 225 * DAYS, 0)
    found = fastest(question, [guess], 1e-3, sharpen=False)
    assert found.time / DAY == pytest.approx(days, abs=2e-5)
    assert found.departure / DAY == pytest.approx(departure, abs=2e-2)
    assert found.miss < 1e-5


@pytest.mark.parametrize("e", [0.0, 0.2, 0.97, 0.9999])
@pytest.mark.parametrize("mean", [0.0, 1e-3, 2.0, -3.1, 40.0])
def test_eccentric_anomaly_solves_keplers_equation(e, mean):
    found = eccentric_anomaly(mean, e)
    assert found - e * np.sin(found) == pytest.approx(mean, abs=1e-13)
