"""Curves of a sail's film: how warm it is, beside what it bears, and how much sunlight it has had."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from sailviz.recording.drawing import style
from sailviz.recording.drawing.plots import Plot
from sailviz.run.arrays import Run


def hottest_of(run: Run) -> float | None:
    """Temperature, K, that the film of a run's first sail bears; None where the scene says none."""
    told: Any = run.setting.resolved.get("device")
    devices = told if isinstance(told, list) else [told]
    limits = [device.get("hottest") for device in devices if isinstance(device, Mapping)]
    return next((float(limit) for limit in limits if limit is not None), None)


def film_plots(first: Run) -> list[Plot]:
    """Temperature and dose, where the run has them."""
    found = []
    if "temperature_K" in first.film:
        hottest = hottest_of(first)

        def warmth(run: Run) -> np.ndarray:
            warm = run.film["temperature_K"]
            return np.stack([warm, np.full(len(warm), hottest)], 1) if hottest is not None else warm[:, None]

        names, colors = ("film", "limit"), (style.QUANTITY["heat"], style.FAULT)
        count = 1 if hottest is None else 2
        title = "Film temperature [K]"
        found.append(
            Plot(
                "film_temperature",
                title,
                names[:count],
                colors[:count],
                warmth,
                natural=-0.4,
                bonus=1.3,
                steady="film at {:.0f} K",
            )
        )
    if "dose_yr" in first.film:
        found.append(
            Plot(
                "dose",
                "Dose of sunlight [yr]",
                ("dose",),
                (style.QUANTITY["dose"],),
                lambda run: run.film["dose_yr"][:, None],
                natural=-0.6,
                bonus=0.9,
                from_zero=True,
                swings="",
            )
        )
    return found
