"""The views of a recording, from its layout: on the left space, the craft and words, on the right the curves."""

from __future__ import annotations

import rerun as rr
import rerun.blueprint as rrb
from rerun.blueprint.archetypes import PlotBackground

from sailviz.recording.layout import Camera, Layout, PlotView
from sailviz.recording.look import BACKGROUND

ENDLESS = rrb.TimeRangeBoundary.infinite()
NOW = rrb.TimeRangeBoundary.cursor_relative()
WHOLE_TIME = rrb.TimeAxis(view_range=rr.TimeRange(start=ENDLESS, end=ENDLESS))


def blueprint(
    layout: Layout, *, active: str | None = None, only: str | None = None, panels: bool = True
) -> rrb.Blueprint:
    """The blueprint of a recording.

    active : the tab that is in front, by the start of its name; only : show this view alone; panels : False leaves out the
    menu and the time panel, for pictures.
    """
    views = all_views(layout)
    if only is not None:
        body = find(views, only)
    else:
        body = arrange(layout, views, active)
    return rrb.Blueprint(
        body,
        rrb.TopPanel(state="expanded" if panels else "hidden"),
        rrb.TimePanel(
            state="collapsed" if panels else "hidden",
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


def all_views(layout: Layout) -> dict[str, rrb.View]:
    """Every view by its name, those in space first."""
    views = {camera.name: space_view(layout, camera) for camera in layout.cameras}
    views[layout.close_up.name] = close_view(layout.close_up)
    views["About"] = rrb.TextDocumentView(origin="/about", name="About")
    views["Events"] = rrb.TextLogView(origin="/log", name="Events")
    for plot in (*layout.plots, *layout.environment):
        views[plot.title] = plot_view(plot)
    if layout.lanes:
        views["Phases"] = rrb.StateTimelineView(
            origin="/phase", contents=[f"+ /phase/{lane}" for lane in layout.lanes], name="Phases", time_view=WHOLE_TIME
        )
    return views


def find(views: dict, name: str):
    """The view whose name starts with `name`; capitals do not count. Raises KeyError with the names there are."""
    for title, view in views.items():
        if title.lower().startswith(name.lower()):
            return view
    raise KeyError(f"there is no view {name}; there are {', '.join(short_names(views))}")


def short_names(views) -> list[str]:
    """Names of views without what stands in brackets."""
    return [name.split(" (")[0].split(" [")[0] for name in views]


def arrange(layout: Layout, views: dict, active: str | None) -> rrb.Container:
    spaces = [views[camera.name] for camera in layout.cameras]
    words = [views["About"], views["Events"]]
    extra = [views[plot.title] for plot in layout.environment]
    front = find(views, active) if active else None

    def tabs(group):
        return rrb.Tabs(*group, active_tab=group.index(front) if front in group else 0)

    left = rrb.Vertical(
        tabs(spaces),
        rrb.Horizontal(views[layout.close_up.name], tabs(words), column_shares=[3, 2]),
        row_shares=[4, 3],
    )
    right = [views[plot.title] for plot in layout.plots]
    shares = [plot.share for plot in layout.plots]
    if extra:
        right.append(tabs(extra) if len(extra) > 1 else extra[0])
        shares.append(2.6)
    if layout.lanes:
        right.append(views["Phases"])
        shares.append(1.0 + 0.7 * len(layout.lanes))
    return rrb.Horizontal(left, rrb.Vertical(*right, row_shares=shares), column_shares=[5, 3])


def space_view(layout: Layout, camera: Camera) -> rrb.Spatial3DView:
    contents = ["+ /world/**", *(f"- /world/planets/{name}/**" for name in layout.hidden)]
    if camera.name == "Follow":
        contents.append("- /world/names/**")  # labels are never hidden by what is in front of them
    return rrb.Spatial3DView(
        name=camera.name,
        origin=camera.origin,
        contents=contents,
        background=BACKGROUND,
        line_grid=rrb.LineGrid3D(visible=False),
        overrides=trail_ranges(layout),
        eye_controls=eye(camera),
    )


def close_view(camera: Camera) -> rrb.Spatial3DView:
    return rrb.Spatial3DView(
        name=camera.name,
        origin=camera.origin,
        contents=["+ /sail/**"],
        background=BACKGROUND,
        line_grid=rrb.LineGrid3D(visible=False),
        eye_controls=eye(camera),
    )


def eye(camera: Camera) -> rrb.EyeControls3D:
    return rrb.EyeControls3D(
        kind=rrb.Eye3DKind.Orbital, position=camera.position, look_target=camera.target, eye_up=camera.up
    )


def trail_ranges(layout: Layout) -> dict:
    """Which part of the run each part of the trail shows. The parts do not overlap: lines on one another tear."""
    ranges = {
        "/world/trail/past": time_range(layout, -layout.past if layout.past else None, -layout.tail),
        "/world/trail/recent": time_range(layout, -layout.tail, 0.0),
        "/world/ladder": time_range(layout, None, None),
    }
    if layout.future:
        ranges["/world/trail/future"] = time_range(layout, 0.0, None)
    else:
        ranges["/world/trail/future"] = rrb.EntityBehavior(visible=False)
    return ranges


def time_range(layout: Layout, start: float | None, end: float | None) -> rrb.VisibleTimeRanges:
    """From `start` to `end`, s after the cursor; None is without limit."""

    def boundary(seconds, timeline):
        if seconds is None:
            return ENDLESS
        if timeline == "step":
            return rrb.TimeRangeBoundary.cursor_relative(seq=round(seconds * layout.rows_per_second))
        return rrb.TimeRangeBoundary.cursor_relative(seconds=seconds) if seconds else NOW

    return rrb.VisibleTimeRanges(
        [rrb.VisibleTimeRange(t, start=boundary(start, t), end=boundary(end, t)) for t in layout.timelines]
    )


def plot_view(plot: PlotView) -> rrb.TimeSeriesView:
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
