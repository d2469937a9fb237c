"""The list of figures; no imports, so that it can be printed at once."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Entry:
    """title : one line. note : what the reader must know of its origin. size : inches. panels : (rows, columns).
    module, function : where a function (*axes) draws it, inside sailviz.figures. takes : keywords of
    that function that a caller may give."""

    title: str
    note: str
    size: tuple[float, float]
    panels: tuple[int, int]
    module: str
    function: str
    takes: tuple[str, ...] = ()


REDRAWN = "Redrawn from our functions after the thesis' text"
OURS = "Ours, not in the thesis"

CATALOGUE = {
    "thesis-3.4": Entry(
        "Electric sail: cone angle and dimensionless acceleration over the pitch angle",
        f"{REDRAWN}, (3.43)-(3.45); dotted: the polynomial fit of table 3.2",
        (11, 5),
        (1, 2),
        "sails",
        "cone_and_acceleration",
    ),
    "thesis-3.5": Entry(
        "What each sail can push outwards and sideways",
        f"{REDRAWN}, (3.8), (3.21), (3.47)-(3.48); dots every 15° of pitch",
        (7.5, 7.2),
        (1, 1),
        "sails",
        "thrust_loci",
    ),
    "ageing": Entry(
        "A film that ages: its push over the pitch angle, and how warm it gets",
        f"{OURS}; JPL-2015, factor 0.2, half dose half a year: assumed, not measured",
        (12, 5.6),
        (1, 2),
        "sails",
        "ageing_and_heat",
    ),
    "thesis-4.2": Entry(
        "Displaced orbits that keep the Earth's angular rate: cone angle and characteristic acceleration",
        "Ours: the thesis does not state the angular rate of its figure 4.2; electric sail, after (4.4)-(4.5)",
        (12, 5.8),
        (1, 2),
        "orbits",
        "requirements",
    ),
    "thesis-4.3": Entry(
        "Electric sail on a Type II displaced orbit: characteristic acceleration",
        f"{REDRAWN}, (4.5) and (4.7)",
        (8, 6),
        (1, 1),
        "orbits",
        "type_ii",
    ),
    "thesis-4.4": Entry(
        "Type II displaced orbits: recent thrust model against the original one",
        f"{REDRAWN}, (3.33) and (3.39); solid: recent, dashed: original",
        (8, 6),
        (1, 1),
        "orbits",
        "type_ii_models",
    ),
    "stability": Entry(
        "Which circular displaced orbits of an electric sail stay by themselves",
        f"{OURS}: linear analysis; growth of a disturbance in one revolution, stable orbits in green",
        (12, 5.8),
        (1, 2),
        "orbits",
        "stability_map",
    ),
    "validity": Entry(
        "How far the first-order solution carries: largest error in radius, no rectification, circular start",
        f"{OURS}; white line: 3 %, where a solution calls itself doubtful; grey: no orbit, or out of the map",
        (13, 5.2),
        (1, 3),
        "analytic",
        "validity_map",
    ),
    "rectification": Entry(
        "What freezing the ellipse anew buys: error after five revolutions over the length of a leg",
        f"{OURS}; ideal sail, electric sail and constant thrust, circular start",
        (13, 5.2),
        (1, 3),
        "analytic",
        "rectification",
    ),
    "spirals": Entry(
        "Logarithmic spirals of solar sails: flight-path angle, and the sail that enters one from an ellipse",
        f"{OURS}, after the equations of motion; ideal film, with the limits of real ones",
        (12, 5.8),
        (1, 2),
        "analytic",
        "spiral_maps",
    ),
    "escape": Entry(
        "Escape under constant thrust: the thesis' estimates and the motion itself",
        f"{REDRAWN}, (2.15), (2.21)-(2.22), (2.26)-(2.27); dots: integrated",
        (12, 5.4),
        (1, 2),
        "analytic",
        "escape",
    ),
    "billow": Entry(
        "What billow costs: force of a flat film and of billowed ones over the incidence of the light",
        f"{OURS}; film jpl-2015, the same area across; each curve as far as the light meets the front alone",
        (12, 5.4),
        (1, 2),
        "shapes",
        "incidence",
    ),
    "torque": Entry(
        "What turns a sail: torques that four vanes and four switched patches give together",
        f"{OURS}; 1 m² each, 10 and 9.6 m from the middle, at 1 au, vanes to ±85°, film jpl-2015; outline: the most in "
        "every direction; light tilted towards x; patches about half on",
        (15, 5.2),
        (1, 3),
        "actuators",
        "attainable",
    ),
    "spin": Entry(
        "An electric sail winds itself up: the spin of its wheel, and the voltage that holds its axis",
        f"{OURS}; effect after Toivanen and Janhunen; circle at 1 au, pitch held; right: 20 tethers of 15 km, coned by "
        "3°, first turn in 30 min, masses invented",
        (12, 5.6),
        (1, 2),
        "actuators",
        "coriolis",
    ),
    "drag-profile": Entry(
        "Plasma brake: drag per length of tether over altitude, and the shapes that stand for it",
        f"{OURS}; force law reconstructed after Janhunen (2014), ionosphere of IRI-2020; topside models differ by more "
        "than the band near solar maximum",
        (12, 5.8),
        (1, 2),
        "deorbit",
        "drag_profile",
    ),
    "deorbit": Entry(
        "Bringing 260 kg down: a plasma brake of 5 km against chemical and electric thrusters",
        f"{OURS}; brake at −1 kV, bands: plasma density × 0.5 to × 2; 1 to 2 kg of brake hardware is an assumption; "
        "perigee lowered to 60 km, spiral and brake to 300 km",
        (12.5, 6.2),
        (1, 2),
        "deorbit",
        "deorbit",
    ),
    "lifetime": Entry(
        "How long 100 kg with a plasma brake stay up, over tether length and altitude",
        f"{OURS}; −1 kV, drag on Cd A = 2.2 m², to 120 km, constant solar level; white: rules of 5 and 25 years",
        (13, 5.4),
        (1, 3),
        "deorbit",
        "lifetime",
    ),
    "wind-fit": Entry(
        "Solar-wind dynamic pressure: how likely, how rare, how long remembered",
        f"{OURS}; five years drawn from the lognormal law fitted to OMNI2 1998-2018, forgetting in 17 h (seed 2018): "
        "not a measured series; grey: the sample",
        (15, 5.2),
        (1, 3),
        "wind",
        "wind_fit",
        ("series",),
    ),
    "gpc-convergence": Entry(
        "Polynomial chaos: what a handful of flights tells of a constant but unknown solar-wind pressure",
        f"{OURS}; electric sail from a circle at 1 au, gamma law k = 2.6, θ = 0.77 nPa; a pressure that changes on the "
        "way spreads a flight about a quarter as much",
        (13, 5.8),
        (1, 2),
        "wind",
        "gpc_convergence",
    ),
    "arrival-dispersion": Entry(
        "Where an electric sail ends that flew to Mars through a wind redrawn every day",
        f"{OURS}; smoothed minimum-time steering, 522 d, a_c 1 mm/s², gamma law k = 2.593, θ = 0.7793 nPa, nominal at "
        "its mean: E√p < √Ep, so all fall short",
        (13, 5.8),
        (1, 2),
        "wind",
        "arrival_dispersion",
    ),
    "flight-time": Entry(
        "How fast a sail gets there: minimum-time transfers from the Earth's orbit",
        f"{OURS}; between circles in one plane, best found without a guess; gaps: none was found",
        (15, 4.8),
        (1, 4),
        "transfers",
        "flight_time",
    ),
    "steering-laws": Entry(
        "Steering for the most thrust along a wanted direction, and what simpler laws lose",
        f"{OURS}; exact laws re-derived; up to where the film goes edge-on",
        (14, 5.2),
        (1, 3),
        "transfers",
        "steering_laws",
    ),
    "films": Entry(
        "Films and electric-sail models compared: minimum-time transfers at 1 mm/s²",
        f"{OURS}; from the Earth's orbit, between circles, best found; cone angles: updated and original model to 30°, "
        "the other two to 19.5° and 19.8°",
        (13, 4.6),
        (1, 3),
        "transfers",
        "films",
    ),
    "throttle": Entry(
        "To Jupiter at partial voltage: an electric sail of 1 mm/s² between full thrust and coast",
        f"{OURS}; scene transfers/earth-jupiter-electric-sail, fastest flight found; dotted: the two orbits",
        (13, 5.4),
        (1, 2),
        "transfers",
        "throttle",
    ),
    "photonic-assist": Entry(
        "Past the Sun and out to 30 au: how light the sail, how near the Sun, how long the flight",
        f"{OURS}; ideal sail from 1 au, in one plane; lightness: thrust over the Sun's pull; best found; "
        "*: turns outside the limit by itself",
        (13, 5.4),
        (1, 2),
        "transfers",
        "photonic_assist",
    ),
    "launch-window": Entry(
        "When to leave for a rendezvous: ideal sail of 1 mm/s², planets and asteroids where they are",
        f"{OURS}; mean elements, of asteroids JPL's; planets' pull left out; upper bounds; dotted: edge-on until later",
        (12, 9.6),
        (2, 2),
        "transfers",
        "launch_window",
    ),
    "speed": Entry(
        "What an error costs: sailviz and heyoka over their tolerances",
        f"{OURS}; the least of interleaved CPU times on the machine named; points that others beat are dim; "
        "tests/bench measures anew",
        (14, 5.0),
        (1, 3),
        "speed",
        "speed",
    ),
}
