"""The integrator of a plan, begun as its scene asks."""

from __future__ import annotations

from typing import Any

from sailviz.propagate import collocation, dop853, gauss_jackson
from sailviz.propagate.choice import COLLOCATION, DOP853, GAUSS_JACKSON, TURNING
from sailviz.propagate.gauss_jackson_steps import refinement_for
from sailviz.propagate.stepping import IN_USE
from sailviz.simulation.plan import Plan


class _Integrators(dict[str, Any]):
    """By their words; that of crafts that turn is imported when one flies."""

    def __missing__(self, word: str) -> Any:
        if word != TURNING:
            raise KeyError(word)
        from sailviz.propagate import body_steps

        self[word] = body_steps
        return body_steps


INTEGRATORS = _Integrators({COLLOCATION: collocation, DOP853: dop853, GAUSS_JACKSON: gauss_jackson})


def begun(p: Plan, finer: float = 1.0) -> Any:
    """An integration at the start of a plan. finer : shortens steps that are equal, beyond what the tolerance asks."""
    given = (p.begin, p.position, p.velocity, p.seventh, len(p.names))
    if p.choice.integrator == GAUSS_JACKSON:
        state: Any = gauss_jackson.start(*given, refinement=finer * refinement_for(p.scene.propagation.tolerance))
    elif p.turning is not None:
        state = INTEGRATORS[p.choice.integrator].start(*given, motion=p.turning.motion)
        state.counter[INTEGRATORS[p.choice.integrator].TUMBLED] = int(p.turning.tumbled)
    else:
        state = INTEGRATORS[p.choice.integrator].start(*given)
    state.counter[IN_USE] = int(p.in_use)
    return state
