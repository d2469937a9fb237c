"""A recording as the Run that it was made of, as far as its columns tell, and for a picture its drawing too."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from sailviz.elements import Elements
from sailviz.errors import RecordingError
from sailviz.frames import unit
from sailviz.recording.contract import thrust_path
from sailviz.recording.drawing import style
from sailviz.recording.drawing.landmarks import LARGER
from sailviz.recording.drawing.samples import unit_of
from sailviz.recording.reader import Recording
from sailviz.run import resample
from sailviz.run.arrays import Attitude, Body, Craft, Event, Phase, Reference, Run, Setting, Thrust

LABELS = {
    "solar-sail": "Solar sail",
    "electric-sail": "E-sail",
    "plasma-brake": "Plasma brake",
    "thruster": "Thruster",
    "none": "Spacecraft",
}
BODY, ORBIT = re.compile("/world/planets/([^/]+)/body"), re.compile("/world/planets/([^/]+)/orbit")
LINE = re.compile("/world/references/([^/]+)")
MOTION = ("rate_rad_s", "angular_momentum_N_m_s", "wheels_N_m_s")  # of a craft whose attitude moves by itself
REACHED = "reached"  # a line that the drawing itself has added


def run_of(recording: Recording) -> Run:
    """The rows of a recording; of several flights those of the first. What a picture alone needs (references,
    ensembles, other bodies) is left out. RecordingError for a recording that was not made by sailviz."""
    if not recording.contract or "/state" not in recording:
        raise RecordingError(f"{recording.label} was not recorded by sailviz: it has no rows of a flight")
    state, attitude, thrust, elements = (recording[name] for name in ("/state", "/attitude", "/thrust", "/elements"))
    angles = ("semi_major_axis_m", "eccentricity", "inclination_rad", "raan_rad", "argument_rad", "true_anomaly_rad")
    acted = recording.get("/environment")
    return Run(
        setting=setting_of(recording, state["time_s"]),
        first=0,
        time=state["time_s"],
        position=state["position_m"],
        velocity=state["velocity_m_s"],
        mass=state["mass_kg"],
        attitude=Attitude(
            attitude["pitch_rad"],
            attitude["cone_rad"],
            attitude["clock_rad"],
            attitude["normal"],
            attitude["quaternion"],
            motion={name: attitude[name] for name in MOTION if name in attitude},
        ),
        thrust=thrust_from(thrust),
        elements=Elements(*(elements[name] for name in angles)),
        environment={} if acted is None else {name: acted[name] for name in acted},
        bodies={},
        devices=devices_of(recording),
        film=dict(recording["/film"]) if "/film" in recording else {},
        events=tuple(Event(event.name, event.time, event.state) for event in recording.events),
    )


def thrust_from(table: Mapping[str, np.ndarray]) -> Thrust:
    """What pushed, by the columns of an entity."""
    return Thrust(*(table[name] for name in ("acceleration_m_s2", "acceleration_rtn_m_s2", "magnitude_m_s2", "on")))


def devices_of(recording: Recording) -> dict[str, Thrust]:
    """Name -> what each device of a list did, in the list's order."""
    told = recording.resolved.get("device")
    names = [str(device.get("name")) for device in told] if isinstance(told, list) else []
    return {name: thrust_from(recording[thrust_path(name)]) for name in names if thrust_path(name) in recording}


def setting_of(recording: Recording, time: np.ndarray) -> Setting:
    """What /scene says of a recording; time (n,) s."""
    facts = recording["/scene"]
    body = Body(str(facts["body"][0]), float(facts["body_mu_m3_s2"][0]), float(facts["body_radius_m"][0]))
    start = recording["/state"]
    try:
        epoch = start.timeline("utc")[0] - start.timeline("sim_time")[0]
    except KeyError:
        epoch = None
    return Setting(
        title=recording.title,
        family=str(facts["family"][0]),
        about="",
        look_for=(),
        thesis="",
        body=body,
        craft=craft_of(facts, recording.resolved),
        duration=float(time[-1] - time[0]),
        rows=len(time),
        epoch=epoch,
        references=(),
        parameters=(),
        text=recording.scene_text,
        resolved=recording.resolved,
        versions=recording.versions,
        accuracy=recording.accuracy,
        identity=recording.identity,
        gaps=tuple((float(start), float(end)) for start, end in recording.gaps),
        phases=phases_of(facts),
    )


def phases_of(facts: Mapping[str, np.ndarray]) -> tuple[Phase, ...]:
    """The phases of a flight, by /scene."""
    names = np.ravel(facts.get("phases", []))
    spans = np.array(facts.get("phases_s", []), float).reshape(-1, 2).tolist()
    words = np.ravel(facts.get("phases_words", []))
    return tuple(Phase(str(n), start, end, str(w)) for n, (start, end), w in zip(names, spans, words, strict=True))


def craft_of(facts: Mapping[str, np.ndarray], resolved: Mapping[str, Any]) -> Craft:
    """What flew, by /scene and the values of the scene that was flown."""
    kind = str(facts["craft_kind"][0])
    sizes = {name: facts.get(f"craft_{name}") for name in ("side_m", "tethers", "tether_length_m")}
    side, tethers, length = (None if size is None else float(size[0]) for size in sizes.values())
    shape = str(facts["craft_shape"][0]) if "craft_shape" in facts else ""
    count = None if tethers is None else int(tethers)
    device = resolved.get("device")
    wheel = (device.get("wheel") if isinstance(device, Mapping) else None) or {}
    cone, rise = float(wheel.get("cone") or 0.0), float(wheel.get("rise") or 0.0)
    return Craft(kind, LABELS.get(kind, "Spacecraft"), side, count, length, shape=shape, cone=cone, rise=rise)


def drawn_run_of(recording: Recording) -> Run:
    """The rows of a recording with what its picture shows beside them: planets and where they are, the Sun seen from
    a planet, orbits that are there from the start; as exact as they are drawn, 1e-7 of their distance at its rows.
    RecordingError for what is no single flight."""
    run = run_of(recording)
    if recording.flights:
        raise RecordingError(
            f"{recording.label} holds {len(recording.flights)} flights already: only recordings of one are put together"
        )
    if any(name.startswith(("/ensemble/", "/attitude_ensemble/")) for name in recording.entities):
        raise RecordingError(f"{recording.label} holds an ensemble of flights: only single flights are compared")
    length, _ = unit_of(run.setting, float(np.linalg.norm(run.position[0])))
    return replace(
        run,
        setting=replace(run.setting, references=references_of(recording, length)),
        bodies={} if run.setting.epoch is None else bodies_of(recording, run.time, length),
    )


def references_of(recording: Recording, length: float) -> tuple[Reference, ...]:
    """Lines that the picture shows from the start, m. length : m, of the view's 1."""
    found = []
    for name in recording.entities:
        ring, line = ORBIT.fullmatch(name), LINE.fullmatch(name)
        if ring:
            found.append(Reference(ring[1], "planet", length * strip_of(recording, name)))
        elif line and line[1] != REACHED:
            color = int(np.ravel(recording[name]["colors"])[0])
            role = "target" if color == style.rgba(style.TARGET) else "initial"
            role = "approximation" if color == style.rgba(style.dim(style.APPROXIMATION)) else role
            larger = LARGER if role == "target" else 1.0
            points = length / larger * strip_of(recording, name)
            found.append(Reference(words_of(line[1]), role, points))
            planet = found[-1].name.removeprefix("orbit of ")
            body = f"/world/planets/{planet}/body"
            if role == "target" and body in recording:  # a planet without a date, whose own ring is then not drawn
                far = length * float(np.linalg.norm(recording[body]["positions"][0]))
                found.append(Reference(planet, "planet", points * far / np.linalg.norm(points, axis=1).mean()))
    return tuple({(each.name, each.role): each for each in found}.values())


def words_of(name: str) -> str:
    """The name of a line by its entity's: orbit_of_mars -> orbit of Mars."""
    words = name.replace("_", " ").split()
    return " ".join(word.capitalize() if word.capitalize() in style.PLANETS else word for word in words)


def strip_of(recording: Recording, name: str) -> np.ndarray:
    """(k, 3) the points of a line that stays."""
    return np.asarray(np.stack([np.stack(list(strip)) for strip in recording[name]["strips"]])[0], float)


def bodies_of(recording: Recording, time: np.ndarray, length: float) -> dict[str, np.ndarray]:
    """Places (n, 3) m at times (n,) s of planets that the picture shows; of the Sun seen from a planet a direction."""
    found = {}
    for name in recording.entities:
        body = BODY.fullmatch(name)
        if body:
            place = length * np.stack(list(recording[name]["positions"])).reshape(-1, 3).astype(float)
            found[body[1]] = between(recording, name, time, place)
    if "/world/night" in recording:
        x, y, z, w = np.asarray(recording["/world/night"]["quaternion"], float).reshape(-1, 4).T
        axis = np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], 1)  # away from the Sun
        found["Sun"] = unit(between(recording, "/world/night", time, -axis))
    return found


def between(recording: Recording, name: str, time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values (m, 3) in the drawn rows of an entity at times (n,) s, by the cubic through the rows about each."""
    drawn = recording[name].timeline("sim_time").astype(np.int64) / 1e9
    inside = np.clip(time, drawn[0], drawn[-1])
    return np.asarray(resample.at(inside, "velocity_m_s", drawn, values))
