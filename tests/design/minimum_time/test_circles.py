"""Minimum-time transfers: reference rows from a cold start, symmetries of the problem, and flights flown again."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from sailviz.constants import AU, DAY, MU_SUN
from sailviz.design.minimum_time import circle_to_circle, circles, planar_orbit_to_orbit, sail_from
from sailviz.design.minimum_time.boundary_conditions import ToCircle
from sailviz.design.minimum_time.continuation import follow
from sailviz.design.minimum_time.effort import FOUND, IMPOSSIBLE, NOT_FOUND, TIME_LIMIT, Effort
from sailviz.design.minimum_time.finishing import distinct, finish
from sailviz.design.minimum_time.search import search
from sailviz.propulsion import solar_sail
from sailviz.propulsion.solar_sail import Film

MARS, VENUS, MERCURY = 1.52366231, 0.72333199, 0.38709893
YEAR_UNIT = np.sqrt(AU**3 / MU_SUN)
solved = cache(circle_to_circle)


# device, target au, a_c mm/s2; flight time d, revolutions, costates: rows of the reference table
ROWS = [
    ("ideal", MARS, 1, 407.698642981187, 0.6908, (7.4256742, 4.2372588, 7.9249668)),
    ("ideal", MERCURY, 0.25, 941.281573576169, 4.6360, (-62.8467369, -3.2336597, -66.0810421)),
    ("jpl-2015", MARS, 0.5, 622.940324966104, 1.0966, (64.8751827, -2.9121931, 37.9168467)),
    ("jpl-1978", VENUS, 0.5, 284.36261074130084, 0.8878, (-30.0191311, -0.0805582, -34.2368231)),
    ("electric-sail", VENUS, 2, 244.973560548558, 0.6523, (-21.4569481, -4.6144670, -25.2859666)),
    ("electric-sail-updated", VENUS, 0.5, 271.24906348739324, 0.8397, (-24.6310323, -3.7630240, -30.2380829)),
]


@pytest.mark.parametrize(("device", "target", "ac", "days", "turns", "costates"), ROWS)
def test_cold_start_finds_the_reference_transfer(device, target, ac, days, turns, costates):
    found = solved(AU, target * AU, device, ac * 1e-3)
    assert found.time / DAY == pytest.approx(days, rel=1e-9)
    assert found.revolutions == pytest.approx(turns, abs=0.51e-4)
    assert found.costates == pytest.approx(np.array(costates), abs=2e-6)
    assert found.residual < 1e-9
    assert found.hamiltonian_drift < 1e-9
    assert found.solutions == len(found.solution_times) >= 1
    assert "Best found" in found.claim


# a_c mm/s2, target au; flight time d, revolutions, costates: an ideal sail outwards, by two codes, confirmed by direct
# transcription to 3e-4
OUTWARDS = [
    (1, 5.2026, 3779.827616, 1.889851, (9.6237487, 3.7526825, 9.0345734)),
    (2, 5.2026, 2394.877495, 0.909918, (4.3962960, 2.0235278, 4.1878100)),
    (1, 9.5371, 9878.896743, 2.657821, (8.5951529, 4.7262767, 6.6460595)),
    (2, 9.5371, 6175.292511, 1.224552, (7.4681926, 2.7206329, 2.0989982)),
]


@pytest.mark.parametrize(("ac", "target", "days", "turns", "costates"), OUTWARDS)
def test_cold_start_finds_the_reference_transfer_to_jupiter_and_saturn(ac, target, days, turns, costates):
    found = circle_to_circle(AU, target * AU, "ideal", ac * 1e-3)
    assert found.time / DAY == pytest.approx(days, abs=6e-7)
    assert found.revolutions == pytest.approx(turns, abs=6e-7)
    assert found.costates == pytest.approx(np.array(costates), abs=1e-7)
    assert found.residual < 1e-9
    assert found.hamiltonian_drift < 1e-9


@pytest.mark.parametrize(("ac", "target", "days", "turns", "costates"), OUTWARDS)
def test_costates_of_the_reference_lead_scipy_to_jupiter_and_saturn(ac, target, days, turns, costates):
    """In polar form, the pitch by its closed form, without this package's equations; the costates have eight digits."""
    strength = ac / 5.930083519

    def rates(t, y):
        r, _, u, v, lam_r, lam_u, lam_v = y
        slope = (np.hypot(3 * lam_u, np.sqrt(8) * lam_v) - 3 * lam_u) / (4 * lam_v)  # tan of the pitch
        c = 1 / np.hypot(1, slope)
        along, across = strength / r**2 * c**3, strength / r**2 * c**3 * slope
        pull = lam_u * (v**2 / r**2 - 2 / r**3 + 2 * along / r) + lam_v * (2 * across / r - u * v / r**2)
        turning = lam_v * v / r - lam_r, (lam_v * u - 2 * lam_u * v) / r
        return [u, v / r, v**2 / r - 1 / r**2 + along, across - u * v / r, pull, *turning]

    span = days * DAY / YEAR_UNIT
    y = solve_ivp(rates, (0, span), [1, 0, 0, 1, *costates], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    assert y[0] / target == pytest.approx(1, abs=1e-6)
    assert y[2] == pytest.approx(0, abs=1e-6)
    assert y[3] * np.sqrt(target) == pytest.approx(1, abs=1e-6)
    assert y[1] / (2 * np.pi) == pytest.approx(turns, abs=1e-6)


def test_the_pitch_history_flown_alone_arrives_on_the_target_circle():
    """An independent integrator, the force model and the pitch as a spline: 1e-6 is the spline's error."""
    found = solved(AU, MARS * AU, "ideal", 1e-3)
    path = found.trajectory(4001)
    pitch = CubicSpline(path.time, path.pitch)

    def rates(t, y):
        r_hat = y[:3] / np.linalg.norm(y[:3])
        alpha = pitch(t)
        normal = np.cos(alpha) * r_hat + np.sin(alpha) * np.array([-r_hat[1], r_hat[0], 0.0])
        pull = -MU_SUN * y[:3] / np.linalg.norm(y[:3]) ** 3
        return np.concatenate([y[3:], pull + solar_sail.acceleration(y[:3], normal, 1e-3, "ideal")])

    start = np.concatenate([path.position[0], path.velocity[0]])
    scale = np.array([AU] * 3 + [3e4] * 3)
    end = solve_ivp(rates, (0, found.time), start, method="DOP853", rtol=1e-11, atol=1e-11 * scale).y[:, -1]
    r, speed = np.linalg.norm(end[:3]), np.linalg.norm(end[3:])
    assert r / (MARS * AU) == pytest.approx(1, abs=1e-6)
    assert speed / np.sqrt(MU_SUN / (MARS * AU)) == pytest.approx(1, abs=1e-6)
    assert end[:3] @ end[3:] / (r * speed) == pytest.approx(0, abs=1e-6)
    angle = np.unwrap(np.arctan2(path.position[:, 1], path.position[:, 0]))
    assert angle[-1] / (2 * np.pi) == pytest.approx(found.revolutions, abs=1e-12)


def test_costates_are_minus_the_change_of_flight_time_with_the_initial_state():
    """dt_f = -lambda . dx0: central differences of the flight time over steps of 1e-4, error of second order."""
    found = solved(AU, MARS * AU, "ideal", 1e-3)
    sail = sail_from("ideal", 1e-3, AU)
    guess = np.append(found.costates / np.linalg.norm(found.costates), found.time / YEAR_UNIT)
    for place, costate in enumerate(found.costates):
        times = []
        for sign in (1, -1):
            start = np.array([1.0, 0.0, 1.0])
            start[place] += sign * 1e-4
            times.append(finish(ToCircle(sail, tuple(start), MARS), guess).time)
        assert (times[0] - times[1]) / 2e-4 == pytest.approx(-costate, rel=1e-5)


def test_time_scales_with_the_three_halves_power_of_distance():
    """The Sun's pull and a solar sail's thrust fall off alike; an E-sail's needs half the strength at twice the
    distance."""
    near, far = solved(AU, MARS * AU, "ideal", 1e-3), solved(2 * AU, 2 * MARS * AU, "ideal", 1e-3)
    assert far.time == pytest.approx(2**1.5 * near.time, rel=1e-12)
    assert far.costates == pytest.approx(near.costates, rel=1e-9)
    near, far = sail_from("electric-sail", 1e-3, AU), sail_from("electric-sail", 0.5e-3, 2 * AU)
    assert far.parameters == pytest.approx(near.parameters, rel=1e-15)
    far = sail_from("electric-sail-original", 1e-3 * 2 ** (-5 / 6), 2 * AU)
    assert far.parameters == pytest.approx(sail_from("electric-sail-original", 1e-3, AU).parameters, rel=1e-14)


def test_optical_transfer_tends_to_the_ideal_one():
    """Linearly in what the film lacks."""
    ideal = solved(AU, MARS * AU, "ideal", 1e-3).time
    longer = [circle_to_circle(AU, MARS * AU, Film(q / 2, 1 - q, 0.0), 1e-3).time / ideal - 1 for q in (2e-3, 1e-3)]
    assert longer[1] > 0
    assert longer[0] == pytest.approx(2 * longer[1], rel=0.01)


def test_electric_sail_switches_where_the_primer_leaves_its_reach():
    """Off beyond 109.4712 deg from the Sun line, on within; the switch times are where the primer stands there."""
    found = solved(AU, VENUS * AU, "electric-sail", 2e-3)
    path = found.trajectory(5001)
    r_hat = path.position / np.linalg.norm(path.position, axis=1)[:, None]
    cosine = np.sum(r_hat * path.primer, axis=1)
    assert np.array_equal(path.on, cosine > -1 / 3)
    changes = np.flatnonzero(np.diff(path.on))
    assert len(changes) == len(found.switches) >= 1
    assert np.interp(found.switches, path.time, cosine) == pytest.approx(-1 / 3, abs=1e-6)


def test_the_same_question_has_the_same_answer_to_the_last_bit():
    first, second = solved(AU, MARS * AU, "ideal", 1e-3), circle_to_circle(AU, MARS * AU, "ideal", 1e-3)
    assert np.array_equal(first.start, second.start)
    assert first.time == second.time


def test_continuation_follows_an_electric_sail_to_half_its_strength():
    """From 2 to 1 mm/s2, over the birth of coasting arcs: 287.60674755 d."""
    strong = solved(AU, VENUS * AU, "electric-sail", 2e-3)
    guess = np.append(strong.costates / np.linalg.norm(strong.costates), strong.time / YEAR_UNIT)
    flight = ToCircle(sail_from("electric-sail", 1e-3, AU), (1.0, 0.0, 1.0), VENUS)
    path = follow(lambda s: replace(flight, sail=sail_from("electric-sail", 2e-3 * 0.5**s, AU)), guess)
    assert path.complete
    assert path.unknowns[3] * YEAR_UNIT / DAY == pytest.approx(287.60674755636535, rel=1e-8)


def test_continuation_in_the_target_radius_reaches_mercury_from_venus():
    """From one circle to another through changing numbers of revolutions: 498.08425696 d."""
    sail = sail_from("ideal", 0.5e-3, AU)
    venus = circle_to_circle(AU, VENUS * AU, "ideal", 0.5e-3)
    guess = np.append(venus.costates / np.linalg.norm(venus.costates), venus.time / YEAR_UNIT)
    path = follow(lambda s: ToCircle(sail, (1.0, 0.0, 1.0), VENUS * (MERCURY / VENUS) ** s), guess)
    assert path.complete
    assert path.unknowns[3] * YEAR_UNIT / DAY == pytest.approx(498.08425695664204, rel=1e-8)


def test_eccentric_orbits_offer_faster_transfers_whatever_their_orientation():
    """Free anomalies can only gain from apsides; turning both orbits changes nothing; small eccentricities, little."""
    r = np.radians
    circles = solved(AU, MARS * AU, "ideal", 2e-3).time
    one, other = (
        planar_orbit_to_orbit((AU, 0.0167, turn), (MARS * AU, 0.0934, turn + r(233.0)), "ideal", 2e-3, directions=512)
        for turn in (0.0, 1.0)
    )
    assert one.time < circles
    assert other.time == pytest.approx(one.time, rel=1e-10)
    assert other.departure_anomaly == pytest.approx(one.departure_anomaly, abs=1e-6)
    assert one.residual < 1e-9
    nearly = planar_orbit_to_orbit((AU, 1e-4, 0.0), (MARS * AU, 1e-4, 2.0), "ideal", 2e-3, directions=512)
    assert nearly.time == pytest.approx(circles, rel=3e-4)


def test_transfer_between_ellipses_ends_on_the_target_ellipse():
    from sailviz.elements import elements

    found = planar_orbit_to_orbit((AU, 0.0167, 1.8), (VENUS * AU, 0.0068, 2.3), "ideal", 1e-3, directions=512)
    path = found.trajectory(11)
    for row, (a, e, argument), nu in (
        (0, (1.0, 0.0167, 1.8), found.departure_anomaly),
        (-1, (VENUS, 0.0068, 2.3), found.arrival_anomaly),
    ):
        orbit = elements(path.position[row], path.velocity[row], MU_SUN)
        assert orbit.semi_major_axis / AU == pytest.approx(a, rel=1e-9)
        assert orbit.eccentricity == pytest.approx(e, abs=1e-9)
        assert orbit.argument == pytest.approx(argument, abs=1e-6)
        assert np.cos(orbit.true_anomaly - nu) == pytest.approx(1, abs=1e-12)


def test_targets_out_of_reach_are_named_with_the_nearest_circle_reached(monkeypatch):
    """A search that is blind for Mars, and a continuation stopped on its way, still say how far they came."""
    found = _blindly(monkeypatch, "ideal", 2e-3, MARS, 3)
    assert (found.feasible, found.solutions, found.ending.outcome) == (False, 0, NOT_FOUND)
    assert np.isnan(found.time)
    assert np.isnan(found.costates).all()
    said = re.search(r"the nearest circle reached has (.*) au, after (.*) d; (.*) mm/s² reach", found.reason)
    radius, days = float(said[1]), float(said[2])
    assert MARS**0.5 < radius < MARS
    assert circle_to_circle(AU, radius * AU, "ideal", 2e-3).time / DAY == pytest.approx(days, rel=1e-5)
    assert 2 < float(said[3]) < 4
    assert f"aim no farther than {radius:.6g} au" in found.ending.advice
    with pytest.raises(ValueError, match="no flight to show"):
        found.trajectory()


def test_what_an_electric_sail_reached_is_told_of_the_true_sail_not_of_the_rounded_one(monkeypatch):
    """With its switching rounded off by 0.03, as it is on the way, the same circle is reached 2 % sooner."""
    monkeypatch.setattr(circles, "_by_arcs", lambda *_: None)
    found = _blindly(monkeypatch, "electric-sail", 2e-3, VENUS, 6)
    said = re.search(r"the nearest circle reached has ([\d.]+) au, after ([\d.]+) d", found.reason)
    true = circle_to_circle(AU, float(said[1]) * AU, "electric-sail", 2e-3)
    assert float(said[2]) == pytest.approx(true.time / DAY, rel=1e-5)


def _blindly(monkeypatch, device, ac, target, steps):
    """The search for a circle that is blind for just this circle and this sail, its continuations of a few steps."""
    sail = sail_from(device, ac, AU)

    def blind(flight, *rest, **more):
        found = search(flight, *rest, **more)
        there = flight.radius == target and np.array_equal(flight.sail.parameters, sail.parameters)
        return replace(found, extremals=()) if there else found

    detours = circles._detours
    monkeypatch.setattr(
        circles, "_detours", lambda *rest: [d for d in detours(*rest) if d.radius_at or d.strength_at][::3]
    )
    for tier in ("SECOND", "LAST"):
        monkeypatch.setattr(circles, tier, circles.FIRST)
    monkeypatch.setattr(circles, "search", blind)
    monkeypatch.setattr(circles, "follow", partial(follow, steps=steps))
    return circle_to_circle(AU, target * AU, device, ac)


def test_a_search_out_of_time_gives_the_best_it_has_with_a_mark(monkeypatch):
    """The time is over once the first four starts have been finished."""
    effort = Effort(time_limit=1e3)
    monkeypatch.setattr(effort, "count", lambda what, n=1: effort.end(TIME_LIMIT) if "finished" in what else None)
    monkeypatch.setattr("sailviz.design.minimum_time.search.AGREE", 5)
    found = circle_to_circle(AU, MARS * AU, "ideal", 1e-3, effort=effort)
    assert (found.ending.outcome, found.ending.stopped) == (FOUND, TIME_LIMIT)
    assert found.time / DAY == pytest.approx(407.698642981187, rel=1e-9)
    assert "stopped by its time limit" in found.claim


def test_a_search_without_time_says_that_it_had_none():
    found = circle_to_circle(AU, MARS * AU, "ideal", 1e-3, time_limit=1e-6)
    assert (found.feasible, found.ending.outcome, found.ending.stopped) == (False, NOT_FOUND, TIME_LIMIT)
    assert "give the search more time" in found.ending.advice[-1]


@pytest.mark.parametrize(
    ("radii", "device", "why"),
    [
        ((AU, 1e-3 * AU), "ideal", "the target lies inside the Sun"),
        ((1e-3 * AU, AU), "ideal", "the departure lies inside the Sun"),
        ((AU, AU), "ideal", "the same"),
        ((AU, 2 * AU), Film(0.5, 0.0, 0.0), "along the Sun line only"),
    ],
)
def test_only_what_is_proven_is_called_impossible(radii, device, why):
    found = circle_to_circle(*radii, device, 1e-3)
    assert (found.feasible, found.ending.outcome) == (False, IMPOSSIBLE)
    assert why in found.reason


def test_questions_that_make_no_sense_are_refused():
    with pytest.raises(ValueError, match="characteristic_acceleration must be a positive number"):
        circle_to_circle(AU, 2 * AU, "ideal", 0.0)
    with pytest.raises(ValueError, match="jpl-2015"):
        circle_to_circle(AU, 2 * AU, "kite", 1e-3)
    with pytest.raises(ValueError, match="eccentricities"):
        planar_orbit_to_orbit((AU, 1.2, 0), (2 * AU, 0, 0), "ideal", 1e-3)


def test_repeated_extremals_count_once():
    found = solved(AU, MARS * AU, "ideal", 1e-3)
    sail = sail_from("ideal", 1e-3, AU)
    guess = np.append(found.costates / np.linalg.norm(found.costates), found.time / YEAR_UNIT)
    extremal = finish(ToCircle(sail, (1.0, 0.0, 1.0), MARS), guess)
    assert len(distinct([extremal, extremal])) == 1
