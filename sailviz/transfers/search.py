"""How fast a sail gets from one orbit to another, asked in words.

    from sailviz import transfers
    solution = transfers.find("earth", "mars", "ideal", 1e-3)
    print(transfers.scene_of(solution))

The search is that of `design.minimum_time`; here are the orbits of the planets and what a question may say.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sailviz import ephemeris
from sailviz.constants import AU
from sailviz.design.minimum_time.circles import circle_to_circle
from sailviz.design.minimum_time.orbits import STARTS, OrbitTransfer, orbit_to_orbit
from sailviz.design.minimum_time.planar_transfer import Transfer
from sailviz.design.minimum_time.planet_rendezvous import DATES, Date, Rendezvous, rendezvous
from sailviz.elements import Elements
from sailviz.propulsion.devices import ELECTRIC_SAILS
from sailviz.propulsion.solar_sail import FILMS, Film
from sailviz.words import length, nearest

# Osculating elements of 2020-01-01 (TDB), ecliptic of J2000: JPL Horizons, solution JPL#48
CERES = Elements(
    semi_major_axis=2.769289292 * AU,
    eccentricity=0.07687465,
    inclination=np.radians(10.59127768),
    raan=np.radians(80.30119019),
    argument=np.radians(73.80896809),
    true_anomaly=0.0,
)
PLACES = (*(name.lower() for name in ephemeris.PLANETS), "ceres")
SAILS = (*FILMS, *ELECTRIC_SAILS)
SAME_CIRCLE = 1e-4  # relative difference of two radii

Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Place:
    """Where a transfer begins or ends: words, an orbit about the Sun, and whether it is a circle by wish."""

    name: str
    orbit: Elements
    circle: bool = False

    @property
    def radius(self) -> float:
        """Mean distance from the Sun, m."""
        return float(self.orbit.semi_major_axis)

    @property
    def table(self) -> dict[str, str | float]:
        """The orbit as a scene's [target]."""
        e = self.orbit
        found: dict[str, str | float] = {
            "name": f"orbit of {self.name}" if self.name[0].isalpha() else f"circle of {self.name}"
        }
        if e.eccentricity == 0:
            found["radius_au"] = self.radius / AU
        else:
            found |= {"semi_major_axis_au": self.radius / AU, "eccentricity": float(e.eccentricity)}
        if e.inclination:
            found |= {"inclination_deg": float(np.degrees(e.inclination)), "raan_deg": float(np.degrees(e.raan))}
        if e.eccentricity != 0:
            found["argument_deg"] = float(np.degrees(e.argument))
        return found


@dataclass(frozen=True)
class Solution:
    """A transfer found, or the nearest: kind "circles", "orbits" or "rendezvous", where from and where to, and the
    flight with its time, costates, residual and claim."""

    kind: str
    origin: Place
    target: Place
    flight: Transfer | OrbitTransfer | Rendezvous


def place(name: str) -> Place:
    """A planet or Ceres on its orbit: mean elements of J2000; Ceres' of 2020. ValueError with the nearest name."""
    key = str(name).lower()
    if key not in PLACES:
        raise ValueError(f'there is no place called "{name}". {nearest(key, PLACES)}')
    return Place(key.capitalize(), CERES if key == "ceres" else ephemeris.planet_ellipse(key.capitalize()))


def circle(radius: float, inclination: float = 0.0, name: str = "") -> Place:
    """A circle about the Sun: radius m, inclination rad to the ecliptic."""
    if not (np.isfinite(radius) and radius > 0):
        raise ValueError(f"a radius must be a positive number, got {radius!r}")
    if not 0 <= inclination <= np.pi:
        raise ValueError(f"an inclination lies between 0 and 180 deg, got {np.degrees(inclination):g} deg")
    return Place(name or length(radius), Elements(float(radius), 0.0, float(inclination), 0.0, 0.0, 0.0), True)


def find(
    origin: str | Place,
    target: str | Place,
    device: Film | str = "ideal",
    characteristic_acceleration: float = 1e-3,
    *,
    orbits: bool = False,
    departure: Date | tuple[Date, Date] | None = None,
    starts: int | None = None,
    dates: int | None = None,
    progress: Progress | None = None,
) -> Solution:
    """The fastest flight found from one place to another; nothing need be guessed.

    origin, target : names in PLACES, or a Place. device : a name in SAILS or a Film, characteristic_acceleration m/s2.
    Between circles at the mean distances; with orbits=True, or to an inclined circle, between the orbits in space with
    free anomalies; with departure, a date or (first, last) as datetime64 or text, from planet to planet. starts, dates
    : of `orbit_to_orbit` and `rendezvous`. ValueError for what is no place, sail or date; an unreachable target gives
    a flight that is not feasible and says why.
    """
    begin, end = (place(x) if isinstance(x, str) else x for x in (origin, target))
    if isinstance(device, str) and device not in SAILS:
        raise ValueError(f'there is no sail called "{device}". {nearest(device, SAILS)}')
    a_c = characteristic_acceleration
    if departure is not None:
        return _between_planets(begin, end, device, a_c, departure, dates, progress)
    if orbits or (end.circle and end.orbit.inclination):
        if not orbits:
            begin = circle(begin.radius, name=begin.name)
        count = STARTS if starts is None else starts
        found = orbit_to_orbit(begin.orbit, end.orbit, device, a_c, starts=count, progress=progress)
        return Solution("orbits", begin, end, found)
    begin, end = (circle(x.radius, name=x.name) for x in (begin, end))
    if abs(end.radius / begin.radius - 1) < SAME_CIRCLE:
        raise ValueError(f"{end.name} is where {begin.name} is: between the two circles there is nothing to fly")
    return Solution("circles", begin, end, circle_to_circle(begin.radius, end.radius, device, a_c, progress=progress))


def _between_planets(
    origin: Place,
    target: Place,
    device: Film | str,
    characteristic_acceleration: float,
    departure: Date | tuple[Date, Date],
    dates: int | None,
    progress: Progress | None,
) -> Solution:
    for end in (origin, target):
        if end.circle or end.name not in ephemeris.PLANETS:
            raise ValueError(f"a date needs planets whose places are known, and {end.name} is none of them")
    try:
        found = rendezvous(
            target.name,
            departure,
            device,
            characteristic_acceleration,
            origin=origin.name,
            dates=DATES if dates is None else dates,
            progress=progress,
        )
    except ValueError as error:
        if "datetime" in str(error).lower():
            raise ValueError(f"{departure!r} is no date: write 2030-01-01") from None
        raise
    return Solution("rendezvous", origin, target, found)


@dataclass(frozen=True)
class FlightTimes:
    """time (n, k) s over characteristic_acceleration (n,) m/s2 for k devices, NaN where no flight was found;
    revolutions (n, k)."""

    characteristic_acceleration: np.ndarray
    devices: tuple[str, ...]
    time: np.ndarray
    revolutions: np.ndarray


def flight_times(
    origin: str | Place,
    target: str | Place,
    devices: Sequence[str],
    characteristic_acceleration: npt.ArrayLike,
    *,
    progress: Progress | None = None,
) -> FlightTimes:
    """Flight times between circles, each from a search of its own. devices : names; acceleration (n,) m/s2."""
    a_c = np.asarray(characteristic_acceleration, dtype=float)
    time, turns = (np.full((len(a_c), len(devices)), np.nan) for _ in range(2))
    for k, device in enumerate(devices):
        for i, a in enumerate(a_c):
            done = (k * len(a_c) + i) / time.size
            if progress is not None:
                progress(done, f"{device}, {a * 1e3:g} mm/s²")
            flight = find(origin, target, device, float(a)).flight
            time[i, k], turns[i, k] = flight.time, flight.revolutions
    return FlightTimes(a_c, tuple(devices), time, turns)
