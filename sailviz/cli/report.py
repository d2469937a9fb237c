"""The command that writes a flight or a sweep on paper."""

from __future__ import annotations

from pathlib import Path

import click

from sailviz.cli.outputs import file_at
from sailviz.cli.shared import collecting_failures, progress_bar, say_if_compiling, set_option, values_of


@click.command()
@click.argument("source", metavar="SCENE|RECORDING|SWEEP")
@click.option("-o", "--output", metavar="FILE", help="The page, .html; NAME.html in this folder by default.")
@click.option("--no-pictures", is_flag=True, help="Words and numbers only.")
@click.option("--alone", is_flag=True, help="Of a descent: do not fly it without its device and under other Suns.")
@click.option("-q", "--quiet", is_flag=True, help="Print errors only.")
@set_option
def report(
    source: str, output: str | None, no_pictures: bool, alone: bool, quiet: bool, settings: tuple[str, ...]
) -> None:
    """Write one HTML page: the answer, pictures, numbers, inputs, versions and what is not covered.

    SCENE and SWEEP are flown first. The page needs no other file and no network, and prints from any browser. For a
    descent in low orbit it says when the craft is down, what the rules of 5 and 25 years say of that, and what would
    happen without the device and under a quiet, a mean and an active Sun. Needs the extra `report`.
    """
    with collecting_failures() as failures, failures.next(source):
        path = file_at(f"{Path(source).stem}.html" if output is None else output, "report", (".html", ".htm"))
        from sailviz.reports import write_report

        say_if_compiling(quiet)
        with progress_bar(Path(source).stem, quiet) as progress:
            written = write_report(
                source,
                path,
                values=values_of(settings),
                pictures=not no_pictures,
                others=not alone,
                progress=progress,
            )
        if not quiet:
            for sentence in written.answer:
                click.echo(sentence)
            click.echo(f"Wrote {written.path}, {written.size / 1e3:,.0f} kB")
