"""A steering, a device and a body that nobody built in fly by their records alone."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
import pytest
from numba import carray

import sailviz
from sailviz.compiled import STATE, layout
from sailviz.constants import AU, MU_SUN
from sailviz.propagate.callbacks import callback
from sailviz.propulsion import devices
from sailviz.scene import device, environment
from sailviz.scene.values import Section
from sailviz.simulation.device import DEVICES, Device
from sailviz.simulation.environment import ENVIRONMENT, Part
from sailviz.simulation.lowered import LoweredDevice, LoweredSteering
from sailviz.simulation.steering import STEERINGS, Steering
from sailviz.steering import attitude


class Nod(NamedTuple):
    """Numbers of the law."""

    amplitude: float  # rad
    rate: float  # rad/s


class Push(NamedTuple):
    """Numbers of the device."""

    size: float  # m/s2 at one au


class Line(NamedTuple):
    """Numbers of the body, a rod along the z axis."""

    strength: float  # m2/s2


NOD, PUSH, LINE = layout(Nod), layout(Push), layout(Line)


def nodding(time, state, parameters, own, number, out):
    """The normal nods about the Sun line, in the meridian plane."""
    s, p, n = carray(state, (STATE,)), carray(own, (1,), NOD)[0], carray(out, (4,))
    r, rho = np.sqrt(s[0] ** 2 + s[1] ** 2 + s[2] ** 2), np.sqrt(s[0] ** 2 + s[1] ** 2)
    pitch = p.amplitude * np.sin(p.rate * time)
    c, k = np.cos(pitch) / r, np.sin(pitch) / (r * rho)
    n[0], n[1], n[2] = c * s[0] - k * s[2] * s[0], c * s[1] - k * s[2] * s[1], c * s[2] + k * rho * rho
    n[3] = 0.5  # at half thrust


def pushing(time, state, parameters, own, number, out):
    """A push along the normal, as 1 / r^3, that costs a gram a second."""
    s, p, a = carray(state, (STATE,)), carray(own, (1,), PUSH)[0], carray(out, (4,))
    r = np.sqrt(s[0] ** 2 + s[1] ** 2 + s[2] ** 2)
    k = number * p.size * (AU / r) ** 3
    a[0], a[1], a[2], a[3] = k * s[7], k * s[8], k * s[9], -1e-3 * number


def attracting(time, state, parameters, own, number, out):
    """The pull of the rod: towards the axis, as 1 / rho."""
    s, p, a = carray(state, (STATE,)), carray(own, (1,), LINE)[0], carray(out, (4,))
    k = -p.strength / (s[0] ** 2 + s[1] ** 2)
    a[0], a[1], a[2], a[3] = k * s[0], k * s[1], 0.0, 0.0


class NoddingSteering(Section):
    kind: Literal["nodding"] = "nodding"
    amplitude: float
    period: float


class PushingDevice(device.Device):
    kind: Literal["thruster"] = "thruster"  # drawn as one
    size: float


class Rod(Section):
    strength: float


class Surroundings(environment.Environment):
    rod: Rod


def _lower_nodding(section, flight):
    numbers = Nod(section.amplitude, 2 * np.pi / section.period)
    return LoweredSteering(attitude.CALLED, callback=callback(nodding, numbers))


def _lower_pushing(section, scene, design):
    return LoweredDevice(devices.CALLED, callback=callback(pushing, Push(section.size)))


@pytest.fixture
def own_kinds(monkeypatch):
    monkeypatch.setitem(
        STEERINGS,
        NoddingSteering,
        Steering(
            _lower_nodding,
            words=lambda section, design: [("amplitude", f"{section.amplitude:g} rad")],
            watches=lambda model, time, states: {"nod_rad": np.sin(time)},
        ),
    )
    monkeypatch.setitem(DEVICES, PushingDevice, Device("Pusher", _lower_pushing))
    lower = Part(lambda part, place: {"forces": (callback(attracting, Line(part.strength)),)})
    monkeypatch.setitem(ENVIRONMENT, Rod, lower)


AMPLITUDE, PERIOD, SIZE, STRENGTH = 0.4, 40 * 86400.0, 1e-4, 4e6
SCENE = {
    "title": "own kinds",
    "start": {
        "kind": "cartesian",
        "position_m": [0.9 * AU, 0.3 * AU, 0.2 * AU],
        "velocity_m_s": [-9e3, 27e3, 4e3],
    },
    "device": {"kind": "thruster", "acceleration_m_s2": 1e-3, "mass_kg": 5000},
    "steering": {"kind": "radial"},
    "propagation": {"duration_d": 60, "outputs": 61, "tolerance": 1e-13},
}


def _flown(times):
    """States (7, n) by SciPy and the formulae as vectors."""
    from scipy.integrate import solve_ivp

    def rates(t, y):
        r, v = y[:3], y[3:6]
        size, rho = np.linalg.norm(r), np.hypot(r[0], r[1])
        up = r / size
        north = np.array([-r[0] * r[2], -r[1] * r[2], rho * rho]) / (size * rho)
        pitch = AMPLITUDE * np.sin(2 * np.pi / PERIOD * t)
        n = np.cos(pitch) * up + np.sin(pitch) * north
        a = -MU_SUN * r / size**3 + 0.5 * SIZE * (AU / size) ** 3 * n
        a -= STRENGTH * np.array([r[0], r[1], 0.0]) / rho**2
        return [*v, *a, -0.5e-3]

    y0 = [*SCENE["start"]["position_m"], *SCENE["start"]["velocity_m_s"], 5000.0]
    return solve_ivp(rates, (0, times[-1]), y0, "DOP853", times, rtol=1e-12, atol=1e-3).y


@pytest.mark.filterwarnings("ignore:Pydantic serializer warnings")  # it knows the kinds of the union alone
def test_kinds_of_ones_own_fly_by_their_records_alone(own_kinds):
    """Against another integrator, within 100 m of 1e11 m: what both leave open at their tolerances."""
    scene = sailviz.load_scene(SCENE)
    own = {
        "steering": NoddingSteering(amplitude=AMPLITUDE, period=PERIOD),
        "device": PushingDevice(size=SIZE, mass=5000.0),
        "environment": Surroundings(rod=Rod(strength=STRENGTH)),
    }
    run = sailviz.simulate(scene.model_copy(update=own))
    expected = _flown(run.time)
    assert np.abs(run.position - expected[:3].T).max() < 100.0
    without = sailviz.simulate(scene.model_copy(update=own | {"environment": scene.environment}))
    assert np.abs(run.position - without.position).max() > 1e6
    np.testing.assert_allclose(run.mass, expected[6], rtol=1e-12)
    assert run.setting.craft.label == "Pusher"
    assert ("amplitude", "0.4 rad") in run.setting.parameters
    assert run.environment["nod_rad"] == pytest.approx(np.sin(run.time))
