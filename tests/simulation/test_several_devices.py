"""Several devices on one craft: accelerations add, mass flows add, each is steered on its own."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz import load_scene, simulate
from sailviz.constants import AU, DAY, MU_SUN, STANDARD_GRAVITY
from sailviz.propulsion import electric_sail

AC = 0.8e-3  # m/s2
PITCH = np.radians(30.0)
SAIL: dict[str, Any] = {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 1e3 * AC}
TURNED = {"kind": "orbital", "pitch_deg": 30, "clock_deg": 90}
AHEAD = {"kind": "tangential"}
THRUSTER: dict[str, Any] = {
    "kind": "thruster", "thrust_mN": 60, "specific_impulse_s": 1500, "mass_kg": 400, "steering": AHEAD,
}  # fmt: skip


def scene(*devices: dict[str, Any], days: float = 200.0, **more: Any) -> dict[str, Any]:
    """A craft on a circle of 1 au, inclined by 10 deg."""
    return {
        "title": "several devices",
        "start": {"kind": "elements", "semi_major_axis_au": 1.0, "eccentricity": 0.05, "inclination_deg": 10.0},
        "device": list(devices),
        "steering": TURNED,
        "propagation": {"duration_d": days, "outputs": 41, "tolerance": 1e-13},
    } | more


def sail_push(r: np.ndarray, v: np.ndarray, a_c: float, pitch: float) -> np.ndarray:
    """An ideal sail, pitched ahead in the orbit's plane, by its formula: a_c (au / r)^2 cos^2 n."""
    u = r / np.linalg.norm(r)
    h = np.cross(r, v)
    t = np.cross(h / np.linalg.norm(h), u)
    n = np.cos(pitch) * u + np.sin(pitch) * t
    return np.asarray(a_c * (AU / np.linalg.norm(r)) ** 2 * np.cos(pitch) ** 2 * n)


def flown(push: Any, times: np.ndarray, start: np.ndarray, edges: tuple[float, ...] = ()) -> np.ndarray:
    """States (7, n) by SciPy, begun anew at every edge. push(t, r, v, m) -> acceleration m/s2, mass flow kg/s."""

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        a, flow = push(t, y[:3], y[3:6], y[6])
        return np.concatenate([y[3:6], a - MU_SUN * y[:3] / np.linalg.norm(y[:3]) ** 3, [flow]])

    out, y = np.empty((7, len(times))), start
    stops = [0.0, *edges, times[-1]]
    for a, b in pairwise(stops):
        inside = (times >= a) & (times <= b)
        middle = 0.5 * (a + b)
        found = solve_ivp(
            lambda t, y, side=(a, b, middle): slope(min(max(t, side[0] + 1e-6), side[1] - 1e-6), y),
            (a, b), y, method="DOP853", rtol=1e-13, atol=[1e-3] * 3 + [1e-10] * 3 + [1e-12], dense_output=True,
        )  # fmt: skip
        out[:, inside], y = found.sol(times[inside]), found.y[:, -1]
    return out


def start_of(run: Any) -> np.ndarray:
    return np.concatenate([run.position[0], run.velocity[0], [400.0]])


def worst(run: Any, states: np.ndarray) -> float:
    """Largest distance from states (7, n) over the distance from the Sun."""
    miss = np.linalg.norm(run.position - states[:3].T, axis=1)
    return float(np.max(miss / np.linalg.norm(run.position, axis=1)))


def test_two_sails_of_half_the_area_are_one_sail() -> None:
    half = {"kind": "solar-sail", "area_m2": 5000}
    both = simulate(scene({**half, "mass_kg": 100}, {**half, "steering": TURNED}))
    one = simulate(scene({"kind": "solar-sail", "area_m2": 10_000, "mass_kg": 100}))
    assert worst(both, np.vstack([one.position.T, one.velocity.T])) < 1e-11
    first, second = both.devices.values()
    np.testing.assert_allclose(first.acceleration, second.acceleration, rtol=1e-14, atol=1e-19)
    np.testing.assert_allclose(both.thrust.acceleration, 2 * first.acceleration, rtol=1e-14, atol=1e-19)


def test_a_sail_and_a_thruster_fly_as_their_formulas_say() -> None:
    run = simulate(scene(SAIL, THRUSTER))

    def push(t: float, r: np.ndarray, v: np.ndarray, m: float) -> tuple[np.ndarray, float]:
        return sail_push(r, v, AC, PITCH) + 0.06 / m * v / np.linalg.norm(v), -0.06 / (STANDARD_GRAVITY * 1500)

    states = flown(push, run.time, start_of(run))
    assert worst(run, states) < 1e-10
    np.testing.assert_allclose(run.mass, states[6], rtol=1e-12)
    for i in (0, 20, 40):
        r, v = run.position[i], run.velocity[i]
        np.testing.assert_allclose(run.devices["solar-sail"].acceleration[i], sail_push(r, v, AC, PITCH), rtol=1e-12)
        ahead = 0.06 / run.mass[i] * v / np.linalg.norm(v)
        np.testing.assert_allclose(run.devices["thruster"].acceleration[i], ahead, rtol=1e-12, atol=1e-18)
        total = sail_push(r, v, AC, PITCH) + ahead
        np.testing.assert_allclose(run.thrust.acceleration[i], total, rtol=1e-12, atol=1e-18)


WHEEL: dict[str, Any] = {
    "kind": "electric-sail", "tethers": 100, "tether_length_km": 20, "voltage_kV": 20, "mass_kg": 400,
}  # fmt: skip


def wheel_push(r: np.ndarray, v: np.ndarray, a_c: float, pitch: float) -> np.ndarray:
    """An electric sail of the final model, pitched ahead: a_c (au / r) (u + (u.n) n) / 2."""
    u = r / np.linalg.norm(r)
    h = np.cross(r, v)
    n = np.cos(pitch) * u + np.sin(pitch) * np.cross(h / np.linalg.norm(h), u)
    return np.asarray(0.5 * a_c * AU / np.linalg.norm(r) * (u + np.cos(pitch) * n))


BURNS: dict[str, Any] = {"kind": "thruster", "thrust_N": 0.25, "specific_impulse_s": 900, "steering": AHEAD}
FILM: dict[str, Any] = {"kind": "solar-sail", "area_m2": 30_000, "mass_kg": 400}
FORCED = {  # what pushes with a force, and its acceleration at 400 kg, m/s2
    "solar-sail": (FILM, sail_push, 2 * 4.563e-6 * 30_000 / 400),
    "electric-sail": (WHEEL, wheel_push, float(electric_sail.characteristic_acceleration(100, 20e3, 20e3, 400))),
}


@pytest.mark.parametrize("kind", FORCED)
@pytest.mark.parametrize("first", [True, False], ids=["steered by the scene", "beside another"])
def test_a_sail_that_pushes_with_a_force_gains_while_propellant_burns(kind: str, first: bool) -> None:
    """Flown by SciPy with the force over the mass of the moment; 0.25 N at 900 s burns 61 % in 100 d."""
    sail, formula, a_c = FORCED[kind]
    devices = [sail, BURNS] if first else [{**SAIL, "name": "other"}, {**sail, "steering": TURNED}, BURNS]
    run = simulate(scene(*devices, days=100))
    flow = -0.25 / (STANDARD_GRAVITY * 900)

    def push(t: float, r: np.ndarray, v: np.ndarray, m: float) -> tuple[np.ndarray, float]:
        a = formula(r, v, a_c * 400 / m, PITCH) + 0.25 / m * v / np.linalg.norm(v)
        return (a if first else a + sail_push(r, v, AC, PITCH)), flow

    states = flown(push, run.time, start_of(run))
    assert worst(run, states) < 1e-10
    np.testing.assert_allclose(run.mass, states[6], rtol=1e-12)
    assert run.mass[-1] < 0.4 * 400
    for i in (0, 20, 40):
        r, v, m = run.position[i], run.velocity[i], run.mass[i]
        told = run.devices[kind].acceleration[i]
        np.testing.assert_allclose(told, formula(r, v, a_c * 400 / m, PITCH), rtol=1e-12)
        np.testing.assert_allclose(run.thrust.acceleration[i], push(0.0, r, v, m)[0], rtol=1e-12, atol=1e-18)


@pytest.mark.parametrize("kind", FORCED)
def test_under_a_sky_a_sail_that_pushes_with_a_force_gains_as_well(kind: str) -> None:
    """High over the Earth, first and beside: the same force over the mass, whoever is steered by the scene."""
    sky = {
        "body": "earth",
        "start": {"kind": "circular", "radius_km": 200_000, "inclination_deg": 60},
        "environment": {"magnetosphere": "none"} if kind == "electric-sail" else {},
        "steering": {"kind": "sun-facing"},
        "propagation": {"duration_d": 20, "outputs": 21, "tolerance": 1e-12},
    }
    sail, burns = FORCED[kind][0], {**BURNS, "thrust_N": 1.0}
    faint = {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 1e-30, "name": "faint"}
    one = simulate(scene(sail, burns) | sky)
    two = simulate(scene(faint, {**sail, "steering": {"kind": "sun-facing"}}, burns) | sky)
    assert worst(one, np.vstack([two.position.T, two.velocity.T])) < 1e-10
    assert one.mass[-1] < 0.55 * 400
    power = 2 if kind == "solar-sail" else 1
    strength = one.devices[kind].magnitude * (one.environment["sun_distance_m"] / AU) ** power * one.mass
    np.testing.assert_allclose(strength, FORCED[kind][2] * 400, rtol=1e-9)


def test_a_characteristic_acceleration_stays_while_propellant_burns() -> None:
    run = simulate(scene({**SAIL, "mass_kg": 400}, BURNS, days=100))
    r = np.linalg.norm(run.position, axis=1)
    np.testing.assert_allclose(run.devices["solar-sail"].magnitude, AC * (AU / r) ** 2 * np.cos(PITCH) ** 2, rtol=1e-12)


def test_each_device_keeps_its_own_times() -> None:
    sail, thruster = {**SAIL, "active_d": [[0, 90]]}, {**THRUSTER, "active_d": [[30, 60], [120, 150]]}
    run = simulate(scene(sail, thruster))

    def push(t: float, r: np.ndarray, v: np.ndarray, m: float) -> tuple[np.ndarray, float]:
        burns = float(30 <= t / DAY < 60 or 120 <= t / DAY < 150)
        a = sail_push(r, v, AC, PITCH) * (t / DAY < 90)
        return a + burns * 0.06 / m * v / np.linalg.norm(v), -burns * 0.06 / (STANDARD_GRAVITY * 1500)

    states = flown(push, run.time, start_of(run), tuple(DAY * np.array([30.0, 60.0, 90.0, 120.0, 150.0])))
    assert worst(run, states) < 1e-10
    np.testing.assert_allclose(run.mass, states[6], rtol=1e-12)
    names = [event.name for event in run.events]
    assert names == ["thruster on", "thruster off", "solar-sail off", "thruster on", "thruster off"]
    days = run.time / DAY
    np.testing.assert_array_equal(run.devices["solar-sail"].on, days < 90)
    np.testing.assert_array_equal(
        run.devices["thruster"].on, ((days >= 30) & (days < 60)) | ((days >= 120) & (days < 150))
    )
    np.testing.assert_array_equal(run.thrust.on, run.devices["solar-sail"].on | run.devices["thruster"].on)


def test_the_order_of_the_devices_does_not_matter() -> None:
    a, b = simulate(scene(SAIL, THRUSTER)), simulate(scene(THRUSTER, SAIL))
    assert list(a.devices) == ["solar-sail", "thruster"]
    assert list(b.devices) == ["thruster", "solar-sail"]
    np.testing.assert_array_equal(a.position, b.position)
    np.testing.assert_array_equal(a.mass, b.mass)
    np.testing.assert_array_equal(a.attitude.normal, b.attitude.normal)


def test_two_thrusters_burn_together() -> None:
    kinds = {"kind": "thruster", "specific_impulse_s": 1500}
    first = {**kinds, "thrust_mN": 60, "mass_kg": 400}
    steady = {**kinds, "acceleration_mm_s2": 0.1, "steering": {"kind": "inertial", "direction": [0, 0, 2]}}
    run = simulate(scene(first, steady) | {"steering": AHEAD})
    exhaust, share = STANDARD_GRAVITY * 1500, 1e-4 / (STANDARD_GRAVITY * 1500)
    force = 0.06 / exhaust
    expected = 400 * np.exp(-share * run.time) - force / share * -np.expm1(-share * run.time)
    np.testing.assert_allclose(run.mass, expected, rtol=1e-12)
    np.testing.assert_allclose(run.devices["thruster 2"].acceleration, np.tile([0, 0, 1e-4], (41, 1)), rtol=1e-14)


def test_a_list_of_one_is_one_device() -> None:
    alone = simulate(scene({**SAIL, "name": "the only one"}))
    plain = simulate(scene(SAIL) | {"device": SAIL})
    np.testing.assert_array_equal(alone.position, plain.position)
    np.testing.assert_array_equal(alone.devices["the only one"].acceleration, plain.thrust.acceleration)
    assert plain.devices == {}


def test_a_device_may_give_the_steering_itself() -> None:
    inside = scene({**SAIL, "steering": TURNED})
    del inside["steering"]
    np.testing.assert_array_equal(simulate(inside).position, simulate(scene(SAIL)).position)


@pytest.mark.parametrize("steering", ["radial", "circumferential", "orbital", "meridian", "inertial"])
def test_a_further_device_is_steered_like_a_first_one(steering: str) -> None:
    more = {"pitch_deg": 40, "clock_deg": 20} if steering in ("orbital", "meridian") else {}
    more |= {"direction": [1, 2, 3]} if steering == "inertial" else {}
    law = {"kind": steering, **more}
    thruster = {"kind": "thruster", "acceleration_mm_s2": 0.3}
    faint = {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 1e-30}
    beside = simulate(scene(faint, {**thruster, "steering": law}, days=60))
    first = simulate(scene(thruster, days=60) | {"steering": law})
    np.testing.assert_allclose(beside.thrust.acceleration, first.thrust.acceleration, rtol=1e-9, atol=1e-16)
    assert worst(beside, np.vstack([first.position.T, first.velocity.T])) < 1e-11


def test_round_the_earth_a_further_sail_follows_the_sun_and_its_shadow() -> None:
    sky = {
        "body": "earth",
        "start": {"kind": "circular", "radius_km": 12_000, "inclination_deg": 20},
        "environment": {"shadow": "cylinder"},
        "steering": {"kind": "sun-facing"},
        "propagation": {"duration_d": 3, "outputs": 200, "tolerance": 1e-12},
    }
    frame = {"kind": "sun-frame", "pitch_deg": 35, "clock_deg": 90}
    sail = {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 0.2}
    both = simulate(scene(sail, {**sail, "steering": frame}) | sky)
    turned = simulate(scene(sail) | sky | {"steering": frame})
    second = both.devices["solar-sail 2"]
    assert 0.05 < np.mean(second.magnitude == 0.0) < 0.45
    at_start = slice(0, 5)  # before the paths part
    np.testing.assert_allclose(
        second.acceleration[at_start], turned.thrust.acceleration[at_start], rtol=1e-4, atol=1e-12
    )


def test_an_electric_sail_beside_feels_the_wind_and_the_solar_sail_does_not() -> None:
    wind = {"kind": "gamma", "redraw_d": 10, "shape": 3, "scale_nPa": 0.7, "seed": 4}
    electric = {"kind": "electric-sail", "characteristic_acceleration_mm_s2": 0.3, "steering": TURNED}
    run = simulate(scene(SAIL, electric) | {"environment": {"solar_wind": wind}})
    r = np.linalg.norm(run.position, axis=1)
    steady = run.devices["solar-sail"].magnitude * r**2
    np.testing.assert_allclose(steady, steady[0], rtol=1e-12)
    blown = run.devices["electric-sail"].magnitude * r
    assert np.std(blown) > 0.05 * np.mean(blown)
    assert "solar_wind_pressure_Pa" in run.environment


def test_a_single_device_is_what_it_was() -> None:
    resolved = load_scene(scene(SAIL) | {"device": SAIL}).resolved()
    assert isinstance(resolved["device"], dict)
    assert not {"name", "steering"} & set(resolved["device"])
