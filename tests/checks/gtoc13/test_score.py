"""The score of GTOC13: numbers of the statement, and where its bodies stand."""

import numpy as np
import pytest

from sailviz.checks.gtoc13.passages import body_state
from sailviz.checks.gtoc13.score import Flyby, quality, scored, season, wheels
from sailviz.exchange.gtoc13 import CompetitionBody, read_catalogue


@pytest.mark.parametrize(
    ("v", "wanted"), [(0.5, 0.206440321), (1.5, 0.645511689), (3.0, 0.993483794), (10.0, 0.663369), (20.0, 0.414711172)]
)
def test_the_quality_of_a_flyby_by_its_speed(v, wanted):
    assert quality(v * 1e3) == pytest.approx(wanted, abs=1e-9 if wanted != 0.663369 else 5e-7)


def test_a_second_flyby_at_the_same_place_is_worth_two_elevenths():
    here = np.array([1.0, 2.0, 3.0])
    assert season(here, []) == 1.0
    assert season(here, [2 * here]) == pytest.approx(2 / 11)
    assert season(here, [-here]) == pytest.approx(1.0)


def test_where_a_body_stands(tmp_path):
    line = "10,PlanetX,3411912.397,12993.800,15955016885.357,0.345,40.000,341.693,30.000,133.427,50"
    (tmp_path / "gtoc13_planets.csv").write_bytes(b"#id,n\xe4me\r\n" + line.encode() + b"\r\n")
    body = read_catalogue(tmp_path)[10]
    place, velocity = body_state(body, np.array([3e9]))
    wanted = (-20709835407.10, 303734256.7273, -5216491819.437)
    assert np.abs(place[0] / 1e3 - wanted).max() < 0.01  # km: the digits printed
    assert np.abs(velocity[0] / 1e3 - (0.145694312, -1.639172712, -1.267414369)).max() < 1e-9


def _body(number):
    return CompetitionBody(number, "", 1e15, 1e7, 1e12, 0.1, 0.0, 0.0, 0.0, 0.0, 2.0)


def _flyby(number, time, science=True):
    place = np.array([np.cos(time), np.sin(time), 0.0])
    return Flyby(0, _body(number), time, 3000.0, 1e8, place, science)


def test_thirteen_flybys_of_a_body_count():
    counted, bonus = scored([_flyby(1, float(i)) for i in range(15)], 0.0)
    assert [each.counts for each in counted] == [True] * 13 + [False] * 2
    assert bonus == 1.0


def test_a_full_tour_has_a_bonus():
    numbers = [*range(1, 11), 1000, *range(1001, 1010), 2001, 2002, 2003]
    tour = [_flyby(number, 10.0 + i) for i, number in enumerate(numbers)]
    assert len(tour) == 23
    assert scored(tour, 5.0)[1] == 1.0  # twelve small bodies
    tour.append(_flyby(2004, 50.0))
    assert scored(tour, 5.0)[1] == 1.2
    assert scored(tour, 30.0)[1] == 1.0  # the asteroids came before the perihelion
    assert scored([flyby._replace(science=False) for flyby in tour], 5.0)[0][0].points == 0.0


def test_the_wheel_of_a_body_says_where_its_flybys_that_count_were():
    flybys = [_flyby(1, 1.0), _flyby(1, 1.1), _flyby(1, 4.0), _flyby(2, 6.0), _flyby(1, 5.0, science=False)]
    counted, _ = scored(flybys, 0.0)
    one, two = wheels(counted)
    assert (one.body.number, one.flybys, two.flybys) == (1, 3, 1)
    assert one.words == ".11....1...."
    wanted = [0] * 12
    for angle in (1.0, 1.1, 4.0):
        wanted[int(np.degrees(angle) // 30)] += 1
    assert list(one.sectors) == wanted
    assert two.sectors[int(np.degrees(6.0) // 30)] == 1
    assert one.points + two.points == pytest.approx(sum(flyby.points for flyby in counted))
