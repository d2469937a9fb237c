"""What a person changed in the views of one flight holds for the next one; what they left alone is the next one's."""

from sailviz.recording.views.carried import VIEW, carried, with_faults, without_faults


def views(tag, shown, distance=1.0, axis=(0.0, 1.0)):
    """A blueprint of two eyes behind tabs beside a plot, with ids that begin with the tag."""
    a, b, c = (f"{tag}-{name}" for name in shown)
    return {
        "/time_panel": {"TimePanelBlueprint": {"play_state": "Playing", "playback_speed": distance}},
        "/viewport": {"ViewportBlueprint": {"root_container": f"{tag}-root"}},
        f"/container/{tag}-root": {
            "ContainerBlueprint": {"contents": [f"container/{tag}-tabs", f"view/{c}"], "col_shares": [2.0, 1.0]}
        },
        f"/container/{tag}-tabs": {
            "ContainerBlueprint": {"contents": [f"view/{a}", f"view/{b}"], "active_tab": f"view/{a}"}
        },
        **{
            f"/view/{identity}": {
                "ViewBlueprint": {"class_identifier": kind, "display_name": name, "space_origin": "/"}
            }
            for identity, name, kind in zip((a, b, c), shown, ("3D", "3D", "TimeSeries"), strict=True)
        },
        f"/view/{a}/EyeControls3D": {"EyeControls3D": {"position": [distance, 0, 0], "eye_up": [0, 0, 1]}},
        f"/view/{c}/ScalarAxis": {"ScalarAxis": {"range": list(axis)}},
    }


SHOWN = ("Flight", "From above", "Speed [km/s]")


def changed():
    left = views("old", SHOWN)
    left["/view/old-Flight/EyeControls3D"]["EyeControls3D"]["position"] = [7, 7, 7]
    left["/container/old-tabs"]["ContainerBlueprint"]["active_tab"] = "view/old-From above"
    left["/container/old-root"]["ContainerBlueprint"]["col_shares"] = [1.0, 1.0]
    left["/time_panel"]["TimePanelBlueprint"]["play_state"] = "Paused"
    return left


def test_nothing_is_carried_where_nothing_was_changed():
    given, fresh = views("old", SHOWN), views("new", SHOWN, 2.0, (0.0, 9.0))
    assert carried(given, views("old", SHOWN), fresh) == fresh


def test_the_eye_stays_and_the_range_of_a_plot_that_nobody_touched_is_the_new_flights():
    found = carried(views("old", SHOWN), changed(), views("new", SHOWN, 2.0, (0.0, 9.0)))
    assert found["/view/new-Flight/EyeControls3D"]["EyeControls3D"] == {"position": [7, 7, 7], "eye_up": [0, 0, 1]}
    assert found["/view/new-Speed [km/s]/ScalarAxis"]["ScalarAxis"]["range"] == [0.0, 9.0]
    assert found["/time_panel"]["TimePanelBlueprint"] == {"play_state": "Paused", "playback_speed": 2.0}
    boxes = [part["ContainerBlueprint"] for part in found.values() if "ContainerBlueprint" in part]
    assert {"contents": ["view/new-Flight", "view/new-From above"], "active_tab": "view/new-From above"} in boxes
    assert [1.0, 1.0] in [box.get("col_shares") for box in boxes]
    root = found[f"/container/{found['/viewport']['ViewportBlueprint']['root_container']}"]["ContainerBlueprint"]
    assert all(f"/{part}" in found for part in root["contents"])


def test_where_the_views_are_others_the_places_are_the_new_flights_and_the_tab_in_front_stays():
    fresh = views("new", ("Flight", "From above", "Inclination [deg]"))
    found = carried(views("old", SHOWN), changed(), fresh)
    assert found["/container/new-root"] == fresh["/container/new-root"]
    assert found["/container/new-tabs"]["ContainerBlueprint"]["active_tab"] == "view/new-From above"
    assert found["/view/new-Flight/EyeControls3D"]["EyeControls3D"]["position"] == [7, 7, 7]
    assert not any("old" in path for path in found)


def test_faults_stand_above_the_views_and_leave_no_trace():
    before = views("old", SHOWN)
    told = with_faults(with_faults(before, "Once"), "Twice")
    assert told[f"/view/{VIEW}"]["ViewBlueprint"]["display_name"] == "Twice"
    root = told[f"/container/{told['/viewport']['ViewportBlueprint']['root_container']}"]["ContainerBlueprint"]
    assert root["contents"] == [f"view/{VIEW}", "container/old-root"]
    assert without_faults(told) == before
