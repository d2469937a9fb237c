"""Displaced orbits: the numbers of the derivation, its limits, and flights that hold what the design promises."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz.constants import AU, GRAVITY_AT_1_AU, MU_EARTH, MU_SUN
from sailviz.design import displaced
from sailviz.propagate import dynamics
from sailviz.propulsion import electric_sail
from sailviz.propulsion.solar_sail import FILMS, Film
from sailviz.steering import attitude

deg = np.radians
PHI_MAX = np.arcsin(1 / 3)
# printed digits, all: half a unit of the last one, and a little for the last bit of the conversion
SEVEN, NINE = 0.51e-6, 0.51e-8


def mm(found):
    return found.characteristic_acceleration * 1e3


# ---------------------------------------------------------------- circles
@pytest.mark.parametrize(
    ("psi", "wb", "cone", "pitch", "gamma", "ac"),
    [
        (10, 0.5, 3.230124182, 6.481046307, 0.9952107844, 4.521066800),
        (30, 0.3, 2.393118947, 4.794646521, 0.9973766561, 5.549187324),
        (75, 1, 15, 32.968664449, 0.8819868872, 6.494451228),
        (72, 1, 18, 42.989843166, 0.8070262107, 6.988428006),
        (80, 1, 10, 20.697815126, 0.9520034474, 6.134423401),
    ],
)
def test_electric_sail_circles_need_the_tabled_thrust(psi, wb, cone, pitch, gamma, ac):
    found = displaced.circular(AU, deg(psi), wb)
    assert np.degrees(found.cone) == pytest.approx(cone, abs=NINE)
    assert np.degrees(found.pitch) == pytest.approx(pitch, abs=NINE)
    assert electric_sail.dimensionless_acceleration(found.pitch) == pytest.approx(gamma, abs=1e-10)
    assert mm(found) == pytest.approx(ac, abs=NINE)
    assert (found.feasible, found.reason, found.clock) == (True, "", 0)


@pytest.mark.parametrize(
    ("psi", "wb", "film", "pitch", "lightness"),
    [
        (10, 0.5, "ideal", 3.230124182, 0.7611604811),
        (10, 0.5, "jpl-1978", 3.570251490, 0.7616931493),
        (10, 0.5, "jpl-2015", 3.504471930, 0.7615853895),
        (30, 0.3, "ideal", 2.393118947, 0.9349440959),
        (30, 0.3, "jpl-1978", 2.644948020, 0.9353027416),
        (30, 0.3, "jpl-2015", 2.596252355, 0.9352302107),
        (75, 1, "ideal", 15, 1.0352761804),
        (75, 1, "jpl-1978", 16.628006992, 1.0519291645),
        (75, 1, "jpl-2015", 16.310861030, 1.0485063834),
        (10, 0.9, "ideal", 32.8624, 0.3618047358),
        (10, 0.9, "jpl-1978", 36.964226734, 0.3994389000),
        (10, 0.9, "jpl-2015", 36.131994269, 0.3910010268),
    ],
)
def test_solar_sail_circles_need_the_tabled_lightness(psi, wb, film, pitch, lightness):
    found = displaced.circular(AU, deg(psi), wb, film)
    assert np.degrees(found.pitch) == pytest.approx(pitch, abs=NINE if pitch != 32.8624 else 1e-4)
    assert FILMS[film].lightness(found.characteristic_acceleration) == pytest.approx(lightness, abs=1e-10)


def test_ideal_sail_agrees_with_the_classical_formula():
    psi, wb = np.meshgrid(deg(np.linspace(1, 80, 9)), np.linspace(0.1, 0.95, 7))
    found = displaced.circular(AU, psi, wb, "ideal")
    q = np.tan(psi) ** 2
    classical = np.sqrt(1 + q) * (q + (1 - wb**2) ** 2) ** 1.5 / (q + 1 - wb**2) ** 2
    assert found.feasible.all()
    assert found.characteristic_acceleration / GRAVITY_AT_1_AU == pytest.approx(classical, rel=1e-11)


def test_an_imperfect_film_needs_more_area_at_the_same_attitude():
    ideal, eta = (displaced.circular(AU, deg(10), 0.5, film) for film in ("ideal", "eta-perfect"))
    assert eta.pitch == ideal.pitch
    ratio = FILMS["eta-perfect"].lightness(eta.characteristic_acceleration) / FILMS["ideal"].lightness(
        ideal.characteristic_acceleration
    )
    assert ratio == pytest.approx(1 / 0.85, rel=1e-14)


def test_own_film_is_a_device():
    same = Film(0.0864, 0.8272, -0.0055)
    assert displaced.circular(AU, 0.2, 0.5, same) == displaced.circular(AU, 0.2, 0.5, "jpl-1978")


@pytest.mark.parametrize(
    ("psi", "wb_max"),
    [
        (1, 0.976341500),
        (5, 0.898759049),
        (10, 0.829444112),
        (20, 0.747005130),
        (30, 0.711614031),
        (np.degrees(np.arctan(np.sqrt(0.5))), np.sqrt(0.5)),
        (45, 0.722777801),
        (60, 0.823458189),
        (75, 1.136588159),
        (80, 1.395033661),
    ],
)
def test_feasibility_ends_at_the_tabled_rate(psi, wb_max):
    largest = displaced.largest_rate_ratio(deg(psi))
    assert largest == pytest.approx(wb_max, abs=0.51e-9)
    at = displaced.circular(AU, deg(psi), largest)
    assert at.feasible
    assert at.cone == pytest.approx(PHI_MAX, abs=1e-12)
    assert at.pitch == pytest.approx(electric_sail.PITCH_AT_CONE_MAX, abs=1e-6)  # a square root ends here
    beyond = displaced.circular(AU, deg(psi), largest * (1 + 1e-9))
    assert not beyond.feasible
    assert np.isnan(beyond.pitch)
    assert "19.47 deg" in beyond.reason


def test_infeasible_entries_of_an_array_are_nan_and_the_others_stand():
    found = displaced.circular(AU, deg(10), np.array([0.5, 0.9, 0.8, 1.2]))
    assert found.feasible.tolist() == [True, False, True, False]
    for values in (found.cone, found.pitch, found.clock, found.characteristic_acceleration):
        assert (np.isnan(values) == ~found.feasible).all()
    assert found.characteristic_acceleration[0] == displaced.circular(AU, deg(10), 0.5).characteristic_acceleration
    assert found.reason == ""


def test_refusals_name_the_nearest_orbit():
    assert "0.8294" in displaced.circular(AU, deg(10), 0.9).reason
    sunward = displaced.circular(AU, deg(10), 1.2).reason
    assert "towards the Sun" in sunward
    assert "0.8294" in sunward
    assert "positive" in displaced.circular(-AU, deg(10), 0.5).reason
    assert "70.5288" in displaced.type_ii(AU, deg(60)).reason
    with pytest.raises(ValueError, match="jpl-2015"):
        displaced.circular(AU, 0.1, 0.5, "cardboard")


def test_orbits_below_the_ecliptic_mirror_those_above():
    above, below = displaced.circular(AU, deg(10), 0.5), displaced.circular(AU, deg(-10), 0.5)
    assert below.clock == np.pi
    assert below.pitch == above.pitch
    assert below.characteristic_acceleration == above.characteristic_acceleration


def test_no_displacement_and_the_keplerian_rate_need_no_sail():
    found = displaced.circular(AU, 0.0, 1.0)
    assert found.feasible
    assert found.characteristic_acceleration == 0
    psi = 1e-6  # near it, where the rate leaves room for the cone angle, the need vanishes with the displacement
    found = displaced.circular(AU, psi, displaced.largest_rate_ratio(psi) * (1 - 1e-10))
    assert mm(found) == pytest.approx(3 * np.sqrt(2) * psi * GRAVITY_AT_1_AU * 1e3, rel=1e-2)  # 3 psi g / gamma


def test_over_the_pole_any_rate_is_standing_still():
    for ratio in (0.1, 1.0, 3.0):
        found = displaced.circular(AU, np.pi / 2, ratio)
        assert found.cone == pytest.approx(0, abs=1e-14)
        assert mm(found) == pytest.approx(5.930083519, abs=NINE)


# ---------------------------------------------------------------- Type II, ecliptic, Lagrange, heliostationary
def test_type_ii_needs_the_tabled_thrust_at_every_distance():
    assert mm(displaced.type_ii(np.array([0.5, 1, 2]) * AU, deg(72))) == pytest.approx(
        [13.976856013, 6.988428006, 3.494214003], abs=NINE
    )
    assert mm(displaced.type_ii(0.5 * AU, deg(80))) == pytest.approx(12.268846802, abs=NINE)
    psi = np.pi / 2 - PHI_MAX
    assert mm(displaced.type_ii(AU, psi)) == pytest.approx(7.9068, abs=0.51e-4)
    assert not displaced.type_ii(AU, psi - 1e-9).feasible


def test_type_ii_cone_angle_is_what_the_elevation_leaves():
    psi = deg(np.linspace(71, 90, 20))
    found = displaced.type_ii(AU, psi)
    assert found.cone == pytest.approx(np.pi / 2 - psi, abs=1e-14)  # (4.7)
    assert (np.diff(found.characteristic_acceleration) < 0).all()


# The table takes 3.003480596e-6 for mu_E / mu, which is mu_E / (mu + mu_E); the digits are those of that number.
TABLED_MU = 3.003480596e-6 * MU_SUN


@pytest.mark.parametrize(
    ("planet_mu", "needs"),
    [
        (0.0, [0.533872581, 0.355853420, 0.266874077, 0.177908496]),
        (TABLED_MU, [0.514676399, 0.312216738, 0.188901955, 0.001580677]),
    ],
)
def test_artificial_lagrange_points_need_the_tabled_thrust(planet_mu, needs):
    radius = np.array([0.97, 0.98, 0.985, 0.99]) * AU
    fall = planet_mu / AU**2 * (1 - radius / AU) * 1e3  # of the Sun, which the table leaves out
    found = displaced.lagrange_point(radius, planet_mu=planet_mu)
    assert mm(found) == pytest.approx(np.array(needs) + fall * radius / AU, abs=0.51e-9)


def test_ideal_sail_at_a_lagrange_point_lightens_the_sun():
    ratio = np.array([0.97, 0.98, 0.985, 0.99])
    found = displaced.lagrange_point(ratio * AU, "ideal")
    lightness = FILMS["ideal"].lightness(found.characteristic_acceleration)
    assert lightness == pytest.approx([0.087327, 0.058808, 0.044328375, 0.029701], abs=1e-12)
    moving = displaced.ecliptic(ratio * AU, ratio**1.5, "ideal")
    assert moving.characteristic_acceleration == pytest.approx(found.characteristic_acceleration, rel=1e-13)


def test_lagrange_thrust_vanishes_at_the_natural_point():
    near, beyond = displaced.lagrange_point(np.array([0.9900295, 0.9900297]) * AU, planet_mu=TABLED_MU).feasible
    assert (near, beyond) == (True, False)
    with_moon = displaced.lagrange_point(np.array([0.9899889, 0.9899891]) * AU, planet_mu=3.04042e-6 * MU_SUN).feasible
    assert with_moon.tolist() == [True, False]
    reason = displaced.lagrange_point(0.995 * AU, planet_mu=MU_EARTH).reason
    assert "0.99002" in reason
    assert "1.0100" in reason
    assert displaced.lagrange_point(
        1.005 * AU, planet_mu=MU_EARTH
    ).feasible  # between the Earth and L2 the sail pushes out
    assert "up to 1 au" in displaced.lagrange_point(1.01 * AU).reason


def test_heliostationary_sail_carries_its_weight():
    radius = np.array([0.25, 0.5, 0.723332, 1, 1.523679]) * AU
    needs = [23.720334076, 11.860167038, 8.198287258, 5.930083519, 3.891950679]
    found = displaced.heliostationary(radius)
    assert mm(found) == pytest.approx(needs, abs=NINE)
    assert (found.pitch == 0).all()
    for film in ("ideal", "jpl-1978", "eta-perfect"):
        ac = displaced.heliostationary(radius, film).characteristic_acceleration
        assert ac == pytest.approx(GRAVITY_AT_1_AU, rel=1e-14)


# ---------------------------------------------------------------- ellipses and tracks
@pytest.mark.parametrize(
    ("a", "e", "ratio", "psi", "needs", "pitches"),
    [
        (1, 0.016709, 1, 72, (7.225936, 6.990380, 6.758727), (42.989843166,) * 3),
        (1, 0.016709, 1, 75, (6.715171, 6.496265, 6.280986), (32.968664449,) * 3),
        (1, 0.016709, 1, 80, (6.342907, 6.136137, 5.932792), (20.697815126,) * 3),
        (1, 0.016709, 1, 90, (6.131623, 5.931740, 5.735169), (0,) * 3),
        (0.387098, 0.20563, 1, 75, (25.463186, 17.518005, 11.054276), None),
        (0.723332, 0.006772, 1, 80, (8.596432, 8.481174, 8.366694), None),
        (1.523679, 0.0934, 0.85, 5, (2.0667260, 1.8738944, 1.6854295), (17.371041, 15.858812, 14.356793)),
        (1, 0.016709, 0.8, 15, (4.5127978, 4.4133320, 4.3153073), (30.204931, 29.669079, 29.137328)),
    ],
)
def test_following_a_planet_needs_the_tabled_thrust(a, e, ratio, psi, needs, pitches):
    found = displaced.planet_following(a * AU, e, deg([0, 90, 180]), deg(psi), ratio)
    assert mm(found) == pytest.approx(needs, abs=SEVEN)
    if pitches:
        assert np.degrees(found.pitch) == pytest.approx(pitches, abs=SEVEN)
    assert found.clock == pytest.approx(0, abs=1e-9)
    assert found.throttle[0] == 1


def test_over_the_pole_of_any_ellipse_the_attitude_is_constant_and_the_voltage_follows():
    e = 0.20563
    found = displaced.planet_following(0.387098 * AU, e, np.linspace(0, 2 * np.pi, 73), deg(80))
    assert np.ptp(found.pitch) < 1e-12
    assert found.throttle.min() == pytest.approx(((1 - e) / (1 + e)) ** 2, rel=1e-12)
    sail = displaced.planet_following(AU, e, 1.0, deg(80), 1.0, "ideal").characteristic_acceleration
    assert sail / GRAVITY_AT_1_AU == pytest.approx((1 + e * np.cos(1.0)) / np.sin(deg(80)), rel=1e-12)


def test_a_circle_is_an_ellipse():
    ellipse = displaced.planet_following(AU, 0.0, np.linspace(0, 6, 7), deg(10), 0.8)
    circle = displaced.circular(0.8 * AU, deg(10), 0.8**1.5)
    assert ellipse.characteristic_acceleration == pytest.approx(circle.characteristic_acceleration, rel=1e-13)
    assert ellipse.pitch == pytest.approx(circle.pitch, rel=1e-12)
    flat = displaced.flat_ellipse(AU * np.cos(deg(10)), 0.0, 1.0, AU * np.sin(deg(10)), 0.25 * np.cos(deg(10)) ** 3)
    circle = displaced.circular(AU, deg(10), 0.5)
    assert flat.characteristic_acceleration == pytest.approx(circle.characteristic_acceleration, rel=1e-13)


def test_flat_ellipse_needs_the_tabled_thrust():
    found = displaced.flat_ellipse(AU, 0.1, deg([0, 90, 180]), 0.1 * AU, 0.4)
    assert mm(found) == pytest.approx([3.9177427, 3.5608047, 3.2041442], abs=0.51e-7)
    assert np.degrees(found.pitch) == pytest.approx([8.520090, 7.726873, 6.939072], abs=SEVEN)
    assert found.clock_meridian == pytest.approx(0, abs=1e-9)  # no push along the azimuth


def test_tracks_refuse_with_the_nearest_point():
    refused = displaced.planet_following(AU, 0.0167, 0.0, deg(60))
    most = float(refused.reason.split(" up to ")[1].split()[0])
    assert displaced.planet_following(AU, 0.0167, 0.0, deg(60), most * 0.99999).feasible
    assert not displaced.planet_following(AU, 0.0167, 0.0, deg(60), most * 1.00001).feasible
    refused = displaced.flat_ellipse(AU, 0.1, 0.0, 0.1 * AU, 0.9)
    most = float(refused.reason.split(" up to ")[1].split(",")[0])
    assert displaced.flat_ellipse(AU, 0.1, 0.0, 0.1 * AU, most * 0.9999).feasible
    assert not displaced.flat_ellipse(AU, 0.1, 0.0, 0.1 * AU, most * 1.0001).feasible


@pytest.mark.parametrize("e", [0.0, 0.3, 0.9])
def test_sampled_track_finds_the_thrust_of_the_closed_form(e):
    nu = np.linspace(0, 2 * np.pi, 400)
    exact = displaced.flat_ellipse(AU, e, nu, 0.1 * AU, 0.2)
    found = displaced.sampled_track(exact.time, exact.position)
    inner = slice(8, -8)
    assert found.acceleration[inner] == pytest.approx(exact.acceleration[inner], rel=1e-6)
    assert found.clock[inner] == pytest.approx(exact.clock[inner], abs=1e-5)
    assert found.velocity[inner] == pytest.approx(exact.velocity[inner], abs=1e-2)


def test_sampled_track_rejects_what_it_cannot_differentiate():
    with pytest.raises(ValueError, match="eight"):
        displaced.sampled_track([0, 1, 2], np.zeros((3, 3)))


def fly_track(at, device_force, start, duration):
    """Integrate with scipy under the thrust that `at` gives for an azimuth; final position and velocity, au and
    au/TU."""
    tu = np.sqrt(AU**3 / MU_SUN)

    def rates(t, y):
        r = y[:3]
        return np.concatenate([y[3:], -r / np.linalg.norm(r) ** 3 + device_force(at(np.arctan2(r[1], r[0])), r, y[3:])])

    y0 = np.concatenate([start.position / AU, start.velocity * tu / AU])
    run = solve_ivp(rates, (0, duration / tu), y0, method="DOP853", rtol=1e-12, atol=1e-13)
    return np.abs(run.y[:, -1] - y0).max()


def esail_push(found, r, v):
    h = np.cross(r, v)
    up, out = h / np.linalg.norm(h), r / np.linalg.norm(r)
    along = np.cross(up, out)
    n = np.cos(found.pitch) * out + np.sin(found.pitch) * (np.cos(found.clock) * up + np.sin(found.clock) * along)
    return electric_sail.acceleration(r * AU, n, found.characteristic_acceleration) / GRAVITY_AT_1_AU


@pytest.mark.parametrize("psi", [72, -80])
def test_flight_over_mercurys_pole_closes_after_a_year(psi):
    a, e = 0.387098 * AU, 0.20563
    at = lambda nu: displaced.planet_following(a, e, nu, deg(psi))  # noqa: E731
    year = 2 * np.pi * np.sqrt(a**3 / MU_SUN)
    assert fly_track(at, esail_push, at(0.0), year) < 1e-8  # au; unstable, 1e-13 grows 1e3-fold


def test_flat_ellipse_flown_in_the_orbital_frame_closes():
    at = lambda nu: displaced.flat_ellipse(AU, 0.1, nu, 0.1 * AU, 0.4)  # noqa: E731
    period = 2 * np.pi * np.sqrt((AU / 0.99) ** 3 / (0.4 * MU_SUN))
    assert fly_track(at, esail_push, at(0.0), period) < 1e-9


def test_time_along_a_track_counts_revolutions():
    nu = np.array([-4 * np.pi, -1.0, 0.0, 1.0, 2 * np.pi + 1.0, 14 * np.pi])
    found = displaced.planet_following(AU, 0.2, nu, deg(80))
    period = 2 * np.pi * np.sqrt(AU**3 / MU_SUN)
    assert found.time[[0, 2, 5]] / period == pytest.approx([-2, 0, 7], abs=1e-12)
    assert found.time[4] - found.time[3] == pytest.approx(period, rel=1e-12)
    assert found.time[1] == pytest.approx(-found.time[3], rel=1e-12)


# ---------------------------------------------------------------- stability
@pytest.mark.parametrize(
    ("psi", "wb", "device", "clock", "squared"),
    [
        (10, 0.8, "electric-sail", "orbital", (-0.2414, -0.64)),
        (75, 1, "electric-sail", "orbital", (0.8660, -1)),
        (10, 0.8, "ideal", "orbital", (-0.6207, -0.64)),
        (5, 0.8, "electric-sail", "meridian", (-0.240123256, -0.679876744)),
        (10, 0.8, "electric-sail", "meridian", (-0.150648056, -0.769351944)),
        (14, 0.78, "electric-sail", "meridian", (-0.021602125, -0.803597875)),
        (15, 0.779, "electric-sail", "meridian", (0.001177106, -0.821700106)),
        (20, 0.7, "electric-sail", "meridian", (0.250629439, -0.720629439)),
        (75, 1, "electric-sail", "meridian", (0.931851653, -2.931851653)),
        (10, 0.8, "ideal", "meridian", (-0.492184870, -0.807113492)),
        (75, 1, "ideal", "meridian", (-0.023019746, -2.909992956)),
        (75, 1, "jpl-2015", "meridian", (-0.023019746, -2.909992956)),
    ],
)
def test_eigenvalues_are_the_tabled_ones(psi, wb, device, clock, squared):
    found = displaced.stability(deg(psi), wb, device, clock)
    assert found.lambda_squared == pytest.approx(squared, abs=0.51e-4 if clock == "orbital" else 0.51e-9)
    assert found.stable == (max(squared) < 0)
    mirrored = displaced.stability(deg(-psi), wb, device, clock)
    assert (mirrored.lambda_squared == found.lambda_squared).all()


@pytest.mark.parametrize(
    ("clock", "limit", "closes"),
    [
        ("meridian", None, 15.07282134),
        ("meridian", 30, 19.849),
        ("meridian", 45, 25.145),
        ("orbital", None, np.degrees(PHI_MAX)),
        ("orbital", 30, 30),
        ("orbital", 45, 45),
    ],
)
def test_stable_wedge_closes_where_it_should(clock, limit, closes):
    radians = None if limit is None else deg(limit)
    psi, ratio = displaced.largest_stable_elevation(clock, radians)
    assert np.degrees(psi) == pytest.approx(closes, abs=0.51e-8 if limit is None else 0.51e-3)
    if limit is None and clock == "meridian":
        assert ratio == pytest.approx(0.78025210, abs=0.51e-8)
    if limit is None:  # the map agrees: nothing is stable above, something is just below
        ratios = np.linspace(0.5, 1.2, 20001)
        assert not displaced.stability(psi + 1e-4, ratios, clock=clock).stable.any()
        assert displaced.stability(psi - 1e-3, ratios, clock=clock).stable.any()


@pytest.mark.parametrize(
    ("psi", "low", "high"), [(1, 0.7074, 0.9763), (5, 0.715179, 0.898759), (10, 0.739349, 0.829444)]
)
def test_wedge_of_the_meridian_law_has_the_tabled_edges(psi, low, high):
    ratios = np.linspace(low - 2e-3, high + 2e-3, 100001)
    stable = ratios[displaced.stability(deg(psi), ratios, clock="meridian").stable]
    assert stable.min() == pytest.approx(low, abs=1e-4)
    assert stable.max() == pytest.approx(high, abs=1e-4)


def test_solar_sails_are_stable_wherever_they_turn_and_drift_where_they_rest():
    psi, ratio = np.meshgrid(deg(np.linspace(0.5, 85, 12)), np.linspace(0.05, 0.95, 10))
    for clock in ("orbital", "meridian"):
        found = displaced.stability(psi, ratio, "ideal", clock)
        assert found.stable[found.feasible].all()
        resting = displaced.stability(deg(30), 0.0, "ideal", clock)
        assert resting.lambda_squared == pytest.approx([0, 0], abs=1e-15)
        assert not resting.stable


def test_stability_of_what_cannot_be_held_is_unknown():
    found = displaced.stability(deg(10), 0.9)
    assert not found.feasible
    assert not found.stable
    assert np.isnan(found.lambda_squared).all()
    assert "0.829444" in found.reason
    with pytest.raises(ValueError, match="meridian"):
        displaced.stability(0.1, 0.8, clock="inertial")


def test_eigenvalues_are_those_of_a_numerical_jacobian():
    """Law by law, device by device: the six-dimensional equations in the turning frame, differentiated numerically."""
    for device, k in (("electric-sail", 1), ("ideal", 2)):
        for clock in ("orbital", "meridian"):
            for psi, wb in ((deg(8), 0.75), (deg(40), 0.5), (deg(75), 1.0)):
                c, s = np.cos(psi), np.sin(psi)
                thrust = np.array([1 - wb**2 * c * c, wb**2 * s * c])

                def rates(y, k=k, clock=clock, wb=wb, thrust=thrust):
                    r, v = y[:3], y[3:]
                    spin = np.array([0, 0, wb])
                    inertial = v + np.cross(spin, r)
                    d = np.linalg.norm(r)
                    out = r / d
                    up = np.cross(r, inertial) if clock == "orbital" else np.array([0, 0, 1.0]) - out[2] * out
                    up = up / np.linalg.norm(up)
                    a = -r / d**3 + (thrust[0] * out + thrust[1] * up) / d**k
                    return np.concatenate([v, a - 2 * np.cross(spin, v) - np.cross(spin, np.cross(spin, r))])

                y0, h = np.array([c, 0, s, 0, 0, 0]), 1e-5
                assert np.abs(rates(y0)).max() < 1e-14
                jacobian = np.column_stack([(rates(y0 + h * u) - rates(y0 - h * u)) / (2 * h) for u in np.eye(6)])
                numeric = np.linalg.eigvals(jacobian)
                wanted = displaced.stability(psi, wb, device, clock).lambda_squared
                for value in np.concatenate([np.sqrt(wanted + 0j), -np.sqrt(wanted + 0j)]):
                    assert np.abs(numeric - value).min() < 1e-6


def flight(fly, psi, wb, clock, shift, periods, outputs=2001):
    """A circular E-sail orbit at 1 au, shifted outwards by a share of its radius: |position| / au and Omega_K t."""
    design = displaced.circular(AU, psi, wb)
    position, velocity = displaced.state(AU, psi, wb)
    model = dynamics.model(
        MU_SUN,
        device=dynamics.ELECTRIC_SAIL,
        device_parameters=(float(design.characteristic_acceleration), 0, np.pi / 2),
        steering=attitude.ORBITAL if clock == "orbital" else attitude.MERIDIAN,
        steering_parameters=attitude.direction_parameters(float(design.pitch), 0.0),
    )
    rate = np.sqrt(MU_SUN / AU**3)
    times = np.linspace(0, periods * 2 * np.pi / (wb * rate), outputs)
    run = fly(model, position * (1 + shift), velocity, times)
    return np.linalg.norm(run.position, axis=1) / AU, times * rate


def test_disturbed_stable_orbit_stays(fly):
    """It swings about the radius that belongs to its angular momentum, 2 w cos^2(psi) / |lambda^2| shifts away."""
    shift = 1e-5
    for psi, wb in ((17, 0.75), (10, 0.8)):
        r, _ = flight(fly, deg(psi), wb, "orbital", shift, 60)
        swing = 2 * wb**2 * np.cos(deg(psi)) ** 2 * shift / -displaced.stability(deg(psi), wb).lambda_squared[0]
        assert (r - 1).min() == pytest.approx(shift, rel=1e-3)
        assert (r - 1).max() == pytest.approx(2 * swing - shift, rel=0.05)
    r, _ = flight(fly, deg(10), 0.8, "meridian", shift, 60)
    assert np.abs(r - 1).max() < 1e-3


def test_the_same_orbit_leaves_under_the_other_law(fly):
    assert displaced.stability(deg(17), 0.75, clock="orbital").stable
    assert not displaced.stability(deg(17), 0.75, clock="meridian").stable
    r, _ = flight(fly, deg(17), 0.75, "meridian", 1e-5, 60)
    assert np.abs(r - 1).max() > 0.1


@pytest.mark.parametrize(
    ("psi", "wb", "clock"), [(30, 0.6, "orbital"), (75, 1.0, "orbital"), (30, 0.6, "meridian"), (75, 1.0, "meridian")]
)
def test_unstable_orbit_leaves_at_the_predicted_rate(fly, psi, wb, clock):
    """Deviation between 1e-6 and 1e-4 of the radius: long enough for one mode to rule, small enough to be linear."""
    predicted = displaced.stability(deg(psi), wb, clock=clock).growth_rate
    r, t = flight(fly, deg(psi), wb, clock, 1e-8, 14 * wb / (2 * np.pi * predicted), 4001)
    away = np.abs(r - 1)
    grown = (away > 1e-6) & (away < 1e-4)
    assert grown.sum() > 100
    rate = np.polyfit(t[grown], np.log(away[grown]), 1)[0]
    assert rate == pytest.approx(predicted, rel=0.02)
