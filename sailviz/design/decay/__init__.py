"""How long a brake or the air takes to bring a satellite down."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.design.decay.neutral_drag import crossover_altitude as crossover_altitude
    from sailviz.design.decay.neutral_drag import cycle_descent as cycle_descent
    from sailviz.design.decay.orbit import BRAKE_FLOOR as BRAKE_FLOOR
    from sailviz.design.decay.orbit import corotation_factor as corotation_factor
    from sailviz.design.decay.orbit import mean_radius_offset as mean_radius_offset
    from sailviz.design.decay.profiles import BAND as BAND
    from sailviz.design.decay.profiles import INCLINATIONS as INCLINATIONS
    from sailviz.design.decay.profiles import LEVELS as LEVELS
    from sailviz.design.decay.profiles import Fit as Fit
    from sailviz.design.decay.profiles import ForceProfile as ForceProfile
    from sailviz.design.decay.profiles import Plasma as Plasma
    from sailviz.design.decay.profiles import averaged_profile as averaged_profile
    from sailviz.design.decay.profiles import constant as constant
    from sailviz.design.decay.profiles import exponential as exponential
    from sailviz.design.decay.profiles import fit as fit
    from sailviz.design.decay.profiles import log_quadratic as log_quadratic
    from sailviz.design.decay.profiles import power_law as power_law
    from sailviz.design.decay.profiles import shipped_profile as shipped_profile
    from sailviz.design.decay.profiles import tabulated as tabulated
    from sailviz.design.decay.quasi_circular import REENTRY as REENTRY
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
    "REENTRY": "quasi_circular",
    "decay_time": "quasi_circular",
    "exponential_decay_time": "quasi_circular",
    "Descent": "quasi_circular",
    "descend": "quasi_circular",
    "altitude_history": "quasi_circular",
    "Band": "quasi_circular",
    "decay_band": "quasi_circular",
    "Compliance": "quasi_circular",
    "compliance": "quasi_circular",
    "crossover_altitude": "neutral_drag",
    "cycle_descent": "neutral_drag",
    "BRAKE_FLOOR": "orbit",
    "corotation_factor": "orbit",
    "mean_radius_offset": "orbit",
    "BAND": "profiles",
    "INCLINATIONS": "profiles",
    "LEVELS": "profiles",
    "Fit": "profiles",
    "ForceProfile": "profiles",
    "Plasma": "profiles",
    "averaged_profile": "profiles",
    "constant": "profiles",
    "exponential": "profiles",
    "fit": "profiles",
    "log_quadratic": "profiles",
    "power_law": "profiles",
    "shipped_profile": "profiles",
    "tabulated": "profiles",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
