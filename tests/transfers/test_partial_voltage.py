"""A flight with a singular arc as a scene: flown again from its costates and from a table, and told in words."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

from sailviz import load_scene, simulate, transfers
from sailviz.cli import transfer_in_words
from sailviz.constants import AU, DAY, MU_SUN
from sailviz.design.minimum_time.arc_structures import Structure, right
from sailviz.design.minimum_time.arc_transfer import FarSearch, transfer_by_arcs
from sailviz.design.minimum_time.boundary_conditions import PolarState, ToCircle
from sailviz.design.minimum_time.state_costate import TIME_UNIT, canonical_sail
from sailviz.errors import SceneError
from sailviz.transfers.search import Solution

RADIUS = 1.7  # au: thrust, coast, singular, thrust


@pytest.fixture(scope="module")
def solution():
    """The flight to 1.7 au at 1 mm/s2, from rounded costates and lengths."""
    flight = ToCircle(canonical_sail("electric-sail", 1e-3), PolarState(1.0, 0.0, 1.0), RADIUS)
    costates = np.array([12.13, 3.37, 13.19])
    lengths = np.array([191.7, 176.2, 30.1, 240.2]) * DAY / TIME_UNIT
    solved = right(flight, Structure("TCST", np.concatenate([costates / np.linalg.norm(costates), lengths])))
    found = transfer_by_arcs(flight, FarSearch((solved,), None, 1, 1), "electric-sail", 1e-3, AU)
    ends = (transfers.circle(radius * AU, name=name) for radius, name in ((1, "Earth"), (RADIUS, "far circle")))
    return Solution("circles", *ends, found)


def missed(run):
    r, v = run.position[-1], run.velocity[-1]
    d, circular = np.linalg.norm(r), np.sqrt(MU_SUN / (RADIUS * AU))
    return np.array([d / (RADIUS * AU) - 1, r @ v / d / circular, np.linalg.norm(np.cross(r, v)) / d / circular - 1])


def test_costates_and_arcs_of_a_scene_arrive_where_the_search_did(solution):
    run = simulate(load_scene(tomllib.loads(transfers.scene_of(solution))))
    assert np.abs(missed(run)).max() < 1e-8
    edges = [arc.start for arc in solution.flight.arcs[1:]]
    told = [(event.name, event.time) for event in run.events if event.name.startswith("thrust")]
    assert [name for name, _ in told] == ["thrust off", "thrust on"]
    assert [time for _, time in told] == pytest.approx(edges[:2], rel=1e-12)
    push = np.linalg.norm(run.thrust.acceleration, axis=1) * np.linalg.norm(run.position, axis=1) / AU / 1e-3
    arc = np.searchsorted(edges, run.time, side="right")
    assert np.all(push[arc == 1] == 0.0)
    low, high = solution.flight.throttle
    singular = push[arc == 2] / np.sqrt(0.5)  # of (3 r_hat + p_hat) / 4 at the switch
    assert singular.min() == pytest.approx(low, abs=2e-3)
    assert singular.max() == pytest.approx(high, abs=2e-3)


def test_a_table_with_a_column_of_throttle_arrives_too(solution):
    text = transfers.scene_of(solution, "table", outputs=20)
    scene = load_scene(tomllib.loads(text))
    between = [x for x in scene.steering.throttle if 0 < x < 1]
    low, high = solution.flight.throttle
    assert min(between) == pytest.approx(low, abs=1e-6)
    assert max(between) == pytest.approx(high, abs=1e-6)
    assert np.abs(missed(simulate(scene))).max() < 1e-6


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('kind = "singular"', 'kind = "singuler"'), ("steering.arcs[2].kind", "singular")),
        (("duration_d = 638", "duration_d = 700"), ("steering.arcs", "they have to last as long")),
        (
            ('kind = "electric-sail"\nmodel = "final"', 'kind = "solar-sail"\nfilm = "ideal"'),
            ("steering.arcs", "a film"),
        ),
    ],
)
def test_arcs_that_do_not_fit_are_told(solution, change, words):
    text = transfers.scene_of(solution)
    assert change[0] in text
    with pytest.raises(SceneError) as told:
        load_scene(tomllib.loads(text.replace(*change)))
    for word in words:
        assert word in str(told.value)


def test_the_answer_says_that_partial_voltage_is_used_and_for_how_long(solution):
    said = "\n".join(transfer_in_words.words(solution))
    assert "throttle 0.08-0.15 for 30 of 638 d" in said
    assert "no on/off flight attains it" in said
    assert "thrust 191.708 d, coast 176.232 d, singular 30.142 d, thrust 240.149 d" in said
    assert "gain little" not in said  # most of this one is not flown at partial voltage
