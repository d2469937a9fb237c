"""Every question that is asked of a scene whose sections fit their own tables, in the order of its answers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sailviz.scene.conflicts import attitude, craft, departures, hybrids, limits, low_orbit, moments, named_files
from sailviz.scene.conflicts.answers import Faults
from sailviz.scene.conflicts.approximations import approximations
from sailviz.scene.conflicts.ensembles import ensembles
from sailviz.scene.conflicts.films import film_of_the_sail
from sailviz.scene.conflicts.phases import asked_of_each, phases
from sailviz.scene.conflicts.sky import under_its_sky
from sailviz.scene.conflicts.wheels import wheel_of_the_sail

if TYPE_CHECKING:
    from sailviz.scene.loading import Scene

QUESTIONS = (
    hybrids.together,
    under_its_sky,
    craft.direction_of_thrust,
    craft.planar_costates,
    craft.designed_orbit,
    craft.round_the_sun,
    craft.what_the_start_asks,
    moments.ephemeris,
    craft.what_the_transfer_asks,
    approximations,
    ensembles,
    moments.expected_of_ensembles,
    moments.expected_of_devices,
    craft.surface_of_the_body,
    departures.outside_the_body,
    departures.frame_of_steering,
    departures.propellant,
    craft.varying_drive,
    craft.brightness,
    craft.sail_with_a_shape,
    film_of_the_sail,
    wheel_of_the_sail,
    attitude.turning,
    moments.epoch,
    low_orbit.known_of_the_earth,
    low_orbit.tether,
    low_orbit.density_of_plasma,
    low_orbit.drag,
    low_orbit.solar_flux,
    low_orbit.date_and_sun,
    low_orbit.start_round_the_earth,
    low_orbit.room_for_the_tether,
    moments.duration,
    named_files.files,
    limits.rows,
    limits.draws,
    limits.steps,
    limits.moments_of_air,
    craft.steepest_pitch,
    moments.events,
    moments.expected_moments,
    attitude.expected_of_turning,
)


OF_LATER_PHASES = (  # what no start decides
    under_its_sky,
    craft.direction_of_thrust,
    craft.steepest_pitch,
    low_orbit.tether,
    low_orbit.density_of_plasma,
    limits.steps,
    attitude.followed_in_phase,
)


def conflicts(scene: Scene) -> Faults:
    """(place, sentence) of everything that fits its own section but not the others."""
    if scene.phase:
        found = phases(scene) + attitude.turning_in_phases(scene)
        return found + [fault for fault in asked_of_each(scene, QUESTIONS, OF_LATER_PHASES) if fault not in found]
    return [fault for question in QUESTIONS for fault in question(scene)]
