"""Flights recorded together: what is accepted, what is refused in one sentence, and how they are read back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import sailviz
from sailviz.errors import RecordingError
from sailviz.recording.companions import MOST, overlay_of
from sailviz.recording.drawing import style
from sailviz.recording.overlay import record_together
from sailviz.run.arrays import Body
from sailviz.run.from_arrays import trajectory

AU, DAY, MU = 149_597_870_700.0, 86_400.0, 1.327_124_400_18e20


def ring(radius=AU, days=300.0, count=40, **options):
    """A ballistic flight on a circle."""
    time = DAY * np.linspace(0, days, count)
    angle = np.sqrt(MU / radius**3) * time
    place = radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    pace = np.sqrt(MU / radius) * np.stack([-np.sin(angle), np.cos(angle), 0 * angle], 1)
    return trajectory(time, place, pace, **options)


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """A recording of two circles, the outer one shorter."""
    path = tmp_path_factory.mktemp("both") / "both.rrd"
    record_together({"inner one": ring(title="Inner"), "outer": ring(1.2 * AU, 200.0, 33, title="Outer")}, path)
    return path


def test_there_is_a_colour_for_every_flight_that_is_accepted():
    assert len(style.FLIGHTS) == MOST
    assert len({tuple(color) for color in style.FLIGHTS.values()}) == MOST
    overlay_of({f"flight {k}": ring() for k in range(MOST)})


def test_the_numbers_of_every_flight_are_read_back_bit_for_bit(both):
    runs = ring(title="Inner"), ring(1.2 * AU, 200.0, 33, title="Outer")
    recording = sailviz.read(both)
    for top, run in zip(("", "/flight/outer"), runs, strict=True):
        assert np.array_equal(recording[f"{top}/state"]["position_m"], run.position)
        assert np.array_equal(recording[f"{top}/state"]["time_s"], run.time)
        assert np.array_equal(recording[f"{top}/elements"]["semi_major_axis_m"], run.elements.semi_major_axis)
    assert [(f.name, f.title, f.rows) for f in recording.flights] == [
        ("inner one", "Inner", 40),
        ("outer", "Outer", 33),
    ]
    assert [f.identity for f in recording.flights] == [run.setting.identity for run in runs]
    assert recording.identity not in [run.setting.identity for run in runs]


def test_circles_are_as_far_apart_as_the_law_of_cosines_says(both):
    recording = sailviz.read(both)
    time = recording["/plots/apart/outer"].timeline("sim_time").astype(np.int64) / 1e9
    rates = [np.sqrt(MU / r**3) for r in (AU, 1.2 * AU)]
    off = np.sqrt(1 + 1.2**2 - 2.4 * np.cos((rates[1] - rates[0]) * time))
    told = recording["/plots/apart/outer"]["scalars"].ravel()
    flown = time <= 200 * DAY
    assert np.abs(told[flown] - off[flown]).max() < 2e-7  # au: Hermite's cubic over six days of a year
    assert np.isnan(told[~flown]).all()


def test_swapped_flights_differ_in_every_number(both, tmp_path):
    other = tmp_path / "swapped.rrd"
    record_together({"outer": ring(1.2 * AU, 200.0, 33, title="Outer"), "inner one": ring(title="Inner")}, other)
    assert not sailviz.compare(both, other).equal
    assert sailviz.compare(both, both).equal


def test_a_flight_that_moved_by_a_metre_is_told_by_its_name(both, tmp_path):
    other, run = tmp_path / "moved.rrd", ring(1.2 * AU, 200.0, 33, title="Outer")
    moved = replace(run, position=run.position + np.array([1000.0, 0.0, 0.0]))
    record_together({"inner one": ring(title="Inner"), "outer": moved}, other)
    found = sailviz.compare(both, other)
    assert [d.quantity for d in found.quantities if not d.equal] == ["/flight/outer/state:position_m"]


def test_the_same_flights_give_the_same_digest(both, tmp_path):
    again = tmp_path / "again.rrd"
    record_together({"inner one": ring(title="Inner"), "outer": ring(1.2 * AU, 200.0, 33, title="Outer")}, again)
    from sailviz.recording import digest

    assert digest(both) == digest(again)


def test_a_moment_of_a_picture_lies_between_the_first_and_the_last_row_of_all_flights(tmp_path):
    from sailviz.recording.views.instant import fraction_of

    path = tmp_path / "dated.rrd"
    record_together({"a": ring(epoch="2031-03-01"), "b": ring(1.1 * AU, epoch="2031-01-30", days=500)}, path)
    assert fraction_of(path, "0d") == pytest.approx(30 / 500)
    assert fraction_of(path, "400d") == pytest.approx(430 / 500)


def test_info_names_the_flights(both):
    from sailviz.recording import info
    from sailviz.recording.views.info import in_words

    facts = info(both)
    assert [flight["name"] for flight in facts["flights"]] == ["inner one", "outer"]
    assert "/flight/outer/state" in facts["truth"]
    assert not any(name.startswith("/flight/") for name in facts["picture"])
    assert "flight        outer: Outer, 33 rows" in in_words(facts)


def test_tables_of_each_flight_go_into_a_file_of_its_own(both, tmp_path):
    import pyarrow.parquet

    written = sailviz.export(both, tmp_path / "both.parquet")
    assert {path.name for path in written} == {"both.parquet", "both.flight.outer.parquet"}
    table = pyarrow.parquet.read_table(tmp_path / "both.flight.outer.parquet")
    assert table.num_rows == 33
    assert "state.position_m.x" in table.column_names
    (archive,) = sailviz.export(both, tmp_path / "both.npz")
    assert sailviz.compare(both, archive).equal
    with pytest.raises(RecordingError, match="holds 2 flights, and an OEM one"):
        sailviz.export(ring_of_dates(tmp_path), tmp_path / "both.oem")


def ring_of_dates(folder):
    path = folder / "dated.rrd"
    record_together({"a": ring(epoch="2031-01-01"), "b": ring(1.1 * AU, epoch="2031-02-01")}, path)
    return path


def test_flights_with_dates_stand_at_the_same_date(tmp_path):
    recording = sailviz.read(ring_of_dates(tmp_path))
    assert [flight.start for flight in recording.flights] == [0.0, 31 * DAY]
    assert str(recording["/flight/b/state"].timeline("utc")[0])[:10] == "2031-02-01"
    assert recording["/flight/b/state"]["time_s"][0] == 0.0


@pytest.mark.parametrize("epochs", [("2031-01-01", None), (None, "2031-01-01"), ("2031-01-01", "2051-01-01")])
def test_flights_that_share_no_dates_stand_at_the_same_time_since_their_starts(epochs):
    overlay = overlay_of({f"flight {k}": ring(epoch=epoch) for k, epoch in enumerate(epochs)})
    assert not overlay.by_date
    assert overlay.setting.epoch is None
    assert [companion.start for companion in overlay.companions] == [0.0]


def test_every_fault_of_the_names_is_told_at_once(tmp_path):
    names = ["", "*bold*", "a b", "a_b", "x" * 25, " lead"]
    with pytest.raises(RecordingError) as caught:
        record_together({name: ring() for name in names}, tmp_path / "never.rrd")
    text = str(caught.value)
    for part in (
        "a name is empty",
        "'*bold*' has to be",
        "a b and a_b are taken for one name",
        "has 25 letters",
        "' lead'",
    ):
        assert part in text
    assert not list(tmp_path.iterdir())


def test_one_flight_and_too_many_are_refused(tmp_path):
    with pytest.raises(RecordingError, match="two are needed at least, and there is one"):
        record_together({"alone": ring()}, tmp_path / "never.rrd")
    with pytest.raises(RecordingError, match=f"there are {MOST} colours for flights, and {MOST + 1} flights"):
        record_together({f"flight {k}": ring() for k in range(MOST + 1)}, tmp_path / "never.rrd")
    assert not list(tmp_path.iterdir())


def test_flights_of_other_families_or_round_other_bodies_are_refused_by_name(tmp_path):
    pair = {"here": ring(), "there": ring(family="wind")}
    with pytest.raises(RecordingError, match="here trajectories about the Sun, there wind about the Sun"):
        record_together(pair, tmp_path / "never.rrd")
    run = ring()
    heavy = replace(run, setting=replace(run.setting, body=Body("Sun", 2 * MU, 0.0)))
    with pytest.raises(RecordingError, match="the Sun of heavy pulls with"):
        record_together({"light": run, "heavy": heavy}, tmp_path / "never.rrd")
    assert not list(tmp_path.iterdir())


def test_an_ensemble_is_no_single_flight(tmp_path):
    run = ring()
    many = replace(run, setting=replace(run.setting, ensembles=("calm",)))
    with pytest.raises(RecordingError, match="many is an ensemble of flights"):
        overlay_of({"one": run, "many": many})


def test_record_takes_runs_by_name_and_scenes_among_them(tmp_path):
    path = tmp_path / "two.rrd"
    scene = sailviz.load_scene("spirals/logarithmic", {"propagation.outputs": 30, "expect": []})
    run = sailviz.simulate(scene)
    recorded = sailviz.record(runs={"flown": run, "to be flown": scene}, sink=path)
    assert recorded.paths == (path,)
    flown = sailviz.read(path)
    assert np.array_equal(flown["/state"]["position_m"], flown["/flight/to_be_flown/state"]["position_m"])
    sailviz.record(path, runs={"one": run, "two": scene})
    assert [flight.name for flight in sailviz.read(path).flights] == ["one", "two"]
    with pytest.raises(RecordingError, match="needs somewhere to go"):
        sailviz.record(runs={"one": run, "two": scene})
    with pytest.raises(TypeError, match="somewhere to put it"):
        sailviz.record(run)


def test_the_words_of_many_flights_leave_out_what_there_is_no_room_for(tmp_path):
    for count in (2, 5):
        path = tmp_path / f"{count}.rrd"
        record_together({f"flight {k}": ring((1 + 0.05 * k) * AU) for k in range(count)}, path)
        (text,) = sailviz.read(path)["/about"]["text"].ravel()
        assert ("at most" in str(text)) == (count == 2)
        assert len([line for line in str(text).splitlines() if line.startswith("- **")]) == count


def test_a_gap_of_the_first_flight_is_told_in_the_line_of_the_moment_and_ends_with_its_next_row(tmp_path):
    days = np.linspace(0, 300, 40)
    gap = (days[12] * DAY, days[13] * DAY)
    record_together({"broken": ring(gaps=[gap]), "whole": ring(1.1 * AU)}, tmp_path / "gap.rrd")
    lines = []
    for table in sailviz.read(tmp_path / "gap.rrd")["/now"].tables:
        times = np.array(table["sim_time"].cast("int64")) / 1e9
        lines += zip(times, (text[0] for text in table["TextDocument:text"].to_pylist()), strict=True)
    inside = [text for time, text in lines if gap[0] < time < gap[1]]
    assert len(inside) == 1
    assert f"broken without data until day {days[13]:.0f}" in inside[0]
    assert "whole" in next(text for time, text in sorted(lines) if time >= gap[1] - 1.0)


def test_flights_round_a_point_are_told_apart_in_its_own_unit(tmp_path):
    time = np.linspace(0, 1e5, 60)
    runs = {}
    for name, radius in (("near", 2000.0), ("far", 2600.0)):
        angle = np.sqrt(5.0 / radius**3) * time
        place = radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
        pace = np.sqrt(5.0 / radius) * np.stack([-np.sin(angle), np.cos(angle), 0 * angle], 1)
        runs[name] = trajectory(time, place, pace, mu=5.0, body="Bennu")
    record_together(runs, tmp_path / "point.rrd")
    text = str(sailviz.read(tmp_path / "point.rrd")["/now"]["text"].ravel()[0])
    assert "near 2.00 × 10^3 m from the centre" in text
    assert "far 0.60 × 10^3 m away" in text
