"""Means, drifts and closed forms that a scene may expect of its run, and the table that tells what came of them."""

from dataclasses import replace

import numpy as np
import pytest

import sailviz
from sailviz.checks.closed_forms import FORMS, error
from sailviz.checks.expectations import Judge, Verdict, check, table
from sailviz.constants import AU, MU_SUN
from sailviz.elements import state
from sailviz.errors import SceneError
from sailviz.recording.timelines import take
from sailviz.run.from_arrays import trajectory
from sailviz.scene.loading import Expectation


def scene(**changes):
    values = {
        "title": "For the tests",
        "start": {"kind": "elements", "semi_major_axis_au": 1.0, "eccentricity": 0.4, "inclination_deg": 20.0},
        "device": {"kind": "none"},
        "propagation": {"duration_yr": 2.0, "outputs": 400, "tolerance": 1e-13},
    }
    return sailviz.load_scene({**values, **changes})


def expecting(*blocks):
    return scene(expect=list(blocks), event=[{"kind": "apoapsis", "name": "far"}])


def flight(rows=301, e=0.4, a=AU, anomaly=(-2.0, 2.0)):
    """A Kepler orbit by its true anomaly, from its elements."""
    nu = np.linspace(*anomaly, rows)
    if e < 1:
        half = np.arctan2(np.sqrt(1 - e) * np.sin(nu / 2), np.sqrt(1 + e) * np.cos(nu / 2))
        time = (2 * half - e * np.sin(2 * half)) * np.sqrt(a**3 / MU_SUN)
    else:
        F = 2 * np.arctanh(np.sqrt((e - 1) / (e + 1)) * np.tan(nu / 2))
        time = (e * np.sinh(F) - F) * np.sqrt(-(a**3) / MU_SUN)
    return trajectory(time - time[0], *state(a, e, 0.3, 0.4, 0.5, nu, MU_SUN), planets=False)


def verdicts_of(blocks, pieces):
    judge = Judge(expecting(*blocks))
    for piece in pieces:
        judge.add(piece)
    return judge.verdicts()


def in_blocks(run, size):
    return [replace(take(run, slice(i, i + size)), first=i) for i in range(0, len(run), size)]


# ---------------------------------------------------------------- moments of a run
@pytest.mark.parametrize("size", [7, 100, 301])
def test_mean_and_drift_do_not_depend_on_the_blocks(size):
    run = flight()
    wanted = [
        {"quantity": "radius_au", "at": "mean", "value": 1.0, "within": 1.0},
        {"quantity": "speed_km_s", "at": "drift", "value": 0.0, "within": 1.0},
        {"quantity": "angular_momentum_km2_s", "at": "drift", "value": 0.0, "within": 1e-12},
        {"quantity": "time_d", "at": "mean", "value": 1.0, "within": 1.0},
    ]
    mean, drift, conserved, half = verdicts_of(wanted, in_blocks(run, size))
    r, v = np.linalg.norm(run.position, axis=1), np.linalg.norm(run.velocity, axis=1)
    assert mean.measured == pytest.approx(np.trapezoid(r, run.time) / run.time[-1] / AU, rel=1e-12)
    assert drift.measured == pytest.approx(np.abs(v / v[0] - 1).max(), rel=1e-12)
    assert conserved.passed
    assert half.measured == pytest.approx(run.time[-1] / 2 / 86400, rel=1e-12)


def test_the_mean_distance_of_a_whole_ellipse_is_that_of_theory():
    run = sailviz.simulate(expecting({"quantity": "radius_au", "at": "mean", "value": 1.08, "within": 1e-4}))
    period = 2 * np.pi * np.sqrt(AU**3 / MU_SUN)
    whole = scene(
        expect=[{"quantity": "radius_au", "at": "mean", "value": 1 + 0.4**2 / 2, "within": 1e-9}],
        propagation={"duration_s": float(period), "outputs": 4001, "tolerance": 1e-13},
    )
    assert check(whole, sailviz.simulate(whole))[0].passed  # over time: a (1 + e^2 / 2)
    assert len(run) == 400


def test_a_quantity_that_starts_at_zero_has_no_relative_drift():
    (verdict,) = verdicts_of([{"quantity": "time_d", "at": "drift", "value": 0.0, "within": 1.0}], [flight()])
    assert not verdict.passed
    assert "no relative drift" in str(verdict)


def test_a_moment_that_never_comes_fails_and_says_so():
    wanted = [{"quantity": "radius_au", "at": "far", "value": 1.4, "within": 0.1}]
    (verdict,) = verdicts_of(wanted, [flight()])
    assert not verdict.passed
    assert "this moment never came" in str(verdict)


# ---------------------------------------------------------------- closed forms
def test_every_name_a_scene_may_write_has_its_closed_form():
    allowed = Expectation.model_json_schema()["properties"]["closed_form"]["anyOf"][0]["enum"]
    assert set(allowed) == set(FORMS)


@pytest.mark.parametrize(
    ("e", "a", "anomaly"), [(0.0, AU, (0, 6)), (0.4, AU, (-2, 2)), (0.93, AU, (-3, 3)), (1.7, -AU, (-1.9, 2))]
)
def test_flight_without_thrust_is_a_conic(e, a, anomaly):
    run = flight(e=e, a=a, anomaly=anomaly)
    assert error(FORMS["kepler"](run), 0.0, run).max() < 1e-12
    late = take(run, slice(100, None))
    assert error(FORMS["kepler"](late), late.time[0], late).max() < 1e-12


def test_a_flight_of_many_revolutions_stays_on_its_conic():
    s = scene(propagation={"duration_yr": 50.0, "outputs": 500, "tolerance": 1e-14})
    run = sailviz.simulate(s)
    assert error(FORMS["kepler"](run), 0.0, run).max() < 1e-9  # rounding, which grows as the square of the turns


def test_a_parabola_and_what_is_close_to_it_are_conics():
    for e in (0.97, 0.9999, 0.999999999, 1.0, 1.000000001, 1.01):  # q = 1 au
        speed = np.sqrt(MU_SUN * (1 + e) / AU)
        s = scene(
            start={"kind": "cartesian", "position_au": [1.0, 0.0, 0.0], "velocity_m_s": [0.0, float(speed), 0.0]},
            propagation={"duration_yr": 3.0, "outputs": 100, "tolerance": 1e-13},
        )
        run = sailviz.simulate(s)
        assert error(FORMS["kepler"](run), 0.0, run).max() < 1e-11, e


def test_a_sail_that_faces_the_sun_moves_as_under_reduced_gravity():
    s = scene(
        device={"kind": "solar-sail", "lightness_number": 0.1},
        steering={"kind": "sun-facing"},
        expect=[
            {
                "quantity": "closed_form_error",
                "closed_form": "reduced-kepler",
                "at": "max",
                "value": 0.0,
                "within": 1e-11,
            },
            {"quantity": "closed_form_error", "closed_form": "kepler", "at": "max", "value": 0.0, "within": 1e-3},
        ],
    )
    reduced, full = check(s, sailviz.simulate(s))
    assert reduced.passed
    assert not full.passed
    assert reduced.quantity == "error against reduced-kepler"


@pytest.mark.parametrize(
    ("name", "form", "within"),
    [("displaced/circular", "displaced-orbit", 1e-8), ("spirals/logarithmic", "logarithmic-spiral", 1e-9)],
)
def test_designed_orbits_follow_their_closed_forms(name, form, within, shipped_run):
    _, run = shipped_run(name)
    assert error(FORMS[form](run), 0.0, run).max() < within
    wrong = "logarithmic-spiral" if form == "displaced-orbit" else "displaced-orbit"
    assert error(FORMS[wrong](run), 0.0, run).max() > 1e-2


def test_a_closed_form_is_judged_at_an_event_as_well():
    s = scene(
        event=[{"kind": "apoapsis", "name": "far"}],
        expect=[{"quantity": "closed_form_error", "closed_form": "kepler", "at": "far", "value": 0.0, "within": 1e-10}],
    )
    (verdict,) = check(s, sailviz.simulate(s))
    assert verdict.passed, str(verdict)


# ---------------------------------------------------------------- words
@pytest.mark.parametrize(
    ("block", "word"),
    [
        ({"quantity": "closed_form_error", "at": "max", "value": 0.0, "within": 1.0}, "closed_form belongs to"),
        (
            {"quantity": "radius_au", "closed_form": "kepler", "at": "max", "value": 0.0, "within": 1.0},
            "closed_form belongs to",
        ),
        (
            {"quantity": "closed_form_error", "closed_form": "keppler", "at": "max", "value": 0.0, "within": 1.0},
            "kepler",
        ),
        ({"quantity": "energy_MJ_kg", "at": "drift", "value": 0.0, "within_percent": 1.0}, "give within"),
        ({"quantity": "radius_au", "at": "meen", "value": 0.0, "within": 1.0}, 'Did you mean "mean"'),
    ],
)
def test_an_expectation_that_means_nothing_is_refused(block, word):
    with pytest.raises(SceneError, match=word):
        expecting(block)


def test_the_table_is_aligned_and_names_what_failed():
    lines = table(
        [
            Verdict("radius_au", "max", 0.95, 1e-8, 0.9500000001),
            Verdict("error against kepler", "far", 0.0, 1e-9, 2e-3),
            Verdict("time_d", "orbit of Mars", 430.471401, 1e-5, np.nan),
        ]
    ).splitlines()
    assert [line[:4].strip() for line in lines] == ["", "ok", "FAIL", "FAIL"]
    column = lines[0].index("expected") + len("expected")
    assert all(line[column - 1] != " " and line[column : column + 2] == "  " for line in lines[1:])
    assert lines[3].endswith("this moment never came")
