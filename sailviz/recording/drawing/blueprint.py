"""The views of a recording, from its layout: on top the line of the moment; on the left the flight over the words; on
the right the craft from close by over at most two plots. It opens playing, in a loop.
"""

from __future__ import annotations

import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint.archetypes import PlotBackground, TextLogColumns
from rerun.blueprint.encodings import TextLogColumn, TextLogColumnKind, TimelineColumn

from sailviz.recording.drawing.arrival_plane import BOX
from sailviz.recording.drawing.layout import Layout, Space, Span
from sailviz.recording.drawing.plot_column import PlotView
from sailviz.recording.drawing.style import BACKGROUND

View = rrb.View | rrb.Container
Overrides = dict[rr.encodings.EntityPath | str, rrb.VisibleTimeRanges | rrb.EntityBehavior]
ENDLESS = rrb.TimeRangeBoundary.infinite()
NOW = rrb.TimeRangeBoundary.cursor_relative()
WHOLE_TIME = rrb.TimeAxis(view_range=rr.TimeRange(start=ENDLESS, end=ENDLESS))
ROWS = [104, 728]  # shares of the line of the moment and of everything below it
COLUMNS = [63, 37]
LEFT = 780  # of which the words take so much at least and at most; lines that fit at least, and what one takes
WORDS = 184, 214
LINES, LINE = 7.6, 16.0
WITH_AXIS = [300, 190, 290]
BARS = "Flights [%] by distance from the calm flight [0.001 au]"


def blueprint(layout: Layout) -> rrb.Blueprint:
    """The blueprint of a recording."""
    now = rrb.TextDocumentView(origin="/now", name=layout.title)
    body = rrb.Horizontal(left(layout), right(layout), column_shares=COLUMNS)
    return rrb.Blueprint(
        rrb.Vertical(now, body, row_shares=ROWS),
        rrb.TimePanel(
            state="collapsed",
            timeline=layout.timelines[0],
            playback_speed=layout.speed,
            play_state="playing",
            loop_mode="all",
            time_selection=selection(layout.turn),
        ),
        rrb.SelectionPanel(state="hidden"),
        rrb.BlueprintPanel(state="hidden"),
        auto_views=False,
        auto_layout=False,
    )


def selection(turn: tuple[float, float] | None) -> rrb.components.AbsoluteTimeRange | None:
    """A span of the run, s, as the time panel selects it."""
    if turn is None:
        return None
    start, end = (round(1e9 * seconds) for seconds in turn)
    return rrb.components.AbsoluteTimeRange(min=start, max=end)


def left(layout: Layout) -> rrb.Container:
    """The flight from several eyes, over the words."""
    spaces: list[View] = [space_view(layout, space) for space in layout.spaces]
    spaces += [plane_view(arrival.name, arrival.path) for arrival in layout.arrivals]
    spaces += [] if layout.heat is None else [plane_view(*layout.heat)]
    words = rrb.Tabs(
        rrb.TextDocumentView(origin="/about", name="About"),
        rrb.TextLogView(origin="/log", name="Events", columns=event_columns(layout)),
        active_tab=0,
    )
    longer = max(0.0, layout.words - LINES) * LINE
    below = WORDS[1] if layout.arrivals else min(WORDS[0] + longer, WORDS[1])
    return rrb.Vertical(rrb.Tabs(*spaces, active_tab=0), words, row_shares=[LEFT - below, below])


def right(layout: Layout) -> rrb.Container:
    """The craft from close by, and curves: two in sight at most, the others as tabs of the last; one, and where its
    axis points, of a craft that turns."""
    parts: list[View] = [space_view(layout, layout.close)]
    plots = [plot_view(plot) for plot in layout.plots]
    lanes = [lane_view(layout)] if layout.lanes else []
    if layout.bars:
        bars = rrb.BarChartView(
            origin="/flights", contents=["+ /flights/**"], name=BARS, plot_legend=rrb.PlotLegend(visible=False)
        )
        parts += [tabs([*plots, *lanes]), bars]
    elif layout.axis is not None:
        axis = space_view(layout, layout.axis)
        parts += [plots[0], tabs([axis, *plots[1:], *lanes])] if plots else [tabs([axis, *lanes])]
        return rrb.Vertical(*parts, row_shares=WITH_AXIS if plots else [400, 380])
    elif len(plots) > 1:
        parts += [plots[0], tabs([*plots[1:], *lanes])]
    elif plots or lanes:
        parts.append(tabs([*plots, *lanes]))
    else:
        parts.append(space_view(layout, next(s for s in layout.spaces if s.name != layout.spaces[0].name)))
    shares = [300, 240, 240] if layout.bars else [340, 220, 220]
    return rrb.Vertical(*parts, row_shares=shares[: len(parts)] if len(parts) == 3 else [400, 380])


def tabs(views: list[View]) -> View:
    """Several views in one place."""
    return views[0] if len(views) == 1 else rrb.Tabs(*views, active_tab=0)


def event_columns(layout: Layout) -> TextLogColumns:
    """Only the line itself, which says when; the viewer's own time column is too narrow for a date."""
    kinds = [TextLogColumn(kind, visible=kind == TextLogColumnKind.Body) for kind in TextLogColumnKind]
    times = [TimelineColumn(name, visible=False) for name in layout.timelines]
    return TextLogColumns(timeline_columns=times, text_log_columns=kinds)


def space_view(layout: Layout, space: Space) -> rrb.Spatial3DView:
    """A view of space."""
    camera = space.camera
    return rrb.Spatial3DView(
        name=camera.name,
        origin=camera.origin,
        contents=list(space.contents),
        background=BACKGROUND,
        line_grid=rrb.LineGrid3D(visible=False),
        overrides=spans(layout),
        eye_controls=rrb.EyeControls3D(
            kind=rrb.Eye3DKind.Orbital, position=camera.position, look_target=camera.target, eye_up=camera.up
        ),
    )


def plane_view(name: str, path: str) -> rrb.Spatial2DView:
    """A plane with axes of its own: of arrival, or of heat over distance."""
    (x, y), margin = BOX, 1.12
    return rrb.Spatial2DView(
        name=name,
        origin=path,
        contents=[f"+ {path}/**"],
        background=BACKGROUND,
        visual_bounds=rrb.VisualBounds2D(x_range=[-margin * x, margin * x], y_range=[-margin * y, margin * y]),
    )


def lane_view(layout: Layout) -> rrb.StateTimelineView:
    """On and off."""
    lanes = [f"+ {lane}" for lane in layout.lanes]
    return rrb.StateTimelineView(origin="/", contents=lanes, name="On and off", time_view=WHOLE_TIME)


def spans(layout: Layout) -> Overrides:
    """Which part of the run each entity shows."""
    return {path: time_range(layout, span) for path, span in layout.spans.items()}


def time_range(layout: Layout, span: Span) -> rrb.VisibleTimeRanges:
    """From the first to the second, s after the cursor."""

    def boundary(seconds: float | None, timeline: str) -> rrb.TimeRangeBoundary:
        if seconds is None:
            return ENDLESS
        if timeline == "step":
            return rrb.TimeRangeBoundary.cursor_relative(seq=round(seconds * layout.rows_per_second))
        return rrb.TimeRangeBoundary.cursor_relative(seconds=seconds) if seconds else NOW

    return rrb.VisibleTimeRanges(
        [
            rrb.VisibleTimeRange(timeline, start=boundary(span[0], timeline), end=boundary(span[1], timeline))
            for timeline in layout.timelines
        ]
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
