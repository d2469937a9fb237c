"""What events watch of a craft that turns, beside what `quantity_callback` knows."""

from __future__ import annotations

import numpy as np

from sailviz.compiled import called
from sailviz.propagate.body_motion import AVERAGED, RATE, WHEELS
from sailviz.propagate.quantity_callback import OF_BODY, QUANTITIES
from sailviz.propulsion.rigid_body import symmetric

BODY_RATE, NUTATION, WHEEL_MOMENTUM = (QUANTITIES.index(name) for name in OF_BODY)
FIRST_OF_BODY = BODY_RATE


@called
def body_quantity(number, y, b):
    """(value, its size): the body rate, rad/s; the angle between the z axis and the angular momentum, rad; the largest
    momentum of a wheel, N m s."""
    if number == WHEEL_MOMENTUM:
        most = max(abs(y[WHEELS]), max(abs(y[WHEELS + 1]), abs(y[WHEELS + 2])))
        return most, most
    wx, wy, wz = y[RATE], y[RATE + 1], y[RATE + 2]
    if number == BODY_RATE:
        rate = np.sqrt(wx * wx + wy * wy + wz * wz)
        return rate, rate
    if b.motion == AVERAGED:
        return 0.0, 1.0
    hx, hy, hz = symmetric(b.xx, b.yy, b.zz, b.xy, b.xz, b.yz, wx, wy, wz)
    hx, hy, hz = hx + y[WHEELS], hy + y[WHEELS + 1], hz + y[WHEELS + 2]
    return np.arctan2(np.sqrt(hx * hx + hy * hy), hz), 1.0
