"""The views of a recording, from its layout: on the left space, the craft and words, on the right the curves."""

from __future__ import annotations

import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint.archetypes import PlotBackground, TextLogColumns
from rerun.blueprint.encodings import TextLogColumn, TextLogColumnKind, TimelineColumn

from sailviz.recording.drawing.arrival_plane import BOX, Arrival
from sailviz.recording.drawing.cameras import Camera
from sailviz.recording.drawing.layout import DESCENT, TUBE, Layout
from sailviz.recording.drawing.plot_column import PlotView
from sailviz.recording.drawing.style import BACKGROUND

View = rrb.View | rrb.Container
Overrides = dict[rr.encodings.EntityPath | str, rrb.VisibleTimeRanges | rrb.EntityBehavior]
ENDLESS = rrb.TimeRangeBoundary.infinite()
NOW = rrb.TimeRangeBoundary.cursor_relative()
WHOLE_TIME = rrb.TimeAxis(view_range=rr.TimeRange(start=ENDLESS, end=ENDLESS))


def blueprint(layout: Layout) -> rrb.Blueprint:
    """The blueprint of a recording."""
    return rrb.Blueprint(
        arrange(layout),
        rrb.TimePanel(
            state="collapsed",
            timeline=layout.timeline,
            playback_speed=layout.speed,
            play_state="paused",
            loop_mode="all",
        ),
        rrb.SelectionPanel(state="hidden"),
        rrb.BlueprintPanel(state="hidden"),
        auto_views=False,
        auto_layout=False,
    )


def arrange(layout: Layout) -> rrb.Container:
    """Left: cameras as tabs over close-up and words. Right: curves over lanes."""
    words = rrb.Tabs(
        rrb.TextDocumentView(origin="/about", name="About"),
        rrb.TextLogView(origin="/log", name="Events", columns=event_columns(layout)),
        active_tab=0,
    )
    below: View = close_view(layout.close_up)
    if layout.arrivals:
        below = rrb.Tabs(*(arrival_view(arrival) for arrival in layout.arrivals), below, active_tab=0)
    left = rrb.Vertical(
        rrb.Tabs(*(space_view(layout, camera) for camera in layout.cameras), active_tab=0),
        rrb.Horizontal(below, words, column_shares=[1, 1] if layout.arrivals else [3, 2]),
        row_shares=[4, 3],
    )
    right: list[View] = []
    shares: list[float] = []
    for slot in layout.slots:
        plots = [plot_view(plot) for plot in slot.plots]
        right.append(plots[0] if len(plots) == 1 else rrb.Tabs(*plots, active_tab=0))
        shares.append(slot.share)
    if layout.arrivals:
        name = "Flights by distance from nominal [% over 10⁻³ au]"
        right.append(rrb.BarChartView(origin="/histogram", contents=["+ /histogram/**"], name=name))
        shares.append(2.0)
    if layout.lanes:
        lanes = [f"+ /phase/{lane}" for lane in layout.lanes]
        right.append(rrb.StateTimelineView(origin="/phase", contents=lanes, name="Phases", time_view=WHOLE_TIME))
        shares.append(layout.lane_share)
    return rrb.Horizontal(left, rrb.Vertical(*right, row_shares=shares), column_shares=[5, 3])


def event_columns(layout: Layout) -> TextLogColumns:
    """Only the line itself, which says when; the viewer's own time column is too narrow for a date."""
    kinds = [TextLogColumn(kind, visible=kind == TextLogColumnKind.Body) for kind in TextLogColumnKind]
    times = [TimelineColumn(name, visible=False) for name in layout.timelines]
    return TextLogColumns(timeline_columns=times, text_log_columns=kinds)


def space_view(layout: Layout, camera: Camera) -> rrb.Spatial3DView:
    """The system, from one of its cameras."""
    contents = ["+ /world/**", "- /world/plane/**", "+ /world/plane/shells/**"]
    contents += [f"- {path}/**" for path in layout.hidden]
    if layout.arrivals:
        contents += ["- /world/cloud/**"]
        kinds = ("tube",) if camera.name == TUBE else ("flights", "now", "ellipse")
        contents += [f"+ /world/cloud/{name}/{kind}/**" for name in layout.ensembles for kind in kinds]
    if camera.name == DESCENT:
        contents = [f"+ /world/{name}/**" for name in ("stars", "plane", "center", "night")]
        contents += ["- /world/night/umbra", "- /world/night/sunlight/**"]
        contents += [f"- /world/center/air/shell{k}" for k in range(1, 4)]  # their heights are for the eye only
    if camera.name == "Follow":
        contents += ["- /world/names/**", "- /world/night/umbra"]  # labels show through; the umbra's wall would be near
    return rrb.Spatial3DView(
        name=camera.name,
        origin=camera.origin,
        contents=contents,
        background=BACKGROUND,
        line_grid=rrb.LineGrid3D(visible=False),
        overrides=trail_ranges(layout),
        eye_controls=eye(camera),
    )


def arrival_view(arrival: Arrival) -> rrb.Spatial2DView:
    """A plane of arrival."""
    (x, y), margin = BOX, 1.12
    return rrb.Spatial2DView(
        name=arrival.name,
        origin=arrival.path,
        contents=[f"+ {arrival.path}/**"],
        background=BACKGROUND,
        visual_bounds=rrb.VisualBounds2D(x_range=[-margin * x, margin * x], y_range=[-margin * y, margin * y]),
    )


def close_view(camera: Camera) -> rrb.Spatial3DView:
    """The craft from close by."""
    return rrb.Spatial3DView(
        name=camera.name,
        origin=camera.origin,
        contents=["+ /sail/**"],
        background=BACKGROUND,
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=eye(camera),
    )


def eye(camera: Camera) -> rrb.EyeControls3D:
    """Where a view looks from."""
    return rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital, position=camera.position, look_target=camera.target, eye_up=camera.up
    )


def trail_ranges(layout: Layout) -> Overrides:
    """Which part of the run each part of the trail shows. The parts do not overlap: lines on one another tear."""
    ranges: Overrides = {
        "/world/trail/past": time_range(layout, -layout.past if layout.past else None, -layout.tail),
        "/world/trail/recent": time_range(layout, -layout.tail, 0.0),
        "/world/ladder": time_range(layout, None, None),
        "/world/plane/ladder": time_range(layout, None, None),
        "/world/plane/rungs": time_range(layout, None, None),
        "/world/nominal/path": time_range(layout, None, 0.0),
    }
    ranges |= {f"/world/cloud/{name}/flights": time_range(layout, None, 0.0) for name in layout.ensembles}
    if layout.future:
        ranges["/world/trail/future"] = time_range(layout, 0.0, None)
    else:
        ranges["/world/trail/future"] = rrb.EntityBehavior(visible=False)
    return ranges


def time_range(layout: Layout, start: float | None, end: float | None) -> rrb.VisibleTimeRanges:
    """From `start` to `end`, s after the cursor; None is without limit."""

    def boundary(seconds: float | None, timeline: str) -> rrb.TimeRangeBoundary:
        if seconds is None:
            return ENDLESS
        if timeline == "step":
            return rrb.TimeRangeBoundary.cursor_relative(seq=round(seconds * layout.rows_per_second))
        return rrb.TimeRangeBoundary.cursor_relative(seconds=seconds) if seconds else NOW

    return rrb.VisibleTimeRanges(
        [rrb.VisibleTimeRange(t, start=boundary(start, t), end=boundary(end, t)) for t in layout.timelines]
    )


def plot_view(plot: PlotView) -> rrb.TimeSeriesView:
    """Curves."""
    legend = (
        rrb.PlotLegend(getattr(rrb.Corner2D, plot.legend), visible=True)
        if plot.legend
        else rrb.PlotLegend(visible=False)
    )
    return rrb.TimeSeriesView(
        name=plot.title,
        origin="/plots",
        contents=[f"+ {path}" for path in plot.paths],
        axis_x=WHOLE_TIME,
        axis_y=rrb.ScalarAxis(range=(plot.low, plot.high), zoom_lock=True),
        plot_legend=legend,
        background=PlotBackground(color=BACKGROUND, show_grid=True),
    )
