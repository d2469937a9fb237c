"""Ensembles: flights, ellipses, bands and histograms against /ensemble, in space, in plots and in planes of arrival."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicSpline

from .facts import AU, unit
from .measure import ULP, hue, same_number, same_place
from .plots import UNITS, in_range, unit_of
from .seen import shown

MILLI_AU = AU / 1000
BESIDE = 1.004  # the nominal path is drawn so much large: on the craft's own trail it would tear
PATHS = 40  # of an ensemble that are drawn
LEVELS = 2  # bands of percentiles on each side of the median


class Ensemble:
    """One ensemble in cylindrical coordinates about the axis of its motion: n times, k flights."""

    def __init__(self, f, name):
        table, self.facts = f.truth.recording[f"/ensemble/{name}"], f.truth.recording[f"/ensemble/{name}/facts"]
        self.table, self.steps, self.time = table, table.timeline("step"), table["time_s"]
        self.nominal = table["nominal_position_m"]
        self.planar = "radius_m" in table
        axis = unit(np.cross(f.truth.position[0], f.truth.velocity[0])) if self.planar else np.array([0.0, 0, 1])
        out = unit(self.nominal[0] - self.nominal[0] @ axis * axis)
        self.axes = np.stack([out, np.cross(axis, out), axis])
        self.kept = table["kept_position_m"].reshape(len(self.time), -1, 3)
        self.mean = table["mean_position_m"]
        self.covariance = table["covariance_m2"].reshape(-1, 3, 3)
        self.levels = np.ravel(self.facts["levels"])

    def cylindrical(self, places) -> np.ndarray:
        """(..., 3): distance from the axis, azimuth less that of the nominal flight, height. Times come first."""
        local = places @ self.axes.T
        nominal = self.nominal @ self.axes.T
        start = np.arctan2(nominal[:, 1], nominal[:, 0]).reshape(-1, *[1] * (local.ndim - 2))
        angle = np.arctan2(local[..., 1], local[..., 0]) - start
        return np.stack(
            [np.hypot(local[..., 0], local[..., 1]), (angle + np.pi) % (2 * np.pi) - np.pi, local[..., 2]], -1
        )

    @property
    def nominal_distance(self) -> np.ndarray:
        return np.hypot(*(self.nominal @ self.axes.T).T[:2])


@cache
def ensemble(f, name) -> Ensemble:
    return Ensemble(f, name)


def joined(f, entity, expected, color, tolerance=None):
    """Broken lines that join on: lines (times, k, 3) of k flights up to each row, in view units."""
    steps, groups = f.picture.rows(entity, "LineStrips3D:strips")
    times, true = expected
    done = 0
    for step, group in zip(steps, groups, strict=True):
        row = int(np.flatnonzero(times == step)[0])
        assert len(group) == true.shape[1]
        same_place(np.array(group), np.swapaxes(true[done : row + 1], 0, 1), size=np.abs(true).max())
        done = row
    assert done == len(times) - 1
    assert hue(f.picture.color(entity, "LineStrips3D:colors")[0]) == color


def color_of(f, name) -> str:
    """The word that the description has for an ensemble's colour."""
    return color_of_table(f, f.truth.recording[f"/ensemble/{name}/facts"]["name"][0])


def color_of_table(f, title) -> str:
    """The word in the line of the description's table that ends in a name."""
    text = f.picture.fixed("/about", "TextDocument:text")[0]
    (line,) = [line for line in text.splitlines() if line.startswith("| **") and line.endswith(f"| {title} |")]
    return line.split("**")[1]


def flights(f, entity, name):
    """Paths of the first forty flights kept, up to each row."""
    e = ensemble(f, name)
    joined(f, entity, (e.steps, e.kept[:, :PATHS] / f.truth.length), color_of(f, name))


def flights_now(f, entity, name):
    """Where they are."""
    e = ensemble(f, name)
    steps, drawn = f.picture.rows(entity, "Points3D:positions")
    assert np.array_equal(steps, e.steps)
    same_place(np.array(drawn), e.kept, f.truth.length)
    assert hue(f.picture.color(entity, "Points3D:colors")[0]) == color_of(f, name)


def mahalanobis(e, row, off) -> np.ndarray:
    """Sigmas of (k, 2) offsets of distance, m, and azimuth, rad, from the mean flight."""
    mean = e.cylindrical(e.mean)[row]
    shape = np.array([1.0, mean[0]])
    covariance = e.covariance[row, :2, :2]
    size = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    scaled = (off - mean[:2]) * shape / size
    return np.sqrt(np.einsum("ki,ij,kj->k", scaled, np.linalg.pinv(covariance / np.outer(size, size)), scaled))


def reaching(e, row) -> float:
    """How round an ellipse is as float32 can draw it: its least axis over the largest coordinate."""
    mean = e.cylindrical(e.mean)[row]
    return float(np.sqrt(max(np.linalg.eigvalsh(e.covariance[row, :2, :2]).min(), 0.0)) / mean[0])


def ellipses(f, entity, name):
    """One, two and three sigmas about the mean flight, of the covariance of distance and way along the orbit."""
    e, length = ensemble(f, name), f.truth.length
    steps, groups = f.picture.rows(entity, "LineStrips3D:strips")
    checked = 0
    for step, group in zip(steps, groups, strict=True):
        row = int(np.flatnonzero(e.steps == step)[0])
        wide = np.sqrt(max(e.covariance[row, 1, 1], 0.0)) / e.cylindrical(e.mean)[row, 0]
        assert len(group) == sum(sigma * wide < 0.8 for sigma in (1, 2, 3))
        for sigma, ring in zip((1, 2, 3), group, strict=False):
            if reaching(e, row) < 300 * ULP:
                continue
            place = cylindrical_of(e, row, np.asarray(ring, float) * length)
            found = mahalanobis(e, row, place[:, :2])
            assert np.abs(found - sigma).max() < 0.02 * sigma + 3 * ULP / reaching(e, row), f"{found.max():.3g} sigma"
            checked += 1
    assert checked or not any(reaching(e, row) >= 300 * ULP for row in range(len(e.steps)))
    assert hue(f.picture.color(entity, "LineStrips3D:colors")[0]) == color_of(f, name)


def cylindrical_of(e, row, places) -> np.ndarray:
    local, nominal = places @ e.axes.T, e.axes @ e.nominal[row]
    angle = np.arctan2(local[:, 1], local[:, 0]) - np.arctan2(nominal[1], nominal[0])
    return np.stack([np.hypot(local[:, 0], local[:, 1]), (angle + np.pi) % (2 * np.pi) - np.pi, local[:, 2]], 1)


def first_ensemble(f) -> Ensemble:
    """All ensembles have the same nominal flight."""
    names = [n.split("/")[2] for n in f.picture.entities if n.startswith("/ensemble/") and n.count("/") == 2]
    for name in names[1:]:
        same_place(ensemble(f, name).nominal, ensemble(f, names[0]).nominal)
    return ensemble(f, names[0])


def nominal_path(f, entity):
    """The nominal flight, 0.4 % large."""
    e = first_ensemble(f)
    joined(f, entity, (e.steps, BESIDE * e.nominal[:, None] / f.truth.length), "white")


def nominal_place(f, entity):
    """Where it is."""
    e = first_ensemble(f)
    steps, drawn = f.picture.rows(entity, "Points3D:positions")
    assert np.array_equal(steps, e.steps)
    same_place(np.array(drawn)[:, 0], e.nominal, f.truth.length)


def nominal_name(f, entity):
    """Its name, outwards of it."""
    e = first_ensemble(f)
    rows, drawn = zip(*shown(f, entity), strict=True)
    calm = between(f, e, e.nominal)[list(rows)]
    off = np.array(drawn) * f.truth.length - calm
    assert np.degrees(np.arccos(np.clip(np.sum(unit(off) * unit(calm), 1), -1, 1))).max() < 0.1
    assert f.picture.fixed(entity, "Points3D:labels") == ["calm flight"]


def between(f, e, places):
    """Places (m, 3) of an ensemble's times at the rows, (n, 3)."""
    x, y, z = (places @ e.axes.T).T
    at = [np.interp(f.truth.time, e.time, c) for c in (np.hypot(x, y), np.unwrap(np.arctan2(y, x)), z)]
    return np.stack([at[0] * np.cos(at[1]), at[0] * np.sin(at[1]), at[2]], 1) @ e.axes


def nominal_of(e, key):
    """(n,) what is taken off a quantity, SI; None where that is nothing, NaN where the recording does not have it."""
    if key in ("radius_m", "axis_distance_m"):
        return e.nominal_distance
    if key == "height_m":
        return e.nominal @ e.axes[2]
    if key == "azimuth_rad":
        local = e.nominal @ e.axes.T
        return np.unwrap(np.arctan2(local[:, 1], local[:, 0]))
    if key.endswith("speed_m_s"):
        return nominal_speed(e, key)
    return None


def nominal_speed(e, key) -> np.ndarray:
    """By a spline through the nominal places, but for the end, which is recorded."""
    local = e.nominal @ e.axes.T
    pace = CubicSpline(e.time, local)(e.time, 1)
    out = unit(local * [1, 1, 0])
    across = np.stack([-out[:, 1], out[:, 0], 0 * out[:, 0]], 1)
    speed = np.sum(pace * (out if key.startswith("radial") else across), axis=1)
    speed[-1] = np.ravel(e.facts[f"nominal_end_{key}"])[0]
    return speed


def plotted(f, entity, e, key, values):
    """A column as its plot shows it, and how far that may be off: nothing, but for speeds within the run."""
    factor, nominal = UNITS[unit_of(f, entity)], nominal_of(e, key)
    true = factor * (values if nominal is None else values - nominal)
    allowed = np.full(len(true), 1e-9 * np.abs(factor * values).max() + 1e-300)
    if key.endswith("speed_m_s"):  # of the nominal flight's speeds the recording has only the last
        true[0] = 0.0  # all flights begin alike
        allowed[1:-1] = 0.03 * factor * np.abs(nominal_speed(e, "transverse_speed_m_s")).max()
    return true, allowed


def close(drawn, true, allowed):
    off = np.abs(np.asarray(drawn) - true)
    assert np.all(off <= allowed), f"off by {off.max():.4g}"


def shown_color(f, key, name) -> str:
    """Of a plot: the ensemble's, but violet for a wind that all share."""
    names = [n.split("/")[2] for n in f.picture.entities if n.startswith("/ensemble/") and n.count("/") == 2]
    facts = [ensemble(f, n).facts for n in names]
    same = len({(fact["wind"][0], int(fact["seed"][0])) for fact in facts}) == 1
    return "violet" if key == "solar_wind_pressure_Pa" and same else color_of(f, name)


def band(f, entity, key, name, number):
    """Between two percentiles, as mean and squared half width."""
    e, k = ensemble(f, name), int(number)
    values = np.array(f.picture.rows(entity, "Measurements:values")[1])[:, 0]
    half = np.sqrt(np.array(f.picture.rows(entity, "Measurements:variances")[1])[:, 0])
    low, allowed = plotted(f, entity, e, key, e.table[key][:, k])
    high, _ = plotted(f, entity, e, key, e.table[key][:, len(e.levels) - 1 - k])
    close(values - half, low, allowed)
    close(values + half, high, allowed)
    same_number(half, (high - low) / 2, 1e-6)
    title, levels = e.facts["name"][0], e.levels
    assert f.picture.fixed(entity, "Measurements:names") == [f"{title}, {levels[k]:g}-{levels[-1 - k]:g} %"]
    assert hue(f.picture.color(entity, "Measurements:colors")[0]) == shown_color(f, key, name)
    in_range(f, entity, np.concatenate([values - half, values + half]))


def median(f, entity, key, name):
    """The middle percentile."""
    e = ensemble(f, name)
    values = np.array(f.picture.rows(entity, "Scalars:scalars")[1])[:, 0]
    true, allowed = plotted(f, entity, e, key, e.table[key][:, len(e.levels) // 2])
    close(values, true, allowed)
    assert e.levels[len(e.levels) // 2] == 50
    assert f.picture.fixed(entity, "SeriesLines:names") == [f"{e.facts['name'][0]}, median"]
    assert hue(f.picture.color(entity, "SeriesLines:colors")[0]) == shown_color(f, key, name)
    in_range(f, entity, values)


def one_flight(f, entity, key, name):
    """What drove the first flight."""
    e = ensemble(f, name)
    values = np.array(f.picture.rows(entity, "Scalars:scalars")[1])[:, 0]
    same_number(values, UNITS[unit_of(f, entity)] * e.table[f"one_{key}"])
    assert f.picture.fixed(entity, "SeriesLines:names") == [f"{e.facts['name'][0]}, one flight"]


def saturated(f, entity, name):
    """The share of the flights at the largest voltage."""
    e = ensemble(f, name)
    values = np.array(f.picture.rows(entity, "Scalars:scalars")[1])[:, 0]
    same_number(values, UNITS[unit_of(f, entity)] * e.table["saturated"])
    assert f.picture.fixed(entity, "SeriesLines:names") == [e.facts["name"][0]]


LIMITS = {
    "maximum_voltage": ("maximum_voltage_V", "largest voltage", "red"),
    "nominal_voltage": ("nominal_voltage_V", "nominal voltage", "grey"),
    "saturation_pressure": ("saturation_pressure_Pa", "saturates below", "red"),
    "reference_pressure": ("reference_pressure_Pa", "nominal pressure", "grey"),
}


def limit(f, entity, key, what):
    """A horizontal line at one of the limits of an ensemble, or red above the largest voltage."""
    name, value = what.rsplit("_", 1)
    names = [n.split("/")[2] for n in f.picture.entities if n.startswith("/ensemble/") and n.count("/") == 2]
    column, words, color = LIMITS.get(name, ("maximum_voltage_V", "saturated", "red"))
    known = [float(ensemble(f, n).facts[column][0]) for n in names if column in ensemble(f, n).facts]
    true = min(known, key=lambda number: abs(number - float(value)))
    assert f"{true:.6g}" == value
    factor = UNITS[unit_of(f, entity)]
    if name == "beyond":
        middle = np.array(f.picture.rows(entity, "Measurements:values")[1])[:, 0]
        half = np.sqrt(np.array(f.picture.rows(entity, "Measurements:variances")[1])[:, 0])
        same_number(middle - half, factor * true)
        assert (middle + half > 1.1 * factor * true).all()
        assert hue(f.picture.color(entity, "Measurements:colors")[0]) == color
        return
    same_number(np.array(f.picture.rows(entity, "Scalars:scalars")[1])[:, 0], factor * true)
    assert f.picture.fixed(entity, "SeriesLines:names") == [f"{words}, {factor * true:.4g}"]
    assert hue(f.picture.color(entity, "SeriesLines:colors")[0]) == color


def buffer(value) -> np.ndarray:
    """Numbers of a tensor as Rerun stores them."""
    (tensor,) = value if isinstance(value, list) else [value]
    return np.asarray(tensor["buffer"] if isinstance(tensor, dict) else tensor, float)


def histogram(f, entity, name):
    """Per cent of the flights over their distance from the calm one, in sixteen bins from nothing to the farthest; the
    ensembles' bars stand side by side in each."""
    e = ensemble(f, name)
    (view,) = [view for view in f.picture.views if view.shows(entity)]
    assert view.name == "Flights [%] by distance from the calm flight [0.001 au]"
    edges = np.ravel(e.facts["histogram_edges_m"]) / MILLI_AU
    centres = buffer(f.picture.fixed(entity, "BarChart:abscissa"))
    wide = np.ravel(f.picture.fixed(entity, "BarChart:widths"))
    step = np.diff(centres).mean()
    others = [n for n in f.picture.entities if n.startswith("/flights/")]
    first = min(buffer(f.picture.fixed(other, "BarChart:abscissa"))[0] for other in others)
    last = max(buffer(f.picture.fixed(other, "BarChart:abscissa"))[0] for other in others)
    assert last - first + wide.max() <= step * 1.001, "bars of two bins overlap"
    taken = sorted((buffer(f.picture.fixed(other, "BarChart:abscissa"))[0]) for other in others)
    assert all(b - a >= wide.max() * 0.999 for a, b in pairwise(taken)), "bars hide each other"
    bins = step * np.arange(len(centres) + 1)
    assert np.all((centres > bins[:-1]) & (centres < bins[1:]))
    own = 0.5 * (edges[1:] + edges[:-1])
    place = np.clip(np.floor(own / step + 1e-6).astype(int), 0, len(centres) - 1)
    steps, charts = f.picture.rows(entity, "BarChart:values")
    rows = np.searchsorted(e.steps, steps)
    shares = np.stack([e.table["histogram"][rows][:, place == b].sum(1) for b in range(len(centres))], 1)
    same_number(np.array([buffer(chart) for chart in charts]), 100 * shares)
    assert np.allclose(100 * shares.sum(1), 100.0)
    assert hue(f.picture.color(entity, "BarChart:color")[0]) == color_of(f, name)


def widest_name(f, entity):
    """Names the widest ensemble, inwards of its mean, once that is a twentieth of the reach off the calm flight."""
    (text,) = f.picture.fixed(entity, "Points3D:labels")
    names = [n.split("/")[2] for n in f.picture.entities if n.startswith("/ensemble/") and n.count("/") == 2]
    widths = {n: np.sqrt(ensemble(f, n).covariance[-1, 0, 0]) for n in names}
    name = max(widths, key=widths.get)
    e = ensemble(f, name)
    assert text == f"flights with {e.facts['name'][0]}"
    mean = between(f, e, e.mean)
    away = np.linalg.norm(mean - between(f, e, e.nominal), axis=1)
    wide = 0.05 * np.linalg.norm(e.nominal, axis=1).max()
    found = shown(f, entity)
    assert len(found) > 0.5 * np.sum(away > wide), "it is left out more often than it is in the way"
    for row, spot in found:
        assert away[row] > 0.98 * wide
        assert np.linalg.norm(spot - 0.86 * mean[row] / f.truth.length) < 1e-3 * np.linalg.norm(spot)
