"""What the description says of a flight's phases."""

import sailviz
from sailviz.recording.drawing.phases import phase_notes


def test_the_colours_of_phases_are_said_of_what_has_them():
    """In a low orbit the trail is coloured by its altitude, and the lane alone by the phases."""
    values = {"propagation.duration_d": 40, "propagation.outputs": 20}
    run = sailviz.simulate(sailviz.load_scene("deorbit/phased-lowering", values))
    low, open_space = (phase_notes(run.setting, low)[0] for low in (True, False))
    assert low.startswith("phases in their lane: **cyan** commissioning (off), **yellow** braking from day 30")
    assert open_space == low.replace(" in their lane", "")
