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
    from sailviz.transfers.ends import Bounds, End

_WHITHER = (
    click.option("--orbits", is_flag=True, help="In space, between the planets' elliptic orbits, both anomalies free."),
    click.option(
        "--date", metavar="DATE", help="Meet the body itself, or pass it, leaving on this date, e.g. 2030-01-01."
    ),
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

_ENDS = (
    click.option(
        "--flyby",
        is_flag=True,
        help="Pass the circle of TO or of --radius-au, or with --date TO itself, at whatever speed.",
    ),
    click.option(
        "--distance-au",
        type=Number(0, 1e3, "au", above=True),
        metavar="AU",
        help="As far from the Sun as this instead of TO, at whatever speed.",
    ),
    click.option(
        "--escape",
        type=Number(0, 1e3, "km/s"),
        metavar="KM_S",
        help="Escape from the Sun with this excess speed instead of TO.",
    ),
    click.option(
        "--across-km-s",
        type=Number(0, 1e3, "km/s", above=True),
        metavar="KM_S",
        help="At --radius-au, move across the Sun line at this speed instead of that of the circle.",
    ),
    click.option(
        "--perihelion-au",
        type=Number(0, 1e3, "au", above=True),
        metavar="AU",
        help="Come no nearer to the Sun than this; with --flyby, --distance-au or --escape.",
    ),
    click.option(
        "--hottest-K",
        "hottest_k",
        type=Number(0, 5e3, "K", above=True),
        metavar="K",
        help="Turn the film away from the Sun where it would become hotter; jpl-1978 and jpl-2015.",
    ),
    click.option(
        "--revolutions",
        type=Number(0, 100, above=True),
        metavar="N",
        help="Sweep exactly so many revolutions about the Sun.",
    ),
)


def question_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """The options of a Question."""
    for option in reversed([*_WHITHER, *_ENDS]):
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
    flyby: bool
    distance_au: float | None
    escape: float | None
    across_km_s: float | None
    perihelion_au: float | None
    hottest_k: float | None
    revolutions: float | None

    @classmethod
    def taken(cls, options: dict[str, Any]) -> Question:
        """The question out of a command's options, which keep what is none of it."""
        return cls(**{one.name: options.pop(one.name) for one in fields(cls)})

    def check(self, target: str | None, sails: tuple[str, ...], as_table: bool, output: str | None) -> None:
        """ValueError for whatever does not go together, one sentence a line."""
        faults = [
            *self._about_the_aim(target), *self._about_the_date(), *self._about_limits(),
            *self._about_tables(sails, as_table, output),
        ]  # fmt: skip
        if faults:
            raise ValueError("\n".join(faults))

    @property
    def _instead_of_an_orbit(self) -> list[str]:
        """Ends that are no orbit, as they were said."""
        said = {"--distance-au": self.distance_au, "--escape": self.escape}
        return [word for word, value in said.items() if value is not None]

    def _about_the_aim(self, target: str | None) -> Iterator[str]:
        ends = self._instead_of_an_orbit
        aims = [
            *(["TO"] if target is not None or self.body_file is not None else []),
            *(["--radius-au"] if self.radius_au is not None else []),
            *ends,
        ]
        if not aims:
            yield "Say where to: a planet, a small body, a circle by --radius-au, --distance-au or --escape."
        elif len(aims) > 1:
            yield f"Say where to once: {' and '.join(aims)} are {len(aims)} ends."
        if self.flyby and ends:
            yield f"--flyby passes TO or the circle of --radius-au; {ends[0]} is an end of its own."
        if self.inclination_deg is not None and self.radius_au is None:
            yield "--inclination-deg is that of a circle: give --radius-au with it."
        if self.orbits and (self.flyby or ends):
            yield f"--orbits ends on an orbit: {' and '.join(ends or ['--flyby'])} does not go with it."
        if self.inclination_deg and (self.flyby or self.across_km_s is not None):
            yield "--flyby and --across-km-s are for the plane of departure: no --inclination-deg."
        if self.across_km_s is not None and (self.radius_au is None or self.flyby):
            yield "--across-km-s is the speed at --radius-au: give that with it, and no --flyby."

    def _about_the_date(self) -> Iterator[str]:
        ends = self._instead_of_an_orbit
        others = [word for word, said in {"--orbits": self.orbits, "--radius-au": self.radius_au}.items() if said]
        if self.date is not None and (others or ends):
            yield f"--date meets a body where it is: {' and '.join([*others, *ends])} does not go with it."
        if self.window is not None and self.date is None:
            yield "--window counts its days from a --date."

    def _about_limits(self) -> Iterator[str]:
        limits = {
            "--perihelion-au": self.perihelion_au,
            "--hottest-K": self.hottest_k,
            "--revolutions": self.revolutions,
        }
        said = [word for word, value in limits.items() if value is not None]
        direct = self.method == "direct" or self.limited
        if self.limited and self.date is not None:
            yield "--cone-deg and --slew-deg-day are for flights in one plane, without --date."
        if said and (self.orbits or self.inclination_deg or self.date is not None):
            yield f"{' and '.join(said)}: for flights in one plane, without --orbits, --inclination-deg or --date."
        if self.date is not None or self.perihelion_au is None or direct:
            return
        if not (self.flyby or self._instead_of_an_orbit):
            yield (
                "--perihelion-au is kept on the way past a circle or out: give --flyby, --distance-au or --escape, or "
                "--method direct."
            )
        if self.revolutions is not None:
            yield "--perihelion-au and --revolutions are looked for at once by --method direct only."

    def _about_tables(self, sails: tuple[str, ...], as_table: bool, output: str | None) -> Iterator[str]:
        ends = self.flyby or self._instead_of_an_orbit or self.within.any or self.across_km_s
        if as_table and (self.orbits or self.date or output is not None or self.inclination_deg or ends):
            yield "--table shows flights between circles: no other ends or limits, no --orbits, --date or -o."
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

    @property
    def end(self) -> End | None:
        """What the flight comes to, None where that is an orbit or a planet."""
        from sailviz.transfers.ends import Arrival, Distance, Escape, FlyBy

        if self.distance_au is not None:
            return Distance(self.distance_au * AU)
        if self.escape is not None:
            return Escape(self.escape * 1e3)
        if self.across_km_s is not None and self.radius_au is not None:
            return Arrival(self.radius_au * AU, self.across_km_s * 1e3)
        return FlyBy() if self.flyby else None

    @property
    def within(self) -> Bounds:
        """What it keeps to."""
        from sailviz.transfers.ends import Bounds

        near = None if self.perihelion_au is None else self.perihelion_au * AU
        return Bounds(near, self.hottest_k, self.revolutions)

    def aim(self, target: str | None) -> Place | None:
        """The place aimed at, where there is one."""
        from sailviz.transfers import circle, place, place_of_file

        if self.body_file is not None:
            return place_of_file(self.body_file, target)
        if target is not None:
            return place(target)
        if self.radius_au is None or self.across_km_s is not None:
            return None
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
