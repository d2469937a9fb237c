"""Frames of others: worked rows on which pyerfa, skyfield and astropy agree (0.3 mm), and what is refused by name."""

import numpy as np
import pytest

from sailviz.calendar import tai
from sailviz.exchange.earth_frames import (
    ARCSECOND,
    EarthOrientation,
    from_gcrf_matrix,
    known_frame,
    read_orientation,
    shipped_orientation,
    to_gcrf,
)

pytest.importorskip("erfa")

NOON = np.array([tai("2025-04-01T12:00:00", "UTC")])
R, V = np.array([[4000.123, -3500.456, 4700.789]]) * 1e3, np.array([[3.1, 6.2, 1.7]]) * 1e3
DAYS = np.array([tai(f"2025-04-0{day}T00:00:00", "UTC") for day in (1, 2)])
EARTH = EarthOrientation(
    DAYS, np.full(2, 0.0123 * ARCSECOND), np.full(2, 0.4321 * ARCSECOND), np.full(2, 0.0388 - 37.0)
)
ROWS = {
    "TEME": ((3991.818591276, -3522.801004634, 4691.146007286), (3.139120017309, 6.182464421582, 1.692057680105)),
    "ITRF": ((4547.987116223, -2770.120385292, 4689.759022300), (2.208272588443, 6.967260538783, 1.694298263300)),
    "TOD": ((3991.813711454, -3522.806517900, 4691.146019479), (3.139128580774, 6.182460079216, 1.692057659261)),
    "MOD": ((3991.814543553, -3523.018230027, 4690.986319140), (3.139117401014, 6.182386325699, 1.692347855040)),
    "EME2000": ((4000.122373522, -3500.456438550, 4700.789206532), None),
}


@pytest.mark.parametrize("frame", ROWS)
def test_a_state_in_a_frame_of_others_is_that_in_gcrf_to_a_micrometre(frame):
    place, speed = to_gcrf(frame, NOON, R, V, EARTH)
    wanted_place, wanted_speed = ROWS[frame]
    assert np.abs(place[0] / 1e3 - wanted_place).max() < 2e-9  # km
    if wanted_speed is not None:
        assert np.abs(speed[0] / 1e3 - wanted_speed).max() < 2e-12  # km/s
    assert np.linalg.norm(place) == pytest.approx(np.linalg.norm(R), rel=1e-15)


def test_eclipj2000_is_eme2000_turned_by_the_obliquity():
    turn = from_gcrf_matrix("ECLIPJ2000", NOON) @ from_gcrf_matrix("EME2000", NOON).swapaxes(-1, -2)
    pole = turn[..., :, :] @ [0.0, -np.sin(np.radians(84381.448 / 3600)), np.cos(np.radians(84381.448 / 3600))]
    assert np.abs(np.ravel(pole) - [0, 0, 1]).max() < 1e-15


def test_names_of_one_frame():
    for word, frame in (
        ("J2000", "EME2000"), ("icrf", "GCRF"), ("ITRF2014", "ITRF"), ("ITRF-93", "ITRF"), ("WGS-84", "ITRF"),
        ("teme", "TEME"),
    ):  # fmt: skip
        assert known_frame(word) == frame


@pytest.mark.parametrize(("word", "said"), [("RTN", "goes along with an orbit"), ("B1950", "not known")])
def test_frames_that_say_nothing_or_are_unknown_are_refused_by_name(word, said):
    with pytest.raises(ValueError, match=f"{word}.*{said}|{said}.*{word}"):
        known_frame(word)


def test_the_itrf_needs_the_earths_orientation_on_that_day():
    early = EarthOrientation(*(values[:2] for values in EARTH))
    with pytest.raises(ValueError, match="2025-04-01 to 2025-04-02"):
        to_gcrf("ITRF", NOON + 10 * 86_400 * 10**9, R, V, early)


def test_orientation_is_read_by_its_columns(tmp_path):
    known = shipped_orientation()
    if known is None:
        pytest.skip("without skyfield-data")
    xp, yp, ut1 = known.at(NOON)
    assert xp[0] / ARCSECOND == pytest.approx(0.0584, abs=1e-3)
    assert yp[0] / ARCSECOND == pytest.approx(0.3769, abs=1e-3)
    assert ut1[0] + 37.0 == pytest.approx(0.0368, abs=1e-3)
    (tmp_path / "finals").write_text(
        "73 1 2 41684.00 I  no numbers at all here, but a line that is long enough ............\n"
    )
    with pytest.raises(ValueError, match="finals2000A"):
        read_orientation(tmp_path / "finals")
    with pytest.raises(ValueError, match="finals2000A"):
        read_orientation(tmp_path / "nothing")
