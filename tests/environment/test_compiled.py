"""The environment as the propagator meets it: everything in one compiled function, reading one record."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.compiled import compiled
from sailviz.constants import DAY, J2_EARTH, J3_EARTH, J4_EARTH, MU_EARTH, RADIUS_EARTH
from sailviz.environment import atmosphere, eclipse, gravity, ionosphere, magnetic, solar_level, sun
from sailviz.propagate.parameters import PARAMETERS

EPOCH = np.datetime64("2024-03-20T03:06")


@compiled
def surroundings(t, x, y, z, record, tables, air_at, strengths, out):
    p = record[0]
    r = np.sqrt(x * x + y * y + z * z)
    f107 = solar_level.flux(t, p.solar_level)
    altitude = gravity.geodetic_altitude(z, r)
    latitude, local_time = np.arcsin(z / r), sun.local_time(t, x, y, p.sun)
    sx, sy, sz = sun.direction(t, p.sun)
    n, m = ionosphere.lookup(tables, 0, latitude, local_time, altitude, f107)
    out[0], out[1], out[2], out[3] = f107, altitude, n, m
    out[4] = atmosphere.lookup(tables, air_at, t, latitude, local_time, altitude, f107)
    out[5] = eclipse.sunlit(eclipse.CONE, x, y, z, sx, sy, sz, RADIUS_EARTH)
    out[6] = eclipse.sunlit(eclipse.CYLINDER, x, y, z, sx, sy, sz, RADIUS_EARTH)
    out[7] = magnetic.alignment(x, y, z, 1.0 / r, 0.3, x / r, y / r, z / r)
    out[8], out[9], out[10] = gravity.gravity(x, y, z, 1.0 / r, MU_EARTH, strengths[0], strengths[1], strengths[2])
    out[11], out[12], out[13] = gravity.gravity(x, y, z, 1.0 / r, MU_EARTH, strengths[0])
    out[14] = sun.mean_right_ascension(t, p.sun)


def test_compiled_and_interpreted_functions_are_one():
    plasma, air = ionosphere.table(), atmosphere.table_over(EPOCH, 900 * DAY)
    seen, level = sun.sun_parameters(EPOCH), solar_level.cycle(2024.2)
    record = np.zeros(1, PARAMETERS)
    record["sun"], record["solar_level"] = seen, level
    strengths = gravity.strengths(MU_EARTH, RADIUS_EARTH, J2_EARTH, J3_EARTH, J4_EARTH)
    out = np.empty(15)
    t, (x, y, z) = 200 * DAY, (3.1e6, -5.2e6, 3.4e6)
    surroundings(t, x, y, z, record, np.concatenate([plasma, air]), len(plasma), strengths, out)

    r = np.sqrt(x * x + y * y + z * z)
    f107, altitude = solar_level.flux.py_func(t, level), gravity.geodetic_altitude.py_func(z, r)
    place = np.arcsin(z / r), sun.local_time.py_func(t, x, y, seen), altitude, f107
    light = sun.direction.py_func(t, seen)
    expected = [
        f107, altitude, *ionosphere.density(*place), atmosphere.density(*place, air, t),
        eclipse.conical.py_func(x, y, z, *light, RADIUS_EARTH),
        eclipse.cylindrical.py_func(x, y, z, *light, RADIUS_EARTH),
        magnetic.alignment.py_func(x, y, z, 1 / r, 0.3, x / r, y / r, z / r),
        *gravity.gravity.py_func(x, y, z, 1 / r, MU_EARTH, *strengths),
        *gravity.gravity.py_func(x, y, z, 1 / r, MU_EARTH, strengths[0]),
        sun.mean_right_ascension.py_func(t, seen),
    ]  # fmt: skip
    assert out == pytest.approx(np.array(expected, dtype=float), rel=1e-11)
    assert out[8:11] != pytest.approx(out[11:14], rel=1e-9)  # J3 and J4 are there
