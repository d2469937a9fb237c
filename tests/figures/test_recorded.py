"""Figures of a recording: each line is read back from the figure and compared with the recording's own rows."""

from __future__ import annotations

import numpy as np
import pytest
from click.testing import CliRunner

pytest.importorskip("matplotlib")

from sailviz import load_scene, record, simulate
from sailviz.cli import main
from sailviz.constants import AU
from sailviz.elements import elements
from sailviz.ephemeris import planet_orbit
from sailviz.figures import FigureError, draw_recording, page
from sailviz.figures.recorded import curves_page, orbit_page, over_page
from sailviz.figures.recorded_curves import BINS, broken, curve_of, telling, thinned
from sailviz.recording import read, record_trajectory
from sailviz.recording.drawing import style as colors
from sailviz.recording.recorded_run import run_of

DAY, MU_SUN = 86400.0, 1.32712440018e20


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    """A quarter of an ellipse from 1 au outwards, inclined by 10 degrees."""
    path = tmp_path_factory.mktemp("figures") / "flight.data"  # a name that does not tell what it is
    time = np.linspace(0, 150 * DAY, 301)
    angle = np.linspace(0, 2.2, 301)
    r = AU * (1 + 0.2 * angle)
    tilt = np.radians(10)
    position = np.stack([r * np.cos(angle), r * np.sin(angle) * np.cos(tilt), r * np.sin(angle) * np.sin(tilt)], 1)
    velocity = np.gradient(position, time, axis=0, edge_order=2)
    record_trajectory(time, position, velocity, path, title="A way outwards")
    return path, time, position, velocity


def composed(made, style="dark"):
    entry, options = made
    return page.compose(entry, style, options)


def line(axes, gid):
    return next(one for one in axes.lines if one.get_gid() == gid)


@pytest.mark.parametrize("style", ["dark", "light"])
def test_curves_are_the_rows_in_the_units_that_their_titles_say(flight, style):
    path, time, position, velocity = flight
    recording = read(path)
    run = run_of(recording)
    names = ["radius", "radius_km", "speed", "inclination"]
    drawn = composed(curves_page(recording, run, [curve_of(run, name) for name in names]), style)
    away, speed = np.linalg.norm(position, axis=1), np.linalg.norm(velocity, axis=1)
    wanted = {
        "radius": ("Distance from the Sun [au]", away / AU),
        "radius_km": ("Distance from the Sun [km]", away / 1e3),
        "speed": ("Speed [km/s]", speed / 1e3),
        "inclination": ("Inclination [°]", np.degrees(elements(position, velocity, MU_SUN).inclination)),
    }
    for axes, name in zip(drawn.axes, names, strict=True):
        x, y = line(axes, name).get_data()
        words, values = wanted[name]
        assert axes.get_title(loc="left") == words
        np.testing.assert_allclose(x, time / DAY, rtol=1e-12)
        np.testing.assert_allclose(y, values, rtol=1e-9)
    assert drawn.axes[-1].get_xlabel() == "time since the start [d]"


def test_what_one_of_several_devices_adds_is_drawn_by_its_name_in_the_color_of_its_kind(tmp_path):
    scene = load_scene("hybrid/pole-sitter-like", {"propagation.duration_yr": 0.1, "propagation.outputs": 21})
    flown = simulate(scene)
    record(flown, tmp_path / "two.rrd")
    run = run_of(read(tmp_path / "two.rrd"))
    for name, device, size in (
        ("thrust/sail", "sail", 1e-3),
        ("thrust/ion_engine", "ion engine", 1e-3),
        ("thrust/ion engine_um_s2", "ion engine", 1e-6),
    ):
        curve = curve_of(run, name)
        np.testing.assert_allclose(curve.values, flown.devices[device].magnitude / size, rtol=1e-12)
        assert curve.words == f"Push of the {device} [{'mm/s²' if size == 1e-3 else 'µm/s²'}]"
        assert list(curve.color) == list(colors.DEVICES["solar-sail" if device == "sail" else "thruster"])
    assert (curve.values * 1e-6)[0] == pytest.approx(0.0623425454669534e-3)
    with pytest.raises(FigureError, match='Did you mean "thrust/sail"'):
        curve_of(run, "thrust/sial")
    with pytest.raises(FigureError, match="there is no quantity 'thrust/sail_km'"):
        curve_of(run, "thrust/sail_km")


def test_the_orbit_from_the_pole_is_x_and_y_with_the_rings_of_planets_near_it(flight):
    path, _, position, _ = flight
    recording = read(path)
    run = run_of(recording)
    axes = composed(orbit_page(recording, run, [])).axes[0]
    x, y = line(axes, "flight").get_data()
    np.testing.assert_allclose([x, y], position[:, :2].T / AU, rtol=1e-12)
    for gid, row in (("start", 0), ("end", -1)):
        np.testing.assert_allclose(np.ravel(line(axes, gid).get_data()), position[row, :2] / AU, rtol=1e-12)
    ring = planet_orbit("Earth", run.setting.epoch) / AU
    np.testing.assert_allclose(line(axes, "orbit of Earth").get_data(), ring[:, :2].T, rtol=1e-12)
    assert {"orbit of Mars", "orbit of Mercury"} <= {one.get_gid() for one in axes.lines}
    assert not any(one.get_gid() == "orbit of Jupiter" for one in axes.lines)
    assert axes.get_aspect() == 1


def test_a_low_orbit_is_drawn_as_its_ellipses_over_the_ground(tmp_path):
    radius, mu = 6_378_137.0, 3.986004415e14
    angle = np.linspace(0, 12 * np.pi, 400)
    height = 700e3 - 50e3 * angle / angle[-1]
    r = radius + height
    time = angle * np.sqrt(r[0] ** 3 / mu)
    position = np.stack([r * np.cos(angle), 0 * r, r * np.sin(angle)], 1)
    velocity = np.sqrt(mu / r)[:, None] * np.stack([-np.sin(angle), 0 * r, np.cos(angle)], 1)
    record_trajectory(time, position, velocity, tmp_path / "low.rrd", mu=mu)
    recording = read(tmp_path / "low.rrd")
    drawn = composed(orbit_page(recording, run_of(recording), []))
    x, y = line(drawn.axes[0], "end").get_data()
    np.testing.assert_allclose(np.hypot(x, y), r[-1] / 1e3, rtol=1e-6)
    x, y = line(drawn.axes[1], "mean_altitude_km").get_data()
    np.testing.assert_allclose(y, height / 1e3, rtol=1e-6)


def test_a_quantity_has_the_colour_of_the_recording_and_on_white_one_of_the_same_hue_that_can_be_read(flight):
    dark, light = (page.Pen(page.STYLES[name]) for name in ("dark", "light"))
    run = run_of(read(flight[0]))
    for name, key in (("radius", "distance"), ("speed", "speed"), ("inclination", "inclination")):
        color = colors.QUANTITY[key]
        assert curve_of(run, name).color == color
        assert dark.readable(color) == "#" + "".join(f"{part:02x}" for part in color)
    for color in [*colors.QUANTITY.values(), *page.DEVICES.values()]:
        said = light.readable(color)
        share = np.array([int(said[k : k + 2], 16) for k in (1, 3, 5)]) / 255
        assert 1.05 / (page.luminance(share) + 0.05) > 2.95
        np.testing.assert_allclose(share / share.max(), np.array(color) / max(color), atol=0.02)


def test_thinned_lines_keep_every_extreme_and_angles_do_not_run_across_the_page():
    time = np.linspace(0, 1, 50_000)
    values = np.sin(9000 * time)
    values[31_234] = 7.0
    t, v = thinned(time, values)
    assert len(t) <= 2 * BINS + 2
    assert v.max() == 7.0
    assert v.min() == values.min()
    assert np.all(np.diff(t) > 0)
    assert np.isnan(broken(np.array([350.0, 359.0, 2.0, 5.0]), 360.0)).tolist() == [False, False, True, False]


def test_what_does_not_change_is_not_drawn_unasked(flight):
    run = run_of(read(flight[0]))
    assert "radius" in telling(run)
    assert "thrust_acceleration" not in telling(run)


@pytest.mark.parametrize("ending", ["svg", "pdf", "png"])
def test_files_are_the_same_every_time(flight, tmp_path, ending):
    files = [draw_recording(flight[0], tmp_path / f"{k}.{ending}", ["radius"], style="light") for k in range(2)]
    assert files[0].read_bytes() == files[1].read_bytes()


def test_the_command_tells_recordings_from_names_and_refuses_in_a_sentence(flight, tmp_path):
    def said(*words):
        result = CliRunner().invoke(main, ["figure", *map(str, words)])
        assert result.exception is None or isinstance(result.exception, SystemExit)
        return result.exit_code, result.output + result.stderr

    out = tmp_path / "a.svg"
    code, words = said(flight[0], "-o", out, "--quantity", "radius")
    assert (code, out.read_text()[:5]) == (0, "<?xml")
    assert f"Drew {out}" in words
    for wrong, sentence in (
        ([flight[0], "-o", out, "--quantity", "raduis"], 'Did you mean "radius"?'),
        ([flight[0], "-o", out, "--quantity", "plasma_force"], "never a number in this recording"),
        ([flight[0], "-o", out, "--quantity", "closed_form_error"], "a verdict on a whole run"),
        ([flight[0], "-o", tmp_path / "a.docx"], "png, svg, pdf"),
        ([tmp_path / "none.rrd", "-o", out], "none.rrd"),
        (["escape", "-o", out, "--orbit"], "for recordings"),
        ([flight[0], "-o", out, "--series", "wind.csv"], "for wind-fit"),
        (["flihgt", "-o", out], "there is no figure"),
    ):
        code, words = said(*wrong)
        assert code == 2, wrong
        assert sentence in words
        assert "Traceback" not in words
    with pytest.raises(FigureError, match="room for 12"):
        draw_recording(flight[0], out, ["radius"] * 13)


@pytest.fixture(scope="module")
def ageing(tmp_path_factory):
    path = tmp_path_factory.mktemp("figures") / "ageing.rrd"
    record(simulate(load_scene("body/ageing-mercury", {"propagation.outputs": 101})), path)
    return path


def test_temperature_and_dose_are_drawn_over_the_distance_row_by_row(ageing, tmp_path):
    run = run_of(read(ageing))
    drawn = composed(over_page(run, ["film_temperature", "dose"], "radius"))
    away = np.linalg.norm(run.position, axis=1) / AU
    for axes, name, column in zip(drawn.axes, ("film_temperature", "dose"), ("temperature_K", "dose_yr"), strict=True):
        x, y = line(axes, name).get_data()
        np.testing.assert_allclose(x, away, rtol=1e-12)
        np.testing.assert_allclose(y, run.film[column], rtol=1e-12)
        assert line(axes, "end").get_data()[0] == pytest.approx(away[-1])
    assert drawn.axes[-1].get_xlabel() == "Distance from the Sun [au]"
    shell = CliRunner().invoke(main, ["figure", str(ageing), "--over", "radius_au", "-o", str(tmp_path / "over.svg")])
    assert shell.exit_code == 0, shell.output
    for words, sentence in (
        (["--over", "radus"], "radius"),
        (["--over", "radius", "--orbit"], "not over a quantity"),
    ):
        refused = CliRunner().invoke(main, ["figure", str(ageing), *words, "-o", str(tmp_path / "no.svg")])
        assert refused.exit_code == 2
        assert sentence in refused.output
