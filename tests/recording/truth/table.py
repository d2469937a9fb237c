"""What each drawn entity claims: one row for every pattern, with the number it shows, its frame, its factor and the
comparison. What is drawn and not in this table fails.

In a pattern * stands for one word of a path, and # for a number; they go to the comparison. S is the view's reach and
L the length 1 of the system view (1 au, a planet's radius, a power of ten of metres).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial

from . import arrival, close_up, craft, earth, ensembles, plots, system

INERTIAL = "inertial, carried along the orbit where a run is slowed"
NEAR = "orbital: radial, transverse, normal; of a tether transverse, normal, up"
BODY = "body: z the normal of /attitude"


@dataclass(frozen=True)
class Claim:
    """draws : archetypes that the entity may have."""

    pattern: str
    draws: str
    truth: str
    frame: str
    factor: str
    check: Callable

    def words(self, entity: str) -> tuple[str, ...] | None:
        """What stands for * and #, or None where an entity is not meant."""
        regex = re.escape(self.pattern).replace(r"\*", r"([^/]+)").replace(r"\#", r"(\d+)")
        found = re.fullmatch(regex, entity)
        return found.groups() if found else None


ARROW, LINE, POINT, MESH, MOVE = "Arrows3D", "LineStrips3D", "Points3D", "Mesh3D", "Transform3D"
SPLAT, CURVE = "GaussianSplats3D", "Scalars SeriesLines"

SYSTEM = (
    Claim("/world", "ViewCoordinates", "right-handed, z up", INERTIAL, "1", system.right_handed),
    Claim("/world/stars", f"{POINT} {MOVE}", "nothing: a backdrop", INERTIAL, "far", system.backdrop),
    Claim("/world/sun", MOVE, "nothing: a size", INERTIAL, "1", craft.scale_only),
    Claim("/world/sun/ball", MESH, "the centre", INERTIAL, "0.035 S", system.sun_ball),
    Claim(
        "/world/sun/glow",
        SPLAT,
        "the centre",
        INERTIAL,
        "0.035 S",
        partial(system.in_centre, component="GaussianSplats3D:centers"),
    ),
    Claim("/world/sun/name", POINT, "the Sun's name", INERTIAL, "1", system.sun_name),
    Claim("/world/center", POINT, "the centre", INERTIAL, "1", system.in_centre),
    Claim("/world/ecliptic", f"{MESH} {MOVE}", "z = 0", INERTIAL, "1.12 S", system.ecliptic),
    Claim("/world/sun_line", LINE, "/state position_m", INERTIAL, "1/L", system.sun_line),
    Claim("/world/height", LINE, "/state position_m", INERTIAL, "1/L", system.height_line),
    Claim("/world/trail/recent", LINE, "/state position_m", INERTIAL, "1/L", system.trail),
    Claim("/world/trail/past", LINE, "/state position_m", INERTIAL, "1/L", system.trail),
    Claim("/world/trail/future", LINE, "/state position_m", INERTIAL, "1/L", system.trail),
    Claim("/world/orbit", f"{LINE} {MOVE}", "/state as an orbit", INERTIAL, "1/L", system.osculating),
    Claim("/world/ladder", LINE, "/state as orbits", INERTIAL, "1/L", system.ladder),
    Claim("/world/planets/*/orbit", LINE, "mean elements", INERTIAL, "1/L", system.planet_orbit),
    Claim("/world/planets/*/body", POINT, "mean elements", INERTIAL, "1/L", system.planet_body),
    Claim("/world/names/*", POINT, "mean elements", INERTIAL, "1/L", system.planet_name),
    Claim("/world/references/*", LINE, "/scene, /state, /approximation", INERTIAL, "1/L", system.reference),
    Claim("/world/approximation/*/place", POINT, "/approximation", INERTIAL, "1/L", system.column_place),
    Claim("/world/approximation/*/name", POINT, "/approximation", INERTIAL, "1/L", system.column_place),
    Claim("/world/rtn", MOVE, "/state", INERTIAL, "1/L", craft.orbital_pose),
    Claim("/world/rtn/name", POINT, "/scene craft_kind", INERTIAL, "1/L", system.craft_name),
    Claim("/world/season", MOVE, "right ascension of the Sun", INERTIAL, "1", system.season),
    Claim("/world/craft", MOVE, "/state position_m", INERTIAL, "1/L", craft.place_only),
    Claim("/world/craft/name", POINT, "/scene craft_kind", INERTIAL, "1/L", system.craft_name),
    Claim("/world/craft/body", MOVE, "/attitude quaternion", INERTIAL, "1", craft.body_pose),
    *(
        Claim(f"/world/craft/{name}", MOVE, "nothing: a size", INERTIAL, "one for all", craft.scale_only)
        for name in ("thrust", "velocity", "primer")
    ),
    Claim("/world/craft/thrust/arrow", ARROW, "/thrust acceleration_m_s2", INERTIAL, "one for all", craft.thrust_arrow),
    Claim("/world/craft/velocity/arrow", ARROW, "/state velocity_m_s", INERTIAL, "direction", craft.velocity_arrow),
    Claim("/world/craft/primer/arrow", ARROW, "primer_direction", INERTIAL, "direction", craft.primer_arrow),
    Claim(
        "/world/craft/primer/name",
        POINT,
        "the arrow's tip",
        INERTIAL,
        "1.06",
        partial(craft.at_tip, arrow="/world/craft/primer/arrow"),
    ),
)

EARTH = (
    Claim("/world/center/globe", MOVE, "sidereal time of Greenwich", INERTIAL, "1", earth.globe_turn),
    Claim("/world/center/globe/ball", "Asset3D", "geographic longitude, latitude", "of the Earth", "1/L", earth.globe),
    Claim("/world/center/air/shell#", MESH, "nothing: air", INERTIAL, "1/L", lambda f, e, number: earth.air(f, e)),
    Claim("/world/night", MOVE, "the Sun's direction", INERTIAL, "1", earth.night_turn),
    Claim("/world/night/zone#", MESH, "the Sun's direction", INERTIAL, "1/L", lambda f, e, _: earth.night_zone(f, e)),
    Claim("/world/night/umbra", MESH, "the Sun's direction", INERTIAL, "1/L", earth.umbra),
    Claim("/world/night/sunlight", ARROW, "the Sun's direction", INERTIAL, "direction", earth.sunlight),
    Claim("/world/night/sunlight/name", POINT, "the Sun's direction", INERTIAL, "direction", earth.sunlight_name),
    Claim("/world/plane", MOVE, "/state as an orbit, the Sun", INERTIAL, "1", earth.plane_turn),
    Claim("/world/plane/orbit", f"{LINE} {MOVE}", "/state as an orbit", INERTIAL, "1/L", earth.plane_orbit),
    Claim("/world/plane/ladder", LINE, "/state as orbits", INERTIAL, "1/L", earth.plane_ladder),
    Claim("/world/plane/now", POINT, "/elements semi_major_axis_m", "of the orbit", "1/L", earth.altitude_now),
    Claim("/world/plane/rungs", POINT, "/elements semi_major_axis_m", "of the orbit", "1/L", earth.rungs),
    Claim("/world/plane/shells/*", MESH, "plasma_density_per_m3", INERTIAL, "log10", lambda f, e, _: earth.shell(f, e)),
)


def of_craft(top: str) -> list[Claim]:
    """The craft in either view; seams and tips are only seen from near."""
    shape, tether = f"{top}/body/shape", f"{top}/body/tether"
    rows = (
        Claim(shape, MOVE, "nothing: a size", BODY, "told in the view's name", craft.scale_only),
        Claim(f"{shape}/film_sun", MESH, "/attitude normal, the Sun", BODY, "1", craft.film),
        Claim(f"{shape}/film_dark", MESH, "/attitude normal, the Sun", BODY, "1", craft.film),
        Claim(f"{shape}/booms", MESH, "/attitude normal", BODY, "1", craft.booms),
        Claim(f"{shape}/vanes", MESH, "/attitude normal", BODY, "1", craft.vanes),
        Claim(f"{shape}/seams", LINE, "/attitude normal", BODY, "1", craft.seams),
        Claim(f"{shape}/tethers", LINE, "/attitude normal", BODY, "1", craft.tethers),
        Claim(f"{shape}/rim", LINE, "/attitude normal", BODY, "1", craft.rim),
        Claim(f"{shape}/tips", f"{MESH} InstancePoses3D", "/attitude normal", BODY, "1", craft.at_tips),
        Claim(f"{shape}/hub", MESH, "/attitude normal", BODY, "1", craft.hub),
        Claim(f"{shape}/sheath", f"{SPLAT} {MOVE}", "/thrust on", BODY, "1", craft.sheath),
        Claim(f"{shape}/bus", MESH, "/attitude normal", BODY, "1", bus),
        Claim(f"{shape}/panels", MESH, "/attitude quaternion", BODY, "1", craft.panels),
        Claim(f"{shape}/nozzle", MESH, "/attitude normal", BODY, "1", craft.nozzle),
        Claim(f"{shape}/plume", f"{SPLAT} {MOVE}", "/thrust on, acceleration_m_s2", BODY, "1", craft.plume),
        Claim(f"{shape}/dot", POINT, "/state position_m", BODY, "1", craft.dot),
        Claim(tether, MOVE, "nothing: a size", BODY, "told in the view's name", craft.scale_only),
        Claim(f"{tether}/line", LINE, "/attitude normal", BODY, "-1", craft.tether),
        Claim(f"{tether}/tip", POINT, "/attitude normal", BODY, "-1", craft.tether_end),
        Claim(f"{tether}/sheath", f"{SPLAT} {MOVE}", "/thrust on", BODY, "-1", craft.sheath),
    )
    return [row for row in rows if top == "/sail" or not row.pattern.endswith(("/seams", "/tips"))]


def bus(f, entity):
    """A sail's bus is on the dark side; that of others is in the middle."""
    (craft.shade_bus if f.truth.kind == "solar-sail" else craft.middle)(f, entity)


CLOSE_UP = (
    Claim("/sail", "ViewCoordinates", "right-handed, z up", NEAR, "1", system.right_handed),
    Claim("/sail/stars", POINT, "nothing: a backdrop", NEAR, "far", system.backdrop),
    Claim("/sail/body", MOVE, "/attitude quaternion", NEAR, "1", craft.body_pose),
    Claim("/sail/flow", ARROW, "/state position_m", NEAR, "direction", close_up.flow),
    Claim("/sail/flow/name", POINT, "/scene craft_kind", NEAR, "1", close_up.flow_name),
    Claim("/sail/radial", LINE, "/state position_m", NEAR, "direction", close_up.radial),
    Claim("/sail/normal", ARROW, "/attitude normal", NEAR, "direction", craft.normal_arrow),
    Claim("/sail/velocity", ARROW, "/state velocity_m_s", NEAR, "direction", craft.velocity_arrow),
    Claim("/sail/primer", ARROW, "primer_direction", NEAR, "direction", craft.primer_arrow),
    *(
        Claim(f"/sail/{name}/name", POINT, "the arrow's tip", NEAR, "1", partial(craft.at_tip, arrow=f"/sail/{name}"))
        for name in ("normal", "velocity", "primer")
    ),
    Claim("/sail/force", MOVE, "nothing: a size", NEAR, "one for all", craft.scale_only),
    Claim("/sail/force/arrow", ARROW, "/thrust acceleration_m_s2", NEAR, "root, one for all", craft.thrust_arrow),
    Claim("/sail/force_name", POINT, "/thrust, plasma_force_N_m", NEAR, "in words", close_up.force_word),
    Claim("/sail/pitch/arc", LINE, "/attitude pitch_rad", NEAR, "1", close_up.pitch_arc),
    Claim("/sail/pitch/fan", MESH, "/attitude pitch_rad", NEAR, "1", close_up.pitch_fan),
    Claim("/sail/pitch/name", POINT, "/attitude pitch_rad", NEAR, "deg", partial(close_up.angle_word, name="pitch")),
    Claim("/sail/cone", LINE, "/attitude cone_rad", NEAR, "1", close_up.cone_arc),
    Claim("/sail/clock/circle", LINE, "/attitude normal", NEAR, "1", close_up.clock_circle),
    Claim("/sail/clock/spokes", LINE, "/attitude clock_rad, normal", NEAR, "1", close_up.clock_spokes),
    Claim("/sail/clock/arc", LINE, "/attitude clock_rad, normal", NEAR, "1", close_up.clock_arc),
    Claim("/sail/clock/name", POINT, "/attitude clock_rad", NEAR, "deg", partial(close_up.angle_word, name="clock")),
)

TETHER = (
    Claim("/sail/vertical", LINE, "/state position_m", NEAR, "-1", earth.upright),
    Claim("/sail/body/force", MOVE, "nothing: a size", NEAR, "one for all", lambda f, e: None),
    Claim(
        "/sail/body/force/arrows", f"{ARROW} {MOVE}", "/thrust across the tether", NEAR, "root", close_up.drag_arrows
    ),
    Claim("/sail/body/tip_name", POINT, "tether length, /attitude normal", NEAR, "m, deg", close_up.tip_word),
    Claim("/sail/tether_name", POINT, "tether voltage, current, power", NEAR, "V, mA, W", close_up.tether_word),
    Claim("/sail/motion", MOVE, "/state velocity_m_s", NEAR, "direction", close_up.motion_turn),
    Claim("/sail/motion/velocity", ARROW, "/state velocity_m_s", NEAR, "direction", close_up.flight_arrow),
    Claim("/sail/motion/flow", ARROW, "/state velocity_m_s", NEAR, "-1", close_up.ram_flow),
    Claim(
        "/sail/motion/velocity_name",
        POINT,
        "/state velocity_m_s",
        NEAR,
        "1",
        partial(close_up.ahead_name, words="velocity"),
    ),
    Claim(
        "/sail/motion/flow_name",
        POINT,
        "/state velocity_m_s",
        NEAR,
        "1",
        partial(close_up.ahead_name, words="ion ram flow"),
    ),
    Claim("/sail/planet", MOVE, "/state position_m", NEAR, "-1", earth.below),
    Claim("/sail/planet/shape", MOVE, "nothing: a size", NEAR, "1", craft.scale_only),
    Claim("/sail/planet/shape/air/shell#", MESH, "nothing: air", NEAR, "1", lambda f, e, number: earth.air(f, e)),
    Claim("/sail/planet/shape/globe", MOVE, "sub-satellite point", NEAR, "1", lambda f, e: None),
    Claim("/sail/planet/shape/globe/ball", "Asset3D", "sub-satellite point, sunlit", NEAR, "1", earth.globe),
    Claim("/sail/sun", MOVE, "the Sun's direction", NEAR, "1", earth.light_turn),
    Claim("/sail/sun/light", f"{ARROW} {MOVE}", "the Sun's direction, sunlit", NEAR, "-1", earth.light_arrow),
    Claim("/sail/sun/name", POINT, "the Sun's direction, sunlit", NEAR, "1", earth.light_name),
)

CURVES = (
    Claim("/plots/distance", CURVE, "/state, /elements", "-", "title's unit", plots.distance),
    Claim("/plots/altitude", CURVE, "/state, /elements, /environment", "-", "title's unit", plots.altitude),
    Claim("/plots/inclination", CURVE, "/elements inclination_rad", "-", "title's unit", plots.element),
    Claim("/plots/eccentricity", CURVE, "/elements eccentricity", "-", "title's unit", plots.element),
    Claim("/plots/angles", CURVE, "/attitude pitch_rad, cone_rad", "-", "title's unit", plots.angles),
    Claim("/plots/clock", CURVE, "/attitude clock_rad", "-", "title's unit", plots.clock),
    Claim("/plots/thrust", CURVE, "/thrust magnitude_m_s2", "-", "title's unit", plots.thrust),
    Claim("/plots/approximation", CURVE, "/approximation", "-", "title's unit", plots.off_by),
    Claim("/plots/*", CURVE, "/environment", "-", "title's unit", plots.acting),
    Claim("/phase/*", "StateChange StateConfiguration", "/thrust on, /environment", "-", "in words", plots.lane),
    Claim("/log", "TextLog", "/events", "-", "in words", plots.log),
    Claim("/about", "TextDocument", "/scene", "-", "in words", plots.about),
)

BAND = "Measurements"
ENSEMBLES = (
    Claim("/world/cloud/*/flights", LINE, "kept_position_m", INERTIAL, "1/L", ensembles.flights),
    Claim("/world/cloud/*/now", POINT, "kept_position_m", INERTIAL, "1/L", ensembles.flights_now),
    Claim("/world/cloud/*/ellipse", LINE, "mean_position_m, covariance_m2", INERTIAL, "1/L", ensembles.ellipses),
    Claim("/world/cloud/*/tube/band#", MESH, "radius_m, azimuth_rad", INERTIAL, "1/L", ensembles.tube_band),
    *(
        Claim(
            f"/world/cloud/*/tube/{kind}",
            LINE,
            "radius_m, azimuth_rad",
            INERTIAL,
            "1/L",
            partial(ensembles.tube_lines, kind=kind),
        )
        for kind in ("median", "edges")
    ),
    Claim("/world/nominal/path", LINE, "nominal_position_m", INERTIAL, "1.004/L", ensembles.nominal_path),
    Claim("/world/nominal/place", POINT, "nominal_position_m", INERTIAL, "1/L", ensembles.nominal_place),
    Claim("/world/nominal/name", POINT, "nominal_position_m", INERTIAL, "1/L", ensembles.nominal_name),
    Claim("/plots/ensemble/saturated/*", CURVE, "saturated", "-", "title's unit", ensembles.saturated),
    Claim("/plots/ensemble/*/limits/*", f"{CURVE} {BAND}", "facts", "-", "title's unit", ensembles.limit),
    Claim("/plots/ensemble/*/*/band#", BAND, "percentiles", "less nominal", "title's unit", ensembles.band),
    Claim("/plots/ensemble/*/*/median", CURVE, "percentiles", "less nominal", "title's unit", ensembles.median),
    Claim("/plots/ensemble/*/*/one", CURVE, "one_*", "-", "title's unit", ensembles.one_flight),
    Claim("/histogram/*", "BarChart", "histogram", "from nominal", "100, 1000/au", ensembles.histogram),
    Claim("/arrival/*/axes", "LineStrips2D", "their own numbers", "less nominal", "numbers", arrival.axes),
    Claim("/arrival/*/axes/names", "Points2D", "their own numbers", "less nominal", "1", arrival.axis_names),
    Claim("/arrival/*/axes/numbers", "Points2D", "their ticks", "less nominal", "deg, 1000/au", arrival.axis_numbers),
    Claim("/arrival/*/axes/nominal", "Points2D", "0", "less nominal", "deg, 1000/au", arrival.nominal_dot),
    Claim("/arrival/*/*/flights", "Points2D", "kept_position_m", "less nominal", "deg, 1000/au", arrival.dots),
    Claim("/arrival/*/*/sigma#", "LineStrips2D", "covariance_m2", "less nominal", "deg, 1000/au", arrival.sigma),
)

TABLE = (*SYSTEM, *EARTH, *of_craft("/world/craft"), *of_craft("/sail"), *CLOSE_UP, *TETHER, *CURVES, *ENSEMBLES)
NUMBERS = ("/state", "/attitude", "/thrust", "/elements", "/environment", "/approximation", "/ensemble", "/events")
NUMBERS = (*NUMBERS, "/scene", "/__properties", "/__checksums")  # what is not drawn: the truth itself


@cache
def claim_of(entity: str) -> Claim | None:
    """The first row of the table that fits an entity."""
    return next((claim for claim in TABLE if claim.words(entity) is not None), None)


def drawn(entities) -> list[str]:
    """Of a recording's entities those that are for the eye."""
    return [name for name in entities if not any(name == part or name.startswith(f"{part}/") for part in NUMBERS)]
