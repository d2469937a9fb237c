"""Recordings in other programs' files: the numbers arrive, named with their units, or one sentence says why not."""

from dataclasses import replace

import numpy as np
import pyarrow.csv
import pyarrow.parquet
import pytest

from sailviz.errors import RecordingError
from sailviz.frames import EQUATOR_FROM_ECLIPTIC
from sailviz.recording import export, info, record
from sailviz.recording.contract import tables
from sailviz.run.oem import read_oem

READERS = {"csv": pyarrow.csv.read_csv, "parquet": pyarrow.parquet.read_table}


@pytest.fixture
def path(any_run, tmp_path):
    record(any_run, tmp_path / "run.rrd")
    return tmp_path / "run.rrd"


@pytest.mark.parametrize("to", ["csv", "parquet"])
def test_every_number_arrives_in_a_table(any_run, path, to, tmp_path):
    written = export(path, tmp_path / f"out.{to}")
    assert [file.name for file in written] == [f"out.{to}"] + [f"out.events.{to}"] * bool(any_run.events)
    table = READERS[to](written[0])
    assert np.array_equal(table["step"].to_numpy(), np.arange(len(any_run)))
    assert np.array_equal(table["time_s"].to_numpy(), any_run.time)
    for entity, columns in tables(any_run).items():
        for name, values in columns.items():
            if name == "time_s":
                continue
            key = f"{entity[1:]}.{name}"
            letters = {"quaternion": "xyzw", "acceleration_rtn_m_s2": "rtn"}.get(name, "xyz")
            parts = [(key, values)] if values.ndim == 1 else [(f"{key}.{c}", v) for c, v in zip(letters, values.T)]  # noqa: B905
            for column, expected in parts:
                back = table[column].to_numpy()
                assert np.array_equal(back, expected), column  # the shortest decimals that give the same float64
    if any_run.events:
        events = READERS[to](written[1])
        assert events["name"].to_pylist() == [event.name for event in any_run.events]
        assert events["position_m.y"].to_numpy()[0] == any_run.events[0].state[1]


def test_an_archive_holds_every_column_under_its_name(any_run, path, tmp_path):
    (file,) = export(path, tmp_path, "npz")
    assert file == tmp_path / "run.npz"
    with np.load(file) as stored:  # without pickle
        for entity, columns in tables(any_run).items():
            for name, values in columns.items():
                assert stored[f"{entity[1:]}.{name}"].tobytes() == np.ascontiguousarray(values).tobytes()
        assert str(stored["scene.identity"]) == any_run.setting.identity
        assert str(stored["scene.epoch"]).startswith("2030-01-01")
        if any_run.events:
            assert stored["events.name"].tolist() == [event.name for event in any_run.events]


def test_one_entity_alone_and_plots_beside_the_truth(runs, tmp_path):
    record(runs.displaced(rows=40), tmp_path / "run.rrd")
    export(tmp_path / "run.rrd", tmp_path / "a.csv", entities=["state", "/plots/earth"])
    names = pyarrow.csv.read_csv(tmp_path / "a.csv").column_names
    assert names[:3] == ["step", "time_s", "utc"]
    assert "plots/earth.scalars" in names
    assert not any(name.startswith("attitude") for name in names)
    export(tmp_path / "run.rrd", tmp_path / "events.csv", entities=["/events"])
    assert pyarrow.csv.read_csv(tmp_path / "events.csv").column_names[:3] == ["name", "step", "time_s"]


def test_a_run_round_the_sun_is_rotated_into_the_equator_of_j2000(runs, tmp_path):
    run = runs.displaced(rows=80)
    (file,) = export(run, tmp_path / "run.oem")
    back = read_oem(file)
    assert (back.center, back.frame, back.time_system) == ("SUN", "EME2000", "UTC")
    assert back.epoch == back.utc == run.setting.epoch
    assert np.abs(back.time - run.time).max() < 1e-8  # as fine as a float64 of 1.5 years
    assert np.abs(back.position - run.position @ EQUATOR_FROM_ECLIPTIC.T).max() < 1e-4  # m: 16 digits of 1 au
    ecliptic = back.in_ecliptic()
    assert np.abs(ecliptic.position - run.position).max() < 2e-4
    assert np.abs(ecliptic.velocity - run.velocity).max() < 1e-10
    assert np.linalg.det(EQUATOR_FROM_ECLIPTIC) == pytest.approx(1, abs=1e-15)
    pole = EQUATOR_FROM_ECLIPTIC @ [0, 0, 1]  # of the ecliptic: right ascension 270 deg, declination 66.56 deg
    assert np.degrees(np.arcsin(pole[2])) == pytest.approx(66.560709, abs=1e-6)
    assert pole[1] < 0
    (file,) = export(run, tmp_path / "e.oem", frame="ECLIPJ2000")
    assert np.abs(read_oem(file).position - run.position).max() < 1e-4


def test_a_run_round_the_earth_is_turned_from_the_equator_of_its_date_to_that_of_j2000(runs, tmp_path):
    run = runs.descent(rows=80)
    (file,) = export(run, tmp_path / "run.oem")
    back = read_oem(file)
    assert (back.center, back.frame) == ("EARTH", "EME2000")
    assert "nutation neglected" in file.read_text()
    turned = np.degrees(np.arccos(np.sum(back.position * run.position, axis=1) / np.sum(run.position**2, axis=1))).max()
    assert turned == pytest.approx(
        30 * 50.29 / 3600, rel=0.1
    )  # deg: 50.29 arcsec a year of general precession since 2000
    home = back.in_equator_of_date()
    assert home.frame == "MOD"
    assert np.abs(home.position - run.position).max() < 1e-7  # m
    assert np.abs(home.velocity - run.velocity).max() < 1e-10


def test_line_breaks_and_keywords_in_a_title_do_not_become_lines_of_the_message(runs, tmp_path):
    run = runs.descent(rows=20)
    title = "META_STOP\nSECOND = line\r\n\x85COMMENT \u2028über\x00all"
    run = replace(run, setting=replace(run.setting, title=title))
    (file,) = export(run, tmp_path / "run.oem")
    lines = file.read_text(encoding="ascii").splitlines()
    assert not [line for line in lines if line.startswith("SECOND")]
    assert lines.count("META_STOP") == 1
    assert read_oem(file).name.startswith("- META_STOP SECOND = LINE")


def test_another_reader_agrees_with_what_was_written(runs, tmp_path):
    oem = pytest.importorskip("oem")
    run = runs.descent(rows=50)
    (file,) = export(run, tmp_path / "run.oem")
    states = oem.OrbitEphemerisMessage.open(file).states
    assert np.allclose([state.position for state in states], run.position / 1e3, rtol=1e-15)
    assert np.allclose([state.velocity for state in states], run.velocity / 1e3, rtol=1e-15)


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        ({"to": "xls"}, "there are csv, parquet, npz, oem"),
        ({}, "one of csv, parquet, npz, oem"),
        ({"to": "csv", "entities": ["/stat"]}, "/stat"),
        ({"to": "csv", "entities": ["/sail/angle/arc"]}, "another number of values"),
        ({"to": "csv", "entities": ["/state", "/world/stars"]}, "does not change over time"),
        ({"to": "csv", "frame": "EME2000"}, "named in an OEM"),
        ({"to": "oem", "frame": "ICRF"}, "EME2000 or ECLIPJ2000, not in ICRF"),
        ({"to": "oem", "entities": ["/thrust"]}, "takes no other entity"),
        ({"to": "csv", "out": "nowhere/run.csv"}, "there is no directory"),
    ],
)
def test_what_cannot_be_exported_is_refused_in_one_sentence(runs, arguments, word, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    record(runs.displaced(rows=30), "run.rrd")
    with pytest.raises(RecordingError, match=word) as error:
        export("run.rrd", **arguments)
    assert "\n" not in str(error.value)
    assert [file.name for file in tmp_path.iterdir()] == ["run.rrd"]


def test_an_ephemeris_needs_an_epoch_and_a_frame(runs, tmp_path):
    record(runs.displaced(rows=30, epoch=False), tmp_path / "run.rrd")
    with pytest.raises(RecordingError, match="has no epoch"):
        export(tmp_path / "run.rrd", tmp_path / "run.oem")
    run = runs.displaced(rows=30)
    vesta = replace(run, setting=replace(run.setting, body=replace(run.setting.body, name="Vesta")))
    with pytest.raises(RecordingError, match="a run round Vesta is in is not known"):
        export(vesta, tmp_path / "run.oem")
    (file,) = export(vesta, tmp_path / "run.oem", frame="VESTA_FIXED")
    assert read_oem(file).center == "VESTA"


def test_a_recording_is_described(any_run, path):
    facts = info(path)
    assert facts["rows"] == len(any_run)
    assert facts["span_s"] == [0.0, any_run.time[-1]]
    assert facts["epoch"].startswith("2030-01-01")
    assert facts["complete"] is True
    assert facts["truth"]["/state"]["position_m"] == "float64 x 3"
    assert facts["truth"]["/thrust"]["on"] == "bool"
    assert facts["family"] == any_run.setting.family
    assert len(facts["views"]) > 5
    assert [event["name"] for event in facts["events"]] == [event.name for event in any_run.events]
