"""What fits its own table of a scene file but not the others: a record of facts per kind, and the questions asked."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.scene.conflicts.hybrids import beside_conflicts as beside_conflicts
    from sailviz.scene.conflicts.questions import conflicts as conflicts

_HOMES = {
    "beside_conflicts": "hybrids",
    "conflicts": "questions",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
