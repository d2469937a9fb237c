"""Values that flights draw for keys of a scene: each known from a seed, the key and the flight's number alone."""

from __future__ import annotations

import hashlib
from collections.abc import Callable

import numpy as np

from sailviz.scene.draws import Draw

DRAWS: dict[str, Callable[..., float]] = {  # from a generator and the parameters of `scene.draws`
    "normal": lambda rng, mean, deviation: rng.normal(mean, deviation),
    "uniform": lambda rng, low, high: rng.uniform(low, high),
    "lognormal": lambda rng, median, sigma: median * np.exp(sigma * rng.standard_normal()),
    "gamma": lambda rng, shape, scale: rng.gamma(shape, scale),
}


def value_of(item: Draw, seed: int, cell: int, draw: int) -> float:
    """The value of one flight: known from the seed of all, the key, the place on a grid and the draw's number alone, so
    that neither workers nor order nor the other keys change it."""
    if item.distribution == "seed":
        return flight_seed(seed, cell, draw)
    own = int.from_bytes(hashlib.sha256(item.key.encode()).digest()[:8], "little")
    rng = np.random.default_rng([seed, own, cell, draw])
    return float(DRAWS[item.distribution](rng, *item.parameters))


def flight_seed(seed: int, cell: int, draw: int) -> int:
    """A flight's own seed, below 2^32."""
    return int(np.random.SeedSequence([seed, cell, draw]).generate_state(1)[0])
