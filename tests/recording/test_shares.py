"""What each device of a list does, through a recording and back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sailviz import compare, read, record, simulate
from sailviz.recording import export
from sailviz.recording.overlay import record_together
from sailviz.recording.recorded_run import run_of
from sailviz.run.arrays import Run
from sailviz.run.moments import run_at

NAMES = {"sail": "sail", "Ion drive": "ion_drive"}  # and the words in paths


@pytest.fixture(scope="module")
def flown() -> Run:
    steering = {"kind": "tangential"}
    return simulate(
        {
            "title": "a sail and an engine",
            "start": {"kind": "circular", "radius_au": 1.0},
            "device": [
                {"kind": "solar-sail", "name": "sail", "characteristic_acceleration_mm_s2": 0.5},
                {"kind": "thruster", "name": "Ion drive", "acceleration_mm_s2": 0.2, "active_d": [[3, 60]],
                 "steering": steering},
            ],
            "propagation": {"duration_d": 100, "outputs": 21},
        }
    )  # fmt: skip


def test_a_recording_tells_what_each_device_did(flown: Run, tmp_path: Path) -> None:
    record(flown, tmp_path / "a.rrd")
    recording = read(tmp_path / "a.rrd")
    told = [recording[f"/thrust/{word}"] for word in NAMES.values()]
    for name, table in zip(NAMES, told, strict=True):
        np.testing.assert_array_equal(table["acceleration_m_s2"], flown.devices[name].acceleration)
        np.testing.assert_array_equal(table["on"], flown.devices[name].on)
    total = sum(table["acceleration_m_s2"] for table in told)
    np.testing.assert_allclose(total, recording["/thrust"]["acceleration_m_s2"], rtol=1e-14, atol=1e-19)
    again = run_of(recording)
    assert list(again.devices) == list(NAMES)
    np.testing.assert_array_equal(again.devices["Ion drive"].magnitude, flown.devices["Ion drive"].magnitude)


def test_a_comparison_sees_thrust_that_went_over_to_the_other_device(flown: Run, tmp_path: Path) -> None:
    """Their sum is the same."""
    record(flown, tmp_path / "a.rrd")
    assert compare(flown, tmp_path / "a.rrd").equal
    sail, drive = flown.devices.values()
    other = replace(flown, devices={"sail": drive, "Ion drive": sail})
    told = compare(other, tmp_path / "a.rrd")
    assert not told.equal
    differing = {difference.quantity.partition(":")[0] for difference in told.different}
    assert differing == {"/thrust/sail", "/thrust/ion_drive"}


def test_what_devices_did_is_kept_of_flights_that_are_recorded_together(flown: Run, tmp_path: Path) -> None:
    """Of each its own devices; and between the rows each is read off at one time with all else."""
    alone = replace(flown, devices={"sail": flown.devices["sail"]})
    record_together({"both": flown, "alone": alone}, tmp_path / "a.rrd")
    recording = read(tmp_path / "a.rrd")
    assert "/flight/alone/thrust/ion_drive" not in recording
    for place in ("/thrust/sail", "/flight/alone/thrust/sail"):
        np.testing.assert_array_equal(recording[place]["magnitude_m_s2"], flown.devices["sail"].magnitude)
    assert compare(tmp_path / "a.rrd", tmp_path / "a.rrd").equal
    between = run_at(flown, 0.5 * (flown.time[:-1] + flown.time[1:]))
    total = sum(device.acceleration for device in between.devices.values())
    np.testing.assert_allclose(total, between.thrust.acceleration, rtol=1e-12, atol=1e-19)


@pytest.mark.parametrize("ending", ["csv", "parquet", "npz"])
def test_a_table_holds_what_each_device_did(flown: Run, tmp_path: Path, ending: str) -> None:
    import pyarrow.csv
    import pyarrow.parquet

    record(flown, tmp_path / "a.rrd")
    (path, *_) = export(tmp_path / "a.rrd", tmp_path / f"a.{ending}", entities=["thrust/ion_drive"])
    key = "thrust/ion_drive.magnitude_m_s2"
    if ending == "npz":
        column = np.load(path)[key]
    else:
        table = pyarrow.csv.read_csv(path) if ending == "csv" else pyarrow.parquet.read_table(path)
        assert not any(name.startswith("thrust/sail") for name in table.column_names)
        column = table[key].to_numpy()
    np.testing.assert_array_equal(column, flown.devices["Ion drive"].magnitude)
