"""Both integrators of single flights have to do what an integrator does."""

from __future__ import annotations

from functools import partial

import pytest

from sailviz.propagate import collocation, dop853


@pytest.fixture(params=[dop853, collocation], ids=["dop853", "collocation"])
def fly(request, fly):
    return partial(fly, method=request.param)


@pytest.fixture
def speed_errs(fly):
    """How much less is asked of velocities: the polynomials of collocation know them to one order less."""
    return 1 if fly.keywords["method"] is dop853 else 20
