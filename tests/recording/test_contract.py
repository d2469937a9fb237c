"""What a run holds comes back from its recording bit for bit, under the names of the contract."""

from dataclasses import replace

import numpy as np

from sailviz import compare
from sailviz.recording import export, read, record
from sailviz.recording.contract import tables
from sailviz.scene.quantities import spellings

CONTRACT = {
    "/state": {"time_s", "position_m", "velocity_m_s", "mass_kg"},
    "/attitude": {"pitch_rad", "cone_rad", "clock_rad", "normal", "quaternion"},
    "/thrust": {"acceleration_m_s2", "acceleration_rtn_m_s2", "magnitude_m_s2", "on"},
    "/elements": {
        "semi_major_axis_m",
        "eccentricity",
        "inclination_rad",
        "raan_rad",
        "argument_rad",
        "true_anomaly_rad",
    },
    "/events": {"name", "time_s", "state"},
}


def test_every_number_of_a_run_comes_back_bit_for_bit(any_run, tmp_path):
    record(any_run, tmp_path / "run.rrd")
    recording = read(tmp_path / "run.rrd")
    for entity, table in tables(any_run).items():
        for name, values in table.items():
            back = recording[entity][name]
            assert back.dtype == values.dtype
            assert back.shape == values.shape
            assert back.tobytes() == np.ascontiguousarray(values).tobytes(), f"{entity} {name}"


def test_nan_and_infinity_come_back(runs, tmp_path):
    run = runs.spiral(rows=50)
    run.elements.semi_major_axis[7] = np.inf
    run.elements.argument[9] = np.nan
    record(run, tmp_path / "run.rrd")
    elements = read(tmp_path / "run.rrd")["/elements"]
    assert elements["semi_major_axis_m"][7] == np.inf
    assert np.isnan(elements["argument_rad"][9])


def test_entities_carry_the_names_of_the_contract(runs, tmp_path):
    record(runs.displaced(), tmp_path / "run.rrd")
    recording = read(tmp_path / "run.rrd")
    assert recording.contract == "sailviz/1"
    for entity, names in CONTRACT.items():
        assert set(recording[entity]) == names


def test_environment_columns_keep_their_names(runs, tmp_path):
    run = runs.spiral()
    record(run, tmp_path / "run.rrd")
    assert set(read(tmp_path / "run.rrd")["/environment"]) == set(run.environment)


def test_scene_and_provenance_travel_with_the_numbers(runs, tmp_path):
    run = runs.displaced()
    recorded = record(run, tmp_path / "run.rrd")
    recording = read(tmp_path / "run.rrd")
    assert recording.scene_text == run.setting.text
    assert recording.resolved == run.setting.resolved
    assert recording.versions == run.setting.versions
    assert recording.accuracy == run.setting.accuracy
    assert recording.identity == recorded.identity == run.setting.identity
    assert recording.application_id == f"sailviz_displaced_{run.setting.identity[:8]}"
    assert recording.complete
    assert recorded.complete
    assert recorded.rows == len(run)
    assert recording["/scene"]["craft_tether_length_m"][0] == 20e3


def test_columns_of_numbers_of_flags_and_of_vectors_come_back(years):
    run, path = years
    table = read(path)["/environment"]
    assert set(table) == set(run.environment)
    for name, values in run.environment.items():
        assert table[name].dtype == values.dtype
        assert np.array_equal(table[name], values), name


def test_a_column_of_vectors_is_compared_and_exported(runs, tmp_path, low_orbit):
    run = low_orbit.with_everything(runs.descent(rows=40))
    bent = run.environment["primer_direction"].copy()
    bent[7, 1] += 1e-3
    record(run, tmp_path / "a.rrd")
    record(replace(run, environment=run.environment | {"primer_direction": bent}), tmp_path / "b.rrd")
    assert compare(tmp_path / "a.rrd", tmp_path / "a.rrd").equal
    found = compare(tmp_path / "a.rrd", tmp_path / "b.rrd")
    assert {d.quantity for d in found.different} == {"/environment:primer_direction"}
    export(tmp_path / "a.rrd", tmp_path / "a.csv", entities=["/environment"])
    assert "primer_direction.y" in (tmp_path / "a.csv").read_text().splitlines()[0]


def test_a_scene_can_expect_what_acted_on_a_low_orbit(runs, low_orbit):
    run = low_orbit.with_everything(runs.descent(rows=20))
    names = spellings()
    assert np.allclose(names["tether_power_W"].of(run), run.environment["tether_power_W"])
    assert np.allclose(names["tether_current_mA"].of(run), 1e3 * run.environment["tether_current_A"])
    assert np.array_equal(names["sunlit"].of(run), run.environment["sunlit"])
    e = run.elements
    expected = (e.semi_major_axis * (1 - e.eccentricity) - low_orbit.RADIUS) / 1e3
    assert np.allclose(names["perigee_altitude_km"].of(run), expected)
    assert np.isnan(names["tether_power_W"].of(runs.displaced(rows=5))).all()
