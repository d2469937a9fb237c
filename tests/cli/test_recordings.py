"""info, export, compare and digest from a shell: what they print and how they exit."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from sailviz.cli import main
from sailviz.constants import AU, MU_SUN
from sailviz.elements import state
from sailviz.recording.writer import record_trajectory


def flight(path, factor=1.0, rows=80, epoch="2030-01-01"):
    time = np.linspace(0, 3e7, rows)
    position, velocity = state(AU, 0.0, 0.1, 0.2, 0.0, time * np.sqrt(MU_SUN / AU**3), MU_SUN)
    thrust = 1e-4 * factor * position / AU
    record_trajectory(
        time, position, velocity, path, thrust=thrust, epoch=epoch, events=[("half", 1.5e7)], planets=False
    )
    return str(path)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("cli")
    return {
        "a": flight(folder / "a.rrd"),
        "same": flight(folder / "same.rrd"),
        "b": flight(folder / "b.rrd", factor=1 + 1e-8),
        "undated": flight(folder / "undated.rrd", epoch=None),
    }


def sailviz(*arguments):
    return CliRunner().invoke(main, list(map(str, arguments)))


def test_compare_exits_0_1_and_2(files, tmp_path):
    equal = sailviz("compare", files["a"], files["same"])
    assert equal.exit_code == 0, equal.output
    assert equal.output.splitlines()[-1].startswith("Equal: ")
    different = sailviz("compare", files["a"], files["b"])
    assert different.exit_code == 1
    assert "DIFFERENT  /thrust:magnitude_m_s2" in different.output
    (tmp_path / "empty.rrd").touch()
    unreadable = sailviz("compare", files["a"], tmp_path / "empty.rrd")
    assert unreadable.exit_code == 2
    assert unreadable.stderr == f"{tmp_path / 'empty.rrd'} is empty\n"
    assert sailviz("compare", files["a"], tmp_path / "none.rrd").exit_code == 2
    assert sailviz("compare", files["a"]).exit_code == 2


def test_compare_takes_tolerances_by_quantity(files):
    arguments = ["compare", files["a"], files["b"], "--no-picture", "-q"]
    names = ("acceleration_m_s2", "acceleration_rtn_m_s2", "magnitude_m_s2")
    loose = [word for name in names for word in ("--atol", f"/thrust:{name}=1e-11")]
    assert sailviz(*arguments, *loose).exit_code == 0
    assert sailviz(*arguments, *loose[:4]).exit_code == 1
    assert sailviz(*arguments, "--rtol", "1e-7").exit_code == 0
    assert sailviz(*arguments, "--on", "step", "--rtol", "/thrust=1e-7").exit_code == 0
    wrong = sailviz(*arguments, "--atol", "/thrust:magnitud=1")
    assert wrong.exit_code == 2
    assert "did you mean" in wrong.stderr
    assert sailviz(*arguments, "--atol", "/thrust=x").exit_code == 2


def test_compare_speaks_json(files):
    told = json.loads(sailviz("compare", files["a"], files["b"], "--json").output)
    assert told["equal"] is False
    worst = [d["quantity"] for d in told["quantities"] if not d["equal"]]
    assert worst == [f"/thrust:{name}" for name in ("acceleration_m_s2", "acceleration_rtn_m_s2", "magnitude_m_s2")]


def test_digest_is_one_for_the_same_and_another_for_others(files):
    lines = sailviz("digest", files["a"], files["same"], files["b"]).output.splitlines()
    a, same, b = (line.split("  ")[0] for line in lines)
    assert len(a) == 64
    assert a == same != b
    assert sailviz("digest", "none.rrd").exit_code == 2


def test_info_in_words_and_in_json(files):
    text = sailviz("info", files["a"]).output
    for word in (
        "Trajectory",
        "80 over 347.222 d",
        "2030-01-01T00:00:00.000 UTC",
        "half at 173.611 d",
        "complete      yes",
    ):
        assert word in text
    facts = json.loads(sailviz("info", files["a"], "--json").output)
    assert facts["truth"]["/state"]["velocity_m_s"] == "float64 x 3"
    assert len(json.loads(sailviz("info", files["a"], files["b"], "--json").output)) == 2
    assert sailviz("info", "none.rrd").exit_code == 2


@pytest.mark.parametrize("form", ["csv", "parquet", "npz", "oem"])
def test_export_says_what_it_wrote(form, files, tmp_path):
    done = sailviz("export", files["a"], "--to", form, "-o", tmp_path)
    assert done.exit_code == 0, done.output
    events = [str(tmp_path / f"a.events.{form}")] * (form in ("csv", "parquet"))
    assert done.output.splitlines() == [str(tmp_path / f"a.{form}"), *events]
    assert (tmp_path / f"a.{form}").stat().st_size > 1000


def test_export_refuses_in_one_sentence(files, tmp_path):
    undated = sailviz("export", files["undated"], "-o", tmp_path / "x.oem")
    assert undated.exit_code == 2
    assert "has no epoch" in undated.stderr
    assert undated.stderr.count("\n") == 1
    assert sailviz("export", files["a"]).exit_code == 2
    assert sailviz("export", files["a"], "--to", "csv", "--entity", "/stat").exit_code == 2
    assert list(tmp_path.iterdir()) == []


def damaged(path, folder):
    """A copy of a recording in which four bytes of its middle are others."""
    content = bytearray(Path(path).read_bytes())
    content[len(content) // 2 : len(content) // 2 + 4] = b"\xff" * 4
    copy = folder / "damaged.rrd"
    copy.write_bytes(content)
    return copy


def test_verify_names_the_damaged_entities_and_looks_at_every_file(files, tmp_path):
    wrong = damaged(files["a"], tmp_path)
    found = sailviz("info", "--verify", files["a"], wrong, tmp_path / "none.rrd", files["b"])
    assert found.exit_code == 2
    assert found.output.count("entities hold") == 2
    assert re.search(r"damaged.rrd is damaged: (/\S+, )*/\S+ do(es)? not have the checksum", found.stderr)
    assert "no such file" in found.stderr
    assert sailviz("info", "--verify", files["a"]).exit_code == 0
    told = json.loads(sailviz("info", "--verify", "--json", wrong).stdout)
    assert told["checksums"] == "damaged"
    assert all(name.startswith("/") for name in told["damaged"])


@pytest.mark.parametrize("verb", [("info",), ("digest",), ("export", "--to", "npz"), ("compare", "-q")])
def test_a_damaged_recording_is_bad_input_and_never_different(verb, files, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    wrong = damaged(files["a"], tmp_path)
    found = sailviz(*verb, wrong, *[files["a"]] * (verb[0] == "compare"))
    assert found.exit_code == 2
    assert found.stderr.count("\n") == 1
    assert "is damaged" in found.stderr
