"""Files in which others write where a craft or a small body was, read in plain Python: `check` looks at them too.

Kernels of SPICE (daf.py, spk.py) are arrays and want numpy; so do orbit ephemeris messages, which stand in run/oem.py.
"""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.exchange.element_sets import ElementSet as ElementSet
    from sailviz.exchange.element_sets import read_element_sets as read_element_sets
    from sailviz.exchange.small_bodies import SmallBody as SmallBody
    from sailviz.exchange.small_bodies import read_small_body as read_small_body

_HOMES = {
    "ElementSet": "element_sets",
    "read_element_sets": "element_sets",
    "SmallBody": "small_bodies",
    "read_small_body": "small_bodies",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
