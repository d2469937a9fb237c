"""Wheels, satellites and thrusters: directions of the tethers, where things are."""

import numpy as np
import pytest

from sailviz.frames import rotation
from sailviz.shapes import tethers


@pytest.mark.parametrize(("count", "slope"), [(16, 0.0), (24, 0.0), (24, 0.3)])
def test_the_turns_of_a_wheel_lay_the_x_axis_along_its_tethers(count, slope):
    out = tethers.spokes(count)
    along = np.cos(slope) * out + [0.0, 0.0, np.sin(slope)]
    assert np.allclose(rotation(tethers.spoke_quaternions(count, slope))[..., 0], along)
    assert np.allclose(out.sum(axis=0), 0)


@pytest.mark.parametrize(("cone", "rise"), [(0.0, 0.0), (0.05, 0.0), (0.0, 0.02), (0.0, 0.8)])
def test_a_bent_tether_is_as_long_as_a_straight_one(cone, rise):
    pieces = np.diff(tethers.bent(cone, rise), axis=0)
    assert np.linalg.norm(pieces, axis=1).sum() == pytest.approx(1.0, abs=1e-3)  # chords of an arc
    reach, depth = tethers.bent(cone, rise)[-1]
    assert depth / reach == pytest.approx(rise or np.tan(cone))


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
