"""How bright the light is: a choice that a scene states, for sails whose area and mass make their acceleration."""

from __future__ import annotations

import numpy as np
import pytest

import sailviz
from sailviz.constants import RADIATION_PRESSURE
from sailviz.errors import SceneError

SAIL = {
    "title": "a hundred square metres",
    "start": {"kind": "circular", "radius_au": 1},
    "device": {"kind": "solar-sail", "area_m2": 100, "mass_kg": 2},
    "propagation": {"duration_d": 1, "outputs": 3},
}


def thrust(**light):
    """m/s2 at the start, facing the Sun at 1 au."""
    return sailviz.simulate(SAIL | light).thrust.magnitude[0]


def test_the_thesis_pressure_is_the_default_and_can_be_said():
    assert thrust() == pytest.approx(2 * 4.563e-6 * 100 / 2, rel=1e-15)
    assert thrust(light={"pressure_uN_m2": 4.563}) == pytest.approx(thrust(), rel=1e-15)
    assert thrust(light={"pressure_nPa": 9126}) == pytest.approx(2 * thrust(), rel=1e-14)


def test_an_irradiance_over_the_speed_of_light_is_a_pressure():
    assert thrust(light={"irradiance_W_m2": 1360.96}) == pytest.approx(2 * 1360.96 / 299792458 * 50, rel=1e-15)
    assert thrust(light={"irradiance_W_m2": 1360.96}) / thrust() == pytest.approx(1 - 0.0051, abs=1e-4)
    assert pytest.approx(1367.95, abs=0.01) == RADIATION_PRESSURE * 299792458


def test_the_recording_says_which_light_it_was():
    said = dict(sailviz.simulate(SAIL).setting.parameters)
    assert said["radiation pressure"] == "4.563 µN/m² at 1 au"
    other = dict(sailviz.simulate(SAIL | {"light": {"irradiance_W_m2": 1360.96}}).setting.parameters)
    assert other["radiation pressure"] == "4.53967 µN/m² at 1 au"


def test_a_scene_without_light_is_what_it_was():
    plain = sailviz.load_scene(SAIL)
    assert "light" not in plain.resolved()
    assert sailviz.load_scene(SAIL | {"light": {"pressure_uN_m2": 4.563}}).identity() != plain.identity()


@pytest.mark.parametrize(
    ("values", "word"),
    [
        ({"light": {"pressure_uN_m2": 4.5, "irradiance_W_m2": 1361}}, "exactly one of pressure or irradiance"),
        ({"light": {}}, "needs a kind, a pressure or an irradiance"),
        ({"light": {"irradiance_W_m2": -1}}, "greater than 0"),
        ({"light": {"irradiance": 1361}}, "irradiance_W_m2"),
        ({"light": {"irradiance_W_m2": np.nan}}, "finite"),
        ({"light": {"irradiance_W_m2": 1361}, "device": {"kind": "none"}}, "acts on a solar sail that gives its area"),
        (
            {"light": {"irradiance_W_m2": 1361}, "device": {"kind": "solar-sail", "lightness_number": 0.1}},
            "acts on a solar sail that gives its area",
        ),
    ],
)
def test_a_light_that_says_nothing_or_too_much_is_refused(values, word):
    with pytest.raises(SceneError, match=word):
        sailviz.load_scene(SAIL | values)
