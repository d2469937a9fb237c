"""Each kind of section means something to the propagator: no kind is without its record."""

from __future__ import annotations

from typing import get_args

import numpy as np
import pytest

from sailviz.scene import device, environment, events, start, steering
from sailviz.scene.conflicts.steerings import STEERINGS as FITS
from sailviz.scene.loading import load_scene
from sailviz.scene.units_in_keys import words_of_kind
from sailviz.scene.values import Section
from sailviz.shipped import shipped_scenes
from sailviz.simulation.device import DEVICES
from sailviz.simulation.ensembles import STEERINGS
from sailviz.simulation.environment import ENVIRONMENT
from sailviz.simulation.events import EVENTS
from sailviz.simulation.loop import simulate
from sailviz.simulation.start import STARTS
from sailviz.simulation.steering import STEERINGS as LAWS
from sailviz.simulation.thrust_history import WINDS


@pytest.mark.parametrize(
    ("union", "records"),
    [(start.Start, STARTS), (environment.Winds, WINDS), (steering.Steering, LAWS), (device.Devices, DEVICES)],
)
def test_each_kind_of_section_has_a_record(union, records):
    assert set(get_args(get_args(union)[0])) == set(records)


def named_in(annotation):
    """Every class of section named in a type, however deep in unions and annotations."""
    if isinstance(annotation, type) and issubclass(annotation, Section):
        yield annotation
    for part in get_args(annotation):
        yield from named_in(part)


def test_each_kind_of_part_of_the_environment_has_a_record():
    fields = environment.Environment.model_fields.values()
    kinds = {kind for field in fields for kind in named_in(field.annotation)}
    assert kinds == set(ENVIRONMENT)


def test_each_kind_of_event_has_a_record():
    words, _ = get_args(events.Watched.model_fields["kind"].annotation)
    assert set(get_args(words)) == set(EVENTS)


def test_every_steering_that_flights_can_follow_side_by_side_has_a_record_there():
    """What the scene's check lets through is known to the ensemble, by its class."""
    refused = {word for word, fits in FITS.items() if fits.ensemble.__name__ == "_alone" or not fits.sail}
    lets = set(FITS) - refused - {"gravity-gradient", "spinning"}  # those two steer no sail
    assert lets == {word for kind in STEERINGS for word in words_of_kind(kind)} - refused - {"gravity-gradient"}


def test_one_scene_by_name_by_path_by_dict_and_as_a_scene_is_one_flight():
    """Whatever names the scene: the same identity and the same last position, bit for bit."""
    name = "displaced/circular"
    short = {"propagation.duration_d": 5, "propagation.outputs": 3}
    scene = load_scene(name, short)
    path = shipped_scenes()[name]
    assert load_scene(name).identity() == load_scene(path).identity() == load_scene(str(path)).identity()
    assert load_scene(scene) is scene
    assert load_scene(load_scene(name), short).identity() == scene.identity()
    runs = [simulate(source) for source in (scene, scene.raw | {"propagation": {"duration_d": 5, "outputs": 3}})]
    assert np.array_equal(runs[0].position, runs[1].position)
    assert len(simulate(name)) == 3000
