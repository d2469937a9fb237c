"""Ensembles of a craft that turns: single flights to the last bit, and spreads that closed forms know."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ellipk

from sailviz import load_scene, simulate
from sailviz.checks.expectations import Judge
from sailviz.constants import AU, MU_SUN
from sailviz.errors import SceneError, TimeLimitError
from sailviz.frames import rotation
from sailviz.simulation.turning_ensembles import statistic_of

W0 = 5.3265205716302e-4  # rad/s, sqrt(kappa/I) of body/tumble-or-not
ZERO = [{"key": "attitude.rates_deg_s.0", "distribution": "normal(0.01, 0)"}]


def wheeled(**more):
    """A body without device or gravity across it, which wheels stop."""
    return {
        "title": "Wheels stop a body",
        "start": {"kind": "circular", "radius_au": 1.0},
        "device": {"kind": "none", "mass_kg": 10.0},
        "steering": {"kind": "inertial", "direction": [0.0, 0.0, 1.0]},
        "attitude": {
            "kind": "controlled",
            "inertia_kg_m2": [3.0, 4.0, 5.0],
            "gravity_gradient": False,
            "rates_deg_s": [0.0, 0.0, 0.1],
            "control": {"kind": "pd", "frequency_rad_s": 0.02},
            "actuators": [{"kind": "wheels", "torque_N_m": 1.0, "storage_N_m_s": 1.0}],
        },
        "propagation": {"duration_h": 1.0, "outputs": 61, "tolerance": 1e-11},
        **more,
    }


def test_a_flight_that_draws_what_the_scene_says_is_the_scenes_own_to_the_last_bit():
    small = {"propagation.duration_h": 3, "propagation.outputs": 181, "expect": []}
    alone = simulate(load_scene("body/tumble-or-not", {**small, "ensemble": []}))
    found = simulate(load_scene("body/tumble-or-not", {**small, "ensemble": [dict(name="none", flights=2, draw=ZERO)]}))
    (many,) = found.setting.attitude_ensembles
    assert np.array_equal(found.position, alone.position)
    assert np.array_equal(many.kept_position[0], alone.position)
    assert np.array_equal(many.kept_axis[1], rotation(alone.attitude.quaternion)[..., 2])
    for name, values in many.percentiles.items():
        assert np.array_equal(values, np.tile(many.nominal[name], (len(values), 1))), name
    assert np.array_equal(many.nominal["pitch_rad"], alone.attitude.pitch)
    assert not many.deviation["body_rate_rad_s"].any()


def test_flights_tumble_when_and_only_when_a_pendulum_turns_over():
    """A flat film with its mass ahead is a pendulum, I a'' = -kappa sin a cos a: from a = 0 it turns over above
    w0 = sqrt(kappa/I), and stands at 90 deg after K(w0^2/w^2)/w."""
    scene = load_scene("body/tumble-or-not")
    first = scene.raw["ensemble"][0] | {"flights": 40}
    run = simulate(scene.with_values({"ensemble": [first], "expect": []}))
    (many,) = run.setting.attitude_ensembles
    rate = np.radians(np.hypot(many.drawn["attitude.rates_deg_s.0"], many.drawn["attitude.rates_deg_s.1"]))
    clear = np.abs(rate / W0 - 1) > 0.03  # the light's line turns by half a degree meanwhile
    over = ~np.isnan(many.met["tumbling"])
    assert clear.sum() >= 30
    assert 5 < over.sum() < 30
    assert np.array_equal(over[clear], (rate > W0)[clear])
    sure = clear & over
    after = ellipk((W0 / rate[sure]) ** 2) / rate[sure]
    assert np.abs(many.met["tumbling"][sure] / after - 1).max() < 0.01
    assert many.share("tumbling")[-1] == over.mean()


def test_wheels_hold_in_the_end_what_the_body_began_with_whatever_the_level():
    """h = I w about one axis: percentiles of the wheels' momentum are those of the drawn rates."""
    draw = [{"key": "attitude.rates_deg_s.2", "distribution": "normal(0, 0.1)"}]
    expect = [
        dict(quantity="wheel_momentum_mN_m_s", ensemble="e", statistic=s, at="end", value=0, within=1e9, **more)
        for s, more in (("percentile", {"percent": 99.0}), ("mean", {}), ("deviation", {}), ("miss", {}))
    ]
    scene = load_scene(wheeled(ensemble=[dict(name="e", flights=12, seed=3, draw=draw)], expect=expect))
    judge, run = Judge(scene), simulate(scene)
    judge.add(run)
    orbit = np.sqrt(MU_SUN / AU**3)  # rad/s, with which the axes that it is held to go round
    held = 5e3 * np.abs(np.radians(run.setting.attitude_ensembles[0].drawn["attitude.rates_deg_s.2"]) - orbit)
    own = 5e3 * (np.radians(0.1) - orbit)
    wanted = [np.percentile(held, 99), held.mean(), held.std(ddof=1), held.mean() - own]
    np.testing.assert_allclose([verdict.measured for verdict in judge.verdicts()], wanted, rtol=0, atol=1e-6)


def test_draws_depend_on_seed_key_and_number_alone():
    one = {"key": "attitude.rates_deg_s.2", "distribution": "normal(0, 0.1)"}
    other = {"key": "attitude.inertia_kg_m2.0", "distribution": "uniform(3, 3.5)"}
    given = [(3, [one], 1), (5, [other, one], 1), (3, [one], 2)]
    found = []
    for flights, draw, seed in given:
        ensemble = [dict(name="e", flights=flights, seed=seed, draw=draw)]
        run = simulate(load_scene(wheeled(ensemble=ensemble, propagation={"duration_min": 1.0, "outputs": 3})))
        found.append(run.setting.attitude_ensembles[0].drawn["attitude.rates_deg_s.2"][:3])
    assert np.array_equal(found[0], found[1])
    assert not np.any(found[0] == found[2])


def test_each_flight_of_a_sail_has_sunshine_of_its_own():
    shines = {"kind": "cycle", "seed": 4, "flicker": 0.05}
    values = {"environment.irradiance": shines, "propagation.duration_d": 3, "propagation.outputs": 13, "expect": []}
    several = [dict(name="light", flights=3)]
    run = simulate(load_scene("body/tumble-or-not", {**values, "ensemble": several}))
    (many,) = run.setting.attitude_ensembles
    assert many.seed == 4
    assert len(np.unique(many.drawn["environment.irradiance.seed"])) == 3
    assert np.ptp(many.kept_position[:, -1, 0]) > 1.0  # m


def test_moments_of_a_flight():
    time, values = np.array([0.0, 1.0, 3.0]), np.array([2.0, 4.0, 0.0])
    ways = {at: statistic_of(values, time, at) for at in ("start", "end", "min", "max", "mean")}
    assert ways == {"start": 2.0, "end": 0.0, "min": 0.0, "max": 4.0, "mean": pytest.approx(7 / 3)}
    assert np.isnan(statistic_of(np.full(3, np.nan), time, "max"))


REFUSED = (
    ([dict(name="e")], "nothing differs between its flights"),
    ([dict(name="e", draw=[dict(key="propagation.duration_h", distribution="normal(1, 1)")])], "drawn are keys below"),
    ([dict(name="e", draw=[dict(key="attitude.rates_deg_s.2", distribution="norml(1, 1)")])], "normal"),
    ([dict(name="e", draw=[dict(key="attitude.rates_deg_s.7", distribution="normal(1, 1)")])], "no such place"),
    ([dict(name="e", draw=[dict(key="attitude.rols_deg", distribution="normal(1, 1)")])], "unknown key"),
    ([dict(name="e", flights=20_000, draw=ZERO)], "10,000 times at most"),
    ([dict(name="e", draw=ZERO, control="none")], "no control but attitude.control"),
    ([dict(name="e", draw=[*ZERO, *ZERO])], "drawn already"),
)


@pytest.mark.parametrize(("ensemble", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_what_cannot_be_drawn_is_refused_with_its_place(ensemble, words):
    with pytest.raises(SceneError) as caught:
        load_scene(wheeled(ensemble=ensemble))
    (fault,) = caught.value.faults
    assert words in f"{fault.what} {fault.hint}"
    assert fault.where.startswith("ensemble[0]")


def test_what_is_asked_of_flights_that_is_not_known_is_refused():
    ensemble = [dict(name="e", flights=2, draw=ZERO)]
    asked = [
        dict(quantity="share", at="tumbling", value=1, within=1),
        dict(quantity="share", ensemble="e", statistic="mean", at="tumblin", value=1, within=1),
        dict(quantity="body_rate_deg_s", ensemble="e", statistic="mean", at="drift", value=1, within=1),
        dict(quantity="clock_deg", ensemble="e", statistic="mean", at="end", value=1, within=1),
        dict(quantity="body_rate_deg_s", ensemble="e", statistic="percentile", at="end", value=1, within=1),
    ]
    with pytest.raises(SceneError) as caught:
        load_scene(wheeled(ensemble=ensemble, expect=asked[:4]))
    assert {fault.where.split(".")[0] for fault in caught.value.faults} == {f"expect[{i}]" for i in range(4)}
    with pytest.raises(SceneError, match="percentile"):
        load_scene(wheeled(ensemble=ensemble, expect=asked[4:]))


def test_a_drawn_body_that_is_none_is_told_with_its_flight_and_what_it_drew():
    draw = [{"key": "attitude.inertia_kg_m2.2", "distribution": "normal(5, 3)"}]
    with pytest.raises(SceneError, match=r"flight \d+ drew attitude.inertia_kg_m2.2 = .*moment"):
        simulate(load_scene(wheeled(ensemble=[dict(name="e", flights=50, draw=draw)])))


def test_many_flights_together_have_the_time_of_the_run():
    ensemble = [dict(name="e", flights=9_000, draw=[{"key": "attitude.rates_deg_s.2", "distribution": "normal(0, 1)"}])]
    with pytest.raises(TimeLimitError, match="flights of an ensemble"):
        simulate(load_scene(wheeled(ensemble=ensemble)), time_limit=0.5)


def test_progress_of_many_flights_never_falls():
    from sailviz.simulation import simulate_blocks

    told: list[float] = []
    ensemble = [dict(name="e", flights=4, draw=ZERO)]
    list(simulate_blocks(load_scene(wheeled(ensemble=ensemble)), progress=told.append))
    assert told == sorted(told)
    assert told[-1] == 1.0
    assert min(told) > 0


def test_a_number_in_a_list_may_be_drawn_in_another_unit_than_the_file_has():
    changed = load_scene(wheeled(), {"attitude.rates_rad_s.0": 0.5, "attitude.centre_of_mass_m": [1.0, 2.0, 3.0]})
    assert changed.attitude.rates == pytest.approx([0.5, 0.0, np.radians(0.1)], abs=1e-15)
    again = changed.with_values({"attitude.centre_of_mass_km.2": 0.004})
    assert again.attitude.centre_of_mass == pytest.approx([1.0, 2.0, 4.0])
