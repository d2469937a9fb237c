"""sailviz: trajectories of spacecraft without propellant, computed, recorded and replayed.

    import sailviz
    scene = sailviz.load_scene("displaced/circular")
    run = sailviz.simulate(scene)
    sailviz.record(run, "circular.rrd")

The verbs are loaded on first use, so that `import sailviz` costs next to nothing. SI and radians throughout.
"""

from functools import cache
from importlib import import_module

_WHERE = {
    "load_scene": "sailviz.scene.loading",
    "Scene": "sailviz.scene.loading",
    "simulate": "sailviz.simulation.loop",
    "simulate_blocks": "sailviz.simulation.loop",
    "Run": "sailviz.run.arrays",
    "record": "sailviz.recording",
    "record_trajectory": "sailviz.run.from_arrays",
    "read": "sailviz.recording",
    "Recording": "sailviz.recording",
    "compare": "sailviz.recording.comparison.compare",
    "Comparison": "sailviz.recording.comparison.compare",
    "sweep": "sailviz.sweeps.sweep",
    "Sweep": "sailviz.sweeps.sweep",
    "export": "sailviz.recording.exports",
    "show": "sailviz.recording.views.notebook",
    "SweepError": "sailviz.sweeps.store",
    "SceneError": "sailviz.errors",
    "PropagationError": "sailviz.errors",
    "RecordingError": "sailviz.errors",
}
__all__ = [*_WHERE, "__version__"]


@cache
def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("sailviz")
    except PackageNotFoundError:  # run from a folder that was never installed
        return "0+unknown"


def __getattr__(name):
    if name == "__version__":
        return _version()
    if name not in _WHERE:
        raise AttributeError(f"module 'sailviz' has no attribute {name!r}")
    return getattr(import_module(_WHERE[name]), name)


def __dir__():
    return sorted(__all__)
