"""Between rows far apart the trail goes where the craft went: against flights integrated by SciPy's DOP853."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sailviz.constants import AU, DAY, MU_SUN
from sailviz.recording.drawing.samples import Frame, Samples
from sailviz.recording.drawing.ways import ways_of
from sailviz.run.from_arrays import trajectory

YEAR = 365.25 * DAY


def flown(days, rows, start, push=0.0):
    """A run of some rows, and the places (k, 3) m at any times; push along (radial, transverse), over r^-2 at 1 au."""

    def fall(_, y):
        r = np.linalg.norm(y[:3])
        out = y[:3] / r
        ahead = np.cross(np.cross(y[:3], y[3:]), out)
        ahead /= np.linalg.norm(ahead)
        return np.concatenate([y[3:], -MU_SUN * out / r**2 + push * (AU / r) ** 2 * (0.8 * out + 0.6 * ahead)])

    time = np.linspace(0, days * DAY, rows)
    found = solve_ivp(fall, time[[0, -1]], start, "DOP853", rtol=1e-12, atol=1.0, dense_output=True)
    y = found.sol(time).T
    thrust = np.array([fall(0, row)[3:] + MU_SUN * row[:3] / np.linalg.norm(row[:3]) ** 3 for row in y])
    return trajectory(time, y[:, :3], y[:, 3:], thrust=thrust), lambda t: found.sol(t)[:3].T


def ways_in(run, breaks=()):
    frame = Frame.of(run)
    assert not frame.sparse
    return ways_of(Samples.of(run, np.arange(len(run)), frame), frame, np.array(breaks, int))


def worst(run, ways, truth):
    """Largest miss in au over all ways, and that of the chords."""
    off, chord = [], []
    for k, (line, share) in ways.lines.items():
        t = run.time[k] + share * (run.time[k + 1] - run.time[k])
        off.append(np.linalg.norm(line - truth(t) / AU, axis=1).max())
        straight = run.position[k] + share[:, None] * (run.position[k + 1] - run.position[k])
        chord.append(np.linalg.norm(straight - truth(t), axis=1).max() / AU)
    return max(off), max(chord)


@pytest.mark.parametrize("speed", [22e3, 30e3, 36e3, 44e3, 50e3], ids=lambda v: f"{v:.0f}")
def test_without_thrust_it_is_the_conic_itself(speed):
    run, truth = flown(700, 7, [AU, 0, 0, 1e3, speed, 4e3])
    ways = ways_in(run)
    assert len(ways.lines) >= 1
    off, chord = worst(run, ways, truth)
    assert off < 1e-7
    assert chord > 0.05
    assert ways.bent == 0
    assert not ways.open


def test_a_push_of_two_per_cent_of_gravity_is_followed_to_a_thousandth_of_the_distance():
    run, truth = flown(500, 9, [AU, 0, 0, 0, 29.8e3, 0], push=1.2e-4)
    ways = ways_in(run)
    assert len(ways.lines) == ways.bent == 8
    off, chord = worst(run, ways, truth)
    assert off < 1e-3
    assert chord > 0.05


def test_pieces_of_a_way_turn_by_five_degrees_at_most_also_past_a_near_periapsis():
    run, _ = flown(160, 4, [AU, 0, 0, 0, 7e3, 0])
    for line, _ in ways_in(run).lines.values():
        out = line / np.linalg.norm(line, axis=1, keepdims=True)
        turned = np.degrees(np.arccos(np.clip(np.sum(out[1:] * out[:-1], axis=1), -1, 1)))
        assert turned.max() < 8


def test_over_a_gap_there_is_no_way_and_where_nothing_leads_on_the_next_orbit_is_drawn():
    run, _ = flown(700, 7, [AU, 0, 0, 0, 30e3, 0])
    assert 2 not in ways_in(run, breaks=[2]).lines
    leap = trajectory(run.time, run.position * np.where(np.arange(7) > 3, -1, 1)[:, None], run.velocity)
    ways = ways_in(leap)
    assert 3 in ways.open
    assert 3 not in ways.lines


def test_few_rows_of_few_turns_stand_in_their_own_places_and_say_so(tmp_path):
    from sailviz.recording import record

    run, _ = flown(4 * 365.25, 17, [AU, 0, 0, 0, 33e3, 2e3])
    told = record(run, tmp_path / "few.rrd").remarks
    assert np.array_equal(Samples.of(run, np.arange(17), Frame.of(run)).position, run.position / AU)
    (words,) = told
    turns = 4 * YEAR / (2 * np.pi * np.sqrt(run.elements.semi_major_axis[0] ** 3 / MU_SUN))
    assert words.startswith(f"{16 / turns:.1f} rows in a revolution: between them the trail follows gravity")
    dense, _ = flown(365.25, 200, [AU, 0, 0, 0, 30e3, 0])
    assert record(dense, tmp_path / "dense.rrd").remarks == ()
