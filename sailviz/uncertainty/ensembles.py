"""What a random wind does to a flight: many flights of one craft, their spread, and what the voltage did about it.

Draws come from streams of the ensemble's own, so an ensemble and single runs under the same law and seed agree in
distribution, not flight by flight.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from sailviz.constants import AU, DAY, MU_SUN, YEAR
from sailviz.environment.solar_wind.laws import Law
from sailviz.environment.solar_wind.pressure import CORRELATION_TIME, KINDS
from sailviz.propagate.ensemble.draws import DRAWN, GIVEN, REPLAYED
from sailviz.propagate.ensemble.flights import LINEAR, ROOT, SEEN, Wind, covariance, fly, percentiles
from sailviz.propagate.ensemble.motion import MERIDIAN, ORBITAL, PLANE
from sailviz.propagate.ensemble.segments import nominal, refined, segments
from sailviz.propulsion import electric_sail, solar_sail, voltage_control
from sailviz.propulsion.electric_sail import MODELS
from sailviz.propulsion.solar_sail import FILMS, Film
from sailviz.steering import attitude

LEVELS = (5.0, 25.0, 50.0, 75.0, 95.0)
_DEVIATES = np.linspace(-8.5, 8.5, 8193)  # a 53-bit number lies within +-8.3; 2e-7 of the pressure between entries
_NORMAL = [2, 5]  # columns of a strength along h
_FRAMES = {"orbital": ORBITAL, "meridian": MERIDIAN}


@dataclass(frozen=True)
class RandomWind:
    """Pressure (or irradiance) drawn from a law of `environment.solar_wind.laws`, or anything with its `from_normal`.

    kind : "constant" over each flight; "redrawn", independent values every interval s; "correlated", p = F^-1(Phi(z))
    with z a stationary Ornstein-Uhlenbeck process, sampled every interval. yearly_deviation : of a slow factor
    exp(N(0, d)) on it, drawn anew every year.
    """

    law: Law
    kind: str = "redrawn"
    interval: float = DAY
    correlation_time: float = CORRELATION_TIME
    yearly_deviation: float = 0.0


@dataclass(frozen=True)
class ReplayedWind:
    """A measured series (n,) in equal steps of `interval` s without gaps; each flight begins at a random place from
    which the series lasts to its end."""

    pressure: np.ndarray
    interval: float


@dataclass(frozen=True)
class GivenWind:
    """Pressures (flights, n), each row the history of one flight in steps of `interval` s; one row serves all flights
    and the last column holds to the end."""

    pressure: np.ndarray
    interval: float


@dataclass(frozen=True)
class Quantity:
    """Statistics of a number that drives the flights, over the flights at the output times; it is the value that holds
    from then on."""

    mean: np.ndarray  # (n,)
    standard_deviation: np.ndarray  # (n,)
    percentiles: np.ndarray  # (levels, n)
    kept: np.ndarray  # (kept, n)


@dataclass(frozen=True)
class Ensemble:
    """Flights under winds of their own. SI and radians.

    States are cylindrical about `axes[2]`: distance rho from the axis m, azimuth rad counted from the start without
    jumps, height m, and the speeds radial (rho'), transverse (rho azimuth') and along the axis, m/s. Flights whose
    thrust never leaves their plane have this plane as height 0, so that rho is the distance from the Sun.
    """

    time: np.ndarray  # (n,) s
    axes: np.ndarray  # (3, 3) rows: inertial directions of azimuth 0, azimuth 90 deg and the axis
    nominal: np.ndarray  # (n, 6) the flight with thrust factor 1
    mean: np.ndarray  # (n, 6)
    covariance: np.ndarray  # (n, 6, 6)
    levels: np.ndarray  # (levels,) per cent
    percentiles: np.ndarray  # (levels, n, 6)
    kept: np.ndarray  # (kept, n, 6) the first flights whole
    end: np.ndarray  # (flights, 6)
    factor: Quantity  # thrust over nominal thrust
    voltage: Quantity  # V; of no meaning for a solar sail
    pressure: Quantity  # Pa; W/m2 for a solar sail
    saturated: np.ndarray  # (n,) share of the flights at the largest voltage
    flight_factor: np.ndarray  # (flights,) mean over time
    flight_voltage: np.ndarray  # (flights,) V, mean over time
    flight_saturated: np.ndarray  # (flights,) share of time at the largest voltage
    reference_pressure: float  # Pa or W/m2, at which the thrust is nominal
    control: np.ndarray  # the row of `sailviz.propulsion.voltage_control` in SI
    seed: int
    error: float  # of integration: largest in position over distance among the first flights, by halving the steps
    resolution: np.ndarray  # (n, 6) how exactly percentiles are known: a bin's width, 0 for exact ones

    @property
    def flights(self) -> int:
        return len(self.end)

    @property
    def standard_deviation(self) -> np.ndarray:
        """(n, 6) of the states."""
        return np.sqrt(np.maximum(np.diagonal(self.covariance, axis1=1, axis2=2), 0.0))

    @property
    def miss(self) -> np.ndarray:
        """(flights, 6) ends of the flights minus the end of the nominal one."""
        return self.end - self.nominal[-1]

    def inertial(self, states: npt.ArrayLike) -> np.ndarray:
        """Position m and velocity m/s (..., 6) in inertial axes from cylindrical states (..., 6)."""
        rho, angle, z, u, v, w = np.moveaxis(np.asarray(states), -1, 0)
        c, s = np.cos(angle), np.sin(angle)
        position = np.stack([rho * c, rho * s, z], axis=-1) @ self.axes
        velocity = np.stack([u * c - v * s, u * s + v * c, w], axis=-1) @ self.axes
        return np.concatenate([position, velocity], axis=-1)


def _axes(position, velocity, planar):
    """Rows of directions: towards the start, across, and the axis; the plane of motion or the inertial x-y plane."""
    if planar:
        axis = np.cross(position, velocity)
        if np.linalg.norm(axis) <= 1e-14 * np.linalg.norm(position) * np.linalg.norm(velocity):  # falls along a line
            axis = np.cross(position, np.cross([0.0, 0.0, 1.0], position))
            if not axis.any():
                axis = np.array([1.0, 0.0, 0.0])
        first = position
    else:
        axis, first = np.array([0.0, 0.0, 1.0]), position * [1.0, 1.0, 0.0]
        if np.linalg.norm(first) < 1e-6 * np.linalg.norm(position):
            raise ValueError("the start lies on the polar axis, where there is no azimuth to count from")
    first, axis = first / np.linalg.norm(first), axis / np.linalg.norm(axis)
    return np.array([first, np.cross(axis, first), axis])


def _strength(device, characteristic_acceleration, model, pitch, clock, throttle):
    """(k, 6) accelerations at 1 au along r, t, h, m/s2: those that go as 1/r, then those that go as 1/r2."""
    normal = np.column_stack(attitude.direction_parameters(pitch, clock))
    position = np.tile([AU, 0.0, 0.0], (len(normal), 1))
    out = np.zeros((len(normal), 6))
    if callable(device):
        out[:, 3:] = device(normal)
    elif device == "electric-sail":
        if model not in MODELS or model == "original":
            raise ValueError(
                f"ensembles fly electric sails whose thrust falls as 1/r: final, updated, polynomial; not {model!r}"
            )
        out[:, :3] = electric_sail.acceleration(position, normal, characteristic_acceleration, model)
    else:
        film = device if isinstance(device, Film) else FILMS.get(device)
        if film is None:
            raise ValueError(f'a device is "electric-sail", a Film or one of {", ".join(FILMS)}, not {device!r}')
        out[:, 3:] = solar_sail.acceleration(position, normal, characteristic_acceleration, film)
    if not np.isfinite(out).all():
        raise ValueError("the pitch leaves the range in which the thrust model holds")
    return out * np.reshape(throttle, (-1, 1))


def _wind(wind, duration, flights, seed, response):
    """(Wind of the kernel, interval between redraws s, interval of the slow factor s)."""
    none = np.zeros(2)
    if isinstance(wind, RandomWind):
        if wind.kind not in KINDS:
            raise ValueError(f"a wind is {', '.join(KINDS)}, not {wind.kind!r}")
        if not (wind.interval > 0 and wind.correlation_time > 0 and wind.yearly_deviation >= 0):
            raise ValueError("interval and correlation time must be positive, the yearly deviation not negative")
        interval = np.inf if wind.kind == "constant" else wind.interval
        memory = np.exp(-wind.interval / wind.correlation_time) if wind.kind == "correlated" else 0.0
        table = np.asarray(wind.law.from_normal(_DEVIATES), dtype=float)
        inverse = 1 / (_DEVIATES[1] - _DEVIATES[0])
        yearly = YEAR if wind.yearly_deviation else np.inf
        spread = float(wind.yearly_deviation)
        made = Wind(DRAWN, seed, float(memory), _DEVIATES[0], inverse, table, spread, np.zeros((1, 1)), response)
        values = table
    elif isinstance(wind, ReplayedWind):
        interval, yearly = wind.interval, np.inf
        values = np.ascontiguousarray(wind.pressure, dtype=float)
        needed = int(np.ceil(duration / interval * (1 - 1e-10)))
        if values.ndim != 1 or len(values) < needed:
            raise ValueError(
                f"the series lasts {values.size * interval / DAY:.6g} d, the flight {duration / DAY:.6g} d: "
                "a replay does not begin again at its end"
            )
        made = Wind(REPLAYED, seed, 0.0, 0.0, 1.0, values, 0.0, np.zeros((1, 1)), response)
    elif isinstance(wind, GivenWind):
        interval, yearly = wind.interval, np.inf
        values = np.ascontiguousarray(np.atleast_2d(np.asarray(wind.pressure, dtype=float)))
        if len(values) not in (1, flights):
            raise ValueError(f"{len(values)} histories were given for {flights} flights")
        made = Wind(GIVEN, seed, 0.0, 0.0, 1.0, none, 0.0, values, response)
    else:
        raise ValueError("a wind is a RandomWind, a ReplayedWind or a GivenWind")
    if not interval > 0:
        raise ValueError(f"the interval of the wind must be positive, not {interval:g} s")
    if not np.isfinite(values).all() or (values < 0).any():
        raise ValueError("pressures must be finite and not negative")
    return made, interval, yearly


def _cores():
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _check(
    position: np.ndarray,
    velocity: np.ndarray,
    duration: float,
    flights: int,
    seed: int,
    frame: str,
    control: np.ndarray,
) -> None:
    if position.shape != (3,) or velocity.shape != (3,):
        raise ValueError("position and velocity are (3,) each")
    if not (duration > 0 and np.isfinite(duration)) or flights < 1:
        raise ValueError(f"{flights} flights of {duration:g} s are none")
    if not 0 <= seed < 2**63:
        raise ValueError(f"a seed is an integer from 0 to 2^63 - 1, not {seed}")
    if frame not in _FRAMES:
        raise ValueError(f"a frame is {' or '.join(_FRAMES)}, not {frame!r}")
    if control[voltage_control.POWER] > 0 or control[voltage_control.KIND] == voltage_control.CONSTANT_POWER:
        raise ValueError("a limit on the gun's power needs the density of the wind, which ensembles do not draw")


def _outputs(outputs: int | npt.ArrayLike, duration: float, unit: float) -> int | np.ndarray:
    """The number of outputs, or their times in a unit of s."""
    if isinstance(outputs, int | np.integer):
        if outputs < 2:
            raise ValueError(f"at least 2 outputs are needed, not {outputs}")
        return int(outputs)
    times = np.asarray(outputs, dtype=float)
    if (np.diff(times) <= 0).any() or times[0] < 0 or times[-1] > duration:
        raise ValueError("output times must rise and lie between 0 and the duration")
    return times / unit


def fly_ensemble(
    position: npt.ArrayLike,
    velocity: npt.ArrayLike,
    duration: float,
    *,
    wind: RandomWind | ReplayedWind | GivenWind,
    control: np.ndarray,
    flights: int = 1000,
    seed: int = 0,
    device: Film | str | Callable[[np.ndarray], np.ndarray] = "electric-sail",
    characteristic_acceleration: float = 1e-3,
    model: str = "final",
    pitch: float = 0.0,
    clock: float = np.pi / 2,
    table: npt.ArrayLike | None = None,
    frame: str = "orbital",
    aim: tuple[float, float] | None = None,
    outputs: int | npt.ArrayLike = 200,
    keep: int = 200,
    levels: Sequence[float] = LEVELS,
    threads: int | None = None,
    mu: float = MU_SUN,
    tolerance: float = 1e-8,
    progress: Callable[[int], None] | None = None,
) -> Ensemble:
    """Fly one craft many times around the Sun, each time through another wind.

    position (3,) m, velocity (3,) m/s at the start; duration s. wind : a RandomWind, ReplayedWind or GivenWind.
    control : a `propulsion.voltage_control.row` with its reference pressure (laws that need the wind's density are
    refused); the distance law leads back to the nominal flight, or to aim : (distance m, radial speed m/s) to hold.
    For a solar sail only the row's reference counts, as the irradiance (W/m2) of nominal thrust, and the wind holds
    irradiances, to which the thrust is proportional. device : "electric-sail", a film, or a function of normals (k, 3)
    along r, t, h that gives the acceleration (k, 3) m/s2 along these at 1 au, which falls as 1/r2.
    characteristic_acceleration m/s2 at 1 au. pitch and clock rad,
    fixed; or table (k, 7) of `sailviz.steering.attitude.table`, its rows held from their times on
    (open loop in time). frame : "orbital" or "meridian", from which the clock counts.
    outputs : times (n,) s, or their number; they then lie where something changes anyway. keep : flights kept whole, at
    most 1024. levels : per cent. seed : an integer from 0 on. threads : None for one per usable core; they do not
    change the result. tolerance : of a position, as a share of the distance from the Sun, see `Ensemble.error`.
    progress : called with the number of flights done.

    Percentiles of up to 1024 flights are exact; of more they come from histograms of 1024 bins over twice the range of
    the first 1024 flights (0.2 % of that range each, `Ensemble.resolution`).
    """
    position, velocity = np.asarray(position, dtype=float), np.asarray(velocity, dtype=float)
    control = np.asarray(control, dtype=float)
    _check(position, velocity, duration, flights, seed, frame, control)
    electric = device == "electric-sail"
    steering = np.array([[0.0, pitch, clock, 1.0]]) if table is None else np.asarray(table, dtype=float)[:, :4]
    strength = _strength(device, characteristic_acceleration, model, *steering.T[1:])
    made, interval, yearly = _wind(wind, duration, flights, seed, ROOT if electric else LINEAR)

    across = np.abs(strength[:, _NORMAL]).max()
    planar = frame == "orbital" and across <= 1e-15 * np.abs(strength).max()
    axes = _axes(position, velocity, planar)
    long, fast = AU, np.sqrt(mu / AU)
    x, v = axes @ position / long, axes @ velocity / fast
    rho = np.hypot(x[0], x[1])
    start = [rho, 0.0, 0.0 if planar else x[2], v[0], v[1], 0.0 if planar else v[2]]
    unit = long / fast

    control = control.copy()
    control[voltage_control.MU] = mu
    own = control.copy()
    own[voltage_control.MU] = 1.0
    fixed = not electric or control[voltage_control.KIND] == voltage_control.CONSTANT
    if not electric:
        own[voltage_control.KIND] = voltage_control.CONSTANT
    plan, times = segments(
        start,
        duration / unit,
        mu=1.0,
        frame=PLANE if planar else _FRAMES[frame],
        steering_times=steering[:, 0] / unit,
        strength=strength * long / fast**2,
        outputs=_outputs(outputs, duration, unit),
        redraw=interval / unit,
        update=np.inf if fixed else control[voltage_control.INTERVAL] / unit,
        new_level=yearly / unit,
    )
    aim = None if aim is None else (aim[0] / long, aim[1] / fast)
    plan, error = refined(plan, made, own, tolerance, aim)
    track = nominal(plan, own)[plan.output >= 0]
    reference = np.zeros((len(times), SEEN))
    reference[:, :6] = track
    reference[:, 6:] = 1.0, control[voltage_control.NOMINAL], control[voltage_control.P_REF]
    found = fly(plan, made, own, reference, flights, threads or _cores(), progress)
    lost = np.flatnonzero(~np.isfinite(found.end).all(axis=1))
    if len(lost):
        raise ValueError(
            f"{len(lost)} flights came so close to the Sun that no step followed them, e.g. flight {lost[0]}"
        )

    shift, cov, deviations = covariance(found.moments, flights)
    mean = reference + shift
    at = percentiles(found, levels)
    kept = found.record[:keep]
    units = np.array([long, 1.0, long, fast, fast, fast])

    def quantity(i):
        column = 6 + i
        return Quantity(mean[:, column], deviations[:, i], at[..., column], kept[..., column].copy())

    return Ensemble(
        time=times * unit,
        axes=axes,
        nominal=track * units,
        mean=mean[:, :6] * units,
        covariance=cov * units[:, None] * units,
        levels=np.asarray(levels, dtype=float),
        percentiles=at[..., :6] * units,
        kept=kept[..., :6] * units,
        end=found.end * units,
        factor=quantity(0),
        voltage=quantity(1),
        pressure=quantity(2),
        saturated=found.moments[:, -1] / flights,
        flight_factor=found.mean[:, 0],
        flight_voltage=found.mean[:, 1],
        flight_saturated=found.mean[:, 2],
        reference_pressure=float(control[voltage_control.P_REF]),
        control=control,
        seed=seed,
        error=error,
        resolution=found.width[:, :6] * units,
    )


def fly_factors(
    factors: npt.ArrayLike,
    interval: float,
    position: npt.ArrayLike,
    velocity: npt.ArrayLike,
    duration: float,
    **options,
) -> np.ndarray:
    """Ends (k, 6) of an electric sail's flights under given thrust factors (k, n) in steps of `interval` s: cylindrical
    states as in `Ensemble`. options : those of `fly_ensemble` but for wind and control."""
    factors = np.atleast_2d(np.asarray(factors, dtype=float))
    row = voltage_control.row(reference_pressure=1.0)
    wind = GivenWind(factors**2, interval)
    options = {"outputs": 2, "keep": 0, **options}
    return fly_ensemble(position, velocity, duration, wind=wind, control=row, flights=len(factors), **options).end
