"""Wheels, satellites and thrusters: directions of the tethers, where things are."""

import numpy as np
import pytest

from sailviz.shapes import tethers


def turned_x(quaternions):
    """The x axis turned by rotations about z, xyzw."""
    z, w = quaternions[:, 2], quaternions[:, 3]
    return np.stack([w**2 - z**2, 2 * z * w, 0 * z], 1)


@pytest.mark.parametrize("count", [16, 24])
def test_the_turns_of_a_wheel_lay_the_x_axis_along_its_tethers(count):
    out = tethers.spokes(count)
    assert np.allclose(turned_x(tethers.spoke_quaternions(count)), out)
    assert np.allclose(out.sum(axis=0), 0)


def test_the_nozzle_of_a_thruster_opens_against_the_thrust():
    nozzle = tethers.thruster_nozzle()
    low, high = nozzle.vertices[:, 2].min(), nozzle.vertices[:, 2].max()
    width = {z: np.linalg.norm(nozzle.vertices[nozzle.vertices[:, 2] == z, :2], axis=1).max() for z in (low, high)}
    assert low < high <= -0.5 * 0.46
    assert width[low] > width[high]


def test_panels_stand_on_both_sides_of_the_bus_without_touching_it():
    for bus, panels, axis in (
        (tethers.satellite_bus(), tethers.satellite_panels(), 1),
        (tethers.thruster_bus(), tethers.thruster_panels(), 0),
    ):
        assert panels.centroid == pytest.approx([0, 0, 0], abs=1e-12)
        assert np.abs(panels.vertices[:, axis]).min() > bus.vertices[:, axis].max()
