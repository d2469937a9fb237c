"""The analytic decay beside the propagated one: closed form, quadrature, and agreement where theory promises it."""

from __future__ import annotations

import numpy as np
import pytest

import sailviz
from sailviz.constants import DAY, RADIUS_EARTH
from sailviz.design import decay
from sailviz.errors import SceneError

FORCE = {"kind": "exponential-force", "force_per_length_nN_m": 292.2708, "scale_height_km": 488.25}
DENSITY = {"kind": "exponential-density", "density_per_m3": 3e11, "scale_height_km": 300}
DESCENT = {
    "title": "a CubeSat comes down",
    "body": "earth",
    "start": {"kind": "circular", "mean_altitude_km": 700, "inclination_deg": 97.8},
    "device": {"kind": "plasma-brake", "tether_length_m": 300, "mass_kg": 4.5},
    "environment": {"ionosphere": DENSITY},
    "approximation": [{"kind": "quasi-circular"}],
    "propagation": {"duration_d": 20, "output_interval_min": 98},
}
SPIN = {"kind": "spinning", "plane": "along-track"}
TURNING = {"environment__corotation": True, "start__inclination_deg": 20}
EVERYTHING = {"j2": True, "corotation": True}


def fly(**values):
    return sailviz.simulate(sailviz.load_scene(DESCENT, set={k.replace("__", "."): v for k, v in values.items()}))


def lost(run):
    """Altitude lost by propagation and by quadrature, m."""
    return [
        column[0] - column[-1] for column in map(run.environment.get, ("mean_altitude_m", "quasi_circular_altitude_m"))
    ]


def test_the_recorded_decay_is_dawsons_integral():
    """Exponential force: the altitude after t takes t to reach, to the precision of the interpolation."""
    run = fly(environment__ionosphere=FORCE)
    altitude = run.environment["quasi_circular_altitude_m"]
    for i in (200, -1):
        time = decay.exponential_decay_time(4.5, 300, 700e3, altitude[i], 292.2708e-9, 488.25e3)
        assert time == pytest.approx(run.time[i], rel=1e-6)


@pytest.mark.parametrize(
    ("law", "values", "within"),
    [
        (FORCE, {}, 2e-6),
        (FORCE, TURNING, 2e-3),
        (FORCE, {"environment__j2": True}, 1e-3),
        (DENSITY, {}, 2e-6),
        (DENSITY, {"steering": SPIN}, 2e-6),
        (DENSITY, TURNING, 2e-3),
        (DENSITY, {"environment__j2": True}, 1e-3),
    ],
)
def test_propagation_and_quadrature_lose_the_same_altitude(law, values, within):
    """A plain profile has no more to it: the step to circular orbits alone is below 1e-6. Co-rotation is taken at mean
    cos^2 of the latitude, J2 at the mean radius to first order."""
    propagated, quadrature = lost(fly(**{"environment__ionosphere": law} | values))
    assert quadrature == pytest.approx(propagated, rel=within)


def test_the_ionosphere_table_is_averaged_for_the_orbit():
    """Three weeks at solar maximum, everything on: within 2 %, most of it the fixed local time."""
    around = {"kind": "iri-2020"}
    for height in ("sphere", "ellipsoid"):
        run = fly(
            environment=EVERYTHING | {"ionosphere": around, "solar_flux_sfu": 193, "height_above": height},
            start__ltan_h=12,
        )
        propagated, quadrature = lost(run)
        assert quadrature == pytest.approx(propagated, rel=0.02)
        denser = fly(
            environment=EVERYTHING
            | {"ionosphere": around | {"density_factor": 2.0}, "solar_flux_sfu": 193, "height_above": height},
            start__ltan_h=12,
        )
        assert lost(denser)[1] / quadrature == pytest.approx(lost(denser)[0] / propagated, rel=0.01)


def test_drag_alone_and_its_end_are_analytic_too():
    """A sphere in exponential air that stands still against the stars, until the quadrature's 120 km."""
    air = {"kind": "exponential", "density_kg_m3": 1e-12, "reference_altitude_km": 400, "scale_height_km": 60}
    run = fly(
        device={"kind": "none", "mass_kg": 100, "drag_area_m2": 3},
        environment={"atmosphere": air},
        start={"kind": "circular", "altitude_km": 400},
        propagation={"duration_d": 300, "output_interval_h": 3},
        event=[{"kind": "altitude", "altitude_km": 120, "sense": "down", "stop": True}],
    )
    analytic = run.environment["quasi_circular_altitude_m"]
    high = run.environment["mean_altitude_m"] > 300e3
    assert analytic[high] == pytest.approx(run.environment["mean_altitude_m"][high], abs=30)
    end = decay.descend(100, 0, 400e3, 120e3, None, drag_area=6.6, air=lambda h: 1e-12 * np.exp((400e3 - h) / 60e3))
    assert run.time[-1] == pytest.approx(end.duration, rel=2e-3)
    assert np.isnan(analytic[run.time > end.duration]).all()


def test_the_start_counts_from_its_mean_semi_major_axis():
    """A start given by its osculating radius under J2 lies kilometres off in the mean."""
    run = fly(
        environment=EVERYTHING | {"ionosphere": DENSITY},
        start={"kind": "circular", "radius_km": 7078.137, "inclination_deg": 97.8},
    )
    first = run.environment["quasi_circular_altitude_m"][0]
    assert first == pytest.approx(run.environment["mean_altitude_m"][0], abs=1e-3)
    assert abs(first - (7078137.0 - RADIUS_EARTH)) > 5e3
    assert run.time[-1] == pytest.approx(20 * DAY, abs=98 * 60)


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"device.eclipse": "off"}, "full voltage"),
        ({"device.polarity": "positive"}, "full voltage"),
        ({"device.power_W": 0.01}, "full voltage"),
        ({"environment.magnetic_sensitivity": 0.3}, "no magnetic field"),
        ({"start": {"kind": "elements", "semi_major_axis_km": 7000, "eccentricity": 0.01}}, "circular"),
        ({"device": {"kind": "none"}, "environment": {}}, "brake or the drag"),
        ({"device.active_d": [[1, 2]]}, "always on"),
        ({"approximation": [{"kind": "quasi-circular"}] * 2}, "stands twice"),
        ({"approximation": [{"kind": "quasicircular"}]}, 'Did you mean "quasi-circular"'),
    ],
)
def test_what_the_quadrature_cannot_know_is_refused(values, reason):
    with pytest.raises(SceneError, match=reason):
        sailviz.load_scene(DESCENT, set=values)


def test_a_descent_that_is_none_is_refused():
    values = {"device.off_below_km": 700.5}
    with pytest.raises(SceneError, match="no quasi-circular descent"):
        sailviz.simulate(sailviz.load_scene(DESCENT, set=values))
