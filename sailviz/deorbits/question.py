"""A question about a descent as the text of a scene that flies it, and of a sweep that says how sure the answer is."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path

from sailviz.constants import J2_EARTH, MU_EARTH, RADIUS_EARTH

RE_ENTRY = "re-entry"
RE_ENTRY_KM = 120
AIR_SPREAD, PLASMA_SPREAD = 0.15, 0.5  # one sigma of the logarithm: of the density of NRLMSIS and of that of IRI
QUIET, ACTIVE = 70, 190  # sfu, between which the Sun of a drawn flight stays; the ionosphere table ends at 193
DRAWN_ROWS, DRAWN_TOLERANCE = 40, 1e-7  # of a drawn flight, whose end alone is told: it errs by 0.1 % of the time
TROPICAL_YEAR = 365.2422 * 86_400.0  # s in which the mean Sun goes round


@dataclass(frozen=True)
class Question:
    """A craft in low orbit and what brings it down.

    tle : file with the element set of its orbit; without it altitude m over the equatorial radius (mean), inclination
    rad (None: Sun-synchronous) and epoch, an ISO date. local_time : h of the ascending node, of a Sun-synchronous
    orbit. mass : kg. tether : m of a plasma brake, 0 for none; voltage : V, its size. drag_area : m2, mean over how it
    tumbles, None where no air is asked for. weather : file of solar and geomagnetic activity. years : to fly at most.
    Files are named in the scene without their folder: they lie beside it. ValueError, in a sentence, for what cannot
    be.
    """

    mass: float
    tle: Path | None = None
    altitude: float | None = None
    inclination: float | None = None
    local_time: float = 10.5
    epoch: str = ""
    tether: float = 0.0
    voltage: float = 1000.0
    drag_area: float | None = None
    drag_coefficient: float = 2.2
    weather: Path | None = None
    years: float = 26.0

    def __post_init__(self) -> None:
        if (self.tle is None) == (self.altitude is None):
            raise ValueError("say where it flies: either the file of an element set (--tle) or an altitude")
        for file in self.files:
            if not file.is_file():
                raise ValueError(f"there is no file {file}")
        if not self.tether and self.drag_area is None:
            raise ValueError("nothing brings it down: give a tether, a drag area, or both")

    @property
    def files(self) -> list[Path]:
        """What must lie beside the scene."""
        return [file for file in (self.tle, self.weather) if file is not None]

    @property
    def brake(self) -> str:
        """What brings it down, in words."""
        words = [f"{self.tether:g} m of tether at {self.voltage:g} V"] * bool(self.tether)
        if self.drag_area is not None:
            words.append(f"{self.drag_area:g} m² of drag area")
        return " and ".join(words)


def sun_synchronous(altitude: float) -> float:
    """Inclination, rad, of the circular orbit whose node turns with the mean Sun under J2 alone. altitude : m over the
    equatorial radius. ValueError where there is none."""
    axis = RADIUS_EARTH + altitude
    rate = 1.5 * math.sqrt(MU_EARTH / axis**3) * J2_EARTH * (RADIUS_EARTH / axis) ** 2
    cosine = -2 * math.pi / TROPICAL_YEAR / rate
    if cosine < -1:
        raise ValueError(f"at {altitude / 1e3:g} km no orbit is Sun-synchronous: give an inclination in degrees")
    return math.acos(cosine)


def scene_text(question: Question) -> str:
    """The text of the scene: TOML, for `load_scene` of what `tomllib` makes of it."""
    q = question
    where = "from its element set" if q.altitude is None else f"from {q.altitude / 1e3:g} km"
    lines = [f"title    = {_text(f'{q.mass:g} kg comes down {where} with {q.brake}')}"]
    if q.epoch:
        lines.append(f"epoch    = {q.epoch}")
    lines += ['body     = "earth"', "", "[start]", *_start(q), "", "[device]", *_device(q), "", *_around(q), ""]
    lines += [
        "[propagation]",
        f"duration_yr = {q.years:.12g}",
        "outputs = 4000",
        "",
        "[[event]]",
        'kind = "altitude"',
        f"name = {_text(RE_ENTRY)}",
        f"altitude_km = {RE_ENTRY_KM}",
        'sense = "down"',
        "stop = true",
    ]
    return "\n".join(lines) + "\n"


def sweep_text(question: Question, scene: str, draws: int, seed: int = 0) -> str:
    """The text of the sweep that draws what is not known: the air by its drag coefficient, the plasma, and where no
    weather was given the Sun. scene : name of the scene's file, beside the sweep's."""
    q = question
    lines = [
        "[sweep]",
        f"scene = {_text(scene)}",
        f"draws = {draws}",
        f"seed = {seed}",
        f'report = ["time_yr@{RE_ENTRY}"]',
        "",
        "[set]",
        *(f"{key} = {value:g}" for key, value in drawn_values().items()),
    ]
    for key, distribution in spreads(q).items():
        lines += ["", "[[vary]]", f"key = {_text(key)}", f"distribution = {_text(distribution)}"]
    return "\n".join(lines) + "\n"


def drawn_values() -> dict[str, float]:
    """Key of the scene -> what drawn flights have in its place, so that many of them take minutes and not hours."""
    return {"propagation.outputs": DRAWN_ROWS, "propagation.tolerance": DRAWN_TOLERANCE}


def spreads(question: Question) -> dict[str, str]:
    """Key of the scene -> distribution, of what is not known."""
    q, found = question, {}
    if q.drag_area is not None:
        found["device.drag_coefficient"] = f"lognormal({q.drag_coefficient:.12g}, {AIR_SPREAD})"
    if q.tether:
        found["environment.ionosphere.density_factor"] = f"lognormal(1, {PLASMA_SPREAD})"
    if q.weather is None:
        found["environment.solar_flux_sfu"] = f"uniform({QUIET}, {ACTIVE})"
    return found


def _start(q: Question) -> list[str]:
    if q.tle is not None:
        return ['kind = "tle"', f"file = {_text(q.tle.name)}"]
    assert q.altitude is not None
    inclination = sun_synchronous(q.altitude) if q.inclination is None else q.inclination
    lines = ['kind = "circular"', f"mean_altitude_km = {q.altitude / 1e3:.12g}"]
    lines.append(f"inclination_deg = {math.degrees(inclination):.9g}")
    return [*lines, f"ltan_h = {q.local_time:.12g}" if q.inclination is None else "raan_deg = 0"]


def _device(q: Question) -> list[str]:
    lines = ['kind = "plasma-brake"' if q.tether else 'kind = "none"']
    if q.tether:
        lines += [f"tether_length_m = {q.tether:.12g}", f"voltage_V = {q.voltage:.12g}"]
    lines.append(f"mass_kg = {q.mass:.12g}")
    if q.drag_area is not None:
        lines += [f"drag_area_m2 = {q.drag_area:.12g}", f"drag_coefficient = {q.drag_coefficient:.12g}"]
    return lines


def _around(q: Question) -> list[str]:
    lines = ["[environment]"] + ['solar_flux = "cycle"'] * (q.weather is None)
    lines += ["j2 = true", "corotation = true", 'height_above = "ellipsoid"']
    if q.drag_area is not None:
        lines.append(
            'atmosphere = { kind = "nrlmsis-2.1" }' if q.weather else 'atmosphere = { kind = "nrlmsis-2.1", ap = 7 }'
        )
    if q.tether:
        lines.append('ionosphere = { kind = "iri-2020", above_table = "hold" }')
    if q.weather is not None:
        lines += [
            "",
            "[environment.space_weather]",
            f"file = {_text(q.weather.name)}",
            'continuation = "cycle"',
        ]
    return lines


def _text(words: str) -> str:
    return json.dumps(words, ensure_ascii=False)
