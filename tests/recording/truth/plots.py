"""/plots, /phase, /log and /about: curves, lanes and words against columns, in the unit that the view's title tells."""

from __future__ import annotations

import re
from itertools import pairwise

import numpy as np

from .facts import AU, DAY
from .measure import hue, same_number

UNITS = {  # SI to what a title says
    "": 1.0,
    "deg": 180 / np.pi,
    "au": 1 / AU,
    "10⁻³ au": 1000 / AU,
    "km": 1e-3,
    "km/s": 1e-3,
    "mm/s²": 1e3,
    "µm/s²": 1e6,
    "nm/s²": 1e9,
    "nPa": 1e9,
    "nT": 1e9,
    "nN/m": 1e9,
    "mN": 1e3,
    "mA": 1e3,
    "kV": 1e-3,
    "%": 100.0,
    "% of r": 100.0,
    **{same: 1.0 for same in ("V", "W", "W/m²", "K", "eV", "s", "u", "sfu")},
}
UNSHOWN = {  # curves that are recorded for a view that not every run has
    "/plots/inclination": "deg",
    "/plots/eccentricity": "",
    "/plots/clock": "deg",
    "/plots/angles": "deg",
    "/plots/thrust_factor": "",
    "/plots/electrochromic_state": "",
    "/plots/ensemble/height_m": "10⁻³ au",
    "/plots/ensemble/radial_speed_m_s": "km/s",
}
SERIES_HUES = {"pitch": "yellow", "cone": "orange", "clock": "pink", "thrust": "orange", "drag": "orange"}


def view_of(f, entity):
    """The view that shows a plot, None where there is none."""
    views = [view for view in f.picture.views if view.kind == "TimeSeries" and view.shows(entity)]
    assert len(views) <= 1
    return views[0] if views else None


def unit_of(f, entity) -> str:
    view = view_of(f, entity)
    if view is not None:
        return view.unit
    known = [unit for path, unit in UNSHOWN.items() if entity == path or entity.startswith(f"{path}/")]
    assert known, "in no view"
    return known[0]


def convert(f, entity, values):
    """SI values in the unit of the view's title."""
    unit = unit_of(f, entity)
    if unit.startswith("log10 "):
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.log10(values)
    if unit.endswith(" m") and unit.startswith("10^"):
        return np.asarray(values) / 10 ** float(unit[3:-2])
    if unit.endswith(" radii"):
        return np.asarray(values) / f.truth.radius
    return np.asarray(values) * UNITS[unit]


def drawn_series(f, entity):
    """Steps, and values (n, k) of a plot, with the names of its k curves."""
    steps, values = f.picture.rows(entity, "Scalars:scalars")
    names = f.picture.fixed(entity, "SeriesLines:names")
    values = np.array(values)
    assert values.shape == (len(f.truth), len(names))
    assert np.array_equal(steps, f.truth.steps)
    return values, names


def in_range(f, entity, values):
    """The view's ordinate holds all that is drawn, but for an axis that grows without bound."""
    view = view_of(f, entity)
    if view is not None and not entity.startswith("/plots/distance"):
        low, high = view.range
        size = 1e-9 * max(abs(low), abs(high))
        assert low - size <= np.nanmin(values)
        assert np.nanmax(values) <= high + size


def series(f, entity, columns):
    """Curves against columns, name by name."""
    values, names = drawn_series(f, entity)
    for k, name in enumerate(names):
        same_number(values[:, k], convert(f, entity, columns[name]))
        if name in SERIES_HUES:
            assert hue(f.picture.color(entity, "SeriesLines:colors")[k]) == SERIES_HUES[name]
    colors = {tuple(color) for color in f.picture.color(entity, "SeriesLines:colors")}
    assert len(colors) == len(names)
    in_range(f, entity, values)


def distance(f, entity):
    """Distance and semi-major axis, from the centre."""
    a = f.truth.elements["semi_major_axis_m"]
    columns = {"r": np.linalg.norm(f.truth.position, axis=1), "a": np.where(a > 0, a, np.nan)}
    series(f, entity, columns)


def altitude(f, entity):
    """Heights over the radius of the planet."""
    a, e = f.truth.elements["semi_major_axis_m"], f.truth.elements["eccentricity"]
    radius, known = f.truth.radius, f.truth.environment
    series(
        f,
        entity,
        {
            "h": np.linalg.norm(f.truth.position, axis=1) - radius,
            "a - R": a - radius,
            "perigee": a * (1 - e) - radius,
            "apogee": a * (1 + e) - radius,
            "mean": known.get("mean_altitude_m", a - radius),
            "analytic decay": known.get("quasi_circular_altitude_m"),
        },
    )


def element(f, entity):
    """Inclination or eccentricity."""
    series(f, entity, {"i": f.truth.elements["inclination_rad"], "e": f.truth.elements["eccentricity"]})


def angles(f, entity):
    """Pitch and cone; no cone without thrust."""
    pushed = np.any(f.truth.thrust, axis=1)
    series(f, entity, {"pitch": f.truth.pitch, "cone": np.where(pushed, f.truth.cone, np.nan)})
    view = view_of(f, entity)
    told = re.search(r", clock (\S+)$", view.name) if view else None
    if told:
        turn = np.exp(1j * f.truth.clock)
        assert np.degrees(np.abs(np.angle(turn / turn.mean()))).max() < 0.5
        mean = np.degrees(np.angle(turn.mean()))
        assert abs((float(told.group(1)) - mean + 180) % 360 - 180) < 0.06


def clock(f, entity):
    """The clock angle, in whichever turn does not jump."""
    values, _ = drawn_series(f, entity)
    off = np.radians(values[:, 0]) - f.truth.clock
    assert np.abs(off - 2 * np.pi * np.round(off / (2 * np.pi))).max() < 1e-9
    assert hue(f.picture.color(entity, "SeriesLines:colors")[0]) == "pink"
    assert unit_of(f, entity) == "deg"
    in_range(f, entity, values)


def thrust(f, entity):
    """The size of the thrust, in the colour of its arrow."""
    size = np.linalg.norm(f.truth.thrust, axis=1)
    series(f, entity, {"thrust": size, "drag": size})


def off_by(f, entity):
    """How far other answers are off, of the distance."""
    table, distance = f.truth.recording["/approximation"], np.linalg.norm(f.truth.position, axis=1)
    names = f.picture.fixed(entity, "SeriesLines:names")
    places = {name: table[f"{name.replace(' ', '_')}_position_m"] for name in names}
    series(f, entity, {n: np.linalg.norm(p - f.truth.position, axis=1) / distance for n, p in places.items()})


def acting(f, entity, name):
    """A column of /environment; the curve is called what it is."""
    values = f.truth.environment[name]
    (label,) = f.picture.fixed(entity, "SeriesLines:names")
    assert name.replace("_", " ").startswith(label)
    series(f, entity, {label: si(name, values)})
    view = view_of(f, entity)
    assert view is None or view.name.lower().startswith(label)


def si(name: str, values):
    """Columns whose names end in a unit that is not SI, in the unit that their plots have as well."""
    for ending, factor in (("_deg", np.pi / 180), ("_km", 1e3), ("_kV", 1e3)):
        if name.endswith(ending):
            return values * factor
    return values


LANES = {  # what a truth value means in words
    "thrust": ("Thrust on", "Coast"),
    "sunlit": ("Sunlit", "Eclipse"),
    "force_law_valid": ("Force law valid", "Outside its range"),
}


def lane(f, entity, name):
    """On and off as the column says, row by row; unknown only where rows are far apart on their orbit."""
    column = f.truth.on if name == "thrust" else f.truth.environment[name].astype(bool)
    values, labels = (f.picture.fixed(entity, f"StateConfiguration:{key}") for key in ("values", "labels"))
    told = dict(zip(values, labels, strict=True))
    on, off = LANES.get(name, (name.replace("_", " "), f"no {name.replace('_', ' ')}"))
    if name == "thrust" and f.truth.kind == "plasma-brake":
        on, off = "Brake on", "Brake off"
    assert told["on"] == on
    assert told["off"] == off
    gap = np.diff(f.truth.time, prepend=f.truth.time[0])
    for row, step in enumerate(f.truth.steps):
        shown = f.picture.at(entity, "StateChange:state", step)[0]
        if shown == "unknown":
            assert name == "sunlit"
            assert gap[row] > 0.2 * f.truth.period
        else:
            assert told[shown] == (on if column[row] else off), f"row {row}: {told[shown]}"
    bright, dark = f.picture.color(entity, "StateConfiguration:colors")[:2, :3]
    assert name != "sunlit" or bright.sum() > 2 * dark.sum()


def log(f, entity):
    """The events with their times, at the rows at or after them, after a line that says start."""
    steps, lines = f.picture.rows(entity, "TextLog:text")
    lines = [line[0] for line in lines]
    assert (steps[0], lines[0]) == (0, "start")
    events = f.truth.recording.events
    assert len(lines) == 1 + len(events)
    for step, line, event in zip(steps[1:], lines[1:], events, strict=True):
        assert step == np.searchsorted(f.truth.time, event.time) == event.step
        value, unit, name = re.fullmatch(r"(\S+) (d|h|s): (.*)", line).groups()
        seconds = float(value) * {"d": DAY, "h": 3600.0, "s": 1.0}[unit]
        assert abs(seconds - event.time) <= 6e-4 * event.time
        assert name == event.name
        before, after = f.truth.position[max(step - 1, 0)], f.truth.position[step]
        reach = np.linalg.norm(after - before)
        place = event.state[:3]
        assert min(np.linalg.norm(place - before), np.linalg.norm(place - after)) <= reach


def about(f, entity):
    """The description: the title, numbers of the scene, and colours by their names."""
    text = f.picture.fixed(entity, "TextDocument:text")[0]
    assert text.startswith(f"**{f.truth.scene['title']}**")
    lines = text.splitlines()
    for told, name in re.findall(r"\*\*(\w+)\*\*: (.*?) \(", text):
        words = {hue(color) for color in ensemble_colors(f, name)}
        assert words == {told}, f"{name} is {' and '.join(sorted(words))}, not {told}"
    if "primer_direction" in f.truth.environment:
        assert any("**turquoise** arrow is the primer" in line for line in lines)
    parameters(f, lines[-1])
    if f.truth.round_planet and "/world/plane" in f.picture.entities:
        orbit_colors(f, text)


def ensemble_colors(f, name):
    path = "".join(letter if letter.isalnum() else "_" for letter in name.lower())
    kinds = {"LineStrips3D:colors", "Points3D:colors", "LineStrips2D:colors", "Points2D:colors", "BarChart:color"}
    found = []
    for entity in f.picture.entities:
        if re.search(rf"/{re.escape(path)}(/|$)", entity) and not entity.startswith("/plots"):
            found += [f.picture.color(entity, kind)[0] for kind in kinds & f.picture.components(entity)]
    assert len(found) > 4
    return found


def parameters(f, line):
    """Numbers in the description's last line that are those of the scene."""
    told = {name.strip(): value for name, value in re.findall(r"([^·*]+) \*\*([^*]+)\*\*", line)}
    start, device = f.truth.resolved.get("start", {}), f.truth.resolved.get("device", {})
    found = 0
    for name, value, unit in (
        ("elevation", start.get("elevation"), "°"),
        ("inclination", start.get("inclination"), "°"),
        ("initial radius", start.get("radius"), "au"),
        ("mass", device.get("mass") if isinstance(device, dict) else None, "kg"),
        ("tether", device.get("tether_length") if isinstance(device, dict) else None, "m"),
    ):
        if name in told and value is not None:
            number, end = re.fullmatch(r"([\d.,]+) ?(\S*)", told[name]).groups()
            if end == unit:
                factor = {"°": 180 / np.pi, "au": 1 / AU}.get(unit, 1.0)
                assert abs(float(number.replace(",", "")) - factor * value) <= 5e-4 * factor * value, told[name]
                found += 1
    if told.get("rows"):
        assert int(told["rows"].replace(",", "")) == len(f.truth)
        found += 1
    return found


def orbit_colors(f, text):
    """Altitudes that belong to colours."""
    blue, pale = re.search(r"\*\*blue\*\* at (\d+) km, pale at (\d+) km, \*\*orange\*\* at the ground", text).groups()
    start = (np.linalg.norm(f.truth.position[0]) - f.truth.radius) / 1e3
    assert abs(float(blue) - start) <= 0.5
    assert abs(float(pale) - 0.75 * start) <= 0.5
    every, unit = re.search(r"a faint ring every (\S+) (d|h)", text).groups()
    steps, _ = f.picture.rows("/world/ladder", "LineStrips3D:strips")
    gap = np.median([b - a for a, b in pairwise(f.truth.time[steps])])
    assert abs(float(every) * {"d": DAY, "h": 3600}[unit] - gap) <= 1.01 * np.diff(f.truth.time).max()
