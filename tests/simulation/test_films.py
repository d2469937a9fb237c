"""Sails whose film ages or gets hot, in flight: rows of the source, SciPy, limits, and every way a flight is cut up."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz import load_scene, simulate, simulate_blocks
from sailviz.constants import AU, DAY, MU_SUN, SOLAR_IRRADIANCE, YEAR
from sailviz.errors import SceneError
from sailviz.propulsion.film_ageing import Optics, aged_film, temperature
from sailviz.run.arrays import join

OPTICS = Optics(0.91, 0.94, 0.79, 0.67, 0.025, 0.27)  # of table 3.1, 2015
OWN = OPTICS._asdict()


def scene(device: dict, days: float, pitch: float = 35.0, outputs: int = 2, **more: object) -> dict:
    found = {
        "title": "a film that ages",
        "start": {"kind": "circular", "radius_au": 1},
        "device": {"kind": "solar-sail", "film": "jpl-2015", "characteristic_acceleration_mm_s2": 1, **device},
        "steering": {"kind": "orbital", "pitch_deg": abs(pitch), "clock_deg": 90 if pitch > 0 else 270},
        "propagation": {"duration_d": days, "outputs": outputs, "tolerance": 1e-13},
    }
    return found | more


def ageing(factor: float = 0.2, half: float = 0.5, **more: float) -> dict:
    return {"ageing": {"factor": factor, "half_dose_yr": half, **more}}


def polar(run, row: int = -1) -> tuple[float, float, float]:
    """(distance au, radial, transverse speed m/s) of a row."""
    position, velocity = run.position[row], run.velocity[row]
    r = np.linalg.norm(position)
    return r / AU, velocity @ position / r, np.linalg.norm(np.cross(position, velocity)) / r


@pytest.mark.parametrize(
    ("factor", "pitch", "days", "r", "radial", "transverse", "dose"),
    [
        (0.2, 35, 300, 1.937223323015, 5202.076030769, 18639.869886018, 0.393593990811),
        (0.0, 35, 300, 1.979086506419, 5740.726746197, 18499.731304489, 0.389990542236),
        (0.2, -35, 250, 0.541166478086, -6703.239404229, 40798.613925307, 0.738698068472),
        (0.0, -35, 250, 0.490387876647, -7468.469152116, 42802.378992073, 0.780080632827),
    ],
)
def test_a_film_that_ages_flies_as_two_codes_have_it(factor, pitch, days, r, radial, transverse, dose):
    """Within a metre and 1e-7 m/s, or 1e-11: the digits of the source."""
    run = simulate(load_scene(scene(ageing(factor), days, pitch)))
    assert polar(run) == pytest.approx((r, radial, transverse), rel=1e-11)
    assert run.film["dose_yr"][-1] == pytest.approx(dose, rel=1e-11)


def flown_by_scipy(y0, duration, pitch, factor, half, dose=0.0, strength=1e-3):
    """In the plane: x, y, vx, vy, dose yr; a normal at a pitch from the radius towards the way of flight."""
    total = aged_film(OPTICS, 0.0, 0.0).total

    def rate(t, y):
        x, yy, vx, vy, s = y
        r = np.hypot(x, yy)
        film = aged_film(OPTICS, s, factor, half)
        c = np.cos(pitch)
        ux, uy = x / r, yy / r
        nx, ny = ux * c - uy * np.sin(pitch), uy * c + ux * np.sin(pitch)
        k = strength / total * (AU / r) ** 2 * c
        ax, ay = (
            k * (film.b1 * u + (film.b2 * c + film.b3) * n) - MU_SUN * p / r**3
            for u, n, p in ((ux, nx, x), (uy, ny, yy))
        )
        return [vx, vy, ax, ay, (AU / r) ** 2 * c / YEAR]

    scale = np.array([AU, AU, 3e4, 3e4, 1.0])
    return solve_ivp(rate, (0, duration), [*y0, dose], "DOP853", rtol=1e-13, atol=1e-14 * scale).y[:, -1]


@pytest.mark.parametrize(("tolerance", "most"), [(1e-10, 2e-9), (1e-13, 3e-12)])
def test_the_integrator_that_auto_takes_keeps_a_quickly_ageing_film_to_its_accuracy(tolerance, most):
    """A half dose of 20 days, towards the Sun: against SciPy at 1e-13, place and dose over their sizes."""
    planned = scene(ageing(0.35, 20 / 365.25, dose_d=3), 200, -50)
    planned["propagation"]["tolerance"] = tolerance
    run = simulate(load_scene(planned))
    assert "carries the dose" in run.setting.accuracy
    start = (*run.position[0][:2], *run.velocity[0][:2])
    x, y, _, _, dose = flown_by_scipy(start, 200 * DAY, np.radians(-50), 0.35, 20 / 365.25, 3 / 365.25)
    assert np.hypot(*(run.position[-1][:2] - [x, y])) < most * np.hypot(x, y)
    assert abs(run.film["dose_yr"][-1] / dose - 1) < most


def test_a_film_that_does_not_age_flies_as_the_sail_of_today():
    """With the same optics, in and out of the plane, and by every integrator of that sail: 1e-12 of the force."""
    device = {"film": OWN}
    whole = scene({**device, **ageing(0.0)}, 100, outputs=5)
    plain = scene(device, 100, outputs=5)
    for each in (whole, plain):
        each["steering"]["clock_deg"] = 40
    one, other = simulate(load_scene(whole)), simulate(load_scene(plain))
    size = other.thrust.magnitude.max()
    np.testing.assert_allclose(one.thrust.acceleration[0], other.thrust.acceleration[0], rtol=0, atol=1e-12 * size)
    np.testing.assert_allclose(one.position, other.position, rtol=0, atol=1e-12 * 2 * AU)
    assert not other.film


@pytest.fixture(scope="module")
def dive():
    return scene({**ageing(0.0), "hottest_K": 350}, 260, -35, outputs=27)


@pytest.mark.parametrize(
    ("kelvin", "days", "r"), [(350, 223.643169025, 0.632227278034), (400, 251.505549685, 0.484049009745)]
)
def test_a_fresh_film_is_too_hot_where_two_codes_have_it(dive, kelvin, days, r):
    wanted = {**dive, "device": {**dive["device"], "hottest_K": kelvin}}
    event = next(event for event in simulate(load_scene(wanted)).events if event.name == "too-hot")
    assert event.time / DAY == pytest.approx(days, abs=2e-8)
    assert np.linalg.norm(event.state[:3]) / AU == pytest.approx(r, abs=1e-10)
    assert np.isnan(event.state[6])


def test_a_flight_may_end_where_its_film_is_too_hot(dive):
    run = simulate(load_scene({**dive, "event": [{"kind": "too-hot", "stop": True}]}))
    assert run.ended == "too-hot"
    assert run.film["temperature_K"][-1] == pytest.approx(350, abs=1e-6)
    assert [event.name for event in run.events] == ["too-hot"]


def test_an_aged_film_is_too_hot_sooner(dive):
    aged = simulate(load_scene({**dive, "device": {**dive["device"], **ageing(0.2)}}))
    fresh = simulate(load_scene(dive))
    times = [next(event.time for event in run.events if event.name == "too-hot") for run in (aged, fresh)]
    assert times[0] < times[1] - 10 * DAY


def test_rows_tell_the_temperature_of_the_dose_they_have(dive):
    run = simulate(load_scene({**dive, "device": {**dive["device"], **ageing(0.2)}}))
    r, pitch = np.linalg.norm(run.position, axis=1), np.radians(35)
    expected = temperature(r, pitch, OPTICS, run.film["dose_yr"], 0.2, 0.5)
    np.testing.assert_allclose(run.film["temperature_K"], expected, rtol=1e-12)
    film = aged_film(OPTICS, run.film["dose_yr"][-1], 0.2)
    assert [run.film[name][-1] for name in ("b1", "b2", "b3")] == pytest.approx([film.b1, film.b2, film.b3], rel=1e-12)


def test_blocks_and_phases_carry_the_dose(dive):
    """A flight cut into blocks, and into phases at a dose, is the one in one piece."""
    planned = {**dive, "device": {**dive["device"], **ageing(0.2), "mass_kg": 14}}
    whole = simulate(load_scene(planned))
    blocks = join(list(simulate_blocks(load_scene(planned), block_rows=7)))
    np.testing.assert_array_equal(blocks.film["dose_yr"], whole.film["dose_yr"])
    phases = [{"name": "fresh", "until": "dose_yr = 0.2"}, {"name": "worn"}]
    cut = simulate(load_scene({**planned, "phase": phases}))
    end = next(event for event in cut.events if event.name == "end of fresh")
    assert np.interp(end.time, cut.time, cut.film["dose_yr"]) == pytest.approx(0.2, abs=1e-9)
    np.testing.assert_allclose(cut.position[-1], whole.position[-1], rtol=0, atol=3e-12 * AU)
    assert cut.film["dose_yr"][-1] == pytest.approx(whole.film["dose_yr"][-1], rel=1e-12)
    assert np.all(cut.mass == 14)
    assert end.state[6] == 14


def test_a_flight_goes_on_with_the_dose_that_it_says_it_has():
    """From the end of one flight, its film as old as it was: the end of both is that of one."""
    whole = simulate(load_scene(scene(ageing(0.2), 200, -35, outputs=3)))
    (x, y, _), (u, v, _) = whole.position[1].tolist(), whole.velocity[1].tolist()
    start = {"kind": "cartesian", "position_m": [x, y, 0.0], "velocity_m_s": [u, v, 0.0]}
    rest = scene(ageing(0.2, dose_yr=float(whole.film["dose_yr"][1])), 100, -35, start=start)
    run = simulate(load_scene(rest))
    np.testing.assert_allclose(run.position[-1], whole.position[-1], rtol=0, atol=1e-11 * AU)


def test_a_sail_that_is_off_neither_ages_nor_has_a_temperature():
    run = simulate(load_scene(scene({**ageing(0.2), "active_d": [[0, 20]]}, 40, outputs=5)))
    dose = run.film["dose_yr"]
    assert dose[2] == dose[3] == dose[4] > dose[1] > 0
    assert np.all(np.isnan(run.film["temperature_K"][2:]))
    assert np.all(run.film["temperature_K"][:2] > 200)


def test_a_brighter_light_ages_and_heats_by_as_much_more():
    device = {**ageing(0.2), "characteristic_acceleration_mm_s2": 1e-6}
    bright = simulate(load_scene(scene(device, 30, light={"irradiance_W_m2": 2 * SOLAR_IRRADIANCE})))
    plain = simulate(load_scene(scene(device, 30)))
    assert bright.film["dose_yr"][-1] == pytest.approx(2 * plain.film["dose_yr"][-1], rel=1e-9)
    assert bright.film["temperature_K"][0] ** 4 == pytest.approx(2 * plain.film["temperature_K"][0] ** 4, rel=1e-12)


def test_a_film_ages_by_the_light_that_reaches_it_under_a_sky():
    """Round the Earth, through its shadow: the dose is the light's, counted by hand over the rows."""
    planned = {
        "title": "in and out of the shadow",
        "epoch": "2026-03-20T00:00:00",
        "body": "earth",
        "start": {"kind": "circular", "altitude_km": 20000},
        "device": {"kind": "solar-sail", "film": "jpl-2015", "characteristic_acceleration_mm_s2": 0.05}
        | ageing(0.2, 0.01)
        | {"hottest_K": 250},
        "steering": {"kind": "sun-frame", "pitch_deg": 40, "clock_deg": 0},
        "propagation": {"duration_d": 1, "outputs": 4001},
    }
    run = simulate(load_scene(planned))
    light = run.environment["sunlit_fraction"]
    rate = light * (AU / run.environment["sun_distance_m"]) ** 2 * np.cos(np.radians(40))
    dose = np.trapezoid(rate, run.time) / YEAR
    assert 0.9 < light.mean() < 0.99
    assert run.film["dose_yr"][-1] == pytest.approx(dose, rel=1e-5)
    warm = run.film["temperature_K"]
    assert np.all(np.isnan(warm[light == 0]))
    assert np.all(warm[light == 1] > 270)
    passes = [event.time for event in run.events if event.name == "too-hot"]
    assert len(passes) == np.count_nonzero((warm[1:] > 250) & ~(warm[:-1] > 250))


@pytest.mark.parametrize(
    ("device", "more", "words"),
    [
        ({"film": "eta-perfect", **ageing()}, {}, "needs the optics"),
        ({"film": {"b1": 0.1, "b2": 0.8, "b3": 0}, "hottest_K": 500}, {}, "needs the optics"),
        ({"film": "ideal", "hottest_K": 500}, {}, "emissivities are 0"),
        (ageing(), {"steering": {"kind": "optimal", "costates": [0.1, 0.2, 0.3]}}, "reckons_with"),
        (
            ageing(),
            {"environment": {"irradiance": {"kind": "cycle"}}, "ensemble": [{"name": "a", "flights": 9}]},
            "stay as they are",
        ),
        ({}, {"event": [{"dose_yr": 1}]}, "only a film that ages"),
        ({}, {"event": [{"kind": "too-hot"}]}, "hottest"),
        (
            {"film": "ideal"},
            {"expect": [{"quantity": "film_temperature_K", "at": "end", "value": 3, "within": 1}]},
            "emissivities",
        ),
        (ageing(1.5), {}, "must be at most 1"),
        ({"back": "black"}, {}, "back belongs"),
        ({**ageing(), "mass_kg": 3}, {"event": [{"mass_kg": 2}]}, "the mass stays"),
    ],
)
def test_what_does_not_go_with_a_films_age_or_heat_is_told(device, more, words):
    with pytest.raises(SceneError, match=words):
        load_scene(scene(device, 100) | more)


@pytest.mark.parametrize("integrator", ["collocation", "gauss-jackson"])
def test_only_the_integrator_that_carries_the_dose_is_taken(integrator):
    planned = scene(ageing(), 100)
    planned["propagation"]["integrator"] = integrator
    with pytest.raises(SceneError, match="DOP853"):
        load_scene(planned)


def test_a_law_of_ones_own_gets_no_mass_from_a_film_that_ages():
    import numba

    @numba.njit
    def push(t, x, y, z, vx, vy, vz, m):
        return 0.0, 0.0, 0.0

    with pytest.raises(SceneError, match="does not carry"):
        simulate(load_scene(scene(ageing(), 10)), force=push)
