"""The table of flights past the Sun: times that shooting from departure gave before, one flown again by SciPy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz.design.minimum_time.state_costate import TIME_UNIT
from sailviz.figures import transfer_data

DAY = 86400.0
# lightness, perihelion limit au: days, by shooting from departure; that of 0.4 and 0.3 by direct transcription too
KNOWN = {
    (0.4, 0.2): 1012.9634,
    (0.4, 0.25): 1124.1093,
    (0.4, 0.3): 1232.0375,
    (0.4, 0.4): 1443.7294,
    (0.4, 0.5): 1652.8946,
    (0.5, 0.25): 985.1427,
    (0.3, 0.3): 1502.1626,
    (0.6, 0.3): 974.3274,
}
# costates of r, u, v at departure, H = +1; time of the touch and jump of the first there; canonical
LAM, TOUCH, JUMP = (-7.345033548047054, -1.506839583651021, -7.084049600716437), 3.1225968333060132, -34.31159196444206


@pytest.fixture(scope="module")
def table():
    rows = transfer_data.photonic_assists()
    return {(beta, limit): rest for beta, limit, *rest in rows.tolist()}


@pytest.mark.parametrize("cell", KNOWN)
def test_flight_time_is_that_of_another_way_of_shooting(table, cell):
    assert table[cell][0] == pytest.approx(KNOWN[cell], abs=2e-4)


def test_nothing_is_faster_with_less_room_or_less_thrust(table):
    for (beta, limit), (days, closest, _) in table.items():
        for (other, wider), (slower, _, _) in table.items():
            if other <= beta and wider >= limit and np.isfinite(days * slower):
                assert days <= slower + 1e-6
        assert not closest < limit * (1 - 1e-5)


def test_a_deep_fall_flown_by_scipy_touches_its_limit_and_comes_out_in_the_time_of_its_cell(table):
    beta, near, far = 0.5, 0.2, 30.0

    def rates(_, y):
        """Polar form; the pitch by tan a = (sqrt(9 c^2 + 8 s^2) - 3 c) / (4 s), the costates by the partials of H."""
        r, u, v, lr, lu, lv = y
        angle = np.arctan2(lv, lu)
        c, s = np.cos(angle), abs(np.sin(angle))
        root = np.sqrt(9 * c * c + 8 * s * s)
        a = np.arctan2(root - 3 * c, 4 * s) if c < 0 else np.arctan2(2 * s, root + 3 * c)
        push = beta / r**2 * np.cos(a) ** 2
        ar, at = push * np.cos(a), push * np.sin(a) * np.copysign(1.0, lv)
        along = lu * ar + lv * at
        return [
            u,
            v * v / r - 1 / r**2 + ar,
            -u * v / r + at,
            lu * (v * v / r**2 - 2 / r**3) - lv * u * v / r**2 + 2 * along / r,
            -lr + lv * v / r,
            -2 * lu * v / r + lv * u / r,
        ]

    def flown(y, span):
        return solve_ivp(rates, (0, span), y, method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]

    touching = flown([1.0, 0.0, 1.0, *LAM], TOUCH)
    assert touching[0] == pytest.approx(near, abs=1e-8)
    assert touching[1] == pytest.approx(0, abs=1e-7)
    touching[3] += JUMP
    span = table[beta, near][0] * DAY / TIME_UNIT
    end = flown(touching, span - TOUCH)
    assert end[0] == pytest.approx(far, abs=1e-5)  # the cell is rounded to 1e-4 d, in which the craft goes 4e-6 au
    assert np.hypot(*end[4:]) < 1e-4 * abs(end[3])  # the speed there is free
