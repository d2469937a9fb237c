"""/plots, lanes, /log and /about: curves, lanes and words against columns, in the unit that the view's title tells."""

from __future__ import annotations

import re

import numpy as np

from . import axis, phases
from .facts import AU, DAY, path_word, planet_place
from .measure import hue, same_number
from .now import heights

UNITS = {  # SI to what a title says
    "": 1.0,
    "deg": 180 / np.pi,
    "au": 1 / AU,
    "0.001 au": 1000 / AU,
    "km": 1e-3,
    "km/s": 1e-3,
    "mm/s²": 1e3,
    "µm/s²": 1e6,
    "nm/s²": 1e9,
    "nPa": 1e9,
    "nT": 1e9,
    "nN": 1e9,
    "µN m": 1e6,
    "mN m s": 1e3,
    "mN m": 1e3,
    "deg/s": 180 / np.pi,
    "mN": 1e3,
    "mA": 1e3,
    "mm": 1e3,
    "kV": 1e-3,
    "%": 100.0,
    "yr": 1.0,
    "N m": 1.0,
    "rpm": 30 / np.pi,
    "% of the distance": 100.0,
    **{same: 1.0 for same in ("V", "W", "W/m²", "K", "eV", "s", "u", "sfu")},
}
CURVES = {  # the colour of a curve by what it shows
    "sail": "yellow",
    "push": "orange",
    "drag": "orange",
    "clock": "pink",
    "distance": "blue",
    "altitude": "blue",
    "speed": "green",
    "inclination": "turquoise",
}
TWINS = 0.015  # of the range, within which two curves are drawn as one


def view_of(f, entity):
    """The view that shows a plot, None where there is none."""
    views = [view for view in f.picture.views if view.kind == "TimeSeries" and view.shows(entity)]
    assert len(views) <= 1
    return views[0] if views else None


def unit_of(f, entity) -> str:
    view = view_of(f, entity)
    assert view is not None, "in no view"
    return view.unit


def convert(f, entity, values):
    """SI values in the unit of the view's title."""
    unit = unit_of(f, entity)
    if unit.startswith("log10 of "):
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
    again = np.flatnonzero(np.diff(steps) == 0) + 1
    assert steps[again].tolist() == f.truth.breaks, "a curve leads over a gap"
    assert not np.isfinite(values[again]).any(), "a value where there is no data"
    steps, values = np.delete(steps, again), np.delete(values, again, axis=0)
    assert values.shape == (len(f.truth), len(names))
    assert np.array_equal(steps, f.truth.steps)
    return values, names


def in_range(f, entity, values):
    """The view's ordinate holds all that is drawn, but for an axis that grows without bound."""
    view = view_of(f, entity)
    if not entity.startswith("/plots/distance"):
        low, high = view.range
        size = 1e-9 * max(abs(low), abs(high))
        assert low - size <= np.nanmin(values)
        assert np.nanmax(values) <= high + size


def series(f, entity, columns):
    """Curves against columns, name by name; a joint name only where they coincide as far as the eye can tell."""
    if re.search(r"/\d+/(band|mean)$", entity):
        swung(f, entity, columns)
        return
    values, names = drawn_series(f, entity)
    reach = np.nanmax([np.nanmax(v) - np.nanmin(v) for v in (convert(f, entity, c) for c in columns.values())])
    for k, joint in enumerate(names):
        first, *twins = joint.split(" = ")
        same_number(values[:, k], convert(f, entity, columns[first]))
        for name in twins:
            off = np.abs(values[:, k] - convert(f, entity, columns[name]))
            assert np.nanmax(off) <= 1.001 * TWINS * reach, f"{joint} do not coincide"
        colored(f, entity, k, first)
    colors = {tuple(color) for color in f.picture.color(entity, "SeriesLines:colors")}
    assert len(colors) == len(names)
    in_range(f, entity, values)


def colored(f, entity, k, name):
    if name in CURVES:
        assert hue(f.picture.color(entity, "SeriesLines:colors")[k]) == CURVES[name], name


def swung(f, entity, columns):
    """Of what swings within a revolution: the least and the largest value of every stretch of the time, and its mean
    of all rows in it."""
    kind = entity.rsplit("/", 1)[1]
    component = "Measurements:names" if kind == "band" else "SeriesLines:names"
    (label,) = f.picture.fixed(entity, component)
    name = label.removesuffix(", mean").removesuffix(", least to largest").split(" = ")[0]
    true = convert(f, entity, columns[name])
    clocks = sorted(f.picture.clocks[entity], key=lambda clock: clock[1])
    middle = np.array([clock[1] for clock in clocks]) * 1e-9 - f.truth.time[0]
    gap = np.diff(middle).min()
    first = middle[0] - 0.5 * gap
    begun = np.round(first / gap) * gap
    place = np.floor((f.truth.time - f.truth.time[0] - begun) / gap + 1e-9).astype(int)
    which = np.round((middle - begun) / gap - 0.5).astype(int)
    rows = [true[place == k] if k < which[-1] else true[place >= k] for k in which]
    if kind == "band":
        _, values = f.picture.rows(entity, "Measurements:values")
        _, spread = f.picture.rows(entity, "Measurements:variances")
        centre, half = (np.array(part, float)[:, 0] for part in (values, spread))
        half = np.sqrt(half)
        same_number(centre - half, np.array([np.nanmin(part) for part in rows]), 1e-6)
        same_number(centre + half, np.array([np.nanmax(part) for part in rows]), 1e-6)
        in_range(f, entity, np.concatenate([centre - half, centre + half]))
    else:
        _, values = f.picture.rows(entity, "Scalars:scalars")
        same_number(np.array(values)[:, 0], np.array([np.nanmean(part) for part in rows]), 1e-9)


def distance(f, entity, *_):
    """Distance and semi-major axis, from the centre."""
    a = f.truth.elements["semi_major_axis_m"]
    far = np.linalg.norm(f.truth.position, axis=1)
    series(f, entity, {"distance": far, "semi-major axis": np.where(a > 0, a, np.nan)})


def altitude(f, entity, *_):
    """Heights over the radius of the planet."""
    a, e = f.truth.elements["semi_major_axis_m"], f.truth.elements["eccentricity"]
    radius, known = f.truth.radius, f.truth.environment
    columns = {
        "altitude": known.get("mean_altitude_m", a - radius),
        "lowest": a * (1 - e) - radius,
        "highest": a * (1 + e) - radius,
    }
    if "quasi_circular_altitude_m" in known:
        columns["closed form"] = known["quasi_circular_altitude_m"]
    series(f, entity, columns)


def element(f, entity, *_):
    """Inclination or eccentricity."""
    names = {"inclination": "inclination_rad", "eccentricity": "eccentricity"}
    series(f, entity, {name: f.truth.elements[key] for name, key in names.items() if name in entity})


def speed(f, entity, *_):
    """The size of the velocity."""
    series(f, entity, {"speed": np.linalg.norm(f.truth.velocity, axis=1)})


def height(f, entity, *_):
    """Over the plane x, y."""
    series(f, entity, {"height": f.truth.position[:, 2]})


def from_earth(f, entity, *_):
    """The distance from the Earth, from her mean elements."""
    off = f.truth.position - planet_place("Earth", f.truth.seconds)
    series(f, entity, {"distance from the Earth": np.linalg.norm(off, axis=1)})


def angles(f, entity, *_):
    """Pitch and cone; no cone without thrust, neither of a stowed sail."""
    assert np.array_equal(np.isnan(f.truth.pitch), f.truth.stowed)
    pushed = np.any(f.truth.thrust, axis=1)
    series(f, entity, {"sail": f.truth.pitch, "push": np.where(pushed, f.truth.cone, np.nan)})


def clock(f, entity, *_):
    """The clock angle, in whichever turn does not jump."""
    values, _ = drawn_series(f, entity)
    off = np.radians(values[:, 0]) - f.truth.clock_angle
    assert np.array_equal(np.isnan(off), f.truth.stowed)
    off = off[~f.truth.stowed]
    assert np.abs(off - 2 * np.pi * np.round(off / (2 * np.pi))).max() < 1e-9
    assert hue(f.picture.color(entity, "SeriesLines:colors")[0]) == "pink"
    assert unit_of(f, entity) == "deg"
    in_range(f, entity, values)


def thrust(f, entity, *_):
    """The size of the thrust, in the colour of its arrow."""
    size = np.linalg.norm(f.truth.thrust, axis=1)
    devices = {name: device["magnitude_m_s2"] for name, device in f.truth.devices.items()}
    series(f, entity, {"drag" if f.truth.kind == "plasma-brake" else "push": size, **devices})


def off_by(f, entity, *_):
    """How far other answers are off, of the distance."""
    table, distance = f.truth.recording["/approximation"], np.linalg.norm(f.truth.position, axis=1)
    names = [key.removesuffix("_position_m") for key in table if key.endswith("_position_m")]
    off = {n: np.linalg.norm(table[f"{n}_position_m"] - f.truth.position, axis=1) / distance for n in names}
    told = [name for joint in f.picture.fixed(entity, "SeriesLines:names") for name in joint.split(" = ")]
    series(f, entity, {name: off[name.replace(" ", "_")] for name in told})


def film_temperature(f, entity, *_):
    """How warm the film is, and what the scene says that it bears."""
    columns = {"film": f.truth.film["temperature_K"]}
    limit = f.truth.resolved["device"].get("hottest")
    if limit is not None:
        columns["limit"] = np.full(len(f.truth), limit)
    series(f, entity, columns)


def dose(f, entity, *_):
    """The dose of a film that ages, as it is recorded."""
    series(f, entity, {"dose": f.truth.film["dose_yr"]})


def acting(f, entity, name, *_):
    """A column of /environment; the curve is called what it is."""
    kind = "Measurements:names" if entity.endswith("/band") else "SeriesLines:names"
    (label,) = f.picture.fixed(entity, kind)
    label = label.removesuffix(", mean").removesuffix(", least to largest")
    assert name.replace("_", " ").startswith(label)
    series(f, entity, {label: si(name, f.truth.environment[name])})


def si(name: str, values):
    """Columns whose names end in a unit that is not SI, in the unit that their plots have as well."""
    for ending, factor in (("_deg", np.pi / 180), ("_km", 1e3), ("_kV", 1e3)):
        if name.endswith(ending):
            return values * factor
    return values


LANES = {  # what a truth value means in words
    "thrust": ("Thrust on", "Coast"),
    "sunlit": ("Sunlit", "Eclipse"),
    "stowed": ("Sail stowed", "Sail out"),
    "force_law_valid": ("Force law valid", "Outside its range"),
}


LANE_OF = {"push": "thrust", "light": "sunlit"}  # words on lanes for columns


def lane(f, entity):
    """On and off as the column says, row by row; unknown only where rows are far apart on their orbit; and from the
    beginning of each gap "no data" until the next row."""
    name = LANE_OF.get(entity.strip("/"), entity.strip("/"))
    own = {f"on/{path_word(device)}": device for device in f.truth.devices}
    if name in own:
        column = f.truth.devices[own[name]]["on"].astype(bool)
    else:
        column = f.truth.on if name == "thrust" else f.truth.environment[name].astype(bool)
    values, labels = (f.picture.fixed(entity, f"StateConfiguration:{key}") for key in ("values", "labels"))
    told = dict(zip(values, labels, strict=True))
    on, off = LANES.get(name, (name.replace("_", " "), f"no {name.replace('_', ' ')}"))
    if name == "thrust" and f.truth.kind == "plasma-brake":
        on, off = "Brake on", "Brake off"
    on, off = (f"{own[name]} on", f"{own[name]} off") if name in own else (on, off)
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
    within = sorted(f.picture.between[entity]["StateChange:state"])
    assert [value for _, (value,) in within] == ["no data"] * len(f.truth.gaps)
    assert told.get("no data", "no data") == "no data"
    for (ns, _), (start, end), row in zip(within, f.truth.gaps, f.truth.breaks, strict=True):
        assert start < ns * 1e-9 < end
        assert row + 1 in f.picture.rows(entity, "StateChange:state")[0], "no data goes on after the gap"
    bright, dark = f.picture.color(entity, "StateConfiguration:colors")[:2, :3]
    assert name != "sunlit" or bright.sum() > 2 * dark.sum()


def log(f, entity):
    """The events with their times, at the rows at or after them, after a line that says start; those of a flight beside
    the first after its name, at their time on the first one's clock."""
    steps, lines = f.picture.rows(entity, "TextLog:text")
    rows = list(zip(steps.tolist(), (line[0] for line in lines), strict=True))
    beside = {word: [] for word in (g.called for g in f.all[1:])}
    for row in rows[:]:
        called = next((word for word in beside if f": {word}: " in row[1]), None)
        if called:
            beside[called].append(row[1].replace(f"{called}: ", ""))
            rows.remove(row)
    for g in f.all[1:]:
        of_it(g, beside[g.called])
    steps, lines = ([row[k] for row in rows] for k in (0, 1))
    assert (steps[0], lines[0]) == (0, "start")
    events = f.truth.recording.events
    assert len(lines) == 1 + len(events)
    for step, line, event in zip(steps[1:], lines[1:], events, strict=True):
        assert step == np.searchsorted(f.truth.time, event.time) == event.step
        word, value, small, name = re.fullmatch(r"(?:(day|hour|year) (\S+)|(\S+) s): (.*)", line).groups()
        seconds = float(value) * {"day": DAY, "hour": 3600.0, "year": 365.25 * DAY}[word] if word else float(small)
        assert abs(seconds - event.time) <= 6e-4 * event.time
        assert name == event.name
        before, after = f.truth.position[max(step - 1, 0)], f.truth.position[step]
        reach = np.linalg.norm(after - before)
        place = event.state[:3]
        assert min(np.linalg.norm(place - before), np.linalg.norm(place - after)) <= reach


def of_it(f, lines):
    """The events of a flight beside the first."""
    path = f"{f.truth.top}/events"
    table = f.truth.recording.get(path, {"time_s": [], "name": []})
    assert len(lines) == len(table["time_s"])
    for line, time, name in zip(lines, table["time_s"], table["name"], strict=True):
        word, value, small, told = re.fullmatch(r"(?:(day|hour|year) (\S+)|(\S+) s): (.*)", line).groups()
        seconds = float(value) * {"day": DAY, "hour": 3600.0, "year": 365.25 * DAY}[word] if word else float(small)
        assert abs(seconds - (time + f.truth.clock[0] - f.truth.time[0])) <= 6e-4 * abs(seconds)
        assert told == name


def about(f, entity):
    """The description: the scene's own sentence first, colours by their names, what is steady, no words of the code."""
    text = f.picture.fixed(entity, "TextDocument:text")[0]
    for told, name in re.findall(r"^\| \*\*(\w+)\*\* \|.*\| (.*?) \|$", text, re.MULTILINE):
        words = {hue(color) for color in ensemble_colors(f, name)}
        assert words == {told}, f"{name} is {' and '.join(sorted(words))}, not {told}"
    assert not re.search(r"expected|_deg|_au|/world|a_c", text)
    many = text.count("\n| **") > 1  # then the table takes the room
    walls, sphere = any(e.startswith("/world/fence") for e in f.picture.entities), axis.first(f)
    assert many or ("**wall on the trail**" in text) == (walls and not sphere)
    assert many or ("**sphere** is of directions: the cyan line" in text) == sphere
    if "the **turquoise** arrow is the primer" in text:
        assert "/sail/primer" in f.picture.entities
    rows_told(f, text)
    phases.told(f, text)
    steady(f, text)
    if f.truth.round_planet and "/world/tail" in f.picture.entities:
        orbit_colors(f, text)


def steady(f, text):
    """What is said to be steady is, within 2 %."""
    for words in re.findall(r"Steady all along: (.*)", text):
        for part in re.findall(r"\*\*(.*?)\*\*", words):
            number = float(re.search(r"([\d.]+)", part).group(1))
            if part.startswith("distance") and part.endswith(" au"):
                values = np.linalg.norm(f.truth.position, axis=1) / AU
            elif "°" in part:
                values = np.degrees(f.truth.pitch)
            elif part.startswith(("push", "drag")):
                size = {"mm/s²": 1e-3, "µm/s²": 1e-6, "nm/s²": 1e-9}[part.split()[-1]]
                values = np.linalg.norm(f.truth.thrust, axis=1) / size
            else:
                continue
            assert np.abs(values / number - 1).max() < 0.06, part


def rows_told(f, text):
    """What of the picture is no data: gaps and how long they are, few rows in a revolution, a stowed sail."""
    told = re.search(r"\*\*no data\*\* (once|(\d+) times), ([\d.e+]+) (day|hour)s in all", text)
    assert (told is not None) == bool(len(f.truth.gaps)), "gaps are not told"
    if told:
        assert int(told.group(2) or 1) == len(f.truth.gaps)
        size = {"day": DAY, "hour": 3600.0}[told.group(4)]
        assert abs(float(told.group(3)) * size / np.sum(np.diff(f.truth.gaps)) - 1) < 6e-3
    assert ("**stowed**" in text) == (f.truth.stowed.any() and f.truth.kind in ("solar-sail", "electric-sail"))
    a = f.truth.elements["semi_major_axis_m"]
    rate = np.where(a > 0, np.sqrt(f.truth.mu / np.abs(a) ** 3), 0.0) / (2 * np.pi)
    turned = np.delete(0.5 * (rate[1:] + rate[:-1]) * np.diff(f.truth.time), f.truth.breaks).sum()
    rows = len(f.truth) - 1
    few = re.search(
        r"\*\*(?:([\d.]+) rows in a revolution|rows are ([\d.e+]+) (revolutions apart|in a revolution))\*\*", text
    )
    slowed = "are shown" in text  # then the line of the orbit says it
    assert slowed or (few is not None) == (turned > rows / 12), f"{rows / max(turned, 1e-9):.3g} rows in a revolution"
    if few:
        number = float(few.group(1) or few.group(2))
        assert abs(number / (turned / rows if few.group(3) == "revolutions apart" else rows / turned) - 1) < 0.06
    assert ("follows gravity" in text) == ("/world/trail/recent" in f.picture.entities and bool(far_rows(f)))
    assert ", bent by the thrust," not in text or np.any(f.truth.thrust)


def far_rows(f) -> list[int]:
    """Rows k that lie more than a twelfth of a revolution before row k + 1, with data between."""
    r2 = np.sum(f.truth.position**2, axis=1)
    rate = np.linalg.norm(np.cross(f.truth.position, f.truth.velocity), axis=1) / r2
    a = f.truth.elements["semi_major_axis_m"]
    rate = np.maximum(rate, np.where(a > 0, np.sqrt(f.truth.mu / np.abs(a) ** 3), 0.0)) / (2 * np.pi)
    far = np.flatnonzero(np.maximum(rate[1:], rate[:-1]) * np.diff(f.truth.time) > 1 / 12)
    return [k for k in far.tolist() if k not in f.truth.breaks]


def ensemble_colors(f, name):
    path = "".join(letter if letter.isalnum() else "_" for letter in name.lower())
    kinds = {"LineStrips3D:colors", "Points3D:colors", "LineStrips2D:colors", "Points2D:colors", "BarChart:color"}
    found = []
    for entity in f.picture.entities:
        if re.search(rf"/{re.escape(path)}(/|$)", entity) and not entity.startswith("/plots"):
            found += [f.picture.color(entity, kind)[0] for kind in kinds & f.picture.components(entity)]
    assert len(found) > (1 if "/axis/ensemble" in " ".join(f.picture.entities) else 4)
    return found


def orbit_colors(f, text):
    """Altitudes that belong to colours, and how many turns are shown of how many."""
    high = heights(f) / 1e3
    if high[0] - high.min() < 1.0 and f.truth.slower <= 1.5:
        assert "**pink**" not in text
        return
    blue, pink = re.search(r"\*\*blue\*\* at (\d+) km to \*\*pink\*\* at (-?\d+) km", text).groups()
    assert abs(float(blue) - high[0]) <= 0.51
    assert abs(float(pink) - high.min()) <= 0.51
    turns = re.search(r"of ([\d,]+) turns (\d+) are shown", text)
    assert (turns is not None) == (f.truth.slower > 1.5)
    if turns:
        assert abs(float(turns.group(1).replace(",", "")) / float(turns.group(2)) / f.truth.slower - 1) < 0.05
