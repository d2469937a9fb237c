"""The figure of the solar wind takes a measured series, and says so; without one it says that nothing was measured."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz import figures
from sailviz.uncertainty import wind

pytest.importorskip("matplotlib")


def words(figure):
    return [figure.get_supxlabel()] + [panel.get_title() for panel in figure.axes]


def test_wind_fit_says_whose_series_it_shows(tmp_path):
    assert any("not measured" in text for text in words(figures.figure("wind-fit")))
    times = 3600.0 * np.arange(3000)
    pressure = wind.generate("burr", times, 1, c=3.3, d=0.76, scale=1.4e-9)
    pressure[40:43] = np.nan
    np.savez(tmp_path / "own.npz", time_s=times, pressure_Pa=pressure)
    shown = words(figures.figure("wind-fit", series=tmp_path / "own.npz"))
    assert not any("not measured" in text for text in shown)
    assert "own.npz: 2997 values of 1 h; 3 missing pressures filled in 1 gaps" in shown[0]


def test_bad_series_are_refused_before_anything_is_drawn(tmp_path):
    from click.testing import CliRunner

    from sailviz.cli import main

    (tmp_path / "bad.csv").write_text("time_h,pressure_Pa\n" + "\n".join(f"{i},2.{i}" for i in range(60)))
    for arguments, sentence in (
        (("wind-fit", "--series", str(tmp_path / "bad.csv")), "look like nPa taken for Pa"),
        (("wind-fit", "--series", str(tmp_path / "nowhere.csv")), "cannot read"),
        (("escape", "--series", str(tmp_path / "bad.csv")), "escape takes no series, only wind-fit does"),
    ):
        refused = CliRunner().invoke(main, ["figure", *arguments, "-o", str(tmp_path / "x.png")])
        assert refused.exit_code == 2
        assert sentence in refused.output
        assert "Traceback" not in refused.output
        assert not (tmp_path / "x.png").exists()
