"""What each drawn entity claims: one row for every pattern, with the number it shows, its frame, its factor and the
comparison. What is drawn and not in this table fails.

In a pattern * stands for one word of a path, and # for a number; they go to the comparison. S is the view's reach and
L the length 1 of the system view (1 au, a planet's radius, a power of ten of metres).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, partial

from . import (
    arrival,
    attitude_ensembles,
    axis,
    close_up,
    craft,
    earth,
    ensembles,
    heat,
    landmarks,
    lit,
    low,
    now,
    phases,
    plots,
    push,
    system,
    together,
)

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


def of_place(f, entity):
    """A frame that moves with the craft, or in a low orbit a dot where it is."""
    (craft.place_only if f.picture.moves(entity, "Transform3D:translation") else low.craft_dot)(f, entity)


def orbit_of(f, entity):
    """The orbit of the moment, of a low one in the colour of its altitude."""
    (low.orbit if "/world/tail" in f.picture.entities else system.osculating)(f, entity)


def place_beside(f, entity, word):
    """A frame or, in a low orbit, a dot where a flight beside the first is."""
    if f.picture.moves(entity, "Transform3D:translation"):
        craft.place_only(f.beside(word), entity)
    else:
        together.low_craft(f, entity, word)


SYSTEM = (
    Claim("/world", "ViewCoordinates", "right-handed, z up", INERTIAL, "1", system.right_handed),
    Claim("/world/stars", f"{POINT} {MOVE}", "nothing: a backdrop", INERTIAL, "far", system.backdrop),
    Claim("/world/sun", MOVE, "nothing: a size", INERTIAL, "1", craft.scale_only),
    Claim("/world/sun/ball", MESH, "the centre", INERTIAL, "0.036 S", system.sun_ball),
    Claim(
        "/world/sun/glow",
        SPLAT,
        "the centre",
        INERTIAL,
        "0.036 S",
        partial(system.in_centre, component="GaussianSplats3D:centers"),
    ),
    Claim("/world/center", POINT, "the centre", INERTIAL, "1", system.in_centre),
    Claim("/world/ecliptic", f"{MESH} {MOVE}", "z = 0", INERTIAL, "1.10 S", system.ecliptic),
    Claim("/world/sun_line", LINE, "/state position_m", INERTIAL, "1/L", system.sun_line),
    Claim("/world/height", LINE, "/state position_m", INERTIAL, "1/L", system.height_line),
    Claim("/world/trail/unknown", LINE, "/state position_m, gaps_s", INERTIAL, "1/L", system.unknown),
    Claim("/world/trail/recent", LINE, "/state position_m", INERTIAL, "1/L", system.trail),
    Claim("/world/trail/past", LINE, "/state position_m", INERTIAL, "1/L", system.trail),
    Claim("/world/trail/future", LINE, "/state position_m", INERTIAL, "1/L", system.trail),
    Claim("/world/orbit", f"{LINE} {MOVE}", "/state as an orbit", INERTIAL, "1/L", orbit_of),
    Claim("/world/ladder", LINE, "/state as orbits", INERTIAL, "1/L", system.ladder),
    Claim("/world/planets/*/orbit", LINE, "mean elements", INERTIAL, "1/L", system.planet_orbit),
    Claim("/world/night/magnetopause", LINE, "Shue 1998", INERTIAL, "1/L", earth.magnetopause),
    Claim("/world/names/magnetopause", POINT, "its nose", INERTIAL, "1.05/L", earth.magnetopause_name),
    Claim("/world/influence/*/globe", MESH, "the Moon's radius", "of the Moon", "1/L", landmarks.passed_globe),
    Claim("/world/influence/*/way", LINE, "/state position_m", "of the Moon", "1/L", landmarks.passed_way),
    Claim(
        "/world/influence/*", f"{LINE} {MOVE}", "Laplace's sphere about its body", INERTIAL, "1/L", landmarks.influence
    ),
    Claim("/world/names/influence/*", POINT, "its top", INERTIAL, "1.06/L", landmarks.influence_name),
    Claim("/world/planets/*/way", LINE, "where its body is", INERTIAL, "1/L", landmarks.moon_way),
    Claim("/world/planets/*/body", POINT, "mean elements, or a circle", INERTIAL, "1/L", landmarks.planet_body),
    Claim("/world/names/Sun", POINT, "the Sun's name", INERTIAL, "1", system.sun_name),
    Claim("/world/near/*", MOVE, "the planet's place", INERTIAL, "1/L", system.near_frame),
    Claim("/world/near/*/craft", POINT, "/state position_m", "of the planet", "1", system.near_craft),
    Claim("/world/near/*/way", LINE, "/state position_m", "of the planet", "1", system.near_way),
    Claim("/world/near/*/line", LINE, "/state position_m", "of the planet", "1", system.near_line),
    Claim("/world/near/*/body", POINT, "the planet's place", "of the planet", "1", system.near_body),
    Claim("/world/near/*/sunlight", ARROW, "the planet's place", "of the planet", "direction", system.near_sunlight),
    Claim("/world/near/*/push", ARROW, "/thrust", "of the planet", "half and half", system.near_push),
    Claim("/world/names/central", POINT, "/scene body", INERTIAL, "1", earth.central_name),
    Claim("/world/names/sunlight", POINT, "the Sun's direction", INERTIAL, "1.36 or 0.15 S", earth.sunlight_word),
    Claim("/world/names/push", POINT, "the arrow's tip", INERTIAL, "1", push.push_name),
    Claim("/world/names/craft", POINT, "/scene craft_kind", INERTIAL, "1", craft.ballistic_name),
    Claim("/world/names/star", POINT, "/scene body", INERTIAL, "1", landmarks.star_name),
    Claim("/world/names/*", POINT, "mean elements, or a circle", INERTIAL, "1/L", landmarks.planet_name),
    Claim("/world/names/orbits/*", POINT, "the ring's own line", INERTIAL, "1/L", landmarks.ring_name),
    Claim("/world/marks", POINT, "/state, /events", INERTIAL, "1/L", landmarks.marks),
    Claim("/world/marks/#", POINT, "/state, /events", INERTIAL, "1/L", landmarks.mark_name),
    Claim("/world/flybys", POINT, "/events", INERTIAL, "1/L", partial(landmarks.passages, word="flyby of ")),
    Claim("/world/flybys/#", POINT, "/events", INERTIAL, "1/L", partial(landmarks.passage_name, word="flyby of ")),
    Claim("/world/violations", POINT, "/events", INERTIAL, "1/L", partial(landmarks.passages, word="violation")),
    Claim("/world/violations/#", POINT, "/events", INERTIAL, "1/L", partial(landmarks.passage_name, word="violation")),
    Claim("/world/pan", MOVE, "the time", INERTIAL, "1", landmarks.pan),
    Claim("/world/fence/*", MESH, "/thrust acceleration_m_s2", INERTIAL, "one for all", push.standing),
    Claim("/world/fence/*/edge", LINE, "the wall's top", INERTIAL, "1", push.edge),
    Claim("/world/ghosts/*", f"{MESH} {LINE} InstancePoses3D", "/attitude quaternion", INERTIAL, "1/L", push.ghost),
    Claim("/world/references/*", LINE, "/scene, /state, /approximation", INERTIAL, "1/L", system.reference),
    Claim("/world/approximation/*/place", POINT, "/approximation", INERTIAL, "1/L", system.column_place),
    Claim("/world/approximation/*/name", POINT, "/approximation", INERTIAL, "1/L", system.column_place),
    Claim("/world/rtn", MOVE, "/state", INERTIAL, "1/L", craft.orbital_pose),
    Claim("/world/season", MOVE, "right ascension of the Sun", INERTIAL, "1", system.season),
    Claim("/world/craft", f"{MOVE} {POINT}", "/state position_m", INERTIAL, "1/L", of_place),
    Claim("/world/craft/name", POINT, "/scene craft_kind", INERTIAL, "1/L", low.craft_dot_name),
    Claim("/world/craft/body", MOVE, "/attitude quaternion", INERTIAL, "1", craft.body_pose),
    Claim("/world/craft/shares/*", ARROW, "/thrust/*", INERTIAL, "that of the push", push.share_arrow),
    Claim("/world/names/shares/*", POINT, "/thrust/*", INERTIAL, "the arrow's tip", push.share_name),
    Claim("/world/craft/push", ARROW, "/thrust acceleration_m_s2", INERTIAL, "half and half", push.push_arrow),
)

LOW = (
    Claim("/world/tail", LINE, "/state as an orbit", INERTIAL, "1.0004/L", low.tail),
    Claim("/world/rtn/body", MOVE, "/attitude quaternion", INERTIAL, "1", craft.body_pose),
    Claim("/world/rtn/drag", ARROW, "/thrust, air_drag_N", INERTIAL, "root, one for all", low.drag_arrows),
    Claim("/world/rtn/drag_name", POINT, "/thrust, /environment", INERTIAL, "in words", low.drag_word),
    Claim("/world/rtn/drag_sail", MOVE, "nothing: a size", INERTIAL, "1", lambda f, e: None),
    Claim("/world/rtn/drag_sail/*", MESH, "/state velocity_m_s", INERTIAL, "1", low.drag_sail),
    Claim("/world/rtn/flight", ARROW, "/state velocity_m_s", INERTIAL, "direction", low.flight),
    Claim("/world/rtn/flight/name", POINT, "/state velocity_m_s", INERTIAL, "in words", low.flight_name),
    Claim("/world/rtn/plumb", LINE, "/state position_m", INERTIAL, "1/L", low.plumb),
    Claim("/world/rtn/ground", POINT, "/state position_m", INERTIAL, "1/L, in words", low.ground),
)

EARTH = (
    Claim("/world/center/globe", MOVE, "sidereal time of Greenwich", INERTIAL, "1", earth.globe_turn),
    Claim("/world/center/globe/ball", "Asset3D", "geographic longitude, latitude", "of the Earth", "1/L", earth.globe),
    Claim("/world/center/air/shell#", MESH, "nothing: air", INERTIAL, "1/L", lambda f, e, number: earth.air(f, e)),
    Claim("/world/center/air/halo", f"{MESH} InstancePoses3D", "nothing: air", INERTIAL, "1/L", earth.halo),
    Claim("/world/night", MOVE, "the Sun's direction", INERTIAL, "1", earth.night_turn),
    Claim("/world/night/zone#", MESH, "the Sun's direction", INERTIAL, "1/L", lambda f, e, _: earth.night_zone(f, e)),
    Claim("/world/night/umbra", MESH, "the Sun's place and size", INERTIAL, "1/L", earth.umbra),
    Claim("/world/night/penumbra", MESH, "the Sun's place and size", INERTIAL, "1/L", earth.penumbra),
    Claim("/world/night/terminator", LINE, "the Sun's direction", INERTIAL, "1/L", earth.terminator),
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
        Claim(f"{shape}/film_lit", f"{MESH} {MOVE}", "/attitude normal, the Sun", BODY, "1", craft.film),
        Claim(f"{shape}/film_dark", f"{MESH} {MOVE}", "/attitude normal, the Sun", BODY, "1", craft.film),
        Claim(f"{shape}/booms", f"{MESH} {MOVE}", "/attitude normal", BODY, "1", craft.booms),
        Claim(f"{shape}/vanes", f"{MESH} {MOVE}", "/attitude normal", BODY, "1", craft.vanes),
        Claim(f"{shape}/seams", f"{LINE} {MOVE}", "/attitude normal", BODY, "1", craft.seams),
        Claim(f"{shape}/tethers", f"{LINE} {MOVE}", "/attitude normal", BODY, "1", craft.tethers),
        Claim(f"{shape}/rim", f"{LINE} {MOVE}", "/attitude normal", BODY, "1", craft.rim),
        Claim(f"{shape}/tips", f"{MESH} {MOVE} InstancePoses3D", "/attitude normal", BODY, "1", craft.at_tips),
        Claim(f"{shape}/disc", f"{MESH} {MOVE}", "/attitude normal", BODY, "1", craft.disc),
        Claim(f"{shape}/hub", MESH, "/attitude normal", BODY, "1", craft.hub),
        Claim(f"{shape}/sheath", f"{SPLAT} {MOVE}", "/thrust on", BODY, "1", craft.sheath),
        Claim(f"{shape}/bus", MESH, "/attitude normal", BODY, "1", bus),
        Claim(f"{shape}/facets", MESH, "/scene resolved, /attitude quaternion", BODY, "1", lit.facets),
        Claim(f"{shape}/panels", MESH, "/attitude quaternion", BODY, "1", craft.panels),
        Claim(f"{shape}/nozzle", MESH, "/attitude normal", BODY, "1", craft.nozzle),
        Claim(f"{shape}/plume", f"{SPLAT} {MOVE}", "/thrust on, acceleration_m_s2", BODY, "1", craft.plume),
        Claim(f"{shape}/dot", POINT, "/state position_m", BODY, "1", craft.dot),
        Claim(tether, MOVE, "nothing: a size", BODY, "told in the view's name", craft.scale_only),
        Claim(f"{tether}/line", LINE, "/attitude normal", BODY, "-1", craft.tether),
        Claim(f"{tether}/tip", POINT, "/attitude normal", BODY, "-1", craft.tether_end),
        Claim(f"{tether}/sheath", f"{SPLAT} {MOVE}", "/thrust on", BODY, "-1", craft.sheath),
    )
    near = top != "/world/craft"  # what presses on facets shows from close by
    rows = [row for row in rows if near or not row.pattern.endswith(("/seams", "/tips", "/facets"))]
    if top != "/world/rtn":
        return [row for row in rows if not row.pattern.startswith(tether)]
    # no electric sail flies so low
    other = ("/tethers", "/rim", "/tips", "/hub", "/disc", "/dot", "shape/sheath")
    return [row for row in rows if not row.pattern.endswith(other)]


def bus(f, entity):
    """A sail's bus is on the dark side; that of others is in the middle; one of one's own is where its mesh says."""
    if craft.has_own_shape(f):
        craft.own_part(f, entity)
        return
    (craft.shade_bus if f.truth.kind == "solar-sail" else craft.middle)(f, entity)


CLOSE_UP = (
    Claim("/sail", "ViewCoordinates", "right-handed, z up", NEAR, "1", system.right_handed),
    Claim("/sail/stars", POINT, "nothing: a backdrop", NEAR, "far", system.backdrop),
    Claim("/sail/body", MOVE, "/attitude quaternion", NEAR, "1", craft.body_pose),
    Claim("/sail/flow", ARROW, "/state position_m, /attitude normal", NEAR, "direction", close_up.flow),
    Claim("/sail/mirrored", ARROW, "/state position_m, /attitude normal", NEAR, "direction", close_up.mirrored),
    Claim("/sail/flow_name", POINT, "/scene craft_kind", NEAR, "1", close_up.flow_name),
    Claim("/sail/radial", LINE, "/state position_m", NEAR, "direction", close_up.radial),
    Claim("/sail/normal", ARROW, "/attitude normal", NEAR, "-1", close_up.sunward_normal),
    Claim("/sail/push", ARROW, "/thrust acceleration_m_s2", NEAR, "7.5 and a root", push.close_push),
    Claim("/sail/torque", ARROW, "light_torque_*_N_m", NEAR, "2.5 and a root", lit.torque_arrow),
    Claim("/sail/torque_name", POINT, "light_torque_*_N_m", NEAR, "in words", lit.torque_name),
    Claim("/sail/shares/*", ARROW, "/thrust/*", NEAR, "that of the push", push.share_arrow),
    Claim("/sail/shares/*/name", POINT, "/thrust/*", NEAR, "in words", push.share_name),
    Claim("/sail/push_name", POINT, "/thrust magnitude_m_s2", NEAR, "in words", close_up.push_word),
    Claim("/sail/velocity", ARROW, "/state velocity_m_s", NEAR, "direction", craft.velocity_arrow),
    Claim("/sail/primer", ARROW, "primer_direction", NEAR, "direction", craft.primer_arrow),
    *(
        Claim(
            f"/sail/{name}_name", POINT, "the arrow's tip", NEAR, "1", partial(close_up.beside, arrow=f"/sail/{name}")
        )
        for name in ("velocity", "primer")
    ),
    Claim("/sail/angle/arc", LINE, "/attitude pitch_rad", NEAR, "-1", close_up.angle_arc),
    Claim("/sail/angle/fan", MESH, "/attitude pitch_rad", NEAR, "-1", close_up.angle_fan),
    Claim("/sail/angle/name", POINT, "/attitude pitch_rad", NEAR, "in words", close_up.angle_word),
    Claim("/sail/clock/circle", LINE, "/attitude pitch_rad, normal", NEAR, "1", close_up.clock_circle),
    Claim("/sail/clock/spokes", LINE, "/attitude clock_rad, normal", NEAR, "1", close_up.clock_spokes),
    Claim("/sail/clock/arc", LINE, "/attitude clock_rad", NEAR, "1", close_up.clock_arc),
    Claim("/sail/clock/name", POINT, "/attitude clock_rad", NEAR, "in words", close_up.clock_word),
)

SPHERE = "inertial, of the rows themselves"
AXIS = (
    Claim("/axis", "ViewCoordinates", "right-handed, z up", SPHERE, "1", system.right_handed),
    Claim("/axis/globe", MESH, "nothing: a sphere", SPHERE, "0.985", axis.globe),
    Claim("/axis/grid", LINE, "parallels and meridians every 30 degrees", SPHERE, "1", axis.grid),
    Claim("/axis/pan", MOVE, "the light's direction", SPHERE, "1", axis.pan),
    Claim("/axis/body", MOVE, "/attitude quaternion", SPHERE, "1", craft.body_pose),
    *(row for row in of_craft("/axis") if row.pattern.endswith(("/shape", "/film_lit", "/film_dark", "/bus"))),
    Claim("/axis/trace/*", f"{LINE} {POINT}", "/attitude quaternion", SPHERE, "1", axis.trace),
    Claim("/axis/now", ARROW, "/attitude quaternion", SPHERE, "1", axis.now),
    Claim("/axis/light", ARROW, "/state position_m, the Sun", SPHERE, "1.22", axis.light),
    Claim("/axis/light_way", LINE, "/state position_m, the Sun", SPHERE, "1", axis.light_way),
    Claim("/axis/momentum", ARROW, "/attitude angular_momentum_N_m_s", SPHERE, "1.36", axis.momentum),
    *(
        Claim(f"/axis/{name}_name", POINT, "the arrow's tip", SPHERE, "0.13 beyond", partial(axis.name, arrow=name))
        for name in ("now", "light", "momentum")
    ),
)

HEAT = (
    Claim("/heat/axes", "LineStrips2D", "their own numbers", "-", "numbers", heat.axes),
    Claim("/heat/axes/names", "Points2D", "their own numbers", "-", "1", heat.names),
    Claim("/heat/axes/numbers", "Points2D", "their ticks", "-", "au, K", heat.numbers),
    Claim("/heat/way", "LineStrips2D", "/state position_m, /film temperature_K", "-", "au, K", heat.way),
    Claim("/heat/limit", "LineStrips2D", "/scene resolved", "-", "K", heat.limit),
    Claim("/heat/now", "Points2D", "/state position_m, /film", "-", "au, K", heat.now),
)

SWUNG = "Measurements Scalars SeriesLines"
NAMED = {
    "distance": ("/state, /elements", plots.distance),
    "altitude": ("/state, /elements, /environment", plots.altitude),
    "speed": ("/state velocity_m_s", plots.speed),
    "height": ("/state position_m", plots.height),
    "earth": ("/state, mean elements", plots.from_earth),
    "inclination": ("/elements inclination_rad", plots.element),
    "eccentricity": ("/elements eccentricity", plots.element),
    "angle": ("/attitude pitch_rad, cone_rad", plots.angles),
    "clock": ("/attitude clock_rad", plots.clock),
    "push": ("/thrust magnitude_m_s2", plots.thrust),
    "approximation": ("/approximation", plots.off_by),
    "film_temperature": ("/film temperature_K, /scene", plots.film_temperature),
    "dose": ("/film dose_yr", plots.dose),
}


def of_plot(f, entity, key, *_):
    """A band or its mean."""
    (NAMED[key][1] if key in NAMED else plots.acting)(f, entity, key)


def now_line(f, entity):
    """The line of the moment, of one flight or of several."""
    (together.line if len(f.all) > 1 else now.line)(f, entity)


def about(f, entity):
    """The words, of one flight or of several."""
    (together.about if len(f.all) > 1 else plots.about)(f, entity)


CURVES = (
    *(Claim(f"/plots/{key}", CURVE, truth, "-", "title's unit", check) for key, (truth, check) in NAMED.items()),
    Claim("/plots/*", CURVE, "/environment", "-", "title's unit", plots.acting),
    Claim("/plots/*/#/*", SWUNG, "as of its plot", "-", "title's unit", of_plot),
    *(
        Claim(f"/{lane}", "StateChange StateConfiguration", "/thrust on, /environment", "-", "in words", plots.lane)
        for lane in ("push", "light", "force_law_valid", "warm", "stowed", "in_solar_wind")
    ),
    Claim("/phase", "StateChange StateConfiguration", "/events, /scene", "-", "in words", phases.lane),
    Claim("/on/*", "StateChange StateConfiguration", "/thrust/* on", "-", "in words", lambda f, e, _: plots.lane(f, e)),
    Claim("/now", "TextDocument", "every column", "-", "in words", now_line),
    Claim("/log", "TextLog", "/events", "-", "in words", plots.log),
    Claim("/about", "TextDocument", "/scene", "-", "in words", about),
)

BAND = "Measurements"
ENSEMBLES = (
    Claim("/world/cloud/*/flights", LINE, "kept_position_m", INERTIAL, "1/L", ensembles.flights),
    Claim("/world/cloud/*/now", POINT, "kept_position_m", INERTIAL, "1/L", ensembles.flights_now),
    Claim("/world/cloud/*/ellipse", LINE, "mean_position_m, covariance_m2", INERTIAL, "1/L", ensembles.ellipses),
    Claim("/world/cloud_name", POINT, "mean_position_m", INERTIAL, "0.86/L", ensembles.widest_name),
    Claim("/world/nominal/path", LINE, "nominal_position_m", INERTIAL, "1.004/L", ensembles.nominal_path),
    Claim("/world/nominal/place", POINT, "nominal_position_m", INERTIAL, "1/L", ensembles.nominal_place),
    Claim("/world/nominal/name", POINT, "nominal_position_m", INERTIAL, "1/L", ensembles.nominal_name),
    Claim("/plots/ensemble/saturated/*", CURVE, "saturated", "-", "title's unit", ensembles.saturated),
    Claim("/plots/ensemble/*/limits/*", f"{CURVE} {BAND}", "facts", "-", "title's unit", ensembles.limit),
    Claim("/plots/ensemble/*/*/band#", BAND, "percentiles", "less nominal", "title's unit", ensembles.band),
    Claim("/plots/ensemble/*/*/median", CURVE, "percentiles", "less nominal", "title's unit", ensembles.median),
    Claim("/plots/ensemble/*/*/one", CURVE, "one_*", "-", "title's unit", ensembles.one_flight),
    Claim("/flights/*", "BarChart", "histogram", "from nominal", "100, 1000/au", ensembles.histogram),
    Claim("/axis/ensemble/*/now", POINT, "kept_axis", SPHERE, "1.004", attitude_ensembles.axes_now),
    Claim("/axis/ensemble/*/tail", LINE, "kept_axis", SPHERE, "1.004", attitude_ensembles.tails),
    Claim("/plots/attitude_ensemble/share/*/*", CURVE, "met_EVENT_s", "-", "title's unit", attitude_ensembles.share),
    Claim("/plots/attitude_ensemble/*/nominal", CURVE, "nominal_*", "-", "title's unit", attitude_ensembles.nominal),
    Claim("/plots/attitude_ensemble/*/*/band#", BAND, "percentiles", "-", "title's unit", attitude_ensembles.band),
    Claim("/plots/attitude_ensemble/*/*/median", CURVE, "percentiles", "-", "title's unit", attitude_ensembles.median),
    Claim("/arrival/*/axes", "LineStrips2D", "their own numbers", "less nominal", "numbers", arrival.axes),
    Claim("/arrival/*/axes/names", "Points2D", "their own numbers", "less nominal", "1", arrival.axis_names),
    Claim("/arrival/*/axes/numbers", "Points2D", "their ticks", "less nominal", "deg, 1000/au", arrival.axis_numbers),
    Claim("/arrival/*/axes/nominal", "Points2D", "0", "less nominal", "deg, 1000/au", arrival.nominal_dot),
    Claim("/arrival/*/*/flights", "Points2D", "kept_position_m", "less nominal", "deg, 1000/au", arrival.dots),
    Claim("/arrival/*/*/sigma#", "LineStrips2D", "covariance_m2", "less nominal", "deg, 1000/au", arrival.sigma),
)

BESIDE = "/world/flight/*"
TOGETHER = (
    Claim("/world/names/flight/*", POINT, "/scene flights, /state", INERTIAL, "1/L", together.name),
    Claim(f"{BESIDE}/trail/unknown", LINE, "/flight/*/state, gaps_s", INERTIAL, "1/L", together.beside(system.unknown)),
    Claim(f"{BESIDE}/trail/*", LINE, "/flight/*/state position_m", INERTIAL, "1/L", together.trail),
    Claim(f"{BESIDE}/craft", f"{MOVE} {POINT}", "/flight/*/state", INERTIAL, "1/L", place_beside),
    Claim(f"{BESIDE}/craft/body", MOVE, "/flight/*/attitude", INERTIAL, "1", together.beside(craft.body_pose)),
    Claim(f"{BESIDE}/craft/push", ARROW, "/flight/*/thrust", INERTIAL, "one for all", together.beside(push.push_arrow)),
    Claim(
        f"{BESIDE}/craft/shares/*", ARROW, "/flight/*/thrust/*", INERTIAL, "of push", together.beside(push.share_arrow)
    ),
    Claim(f"{BESIDE}/craft/name", POINT, "/flight/*/state", INERTIAL, "1.06/L", together.low_name),
    Claim(f"{BESIDE}/orbit", f"{LINE} {MOVE}", "/flight/*/state as an orbit", INERTIAL, "1/L", together.low_orbit),
    Claim("/world/plane/flight/*/orbit", f"{LINE} {MOVE}", "/flight/*/elements", "-", "1/L", together.plane_orbit),
    Claim("/world/plane/flight/*/now", POINT, "/flight/*/elements", "-", "1/L", together.plane_altitude),
    Claim("/plots/*/*", CURVE, "/flight/*, Hermite's cubic", "-", "title's unit", together.curve),
)
CRAFTS = (*of_craft("/world/craft"), *of_craft("/world/rtn"), *of_craft("/sail"))
BESIDES = tuple(
    replace(row, pattern=row.pattern.replace("/world/craft", f"{BESIDE}/craft"), check=together.beside(row.check))
    for row in of_craft("/world/craft")
    if not row.pattern.endswith(("/dot", "/plume", "/panels", "/nozzle", "/hub", "sheath"))
    and not row.pattern.endswith(("/tethers", "/rim", "/disc"))
)
TABLE = (*SYSTEM, *EARTH, *LOW, *CRAFTS, *CLOSE_UP, *AXIS, *HEAT, *ENSEMBLES, *TOGETHER, *BESIDES, *CURVES)
NUMBERS = ("/state", "/attitude", "/thrust", "/elements", "/environment", "/approximation", "/ensemble", "/events")
NUMBERS = (
    *NUMBERS,
    "/film",
    "/attitude_ensemble",
    "/phases",
    "/scene",
    "/flight",
    "/__properties",
    "/__checksums",
)  # what is not drawn: the truth itself


@cache
def claim_of(entity: str) -> Claim | None:
    """The first row of the table that fits an entity."""
    return next((claim for claim in TABLE if claim.words(entity) is not None), None)


def drawn(entities) -> list[str]:
    """Of a recording's entities those that are for the eye."""
    return [name for name in entities if not any(name == part or name.startswith(f"{part}/") for part in NUMBERS)]
