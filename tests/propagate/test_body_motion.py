"""A craft that turns, against closed forms, conservation and SciPy: nothing here is the kernel's own number."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipk

from sailviz import frames
from sailviz.constants import AU, MU_EARTH, MU_SUN, RADIATION_PRESSURE
from sailviz.propagate import body_steps, dop853, dynamics
from sailviz.propagate.body_motion import AVERAGED, RATE, SIZE, Body, Q, packed
from sailviz.propagate.events import watch
from sailviz.propagate.shape_callback import shape_thrust
from sailviz.propulsion.devices import CALLED
from sailviz.propulsion.solar_sail import FILMS
from sailviz.propulsion.surfaces import side_of
from sailviz.run.quantities import VALUES  # noqa: F401 - imported before tests patch anything
from sailviz.shapes import light_table, membranes
from sailviz.shapes.facets import Coefficients, Part, Shape, Surface
from sailviz.shapes.primitives import Trimesh

JPL = Coefficients(*side_of(FILMS["jpl-2015"]))
IDEAL = Coefficients(0.0, 1.0, 0.0)
STILL = ((AU, 0.0, 0.0), (0.0, 1e-9, 0.0), 1e15)  # a craft too heavy to be moved, where nothing pulls
WEAK = 1e-6  # m3/s2


def body(inertia, **said) -> Body:
    matrix = np.diag(inertia) if np.ndim(inertia) == 1 else np.asarray(inertia, float)
    inverse = np.linalg.inv(matrix)
    places = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    numbers = [float(m[i, j]) for m in (matrix, inverse) for i, j in places]
    return Body(0.0, *numbers)._replace(**said)


def model(craft: Body, shape: Shape | None = None, mu: float = WEAK, rows=(), cells: int = 2):
    lit = {}
    if shape is not None:
        table = light_table.build(shape, cells, shadow=False)
        push = shape_thrust(2 * RADIATION_PRESSURE * AU**2, False, 0.0, table.numbers.tolist())
        craft = craft._replace(lit=1.0)
        lit = {"device": CALLED, "device_callback": push}
    return dynamics.model(mu, steering=dynamics.attitude.INERTIAL, body=packed(craft, rows), **lit)


def flown(acting, start, motion, times, tolerance=1e-13, largest=np.inf):
    """States (SIZE, n) at times (n,) s, from position, velocity, mass and the motion (quaternion, body rate)."""
    state = body_steps.start(0.0, *start, 0, motion)
    times = np.atleast_1d(np.asarray(times, float))
    out = np.empty((SIZE, len(times)))
    none = np.array([0.0]), np.array([1.0])
    status = body_steps.advance(state, acting, *none, watch([]), times, out, times[-1], tolerance, largest)
    assert status == dop853.DONE
    return out


def rates(out):
    return out[RATE : RATE + 3]


def axes(out):
    """(n, 3, 3) axes as columns."""
    return frames.rotation(frames.unit(out[Q : Q + 4].T))


def square(side: float, off, surface: Surface) -> tuple[Shape, dict[str, float]]:
    """A flat square, and a centre of mass from which its middle is `off` (3,) m away."""
    return Shape((membranes.square(side, surface),)), dict(
        zip(("centre_x", "centre_y", "centre_z"), -np.array(off), strict=True)
    )


def tilted(angle: float) -> np.ndarray:
    """Quaternion of a craft at x > 0 whose z axis is turned off the Sun line in the x-z plane."""
    half = (np.pi / 2 - angle) / 2
    return np.array([0.0, np.sin(half), 0.0, np.cos(half)])


# ---------------------------------------------------------------- nothing turns it
def euler_poinsot(inertia, w0, t):
    """Body rate of a free asymmetric top that starts without a rate about its middle axis: Jacobi's elliptic functions,
    and the period."""
    i1, i2, i3 = inertia
    a, _, c = w0
    twice, g = i1 * a**2 + i3 * c**2, (i1 * a) ** 2 + (i3 * c) ** 2
    swapped = g < twice * i2
    if swapped:
        i1, i3, a, c = i3, i1, c, a
    middle = np.sqrt((twice * i3 - g) / (i2 * (i3 - i2)))
    turn = np.sqrt((g - twice * i1) * (i3 - i2) / (i1 * i2 * i3))
    m = (i2 - i1) * (twice * i3 - g) / ((i3 - i2) * (g - twice * i1))
    sn, cn, dn, _ = ellipj(turn * t, m)
    sign = np.sign((i3 - i1) * a * c)  # as w2' = (i3 - i1) w1 w3 / i2 of the body as it is
    w = (a * cn, sign * middle * sn, c * dn)
    if swapped:
        w = (w[2], -w[1], w[0])
    return np.array([float(value) for value in w]), float(4 * ellipk(m) / turn)


@pytest.mark.parametrize(
    ("w0", "t", "period"), [((0.02, 0, 0.05), 3600, 138.4070333015), ((0.06, 0, 0.03), 600, 395.7201758296)]
)
def test_a_free_asymmetric_top_turns_by_elliptic_functions(w0, t, period):
    inertia = (10, 15, 24)
    found = flown(model(body(inertia)), STILL, (0, 0, 0, 1, *w0), [t / 2, t])
    for i, time in enumerate((t / 2, t)):
        exact, own_period = euler_poinsot(inertia, w0, time)
        assert rates(found)[:, i] == pytest.approx(exact, abs=2e-12)
        assert own_period == pytest.approx(period, rel=1e-11)
    momentum = axes(found) @ (np.diag(inertia) @ rates(found)).T[..., None]
    assert momentum[..., 0] == pytest.approx(np.tile(np.array(inertia) * w0, (2, 1)), abs=2e-12)


def test_attitudes_of_a_free_top_are_those_of_its_direction_cosines():
    inertia, w0 = np.array([10.0, 15.0, 24.0]), np.array([0.06, 0.0, 0.03])

    def rate(_, y):  # R' = R [w]x, not a quaternion
        w, turn = y[:3], y[3:].reshape(3, 3)
        cross = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
        return np.concatenate([np.cross(inertia * w, w) / inertia, (turn @ cross).ravel()])

    exact = solve_ivp(rate, (0, 600), [*w0, *np.eye(3).ravel()], "DOP853", rtol=1e-13, atol=1e-15).y[3:, -1]
    found = flown(model(body(inertia)), STILL, (0, 0, 0, 1, *w0), [600])
    assert axes(found)[0] == pytest.approx(exact.reshape(3, 3), abs=1e-10)


def test_a_symmetric_top_nutates_at_its_body_and_space_rates():
    spin, across, i_axial, i_across = 0.2, 0.01, 110.0, 60.0
    t = 1000.0
    found = flown(model(body((60, 60, 110))), STILL, (0, 0, 0, 1, across, 0, spin), [t])
    turn = (i_axial - i_across) / i_across * spin  # 1/6 rad/s
    exact = (across * np.cos(turn * t), across * np.sin(turn * t), spin)
    assert rates(found)[:, 0] == pytest.approx(exact, abs=1e-12)
    momentum = np.array([i_across * across, 0, i_axial * spin])
    rate, along = np.linalg.norm(momentum) / i_across, momentum / np.linalg.norm(momentum)
    assert rate == pytest.approx(0.366803004956, rel=1e-11)
    z, angle = np.array([0.0, 0.0, 1.0]), rate * t  # z circles the momentum: Rodrigues' formula
    circled = z * np.cos(angle) + np.cross(along, z) * np.sin(angle) + along * (along @ z) * (1 - np.cos(angle))
    assert axes(found)[0, :, 2] == pytest.approx(circled, abs=2e-11)


def test_energy_and_momentum_of_a_tumbling_body_are_kept_over_a_hundred_periods():
    inertia = np.array([[12.0, 1.0, -0.5], [1.0, 16.0, 0.7], [-0.5, 0.7, 24.0]])
    w0 = np.array([0.02, 0.01, 0.05])
    found = flown(model(body(inertia)), STILL, (0, 0, 0, 1, *w0), np.linspace(0, 14_000, 20), 1e-12)
    w = rates(found).T
    energy = np.einsum("ni,ij,nj->n", w, inertia, w)
    momentum = np.einsum("nij,nj->ni", axes(found), w @ inertia)
    assert energy == pytest.approx(np.full(20, energy[0]), rel=1e-10)
    assert momentum == pytest.approx(np.tile(inertia @ w0, (20, 1)), abs=1e-10 * np.linalg.norm(inertia @ w0))
    assert np.linalg.norm(found[Q : Q + 4], axis=0) == pytest.approx(np.ones(20), abs=2e-9)


# ---------------------------------------------------------------- light
@pytest.mark.parametrize(("degrees", "known"), [(5, 11818.53789738), (30, 12659.29855817), (85, 28774.821749)])
def test_a_flat_film_swings_about_the_sun_line_like_a_pendulum(degrees, known):
    a0, off, inertia, area = np.radians(degrees), 0.3, 60.0, 86.0
    kappa = 2 * RADIATION_PRESSURE * area * JPL.b1 * off
    period = float(4 * ellipk(np.sin(a0) ** 2) / np.sqrt(kappa / inertia))
    assert period == pytest.approx(known, rel=1e-10)
    shape, centre = square(np.sqrt(area), (0, 0, off), Surface(JPL, JPL))
    start = (*tilted(a0), 0, 0, 0)
    found = flown(model(body((60, 60, 115), **centre), shape), STILL, start, [period / 4, period / 2, period])
    normal = axes(found)[..., 2]
    angle = np.arctan2(normal[:, 2], normal[:, 0])
    assert angle == pytest.approx([0.0, -a0, a0], abs=1e-8)


def test_an_ideal_film_feels_no_torque_by_an_offset_along_its_axis_and_a_wrong_side_falls_over():
    shape, centre = square(9.0, (0, 0, 0.3), Surface(IDEAL, IDEAL))
    still = flown(model(body((60, 60, 115), **centre), shape), STILL, (*tilted(0.3), 0, 0, 0), [20_000])
    assert rates(still)[:, 0] == pytest.approx(np.zeros(3), abs=1e-15)
    shape, centre = square(9.0, (0, 0, -0.3), Surface(JPL, JPL))
    fallen = flown(model(body((60, 60, 115), **centre), shape), STILL, (*tilted(0.05), 0, 0, 0), [9_000])
    assert axes(fallen)[0, 0, 2] < 0.3  # cosine of an angle that has grown


@pytest.mark.parametrize(("degrees", "known"), [(10, 1862.196869065), (65, 2716.261864477)])
def test_a_roof_of_two_panels_swings_like_a_pendulum(degrees, known):
    area, half, x0, z0, inertia, a0 = 40.0, np.radians(20), 1.5, 0.2, 30.0, np.radians(degrees)
    corners, faces = [], []
    for side in (1, -1):  # apex to the Sun: outwards the panels lean downwind
        along = np.array([side * np.cos(half), 0.0, np.sin(half)]) * np.sqrt(area / 2) / 2
        across = np.array([0.0, np.sqrt(area / 2) / 2, 0.0])
        middle = np.array([side * x0, 0.0, z0])
        at = len(corners)
        corners += [middle - along - across, middle + along - across, middle + along + across, middle - along + across]
        quad = (
            [[at, at + 2, at + 1], [at, at + 3, at + 2]] if side > 0 else [[at, at + 1, at + 2], [at, at + 2, at + 3]]
        )
        faces += quad
    mesh = Trimesh(np.array(corners), np.array(faces), process=False)
    shape = Shape((Part("roof", mesh, Surface(IDEAL, IDEAL)),))
    assert np.all(shape.elements.normal[:, 2] < 0)  # fronts to the Sun
    w0 = np.sqrt(2 * RADIATION_PRESSURE * area * (z0 * np.sin(half) + x0 * np.cos(half)) * np.sin(2 * half) / inertia)
    period = float(4 * ellipk(np.sin(a0) ** 2) / w0)
    assert period == pytest.approx(known, rel=1e-10)
    acting = model(body((40, 30, 60)), shape, cells=64)  # whose tensors alone tell it out to 66 deg
    found = flown(acting, STILL, (*tilted(a0), 0, 0, 0), [period / 4, period / 2, period])
    normal = axes(found)[..., 2]
    assert np.arctan2(normal[:, 2], normal[:, 0]) == pytest.approx([0.0, -a0, a0], abs=1e-8)


# ---------------------------------------------------------------- gravity
R_LOW = 7_178_137.0
RATE_LOW = np.sqrt(MU_EARTH / R_LOW**3)


def in_low_orbit(inertia, tilt, times, extra=(0, 0, 0)):
    """A craft on a circle, its axes along track, along the negative orbit normal's opposite and outwards, turned by
    three small angles (rad, about x, y, z); it turns with the orbit. Returns the angles (3, n) left in that frame."""
    start = ((R_LOW, 0, 0), (0, R_LOW * RATE_LOW, 0), 100.0)
    frame = np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])  # columns: track, normal, radial
    small = frames.turn_x(tilt[0]).T @ frames.turn_y(tilt[1]).T @ frames.turn_z(tilt[2]).T
    turn = frame @ small
    w = turn.T @ np.array([0, 0, RATE_LOW]) + np.array(extra)
    craft = body(inertia, gradient=1.0)
    found = flown(model(craft, mu=MU_EARTH), start, (*frames.quaternion(turn), *w), times)
    angle = RATE_LOW * np.asarray(times)
    c, s, o, one = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    orbit = np.stack([np.stack([-s, c, o], -1), np.stack([o, o, one], -1), np.stack([c, s, o], -1)], -1)
    return np.swapaxes(orbit, 1, 2) @ axes(found), found


@pytest.mark.parametrize("degrees", [5.0, 45.0])
def test_gravity_swings_a_long_body_in_the_plane_of_its_orbit_like_a_pendulum(degrees):
    ix, iy, iz = 80.0, 100.0, 30.0
    a0, w = np.radians(degrees), RATE_LOW * np.sqrt(3 * (ix - iz) / iy)
    assert w / RATE_LOW == pytest.approx(1.224744871392, rel=1e-12)
    period = float(4 * ellipk(np.sin(a0) ** 2) / w)
    if degrees == 45:
        assert period == pytest.approx(5832.977627727, rel=1e-10)
    left, _ = in_low_orbit((ix, iy, iz), (0, a0, 0), [period / 4, period / 2, period])
    assert np.arctan2(left[:, 0, 2], left[:, 2, 2]) == pytest.approx([0.0, -a0, a0], abs=1e-8)


def test_small_swings_across_the_orbit_have_the_two_frequencies_of_roll_and_yaw():
    ix, iy, iz = 80.0, 100.0, 30.0
    kx, kz = (iy - iz) / ix, (iy - ix) / iz
    b, c = 1 + 3 * kx + kx * kz, 4 * kx * kz
    fast, slow = (np.sqrt((b + sign * np.sqrt(b * b - 4 * c)) / 2) for sign in (1, -1))
    assert (fast, slow) == pytest.approx((1.884488325488, 0.810578240784), rel=1e-12)
    times = np.linspace(0, 40_000, 400)[1:]
    left, _ = in_low_orbit((ix, iy, iz), (1e-5, 0, 2e-5), times)
    roll, yaw = left[:, 2, 1], left[:, 1, 0]
    n = RATE_LOW
    waves = np.stack([f(k * n * times) for k in (fast, slow) for f in (np.cos, np.sin)], -1)
    for angle in (roll, yaw):  # nothing is left over beside two pairs of waves
        rest = angle - waves @ np.linalg.lstsq(waves, angle, rcond=None)[0]
        assert np.abs(rest).max() < 2e-4 * np.abs(angle).max()


def test_a_tumble_in_low_orbit_is_that_of_direction_cosines_by_scipy():
    r, mu, inertia = 7_378_137.0, MU_EARTH, np.array([40.0, 55.0, 90.0])
    n, w0, t = np.sqrt(mu / r**3), np.array([0.002, 0.001, 0.0005]), 6307.0

    def rate(time, y):
        w, turn = y[:3], y[3:].reshape(3, 3)
        up = turn.T @ np.array([np.cos(n * time), np.sin(n * time), 0])
        torque = 3 * n * n * np.cross(up, inertia * up)
        cross = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
        return np.concatenate([(torque + np.cross(inertia * w, w)) / inertia, (turn @ cross).ravel()])

    exact = solve_ivp(rate, (0, t), [*w0, *np.eye(3).ravel()], "DOP853", rtol=1e-13, atol=1e-16).y[:, -1]
    craft = model(body(inertia, gradient=1.0), mu=mu)
    found = flown(craft, ((r, 0, 0), (0, r * n, 0), 50.0), (0, 0, 0, 1, *w0), [t])
    assert rates(found)[:, 0] == pytest.approx(exact[:3], abs=1e-12)
    assert axes(found)[0] == pytest.approx(exact[3:].reshape(3, 3), abs=1e-9)
    assert exact[[5, 8, 11]] == pytest.approx([0.871708054937, -0.2504618458242, 0.4211815888003], abs=1e-9)


# ---------------------------------------------------------------- orbit and attitude together
ORBIT = ((AU, 0.0, 0.0), (0.0, np.sqrt(MU_SUN / AU), 0.0), 14.0)
FROM_110 = (0.0, np.sin(np.radians(55)), 0.0, np.cos(np.radians(55)))


def together(off, w0, t):
    """Orbit and attitude of a flat film by SciPy, the film's law written out: state position, velocity, R, w."""
    inertia, area, mass = np.array([60.0, 62.0, 115.0]), 86.0, 14.0

    def rate(_, y):
        x, v, turn, w = y[:3], y[3:6], y[6:15].reshape(3, 3), y[15:]
        r = np.linalg.norm(x)
        u = turn.T @ x / r
        c = u[2]
        normal = np.array([0, 0, 1.0]) if c > 0 else np.array([0, 0, -1.0])
        c = abs(c)
        push = 2 * RADIATION_PRESSURE * (AU / r) ** 2 * area * c * (JPL.b1 * u + (JPL.b2 * c + JPL.b3) * normal)
        torque = np.cross(off, push)
        cross = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
        return np.concatenate(
            [
                v,
                -MU_SUN * x / r**3 + turn @ push / mass,
                (turn @ cross).ravel(),
                (torque - np.cross(w, inertia * w)) / inertia,
            ]
        )

    start = [*ORBIT[0], *ORBIT[1], *frames.rotation(FROM_110).ravel(), *w0]
    scale = np.array([1e-3] * 3 + [1e-9] * 3 + [1e-14] * 9 + [1e-18] * 3)
    return solve_ivp(rate, (0, t), start, "DOP853", rtol=2e-14, atol=scale).y[:, -1]


@pytest.mark.parametrize(
    ("off", "w0", "t", "normal", "turning"),
    [
        ((0, 0, 0.3), (0, 0, 0), 172_800, (0.9409080976776, 0.0299222514286, -0.3373375321458), 1e-13),
        ((0.01, -0.005, 0.3), (0, 0, 0), 3600, (0.7794430281179, 0.2313480232338, 0.5821912555718), 1e-12),
        ((0.01, -0.005, 0.3), (0, 0, 2 * np.pi / 300), 3600, None, 1e-11),
    ],
)
def test_orbit_and_attitude_of_a_sail_are_those_of_scipy(off, w0, t, normal, turning):
    shape, centre = square(np.sqrt(86), off, Surface(JPL, JPL))
    acting = model(body((60, 62, 115), **centre), shape, mu=MU_SUN)
    found, exact = flown(acting, ORBIT, (*FROM_110, *w0), [t]), together(np.array(off), w0, t)
    assert found[:3, 0] == pytest.approx(exact[:3], abs=0.05)  # m, of 1 au
    assert axes(found)[0] == pytest.approx(exact[6:15].reshape(3, 3), abs=2e-9)
    assert rates(found)[:, 0] == pytest.approx(exact[15:], abs=turning)
    if normal is not None:
        assert axes(found)[0, :, 2] == pytest.approx(normal, abs=2e-9)


# ---------------------------------------------------------------- spin
def test_a_spinning_flat_sail_precesses_evenly_about_the_sun_line():
    across, axial, area, off, angle = 350.0, 700.0, 196.0, 0.5, np.radians(20)
    spin = 2 * np.pi / 60
    kappa = 2 * RADIATION_PRESSURE * area * JPL.b1 * off
    c = np.cos(angle)
    roots = np.roots([across * c, -axial * spin, -kappa * c])
    rate = float(roots[np.argmin(np.abs(roots))])
    assert rate == pytest.approx(-8.2890046013519e-7, rel=1e-11)
    shape, centre = square(np.sqrt(area), (0, 0, off), Surface(JPL, JPL))
    acting = model(body((across, across, axial), **centre), shape)
    up = np.array([1.0, 0, 0])
    turn = frames.rotation(tilted(angle))
    z = turn[:, 2]
    w = turn.T @ (rate * up + (spin - rate * (up @ z)) * z)  # precession, and about z whatever makes it the spin
    t = 4000.0
    found = flown(acting, STILL, (*tilted(angle), *w), [t])
    end = z * np.cos(rate * t) + np.cross(up, z) * np.sin(rate * t) + up * (up @ z) * (1 - np.cos(rate * t))
    assert axes(found)[0, :, 2] == pytest.approx(end, abs=2e-11)


def windmill():
    """Four plates pitched a little, coned downwind: a shape that light both precesses, brings in and spins up."""
    cone, pitch, side = np.radians(2), np.radians(0.3), 7.0
    corners, faces = [], []
    for quarter in range(4):
        azimuth = quarter * np.pi / 2
        out, ahead = np.array([np.cos(azimuth), np.sin(azimuth), 0]), np.array([-np.sin(azimuth), np.cos(azimuth), 0])
        z = np.array([0, 0, 1.0])
        normal = (z * np.cos(cone) - out * np.sin(cone)) * np.cos(pitch) + ahead * np.sin(pitch)
        along = out * np.cos(cone) + z * np.sin(cone)
        across = np.cross(normal, along)
        middle, at = 14 / 3 * along, len(corners)
        corners += [middle + side / 2 * (i * along + j * across) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        faces += [[at, at + 2, at + 1], [at, at + 3, at + 2]]
    mesh = Trimesh(np.array(corners), np.array(faces), process=False)
    assert np.all(
        np.cross(mesh.triangles[:, 1] - mesh.triangles[:, 0], mesh.triangles[:, 2] - mesh.triangles[:, 0])[:, 2] < 0
    )
    return Shape((Part("plates", mesh, Surface(JPL, JPL)),))


def test_the_average_over_a_fast_spin_is_the_motion_it_stands_for():
    spin, tilt, t = 2 * np.pi / 60, np.radians(3), 10_000.0
    said = {"centre_x": 0.02, "centre_z": -0.4}
    craft = body((350, 350, 600), **said)
    z = np.array([1.0, 0, 0]) * np.cos(tilt) + np.array([0, 1.0, 0]) * np.sin(tilt)
    averaged = model(craft._replace(motion=AVERAGED), windmill(), cells=16)
    mean = flown(averaged, STILL, (*z, 0, 0, 0, spin), [t], 1e-10)
    turn = frames.body_axes(z[None], np.array([[0, 0, 1.0]]))[0]
    acting = model(craft, windmill(), cells=16)
    whole = flown(acting, STILL, (*frames.quaternion(turn), 0, 0, spin), [t], 1e-10)
    momentum = axes(whole)[0] @ (np.array([350, 350, 600]) * rates(whole)[:, 0])
    assert frames.unit(mean[Q : Q + 3, 0]) == pytest.approx(momentum / np.linalg.norm(momentum), abs=2e-5)
    assert mean[RATE + 2, 0] == pytest.approx(rates(whole)[2, 0], rel=1e-6)
    assert mean[RATE + 2, 0] - spin > 5e-4  # of which a good part is the windmill's


def test_small_tilts_of_an_averaged_spin_spiral_at_the_rate_of_the_torque_s_slopes():
    spin, t, a = 2 * np.pi / 60, 40_000.0, np.radians(3)
    shape, said = windmill(), {"centre_x": 0.02, "centre_z": -0.4}
    centre = np.array([0.02, 0, -0.4])

    def torque(u):
        force, about_origin = (np.zeros(3), np.zeros(3))
        for middle, outwards, area in zip(
            shape.elements.centre, shape.elements.normal, shape.elements.area, strict=True
        ):
            normal = -outwards
            c = normal @ u
            push = 2 * RADIATION_PRESSURE * area * c * (JPL.b1 * u + (JPL.b2 * c + JPL.b3) * normal)
            force, about_origin = force + push, about_origin + np.cross(middle, push)
        return about_origin - np.cross(centre, force)

    h = 1e-5
    slopes = np.array(
        [
            (torque(np.array(u) / np.linalg.norm(u)) - torque(np.array(w) / np.linalg.norm(w))) / (2 * h)
            for u, w in (((h, 0, 1), (-h, 0, 1)), ((0, h, 1), (0, -h, 1)))
        ]
    ).T
    p, q = (slopes[0, 0] + slopes[1, 1]) / 2, (slopes[1, 0] - slopes[0, 1]) / 2
    assert (p, q) == pytest.approx((-3.88302393e-5, 3.32629101e-4), rel=1e-6)
    along = torque(np.array([0, 0, 1.0]))[2]
    assert along == pytest.approx(3.718575583e-5, rel=1e-8)
    averaged = model(body((350, 350, 600), motion=AVERAGED, **said), shape, cells=16)
    z = (np.cos(a), np.sin(a), 0.0)
    mean = flown(averaged, STILL, (*z, 0, 0, 0, spin), [t], 1e-10)
    # the Sun along x: the tilt's plane is y, z, counted about it
    zeta = np.sin(a) * np.exp(-(p + 1j * q) / along * np.log(1 + along * t / (600 * spin)))
    assert mean[Q + 1 : Q + 3, 0] == pytest.approx((zeta.real, zeta.imag), abs=2e-4 * np.sin(a) + 2e-5)
    assert mean[RATE + 2, 0] == pytest.approx(spin + along * t / 600, rel=2e-4)
