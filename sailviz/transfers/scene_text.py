"""The answer to a question about a transfer as the text of a scene that flies it."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable

import numpy as np

from sailviz.constants import AU, DAY, MU_SUN
from sailviz.design.direct.search import DirectFlight
from sailviz.design.minimum_time import replay, touches
from sailviz.design.minimum_time.orbits import OrbitTransfer
from sailviz.design.minimum_time.planar_transfer import Transfer
from sailviz.design.minimum_time.planet_rendezvous import Rendezvous
from sailviz.design.minimum_time.singular_arcs import fly
from sailviz.design.minimum_time.state_costate import POSITION, SPEED_UNIT, TIME_UNIT, VELOCITY, canonical_sail
from sailviz.elements import Elements, elements
from sailviz.propulsion.devices import ELECTRIC_SAILS
from sailviz.propulsion.film_ageing import temperature
from sailviz.propulsion.solar_sail import FILMS, Film
from sailviz.transfers.ends import Arrival, Distance, Escape, FlyBy
from sailviz.transfers.places import Place
from sailviz.transfers.search import Solution
from sailviz.words import nearest

TABLE_ERROR = 1e-5  # rad of the attitudes of a steering table between its rows
ARC_TABLE_ERROR = 3e-6  # of flights in arcs, and of the throttle on those that are singular
AFTER_SWITCH = 1e-3  # s from the row before a switch to the row after it
LONG = 3000 * DAY  # from which on twelve digits of a day do not tell these two apart
LEAST_TILT = np.radians(0.01)  # of an orbit whose node is worth checking

Flight = Transfer | OrbitTransfer | Rendezvous
ALLOWED = 3.0  # misses of a direct flight's table within which a scene's flight of it must end


def solved(flight: Flight) -> replay.Solved:
    """A Transfer, OrbitTransfer or Rendezvous as what flies it again, six costates in units of mu = 1 and one au.
    ValueError where no flight was found."""
    if not flight.feasible:
        raise ValueError(f"there is no flight to write down: {flight.reason}")
    device, a_c = flight.device, flight.characteristic_acceleration
    if not isinstance(flight, Transfer):
        return replay.Solved(flight.position, flight.velocity, flight.costates, flight.time, device, a_c)
    if flight.start is None:
        raise ValueError("there is no flight to write down: it has no start")
    return replay.from_planar(
        flight.start, flight.initial_radius, flight.time, device, a_c, flight.arcs, flight.touches, flight.coolness
    )


def path_of(flight: Flight, samples: int = 1000) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position m, velocity m/s (samples, 3) of a flight at equal steps of time, and its switches (k,) s."""
    it = solved(flight)
    start = np.concatenate([it.position / AU, it.velocity / SPEED_UNIT, it.costates])
    span = it.time / TIME_UNIT
    sail = canonical_sail(it.device, it.characteristic_acceleration, it.coolness)
    arcs = [(arc.kind, (arc.end - arc.start) / TIME_UNIT) for arc in it.arcs]
    times = np.linspace(0.0, span, samples)
    found = fly(start, span, sail, arcs, times) if arcs else touches.propagate(start, span, sail, it.touches, times)
    return found.rows[:, POSITION] * AU, found.rows[:, VELOCITY] * SPEED_UNIT, found.switches * TIME_UNIT


def scene_of(
    solution: Solution | Flight | DirectFlight,
    form: str = "costates",
    *,
    title: str | None = None,
    target: dict[str, str | float] | None = None,
    outputs: int = 2000,
) -> str:
    """The text of a scene that `sailviz run` flies to the same end: TOML, for `tomllib.loads` and `load_scene`.

    solution : a Solution, or a Transfer, OrbitTransfer or Rendezvous. form : "costates", which repeats the flight to
    1e-8, or "table" of pitch and clock angle, to 1e-5; a DirectFlight has its table only. target : the scene's
    [target], by default the Solution's, or the orbit reached. ValueError where there is no flight.
    """
    if form not in ("costates", "table"):
        raise ValueError(f'there is no form "{form}". {nearest(form, ("costates", "table"))}')
    whole = solution if isinstance(solution, Solution) else None
    flight = solution.flight if isinstance(solution, Solution) else solution
    if isinstance(flight, DirectFlight):
        return _direct_scene(flight, whole, title, target, outputs)
    it = solved(flight)
    position, velocity, _ = path_of(flight)
    reached = elements(position[-1], velocity[-1], MU_SUN)
    target = _target(flight, whole, target, reached)
    craft = device_words(it.device)
    ways = _ways(whole) if whole else "from orbit to orbit"
    lines = [
        f"title    = {_text(title or f'{craft}: the fastest way {ways}')}",
        'thesis   = "6"',
        f"about    = {_text(_about(flight, it, craft, ways, form))}",
        'family   = "transfers"',
    ]
    if isinstance(flight, Rendezvous):
        lines.append(f"epoch    = {np.datetime_as_string(flight.departure, 'us')}")
    circular = isinstance(flight, Transfer) and np.isnan(flight.departure_anomaly)
    lines += ["", "[start]", *_start(flight, it, circular)]
    lines += ["", "[device]", *_device(it), "", "[steering]"]
    lines += _steering(flight, it, circular) if form == "costates" else _steering_table(it)
    if target is not None:
        lines += ["", "[target]", *(f"{key} = {_value(value)}" for key, value in target.items())]
    lines += [
        "",
        "[propagation]",
        f"duration_d = {float(it.time / DAY)!r}",
        f"outputs = {outputs}",
        "tolerance = 1e-13",
        *(['integrator = "dop853"'] if it.touches or it.coolness else []),  # the force has kinks
    ]
    within = 1e-7 if form == "costates" else 1e-5
    if whole is not None and whole.kind == "end":
        lines += _expected_end(whole, position, velocity, within)
    else:
        lines += _expectations(reached, position, within, isinstance(flight, Rendezvous))
    return "\n".join(lines) + "\n"


def _target(
    flight: Flight, whole: Solution | None, given: dict[str, str | float] | None, reached: Elements
) -> dict[str, str | float] | None:
    """What a scene's [target] says; None where the flight came to no orbit."""
    aim = None if whole is None else whole.target
    if isinstance(flight, Rendezvous) and aim is not None:
        return aim.moving_table
    if given is not None:
        return given
    if whole is None:
        return Place("reached", _plain(reached)).table | {"name": "orbit reached"}
    return None if aim is None else aim.table


def _steering(flight: Flight, it: replay.Solved, circular: bool) -> list[str]:
    """By costates, and what else a flight under limits or at partial voltage needs."""
    in_plane = circular and isinstance(flight, Transfer) and not flight.angle_costate
    numbers = flight.costates if in_plane else it.costates
    units = "mu = 1, distance of the start = 1" if in_plane else "mu = 1 au = 1"
    scaled = f"{flight.hamiltonian:.6g}" if isinstance(flight, Rendezvous) else "+1"
    optimal = ['kind = "optimal"', f"costates = {_list(numbers)}  # H = {scaled}, {units}"]
    return [*optimal, *_arcs(it), *_limited(flight, it, in_plane)]


def _direct_scene(
    flight: DirectFlight,
    whole: Solution | None,
    title: str | None,
    target: dict[str, str | float] | None,
    outputs: int,
) -> str:
    """The scene of a flight of the direct method: its table, and an end as near as the table was seen to come."""
    if flight.table is None or flight.flown is None:
        raise ValueError(f"there is no flight to write down: {flight.reason}")
    craft = device_words(flight.device)
    ways = _ways(whole) if whole else "from orbit to orbit"
    about = (
        f"**{craft}** of {flight.characteristic_acceleration * 1e3:g} mm/s², steered {ways} by a table of pitch and "
        f"clock angle in **{flight.days} d** and {flight.revolutions:.3f} revolutions: the best found by the direct "
        f"method, not confirmed by another; its table misses the end by {flight.miss:.0e}."
    )
    reached = elements(flight.flown.position[-1], flight.flown.velocity[-1], MU_SUN)
    if target is None:
        target = (
            whole.target.table
            if whole and whole.target
            else Place("reached", _plain(reached)).table | {"name": "orbit reached"}
        )
    dated = whole is not None and whole.kind == "rendezvous" and whole.target is not None
    if dated and whole is not None and whole.target is not None:
        target = whole.target.moving_table
        start = _cartesian(flight.position, flight.velocity)
    else:
        e = elements(flight.position, flight.velocity, MU_SUN)
        start = ['kind = "circular"', f"radius_au = {_number(float(e.semi_major_axis) / AU)}"]
    lines = [
        f"title    = {_text(title or f'{craft}: the fastest way {ways}')}",
        'thesis   = "6"',
        f"about    = {_text(about)}",
        'family   = "transfers"',
        *([f"epoch    = {np.datetime_as_string(flight.leaves, 'us')}"] if dated else []),
        "",
        "[start]",
        *start,
        "",
        "[device]",
        *_device(flight),
        "",
        "[steering]",
        *_table_lines(flight.table),
        "",
        "[target]",
        *(f"{key} = {_value(value)}" for key, value in target.items()),
        "",
        "[propagation]",
        f"duration_d = {float(flight.time / DAY)!r}",
        f"outputs = {outputs}",
        "tolerance = 1e-12",
    ]
    within = max(ALLOWED * flight.miss, 1e-8)
    radius = float(np.linalg.norm(flight.flown.position[-1])) / AU
    lines += ["", "[[expect]]", 'quantity = "radius_au"', 'at = "end"']
    lines += [f"value = {radius!r}", f"within = {within * radius:.1e}"]
    return "\n".join(lines) + "\n"


def _ways(whole: Solution) -> str:
    """From where to where, in words."""
    if isinstance(whole.end, (Distance, Escape, Arrival)):
        return f"from {whole.origin.name} to {whole.end.words}"
    past = "past" if isinstance(whole.end, FlyBy) else "to"
    assert whole.target is not None, "it is flown by or reached"
    return f"from {whole.origin.name} {past} {whole.target.name}"


def _limited(flight: Flight, it: replay.Solved, in_plane: bool) -> list[str]:
    """The steering's keys of a flight that touches a limit, or whose film is kept cool."""
    lines = []
    if it.touches and isinstance(flight, Transfer):
        jumps = flight.touches if in_plane else it.touches  # in the unit of the costates
        rows = (
            f"{{ time_d = {_number(there.time * TIME_UNIT / DAY)}, jump = {_number(one.jump)} }}"
            for there, one in zip(it.touches, jumps, strict=True)
        )
        lines.append(f"touches = [{', '.join(rows)}]")
    if it.coolness and isinstance(it.device, str):
        hottest = it.coolness**0.25 * float(temperature(AU, 0.0, it.device))
        lines.append(f"hottest_K = {_number(float(f'{hottest:.12g}'))}")
    return lines


def _expected_end(whole: Solution, position: np.ndarray, velocity: np.ndarray, within: float) -> list[str]:
    """What a flight to an end that is no orbit comes to, and what it keeps to. position, velocity : (n, 3) m, m/s."""
    r, v = position[-1], velocity[-1]
    distance = float(np.linalg.norm(r))
    along, across = float(r @ v) / distance, float(np.linalg.norm(np.cross(r, v))) / distance
    longitude = np.unwrap(np.arctan2(position[:, 1], position[:, 0]))
    speed = float(np.linalg.norm(v)) / 1e3
    limits, flight = whole.within, whole.flight
    wanted = [
        ("radius_au", "end", distance / AU, within * distance / AU),
        ("radial_speed_km_s", "end", along / 1e3, within * speed),
        ("transverse_speed_km_s", "end", across / 1e3, within * speed),
        ("longitude_deg", "end", math.degrees(longitude[-1]), math.degrees(within)),
    ]
    if isinstance(flight, Transfer) and flight.touches and limits.perihelion is not None:
        # rows beside the touching point: half a spacing away at most
        wanted.append(("radius_au", "min", limits.perihelion / AU, 1e-3 * limits.perihelion / AU))
    lines = []
    for quantity, at, value, tolerance in wanted:
        lines += ["", "[[expect]]", f'quantity = "{quantity}"', f'at = "{at}"']
        lines += [f"value = {float(f'{value:.10g}')!r}", f"within = {tolerance:.1e}"]
    return lines


def _plain(e: Elements) -> Elements:
    """Elements as Python's own numbers, what is rounding noise left out."""
    a, eccentricity, inclination, raan, argument = (
        float(x) for x in (e.semi_major_axis, e.eccentricity, e.inclination, e.raan, e.argument)
    )
    eccentricity *= eccentricity > 1e-9
    inclination *= inclination > 1e-9
    return Elements(a, eccentricity, inclination, raan, argument, 0.0)


def device_words(device: Film | str) -> str:
    """A sail in words, e.g. "Ideal solar sail"."""
    if not isinstance(device, str):
        return "Solar sail"
    if device in ELECTRIC_SAILS:
        model = device.removeprefix("electric-sail").lstrip("-")
        return f"E-sail ({model} model)" if model else "E-sail"
    return {"ideal": "Ideal solar sail", "eta-perfect": "Solar sail of 85 % efficiency"}.get(
        device, f"Solar sail with the film {device.upper()}"
    )


def _about(flight: Flight, it: replay.Solved, craft: str, ways: str, form: str) -> str:
    how = "its initial costates" if form == "costates" else "a table of pitch and clock angle"
    a_c = f"{it.characteristic_acceleration * 1e3:g} mm/s²"
    return (
        f"**{craft}** of {a_c}, steered {ways} by {how} in **{it.time / DAY:.4f} d** and {flight.revolutions:.3f} "
        f"revolutions: the best found, residual {flight.residual:.0e}.{flight.ending.mark}"
    )


def _start(flight: Flight, it: replay.Solved, circular: bool) -> list[str]:
    if circular and isinstance(flight, Transfer):
        return ['kind = "circular"', f"radius_au = {_number(flight.initial_radius / AU)}"]
    if isinstance(flight, Rendezvous):
        return _cartesian(it.position, it.velocity)
    e = elements(it.position, it.velocity, MU_SUN)
    angles = {name: np.degrees(getattr(e, name)) for name in ("inclination", "raan", "argument", "true_anomaly")}
    return [
        'kind = "elements"',
        f"semi_major_axis_au = {_number(float(e.semi_major_axis) / AU)}",
        f"eccentricity = {_number(float(e.eccentricity))}",
        *(f"{name}_deg = {_number(value)}" for name, value in angles.items()),
    ]


def _cartesian(position: np.ndarray, velocity: np.ndarray) -> list[str]:
    """A start of a state (3,) m, m/s."""
    return [
        'kind = "cartesian"',
        f"position_au = {_list(position / AU)}",
        f"velocity_km_s = {_list(velocity / 1e3)}",
    ]


def _device(it: replay.Solved | DirectFlight) -> list[str]:
    strength = f"characteristic_acceleration_mm_s2 = {_number(it.characteristic_acceleration * 1e3)}"
    if isinstance(it.device, Film):
        b = ", ".join(f"{name} = {_number(getattr(it.device, name))}" for name in ("b1", "b2", "b3", "efficiency"))
        return ['kind = "solar-sail"', f"film = {{ {b} }}", strength]
    if it.device in FILMS:
        return ['kind = "solar-sail"', f'film = "{it.device}"', strength]
    model = it.device.removeprefix("electric-sail").lstrip("-") or "final"
    return ['kind = "electric-sail"', f'model = "{model}"', strength]


def _arcs(it: replay.Solved) -> list[str]:
    if not it.arcs:
        return []
    rows = [f'  {{ kind = "{arc.kind}", duration_d = {_number((arc.end - arc.start) / DAY)} }},' for arc in it.arcs]
    return ["arcs = [", *rows, "]"]


def _steering_table(it: replay.Solved) -> list[str]:
    return _table_lines(replay.steering_table(it, error=ARC_TABLE_ERROR if it.arcs else TABLE_ERROR))


def _table_lines(found: replay.SteeringTable) -> list[str]:
    time = np.round(found.time, 4)
    again = np.nonzero(np.diff(time) <= 0)[0] + 1  # the second row of a switch
    time[again] = time[again - 1] + AFTER_SWITCH
    columns = {
        "time_d": [f"{t:.{12 if time[-1] < LONG else 14}g}" for t in time / DAY],
        "pitch_deg": [f"{x:.6f}" for x in np.degrees(found.pitch)],
        "clock_deg": [f"{x:.6f}" for x in np.degrees(found.clock)],
    }
    if found.throttle.min() < 1:
        columns["throttle"] = [f"{x:.8g}" for x in found.throttle]
    return ['kind = "table"', *(f"{name} = {_wrapped(values)}" for name, values in columns.items())]


def _expectations(reached: Elements, position: np.ndarray, within: float, met: bool) -> list[str]:
    """What a flight's end must be: the elements that the optimisation aimed at, or the place of the planet."""
    wanted: dict[str, tuple[float, float]] = {
        "semi_major_axis_au": (float(reached.semi_major_axis) / AU, within),
        "eccentricity": (float(reached.eccentricity), within),
    }
    tilt, node = float(reached.inclination), float(reached.raan)
    if tilt > 1e-9:
        wanted["inclination_deg"] = (math.degrees(tilt), math.degrees(within))
    if tilt > LEAST_TILT and abs(math.sin(node / 2)) > 1e-6:  # a node at 0 would be measured as 0 or as 360
        wanted["raan_deg"] = (math.degrees(node), math.degrees(within) / math.sin(tilt))
    if met:
        x, y, _ = position.T
        longitude = np.unwrap(np.arctan2(y, x))
        wanted["longitude_deg"] = (math.degrees(longitude[-1]), math.degrees(within))
        wanted["radius_au"] = (float(np.linalg.norm(position[-1])) / AU, within)
    lines = []
    for quantity, (value, tolerance) in wanted.items():
        if quantity == "eccentricity" and value < 0.1 * tolerance:
            value = 0.0
        lines += ["", "[[expect]]", f'quantity = "{quantity}"', 'at = "end"']
        lines += [f"value = {float(f'{value:.10g}')!r}", f"within = {tolerance:.1e}"]
    return lines


def _text(words: str) -> str:
    return json.dumps(words, ensure_ascii=False)


def _number(value: float) -> str:
    return repr(float(value))


def _value(value: str | float) -> str:
    return _text(value) if isinstance(value, str) else _number(value)


def _list(values: Iterable[float]) -> str:
    return "[" + ", ".join(_number(x) for x in values) + "]"


def _wrapped(words: Iterable[str], width: int = 110) -> str:
    """A list over several lines."""
    lines, line = [], "   "
    for word in words:
        if len(line) + len(word) + 2 > width:
            lines.append(line)
            line = "   "
        line += f" {word},"
    return "[\n" + "\n".join([*lines, line]) + "\n]"
