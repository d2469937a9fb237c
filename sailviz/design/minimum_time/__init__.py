"""Minimum-time flights by the indirect method."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.design.minimum_time.circles import circle_to_circle as circle_to_circle
    from sailviz.design.minimum_time.circles import planar_orbit_to_orbit as planar_orbit_to_orbit
    from sailviz.design.minimum_time.orbits import OrbitTransfer as OrbitTransfer
    from sailviz.design.minimum_time.orbits import orbit_to_orbit as orbit_to_orbit
    from sailviz.design.minimum_time.planar_transfer import Transfer as Transfer
    from sailviz.design.minimum_time.planar_transfer import sail_from as sail_from
    from sailviz.design.minimum_time.planet_rendezvous import Rendezvous as Rendezvous
    from sailviz.design.minimum_time.planet_rendezvous import rendezvous as rendezvous
    from sailviz.design.minimum_time.to_ends import Keeping as Keeping
    from sailviz.design.minimum_time.to_ends import circle_to_end as circle_to_end

_HOMES = {
    "Transfer": "planar_transfer",
    "circle_to_circle": "circles",
    "planar_orbit_to_orbit": "circles",
    "sail_from": "planar_transfer",
    "OrbitTransfer": "orbits",
    "circle_to_end": "to_ends",
    "Keeping": "to_ends",
    "orbit_to_orbit": "orbits",
    "Rendezvous": "planet_rendezvous",
    "rendezvous": "planet_rendezvous",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
