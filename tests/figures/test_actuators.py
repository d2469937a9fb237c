"""Figures of what turns a craft: against the physics document's rows and closed forms."""

import numpy as np
import pytest

pytest.importorskip("matplotlib")

from sailviz import figures
from sailviz.constants import AU, MU_SUN
from sailviz.figures import actuators
from sailviz.propulsion.electric_sail import characteristic_acceleration


def test_a_vane_and_a_patch_turn_a_sail_as_much_as_a_plate_on_an_arm_does():
    tilted, flat = actuators.vane_torques(0.0, np.radians([30.0, 0.0]))[0]  # of the vane on +x
    assert tilted == pytest.approx([0, -5.621271351970e-5, -2.915537628248e-5], abs=1e-16)
    assert flat == pytest.approx([0, -8.4388122e-5, 0], abs=1e-12)
    for degrees, torque in ((0.0, -8.00459712e-6), (35.0, -2.303875551731e-6)):
        off, on = actuators.patch_torques(np.radians(degrees))[0]  # on x = 9.6 m
        assert on[1] - off[1] == pytest.approx(torque, abs=1e-17)


def test_an_outline_has_the_most_of_all_actuators_in_every_direction():
    torques = actuators.vane_torques(0.3, np.linspace(-actuators.LIMIT, actuators.LIMIT, 61))
    outline = actuators.most_of(torques, (2, 1))
    for way in ([1.0, 0.0], [0.0, 1.0], [-0.6, 0.8]):
        flat = torques[..., [2, 1]] @ way
        assert (outline @ way).max() == pytest.approx(flat.max(axis=1).sum(), rel=1e-3)


def test_lines_are_closed_and_are_the_outlines():
    drawn = figures.figure("torque")
    for axes, plane in zip(drawn.axes, ((0, 1), (2, 1), (0, 1)), strict=True):
        assert len(axes.lines) == len(actuators.INCIDENCES)
        for line in axes.lines:
            x, y = line.get_data()
            assert (x[0], y[0]) == pytest.approx((x[-1], y[-1]), abs=1e-9), plane


def test_the_spin_of_a_wheel_grows_as_the_integrated_rigid_sail_does():
    axes = figures.figure("spin").axes[0]
    lines = {line.get_label(): line.get_data() for line in axes.lines}
    for pitch, degrees, grown in (
        ("+20°", 360, 9.8442982350),
        ("+35°", 180, 9.0229096352),
        ("-20°", 360, 0.1015816441),
    ):
        assert np.interp(degrees, *lines[pitch]) == pytest.approx(grown, rel=1e-9)


def test_the_voltage_holds_the_cone_and_turns_the_spin_at_right_angles_to_each_other():
    pitch, way = np.radians(25.0), np.array([0.0, 3.0])
    count, length, voltage, mass, pressure, potential = actuators.WHEEL
    force = mass * float(characteristic_acceleration(count, length, voltage, mass, pressure, potential))  # N sigma L
    spin = 2 * np.pi / 1800 * np.exp(np.tan(pitch) * way)
    momentum = count * (1.0 + 0.2 / 3) * length**2 * spin
    turning = 2 * np.sqrt(MU_SUN / AU**3) * momentum / (force * length / 2 * np.cos(pitch)) / 2
    cone = 2 * np.tan(np.radians(3)) * np.tan(pitch)
    assert actuators.swing(pitch, way) == pytest.approx(np.hypot(cone, 2 * turning), rel=3e-3)  # cos 3 deg of the arm
