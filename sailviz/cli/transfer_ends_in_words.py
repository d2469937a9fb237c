"""What is said of flights that end on no orbit, or keep to limits, in words and for scripts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from sailviz.constants import AU, DAY, MU_SUN

if TYPE_CHECKING:
    import numpy as np

    from sailviz.transfers import Solution

Row = tuple[str, str]

ROUNDED = 0.05  # m/s that four decimals of km/s do not show


def name_of_target(found: Solution) -> str:
    """Where to, in words; an escape has no place."""
    if found.target is not None:
        return found.target.name
    return found.end.words if found.end is not None else ""


def heading(found: Solution) -> str:
    """From where to where, and within which within."""
    from sailviz.transfers import FlyBy

    if isinstance(found.end, FlyBy):
        way = f"past {name_of_target(found)}, flown by at any speed"
    else:
        way = f"to {name_of_target(found) if found.end is None else found.end.words}"
    return ", ".join(part for part in (f"{found.origin.name} {way}", found.within.words) if part)


def rows_of_end(found: Solution, position: np.ndarray, velocity: np.ndarray) -> list[Row]:
    """Names and values of a flight's end; position m, velocity m/s (n, 3)."""
    import numpy as np

    from sailviz.design.minimum_time import Transfer
    from sailviz.design.minimum_time.planar_transfer import time_unit
    from sailviz.transfers import Distance, Escape
    from sailviz.transfers.to_ends import speed_at_100_au

    flight = found.flight
    r, v = position[-1], velocity[-1]
    distance, speed = float(np.linalg.norm(r)), float(np.linalg.norm(v))
    along = float(r @ v) / distance
    along = along if abs(along) > ROUNDED else 0.0
    across = math.sqrt(max(speed**2 - along**2, 0.0))
    rows = [
        (
            "at the end",
            f"{distance / AU:.6g} au, {speed / 1e3:.4f} km/s: {along / 1e3:.4f} out, {across / 1e3:.4f} across",
        )
    ]
    left = speed**2 - 2 * MU_SUN / distance
    if left >= 0:
        rows += [("excess speed", f"{math.sqrt(left) / 1e3:.4f} km/s if the sail is then dropped")]
    if isinstance(found.end, (Distance, Escape)) and distance < 100 * AU:
        far = speed_at_100_au(speed, distance, flight.device, flight.characteristic_acceleration)
        if math.isfinite(far):
            rows += [("at 100 au", f"{far / 1e3:.4f} km/s if the sail is kept, facing the Sun: its thrust goes on")]
    if not isinstance(flight, Transfer):  # without costates
        return rows
    unit = time_unit(flight.initial_radius)
    for touch in flight.touches:
        rows += [("touches its limit", f"on day {touch.time * unit / DAY:.4f}, lam_r jumps by {touch.jump:.10g}")]
    if flight.angle_costate:
        rows += [("costate of angle", f"{flight.angle_costate:.10g}")]
    return rows


def values_of_end(found: Solution) -> dict[str, Any]:
    """The same for JSON."""
    from sailviz.design.minimum_time import Transfer
    from sailviz.design.minimum_time.planar_transfer import time_unit

    flight, within = found.flight, found.within
    values: dict[str, Any] = {
        "end": "circle" if found.end is None else type(found.end).__name__.lower(),
        "perihelion_au": None if within.perihelion is None else within.perihelion / AU,
        "hottest_K": within.hottest,
    }
    if not isinstance(flight, Transfer):
        return values
    unit = time_unit(flight.initial_radius)
    return values | {
        "angle_costate": flight.angle_costate,
        "touches": [{"time_d": touch.time * unit / DAY, "jump": touch.jump} for touch in flight.touches],
    }
