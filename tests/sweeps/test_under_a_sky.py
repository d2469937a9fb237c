"""Sweeps of flights under a sky: each is the flight that the scene itself would be, and shadow falls where it does."""

from pathlib import Path

import numpy as np
import pytest

import sailviz
from sailviz.constants import AU, RADIUS_EARTH, RADIUS_SUN
from sailviz.recording import export

ELEMENT_SETS = Path(__file__).parents[1] / "data" / "foreign" / "tle_made_up.txt"
ASIDE = {"kind": "sun-frame", "pitch_deg": 35.0, "clock_deg": 90.0}
SAIL = {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 0.1}
GEO = {"kind": "cartesian", "position_km": [42_164.169, 0.0, 0.0], "velocity_km_s": [0.0, 2.6627, 1.5373]}


def scene(**more):
    found = {
        "title": "In its sky",
        "body": "earth",
        "epoch": "2026-03-20T00:00:00",
        "start": GEO,
        "device": SAIL,
        "steering": ASIDE,
        "environment": {"gravity_of": ["moon", "sun"]},
        "propagation": {"duration_d": 2.0, "outputs": 60},
    } | more
    return {key: value for key, value in found.items() if value is not None}


MARS_CIRCLE = {"kind": "cartesian", "position_km": [20_427.7, 0.0, 0.0], "velocity_km_s": [0.0, 1.2, 0.7]}
SCENES = {
    "gravity and light": scene(),
    "kernel frame and shadows": scene(
        frame="icrf",
        ephemeris="de421",
        environment={"gravity_of": ["moon", "sun"], "shadow_of": ["earth", "moon"]},
    ),
    "magnetopause": scene(device={"kind": "electric-sail", "characteristic_acceleration_mm_s2": 0.3}),
    "phases": scene(
        phase=[{"name": "a", "until": "radius_km = 42200"}, {"name": "b", "device": {"on": False}}],
    ),
    "devices": scene(
        steering=None,
        device=[
            SAIL | {"steering": ASIDE},
            {
                "kind": "thruster",
                "acceleration_mm_s2": 0.05,
                "steering": {"kind": "orbital", "pitch_deg": 90.0, "clock_deg": 90.0},
            },
        ],
    ),
    "round Mars": scene(body="mars", environment={"gravity_of": ["sun"]}, start=MARS_CIRCLE),
    "from a planet": scene(
        body="sun",
        start={"kind": "from-planet", "planet": "mars", "c3_km2_s2": 4.0},
        environment={"gravity_of": ["venus", "earth"]},
        steering={"kind": "radial"},
        propagation={"duration_d": 100.0, "outputs": 60},
    ),
}
AT_THE_END = ("radius_km", "semi_major_axis_km", "inclination_deg", "speed_km_s")


def at_the_end(flown, name):
    """One quantity at the end of a run, by its own columns."""
    if name == "radius_km":
        return np.linalg.norm(flown.position[-1]) / 1e3
    if name == "speed_km_s":
        return np.linalg.norm(flown.velocity[-1]) / 1e3
    if name == "semi_major_axis_km":
        return flown.elements.semi_major_axis[-1] / 1e3
    return np.degrees(flown.elements.inclination[-1])


@pytest.mark.parametrize("name", SCENES)
def test_a_draw_without_spread_is_the_flight_itself(name):
    given = SCENES[name]
    alone = sailviz.simulate(given)
    days = given["propagation"]["duration_d"]
    found = sailviz.sweep(
        given,
        {"propagation.duration_d": f"normal({days}, 0)"},
        draws=2,
        report=[f"{quantity}@end" for quantity in AT_THE_END],
        engine="serial",
    )
    assert list(found.table["reason"]) == ["", ""]
    for quantity in AT_THE_END:
        expected = at_the_end(alone, quantity)
        assert list(found.table[f"{quantity}@end"]) == pytest.approx([expected] * 2, rel=1e-14)


def test_starts_out_of_files_fly_in_other_processes_too(tmp_path):
    """The files lie beside the scene, wherever a worker runs."""
    alone = sailviz.simulate(SCENES["gravity and light"])
    export(alone, tmp_path / "before.oem")
    (tmp_path / "sat.tle").write_text(ELEMENT_SETS.read_text())
    body = (
        'title = "on"\nbody = "earth"\n[device]\nkind = "solar-sail"\ncharacteristic_acceleration_mm_s2 = 0.1\n'
        '[steering]\nkind = "sun-frame"\npitch_deg = 35\nclock_deg = 90\n[environment]\ngravity_of = ["moon", "sun"]\n'
        "[propagation]\nduration_d = 2\noutputs = 60\n[start]\n"
    )
    for start in ('kind = "oem"\nfile = "before.oem"\n', 'kind = "tle"\nfile = "sat.tle"\n'):
        (tmp_path / "on.toml").write_text(body + start)
        itself = sailviz.simulate(tmp_path / "on.toml")
        found = sailviz.sweep(
            tmp_path / "on.toml", {"steering.pitch_deg": [35.0, 60.0]}, report=["radius_km@end"], workers=2
        )
        first, other = found.table["radius_km@end"]
        assert first == pytest.approx(np.linalg.norm(itself.position[-1]) / 1e3, rel=1e-14)
        assert abs(other - first) > 1e-3  # km: another pitch
        if "oem" in start:  # from the first row on it is the flight that was written
            assert np.linalg.norm(itself.position[-1] - alone.position[-1]) < 0.02  # m in 42,164 km


def test_sails_of_scattered_planes_cross_the_shadow_or_pass_beside_it():
    """The far side of a circle stands a sin i above the shadow's axis: against the two cones of the Earth's shadow."""
    radius = 42_164.169
    found = sailviz.sweep(
        {
            "title": "Above the shadow's axis",
            "body": "earth",
            "frame": "ecliptic-j2000",
            "light": {"kind": "circular", "longitude_deg": 0.0, "obliquity_deg": 0.0, "distance_au": 1.0},
            "start": {
                "kind": "elements",
                "semi_major_axis_km": radius,
                "eccentricity": 0.0,
                "inclination_deg": 0.0,
                "raan_deg": 90.5,  # half a day on, the Sun has come to 0.5 deg
                "true_anomaly_deg": -90.0,
            },
            "device": SAIL | {"characteristic_acceleration_mm_s2": 1e-6},
            "steering": ASIDE | {"pitch_deg": 0.0},
            "environment": {"shadow_of": ["earth"]},
            "propagation": {"duration_h": 23.9, "outputs": 2869},
        },
        {"start.inclination_deg": "uniform(0, 17.4)"},
        draws=25,
        seed=3,
        report=["sunlit_fraction@min"],
        engine="serial",
    )
    inclination = np.radians(np.array(found.table["start.inclination_deg"], float))
    lit = np.array(found.table["sunlit_fraction@min"], float)
    height, behind = 1e3 * radius * np.sin(inclination), 1e3 * radius * np.cos(inclination)
    umbra = RADIUS_EARTH - behind * (RADIUS_SUN - RADIUS_EARTH) / AU
    penumbra = RADIUS_EARTH + behind * (RADIUS_SUN + RADIUS_EARTH) / AU
    assert np.all(lit[height < 0.999 * umbra] == 0)
    assert np.all(lit[height > 1.001 * penumbra] == 1)
    partly = (height > 1.001 * umbra) & (height < 0.999 * penumbra)
    assert np.all((lit[partly] > 0) & (lit[partly] < 1))
    assert min(np.sum(height < umbra), np.sum(height > penumbra)) >= 8
