"""The tables of a scene file, one class each: what may stand in them, in SI once loaded.

Imports neither rerun nor numba nor scipy, so that `sailviz check` answers at once.
"""

from typing import Annotated, Literal, Self, get_args

from pydantic import Field, model_validator

from sailviz.scene.device import DistanceControl, ElectrochromicControl, PressureControl
from sailviz.scene.environment import Winds
from sailviz.scene.values import POSITIVE, Angle, Section, Time, one_of, wrong
from sailviz.words import nearest, shown


class DenseOutput(Section):
    """A window of the run in which rows come closer."""

    start: Annotated[Time, Field(ge=0)]
    end: Annotated[Time, POSITIVE]
    output_interval: Annotated[Time, POSITIVE]

    @model_validator(mode="after")
    def _window(self) -> Self:
        if self.end - self.start < self.output_interval:
            raise wrong("the window from start to end is shorter than its output_interval")
        return self


class Propagation(Section):
    """Duration, output grid, integrator and accuracy."""

    duration: Annotated[Time, POSITIVE]
    outputs: Annotated[int, Field(ge=2, le=1_000_000_000)] | None = None
    output_interval: Annotated[Time, POSITIVE] | None = None
    dense: list[DenseOutput] = []
    integrator: Literal["auto", "collocation", "dop853", "gauss-jackson"] = "auto"
    tolerance: Annotated[float, Field(ge=1e-15, le=1e-3)] = 1e-10
    largest_step: Annotated[Time, POSITIVE] | None = None

    @model_validator(mode="after")
    def _grid(self) -> Self:
        if self.outputs is not None and self.output_interval is not None:
            raise wrong("give outputs or output_interval, not both")
        if self.output_interval is not None and self.output_interval > self.duration:
            raise wrong("output_interval is longer than duration")
        return self


class FirstOrderApproximation(Section):
    """The first-order analytic solution, recorded beside the integrated trajectory."""

    kind: Literal["first-order"]
    name: str = "first order"
    leg: Annotated[Angle, POSITIVE] | None = None
    scheme: Literal["plain", "midpoint"] = "plain"


class QuasiCircularApproximation(Section):
    """The decay of a nearly circular orbit by quadrature, its altitude recorded beside the integrated one."""

    kind: Literal["quasi-circular"]


Approximation = Annotated[FirstOrderApproximation | QuasiCircularApproximation, Field(discriminator="kind")]


class ManyFlights(Section):
    """Many flights of the scene side by side. control : "device" as the device has it, "none", or one of its own;
    solar_wind : another wind than the scene's."""

    name: Annotated[str, Field(min_length=1)]
    control: (
        Literal["device", "none"]
        | Annotated[PressureControl | DistanceControl | ElectrochromicControl, Field(discriminator="kind")]
    ) = "device"
    solar_wind: Winds | None = None


class Drawn(Section):
    """A key of the scene, with its unit, that each flight of an ensemble draws for itself: "normal(20, 3)"."""

    key: Annotated[str, Field(min_length=1)]
    distribution: str


class Ensemble(ManyFlights):
    """Flights through winds (or sunshine) of their own; of a craft that turns with what each draws. seed : that of the
    wind if absent; keep : flights drawn whole."""

    flights: Annotated[int, Field(ge=2, le=1_000_000)] = 200
    seed: Annotated[int, Field(ge=0)] | None = None
    keep: Annotated[int, Field(ge=1, le=200)] = 60
    draw: Annotated[list[Drawn], Field(min_length=1)] | None = None


class Chaos(ManyFlights):
    """What order + 1 flights tell about a gamma-distributed pressure that stays the same for a whole flight."""

    order: Annotated[int, Field(ge=1, le=30)] = 5
    basis: Literal["root", "laguerre"] = "root"


class Limits(Section):
    """How much a run may ask for before it is refused; nothing of this changes what is flown. rows : of the recording;
    draws : of a wind or of sunlight, or updates of a controller; changes : of wind or voltage in all flights of an
    ensemble together; steps : rows of a steering table that a law makes, or legs of the first-order solution;
    air_tables : of real space weather, one a day or eight; integration_steps : of the flight, tried ones; flights : of
    a sweep."""

    rows: Annotated[int, Field(ge=1, le=1_000_000_000)] = 10_000_000
    draws: Annotated[int, Field(ge=1, le=1_000_000_000)] = 10_000_000
    changes: Annotated[int, Field(ge=1, le=1_000_000_000_000)] = 1_000_000_000
    steps: Annotated[int, Field(ge=1, le=1_000_000_000)] = 10_000_000
    air_tables: Annotated[int, Field(ge=1, le=1_000_000)] = 4_000
    integration_steps: Annotated[int, Field(ge=1, le=1_000_000_000_000)] = 200_000_000
    flights: Annotated[int, Field(ge=1, le=1_000_000_000)] = 10_000_000


PlotWord = Literal[
    "distance",
    "speed",
    "height",
    "angle",
    "clock",
    "earth",
    "push",
    "inclination",
    "eccentricity",
    "altitude",
    "approximation",
    "switching_function",
    "plasma_force",
    "plasma_density",
    "mean_ion_mass",
    "tether_current",
    "tether_voltage",
    "tether_power",
    "tether_tilt",
    "air_density",
    "air_drag",
    "solar_flux",
    "sunlit_fraction",
    "solar_wind_pressure",
    "thrust_voltage",
    "film_temperature",
    "dose",
    "spin_rate",
    "modulation",
    "thrust_lost",
    "wheel_torque",
    "light_torque",
    "air_torque",
    "irradiance",
    "electrochromic_state",
]


class Recording(Section):
    """How the recording plays: how long, 30 s (40 s in a low orbit) where nothing is said; and which curves are in
    front, most telling first, of those that the flight has. Without them those that vary most are."""

    play_duration: Annotated[Time, POSITIVE] | None = None
    plots: list[PlotWord] = []


OfRows = Literal["start", "end", "min", "max", "mean", "drift"]
STATISTICS_OF_ROWS: tuple[str, ...] = get_args(OfRows)


class Expectation(Section):
    """A quantity that the run must reach: value and tolerance in the quantity's own unit. device : of a list, whose
    share of the thrust it is. ensemble : of its flights instead, a statistic of their ends: the mean, the mean miss of
    the nominal flight's end, the standard deviation, or of a craft that turns the percentile at `percent`."""

    quantity: str
    device: str | None = None
    ensemble: str | None = None
    statistic: Literal["mean", "miss", "deviation", "percentile"] | None = None
    percent: Annotated[float, Field(ge=0, le=100)] | None = None
    closed_form: Literal["kepler", "reduced-kepler", "displaced-orbit", "logarithmic-spiral"] | None = None
    at: OfRows | str | None = None
    at_time: Time | None = None
    value: float
    within: Annotated[float, POSITIVE] | None = None
    within_percent: Annotated[float, POSITIVE] | None = None

    @model_validator(mode="after")
    def _known(self) -> Self:
        from sailviz.scene.quantities import spellings

        if self.quantity not in spellings():
            raise wrong(f"unknown quantity {shown(self.quantity)}. {nearest(self.quantity, spellings())}")
        if (self.quantity == "closed_form_error") != (self.closed_form is not None):
            raise wrong('closed_form belongs to quantity = "closed_form_error" and to no other')
        one_of(self, "at", "at_time")
        if (self.ensemble is None) != (self.statistic is None):
            raise wrong("ensemble and statistic belong together")
        if (self.statistic == "percentile") != (self.percent is not None):
            raise wrong('statistic = "percentile" and percent belong together')
        one_of(self, "within", "within_percent")
        if self.value == 0 and self.within_percent is not None:
            raise wrong("of a value of 0 no percentage can be taken: give within")
        return self
