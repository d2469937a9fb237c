"""Descents through the whole environment, propagated: times against an independent integration and the quadrature, each
force against its closed form in the rows of a run, and what is refused."""

from __future__ import annotations

import time

import numpy as np
import pytest

import sailviz
from sailviz.constants import (
    ATOMIC_MASS,
    DAY,
    ELEMENTARY_CHARGE,
    MASS_ELECTRON,
    MU_EARTH,
    RADIUS_EARTH,
    VACUUM_PERMITTIVITY,
    YEAR,
)
from sailviz.design import decay
from sailviz.environment.eclipse import circular_fraction
from sailviz.errors import SceneError

REAL = {"j2": True, "corotation": True, "height_above": "ellipsoid", "ionosphere": {"kind": "iri-2020"}}
AT_500 = {"kind": "mean-altitude", "altitude_km": 500, "sense": "down", "stop": True, "name": "500 km"}
CUBESAT = {
    "title": "300 m of tether take 4.5 kg from 700 to 500 km",
    "body": "earth",
    "start": {"kind": "circular", "mean_altitude_km": 700, "inclination_deg": 97.8, "ltan_h": 12},
    "device": {"kind": "plasma-brake", "tether_length_m": 300, "mass_kg": 4.5},
    "environment": {"solar_flux_sfu": 193, **REAL},
    "event": [AT_500],
    "propagation": {"duration_d": 400, "output_interval_min": 160},
}
OXYGEN_PLASMA = {"kind": "exponential-density", "density_per_m3": 3e10, "scale_height_km": 200}


def scene(base=CUBESAT, **values):
    return sailviz.load_scene(base, set={key.replace("__", "."): value for key, value in values.items()})


def fly(base=CUBESAT, **values):
    return sailviz.simulate(scene(base, **values))


def days(run, name="500 km"):
    return next(event.time for event in run.events if event.name == name) / DAY


def hours(**values):
    """Half a day in rows of a minute, nothing to stop it."""
    return fly(**{"event": [], "propagation": {"duration_h": 12, "output_interval_min": 1}} | values)


# ---------------------------------------------------------------- how long it takes
# Runge-Kutta 4 at 15 s through the same table, written independently; days. Its step leaves 1e-4 of the time.
@pytest.mark.parametrize(
    ("flux", "ltan", "expected"),
    [
        (193, 12, 50.504),
        (193, 18, 50.446),
        (193, 0, 50.251),
        (193, 6, 50.937),
        (145, 12, 104.808),
        (145, 18, 109.352),
        (70, 12, 344.855),
    ],
)
def test_descent_through_the_real_environment(flux, ltan, expected):
    run = fly(environment__solar_flux_sfu=flux, start__ltan_h=ltan)
    assert days(run) == pytest.approx(expected, rel=2e-4)


def test_descent_through_the_table_alone():
    """A sphere that neither is oblate nor turns its plasma: 104.615 d at the medium level, node at the Sun."""
    plain = {"solar_flux_sfu": 145, "ionosphere": {"kind": "iri-2020"}}
    assert days(fly(environment=plain)) == pytest.approx(104.615, rel=2e-4)


@pytest.mark.parametrize(("flux", "expected"), [(70, 347.890), (145, 105.698), (193, 50.805)])
def test_quadrature_through_the_table(flux, expected):
    """By the profile averaged over local time: days."""
    time = decay.decay_time(4.5, 300, 700e3, 500e3, decay.averaged_profile(np.radians(97.8), flux))
    assert time / DAY == pytest.approx(expected, rel=2e-3)


def test_the_step_to_circular_orbits_costs_less_than_two_hundredths_of_a_percent():
    """One profile, propagated and by quadrature."""
    plain = {"ionosphere": {"kind": "exponential-force", "force_per_length_nN_m": 292.2708, "scale_height_km": 488.25}}
    assert days(fly(environment=plain)) == pytest.approx(52.71748, rel=2e-4)


def test_local_time_is_worth_what_it_is():
    """A sun-synchronous orbit keeps its local time: 4 % between noon and dusk at the medium level, a tenth of a percent
    at maximum."""
    noon, dusk = (days(fly(environment__solar_flux_sfu=145, start__ltan_h=hour)) for hour in (12, 18))
    assert dusk / noon == pytest.approx(109.352 / 104.808, rel=2e-4)


def test_half_and_twice_the_plasma_bracket_the_time():
    """f ~ n^0.537 at the reference point."""
    half, twice = (days(fly(environment__ionosphere__density_factor=factor)) for factor in (0.5, 2.0))
    assert half / twice == pytest.approx(4**0.537, rel=0.03)


def test_three_years_to_re_entry_take_seconds():
    """Plasma, air, J2 to J4, co-rotation, ellipsoid, 100 kg from 800 km: 2.976 yr by quadrature over profiles without
    J2, co-rotation and a fixed local time, each worth some percent. Budget of 10 s of one core, all compiled."""
    full = {
        "start__mean_altitude_km": 800,
        "device": {"kind": "plasma-brake", "tether_length_km": 5, "mass_kg": 100, "drag_area_m2": 1},
        "environment": {
            "solar_flux_sfu": 70,
            **REAL,
            "j3": True,
            "j4": True,
            "atmosphere": {"kind": "nrlmsis-2.1", "ap": 5},
        },
        "event": [{"kind": "altitude", "altitude_km": 120, "sense": "down", "stop": True, "name": "re-entry"}],
        "propagation": {"duration_yr": 4, "output_interval_min": 466},
    }
    fly(**full | {"propagation": {"duration_d": 1, "output_interval_h": 1}})
    begin = time.thread_time()
    run = fly(**full)
    assert time.thread_time() - begin < 10
    assert run.ended == "re-entry"
    assert run.time[-1] / YEAR == pytest.approx(2.976, rel=0.05)
    # below 200 km the brake is off, and only the air brakes
    off = next(event for event in run.events if event.name == "brake off")
    assert np.linalg.norm(off.state[:3]) - RADIUS_EARTH == pytest.approx(200e3, abs=1)
    below = run.time > off.time
    assert below.any()
    assert not run.environment["plasma_force_N_m"][below].any()
    assert not run.thrust.on[below].any()
    assert run.environment["air_drag_N"][below].min() > 0
    assert run.environment["plasma_force_N_m"][~below].min() > 0


# ---------------------------------------------------------------- forces in the rows of a run
def test_the_force_of_a_run_is_the_force_law():
    """Co-rotating plasma, vertical tether: f of the horizontal part of the relative velocity."""
    run = hours(environment={"corotation": True, "ionosphere": OXYGEN_PLASMA})
    r, v = run.position, run.velocity
    u = v - np.cross([0, 0, 7.2921159e-5], r)
    up = r / np.linalg.norm(r, axis=1)[:, None]
    across = u - np.sum(u * up, axis=1)[:, None] * up
    speed, n, m = np.linalg.norm(across, axis=1), run.environment["plasma_density_per_m3"], 15.999 * ATOMIC_MASS
    sheath = np.sqrt(VACUUM_PERMITTIVITY * 1000 / (ELEMENTARY_CHARGE * n))
    v_t = 1000 / np.log(sheath / 1e-3)
    thickness = np.sqrt(VACUUM_PERMITTIVITY * v_t / (ELEMENTARY_CHARGE * n))
    law = 3.864 * m * n * speed**2 * thickness * np.exp(-m * speed**2 / (2 * ELEMENTARY_CHARGE * v_t))
    assert run.environment["plasma_force_N_m"] == pytest.approx(law, rel=1e-9)
    push = -300 * law[:, None] / 4.5 * across / speed[:, None]
    assert run.thrust.acceleration == pytest.approx(push, abs=1e-9 * np.abs(push).max())


def test_the_tilt_of_a_run_balances_drag_and_gravity_gradient():
    """tan = F / (6 n^2 (m_tip + m / 3) L); 5 km with 1 kg and 55 g at 0.43 mN and 800 km: 0.7483 deg."""
    craft = {"kind": "plasma-brake", "tether_length_km": 5, "mass_kg": 260, "tip_mass_kg": 1}
    plasma = {"kind": "exponential-force", "force_per_length_nN_m": 86, "scale_height_km": 1e6}
    run = hours(
        device=craft,
        start={"kind": "circular", "altitude_km": 800},
        steering={"kind": "gravity-gradient"},
        environment={"ionosphere": OXYGEN_PLASMA | {"density_per_m3": 3.152e10, "reference_altitude_km": 800}},
    )
    force = run.environment["plasma_force_N_m"][0] * 5e3
    assert force == pytest.approx(0.43e-3, rel=2e-3)
    assert np.degrees(run.environment["tether_tilt_rad"][0]) == pytest.approx(0.7483 * force / 0.43e-3, rel=1e-3)
    with_force = hours(device=craft, steering={"kind": "gravity-gradient"}, environment={"ionosphere": plasma})
    assert "tether_tilt_rad" not in with_force.environment  # a given force has no plasma to say more about


def test_a_spinning_tether_brakes_with_the_mean_of_its_turn():
    """4 / (3 pi) in the plane of motion, all of the force about the velocity."""
    at_rest = {"environment": {"ionosphere": OXYGEN_PLASMA}}
    hanging = hours(**at_rest)
    for plane, share in (("along-track", 4 / (3 * np.pi)), ("across-track", 1.0)):
        run = hours(**at_rest, steering={"kind": "spinning", "plane": plane})
        ratio = run.environment["plasma_force_N_m"][0] / hanging.environment["plasma_force_N_m"][0]
        assert ratio == pytest.approx(share, rel=1e-9)


def test_a_positive_tether_drinks_171_times_the_current():
    """sqrt(m_i / m_e), once the ram of the ions is left out: 22.537 W on 5 km, 0.06 of it here."""
    plasma = {"environment": {"ionosphere": OXYGEN_PLASMA}, "start": {"kind": "circular", "altitude_km": 700}}
    negative, positive = (hours(**plasma, device__polarity=sign).environment for sign in ("negative", "positive"))
    still = np.sqrt(1 + 15.999 * ATOMIC_MASS * MU_EARTH / 7078137 / (2 * ELEMENTARY_CHARGE * 1000))
    ratio = positive["tether_current_A"][0] / negative["tether_current_A"][0] * still
    assert ratio == pytest.approx(np.sqrt(15.999 * ATOMIC_MASS / MASS_ELECTRON), rel=1e-9)
    assert ratio == pytest.approx(171, abs=0.5)
    assert positive["tether_power_W"][0] == pytest.approx(22.537 * 0.06, rel=3e-5)


def test_power_is_never_above_its_limit():
    """20 mW in sunlight, 5 mW in the shadow; where neither binds, the tether is at its full voltage."""
    limits = {"device__power_mW": 20, "device__eclipse": "limited", "device__eclipse_power_mW": 5}
    run = hours(**limits)
    power, lit, volts = (run.environment[k] for k in ("tether_power_W", "sunlit", "tether_voltage_V"))
    assert volts.max() < 0  # of a negative tether
    assert power[lit].max() <= 20e-3 * (1 + 1e-12)
    assert power[~lit].max() <= 5e-3 * (1 + 1e-12)
    bound = volts > -1000
    assert power[bound] == pytest.approx(np.where(lit, 20e-3, 5e-3)[bound], rel=1e-5)
    assert bound.any()
    quiet = hours(**limits, environment__solar_flux_sfu=70)
    free = quiet.environment["tether_voltage_V"] == -1000
    assert (quiet.environment["tether_power_W"][free] < 20e-3).all()
    assert free.any()


@pytest.mark.parametrize("shadow", ["cylinder", "cone"])
def test_a_brake_without_a_battery_rests_in_the_shadow(shadow):
    """Noon-midnight orbit, the Sun in its plane: dark for acos(sqrt(1 - (R / r)^2)) / pi of the time."""
    run = hours(
        device__eclipse="off",
        environment__shadow=shadow,
        environment__sun_right_ascension_deg=0,
        propagation={"duration_d": 5, "output_interval_s": 61},
    )
    lit, force = run.environment["sunlit"], run.environment["plasma_force_N_m"]
    assert 1 - lit.mean() == pytest.approx(circular_fraction(7078137.0, RADIUS_EARTH), abs=2e-3)
    assert not force[~lit].any()
    assert not run.environment["tether_current_A"][~lit].any()
    assert force[lit].min() > 0
    assert not run.thrust.magnitude[~lit].any()


def test_resting_in_the_shadow_costs_less_than_the_night():
    """Of the force, 0.327, 0.394 and 0.411 are made at night (18 to 6 h, 800 km, the three levels): without the night a
    descent takes 1.49, 1.65 and 1.70 times as long, without the shorter shadow less."""
    for flux, most in ((70, 1.49), (145, 1.65), (193, 1.70)):
        lost = []
        for eclipse in ("on", "off"):
            run = hours(
                start__mean_altitude_km=800,
                device__eclipse=eclipse,
                environment__solar_flux_sfu=flux,
                propagation={"duration_d": 3, "output_interval_h": 1},
            )
            high = run.environment["mean_altitude_m"]
            lost.append(high[0] - high[-1])
        assert 1.05 < lost[0] / lost[1] < most


# ---------------------------------------------------------------- what is refused
@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"device__tether_length_km": 501}, "longer than the 500 km between the orbit and where the brake goes off"),
        ({"device__voltage_kV": -1, "device__polarity": "positive"}, "give one sign only"),
        ({"device__voltage_kV": 0}, "makes no brake"),
        ({"start__mean_altitude_km": 1600}, 'above_table = "hold" keeps its last value'),
        ({"environment__solar_flux_sfu": 69}, "from 70 to 193 sfu"),
        ({"environment__solar_flux_sfu": 230}, "from 70 to 193 sfu"),
        ({"environment": REAL}, "tables need the sun's level"),
        ({"propagation": {"duration_yr": 300}}, "292 years"),
        ({"environment": {}}, "needs an ionosphere"),
        ({"device__eclipse": "limited"}, "belong together"),
        ({"steering": {"kind": "gravity-gradient"}}, "mass at its tip"),
    ],
)
def test_what_cannot_be_flown_is_refused_with_its_reason(values, sentence):
    with pytest.raises(SceneError, match=sentence):
        scene(**values)


def test_centuries_of_drag_are_left_to_the_quadrature():
    """Drag alone from 700 km at solar minimum: 597.8 yr. A recording's clock ends before; the quadrature answers."""
    drag = {
        "title": "air alone",
        "body": "earth",
        "start": {"kind": "circular", "altitude_km": 700},
        "device": {"kind": "none", "mass_kg": 4.5, "drag_area_m2": 0.03},
        "environment": {"solar_flux_sfu": 70, "atmosphere": {"kind": "nrlmsis-2.1", "ap": 5}},
        "propagation": {"duration_yr": 598, "output_interval_d": 10},
    }
    with pytest.raises(SceneError, match=r"292 years .* sailviz\.design\.decay"):
        scene(drag)


def test_above_the_table_its_last_value_holds_if_asked():
    run = hours(start__mean_altitude_km=1600, environment__ionosphere__above_table="hold")
    assert run.environment["plasma_density_per_m3"].min() > 0
    assert not run.environment["force_law_valid"].any()
