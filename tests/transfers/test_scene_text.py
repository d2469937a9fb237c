"""The answer to a question, written as a scene, flies to the same end."""

from __future__ import annotations

import re
import tomllib

import numpy as np
import pytest

import sailviz
from sailviz import transfers
from sailviz.checks.expectations import check
from sailviz.constants import AU, DAY, MU_SUN
from sailviz.design.minimum_time import circle_to_circle
from sailviz.shipped import shipped_scenes


@pytest.fixture(scope="module")
def solutions():
    return {
        "circles": transfers.find("earth", "mars", "electric-sail", 1e-3),  # coasts on the way
        "film": transfers.find("earth", "venus", "jpl-2015", 1e-3),  # stands edge-on for a while
        "orbits": transfers.find("earth", transfers.circle(0.8 * AU, np.radians(3.0)), "ideal", 1e-3, starts=6),
        "rendezvous": transfers.find("earth", "venus", "ideal", 1e-3, departure="2029-07-22"),
    }


@pytest.mark.parametrize("name", ["circles", "film", "orbits", "rendezvous"])
@pytest.mark.parametrize(("form", "miss"), [("costates", 1e-8), ("table", 1e-5)])
def test_a_written_transfer_flies_to_the_same_end(solutions, name, form, miss):
    solution = solutions[name]
    assert solution.flight.feasible, solution.flight.reason
    scene = sailviz.load_scene(tomllib.loads(transfers.scene_of(solution, form)))
    run = sailviz.simulate(scene)
    position, velocity, switches = transfers.path_of(solution.flight)
    assert np.linalg.norm(run.position[-1] - position[-1]) < miss * np.linalg.norm(position[-1])
    assert np.linalg.norm(run.velocity[-1] - velocity[-1]) < miss * np.linalg.norm(velocity[-1])
    assert all(verdict.passed for verdict in check(scene, run))
    thrust = [event.time for event in run.events if event.name.startswith("thrust ")]
    assert thrust == pytest.approx(list(switches), abs=1e-3 * DAY)


def test_the_target_is_drawn_where_the_flight_ends(solutions):
    scene = sailviz.load_scene(tomllib.loads(transfers.scene_of(solutions["orbits"])))
    run = sailviz.simulate(scene)
    target = next(r.points for r in run.setting.references if r.role == "target")
    initial = next(r.points for r in run.setting.references if r.role == "initial")
    # 361 points of a circle lie 0.0044 of its radius from anything between them
    assert np.linalg.norm(target - run.position[-1], axis=1).min() < 0.01 * AU
    assert np.linalg.norm(initial - run.position[0], axis=1).min() < 0.01 * AU


def hamiltonian(scene):
    """H of a scene's own costates, by its definition: lam_r v + lam_v (a_gravity + a_thrust), canonical."""
    duration = scene.propagation.duration if scene.steering.arcs else 86.4  # arcs last as long as the flight
    run = sailviz.simulate(scene.with_values({"propagation": {"duration_s": duration, "outputs": 2}}))
    # three costates of a planar flight count in the distance of the start
    unit = np.linalg.norm(run.position[0]) if len(scene.steering.costates) == 3 else AU
    r, v = run.position[0] / unit, run.velocity[0] / np.sqrt(MU_SUN / unit)
    a = run.thrust.acceleration[0] / (MU_SUN / unit**2) - r / np.linalg.norm(r) ** 3
    lam = np.array(scene.steering.costates)
    if len(lam) == 3:
        assert r @ v == pytest.approx(0, abs=1e-12)
        up, along = r, np.array([-r[1], r[0], 0.0])
        # of angle none; radial speed u = 0, transverse speed w
        w = v @ along
        rates = np.array([0.0, a @ up + w * w, a @ along])
        return lam @ rates
    return lam[:3] @ v + lam[3:] @ a


def claimed(text):
    """The value of H that a scene's text states."""
    (value,) = re.findall(r"H = ([+-]?\d+(?:\.\d+)?)", text)
    return float(value), 0.51 * 10.0 ** -len(value.partition(".")[2])


OPTIMAL = [name for name, path in shipped_scenes().items() if "H = " in path.read_text()]


@pytest.mark.parametrize("name", OPTIMAL)
def test_a_shipped_flight_has_the_hamiltonian_that_it_states(name):
    value, rounding = claimed(shipped_scenes()[name].read_text())
    assert hamiltonian(sailviz.load_scene(name)) == pytest.approx(value, abs=max(1e-7, rounding * (value != 1)))


@pytest.mark.parametrize("name", ["circles", "orbits", "rendezvous"])
def test_a_written_flight_has_the_hamiltonian_that_it_states(solutions, name):
    text = transfers.scene_of(solutions[name])
    value, _ = claimed(text)
    assert (value == 1) == (name != "rendezvous")
    assert hamiltonian(sailviz.load_scene(tomllib.loads(text))) == pytest.approx(value, rel=1e-5)


def test_a_designed_result_can_be_written_without_words(solutions):
    text = transfers.scene_of(solutions["circles"].flight, title="x")
    scene = sailviz.load_scene(tomllib.loads(text))
    assert scene.target.radius == pytest.approx(1.52371034 * AU, rel=1e-7)


def test_a_flight_that_was_not_found_is_not_written():
    nothing = circle_to_circle(AU, AU, "ideal", 1e-3)
    with pytest.raises(ValueError, match="no flight to write down"):
        transfers.scene_of(nothing)


@pytest.mark.parametrize(("scene", "why"), [("ideal", "smooth"), ("jpl-2015", "switches the thrust")])
def test_a_film_that_turns_edge_on_at_once_is_no_smooth_flight(scene, why):
    """Real film stops to push at an angle at which it still would; steps that see eight places only miss that."""
    run = sailviz.simulate(sailviz.load_scene(f"transfers/earth-venus-{scene}", {"propagation.outputs": 20}))
    assert why in run.setting.accuracy
