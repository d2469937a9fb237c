"""Anybody's arrays, drawn as they are, or refused with everything that is wrong with them."""

import runpy
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

import sailviz
from sailviz.constants import AU, MU_EARTH, MU_SUN, RADIUS_EARTH
from sailviz.elements import state
from sailviz.recording.drawing.devices import CRAFT
from sailviz.recording.writer import record_trajectory
from sailviz.run.arrays import Event, Reference
from sailviz.run.devices import LABELS
from sailviz.run.from_arrays import TrajectoryError, trajectory
from sailviz.scene.units_in_keys import words_of_kind
from sailviz.simulation.device import DEVICES

SCRIPT = Path(__file__).parents[2] / "scenes" / "scripts" / "from_oem.py"
ROWS = 50


def ellipse(mu=MU_SUN, a=AU, e=0.2, rows=ROWS):
    """time, position, velocity over a bit less than one turn of a Kepler orbit, by its true anomaly."""
    nu = np.linspace(0, 6, rows)
    half = np.arctan2(np.sqrt(1 - e) * np.sin(nu / 2), np.sqrt(1 + e) * np.cos(nu / 2))
    time = (2 * half - e * np.sin(2 * half)) * np.sqrt(a**3 / mu)
    return time, *state(a, e, 0.3, 0.4, 0.5, nu, mu)


def test_a_ballistic_flight_has_the_elements_it_was_made_of():
    run = trajectory(*ellipse())
    assert np.allclose(run.elements.semi_major_axis, AU, rtol=1e-12)
    assert np.allclose(run.elements.eccentricity, 0.2, atol=1e-12)
    assert np.allclose(run.elements.inclination, 0.3, atol=1e-12)
    assert not run.thrust.on.any()
    assert run.setting.craft.kind == "none"
    assert run.setting.body.name == "Sun"


@pytest.mark.parametrize("sink", ["a.rrd", "b.rrd"])
def test_it_is_recorded_bit_for_bit_with_the_same_views(sink, tmp_path):
    time, position, velocity = ellipse()
    thrust = 1e-4 * position / AU
    recorded = record_trajectory(
        time,
        position,
        velocity,
        tmp_path / sink,
        thrust=thrust,
        epoch="2031-04-01T12:00Z",
        events=[("half", time[25] + 5)],
    )
    back = sailviz.read(tmp_path / sink)
    assert recorded.rows == ROWS
    assert back.complete
    assert np.array_equal(back["/state"]["position_m"], position)
    assert np.array_equal(back["/state"]["time_s"], time)
    assert np.array_equal(back["/thrust"]["acceleration_m_s2"], thrust)
    assert str(back["/state"].timeline("utc")[0])[:16] == "2031-04-01T12:00"
    assert [event.name for event in back.events] == ["half"]
    assert "/world/planets/Earth/body" in back.entities
    assert "Flight" in sailviz.recording.info(back)["views"]


def test_the_same_arrays_have_the_same_identity_and_others_another():
    time, position, velocity = ellipse()
    one = trajectory(time, position, velocity).setting.identity
    assert trajectory(time, position, velocity).setting.identity == one
    position[3, 1] = np.nextafter(position[3, 1], 0)
    assert trajectory(time, position, velocity).setting.identity != one


def test_thrust_gives_pitch_and_a_normal_gives_a_sail():
    time, position, velocity = ellipse()
    r_hat = position / np.linalg.norm(position, axis=1)[:, None]
    run = trajectory(time, position, velocity, thrust=1e-4 * r_hat)
    assert run.setting.craft.kind == "thruster"
    assert np.allclose(run.attitude.pitch, 0, atol=1e-12)
    assert np.allclose(run.thrust.acceleration_rtn, [1e-4, 0, 0], atol=1e-18)
    sail = trajectory(time, position, velocity, normal=2 * r_hat, thrust=1e-4 * r_hat, side=40.0, device="solar-sail")
    assert np.allclose(np.linalg.norm(sail.attitude.normal, axis=1), 1)
    assert sail.setting.craft.side == 40.0


def test_what_circles_the_earth_is_drawn_round_the_earth(tmp_path):
    time, position, velocity = ellipse(MU_EARTH, RADIUS_EARTH * 1.4, 0.1)
    epoch = datetime(2031, 4, 1, tzinfo=UTC)
    run = trajectory(
        time, position, velocity, mu=MU_EARTH, epoch=epoch, mass=np.linspace(5, 4, ROWS), device="plasma-brake"
    )
    assert run.setting.body.name == "Earth"
    assert set(run.bodies) == {"Sun"}
    assert sailviz.record(run, tmp_path / "leo.rrd").complete


def test_any_body_and_any_columns_are_drawn(tmp_path):
    time, position, velocity = ellipse(1.7e10, 600e3, 0.05)
    run = trajectory(
        time, position, velocity, mu=1.7e10, body="Vesta", radius=262e3, environment={"drag_N": np.ones(ROWS)},
        references={"rim": position[::5]}, events=[Event("seen", time[3], np.zeros(7))],
    )  # fmt: skip
    assert run.setting.body.name == "Vesta"
    assert sailviz.record(run, tmp_path / "vesta.rrd").complete
    assert np.array_equal(sailviz.read(tmp_path / "vesta.rrd")["/environment"]["drag_N"], np.ones(ROWS))


def test_an_event_gets_the_state_between_its_rows():
    time, position, velocity = ellipse(rows=400)
    (event,) = trajectory(time, position, velocity, events=[("x", float(time[200] + time[201]) / 2)]).events
    r = np.linalg.norm(event.state[:3])
    energy = event.state[3:6] @ event.state[3:6] / 2 - MU_SUN / r
    assert energy == pytest.approx(-MU_SUN / (2 * AU), rel=1e-7)


def test_a_trajectory_without_a_mass_has_none():
    run = trajectory(*ellipse(), events=[("half", 1e7)])
    assert np.isnan(run.mass).all()
    assert np.isnan(run.events[0].state[6])
    heavy = trajectory(*ellipse(), mass=5, events=[("half", 1e7)])
    assert (heavy.mass == 5).all()
    assert heavy.events[0].state[6] == 5


def test_every_fault_is_named_at_once_with_what_was_wanted():
    time, position, velocity = ellipse()
    position[3, 1] = np.nan
    with pytest.raises(ValueError, match="7 faults") as error:
        trajectory(
            time, position, velocity.T, thrust=np.zeros((4, 3)), mass=-1, mu=0, epoch="soon", device="kite",
        )  # fmt: skip
    text = str(error.value)
    for word in (
        "position: row 3 is not a number (nan)",
        "velocity: shape (3, 50), wanted (50, 3): transpose it",
        "thrust: shape (4, 3), wanted (50, 3)",
        "mass: must be positive",
        "mu: must be a positive number",
        "epoch: 'soon' is no date",
        "device: 'kite' is not one of solar-sail",
    ):
        assert word in text


@pytest.mark.parametrize(
    ("change", "word"),
    [
        (lambda a: {"time": a["time"][:, None]}, r"time: shape \(50, 1\), wanted \(n,\)"),
        (lambda a: {"time": a["time"][::-1]}, "time: goes back from row 0 "),
        (lambda a: {"time": a["time"] // 3e6}, r"time: does not increase from row 0 to row 1 \(both 0\)"),
        (lambda a: {"time": a["time"] + 1e10}, "beyond the 292 years"),
        (lambda a: {"epoch": "2262-01-01"}, "outside the years 1678 to 2262"),
        (lambda a: {"epoch": "2500-01-01"}, "epoch: '2500-01-01' lies outside the years 1678 to 2262"),
        (lambda a: {"epoch": 2031}, "epoch: 2031 is no date"),
        (lambda a: {"epoch": "now"}, "epoch: 'now' is no date"),
        (lambda a: {"time": np.ma.masked_array(a["time"], np.arange(50) == 5)}, "time: row 5 is masked"),
        (
            lambda a: {"position": np.ma.masked_invalid(np.where(np.eye(50, 3, -5) > 0, np.nan, a["position"]))},
            "position: row 5 is masked",
        ),
        (lambda a: {"velocity": a["velocity"] * (1 + 0j)}, "velocity: holds complex numbers"),
        (lambda a: {"time": []}, "time: has no values"),
        (lambda a: {"position": "here"}, "position: not an array of numbers"),
        (lambda a: {"position": a["position"] / 1e3}, "position looks like kilometres, wanted m"),
        (lambda a: {"velocity": a["velocity"] / 1e3}, "velocity looks like kilometres a second, wanted m/s"),
        (lambda a: {"position": a["position"] * (np.arange(50) != 4)[:, None]}, "row 4 is the centre of the Sun"),
        (
            lambda a: {"normal": a["position"] * (np.arange(50) != 4)[:, None], "device": "thruster"},
            "normal: row 4 is the zero vector",
        ),
        (lambda a: {"body": "Earth"}, "Earth does not go with mu"),
        (lambda a: {"radius": -1.0}, "radius"),
        (lambda a: {"mass": [1.0, 2.0]}, r"mass: shape \(2,\)"),
        (lambda a: {"mass": 0}, "mass: must be positive"),
        (lambda a: {"mass": np.nan}, r"mass: is not a number \(nan\)"),
        (lambda a: {"mass": np.inf}, r"mass: is not a number \(inf\)"),
        (lambda a: {"mass": np.where(np.arange(50) == 7, np.nan, 5.0)}, r"mass: row 7 is not a number \(nan\)"),
        (lambda a: {"mass": 1 + 2j}, "mass: holds complex numbers"),
        (lambda a: {"mass": np.full(50, 1 + 0j)}, "mass: holds complex numbers"),
        (lambda a: {"mass": True}, "mass: True is a truth value"),
        (lambda a: {"mass": "5"}, "mass: not an array of numbers"),
        (lambda a: {"mass": 10**400}, "mass: not an array of numbers"),
        (lambda a: {"events": [("late", 1e12)]}, "'late' at 1000000000000.0 s is outside the run"),
        (lambda a: {"environment": {"drag_N": [1.0]}}, r"environment\['drag_N'\]: shape \(1,\), wanted \(50,\)"),
        (lambda a: {"references": {"x": [1.0, 2.0]}}, r"references\['x'\]: shape \(2,\), wanted \(k, 3\)"),
    ],
)
def test_each_fault_names_its_argument(change, word):
    arguments = dict(zip(("time", "position", "velocity"), ellipse(), strict=True))
    with pytest.raises(TrajectoryError, match=word):
        trajectory(**{**arguments, **change(arguments)})


@pytest.mark.parametrize("unit", ["ns", "us", "ms", "s", "m"])
def test_spans_of_any_unit_are_the_same_flight(unit):
    time, position, velocity = ellipse(rows=400)
    given = np.round(time * (np.timedelta64(1, "s") / np.timedelta64(1, unit))).astype(np.int64).astype(f"m8[{unit}]")
    run = trajectory(given, position, velocity)
    assert np.abs(run.time - time).max() < 31 if unit == "m" else 1  # s: the rounding to whole units


def test_dates_as_times_bring_their_epoch_along():
    time, position, velocity = ellipse()
    stamps = np.datetime64("2031-04-01T12:00", "ns") + np.round(time * 1e9).astype("m8[ns]")
    run = trajectory(stamps, position, velocity)
    assert run.setting.epoch == np.datetime64("2031-04-01T12:00")
    assert np.abs(run.time - time).max() < 1e-8


def test_a_jump_of_the_velocity_keeps_both_rows_and_is_an_event(tmp_path):
    time, position, velocity = ellipse()
    again = np.sort(np.append(np.arange(ROWS), 20))
    kicked = velocity.copy()
    kicked[20:] *= 1.0001
    both = np.insert(kicked[np.delete(again, 20)], 20, velocity[20], axis=0)
    run = trajectory(time[again], position[again], both)
    assert len(run) == ROWS + 1
    (event,) = run.events
    assert event.name == "velocity jumps"
    assert event.time == time[20]
    assert np.array_equal(event.state[3:6], kicked[20])
    assert sailviz.record(run, tmp_path / "jump.rrd").complete
    assert len(sailviz.read(tmp_path / "jump.rrd")["/state"]["time_s"]) == ROWS + 1


FACTORS = {"ms": 1e-3, "minutes": 60.0, "hours": 3600.0, "days": 86400.0}


@pytest.mark.parametrize("unit", FACTORS)
@pytest.mark.parametrize("rows", [7, 50, 1000])
def test_a_time_in_another_unit_is_named(unit, rows):
    time, position, velocity = ellipse(rows=rows)
    with pytest.raises(TrajectoryError, match=f"time looks like {unit}, wanted s"):
        trajectory(time / FACTORS[unit], position, velocity)


@pytest.mark.parametrize(
    ("place", "speed", "words"),
    [
        (1e3, 1.0, "position looks like kilometres, wanted m"),
        (AU, 1.0, "position looks like au, wanted m"),
        (1.0, 1e3, "velocity looks like kilometres a second, wanted m/s"),
        (1.0, 1 / 86400, "velocity looks like metres a day"),
        (1.0, 1 / 3.6, "velocity looks like kilometres an hour"),
        (1e3, 1e3, "position looks like kilometres and velocity like km/s"),
        (AU, AU / 86400, "position looks like au and velocity like au/day"),
    ],
)
@pytest.mark.parametrize(("mu", "a", "e"), [(MU_SUN, AU, 0.02), (MU_EARTH, 8e6, 0.1), (MU_EARTH, 4e7, 0.8)])
def test_places_and_speeds_in_other_units_are_named(place, speed, words, mu, a, e):
    time, position, velocity = ellipse(mu, a, e)
    with pytest.raises(TrajectoryError, match=words):
        trajectory(time, position / place, velocity / speed, mu=mu)


@pytest.mark.parametrize("e", [0.0, 0.5, 0.95])
@pytest.mark.parametrize("rows", [4, 20, 400])
def test_honest_rows_of_any_conic_pass_the_guard_of_units(e, rows):
    assert trajectory(*ellipse(e=e, rows=rows)).setting.accuracy == "Given as arrays; nothing was propagated."


def test_thrust_as_large_as_gravity_passes_and_is_called_strange_where_it_is_not_given():
    time = np.linspace(0, 3e7, 60)
    position = np.column_stack([AU + 0 * time, 2e4 * (time - 1.5e7), 0 * time])  # straight on: thrust cancels gravity
    velocity = np.tile([0.0, 2e4, 0.0], (60, 1))
    assert "The rows change speed as if mu were 0 m3/s2" in trajectory(time, position, velocity).setting.accuracy
    push = MU_SUN * position / np.linalg.norm(position, axis=1)[:, None] ** 3
    assert "as if mu" not in trajectory(time, position, velocity, thrust=push).setting.accuracy


def test_the_arrays_stay_the_callers_own():
    time, position, velocity = ellipse()
    run = trajectory(time, position, velocity)
    position[0] = 0
    assert run.position[0].any()


def test_the_example_reads_its_message_and_records_it(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [str(SCRIPT)])
    runpy.run_path(str(SCRIPT))
    assert "recorded displaced.rrd" in capsys.readouterr().out
    position = sailviz.read("displaced.rrd")["/state"]["position_m"]
    elevation = np.degrees(np.arcsin(position[:, 2] / np.linalg.norm(position, axis=1)))
    assert np.allclose(elevation, 10, atol=1e-6)


def test_the_example_refuses_a_body_it_does_not_know(tmp_path):
    text = SCRIPT.with_name("displaced.oem").read_text().replace("= SUN", "= CERES")
    (tmp_path / "a.oem").write_text(text)
    done = subprocess.run([sys.executable, SCRIPT, tmp_path / "a.oem"], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 2
    assert "no gravitational parameter for Ceres" in done.stderr


def test_an_environment_may_hold_truth_values_and_vectors(tmp_path):
    time, position, velocity = ellipse(MU_EARTH, RADIUS_EARTH * 1.4, 0.1)
    lit = np.arange(ROWS) % 2 == 0
    field = np.arange(3.0 * ROWS).reshape(ROWS, 3)
    sailviz.record_trajectory(
        time, position, velocity, mu=3.986004418e14, environment={"sunlit": lit, "field_T": field},
        sink=tmp_path / "lit.rrd",
    )  # fmt: skip
    read = sailviz.read(tmp_path / "lit.rrd")["/environment"]
    assert read["sunlit"].dtype == bool
    assert np.array_equal(read["sunlit"], lit)
    assert np.array_equal(read["field_T"], field)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"mass": np.nan}, "mass: is not a number"),
        ({"mass": [1.0] * 49 + [np.inf]}, "mass: row 49 is not a number"),
        ({"mass": 1 + 0j}, "mass: holds complex numbers"),
        ({"mass": "heavy"}, "mass: not an array of numbers"),
        ({"thrust": np.ones((ROWS, 3), complex)}, "thrust: holds complex numbers"),
        ({"normal": [[1, 0], [1, 0, 0]]}, "normal: not an array of numbers"),
        ({"environment": [1, 2]}, "environment: wanted a mapping"),
        ({"environment": {3: np.ones(ROWS)}}, "environment: a column's name is text, not 3"),
        ({"environment": {"air_K": np.ones(ROWS, complex)}}, "holds complex numbers"),
        ({"environment": {"air_K": {}}}, "environment['air_K']"),
        ({"environment": {"air_K": ["warm"] * ROWS}}, "not an array of numbers"),
        ({"events": 5}, "events: wanted pairs"),
        ({"events": "half"}, "events: wanted pairs"),
        ({"events": [("half",)]}, "events: number 0"),
        ({"events": [(1.0, "half")]}, "events: number 0"),
        ({"events": [("half", "noon")]}, "is at a time in s"),
        ({"events": [("half", np.nan)]}, "outside the run"),
        ({"events": [("half", 1j)]}, "is at a time in s"),
        ({"events": [("half", True)]}, "is at a time in s"),
        ({"events": [Event("late", 1e12, np.zeros(7))]}, "outside the run"),
        ({"events": [Event("odd", 1.0, np.zeros(6))]}, "wanted (7,)"),
        ({"references": 5}, "references: wanted pairs"),
        ({"references": {"orbit": np.zeros((4, 2))}}, "wanted (k, 3)"),
        ({"references": [np.zeros((4, 3))]}, "references: number 0"),
        ({"references": {"orbit": np.full((4, 3), np.nan)}}, "row 0 is not a number"),
        ({"references": [Reference("orbit", "target", np.zeros(3))]}, "wanted (k, 3)"),
        ({"device": ["solar-sail"]}, "device: "),
        ({"device": ""}, "device: '' is not one of"),
        ({"mu": True}, "mu: must be a positive number"),
        ({"body": 3}, "body: must be a name"),
        ({"radius": np.nan}, "radius: must be"),
        ({"side": -1}, "side: must be"),
        ({"tethers": 2.5}, "tethers: must be a whole number"),
        ({"tether_length": np.inf}, "tether_length: must be"),
        ({"play_duration": 0}, "play_duration: must be"),
        ({"look_for": 3}, "look_for: wanted lines"),
    ],
)
def test_what_is_no_argument_is_refused_in_a_sentence(more, words):
    with pytest.raises(TrajectoryError) as caught:
        trajectory(*ellipse(), **more)
    (fault,) = caught.value.faults
    assert words in fault


def test_arguments_of_other_number_types_are_taken():
    run = trajectory(*ellipse(), mu=np.float32(MU_SUN), mass=np.int16(7), tethers=np.int64(8), look_for="one line")
    assert (run.mass == 7).all()
    assert run.setting.look_for == ("one line",)


def test_round_the_earth_an_epoch_turns_the_globe_once_a_sidereal_day(tmp_path):
    """On 2000-01-01 at noon Greenwich stands 280.46 deg from the equinox (IAU)."""
    turn = 86164.0905
    time = np.linspace(0, turn, 25)
    radius = (MU_EARTH * (turn / (2 * np.pi)) ** 2) ** (1 / 3)
    position, velocity = state(radius, 0.0, 0.0, 0.0, 0.0, 2 * np.pi * time / turn, MU_EARTH)
    run = trajectory(time, position, velocity, mu=MU_EARTH, epoch="2000-01-01T12:00:00")
    angle = run.environment["earth_rotation_rad"]
    assert np.degrees(angle[0]) == pytest.approx(280.46, abs=0.01)
    assert np.degrees(np.unwrap(angle)[-1] - angle[0]) == pytest.approx(360, abs=1e-3)
    record_trajectory(time, position, velocity, tmp_path / "a.rrd", mu=MU_EARTH, epoch="2000-01-01T12:00:00")
    assert "/world/center/globe" in sailviz.read(tmp_path / "a.rrd").entities
    assert "earth_rotation_rad" not in trajectory(time, position, velocity, mu=MU_EARTH).environment


def test_the_devices_of_arrays_are_those_of_scenes_and_those_that_are_drawn():
    assert set(LABELS) == set(CRAFT)
    assert {word: record.label for kind, record in DEVICES.items() for word in words_of_kind(kind)} == LABELS


def test_rows_without_data_are_left_out_and_leave_a_gap():
    time, position, velocity = ellipse()
    lost = slice(10, 14)
    holes = [array.copy() for array in (position, velocity)]
    for array in holes:
        array[lost] = np.nan
    normal = position / AU
    normal[lost] = np.nan
    run = trajectory(time, *holes, normal=normal, mass=np.linspace(5, 4, ROWS), environment={"warm": time > time[20]})
    assert len(run) == ROWS - 4
    assert run.setting.gaps == ((time[9], time[14]),)
    assert np.array_equal(run.position, np.delete(position, np.r_[lost], axis=0))
    assert run.mass[10] == np.linspace(5, 4, ROWS)[14]
    assert run.environment["warm"].sum() == ROWS - 21
    holes[0][30, 1] = np.nan
    with pytest.raises(TrajectoryError, match="position: row 30 is not a number"):
        trajectory(time, *holes)


def test_gaps_are_given_as_times_or_dates_and_those_that_overlap_are_one():
    time, position, velocity = ellipse()
    pairs = [(time[30], time[31]), (time[4] + 1, time[5]), (time[4], time[5] - 1)]
    assert trajectory(time, position, velocity, gaps=pairs).setting.gaps == ((time[4], time[5]), (time[30], time[31]))
    (gap,) = trajectory(
        time, position, velocity, epoch="2031-01-01", gaps=[("2031-01-01T00:10", "2031-01-01T05:00")]
    ).setting.gaps
    assert gap == (600.0, 18_000.0)


@pytest.mark.parametrize(
    ("pair", "words"),
    [
        (5, "is no pair of times"),
        ((1.0,), "is no pair of times"),
        (("2031-01-02", "2031-01-03"), "is no pair of times"),
        ((2e6, 1e6), "does not end after its start"),
        ((-5.0, 1e5), "is not within the run"),
        ((1e3, 2e6), "in it"),
    ],
)
def test_a_gap_that_is_none_is_refused_in_a_sentence(pair, words):
    with pytest.raises(TrajectoryError) as caught:
        trajectory(*ellipse(), gaps=[pair])
    (fault,) = caught.value.faults
    assert fault.startswith("gaps: number 0")
    assert words in fault


def test_an_event_within_a_gap_needs_a_state_of_its_own():
    time, position, velocity = ellipse()
    when = float(time[10] + time[11]) / 2
    with pytest.raises(TrajectoryError, match="lies where there is no data"):
        trajectory(time, position, velocity, gaps=[(time[10], time[11])], events=[("x", when)])
    known = Event("x", when, np.append(np.append(position[10], velocity[10]), 1.0))
    assert trajectory(time, position, velocity, gaps=[(time[10], time[11])], events=[known]).events == (known,)


def test_a_zero_normal_is_a_stowed_sail_without_angles_or_thrust():
    time, position, velocity = ellipse()
    normal, thrust = position / AU, 1e-4 * position / AU
    normal[5:9] = thrust[5:9] = 0.0
    run = trajectory(time, position, velocity, normal=normal, thrust=thrust)
    stowed = np.isin(np.arange(ROWS), range(5, 9))
    assert np.array_equal(run.environment["stowed"], stowed)
    assert np.array_equal(np.isnan(run.attitude.pitch), stowed)
    assert np.array_equal(run.attitude.normal.any(axis=1), ~stowed)
    assert np.allclose(np.linalg.norm(run.attitude.quaternion, axis=1), 1)
    assert "stowed" not in trajectory(time, position, velocity, normal=position).environment
    thrust[6] = [1e-5, 0, 0]
    with pytest.raises(TrajectoryError, match="row 6 has a push, but a sail without a normal there is stowed"):
        trajectory(time, position, velocity, normal=normal, thrust=thrust)
    with pytest.raises(TrajectoryError, match="normal: row 5 is the zero vector"):
        trajectory(time, position, velocity, normal=normal, device="thruster")


def test_a_gap_has_an_identity():
    time, position, velocity = ellipse()
    one, two = (trajectory(time, position, velocity, gaps=gaps) for gaps in ((), [(time[3], time[4])]))
    assert one.setting.identity != two.setting.identity
