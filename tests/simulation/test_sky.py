"""Flights under a sky against reference rows: end states that two independent codes agree upon, DE421 where said.

The tolerance of each row is the distance by which those codes differ, or what is left of a float64 flight.
"""

from __future__ import annotations

import numpy as np
import pytest
from independent.under_sky import DE421, GEO, elements, fly, sail

from sailviz.constants import AU, DAY, MU_SUN
from sailviz.sky import Sky


@pytest.fixture
def de421():
    pytest.importorskip("jplephem")
    pytest.importorskip("skyfield_data")


FAR = elements((400_000 + 7_000) / 2, 393_000 / 407_000, 28.5, 10, 250, 0)
LUNAR = {
    "kind": "cartesian",
    "position_m": [-265429.056, -5871099.606, -3171316.859],
    "velocity_m_s": [10819.975519, -551.974072, 116.279415],
}


@pytest.mark.usefixtures("de421")
@pytest.mark.parametrize(
    ("start", "days", "end", "speed", "within"),
    [
        (GEO, 10, (41520805.933, 7337087.034, -18353.336), (-534.88422029, 3027.74652690, 0.46008660), 1e-3),
        (GEO, 60, (21005397.12, 36559749.46, -17820.70), None, 6e-3),
        (FAR, 10, (129094517.158, 176244969.176, 26691390.886), (433.446052, 1115.249838, 537.337144), 3e-3),
        (FAR, 60, (112174388.19, 307402622.75, 180029739.08), None, 1e-2),
        (LUNAR, 3, (48068115.470, 303097483.460, 165026148.885), (-123.708033, 456.167749, 240.826511), 1e-3),
        (LUNAR, 6, (10192630.33, 297829881.15, 160768832.10), None, 6e-3),
    ],
)
def test_moon_and_sun_pull_a_craft_round_the_earth(start, days, end, speed, within):
    found = fly(days, start=start, frame="icrf", environment={"gravity_of": ["moon", "sun"]}, **DE421)
    assert np.linalg.norm(found.position[-1] - end) < within
    if speed is not None:
        assert found.velocity[-1] == pytest.approx(speed, abs=6e-7)


@pytest.mark.usefixtures("de421")
def test_a_flight_past_the_moon_is_the_same_as_seen_from_the_earth_and_from_the_moon():
    """14,857.27 km from the Moon's centre, at 5.224 d. From the Moon its fall towards the Earth is the bodies' own; in
    DE421 it is that to 26 m in three days."""
    around = {"gravity_of": ["moon", "sun"]}
    seen = fly(6, start=LUNAR, frame="icrf", environment=around, outputs=6 * 1440 + 1, **DE421)
    moon = np.linalg.norm(seen.position - seen.bodies["Moon"], axis=1)
    assert moon.min() / 1e3 == pytest.approx(14857.27, abs=0.01)
    assert seen.time[moon.argmin()] / DAY == pytest.approx(5.224, abs=1e-3)
    half = 3 * 1440
    sky = Sky(np.datetime64(DE421["epoch"], "ns"), "icrf", "de421")
    around_then = np.array([-30.0, -15.0, 15.0, 30.0]) + 3 * DAY
    stencil = np.array([1.0, -8.0, 8.0, -1.0]) / 180.0
    handed_on = {
        "kind": "cartesian",
        "position_m": list(map(float, seen.position[half] - seen.bodies["Moon"][half])),
        "velocity_m_s": list(map(float, seen.velocity[half] - stencil @ sky.position("moon", "earth", around_then))),
    }
    later = {"epoch": "2026-03-23T00:00:00", "ephemeris": "de421", "frame": "icrf"}
    other = fly(3, body="moon", start=handed_on, environment={"gravity_of": ["earth", "sun"]}, **later)
    assert np.linalg.norm(seen.position[-1] - seen.bodies["Moon"][-1] - other.position[-1]) < 30


@pytest.mark.usefixtures("de421")
@pytest.mark.parametrize(
    ("start", "both", "others", "within"), [(GEO, 722e3, 1.9, 0.05), (FAR, 72_000e3, 104, 0.5)], ids=["ring", "far"]
)
def test_who_matters_round_the_earth(start, both, others, within):
    """What is left out displaces a craft in 60 d: without Moon and Sun hundreds of km, without planets metres."""
    flown = {"start": start, "frame": "icrf", **DE421}
    ends = [
        fly(60, **flown, environment={"gravity_of": bodies} if bodies else {}).position[-1]
        for bodies in ([], ["moon", "sun"], ["moon", "sun", "venus", "mars", "jupiter"])
    ]
    assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(both, rel=0.01)
    assert np.linalg.norm(ends[2] - ends[1]) == pytest.approx(others, abs=within)


@pytest.mark.usefixtures("de421")
@pytest.mark.parametrize(
    ("bodies", "end"),
    [
        (["jupiter"], (149598515948.2, -170739766.3, 100295.0)),
        (["venus", "earth", "moon", "mars", "jupiter", "saturn"], (149595691118.3, -51641965.8, 39995.9)),
    ],
)
def test_planets_pull_a_craft_round_the_sun(bodies, end):
    start = {"kind": "cartesian", "position_m": [AU, 0, 0], "velocity_m_s": [0, float(np.sqrt(MU_SUN / AU)), 0]}
    found = fly(5 * 365.25, body="sun", start=start, environment={"gravity_of": bodies}, **DE421)
    assert np.linalg.norm(found.position[-1] - end) < 0.15


@pytest.mark.usefixtures("de421")
def test_a_sail_keeps_its_station_within_the_earths_orbit_in_real_gravity():
    """At 0.98 of the Earth's heliocentric state, which the row gives to 1e-6 m/s: 2 m after 30 d. 0.02 m/s across too
    much would be 50 km."""
    start = {
        "kind": "cartesian",
        "position_m": [0.98 * x for x in (-148940181496.0, 2531871683.9, 451881.0)],
        "velocity_m_s": [0.98 * v for v in (-987.408823, -29908.510905, 0.827183)],
    }
    around = {"gravity_of": ["earth", "moon"]}
    found = fly(30, body="sun", start=start, device=sail(0.305972616e-3), environment=around, **DE421)
    assert np.linalg.norm(found.position[-1] - (-129272362503.0, -70488092430.4, 2448727.5)) < 2.5
    assert found.velocity[-1] == pytest.approx((13495.663392, -25753.420236, 0.718713), abs=2e-6)
    ratio = np.linalg.norm(found.position[-1]) / np.linalg.norm(found.bodies["Earth"][-1])
    assert ratio == pytest.approx(0.98007916, abs=5e-9)


@pytest.mark.usefixtures("de421")
def test_the_sun_pulls_and_shines_from_one_place():
    around = {"gravity_of": ["moon", "sun"], "shadow_of": []}
    found = fly(10, start=GEO, device=sail(1e-3), frame="icrf", environment=around, **DE421)
    assert np.linalg.norm(found.position[-1] - (23707713.66, -51973967.19, -120891.52)) < 8e-3  # given to 0.01


@pytest.mark.parametrize("frame", ["ecliptic-j2000", "icrf"])
@pytest.mark.parametrize("pulling", [[], ["earth", "moon"], ["earth-moon"]])
def test_planets_are_recorded_in_the_frame_of_the_flight(frame, pulling):
    """The Earth where it stands, if it pulls alone, and where both stand together, 4,700 km off, if it does not. Rings
    and targets, of points a degree apart, lie in the same frame."""
    start = elements(AU / 1e3, 0.4, 5, 10, 20, 0)
    around = {"gravity_of": pulling} if pulling else {}
    target = {"planet": "mars"}
    found = fly(
        300, 1e-9, 50, body="sun", start=start, frame=frame, environment=around, target=target, epoch="2026-03-20"
    )
    sky = Sky(np.datetime64("2026-03-20", "ns"), frame)
    for name, word in {"Venus": "venus", "Earth": "earth" if "earth" in pulling else "earth-moon"}.items():
        assert np.linalg.norm(found.bodies[name] - sky.position(word, "sun", found.time), axis=1).max() < 1.0
    rings = {one.name: one.points for one in found.setting.references}
    for name, place in found.bodies.items():
        ring = next(points for title, points in rings.items() if name in title and "target" not in title)
        assert (
            np.linalg.norm(ring[:, None] - place[None], axis=2).min(axis=0).max() < 0.02 * AU
        )  # points of a ring are a degree apart
    mars = sky.position("mars", "sun", np.linspace(0, 687 * DAY, 60))
    aim = next(points for title, points in rings.items() if "Mars" in title)
    assert np.linalg.norm(aim[:, None] - mars[None], axis=2).min(axis=0).max() < 0.03 * AU
