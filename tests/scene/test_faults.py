"""Every fault of a scene is told at once, with its place and a way out, in words of bearable length."""

from __future__ import annotations

from datetime import date

import pytest

from sailviz.errors import SceneError
from sailviz.scene.loading import load_scene
from sailviz.shipped import shipped_scenes

from .small import faults, with_parts

FAULTY = """\
title = ""
epock = 2030-01-01

[start]
kind = "circular"
radius_au = -1

[device]
kind = "solar-sail"
film = "jpl-2016"
lightness_number = "much"

[propagation]
duration_yr = 1
outputs = 1.5

[[expect]]
quantity = "radius_aw"
at = "end"
value = 1
within = 1
"""


def test_every_fault_is_listed_at_once_with_its_line_and_the_nearest_word(tmp_path):
    file = tmp_path / "faulty.toml"
    file.write_text(FAULTY)
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    found = {fault.where: fault for fault in caught.value.faults}
    lines = {"title": 1, "epock": 2, "start.radius_au": 6, "device.film": 10, "device.lightness_number": 11}
    lines |= {"propagation.outputs": 15, "expect[0]": 17}
    assert {where: fault.line for where, fault in found.items()} == lines
    text = str(caught.value)
    assert text.startswith(f"{file}: 7 faults")
    for words in (
        'Did you mean "epoch"',
        'Did you mean "jpl-2015"',
        'Did you mean "radius_au"',
        "greater than 0 au, is -1",
    ):
        assert words in text


def test_faults_between_sections_name_both():
    assert (
        "from the Sun line"
        in faults(
            with_parts(
                body="earth",
                device={"kind": "solar-sail", "lightness_number": 0.1},
                steering={"kind": "orbital", "pitch_deg": 5},
            )
        )["steering.kind"]
    )
    found = faults(with_parts(device={"kind": "plasma-brake", "mass_kg": 4, "tether_length_m": 300}))
    assert set(found) == {"device.kind", "environment.ionosphere"}
    assert (
        "as designed"
        in faults(with_parts(device={"kind": "electric-sail", "characteristic_acceleration": "as designed"}))[
            "device.characteristic_acceleration"
        ]
    )


@pytest.mark.parametrize(
    ("parts", "place", "words"),
    [
        ({"start": {"kind": "circlar", "radius_au": 1}}, "start.kind", 'Did you mean "circular"'),
        ({"start": {"radius_au": 1}}, "start.kind", "is missing"),
        ({"start": {"kind": "circular"}}, "start", "exactly one of radius or altitude"),
        ({"start": 3}, "start", "must be a table"),
        ({"body": "sunn"}, "body", 'Did you mean "sun"'),
        ({"body": {"name": "x"}}, "body.mu", "mu_km3_s2"),
        ({"epoch": "soon"}, "epoch", "'soon' is no date"),
        ({"epoch": date(1500, 1, 1)}, "epoch", "1678 to 2262"),
        ({"event": [{"kind": "radius"}]}, "event[0]", "needs radius"),
        ({"event": [{"kind": "node", "sense": {"a": 1}}]}, "event[0].sense", "Allowed: up, down, both"),
        ({"expect": [{"quantity": "mass_kg", "at": "ende", "value": 1, "within": 1}]}, "expect[0].at", '"end"'),
        ({"device": {"kind": "none", "active_d": [[3, 1]]}}, "device", "each after the one before"),
        ({"device": {"kind": "none", "active_d": [[3]]}}, "device.active_d[0]", "has 1 entries"),
        ({"propagation": {"duration_d": 10**400}}, "propagation.duration_d", "must be a number"),
        ({"propagation": {"duration_d": 1, "outputs": 10**400}}, "propagation.outputs", "at most 1e+09"),
        ({"propagation": {"duration_d": float("nan")}}, "propagation.duration_d", "finite"),
    ],
)  # fmt: skip
def test_fault_says_where_what_and_what_instead(parts, place, words):
    found = faults(with_parts(**parts))
    assert place in found
    assert words in found[place]


@pytest.mark.parametrize(
    ("key", "value", "where"),
    [
        ("start.radius_au", -1, "--set start.radius_au: must be greater than 0 au"),
        ("start.radius_km", -1, "--set start.radius_km: must be greater than 0 km"),
        ("expect.1.value", "x", "--set expect[1].value: must be a number"),
        ("device", {"kind": "non"}, '--set device.kind: "non" is not a kind of device'),
        ("epoch", "soon", "--set epoch: 'soon' is no date"),
        ("expect.99.value", 1, "--set expect.99.value: no such place"),
        ("nosuch.key", 1, "nosuch (with --set nosuch.key): unknown key"),
    ],
)
def test_a_fault_of_a_value_put_over_the_file_names_no_line_of_it(key, value, where):
    with pytest.raises(SceneError) as caught:
        load_scene("displaced/circular", set={key: value})
    (fault,) = caught.value.faults
    assert fault.words("--set").startswith(where)
    assert "(line" not in str(caught.value)
    assert "--set" not in str(caught.value)  # a shell's word; in Python there is none


def test_faults_of_the_file_keep_their_lines_beside_those_of_values_put_over_it(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(shipped_scenes()["displaced/circular"].read_text().replace("outputs = 3000", "outputs = 0"))
    with pytest.raises(SceneError) as caught:
        load_scene(file, set={"start.radius_au": -1})
    given = {fault.where: (fault.given, fault.line) for fault in caught.value.faults}
    assert given["start.radius_au"] == ("start.radius_au", None)
    assert given["propagation.outputs"][0] == ""
    assert given["propagation.outputs"][1] > 1


LONG = "radius" * 900
MASS = {"quantity": "mass_kg", "value": 1, "within": 1}
LONG_WORDS = [
    {LONG: 1},
    {"title": "t", LONG: {"a": 1}},
    with_parts(start={"kind": LONG}),
    with_parts(start={"kind": "circular", LONG: 1}),
    with_parts(device={"kind": "solar-sail", "lightness_number": 0.1, "film": LONG}),
    with_parts(body=LONG),
    with_parts(epoch=LONG),
    with_parts(expect=[{"quantity": LONG, "at": "end", "value": 1, "within": 1}]),
    with_parts(expect=[{**MASS, "at": LONG}]),
    with_parts(
        expect=[{"quantity": "mass_kg", "at": "end", "ensemble": LONG, "statistic": "mean", "value": 1, "within": 1}]
    ),
    with_parts(start={"kind": "circular", "radius_au": LONG}),
]


ELECTRIC = {"kind": "electric-sail", "characteristic_acceleration_mm_s2": 1}
AMONG_LONG = [{**MASS, "at": "end", "ensemble": "calm", "statistic": "mean"}]
LONG_WORDS.append(with_parts(device=ELECTRIC, ensemble=[{"name": LONG}], expect=AMONG_LONG))


@pytest.mark.parametrize("raw", LONG_WORDS, ids=range(len(LONG_WORDS)))
def test_long_words_are_shortened_in_messages_and_cost_no_time(raw):
    with pytest.raises(SceneError) as caught:
        load_scene(raw)
    assert LONG[:100] not in str(caught.value).replace(LONG[:80] + "...", "")
    assert max(map(len, str(caught.value).splitlines())) < 1500


def test_words_with_line_breaks_stay_on_one_line():
    with pytest.raises(SceneError) as caught:
        load_scene(with_parts(body="su\nn", **{"a\nb": 1}))
    assert len(str(caught.value).splitlines()) == 1 + len(caught.value.faults)
