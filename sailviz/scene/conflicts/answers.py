"""What the records of all kinds share: the shape of an answer, and the answers of a kind that has nothing to say."""

from __future__ import annotations

from collections.abc import Sequence

Faults = list[tuple[str, str]]  # (place in SI names, e.g. "start.radius"; sentence)


def never(section: object) -> bool:
    """No section of this kind does so."""
    return False


def always(section: object) -> bool:
    """Every section of this kind does so."""
    return True


def nothing(*sections: object) -> Faults:
    """No section of this kind is at fault."""
    return []


def no_sentences(*sections: object) -> list[str]:
    """Nothing of this kind stands in the way."""
    return []


def no_angles(section: object) -> Sequence[float]:
    """This kind gives no pitch angles."""
    return ()


def unknown(section: object) -> None:
    """Sections of this kind do not say."""
