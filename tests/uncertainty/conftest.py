"""The measured wind that some tests compare with; they are skipped where it is not at hand."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from sailviz.uncertainty import wind


@pytest.fixture(scope="session")
def omni():
    """Hourly OMNI2 1998-2018 as a Series, from the folder named in SAILVIZ_TEST_DATA."""
    file = Path(os.environ.get("SAILVIZ_TEST_DATA", "nowhere")) / "omni2_hourly_1998_2018.npz"
    if not file.exists():
        pytest.skip("no omni2_hourly_1998_2018.npz in SAILVIZ_TEST_DATA")
    with np.load(file) as data:
        column = {
            name: np.where(data[key] < 0, np.nan, data[key] * unit)
            for name, key, unit in (
                ("pressure", "pressure_x100", 1e-11),
                ("speed", "speed", 1e3),
                ("density", "density_x10", 1e5),
            )
        }
        hours = np.datetime64(str(data["t0"])) + np.arange(len(column["pressure"]))
    return wind.series(hours, **column)
