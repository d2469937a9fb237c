"""Many flights at once: their paths up to now, where they are, ellipses about their mean, percentiles, histograms.

All of it is known when the run begins and written at once. Colours tell clouds apart everywhere; white is the nominal
flight. /arrival shows the flights' distance from it in a plane of azimuth and distance from the Sun, each axis with a
scale of its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import rerun as rr

from sailviz.constants import AU
from sailviz.recording import contract as truth
from sailviz.recording import timelines as rows
from sailviz.recording.contract import word
from sailviz.recording.drawing import style as look
from sailviz.recording.drawing.log import Pen, f4
from sailviz.recording.drawing.plot_column import PlotView, Slot
from sailviz.recording.drawing.plots import nice_range
from sailviz.recording.drawing.samples import Frame
from sailviz.recording.drawing.style import points
from sailviz.run.arrays import EnsembleStatistics, Setting

PIECE = 3  # rows of a cloud in one piece of its paths
RING = 49  # points of an ellipse
SIGMAS = (1.0, 2.0, 3.0)
BOX = 1.0, 0.5  # half width and half height of the plane of arrival, in which its axes are stretched to fit
NARROW = 1e-6  # rad: the least that a plane of arrival is wide
BENT = 0.8  # rad that an ellipse may reach along the orbit to be drawn in space
TUBE_ALPHA = 16
ROOM = 0.08  # of the range, round what must be seen in the plane of arrival
MILLI_AU = AU / 1000
WIDER = 2.5  # how many times the spread of the narrowest cloud that of the widest must be to give it a plane of its own


@dataclass(frozen=True)
class Arrival:
    """A plane of azimuth and distance, both from the nominal flight's, stretched to fit: the ranges, rad and m, that
    fill its width and height."""

    name: str
    path: str
    ahead: tuple[float, float]
    out: tuple[float, float]

    def place(self, azimuth, distance) -> np.ndarray:
        """(..., 2) in the plane of distances from the nominal flight, rad and m."""
        across = (np.asarray(azimuth) - self.ahead[0]) / (self.ahead[1] - self.ahead[0])
        up = (np.asarray(distance) - self.out[0]) / (self.out[1] - self.out[0])
        return np.stack(np.broadcast_arrays(BOX[0] * (2 * across - 1), BOX[1] * (1 - 2 * up)), -1)


@dataclass(frozen=True)
class Band:
    """Percentiles of one quantity as a plot. offset : whether the nominal flight's value is taken off."""

    key: str
    title: str
    factor: float
    column: int | None  # of the nominal state that is taken off, None for none


BANDS = {
    "radius_m": Band("radius_m", "Distance from the Sun less nominal [10⁻³ au]", 1 / MILLI_AU, 0),
    "axis_distance_m": Band("axis_distance_m", "Distance from the axis less nominal [10⁻³ au]", 1 / MILLI_AU, 0),
    "height_m": Band("height_m", "Height less nominal [10⁻³ au]", 1 / MILLI_AU, 2),
    "azimuth_rad": Band("azimuth_rad", "Azimuth less nominal [deg]", 180 / np.pi, 1),
    "transverse_speed_m_s": Band("transverse_speed_m_s", "Transverse speed less nominal [km/s]", 1e-3, 4),
    "radial_speed_m_s": Band("radial_speed_m_s", "Radial speed less nominal [km/s]", 1e-3, 3),
    "thrust_factor": Band("thrust_factor", "Thrust over nominal", 1.0, None),
    "thrust_voltage_V": Band("thrust_voltage_V", "Tether voltage [kV]", 1e-3, None),
    "solar_wind_pressure_Pa": Band("solar_wind_pressure_Pa", "Solar-wind dynamic pressure at 1 au [nPa]", 1e9, None),
    "irradiance_W_m2": Band("irradiance_W_m2", "Irradiance at 1 au [W/m²]", 1.0, None),
    "electrochromic_state": Band("electrochromic_state", "Electrochromic area: 0 black, 1 mirror", 1.0, None),
}
PLACES = ("radius_m", "axis_distance_m", "azimuth_rad", "height_m")
OWN = ("solar_wind_pressure_Pa", "irradiance_W_m2", "thrust_voltage_V", "thrust", "angles")  # the craft's own curves
DRIVERS = ("solar_wind_pressure_Pa", "irradiance_W_m2")
SPEEDS = ("transverse_speed_m_s", "radial_speed_m_s")


def color_of(k: int) -> list[int]:
    """Of the k-th cloud: blue is the craft's own trail."""
    return look.SERIES[1 + k % 4]


def band_values(cloud: EnsembleStatistics, band: Band) -> np.ndarray:
    """Percentiles (m, n) as plotted."""
    values = cloud.percentiles[band.key]
    if band.column is not None:
        values = values - cloud.nominal[:, band.column]
    return band.factor * values


class Clouds:
    """Writes the clouds of a run."""

    def __init__(self, pen: Pen, setting: Setting, frame: Frame):
        self._pen, self._setting, self._frame = pen, setting, frame
        for k, cloud in enumerate(setting.ensembles):
            self._write_truth(cloud)
            self._draw_space(cloud, color_of(k))
            self._draw_plots(cloud, color_of(k), first=k == 0)
            if cloud.method == "monte-carlo":
                self._draw_histogram(cloud, color_of(k))
        self._draw_nominal(setting.ensembles[0])
        self.arrivals = arrivals_of(setting)
        for arrival in self.arrivals:
            self._draw_axes(arrival)
            for k, cloud in enumerate(setting.ensembles):
                self._draw_arrival(arrival, cloud, color_of(k))

    def _index(self, cloud: EnsembleStatistics, some=slice(None)) -> list:
        return rows.timelines(self._setting, cloud.step[some], cloud.time[some])

    def _write_truth(self, cloud: EnsembleStatistics) -> None:
        path = truth.cloud_path(cloud)
        self._pen.columns(path, self._index(cloud), truth.columns(path, truth.cloud_table(cloud)))
        self._pen.static(f"{path}/facts", truth.cloud_facts(cloud))

    def _draw_space(self, cloud: EnsembleStatistics, color) -> None:
        pen, path, unit = self._pen, f"/world/cloud/{word(cloud.name)}", self._frame.unit
        places = cloud.places(cloud.kept) / unit  # (k, n, 3)
        pen.strip_style(f"{path}/flights", look.dim(color, 0.5), look.WIDTH["flight"])
        starts = np.arange(0, len(cloud.time) - 1, PIECE)
        ends = np.minimum(starts + PIECE, len(cloud.time) - 1)
        groups = [list(places[:, a : b + 1]) for a, b in zip(starts, ends, strict=True)]
        pen.broken_strips(f"{path}/flights", self._index(cloud, ends), groups)
        pen.static(
            f"{path}/now",
            rr.Points3D.from_fields(radii=points(look.FLIGHT_DOT), colors=[color], point_shading="flat"),
        )
        now = rr.Points3D.columns(positions=f4(places.transpose(1, 0, 2).reshape(-1, 3)))
        pen.columns(f"{path}/now", self._index(cloud), [*now.partition([len(places)] * len(cloud.time))])
        rings = np.stack([cloud.places(ring) for ring in ellipses(cloud)], axis=1) / unit  # (n, sigmas, RING, 3)
        reach = np.sqrt(np.maximum(cloud.covariance[:, 1, 1], 0.0))[:, None] * SIGMAS
        pen.strip_style(f"{path}/ellipse", color, look.WIDTH["orbit"])
        groups = [list(group[bent < BENT]) for group, bent in zip(rings, reach, strict=True)]
        pen.broken_strips(f"{path}/ellipse", self._index(cloud), groups)
        if cloud.planar:
            self._draw_tube(cloud, color, f"{path}/tube")

    def _draw_tube(self, cloud: EnsembleStatistics, color, path: str) -> None:
        """Percentiles of the distance at the median azimuth."""
        pen, unit = self._pen, self._frame.unit
        levels = len(cloud.levels)
        azimuth = cloud.percentiles["azimuth_rad"][levels // 2]
        radii = cloud.percentiles["radius_m"]
        edges = [cloud.places(np.stack([radius, azimuth, 0 * azimuth], -1)) / unit for radius in radii]
        for k in range(levels // 2):
            low, high = edges[k], edges[-1 - k]
            pen.ribbon(f"{path}/band{k}", low, high, [*color, TUBE_ALPHA])
        pen.lines(f"{path}/median", [edges[levels // 2]], look.dim(color, 0.85), look.WIDTH["past"])
        pen.lines(f"{path}/edges", [edges[0], edges[-1]], look.dim(color, 0.6), look.WIDTH["future"])

    def _draw_nominal(self, cloud: EnsembleStatistics) -> None:
        pen, line = self._pen, cloud.places(cloud.nominal) / self._frame.unit
        pen.strip_style("/world/nominal/path", look.NOMINAL, look.WIDTH["nominal"])
        starts = np.arange(0, len(line) - 1, PIECE)
        ends = np.minimum(starts + PIECE, len(line) - 1)
        beside = 1.004 * line  # a line on the craft's own trail would tear
        strips = [[beside[a : b + 1]] for a, b in zip(starts, ends, strict=True)]
        pen.broken_strips("/world/nominal/path", self._index(cloud, ends), strips)
        pen.static("/world/nominal/place", rr.Points3D.from_fields(radii=points(3.4), colors=[look.NOMINAL]))
        pen.columns("/world/nominal/place", self._index(cloud), rr.Points3D.columns(positions=f4(line)))
        pen.label_style("/world/nominal/name", look.NOMINAL, "nominal")
        outwards = line * (1 + 0.10 * np.abs(line).max() / np.maximum(np.linalg.norm(line, axis=1), 1e-9))[:, None]
        pen.labels("/world/nominal/name", self._index(cloud), outwards)

    def _draw_plots(self, cloud: EnsembleStatistics, color, first: bool) -> None:
        pen, index = self._pen, self._index(cloud)
        names = [f"{level:g}" for level in cloud.levels]
        same_wind = len({(c.wind, c.seed) for c in self._setting.ensembles}) == 1
        for key in cloud.percentiles:
            band = BANDS.get(key)
            if band is None or (key in DRIVERS and same_wind and not first):
                continue
            shown = look.WIND if key == "solar_wind_pressure_Pa" and same_wind else color
            values, path = band_values(cloud, band), f"/plots/ensemble/{key}/{word(cloud.name)}"
            inner = len(names) // 2 if band.column is not None else 1  # what jumps has its outermost band alone
            for k in range(inner):
                low, high = values[k], values[-1 - k]
                if np.max(high - low, initial=0.0) <= 1e-9 * np.max(np.abs(values), initial=0.0):
                    continue  # constant: a line says it
                label = f"{cloud.name}, {names[k]}-{names[-1 - k]} %"
                pen.static(
                    f"{path}/band{k}",
                    rr.Measurements.from_fields(colors=[look.dim(shown, 0.9)], widths=[0.0], names=[label]),
                )
                edges = rr.Measurements.columns(values=(low + high) / 2, variances=((high - low) / 2) ** 2)
                pen.columns(f"{path}/band{k}", index, edges)
            width = look.WIDTH["plot"]
            pen.static(
                f"{path}/median",
                rr.SeriesLines(names=[f"{cloud.name}, median"], colors=[shown], widths=[width]),
            )
            pen.columns(f"{path}/median", index, rr.Scalars.columns(scalars=values[len(values) // 2]))
            if key in (*DRIVERS, "thrust_voltage_V") and np.ptp(cloud.one[key]) > 0:
                style = rr.SeriesLines(names=[f"{cloud.name}, one flight"], colors=[shown], widths=[0.9])
                pen.static(f"{path}/one", style)
                pen.columns(f"{path}/one", index, rr.Scalars.columns(scalars=band.factor * cloud.one[key]))
        if cloud.control in ("pressure", "distance"):
            path = f"/plots/ensemble/saturated/{word(cloud.name)}"
            pen.static(path, rr.SeriesLines(names=[cloud.name], colors=[color], widths=[look.WIDTH["plot"]]))
            pen.columns(path, index, rr.Scalars.columns(scalars=100 * cloud.saturated))
        self._draw_limits(cloud)

    def _draw_limits(self, cloud: EnsembleStatistics) -> None:
        """Horizontal lines: where the voltage ends, and the pressure below which it does."""
        ends = [0, -1]
        index = rows.timelines(self._setting, cloud.step[ends], cloud.time[ends])
        lines = (
            ("thrust_voltage_V", "maximum_voltage_V", 1e-3, "largest voltage", look.FAULT),
            ("thrust_voltage_V", "nominal_voltage_V", 1e-3, "nominal voltage", look.REFERENCE),
            ("solar_wind_pressure_Pa", "saturation_pressure_Pa", 1e9, "saturates below", look.FAULT),
            ("solar_wind_pressure_Pa", "reference_pressure_Pa", 1e9, "nominal pressure", look.REFERENCE),
        )
        for key, limit, factor, name, color in lines:
            value = cloud.limits.get(limit)
            if value is None or (cloud.control != "pressure" and limit == "saturation_pressure_Pa"):
                continue
            path = f"/plots/ensemble/{key}/limits/{limit.rsplit('_', 1)[0]}_{value:.6g}"
            words = f"{name}, {factor * value:.4g}"
            self._pen.static(path, rr.SeriesLines(names=[words], colors=[color], widths=[1.0]))
            self._pen.columns(path, index, rr.Scalars.columns(scalars=[factor * value] * 2))
            if limit == "maximum_voltage_V":  # above it lies what cannot be
                top = 1.2 * value
                path = f"/plots/ensemble/{key}/limits/beyond_{value:.6g}"
                style = rr.Measurements.from_fields(colors=[look.FAULT], widths=[0.0], names=["saturated"])
                self._pen.static(path, style)
                middle, half = 0.5 * factor * (value + top), 0.5 * factor * (top - value)
                self._pen.columns(path, index, rr.Measurements.columns(values=[middle] * 2, variances=[half**2] * 2))

    def _draw_histogram(self, cloud: EnsembleStatistics, color) -> None:
        edges = cloud.histogram_edges / MILLI_AU
        middle = 0.5 * (edges[1:] + edges[:-1])
        self._pen.bars(
            f"/histogram/{word(cloud.name)}", self._index(cloud), 100 * cloud.histogram, middle, [*color, 255]
        )

    def _draw_axes(self, arrival: Arrival) -> None:
        pen, path, style = self._pen, f"{arrival.path}/axes", {"colors": [look.AXES], "radii": points(0.7)}
        origin = arrival.place(0.0, 0.0)
        lines = [arrival.place(np.array(arrival.ahead), 0.0), arrival.place(0.0, np.array(arrival.out))]
        places, names = [], []
        spread_out = arrival.ahead[1] - arrival.ahead[0] > 2 * NARROW  # flights that stand still have one azimuth
        for number in ticks(np.degrees(arrival.ahead)) if spread_out else ():
            at = arrival.place(np.radians(number), 0.0)
            lines.append(np.array([[0.0, -0.012], [0.0, 0.012]]) + at)
            places.append(np.array([0.0, 0.02]) + at)
            names.append(f"{number:+.4g}°")
        for number in ticks(np.array(arrival.out) / MILLI_AU):
            at = arrival.place(0.0, number * MILLI_AU)
            lines.append(np.array([[-0.012, 0.0], [0.012, 0.0]]) + at)
            places.append(np.array([-0.09, -0.03]) + at)
            names.append(f"{number:+.4g}")
        pen.static(path, rr.LineStrips2D([f4(line) for line in lines], **style))
        style = {"radii": points(look.ANCHOR), "colors": [look.REFERENCE], "labels": names, "show_labels": True}
        pen.static(f"{path}/numbers", rr.Points2D(f4(places), **style))
        top = arrival.place(0.0, arrival.out[1])
        words = [[max(top[0], 0.3 - BOX[0]), top[1] - 0.09], [BOX[0] - 0.22, origin[1] - 0.10]]
        style |= {"labels": ["farther out [10⁻³ au]", "ahead"]}
        pen.static(f"{path}/names", rr.Points2D(f4(words), **style))
        pen.static(f"{path}/nominal", rr.Points2D([f4(origin)], radii=points(3.0), colors=[look.NOMINAL]))

    def _draw_arrival(self, arrival: Arrival, cloud: EnsembleStatistics, color) -> None:
        pen, path, index = self._pen, f"{arrival.path}/{word(cloud.name)}", self._index(cloud)

        def plane(states):
            """(..., n, 2) of states (..., n, 3+)."""
            off = states[..., :2] - cloud.nominal[:, :2]
            return arrival.place(off[..., 1], off[..., 0])

        dots = plane(cloud.kept).transpose(1, 0, 2)
        style = rr.Points2D.from_fields(radii=points(look.FLIGHT_DOT + 0.5), colors=[color])
        pen.static(f"{path}/flights", style)
        places = rr.Points2D.columns(positions=f4(dots.reshape(-1, 2))).partition([dots.shape[1]] * len(dots))
        pen.columns(f"{path}/flights", index, [*places])
        rings = [plane(ring.transpose(1, 0, 2)).transpose(1, 0, 2) for ring in ellipses(cloud)]
        shades = (1.0, 0.75, 0.5)
        for k, ring in enumerate(rings):
            pen.static(
                f"{path}/sigma{k + 1}",
                rr.LineStrips2D.from_fields(colors=[look.dim(color, shades[k])], radii=points(1.1)),
            )
            pen.columns(f"{path}/sigma{k + 1}", index, rr.LineStrips2D.columns(strips=f4(ring)))


def ellipses(cloud: EnsembleStatistics) -> list[np.ndarray]:
    """For each sigma the ring (n, RING, 3) of distance and azimuth about their mean, at the mean height: an ellipse in
    these coordinates, bent along the orbit in space."""
    block = cloud.covariance[:, :2, :2]
    scale = np.sqrt(np.maximum(np.diagonal(block, axis1=1, axis2=2), 1e-300))
    size, axes = np.linalg.eigh(block / (scale[:, :, None] * scale[:, None, :]))
    turn = np.linspace(0, 2 * np.pi, RING)
    circle = np.stack([np.cos(turn), np.sin(turn)])  # (2, RING)
    off = np.einsum("nij,nj,jk->nki", axes, np.sqrt(np.maximum(size, 0.0)), circle) * scale[:, None, :]
    rings = []
    for sigma in SIGMAS:
        ring = np.repeat(cloud.mean[:, None, :3], RING, axis=1)
        ring[..., :2] += sigma * off
        rings.append(ring)
    return rings


def arrivals_of(setting: Setting) -> tuple[Arrival, ...]:
    """A plane for all clouds, and one for the narrowest where it would be lost in that."""
    reach = []  # of each cloud: lowest and highest distance and azimuth within three sigma, whenever
    for cloud in setting.ensembles:
        off = cloud.mean[:, :2] - cloud.nominal[:, :2]
        wide = 3.0 * np.sqrt(np.maximum(np.diagonal(cloud.covariance, axis1=1, axis2=2)[:, :2], 0.0))
        reach.append([np.minimum((off - wide).min(axis=0), 0.0), np.maximum((off + wide).max(axis=0), 0.0)])
    reach = np.array(reach)  # (clouds, 2, 2)
    least = np.array([1.0, NARROW])  # m, rad: clouds may have no spread at all
    size = np.maximum(reach[:, 1] - reach[:, 0], least)
    narrow = int(np.argmin(size[:, 0]))

    def plane(name, path, low, high):
        margin = ROOM * np.maximum(high - low, least) + 0.5 * least
        low, high = low - margin, high + margin
        return Arrival(name, path, *((float(low[k]), float(high[k])) for k in (1, 0)))

    planes = [plane("Off nominal", "/arrival/all", reach[:, 0].min(axis=0), reach[:, 1].max(axis=0))]
    if np.all(size[narrow] > 2 * least) and size[:, 0].max() > WIDER * size[narrow, 0]:
        planes.append(plane(f"Near: {setting.ensembles[narrow].name}", "/arrival/near", *reach[narrow]))
    return tuple(planes)


def ticks(ends) -> np.ndarray:
    """Round numbers between two ends, about four of them, 0 and the very ends left out."""
    low, high = ends
    rough = (high - low) / 4
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * max(k for k in (1, 2, 5) if k * power <= rough)
    found = step * np.arange(np.ceil(low / step), np.floor(high / step) + 1)
    inside = (found > low + 0.05 * (high - low)) & (found < high - 0.05 * (high - low))
    return found[inside & (np.abs(found) > 0.5 * step)]


def slots_of(setting: Setting, shown, environment) -> tuple[Slot, ...]:
    """The column of curves of a run with clouds; what the craft itself did stands behind, as tabs."""
    keys = [key for key in BANDS if any(key in cloud.percentiles for cloud in setting.ensembles)]
    own = {plot.paths[0]: plot for plot in (*shown, *(plot for group in environment for plot in group))}

    def view(key: str) -> PlotView:
        values = np.concatenate([band_values(c, BANDS[key]).ravel() for c in setting.ensembles if key in c.percentiles])
        paths = [f"/plots/ensemble/{key}/**"]
        low, high = float(values.min()), float(values.max())
        if key == "thrust_voltage_V":
            limits = [c.limits.get("maximum_voltage_V", 0.0) for c in setting.ensembles]
            low, high = min(low, 0.0), max(high, 1.08e-3 * max(limits))
        if key in DRIVERS:
            driven = [c for c in setting.ensembles if key in c.one]
            one = np.concatenate([BANDS[key].factor * cloud.one[key] for cloud in driven])
            low, high = min(low, one.min()), max(high, one.max())
        low, high = nice_range(low, high)
        return PlotView(BANDS[key].title, tuple(paths), low, high)

    def group(*names) -> list[PlotView]:
        return [view(key) for key in names if key in keys]

    places, speeds = group(*PLACES), group(*SPEEDS)
    acting = group(*DRIVERS)
    setting_it = group("thrust_voltage_V", "electrochromic_state")
    if any(cloud.control in ("pressure", "distance") for cloud in setting.ensembles):
        top = 100 * max(float(cloud.saturated.max()) for cloud in setting.ensembles)
        low, high = nice_range(0.0, max(top, 1.0))
        setting_it.append(PlotView("Flights at the largest voltage [%]", ("/plots/ensemble/saturated/**",), low, high))
    pushing = group("thrust_factor")
    rest = list(own.values())
    flown = [plot for plot in rest if plot.paths[0] == "/plots/distance"]
    own_curves = {path: [plot for plot in rest if plot.paths[0] == f"/plots/{path}"] for path in OWN}
    columns = [
        (places[:2] + speeds[:1] + flown, 3.0),
        (acting + own_curves["solar_wind_pressure_Pa"] + own_curves["irradiance_W_m2"], 2.2),
        (setting_it + own_curves["thrust_voltage_V"], 2.4),
        (pushing + own_curves["thrust"] + own_curves["angles"], 2.2),
    ]
    return tuple(Slot(tuple(plots), share) for plots, share in columns if plots)


def scoreboard(setting: Setting) -> list[str]:
    """Lines of Markdown: how far each cloud ends from the nominal flight, mean ± standard deviation."""
    if not setting.ensembles:
        return []
    lines = ["", "| end − nominal | r, 10⁻³ au | azimuth, ° | out, km/s | across, km/s |", "|---|---|---|---|---|"]
    factors = {0: 1 / MILLI_AU, 1: 180 / np.pi, 3: 1e-3, 4: 1e-3}
    for cloud in setting.ensembles:
        off = cloud.end_mean - cloud.nominal[-1]
        cells = [spread(off[k] * factor, cloud.end_deviation[k] * factor) for k, factor in factors.items()]
        lines.append(f"| **{cloud.name}** | {' | '.join(cells)} |")
    return lines


def legend(setting: Setting) -> list[str]:
    """What the colours mean, one line each."""
    names = {0: "orange", 1: "green", 2: "pink", 3: "violet"}
    lines = []
    for k, cloud in enumerate(setting.ensembles):
        flights = f"{cloud.flights:,} flights" + (", gPC" if cloud.method == "polynomial-chaos" else "")
        lines.append(f"**{names[k % 4]}**: {cloud.name} ({cloud.words}; {flights})")
    return lines


def spread(mean: float, deviation: float) -> str:
    """Mean ± deviation, the deviation with two digits and the mean as exactly."""
    if max(abs(mean), abs(deviation)) < 1e-6:
        return "0"
    size = max(abs(deviation), 1e-3 * abs(mean), 1e-12)
    digits = int(np.clip(1 - np.floor(np.log10(size)), 0, 6))
    return f"{mean:+.{digits}f} ± {deviation:.{digits}f}".replace("-", "−")
