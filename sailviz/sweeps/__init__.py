"""Many flights of one scene in one table."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.sweeps.json_schema import schema as schema
    from sailviz.sweeps.loop import sweep as sweep
    from sailviz.sweeps.result import Sweep as Sweep
    from sailviz.sweeps.store import SweepError as SweepError

_HOMES = {
    "sweep": "loop",
    "Sweep": "result",
    "SweepError": "store",
    "schema": "json_schema",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
