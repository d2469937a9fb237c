"""The judge of GTOC13 solutions: every arc is flown again, every rule looked at, the score counted."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.checks.gtoc13.judgement import Judgement as Judgement
    from sailviz.checks.gtoc13.judgement import judge as judge

_HOMES = {
    "Judgement": "judgement",
    "judge": "judgement",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
