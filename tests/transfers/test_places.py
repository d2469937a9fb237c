"""Places of small bodies: where their elements come from, how long they hold, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from sailviz import transfers, two_body
from sailviz.constants import AU, DAY, MU_SUN
from sailviz.exchange.small_bodies import read_small_body
from sailviz.transfers import places

FOREIGN = Path(__file__).parents[1] / "data" / "foreign"
NEW_YEAR = np.datetime64("2026-01-01", "ns")

# "Export format for minor-planet orbits" lines of MPCORB.DAT: epoch JD, a au, e, i, node, argument, mean anomaly deg
MPC = {
    "vesta": (2461000.5, 2.3615413, 0.0901676, 7.14406, 103.70232, 151.53711, 26.80969),
    "pallas": (2461000.5, 2.7699258, 0.2306430, 34.92833, 172.88859, 310.93340, 211.52977),
    "eros": (2461200.5, 1.4582437, 0.2228780, 10.82855, 304.26797, 178.91814, 62.51145),
}


@pytest.mark.parametrize("name", MPC)
def test_a_named_body_stands_where_the_minor_planet_center_has_it(name):
    """Two institutes' elements of different epochs: the planets' pull in half a year stands between them."""
    date, a, e, *angles = MPC[name]
    i, node, argument, anomaly = np.radians(angles)
    orbit = places.Elements(a * AU, e, i, node, argument, 0.0)
    theirs = places.SmallBodyOrbit(name, orbit, float(anomaly), date).state(NEW_YEAR, 0.0)
    ours = transfers.place(name).body.state(NEW_YEAR, 0.0)
    assert np.linalg.norm(ours[0] - theirs[0]) < 1e-3 * AU
    assert np.linalg.norm(ours[1] - theirs[1]) < 20  # m/s


@pytest.mark.parametrize("name", ["halley", "phaethon", "ceres"])
def test_a_body_moves_on_its_conic(name):
    """Kepler's equation against universal variables, over a hundred years of a comet."""
    body = transfers.place(name).body
    time = np.linspace(0, 100 * 365.25, 400) * DAY
    r, v = body.state(NEW_YEAR, time)
    again = two_body.advance(np.tile(r[0], (400, 1)), np.tile(v[0], (400, 1)), time, MU_SUN)
    assert np.abs(again[0] - r).max() < 1e-9 * np.abs(r).max()
    assert np.abs(again[1] - v).max() < 1e-9 * np.abs(v).max()


def test_apophis_passes_the_earth_in_april_2029_and_its_elements_end_there():
    apophis = transfers.place("apophis")
    (passage,) = places.passages(apophis.body, np.datetime64("2030-01-01", "ns"))
    assert (passage.planet, str(passage.date.astype("datetime64[M]"))) == ("Earth", "2029-04")
    assert passage.distance < 0.003 * AU  # 0.00025 au in truth: the planets' pull of eight years is left out
    assert places.trusted(apophis, np.datetime64("2029-04-01", "ns")) == []
    with pytest.raises(ValueError, match=r"passes Earth on 2029-04-1\d, .* take newer ones for 2029-05-01"):
        places.trusted(apophis, np.datetime64("2029-05-01", "ns"))


def test_old_elements_are_told():
    (words,) = places.trusted(transfers.place("halley"), NEW_YEAR)
    assert words == "the elements of Halley are 58 years from the flight"
    assert places.trusted(transfers.place("mars"), NEW_YEAR) == []


def test_a_body_of_a_file_is_where_the_file_has_it(tmp_path):
    file = FOREIGN / "sbdb_made_up.json"
    found, place = read_small_body(file), transfers.place_of_file(file)
    r, v = found.at_perihelion()
    passage = np.datetime64("2000-01-01T12:00", "ns") + np.timedelta64(
        round(((found.passage - 2_451_545.0) * DAY - 69.184) * 1e9), "ns"
    )
    here = place.body.state(passage, 0.0)
    assert np.abs(here[0][0] - r).max() < 100
    assert np.abs(here[1][0] - v).max() < 1e-4
    answer = json.loads(file.read_text())
    for item in answer["orbit"]["elements"]:
        item["value"] = {"e": "1.2", "q": "0.8", "tp": "2461000.5"}.get(item["name"], item["value"])
    (tmp_path / "open.json").write_text(json.dumps(answer))
    with pytest.raises(ValueError, match=r"does not come back: its eccentricity is 1\.2"):
        transfers.place_of_file(tmp_path / "open.json")


@pytest.mark.parametrize(
    ("full", "short"),
    [
        ("99942 Apophis (2004 MN4)", "Apophis"),
        ("(433) Eros", "Eros"),
        ("1P/Halley", "Halley"),
        ("(2016 HO3)", "2016-HO3"),
        ("C/2027 A1 (Made Up)", "C-2027-A1-Made-Up"),
        ("469219 Kamo`oalewa (2016 HO3)", "Kamo-oalewa"),
    ],
)
def test_a_catalogues_name_becomes_one_for_a_picture(full, short):
    assert places.short_name(full) == short


def test_the_nearest_name_is_told():
    with pytest.raises(ValueError, match='Did you mean "apophis"'):
        transfers.place("apofis")
    assert transfers.place("2016 HO3").name == "Kamooalewa"
