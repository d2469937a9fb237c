"""Every physical key carries its unit: any unit of the right dimension, SI once loaded."""

from __future__ import annotations

import copy

import numpy as np
import pytest

from sailviz.scene.loading import load_scene
from sailviz.simulation.plan import plan

from .small import SMALL, faults, with_parts


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ({"radius_au": 1}, {"radius_km": 149597870.7}),
        ({"radius_au": 1}, {"radius_m": 149_597_870_700}),
        ({"radius_earth_radii": 200}, {"radius_km": 1275627.4}),
    ],
)
def test_every_spelling_of_a_length_is_the_same_length(one, other):
    first, second = (load_scene(with_parts(start={"kind": "circular", **start})) for start in (one, other))
    assert first.start.radius == pytest.approx(second.start.radius, rel=1e-15)


def test_one_scene_in_many_units_is_one_flight():
    """Degrees and radians, years and seconds, kilovolts and volts: the same model to the last digits of float."""
    many = {
        "title": "units",
        "start": {"kind": "circular", "radius_au": 1, "inclination_deg": 90},
        "device": {
            "kind": "electric-sail",
            "tethers": 100,
            "tether_length_km": 20,
            "voltage_kV": 20,
            "mass_t": 1,
            "wind_pressure_nPa": 2,
        },
        "steering": {"kind": "orbital", "pitch_deg": 30, "clock_deg": 180},
        "propagation": {"duration_yr": 2},
    }
    si = copy.deepcopy(many)
    si["start"] = {"kind": "circular", "radius_m": 149_597_870_700, "inclination_rad": np.pi / 2}
    si["device"] = {
        "kind": "electric-sail", "tethers": 100, "tether_length_m": 20e3, "voltage_V": 20e3, "mass_kg": 1000,
        "wind_pressure_Pa": 2e-9,
    }  # fmt: skip
    si["steering"] = {"kind": "orbital", "pitch_rad": np.pi / 6, "clock_rad": np.pi}
    si["propagation"] = {"duration_s": 63_115_200}
    one, other = plan(load_scene(many)), plan(load_scene(si))
    named, others = (p.model.named._replace(places=(), callbacks=()) for p in (one, other))  # no addresses
    for values, same in zip(named, others, strict=True):
        assert values == pytest.approx(same, rel=1e-15)
    assert np.array_equal(one.model.tables, other.model.tables)
    assert np.array_equal(one.position, other.position)
    assert one.scene.propagation.duration == other.scene.propagation.duration


def test_a_quantity_without_its_unit_is_told_its_units():
    found = faults(with_parts(start={"kind": "circular", "radius": 1}))
    assert "needs its unit" in found["start.radius"]
    assert "radius_au" in found["start.radius"]


def test_a_quantity_in_two_units_is_refused():
    assert (
        "second time"
        in faults(with_parts(start={"kind": "circular", "radius_au": 1, "radius_km": 1}))["start.radius_km"]
    )


def test_limits_are_told_in_the_unit_of_the_file():
    found = faults(with_parts(steering={"kind": "orbital", "pitch_deg": 200}))
    assert found["steering.pitch_deg"].startswith("must be at most 180 deg, is 200")


def test_another_unit_replaces_the_one_in_the_file():
    scene = load_scene(SMALL)
    changed = scene.with_values({"start.radius_km": 3e8, "propagation.duration_yr": 1})
    assert changed.start.radius == 3e11
    assert changed.propagation.duration == 365.25 * 86400
    assert scene.start.radius == 149_597_870_700.0
    assert changed.with_values({"start.radius_au": 1}).start == scene.start


def test_values_inside_lists_can_be_set():
    scene = load_scene("displaced/circular")
    assert scene.with_values({"expect.1.value": 3}).expect[1].value == 3
    assert list(faults("displaced/circular", set={"expect.99.value": 3})) == ["expect.99.value"]
