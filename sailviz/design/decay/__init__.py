"""How long a brake or the air takes to bring a satellite down."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.design.decay.quasi_circular import Band as Band
    from sailviz.design.decay.quasi_circular import Compliance as Compliance
    from sailviz.design.decay.quasi_circular import Descent as Descent
    from sailviz.design.decay.quasi_circular import altitude_history as altitude_history
    from sailviz.design.decay.quasi_circular import compliance as compliance
    from sailviz.design.decay.quasi_circular import decay_band as decay_band
    from sailviz.design.decay.quasi_circular import decay_time as decay_time
    from sailviz.design.decay.quasi_circular import descend as descend
    from sailviz.design.decay.quasi_circular import exponential_decay_time as exponential_decay_time

_HOMES = {
    "decay_time": "quasi_circular",
    "exponential_decay_time": "quasi_circular",
    "Descent": "quasi_circular",
    "descend": "quasi_circular",
    "altitude_history": "quasi_circular",
    "Band": "quasi_circular",
    "decay_band": "quasi_circular",
    "Compliance": "quasi_circular",
    "compliance": "quasi_circular",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
