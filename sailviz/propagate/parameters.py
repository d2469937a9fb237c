"""The parameters of a Model by name: one record, composed of what laws, devices and the environment declare.

A room declares its numbers in a NamedTuple (`sun.Parameters`): fields of float or int in SI and radians, said in its
comments. The record here has a field for each of them, and compiled code reads `p.sun.mean_longitude`. What has no
fixed length, steering tables, atmospheres, numbers of a callback, stands in a flat array beside it, and `Places` says
where. Compiled code gets the record alone, one pointer, and turns a name into an offset: two arrays beside each other
in every call of the right-hand side would cost 15 %.
"""

from __future__ import annotations

from typing import NamedTuple, get_type_hints

import numpy as np

from sailviz.compiled import late, layout
from sailviz.environment import atmosphere, gravity, grid, ionosphere, magnetosphere, sky, solar_level, sun, third_body
from sailviz.propulsion import electric_sail, esail_wheel, film_ageing, plasma_brake, solar_sail, thruster
from sailviz.steering import attitude, by_light


class Kinds(NamedTuple):
    """Which branches the right-hand side takes."""

    device: int = 0  # of propulsion.devices
    steering: int = 0  # of steering.attitude


class Surface(NamedTuple):
    """Of the body that the craft orbits, and how a place above it is told."""

    radius: float = 0.0  # m; 0 for none
    rotation: float = 0.0  # rad/s about +z
    ellipsoid: int = 0  # 1: altitude counts above the ellipsoid, 0: above the sphere
    shadow: int = 0  # a kind of environment.eclipse


class Primer(NamedTuple):
    """The laws that follow a primer."""

    kind: int = 0  # of steering.attitude: PRIMER, LOCAL or LYAPUNOV
    sail: int = 0  # the sail for which the law steers, of propulsion.devices
    mu: float = 0.0  # m3/s2, for the laws that know the orbit


class Pushed(NamedTuple):
    """A sail that callbacks push (sky_callback): which, and its air drag by attitude."""

    device: int = 0  # of propulsion.devices
    drag_area: float = 0.0  # m2, drag coefficient times the area that faces the flow; 0: no drag by attitude
    edge_area: float = 0.0  # m2, the same of what a sail that stands edge-on shows
    mass: float = 0.0  # kg, at which the sail has its strength, a force over the mass; 0: its strength stays
    blown: int = 0  # 1: the air pushes a shape, whose sides have kinks between them; 2: of a craft that turns by itself


class Callbacks(NamedTuple):
    """Addresses of C functions, 0 for none."""

    user_steering: int = 0  # these two of callbacks.USER_SIGNATURE, the others of callbacks.SIGNATURE
    user_force: int = 0
    steering: int = 0
    device: int = 0
    control: int = 0
    edges: int = 0  # where steps have to end, see edges_callback
    body: int = 0  # what turns a craft on purpose, see body_control
    quantity: int = 0  # what events watch beside the kinds that are built in, see quantity_callback
    forces: int = 0  # how many forces of the environment there are; Places.forces says where their addresses stand
    burns: int = 0  # 1: one of them burns propellant


class Places(NamedTuple):
    """Where things begin in the flat array of tables."""

    steering: int = 0  # numbers of the steering's callback, or its table
    device: int = 0  # numbers of the device's callback
    forces: int = 0  # pairs of an address and the place of its own numbers
    air: int = 0
    plasma: int = 0
    solar_level: int = 0  # its days
    sail: int = 0  # parameters of the sail for which a primer law steers
    control: int = 0
    control_law: int = 0
    sky: int = 0  # places of bodies, see environment.sky
    shape_air: int = 0  # air on a shape, see shape_air_callback
    body: int = 0  # numbers of a craft whose attitude moves, see body_motion
    heat: int = 0  # of a shape's films, see shape_heat_callback
    end: int = 0  # length of the array
    address: int = 0  # of the array itself, which the Model keeps alive


class Parameters(NamedTuple):
    """Everything by name."""

    kinds: Kinds
    gravity: gravity.Parameters
    surface: Surface
    third_body: third_body.Parameters
    air: atmosphere.Parameters
    plasma: ionosphere.Parameters
    sun: sun.Parameters
    solar_level: solar_level.Parameters
    solar_sail: solar_sail.Parameters
    electric_sail: electric_sail.Parameters
    thruster: thruster.Parameters
    brake: plasma_brake.Parameters
    components: attitude.Components
    inertial: attitude.Inertial
    local: attitude.Local
    table: attitude.Table
    primer: Primer
    held: grid.Held
    sky: sky.Parameters
    sides: sky.Sides
    magnetosphere: magnetosphere.Parameters
    by_light: by_light.Parameters
    pushed: Pushed
    film: film_ageing.Numbers
    wheel: esail_wheel.Numbers
    callbacks: Callbacks
    places: Places


PARTS: dict[str, type] = get_type_hints(Parameters)
PARAMETERS = np.dtype([(name, layout(part)) for name, part in PARTS.items()], align=True)

array_at = late("sailviz.propagate.intrinsics", "array_at")  # (address or pointer, length) -> the float64 array there
record_at = late(
    "sailviz.propagate.intrinsics", "record_at"
)  # (address or pointer, structured type) -> the record there
