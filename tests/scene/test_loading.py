"""The scene loader: SI whatever the unit, every fault at once with its place and a way out, never a traceback."""

from __future__ import annotations

import copy
import subprocess
import sys
import tomllib
from datetime import UTC, date, datetime, time, timedelta, timezone

import jsonschema
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sailviz.errors import SceneError
from sailviz.scene.loading import load_scene, schema
from sailviz.shipped import shipped_scenes
from sailviz.simulation.plan import plan
from sailviz.units import UNITS

RAW = {name: tomllib.loads(path.read_text(encoding="utf-8")) for name, path in shipped_scenes().items()}
SMALL = {
    "title": "small",
    "start": {"kind": "circular", "radius_au": 1},
    "device": {"kind": "none"},
    "propagation": {"duration_d": 10},
}


def with_parts(**parts):
    return {**SMALL, **parts}


def faults(source, **more) -> dict[str, str]:
    """Place -> sentence (with its hint) of everything that is wrong."""
    with pytest.raises(SceneError) as caught:
        load_scene(source, **more)
    return {fault.where: f"{fault.what} {fault.hint}" for fault in caught.value.faults}


# ---------------------------------------------------------------- units
@pytest.mark.parametrize(
    ("one", "other"),
    [
        ({"radius_au": 1}, {"radius_km": 149597870.7}),
        ({"radius_au": 1}, {"radius_m": 149_597_870_700}),
        ({"radius_earth_radii": 200}, {"radius_km": 1275627.4}),
    ],
)
def test_every_spelling_of_a_length_is_the_same_length(one, other):
    first, second = (load_scene(with_parts(start={"kind": "circular", **start})) for start in (one, other))
    assert first.start.radius == pytest.approx(second.start.radius, rel=1e-15)


def test_one_scene_in_many_units_is_one_flight():
    """Degrees and radians, years and seconds, kilovolts and volts: the same model to the last digits of float."""
    many = {
        "title": "units",
        "start": {"kind": "circular", "radius_au": 1, "inclination_deg": 90},
        "device": {
            "kind": "electric-sail",
            "tethers": 100,
            "tether_length_km": 20,
            "voltage_kV": 20,
            "mass_t": 1,
            "wind_pressure_nPa": 2,
        },
        "steering": {"kind": "orbital", "pitch_deg": 30, "clock_deg": 180},
        "propagation": {"duration_yr": 2},
    }
    si = copy.deepcopy(many)
    si["start"] = {"kind": "circular", "radius_m": 149_597_870_700, "inclination_rad": np.pi / 2}
    si["device"] = {
        "kind": "electric-sail", "tethers": 100, "tether_length_m": 20e3, "voltage_V": 20e3, "mass_kg": 1000,
        "wind_pressure_Pa": 2e-9,
    }  # fmt: skip
    si["steering"] = {"kind": "orbital", "pitch_rad": np.pi / 6, "clock_rad": np.pi}
    si["propagation"] = {"duration_s": 63_115_200}
    one, other = plan(load_scene(many)), plan(load_scene(si))
    named, others = (p.model.named._replace(places=(), callbacks=()) for p in (one, other))  # no addresses
    for values, same in zip(named, others, strict=True):
        assert values == pytest.approx(same, rel=1e-15)
    assert np.array_equal(one.model.tables, other.model.tables)
    assert np.array_equal(one.position, other.position)
    assert one.scene.propagation.duration == other.scene.propagation.duration


def test_a_quantity_without_its_unit_is_told_its_units():
    found = faults(with_parts(start={"kind": "circular", "radius": 1}))
    assert "needs its unit" in found["start.radius"]
    assert "radius_au" in found["start.radius"]


def test_a_quantity_in_two_units_is_refused():
    assert (
        "second time"
        in faults(with_parts(start={"kind": "circular", "radius_au": 1, "radius_km": 1}))["start.radius_km"]
    )


def test_limits_are_told_in_the_unit_of_the_file():
    found = faults(with_parts(steering={"kind": "orbital", "pitch_deg": 200}))
    assert found["steering.pitch_deg"].startswith("must be at most 180 deg, is 200")


def test_another_unit_replaces_the_one_in_the_file():
    scene = load_scene(SMALL)
    changed = scene.with_values({"start.radius_km": 3e8, "propagation.duration_yr": 1})
    assert changed.start.radius == 3e11
    assert changed.propagation.duration == 365.25 * 86400
    assert scene.start.radius == 149_597_870_700.0
    assert changed.with_values({"start.radius_au": 1}).start == scene.start


def test_values_inside_lists_can_be_set():
    scene = load_scene("displaced/circular")
    assert scene.with_values({"expect.1.value": 3}).expect[1].value == 3
    assert list(faults("displaced/circular", set={"expect.99.value": 3})) == ["expect.99.value"]


# ---------------------------------------------------------------- faults
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
        "needs the Sun"
        in faults(with_parts(body="earth", device={"kind": "solar-sail", "lightness_number": 0.1}))["device.kind"]
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


# ---------------------------------------------------------------- files
@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"title = ", "not valid TOML"),
        (b"\xff\xfet\x00", "not UTF-8"),
        (b"a = " + b"[" * 5000 + b"]" * 5000, "nested too deeply"),
        (b"a." * 5000 + b"a = 1", "nested too deeply"),
        (b"title = " + b"9" * 5000, "not valid TOML"),
        (b"", "title: is missing"),
        (b'"a]b" = 1\n"a." = 2\n"" = 3', "unknown key"),
    ],
)  # fmt: skip
def test_a_file_that_is_no_scene_is_refused_in_a_sentence(tmp_path, content, words):
    file = tmp_path / "scene.toml"
    file.write_bytes(content)
    with pytest.raises(SceneError, match=words):
        load_scene(file)


@pytest.mark.parametrize("source", ["displaced/circle", "no/such", "", "x" * 5000, "\0", "."])
def test_a_name_that_is_no_scene_is_refused_in_a_sentence(source):
    with pytest.raises(SceneError, match="file"):
        load_scene(source)


def test_a_byte_order_mark_is_no_part_of_the_scene(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_bytes(b"\xef\xbb\xbf" + shipped_scenes()["displaced/circular"].read_bytes())
    assert load_scene(file).identity() == load_scene("displaced/circular").identity()


def test_a_scene_remembers_its_text_and_its_name():
    scene = load_scene("displaced/circular.toml")
    assert scene.source == "displaced/circular"
    assert scene.text == shipped_scenes()["displaced/circular"].read_text()
    assert scene.with_values({"title": "other"}).text == scene.text


def test_epochs_become_utc():
    for epoch, utc in (
        (date(2030, 1, 2), datetime(2030, 1, 2)),
        (datetime(2030, 1, 2, 3), datetime(2030, 1, 2, 3)),
        (datetime.fromisoformat("2030-01-02T03:00:00+05:00"), datetime(2030, 1, 1, 22)),
    ):
        assert load_scene(with_parts(epoch=epoch)).epoch_utc == utc


QUOTED = [
    ("2031-04-01", date(2031, 4, 1)),
    ("2031-091", date(2031, 4, 1)),
    ("2031-04-01T12:00:00", datetime(2031, 4, 1, 12)),
    ("2031-04-01 12:00:00.25", datetime(2031, 4, 1, 12, 0, 0, 250_000)),
    ("2031-091T12:00", datetime(2031, 4, 1, 12)),
    ("2031-04-01T12:00:00Z", datetime(2031, 4, 1, 12, tzinfo=UTC)),
    ("2031-04-01T14:00:00+02:00", datetime(2031, 4, 1, 14, tzinfo=timezone(timedelta(hours=2)))),
    ("1678-01-01", date(1678, 1, 1)),
    ("2262-03-01", date(2262, 3, 1)),
]


@pytest.mark.parametrize(("text", "unquoted"), QUOTED)
def test_a_quoted_date_is_the_date_without_quotes_and_the_schema_agrees(text, unquoted):
    quoted, plainly = (load_scene(with_parts(epoch=epoch)) for epoch in (text, unquoted))
    assert quoted.epoch_utc == plainly.epoch_utc
    assert quoted.identity() == plainly.identity()
    assert jsonschema.Draft202012Validator(schema()).is_valid(with_parts(epoch=text))


@pytest.mark.parametrize(
    "epoch", ["now", "2031", "2031-4-1", "04/01/2031", "12:00", "2031-04-01T12", "", 2031, 2461000.5, True]
)
def test_what_is_no_date_is_refused_by_checker_and_schema(epoch):
    assert "is no date" in faults(with_parts(epoch=epoch))["epoch"]
    assert not jsonschema.Draft202012Validator(schema()).is_valid(with_parts(epoch=epoch))


@pytest.mark.parametrize(
    ("epoch", "words"),
    [
        (time(3, 4), "is no date"),
        (np.datetime64("NaT"), "is no date"),
        ("2031-02-30", "no such day"),
        ("2016-12-31T23:59:60", "leap second"),
        (date(1677, 1, 1), "1678 to 2262"),
        (datetime(1, 1, 1, tzinfo=timezone(timedelta(hours=12))), "1678 to 2262"),
        ("2262-04-05", "the end of the run, 2262-04-15, lies outside"),
    ],
)
def test_dates_that_no_recording_can_hold_are_refused(epoch, words):
    assert words in faults(with_parts(epoch=epoch))["epoch"]


def test_the_date_of_a_replayed_wind_may_be_quoted_too():
    def begins(start):
        wind = {"kind": "replay", "file": "wind.csv", "start": start}
        device = {"kind": "electric-sail", "characteristic_acceleration_mm_s2": 1}
        return with_parts(device=device, environment={"solar_wind": wind})

    assert load_scene(begins("2005-01-02")).identity() == load_scene(begins(date(2005, 1, 2))).identity()
    assert "is no date" in faults(begins(2005))["environment.solar_wind.start"]


# ---------------------------------------------------------------- never another exception
def words_of(value):
    if isinstance(value, dict):
        return set(value) | set().union(*map(words_of, value.values()))
    if isinstance(value, list):
        return set().union(*map(words_of, value))
    return {value} if isinstance(value, str) else set()


WORDS = sorted(set().union(*map(words_of, RAW.values())) | words_of(schema()) | {"", ".", "a]b", "\n", "é", "0"})
SCALARS = st.one_of(
    st.sampled_from(WORDS),
    st.text(max_size=5),
    st.booleans(),
    st.integers(),
    st.sampled_from([10**400, -(10**400), 2**63, 0]),
    st.floats(),
    st.dates(),
    st.datetimes(timezones=st.sampled_from([None, UTC])),
    st.just(time(3, 4)),
)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from(WORDS), inner, max_size=4),
    max_leaves=12,
)


def places(value, path=()):
    """Paths of everything inside a nested value."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [place for key, part in inner for place in [(*path, key), *places(part, (*path, key))]]


@st.composite
def mutated(draw):
    """A shipped scene with up to three keys replaced, removed, added or renamed."""
    raw = copy.deepcopy(RAW[draw(st.sampled_from(sorted(RAW)))])
    for _ in range(draw(st.integers(1, 3))):
        path = draw(st.sampled_from(places(raw)))
        table = raw
        for key in path[:-1]:
            table = table[key]
        change = draw(st.sampled_from(["replace", "remove", "add", "rename"]))
        if change == "replace" or not isinstance(table, dict):
            table[path[-1]] = draw(VALUES)
        elif change == "remove":
            del table[path[-1]]
        else:
            word = draw(st.sampled_from(WORDS))
            table[word] = draw(VALUES) if change == "add" else table.pop(path[-1])
        if not places(raw):
            break
    return raw


def accepted(load):
    """What load returns, or None if it refused with a list of faults. Any other exception is a bug."""
    faulty = None
    try:
        result = load()
    except SceneError as error:
        faulty, result = error, None
    assert faulty is None or (faulty.faults and str(faulty))
    return result


FAST = settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))


@FAST
@given(mutated())
def test_a_mutated_scene_is_a_scene_or_a_list_of_faults_and_so_is_its_plan(raw):
    scene = accepted(lambda: load_scene(raw))
    if scene is not None:
        assert len(scene.identity()) == 16
        accepted(lambda: plan(scene))


@FAST
@given(st.dictionaries(st.sampled_from(WORDS), VALUES, max_size=6))
def test_any_table_is_a_scene_or_a_list_of_faults(raw):
    accepted(lambda: load_scene(raw))


@FAST
@given(st.lists(st.sampled_from(WORDS) | st.text(max_size=3), min_size=1, max_size=4).map(".".join), VALUES)
def test_any_override_is_a_scene_or_a_list_of_faults(key, value):
    accepted(lambda: load_scene("displaced/circular").with_values({key: value}))


@FAST
@given(st.sampled_from(sorted(RAW)), st.data())
def test_a_file_with_damaged_characters_is_a_scene_or_a_list_of_faults(tmp_path_factory, name, data):
    text = shipped_scenes()[name].read_text(encoding="utf-8")
    start = data.draw(st.integers(0, len(text)))
    end = data.draw(st.integers(start, min(len(text), start + 20)))
    file = tmp_path_factory.getbasetemp() / "damaged.toml"
    file.write_text(
        text[:start] + data.draw(st.text("[]{}\"'=.#\n\0 -_aé10", max_size=8)) + text[end:], encoding="utf-8"
    )
    accepted(lambda: load_scene(file))


# ---------------------------------------------------------------- schema
def plain(value):
    """As an editor's JSON Schema validator sees TOML: dates are strings there."""
    if isinstance(value, dict):
        return {key: plain(part) for key, part in value.items()}
    if isinstance(value, list):
        return [plain(part) for part in value]
    return value.isoformat() if isinstance(value, (date, datetime)) else value


@pytest.mark.parametrize("name", sorted(RAW))
def test_json_schema_accepts_shipped_scenes_and_rejects_a_misspelt_key(name):
    validator = jsonschema.Draft202012Validator(schema())
    validator.check_schema(schema())
    good = plain(RAW[name])
    assert [error.message for error in validator.iter_errors(good)] == []
    for where in ("start", "device", "propagation"):
        bad = copy.deepcopy(good)
        key = next(key for key in bad[where] if key != "kind")
        bad[where][key + "x"] = bad[where].pop(key)
        assert not validator.is_valid(bad)


def test_schema_wants_a_unit_and_only_one():
    validator = jsonschema.Draft202012Validator(schema())
    assert validator.is_valid(SMALL)
    assert not validator.is_valid(with_parts(propagation={"duration": 10}))
    assert not validator.is_valid(with_parts(propagation={"duration_d": 10, "duration_s": 10}))
    assert not validator.is_valid(with_parts(propagation={}))


def test_schema_knows_every_unit_of_every_quantity():
    properties = schema()["$defs"]["Propagation"]["properties"]
    assert {f"duration_{unit}" for unit in UNITS["time"]} <= set(properties)
    assert "duration" not in properties


# ---------------------------------------------------------------- what loading costs
@pytest.mark.parametrize(
    ("code", "heavy"),
    [
        ("import sailviz", ("numpy", "pydantic", "numba", "rerun", "scipy")),
        ("import sailviz; sailviz.load_scene('displaced/circular')", ("numba", "rerun", "scipy")),
    ],
)
def test_what_is_not_needed_is_not_imported(code, heavy):
    report = f"{code}\nimport sys; print([name for name in {heavy} if name in sys.modules])"
    assert subprocess.check_output([sys.executable, "-c", report], text=True).strip() == "[]"


def test_verbs_are_found_on_first_use():
    import sailviz

    assert set(sailviz.__all__) <= set(dir(sailviz))
    for verb in ("load_scene", "simulate", "simulate_blocks"):
        assert callable(getattr(sailviz, verb))
    with pytest.raises(AttributeError, match="no attribute"):
        _ = sailviz.simulat


# ---------------------------------------------------------------- --set and long words
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
    assert [str(fault)[: len(where)] for fault in caught.value.faults] == [where]
    assert "(line" not in str(caught.value)


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
