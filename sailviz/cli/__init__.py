"""The verbs for a shell, one file per group of commands; click is known here only."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.cli.main import main as main

_HOMES = {
    "main": "main",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
