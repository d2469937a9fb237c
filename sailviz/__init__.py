"""sailviz: trajectories of spacecraft without propellant, computed, recorded and replayed.

    import sailviz
    scene = sailviz.load_scene("displaced/circular")
    run = sailviz.simulate(scene)
    sailviz.record(run, "circular.rrd")

The verbs are loaded on first use, so that `import sailviz` costs next to nothing. SI and radians throughout.
"""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.errors import PropagationError as PropagationError
    from sailviz.errors import RecordingError as RecordingError
    from sailviz.errors import SceneError as SceneError
    from sailviz.recording.comparison.comparer import compare as compare
    from sailviz.recording.comparison.result import Comparison as Comparison
    from sailviz.recording.exports import export as export
    from sailviz.recording.reader import Recording as Recording
    from sailviz.recording.reader import read as read
    from sailviz.recording.views.notebook import show as show
    from sailviz.recording.writer import record_trajectory as record_trajectory
    from sailviz.run.arrays import Run as Run
    from sailviz.scene.loading import Scene as Scene
    from sailviz.scene.loading import load_scene as load_scene
    from sailviz.simulation.loop import simulate as simulate
    from sailviz.simulation.loop import simulate_blocks as simulate_blocks
    from sailviz.simulation.recorder import record as record
    from sailviz.sweeps.loop import sweep as sweep
    from sailviz.sweeps.result import Sweep as Sweep
    from sailviz.sweeps.store import SweepError as SweepError

    __version__: str

_HOMES = {
    "load_scene": "scene.loading",
    "Scene": "scene.loading",
    "simulate": "simulation.loop",
    "simulate_blocks": "simulation.loop",
    "Run": "run.arrays",
    "record": "simulation.recorder",
    "record_trajectory": "recording.writer",
    "read": "recording.reader",
    "Recording": "recording.reader",
    "compare": "recording.comparison.comparer",
    "Comparison": "recording.comparison.result",
    "sweep": "sweeps.loop",
    "Sweep": "sweeps.result",
    "export": "recording.exports",
    "show": "recording.views.notebook",
    "SweepError": "sweeps.store",
    "SceneError": "errors",
    "PropagationError": "errors",
    "RecordingError": "errors",
    "__version__": "version",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
