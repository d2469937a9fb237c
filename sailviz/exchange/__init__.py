"""Files in which others write where a craft or a small body was, read in plain Python: `check` looks at them too.

Kernels of SPICE (daf.py, spk.py, ck.py, spice.py) are arrays and want numpy; so do orbit ephemeris messages, which
stand in run/oem.py.
"""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.exchange.aem import AttitudeRows as AttitudeRows
    from sailviz.exchange.aem import read_aem as read_aem
    from sailviz.exchange.aem import write_aem as write_aem
    from sailviz.exchange.apm import read_apm as read_apm
    from sailviz.exchange.apm import write_apm as write_apm
    from sailviz.exchange.earth_frames import to_gcrf as to_gcrf
    from sailviz.exchange.element_sets import ElementSet as ElementSet
    from sailviz.exchange.element_sets import read_element_sets as read_element_sets
    from sailviz.exchange.omm import write_omm as write_omm
    from sailviz.exchange.opm import OrbitParameters as OrbitParameters
    from sailviz.exchange.opm import read_opm as read_opm
    from sailviz.exchange.opm import write_opm as write_opm
    from sailviz.exchange.small_bodies import SmallBody as SmallBody
    from sailviz.exchange.small_bodies import read_small_body as read_small_body

_HOMES = {
    "AttitudeRows": "aem",
    "read_aem": "aem",
    "write_aem": "aem",
    "read_apm": "apm",
    "write_apm": "apm",
    "to_gcrf": "earth_frames",
    "write_omm": "omm",
    "OrbitParameters": "opm",
    "read_opm": "opm",
    "write_opm": "opm",
    "ElementSet": "element_sets",
    "read_element_sets": "element_sets",
    "SmallBody": "small_bodies",
    "read_small_body": "small_bodies",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
