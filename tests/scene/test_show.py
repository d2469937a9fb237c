"""`sailviz show`: whatever a scene may say is shown with its unit."""

from sailviz import load_scene
from sailviz.figures.recorded_curves import USUAL
from sailviz.scene import show
from sailviz.scene.quantities import DIMENSIONS
from sailviz.units import UNITS


def test_every_dimension_has_a_unit_in_which_it_is_shown_and_one_in_which_it_is_drawn():
    assert set(UNITS) - set(show._SI) == {"none"}
    assert set(DIMENSIONS.values()) <= set(USUAL)


def test_what_a_sail_bears_and_how_its_wheel_spins_is_shown():
    hot = "\n".join(show.resolved_lines(load_scene("body/too-hot")))
    assert "device.hottest" in hot
    assert "520 K" in hot
    spins = "\n".join(show.resolved_lines(load_scene("body/e-sail-spin")))
    assert "device.wheel.spin_period" in spins
