"""What surrounds a craft: [environment] and the kinds inside it."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from sailviz.scene.values import (
    POSITIVE,
    Angle,
    ForcePerLength,
    IonMass,
    Length,
    MassDensity,
    Moment,
    Mu,
    NumberDensity,
    Pressure,
    Section,
    SolarFlux,
    Time,
    one_of,
    wrong,
)


class DrawnWind(Section):
    """Solar-wind dynamic pressure at 1 au drawn from a law: independent every `redraw`, correlated, or one value for
    the whole flight. reference : the pressure of nominal thrust, the law's mean, what leaves the mean thrust nominal,
    or a pressure."""

    variation: Literal["redrawn", "correlated", "constant"] = "redrawn"
    redraw: Annotated[Time, POSITIVE] = 86_400.0
    correlation_time: Annotated[Time, POSITIVE] = 61_200.0
    yearly_deviation: Annotated[float, Field(ge=0, le=1)] = 0.0
    seed: Annotated[int, Field(ge=0)]
    reference: Annotated[Pressure, POSITIVE] | Literal["mean", "unbiased"] = "mean"


class GammaWind(DrawnWind):
    """The thesis' law."""

    kind: Literal["gamma"]
    shape: Annotated[float, POSITIVE]
    scale: Annotated[Pressure, POSITIVE]


class LognormalWind(DrawnWind):
    """Fits the measured pressures better: scale is the median, sigma that of ln p."""

    kind: Literal["lognormal"]
    sigma: Annotated[float, POSITIVE]
    scale: Annotated[Pressure, POSITIVE]


class BurrWind(DrawnWind):
    """Burr XII, which fits the measured pressures best."""

    kind: Literal["burr"]
    c: Annotated[float, POSITIVE]
    d: Annotated[float, POSITIVE]
    scale: Annotated[Pressure, POSITIVE]

    @model_validator(mode="after")
    def _mean_exists(self) -> Self:
        if self.c * self.d <= 1:
            raise wrong("with c d not above 1 this law has no mean pressure")
        return self


class ReplayedWind(Section):
    """A measured series: OMNI2 hourly text, npz, CSV or parquet. It begins at `start`, or at a place drawn with the
    seed; impossible values are an error unless `repair` says to fill and count them."""

    kind: Literal["replay"]
    file: str
    start: Moment | None = None
    seed: Annotated[int, Field(ge=0)] | None = None
    reference: Annotated[Pressure, POSITIVE] | Literal["mean", "unbiased"] = "mean"
    potential: Literal["fixed", "from speed"] = "fixed"
    repair: bool = False

    @model_validator(mode="after")
    def _begins(self) -> Self:
        one_of(self, "start", "seed")
        return self


class SteadyWind(Section):
    """The nominal wind."""

    kind: Literal["steady"]


class SteadyIrradiance(Section):
    """Sunlight as at the mean."""

    kind: Literal["steady"]


class CyclicIrradiance(Section):
    """Sunlight with its 11-year cycle (by the epoch, else from a maximum on) and a daily flicker drawn with the seed;
    both as shares of the mean."""

    kind: Literal["cycle"]
    amplitude: Annotated[float, Field(ge=0, lt=0.1)] = 3.6e-4
    flicker: Annotated[float, Field(ge=0, lt=0.1)] = 2.454e-4
    redraw: Annotated[Time, POSITIVE] = 86_400.0
    seed: Annotated[int, Field(ge=0)] = 0


Winds = Annotated[SteadyWind | GammaWind | LognormalWind | BurrWind | ReplayedWind, Field(discriminator="kind")]


class ForceProfile(Section):
    """Plasma drag per length of tether, exponential in altitude."""

    kind: Literal["exponential-force"]
    force_per_length: Annotated[ForcePerLength, POSITIVE]
    reference_altitude: Annotated[Length, POSITIVE] = 700e3
    scale_height: Annotated[Length, POSITIVE]


class DensityProfile(Section):
    """Plasma density, exponential in altitude, of one mean ion mass; the force law makes drag of it."""

    kind: Literal["exponential-density"]
    density: Annotated[NumberDensity, POSITIVE]
    reference_altitude: Annotated[Length, POSITIVE] = 700e3
    scale_height: Annotated[Length, POSITIVE]
    ion_mass: Annotated[IonMass, POSITIVE] = 15.999 * 1.66053906660e-27


class IonosphereTable(Section):
    """The plasma of IRI-2020 over latitude, local time, altitude and solar flux. density_factor: how far the truth may
    be off, 0.5 to 2 for the whole model."""

    kind: Literal["iri-2020"]
    density_factor: Annotated[float, POSITIVE] = 1.0
    above_table: Literal["refuse", "hold"] = "refuse"


class ExponentialAtmosphere(Section):
    """Neutral density, exponential in altitude."""

    kind: Literal["exponential"]
    density: Annotated[MassDensity, POSITIVE]
    reference_altitude: Annotated[Length, POSITIVE] = 700e3
    scale_height: Annotated[Length, POSITIVE]


class MsisAtmosphere(Section):
    """Neutral density of NRLMSIS 2.1, tabulated for the solar flux and the geomagnetic index ap of the scene."""

    kind: Literal["nrlmsis-2.1"]
    ap: Annotated[float, Field(ge=0, le=400)] = 10.0


class SpaceWeather(Section):
    """Measured and predicted days of the Sun's radio flux and of the geomagnetic index ap, from a file of CelesTrak,
    CSSI or GFZ, for the air (NRLMSIS) and the ionosphere's solar level. storms: ap of every three hours instead of its
    daily mean. continuation: what holds after the file's last day, which is an error without it; the cycle and a
    constant flux go with a constant ap."""

    file: str
    storms: bool = False
    continuation: Literal["cycle", "constant", "11 years earlier"] | None = None
    continued_solar_flux: Annotated[SolarFlux, Field(ge=60, le=300)] | None = None
    continued_ap: Annotated[float, Field(ge=0, le=400)] = 10.0

    @model_validator(mode="after")
    def _continued(self) -> Self:
        if (self.continuation == "constant") != (self.continued_solar_flux is not None):
            raise wrong('continuation = "constant" and continued_solar_flux_sfu go together')
        return self


class MagneticSphere(Section):
    """A sphere round the central body into which the solar wind does not come."""

    radius: Annotated[Length, POSITIVE]


SkyWord = Literal[
    "sun", "mercury", "venus", "earth", "moon", "mars", "jupiter", "saturn", "uranus", "neptune", "earth-moon"
]


class ThirdBody(Section):
    """A planet on a circular orbit in the ecliptic, whose gravity acts on the craft."""

    name: str = "Earth"
    mu: Annotated[Mu, POSITIVE] = 3.986004418e14
    radius: Annotated[Length, POSITIVE] = 149_597_870_700.0
    azimuth: Angle = 0.0


class Environment(Section):
    """Everything around the craft but the point mass it orbits."""

    solar_wind: Winds = SteadyWind(kind="steady")
    irradiance: Annotated[SteadyIrradiance | CyclicIrradiance, Field(discriminator="kind")] = SteadyIrradiance(
        kind="steady"
    )
    ionosphere: Annotated[ForceProfile | DensityProfile | IonosphereTable, Field(discriminator="kind")] | None = None
    atmosphere: Annotated[ExponentialAtmosphere | MsisAtmosphere, Field(discriminator="kind")] | None = None
    solar_flux: Annotated[SolarFlux, POSITIVE] | Literal["cycle"] | None = None
    space_weather: SpaceWeather | None = None
    sun_right_ascension: Angle | None = None
    shadow: Literal["cylinder", "cone"] | None = None
    magnetic_sensitivity: Annotated[float, Field(ge=0, le=1)] = 0.0
    third_body: ThirdBody | None = None
    j2: bool = False
    j3: bool = False
    j4: bool = False
    corotation: bool = False
    height_above: Literal["sphere", "ellipsoid"] = "sphere"
    gravity_of: Annotated[list[SkyWord], Field(min_length=1)] | None = None
    shadow_of: list[SkyWord] | None = None
    magnetosphere: Literal["shue-1998", "none"] | MagneticSphere | None = None

    @property
    def gravity_of_bodies(self) -> list[str]:
        """Words of the bodies that pull beside the central one."""
        return [] if self.gravity_of is None else list(self.gravity_of)
