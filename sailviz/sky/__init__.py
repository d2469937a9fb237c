"""Where the Sun, the Moon and the planets stand, how heavy and how large they are, and the frames they are told in."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.sky.bodies import BODIES as BODIES
    from sailviz.sky.places import Sky as Sky
    from sailviz.sky.tables import Table as Table
    from sailviz.sky.tables import table as table

_HOMES = {
    "BODIES": "bodies",
    "Sky": "places",
    "Table": "tables",
    "table": "tables",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
