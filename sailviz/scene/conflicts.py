"""Checks between the sections of a scene: what fits its own table but not the others."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING

from sailviz.constants import RADIUS_EARTH
from sailviz.scene.start import HELD_STARTS
from sailviz.scene.steering import PRIMER_LAWS
from sailviz.words import nearest

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

LONGEST = 2**63 / 1e9  # s, what 64 bits of nanoseconds reach


def conflicts(scene: Scene) -> list[tuple[str, str]]:
    """(place, sentence) of everything that fits its own section but not the others."""
    found = []
    device, steering, start = scene.device, scene.steering, scene.start
    sail = device.kind in ("solar-sail", "electric-sail")
    law = steering.kind if steering else None
    duration = scene.propagation.duration
    if sail and scene.body != "sun":
        found.append(("device.kind", f"a {device.kind} needs the Sun as its central body"))
    if device.kind == "thruster" and law in (None, "sun-facing", "vertical", "as designed"):
        words = '"radial", "circumferential", "tangential", "inertial", "orbital", "meridian" or "table"'
        found.append(("steering.kind", f"a thruster needs a direction: {words}"))
    if sail and law in ("circumferential", "tangential", "vertical"):
        found.append(("steering.kind", f'"{law}" is a thruster\'s law; a sail is steered by pitch and clock angle'))
    if law in PRIMER_LAWS and not sail:
        found.append(("steering.kind", f'"{law}" steers a solar sail or an electric sail'))
    if law == "optimal" and len(scene.steering.costates) == 3 and getattr(start, "inclination", 0.0):
        found.append(("steering.costates", "three costates belong to a planar flight: a start without inclination"))
    designed = getattr(device, "characteristic_acceleration", None) == "as designed"
    if start.kind not in HELD_STARTS:
        needs = f'"as designed" needs a start.kind that is held: {", ".join(HELD_STARTS)}'
        if designed:
            found.append(("device.characteristic_acceleration", needs))
        if law == "as designed":
            found.append(("steering.kind", needs))
    elif not sail:
        found.append(("start.kind", f"{start.kind}: such an orbit is held by a solar sail or an electric sail"))
    elif device.kind == "electric-sail" and device.model != "final":
        found.append(("device.model", 'orbits are designed with the "final" model'))
    elif start.kind in ("planet-following", "flat-ellipse") and (not designed or law != "as designed"):
        found.append(("start.kind", f'{start.kind} needs characteristic_acceleration and steering "as designed"'))
    if scene.target is not None and scene.target.planet is not None and scene.body != "sun":
        found.append(("target.planet", "a planet's orbit goes round the Sun"))
    if scene.environment.third_body is not None and scene.body != "sun":
        found.append(("environment.third_body", "a third body goes round the Sun"))
    if start.kind == "spiral":
        if device.kind != "solar-sail":
            found.append(("start.kind", "a logarithmic spiral is flown by a solar sail"))
        elif law != "orbital":
            found.append(("steering.kind", 'a logarithmic spiral needs a fixed pitch: kind = "orbital"'))
        elif abs(abs(steering.clock) % 6.283185307179586 - 1.5707963267948966) > 1e-9:
            found.append(
                ("steering.clock", "a logarithmic spiral is planar: clock_deg = 90 (negative pitch goes inwards)")
            )
    if scene.ephemeris == "de421" and scene.epoch is not None:
        if not 1900 <= scene.epoch.year <= 2053 - duration / 3.15576e7:
            found.append(("ephemeris", "DE421 reaches from 1899 to 2053"))
        if find_spec("skyfield_data") is None or find_spec("jplephem") is None:
            found.append(("ephemeris", 'DE421 needs the extra "ephemeris": pip install "sailviz[ephemeris]"'))
    if law == "smoothed-transfer":
        if start.kind != "circular" or start.radius is None:
            found.append(("steering.kind", "a smoothed transfer begins on a circle: start.kind circular with radius"))
        if device.kind != "electric-sail" or device.model != "final":
            found.append(("steering.kind", 'a smoothed transfer is flown by an electric sail, model "final"'))
    found += _approximated(scene)
    found += _swarming(scene)
    if start.kind == "circular" and start.altitude is not None and _body_radius(scene) == 0:
        found.append(("start.altitude", "the body has no radius to measure an altitude from"))
    if scene.environment.solar_wind.kind != "steady" and device.kind != "electric-sail":
        found.append(("environment.solar_wind", "the solar wind acts on an electric sail only"))
    wind = scene.environment.solar_wind
    if duration / getattr(wind, "redraw", duration) > 1e7:
        found.append(("environment.solar_wind.redraw", "more than ten million draws in one run"))
    if scene.environment.irradiance.kind != "steady" and device.kind != "solar-sail":
        found.append(("environment.irradiance", "irradiance that varies acts on a solar sail only"))
    control = getattr(device, "control", None)
    if control is not None and control.kind == "electrochromic" and scene.environment.irradiance.kind == "steady":
        found.append(("device.control", "in steady sunlight there is nothing to control"))
    if duration / getattr(control, "interval", duration) > 1e7:
        found.append(("device.control.interval", "more than ten million updates in one run"))
    if scene.epoch is not None and not 1700 <= scene.epoch.year <= 2262 - duration / 3.15576e7:
        found.append(("epoch", "the run must lie between the years 1700 and 2262, what 64 bits of nanoseconds reach"))
    found += _around_the_earth(scene)
    if duration > LONGEST:
        words = (
            "a recording's clock reaches 292 years of nanoseconds; lifetimes beyond are sailviz.design.decay's business"
        )
        found.append(("propagation.duration", words))
    for i, window in enumerate(scene.propagation.dense):
        if window.end > duration:
            found.append((f"propagation.dense[{i}].end", "the window reaches beyond the run"))
    if sail and law in ("orbital", "meridian", "table"):
        angles = steering.pitch if isinstance(steering.pitch, list) else [steering.pitch]
        limited = device.kind == "electric-sail" and device.model in ("original", "updated")
        limit = device.pitch_limit if limited else 1.5707963267948968
        if max(map(abs, angles)) > limit * (1 + 1e-12):
            degrees = limit * 57.29577951308232
            found.append(("steering.pitch", f"beyond {degrees:.4g} deg the {device.kind}'s force model does not hold"))
    for i, watched in enumerate(scene.event):
        if watched.kind in ("altitude", "mean-altitude") and _body_radius(scene) == 0:
            found.append((f"event[{i}].altitude", "the body has no radius to measure an altitude from"))
    names = {w.name or w.kind for w in scene.event} | {"impact", "thrust on", "thrust off", "brake off"}
    for i, expected in enumerate(scene.expect):
        if expected.at not in (None, "start", "end", "min", "max", "mean", "drift") and expected.at not in names:
            words = ["start", "end", "min", "max", "mean", "drift", *sorted(names)]
            found.append((f"expect[{i}].at", f'no such moment "{expected.at}". {nearest(expected.at, words)}'))
        if expected.at_time is not None and not 0 <= expected.at_time <= duration:
            found.append((f"expect[{i}].at_time", "outside the run"))
    return found


MOST_UPDATES = 1e9  # changes of wind or voltage in all flights of an ensemble together: minutes of computing


def _swarming(scene: Scene) -> list[tuple[str, str]]:
    """What is wrong with the ensembles of a scene."""
    found, names = [], set()
    swarms = [(f"ensemble[{i}]", item) for i, item in enumerate(scene.ensemble)]
    swarms += [(f"chaos[{i}]", item) for i, item in enumerate(scene.chaos)]
    for place, item in swarms:
        word = "".join(letter if letter.isalnum() else "_" for letter in item.name.lower())
        if word in names:
            found.append((f"{place}.name", f'another ensemble is called "{item.name}" already'))
        names.add(word)
    if swarms:
        found += [(swarms[0][0], sentence) for sentence in _not_for_swarms(scene)]
    for place, item in swarms:
        found += [(f"{place}{where}", sentence) for where, sentence in _unlike_the_device(scene, item)]
    for i, item in enumerate(scene.ensemble):
        found += [(f"ensemble[{i}]{where}", sentence) for where, sentence in _undrawable(scene, item)]
    for i, item in enumerate(scene.chaos):
        wind = item.solar_wind or scene.environment.solar_wind
        if wind.kind != "gamma" or wind.variation != "constant":
            words = "polynomial chaos knows one gamma-distributed pressure for a whole flight"
            place = f"chaos[{i}].solar_wind" if item.solar_wind else "environment.solar_wind"
            found.append((place, f'{words}: kind = "gamma", variation = "constant"'))
    from sailviz.scene.quantities import MEANS, PLACES, spellings

    known = {item.name for _, item in swarms}
    for i, expected in enumerate(scene.expect):
        if expected.ensemble is None:
            continue
        if expected.ensemble not in known:
            words = f'no such ensemble "{expected.ensemble}". {nearest(expected.ensemble, known)}'
            found.append((f"expect[{i}].ensemble", words))
        elif expected.at != "end":
            found.append((f"expect[{i}].at", 'statistics of an ensemble are those of its ends: at = "end"'))
        stem = spellings()[expected.quantity].stem
        if stem not in PLACES and (stem not in MEANS or expected.statistic != "mean"):
            words = f"of an ensemble are known: {', '.join(PLACES)}; and the mean of {', '.join(MEANS)}"
            found.append((f"expect[{i}].quantity", words))
    return found


def _not_for_swarms(scene: Scene) -> list[str]:
    """What of a scene an ensemble cannot fly."""
    device, steering, start, found = scene.device, scene.steering, scene.start, []
    if device.kind not in ("solar-sail", "electric-sail") or scene.body != "sun":
        return ["an ensemble flies a solar sail or an electric sail round the Sun"]
    law = steering.kind if steering else "sun-facing"
    if law == "table" and steering.interpolation != "hold":
        found.append('an ensemble holds each row of a steering table: interpolation = "hold"')
    elif law == "as designed" and start.kind in ("planet-following", "flat-ellipse"):
        found.append(f"an ensemble cannot fly {start.kind}: its steering changes all the time")
    elif law in PRIMER_LAWS or law == "inertial":
        found.append(f'an ensemble cannot fly "{law}" steering, which depends on where each flight is')
    if scene.environment.third_body is not None:
        found.append("an ensemble knows no gravity but the Sun's")
    if device.kind == "electric-sail" and device.model == "original":
        found.append('an ensemble needs thrust that falls as 1/r: model "final", "updated" or "polynomial"')
    if device.active is not None:
        found.append("an ensemble's sail is on all the time: device.active is not for it")
    if any(event.stop for event in scene.event):
        found.append("an ensemble flies the whole duration: no event may stop the run")
    return found


def _unlike_the_device(scene: Scene, item) -> list[tuple[str, str]]:
    """What an ensemble asks of a craft that has it not."""
    found, control = [], item.control
    electric = scene.device.kind == "electric-sail"
    if not isinstance(control, str):
        if electric == (control.kind == "electrochromic"):
            has = "an electric sail controls its voltage" if electric else "a solar sail has electrochromic control"
            found.append((".control", has))
        elif electric and control.nominal_voltage <= scene.device.wind_potential:
            found.append((".control.nominal_voltage", "must exceed device.wind_potential, or there is no thrust"))
    if item.solar_wind is not None and not electric:
        found.append((".solar_wind", "the solar wind acts on an electric sail only"))
    return found


def _undrawable(scene: Scene, item) -> list[tuple[str, str]]:
    """What keeps an ensemble from drawing winds of its own."""
    found, around, duration = [], scene.environment, scene.propagation.duration
    if scene.device.kind == "solar-sail":
        if around.irradiance.kind == "steady":
            found.append((".name", "in steady sunlight all flights are the same: environment.irradiance"))
        step = getattr(around.irradiance, "redraw", duration)
    else:
        wind = item.solar_wind or around.solar_wind
        if wind.kind == "steady":
            found.append((".name", "in a steady wind all flights are the same: environment.solar_wind, or its own"))
        if getattr(wind, "potential", "fixed") != "fixed":
            found.append((".solar_wind", 'an ensemble replays pressures alone: potential = "fixed"'))
        if wind.kind == "replay" and item.seed is None and wind.seed is None:
            found.append((".seed", "where in the series each flight begins is drawn: give a seed"))
        step = 3600.0 if wind.kind == "replay" else getattr(wind, "redraw", duration)
    control = scene.device.control if item.control == "device" else item.control
    step = min(step, getattr(control, "interval", duration))
    if item.flights * duration / step > MOST_UPDATES:
        found.append(
            (".flights", "more than a thousand million changes of wind or voltage: fewer flights, longer steps")
        )
    return found


def _around_the_earth(scene: Scene) -> list[tuple[str, str]]:
    """What concerns the plasma, the air and the shadow of the Earth."""
    found = []
    device, around, start = scene.device, scene.environment, scene.start
    law = scene.steering.kind if scene.steering else None
    brake, table = device.kind == "plasma-brake", getattr(around.ionosphere, "kind", None) == "iri-2020"
    if scene.body != "earth":
        for name in ("j2", "j3", "j4", "atmosphere", "solar_flux"):
            if getattr(around, name):
                found.append((f"environment.{name}", f'{name} is known for body = "earth"'))
        if brake:
            found.append(("device.kind", 'a plasma brake works in the ionosphere: body = "earth"'))
    if (around.j3 or around.j4) and not around.j2:
        found.append(("environment.j2", "j3 and j4 are corrections to j2: turn it on"))
    if brake and around.ionosphere is None:
        found.append(("environment.ionosphere", "a plasma brake needs an ionosphere"))
    hangs = ("vertical", "gravity-gradient", "spinning")
    if brake and law not in (None, *hangs):
        words = '"vertical", "gravity-gradient" or "spinning"'
        found.append(("steering.kind", f"a plasma-brake tether hangs along the gravity gradient or spins: {words}"))
    if not brake and law in hangs[1:]:
        found.append(("steering.kind", f'"{law}" is for a plasma-brake tether'))
    if law == "gravity-gradient" and brake and device.tip_mass is None:
        found.append(("device.tip_mass", "how far the drag tilts the tether depends on the mass at its tip"))
    if law == "spinning" and brake and getattr(around.ionosphere, "kind", None) == "exponential-force":
        found.append(("environment.ionosphere", "a spinning tether needs a density, from which its mean force is made"))
    needs_density = [name for name in ("power", "eclipse_power") if getattr(device, name, None) is not None]
    needs_density += ["polarity"] if getattr(device, "polarity", "negative") == "positive" else []
    if getattr(around.ionosphere, "kind", None) == "exponential-force":
        for name in needs_density:
            found.append((f"device.{name}", "needs an ionosphere with a density, not a given force"))
    if around.atmosphere is not None and (device.drag_area is None or device.mass is None):
        found.append(("device.drag_area", "an atmosphere needs the area and the mass that it brakes"))
    if device.drag_area is not None and around.atmosphere is None:
        found.append(("environment.atmosphere", "drag_area without an atmosphere does nothing"))
    air_table = getattr(around.atmosphere, "kind", None) == "nrlmsis-2.1"
    if (table or air_table) and around.solar_flux is None:
        found.append(
            (
                "environment.solar_flux",
                'tables need the sun\'s level: solar_flux_sfu = 70 ... 193 or solar_flux = "cycle"',
            )
        )
    if isinstance(around.solar_flux, float):
        low, high = (70.0, 193.0) if table else (60.0, 300.0)
        if (table or air_table) and not low <= around.solar_flux <= high:
            words = "the ionosphere table reaches" if table else "the atmosphere model is meant"
            found.append(("environment.solar_flux", f"{words} from {low:g} to {high:g} sfu"))
    if around.solar_flux is not None and not (table or air_table):
        found.append(("environment.solar_flux", "nothing in this scene depends on it"))
    if around.solar_flux == "cycle" and scene.epoch is None:
        found.append(("epoch", "where the solar cycle stands needs a date"))
    if around.sun_right_ascension is not None and scene.epoch is not None:
        found.append(("environment.sun_right_ascension", "the epoch says where the Sun is"))
    if getattr(start, "mean_altitude", None) is not None and scene.body != "earth":
        found.append(("start.mean_altitude", 'is known for body = "earth"; elsewhere give altitude'))
    if getattr(start, "ltan", None) is not None and scene.body != "earth":
        found.append(("start.ltan", "local time is counted round the Earth"))
    low, high = _altitudes(scene)
    if brake and low is not None:
        room = low - device.off_below
        if device.tether_length >= room > 0:
            found.append(
                (
                    "device.tether_length",
                    f"longer than the {room / 1e3:.4g} km between the orbit and where the brake goes off",
                )
            )
        if table and high > 1500e3 and around.ionosphere.above_table == "refuse":
            words = f'the orbit reaches {high / 1e3:.5g} km, the table 1500: above_table = "hold" keeps its last value'
            found.append(("environment.ionosphere.above_table", words))
    return found


def _altitudes(scene: Scene) -> tuple[float | None, float | None]:
    """Lowest and highest altitude of the first revolution over the Earth's equatorial radius, m; None if unknown."""
    start = scene.start
    if scene.body != "earth" or start.kind not in ("circular", "elements"):
        return None, None
    if start.kind == "elements":
        a, e = start.semi_major_axis, start.eccentricity
        return a * (1 - e) - RADIUS_EARTH, (a * (1 + e) if e < 1 else float("inf")) - RADIUS_EARTH
    altitude = start.radius - RADIUS_EARTH if start.radius is not None else start.altitude or start.mean_altitude
    return altitude, altitude


def _approximated(scene: Scene) -> list[tuple[str, str]]:
    """What is wrong with the analytic solutions that a scene asks for."""
    found, names, beyond = [], set(), {"first-order": _beyond_first_order, "quasi-circular": _beyond_quasi_circular}
    for i, item in enumerate(scene.approximation):
        place, name = f"approximation[{i}]", getattr(item, "name", item.kind)
        if name in names:
            words = "two approximations have the same name"
            found.append(
                (f"{place}.name", words) if item.kind == "first-order" else (place, f"{item.kind} stands twice")
            )
        names.add(name)
        found += [(place, sentence) for sentence in beyond[item.kind](scene)]
    return found


def _beyond_quasi_circular(scene: Scene) -> list[str]:
    """What keeps a scene from the quasi-circular decay, which knows a mean force over the altitude and nothing else."""
    device, around, found = scene.device, scene.environment, []
    if scene.start.kind != "circular" or scene.body != "earth":
        found.append('the quasi-circular decay begins on a circular orbit: body = "earth", start.kind = "circular"')
    brake = device.kind == "plasma-brake"
    if not brake and around.atmosphere is None:
        found.append("the quasi-circular decay needs a plasma brake or the drag of an atmosphere")
    if device.kind not in ("plasma-brake", "none") or device.active is not None:
        found.append("the quasi-circular decay knows a plasma brake that is always on, and drag")
    if around.solar_flux == "cycle":
        found.append("the quasi-circular decay needs a constant solar flux")
    if not brake:
        return found
    law = scene.steering.kind if scene.steering else "vertical"
    if device.eclipse != "on" or device.power is not None or device.polarity == "positive":
        found.append("the quasi-circular decay knows a negative tether at full voltage")
    if law == "gravity-gradient" or around.magnetic_sensitivity > 0:
        found.append("the quasi-circular decay knows a vertical or spinning tether and no magnetic field")
    return found


def _beyond_first_order(scene: Scene) -> list[str]:
    """What keeps a scene from the first-order solution, which is planar and has one thrust law at fixed pitch."""
    device, steering, found = scene.device, scene.steering, []
    planar = scene.start.kind in ("circular", "elements") and scene.start.inclination == 0
    if not planar:
        found.append('the first-order solution is planar: start.kind "circular" or "elements" without inclination')
    law = steering.kind if steering else "sun-facing"
    sideways = law != "orbital" or abs(abs(steering.clock) % 3.141592653589793 - 1.5707963267948966) < 1e-9
    if law not in ("orbital", "sun-facing", "radial", "circumferential") or not sideways:
        found.append(
            "the first-order solution needs a fixed pitch in the orbit plane, or radial or circumferential thrust"
        )
    if device.active is not None or scene.environment.solar_wind.kind != "steady" or device.kind == "plasma-brake":
        found.append("the first-order solution needs thrust that is always on and never disturbed")
    if device.kind == "electric-sail" and device.model != "final":
        found.append('the first-order solution needs the electric sail\'s "final" model')
    if device.kind == "thruster" and (device.thrust is not None or device.specific_impulse is not None):
        found.append("the first-order solution is compared at constant acceleration, without loss of mass")
    return found


def _body_radius(scene: Scene) -> float:
    return 1.0 if isinstance(scene.body, str) else scene.body.radius
