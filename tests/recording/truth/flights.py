"""Short runs of every family, each recorded once: the smallest that draw everything that the family can draw."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import trimesh

import sailviz
from sailviz import frames
from sailviz.run.from_arrays import trajectory

from .facts import MADE_UP, Truth
from .picture import Picture

BESIDE = re.compile("/flight/[^/]+/state")
AU, DAY = 149_597_870_700.0, 86_400.0
MU_SUN, MU_EARTH, EARTH = 1.327_124_400_18e20, 3.986_004_415e14, 6_378_137.0


@dataclass(frozen=True)
class Flight:
    """A recording as a picture and as numbers."""

    name: str
    path: Path
    word: str = ""  # of a flight beside the first, in its paths

    @cached_property
    def picture(self) -> Picture:
        return Picture(self.path)

    @cached_property
    def all(self) -> list[Flight]:
        """The flights of one picture, the first one first."""
        others = [entity.split("/")[2] for entity in self.picture.entities if BESIDE.fullmatch(entity)]
        return [self, *map(self.beside, others)] if not self.word else self._first.all

    def beside(self, word: str) -> Flight:
        """A flight beside this one, in the same picture."""
        known = self.__dict__.setdefault("_beside", {})
        if word not in known:
            known[word] = Flight(self.name, self.path, word)
            known[word].__dict__.update(picture=self.picture, _first=self)
        return known[word]

    @cached_property
    def called(self) -> str:
        """The name of this flight among several."""
        facts = self.truth.recording["/scene"]
        names = [str(name) for name in np.ravel(facts["flights"])]
        if not self.word:
            return names[0]
        return str(self.truth.recording[f"/flight/{self.word}/scene"]["name"][0])

    def spreads(self, time) -> list[tuple[float, str]]:
        """Standard deviation of the distance from the Sun, au, of each ensemble at a time, s, with its name."""
        found = []
        for entity in self.picture.entities:
            if entity.startswith("/ensemble/") and entity.count("/") == 2:
                table = self.truth.recording[entity]
                sigma = np.sqrt(np.maximum(table["covariance_m2"].reshape(-1, 3, 3)[:, 0, 0], 0.0)) / AU
                found.append((float(np.interp(time, table["time_s"], sigma)), entity))
        return found

    @property
    def ensembles(self) -> dict[str, np.ndarray]:
        """Percentiles of the distance, m, by the name of each ensemble; of nominal flights where they are not known."""
        found = {}
        for entity in self.picture.entities:
            if entity.startswith("/ensemble/") and entity.count("/") == 2:
                table = self.truth.recording[entity]
                own = np.linalg.norm(table["nominal_position_m"], axis=1)
                found[entity] = table.get("radius_m", own)
        return found

    @cached_property
    def truth(self) -> Truth:
        top = f"/flight/{self.word}" if self.word else ""
        return Truth(sailviz.read(self.path), slowed=self.name in SLOWED, top=top)


def scene(name: str, **values) -> Callable[[], sailviz.Run]:
    """A shipped scene with some values changed: the keys' dots are written as two underscores."""
    changes = {key.replace("__", "."): value for key, value in values.items()}
    return lambda: sailviz.simulate(sailviz.load_scene(name, changes))


def tumbling(count: int, period: float, phase: float):
    """Unit vectors (count, 3) that point everywhere in turn."""
    angle = phase + np.linspace(0, 2 * np.pi, count) * period
    vectors = np.stack([np.cos(angle), np.sin(1.7 * angle), np.sin(angle) + 0.4], 1)
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def ellipse(time, mu, size, eccentricity, tilt):
    """Position and velocity (n, 3) on a tilted ellipse, by Kepler's equation; no axis of it lies along x, y or z."""
    anomaly = mean = np.sqrt(mu / size**3) * np.asarray(time)
    for _ in range(60):
        anomaly = mean + eccentricity * np.sin(anomaly)
    across = np.sqrt(1 - eccentricity**2)
    rate = np.sqrt(mu / size**3) / (1 - eccentricity * np.cos(anomaly))
    flat = size * np.stack([np.cos(anomaly) - eccentricity, across * np.sin(anomaly), 0 * anomaly], 1)
    pace = (size * rate)[:, None] * np.stack([-np.sin(anomaly), across * np.cos(anomaly), 0 * anomaly], 1)
    c, s = np.cos(0.7), np.sin(0.7)
    turned = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]])
    turned = turned @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return flat @ turned.T, pace @ turned.T


def own_sail():
    """A sail that points anywhere, its thrust elsewhere, switched off for a while."""
    time = np.linspace(0, 400 * DAY, 33)
    position, velocity = ellipse(time, MU_SUN, 0.9 * AU, 0.2, 0.3)
    out = position / np.linalg.norm(position, axis=1, keepdims=True)
    normal = out + 0.9 * tumbling(33, 2, 0.3)
    thrust = 1e-3 * (out + 0.5 * tumbling(33, 3, 1.0)) * (1 + 0.5 * np.sin(time / 5e6))[:, None]
    thrust[20:24] = 0.0
    return trajectory(
        time,
        position,
        velocity,
        normal=normal,
        thrust=thrust,
        side=60.0,
        epoch="2031-04-01T06:00:00",
        events=[("flare", 100.3 * DAY), ("eclipse of a star", 250.0 * DAY)],
        references={"a ring": AU * np.stack([np.cos(time), np.sin(time), 0.1 * np.sin(time)], 1)},
        environment={
            "solar_wind_pressure_Pa": 2e-9 * (1 + 0.3 * np.sin(time / 1e6)),
            "field_T": np.full(33, 5e-9) * (1 + time / time[-1]),
            "thrust_voltage_V": 20e3 + time / 1e5,
            "film_temperature_K": 300 + time / 1e6,
            "warm": time > 200 * DAY,
        },
    )


def own_thruster():
    """Round the Earth with an engine that fires at times, and no rows for two hours."""
    time = DAY * np.concatenate([np.linspace(0, 0.17, 35), np.linspace(0.28, 0.42, 30)])
    position, velocity = ellipse(time, MU_EARTH, EARTH + 2000e3, 0.1, 1.1)
    thrust = 2e-5 * tumbling(len(time), 2, 0.2)
    thrust[10:20] = thrust[40:45] = 0.0
    return trajectory(time, position, velocity, thrust=thrust, mu=MU_EARTH, epoch="2027-09-10T03:00:00")


def own_film():
    """A sail round the Earth, which tumbles in her shadow and out of it."""
    time = DAY * np.linspace(0, 0.3, 81)
    position, velocity = ellipse(time, MU_EARTH, EARTH + 1200e3, 0.02, 0.9)
    normal = tumbling(len(time), 3, 0.4)
    thrust = 4e-5 * normal * (1 + 0.3 * np.sin(time / 900.0))[:, None]
    options = {"mu": MU_EARTH, "epoch": "2027-09-10T03:00:00", "device": "solar-sail", "side": 9.0}
    return trajectory(time, position, velocity, normal=normal, thrust=thrust, **options)


def own_point():
    """A dust grain round a body that is a point, without a date, going round sixty times: drawn slowed."""
    time = np.linspace(0, 60 * 2 * np.pi * np.sqrt(1500.0**3 / 5.0), 27)
    position, velocity = ellipse(time, 5.0, 1500.0, 0.3, 0.4)
    return trajectory(time, position, velocity, mu=5.0, body="Bennu", title="Dust")


def kepler(time, mu, position, velocity):
    """Places and velocities of an unpowered flight, by SciPy's DOP853."""
    from scipy.integrate import solve_ivp

    def fall(_, y):
        return np.concatenate([y[3:], -mu * y[:3] / np.linalg.norm(y[:3]) ** 3])

    y = solve_ivp(fall, (0, time[-1]), [*position, *velocity], "DOP853", time, rtol=1e-12, atol=1e-6).y.T
    return y[:, :3], y[:, 3:]


def several_devices(pitch=35):
    """A sail, an electric sail and a thruster that fires at times, each turned its own way."""
    sail = {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 0.7}
    wheel = {
        "kind": "electric-sail",
        "characteristic_acceleration_mm_s2": 0.4,
        "active_d": [[0, 260]],
        "steering": {"kind": "meridian", "pitch_deg": 25, "clock_deg": -40},
    }
    engine = {
        "kind": "thruster",
        "name": "Ion engine",
        "mass_kg": 300,
        "thrust_mN": 80,
        "specific_impulse_s": 3000,
        "active_d": [[60, 130], [200, 330]],
        "steering": {"kind": "inertial", "direction": [0.5, 0.2, 1]},
    }
    return sailviz.simulate(
        {
            "title": "several devices",
            "start": {"kind": "elements", "semi_major_axis_au": 0.9, "eccentricity": 0.1, "inclination_deg": 25},
            "device": [sail, engine, wheel],
            "steering": {"kind": "orbital", "pitch_deg": pitch, "clock_deg": 60},
            "propagation": {"duration_d": 400, "outputs": 61},
        }
    )


def own_gaps():
    """A sail that is stowed for a while, twice without data: rows that are lost, and a silence between rows."""
    time = 420 * DAY * np.linspace(0, 1, 85)
    position, velocity = kepler(time, MU_SUN, [0.8 * AU, 0, 0], [2e3, 36e3, 6e3])
    out = position / np.linalg.norm(position, axis=1, keepdims=True)
    normal = out + 0.6 * tumbling(85, 2, 0.3)
    thrust = 2e-6 * normal
    normal[60:68] = thrust[60:68] = 0.0
    lost = slice(20, 33)
    position[lost] = velocity[lost] = normal[lost] = np.nan
    thrust[lost] = 0.0
    kept = np.r_[0:45, 52:85]
    silence = [(time[44] + DAY, time[52] - DAY)]
    options = {"normal": normal[kept], "thrust": thrust[kept], "side": 30.0, "epoch": "2031-04-01"}
    about = "The clock goes round."
    return trajectory(time[kept], position[kept], velocity[kept], gaps=silence, about=about, **options)


def own_wheel():
    """An E-sail that is stowed at its end, without a date."""
    time = 300 * DAY * np.linspace(0, 1, 41)
    position, velocity = kepler(time, MU_SUN, [AU, 0, 0], [0, 30e3, 1e3])
    normal = position / AU + 0.3 * tumbling(41, 1, 0.2)
    thrust = 1e-6 * normal
    normal[30:] = thrust[30:] = 0.0
    return trajectory(time, position, velocity, normal=normal, thrust=thrust, device="electric-sail")


def own_sparse():
    """Five rows in each revolution of an eccentric orbit, and a gap."""
    time = np.linspace(0, 4 * 365.25 * DAY, 21)
    position, velocity = kepler(time, MU_SUN, [0.7 * AU, 0, 0], [0, 40e3, 5e3])
    return trajectory(time, position, velocity, gaps=[(time[12], time[13])], title="Five rows a turn")


def own_steps():
    """A sail with eight rows in a revolution, pushed hard: the way between rows is bent, the wall follows it."""
    from scipy.integrate import solve_ivp

    def push(y):
        out = y[:3] / np.linalg.norm(y[:3])
        ahead = np.cross(np.cross(y[:3], y[3:]), out)
        return 1e-4 * (AU / np.linalg.norm(y[:3])) ** 2 * (0.8 * out + 0.6 * ahead / np.linalg.norm(ahead))

    def fall(_, y):
        return np.concatenate([y[3:], push(y) - MU_SUN * y[:3] / np.linalg.norm(y[:3]) ** 3])

    time = np.linspace(0, 900 * DAY, 21)
    start = [AU, 0, 0, 0, 29e3, 3e3]
    y = solve_ivp(fall, (0, time[-1]), start, "DOP853", time, rtol=1e-12, atol=1e-3).y.T
    thrust = np.array([push(row) for row in y])
    return trajectory(time, y[:, :3], y[:, 3:], normal=thrust, thrust=thrust, gaps=[(time[15], time[16])])


def own_low_gap():
    """Round the Earth, two revolutions without data."""
    time = np.concatenate([np.arange(10) * 300.0, 14_700 + np.arange(10) * 300.0])
    position, velocity = kepler(time, MU_EARTH, [7e6, 0, 0], [0, 3773.0, 6535.0])
    options = {"mu": MU_EARTH, "epoch": "2031-03-01", "gaps": [(time[9], time[10])]}
    return trajectory(time, position, velocity, **options)


def together_sails():
    """Three fast ways, none of which takes as long as another, without a date."""
    return {
        "ideal": scene("transfers/earth-mars-ideal", propagation__outputs=41)(),
        "real film": scene("transfers/earth-mars-jpl-2015", propagation__outputs=53)(),
        "to Venus": scene("transfers/earth-venus-ideal", propagation__outputs=25)(),
    }


def together_devices():
    """A sail, an electric sail and a thruster, of which one turns its sail another way."""
    return {"as it was": several_devices(), "leaning": several_devices(20)}


def together_dated():
    """Sails by date: one starts 60 days before the first and has a gap, one 40 days after it and ends later."""
    runs, days = {}, {"first": (0, 300, 37), "early bird": (-60, 250, 33), "late": (40, 380, 45)}
    for number, (name, (start, length, count)) in enumerate(days.items()):
        time = length * DAY * np.linspace(0, 1, count)
        position, velocity = kepler(time, MU_SUN, [AU, 0.05 * number * AU, 0], [1e3, 29e3 + 2e3 * number, 4e3])
        normal = position / np.linalg.norm(position, axis=1, keepdims=True) + 0.4 * tumbling(count, 2, number)
        thrust = (1 + number) * 1e-4 * normal * (1 + 0.4 * np.sin(time / 2e6))[:, None]
        runs[name] = trajectory(
            time,
            position,
            velocity,
            normal=normal,
            thrust=thrust,
            epoch=np.datetime64("2031-04-01") + np.timedelta64(start, "D"),
            title=f"Sail {number}",
            events=[("flare", 200 * DAY)],
            gaps=[(time[12], time[13])] if number == 1 else [],
        )
    return runs


def together_low():
    """A brake, and beside it two satellites without one, one of them elsewhere."""
    time = DAY * np.linspace(0, 0.5, 91)
    options = {"mu": MU_EARTH, "epoch": "2019-03-20T22:00:00", "family": "deorbit"}
    runs = {
        "tether": scene("deorbit/gravity-gradient", propagation__duration_d=0.45, propagation__output_interval_min=7)()
    }
    for name, height, tilt in (("alone", 700e3, 1.7), ("far off", 900e3, 0.6)):
        position, velocity = ellipse(time, MU_EARTH, EARTH + height, 0.01, tilt)
        runs[name] = trajectory(time, position, velocity, **options)
    return runs


SMALL = {"propagation__outputs": 31}


def tumbling_or_not():
    """Two ensembles of a sail that is let go with errors."""
    several = [one | {"flights": 9, "keep": 5} for one in sailviz.load_scene("body/tumble-or-not").raw["ensemble"]]
    values = {"ensemble": several, "expect": [], "propagation.outputs": 61, "propagation.duration_h": 6}
    return sailviz.simulate(sailviz.load_scene("body/tumble-or-not", values))


def round_a_planet():
    """A sail high over the Earth, its light from an even Sun, clock angle and all."""
    return sailviz.simulate(
        {
            "title": "Round a planet: the clock angle",
            "body": "earth",
            "start": {"kind": "circular", "radius_km": 42164, "inclination_deg": 20},
            "device": {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 1.0, "film": "jpl-2015"},
            "steering": {"kind": "sun-frame", "pitch_deg": 30, "clock_deg": 70},
            "propagation": {"duration_d": 4, "outputs": 61},
        }
    )


def several_in_phases():
    """A sail and a thruster that take turns, each turned anew."""
    ahead = {"kind": "thruster", "name": "engine", "acceleration_mm_s2": 0.3, "steering": {"kind": "tangential"}}
    up = {"kind": "inertial", "direction": [0, 0, 1]}
    return sailviz.simulate(
        {
            "title": "A sail and a thruster take turns",
            "start": {"kind": "circular", "radius_au": 0.9},
            "device": [ahead, {"kind": "solar-sail", "name": "sail", "characteristic_acceleration_mm_s2": 0.6}],
            "steering": {"kind": "orbital", "pitch_deg": 35, "clock_deg": 270},
            "propagation": {"duration_d": 240, "outputs": 121},
            "phase": [
                {"name": "spiral in", "until": {"duration_d": 80}, "device": [{"name": "engine", "on": False}]},
                {"name": "crank", "until": "time_d = 170", "device": [{"name": "engine", "steering": up}]},
                {"name": "watch the poles", "device": [{"name": "sail", "on": False}, {"name": "engine", "on": False}]},
            ],
        }
    )


def several_round_a_planet():
    """A sail and a thruster high over the Earth: two parts of a push in the frame of the light."""
    ahead = {"kind": "thruster", "acceleration_mm_s2": 0.4, "steering": {"kind": "tangential"}}
    return sailviz.simulate(
        {
            "title": "A sail and a thruster",
            "body": "earth",
            "start": {"kind": "circular", "radius_km": 42164, "inclination_deg": 20},
            "device": [{"kind": "solar-sail", "characteristic_acceleration_mm_s2": 0.6}, ahead],
            "steering": {"kind": "sun-frame", "pitch_deg": 30, "clock_deg": 70},
            "propagation": {"duration_d": 3, "outputs": 41},
        }
    )


def in_and_out_of_the_wind():
    """A wheel on an ellipse that leaves the magnetosphere."""
    return sailviz.simulate(
        {
            "title": "Wind on, wind off",
            "body": "earth",
            "start": {
                "kind": "elements",
                "semi_major_axis_km": 150000,
                "eccentricity": 0.6,
                "inclination_deg": 30,
                "argument_deg": 90,
                "true_anomaly_deg": 180,
            },
            "device": {"kind": "electric-sail", "characteristic_acceleration_mm_s2": 0.3},
            "steering": {"kind": "sun-facing"},
            "propagation": {"duration_d": 12, "outputs": 61},
        }
    )


def beside_the_earth():
    """A sail inside the Earth's orbit, between her and the Sun."""
    return sailviz.simulate(
        {
            "title": "Beside the Earth",
            "epoch": "2026-03-20T00:00:00",
            "start": {
                "kind": "cartesian",
                "position_km": [-145961377.86608, 2481234.250222, 442.84338],
                "velocity_km_s": [-0.96766064654, -29.3103407029, 0.00081063934],
            },
            "device": {"kind": "solar-sail", "film": "ideal", "characteristic_acceleration_mm_s2": 0.305972616},
            "steering": {"kind": "sun-facing"},
            "propagation": {"duration_d": 60, "outputs": 41},
        }
    )


def many_turns():
    """A sail that goes round the Earth 36 times, in 201 rows."""
    return sailviz.simulate(
        {
            "title": "Many turns in few rows",
            "body": "earth",
            "start": {"kind": "elements", "semi_major_axis_km": 108428.329, "eccentricity": 0.35, "inclination_deg": 9},
            "device": {"kind": "solar-sail", "characteristic_acceleration_mm_s2": 0.096, "film": "ideal"},
            "steering": {"kind": "sun-facing"},
            "environment": {"shadow_of": []},
            "propagation": {"duration_d": 150, "outputs": 201},
        }
    )


def to_the_moon():
    """A ballistic flight past the Moon."""
    return sailviz.simulate(
        {
            "title": "To the Moon",
            "body": "earth",
            "epoch": "2026-03-20T00:00:00",
            "start": {
                "kind": "cartesian",
                "position_km": [-265.429056, -5871.099606, -3171.316859],
                "velocity_km_s": [10.819975519, -0.551974072, 0.116279415],
            },
            "device": {"kind": "none"},
            "environment": {"gravity_of": ["moon", "sun"]},
            "propagation": {"duration_d": 10, "outputs": 61},
        }
    )


def lopsided() -> trimesh.Scene:
    """A plate and a box, in mm, alike in no two directions; the front of the plate is along +x."""
    scene = trimesh.Scene()
    plate = [[0, -900, -200], [0, 1500, -200], [0, 1500, 700], [0, -900, 700]]
    scene.add_geometry(trimesh.Trimesh(plate, [[0, 1, 2], [0, 2, 3]], process=False), geom_name="plate")
    box = trimesh.creation.box([300, 400, 500])
    box.apply_translation([-250, 100, 50])
    scene.add_geometry(box, geom_name="box")
    return scene


def quaternions() -> sailviz.Run:
    """Arrays with an attitude of their own, rolled about the normal, and with a mesh of their own."""
    angle = np.linspace(0.0, 1.5, 25)
    place = AU * np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    speed = np.sqrt(MU_SUN / AU) * np.stack([-np.sin(angle), np.cos(angle), 0 * angle], 1)
    axes = frames.body_axes(frames.unit(place + np.array([0.0, 0.0, 0.4 * AU])), np.tile([0.2, 0.4, 0.9], (25, 1)))
    return trajectory(
        angle * np.sqrt(AU**3 / MU_SUN), place, speed, attitude=frames.quaternion(axes), scalar="last",
        direction="body_to_world", thrust=3e-4 * axes[..., 2], mesh=lopsided(), unit="mm", front="+x",
    )  # fmt: skip


def billowed() -> sailviz.Run:
    """A square sail that billows, a bus on its Sun side whose shadow falls on it, rolled, out of the plane."""
    from sailviz.shapes.shadows import ray_caster

    bus = {"size_m": [1.2, 1.0, 0.8], "centre_m": [0.3, -0.2, -1.5]}
    shape = {"kind": "square", "side_m": 10, "cone_deg": 4, "sag": 0.03, "bus": bus, "cells": 2}
    return sailviz.simulate(
        {
            "title": "billowed",
            "start": {"kind": "circular", "radius_au": 1, "inclination_deg": 10},
            "device": {
                "kind": "solar-sail",
                "mass_kg": 5,
                "film": "jpl-2015",
                "back": "same",
                "roll_deg": 25,
                "shape": shape | {"shadow": ray_caster() == "embreex"},
            },
            "steering": {"kind": "orbital", "pitch_deg": 35, "clock_deg": 60},
            "propagation": {"duration_d": 300, "outputs": 41},
        }
    )


BUS = {"size_m": [1.2, 1.0, 0.8], "centre_m": [0.3, -0.2, -1.5]}
SAIL = {"kind": "solar-sail", "mass_kg": 5, "film": "jpl-2015", "back": "same"}
UNEVEN = {
    "kind": "free",
    "inertia_kg_m2": [[20e8, 1e8, 0.5e8], [1e8, 26e8, -2e8], [0.5e8, -2e8, 40e8]],  # so slow that its copies show
    "centre_of_mass_m": [0.06, -0.04, -0.5],
    "clock_deg": 60,
    "roll_deg": 25,
}


def turning() -> sailviz.Run:
    """A square sail that nobody holds turns over, out of the plane; a bus throws its shadow on it, or has that of the
    film."""
    from sailviz.shapes.shadows import ray_caster

    shape = {"kind": "square", "side_m": 10, "bus": BUS, "cells": 2, "shadow": ray_caster() == "embreex"}
    return sailviz.simulate(
        {
            "title": "turning",
            "start": {"kind": "circular", "radius_au": 1, "inclination_deg": 10},
            "device": SAIL | {"shape": shape},
            "attitude": UNEVEN | {"pitch_deg": 35, "rates_deg_s": [3e-5, 5e-5, 1e-5]},
            "propagation": {"duration_d": 100, "outputs": 49},
        }
    )


def turning_low() -> sailviz.Run:
    """The same in a low orbit, where air turns it too, in and out of the Earth's shadow."""
    from sailviz.shapes.shadows import ray_caster

    shape = {"kind": "square", "side_m": 10, "bus": BUS, "cells": 2, "shadow": ray_caster() == "embreex"}
    return sailviz.simulate(
        {
            "title": "turning low",
            "body": "earth",
            "start": {"kind": "circular", "altitude_km": 500, "inclination_deg": 40},
            "light": {"kind": "fixed", "direction": [0.8, 0.6, 0], "distance_au": 1},
            "environment": {"atmosphere": {"kind": "exponential", "density_kg_m3": 1e-14, "scale_height_km": 60}},
            "device": SAIL | {"shape": shape | {"air": {"law": "hyperthermal"}}},
            "attitude": UNEVEN | {"inertia_kg_m2": [20, 26, 40], "pitch_deg": 35, "rates_deg_s": [0.02, 0.03, 0.01]},
            "propagation": {"duration_h": 3, "outputs": 121},
        }
    )


def turning_file() -> sailviz.Run:
    """A craft of a file, alike in no two directions, that turns by itself."""
    mesh = lopsided()
    mesh.apply_scale(1e-3)
    lines = """
        title = "turning file"
        start = {kind = "circular", radius_au = 1, inclination_deg = 10}
        propagation = {duration_d = 90, outputs = 41}
        [device]
        kind = "solar-sail"
        mass_kg = 5
        film = "jpl-2015"
        back = "same"
        shape = {kind = "file", file = "plate.glb", front = "+x", cells = 2, shadow = false}
        [attitude]
        kind = "free"
        inertia_kg_m2 = [4e8, 12e8, 15e8]
        centre_of_mass_m = [0.2, -0.1, 0.05]
        pitch_deg = 20
        clock_deg = 60
        roll_deg = 25
        rates_deg_s = [2e-5, 3e-5, 5e-5]
        """
    with tempfile.TemporaryDirectory() as folder:
        mesh.export(Path(folder) / "plate.glb")
        (Path(folder) / "turning file.toml").write_text(lines)
        return sailviz.simulate(Path(folder) / "turning file.toml")


def competition() -> sailviz.Run:
    """A flyby of a planet of GTOC13, and a sail after it that breaks a rule: it ends far from where it says."""
    from sailviz.checks.gtoc13 import judge, sail
    from sailviz.checks.gtoc13.replay import replay

    text = Path(__file__).parents[2] / "data" / "foreign" / "gtoc13_legal.txt"
    with tempfile.TemporaryDirectory() as folder:
        catalogue, solution = Path(folder) / "gtoc13_planets.csv", Path(folder) / "made up.txt"
        a, e, *angles = MADE_UP["PlanetX"]
        numbers = ",".join(f"{value:.12g}" for value in (a / 1e3, e, *angles))
        catalogue.write_text(f"10,PlanetX,3411912.397,12993.800,{numbers},50\n")
        lines = [line for line in text.read_text().splitlines() if not line.startswith("#")][2:12]
        row = np.array([float(word) for word in lines[-1].split(",")])
        normal, span = row[None, 9:], np.array([26 * 365.25 * DAY])
        end = sail.fly(sail.Steps(1e3 * row[None, 3:9], span, normal, normal, normal)).state[0] / 1e3
        end[3:] *= 1.02
        last = np.concatenate([[0, 1, row[2] + span[0]], end, row[9:]])
        solution.write_text("\n".join([*lines, ", ".join(f"{value:.17g}" for value in last)]))
        return replay(judge(solution, folder), folder, rows=60)


FLIGHTS: dict[str, Callable[[], sailviz.Run | dict[str, sailviz.Run]]] = {
    "displaced": scene(
        "displaced/circular",
        propagation__duration_yr=1.3,
        propagation__outputs=37,
        start__elevation_deg=20,
        start__rate_ratio=0.7,
    ),
    "following": scene("displaced/mars-following", propagation__outputs=61),
    "spiral": scene("spirals/optical-sail", propagation__outputs=161),
    "approximations": scene("spirals/first-order", propagation__outputs=101),
    "transfer": scene("transfers/mars-rendezvous-2031", propagation__outputs=49),
    "small-body": scene("transfers/apophis", propagation__outputs=49),
    "primer": scene("transfers/ideal-law-real-film", propagation__outputs=41),
    "thruster": scene("spirals/radial-escape", propagation__outputs=61),
    "orbits": scene("transfers/earth-mercury-orbits", propagation__outputs=121),
    "spinning wheel": scene("body/e-sail-spin", propagation__outputs=41),
    "ageing": scene("body/ageing-mercury", propagation__outputs=41),
    "phases": scene("transfers/phased-solar-polar", propagation__outputs=181, phase__2__steering__pitch_deg=80),
    "arcs": scene("transfers/earth-jupiter-electric-sail", propagation__outputs=121),
    "brake": scene("deorbit/gravity-gradient", propagation__duration_d=0.45, propagation__output_interval_min=7),
    "spinning": scene(
        "deorbit/foresail-1",
        propagation__duration_d=0.45,
        propagation__output_interval_min=7,
        propagation__dense=[],
    ),
    "spinning across": scene(
        "deorbit/foresail-1",
        propagation__duration_d=0.2,
        propagation__output_interval_min=6,
        propagation__dense=[],
        steering__plane="across-track",
    ),
    "decay": scene(
        "deorbit/aalto-1",
        start__mean_altitude_km=360,
        propagation__duration_yr=0.12,
        propagation__output_interval_min=1430,
        propagation__dense__0__output_interval_min=6,
    ),
    "drag": scene("deorbit/drag-only", propagation__duration_yr=0.3, propagation__output_interval_min=2900),
    "chaos": scene("wind/gpc-spiral", **SMALL),
    "wind": scene("wind/voltage-limits", **SMALL),
    "competition": competition,
    "quaternions": quaternions,
    "billowed": billowed,
    "ageing billow": scene("body/ageing-billow", propagation__outputs=41),
    "turning": turning,
    "turning file": turning_file,
    "turning low": turning_low,
    "tumbling": scene("body/tumbling", propagation__outputs=61),
    "swinging": scene("body/swinging-pyramid", propagation__duration_h=1, propagation__outputs=41),
    "tumbling or not": tumbling_or_not,
    "averaged spin": scene("body/ikaros", propagation__outputs=61),
    "sliding mass": scene("body/offset", propagation__outputs=61),
    "held": scene("wind/held-displaced", propagation__outputs=61),
    "light": scene("wind/flickering-sun", **SMALL),
    "round a planet": round_a_planet,
    "beside the Earth": beside_the_earth,
    "many turns": many_turns,
    "to the Moon": to_the_moon,
    "in and out of the wind": in_and_out_of_the_wind,
    "own sail": own_sail,
    "own thruster": own_thruster,
    "own film": own_film,
    "own point": own_point,
    "own gaps": own_gaps,
    "own wheel": own_wheel,
    "own sparse": own_sparse,
    "own steps": own_steps,
    "own low gap": own_low_gap,
    "several devices": several_devices,
    "several round a planet": several_round_a_planet,
    "several in phases": several_in_phases,
    "together sails": together_sails,
    "together dated": together_dated,
    "together devices": together_devices,
    "together low": together_low,
}
TOGETHER = tuple(name for name in FLIGHTS if name.startswith("together"))
SLOWED = ("decay", "drag", "own point", "many turns")
