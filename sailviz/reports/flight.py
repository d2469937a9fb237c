"""The report of one flight, from its recording and, where it can be had, its scene."""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from sailviz.checks.expectations import Judge, Verdict
from sailviz.constants import RADIUS_EARTH, YEAR
from sailviz.deorbits.companions import Companion, companions_of
from sailviz.deorbits.disposal import LOW_ORBIT, NOT_COVERED, RULES, Descent, descent_of, rule_rows
from sailviz.errors import RecordingError, SceneError
from sailviz.recording import Recording, info, read
from sailviz.recording import digest as contents_digest
from sailviz.recording.recorded_run import run_of
from sailviz.reports.page import Page, Section, Table
from sailviz.reports.pictures import pictures_of
from sailviz.reports.spread import spreads, uncertainty
from sailviz.run.arrays import Run
from sailviz.scene import Scene, load_scene
from sailviz.scene.show import resolved_lines
from sailviz.simulation.identity import identity_of
from sailviz.simulation.parameters_in_words import parameters_in_words
from sailviz.version import __version__
from sailviz.words import duration, length

ASSUMED = (
    "The drag area and its coefficient, where they are given as numbers, are means over how the craft tumbles and hold "
    "for the whole flight. Densities are those of the models named here, whose own error is about 15 % (one sigma) for "
    "the air; the Sun's activity changes a lifetime from 600 km by a factor of two to three.",
)
PUSHES = ((1e-3, "mm/s²"), (1e-6, "µm/s²"), (1e-9, "nm/s²"))
ROUNDING = 1e-12  # below which an eccentricity or an angle in degrees is nothing


def flight_page(
    path: Path, scene: Scene | None = None, *, pictures: bool = True, others: bool = True, again: str = ""
) -> Page:
    """The page of a recording.

    scene : that was flown; without it the recording's own text is taken, if it is whole. pictures : whether they are
    taken; others : whether flights without the device and under other Suns stand beside a descent; again : the command
    that flies it. RecordingError for what is no flight of sailviz.
    """
    recording = read(path)
    if recording.flights:
        raise RecordingError(f"{path} holds several flights: a report is of one, from its own recording")
    run, facts = run_of(recording), info(recording)
    scene = scene_of(recording) if scene is None else scene
    verdicts = _judged(scene, run)
    descent = _descent(facts["family"], facts["ended"], run)
    seen, no_picture = pictures_of(path) if pictures else ((), "")
    sections = [
        _what_came(facts, run, verdicts),
        *(_disposal(scene, run, descent, others) if descent else ()),
        *([Section("Pictures", (no_picture,) * bool(no_picture), pictures=seen)] if seen or no_picture else []),
        *uncertainty(recording),
        _motion(run),
        *_inputs(recording, scene, path, again),
    ]
    answer = (*_answer(facts, run, descent, verdicts), *spreads(recording))
    made = f"sailviz {__version__}; every number is read from the recording named under Inputs."
    return Page(facts["title"] or path.name, answer, tuple(sections), made)


def scene_of(recording: Recording) -> Scene | None:
    """The scene of a recording from its text; None where that is not what was flown, or cannot be read here."""
    try:
        scene = load_scene(tomllib.loads(recording.scene_text))
    except (tomllib.TOMLDecodeError, SceneError):
        return None
    return scene if identity_of(scene) == recording.identity else None


def _judged(scene: Scene | None, run: Run) -> list[Verdict]:
    """What the scene expects, measured on the rows; what is asked of ensembles is no matter of the rows."""
    if scene is None:
        return []
    judge = Judge(scene.model_copy(update={"expect": [item for item in scene.expect if item.ensemble is None]}))
    judge.add(run)
    return judge.verdicts()


def _descent(family: str, ended: str, run: Run) -> Descent | None:
    """How a flight in low orbit ended; None for every other."""
    if family != "deorbit" or run.setting.body.name.lower() != "earth":
        return None
    if np.linalg.norm(run.position[0]) > RADIUS_EARTH + LOW_ORBIT:
        return None
    found = descent_of(run)
    return Descent(found.time, found.down, found.altitude, ended)


def _answer(facts: dict[str, Any], run: Run, descent: Descent | None, verdicts: list[Verdict]) -> Iterator[str]:
    """What the report is read for, in two or three sentences."""
    span = float(run.time[-1] - run.time[0])
    if not facts["complete"]:
        yield f"This recording is not whole: it stops after {duration(span)}, and nothing is said of what comes later."
    if descent is not None:
        yield descent.words
        for name, verdict, source in rule_rows(descent):
            if not verdict.startswith("open"):
                yield f"Limit of {name} after the start of this flight: {verdict} ({source})."
        if not descent.down and descent.time < RULES[0][1]:
            yield "Nothing follows from that for the limits of 5 and 25 years: it was not flown so long."
    else:
        yield f"Flown: {duration(span)}" + (f", ended by {facts['ended']}." if facts["ended"] else ".")
    if verdicts:
        met = sum(verdict.passed for verdict in verdicts)
        yield f"{met} of {len(verdicts)} expectations of the scene are met."


def _what_came(facts: dict[str, Any], run: Run, verdicts: list[Verdict]) -> Section:
    tables = []
    if verdicts:
        rows = tuple(
            (
                v.quantity,
                v.at,
                "-" if np.isnan(v.measured) else f"{v.measured:.7g}",
                f"{v.expected:.7g}",
                f"{v.tolerance:.3g}",
                "met" if v.passed else f"missed: {v.miss}",
            )
            for v in verdicts
        )
        head = ("quantity", "at", "measured", "expected", "within", "")
        tables.append(Table(rows, head, "What the scene expects"))
    if facts["events"]:
        events = facts["events"]
        happened = tuple((e["name"], duration(e["time_s"])) for e in events[:40])
        more = f" (the first 40 of {len(events):,})" if len(events) > 40 else ""
        tables.append(Table(happened, ("event", "after"), f"Events{more}"))
    said = () if tables else ("The scene expects nothing and no event happened.",)
    return Section("What came of it", said, tuple(tables))


def _disposal(scene: Scene | None, run: Run, descent: Descent, others: bool) -> Iterator[Section]:
    """Rules, the same craft without its device and under other Suns, the swept product, what is not covered."""
    rules = Table(rule_rows(descent), ("limit", "this flight", "rule"), "Counted from the start of the flight")
    flown: tuple[Companion, ...] = ()
    why = ""
    if scene is None:
        why = "Flights beside this one were not made: the recording's scene cannot be built again here."
    elif others:
        flown, why = companions_of(scene)
    tables = [rules]
    if scene is not None:
        yield Section("Assumptions", ASSUMED, (Table(tuple(_assumed(scene))),))
    if flown:
        rows = [("as recorded", descent.words, *(descent.verdict(limit) for _, limit, _ in RULES))]
        rows += [(c.name, c.words, *(c.verdict(limit) for _, limit, _ in RULES)) for c in flown]
        tables.append(Table(tuple(rows), ("flight", "how it ends", *(name for name, *_ in RULES)), "Beside it"))
    product = _swept(scene, descent) if scene is not None else ""
    sentences = (why, product, *NOT_COVERED)
    yield Section("Disposal", tuple(filter(None, sentences)), tuple(tables))


def _assumed(scene: Scene) -> Iterator[tuple[str, str]]:
    """Craft, orbit, and the models of what surrounds it."""
    for name, value in parameters_in_words(scene, None):
        if not name.startswith("expected"):
            yield name, value
    area, around = scene.device.drag_area, scene.environment
    yield "drag area", f"{area:g} m²" if isinstance(area, float) else "follows the attitude" if area else "none given"
    if area:
        yield "drag coefficient", f"{scene.device.drag_coefficient:g}"
    for name, part in (("air", around.atmosphere), ("plasma", around.ionosphere)):
        yield f"model of the {name}", "none" if part is None else str(part.kind)
    if around.space_weather is not None:
        yield "Sun's activity", "measured and predicted days of a file"
    elif around.solar_flux is not None:
        flux = around.solar_flux
        yield "Sun's activity", f"F10.7 = {flux:g} sfu" if isinstance(flux, (int, float)) else f"{flux}"


def _swept(scene: Scene, descent: Descent) -> str:
    """Cross-section times time, with what it is made of."""
    device = scene.device
    given = device.drag_area
    if isinstance(given, str):
        return "The drag area follows the attitude: the product of area and time is not told."
    area = given or 0.0
    tether = getattr(device, "tether_length", 0.0) * getattr(device, "wire_diameter", 0.0)
    if not area and not tether:
        return "The scene gives no cross-section, so there is no product of area and time."
    of = [f"{area:g} m² of drag area"] * bool(area) + [f"{tether:.3g} m² of tether (length x diameter)"] * bool(tether)
    so_far = "" if descent.down else " so far"
    return (
        f"Cross-section times time{so_far}: {(area + tether) * descent.time / YEAR:.4g} m² yr, of {' and '.join(of)}."
    )


def _motion(run: Run) -> Section:
    """Where the flight begins and ends."""
    e, ends = run.elements, (0, -1)

    def row(name: str, values: tuple[str, ...]) -> tuple[str, ...]:
        return (name, *values)

    rows = (
        row("distance from the centre", tuple(length(float(np.linalg.norm(run.position[i]))) for i in ends)),
        row("speed", tuple(f"{float(np.linalg.norm(run.velocity[i])) / 1e3:.6g} km/s" for i in ends)),
        row("semi-major axis", tuple(length(float(e.semi_major_axis[i])) for i in ends)),
        row("eccentricity", tuple(_plain(float(e.eccentricity[i])) for i in ends)),
        row("inclination", tuple(f"{_plain(np.degrees(float(e.inclination[i])))}°" for i in ends)),
        row("mass", tuple("not given" if np.isnan(run.mass[i]) else f"{float(run.mass[i]):.6g} kg" for i in ends)),
        row("acceleration of the device", _pushes(run)),
    )
    return Section("Motion", tables=(Table(rows, ("", "at the start", "at the end")),))


def _pushes(run: Run) -> tuple[str, str]:
    """What the device does at either end, in one unit."""
    ends = [float(run.thrust.magnitude[i]) for i in (0, -1)]
    size, unit = next(((s, u) for s, u in PUSHES if max(ends) >= s), PUSHES[-1])
    first, last = (f"{push / size:.5g} {unit}" if push > 0 else "none" for push in ends)
    return first, last


def _plain(number: float) -> str:
    """A number of order 1; what is only rounding is 0."""
    return "0" if abs(number) < ROUNDING else f"{number:.6g}"


def _inputs(recording: Recording, scene: Scene | None, path: Path, again: str) -> Iterator[Section]:
    """File, checksums, versions, accuracy; the scene letter by letter; every value as it was understood."""
    whole = hashlib.sha256(path.read_bytes()).hexdigest()
    epoch = info(recording)["epoch"]
    rows = [
        ("recording", f"{path.name}, {path.stat().st_size / 1e6:.3g} MB"),
        ("SHA-256", whole),
        ("digest of what it holds", contents_digest(recording)),
        ("identity of the scene", recording.identity),
        ("epoch", f"{epoch} UTC" if epoch else "none"),
        ("versions", ", ".join(f"{name} {number}" for name, number in recording.versions.items())),
        ("accuracy", recording.accuracy),
    ]
    rows += [("fly it again", again)] * bool(again)
    values: tuple[tuple[str, ...], ...] = ()
    if scene is not None:
        values = tuple(tuple(line.split(" = ", 1)) for line in resolved_lines(scene))
    yield Section("Inputs", tables=(Table(tuple(rows)),))
    if recording.scene_text:
        yield Section("Scene", text=recording.scene_text)
    if values:
        told = Table(values, caption="Every value of the scene, defaults included")
        yield Section("Values as understood", tables=(told,))
