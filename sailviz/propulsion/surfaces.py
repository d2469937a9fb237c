"""What the two sides of a film feel, by the words of a scene or of a shell. Nothing is silently assumed of a back."""

from __future__ import annotations

from typing import NamedTuple

from sailviz.propulsion.solar_sail import FILMS, OPTICS, Film, black_back
from sailviz.words import nearest


class Side(NamedTuple):
    """b1, b2, b3 of one side, efficiency included."""

    b1: float
    b2: float
    b3: float


def side_of(film: Film) -> Side:
    """The three numbers of a film."""
    return Side(film.efficiency * film.b1, film.efficiency * film.b2, film.efficiency * film.b3)


def film_named(word: str) -> Side:
    """Front of a film: a name, "black", or "b1,b2,b3". ValueError for another word."""
    if word == "black":
        return Side(0.5, 0.0, 0.0)
    if word in FILMS:
        return side_of(FILMS[word])
    return _numbers(word, [*FILMS, "black"])


def back_named(film: str, back: str) -> Side:
    """Back of a film: "same", "black", or "b1,b2,b3". ValueError for another word, and for the black back of a film
    whose emissivities are not known."""
    if back == "same":
        return film_named(film)
    if back != "black":
        return _numbers(back, ["same", "black"])
    if film not in OPTICS:
        raise ValueError(f'the back of "{film}" cannot be "black": how it radiates is not known. Give b1,b2,b3')
    return side_of(black_back(OPTICS[film]))


def _numbers(word: str, words: list[str]) -> Side:
    try:
        b1, b2, b3 = (float(part) for part in word.split(","))
    except ValueError:
        raise ValueError(f'"{word[:60]}" is no film, nor b1,b2,b3. {nearest(word, words)}') from None
    total = b1 + b2 + b3
    if not (total > 0 and total < 10):
        raise ValueError(f'b1,b2,b3 of "{word[:60]}" must have a positive sum')
    return Side(b1, b2, b3)
