"""Wheels of electric sails as bodies, in flight: drift of the spin, thrust lost, what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz import load_scene, simulate
from sailviz.errors import SceneError
from sailviz.propulsion.esail_wheel import wheel_force

HARDWARE = {"tethers": 20, "tether_length_km": 15, "voltage_kV": 20, "mass_kg": 300}
SPIN = {"spin_period_min": 30, "tip_mass_kg": 1}
SIGMA = 0.18 * 19e3 * np.sqrt(8.8541878128e-12 * 2e-9)  # N/m at 1 au: (3.41)


def scene(wheel: dict | None, days: float = 100.0, pitch: float = 30.0, outputs: int = 11, **more: object) -> dict:
    found = {
        "title": "a wheel",
        "start": {"kind": "circular", "radius_au": 1},
        "device": {"kind": "electric-sail", **HARDWARE} | ({} if wheel is None else {"wheel": wheel}),
        "steering": {"kind": "orbital", "pitch_deg": abs(pitch), "clock_deg": 90 if pitch > 0 else 270},
        "propagation": {"duration_d": days, "outputs": outputs, "tolerance": 1e-12},
    }
    return found | more


def test_a_flat_wheel_flies_as_the_electric_sail_of_today():
    one, other = (simulate(load_scene(scene(wheel))) for wheel in ({}, None))
    size = other.thrust.magnitude.max()
    np.testing.assert_allclose(one.thrust.acceleration[0], other.thrust.acceleration[0], rtol=0, atol=1e-12 * size)
    np.testing.assert_allclose(one.position, other.position, rtol=0, atol=2)


@pytest.mark.parametrize("hold", [True, False])
def test_a_coned_wheel_pushes_as_its_formula_says(hold):
    run = simulate(load_scene(scene({"cone_deg": 5, "hold": hold}, 50, 45)))
    force, torque, share = wheel_force(float(np.radians(5)), np.radians(45), held=hold)
    distance = np.linalg.norm(run.position, axis=1) / 149_597_870_700.0
    a_c = 20 * 15e3 * SIGMA / 300
    np.testing.assert_allclose(run.thrust.magnitude, a_c / distance * np.linalg.norm(force), rtol=1e-12)
    np.testing.assert_allclose(
        run.environment["wheel_torque_N_m"], 20 * SIGMA * 15e3**2 * torque / distance, rtol=1e-12
    )
    assert ("modulation" in run.environment) == hold
    if hold:
        np.testing.assert_allclose(run.environment["modulation"], share, rtol=1e-12)
        np.testing.assert_allclose(run.environment["thrust_lost"], 1 - 0.843275128, atol=6e-10)


@pytest.mark.parametrize(("pitch", "clock"), [(20, 90), (20, 270), (35, 90), (40, 40)])
def test_a_spin_drifts_by_the_way_round_the_sun(pitch, clock):
    """tan(pitch) sin(clock) for each radian, in the plane that the sail turns."""
    planned = scene(SPIN, 300, pitch, 301)
    planned["steering"]["clock_deg"] = clock
    run = simulate(load_scene(planned))
    r, v = run.position, run.velocity
    rate = np.linalg.norm(np.cross(r, v), axis=1) / np.sum(r * r, axis=1)
    steps = 0.5 * (rate[1:] + rate[:-1]) * np.diff(run.time)
    slopes = np.gradient(rate, run.time)
    steps -= np.diff(slopes) * np.diff(run.time) ** 2 / 12  # Euler and Maclaurin
    drift = np.tan(np.radians(pitch)) * np.sin(np.radians(clock)) * steps.sum()
    spin = run.environment["spin_rate_rad_s"]
    assert spin[0] == pytest.approx(2 * np.pi / 1800, rel=1e-12)
    assert np.log(spin[-1] / spin[0]) == pytest.approx(drift, rel=2e-7)
    assert "drift of the wheel's spin" in run.setting.accuracy
    assert np.all(run.mass == 300)


def test_the_voltage_of_a_wheel_that_winds_itself_up_is_used_up_at_an_event():
    """The event is where the swing passes 1, and the flight may end there; what only turns the axis is 2 Om I s over
    N sigma L^2 cos(pitch) / 2."""
    planned = scene(SPIN | {"tip_mass_kg": 6}, 700, 40, 141)
    planned["event"] = [{"modulation": 1.0, "stop": True, "name": "no more"}]
    run = simulate(load_scene(planned))
    assert run.ended == "no more"
    assert [event.name for event in run.events].count("tethers-saturated") == 1
    swing = run.environment["modulation"]
    assert swing[-1] == pytest.approx(1, abs=1e-9)
    assert np.all(np.diff(swing) > 0)
    r, v = run.position, run.velocity
    rate = np.linalg.norm(np.cross(r, v), axis=1) / np.sum(r * r, axis=1)
    lever = 20 * SIGMA * 149_597_870_700.0 / np.linalg.norm(r, axis=1) * 15e3**2 / 2
    inertia = 20 * 6 * 15e3**2
    asked = 2 * rate * inertia * run.environment["spin_rate_rad_s"] / (lever * np.cos(np.radians(40)))
    np.testing.assert_allclose(swing, asked, rtol=1e-11)


@pytest.mark.parametrize(
    ("planned", "words"),
    [
        (scene({"cone_deg": 30}, pitch=70), "1 is all"),
        (scene({"cone_deg": 3, "rise": 0.1}), "two ways to bend"),
        (scene({"spin_period_min": 3}), "belong together"),
        (scene({}, pitch=89), "no voltage holds"),
        (scene(None, event=[{"modulation": 0.5}]), "electric sail with a wheel"),
        (scene({}, event=[{"spin_rate_rad_s": 0.5}]), "spin_period"),
        (scene(SPIN, steering={"kind": "meridian", "pitch_deg": 20, "clock_deg": 90}), "keep their angles"),
        (scene({}, steering={"kind": "optimal", "costates": [0.1, 0.2, 0.3]}), "flat wheel"),
        (
            scene({}, device={"kind": "electric-sail", "characteristic_acceleration_mm_s2": 1, "wheel": {}}),
            "needs the hardware",
        ),
        (scene({}, device={"kind": "electric-sail", **HARDWARE, "model": "updated", "wheel": {}}), "final"),
    ],
)
def test_what_does_not_go_with_a_wheel_is_told(planned, words):
    with pytest.raises(SceneError, match=words):
        simulate(load_scene(planned))
