"""Displaced orbits and the sails that hold them."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.design.displaced.holding import Holding as Holding
    from sailviz.design.displaced.holding import Track as Track
    from sailviz.design.displaced.linear_stability import Stability as Stability
    from sailviz.design.displaced.linear_stability import largest_stable_elevation as largest_stable_elevation
    from sailviz.design.displaced.linear_stability import smallest_stable_rate as smallest_stable_rate
    from sailviz.design.displaced.linear_stability import stability as stability
    from sailviz.design.displaced.orbits import circular as circular
    from sailviz.design.displaced.orbits import ecliptic as ecliptic
    from sailviz.design.displaced.orbits import heliostationary as heliostationary
    from sailviz.design.displaced.orbits import lagrange_point as lagrange_point
    from sailviz.design.displaced.orbits import largest_rate_ratio as largest_rate_ratio
    from sailviz.design.displaced.orbits import state as state
    from sailviz.design.displaced.orbits import type_ii as type_ii
    from sailviz.design.displaced.tracks import flat_ellipse as flat_ellipse
    from sailviz.design.displaced.tracks import planet_following as planet_following
    from sailviz.design.displaced.tracks import sampled_track as sampled_track
    from sailviz.design.displaced.tracks import track as track

_HOMES = {
    "circular": "orbits",
    "largest_rate_ratio": "orbits",
    "type_ii": "orbits",
    "ecliptic": "orbits",
    "heliostationary": "orbits",
    "lagrange_point": "orbits",
    "state": "orbits",
    "Stability": "linear_stability",
    "stability": "linear_stability",
    "smallest_stable_rate": "linear_stability",
    "largest_stable_elevation": "linear_stability",
    "planet_following": "tracks",
    "flat_ellipse": "tracks",
    "track": "tracks",
    "sampled_track": "tracks",
    "Holding": "holding",
    "Track": "holding",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
