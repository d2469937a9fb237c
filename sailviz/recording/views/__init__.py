"""A recording in front of a person: viewers, pictures, movies, notebooks, a summary."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.recording.views.movie import MovieReport as MovieReport
    from sailviz.recording.views.movie import make_movie as make_movie
    from sailviz.recording.views.notebook import show as show
    from sailviz.recording.views.screenshot import PictureReport as PictureReport
    from sailviz.recording.views.screenshot import picture as picture

_HOMES = {
    "picture": "screenshot",
    "PictureReport": "screenshot",
    "make_movie": "movie",
    "MovieReport": "movie",
    "show": "notebook",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
