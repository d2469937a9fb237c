"""Shipped scenes taken apart and put together anew, with broken values, are scenes or lists of faults, nothing else.

Seeded, so that a failure comes back; `recombined(random)` is also what larger trials by hand are made of.
"""

from __future__ import annotations

import copy
import random
import time
import tomllib
from contextlib import chdir
from datetime import date, datetime

import pytest

from sailviz.errors import SceneError
from sailviz.scene.loading import load_scene, schema
from sailviz.shipped import shipped_folder, shipped_scenes

RAW = [tomllib.loads(path.read_text(encoding="utf-8")) for path in shipped_scenes().values()]
SECTIONS = sorted({key for raw in RAW for key in raw})
KEYS = sorted({key for part in schema()["$defs"].values() for key in part.get("properties", {})})
NUMBERS = [
    0,
    1,
    -1,
    2,
    0.5,
    1e-320,
    1e-12,
    1e12,
    1e300,
    -1e300,
    10**400,
    float("nan"),
    float("inf"),
    -0.0,
    2**63,
    170.0,
]
WORDS = ["", "sun", "earth", "as designed", "x" * 5000, "a\nb", "{}", "2031-04-01", "../x", "\0", "\ud800", "end"]
TABLES = [{}, {"kind": "none"}, [], [None], [1, 2, 3], [[0, 1], [1, 2]]]
OTHER = [True, None, date(2031, 1, 1), datetime(9999, 12, 31), *TABLES]


@pytest.fixture(autouse=True, scope="module")
def beside_the_files_that_scenes_name():
    with chdir(shipped_folder("scenes") / "deorbit"):
        yield


def places(value, path=()):
    """Paths of everything inside a nested value."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [place for key, part in inner for place in [(*path, key), *places(part, (*path, key))]]


def recombined(chance: random.Random) -> dict:
    """Sections of several shipped scenes side by side; then up to three values broken, lost, renamed or exchanged."""
    raw = copy.deepcopy(chance.choice(RAW))
    for key in chance.sample(SECTIONS, chance.randrange(6)):
        donors = [scene[key] for scene in RAW if key in scene]
        raw[key] = copy.deepcopy(chance.choice(donors))
    for _ in range(chance.choice([0, 0, 1, 1, 2, 3])):
        path = chance.choice(places(raw))
        table = raw
        for key in path[:-1]:
            table = table[key]
        change = chance.randrange(6)
        if change == 0:
            del table[path[-1]]
        elif change == 1 and isinstance(table, dict):
            table[chance.choice(KEYS)] = table.pop(path[-1])
        elif change == 2 and isinstance(table[path[-1]], (int, float)):
            table[path[-1]] = table[path[-1]] * chance.choice([-1, 0, 1e-9, 1e-3, 1e3, 1e9])
        else:
            table[path[-1]] = copy.deepcopy(chance.choice(chance.choice([NUMBERS, WORDS, OTHER])))
        if not raw:
            break
    return raw


def verdict(raw: dict) -> str:
    """ "ok", or "refused" with faults that are sentences; whatever else is raised comes through."""
    faults = None
    try:
        scene = load_scene(raw)
    except SceneError as error:
        faults = error.faults
    if faults is None:
        assert len(scene.identity()) == 16
        return "ok"
    assert faults
    assert all(fault.what.strip() and len(str(fault)) < 3000 for fault in faults)
    return "refused"


@pytest.mark.parametrize("seed", range(4))
def test_recombined_and_broken_scenes_are_scenes_or_lists_of_faults(seed):
    """For at most 8 s each; every scene in less than 2 s."""
    chance, end, found = random.Random(seed), time.monotonic() + 8, {"ok": 0, "refused": 0}
    for _ in range(500):
        if time.monotonic() > end:
            break
        raw, begin = recombined(chance), time.process_time()
        found[verdict(raw)] += 1
        assert time.process_time() - begin < 2.0
    assert min(found.values()) > 0
