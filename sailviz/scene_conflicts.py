"""Checks between the sections of a scene: what fits its own table but not the others."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING

from sailviz.scene_faults import nearest
from sailviz.scene_sections import HELD_STARTS

if TYPE_CHECKING:
    from sailviz.scene import Scene


def conflicts(scene: Scene) -> list[tuple[str, str]]:
    """(place, sentence) of everything that fits its own section but not the others."""
    found = []
    device, steering, start = scene.device, scene.steering, scene.start
    sail = device.kind in ("solar-sail", "electric-sail")
    law = steering.kind if steering else None
    duration = scene.propagation.duration
    if sail and scene.body != "sun":
        found.append(("device.kind", f"a {device.kind} needs the Sun as its central body"))
    if device.kind == "plasma-brake":
        if scene.body != "earth":
            found.append(("device.kind", 'a plasma brake works in the ionosphere: body = "earth"'))
        if scene.environment.ionosphere is None:
            found.append(("environment.ionosphere", "a plasma brake needs an ionosphere"))
        if law not in (None, "vertical"):
            found.append(("steering.kind", 'a plasma-brake tether hangs along the gravity gradient: "vertical"'))
    if device.kind == "thruster" and law in (None, "sun-facing", "vertical", "as designed"):
        words = '"radial", "circumferential", "tangential", "inertial", "orbital", "meridian" or "table"'
        found.append(("steering.kind", f"a thruster needs a direction: {words}"))
    if sail and law in ("circumferential", "tangential", "vertical"):
        found.append(("steering.kind", f'"{law}" is a thruster\'s law; a sail is steered by pitch and clock angle'))
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
    if scene.approximation:
        found += [("approximation[0]", sentence) for sentence in _beyond_first_order(scene)]
        if len({item.name for item in scene.approximation}) < len(scene.approximation):
            found.append(("approximation[1].name", "two approximations have the same name"))
    if start.kind == "circular" and start.altitude is not None and _body_radius(scene) == 0:
        found.append(("start.altitude", "the body has no radius to measure an altitude from"))
    if scene.environment.solar_wind.kind != "steady" and device.kind != "electric-sail":
        found.append(("environment.solar_wind", "the solar wind acts on an electric sail only"))
    if scene.environment.solar_wind.kind == "gamma" and duration / scene.environment.solar_wind.redraw > 1e7:
        found.append(("environment.solar_wind.redraw", "more than ten million draws in one run"))
    if scene.epoch is not None and not 1700 <= scene.epoch.year <= 2262 - duration / 3.15576e7:
        found.append(("epoch", "the run must lie between the years 1700 and 2262, what 64 bits of nanoseconds reach"))
    if scene.environment.j2 and scene.body != "earth":
        found.append(("environment.j2", 'j2 is known for body = "earth"'))
    if sail and law in ("orbital", "meridian", "table"):
        angles = steering.pitch if isinstance(steering.pitch, list) else [steering.pitch]
        limited = device.kind == "electric-sail" and device.model in ("original", "updated")
        limit = device.pitch_limit if limited else 1.5707963267948968
        if max(map(abs, angles)) > limit * (1 + 1e-12):
            degrees = limit * 57.29577951308232
            found.append(("steering.pitch", f"beyond {degrees:.4g} deg the {device.kind}'s force model does not hold"))
    for i, watched in enumerate(scene.event):
        if watched.kind == "altitude" and _body_radius(scene) == 0:
            found.append((f"event[{i}].altitude", "the body has no radius to measure an altitude from"))
    names = {w.name or w.kind for w in scene.event} | {"impact", "thrust on", "thrust off", "brake off"}
    for i, expected in enumerate(scene.expect):
        if expected.at not in (None, "start", "end", "min", "max", "mean", "drift") and expected.at not in names:
            words = ["start", "end", "min", "max", "mean", "drift", *sorted(names)]
            found.append((f"expect[{i}].at", f'no such moment "{expected.at}". {nearest(expected.at, words)}'))
        if expected.at_time is not None and not 0 <= expected.at_time <= duration:
            found.append((f"expect[{i}].at_time", "outside the run"))
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
