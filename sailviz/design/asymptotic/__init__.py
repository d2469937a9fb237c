"""The first-order analytic solution for small thrust."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.design.asymptotic.solution import CLOCKS as CLOCKS
    from sailviz.design.asymptotic.solution import DOUBTFUL as DOUBTFUL
    from sailviz.design.asymptotic.solution import SCHEMES as SCHEMES
    from sailviz.design.asymptotic.solution import BreakdownError as BreakdownError
    from sailviz.design.asymptotic.solution import Solution as Solution
    from sailviz.design.asymptotic.solution import constant_thrust as constant_thrust
    from sailviz.design.asymptotic.solution import from_elements as from_elements
    from sailviz.design.asymptotic.solution import from_state as from_state
    from sailviz.design.asymptotic.solution import mass_at_constant_acceleration as mass_at_constant_acceleration
    from sailviz.design.asymptotic.solution import propagate as propagate
    from sailviz.design.asymptotic.solution import thrust as thrust
    from sailviz.design.asymptotic.solution import uniform as uniform

_HOMES = {
    "BreakdownError": "solution",
    "CLOCKS": "solution",
    "DOUBTFUL": "solution",
    "SCHEMES": "solution",
    "Solution": "solution",
    "propagate": "solution",
    "from_elements": "solution",
    "from_state": "solution",
    "thrust": "solution",
    "constant_thrust": "solution",
    "mass_at_constant_acceleration": "solution",
    "uniform": "solution",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
