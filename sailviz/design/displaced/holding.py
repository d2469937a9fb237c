"""From the acceleration that a track needs to the sail that gives it: attitude and characteristic acceleration.

Source: thesis, (3.43)-(3.46) and (4.2)-(4.5), read in excerpt; films by inverting their force shape.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sailviz import frames
from sailviz.constants import AU
from sailviz.design.displaced.force_shape import force_shape
from sailviz.propulsion.solar_sail import Film

Motion = tuple[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike]  # a coordinate, its rate and its second rate

ROUNDING = 1e-12  # relative, by which a cone angle may pass the device's limit


@dataclass(frozen=True)
class Holding:
    """What holds an orbit; scalars or arrays of one shape, NaN where infeasible.

    cone, pitch : rad. clock : rad from h_hat towards t_hat in the orbital frame. characteristic_acceleration : m/s2 at
    1 au, facing the Sun. acceleration : m/s2, the thrust that is needed, feasible or not. feasible : bool.
    reason : "" or, for scalar requests, why not and the nearest that is possible.
    """

    cone: np.ndarray
    pitch: np.ndarray
    clock: np.ndarray
    characteristic_acceleration: np.ndarray
    acceleration: np.ndarray
    feasible: np.ndarray
    reason: str = ""


@dataclass(frozen=True, kw_only=True)
class Track(Holding):
    """What holds a prescribed track around the Sun, point by point; arrays of one shape (...), vectors (..., 3).

    As Holding; besides, clock_meridian : rad from the meridian upwards towards east. time : s since perihelion, or as
    given.
    radius : m. position : m. velocity : m/s. throttle : characteristic_acceleration over its maximum, what the voltage
    (or, on a solar sail, the reflecting area) has to follow.
    """

    clock_meridian: np.ndarray
    time: np.ndarray
    radius: np.ndarray
    position: np.ndarray
    velocity: np.ndarray

    @property
    def throttle(self) -> np.ndarray:
        return self.characteristic_acceleration / np.nanmax(self.characteristic_acceleration)


def attitude(
    radius: np.ndarray, outward: np.ndarray, sideways: np.ndarray, device: Film | str, cone_limit: float | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """(cone, pitch, characteristic acceleration, feasible) for accelerations in m/s2 along r_hat and across it (>= 0).

    radius : m. cone_limit : rad, instead of the device's own. Arrays of one shape. No thrust at all is feasible: a_c =
    0.
    """
    shape = force_shape(device)
    limit = shape.cone_limit()
    size = np.hypot(outward, sideways)
    cone = np.where(size > 0, np.arctan2(sideways, outward), 0.0)
    allowed = limit if cone_limit is None else min(limit, cone_limit)
    with np.errstate(invalid="ignore"):
        feasible = (radius > 0) & (cone <= allowed * (1 + ROUNDING)) & ((outward > 0) | (size == 0))
    pitch = np.where(feasible, shape.pitch(np.where(feasible, np.minimum(cone, limit), 0.0)), np.nan)
    k_r, k_t = shape.components(pitch)
    with np.errstate(divide="ignore", invalid="ignore"):
        ac = np.where(feasible, size / np.hypot(k_r, k_t) * (radius / AU) ** shape.exponent, np.nan)
    return np.where(feasible, cone, np.nan), pitch, ac, feasible


def hold_track(
    time: npt.ArrayLike,
    r: Motion,
    psi: Motion,
    theta: Motion,
    mu: npt.ArrayLike,
    device: Film | str,
    reason: Callable[[], str] | None = None,
) -> Track:
    """The Track of a craft whose Sun distance r in m, elevation psi and azimuth theta in rad are each given as (value,
    rate, second rate) over time in s; all broadcast. reason : a function that explains a scalar refusal.

    a_r = r'' - r psi'^2 - r theta'^2 cos^2(psi) + mu / r^2, a_north = r psi'' + 2 r' psi' + r theta'^2 sin(psi)
    cos(psi), a_east = (1 / (r cos(psi))) d(r^2 cos^2(psi) theta') / dt: spherical kinematics.
    """
    given = (np.asarray(x, dtype=float) for x in (time, *r, *psi, *theta))
    when, distance, r_d, r_dd, elevation, psi_d, psi_dd, azimuth, theta_d, theta_dd = np.broadcast_arrays(*given)
    c, s = np.cos(elevation), np.sin(elevation)
    outward = r_dd - distance * psi_d**2 - distance * theta_d**2 * c * c + np.divide(mu, distance**2)
    north = distance * psi_dd + 2 * r_d * psi_d + distance * theta_d**2 * s * c
    east = 2 * r_d * c * theta_d - 2 * distance * psi_d * s * theta_d + distance * c * theta_dd
    cone, pitch, ac, feasible = attitude(distance, outward, np.hypot(north, east), device)
    ct, st = np.cos(azimuth), np.sin(azimuth)
    r_hat = np.stack([c * ct, c * st, s], axis=-1)
    n_hat = np.stack([-s * ct, -s * st, c], axis=-1)
    e_hat = np.stack([-st, ct, np.zeros_like(st)], axis=-1)
    position = distance[..., None] * r_hat
    velocity = (
        r_d[..., None] * r_hat + (distance * psi_d)[..., None] * n_hat + (distance * c * theta_d)[..., None] * e_hat
    )
    across = north[..., None] * n_hat + east[..., None] * e_hat
    rtn = frames.to_frame(frames.rtn(position, velocity), across)
    sun_facing = np.hypot(north, east) <= ROUNDING * np.abs(outward)  # then the clock angle is rounding noise
    clock, meridian = (np.where(sun_facing, 0.0, np.arctan2(*x)) for x in ((rtn[..., 1], rtn[..., 2]), (east, north)))
    clock, meridian = np.where(feasible, clock, np.nan), np.where(feasible, meridian, np.nan)
    why = reason() if reason is not None and distance.ndim == 0 and not feasible else ""
    size = np.sqrt(outward**2 + north**2 + east**2)
    return Track(
        cone[()],
        pitch[()],
        clock[()],
        ac[()],
        size[()],
        feasible[()],
        why,
        clock_meridian=meridian[()],
        time=when[()],
        radius=distance[()],
        position=position,
        velocity=velocity,
    )
