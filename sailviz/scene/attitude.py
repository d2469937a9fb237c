"""How the craft turns: the kinds of [attitude], the mass that turns, and the actuators that turn it."""

from math import isfinite
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from sailviz.scene.device import FilmCoefficients, FilmOptics
from sailviz.scene.values import (
    HALF_TURN,
    POSITIVE,
    Angle,
    AngularMomentum,
    AngularRate,
    Area,
    InertiaMatrix,
    Length,
    Mass,
    PositionVector,
    RateVector,
    Section,
    Speed,
    Torque,
    wrong,
)

QUARTER = Field(ge=0, lt=1.5707963267948966)
UNEVEN = 0.05  # of a spinner's transverse moments of inertia, over which an average over its turn is not its motion


class Wheels(Section):
    """Three reaction wheels along the body's axes."""

    kind: Literal["wheels"]
    torque: Annotated[Torque, POSITIVE]
    storage: Annotated[AngularMomentum, POSITIVE]


class SlidingMass(Section):
    """A mass that slides across the sail, along body x and y, and takes the centre of mass with it."""

    kind: Literal["sliding-mass"]
    mass: Annotated[Mass, POSITIVE]
    travel: Annotated[Length, POSITIVE]
    speed: Annotated[Speed, POSITIVE]


class Vane(Section):
    """A plate of the sail's film on a hinge that points outwards. limit : to either side; rest : where it stands when
    nothing is wanted of it."""

    kind: Literal["vane"]
    position: PositionVector
    area: Annotated[Area, POSITIVE]
    limit: Annotated[Angle, QUARTER] = 1.5
    rest: Annotated[Angle, HALF_TURN] = 0.0

    @model_validator(mode="after")
    def _outside(self) -> Self:
        if self.position[0] == 0 and self.position[1] == 0:
            raise wrong("position lies on the z axis, where a hinge that points outwards has no direction")
        if abs(self.rest) > self.limit:
            raise wrong("rest lies beyond limit")
        return self


class Reflectivity(Section):
    """A patch of the film whose reflectivity is switched: on it is the film, off what `off` says."""

    kind: Literal["reflectivity"]
    position: PositionVector
    area: Annotated[Area, POSITIVE]
    off: FilmCoefficients | FilmOptics


class PointingControl(Section):
    """What is wanted of the actuators: that the craft follows its steering like a damped spring."""

    kind: Literal["pd"]
    frequency: Annotated[AngularRate, POSITIVE]
    damping: Annotated[float, Field(ge=0)] = 1.0


class SpinAxisControl(Section):
    """What is wanted of switched reflectivity: that the spin axis follows the steering's normal. calm : off which it
    switches all of a device."""

    kind: Literal["spin-axis"]
    calm: Annotated[Angle, POSITIVE] = 0.008726646259971648


class TurningMass(Section):
    """The mass that turns: its inertia about the centre of mass, three principal moments or a matrix, and that centre;
    or film_mass, spread over the films of the device's shape, the rest of the craft's mass over its closed bodies."""

    inertia: InertiaMatrix | None = None
    film_mass: Annotated[Mass, POSITIVE] | None = None
    centre_of_mass: PositionVector | None = None
    gravity_gradient: bool = True
    sun_angle_limit: Annotated[Angle, Field(gt=0, lt=3.141592653589793)] | None = None

    @property
    def matrix(self) -> list[list[float]] | None:
        """Inertia (3, 3) kg m2, where it is said."""
        if self.inertia is None:
            return None
        rows = [row for row in self.inertia if isinstance(row, list)]
        if rows:
            return rows
        a, b, c = (value for value in self.inertia if isinstance(value, float))
        return [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]]

    @model_validator(mode="after")
    def _massive(self) -> Self:
        if (self.inertia is None) == (self.film_mass is None):
            given = "has both" if self.inertia is not None else "has neither"
            raise wrong(f"needs exactly one of inertia or film_mass, {given}")
        if self.film_mass is not None and self.centre_of_mass is not None:
            raise wrong("film_mass tells the centre of mass: leave centre_of_mass out, or give inertia")
        if self.inertia is not None:
            fault = _no_inertia(self.inertia)
            if fault:
                raise wrong(f"inertia {fault}")
        return self


def _no_inertia(given: list[float] | list[list[float]]) -> str:
    """Why numbers are no inertia; "" where they are one."""
    rows = [row for row in given if isinstance(row, list)]
    if len(given) != 3 or (rows and (len(rows) != 3 or any(len(row) != 3 for row in rows))):
        return "needs three principal moments, or a matrix of three rows of three"
    if rows:
        return _no_matrix_of_inertia(rows)
    a, b, c = sorted(value for value in given if isinstance(value, float))
    if a <= 0:
        return "needs positive moments"
    return "" if a + b >= c * (1 - 1e-12) else "of no body: one moment is larger than the two others together"


def _no_matrix_of_inertia(rows: list[list[float]]) -> str:
    """The same for a matrix."""
    if not all(isfinite(value) for row in rows for value in row):
        return "needs numbers"
    pairs = ((1, 0), (2, 0), (2, 1))
    if any(abs(rows[i][j] - rows[j][i]) > 1e-9 * (abs(rows[i][i]) + abs(rows[j][j])) for i, j in pairs):
        return "needs a symmetric matrix"
    return "" if _has_mass(rows) else "of no body: about some axis it is larger than about the two across it together"


def _has_mass(rows: list[list[float]]) -> bool:
    """Whether a distribution of mass has this inertia, in two directions at least."""
    # the second moments of mass, S = tr(I)/2 - I, have no negative eigenvalue: nor has a leading or other minor
    half = 0.5 * (rows[0][0] + rows[1][1] + rows[2][2])
    s = [[(half if i == j else 0.0) - rows[i][j] for j in range(3)] for i in range(3)]
    little = 1e-12 * abs(half)
    pairs = [s[i][i] * s[j][j] - s[i][j] ** 2 for i, j in ((1, 0), (2, 0), (2, 1))]
    whole = (
        s[0][0] * (s[1][1] * s[2][2] - s[1][2] ** 2)
        - s[0][1] * (s[0][1] * s[2][2] - s[1][2] * s[0][2])
        + s[0][2] * (s[0][1] * s[1][2] - s[1][1] * s[0][2])
    )
    negative = min(s[i][i] for i in range(3)) < -little or min(pairs) < -little * half or whole < -little * half**2
    return not negative and half > 0 and sum(value > little for value in (s[0][0], s[1][1], s[2][2])) >= 2


class PrescribedAttitude(TurningMass):
    """As the steering says, whatever it takes: the torque that it would take is recorded."""

    kind: Literal["prescribed"]


class StartsTurned(TurningMass):
    """Where the craft stands at the start: its normal by pitch and clock from the light, as they are recorded, with a
    roll about it, or a quaternion, body to inertial."""

    pitch: Annotated[Angle, HALF_TURN] | None = None
    clock: Angle | None = None
    roll: Angle | None = None
    quaternion: Annotated[list[float], Field(min_length=4, max_length=4)] | None = None

    @model_validator(mode="after")
    def _once(self) -> Self:
        angles = [name for name in ("pitch", "clock", "roll") if getattr(self, name) is not None]
        if self.quaternion is not None and angles:
            raise wrong(f"quaternion says it all: leave {' and '.join(angles)} out")
        if self.quaternion is not None and not 1e-6 < sum(q * q for q in self.quaternion) < 1e6:
            raise wrong("quaternion must not be zero")
        return self


class FreeAttitude(StartsTurned):
    """Nothing holds the craft: light, gravity and its own momentum turn it. rates : about its axes at the start."""

    kind: Literal["free"]
    rates: RateVector = [0.0, 0.0, 0.0]


class SpinAveragedAttitude(StartsTurned):
    """A fast spin about the z axis, its motion averaged over the turn: axis and spin rate remain."""

    kind: Literal["spin-averaged"]
    spin: AngularRate

    @model_validator(mode="after")
    def _spins(self) -> Self:
        if self.spin == 0:
            raise wrong("spin must not be 0")
        moments = self.matrix
        if moments is not None:
            a, b = moments[0][0], moments[1][1]
            if abs(a - b) > UNEVEN * max(a, b):
                raise wrong("inertia about x and y differ by more than 5 %: the average over a turn is not its motion")
        return self


class ControlledAttitude(StartsTurned):
    """Actuators turn the craft as its steering wants."""

    kind: Literal["controlled"]
    rates: RateVector | None = None
    control: Annotated[PointingControl | SpinAxisControl, Field(discriminator="kind")]
    actuators: Annotated[
        list[Annotated[Wheels | SlidingMass | Vane | Reflectivity, Field(discriminator="kind")]],
        Field(min_length=1, max_length=64),
    ]

    @model_validator(mode="after")
    def _goes_together(self) -> Self:
        words = clash(self)
        if words:
            raise wrong(words)
        return self


def clash(one: ControlledAttitude) -> str:
    """Why a controller and its actuators do not go together; "" where they do."""
    for kind in ("wheels", "sliding-mass"):
        if sum(each.kind == kind for each in one.actuators) > 1:
            return f"actuators has several of kind {kind}: one is known"
    if isinstance(one.control, SpinAxisControl):
        others = sorted({each.kind for each in one.actuators if not isinstance(each, Reflectivity)})
        if others:
            return f'control of kind "spin-axis" is that of switched reflectivity, not of {", ".join(others)}'
        if one.rates is None or one.rates[2] == 0:
            return 'control of kind "spin-axis" needs rates about z, a spin'
    elif any(isinstance(each, Reflectivity) for each in one.actuators):
        return 'switched reflectivity tilts a spin axis: control.kind = "spin-axis"'
    return ""


class PhaseAttitude(Section):
    """How the craft turns during a phase: let go, or held. control and actuators : those of [attitude] where they are
    not said; the mass that turns is the same all the way, and how it turns is handed on."""

    kind: Literal["free", "controlled"]
    control: Annotated[PointingControl | SpinAxisControl, Field(discriminator="kind")] | None = None
    actuators: (
        Annotated[
            list[Annotated[Wheels | SlidingMass | Vane | Reflectivity, Field(discriminator="kind")]],
            Field(min_length=1, max_length=64),
        ]
        | None
    ) = None

    def of(self, whole: StartsTurned) -> FreeAttitude | ControlledAttitude:
        """The attitude that holds during the phase, of a scene's. ValueError, with a sentence, where there is none."""
        if isinstance(whole, SpinAveragedAttitude):
            raise ValueError("an averaged spin does not say at which angle the craft stands: it goes on to the end")
        names = (*TurningMass.model_fields, *StartsTurned.model_fields)
        same = {name: getattr(whole, name) for name in names} | {"rates": getattr(whole, "rates", None)}
        if self.kind == "free":
            if self.control is not None or self.actuators is not None:
                raise ValueError('control and actuators belong to kind "controlled"')
            had = getattr(whole, "actuators", None) or []
            kept = sorted({one.kind for one in had if one.kind in ("vane", "reflectivity")})
            if kept:
                raise ValueError(f"where {' and '.join(kept)} would be left when the craft is let go is not known")
            return FreeAttitude.model_construct(**same | {"kind": "free", "rates": same["rates"] or [0.0, 0.0, 0.0]})
        control, actuators = (getattr(self, name) or getattr(whole, name, None) for name in ("control", "actuators"))
        if control is None or actuators is None:
            missing = "control" if control is None else "actuators"
            raise ValueError(f"needs {missing}, which the scene's [attitude] has none of either")
        given = same | {"kind": "controlled", "control": control, "actuators": actuators}
        found = ControlledAttitude.model_construct(**given)
        words = clash(found)
        if words:
            raise ValueError(words)
        return found


Attitudes = Annotated[
    PrescribedAttitude | FreeAttitude | ControlledAttitude | SpinAveragedAttitude, Field(discriminator="kind")
]
Moving = FreeAttitude | ControlledAttitude | SpinAveragedAttitude  # what has a motion of its own
