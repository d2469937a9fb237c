"""The shape of a solar sail, which is what the light pushes: the kinds of [device.shape]."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from sailviz.scene.values import POSITIVE, Angle, Length, Section, wrong

STEEP = Field(ge=0, lt=1.5707963267948966)
Unit = Literal["m", "cm", "mm", "in", "ft", "km"]
Front = Literal["+x", "-x", "+y", "-y", "+z", "-z"]


class Bus(Section):
    """A closed box beside the film, in its axes: +z away from the Sun. film : of its outside."""

    size: Annotated[list[Annotated[Length, POSITIVE]], Field(min_length=3, max_length=3)]
    centre: Annotated[list[Length], Field(min_length=3, max_length=3)]
    film: Annotated[str, Field(min_length=1)] = "black"


class Air(Section):
    """How the scene's atmosphere pushes the facets: Maxwell's law of free molecular flow, or its limit of a gas without
    heat. speed_ratio : of the flow over the most probable speed of the gas; accommodation : of momentum;
    wall_temperature_ratio : of wall and gas. By default oxygen atoms of 1000 K, a wall of 300 K."""

    law: Literal["free-molecular", "hyperthermal"] = "free-molecular"
    speed_ratio: Annotated[float, POSITIVE] = 7.5
    normal_accommodation: Annotated[float, Field(ge=0, le=1)] = 1.0
    tangential_accommodation: Annotated[float, Field(ge=0, le=1)] = 1.0
    wall_temperature_ratio: Annotated[float, POSITIVE] = 0.3


class Shape(Section):
    """What every shape may say: whether parts shade each other, how its table is made and read, how air pushes it."""

    shadow: bool = True
    cells: Annotated[int, Field(ge=2, le=256, multiple_of=2)] = 32
    interpolation: Literal["bilinear", "bicubic"] = "bilinear"
    bus: Bus | None = None
    air: Air | None = None


class SquareShape(Shape):
    """Four quadrants between diagonal booms. cone : by which the booms bend downwind; sag : depth of a strip over its
    chord."""

    kind: Literal["square"]
    side: Annotated[Length, POSITIVE]
    cone: Annotated[Angle, Field(gt=-1.5, lt=1.5)] = 0.0
    sag: Annotated[float, Field(ge=-1, le=1)] = 0.0


class CapShape(Shape):
    """Part of a sphere over a round mouth, its middle blown downwind."""

    kind: Literal["cap"]
    diameter: Annotated[Length, POSITIVE]
    edge_slope: Annotated[Angle, STEEP] = 0.0


class DiscShape(Shape):
    """Flat and round."""

    kind: Literal["disc"]
    diameter: Annotated[Length, POSITIVE]


class RingShape(Shape):
    """A flat ring."""

    kind: Literal["ring"]
    diameter: Annotated[Length, POSITIVE]
    inner_diameter: Annotated[Length, POSITIVE]

    @model_validator(mode="after")
    def _open(self) -> Self:
        if self.inner_diameter >= self.diameter:
            raise wrong("inner_diameter must be less than diameter")
        return self


class HeliogyroShape(Shape):
    """Blades from the hub outwards, each pitched about its own axis by pitch + twist x / length."""

    kind: Literal["heliogyro"]
    blades: Annotated[int, Field(ge=1, le=64)]
    length: Annotated[Length, POSITIVE]
    chord: Annotated[Length, POSITIVE]
    pitch: Annotated[Angle, Field(gt=-1.5, lt=1.5)] = 0.0
    twist: Annotated[Angle, Field(gt=-1.5, lt=1.5)] = 0.0


class PyramidShape(Shape):
    """Quasi-rhombic: four plane films between booms that bend downwind by cone, at half the opening from the x axis."""

    kind: Literal["pyramid"]
    boom: Annotated[Length, POSITIVE]
    cone: Annotated[Angle, STEEP]
    opening: Annotated[Angle, Field(gt=0, lt=3.141592653589793)] = 1.5707963267948966


class FileShape(Shape):
    """A file of facets beside the scene: STL, OBJ, GLB, PLY or 3MF. front : the axis of the file that the films' front
    faces; parts : by their names FILM or FILM/BACK, where not the device's own, or black for a closed one."""

    kind: Literal["file"]
    file: Annotated[str, Field(min_length=1)]
    unit: Unit | None = None
    front: Front = "-z"
    parts: dict[str, str] = {}


Shapes = Annotated[
    SquareShape | CapShape | DiscShape | RingShape | HeliogyroShape | PyramidShape | FileShape,
    Field(discriminator="kind"),
]
