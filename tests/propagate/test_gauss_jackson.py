"""The multistep integrator against closed forms, conservation laws and DOP853. Earth's units: m, s, kg."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import DAY, J2_EARTH, MU_EARTH, RADIUS_EARTH
from sailviz.elements import state as state_on_orbit
from sailviz.environment import atmosphere
from sailviz.propagate import choice, dop853, dynamics, gauss_jackson, gauss_jackson_steps
from sailviz.propagate.callbacks import user_address
from sailviz.propagate.events import APSIS, END_OF_USE, NODE, RADIUS, RECORD, STOP, watch
from sailviz.steering import attitude

R0 = RADIUS_EARTH + 700e3
J2_STRENGTH = 1.5 * J2_EARTH * MU_EARTH * RADIUS_EARTH**2
PUSH = {"device": dynamics.THRUSTER, "steering": attitude.TANGENTIAL}
AIR = (1, 4e-14, R0, 1.0, 60e3)  # drag of 1.1e-6 m/s2 at 700 km, that of a large sail; mass 1 kg


def earth(**parts):
    return dynamics.model(MU_EARTH, **({"j2_strength": J2_STRENGTH} | parts))


def orbit(altitude, e=0.0, inclination=1.0):
    """Position, velocity at the perigee of this altitude."""
    return state_on_orbit((RADIUS_EARTH + altitude) / (1 - e), e, inclination, 0.3, 0.5, 0.0, MU_EARTH)


def fly(method, model, start, times, *, events=(), breaks=(0.0,), factors=(1.0,), block=None, tolerance=1e-13, **more):
    """(states (6, n), events, status, integration) by either integrator."""
    times = np.asarray(times, dtype=float)
    s = method.start(0.0, *start, 1.0, events=len(events), **more)
    out, found, status, done = np.full((6, len(times)), np.nan), [], method.DONE, 0
    size = block or len(times)
    for first in range(0, len(times), size):
        part = times[first : first + size]
        chunk = np.empty((6, len(part)))
        arguments = (np.asarray(breaks, float), np.asarray(factors, float), watch(events), part, chunk, times[-1])
        status = method.EVENTS_FULL
        while status == method.EVENTS_FULL:
            status = method.advance(s, model, *arguments, tolerance, np.inf)
            found += method.drain_events(s)
        rows = method.rows_done(s)
        out[:, first : first + rows] = chunk[:, :rows]
        done = first + rows
        if status != method.DONE:
            break
    return out[:, :done], found, status, s


def apart(states, others):
    """Largest distance over the radius, and largest difference of velocity over the speed."""
    n = min(states.shape[1], others.shape[1])
    d = states[:, :n] - others[:, :n]
    return tuple(
        (np.linalg.norm(d[i : i + 3], axis=0) / np.linalg.norm(others[i : i + 3, :n], axis=0)).max() for i in (0, 3)
    )


def kepler(altitude, e, times):
    """States (6, n) on the unperturbed orbit, since perigee, by Kepler's equation in extended precision."""
    a = np.longdouble((RADIUS_EARTH + altitude) / (1 - e))
    mean = np.sqrt(np.longdouble(MU_EARTH) / a**3) * times.astype(np.longdouble)
    anomaly = mean + e * np.sin(mean)
    for _ in range(12):
        anomaly = anomaly - (anomaly - e * np.sin(anomaly) - mean) / (1 - e * np.cos(anomaly))
    nu = 2 * np.arctan2(np.sqrt(1 + e) * np.sin(anomaly / 2), np.sqrt(1 - e) * np.cos(anomaly / 2))
    position, velocity = state_on_orbit(float(a), e, 1.0, 0.3, 0.5, nu.astype(float), MU_EARTH)
    return np.vstack([np.transpose(position), np.transpose(velocity)])


# ---------------------------------------------------------------- accuracy
@pytest.mark.parametrize("e", [0.0, 0.024, 0.1])
def test_a_thousand_revolutions_follow_keplers_equation(e):
    """At times that hit no step. Rounding pushes the energy by 1e-16 at random; in 1000 turns that makes 1e-11."""
    times = np.linspace(0, 1000 * 5930.0, 20011)
    states, _, _, s = fly(gauss_jackson, dynamics.model(MU_EARTH), orbit(700e3, e), times)
    position, velocity = apart(states, kepler(700e3, e, times))
    assert position < 5e-11
    assert velocity < 1e-9  # of the quintic between two steps
    assert gauss_jackson.statistics(s)[0] > 70_000


def test_error_falls_with_the_fourteenth_power_of_the_step():
    """Long steps around an eccentric orbit, so that truncation shows above rounding."""
    times = np.arange(0, 300 * 5930.0, 517.0)
    exact = kepler(700e3, 0.12, times)
    missed = [
        apart(fly(gauss_jackson, dynamics.model(MU_EARTH), orbit(700e3, 0.12), times, refinement=f)[0], exact)[0]
        for f in (0.75, 0.85)
    ]
    assert 10 < np.log(missed[0] / missed[1]) / np.log(0.85 / 0.75) < 20


def test_oblateness_keeps_energy_and_the_axial_angular_momentum():
    """Energy with the potential mu J2 R^2 (3 sin^2 phi - 1) / (2 r^3), for half a year at steps of the method."""
    times = np.linspace(0, 180 * DAY, 3001)
    states, *_ = fly(gauss_jackson, earth(), orbit(600e3, 0.01), times)
    r, v = states[:3].T, states[3:].T
    size = np.linalg.norm(r, axis=1)
    oblate = MU_EARTH * J2_EARTH * RADIUS_EARTH**2 * (3 * (r[:, 2] / size) ** 2 - 1) / (2 * size**3)
    energy = np.sum(v * v, axis=1) / 2 - MU_EARTH / size + oblate
    momentum = np.cross(r, v)[:, 2]
    # 1.4e-10 of the speed between two steps, and what rounding did in 2700 turns
    assert np.ptp(energy) / abs(energy[0]) < 5e-10
    assert np.ptp(momentum) / abs(momentum[0]) < 3e-10


@pytest.mark.parametrize(("altitude", "e"), [(500e3, 0.0), (700e3, 0.024)])
def test_oblate_decay_agrees_with_scipy(altitude, e):
    from scipy.integrate import solve_ivp

    def independent(_, y):
        r, v = y[:3], y[3:]
        size = np.linalg.norm(r)
        s = 5 * (r[2] / size) ** 2
        pull = -MU_EARTH / size**3 * r + J2_STRENGTH / size**5 * r * np.array([s - 1, s - 1, s - 3])
        return [*v, *(pull - 0.5 * AIR[1] * np.exp((R0 - size) / AIR[4]) * np.linalg.norm(v) * v)]

    start, times = orbit(altitude, e), np.linspace(0, DAY, 701)
    states, *_ = fly(gauss_jackson, earth(air=AIR), start, times)
    reference = solve_ivp(independent, (0, DAY), np.concatenate(start), "DOP853", times, rtol=3e-14, atol=1e-9).y
    # SciPy's own error; its output between steps is worse than its steps
    assert apart(states, reference)[0] < 1e-9


def test_thirty_days_of_decay_agree_with_dop853():
    times = np.linspace(0, 30 * DAY, 5003)
    model, start = earth(air=AIR), orbit(700e3, 0.01)
    states, *_ = fly(gauss_jackson, model, start, times)
    reference, *_ = fly(dop853, model, start, times, tolerance=3e-15)
    assert apart(states, reference)[0] < 2e-9  # DOP853's error of energy grows by 1e-14 a turn


def test_halving_the_step_tells_the_error():
    """The estimate is at least a tenth of the true error where truncation dominates."""
    times = np.arange(0, 300 * 5930.0, 597.0)
    start, model = orbit(700e3, 0.1), dynamics.model(MU_EARTH)
    coarse, *_ = fly(gauss_jackson, model, start, times, refinement=0.75)
    true = np.linalg.norm(coarse[:3] - kepler(700e3, 0.1, times)[:3], axis=0).max()
    told = gauss_jackson.estimated_error(model, *start, 1.0, times, refinement=0.75)
    assert told.shape == times.shape
    assert told.max() == pytest.approx(true, rel=0.05)
    assert told[0] == 0


# ---------------------------------------------------------------- the same run however it is asked for
def test_rows_do_not_depend_on_the_block_size():
    times = np.linspace(0, 3 * DAY, 2000)
    events = [(APSIS, 0, 0, RECORD), (NODE, 0, 1, RECORD)]
    breaks, factors = np.arange(0, 3 * DAY, 9_000.0), np.arange(29) % 2
    model = earth(air=AIR, device=dynamics.THRUSTER, device_parameters=(1e-5, 0, 0), steering=attitude.TANGENTIAL)
    arguments = (gauss_jackson, model, orbit(700e3, 0.01), times)
    whole = fly(*arguments, events=events, breaks=breaks, factors=factors)
    for block in (1, 7, 999):
        pieces = fly(*arguments, events=events, breaks=breaks, factors=factors, block=block)
        assert np.array_equal(pieces[0], whole[0])
        assert [event[:2] for event in pieces[1]] == [event[:2] for event in whole[1]]


def test_state_at_a_time_does_not_depend_on_what_else_is_asked_for():
    coarse = np.arange(0, 2 * DAY + 1, 600.0)
    fine = np.arange(0, 2 * DAY + 1, 12.0)
    few = fly(gauss_jackson, earth(), orbit(700e3), coarse)[0]
    many = fly(gauss_jackson, earth(), orbit(700e3), fine, events=[(NODE, 0, 0, RECORD)])[0]
    assert np.array_equal(many[:, ::50], few)


# ---------------------------------------------------------------- thrust with a schedule
@pytest.mark.parametrize("spacing", [400.0, 5_000.0])
def test_switched_thrust_agrees_with_dop853(spacing):
    """Closer than the points that a start needs, and wider."""
    breaks = np.arange(0, 2 * DAY, spacing)
    factors = np.cos(np.arange(len(breaks))) ** 2
    model = earth(device=dynamics.THRUSTER, device_parameters=(1e-4, 0, 0), steering=attitude.TANGENTIAL)
    times = np.linspace(0, 2 * DAY, 1001)
    arguments = (model, orbit(700e3), times)
    states, *_ = fly(gauss_jackson, *arguments, breaks=breaks, factors=factors)
    reference, *_ = fly(dop853, *arguments, breaks=breaks, factors=factors, tolerance=1e-14)
    assert apart(states, reference)[0] < 1e-10


def test_a_force_that_jumps_unannounced_stays_within_a_millionth_of_its_effect():
    """A push of 1e-6 of gravity, on and off with the sign of x: twice a turn the integrator meets the jump unwarned."""
    import numba

    @numba.njit
    def push(t, x, y, z, vx, vy, vz, m):
        k = -8e-6 if x > 0 else 0.0
        v = np.sqrt(vx * vx + vy * vy + vz * vz)
        return k * vx / v, k * vy / v, k * vz / v

    address, keep = user_address(push, "force")
    times = np.linspace(0, 10 * DAY, 2001)
    start = orbit(700e3, 0.0, 0.5)
    states, *_ = fly(gauss_jackson, earth(user_force=address), start, times)
    reference, *_ = fly(dop853, earth(user_force=address), start, times, tolerance=1e-14)
    without, *_ = fly(gauss_jackson, earth(), start, times)
    assert apart(states, reference)[0] < 1e-6 * apart(without, reference)[0]
    assert keep is not None


# ---------------------------------------------------------------- events
def test_events_are_those_of_dop853():
    model, start, times = earth(air=AIR), orbit(600e3, 0.005), np.linspace(0, 5 * DAY, 11)
    events = [(NODE, 0, 1, RECORD), (APSIS, 0, 0, RECORD), (RADIUS, RADIUS_EARTH + 610e3, 0, RECORD)]
    ours = fly(gauss_jackson, model, start, times, events=events)[1]
    theirs = fly(dop853, model, start, times, events=events)[1]
    assert len(ours) > 300
    assert [i for i, _, _ in ours] == [i for i, _, _ in theirs]
    assert np.array([t for _, t, _ in ours]) == pytest.approx([t for _, t, _ in theirs], abs=1e-4)
    assert [t for _, t, _ in ours] == sorted(t for _, t, _ in ours)


def test_stop_and_end_of_use_happen_where_dop853_has_them():
    parts = {"device": dynamics.THRUSTER, "device_parameters": (-3e-4, 0, 0), "steering": attitude.TANGENTIAL}
    model = earth(air=AIR, surface_radius=RADIUS_EARTH, **parts)
    times = np.linspace(0, 20 * DAY, 4001)
    events = [(RADIUS, RADIUS_EARTH + 500e3, -1, END_OF_USE), (RADIUS, RADIUS_EARTH + 495e3, -1, STOP)]
    runs = [
        fly(method, model, orbit(600e3), times, events=events, tolerance=1e-14) for method in (gauss_jackson, dop853)
    ]
    for method, (_, found, status, s) in zip((gauss_jackson, dop853), runs, strict=True):
        assert [i for i, _, _ in found] == [0, 1]
        assert status == method.STOPPED
        assert method.stopped_by(s) == 1
        assert not method.in_use(s)
        assert np.array_equal(method.state(s), found[1][2])
        assert method.time(s) == found[1][1]
    (a, first, *_), (b, second, *_) = runs
    assert a.shape == b.shape
    assert apart(a, b)[0] < 1e-9  # the error of DOP853
    assert [t for _, t, _ in first] == pytest.approx([t for _, t, _ in second], abs=1e-3)


def test_contact_with_the_surface_is_met_at_perigee():
    """Drag on a body without air below 120 km: the surface there stands for the ground."""
    surface = RADIUS_EARTH + 150e3
    model = earth(air=AIR, surface_radius=surface)
    times = np.linspace(0, 200 * DAY, 2001)
    (_, found, status, s), (_, theirs, *_) = (
        fly(method, model, orbit(250e3, 0.004), times) for method in (gauss_jackson, dop853)
    )
    assert status == gauss_jackson.SURFACE
    assert found[0][0] == -1
    assert np.linalg.norm(gauss_jackson.state(s)[:3]) == pytest.approx(surface, abs=1e-3)
    assert found[0][1] == pytest.approx(theirs[0][1], abs=1e-2)


def test_decay_to_200_km_shortens_the_step_and_agrees_with_dop853():
    """From 500 km down to 200 km and into the last turns, where drag is no small force any more."""
    times = np.linspace(0, 60 * DAY, 5001)
    events = [(RADIUS, RADIUS_EARTH + 200e3, -1, RECORD), (RADIUS, RADIUS_EARTH + 120e3, -1, STOP)]
    model = earth(air=(1, 2e-13, *AIR[2:]))
    ours, found, status, s = fly(gauss_jackson, model, orbit(500e3), times, events=events)
    theirs, expected, *_ = fly(dop853, model, orbit(500e3), times, events=events, tolerance=1e-14)
    assert status == gauss_jackson.STOPPED
    assert [i for i, _, _ in found] == [i for i, _, _ in expected]
    assert [t for _, t, _ in found] == pytest.approx([t for _, t, _ in expected], abs=1e-2)
    assert ours.shape == theirs.shape
    assert apart(ours, theirs)[0] < 1e-9
    assert gauss_jackson.step(s) < 0.95 * gauss_jackson_steps.ANGLE / np.sqrt(MU_EARTH / (RADIUS_EARTH + 500e3) ** 3)


# ---------------------------------------------------------------- where it does not apply
def test_an_eccentric_orbit_is_left_to_dop853_steps():
    times = np.linspace(0, 2 * DAY, 301)
    start = orbit(700e3, 0.6)
    states, *_ = fly(gauss_jackson, earth(), start, times)
    assert apart(states, fly(dop853, earth(), start, times, tolerance=1e-14)[0])[0] < 1e-11


def test_a_force_that_is_not_finite_is_reported():
    model = earth(air=(1, np.nan, R0, 1.0, 60e3))
    assert fly(gauss_jackson, model, orbit(700e3), [DAY])[2] == gauss_jackson.NOT_FINITE


def test_mass_loss_is_refused():
    model = earth(device=dynamics.THRUSTER, device_parameters=(1e-4, 0, 1e-4), steering=attitude.TANGENTIAL)
    with pytest.raises(ValueError, match="mass constant"):
        fly(gauss_jackson, model, orbit(700e3), [DAY])


# ---------------------------------------------------------------- which integrator
def chosen(model, start, days, **more):
    return choice.choose(model, *start, days * DAY, **more)


def test_many_turns_of_a_low_orbit_are_left_to_the_multistep_method():
    low = earth(surface_radius=RADIUS_EARTH, user_force=1)  # evaluated at one place at a time
    assert chosen(low, orbit(700e3, 0.02), 365).integrator == "gauss-jackson"
    assert chosen(low, orbit(700e3), 365, wanted="dop853").integrator == "dop853"
    free = earth(surface_radius=RADIUS_EARTH, device_parameters=(1e-5, 0, 0), **PUSH)
    assert chosen(free, orbit(700e3), 365).integrator == "gauss-jackson"
    assert chosen(free, orbit(700e3), 365, breaks=np.arange(0, 365 * DAY, 600.0)).integrator == "collocation"
    assert chosen(free, orbit(700e3), 1).integrator == "collocation"
    assert chosen(free, orbit(36_000e3), 3650).reason == "the forces are smooth"
    tabled = earth(surface_radius=RADIUS_EARTH, air=(atmosphere.TABLED, 1.0), air_table=np.zeros(20))
    assert "tables" in chosen(tabled, orbit(700e3), 365).reason
    assert chosen(tabled, orbit(700e3), 365).integrator == "dop853"


def test_what_may_jump_unforeseen_is_left_to_dop853():
    sun = {"position": (1.0, 0, 0), "velocity": (0, 1.0, 0), "duration": 10.0}
    film = {"device": dynamics.SOLAR_SAIL, "device_parameters": (0.05, 0, 1, 0)}
    wires = {"device": dynamics.ELECTRIC_SAIL, "device_parameters": (1e-12, 0, 1)}
    push = {"device": dynamics.THRUSTER, "device_parameters": (1e-3, 0, 0)}
    for more, integrator in (
        (film | {"steering": attitude.ORBITAL, "steering_parameters": (1, 0, 0)}, "collocation"),
        (film | {"steering": attitude.PRIMER}, "collocation"),  # a sail that is steered for the most thrust never stops
        (wires | {"steering": attitude.PRIMER}, "dop853"),  # its wires do
        (film | {"steering": attitude.LYAPUNOV}, "dop853"),
        (film | {"steering": attitude.INERTIAL}, "dop853"),  # edge-on twice a turn
        (film | {"steering": attitude.TANGENTIAL}, "dop853"),
        (push | {"steering": attitude.INERTIAL}, "collocation"),
        (push | {"steering": attitude.TANGENTIAL}, "collocation"),
        ({"third_body": (1e-3, 1.0, 1.0, 0.0)}, "dop853"),
        ({"user_force": 1}, "dop853"),
        ({"device": dynamics.CALLED}, "dop853"),
    ):
        assert choice.choose(dynamics.model(1.0, **more), **sun).integrator == integrator
        assert choice.choose(dynamics.model(1.0, **more), **sun, wanted="collocation").integrator == "collocation"


def test_what_the_multistep_method_cannot_do_is_refused_with_the_reason():
    burning = earth(device=dynamics.THRUSTER, device_parameters=(1e-4, 0, 1e-4), steering=attitude.TANGENTIAL)
    position, velocity = orbit(700e3)
    for model, start, reason in (
        (burning, (position, velocity), "burns propellant"),
        (earth(), orbit(700e3, 0.3), "eccentricity 0.3"),
        (earth(), (position, 1.5 * velocity), "not bound"),
    ):
        asked = chosen(model, start, 365, wanted="gauss-jackson")
        assert not asked.possible
        assert reason in asked.reason
        assert chosen(model, start, 365).possible
    with pytest.raises(ValueError, match="must be"):
        chosen(earth(), orbit(700e3), 1, wanted="euler")
