"""Optimal pitch: closed forms, the errors of the analytic law, and brute force over the force models themselves."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from sailviz.constants import AU
from sailviz.propulsion import electric_sail
from sailviz.propulsion.solar_sail import FILMS, Film
from sailviz.steering.attitude import analytic_pitch, optimal_pitch

ELECTRIC = {
    "electric-sail": "final",
    "electric-sail-original": "original",
    "electric-sail-updated": "updated",
    "electric-sail-polynomial": "polynomial",
}
PRIMERS = np.radians(np.arange(0, 180.5, 7.5))


def switch(device):
    """Primer angle, deg, where the thrust goes off, and the pitch just before."""
    angle = brentq(lambda x: optimal_pitch(x, device).on - 0.5, 1.0, 3.1, xtol=1e-14)
    return np.degrees(angle), np.degrees(optimal_pitch(angle - 1e-9, device).pitch)


def thrusts(device, pitch):
    """(along r_hat, along t_hat) for a_c = 1 at 1 au, from the force models."""
    if device in FILMS:
        return FILMS[device].components(pitch)
    normal = np.stack([np.cos(pitch), np.sin(pitch), np.zeros_like(pitch)], axis=-1)
    force = electric_sail.acceleration(np.array([AU, 0, 0]), normal, 1.0, ELECTRIC[device])
    return force[:, 0], force[:, 1]


@pytest.mark.parametrize("device", ["ideal", "jpl-1978", "jpl-2015", *ELECTRIC])
def test_no_pitch_gives_more_thrust_along_the_primer(device):
    """Brute force over 20,001 pitches: nothing beats the law, and it is reached to the square of the spacing."""
    most = {"electric-sail-original": 60, "electric-sail-updated": 60, "electric-sail-polynomial": 70}.get(device, 90)
    along, across = thrusts(device, np.radians(np.linspace(0, most, 20001)))
    found = optimal_pitch(PRIMERS, device)
    best = np.array([max((np.cos(x) * along + np.sin(x) * across).max(), 0.0) for x in PRIMERS])
    assert np.all(found.support >= best - 1e-14)
    assert found.support == pytest.approx(best, abs=1e-7)
    f_r, f_t = thrusts(device, found.pitch)
    gain = np.cos(PRIMERS) * f_r + np.sin(PRIMERS) * f_t
    assert gain[found.on] == pytest.approx(found.support[found.on], abs=1e-12)


@pytest.mark.parametrize("device", ["ideal", "eta-perfect"])
def test_ideal_sail_follows_the_closed_form(device):
    c, s = np.cos(PRIMERS[1:]), np.sin(PRIMERS[1:])
    expected = np.arctan2(-3 * c + np.sqrt(8 + c * c), 4 * s)
    found = optimal_pitch(PRIMERS[1:], device)
    assert found.pitch == pytest.approx(expected, abs=1e-15)
    assert found.on[:-1].all()


@pytest.mark.parametrize(
    ("film", "off", "pitch", "without_b3"),
    [("jpl-1978", 145.4825, 72.5592, 145.8122), ("jpl-2015", 148.6255, 74.2160, 148.8040)],
)
def test_optical_sail_jumps_edge_on_at_its_switch(film, off, pitch, without_b3):
    angle, before = switch(film)
    assert angle == pytest.approx(off, abs=0.51e-4)
    assert before == pytest.approx(pitch, abs=1e-4)
    beyond = optimal_pitch(np.radians(angle + 1e-6), film)
    assert (beyond.pitch, beyond.on, beyond.support) == (np.pi / 2, False, 0)
    analytic = brentq(lambda x: analytic_pitch(x, film).on - 0.5, 2.0, 3.0, xtol=1e-14)
    assert np.degrees(analytic) == pytest.approx(without_b3, abs=0.51e-4)


# film, largest and rms error deg of the law, deg; largest loss of gain up to 1.5 deg from the jump
ERRORS = [("jpl-1978", 0.0575, 0.0425, 1.4e-5), ("jpl-2015", 0.0305, 0.0226, 4.45e-6)]


@pytest.mark.parametrize(("film", "largest", "rms", "loss"), ERRORS)
def test_analytic_law_misses_the_optimum_by_as_little_as_tabled(film, largest, rms, loss):
    end = np.radians(switch(film)[0])
    primer = np.linspace(0, end, 20001)[:-1]
    exact, analytic = optimal_pitch(primer, film), analytic_pitch(primer, film)
    error = np.degrees(analytic.pitch - exact.pitch)
    assert np.abs(error).max() == pytest.approx(largest, abs=0.51e-4)
    assert np.sqrt(np.mean(error**2)) == pytest.approx(rms, abs=0.51e-4)
    early = primer < end - np.radians(1.5)
    assert np.max(1 - analytic.support / exact.support, where=early, initial=0) == pytest.approx(loss, rel=0.05)


@pytest.mark.parametrize(("film", "largest", "rms"), [("jpl-1978", 5.26, 1.30), ("jpl-2015", 4.90, 1.19)])
def test_ideal_law_flown_by_an_optical_film_misses_by_degrees(film, largest, rms):
    primer = np.linspace(0, np.radians(switch(film)[0]), 20001)[:-1]
    error = np.degrees(optimal_pitch(primer, "ideal").pitch - optimal_pitch(primer, film).pitch)
    assert np.abs(error).max() == pytest.approx(largest, abs=0.006)
    assert np.sqrt(np.mean(error**2)) == pytest.approx(rms, abs=0.006)


def test_optical_law_tends_to_the_ideal_law():
    """Linearly in what the film lacks: the difference divided by it stays the same."""
    primer = np.radians([10.0, 60.0, 110.0])
    ideal = optimal_pitch(primer, "ideal").pitch
    change = [
        (optimal_pitch(primer, Film(0.5 * q, 1 - q, 0.1 * q)).pitch - ideal) / q for q in (1e-4, 1e-5)
    ]  # 2 b1 + b2 = 1
    assert change[0] == pytest.approx(change[1], rel=1e-3)


def test_electric_sail_halves_the_angle_and_switches_off_at_its_largest_cone():
    found = optimal_pitch(PRIMERS, "electric-sail")
    assert found.pitch == pytest.approx(PRIMERS / 2, abs=1e-15)
    assert np.array_equal(found.on, np.cos(PRIMERS) > -1 / 3)
    angle, pitch = switch("electric-sail")
    assert angle == pytest.approx(109.4712, abs=0.51e-4)
    assert angle - 90 == pytest.approx(np.degrees(electric_sail.CONE_MAX), abs=1e-6)
    assert pitch == pytest.approx(np.degrees(electric_sail.PITCH_AT_CONE_MAX), abs=1e-6)


@pytest.mark.parametrize("device", ["electric-sail-original", "electric-sail-updated"])
def test_older_electric_sails_point_the_thrust_at_the_primer_within_their_cone(device):
    found = optimal_pitch(PRIMERS, device)
    cone = np.minimum(PRIMERS, np.radians(30))
    assert found.pitch == pytest.approx(2 * cone, abs=1e-14)
    assert switch(device)[0] == pytest.approx(120, abs=1e-9)
    assert found.support == pytest.approx(np.maximum(np.cos(PRIMERS - cone), 0), abs=1e-15)


def test_polynomial_sail_switches_off_a_little_later():
    angle, pitch = switch("electric-sail-polynomial")
    assert angle == pytest.approx(109.759, abs=0.51e-3)
    assert pitch == pytest.approx(54.84, abs=0.51e-2)


def test_a_primer_on_the_other_side_gives_the_mirrored_pitch():
    for device in ("ideal", "jpl-2015", "electric-sail"):
        assert optimal_pitch(-0.7, device).pitch == -optimal_pitch(0.7, device).pitch


@pytest.mark.parametrize("film", [Film(0.5, 0.0, 0.0), Film(0.4, 0.0, 0.3), Film(0.3, 0.4, -0.1), Film(0.0, 0.5, 0.3)])
def test_unusual_films_are_steered_as_brute_force_would(film):
    """An absorber, a film that scatters only, one that radiates forwards, one without tangential force."""
    pitch = np.radians(np.linspace(0, 90, 90001))
    along, across = film.components(pitch)
    for primer in np.radians(np.arange(0, 180, 4.0)):
        best = max((np.cos(primer) * along + np.sin(primer) * across).max(), 0.0)
        assert optimal_pitch(primer, film).support == pytest.approx(best, abs=1e-8)


def test_unknown_sails_are_named_in_the_refusal():
    with pytest.raises(ValueError, match="electric-sail-polynomial"):
        optimal_pitch(0.3, "kite")
