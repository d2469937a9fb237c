"""The scene file: what a person may write, checked whole, SI once loaded; imports neither numpy nor rerun nor numba."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene as Scene
    from sailviz.scene.loading import load_scene as load_scene
    from sailviz.scene.loading import schema as schema

_HOMES = {
    "Scene": "loading",
    "load_scene": "loading",
    "schema": "loading",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
