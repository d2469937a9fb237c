"""What a run is held to: expectations, closed forms, baselines, and the pytest fixture."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.checks.baselines import Regression as Regression
    from sailviz.checks.expectations import Verdict as Verdict
    from sailviz.checks.expectations import check as check

_HOMES = {
    "Verdict": "expectations",
    "check": "expectations",
    "Regression": "baselines",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
