"""Planted lies about what each of several devices adds are found by the claims that they break."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sailviz.frames import to_frame
from sailviz.recording import record
from sailviz.recording.drawing import near, shares, story

from .flights import FLIGHTS, Flight
from .table import claim_of, drawn

HONEST_ARROWS, HONEST_NEAR, HONEST_WORDS = shares.arrows_of, near.near_of, shares.push_with_shares


def swapped_arrows(*about):
    """Each device has the arrow of another."""
    found = HONEST_ARROWS(*about)
    return dict(zip(found, [*list(found.values())[1:], *list(found.values())[:1]], strict=True))


def longer_arrows(*about):
    """Arrows that do not add up to the push."""
    return {name: 1.1 * arrow for name, arrow in HONEST_ARROWS(*about).items()}


def swapped_words(push, parts):
    """Numbers under the names of others."""
    return HONEST_WORDS(push, dict(zip(parts, reversed(parts.values()), strict=True)))


def same_colors(run):
    """All in one colour, so that no arrow tells whose it is."""
    return {name: [255, 206, 84] for name in run.devices}


def orbital_frame(samples, *about):
    """Shares in the orbital frame beside a push in that of the light."""
    told = {name: to_frame(samples.axes, one.acceleration) for name, one in samples.run.devices.items()}
    return replace(HONEST_NEAR(samples, *about), devices=told)


ARROWS = ("/world/craft/shares/", "/sail/shares/")
LIES = {  # what is planted -> where, in which flight, and entities whose claims it breaks
    swapped_arrows: (shares, "arrows_of", "several devices", (*ARROWS, "/world/names/shares/")),
    longer_arrows: (shares, "arrows_of", "several devices", ARROWS),
    swapped_words: (shares, "push_with_shares", "several devices", ("/now",)),
    same_colors: (shares, "device_colors", "several devices", ARROWS),
    orbital_frame: (story, "near_of", "several round a planet", ("/sail/shares/",)),
}


@pytest.mark.parametrize("lie", LIES, ids=[lie.__name__ for lie in LIES])
def test_a_lie_about_what_a_device_adds_is_found(lie, tmp_path, monkeypatch):
    module, name, flown, broken = LIES[lie]
    monkeypatch.setattr(module, name, lie)
    record(FLIGHTS[flown](), tmp_path / "lie.rrd")
    flight, found = Flight(flown, tmp_path / "lie.rrd"), []
    for entity in drawn(flight.picture.entities):
        if not any(part in entity for part in broken):
            continue
        claim = claim_of(entity)
        try:
            claim.check(flight, entity, *claim.words(entity))
        except Exception:  # an assertion, or what a lie brings down before it
            found.append(entity)
    missed = [part for part in broken if not any(part in entity for entity in found)]
    assert not missed, f"{lie.__doc__} Not seen in {missed}"
