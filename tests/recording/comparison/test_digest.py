"""The digest of a recording: blind to how it was written, wide awake to what it says."""

from dataclasses import replace

import numpy as np
import pytest

from sailviz.recording import Memory, digest, record
from sailviz.recording.comparison.digest import digest_by_entity
from sailviz.recording.timelines import take


def digest_of(run, path):
    record(run, path)
    return digest(path)


def test_the_same_run_twice_has_one_digest(any_run, tmp_path):
    assert digest_of(any_run, tmp_path / "a.rrd") == digest_of(any_run, tmp_path / "b.rrd")


@pytest.mark.parametrize("size", [11, 130])
def test_the_blocks_in_which_a_run_arrives_do_not_count(runs, any_run, size, tmp_path):
    record(any_run, tmp_path / "whole.rrd")
    record(runs.in_blocks(any_run, size), tmp_path / "blocks.rrd")
    whole, blocks = digest_by_entity(tmp_path / "whole.rrd"), digest_by_entity(tmp_path / "blocks.rrd")
    assert {name for name in whole if whole[name] != blocks.get(name)} == set()
    assert digest(tmp_path / "whole.rrd") == digest(tmp_path / "blocks.rrd")


def test_blocks_do_not_count_where_only_some_rows_are_drawn(runs, tmp_path):
    run = runs.spiral(rows=7001)
    record(run, tmp_path / "whole.rrd")
    record(runs.in_blocks(run, 997), tmp_path / "blocks.rrd")
    assert digest(tmp_path / "whole.rrd") == digest(tmp_path / "blocks.rrd")


def test_memory_and_file_have_one_digest(run, tmp_path):
    memory = Memory()
    record(run, memory)
    (tmp_path / "memory.rrd").write_bytes(memory.bytes)
    assert digest(tmp_path / "memory.rrd") == digest_of(run, tmp_path / "file.rrd")


COLUMNS = {
    "": ("time", "position", "velocity", "mass"),
    "attitude": ("pitch", "cone", "clock", "normal", "quaternion"),
    "thrust": ("acceleration", "acceleration_rtn", "magnitude"),
    "elements": ("semi_major_axis", "eccentricity", "inclination", "raan", "argument", "true_anomaly"),
}


def changed(run, group, name, change):
    """The run with one of its columns changed."""
    part = getattr(run, group) if group else run
    values = getattr(part, name).copy()
    change(values)
    part = replace(part, **{name: values})
    return replace(run, **{group: part}) if group else part


@pytest.mark.parametrize(("group", "name"), [(group, name) for group, names in COLUMNS.items() for name in names])
def test_the_last_bit_of_any_column_changes_the_digest(runs, group, name, tmp_path):
    run = runs.displaced(rows=40)
    before = digest_of(run, tmp_path / "a.rrd")

    def next_number(values):
        values[-7] = np.nextafter(values[-7], np.inf)

    assert digest_of(changed(run, group, name, next_number), tmp_path / "b.rrd") != before


def test_a_flipped_thrust_changes_the_digest(runs, tmp_path):
    run = runs.displaced(rows=40)

    def flip(values):
        values[11] *= -1

    flipped = changed(run, "thrust", "acceleration", flip)
    assert digest_of(flipped, tmp_path / "b.rrd") != digest_of(run, tmp_path / "a.rrd")


def test_a_missing_event_or_row_changes_the_digest(runs, tmp_path):
    run = runs.displaced(rows=40)
    before = digest_of(run, tmp_path / "a.rrd")
    assert digest_of(replace(run, events=()), tmp_path / "b.rrd") != before
    assert digest_of(take(run, slice(0, 39)), tmp_path / "c.rrd") != before
