"""Low orbits over days to years: the Earth turns, rows may be uneven in time, and nothing is drawn where it was not."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from sailviz import compare
from sailviz.constants import ROTATION_EARTH
from sailviz.frames import rtn, unit
from sailviz.recording import digest, export, read, record
from sailviz.recording.drawing import drawing, layout
from sailviz.recording.drawing import orbit_plane as plane
from sailviz.recording.drawing.curves import Curves
from sailviz.recording.drawing.plots import plots_of
from sailviz.recording.drawing.samples import Frame, Samples, orbits, rings
from sailviz.recording.timelines import Picker, take
from sailviz.recording.views.screenshot import Studio, has_vulkan
from sailviz.run.arrays import Shell
from sailviz.scene.quantities import spellings

DAY = 86_400.0
RADIUS = 6_378_137.0
GREENWICH = 1.2  # rad, direction of longitude 0 at the start


def with_everything(run):
    """The run with every column that an environment may fill, of the right size and sign but made up."""
    height = np.linalg.norm(run.position, axis=1) - RADIUS
    sun = unit(run.bodies["Sun"])
    ahead = np.sum(run.position * sun, 1)
    density = 1e11 * np.exp((500e3 - height) / 150e3)
    normal = unit(np.cross(run.position[0], run.velocity[0]))
    angle, altitude = np.linspace(0, 2 * np.pi, 48, endpoint=False), np.linspace(100e3, 1000e3, 31)
    value = 1e9 + 1e12 * np.exp(-(((altitude - 350e3) / 150e3) ** 2)) * (1.1 + np.cos(angle))[:, None]
    noon = unit(sun[0] - sun[0] @ normal * normal)
    environment = {
        "sunlit": (ahead > 0) | (np.linalg.norm(run.position - ahead[:, None] * sun, axis=1) > RADIUS),
        "plasma_force_N_m": 3e-19 * density,
        "plasma_density_per_m3": density,
        "mean_ion_mass_u": 16 - 6 * height / 1e6,
        "tether_current_A": 1e-14 * density,
        "tether_voltage_V": np.full(len(run), -1000.0),
        "tether_power_W": 1e-11 * density,
        "tether_tilt_rad": 1e-13 * density,
        "air_density_kg_m3": 1e-12 * np.exp((400e3 - height) / 60e3),
        "air_drag_N": 1e-6 * np.exp((400e3 - height) / 60e3),
        "solar_flux_sfu": 140 + 40 * np.sin(run.time / 1e7),
        "force_law_valid": height < 690e3,
        "quasi_circular_altitude_m": run.elements.semi_major_axis - RADIUS + 2e3,
        "earth_rotation_rad": np.mod(GREENWICH + ROTATION_EARTH * run.time, 2 * np.pi),
        "primer_direction": unit(run.velocity),
    }
    shells = (Shell("plasma density", "1/m³", normal, noon, angle, altitude, value),)
    return replace(run, environment=environment, setting=replace(run.setting, shells=shells))


def uneven(days=1095.0, far=1000, close=1000, pace=60.0):
    """Times of rows that are far apart but in one dense window."""
    window = 0.4 * days * DAY + pace * np.arange(close)
    return np.unique(np.concatenate([np.linspace(0, days * DAY, far), window]))


def column(recording, entity, name):
    """The rows of one component of a picture's entity, and the numbers of the rows."""
    table = recording[entity]
    return np.asarray(table[name], float), table.timeline("step")


def turn(quaternion):
    """Angle of a turn about z, rad."""
    return 2 * np.arctan2(quaternion[:, 2], quaternion[:, 3])


def angle_between(a, b):
    return np.abs(np.mod(a - b + np.pi, 2 * np.pi) - np.pi)


@pytest.fixture(scope="module")
def years(runs, tmp_path_factory):
    """A descent of three years with a dense window, and its recording."""
    run = with_everything(runs.descent(time=uneven(), high=800e3, low=250e3))
    path = tmp_path_factory.mktemp("years") / "years.rrd"
    record(run, path)
    return run, path


def test_columns_of_numbers_of_flags_and_of_vectors_come_back(years):
    run, path = years
    table = read(path)["/environment"]
    assert set(table) == set(run.environment)
    for name, values in run.environment.items():
        assert table[name].dtype == values.dtype
        assert np.array_equal(table[name], values), name


def test_a_column_of_vectors_is_compared_and_exported(runs, tmp_path):
    run = with_everything(runs.descent(rows=40))
    bent = run.environment["primer_direction"].copy()
    bent[7, 1] += 1e-3
    record(run, tmp_path / "a.rrd")
    record(replace(run, environment=run.environment | {"primer_direction": bent}), tmp_path / "b.rrd")
    assert compare(tmp_path / "a.rrd", tmp_path / "a.rrd").equal
    found = compare(tmp_path / "a.rrd", tmp_path / "b.rrd")
    assert {d.quantity for d in found.different} == {"/environment:primer_direction"}
    export(tmp_path / "a.rrd", tmp_path / "a.csv", entities=["/environment"])
    assert "primer_direction.y" in (tmp_path / "a.csv").read_text().splitlines()[0]


def test_the_globe_turns_by_the_rotation_of_the_earth(runs, tmp_path):
    run = with_everything(runs.descent(rows=300, days=1.0))
    record(run, tmp_path / "day.rrd")
    quaternion, step = column(read(tmp_path / "day.rrd"), "/world/center/globe", "quaternion")
    assert np.array_equal(step, np.arange(300))
    assert np.abs(quaternion[:, :2]).max() == 0
    assert angle_between(turn(quaternion), run.environment["earth_rotation_rad"]).max() < 1e-6  # float32


def test_a_slowed_orbit_and_the_globe_keep_their_number_of_revolutions_a_day(years):
    run, path = years
    frame = Frame.of(run)
    quaternion, step = column(read(path), "/world/center/globe", "quaternion")
    time = run.time[step]
    ends = (time < 0.39 * time[-1]) | (time > 0.41 * time[-1])
    expected = GREENWICH + ROTATION_EARTH * time / frame.slowed
    assert frame.slowed > 500
    assert angle_between(turn(quaternion), expected)[ends].max() < 1e-5


def test_in_a_dense_window_craft_and_globe_are_where_they_were(years):
    run, path = years
    recording = read(path)
    place, step = column(recording, "/world/craft", "translation")
    quaternion, _ = column(recording, "/world/center/globe", "quaternion")
    gap = np.diff(run.time[step], prepend=-np.inf)
    inside = (gap < 600) & (np.roll(gap, 1) < 600)
    assert inside.sum() > 300
    assert np.abs(place * RADIUS - run.position[step])[inside].max() < 2.0  # m, float32
    truth = run.environment["earth_rotation_rad"][step]
    assert angle_between(turn(quaternion), truth)[inside].max() < 1e-6


def test_outside_it_the_craft_is_drawn_on_the_orbit_of_its_row(years):
    run, path = years
    place, step = column(read(path), "/world/craft", "translation")
    e = take(run, step).elements
    normal = unit(np.cross(run.position, run.velocity))[step]
    distance = np.linalg.norm(place, axis=1) * RADIUS
    assert np.abs(np.sum(place * normal, axis=1)).max() < 1e-6
    assert np.all(distance > e.semi_major_axis * (1 - e.eccentricity) - 2)
    assert np.all(distance < e.semi_major_axis * (1 + e.eccentricity) + 2)


def test_evenly_spaced_rows_that_leap_along_the_orbit_are_all_slowed(runs, tmp_path):
    run = runs.descent(rows=601, days=0.1 * 600 * 5_800 / DAY)  # a tenth of a revolution from row to row
    frame = Frame.of(run)
    assert frame.sparse
    record(run, tmp_path / "run.rrd")
    place, _ = column(read(tmp_path / "run.rrd"), "/world/craft", "translation")
    step = np.arccos(np.clip(np.sum(unit(place[1:]) * unit(place[:-1]), 1), -1, 1))
    assert step.max() < 2 * np.pi * 30 / 600 * 1.05  # 30 revolutions over the run, on a nearly circular orbit


def test_evenly_spaced_rows_are_thinned_evenly_and_others_by_time_too():
    class Rows:
        def __init__(self, time, first=0):
            self.time, self.first = time, first

        def __len__(self):
            return len(self.time)

    even = np.linspace(0, 1e6, 10_001)
    assert np.array_equal(Picker(10_001, 1000, 1e6).pick(Rows(even)), np.arange(0, 10_001, 11))
    time = np.concatenate([np.linspace(0, 10.0, 9_000), np.linspace(1e3, 1e6, 1000)])
    picker = Picker(10_000, 1000, 1e6)
    chosen = picker.pick(Rows(time))
    assert np.all(np.isin(np.arange(0, 10_000, 10), chosen))
    gap = 1.5 * 10 * 1e6 / 9_999
    late = chosen[time[chosen] > 1e3]
    assert np.diff(time[late]).max() < gap + 1e3 + 1  # the row at which the gap is reached: rows are 1000 s apart
    assert len(chosen) <= 1000 + 1e6 / gap + 1
    again, parts = Picker(10_000, 1000, 1e6), []
    for start in range(0, 10_000, 777):
        parts.append(start + again.pick(Rows(time[start : start + 777], start)))
    assert np.array_equal(np.concatenate(parts), chosen)


def test_the_blocks_of_an_uneven_run_do_not_count(runs, tmp_path):
    run = with_everything(runs.descent(time=uneven(days=300.0, far=200, close=200)))
    record(run, tmp_path / "whole.rrd")
    record(iter(runs.in_blocks(run, 37)), tmp_path / "blocks.rrd")
    assert digest(tmp_path / "whole.rrd") == digest(tmp_path / "blocks.rrd")


def test_a_trail_over_a_gap_follows_the_orbit_and_not_a_chord(runs, tmp_path):
    close = np.arange(600) * 60.0
    time = np.concatenate([close, close[-1] + 2400 + close, close[-1] + 40 * DAY + close])
    run = runs.descent(time=time)
    run = replace(run, setting=replace(run.setting, duration=2 * DAY))  # so that it counts as close rows
    assert not Frame.of(run).sparse
    record(run, tmp_path / "gap.rrd")
    strips = read(tmp_path / "gap.rrd")["/world/trail/recent"]["strips"]
    nearest = np.inf
    for row in strips:
        for strip in row if np.ndim(row[0]) > 1 else [row]:
            points = np.array([np.asarray(point, float) for point in strip])
            middle = 0.5 * (points[1:] + points[:-1])
            nearest = min(nearest, np.linalg.norm(middle, axis=1).min())
    lowest = np.linalg.norm(run.position, axis=1).min() / RADIUS
    assert nearest > lowest * np.cos(np.radians(2.6))  # the middle of a chord of 5 degrees and no longer


def test_a_ring_is_the_osculating_orbit(runs):
    run = runs.descent(rows=20)
    frame = Frame.of(run)
    placed = rings(run, np.broadcast_to(np.eye(3), (20, 3, 3)), frame)
    circle = np.stack([np.cos(np.linspace(0, 6.2, 50)), np.sin(np.linspace(0, 6.2, 50)), np.zeros(50)], 1)
    line = plane.turned_by(placed["quaternion"], placed["scale"][:, None] * circle) + placed["translation"][:, None]
    normal = unit(np.cross(run.position, run.velocity))
    assert np.abs(np.einsum("nki,ni->nk", line, normal)).max() < 1e-12
    e = run.elements
    apse = orbits(replace(run, elements=replace(e, true_anomaly=0 * e.true_anomaly)), frame, 3)[:, 0]
    cosine = np.sum(unit(line) * unit(apse)[:, None], -1)
    p = (e.semi_major_axis * (1 - e.eccentricity**2) / frame.unit)[:, None]
    expected = p / (1 + e.eccentricity[:, None] * cosine)  # the polar equation of a conic section
    assert np.abs(np.linalg.norm(line, axis=-1) - expected).max() < 1e-12


def test_a_map_lies_in_the_plane_of_the_orbit_at_its_altitudes_and_angles(years):
    run, path = years
    shell = run.setting.shells[0]
    mesh = read(path)["/world/plane/shells/plasma_density"]
    corners = np.asarray(mesh["vertex_positions"], float).reshape(49, 31, 3)  # the circle is closed
    axes = plane.plane_axes(run)[0]
    placed = corners @ axes.T
    radius = 1 + shell.altitude / RADIUS
    assert np.abs(np.linalg.norm(placed, axis=-1) - radius).max() < 1e-6
    assert np.abs(placed @ shell.normal).max() < 1e-6
    quarter = np.cross(shell.normal, shell.reference)
    assert np.abs(placed[0] - radius[:, None] * shell.reference).max() < 1e-6
    assert np.abs(placed[12] - radius[:, None] * quarter).max() < 1e-6
    assert np.abs(placed[48] - placed[0]).max() < 1e-6
    share = plane.shares(shell.value)
    assert share[0, 8] > share[24, 8] > 0  # noon, midnight
    assert share.max() == 1


def test_the_plane_faces_the_sun_as_it_turns(years):
    run, _ = years
    axes = plane.plane_axes(run)
    sun = unit(run.bodies["Sun"])
    assert np.sum(axes[..., 0] * sun, 1).min() > 0
    assert np.abs(np.sum(axes[..., 1] * sun, 1)).max() < 1e-12
    assert np.abs(np.linalg.det(axes) - 1).max() < 1e-12


def test_three_years_with_every_column_take_less_than_five_megabytes(years):
    run, path = years
    assert len(run) > 1900
    assert path.stat().st_size < 5e6


def test_light_and_shadow_are_unknown_between_rows_far_apart(years):
    run, path = years
    lane = read(path)["/phase/sunlit"]
    states, step = lane["state"], lane.timeline("step")
    for state, row in zip(states, step, strict=True):
        gap = run.time[row] - run.time[max(row - 1, 0)]
        known = "on" if run.environment["sunlit"][row] else "off"
        assert state == ("unknown" if gap > 3600 else known)
    assert {"on", "off", "unknown"} == set(states)


def test_a_lane_of_light_is_left_out_where_all_rows_are_far_apart(runs):
    run = with_everything(runs.descent(rows=200, days=300.0))
    curves = Curves(Silent(), run, Frame.of(run))
    curves.add(run)
    assert curves.changes["sunlit"] == 0
    assert curves.changes["force_law_valid"] > 0


class Silent:
    """A pen that writes nothing."""

    def static(self, *_):
        pass

    columns = static


def test_altitudes_of_perigee_and_apogee_and_the_analytic_decay_share_a_plot(years):
    run, _ = years
    (plot,) = (p for p in plots_of(run, Frame.of(run)) if p.path == "/plots/altitude")
    assert plot.names == ("perigee", "apogee", "mean", "analytic decay")
    perigee, apogee, mean, analytic = plot.values(run).T
    e = run.elements
    assert np.allclose(0.5 * (perigee + apogee), mean)
    assert np.allclose(apogee - perigee, 2e-3 * e.semi_major_axis * e.eccentricity, atol=1e-9)
    assert np.allclose(analytic - mean, 2.0)
    paths = {p.path for p in plots_of(run, Frame.of(run))}
    assert not paths & {"/plots/primer_direction", "/plots/earth_rotation_rad", "/plots/sunlit"}


@pytest.mark.parametrize("end", [1.0, 0.4])
def test_a_replay_lasts_as_long_as_asked_for(runs, end, tmp_path, monkeypatch):
    shown = []
    monkeypatch.setattr(drawing, "blueprint", lambda given: shown.append(given) or layout_blueprint(given))
    run = runs.descent(time=uneven(days=100.0, far=100, close=100))
    run = replace(run, setting=replace(run.setting, duration=run.time[-1] / end, play_duration=25.0))
    record(run, tmp_path / "run.rrd")
    assert run.time[-1] / shown[-1].speed == pytest.approx(25.0)


def layout_blueprint(given):
    from sailviz.recording.drawing.blueprint import blueprint

    return blueprint(given)


@pytest.mark.parametrize("pitch", np.radians([-60, -35, 0, 20, 35, 50]))
def test_the_view_along_with_a_sail_sees_its_sunward_side(runs, pitch):
    run = runs.spiral(rows=3, pitch=pitch)
    eye = unit(layout.follow_eye(Samples.of(run, np.arange(3), Frame.of(run)), "solar-sail"))
    normal = np.array([np.cos(pitch), -np.sin(pitch), 0.0])
    assert -(eye @ normal) > 0.3


def test_the_ends_of_arrows_are_in_sight():
    places = np.random.default_rng(3).normal(size=(50, 3))
    target, direction = np.array([0.1, -0.2, 0.0]), unit(np.array([0.1, -0.9, 0.4]))
    distance = layout.distance_to_see(places, target, direction)
    right = unit(np.cross([0, 0, 1.0], direction))
    up = np.cross(direction, right)
    depth = distance - (places - target) @ direction
    seen = np.maximum(np.abs((places - target) @ up) / 0.47, np.abs((places - target) @ right) / 0.95) / depth
    assert seen.max() == pytest.approx(1.0)


def test_a_craft_that_stands_still_has_no_arrow_of_velocity(runs, tmp_path):
    run = runs.displaced(rows=30)
    still = replace(run, velocity=1e-6 * run.velocity / np.linalg.norm(run.velocity, axis=1, keepdims=True))
    record(still, tmp_path / "still.rrd")
    recording = read(tmp_path / "still.rrd")
    assert np.abs(np.asarray(recording["/world/craft/velocity/arrow"]["vectors"], float)).max() == 0
    assert all(len(place) == 0 for place in recording["/sail/velocity/name"]["positions"])


def test_a_primer_vector_is_an_arrow_of_its_own(runs, tmp_path):
    run = runs.spiral(rows=40)
    primer = unit(run.velocity + 0.3 * unit(run.position) * np.linalg.norm(run.velocity, axis=1, keepdims=True))
    record(replace(run, environment={"primer_direction": primer}), tmp_path / "run.rrd")
    recording = read(tmp_path / "run.rrd")
    drawn = np.asarray(recording["/world/craft/primer/arrow"]["vectors"], float)
    assert np.abs(drawn - primer).max() < 1e-6
    near = np.asarray(recording["/sail/primer"]["vectors"], float)
    in_frame = np.einsum("nji,nj->ni", rtn(run.position, run.velocity), primer)
    assert np.abs(unit(near) - in_frame).max() < 1e-6


def test_a_scene_can_expect_what_acted_on_a_low_orbit(runs):
    run = with_everything(runs.descent(rows=20))
    names = spellings()
    assert np.allclose(names["tether_power_W"].of(run), run.environment["tether_power_W"])
    assert np.allclose(names["tether_current_mA"].of(run), 1e3 * run.environment["tether_current_A"])
    assert np.array_equal(names["sunlit"].of(run), run.environment["sunlit"])
    e = run.elements
    expected = (e.semi_major_axis * (1 - e.eccentricity) - RADIUS) / 1e3
    assert np.allclose(names["perigee_altitude_km"].of(run), expected)
    assert np.isnan(names["tether_power_W"].of(runs.displaced(rows=5))).all()


@pytest.mark.skipif(not has_vulkan(), reason="no Vulkan driver: apt-get install libvulkan1 mesa-vulkan-drivers")
def test_the_views_of_a_low_orbit_show_its_colours(years, tmp_path):
    _, path = years
    seen = {}
    with Studio(path, size=(640, 440)) as studio:
        for view, at in (("Earth", 0.1), ("Earth", 0.9), ("Descent", 0.1), ("Descent", 0.9), ("Tether close", 0.5)):
            report = studio.shoot(tmp_path / "view.png", view=view, at=at)
            assert report.errors == report.warnings == (), view
            seen[view, at] = np.asarray(Image.open(report.path).convert("RGB"), int)
    red, green, blue = np.moveaxis(seen["Descent", 0.9], -1, 0)
    assert np.mean((red > 60) & (blue > green + 30) & (red > green + 10)) > 0.05, "no violet band"
    for at, warm in ((0.1, False), (0.9, True)):  # the bright orbit: blue at the start, orange near the end
        red, green, blue = np.moveaxis(seen["Descent", at], -1, 0)
        line = (red > 215) & (green > 120) & (blue < 200) if warm else (blue > 225) & (red < 160) & (green > 150)
        assert line.sum() > 150, f"no bright orbit at {at}"
    assert np.mean(np.abs(seen["Earth", 0.1] - seen["Earth", 0.9]).max(-1) > 24) > 0.05, "the Earth does not turn"
