"""The hottest facet of a shape's films: the flat sail, closed forms, and NumPy facet by facet, which knows no table."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from sailviz import load_scene, simulate
from sailviz.constants import AU, SOLAR_IRRADIANCE, STEFAN_BOLTZMANN
from sailviz.errors import SceneError
from sailviz.frames import rotation

FILM = {"cr": 0.91, "ef": 0.025, "eb": 0.27}  # of table 3.1, 2015
OLDER = {"cr": 0.88, "ef": 0.05, "eb": 0.55}  # 1978
SQUARE = {"kind": "square", "side_m": 9.27, "cells": 4, "shadow": False}
CAP = {"kind": "cap", "diameter_m": 12, "edge_slope_deg": 20, "cells": 8, "shadow": False}
PYRAMID = {"kind": "pyramid", "boom_m": 6, "cone_deg": 15, "opening_deg": 70, "cells": 4, "shadow": False}


@pytest.fixture(autouse=True)
def own_cache(tmp_path_factory, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.getbasetemp() / "tables"))


def scene(device: dict, days: float = 250.0, outputs: int = 6, pitch: float = 35.0, **more: object) -> dict:
    found = {
        "title": "a shape that gets hot",
        "start": {"kind": "circular", "radius_au": 1},
        "device": {"kind": "solar-sail", "film": "jpl-2015", "mass_kg": 1, "hottest_K": 1000, **device},
        "steering": {"kind": "orbital", "pitch_deg": pitch, "clock_deg": 270},
        "propagation": {"duration_d": days, "outputs": outputs, "tolerance": 1e-12},
        **more,
    }
    if more.get("attitude", {}).get("kind") in ("free", "spin-averaged"):
        del found["steering"]
    return found


def turning(kind: str, **more: object) -> dict:
    still = {"inertia_kg_m2": [60, 60, 110], "gravity_gradient": False, "clock_deg": 40}
    return {"attitude": {"kind": kind, **still, "pitch_deg": 20, **more}}


def balance(c, distance, film: dict, dose: float = 0.0, factor: float = 0.0, half: float = 0.5, back: bool = False):
    """K, at the cosine c of the light's angle: the thin film's balance, aged by the formulas of the source, dose yr."""
    left = np.exp(-np.log(2) * dose / half)
    cr, ef = film["cr"], film["ef"] * (1 + factor * (1 - left))
    if not back:
        cr = cr * (1 + factor * left) / (1 + factor)
    taken = (1 - cr) * SOLAR_IRRADIANCE * (AU / distance) ** 2 * np.maximum(c, 0)
    return (taken / (STEFAN_BOLTZMANN * (ef + film["eb"]))) ** 0.25


def light(run) -> tuple[np.ndarray, np.ndarray]:
    """(direction of the light in body axes (n, 3), distance (n,) m) of each row."""
    distance = np.linalg.norm(run.position, axis=1)
    return np.einsum("nij,ni->nj", rotation(run.attitude.quaternion), run.position / distance[:, None]), distance


def normals(device: dict) -> tuple[np.ndarray, np.ndarray]:
    """(front normals, centres) (k, 3) of the facets of the film, of the corners of its triangles alone."""
    from sailviz.simulation.sail_shape import sail_shape

    part = sail_shape(load_scene(scene(device))).shape.parts[0]
    a, b, c = np.moveaxis(np.asarray(part.mesh.triangles), 1, 0)
    across = np.cross(b - a, c - a)
    return across / np.linalg.norm(across, axis=1)[:, None], (a + b + c) / 3


def test_a_flat_shape_is_as_hot_as_the_flat_sail():
    """Within 1e-12 of its balance at every row, and too hot within a millisecond of the flat one, which flies alike."""
    flat = simulate(load_scene(scene({"area_m2": 120, "hottest_K": 350})))
    device = {"shape": SQUARE | {"side_m": 120**0.5}, "back": "same", "hottest_K": 350}
    run = simulate(load_scene(scene(device)))
    u, distance = light(run)
    np.testing.assert_allclose(run.film["temperature_K"], balance(u[:, 2], distance, FILM), rtol=1e-12)
    np.testing.assert_allclose(run.film["temperature_K"], flat.film["temperature_K"], rtol=1e-11)
    assert [one.name for one in run.events] == ["too-hot"] == [one.name for one in flat.events]
    assert run.events[0].time == pytest.approx(flat.events[0].time, abs=1e-3)


@pytest.mark.parametrize("pitch", [0, 12, 35, 60])
def test_the_hottest_facet_of_a_cap_is_the_one_that_faces_the_sun(pitch):
    """Closed form: a sphere's normals are all there within the edge's slope, beyond it those of the edge are nearest;
    facets stand a tenth of the slope apart along a meridian."""
    run = simulate(load_scene(scene({"shape": CAP, "back": "same"}, 5, pitch=pitch)))
    distance, off = np.linalg.norm(run.position, axis=1), np.radians(max(0, pitch - 20))
    high, low = (balance(np.cos(off + step), distance, FILM) for step in (0, np.radians(2)))
    assert np.all(run.film["temperature_K"] <= high * (1 + 1e-12))
    assert np.all(run.film["temperature_K"] >= low)


ATTITUDES = {
    "held": {},
    "free": turning("free", rates_deg_s=[0.05, 0.01, 0.0], pitch_deg=120),
    "controlled": turning(
        "controlled",
        control={"kind": "pd", "frequency_rad_s": 1e-3},
        actuators=[{"kind": "wheels", "torque_mN_m": 5, "storage_N_m_s": 1}],
    ),
}


@pytest.mark.parametrize("attitude", ATTITUDES)
def test_a_pyramid_is_as_hot_as_the_hottest_of_its_films(attitude):
    """Each row to 1e-11, facet by facet from its own quaternion; the back to the light for a while if it is free."""
    device = {"shape": PYRAMID, "back": "black", "mass_kg": 14}
    run = simulate(load_scene(scene(device, 0.3, 12, **ATTITUDES[attitude])))
    u, distance = light(run)
    d = u @ normals(device)[0].T
    front, behind = balance(-d.min(axis=1), distance, FILM), balance(d.max(axis=1), distance, FILM | {"cr": 0.0})
    assert attitude != "free" or np.any(d.max(axis=1) > 0.1)
    np.testing.assert_allclose(run.film["temperature_K"], np.maximum(front, behind), rtol=1e-11)


def billowed(cone: float, sag: float) -> np.ndarray:
    """Normals away from the Sun (k, 3) of a square's film, as the source parametrises it, close together."""
    t = np.linspace(-1, 1, 4001)
    m = np.stack([-(np.tan(cone) + 2 * sag * (1 + t * t)), 4 * sag * t, np.ones_like(t)], -1)
    m = m / np.linalg.norm(m, axis=1)[:, None]
    return np.concatenate([m, m * [-1, -1, 1], *(m[:, [1, 0, 2]] * sign for sign in ([-1, 1, 1], [1, -1, 1]))])


def test_a_billowed_square_is_as_hot_as_where_it_leans_most_to_the_sun():
    """Its steepest part is at the booms; the film's points end 0.15 % before them: 5e-5 of the temperature."""
    device = {"shape": SQUARE | {"cone_deg": 5, "sag": 0.04}, "back": "same"}
    run = simulate(load_scene(scene(device, 250, 12)))
    u, distance = light(run)
    found = balance((u @ billowed(np.radians(5), 0.04).T).max(axis=1), distance, FILM)
    assert np.all(found > 1.01 * balance(u[:, 2], distance, FILM))
    assert np.all(run.film["temperature_K"] <= found * (1 + 1e-9))
    np.testing.assert_allclose(run.film["temperature_K"], found, rtol=5e-5)


def test_a_free_craft_is_too_hot_where_its_facets_are():
    """A flight that ends at the moment of the event has the film's limit there, from its own quaternion."""
    shape = {"shape": PYRAMID, "back": "same", "mass_kg": 14, "hottest_K": 285}
    free = turning("free", rates_deg_s=[0, 0.01, 0.02], pitch_deg=60) | {"event": [{"kind": "too-hot", "stop": True}]}
    run = simulate(load_scene(scene(shape, 0.3, 3, **free)))
    assert run.ended == "too-hot"
    u, distance = light(run)
    warm = balance(np.abs(u @ normals(shape)[0].T).max(axis=1), distance, FILM)
    assert warm[0] < 280
    assert warm[-1] == pytest.approx(285, abs=1e-5)


def test_of_an_averaged_spin_the_hottest_facet_in_a_turn_counts():
    """Closed form: a pyramid's film tilted by s is met at best at the pitch less s, in 64 places of a turn."""
    run = simulate(
        load_scene(scene({"shape": PYRAMID, "back": "same"}, 0.1, 3, **turning("spin-averaged", spin_rpm=1)))
    )
    tilt = np.arccos(np.abs(normals({"shape": PYRAMID, "back": "same"})[0][0, 2]))
    u, distance = light(run)
    best = balance(np.cos(np.arccos(u[:, 2]) - tilt), distance, FILM)
    assert np.all(run.film["temperature_K"] <= best * (1 + 1e-12))
    np.testing.assert_allclose(run.film["temperature_K"], best, rtol=5e-5)


def in_the_shadow_of(box: dict, centres: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Whether a box stands between places (k, 3) and the Sun, by its slabs."""
    half, middle = np.array(box["size_m"]) / 2, np.array(box["centre_m"])
    with np.errstate(divide="ignore"):
        one, two = (((middle + sign * half) - centres) / -u for sign in (-1, 1))
    enters, leaves = np.minimum(one, two).max(axis=1), np.maximum(one, two).min(axis=1)
    return (leaves > 0) & (enters < leaves)


@pytest.mark.parametrize("pitch", [0, 8])
def test_a_facet_in_the_shadow_of_the_bus_is_not_the_hottest(pitch):
    """The part of a cap that faces the Sun lies behind a box: what is lit round it is cooler, by up to a twentieth of
    c at the edge of the shadow, a facet wide."""
    bus = {"size_m": [8, 8, 1], "centre_m": [0.0, 0.0, -3.0]}
    shape = CAP | {"edge_slope_deg": 45, "cells": 16, "shadow": True, "bus": bus}
    run = simulate(load_scene(scene({"shape": shape, "back": "same"}, 1, 2, pitch=pitch)))
    u, distance = light(run)
    slope, around = np.meshgrid(np.radians(np.linspace(0, 45, 400)), np.linspace(0, 2 * np.pi, 721))
    m = np.stack([np.sin(slope) * np.cos(around), np.sin(slope) * np.sin(around), np.cos(slope)], -1).reshape(-1, 3)
    radius = 6 / np.sin(np.radians(45))
    c = m @ u[0]
    lit = ~in_the_shadow_of(bus, radius * m - [0, 0, radius * np.cos(np.radians(45))], u[0])
    hottest = balance(c[lit].max(), distance[0], FILM)
    assert hottest < 0.985 * balance(c.max(), distance[0], FILM)
    assert run.film["temperature_K"][0] == pytest.approx(hottest, rel=0.01)


def two_films(folder) -> None:
    """two.glb: a square across z of 100 m2, and beside it one of 25 m2 tilted by 30 deg; fronts along -z."""
    scene_of = trimesh.Scene()
    corners = np.array([[-1, -1, 0], [-1, 1, 0], [1, 1, 0], [1, -1, 0]], float)
    tilt = rotation(np.array([[0, np.sin(np.radians(15)), 0, np.cos(np.radians(15))]]))[0]
    for name, place in (("main", 5 * corners), ("fin", 2.5 * corners @ tilt.T + [12, 0, 0])):
        mesh = trimesh.Trimesh(place, [[0, 1, 2], [0, 2, 3]], process=False)
        scene_of.add_geometry(mesh, node_name=name, geom_name=name)
    scene_of.export(str(folder / "two.glb"))


def test_of_two_films_the_hotter_one_is_told(tmp_path, monkeypatch):
    """One faces the Sun where the other is 30 deg off: which of them is hotter changes with the pitch."""
    two_films(tmp_path)
    monkeypatch.chdir(tmp_path)
    which = []
    for pitch in (0, 70):
        shape = {"kind": "file", "file": "two.glb", "cells": 4, "shadow": False, "parts": {"fin": "jpl-1978/same"}}
        run = simulate(load_scene(scene({"shape": shape, "back": "same"}, 1, 2, pitch)))
        u, distance = light(run)
        tilted = np.array([np.sin(np.radians(30)), 0, np.cos(np.radians(30))])
        both = [balance(np.abs(u[0] @ m), distance[0], film) for m, film in (([0, 0, 1], FILM), (tilted, OLDER))]
        which.append(int(np.argmax(both)))
        assert run.film["temperature_K"][0] == pytest.approx(max(both), rel=1e-6)
    assert which == [0, 1]


def test_a_part_of_a_film_without_optics_is_refused(tmp_path, monkeypatch):
    two_films(tmp_path)
    monkeypatch.chdir(tmp_path)
    shape = {"kind": "file", "file": "two.glb", "cells": 4, "shadow": False, "parts": {"fin": "0.1,0.8,0/same"}}
    with pytest.raises(SceneError, match='part "fin" is of a film whose optics are not known'):
        simulate(load_scene(scene({"shape": shape, "back": "same"}, 1, 2)))


@pytest.mark.parametrize(("dose", "kelvin"), [(1.0, 505.848923), (1000.0, 527.347970)])
def test_a_shape_that_ages_gets_hotter_as_the_source_has_it(dose, kelvin):
    """The source's rows: facing the Sun at 0.5 au, d 0.2, half dose 0.5 yr."""
    ageing = {"factor": 0.2, "half_dose_yr": 0.5, "dose_yr": dose}
    planned = scene({"shape": SQUARE, "back": "black", "ageing": ageing}, 0.01, 2, 0)
    planned["start"]["radius_au"] = 0.5
    assert simulate(load_scene(planned)).film["temperature_K"][0] == pytest.approx(kelvin, rel=1e-9)
