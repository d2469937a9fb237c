"""Damaged recordings: told in one sentence, never trusted, never the end of the process that reads them."""

import random
import subprocess
import zlib

import numpy as np
import pytest
import rerun as rr

from sailviz.errors import DamagedError, RecordingError
from sailviz.recording import Memory, checksums, compare, digest, export, framing, info, messages, read, record, verify
from sailviz.recording.sinks import viewer_binary


@pytest.fixture(scope="module")
def whole(runs, tmp_path_factory):
    """A small recording, as bytes, and its path."""
    path = tmp_path_factory.mktemp("whole") / "run.rrd"
    record(runs.displaced(rows=20), path)
    return path.read_bytes(), path


def flipped(content, bit):
    """The content with one bit turned."""
    changed = bytearray(content)
    changed[bit // 8] ^= 1 << (bit % 8)
    return bytes(changed)


def tried(verb, path):
    """(what a verb finds, "") or, where it refuses, (None, its sentence)."""
    try:
        return verb(path), ""
    except RecordingError as error:
        return None, str(error)


def test_a_bit_that_flips_anywhere_is_found_or_changes_nothing(whole, tmp_path):
    """Whichever bit it is: one sentence, or the same contents."""
    content, path = whole
    chance, same = random.Random(20), digest(path)
    frames = framing.framing(path)
    sealed = checksums.sums_of(path, frames).start
    places = [chance.randrange(8 * sealed) for _ in range(50)]  # what the checksum covers
    places += [chance.randrange(8 * sealed, 8 * len(content)) for _ in range(20)]  # the sums, index and tail
    places += [8 * (message.start + chance.randrange(16)) for message in chance.sample(frames.messages, 10)]
    for bit in places:
        (tmp_path / "damaged.rrd").write_bytes(flipped(content, bit))
        found, sentence = tried(digest, tmp_path / "damaged.rrd")
        assert "\n" not in sentence, bit
        assert sentence or bit >= 8 * sealed, bit
        assert found in (same, None), bit


def test_a_file_that_is_cut_anywhere_is_read_as_far_as_it_goes_or_refused(whole, run, tmp_path):
    content, path = whole
    position = read(path)["/state"]["position_m"]
    chance = random.Random(3)
    for stop in [*(chance.randrange(len(content)) for _ in range(2)), len(content) - 1]:
        (tmp_path / "cut.rrd").write_bytes(content[:stop])
        recording, sentence = tried(read, tmp_path / "cut.rrd")
        assert "\n" not in sentence
        assert recording is None or not recording.complete
        if recording is not None and "/state" in recording:
            assert np.array_equal(recording["/state"]["position_m"], position)


@pytest.mark.parametrize("verb", [read, digest, info, export, compare])
def test_every_verb_refuses_a_damaged_recording_in_one_sentence(verb, whole, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    content, path = whole
    (tmp_path / "damaged.rrd").write_bytes(flipped(content, 4 * len(content)))
    more = {export: ("a.csv",), compare: (path,)}.get(verb, ())
    with pytest.raises(RecordingError, match="damaged") as error:
        verb("damaged.rrd", *more)
    assert "\n" not in str(error.value)
    assert [file.name for file in tmp_path.iterdir()] == ["damaged.rrd"]


def test_a_recording_has_a_checksum_for_each_of_its_messages(any_run, runs, tmp_path):
    record(runs.in_blocks(any_run, 70), tmp_path / "run.rrd", tmp_path / "twin.rrd")
    for path in (tmp_path / "run.rrd", tmp_path / "twin.rrd"):
        frames = framing.framing(path)
        sums = checksums.sums_of(path, frames)
        content = path.read_bytes()
        parts = [content[message.start : message.stop] for message in frames.messages]
        parts[0] = content[: frames.messages[0].stop]
        assert sums.sums.tolist() == [zlib.crc32(part) for part in parts[:-1]]
        assert read(path).sealed


def test_the_entities_in_which_damage_lies_are_named(whole, tmp_path):
    """Wherever it lies: in the truth, the plots or the picture."""
    content, path = whole
    for chunk_of in ("/state", "/plots/", "/world/craft"):
        frames = framing.framing(path)
        names = [messages.named(path, frames, [message]) for message in frames.messages]
        place = next(place for place, name in enumerate(names) if name and name[0].startswith(chunk_of))
        message = frames.messages[place]
        (tmp_path / "damaged.rrd").write_bytes(flipped(content, 8 * (message.stop - 20)))
        with pytest.raises(DamagedError, match=f"{names[place][0]} does not have the checksum") as error:
            read(tmp_path / "damaged.rrd")
        assert error.value.entities == tuple(names[place])
        found = verify(tmp_path / "damaged.rrd")
        assert (found["checksums"], found["damaged"]) == ("damaged", names[place])


def test_the_names_of_messages_are_those_that_rerun_reads(whole):
    _, path = whole
    frames = framing.framing(path)
    named = set(messages.named(path, frames, list(frames.messages)))
    assert set(read(path).entities) <= named


def test_a_recording_in_memory_has_the_checksums_of_a_file(run):
    memory = Memory()
    record(run, memory)
    assert read(memory).sealed


def rewritten(path):
    """The recording as Rerun's own tool puts it together anew: other bytes, the same contents."""
    out = path.with_name(f"rewritten-{path.name}")
    subprocess.run([viewer_binary(), "rrd", "optimize", path, "-o", out], check=True, capture_output=True)
    return out


def test_a_recording_that_another_program_rewrote_says_that_its_checksums_are_of_another_file(run, tmp_path):
    record(run, tmp_path / "run.rrd")
    recording = read(rewritten(tmp_path / "run.rrd"))
    assert not recording.sealed
    assert info(recording)["checksums"] == "none"
    assert compare(recording, tmp_path / "run.rrd").equal


def test_checksums_do_not_change_the_digest(run, tmp_path, monkeypatch):
    record(run, tmp_path / "with.rrd")
    monkeypatch.setattr(rr, "RecordingStream", without_sums(rr.RecordingStream))
    monkeypatch.setattr("sailviz.recording.growing.check_whole", lambda *_, **how: None)
    record(run, tmp_path / "without.rrd")
    assert verify(tmp_path / "with.rrd")["checksums"] == "hold"
    assert verify(tmp_path / "without.rrd")["checksums"] == "none"
    assert digest(tmp_path / "with.rrd") == digest(tmp_path / "without.rrd")
    assert compare(tmp_path / "with.rrd", tmp_path / "without.rrd").equal


def without_sums(stream):
    """A stream as it was before there were checksums."""

    class Older(stream):
        def log(self, path, *what, **how):
            if path != checksums.ENTITY:
                super().log(path, *what, **how)

    return Older


def test_damage_to_a_recording_without_checksums_does_not_end_this_process(tmp_path):
    """One of these bits ends the process that hands the file to Rerun."""
    stream = rr.RecordingStream("somebody_else", recording_id="x", send_properties=False)
    stream.save(str(tmp_path / "other.rrd"))
    stream.send_columns("a/b", [rr.TimeColumn("frame", sequence=range(5))], rr.Scalars.columns(scalars=np.arange(5.0)))
    stream.disconnect()
    content = (tmp_path / "other.rrd").read_bytes()
    chance, sentences = random.Random(1), []
    for _ in range(4):
        (tmp_path / "damaged.rrd").write_bytes(flipped(content, chance.randrange(8 * 200, 4 * len(content))))
        sentences.append(tried(digest, tmp_path / "damaged.rrd")[1])
    assert any(sentences)
    assert not any("\n" in sentence for sentence in sentences)


def test_a_damaged_table_of_arrays_is_told_in_one_sentence_or_is_the_same(whole, tmp_path, harmed):
    export(whole[1], tmp_path / "whole.npz")
    content, chance, told = (tmp_path / "whole.npz").read_bytes(), random.Random(5), []
    for _ in range(60):
        (tmp_path / "damaged.npz").write_bytes(harmed(content, chance))
        found, sentence = tried(lambda path: compare(path, tmp_path / "whole.npz"), tmp_path / "damaged.npz")
        assert found is None or found.equal
        told += [sentence] if sentence else []
    assert len(told) > 30
    assert all(str(tmp_path / "damaged.npz") in sentence and "\n" not in sentence for sentence in told)


def test_a_harmed_recording_is_told_in_one_sentence_or_read_as_far_as_it_is_whole(whole, tmp_path, harmed):
    """Blocks swapped, emptied or cut out, bytes too many: with checksums, what is complete has the same contents."""
    content, path = whole
    chance, same, probed = random.Random(9), digest(path), 0
    for _ in range(40):
        (tmp_path / "damaged.rrd").write_bytes(changed := harmed(content, chance))
        if content.startswith(changed):
            continue  # cut off, which has a test of its own
        found, sentence = tried(read, tmp_path / "damaged.rrd")
        assert "\n" not in sentence
        assert found is None or not found.complete or digest(found) == same
        probed += found is not None and not found.sealed
    assert probed < 10  # those cost a process each
