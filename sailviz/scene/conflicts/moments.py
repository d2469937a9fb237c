"""Whether duration, dates, windows, events and expectations of a scene lie where a run can meet them."""

from __future__ import annotations

from collections.abc import Callable
from datetime import timedelta
from importlib.util import find_spec
from typing import TYPE_CHECKING

from sailviz.calendar import LONGEST, OUT_OF_REACH, DateError, in_reach
from sailviz.constants import YEAR
from sailviz.scene.attitude import Moving
from sailviz.scene.conflicts import turning_ensembles
from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.conflicts.attitude import BELONGS, OF_BODY
from sailviz.scene.conflicts.craft import has_surface
from sailviz.scene.conflicts.ensembles import placed_ensembles
from sailviz.scene.conflicts.records import device_of, ionosphere_of
from sailviz.scene.device import NoDevice
from sailviz.scene.phases import end_of
from sailviz.scene.quantities import MEANS, OF_EACH_DEVICE, PLACES, spellings
from sailviz.scene.sections import STATISTICS_OF_ROWS
from sailviz.scene.sky import has_sky, kernel_bodies, light_away, shades
from sailviz.words import nearest, shown

if TYPE_CHECKING:
    from sailviz.scene.events import Crossing
    from sailviz.scene.loading import Scene

COME_WITH_DEVICES = {
    "impact",
    "thrust on",
    "thrust off",
    "brake off",
    "wind on",
    "wind off",
    "too-hot",
    "tethers-saturated",
}  # events that nobody asks for
OVER_THE_SURFACE = ("altitude", "perigee_altitude", "apogee_altitude", "mean_altitude")
OF_A_DEVICE = ("pitch", "cone", "clock", "thrust_acceleration", "thrust_factor")
OF_A_BRAKE = ("plasma_force", "plasma_density", "tether_current", "tether_voltage", "tether_power", "tether_tilt")
OF_A_DENSITY = ("plasma_density", "tether_current", "tether_voltage", "tether_power")


def ephemeris(scene: Scene) -> Faults:
    """DE421 is there, and reaches over the run."""
    if scene.ephemeris != "de421" or scene.epoch is None:
        return []
    found = []
    if not 1900 <= scene.epoch.year <= 2053 - scene.propagation.duration / YEAR:
        found.append(("ephemeris", "DE421 reaches from 1899 to 2053; this run goes beyond"))
    if find_spec("skyfield_data") is None or find_spec("jplephem") is None:
        found.append(("ephemeris", 'DE421 needs the extra "ephemeris": pip install "sailviz[ephemeris]"'))
    return found


def epoch(scene: Scene) -> Faults:
    """A recording's clock reaches over the run's dates."""
    begins = scene.epoch_utc
    if begins is None:
        return []
    try:
        ends = begins + timedelta(seconds=scene.propagation.duration)
        in_reach(ends.date(), f"the end of the run, {ends:%Y-%m-%d},")
    except OverflowError:
        return [("epoch", f"the end of the run {OUT_OF_REACH}")]
    except DateError as error:
        return [("epoch", str(error))]
    return []


def duration(scene: Scene) -> Faults:
    """A recording's clock reaches over the run, which reaches over its windows."""
    found, whole = [], scene.propagation.duration
    if whole > LONGEST:
        words = (
            "a recording's clock reaches 292 years of nanoseconds; lifetimes beyond are sailviz.design.decay's business"
        )
        found.append(("propagation.duration", words))
    for i, window in enumerate(scene.propagation.dense):
        if window.end > whole:
            found.append((f"propagation.dense[{i}].end", "the window reaches beyond the run"))
    return found


def events(scene: Scene) -> Faults:
    """What an event watches is there in the scene."""
    found: Faults = []
    for i, item in enumerate(scene.event):
        found += unknown_here(scene, item, f"event[{i}]")
    return found


def unknown_here(scene: Scene, item: Crossing, place: str) -> Faults:
    """What keeps a scene from a quantity that is watched in it."""
    stem = item.quantity
    if stem is None:
        return []
    return [(f"{place}.{stem}", words) for stems, lacks, words in LACKING if stem in stems and lacks(scene)][:1]


def lit_and_dark(scene: Scene) -> bool:
    """Whether a shadow is known in a scene."""
    known = scene.epoch is not None or scene.environment.sun_right_ascension is not None
    return scene.body == "earth" and (known or getattr(scene.device, "eclipse", "on") != "on")


def expected_of_ensembles(scene: Scene) -> Faults:
    """Statistics are those of the ends of an ensemble that is there."""
    found, known = [], list(dict.fromkeys(item.name for _, item in placed_ensembles(scene)))
    for i, expected in enumerate(scene.expect):
        if expected.ensemble is None:
            if spellings()[expected.quantity].stem == "share":
                words = "share is that of an ensemble's flights: say which, ensemble"
                found.append((f"expect[{i}].quantity", words))
            continue
        if expected.ensemble not in known:
            words = f"no such ensemble {shown(expected.ensemble)}. {nearest(expected.ensemble, known)}"
            found.append((f"expect[{i}].ensemble", words))
        if turning_ensembles.turns(scene):
            found += turning_ensembles.expected(scene, expected, f"expect[{i}]", moments_of(scene))
            continue
        if expected.statistic == "percentile":
            found.append((f"expect[{i}].statistic", "percentiles are known of ensembles of a craft that turns"))
        if expected.ensemble in known and expected.at != "end":
            found.append((f"expect[{i}].at", 'statistics of an ensemble are those of its ends: at = "end"'))
        stem = spellings()[expected.quantity].stem
        if stem not in PLACES and (stem not in MEANS or expected.statistic != "mean"):
            words = f"of an ensemble are known: {', '.join(PLACES)}; and the mean of {', '.join(MEANS)}"
            found.append((f"expect[{i}].quantity", words))
    return found


def expected_of_devices(scene: Scene) -> Faults:
    """Shares of the thrust are those of a device in a list that is there."""
    found: Faults = []
    known = [str(device.name) for device in scene.devices] if scene.place is not None else []
    for i, expected in enumerate(scene.expect):
        if expected.device is None:
            continue
        where = f"expect[{i}].device"
        if not known:
            found.append((where, "names one of a list of devices: this scene has one device and no [[device]]"))
        elif expected.device not in known:
            found.append((where, f"no such device {shown(expected.device)}. {nearest(expected.device, known)}"))
        stem = spellings()[expected.quantity].stem
        if stem not in OF_EACH_DEVICE or expected.ensemble is not None:
            found.append((f"expect[{i}].quantity", f"of one device is known: {', '.join(OF_EACH_DEVICE)}"))
    return found


def moments_of(scene: Scene) -> list[str]:
    """Names of the events that a run can meet."""
    happens = {item.called for item in scene.event} | COME_WITH_DEVICES
    if isinstance(scene.attitude, Moving):
        happens |= {"tumbling", "Sun angle", "wheels saturated"}
    if scene.place is not None:
        happens |= {f"{device.name} {word}" for device in scene.devices for word in ("on", "off")}
    happens |= {end_of(phase.name) for phase in scene.phase[:-1]}
    return sorted(happens)


def expected_moments(scene: Scene) -> Faults:
    """Expectations are of moments that the run can meet, and of a mass that is known."""
    found: Faults = []
    words = [*STATISTICS_OF_ROWS, *moments_of(scene)]
    for i, expected in enumerate(scene.expect):
        if expected.quantity.startswith("mass_") and scene.device.mass is None:
            found.append((f"expect[{i}].quantity", "the device gives no mass"))
        if expected.at is not None and expected.at not in words:
            found.append((f"expect[{i}].at", f"no such moment {shown(expected.at)}. {nearest(expected.at, words)}"))
        if expected.at_time is not None and not 0 <= expected.at_time <= scene.propagation.duration:
            found.append((f"expect[{i}].at_time", "outside the run"))
    return found


# quantities, where a scene does not know them, and in which words that is told; the first that holds is
LACKING: tuple[tuple[tuple[str, ...], Callable[[Scene], bool], str], ...] = (
    (OVER_THE_SURFACE, lambda scene: not has_surface(scene), "the body has no radius to measure an altitude from"),
    (("mass",), lambda scene: scene.device.mass is None, "the device gives no mass"),
    (OF_BODY, lambda scene: not isinstance(scene.attitude, Moving), BELONGS),
    (
        OF_A_DEVICE,
        lambda scene: isinstance(scene.device, NoDevice) and not isinstance(scene.attitude, Moving),
        "nothing is steered and nothing pushes: the device is none",
    ),
    (OF_A_BRAKE, lambda scene: not device_of(scene).tether, "only a plasma brake has it"),
    (
        OF_A_DENSITY,
        lambda scene: not ionosphere_of(scene).density,
        "needs an ionosphere with a density, not a given force",
    ),
    (("air_drag",), lambda scene: scene.environment.atmosphere is None, "there is no environment.atmosphere"),
    (
        ("sun_distance",),
        lambda scene: not (has_sky(scene) and light_away(scene)),
        "the light is at the centre: watch radius, or nothing here depends on where the light is",
    ),
    (
        ("moon_distance",),
        lambda scene: "moon" not in kernel_bodies(scene),
        'the Moon is not there: environment.gravity_of = ["moon"]',
    ),
    (
        ("sunlit_fraction",),
        lambda scene: not shades(scene) and not lit_and_dark(scene),
        "a shadow is known round the Earth, with an epoch or environment.sun_right_ascension",
    ),
)
