"""A run at other times than those of its rows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sailviz.elements import Elements
from sailviz.run import resample
from sailviz.run.arrays import Attitude, Run, Thrust


def run_at(run: Run, times: np.ndarray) -> Run:
    """A run at times (m,) s: positions by cubic Hermite interpolation, the other columns as `resample.at` has them; NaN
    outside of its rows and in its gaps, where what is on or off stays as it was. Events and other answers are left out.
    """
    within = (times >= run.time[0]) & (times <= run.time[-1])
    inside = np.clip(times, run.time[0], run.time[-1])

    def column(name: str, values: np.ndarray, **siblings: np.ndarray) -> np.ndarray:
        found = resample.at(inside, name, run.time, values, siblings, run.setting.gaps)
        if found.dtype.kind == "f":
            found = np.where(within.reshape((-1,) + (1,) * (found.ndim - 1)), found, np.nan)
        return found

    def thrust_at(thrust: Thrust) -> Thrust:
        return Thrust(
            column("acceleration_m_s2", thrust.acceleration),
            column("acceleration_rtn_m_s2", thrust.acceleration_rtn),
            column("magnitude_m_s2", thrust.magnitude),
            column("on", thrust.on),
        )

    attitude, e = run.attitude, run.elements
    return replace(
        run,
        time=times,
        position=column("position_m", run.position, velocity_m_s=run.velocity),
        velocity=column("velocity_m_s", run.velocity),
        mass=column("mass_kg", run.mass),
        attitude=Attitude(
            column("pitch_rad", attitude.pitch),
            column("cone_rad", attitude.cone),
            column("clock_rad", attitude.clock),
            column("normal", attitude.normal),
            column("quaternion", attitude.quaternion),
            {name: column(name, values) for name, values in attitude.motion.items()},
        ),
        thrust=thrust_at(run.thrust),
        devices={name: thrust_at(device) for name, device in run.devices.items()},
        elements=Elements(
            column("semi_major_axis_m", e.semi_major_axis),
            column("eccentricity", e.eccentricity),
            column("inclination_rad", e.inclination),
            column("raan_rad", e.raan),
            column("argument_rad", e.argument),
            column("true_anomaly_rad", e.true_anomaly),
        ),
        environment={name: column(name, values) for name, values in run.environment.items()},
        film={name: column(name, values) for name, values in run.film.items()},
        bodies={name: column("velocity_m_s", place) for name, place in run.bodies.items()},  # smooth as velocities are
        approximations={},
        events=(),
    )
