"""When a craft in low orbit comes down, asked in words; what a descent is held to, and what flies beside it."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.deorbits.flights import Answer as Answer
    from sailviz.deorbits.flights import answer as answer
    from sailviz.deorbits.question import Question as Question
    from sailviz.deorbits.question import scene_text as scene_text
    from sailviz.deorbits.question import sweep_text as sweep_text

_HOMES = {
    "Answer": "flights",
    "answer": "flights",
    "Question": "question",
    "scene_text": "question",
    "sweep_text": "question",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
