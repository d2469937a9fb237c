"""How fast a sail gets from one orbit to another, asked in words, and the answer as a scene that flies it.

    from sailviz import transfers
    solution = transfers.find("earth", "mars", "ideal", 1e-3)
    print(transfers.scene_of(solution))

The search is that of `design.minimum_time`, `design.transfers` and `design.rendezvous`; here are the orbits of the
planets, and the text of the scene.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sailviz import elements as orbital
from sailviz import ephemeris
from sailviz.constants import AU, DAY, MU_SUN
from sailviz.design.minimum_time import costates
from sailviz.design.minimum_time import replay as reflight
from sailviz.design.minimum_time.circles import Transfer, circle_to_circle
from sailviz.design.minimum_time.costates import SPEED_UNIT, TIME_UNIT, canonical_sail
from sailviz.design.minimum_time.orbits import OrbitTransfer, orbit_to_orbit
from sailviz.design.minimum_time.planet_rendezvous import Rendezvous, rendezvous
from sailviz.elements import Elements
from sailviz.propulsion.devices import ELECTRIC_SAILS
from sailviz.propulsion.solar_sail import FILMS, Film
from sailviz.words import length, nearest

# Osculating elements of 2020-01-01 (TDB), ecliptic of J2000: JPL Horizons, solution JPL#48
CERES = Elements(2.769289292 * AU, 0.07687465, *np.radians([10.59127768, 80.30119019, 73.80896809]), 0.0)
PLACES = (*(name.lower() for name in ephemeris.PLANETS), "ceres")
SAILS = (*FILMS, *ELECTRIC_SAILS)
TABLE_ERROR = 1e-5  # rad of the attitudes of a steering table between its rows
AFTER_SWITCH = 1e-3  # s from the row before a switch to the row after it
SAME_CIRCLE = 1e-4  # relative difference of two radii
LEAST_TILT = np.radians(0.01)  # of an orbit whose node is worth checking

Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Place:
    """Where a transfer begins or ends: words, an orbit about the Sun, and whether it is a circle by wish."""

    name: str
    orbit: Elements
    circle: bool = False

    @property
    def table(self) -> dict:
        """The orbit as a scene's [target]."""
        e = self.orbit
        named = {"name": f"orbit of {self.name}" if self.name[0].isalpha() else f"circle of {self.name}"}
        tilt = {"inclination_deg": np.degrees(e.inclination), "raan_deg": np.degrees(e.raan)} if e.inclination else {}
        if e.eccentricity == 0:
            return {**named, "radius_au": e.semi_major_axis / AU, **tilt}
        shape = {"semi_major_axis_au": e.semi_major_axis / AU, "eccentricity": e.eccentricity}
        return {**named, **shape, **tilt, "argument_deg": np.degrees(e.argument)}


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
    origin,
    target,
    device: Film | str = "ideal",
    characteristic_acceleration: float = 1e-3,
    *,
    orbits: bool = False,
    departure=None,
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
    origin, target = (place(x) if isinstance(x, str) else x for x in (origin, target))
    if isinstance(device, str) and device not in SAILS:
        raise ValueError(f'there is no sail called "{device}". {nearest(device, SAILS)}')
    a_c, more = characteristic_acceleration, {"progress": progress}
    if departure is not None:
        for end in (origin, target):
            if end.circle or end.name not in ephemeris.PLANETS:
                raise ValueError(f"a date needs planets whose places are known, and {end.name} is none of them")
        more |= {} if dates is None else {"dates": dates}
        try:
            found = rendezvous(target.name, departure, device, a_c, origin=origin.name, **more)
        except ValueError as error:
            if "datetime" in str(error).lower():
                raise ValueError(f"{departure!r} is no date: write 2030-01-01") from None
            raise
        return Solution("rendezvous", origin, target, found)
    if orbits or (target.circle and target.orbit.inclination):
        more |= {} if starts is None else {"starts": starts}
        if not orbits:
            origin = circle(origin.orbit.semi_major_axis, name=origin.name)
        return Solution("orbits", origin, target, orbit_to_orbit(origin.orbit, target.orbit, device, a_c, **more))
    origin, target = (circle(x.orbit.semi_major_axis, name=x.name) for x in (origin, target))
    r0, r1 = origin.orbit.semi_major_axis, target.orbit.semi_major_axis
    if abs(r1 / r0 - 1) < SAME_CIRCLE:
        raise ValueError(f"{target.name} is where {origin.name} is: between the two circles there is nothing to fly")
    return Solution("circles", origin, target, circle_to_circle(r0, r1, device, a_c, **more))


@dataclass(frozen=True)
class FlightTimes:
    """time (n, k) s over characteristic_acceleration (n,) m/s2 for k devices, NaN where no flight was found;
    revolutions (n, k)."""

    characteristic_acceleration: np.ndarray
    devices: tuple[str, ...]
    time: np.ndarray
    revolutions: np.ndarray


def flight_times(
    origin, target, devices, characteristic_acceleration, *, progress: Progress | None = None
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


# ---------------------------------------------------------------- a solution as a scene
def solved(flight) -> reflight.Solved:
    """A Transfer, OrbitTransfer or Rendezvous as what flies it again, six costates in units of mu = 1 and one au."""
    if not flight.feasible:
        raise ValueError(f"there is no flight to write down: {flight.reason}")
    if isinstance(flight, Transfer):
        start, radius = flight.start, flight.initial_radius
        return reflight.from_planar(start, radius, flight.time, flight.device, flight.characteristic_acceleration)
    parts = (flight.position, flight.velocity, flight.costates, flight.time)
    return reflight.Solved(*parts, flight.device, flight.characteristic_acceleration)


def path_of(flight, samples: int = 1000):
    """Position m, velocity m/s (samples, 3) of a flight at equal steps of time, and its switches (k,) s."""
    it = solved(flight)
    start = np.concatenate([it.position / AU, it.velocity / SPEED_UNIT, it.costates])
    span = it.time / TIME_UNIT
    sail = canonical_sail(it.device, it.characteristic_acceleration)
    found = costates.propagate(start, span, sail, times=np.linspace(0.0, span, samples))
    return found.rows[:, :3] * AU, found.rows[:, 3:6] * SPEED_UNIT, found.switches * TIME_UNIT


def scene_of(
    solution, form: str = "costates", *, title: str | None = None, target: dict | None = None, outputs: int = 2000
) -> str:
    """The text of a scene that `sailviz run` flies to the same end: TOML, for `tomllib.loads` and `load_scene`.

    solution : a Solution, or a Transfer, OrbitTransfer or Rendezvous. form : "costates", which repeats the flight to
    1e-8, or "table" of pitch and clock angle, to 1e-5. target : the scene's [target], by default the Solution's, or
    the orbit reached. ValueError where there is no flight.
    """
    if form not in ("costates", "table"):
        raise ValueError(f'there is no form "{form}". {nearest(form, ("costates", "table"))}')
    whole = solution if isinstance(solution, Solution) else None
    flight = solution.flight if whole else solution
    it = solved(flight)
    position, velocity, _ = path_of(flight)
    reached = orbital.elements(position[-1], velocity[-1], MU_SUN)
    if target is None:
        target = whole.target.table if whole else Place("reached", _plain(reached)).table | {"name": "orbit reached"}
    met = isinstance(flight, Rendezvous)
    if met and whole:
        target = {"name": f"orbit of {whole.target.name}", "planet": whole.target.name.lower()}
    craft = device_words(it.device)
    ways = f"from {whole.origin.name} to {whole.target.name}" if whole else "from orbit to orbit"
    lines = [
        f"title    = {_text(title or f'{craft}: the fastest way {ways}')}",
        'thesis   = "6"',
        f"about    = {_text(_about(flight, it, craft, ways, form))}",
        'family   = "transfers"',
    ]
    if met:
        lines.append(f"epoch    = {np.datetime_as_string(flight.departure, 'us')}")
    circular = isinstance(flight, Transfer) and np.isnan(flight.departure_anomaly)
    lines += ["", "[start]", *_start(flight, it, circular, met)]
    lines += ["", "[device]", *_device(it), "", "[steering]"]
    if form == "costates":
        numbers = flight.costates if circular else it.costates
        units = "mu = 1, distance of the start = 1" if circular else "mu = 1 au = 1"
        lines += ['kind = "optimal"', f"costates = {_list(numbers)}  # H = +1, {units}"]
    else:
        lines += _steering_table(it)
    lines += ["", "[target]", *(f"{key} = {_value(value)}" for key, value in target.items())]
    lines += [
        "",
        "[propagation]",
        f"duration_d = {float(it.time / DAY)!r}",
        f"outputs = {outputs}",
        "tolerance = 1e-13",
    ]
    lines += _expectations(reached, position, velocity, 1e-7 if form == "costates" else 1e-5, met)
    return "\n".join(lines) + "\n"


def _plain(e):
    """Elements as Python's own numbers, what is rounding noise left out."""
    shape = [float(x) for x in (e.semi_major_axis, e.eccentricity, e.inclination, e.raan, e.argument)]
    shape[1] *= shape[1] > 1e-9
    shape[2] *= shape[2] > 1e-9
    return Elements(*shape, 0.0)


def device_words(device) -> str:
    """A sail in words, e.g. "Ideal solar sail"."""
    if not isinstance(device, str):
        return "Solar sail"
    if device in ELECTRIC_SAILS:
        model = device.removeprefix("electric-sail").lstrip("-")
        return f"E-sail ({model} model)" if model else "E-sail"
    return {"ideal": "Ideal solar sail", "eta-perfect": "Solar sail of 85 % efficiency"}.get(
        device, f"Solar sail with the film {device.upper()}"
    )


def _about(flight, it, craft, ways, form):
    how = "its initial costates" if form == "costates" else "a table of pitch and clock angle"
    a_c = f"{it.characteristic_acceleration * 1e3:g} mm/s²"
    return (
        f"**{craft}** of {a_c}, steered {ways} by {how} in **{it.time / DAY:.4f} d** and {flight.revolutions:.3f} "
        f"revolutions: the best found, residual {flight.residual:.0e}."
    )


def _start(flight, it, circular, met):
    if circular:
        return ['kind = "circular"', f"radius_au = {_number(flight.initial_radius / AU)}"]
    if met:
        where = "position_au", it.position / AU, "velocity_km_s", it.velocity / 1e3
        return ['kind = "cartesian"', f"{where[0]} = {_list(where[1])}", f"{where[2]} = {_list(where[3])}"]
    e = orbital.elements(it.position, it.velocity, MU_SUN)
    angles = {name: np.degrees(getattr(e, name)) for name in ("inclination", "raan", "argument", "true_anomaly")}
    return [
        'kind = "elements"',
        f"semi_major_axis_au = {_number(e.semi_major_axis / AU)}",
        f"eccentricity = {_number(e.eccentricity)}",
        *(f"{name}_deg = {_number(value)}" for name, value in angles.items()),
    ]


def _device(it):
    strength = f"characteristic_acceleration_mm_s2 = {_number(it.characteristic_acceleration * 1e3)}"
    if isinstance(it.device, Film):
        b = ", ".join(f"{name} = {_number(getattr(it.device, name))}" for name in ("b1", "b2", "b3", "efficiency"))
        return ['kind = "solar-sail"', f"film = {{ {b} }}", strength]
    if it.device in FILMS:
        return ['kind = "solar-sail"', f'film = "{it.device}"', strength]
    model = it.device.removeprefix("electric-sail").lstrip("-") or "final"
    return ['kind = "electric-sail"', f'model = "{model}"', strength]


def _steering_table(it):
    found = reflight.steering_table(it, error=TABLE_ERROR)
    time = np.round(found.time, 4)
    again = np.nonzero(np.diff(time) <= 0)[0] + 1  # the second row of a switch
    time[again] = time[again - 1] + AFTER_SWITCH
    columns = {
        "time_d": [f"{t:.12g}" for t in time / DAY],
        "pitch_deg": [f"{x:.6f}" for x in np.degrees(found.pitch)],
        "clock_deg": [f"{x:.6f}" for x in np.degrees(found.clock)],
    }
    if found.throttle.min() < 1:
        columns["throttle"] = [f"{x:g}" for x in found.throttle]
    return ['kind = "table"', *(f"{name} = {_wrapped(values)}" for name, values in columns.items())]


def _expectations(reached, position, velocity, within, met):
    """What a flight's end must be: the elements that the optimisation aimed at, or the place of the planet."""
    wanted = {
        "semi_major_axis_au": (reached.semi_major_axis / AU, within),
        "eccentricity": (float(reached.eccentricity), within),
    }
    tilt = float(reached.inclination)
    if tilt > 1e-9:
        wanted["inclination_deg"] = (np.degrees(tilt), np.degrees(within))
    if tilt > LEAST_TILT and abs(np.sin(reached.raan / 2)) > 1e-6:  # a node at 0 would be measured as 0 or as 360
        wanted["raan_deg"] = (np.degrees(reached.raan), np.degrees(within) / np.sin(tilt))
    if met:
        longitude = np.unwrap(np.arctan2(position[:, 1], position[:, 0]))
        wanted["longitude_deg"] = (np.degrees(longitude[-1]), np.degrees(within))
        wanted["radius_au"] = (np.linalg.norm(position[-1]) / AU, within)
    lines = []
    for quantity, (value, tolerance) in wanted.items():
        if quantity == "eccentricity" and value < 0.1 * tolerance:
            value = 0.0
        lines += ["", "[[expect]]", f'quantity = "{quantity}"', 'at = "end"']
        lines += [f"value = {float(f'{value:.10g}')!r}", f"within = {tolerance:.1e}"]
    return lines


def _text(words):
    return json.dumps(words, ensure_ascii=False)


def _number(value):
    return repr(float(value))


def _value(value):
    return _text(value) if isinstance(value, str) else _number(value)


def _list(values):
    return "[" + ", ".join(_number(x) for x in values) + "]"


def _wrapped(words, width=110):
    """A list over several lines."""
    lines, line = [], "   "
    for word in words:
        if len(line) + len(word) + 2 > width:
            lines.append(line)
            line = "   "
        line += f" {word},"
    return "[\n" + "\n".join([*lines, line]) + "\n]"
