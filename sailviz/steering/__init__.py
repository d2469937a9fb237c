"""Where a sail points: attitudes, optimal laws and the primers they follow."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.steering.optimal import Pitch as Pitch
    from sailviz.steering.optimal import analytic_pitch as analytic_pitch
    from sailviz.steering.optimal import optimal_pitch as optimal_pitch

_HOMES = {
    "Pitch": "optimal",
    "optimal_pitch": "optimal",
    "analytic_pitch": "optimal",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
