"""Scene -> Run: the only room that knows scenes and the propagator."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.simulation.loop import simulate as simulate
    from sailviz.simulation.loop import simulate_blocks as simulate_blocks
    from sailviz.simulation.recorder import record as record

_HOMES = {
    "simulate": "loop",
    "simulate_blocks": "loop",
    "record": "recorder",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
