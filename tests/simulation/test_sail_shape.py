"""Sails of any shape in flight: against two codes of the source, the flat sail, and what the recording says."""

from __future__ import annotations

import hashlib
import json
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from sailviz import load_scene, simulate
from sailviz.constants import AU, DAY, RADIATION_PRESSURE
from sailviz.errors import SceneError
from sailviz.propulsion import solar_sail
from sailviz.propulsion.solar_sail import Film, black_back
from sailviz.shapes import membranes
from sailviz.shapes.facets import Coefficients, Surface
from sailviz.simulation.sail_shape import sail_shape

A_MEAN = 120.0  # m2/kg of the source's sail, 1 kg


@pytest.fixture(autouse=True)
def own_cache(tmp_path_factory, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.getbasetemp() / "tables"))


def scene(device: dict, days: float = 400.0, outputs: int = 3, **more: object) -> dict:
    return {
        "title": "a sail with a shape",
        "start": {"kind": "circular", "radius_au": 1},
        "device": {"kind": "solar-sail", **device},
        "steering": {"kind": "orbital", "pitch_deg": 35, "clock_deg": 90},
        "propagation": {"duration_d": days, "outputs": outputs, "tolerance": 1e-13},
        **more,
    }


def cap(slope: float, **more: object) -> dict:
    """120 m2/kg of mouth."""
    shape = {"kind": "cap", "diameter_m": float(np.sqrt(4 * A_MEAN / np.pi)), "edge_slope_deg": slope, "cells": 4}
    return {"mass_kg": 1, "back": "same", "shape": shape | {"shadow": False}, **more}


def square(**more: object) -> dict:
    return {"kind": "square", "side_m": 9.27, "cells": 4, "shadow": False, **more}


@pytest.mark.parametrize(
    ("slope", "film", "r", "radial", "transverse"),
    [
        (0.0, "jpl-2015", 2.275772608549, 4000.773415115, 16755.063647586),
        (20.0, "jpl-2015", 2.154117676763, 3173.865667124, 17372.361574702),
        (20.0, "ideal", 2.345279559230, 4451.783830478, 16405.693661016),
    ],
)
def test_a_billowed_sail_flies_as_two_codes_have_it(slope, film, r, radial, transverse):
    """Cap whose axis keeps a pitch of 35 deg, 400 days from 1 au: within 15 m and 1e-5 m/s."""
    run = simulate(load_scene(scene(cap(slope, film=film))))
    position, velocity = run.position[-1], run.velocity[-1]
    size = np.linalg.norm(position)
    assert size / AU == pytest.approx(r, abs=1e-10)
    assert velocity @ position / size == pytest.approx(radial, abs=1e-5)
    assert np.linalg.norm(np.cross(position, velocity)) / size == pytest.approx(transverse, abs=1e-5)


@pytest.mark.parametrize("film", ["ideal", "jpl-2015", "eta-perfect"])
def test_a_flat_shape_flies_as_the_flat_sail(film):
    """Of the same area and mass, steered out of its plane too: forces within 1e-12, places within metres."""
    flat = scene({"mass_kg": 14, "area_m2": 9.27**2, "film": film}, 200, 20)
    shaped = scene({"mass_kg": 14, "film": film, "back": "same", "shape": square()}, 200, 20)
    for each in (flat, shaped):
        each["steering"] |= {"clock_deg": 60}
    one, other = simulate(load_scene(flat)), simulate(load_scene(shaped))
    size = one.thrust.magnitude.max()
    np.testing.assert_allclose(other.thrust.acceleration[0], one.thrust.acceleration[0], rtol=0, atol=1e-12 * size)
    np.testing.assert_allclose(other.position, one.position, rtol=0, atol=30)


def test_the_recorded_attitude_is_that_by_which_the_shape_is_pushed():
    """A heliogyro, whose force has parts along all its axes: the force of the table along the recorded axes, rolled;
    and the torque that control has to hold."""
    shape = {"kind": "heliogyro", "blades": 1, "length_m": 50, "chord_m": 1, "pitch_deg": 15, "twist_deg": 5}
    device = {"mass_kg": 2, "back": "same", "film": "jpl-2015", "roll_deg": 40, "shape": shape | {"shadow": False}}
    run = simulate(load_scene(scene(device, 50, 5)))
    found = sail_shape(load_scene(scene(device, 50, 5)))
    from sailviz.propulsion.shaped_sail import force_and_torque

    for i in range(len(run.time)):
        axes = turned(run.attitude.quaternion[i])
        np.testing.assert_allclose(axes[:, 2], run.attitude.normal[i], rtol=0, atol=1e-12)
        distance = np.linalg.norm(run.position[i])
        force, torque = force_and_torque(axes.T @ run.position[i] / distance, found.table.numbers)
        push = 2 * RADIATION_PRESSURE * (AU / distance) ** 2
        np.testing.assert_allclose(run.thrust.acceleration[i], axes @ force * push / 2, rtol=1e-9, atol=1e-16)
        recorded = [run.environment[f"light_torque_{axis}_N_m"][i] for axis in "xyz"]
        np.testing.assert_allclose(recorded, push * torque, rtol=1e-9, atol=1e-15)
    assert np.abs(run.environment["light_torque_z_N_m"]).min() > 1e-6


def turned(q: np.ndarray) -> np.ndarray:
    """Rotation matrix of a quaternion x, y, z, w, written out."""
    x, y, z, w = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def test_a_billowed_sail_is_a_little_weaker_than_a_flat_one_and_says_so():
    billowed = load_scene(scene({"mass_kg": 14, "back": "black", "film": "jpl-2015", "shape": square(sag=0.05)}, 10))
    flat = load_scene(scene({"mass_kg": 14, "back": "black", "film": "jpl-2015", "shape": square()}, 10))
    weaker, whole = sail_shape(billowed).facing(), sail_shape(flat).facing()
    assert 0.9 * whole < weaker < 0.999 * whole
    assert whole == pytest.approx(9.27**2 * (0.0723 + 0.8554 - 0.0030), rel=1e-12)


def test_the_brightness_of_the_light_acts_on_a_shape():
    device = {"mass_kg": 14, "back": "same", "shape": square()}
    plain, bright = (
        simulate(load_scene(scene(device, 1, 2, **more))) for more in ({}, {"light": {"pressure_uN_m2": 9.126}})
    )
    np.testing.assert_allclose(bright.thrust.magnitude[0], 2 * plain.thrust.magnitude[0], rtol=1e-12)


def test_a_black_back_is_that_of_the_films_own_emissivities():
    """(3.18)-(3.20) with the roles swapped: cr 0, (0.27 0.67 - 0.025 0.79) / 0.295 / 2."""
    back = black_back((0.91, 0.94, 0.79, 0.67, 0.025, 0.27))
    assert back == Film(0.5, 0.0, pytest.approx((0.27 * 0.67 - 0.025 * 0.79) / 0.295 / 2, abs=1e-15))


SHAPE = {"shape": square(), "back": "same", "mass_kg": 14}


@pytest.mark.parametrize(
    ("device", "words"),
    [
        ({"shape": square(), "mass_kg": 14}, "a sail with a shape needs its back"),
        ({"shape": square(), "back": "same"}, "needs exactly one of"),
        (SHAPE | {"area_m2": 80}, "has area.mass and shape.mass"),
        (SHAPE | {"characteristic_acceleration_mm_s2": 1}, "needs exactly one of"),
        ({"area_m2": 80, "mass_kg": 14, "back": "same"}, "back belongs to a sail with a shape"),
        ({"area_m2": 80, "mass_kg": 14, "roll_deg": 3}, "roll belongs to a sail with a shape"),
        (SHAPE | {"shape": square(cells=7)}, "multiple of 2"),
        (SHAPE | {"shape": {"kind": "cube"}}, "is not a kind of device.shape"),
        (SHAPE | {"shape": {"kind": "ring", "diameter_m": 3, "inner_diameter_m": 4}}, "must be less than diameter"),
        (SHAPE | {"shape": {"kind": "file", "file": "../sail.stl"}}, "leads out of the folder"),
        (SHAPE | {"shape": {"kind": "file", "file": "none.stl"}}, "there is no file"),
        (SHAPE | {"control": {"kind": "electrochromic"}}, "a film that darkens is known of flat sails only"),
    ],
)
def test_what_does_not_go_with_a_shape_is_refused(device, words):
    with pytest.raises(SceneError, match=words):
        load_scene(scene(device))


def lawful(device: dict, steering: dict, **more: object) -> dict:
    return scene(device, 60, 5, **more) | {"steering": steering}


TOWARDS = {"kind": "locally-optimal", "goal": "semi-major-axis"}
LAWS = [
    TOWARDS,
    {"kind": "lyapunov", "semi_major_axis_au": 1.3, "inclination_deg": 5},
    {"kind": "optimal", "costates": [1.0, 0.3, 0.9]},
]


@pytest.mark.parametrize("steering", LAWS, ids=["locally-optimal", "lyapunov", "optimal"])
def test_a_law_turns_a_shape_as_the_flat_film_and_says_what_that_gives_up(steering):
    """A flat shape flies as the flat film and gives up nothing; a billowed one pushes less along the primer than the
    law expects."""
    flat = simulate(load_scene(lawful({"mass_kg": 1, "area_m2": 120.0, "film": "jpl-2015"}, steering)))
    side = {"side_m": float(np.sqrt(120.0))}
    device = {"mass_kg": 1, "film": "jpl-2015", "back": "same"}
    shaped, billowed = (
        simulate(load_scene(lawful(device | {"shape": square(**side, **more)}, steering)))
        for more in ({}, {"sag": 0.08})
    )
    np.testing.assert_allclose(shaped.position, flat.position, rtol=0, atol=30)
    expected = shaped.environment["switching_function"]
    assert expected.max() > 0.1
    np.testing.assert_allclose(shaped.environment["push_along_primer"], expected, rtol=0, atol=1e-9)
    assert "push_along_primer" not in flat.environment
    had, wanted = billowed.environment["push_along_primer"], billowed.environment["switching_function"]
    on = wanted > 0.05
    assert np.all(had[on] < wanted[on] - 1e-4)


def test_the_share_given_up_is_that_of_the_best_angle():
    """Of a cap, by its closed form: the push along a primer at the flat film's best pitch, over the best of all."""
    from scipy.optimize import minimize_scalar

    from sailviz.simulation.sail_shape import given_up
    from sailviz.steering import optimal_pitch

    found = sail_shape(load_scene(scene(cap(20.0, film="ideal"), 1)))
    s, k = np.sin(np.radians(20)), np.cos(np.radians(20))

    def push(a: float, theta: float) -> float:
        z = (1 + k * k) / 2 * np.cos(a) ** 2 + s * s / 4 * np.sin(a) ** 2
        x = s * s / 2 * np.sin(a) * np.cos(a)
        # the axis a from the light, the primer theta beyond it on the same side
        return float(z * np.cos(theta - a) - x * np.sin(theta - a))

    lost = []
    for theta in np.radians(np.arange(5.0, 111.0, 5.0)):
        within = {"bounds": (0, np.radians(70)), "method": "bounded"}
        best = -minimize_scalar(lambda a, theta=theta: -push(a, theta), **within).fun
        flown = float(optimal_pitch(theta, "ideal").pitch)
        if flown < np.radians(69):
            lost.append(1 - push(flown, theta) / best)
    assert 0 < max(lost) < given_up(found, Film(0.0, 1.0, 0.0)) + 1e-3
    flat = sail_shape(load_scene(scene({"mass_kg": 14, "film": "jpl-2015", "back": "same", "shape": square()}, 1)))
    assert given_up(flat, solar_sail.film("jpl-2015")) < 2e-4  # what a grid of whole degrees misses


def test_many_shapes_fly_side_by_side_as_one_does():
    """A flat one as the flat sail in the same sunshine, and a heliogyro, whose push has parts along all axes, without
    any flicker as its own scene's flight."""
    sunshine = {"irradiance": {"kind": "cycle", "seed": 3}}
    many = {"ensemble": [{"name": "many", "flights": 4, "control": "none"}], "environment": sunshine}
    flat = simulate(load_scene(scene({"mass_kg": 14, "area_m2": 9.27**2}, 100, 5, **many)))
    shaped = simulate(load_scene(scene({"mass_kg": 14, "back": "same", "shape": square()}, 100, 5, **many)))
    np.testing.assert_allclose(shaped.setting.ensembles[0].kept, flat.setting.ensembles[0].kept, rtol=1e-10, atol=1.0)
    assert np.ptp(flat.setting.ensembles[0].kept[:, -1, 0]) > 1.0
    blade = {"kind": "heliogyro", "blades": 1, "length_m": 50, "chord_m": 2, "pitch_deg": 15, "twist_deg": 5}
    device = {"mass_kg": 2, "back": "same", "roll_deg": 40, "shape": blade | {"shadow": False, "cells": 8}}
    one = simulate(load_scene(scene(device, 100, 5)))
    nominal = simulate(load_scene(scene(device, 100, 5, **many))).setting.ensembles[0]
    rho, angle, z = nominal.nominal[-1, :3]
    x, y, up = nominal.axes
    place = rho * (np.cos(angle) * x + np.sin(angle) * y) + z * up
    assert np.linalg.norm(place - one.position[-1]) < 2e-8 * AU
    assert abs(one.position[-1] @ [0, 0, 1]) > 1e7


def test_a_shape_flies_with_an_engine_beside_it():
    """As the flat sail does; its torque is recorded."""
    engine = {"kind": "thruster", "thrust_mN": 1, "specific_impulse_s": 3000, "steering": {"kind": "tangential"}}
    runs = []
    for sail in ({"area_m2": 9.27**2}, {"back": "same", "shape": square()}):
        whole = scene({}, 30, 4)
        steering = whole.pop("steering")
        first = {"kind": "solar-sail", "mass_kg": 14, **sail, "steering": steering}
        runs.append(simulate(load_scene(whole | {"device": [first, engine]})))
    np.testing.assert_allclose(runs[1].position, runs[0].position, rtol=0, atol=30)
    assert runs[1].mass[-1] < 14
    assert np.abs(runs[1].environment["light_torque_x_N_m"]).max() < 1e-12


def test_a_shape_is_that_of_the_first_sail():
    sail = {"kind": "solar-sail", "mass_kg": 14, "area_m2": 50, "steering": {"kind": "sun-facing"}}
    whole = scene({}, 30, 4)
    del whole["steering"]
    other = {"name": "second", "kind": "solar-sail", "back": "same", "shape": square()}
    with pytest.raises(SceneError, match="has that one's shape: give this one its area"):
        load_scene(whole | {"device": [sail, other | {"steering": {"kind": "sun-facing"}}]})


def test_a_shape_is_swept(tmp_path):
    """The more a film sags the less far it comes."""
    from sailviz import sweep

    device = {"mass_kg": 1, "back": "same", "shape": square(side_m=10.0)}
    sags = {"device.shape.sag": [0.0, 0.05, 0.1]}
    found = sweep(scene(device, 50, 3), sags, report=["radius_au@end"], engine="serial")
    radii = list(found.table["radius_au@end"])
    assert radii[0] > radii[1] > radii[2]


def test_a_file_that_lies_is_told_when_the_scene_is_flown(tmp_path):
    (tmp_path / "a.stl").write_bytes(b" " * 80 + (10**6).to_bytes(4, "little"))
    text = (
        'title = "a"\n[start]\nkind = "circular"\nradius_au = 1\n[device]\nkind = "solar-sail"\nmass_kg = 1\n'
        'back = "same"\nshape = {kind = "file", file = "a.stl", unit = "m"}\n[propagation]\nduration_d = 1\n'
    )
    (tmp_path / "a.toml").write_text(text)
    with pytest.raises(SceneError, match="has 1000000 facets, more than 200000"):
        simulate(load_scene(tmp_path / "a.toml"))


def test_what_is_drawn_is_what_is_pushed(tmp_path):
    """The facets of the close-up times the size that they stand for are those of the shape; lit from the front."""
    from rerun.chunk import RrdReader

    from sailviz import record

    shape = square(cone_deg=5, sag=0.03, bus={"size_m": [1, 1, 1], "centre_m": [0, 0, -1]})
    whole = load_scene(scene({"mass_kg": 14, "back": "same", "shape": shape}, 5, 20))
    record(simulate(whole), tmp_path / "a.rrd")
    pushed = {part.name: part.mesh for part in sail_shape(whole).shape.parts}
    drawn: dict[str, list] = {}
    for chunk in RrdReader(str(tmp_path / "a.rrd")).stream():
        batch = chunk.to_record_batch()
        name = chunk.entity_path.rsplit("/", 1)[-1]
        if "Mesh3D:vertex_positions" in batch.schema.names:
            drawn.setdefault(name, []).append(batch.column("Mesh3D:vertex_positions").to_pylist()[0])
    size = sail_shape(whole).shape.size
    assert not {"booms", "vanes"} & set(drawn)
    for name, part in (("film_lit", "film"), ("film_dark", "film"), ("bus", "bus")):
        assert drawn[name], name
        for corners in drawn[name]:
            found, whole_part = size * np.array(corners), pushed[part].vertices
            if part == "film":
                np.testing.assert_allclose(found, whole_part, rtol=0, atol=1e-6 * size)
            for seen, meant in (
                (found.min(axis=0), whole_part.min(axis=0)),
                (found.max(axis=0), whole_part.max(axis=0)),
            ):
                np.testing.assert_allclose(seen, meant, rtol=0, atol=1e-6 * size)


def test_scenes_without_a_shape_say_nothing_of_it():
    values = load_scene(scene({"mass_kg": 14, "area_m2": 80.0})).resolved()["device"]
    assert not {"shape", "back", "roll"} & set(values)
    assert DAY == 86400.0


def shaped_file(folder: Path, side: float) -> Path:
    """A scene of two days beside a flat square in a file."""
    b = Coefficients(0.0, 1.0, 0.0)
    membranes.square(side, Surface(b, b), rows=3).mesh.export(str(folder / "sail.stl"))
    text = (
        'title = "a"\n[start]\nkind = "circular"\nradius_au = 1\n[device]\nkind = "solar-sail"\nmass_kg = 1\n'
        'back = "same"\nshape = {kind = "file", file = "sail.stl", unit = "m", cells = 4}\n'
        '[steering]\nkind = "sun-facing"\n[propagation]\nduration_d = 2\noutputs = 5\n'
    )
    (folder / "a.toml").write_text(text)
    return folder / "a.toml"


def test_a_recording_says_what_was_pushed_and_another_file_is_another_run(tmp_path):
    import sailviz
    from sailviz.shapes import kept_tables

    told = []
    for side in (5.0, 6.0):
        path = shaped_file(tmp_path, side)
        sailviz.record(load_scene(path), tmp_path / "a.rrd")
        recording = sailviz.read(tmp_path / "a.rrd")
        facts = json.loads(str(recording["/scene"]["craft_shape"][0]))
        assert facts["film_area_m2"] == pytest.approx(side**2, rel=1e-6)
        assert facts["file_sha256"] == hashlib.sha256((tmp_path / "sail.stl").read_bytes()).hexdigest()
        assert facts["facets"] == len(sail_shape(load_scene(path)).shape.elements)
        assert facts["rays"] == "none"
        assert (kept_tables.folder() / f"{facts['table']}.table").is_file()
        told.append((load_scene(path).identity(), recording.identity, facts["hash"], facts["table"]))
    assert told[0][0] == told[1][0]
    assert all(one != other for one, other in zip(told[0][1:], told[1][1:], strict=True))


def test_a_table_is_made_once_under_a_bar_of_its_own(tmp_path, monkeypatch):
    from click.testing import CliRunner

    from sailviz.cli import shared
    from sailviz.cli.entry import main
    from sailviz.shapes import kept_tables
    from sailviz.simulation import sail_shape as of_scenes

    heard: dict[str, list[float]] = {}

    @contextmanager
    def bar(title, quiet):
        yield heard.setdefault(title, []).append

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(shared, "progress_bar", bar)
    path = shaped_file(tmp_path, 4.0)
    for _ in range(2):
        of_scenes._built.cache_clear()
        found = CliRunner().invoke(main, ["run", str(path), "-o", str(tmp_path / "a.rrd")])
        assert found.exit_code == 0, found.output
        monkeypatch.setattr(kept_tables.light_table, "build", None)  # the second run finds it made
    shares = heard["Light on the shape"]
    assert shares
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
