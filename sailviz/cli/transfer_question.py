"""What `sailviz transfer` may be asked: its options, the question they make, and what in it does not go together."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import click

from sailviz.cli.numbers import Number
from sailviz.constants import AU, DAY

if TYPE_CHECKING:
    import numpy as np

    from sailviz.design.direct import Limits
    from sailviz.transfers import Place

_WHITHER = (
    click.option("--orbits", is_flag=True, help="In space, between the planets' elliptic orbits, both anomalies free."),
    click.option("--date", metavar="DATE", help="Meet the body itself, leaving on this date, e.g. 2030-01-01."),
    click.option(
        "--body-file",
        metavar="FILE",
        help="TO is an asteroid or a comet in this file of JPL's Small-Body Database or the Minor Planet Center.",
    ),
    click.option(
        "--window",
        type=Number(0, 36525, "days", above=True),
        metavar="DAYS",
        help="With --date: leave on the best day of so many.",
    ),
    click.option("--dates", type=click.IntRange(2, 400), default=41, show_default=True, help="Of a window, looked at."),
    click.option(
        "--radius-au",
        type=Number(0, 1e3, "au", above=True),
        metavar="AU",
        help="To a circle of this radius instead of TO.",
    ),
    click.option(
        "--inclination-deg",
        type=Number(-180, 180, "degrees"),
        metavar="DEG",
        help="Of the circle aimed at, to the ecliptic.",
    ),
    click.option(
        "--method",
        type=click.Choice(["auto", "indirect", "direct"]),
        default="auto",
        show_default=True,
        help="By costates; by collocation (extra direct); or the second where the first fails or limits are set.",
    ),
    click.option(
        "--cone-deg",
        type=Number(0, 90, "degrees", above=True),
        metavar="DEG",
        help="Hold the sail within so much of the sunlight (extra direct).",
    ),
    click.option(
        "--slew-deg-day",
        type=Number(0, 1e4, "degrees a day", above=True),
        metavar="DEG",
        help="Turn the sail in space no faster (extra direct).",
    ),
    click.option("--starts", type=click.IntRange(1, 200), help="Departure points tried with --orbits (24)."),
)


def question_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options of a Question."""
    for option in reversed(_WHITHER):
        command = option(command)
    return command


@dataclass(frozen=True)
class Question:
    """Where to and how, as it was said at the shell."""

    orbits: bool
    date: str | None
    body_file: str | None
    window: float | None
    dates: int
    radius_au: float | None
    inclination_deg: float | None
    starts: int | None
    method: str
    cone_deg: float | None
    slew_deg_day: float | None

    @classmethod
    def taken(cls, options: dict[str, Any]) -> Question:
        """The question out of a command's options, which keep what is none of it."""
        return cls(**{one.name: options.pop(one.name) for one in fields(cls)})

    def check(self, target: str | None, sails: tuple[str, ...], as_table: bool, output: str | None) -> None:
        """ValueError for whatever does not go together, one sentence a line."""
        faults = [*self._about_the_aim(target), *self._about_the_date(), *self._about_tables(sails, as_table, output)]
        if faults:
            raise ValueError("\n".join(faults))

    def _about_the_aim(self, target: str | None) -> Iterator[str]:
        named = target is not None or self.body_file is not None
        if named == (self.radius_au is not None):
            yield "Say where to: a planet, a small body, or a circle by --radius-au."
        if self.inclination_deg is not None and self.radius_au is None:
            yield "--inclination-deg is that of a circle: give --radius-au with it."

    def _about_the_date(self) -> Iterator[str]:
        if self.date is not None and (self.orbits or self.radius_au is not None):
            yield "--date meets a body where it is: neither --orbits nor --radius-au go with it."
        if self.window is not None and self.date is None:
            yield "--window counts its days from a --date."

    def _about_tables(self, sails: tuple[str, ...], as_table: bool, output: str | None) -> Iterator[str]:
        if as_table and (self.orbits or self.date or output is not None or self.inclination_deg):
            yield "--table shows flights between circles: no --orbits, --date, --inclination-deg or -o."
        if as_table and (self.method == "direct" or self.limited):
            yield "--table shows flights of the indirect method: no --method direct, --cone-deg or --slew-deg-day."
        if len(sails) > 1 and not as_table:
            yield "Several sails are compared with --table."

    @property
    def limited(self) -> bool:
        """Whether the sail is held to limits on the way."""
        return self.cone_deg is not None or self.slew_deg_day is not None

    @property
    def limits(self) -> Limits:
        """What the sail is held to on the way."""
        from sailviz.transfers import limits

        return limits(
            cone=None if self.cone_deg is None else math.radians(self.cone_deg),
            turn_rate=None if self.slew_deg_day is None else math.radians(self.slew_deg_day) / DAY,
        )

    def aim(self, target: str | None) -> Place:
        """The place aimed at."""
        from sailviz.transfers import circle, place, place_of_file

        if self.body_file is not None:
            return place_of_file(self.body_file, target)
        if target is not None:
            return place(target)
        assert self.radius_au is not None, "check has seen that there is one of the two"
        return circle(self.radius_au * AU, math.radians(self.inclination_deg or 0.0))

    @property
    def departure(self) -> np.datetime64 | tuple[np.datetime64, np.datetime64] | None:
        """The date, or the first and the last; ValueError for what is none."""
        if self.date is None:
            return None
        import numpy as np

        first = _day(self.date)
        return first if self.window is None else (first, first + np.timedelta64(round(self.window * DAY), "s"))


def _day(date: str) -> np.datetime64:
    """The day of a departure, UTC. ValueError for what is no date."""
    from sailviz.run.dates import epoch_of

    try:
        found = epoch_of(date)
    except ValueError as error:
        raise ValueError(f"--date: {error}: write 2030-01-01.") from None
    assert found is not None, "only None has no date"
    return found
