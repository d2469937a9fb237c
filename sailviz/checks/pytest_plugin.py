"""A pytest fixture that holds runs to what they were: `recording_regression`.

    def test_my_mission(recording_regression):
        recording_regression("my_mission.toml")

The first time, and whenever a change is meant, `pytest --sailviz-update` writes a baseline beside the test: float64
numbers of some rows, all events, and the allowed differences in a TOML file that may be edited. Imports nothing heavy:
this module is loaded whenever pytest starts.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from sailviz.recording import Comparison, Recording
    from sailviz.run import Run
    from sailviz.scene import Scene


def pytest_addoption(parser: pytest.Parser) -> None:
    """What pytest and its configuration file may say to the fixture."""
    group = parser.getgroup("sailviz", "runs held to their baselines")
    group.addoption("--sailviz-update", action="store_true", help="Write the baselines of recording_regression anew.")
    group.addoption("--sailviz-failures", metavar="DIR", help="Where recording_regression leaves what failed.")
    group.addoption("--sailviz-no-pictures", action="store_true", help="Take no pictures of what failed.")
    parser.addini("sailviz_baselines", "Folder of the baselines; by default 'baselines' beside the test.", default="")


@pytest.fixture
def recording_regression(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Callable[..., Comparison | None]:
    """recording_regression(scene or run) compares it with its baseline and fails where they differ.

    source : the name of a shipped scene, the path of a scene file or recording, a Scene, a Run, or a Recording
    name : of the baseline, by default that of the test; folder : where it lies; rows : how many are kept, at most
    atol, rtol : allowed differences as in `sailviz.compare`, over those of the file beside the baseline
    set : values over those of the scene, e.g. {"propagation.tolerance": 1e-13}
    Returns the Comparison.
    """
    used: set[str] = set()

    def check(
        source: Run | Recording | Scene | str | os.PathLike[str],
        *,
        name: str = "",
        folder: str | Path | None = None,
        rows: int = 60,
        atol: float | Mapping[str, float] | None = None,
        rtol: float | Mapping[str, float] | None = None,
        set: Mapping[str, Any] | None = None,
    ) -> Comparison | None:
        __tracebackhide__ = True
        name = re.sub(r"[^\w.+-]+", "_", name or request.node.name).strip("_")
        if name in used:
            pytest.fail(f"the baseline {name} is used twice in one test: give each a name", pytrace=False)
        used.add(name)
        from sailviz.checks.baselines import Regression

        regression = Regression(_folder(request, folder), name, rows=rows, atol=atol, rtol=rtol)
        if request.config.getoption("--sailviz-update"):
            regression.update(source, set)
        failures = request.config.getoption("--sailviz-failures")
        pictures = not request.config.getoption("--sailviz-no-pictures")

        def leave_in() -> Path:
            if failures:
                place = Path(failures).resolve() / re.sub(r"[^\w.+-]+", "_", request.node.nodeid) / name
                place.mkdir(parents=True, exist_ok=True)
                return place
            return tmp_path_factory.mktemp(name)

        found = regression.check(source, set, leave_in, pictures)
        if not found.passed:
            pytest.fail(found.report, pytrace=False)
        return found.comparison

    return check


def _folder(request: pytest.FixtureRequest, given: str | Path | None) -> Path:
    if given is not None:
        return Path(given)
    configured = request.config.getini("sailviz_baselines")
    return request.config.rootpath / configured if configured else request.path.parent / "baselines"
