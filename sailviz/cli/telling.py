"""What is said of a flight once it is over: how long it was, what ended it, what became of what its scene expects."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from sailviz.checks import Verdict


def verdict_facts(verdict: Verdict) -> dict[str, Any]:
    """A verdict for JSON, which has no NaN."""
    return {
        "quantity": verdict.quantity,
        "at": verdict.at,
        "expected": verdict.expected,
        "within": verdict.tolerance,
        "measured": None if verdict.measured != verdict.measured else verdict.measured,
        "passed": verdict.passed,
    }


def tell_flight(
    title: str, seconds: float, rows: int, ended: str, verdicts: list[Verdict], remarks: tuple[str, ...] = ()
) -> None:
    """Say how long a flight was, what ended it, what its rows do not tell and what became of what its scene expects."""
    from sailviz.checks.expectations import table
    from sailviz.words import duration

    click.echo(f"{title}: {duration(seconds)}, {rows:,} rows" + (f", ended by {ended}" if ended else ""))
    for remark in remarks:
        click.echo(remark)
    if verdicts:
        click.echo(table(verdicts))


def rerun_command() -> str:
    """How this person calls the viewer: by its name if the shell finds it, else by its path."""
    import shutil

    if shutil.which("rerun"):
        return "rerun"
    beside = Path(sys.executable).with_name("rerun")
    return os.path.relpath(beside) if Path.cwd() in beside.parents else str(beside)
