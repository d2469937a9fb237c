"""The verbs for a shell, one file per command under its own name; click is known here only."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.cli.entry import main as main

_HOMES = {
    "main": "entry",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
