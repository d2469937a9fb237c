"""The arrays that a simulation yields: float64, SI, one row per output time."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.run.arrays import Attitude as Attitude
    from sailviz.run.arrays import Body as Body
    from sailviz.run.arrays import Craft as Craft
    from sailviz.run.arrays import Event as Event
    from sailviz.run.arrays import Reference as Reference
    from sailviz.run.arrays import Run as Run
    from sailviz.run.arrays import Setting as Setting
    from sailviz.run.arrays import Thrust as Thrust
    from sailviz.run.arrays import join as join
    from sailviz.run.from_arrays import TrajectoryError as TrajectoryError
    from sailviz.run.from_arrays import trajectory as trajectory
    from sailviz.run.oem import Ephemeris as Ephemeris
    from sailviz.run.oem import read_oem as read_oem
    from sailviz.run.oem_writer import write_oem as write_oem

_HOMES = {
    "Attitude": "arrays",
    "Body": "arrays",
    "Craft": "arrays",
    "Event": "arrays",
    "Reference": "arrays",
    "Run": "arrays",
    "Setting": "arrays",
    "Thrust": "arrays",
    "join": "arrays",
    "TrajectoryError": "from_arrays",
    "trajectory": "from_arrays",
    "Ephemeris": "oem",
    "read_oem": "oem",
    "write_oem": "oem_writer",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
