"""Displaced orbits against the closed forms, and flown. Angles of the tables in degrees, accelerations in mm/s2."""

from __future__ import annotations

import numpy as np
import pytest

import sailviz
from sailviz.constants import AU, GRAVITY_AT_1_AU, MU_SUN
from sailviz.design import displaced
from sailviz.propulsion import electric_sail, solar_sail

DEG = np.pi / 180


def rate(radius):
    """Omega_K, rad/s, at a distance from the Sun in m."""
    return np.sqrt(MU_SUN / radius**3)


# Re-derived from (4.2)-(4.5) with an independent program, ten digits; elevation deg, rate ratio, distance au,
# then cone, pitch, characteristic acceleration.
ELECTRIC = [
    (10, 0.5, 1, 3.230124182, 6.481046307, 4.521066800),
    (30, 0.3, 1, 2.393118947, 4.794646521, 5.549187324),
    (75, 1, 1, 15.0, 32.968664449, 6.494451228),
    (72, 1, 0.5, 18.0, 42.989843166, 13.976856013),
    (72, 1, 1, 18.0, 42.989843166, 6.988428006),
    (72, 1, 2, 18.0, 42.989843166, 3.494214003),
    (80, 1, 1, 10.0, 20.697815126, 6.134423401),
    (80, 1, 0.5, 10.0, 20.697815126, 12.268846802),
]


@pytest.mark.parametrize(("elevation", "ratio", "radius", "cone", "pitch", "acceleration"), ELECTRIC)
def test_electric_sail_holds_a_displaced_orbit(elevation, ratio, radius, cone, pitch, acceleration):
    found = displaced.circular(radius * AU, elevation * DEG, ratio)
    assert found.feasible
    assert (found.cone / DEG, found.pitch / DEG) == pytest.approx((cone, pitch), abs=2e-9)
    assert found.characteristic_acceleration * 1e3 == pytest.approx(acceleration, abs=1e-9)


# elevation, rate ratio, film, pitch deg (None: not tabulated), lightness number
SAILS = [
    (10, 0.5, "ideal", 3.230124182, 0.7611604811),
    (10, 0.5, "jpl-1978", 3.570251490, 0.7616931493),
    (10, 0.5, "jpl-2015", 3.504471930, 0.7615853895),
    (30, 0.3, "ideal", 2.393118947, 0.9349440959),
    (30, 0.3, "jpl-1978", 2.644948020, 0.9353027416),
    (30, 0.3, "jpl-2015", 2.596252355, 0.9352302107),
    (75, 1, "ideal", 15.0, 1.0352761804),
    (75, 1, "jpl-1978", 16.628006992, 1.0519291645),
    (75, 1, "jpl-2015", 16.310861030, 1.0485063834),
    (10, 0.9, "ideal", 32.862, 0.3618047358),
    (10, 0.9, "jpl-1978", 36.964226734, 0.3994389000),
    (10, 0.9, "jpl-2015", 36.131994269, 0.3910010268),
]


@pytest.mark.parametrize(("elevation", "ratio", "film", "pitch", "lightness"), SAILS)
def test_solar_sail_holds_a_displaced_orbit(elevation, ratio, film, pitch, lightness):
    found = displaced.circular(AU, elevation * DEG, ratio, film)
    assert found.pitch / DEG == pytest.approx(pitch, abs=2e-9 if pitch != 32.862 else 5e-4)
    assert found.characteristic_acceleration / GRAVITY_AT_1_AU == pytest.approx(lightness, abs=2e-10)


@pytest.mark.parametrize(("elevation", "ratio"), [(10, 0.5), (40, 0.7), (75, 1.2), (-20, 0.3)])
def test_ideal_sail_needs_mcinnes_lightness_number(elevation, ratio):
    """beta = sqrt(1 + k^2) (k^2 + (1 - w)^2)^(3/2) / (k^2 + 1 - w)^2 with k = z / rho, w = (Omega / Omega_K)^2."""
    k, w = np.tan(elevation * DEG), ratio**2
    beta = np.sqrt(1 + k * k) * (k * k + (1 - w) ** 2) ** 1.5 / (k * k + 1 - w) ** 2
    found = displaced.circular(0.8 * AU, elevation * DEG, ratio, "ideal")
    assert found.characteristic_acceleration / GRAVITY_AT_1_AU == pytest.approx(beta, rel=1e-13)


@pytest.mark.parametrize("device", ["electric-sail", "ideal", "jpl-1978", "jpl-2015", "eta-perfect"])
@pytest.mark.parametrize(("elevation", "ratio"), [(10, 0.7), (-10, 0.7), (30, 0.3), (80, 1.0), (0, 0.5)])
def test_designed_thrust_makes_up_for_gravity_and_circling(device, elevation, ratio):
    """Force balance in the meridian plane, with the force law of the device itself."""
    psi, r = elevation * DEG, 0.9 * AU
    found = displaced.circular(r, psi, ratio, device)
    position, velocity = displaced.state(r, psi, ratio, 0.3)
    pole, r_hat = np.array([0, 0, 1.0]), position / r
    north = pole - r_hat[2] * r_hat
    # the clock angle counts from the orbit's normal, which leans from the Sun line as much as north does
    side = north / np.linalg.norm(north) * np.cos(found.clock)
    normal = np.cos(found.pitch) * r_hat + np.sin(found.pitch) * side
    if device == "electric-sail":
        thrust = electric_sail.acceleration(position, normal, found.characteristic_acceleration)
    else:
        thrust = solar_sail.acceleration(position, normal, found.characteristic_acceleration, device)
    needed = MU_SUN * position / r**3 - (ratio * rate(r)) ** 2 * position * [1, 1, 0]
    assert np.linalg.norm(thrust - needed) < 1e-12 * GRAVITY_AT_1_AU
    assert np.linalg.norm(position) == pytest.approx(r, rel=1e-15)
    assert np.cross(position, velocity) @ pole == pytest.approx(ratio * rate(r) * (r * np.cos(psi)) ** 2, rel=1e-14)


# w <= T / (s c + T c^2), T = tan(asin(1/3)) = 1 / (2 sqrt 2); the smallest is 1 / sqrt 2, at asin(1 / sqrt 3)
@pytest.mark.parametrize(
    ("elevation", "largest"),
    [
        (1, 0.976341500),
        (5, 0.898759049),
        (10, 0.829444112),
        (20, 0.747005130),
        (30, 0.711614031),
        (np.degrees(np.arcsin(3**-0.5)), 2**-0.5),
        (45, 0.722777801),
        (60, 0.823458189),
        (90 - np.degrees(np.arcsin(1 / 3)), 1.0),
        (75, 1.136588159),
        (80, 1.395033661),
    ],
)
def test_cone_angle_limits_the_rate(elevation, largest):
    assert displaced.largest_rate_ratio(elevation * DEG) == pytest.approx(largest, abs=1e-9)
    assert displaced.circular(AU, elevation * DEG, largest * (1 - 1e-8)).feasible
    assert not displaced.circular(AU, elevation * DEG, largest * (1 + 1e-8)).feasible


def test_infeasible_orbits_say_why():
    sideways = displaced.circular(AU, 10 * DEG, 0.9)
    assert np.isnan(sideways.characteristic_acceleration)
    assert np.isnan(sideways.pitch)
    assert "32.86 deg" in sideways.reason
    assert "19.47 deg" in sideways.reason
    assert "0.8294" in sideways.reason
    assert "towards the Sun" in displaced.circular(AU, 10 * DEG, 1.1).reason
    assert "positive" in displaced.circular(-AU, 10 * DEG, 0.5).reason
    assert displaced.circular(AU, 10 * DEG, 0.5).reason == ""


def test_a_craft_at_rest_needs_the_pull_of_the_sun_wherever_it_is():
    """Heliostationary: a_c = mu / (r r_E) for the E-sail, lightness number 1 for any sail, at any elevation."""
    radius = np.array([0.25, 0.5, 1.0, 1.523679])
    for elevation in (0, 30, 85):
        found = displaced.circular(radius * AU, elevation * DEG, 0.0)
        assert found.characteristic_acceleration == pytest.approx(MU_SUN / (radius * AU) / AU, rel=1e-14)
        assert displaced.circular(AU, elevation * DEG, 0.0, "jpl-2015").characteristic_acceleration == pytest.approx(
            GRAVITY_AT_1_AU, rel=1e-14
        )
    assert found.cone == pytest.approx(np.zeros(4))


def test_type_ii_cone_angle_is_the_colatitude():
    """At the Keplerian rate tan(phi) = cot(psi)."""
    elevation = np.radians([72, 75, 80, 89])
    assert displaced.circular(AU, elevation, 1.0).cone == pytest.approx(np.pi / 2 - elevation, abs=1e-14)


def test_arrays_give_nan_where_infeasible_and_numbers_elsewhere():
    found = displaced.circular(AU, 10 * DEG, np.array([[0.5], [0.9]]))
    assert found.feasible.shape == found.pitch.shape == (2, 1)
    assert list(found.feasible[:, 0]) == [True, False]
    assert list(np.isnan(found.characteristic_acceleration[:, 0])) == [False, True]


def test_below_the_ecliptic_is_the_mirror_image_of_above():
    above, below = (displaced.circular(AU, s * 20 * DEG, 0.5) for s in (1, -1))
    assert (below.pitch, below.cone) == (above.pitch, above.cone)
    assert (above.clock, below.clock) == (0, np.pi)


# ---------------------------------------------------------------- flown
def orbit(elevation, ratio, periods, device="electric-sail", offset=0.0):
    """Scene of a displaced orbit at 1 au; offset displaces the start radially, m."""
    design = displaced.circular(AU, elevation * DEG, ratio, device)
    position, velocity = displaced.state(AU, elevation * DEG, ratio)
    period = 2 * np.pi / (ratio * rate(AU))
    kind = {"kind": "electric-sail"} if device == "electric-sail" else {"kind": "solar-sail", "film": device}
    return sailviz.load_scene(
        {
            "title": "displaced",
            "start": {
                "kind": "cartesian",
                "position_m": list(position * (1 + offset / AU)),
                "velocity_m_s": list(velocity / (1 + offset / AU)),  # the same angular momentum
            },
            "device": kind | {"characteristic_acceleration_m_s2": float(design.characteristic_acceleration)},
            "steering": {"kind": "orbital", "pitch_rad": float(design.pitch), "clock_rad": float(design.clock)},
            "propagation": {"duration_s": periods * period, "outputs": 361, "tolerance": 1e-13},
        }
    )


@pytest.mark.parametrize(
    ("elevation", "ratio", "device"),
    [
        (10, 0.8, "electric-sail"),
        (-10, 0.8, "electric-sail"),
        (15, 0.77, "electric-sail"),
        (30, 0.5, "jpl-2015"),
        (45, 0.6, "ideal"),
    ],
)
def test_displaced_orbit_closes_on_itself(elevation, ratio, device):
    """Within 1e-8 of its radius after a period, and on its ring all the way."""
    run = sailviz.simulate(orbit(elevation, ratio, 1, device=device))
    assert np.linalg.norm(run.position[-1] - run.position[0]) < 1e-8 * AU
    assert np.abs(run.position[:, 2] - AU * np.sin(elevation * DEG)).max() < 1e-8 * AU
    assert np.abs(np.linalg.norm(run.position, axis=1) - AU).max() < 1e-8 * AU


def growth_exponents(elevation, ratio, exponent=1):
    """lambda^2 in units of Omega_K^2 with pitch and clock fixed in the orbital frame: linearising r'' = h^2 / r^3 - ...
    with |h| conserved gives (2 - k) - (3 - k) w cos^2(psi), thrust ~ r^-k, and -w for the plane's nutation."""
    w = ratio**2
    return (2 - exponent) - (3 - exponent) * w * np.cos(elevation * DEG) ** 2, -w


def test_a_type_ii_orbit_is_left_440_fold_a_period():
    """lambda = 0.969 Omega: a radial displacement at equal angular momentum grows as cosh(lambda t)."""
    growth = np.sqrt(growth_exponents(80, 1.0)[0])
    assert np.exp(growth * 2 * np.pi) == pytest.approx(440, abs=5)
    start = 1e-7 * AU
    run = sailviz.simulate(orbit(80, 1.0, 1, offset=start))
    grown = np.linalg.norm(run.position, axis=1) - AU
    # second-order terms: the displacement reaches 2e-5 of the radius
    assert grown[-1] / start == pytest.approx(np.cosh(growth * 2 * np.pi), rel=1e-3)


def test_a_stable_displaced_orbit_swings_at_the_rate_of_the_closed_form():
    """10 deg above at 0.8 of the Keplerian rate: lambda^2 = 1 - 2 w cos^2(psi) < 0, a swing of r about 1 au."""
    square, _ = growth_exponents(10, 0.8)
    assert square == pytest.approx(-0.2414, abs=5e-5)
    start = 1e-6 * AU
    run = sailviz.simulate(orbit(10, 0.8, 3, offset=start))
    swing = np.cos(np.sqrt(-square) * rate(AU) * run.time)
    assert np.abs((np.linalg.norm(run.position, axis=1) - AU) / start - swing).max() < 1e-4
