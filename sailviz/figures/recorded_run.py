"""A recording as the Run that it was made of, as far as its columns tell."""

from __future__ import annotations

import numpy as np

from sailviz.elements import Elements
from sailviz.errors import RecordingError
from sailviz.recording.reader import Recording
from sailviz.run.arrays import Attitude, Body, Craft, Event, Run, Setting, Thrust


def run_of(recording: Recording) -> Run:
    """The rows of a recording. What a picture alone needs (references, ensembles, other bodies) is left out.
    RecordingError for a recording that was not made by sailviz."""
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
        attitude=Attitude(*(attitude[name] for name in ("pitch_rad", "cone_rad", "clock_rad", "normal", "quaternion"))),
        thrust=Thrust(
            *(thrust[name] for name in ("acceleration_m_s2", "acceleration_rtn_m_s2", "magnitude_m_s2", "on"))
        ),
        elements=Elements(*(elements[name] for name in angles)),
        environment={} if acted is None else {name: acted[name] for name in acted},
        bodies={},
        events=tuple(Event(event.name, event.time, event.state) for event in recording.events),
    )


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
        craft=Craft(str(facts["craft_kind"][0]), ""),
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
    )
