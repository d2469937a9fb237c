"""Pressure histories: laws, correlation, streams of random numbers, replay, and how measured series are repaired."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats
from scipy.integrate import quad

from sailviz.constants import DAY, YEAR
from sailviz.environment.solar_wind import pressure as solar_wind
from sailviz.environment.solar_wind.laws import LAWS, named
from sailviz.environment.solar_wind.series import read_omni, read_series, series
from sailviz.uncertainty.wind import fit

HOUR = 3600.0
nPa = 1e-9
LAW = named("gamma", shape=2.593, scale=0.7793e-9)
EXAMPLES = {
    "gamma": ({"shape": 2.593, "scale": 0.7793e-9}, stats.gamma(2.593, scale=0.7793e-9)),
    "lognormal": ({"sigma": 0.6144, "scale": 1.646e-9}, stats.lognorm(0.6144, scale=1.646e-9)),
    "burr": ({"c": 3.29, "d": 0.764, "scale": 1.4245e-9}, stats.burr12(3.29, 0.764, scale=1.4245e-9)),
    "weibull": ({"shape": 1.428, "scale": 2.249e-9}, stats.weibull_min(1.428, scale=2.249e-9)),
    "inverse-gamma": ({"shape": 2.754, "scale": 3.74e-9}, stats.invgamma(2.754, scale=3.74e-9)),
    "inverse-gaussian": (
        {"centre": 2.0206e-9, "scale": 4.1405e-9},
        stats.invgauss(2.0206 / 4.1405, scale=4.1405e-9),
    ),
}


@pytest.mark.parametrize("name", LAWS)
def test_laws_are_those_of_the_textbook(name):
    parameters, book = EXAMPLES[name]
    law = named(name, **parameters)
    p = np.geomspace(0.05, 60, 40) * nPa
    np.testing.assert_allclose(law.distribution(p), book.cdf(p), rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(law.log_density(p), book.logpdf(p), rtol=1e-9)
    assert law.mean == pytest.approx(book.mean(), rel=1e-9)
    assert law.standard_deviation == pytest.approx(book.std(), rel=1e-9)
    root = quad(lambda q: np.sqrt(book.ppf(q)), 0, 1, limit=500)[0]
    assert law.power_mean(0.5) == pytest.approx(root, rel=1e-6)
    if name != "inverse-gaussian":
        z = np.linspace(-7, 7, 41)  # far enough that Phi(z) itself would round to 1
        np.testing.assert_allclose(book.logsf(law.from_normal(z))[z > 0], stats.norm.logsf(z[z > 0]), rtol=1e-5)
        np.testing.assert_allclose(book.logcdf(law.from_normal(z))[z < 0], stats.norm.logcdf(z[z < 0]), rtol=1e-5)


def test_mean_reference_pressure_costs_thrust_and_the_unbiased_one_does_not():
    assert LAW.power_mean(0.5) / np.sqrt(nPa) == pytest.approx(1.355009, abs=1e-6)
    deviation = np.sqrt(LAW.mean - LAW.power_mean(0.5) ** 2) / np.sqrt(nPa)
    assert deviation == pytest.approx(0.429739, abs=1e-6)
    assert LAW.reference_pressure() / nPa == pytest.approx(2.020725, abs=1e-6)
    assert LAW.reference_pressure(unbiased=True) / nPa == pytest.approx(1.836, abs=5e-4)
    assert LAW.power_mean(0.5) / np.sqrt(LAW.reference_pressure()) == pytest.approx(0.953210, abs=1e-5)
    assert deviation * np.sqrt(nPa / LAW.reference_pressure()) == pytest.approx(0.302309, abs=1e-5)
    for name, (parameters, _) in EXAMPLES.items():
        law = named(name, **parameters)
        assert law.power_mean(0.5) / np.sqrt(law.reference_pressure(unbiased=True)) == pytest.approx(1, abs=1e-12)
    assert solar_wind.reference_pressure(2.593, 0.7793e-9, True) == LAW.reference_pressure(True)


def test_phases_of_the_cycle_have_their_mean_pressures():
    for phase, mean in (("2000-2002", 2.241), ("2003-2005", 2.424), ("2008-2009", 1.471), ("2015-2017", 2.344)):
        assert solar_wind.phase_factor(phase) == pytest.approx(mean / 2.0206, abs=5e-4)
    with pytest.raises(ValueError, match="no phase '1666'"):
        solar_wind.phase_factor("1666")


def test_constant_redrawn_and_correlated_histories_keep_their_law():
    times = HOUR * np.arange(20_000)
    constant = solar_wind.history(LAW, times, 5, "constant")
    assert np.ptp(constant) == 0
    daily = solar_wind.history(LAW, times, 5, "redrawn", interval=DAY)
    assert all(np.ptp(daily[24 * day : 24 * day + 24]) == 0 for day in range(800))
    np.testing.assert_array_equal(daily[::24], solar_wind.history(LAW, times[::24], 5, "redrawn"))
    np.testing.assert_array_equal(daily[::24], solar_wind.gamma_pressure(2.593, 0.7793e-9, DAY, 20_000 * HOUR, 5)[1])
    lognormal = named("lognormal", sigma=0.6144, scale=1.646e-9)
    log = np.log(solar_wind.history(lognormal, times, 5, "redrawn") / nPa)
    assert log.mean() == pytest.approx(0.4984, abs=3 * 0.6144 / np.sqrt(20_000))


def test_correlated_history_forgets_with_its_time_and_keeps_the_gamma_law():
    hours = 1_000_000
    z = solar_wind.relaxing_normals(HOUR * np.arange(hours), solar_wind.generator(1), 17 * HOUR)
    assert np.mean(z[17:] * z[:-17]) == pytest.approx(np.exp(-1), abs=0.01)
    p = solar_wind.history(LAW, HOUR * np.arange(hours), 1, "correlated", correlation_time=17 * HOUR)
    found = fit(p, ["gamma"])["gamma"].parameters
    assert found["shape"] == pytest.approx(2.593, rel=0.03)
    assert found["scale"] == pytest.approx(0.7793e-9, rel=0.03)


def test_uneven_times_are_correlated_by_their_distance():
    times = np.cumsum(np.tile([HOUR, 30 * HOUR], 100_000))
    z = solar_wind.relaxing_normals(times, solar_wind.generator(2), 17 * HOUR)
    assert np.mean(z[::2] * z[1::2]) == pytest.approx(np.exp(-30 / 17), abs=0.012)
    assert np.mean(z[1:-1:2] * z[2::2]) == pytest.approx(np.exp(-1 / 17), abs=0.012)


@pytest.mark.parametrize("kind", solar_wind.KINDS)
def test_a_flight_meets_the_same_wind_in_whatever_company_and_for_whatever_time(kind):
    times = HOUR * np.arange(500)
    alone = solar_wind.history(LAW, times, 9, kind, flight=3)
    np.testing.assert_array_equal(solar_wind.history(LAW, times[:100], 9, kind, flight=3), alone[:100])
    others = [solar_wind.history(LAW, times, 9, kind, flight=i)[0] for i in range(6)]
    assert others[3] == alone[0]
    assert len(set(others)) == 6
    assert solar_wind.history(LAW, times, 10, kind, flight=3)[0] != alone[0]


def test_years_differ_by_their_own_stream():
    times = HOUR * np.arange(0, 40 * 8766, 50)
    factor = solar_wind.yearly_factor(times, 3)
    year = np.floor(times / YEAR).astype(int)
    assert len(np.unique(factor)) == 40
    assert all(np.ptp(factor[year == i]) == 0 for i in range(40))
    many = np.log([solar_wind.yearly_factor(np.zeros(1), 3, flight=i)[0] for i in range(2000)])
    assert many.std() == pytest.approx(0.175, rel=0.05)


def test_wind_potential_is_the_energy_of_its_protons():
    assert solar_wind.wind_potential() == 1000
    assert solar_wind.wind_potential(437.7e3) == pytest.approx(1000, rel=1e-3)
    assert solar_wind.proton_density(2.2e-9, 400e3) == pytest.approx(7.2e6, rel=0.01)


def wind(n=200, **more):
    hours = np.datetime64("2003-01-01T00") + np.arange(n)
    p = (2 + np.sin(np.arange(n) / 7)) * nPa
    return {"time": hours, "pressure": p, "speed": np.full(n, 4.5e5), "density": np.full(n, 5e6)} | more


def test_replay_starts_where_told_or_drawn_and_does_not_wrap():
    data = series(**wind())
    found = solar_wind.replay(data, HOUR / 2 * np.arange(9), start="2003-01-03T05:00")
    assert found.first == 53
    np.testing.assert_array_equal(found.pressure, data.pressure[[53, 53, 54, 54, 55, 55, 56, 56, 57]])
    assert found.speed[0] == 4.5e5
    firsts = [solar_wind.replay(data, HOUR * np.arange(198), seed=8, flight=i).first for i in range(60)]
    assert set(firsts) == {0, 1, 2}
    for arguments, words in (
        ({"times": HOUR * np.arange(201), "seed": 1}, "does not begin again"),
        ({"times": HOUR * np.arange(9), "start": 195}, "lasts only"),
        ({"times": HOUR * np.arange(9), "start": "2004-01-01"}, "outside the series, which runs from 2003-01-01T00"),
        ({"times": HOUR * np.arange(9), "start": "soon"}, "no date"),
        ({"times": HOUR * np.arange(9)}, "start or a seed"),
    ):
        with pytest.raises(ValueError, match=words):
            solar_wind.replay(data, **arguments)


def test_gaps_are_filled_linearly_in_the_logarithm_and_counted():
    p = wind()["pressure"]
    p[50], p[53] = 1 * nPa, 8 * nPa
    p[[51, 52, 100]] = np.nan
    found = series(**wind(pressure=p))
    np.testing.assert_allclose(found.pressure[50:54] / nPa, [1, 2, 4, 8])
    assert (found.repairs.filled, found.repairs.gaps, found.repairs.longest_gap) == (3, 2, 2 * HOUR)
    assert found.measured.sum() == 197
    assert "3 missing pressures filled in 2 gaps, the longest 2 h" in str(found.repairs)
    kept = np.delete(np.arange(200), [51, 52, 100])
    rows = {name: x[kept] for name, x in wind(pressure=p).items()}
    np.testing.assert_array_equal(series(**rows).pressure, found.pressure)
    assert found.reference_pressure() == pytest.approx(p[kept].mean(), rel=1e-14)
    ends = np.concatenate([np.full(5, np.nan), p[5:-2], np.full(2, np.nan)])
    cut = series(**wind(pressure=ends))
    assert cut.repairs.trimmed == 7
    assert cut.start == np.datetime64("2003-01-01T05")
    assert len(cut.pressure) == 193


def test_rows_in_the_wrong_order_or_twice_are_put_right_and_counted():
    order = np.concatenate([np.arange(100, 200), np.arange(100)])
    found = series(**{name: x[order] for name, x in wind().items()})
    assert found.repairs.reordered == 100
    np.testing.assert_array_equal(found.pressure, wind()["pressure"])
    again = np.concatenate([np.arange(200), [7, 8]])
    twice = series(**{name: x[again] for name, x in wind().items()})
    assert twice.repairs.repeated == 2
    np.testing.assert_array_equal(twice.pressure, wind()["pressure"])


def spoilt(index, value, name="pressure"):
    x = wind()[name].copy()
    x[index] = value
    return {name: x}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (spoilt(slice(20, 150), np.nan), "longest gap lasts 130 h, up to 120 h"),
        (spoilt(3, -1 * nPa), "1 values of pressure are zero, negative or infinite, the first -1e-09 in row 3"),
        (spoilt([3, 9], 0.0), "2 values of pressure"),
        (spoilt(3, np.inf), "1 values of pressure"),
        ({"pressure": wind()["pressure"] * 1e9}, "the numbers look like nPa taken for Pa"),
        ({"pressure": wind()["pressure"] * 1e-9}, "the numbers look like Pa taken for nPa"),
        ({"speed": np.full(200, 450.0)}, "look like km_s taken for m/s"),
        ({"density": np.full(200, 5.0)}, "look like per_cm3 taken for 1/m3"),
        ({"time": wind()["time"] + (np.arange(200) > 99) * np.timedelta64(1, "m")}, "not spaced evenly"),
        ({"pressure": np.ones(3) * nPa}, "both must be"),
    ],
)
def test_series_beyond_repair_are_refused_in_a_sentence(change, words):
    columns = wind()
    if "time" in change:
        columns["time"] = columns["time"].astype("datetime64[m]")
    with pytest.raises(ValueError, match=words):
        series(**(columns | change))


def test_short_series_and_clashing_rows_are_refused():
    with pytest.raises(ValueError, match="40 pressures; 48 are needed"):
        series(**wind(40))
    again = {name: np.concatenate([x, x[:1]]) for name, x in wind().items()}
    again["pressure"][-1] *= 2
    with pytest.raises(ValueError, match="1 times come twice"):
        series(**again)
    assert series(**again, repair=True).repairs.repeated == 1


def test_a_series_whose_gaps_would_fill_the_memory_is_counted_and_refused():
    """Two spans of hourly values a thousand million hours apart: 8 GB, for which nothing is asked."""
    hours = np.concatenate([np.arange(60.0), 1e9 + np.arange(60.0)])
    with pytest.raises(ValueError, match=r"span 1,000,000,060 of them .*\(some 8 GB\), more than the 10,000,000"):
        series(hours * HOUR, np.full(120, 2e-9))
    with pytest.raises(ValueError, match=r"span 1,060 .* more than the 1,000 that most_rows"):
        series(np.concatenate([np.arange(60.0), 1e3 + np.arange(60.0)]) * HOUR, np.full(120, 2e-9), most_rows=1000)


def test_impossible_values_become_gaps_only_on_demand_and_with_a_count():
    found = series(**wind(**spoilt([10, 30], -1.0)), repair=True)
    assert (found.repairs.refused, found.repairs.filled) == (2, 2)
    assert (found.pressure > 0).all()


def omni_line(year, day, hour, density, speed, pressure):
    words = [str(year), str(day), str(hour)] + ["0"] * 52
    words[23], words[24], words[28] = f"{density:.1f}", f"{speed:.0f}.", f"{pressure:.2f}"
    return " ".join(words)


def test_omni_rows_are_read_by_word_and_fill_values_are_missing(tmp_path):
    lines = [omni_line(2003, 365, h, 7.0, 400, 2.0) for h in range(24)] + [
        omni_line(2004, 1 + h // 24, h % 24, 5.0, 500, 4.0) for h in range(72)
    ]
    lines[30] = omni_line(2004, 1, 6, 999.9, 9999, 99.99)
    (tmp_path / "omni2_2003.dat").write_text("\n".join(lines[:24]) + "\n")
    (tmp_path / "omni2_2004.dat").write_text("\n".join(lines[24:]) + "\n")
    found = read_omni(tmp_path)
    assert found.start == np.datetime64("2003-12-31T00")
    assert (len(found.pressure), found.step) == (96, HOUR)
    assert found.pressure[[0, 30]] == pytest.approx([2 * nPa, 4 * nPa])
    assert found.speed[[0, 24]] == pytest.approx([4e5, 5e5])
    assert found.density[[0, 24]] == pytest.approx([7e6, 5e6])
    assert (found.repairs.filled, found.repairs.filled_speed) == (1, 2)
    assert not found.measured[30]
    lines[5] = "2003 365 5 nonsense"
    (tmp_path / "bad.dat").write_text("\n".join(lines))
    with pytest.raises(ValueError, match=r"bad\.dat, line 6: no hourly OMNI2 row"):
        read_omni(tmp_path / "bad.dat")


def test_csv_npz_and_parquet_hold_the_same_series(tmp_path):
    import pyarrow
    from pyarrow import parquet

    columns = {"utc": wind()["time"].astype("datetime64[s]"), "pressure_nPa": wind()["pressure"] / nPa}
    columns |= {"speed_km_s": wind()["speed"] / 1e3}
    np.savez(tmp_path / "a.npz", **columns)
    parquet.write_table(pyarrow.table(columns), tmp_path / "a.parquet")
    rows = ["utc,pressure_nPa,speed_km_s"] + [
        f"{t},{p!r},{v}" for t, p, v in zip(*(x.tolist() for x in columns.values()), strict=True)
    ]
    rows[4] = rows[4].split(",")[0] + ",,450.0"
    (tmp_path / "a.csv").write_text("\n".join(rows))
    found = [read_series(tmp_path / f"a.{ending}") for ending in ("npz", "parquet", "csv")]
    for one in found:
        assert one.start == np.datetime64("2003-01-01")
        np.testing.assert_allclose(one.speed, 4.5e5, rtol=1e-12)
    np.testing.assert_allclose(found[0].pressure, wind()["pressure"], rtol=1e-14)
    np.testing.assert_allclose(found[1].pressure, found[0].pressure, rtol=1e-14)
    assert found[2].repairs.filled == 1
    (tmp_path / "b.csv").write_text("\n".join(rows).replace("utc,pressure_nPa", "utc,flow"))
    assert read_series(tmp_path / "b.csv", {"pressure_nPa": "flow"}).repairs.filled == 1
    (tmp_path / "c.csv").write_text("\n".join(rows).replace("pressure_nPa", "pressure_Pa"))
    (tmp_path / "d.csv").write_text("\n".join(rows).replace(",450.0", ",fast"))
    (tmp_path / "e.npz").write_text("no archive")
    (tmp_path / "f.parquet").write_text("no table")
    for name, words in (
        ("b.csv", "no column pressure_nPa or pressure_Pa; there are utc, flow"),
        ("c.csv", "the numbers look like nPa taken for Pa"),
        ("d.csv", "speed_km_s is not made of numbers"),
        ("e.npz", "no npz file"),
        ("f.parquet", "no parquet file"),
    ):
        with pytest.raises(ValueError, match=words):
            read_series(tmp_path / name)


def test_laws_with_impossible_parameters_are_refused():
    for name, parameters, words in (
        ("cauchy", {}, "one of gamma, lognormal"),
        ("gamma", {"shape": 2.0}, "takes shape, scale, not shape"),
        ("gamma", {"shape": -2.0, "scale": 1e-9}, "must be a positive number"),
    ):
        with pytest.raises(ValueError, match=words):
            named(name, **parameters)
    with pytest.raises(ValueError, match="no pressures can be drawn"):
        solar_wind.history(named("inverse-gaussian", **EXAMPLES["inverse-gaussian"][0]), np.arange(3.0), 1)
    with pytest.raises(ValueError, match="constant, redrawn, correlated"):
        solar_wind.history(LAW, np.arange(3.0), 1, "breezy")
    for options, words in (
        ({"kind": "correlated", "interval": DAY}, "takes no interval, only a redrawn"),
        ({"correlation_time": DAY}, "takes no correlation_time, only a correlated"),
        ({"interval": 0.0}, "interval must be positive"),
        ({"times": np.zeros(3)}, "and rise"),
    ):
        with pytest.raises(ValueError, match=words):
            solar_wind.history(LAW, **({"times": np.arange(3.0), "seed": 1} | options))
