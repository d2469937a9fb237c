"""Pictures cannot lie: whatever a recording draws is compared with the number it shows, entity by entity."""

from __future__ import annotations

import pytest

from .flights import FLIGHTS
from .table import TABLE, claim_of, drawn


@pytest.mark.parametrize("name", FLIGHTS)
def test_everything_drawn_has_a_row_in_the_table(flights, name):
    picture = flights(name).picture
    unlisted = [entity for entity in drawn(picture.entities) if claim_of(entity) is None]
    assert unlisted == []
    more = {
        entity: picture.archetypes(entity) - set(claim_of(entity).draws.split()) for entity in drawn(picture.entities)
    }
    assert {entity: kinds for entity, kinds in more.items() if kinds} == {}


@pytest.mark.parametrize("claim", TABLE, ids=[claim.pattern for claim in TABLE])
def test_what_is_drawn_is_what_the_numbers_say(flights, claim):
    lies, found = [], 0
    for name in FLIGHTS:
        flight = flights(name)
        for entity in drawn(flight.picture.entities):
            if claim_of(entity) is not claim:
                continue
            found += 1
            try:
                claim.check(flight, entity, *claim.words(entity))
            except AssertionError as error:
                lies.append(f"{name}: {entity}: {error or 'not so'}")
    assert found, "no flight draws it"
    assert not lies, f"{claim.truth}, {claim.check.__doc__}\n" + "\n".join(lies)
