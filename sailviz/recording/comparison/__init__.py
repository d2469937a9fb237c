"""How far two recordings are apart."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.recording.comparison.comparer import compare as compare
    from sailviz.recording.comparison.differences import Difference as Difference
    from sailviz.recording.comparison.result import Comparison as Comparison
    from sailviz.recording.comparison.tolerances import Tolerances as Tolerances

_HOMES = {
    "compare": "comparer",
    "Comparison": "result",
    "Difference": "differences",
    "Tolerances": "tolerances",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
