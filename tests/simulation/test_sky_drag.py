"""Air on a sail by its attitude, at the tolerance that ships, against an integration of the law written down anew."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import sailviz
from sailviz.constants import AU, DAY, MU_EARTH, RADIUS_EARTH, ROTATION_EARTH

AREA, MASS, EDGE, DRAG = 32.0, 5.0, 0.5, 2.2
PRESSURE = 4.563e-6  # N/m2, of light at 1 au
TILT = np.radians(23.439)
INERTIAL = {"kind": "inertial", "direction": [0.6, 0.0, 0.8]}


def _scene(steering):
    air = {"kind": "exponential", "density_kg_m3": 3e-12, "reference_altitude_km": 420, "scale_height_km": 60}
    device = {"kind": "solar-sail", "area_m2": AREA, "mass_kg": MASS, "film": "ideal"}
    return {
        "title": "Air by attitude",
        "body": "earth",
        "start": {"kind": "circular", "altitude_km": 420, "inclination_deg": 51.6},
        "device": {**device, "drag_area": "attitude", "edge_area_m2": EDGE},
        "steering": steering,
        "environment": {"atmosphere": air, "corotation": True, "shadow_of": []},
        "propagation": {"duration_d": 0.5, "outputs": 7},
    }


def _slope(steering):
    """The same: two bodies, an even Sun 1 au away, an ideal film, air that turns with the Earth."""
    fixed = np.array([0.6, 0.0, 0.8])

    def slope(t, s):
        r, v = s[:3], s[3:]
        angle = 2 * np.pi * t / (365.25 * DAY)
        sun = AU * np.array([np.cos(angle), np.sin(angle) * np.cos(TILT), np.sin(angle) * np.sin(TILT)])
        ray = r - sun
        distance = np.linalg.norm(ray)
        u = ray / distance
        n = u if steering["kind"] == "sun-facing" else fixed
        q = v - np.cross([0.0, 0.0, ROTATION_EARTH], r)
        speed = np.linalg.norm(q)
        density = 3e-12 * np.exp(-(np.linalg.norm(r) - RADIUS_EARTH - 420e3) / 60e3)
        area = DRAG * (AREA * abs(n @ q) / speed + EDGE)
        light = 2 * PRESSURE * AREA / MASS * (AU / distance) ** 2 * max(u @ n, 0.0) ** 2
        pull = -MU_EARTH * r / np.linalg.norm(r) ** 3
        return np.concatenate([v, pull - 0.5 * density * area / MASS * speed * q + light * n])

    return slope


@pytest.mark.parametrize("steering", [{"kind": "sun-facing"}, INERTIAL], ids=["sun-facing", "inertial"])
def test_the_air_brakes_a_sail_as_it_stands_in_the_flow_whatever_steers_it(steering):
    """Where the air changes the side of the sail on which it falls there is a kink, twice a revolution: a step that ran
    across it would be farther off than this."""
    run = sailviz.simulate(_scene(steering))
    first = np.concatenate([run.position[0], run.velocity[0]])
    found = solve_ivp(_slope(steering), (0.0, run.time[-1]), first, "DOP853", rtol=1e-11, atol=1e-4, max_step=5.0)
    assert np.linalg.norm(found.y[:3, -1] - run.position[-1]) < 2.0
    fallen = run.elements.semi_major_axis[0] - run.elements.semi_major_axis[-1]
    assert fallen > 5e3


def test_a_sail_that_is_kept_edge_on_to_the_flow_is_flown_without_sides():
    """Facing the light or edge-on to it and to the flow, where the projected area is rounding and steps end nowhere."""
    scene = _scene({"kind": "on-off"})
    scene["environment"]["corotation"] = False
    run = sailviz.simulate(scene)
    again = sailviz.simulate({**scene, "propagation": {**scene["propagation"], "tolerance": 1e-12}})
    assert np.linalg.norm(run.position[-1] - again.position[-1]) < 2.0


SPEED_RATIO, WALL = 7.0, 0.4  # of the gas


def _thermal(cosine, sine):
    """Pressure and shear over rho V^2 / 2 on one side of a plate, accommodation 1, Maxwell's law written down anew."""
    from scipy.special import erf

    a, t = SPEED_RATIO * cosine, SPEED_RATIO * sine
    e, both = np.exp(-a * a), np.sqrt(np.pi) * (1 + erf(a))
    flux = (e + a * both) / np.sqrt(np.pi)
    p = a * e / np.sqrt(np.pi) + (a * a + 0.5) * both / np.sqrt(np.pi) + 0.5 * np.sqrt(np.pi * WALL) * flux
    return p / SPEED_RATIO**2, t * flux / SPEED_RATIO**2


def _fast(cosine, sine):
    """The same of a gas without heat but for the wall's."""
    if cosine <= 0:
        return 0.0, 0.0
    return 2 * cosine * (cosine + np.sqrt(np.pi * WALL) / (2 * SPEED_RATIO)), 2 * cosine * sine


@pytest.mark.parametrize(("law", "side", "near"), [("hyperthermal", _fast, 1e-5), ("free-molecular", _thermal, 1e-3)])
def test_the_air_pushes_the_facets_of_a_shape(law, side, near):
    """A flat square in an attitude that keeps to the stars: pressure and shear of both sides, lift and all. near : of
    what the air does to its place: the tensors have all of the limit, a table of 32 cells is near the law."""
    scene = _scene(INERTIAL)
    scene["propagation"]["duration_d"] = 0.15
    air = {"law": law, "speed_ratio": SPEED_RATIO, "wall_temperature_ratio": WALL}
    square = {"kind": "square", "side_m": float(np.sqrt(AREA)), "air": air}
    scene["device"] = {"kind": "solar-sail", "film": "ideal", "back": "same", "mass_kg": MASS, "shape": square}
    scene["event"] = [{"air_drag_mN": 3.0, "name": "three millinewtons"}]
    run = sailviz.simulate(scene)
    normal = np.array([0.6, 0.0, 0.8])

    def push(r, v):
        q = v - np.cross([0.0, 0.0, ROTATION_EARTH], r)
        speed = np.linalg.norm(q)
        u = -q / speed
        d = u @ normal
        along = u - d * normal
        sine = np.linalg.norm(along)
        density = 3e-12 * np.exp(-(np.linalg.norm(r) - RADIUS_EARTH - 420e3) / 60e3)
        (p, shear), (lee, drawn) = side(d, sine), side(-d, sine)
        size = 0.5 * density * speed**2 * AREA
        return size * ((p - lee) * normal + (shear + drawn) * along / sine), u, 4 * size

    def slope(t, s, blown):
        r, v = s[:3], s[3:]
        angle = 2 * np.pi * t / (365.25 * DAY)
        ray = r - AU * np.array([np.cos(angle), np.sin(angle) * np.cos(TILT), np.sin(angle) * np.sin(TILT)])
        distance = np.linalg.norm(ray)
        c = ray @ normal / distance
        light = 2 * PRESSURE * AREA / MASS * (AU / distance) ** 2 * c * abs(c)
        pull = -MU_EARTH * r / np.linalg.norm(r) ** 3
        return np.concatenate([v, pull + blown * push(r, v)[0] / MASS + light * normal])

    first = np.concatenate([run.position[0], run.velocity[0]])
    options = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-4, "max_step": 20.0}
    places = [solve_ivp(slope, (0, run.time[-1]), first, args=(blown,), **options).y[:3, -1] for blown in (1, 0)]
    blown_off = np.linalg.norm(places[0] - places[1])
    assert blown_off > 1e4
    assert np.linalg.norm(places[0] - run.position[-1]) < max(near * blown_off, 0.05)
    crossings = [event for event in run.events if event.name == "three millinewtons"]
    assert crossings
    for event in crossings:
        force, u, _ = push(event.state[:3], event.state[3:6])
        assert force @ u == pytest.approx(3e-3, rel=10 * near, abs=1e-9)
    for i in range(len(run.time)):
        force, u, size = push(run.position[i], run.velocity[i])
        assert run.environment["air_drag_N"][i] == pytest.approx(force @ u, abs=2e-3 * size)
        lift = np.linalg.norm(force - (force @ u) * u)
        assert run.environment["air_lift_N"][i] == pytest.approx(lift, abs=2e-3 * size)
