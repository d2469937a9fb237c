"""Small runs made with numpy alone: closed-form motions with the thrust that they take, so that every column means
something.
"""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sailviz.constants import ROTATION_EARTH
from sailviz.elements import elements, state
from sailviz.frames import body_axes, from_frame, pitch_cone_clock, quaternion, rtn, to_frame, unit
from sailviz.recording import record
from sailviz.recording.timelines import take
from sailviz.run.arrays import Attitude, Body, Craft, Event, Reference, Run, Setting, Shell, Thrust

AU = 149_597_870_700.0
MU_SUN = 1.327_124_400_18e20
MU_EARTH = 3.986_004_415e14
RADIUS_EARTH = 6_378_137.0
DAY = 86_400.0
YEAR = 365.25 * DAY
GREENWICH = 1.2  # rad, direction of longitude 0 at the start
PLANETS = {"Venus": 0.723, "Earth": 1.0}


def assemble(
    setting,
    time,
    position,
    velocity,
    acceleration,
    normal,
    *,
    mass=1.0,
    on=None,
    environment=None,
    bodies=None,
    events=(),
):
    """A whole Run from its motion, thrust and normal; angles, elements and quaternions follow from them."""
    axes = rtn(position, velocity)
    acceleration = np.broadcast_to(acceleration, position.shape).copy()
    size = np.linalg.norm(acceleration, axis=1)
    return Run(
        setting=setting,
        first=0,
        time=time,
        position=position,
        velocity=velocity,
        mass=np.full(len(time), float(mass)),
        attitude=Attitude(
            *pitch_cone_clock(axes, normal, acceleration), normal, quaternion(body_axes(normal, axes[..., 1]))
        ),
        thrust=Thrust(acceleration, to_frame(axes, acceleration), size, size > 0 if on is None else on),
        elements=elements(position, velocity, setting.body.mu),
        environment=environment or {},
        bodies=bodies or {},
        events=tuple(events),
    )


def setting_of(family, rows, duration, body, craft, references=(), **more):
    values = {
        "title": f"A run of the family {family}",
        "about": "A motion in closed form, for the tests.",
        "look_for": ("the orange arrow: the thrust", "the plots: nothing jumps"),
        "thesis": "4.2",
        "epoch": np.datetime64("2030-01-01T00:00:00", "ns"),
        "parameters": (("radius", "0.95 au"), ("elevation", "10 deg")),
        "text": f'title = "{family}"\n',
        "resolved": {"family": family, "rows": rows, "duration": duration},
        "versions": {"sailviz": "0", "rerun-sdk": "0.41.0"},
        "accuracy": "closed form",
        "identity": f"{family}-{rows}-{duration:.0f}",
    }
    return Setting(
        family=family,
        duration=duration,
        rows=rows,
        body=body,
        craft=craft,
        references=tuple(references),
        **{**values, **more},
    )


def circle(radius, height=0.0, points=181):
    phase = np.linspace(0, 2 * np.pi, points)
    return np.stack([radius * np.cos(phase), radius * np.sin(phase), np.full(points, height)], axis=1)


def planets(time):
    """Where the planets are, on circles."""
    return {
        name: AU
        * a
        * np.stack(
            [
                np.cos(time * np.sqrt(MU_SUN / (a * AU) ** 3) + 2 * a),
                np.sin(time * np.sqrt(MU_SUN / (a * AU) ** 3) + 2 * a),
                0 * time,
            ],
            1,
        )
        for name, a in PLANETS.items()
    }


def planet_orbits():
    return [Reference(name, "planet", circle(a * AU)) for name, a in PLANETS.items()]


def displaced_run(rows=300, years=1.5, elevation=0.21, radius=0.95 * AU, epoch=True):
    """An E-sail on a circle above the ecliptic: the thrust is what the circle takes, the normal leans twice as far as
    it.
    """
    time = np.linspace(0, years * YEAR, rows)
    omega = 0.8 * np.sqrt(MU_SUN / radius**3)
    rho, height = radius * np.cos(elevation), radius * np.sin(elevation)
    c, s, z = np.cos(omega * time), np.sin(omega * time), np.zeros(rows)
    position = np.stack([rho * c, rho * s, z + height], 1)
    velocity = np.stack([-rho * omega * s, rho * omega * c, z], 1)
    needed = -(omega**2) * np.stack([rho * c, rho * s, z], 1) + MU_SUN * position / radius**3
    r_hat, thrust = unit(position), unit(needed)
    normal = unit(
        2 * np.sum(r_hat * thrust, 1, keepdims=True) * thrust - r_hat
    )  # mirror r_hat at the thrust: twice the angle
    setting = setting_of(
        "displaced",
        rows,
        years * YEAR,
        Body("Sun", MU_SUN, 6.957e8),
        Craft("electric-sail", "E-sail", tethers=100, tether_length=20e3),
        [*planet_orbits(), Reference("Displaced orbit", "target", circle(rho, height))],
        **({} if epoch else {"epoch": None}),
    )
    return assemble(
        setting,
        time,
        position,
        velocity,
        needed,
        normal,
        mass=300.0,
        bodies=planets(time),
        events=[Event("halfway", 0.5 * years * YEAR + 1.0, np.arange(7.0))],
    )


def spiral_run(rows=300, years=1.5, pitch=0.6155):
    """A solar sail inwards on a logarithmic spiral, the normal leaning against the motion; the last tenth coasts."""
    time = np.linspace(0, years * YEAR, rows)
    slope = -0.05
    rate = 1.5 * slope * np.sqrt(MU_SUN / AU**3)
    r = AU * (1 + rate * time) ** (2 / 3)  # r' = slope sqrt(mu / r)
    theta = np.log(r / AU) / slope
    c, s, z = np.cos(theta), np.sin(theta), np.zeros(rows)
    r_hat, t_hat = np.stack([c, s, z], 1), np.stack([-s, c, z], 1)
    v = np.sqrt(MU_SUN / r)[:, None]
    position, velocity = r[:, None] * r_hat, slope * v * r_hat + v * t_hat
    wobble = pitch + np.radians(3) * np.sin(3 * theta)
    normal = np.cos(wobble)[:, None] * r_hat - np.sin(wobble)[:, None] * t_hat
    on = np.arange(rows) < 0.9 * rows
    acceleration = on[:, None] * 0.05 * (MU_SUN / r**2 * np.cos(wobble) ** 2)[:, None] * normal
    setting = setting_of(
        "spirals",
        rows,
        years * YEAR,
        Body("Sun", MU_SUN, 6.957e8),
        Craft("solar-sail", "Solar sail", side=40.0),
        planet_orbits(),
    )
    environment = {"thrust_factor": 1 + 0.2 * np.sin(5 * theta), "solar_wind_pressure_Pa": 2e-9 * (AU / r) ** 2}
    return assemble(
        setting, time, position, velocity, acceleration, normal, on=on, environment=environment, bodies=planets(time)
    )


def descent_run(rows=300, days=52.0, high=700e3, low=500e3, revolutions=None, time=None):
    """A plasma brake from one circular orbit to a lower one, nearly circular on the way, the tether hanging from the
    satellite; at times of one's own, if given.
    """
    time = np.linspace(0, days * DAY, rows) if time is None else np.asarray(time, float)
    rows, days = len(time), time[-1] / DAY
    a = RADIUS_EARTH + high - (high - low) * (time / time[-1]) ** 1.3
    mean_motion = np.sqrt(MU_EARTH / a**3)
    phase = np.concatenate([[0.0], np.cumsum(0.5 * (mean_motion[1:] + mean_motion[:-1]) * np.diff(time))])
    if revolutions is not None:
        phase *= revolutions * 2 * np.pi / phase[-1]
    position, velocity = state(a, 1e-4, np.radians(98), np.radians(40) + 2e-7 * time, 0.0, phase, MU_EARTH)
    force = 60e-9 * np.exp(-(a - RADIUS_EARTH - 500e3) / 150e3) * (1 + 0.4 * np.sin(phase))
    acceleration = -unit(velocity) * (force * 500.0 / 10.0)[:, None]
    longitude = np.radians(280) + 2 * np.pi * time / YEAR
    sun = AU * np.stack([np.cos(longitude), 0.917 * np.sin(longitude), 0.398 * np.sin(longitude)], 1)
    setting = setting_of(
        "deorbit",
        rows,
        days * DAY,
        Body("Earth", MU_EARTH, RADIUS_EARTH),
        Craft("plasma-brake", "Plasma brake", tethers=1, tether_length=500.0),
    )
    environment = {"plasma_force_N_m": force, "plasma_density_m3": 1e11 * np.exp(-(a - RADIUS_EARTH - 500e3) / 100e3)}
    return assemble(
        setting,
        time,
        position,
        velocity,
        acceleration,
        from_frame(rtn(position, velocity), np.tile([1.0, 0, 0], (rows, 1))),
        mass=10.0,
        environment=environment,
        bodies={"Sun": sun},
        events=[Event("altitude 600 km", time[-1] * 0.587, np.zeros(7))],
    )


def in_blocks(run, size):
    """The same run as consecutive blocks, each with the events up to its end."""
    blocks, told = [], -np.inf
    for start in range(0, len(run), size):
        block = take(run, slice(start, start + size))
        events = tuple(event for event in run.events if told < event.time <= block.time[-1])
        blocks.append(replace(block, first=start, events=events))
        told = block.time[-1]
    return blocks


def with_everything(run):
    """The run with every column that an environment may fill, of the right size and sign but made up."""
    height = np.linalg.norm(run.position, axis=1) - RADIUS_EARTH
    sun = unit(run.bodies["Sun"])
    ahead = np.sum(run.position * sun, 1)
    density = 1e11 * np.exp((500e3 - height) / 150e3)
    normal = unit(np.cross(run.position[0], run.velocity[0]))
    angle, altitude = np.linspace(0, 2 * np.pi, 48, endpoint=False), np.linspace(100e3, 1000e3, 31)
    value = 1e9 + 1e12 * np.exp(-(((altitude - 350e3) / 150e3) ** 2)) * (1.1 + np.cos(angle))[:, None]
    noon = unit(sun[0] - sun[0] @ normal * normal)
    environment = {
        "sunlit": (ahead > 0) | (np.linalg.norm(run.position - ahead[:, None] * sun, axis=1) > RADIUS_EARTH),
        "plasma_force_N_m": 3e-19 * density,
        "plasma_density_per_m3": density,
        "mean_ion_mass_u": 16 - 6 * height / 1e6,
        "tether_current_A": 1e-14 * density,
        "tether_voltage_V": np.full(len(run), -1000.0),
        "tether_power_W": 1e-11 * density,
        "tether_tilt_rad": 1e-13 * density,
        "air_density_kg_m3": 1e-12 * np.exp((400e3 - height) / 60e3),
        "air_drag_N": 1e-6 * np.exp((400e3 - height) / 60e3),
        "solar_flux_sfu": 140 + 40 * np.sin(run.time / 1e7),
        "force_law_valid": height < 690e3,
        "quasi_circular_altitude_m": run.elements.semi_major_axis - RADIUS_EARTH + 2e3,
        "earth_rotation_rad": np.mod(GREENWICH + ROTATION_EARTH * run.time, 2 * np.pi),
        "primer_direction": unit(run.velocity),
    }
    shells = (Shell("plasma density", "1/m³", normal, noon, angle, altitude, value),)
    return replace(run, environment=environment, setting=replace(run.setting, shells=shells))


def uneven(days=1095.0, far=1000, close=1000, pace=60.0):
    """Times of rows that are far apart but in one dense window."""
    window = 0.4 * days * DAY + pace * np.arange(close)
    return np.unique(np.concatenate([np.linspace(0, days * DAY, far), window]))


FAMILIES = {"displaced": displaced_run, "spirals": spiral_run, "deorbit": descent_run}


@pytest.fixture(scope="session")
def runs():
    """Makers of runs, and the cutting of a run into blocks."""
    return SimpleNamespace(displaced=displaced_run, spiral=spiral_run, descent=descent_run, in_blocks=in_blocks)


@pytest.fixture(params=FAMILIES)
def any_run(request):
    """One run of each family."""
    return FAMILIES[request.param]()


@pytest.fixture
def run():
    return displaced_run()


@pytest.fixture(scope="module", params=FAMILIES)
def recorded_family(request, tmp_path_factory):
    """Name and recording of a run of each family."""
    path = tmp_path_factory.mktemp("families") / f"{request.param}.rrd"
    record(FAMILIES[request.param](rows=200), path)
    return request.param, path


@pytest.fixture(scope="session")
def low_orbit():
    """Runs over days to years in a low orbit: everything that an environment may hold, and rows uneven in time."""
    return SimpleNamespace(with_everything=with_everything, uneven=uneven, RADIUS=RADIUS_EARTH, GREENWICH=GREENWICH)


@pytest.fixture(scope="session")
def years(tmp_path_factory):
    """A descent of three years with a dense window, and its recording."""
    run = with_everything(descent_run(time=uneven(), high=800e3, low=250e3))
    path = tmp_path_factory.mktemp("years") / "years.rrd"
    record(run, path)
    return run, path
