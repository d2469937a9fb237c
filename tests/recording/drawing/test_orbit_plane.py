"""What lies in the plane of a low orbit."""

import numpy as np

from sailviz.frames import unit
from sailviz.recording import read
from sailviz.recording.drawing import orbit_plane


def test_a_map_lies_in_the_plane_of_the_orbit_at_its_altitudes_and_angles(years, low_orbit):
    run, path = years
    shell = run.setting.shells[0]
    mesh = read(path)["/world/plane/shells/plasma_density"]
    corners = np.asarray(mesh["vertex_positions"], float).reshape(49, 31, 3)  # the circle is closed
    axes = orbit_plane.plane_axes(run)[0]
    placed = corners @ axes.T
    radius = 1 + shell.altitude / low_orbit.RADIUS
    assert np.abs(np.linalg.norm(placed, axis=-1) - radius).max() < 1e-6
    assert np.abs(placed @ shell.normal).max() < 1e-6
    quarter = np.cross(shell.normal, shell.reference)
    assert np.abs(placed[0] - radius[:, None] * shell.reference).max() < 1e-6
    assert np.abs(placed[12] - radius[:, None] * quarter).max() < 1e-6
    assert np.abs(placed[48] - placed[0]).max() < 1e-6
    share = orbit_plane.shares(shell.value)
    assert share[0, 8] > share[24, 8] > 0  # noon, midnight
    assert share.max() == 1


def test_the_plane_faces_the_sun_as_it_turns(years):
    run, _ = years
    axes = orbit_plane.plane_axes(run)
    sun = unit(run.bodies["Sun"])
    assert np.sum(axes[..., 0] * sun, 1).min() > 0
    assert np.abs(np.sum(axes[..., 1] * sun, 1)).max() < 1e-12
    assert np.abs(np.linalg.det(axes) - 1).max() < 1e-12
