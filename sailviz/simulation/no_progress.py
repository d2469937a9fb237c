"""Why a flight does not get anywhere, in a sentence: what turns to and fro or pulls too hard, and what to change."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sailviz.propagate import dynamics, stepping
from sailviz.propagate.patience import WINDOW, Patience
from sailviz.run.arrays import Body
from sailviz.simulation.environment import drawn_bodies
from sailviz.simulation.lowered import Array
from sailviz.words import duration

if TYPE_CHECKING:
    from sailviz.simulation.plan import Plan

STEPS = 64  # that are looked at
TURNED = np.cos(np.radians(30.0))  # of the normal from one step to the next
OFTEN = 4  # turns or switches among so many steps: a flight has a few in a revolution


def too_slow(p: Plan, state: Any, patience: Patience, integrator: Any) -> str:
    """The reason of a PropagationError: the flight advances so slowly that it would never be over."""
    left = p.scene.propagation.duration - stepping.time(state)
    many = f"{patience.left:.2g}" if np.isfinite(patience.left) else "endlessly many"
    words = f"The flight does not get on: over the last {WINDOW:,} steps one took {patience.step:.2g} s on average"
    words += f", and the {duration(left)} that are left would take {many} of them"
    words += f", more than the {patience.most_steps:,} that limits.integration_steps allows"
    return f"{words}. {_cause(p, state, integrator)}. It stopped"


def too_short(p: Plan, state: Any) -> str:
    """The reason of a PropagationError: no step is short enough."""
    body = _close_body(p, stepping.time(state), stepping.state(state)[:3])
    return "The step size fell below the resolution of time" + (f". {body}. It stopped" if body else "")


def too_many(p: Plan, patience: Patience) -> str:
    """The reason of a PropagationError: the steps are used up."""
    return (
        f"The flight took the {patience.most_steps:,} steps that limits.integration_steps allows: raise it, loosen "
        "propagation.tolerance or largest_step, or shorten the flight. It stopped"
    )


def _cause(p: Plan, state: Any, integrator: Any) -> str:
    """What is to blame, and what to change."""
    times, states = _next_steps(p, state, integrator)
    body = _close_body(p, times[-1], states[:3, -1])
    if body:
        return body
    interval = np.searchsorted(p.schedule.breaks, times, side="right") - 1
    normal, _, throttle = dynamics.observe(times, states, p.schedule.factors[interval], p.model)
    turned = int(np.count_nonzero(np.sum(normal[1:] * normal[:-1], axis=1) < TURNED))
    switched = int(np.count_nonzero((throttle[1:] > 0) != (throttle[:-1] > 0)))
    own = p.model.parameters["callbacks"]
    law = "Your own steering" if own["user_steering"][0] else f"The {_kind(p)} steering"
    if max(turned, switched) >= OFTEN:
        did = f"turned the sail {turned} times" if turned >= switched else f"switched the thrust {switched} times"
        return (
            f"{law} chatters: it {did} in {STEPS} steps. Let it hold its attitude (a table with "
            'interpolation = "hold"), stop the run by an event before it arrives, or aim at another orbit'
        )
    if own["user_force"][0]:
        return "Your own force jumps, or changes too fast to be followed: make it smooth, or bound it"
    r = float(np.linalg.norm(states[:3, -1]))
    return (
        f"At {r:.4g} m from the centre a force changes too fast to be followed ({_what_acts(p)}): "
        "stop the run by an event before, or loosen propagation.tolerance"
    )


def _next_steps(p: Plan, state: Any, integrator: Any) -> tuple[Array, Array]:
    """Times (k,) s and states (7, k) of the steps that would come next."""
    run = p.scene.propagation
    times, states = [stepping.time(state)], [stepping.state(state)]
    end, out = np.array([run.duration]), np.empty((7, 1))
    one_step = Patience(until=0.0)
    state.counter[stepping.STATUS] = stepping.DONE  # the rows are others now
    for _ in range(STEPS):
        one_step.next_piece(1)
        status = integrator.advance(
            state, p.model, p.schedule.breaks, p.schedule.factors, p.watch, end, out, p.limit, run.tolerance,
            run.largest_step or np.inf, one_step,
        )  # fmt: skip
        stepping.drain_events(state)
        times.append(stepping.time(state))
        states.append(stepping.state(state))
        if status != stepping.TIME_IS_UP:
            break
    return np.array(times), np.ascontiguousarray(np.array(states).T)


def _close_body(p: Plan, time: float, position: Array) -> str:
    """A sentence where a third body pulls harder than the central one; "" otherwise."""
    pull = float(p.model.named.third_body.mu)
    names = {body.name: body.position(np.array([time]))[0] for body in drawn_bodies(p.scene)}
    if not pull or not names:
        return ""
    name, place = min(names.items(), key=lambda item: float(np.linalg.norm(item[1] - position)))
    away = float(np.linalg.norm(place - position))
    share = pull / away**2 / (p.body.mu / float(position @ position))
    if share < 1.0:
        return ""
    return (
        f"{name}, a point without a surface {away / 1e3:.4g} km away, pulls {share:.3g} times as hard as the "
        f"{_centre(p.body)}, and the craft goes round it: start elsewhere, or stop the run by an event before"
    )


def _centre(body: Body) -> str:
    return body.name if body.name in ("Sun", "Earth") else f"central body {body.name}"


def _kind(p: Plan) -> str:
    return p.scene.steering.kind if p.scene.steering is not None else "sun-facing"


def _what_acts(p: Plan) -> str:
    around = p.scene.environment
    parts: list[str] = [p.scene.device.kind if p.scene.device.kind != "none" else ""]
    parts += [name for name in ("third_body", "atmosphere", "ionosphere") if getattr(around, name, None) is not None]
    return ", ".join(["gravity", *filter(None, parts)])
