"""Names that scripts may rely on: each is there, is what it says, and keeps the shape of what it is given."""

from __future__ import annotations

import pkgutil
import subprocess
import sys
from dataclasses import fields, is_dataclass
from importlib import import_module

import numpy as np
import pytest

import sailviz
from sailviz.constants import ATOMIC_MASS, AU, MU_SUN
from sailviz.design import asymptotic, decay, displaced, minimum_time, special_thrust, spirals
from sailviz.elements import Elements
from sailviz.propulsion import electric_sail, plasma_brake, solar_sail
from sailviz.steering import analytic_pitch, optimal_pitch
from sailviz.uncertainty import chaos, control, wind

VERBS = ("load_scene", "simulate", "record", "read", "compare", "record_trajectory", "sweep")
FIXED = {
    "sailviz.propulsion.solar_sail": "Film film acceleration",
    "sailviz.propulsion.electric_sail": (
        "acceleration cone_angle pitch_angle dimensionless_acceleration characteristic_acceleration"
    ),
    "sailviz.propulsion.plasma_brake": "force_per_length current power",
    "sailviz.design.displaced": "circular stability planet_following flat_ellipse lagrange_point",
    "sailviz.design.spirals": "logarithmic insertion",
    "sailviz.design.special_thrust": "radial circumferential tangential",
    "sailviz.design.asymptotic": "propagate",
    "sailviz.design.decay": "decay_time exponential_decay_time",
    "sailviz.steering": "optimal_pitch analytic_pitch",
    "sailviz.design.minimum_time": "circle_to_circle orbit_to_orbit rendezvous",
    "sailviz.uncertainty.wind": "fit generate read_omni",
    "sailviz.uncertainty.chaos": "expand",
    "sailviz.uncertainty.control": "saturation",
}
FOUND = [m for m in pkgutil.walk_packages(sailviz.__path__, "sailviz.") if not m.name.endswith("__main__")]
MODULES, PACKAGES = [m.name for m in FOUND], [m.name for m in FOUND if m.ispkg]


@pytest.mark.parametrize("home", ["sailviz", *FIXED])
def test_a_name_that_is_fixed_can_be_called_from_where_it_is_fixed(home):
    room = import_module(home)
    for name in VERBS if home == "sailviz" else FIXED[home].split():
        assert callable(getattr(room, name)), f"{home}.{name}"
        assert getattr(room, name).__doc__, f"{home}.{name}"


@pytest.mark.parametrize("package", ["sailviz", *PACKAGES])
def test_a_package_offers_what_its_modules_define_and_defines_nothing(package):
    room = import_module(package)
    homes = getattr(room, "_HOMES", {})
    assert sorted(getattr(room, "__all__", [])) == sorted(homes)
    for name, home in homes.items():
        assert getattr(room, name) is getattr(import_module(f"{package}.{home}"), name)
    own = {
        name
        for name, thing in vars(room).items()
        if getattr(thing, "__module__", None) == package and not name.startswith("__")
    }
    assert own == set()
    assert room.__doc__


def test_no_module_hides_a_name_that_a_package_offers_once_all_are_imported():
    code = f"""
from importlib import import_module
from types import ModuleType
modules = {MODULES!r}
for name in modules:
    import_module(name)
for package in ["sailviz", *modules]:
    room = import_module(package)
    for name in getattr(room, "_HOMES", {{}}):
        assert not isinstance(getattr(room, name), ModuleType), (package, name)
"""
    subprocess.run([sys.executable, "-c", code], check=True, timeout=120)


def shaped(value, shape):
    """Whether a result, or every field of one that is numbers, has a shape."""
    if is_dataclass(value):
        numbers = [getattr(value, field.name) for field in fields(value)]
        return all(np.shape(x) == shape for x in numbers if isinstance(x, float | np.ndarray | np.generic))
    return np.shape(value) == shape


BOTH = {  # a function of one number, and a value that it takes
    "electric_sail.cone_angle": (electric_sail.cone_angle, 0.3),
    "electric_sail.pitch_angle": (electric_sail.pitch_angle, 0.2),
    "electric_sail.dimensionless_acceleration": (electric_sail.dimensionless_acceleration, 0.3),
    "electric_sail.characteristic_acceleration": (
        lambda voltage: electric_sail.characteristic_acceleration(100, 20e3, voltage, 1000.0),
        20e3,
    ),
    "plasma_brake.force_per_length": (
        lambda voltage: plasma_brake.force_per_length(1e11, 16 * ATOMIC_MASS, 7500.0, voltage),
        1000.0,
    ),
    "plasma_brake.current": (
        lambda density: plasma_brake.current(density, 16 * ATOMIC_MASS, 7500.0, 1000.0, 5e3, 50e-6),
        1e11,
    ),
    "plasma_brake.power": (
        lambda density: plasma_brake.power(density, 16 * ATOMIC_MASS, 7500.0, 1000.0, 5e3, 50e-6, 0.8),
        1e11,
    ),
    "displaced.circular": (lambda radius: displaced.circular(radius, 0.1, 0.9, "ideal"), AU),
    "displaced.planet_following.cone": (
        lambda nu: displaced.planet_following(AU, 0.0167, nu, 1.3, device="electric-sail").cone,
        0.5,
    ),
    "displaced.flat_ellipse.cone": (lambda nu: displaced.flat_ellipse(AU, 0.1, nu, 0.1 * AU, 0.9, "ideal").cone, 0.5),
    "displaced.lagrange_point": (lambda radius: displaced.lagrange_point(radius, "ideal"), 0.95 * AU),
    "displaced.stability.stable": (lambda psi: displaced.stability(psi, 0.9, "electric-sail").stable, 0.1),
    "spirals.logarithmic": (lambda pitch: spirals.logarithmic(0.05, pitch, "ideal"), 0.6),
    "spirals.logarithmic.time": (lambda r1: spirals.logarithmic(0.05, 0.6, "ideal").time(AU, r1, MU_SUN), 1.5 * AU),
    "spirals.logarithmic.angle": (lambda r1: spirals.logarithmic(0.05, 0.6, "ideal").angle(AU, r1), 1.5 * AU),
    "spirals.insertion": (lambda nu: spirals.insertion(0.2, nu, "ideal"), 2.5),
    "special_thrust.radial": (special_thrust.radial, 0.2),
    "special_thrust.circumferential": (special_thrust.circumferential, 0.01),
    "special_thrust.tangential": (special_thrust.tangential, 0.01),
    "decay.decay_time": (lambda mass: decay.decay_time(mass, 5e3, 800e3, 700e3, 50e-9), 100.0),
    "decay.exponential_decay_time": (
        lambda mass: decay.exponential_decay_time(mass, 5e3, 800e3, 700e3, f700=50e-9, scale_height=200e3, exact=True),
        100.0,
    ),
    "steering.optimal_pitch": (lambda primer: optimal_pitch(primer, "jpl-2015"), 1.0),
    "steering.analytic_pitch": (lambda primer: analytic_pitch(primer, "jpl-2015"), 1.0),
    "control.saturation": (lambda scale: control.saturation(2.6, scale, 20e3, 40e3, 1000.0, 2e-9), 0.77e-9),
}


@pytest.mark.parametrize("name", BOTH)
@pytest.mark.parametrize("shape", [(), (3,), (2, 3)])
def test_a_number_gives_numbers_and_an_array_arrays_of_its_shape(name, shape):
    function, value = BOTH[name]
    found = function(np.full(shape, value) if shape else value)
    assert shaped(found, shape)
    if shape:
        once = function(value)
        for one, many in zip(numbers(once), numbers(found), strict=True):
            assert np.ravel(many) == pytest.approx(np.full(np.size(many), one), nan_ok=True)


def numbers(value):
    if not is_dataclass(value):
        return [value]
    return [
        x for x in (getattr(value, f.name) for f in fields(value)) if isinstance(x, float | np.ndarray | np.generic)
    ]


@pytest.mark.parametrize("shape", [(3,), (4, 3), (2, 2, 3)])
def test_a_sails_acceleration_has_the_shape_of_its_positions(shape):
    position, normal = np.broadcast_to([AU, 0.0, 0.0], shape), np.broadcast_to([1.0, 0.0, 0.0], shape)
    for push in (
        solar_sail.acceleration(position, normal, 1e-3, solar_sail.film("ideal")),
        electric_sail.acceleration(position, normal, 1e-3, model="final", on=True),
    ):
        assert push.shape == shape
        assert push == pytest.approx(np.broadcast_to([1e-3, 0.0, 0.0], shape))


def test_what_cannot_be_is_nan_and_says_why_for_a_number():
    lone = displaced.circular(AU, 1.0, 1.0, "electric-sail")
    assert not lone.feasible
    assert np.isnan(lone.characteristic_acceleration)
    assert "possible" in lone.reason
    both = displaced.circular(AU, np.array([0.0, 1.0]), np.array([0.9, 1.0]), "electric-sail")
    assert both.feasible.tolist() == [True, False]
    assert np.isnan(both.cone).tolist() == [False, True]


def test_a_film_is_made_from_its_optics():
    mirror = solar_sail.Film.from_optics(1.0, 1.0, 0.0, 0.0, 0.05, 0.55)
    assert (mirror.b1, mirror.b2, mirror.b3) == (0.0, 1.0, 0.0)


def test_a_stability_has_two_eigenvalues():
    assert displaced.stability(0.1, 0.9, "electric-sail", clock="meridian", cone_limit=None).lambda_squared.shape == (
        2,
    )
    assert displaced.stability(np.full(5, 0.1), 0.9, "ideal").lambda_squared.shape == (5, 2)


def test_first_order_flight_has_a_row_per_angle():
    flight = asymptotic.propagate([0.0, 0.0, 1.0], 0.0, np.linspace(0, 1, 4), 0.0, 1e-3, 2, leg=None, scheme="midpoint")
    assert (flight.q.shape, flight.time.shape, flight.radius.shape) == ((4, 3), (4,), (4,))


def test_fastest_flights_are_found_from_circle_orbit_and_planet():
    circles = minimum_time.circle_to_circle(AU, 1.1 * AU, "ideal", 2e-3)
    assert circles.feasible
    assert circles.costates.shape == (3,)
    assert circles.revolutions > 0
    assert circles.residual < 1e-9
    ellipse = Elements(AU, 0.05, 0.0, 0.0, 0.0, 0.0), Elements(1.1 * AU, 0.05, 0.02, 0.0, 0.0, 0.0)
    orbits = minimum_time.orbit_to_orbit(*ellipse, "ideal", 2e-3, starts=4)
    assert orbits.costates.shape == (6,)
    with pytest.raises(ValueError, match="no ephemeris"):
        minimum_time.rendezvous("Vulcan", "2030-01-01")


def test_wind_is_fitted_drawn_and_read(tmp_path):
    times = 3600.0 * np.arange(2000)
    pressure = wind.generate("gamma", times, seed=1, shape=2.6, scale=0.77e-9, interval=3600.0)
    assert pressure.shape == times.shape
    fits = wind.fit(pressure)
    assert fits["gamma"].parameters["scale"] == pytest.approx(0.77e-9, rel=0.1)
    assert fits["gamma"].ks < 0.05
    assert np.isfinite(fits["gamma"].aic)
    with pytest.raises(OSError, match=r"omni\.dat"):
        wind.read_omni(tmp_path / "omni.dat")


def test_an_expansion_knows_its_mean_spread_and_percentiles():
    for basis in ("root", "laguerre"):
        found = chaos.expand(lambda p: np.stack([p, 2 * p], axis=-1), 2.6, 0.77e-9, 2, basis=basis)
        assert found.mean == pytest.approx(2.6 * 0.77e-9 * np.array([1, 2]))
        assert found.standard_deviation.shape == (2,)
        assert found.percentile(50).shape == (2,)
        assert found.percentile([5, 95]).shape == (2, 2)


def test_every_result_of_a_design_is_frozen():
    for package in (p for p in PACKAGES if p.startswith("sailviz.design.")):
        room = import_module(package)
        for thing in (getattr(room, name) for name in getattr(room, "__all__", [])):
            if isinstance(thing, type) and is_dataclass(thing):
                assert thing.__dataclass_params__.frozen, f"{package}.{thing.__name__}"
