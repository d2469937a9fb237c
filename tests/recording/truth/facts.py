"""What a picture ought to show: the truth entities of a recording and, from them, plain numpy. Nothing that draws.

SI and radians; n rows. Where a low orbit is drawn slowed down (`slowed`), the craft stands on the osculating orbit of
its row, at the place of an even motion that goes round `TURNS` times in all; close rows stand where they were.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

AU, DAY, CENTURY = 149_597_870_700.0, 86_400.0, 36_525 * 86_400.0
TURNS = 30.0  # revolutions that are drawn of a slowed run
TILT = np.radians(23.439)  # of the ecliptic against the equator
SIDEREAL = 2 * np.pi * 1.00273781191135448 / DAY  # rad/s, rotation of the Earth

# E. M. Standish, Keplerian elements for approximate positions of the major planets (JPL), 1800-2050: a au, e, i, mean
# longitude, longitude of perihelion, node in degrees, and the rates of each per Julian century
PLANETS = {
    "Mercury": (
        [0.38709927, 0.20563593, 7.00497902, 252.25032350, 77.45779628, 48.33076593],
        [0.00000037, 0.00001906, -0.00594749, 149472.67411175, 0.16047689, -0.12534081],
    ),
    "Venus": (
        [0.72333566, 0.00677672, 3.39467605, 181.97909950, 131.60246718, 76.67984255],
        [0.00000390, -0.00004107, -0.00078890, 58517.81538729, 0.00268329, -0.27769418],
    ),
    "Earth": (
        [1.00000261, 0.01671123, -0.00001531, 100.46457166, 102.93768193, 0.0],
        [0.00000562, -0.00004392, -0.01294668, 35999.37244981, 0.32327364, 0.0],
    ),
    "Mars": (
        [1.52371034, 0.09339410, 1.84969142, -4.55343205, -23.94362959, 49.55953891],
        [0.00001847, 0.00007882, -0.00813131, 19140.30268499, 0.44441088, -0.29257343],
    ),
    "Jupiter": (
        [5.20288700, 0.04838624, 1.30439695, 34.39644051, 14.72847983, 100.47390909],
        [-0.00011607, -0.00013253, -0.00183714, 3034.74612775, 0.21252668, 0.20469106],
    ),
    "Saturn": (
        [9.53667594, 0.05386179, 2.48599187, 49.95424423, 92.59887831, 113.66242448],
        [-0.00125060, -0.00050991, 0.00193609, 1222.49362201, -0.41897216, -0.28867794],
    ),
    "Uranus": (
        [19.18916464, 0.04725744, 0.77263783, 313.23810451, 170.95427630, 74.01692503],
        [-0.00196176, -0.00004397, -0.00242939, 428.48202785, 0.40805281, 0.04240589],
    ),
    "Neptune": (
        [30.06992276, 0.00859048, 1.77004347, -55.12002969, 44.96476227, 131.78422574],
        [0.00026291, 0.00005105, 0.00035372, 218.45945325, -0.32241464, -0.00508664],
    ),
}


def unit(vectors) -> np.ndarray:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors, float) / np.where(length > 0, length, 1.0)


def orbital_frame(position, velocity) -> np.ndarray:
    """(n, 3, 3), rows: radial, transverse, normal."""
    radial, normal = unit(position), unit(np.cross(position, velocity))
    return np.stack([radial, np.cross(normal, radial), normal], -2)


def on_conic(a, e, inclination, raan, argument, anomaly) -> np.ndarray:
    """Places (..., 3) on orbits from their elements."""
    radius = a * (1 - e**2) / (1 + e * np.cos(anomaly))
    turn = argument + anomaly
    node = np.stack([np.cos(raan), np.sin(raan), 0 * raan], -1)
    ahead = np.stack([-np.sin(raan) * np.cos(inclination), np.cos(raan) * np.cos(inclination), np.sin(inclination)], -1)
    return radius[..., None] * (np.cos(turn)[..., None] * node + np.sin(turn)[..., None] * ahead)


MU_ALTAIRA = 139_348_062_043.343e9  # m3/s2
MADE_UP = {"PlanetX": (15955016885.357e3, 0.345, 40.0, 341.693, 30.0, 133.427)}  # a m, e, angles in degrees at t = 0

# JPL Horizons, solution 218: epoch JD TDB, a au, e, i, raan, argument, mean anomaly in degrees
SMALL_BODIES = {
    "Apophis": (2459215.5, 0.9225071817339578, 0.1915216892529348, 3.336751319526047, 204.0389271089114,
                126.6520518833791, 127.3225632500591),
}  # fmt: skip
TDB_AHEAD = 69.184  # s of UTC, since 2017


def planet_ellipse(name: str, seconds):
    """a m, e, i, raan, argument, mean anomaly rad at seconds after J2000; of a made-up one after t = 0."""
    if name in MADE_UP:
        a, e, *angles = MADE_UP[name]
        i, raan, argument, anomaly = np.radians(angles)
        turned = np.sqrt(MU_ALTAIRA / a**3) * np.atleast_1d(seconds)
        return (
            a + 0 * turned,
            e + 0 * turned,
            i + 0 * turned,
            raan + 0 * turned,
            argument + 0 * turned,
            anomaly + turned,
        )
    if name in SMALL_BODIES:
        day, axis, e, *angles = SMALL_BODIES[name]
        i, raan, argument, anomaly = np.radians(angles)
        a = axis * AU
        since = np.atleast_1d(seconds) + TDB_AHEAD - (day - 2451545.0) * DAY
        turned = np.sqrt(1.327_124_400_18e20 / a**3) * since
        return (
            a + 0 * turned,
            e + 0 * turned,
            i + 0 * turned,
            raan + 0 * turned,
            argument + 0 * turned,
            anomaly + turned,
        )
    start, rate = np.array(PLANETS[name][0]), np.array(PLANETS[name][1])
    a, e, i, longitude, perihelion, node = start[:, None] + rate[:, None] * np.atleast_1d(seconds) / CENTURY
    return a * AU, e, *np.radians([i, node, perihelion - node, longitude - perihelion])


def planet_place(name: str, seconds) -> np.ndarray:
    """(n, 3) m from the Sun, ecliptic of J2000; Kepler's equation by fixed-point iteration."""
    a, e, i, node, argument, mean = planet_ellipse(name, seconds)
    eccentric = mean
    for _ in range(80):
        eccentric = mean + e * np.sin(eccentric)
    anomaly = 2 * np.arctan(np.sqrt((1 + e) / (1 - e)) * np.tan(eccentric / 2))
    return on_conic(a, e, i, node, argument, anomaly)


def sun_place(seconds) -> np.ndarray:
    """(n, 3) m from the Earth, equator of date: Astronomical Almanac, section C, 0.01 deg."""
    days = np.atleast_1d(seconds) / DAY
    g = np.radians(357.528 + 0.9856003 * days)
    longitude = np.radians(280.460 + 0.9856474 * days + 1.915 * np.sin(g) + 0.020 * np.sin(2 * g))
    tilt = np.radians(23.439 - 4e-7 * days)
    distance = AU * (1.00014 - 0.01671 * np.cos(g) - 0.00014 * np.cos(2 * g))
    place = [np.cos(longitude), np.cos(tilt) * np.sin(longitude), np.sin(tilt) * np.sin(longitude)]
    return (distance * np.array(place)).T


def sidereal_angle(seconds) -> np.ndarray:
    """Right ascension of Greenwich, rad: IAU 1982, to 0.001 deg in this century."""
    days, centuries = np.asarray(seconds) / DAY, np.asarray(seconds) / CENTURY
    return np.radians(280.46061837 + 360.98564736629 * days + 0.000387933 * centuries**2) % (2 * np.pi)


def path_word(name: str) -> str:
    """A name as part of a path."""
    return "".join(letter if letter.isalnum() else "_" for letter in name.lower())


STAR = 1e19  # m3/s2, from which a body without a size is a star


class Truth:
    """The numbers of one recording."""

    def __init__(self, recording, slowed: bool = False, top: str = ""):
        """top : above the entities of a flight beside the first."""
        self.recording, self.slowed, self.top = recording, slowed, top
        state, attitude, thrust = (recording[f"{top}/{name}"] for name in ("state", "attitude", "thrust"))
        self.steps, self.time = state.timeline("step"), state["time_s"]
        self.position, self.velocity = state["position_m"], state["velocity_m_s"]
        self.normal, self.quaternion = attitude["normal"], attitude["quaternion"]
        self.pitch, self.cone, self.clock_angle = (attitude[f"{name}_rad"] for name in ("pitch", "cone", "clock"))
        self.thrust, self.on = thrust["acceleration_m_s2"], thrust["on"].astype(bool)
        told = recording.resolved.get("device")  # in one picture all craft have the devices of the first
        names = [device["name"] for device in told] if isinstance(told, list) else []
        self.kinds = {device["name"]: device["kind"] for device in told} if names else {}
        self.devices = {name: recording[f"{top}/thrust/{path_word(name)}"] for name in names}
        self.elements = recording[f"{top}/elements"]
        self.environment = dict(recording[f"{top}/environment"]) if f"{top}/environment" in recording else {}
        self.film = dict(recording[f"{top}/film"]) if f"{top}/film" in recording else {}
        self.scene = {name: values[0] for name, values in recording[f"{top}/scene"].items()}
        self.clock = self.time + float(self.scene.get("start_s", 0.0))  # of the first flight
        self.mu, self.radius = float(self.scene["body_mu_m3_s2"]), float(self.scene["body_radius_m"])
        self.body, self.kind = self.scene["body"], self.scene["craft_kind"]
        self.resolved = recording.resolved if not top else {}
        scene = recording[f"{top}/scene"]
        self.gaps = np.array(scene.get("gaps_s", []), float).reshape(-1, 2)
        self.stowed = ~np.any(self.normal, axis=1)

    def __len__(self) -> int:
        return len(self.time)

    @cached_property
    def seconds(self) -> np.ndarray | None:
        """Of each row after J2000, None without an epoch."""
        try:
            utc = self.recording[f"{self.top}/state"].timeline("utc")
        except KeyError:
            return None
        return (utc - np.datetime64("2000-01-01T12:00:00", "ns")) / np.timedelta64(1, "ns") * 1e-9

    @cached_property
    def length(self) -> float:
        """m that the system view draws as 1: au, radii of a body, else a power of ten."""
        if self.body == "Sun" or (not self.radius and self.mu > STAR):
            return AU
        return self.radius or 10.0 ** np.floor(np.log10(np.linalg.norm(self.position[0])))

    @property
    def round_planet(self) -> bool:
        return self.body != "Sun" and self.radius > 0

    @cached_property
    def breaks(self) -> list[int]:
        """Rows after which there is no data until the next row."""
        found = {int(np.flatnonzero(self.time <= start)[-1]) for start, _ in self.gaps}
        assert all(self.time[row + 1] >= end for row, (_, end) in zip(sorted(found), self.gaps, strict=True))
        return sorted(found)

    @cached_property
    def duration(self) -> float:
        return float(self.resolved.get("propagation", {}).get("duration") or self.time[-1] - self.time[0])

    @cached_property
    def frame(self) -> np.ndarray:
        """(n, 3, 3) rows: the orbital frame."""
        return orbital_frame(self.position, self.velocity)

    def rtn(self, vectors) -> np.ndarray:
        return np.einsum("nij,nj->ni", self.frame, vectors)

    @cached_property
    def orbit(self):
        """a, e, i, raan, argument, true anomaly as recorded."""
        names = ("semi_major_axis_m", "eccentricity", "inclination_rad", "raan_rad", "argument_rad", "true_anomaly_rad")
        return tuple(self.elements[name] for name in names)

    @cached_property
    def period(self) -> float:
        """s of a revolution at the start."""
        speed, distance = np.linalg.norm(self.velocity[0]), np.linalg.norm(self.position[0])
        a = 1 / (2 / distance - speed**2 / self.mu)
        return 2 * np.pi * np.sqrt(a**3 / self.mu) if a > 0 else np.inf

    @cached_property
    def at_home(self) -> np.ndarray:
        """(n,) whether the craft is drawn where it was: always, or where a slowed run has close rows."""
        if not self.slowed:
            return np.ones(len(self), bool)
        near = np.concatenate([[False], np.diff(self.time) < self.period / 6])
        home = near & np.concatenate([[False], near[:-1]])
        home[self.one_turn] = True
        return home

    @cached_property
    def one_turn(self) -> slice:
        """Rows of the first revolution, of more than ten, with twelve rows in it at least."""
        period = 2 * np.pi * np.sqrt(np.maximum(self.orbit[0], 1.0) ** 3 / self.mu)
        close = np.diff(self.time) < period[:-1] / 12
        for first in np.flatnonzero(close):
            last = int(np.searchsorted(self.time, self.time[first] + period[first], side="right"))
            if (
                last <= len(self)
                and self.time[-1] >= self.time[first] + period[first]
                and close[first : last - 1].all()
            ):
                return slice(int(first), last + 1 if close[last - 1 : last].all() else last)
        return slice(0, 0)

    @cached_property
    def spin(self) -> np.ndarray:
        """(n, 3, 3) turns, in the body's axes, of a tether that spins: eight in a replay, in the plane of motion or
        across it, from straight down on; none of any other."""
        steering = self.resolved.get("steering") or {}
        phase = 2 * np.pi * 8 * (self.time - self.time[0]) / (self.time[-1] - self.time[0])
        phase = phase * (steering.get("kind") == "spinning")
        c, s, zero, one = np.cos(phase), np.sin(phase), 0 * phase, 0 * phase + 1
        if steering.get("plane") == "across-track":
            rows = [[one, zero, zero], [zero, c, -s], [zero, s, c]]
        else:
            rows = [[c, zero, s], [zero, one, zero], [-s, zero, c]]
        return np.moveaxis(np.array(rows), -1, 0)

    @cached_property
    def slower(self) -> float:
        """How many times slower a slowed run goes round."""
        return self.duration / self.period / TURNS if self.slowed else 1.0

    @cached_property
    def place(self) -> np.ndarray:
        """(n, 3) m, where the craft is drawn."""
        if not self.slowed:
            return self.position
        a, e, i, raan, argument, anomaly = self.orbit
        began = raan[0] + argument[0] + anomaly[0]
        longitude = began + 2 * np.pi * TURNS * (self.time - self.time[0]) / self.duration
        even = on_conic(a, e, i, raan, argument, longitude - raan - argument)
        return np.where(self.at_home[:, None], self.position, even)

    @cached_property
    def drawn_frame(self) -> np.ndarray:
        """(n, 3, 3) rows: the orbital frame at the place where the craft is drawn."""
        normal, radial = unit(np.cross(self.position, self.velocity)), unit(self.place)
        return np.stack([radial, np.cross(normal, radial), normal], -2)

    def carried(self, vectors) -> np.ndarray:
        """Inertial vectors (n, 3) with their components in the orbital frame, at the place where the craft is drawn."""
        return np.einsum("nji,nj->ni", self.drawn_frame, self.rtn(vectors))

    @cached_property
    def sun(self) -> np.ndarray:
        """(n, 3) unit vectors from the Earth; without a date the Sun goes evenly round it from the x axis on. A light
        that is fixed stands where its scene says."""
        light = self.resolved.get("light") or {}
        if light.get("kind") == "fixed":
            return np.tile(unit(np.array(light["direction"], float)), (len(self), 1))
        if self.seconds is None:
            angle = 2 * np.pi * self.time / (365.25 * DAY)
            return np.stack([np.cos(angle), np.sin(angle) * np.cos(TILT), np.sin(angle) * np.sin(TILT)], -1)
        return unit(sun_place(self.seconds))

    @cached_property
    def sun_distance(self) -> np.ndarray:
        """(n,) m of the Sun from the Earth."""
        if self.seconds is None:
            return np.full(len(self), AU)
        return np.linalg.norm(sun_place(self.seconds), axis=1)

    @property
    def sailing_round_a_planet(self) -> bool:
        """Whether the light that pushes the craft is not at the centre."""
        return self.round_planet and self.kind in ("solar-sail", "electric-sail")

    @cached_property
    def outward(self) -> np.ndarray:
        """(n, 3) from where the light is: the Sun, 1 au away, of a sail round a planet, else the centre."""
        return self.position - AU * self.sun if self.sailing_round_a_planet else self.position

    @cached_property
    def close_frame(self) -> np.ndarray:
        """(n, 3, 3) rows: x, y, z of the close-up; round a planet x from the light, z as near to the pole as it can."""
        if not self.sailing_round_a_planet:
            return self.frame
        x = unit(self.outward)
        y = unit(np.cross([0.0, 0.0, 1.0], x))
        return np.stack([x, y, np.cross(x, y)], -2)

    @cached_property
    def clock_axes(self) -> np.ndarray:
        """(n, 3, 3) rows: the directions of clock angle 0 and 90 deg, and outward. Round a planet the first is as near
        to the pole of the ecliptic as it can be."""
        if not self.sailing_round_a_planet:
            return self.frame[:, ::-1]
        out = unit(self.outward)
        east = unit(np.cross([0.0, -np.sin(TILT), np.cos(TILT)], out))
        return np.stack([np.cross(out, east), east, out], -2)

    @cached_property
    def lit(self) -> np.ndarray:
        """(n,) whether the craft is in sunlight: as recorded, or by a cylinder of shadow where drawn elsewhere."""
        along = np.sum(self.place * self.sun, axis=1)
        away = np.linalg.norm(self.place - along[:, None] * self.sun, axis=1)
        geometric = (along > 0) | (away > self.radius)
        return np.where(self.at_home, self.environment.get("sunlit", geometric).astype(bool), geometric)

    @cached_property
    def greenwich(self) -> np.ndarray:
        """(n,) rad, as drawn: a slowed run turns the Earth as much slower, so that days keep their revolutions."""
        true = sidereal_angle(self.seconds)
        turned = SIDEREAL * (self.time - self.time[0])
        return np.where(self.at_home, true, true - turned + turned / self.slower)

    def ring(self, row: int):
        """Angular momentum's direction, eccentricity vector (3,) and semilatus rectum m of a row, from its state."""
        r, v = self.position[row], self.velocity[row]
        h = np.cross(r, v)
        return unit(h), np.cross(v, h) / self.mu - unit(r), h @ h / self.mu

    @cached_property
    def reach(self) -> float:
        """The largest distance from the centre among the rows, in view units."""
        return float(np.linalg.norm(self.position, axis=1).max()) / self.length
