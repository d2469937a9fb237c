"""Files of a measured wind that are none, are damaged, or say what cannot be: one sentence each, soon."""

import os
import random
import time

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from sailviz.environment.solar_wind.series import read_omni, read_series

COLUMNS = {"time_h": np.arange(400.0), "pressure_nPa": 2.0 + np.sin(np.arange(400.0))}


def written(folder, ending, columns=COLUMNS):
    path = folder / f"wind{ending}"
    if ending == ".npz":
        np.savez(path, **columns)
    elif ending == ".parquet":
        pq.write_table(pa.table(dict(columns)), path)
    else:
        rows = zip(*(values.tolist() for values in columns.values()), strict=True)
        path.write_text("\n".join([",".join(columns), *(",".join(map(str, row)) for row in rows)]))
    return path


@pytest.mark.parametrize("ending", [".npz", ".parquet", ".csv"])
def test_a_damaged_series_is_told_in_one_sentence_that_names_the_file(ending, tmp_path, harmed):
    path = written(tmp_path, ending)
    content, chance, told = path.read_bytes(), random.Random(3), []
    for _ in range(120):
        path.write_bytes(harmed(content, chance))
        try:
            series = read_series(path)
        except ValueError as error:
            told.append(str(error))
        else:
            assert np.isfinite(series.pressure).all()
    assert len(told) > 60
    assert all(sentence.startswith(str(path)) and "\n" not in sentence for sentence in told)


@pytest.mark.parametrize("ending", [".npz", ".parquet", ".csv", ".dat"])
def test_an_empty_file_is_no_series(ending, tmp_path):
    path = tmp_path / f"wind{ending}"
    path.touch()
    with pytest.raises(ValueError, match="wind"):
        read_series(path)


@pytest.mark.parametrize("ending", [".npz", ".parquet", ".csv"])
@pytest.mark.parametrize("hour", [1e12, 1e300, -1e15])
def test_a_time_far_away_asks_for_no_memory(ending, hour, tmp_path):
    times = COLUMNS["time_h"].copy()
    times[200] = hour
    path = written(tmp_path, ending, COLUMNS | {"time_h": times})
    began = time.monotonic()
    with pytest.raises(ValueError, match=r"400 rows in steps of 3600 s span .* of them with their gaps"):
        read_series(path)
    assert time.monotonic() - began < 5


def test_rows_that_all_have_one_time_are_no_series(tmp_path):
    path = written(tmp_path, ".csv", {"time_h": np.zeros(100), "pressure_nPa": np.full(100, 2.0)})
    with pytest.raises(ValueError, match="1 different times; 48 are needed"):
        read_series(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names")
@pytest.mark.parametrize("ending", [".npz", ".parquet", ".csv", ".dat"])
def test_a_pipe_or_a_device_is_not_waited_for(ending, tmp_path):
    os.mkfifo(tmp_path / f"wind{ending}")
    with pytest.raises(ValueError, match="not a regular file"):
        (read_omni if ending == ".dat" else read_series)(tmp_path / f"wind{ending}")
