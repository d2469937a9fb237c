"""The command that answers when a craft comes down, and writes the scene and the sweep that fly it again."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sailviz.cli.numbers import Number
from sailviz.cli.outputs import file_at
from sailviz.cli.shared import BAD_INPUT, INTERRUPTED, collecting_failures, progress_bar, say_if_compiling, tell
from sailviz.constants import YEAR
from sailviz.deorbits.question import Question, scene_text, spreads, sweep_text
from sailviz.files import write_text, writing

if TYPE_CHECKING:
    from sailviz.deorbits import Answer

SSO = "sso"
WORDS = {"p5": "5 %", "median": "median", "p95": "95 %"}
FEW = 20  # flights below which nothing is said of one in twenty
OF_FEW = {"min": "least", "median": "median", "max": "largest"}


@click.command()
@click.option("--tle", metavar="FILE", type=click.Path(path_type=Path), help="Element set of its orbit (TLE or OMM).")
@click.option("--altitude", type=Number(130, 2000, "km"), metavar="KM", help="Of a circular orbit instead.")
@click.option("--inclination", default=SSO, show_default=True, metavar="DEG|sso", help="With --altitude.")
@click.option("--epoch", metavar="DATE", help="With --altitude: when it starts, e.g. 2027-01-01; today by default.")
@click.option("--mass", type=Number(0, 1e6, "kg", above=True), required=True, metavar="KG", help="Of the craft.")
@click.option("--tether", type=Number(0, 1e5, "m", above=True), metavar="M", help="Length of a plasma brake.")
@click.option(
    "--voltage",
    type=Number(0, 1e5, "V", above=True),
    default=1000.0,
    show_default=True,
    metavar="V",
    help="Of the tether, negative against the plasma; give its size.",
)
@click.option(
    "--drag-area",
    type=Number(0, 1e6, "m²", above=True),
    metavar="M2",
    help="Mean cross-section of the craft or of its drag sail.",
)
@click.option(
    "--drag-coefficient", type=Number(0, 10, above=True), default=2.2, show_default=True, metavar="CD", help="Of it."
)
@click.option(
    "--weather",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Space weather of CelesTrak, CSSI or GFZ; after its last day, and without it, a smooth cycle of 11 years.",
)
@click.option(
    "--years", type=Number(0, 100, "years", above=True), default=26.0, show_default=True, help="To fly at most."
)
@click.option(
    "--draws", type=click.IntRange(0, 100_000), default=0, show_default=True, help="Flights that say how sure."
)
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Of the draws.")
@click.option("-o", "--output", metavar="FILE", help="Write the scene, NAME.toml, and the sweep, NAME-sweep.toml.")
@click.option("--json", "as_json", is_flag=True, help="Print what was found for a script to read.")
@click.option("-q", "--quiet", is_flag=True, help="Print the years until re-entry only; nothing where it stays up.")
def deorbit(
    tle: Path | None,
    altitude: float | None,
    inclination: str,
    epoch: str | None,
    mass: float,
    tether: float | None,
    voltage: float,
    drag_area: float | None,
    drag_coefficient: float,
    weather: Path | None,
    years: float,
    draws: int,
    seed: int,
    output: str | None,
    as_json: bool,
    quiet: bool,
) -> None:
    """Say when a craft in low orbit comes down with a tether, a drag sail or as it is, and how sure that is.

    It is flown as asked, without the tether, and under a quiet, a mean and an active Sun. With --draws it flies that
    often more, the density of the air and of the plasma and the Sun's activity drawn, and percentiles are told.
    """
    silent = quiet or as_json
    with collecting_failures() as failures, failures.next():
        try:
            asked = Question(
                mass=mass,
                tle=tle,
                altitude=None if altitude is None else altitude * 1e3,
                inclination=_inclination(inclination),
                epoch="" if tle else _date(epoch),
                tether=tether or 0.0,
                voltage=voltage,
                drag_area=drag_area,
                drag_coefficient=drag_coefficient,
                weather=weather,
                years=years,
            )
            scene = scene_text(asked)
            if tle is not None and epoch is not None:
                raise ValueError("an element set has its own epoch: --epoch goes with --altitude")
        except ValueError as error:
            tell(error)
            raise click.exceptions.Exit(BAD_INPUT) from None
        files = [] if output is None else _files(output)
        from sailviz.deorbits import answer

        say_if_compiling(silent)
        with progress_bar("Descents", silent) as progress:
            found = answer(asked, draws, seed=seed, progress=progress)
        if as_json:
            click.echo(json.dumps(summary(found), indent=2))
        elif quiet:
            first = found.flown[0].descent
            if first is not None and first.down:
                click.echo(f"{first.time / YEAR:.6g}")
        else:
            click.echo("\n".join(words(found)))
        if found.interrupted:
            tell("Interrupted.")
            failures.worst(INTERRUPTED)
        if files:
            write_text(files[0], scene, "scene")
            write_text(files[1], sweep_text(asked, files[0].name, draws or 200, seed), "sweep")
            _copy_beside(asked, files[0].parent)
            if not silent:
                click.echo(f"Wrote {files[0]} and {files[1]}: sailviz run {files[0]}, sailviz sweep {files[1]}")


def words(found: Answer) -> Iterator[str]:
    """The answer in sentences and a table."""
    first = found.flown[0].descent
    if first is not None:
        yield first.words
    width = max(len(flight.name) for flight in found.flown)
    for flight in found.flown:
        descent = flight.descent
        if descent is None:
            said = flight.why
        elif descent.down:
            said = f"down after {descent.time / YEAR:.4g} yr"
        else:
            said = f"not down within {descent.time / YEAR:.4g} yr, then {descent.altitude / 1e3:,.0f} km high"
        yield f"  {flight.name:<{width}}  {said}"
    if found.note:
        yield found.note
    if found.draws is not None:
        yield from _drawn(found)


def _drawn(found: Answer) -> Iterator[str]:
    draws = found.draws
    assert draws is not None
    if draws.flights + draws.failed < draws.asked:
        yield f"Interrupted: {draws.flights + draws.failed:,} of {draws.asked:,} flights have flown; of these:"
    if draws.numbers:
        told = [
            f"{word} {'at least ' if draws.numbers[key].at_least else ''}{draws.numbers[key].value:.4g} yr"
            for key, word in (WORDS if draws.flights >= FEW else OF_FEW).items()
        ]
        yield f"Of {draws.flights:,} flights: {', '.join(told)}; {draws.up:,} were still up when their time was over."
    for limit, kept, late, open_ in draws.within:
        rest = f", of {open_:,} that is open" if open_ else ""
        yield f"  down within {limit}: {kept:,} ({kept / max(draws.flights, 1):.1%}), not {late:,}{rest}"
    if draws.failed:
        yield f"  {draws.failed:,} flights failed and are left out"
    yield "  drawn: " + "; ".join(f"{key} {law}" for key, law in spreads(found.question).items())


def summary(found: Answer) -> dict[str, Any]:
    """The answer for a script: times in years, None where it is not down."""

    def one(flight: Any) -> dict[str, Any]:
        descent = flight.descent
        if descent is None:
            return {"flight": flight.name, "down": None, "why": flight.why}
        told = {"flown_yr": descent.time / YEAR, "altitude_km": descent.altitude / 1e3}
        return {"flight": flight.name, "down": descent.down, **told}

    told: dict[str, Any] = {"flights": [one(flight) for flight in found.flown], "note": found.note}
    if found.draws is not None:
        draws = found.draws
        told["draws"] = {
            "flights": draws.flights,
            "asked": draws.asked,
            "still_up": draws.up,
            "failed": draws.failed,
            "years": {key: number.value for key, number in draws.numbers.items()},
            "at_least": [key for key, number in draws.numbers.items() if number.at_least],
            "within": [
                {"limit": limit, "down": kept, "not": late, "open": open_} for limit, kept, late, open_ in draws.within
            ],
            "drawn": spreads(found.question),
        }
    return told


def _inclination(given: str) -> float | None:
    """rad; None for a Sun-synchronous orbit. ValueError for what is neither."""
    if given.lower() == SSO:
        return None
    try:
        degrees = float(given)
    except ValueError:
        degrees = math.nan
    if not 0 <= degrees <= 180:
        raise ValueError(f'an inclination is "sso" or a number of degrees from 0 to 180, not {given!r}')
    return math.radians(degrees)


def _date(given: str | None) -> str:
    if given is None:
        return datetime.now(UTC).date().isoformat()
    try:
        return datetime.fromisoformat(given).isoformat()
    except ValueError:
        raise ValueError(f"{given!r} is no date: write it as 2027-01-01 or 2027-01-01T12:00:00") from None


def _files(output: str) -> list[Path]:
    """The scene's file and the sweep's. OutputError where one cannot be written."""
    scene = file_at(output, "scene", (".toml",))
    return [scene, file_at(scene.with_name(f"{scene.stem}-sweep.toml"), "sweep", (".toml",))]


def _copy_beside(asked: Question, folder: Path) -> None:
    """Put the files that the scene names where it looks for them."""
    for file in asked.files:
        target = folder / file.name
        if not (target.exists() and target.samefile(file)):
            with writing(target, "file of the scene") as part:
                part.write_bytes(file.read_bytes())
