"""Planted lies about flights in one picture are found by the claims that they break."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sailviz.recording.drawing import drawing, flight_curves
from sailviz.recording.overlay import record_together

from .flights import FLIGHTS, Flight
from .table import claim_of, drawn

HONEST = drawing.flights_together, flight_curves.run_at


def swapped_places(overlay, story):
    """The companions under each other's names."""
    first, one, two = HONEST[0](overlay, story)
    return [first, replace(one, story=two.story, run=two.run), replace(two, story=one.story, run=one.run)]


def swapped_colors(overlay, story):
    """Each companion in the other's colour."""
    first, one, two = HONEST[0](overlay, story)
    return [first, replace(one, color_word=two.color_word), replace(two, color_word=one.color_word)]


def own_arrows(overlay, story):
    """Arrows of pushes that are not comparable."""
    return [replace(flight, story=replace(flight.story, beside=None)) for flight in HONEST[0](overlay, story)]


def late(run, times):
    """A companion read off a day too late."""
    return HONEST[1](run, times + 86_400.0)


SPACE = ("trail/past", "names/flight", "/plots/push", "/about")
LIES = {  # what is planted -> where, and entities whose claims it breaks
    swapped_places: (
        drawing,
        "flights_together",
        ("trail/past", "craft", "names/flight", "/plots/push", "/now", "/about"),
    ),
    swapped_colors: (
        drawing,
        "flights_together",
        ("trail/past", "names/flight", "/plots/push", "/plots/apart", "/about"),
    ),
    own_arrows: (drawing, "flights_together", ("craft/push",)),
    late: (flight_curves, "run_at", ("/plots/apart", "/plots/difference", "/now", "/about")),
}


@pytest.mark.parametrize("lie", LIES, ids=[lie.__name__ for lie in LIES])
def test_a_lie_about_flights_in_one_picture_is_found(lie, tmp_path, monkeypatch):
    module, name, broken = LIES[lie]
    monkeypatch.setattr(module, name, lie)
    record_together(FLIGHTS["together sails"](), tmp_path / "lie.rrd")
    flight, found = Flight("together sails", tmp_path / "lie.rrd"), []
    for entity in drawn(flight.picture.entities):
        claim = claim_of(entity)
        try:
            claim.check(flight, entity, *claim.words(entity))
        except Exception:  # an assertion, or what a lie brings down before it
            found.append(entity)
    missed = [part for part in broken if not any(part in entity for entity in found)]
    assert not missed, f"{lie.__doc__} Not seen in {missed}"
