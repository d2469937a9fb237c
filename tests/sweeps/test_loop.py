"""Sweeps: every flight is there, each follows from the definition alone, and nothing that was flown is lost."""

import json
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner

import sailviz
from sailviz.cli import main
from sailviz.constants import AU, MU_SUN
from sailviz.errors import SceneError
from sailviz.shipped import shipped_sweeps
from sailviz.sweeps import dealing
from sailviz.sweeps.definition import define
from sailviz.sweeps.distributions import varied
from sailviz.sweeps.engines import SerialExecutor
from sailviz.sweeps.loop import fly_all
from sailviz.sweeps.store import SweepError
from sailviz.uncertainty.draws import value_of

COASTING = {
    "title": "A circle round the Sun",
    "start": {"kind": "circular", "radius_au": 1.0},
    "device": {"kind": "none", "mass_kg": 100.0},
    "propagation": {"duration_d": 20.0, "outputs": 5},
}
SAIL = COASTING | {
    "device": {"kind": "solar-sail", "lightness_number": 0.05},
    "steering": {"kind": "orbital", "pitch_deg": 35.0, "clock_deg": 90.0},
}
GUSTS = {
    "scene": SAIL,
    "vary": {"device.lightness_number": "normal(0.05, 0.01)", "steering.pitch_deg": [20, 35.0, 50]},
    "draws": 4,
    "seed": 7,
    "report": ["radius_au@end", "speed_km_s@10d", "pitch_deg@max"],
}


def rows(found):
    """The table without what the clock says."""
    return found.to_arrow().drop_columns(["wall_s"]).to_pylist()


@pytest.fixture(scope="module")
def gusts():
    return rows(sailviz.sweep(**GUSTS, engine="serial"))


@pytest.fixture
def shell(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return lambda *words: CliRunner().invoke(main, ["sweep", *map(str, words)], catch_exceptions=False)


# ---------------------------------------------------------------- what is flown
def test_energies_of_a_grid_of_circles_are_those_of_kepler():
    found = sailviz.sweep(COASTING, {"start.radius_au": "0.5:2:7"}, report=["energy_J_kg@end"], engine="serial")
    radius = found.table["start.radius_au"]
    np.testing.assert_array_equal(radius, np.linspace(0.5, 2, 7))
    np.testing.assert_allclose(found.table["energy_J_kg@end"], -MU_SUN / (2 * radius * AU), rtol=1e-10)
    assert (found.flights, found.failed, found.missed, found.complete) == (7, 0, 0, True)


def test_mean_energy_of_drawn_circles_is_the_lognormal_mean_within_three_standard_errors():
    n, sigma = 300, 0.1
    found = sailviz.sweep(
        COASTING,
        {"start.radius_au": f"lognormal(1, {sigma})"},
        draws=n,
        seed=3,
        report=["energy_J_kg@end"],
        engine="serial",
    )
    ratio = found.table["energy_J_kg@end"] / (-MU_SUN / (2 * AU))  # 1 / r, lognormal too
    mean = np.exp(sigma**2 / 2)
    deviation = mean * np.sqrt(np.exp(sigma**2) - 1)
    assert abs(ratio.mean() - mean) < 3 * deviation / np.sqrt(n)
    assert abs(ratio.std(ddof=1) - deviation) < 3 * deviation / np.sqrt(2 * n)


@pytest.mark.parametrize(
    ("law", "mean", "deviation"),
    [
        ("normal(2, 0.5)", 2, 0.5),
        ("uniform(1, 4)", 2.5, 3 / np.sqrt(12)),
        ("gamma(2.593, 0.7793)", 2.593 * 0.7793, np.sqrt(2.593) * 0.7793),
        ("lognormal(3, 0.2)", 3 * np.exp(0.02), 3 * np.exp(0.02) * np.sqrt(np.exp(0.04) - 1)),
    ],
)
def test_draws_have_the_moments_of_their_law(law, mean, deviation):
    n = 4000
    draw = varied("a.key", law)
    values = np.array([value_of(draw, 1, 0, i) for i in range(n)])
    assert abs(values.mean() - mean) < 3.5 * deviation / np.sqrt(n)
    assert values.std() == pytest.approx(deviation, rel=0.1)  # heavy tails: 3 standard errors of the gamma law are 6 %


def test_the_last_key_of_a_grid_varies_fastest_and_together_they_step_in_pace():
    keys = {"start.radius_au": [1, 2.5], "start.raan_deg": "0:30:2"}
    grid, _ = define(COASTING, keys)
    assert [tuple(grid.values(i).values()) for i in range(grid.flights)] == [(1, 0), (1, 30), (2.5, 0), (2.5, 30)]
    paced, _ = define(COASTING, keys, together=True)
    assert [tuple(paced.values(i).values()) for i in range(paced.flights)] == [(1, 0), (2.5, 30)]


def test_dates_and_words_vary_too():
    keys = {"epoch": "2030-01-01T06:00:00,2031-01-01", "device.kind": ["none"], "start.raan_deg": "1,2.5"}
    found = sailviz.sweep(COASTING, keys, engine="serial")
    assert [str(day) for day in found.table["epoch"][::2]] == ["2030-01-01 06:00:00", "2031-01-01"]
    assert list(found.table["start.raan_deg"]) == [1.0, 2.5, 1.0, 2.5]
    assert found.failed == 0


def test_a_draw_depends_on_nothing_but_its_key_and_its_number():
    alone, _ = define(SAIL, {"device.lightness_number": "normal(0.05, 0.01)"}, draws=3, seed=7)
    among, _ = define(
        SAIL,
        {"start.radius_au": "uniform(0.9, 1.1)", "device.lightness_number": "normal(0.05, 0.01)"},
        draws=50,
        seed=7,
    )
    for i in range(3):
        assert alone.values(i)["device.lightness_number"] == among.values(i)["device.lightness_number"]
    assert len({among.values(i)["start.radius_au"] for i in range(50)}) == 50
    assert len({among.seed_of(i) for i in range(50)}) == 50


def test_wind_is_drawn_anew_by_each_flights_own_seed():
    found = sailviz.sweep(
        "wind/transfer-arc",
        {"environment.solar_wind.seed": "seed"},
        draws=3,
        values={"expect": [], "propagation.duration_d": 20, "propagation.outputs": 5},
        report=["radius_au@end"],
        engine="serial",
    )
    assert list(found.table["environment.solar_wind.seed"]) == list(found.table["seed"])
    assert len(set(found.table["radius_au@end"])) == 3


@pytest.mark.parametrize("name", shipped_sweeps())
def test_a_shipped_sweep_can_be_flown(name):
    definition, _ = define(name)
    found = sailviz.sweep(definition.scene(), {axis.key: axis.values[:1] for axis in definition.axes}, engine="serial")
    assert found.failed == 0


# ---------------------------------------------------------------- where it is flown
def test_threads_and_chunks_change_no_number(gusts, monkeypatch):
    monkeypatch.setattr(dealing, "CHUNK_SECONDS", 1e-6)
    with ThreadPoolExecutor(3) as executor:
        assert rows(sailviz.sweep(**GUSTS, executor=executor)) == gusts


def test_processes_change_no_number(gusts):
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as executor:
        assert rows(sailviz.sweep(**GUSTS, executor=executor)) == gusts


def test_dask_changes_no_number(gusts):
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(n_workers=1, processes=False, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        assert rows(sailviz.sweep(**GUSTS, executor=client.get_executor())) == gusts


# ---------------------------------------------------------------- what goes wrong
def test_a_flight_that_cannot_be_flown_is_a_row_with_its_reason(shell, tmp_path):
    words = ("displaced/circular", "--vary", "start.rate_ratio=0.7,0.9,0.75", "--set", "propagation.outputs=9")
    result = shell(*words, "--set", "propagation.duration_d=9", "--engine", "serial", "--record", "failed,2")
    assert result.exit_code == 3
    assert "1 failed" in result.output
    table = pq.read_table("circular-sweep.parquet").to_pydict()
    assert table["status"] == ["ok", "failed", "ok"]
    assert "0.8294" in table["reason"][1]  # D1's bound at 10 deg: 0.829444
    assert table["elevation_deg@end"][1] is None
    assert table["elevation_deg@end"][2] == pytest.approx(10, abs=1e-6)
    assert table["duration_s"] == pytest.approx([9 * 86400.0, 0, 9 * 86400.0])
    assert [path.name for path in tmp_path.glob("*.rrd")] == ["circular-sweep-2.rrd"]  # 1 never began


def test_a_flight_that_breaks_down_says_when():
    falling = {
        "title": "Into a point mass",
        "body": {"mu_km3_s2": 1},
        "start": {"kind": "cartesian", "position_km": [1, 0, 0], "velocity_km_s": [0, 1, 0]},
        "device": {"kind": "none"},
        "propagation": {"duration_s": 10, "outputs": 50},
    }
    found = sailviz.sweep(falling, {"start.velocity_km_s": [[0, 0, 0], [0, 1, 0]]}, engine="serial")
    assert list(found.table["status"]) == ["failed", "ok"]
    assert "t = 1.11" in found.table["reason"][0]  # free fall from rest, r = mu = 1: pi / sqrt(8) = 1.1107 s
    assert found.table["duration_s"][0] == pytest.approx(np.pi / np.sqrt(8), rel=1e-3)
    assert json.loads(found.table["start.velocity_km_s"][1]) == [0, 1, 0]


def test_a_flight_that_kills_its_process_is_found_and_the_rest_is_flown(monkeypatch):
    class Pool(SerialExecutor):
        _max_workers = 2

        def submit(self, fn, definition, first, stop):
            future = super().submit(fn, definition, first, stop)
            if first <= 5 < stop:
                future = type(future)()
                future.set_exception(BrokenProcessPool())
            return future

    monkeypatch.setattr(dealing, "processes", lambda workers: Pool())
    found = sailviz.sweep(**GUSTS)
    assert [i for i, status in enumerate(found.table["status"]) if status == "failed"] == [5]
    assert "died" in found.table["reason"][5]


def test_a_foreign_executor_that_breaks_down_leaves_what_was_flown(tmp_path, gusts):
    class Pool(SerialExecutor):
        def submit(self, fn, definition, first, stop):
            if first > 3:
                raise BrokenProcessPool
            return super().submit(fn, definition, first, stop)

    path = tmp_path / "gusts.parquet"
    with pytest.raises(SweepError, match="goes on from them"):
        sailviz.sweep(**GUSTS, executor=Pool(), path=path)
    found = sailviz.sweep(**GUSTS, engine="serial", path=path)
    assert found.resumed >= 1
    assert rows(found) == gusts


def test_every_fault_of_a_sweep_is_told_at_once_and_nothing_is_written(shell, tmp_path):
    (tmp_path / "bad.toml").write_text(
        '[sweep]\nscene = "spirals/optical-sail"\nreport = ["radius_aw@end", "time_d@arrival", "mass_kg"]\n'
        '[[vary]]\nkey = "steering.pich_deg"\nrange = [20, 60, 5]\n'
        '[[vary]]\nkey = "device.area_m2"\ndistribution = "norml(1, 2)"\n'
    )
    result = shell("bad.toml")
    assert result.exit_code == 2
    for words in (
        "report[0]",
        'Did you mean "radius_au"?',
        'no such moment "arrival"',
        "is not QUANTITY@MOMENT",
        "vary[0].key (line 5)",
        'Did you mean "pitch_deg"?',
        "vary[1].distribution (line 9)",
        'Did you mean "normal"?',
    ):
        assert words in result.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["bad.toml"]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--vary", "start.radius_au=1,-2"], "must be greater than 0"),
        (["--vary", "start.radius_au=1:2"], "LOW:HIGH:COUNT"),
        (["--vary", "start.radius_au=1:2:2.5"], "whole number of values"),
        (["--vary", "start.radius_au=uniform(2,1)"], "low end must lie below"),
        (["--vary", "start.radius_au=normal(1,0.1)"], "how many flights"),
        (["--vary", "start.radius_au=1,2", "--draws", "3"], "nothing is drawn"),
        (["--vary", "start.radius_au=1,2", "--vary", "start.radius_km=1e8,2e8"], "varies already"),
        (["--vary", "start.radius_au=1,2", "--vary", "start.raan_deg=1,2,3", "--together"], "as many values each"),
        (["--vary", "start.radius_au=1,2", "--record", "7"], "there is no flight 7"),
        (["--vary", "start.radius_au=1,2", "--record", "min:radius_au"], "no column of numbers"),
        (["--vary", "start.radius_au=1,2", "--engine", "thread"], 'Did you mean "threads"?'),
        ([], "nothing varies"),
    ],
)
def test_a_wrong_word_is_bad_input(shell, tmp_path, words, sentence):
    result = shell("spirals/tangential-escape", *words)
    assert result.exit_code == 2
    assert sentence in result.stderr
    assert list(tmp_path.iterdir()) == []


# ---------------------------------------------------------------- what is left on disk
def test_the_file_holds_the_table_and_the_definition(tmp_path, gusts):
    found = sailviz.sweep(**GUSTS, engine="serial", path=tmp_path / "gusts.parquet", record=["max:radius_au@end"])
    assert rows(found) == gusts
    table = pq.read_table(found.path)
    assert table.drop_columns(["wall_s"]).to_pylist() == gusts
    assert json.loads(table.schema.metadata[b"sailviz.sweep"])["seed"] == 7
    farthest = max(gusts, key=lambda row: row["radius_au@end"])
    ((number, file),) = found.recordings.items()
    assert number == farthest["index"]
    recorded = sailviz.read(file)["/state"]["position_m"]
    assert np.linalg.norm(recorded[-1]) / AU == pytest.approx(farthest["radius_au@end"], rel=1e-14)
    again = sailviz.sweep(**GUSTS, executor=None, engine="serial", path=found.path)
    assert again.resumed == again.flights == len(gusts)
    assert found.to_numpy()["index"].tolist() == list(range(12))


def test_another_definition_is_refused_with_what_changed(tmp_path):
    path = tmp_path / "gusts.parquet"
    sailviz.sweep(**GUSTS, engine="serial", path=path)
    with pytest.raises(SweepError, match="seed was 7 and is 8"):
        sailviz.sweep(**GUSTS | {"seed": 8}, path=path)
    with pytest.raises(SweepError, match=r"start\.radius_au was 1\.0 and is 2"):
        sailviz.sweep(**GUSTS, values={"start.radius_au": 2}, path=path)
    (tmp_path / "other.parquet").write_text("no table")
    with pytest.raises(SweepError, match="not the table of a sweep"):
        sailviz.sweep(**GUSTS, path=tmp_path / "other.parquet")


LONG = ("spirals/optical-sail", "--vary", "steering.pitch_deg=20:40:320", "--set", "expect=[]", "-o", "long.parquet")
LONG = (*LONG, "--report", "time_d@end")


@pytest.fixture(scope="module")
def long_rows():
    return rows(
        sailviz.sweep(
            LONG[0],
            {"steering.pitch_deg": "20:40:320"},
            values={"expect": []},
            report=["time_d@end"],
            engine="threads",
            workers=2,
        )
    )


def test_a_process_killed_while_it_wrote_leaves_nothing_beside_the_finished_table(tmp_path):
    path, parts = tmp_path / "gusts.parquet", tmp_path / "gusts.parquet.parts"
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    parts.mkdir()
    for name in ("000000000003-2.parquet", "definition.json"):
        (parts / f".{name}.{dead.pid}.part").write_bytes(b"PAR1 half of it")
    (parts / f".000000000005-2.parquet.{os.getpid()}.part").write_bytes(b"a living process writes here")
    sailviz.sweep(**GUSTS, engine="serial", path=path)
    assert [file.name for file in parts.iterdir()] == [f".000000000005-2.parquet.{os.getpid()}.part"]
    (parts / f".000000000005-2.parquet.{os.getpid()}.part").unlink()
    parts.rmdir()
    assert list(tmp_path.iterdir()) == [path]


def _begin(folder, *words):
    """A sweep in a process of its own, once two parts of it are on disk."""
    environment = os.environ | {"PYTHONPATH": str(Path(sailviz.__file__).parents[1])}
    begun = subprocess.Popen(
        [sys.executable, "-m", "sailviz", "sweep", *LONG, *words],
        cwd=folder,
        env=environment,
        stderr=subprocess.PIPE,
        text=True,
    )
    for _ in range(2400):
        if len(list(folder.glob("long.parquet.parts/*.parquet"))) >= 2 or begun.poll() is not None:
            return begun
        time.sleep(0.05)
    raise AssertionError("no part came")


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="looks for children in /proc")
def test_a_killed_sweep_goes_on_where_it_stopped_and_leaves_no_process_behind(tmp_path, long_rows):
    begun = _begin(tmp_path, "--workers", "1")
    children = Path(f"/proc/{begun.pid}/task/{begun.pid}/children").read_text().split()
    assert children
    begun.kill()
    begun.wait()
    begun.stderr.close()
    assert not (tmp_path / "long.parquet").exists()
    definition, _ = define(LONG[0], {"steering.pitch_deg": "20:40:320"}, report=["time_d@end"], values={"expect": []})
    found = fly_all(definition, engine="threads", workers=2, path=tmp_path / "long.parquet")
    assert 0 < found.resumed < found.flights
    assert rows(found) == long_rows
    assert [path.name for path in tmp_path.iterdir()] == ["long.parquet"]
    deadline = time.time() + 10
    while (alive := [pid for pid in children if _runs(pid)]) and time.time() < deadline:
        time.sleep(0.05)
    assert not alive


def _runs(pid) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to another process")
def test_an_interrupted_sweep_leaves_a_table_of_what_was_flown(tmp_path, shell, long_rows):
    begun = _begin(tmp_path, "--engine", "serial")
    begun.send_signal(signal.SIGINT)
    _, said = begun.communicate(timeout=60)
    assert begun.returncode == 130
    assert "The same command goes on from there." in said
    table = pq.read_table(tmp_path / "long.parquet").drop_columns(["wall_s"]).to_pylist()
    assert 0 < len(table) < 320
    assert table == long_rows[: len(table)]
    result = shell(*LONG, "--engine", "threads", "--workers", "2", "--json")
    assert json.loads(result.stdout)["resumed"] == len(table)
    assert pq.read_table("long.parquet").drop_columns(["wall_s"]).to_pylist() == long_rows


def test_parts_that_came_out_of_order_become_one_table_in_order(tmp_path, gusts):
    from sailviz.sweeps.store import FileStore

    definition, _ = define(**GUSTS)
    path = tmp_path / "gusts.parquet"
    for share in ([gusts[8:10], gusts[0:3]], [gusts[10:12], gusts[3:5]], [gusts[5:8]]):
        store = FileStore(definition, path)
        for part in share:
            store.add(part)
        store.close()
        index = pq.read_table(path)["index"].to_pylist()
        assert index == sorted(index)
    assert index == list(range(12))
    with pytest.raises(SceneError, match="nothing varies"):
        define(SAIL, {})


def test_ctrl_c_that_pydantic_makes_an_error_of_ends_the_sweep(monkeypatch):
    def pressed(*_):
        raise RuntimeError("Error calling function") from KeyboardInterrupt()

    monkeypatch.setattr("sailviz.sweeps.flight._measured", pressed)
    with pytest.raises(KeyboardInterrupt):
        sailviz.sweep(LONG[0], {"steering.pitch_deg": "20:40:3"}, values={"expect": []}, engine="serial")
