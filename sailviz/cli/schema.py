"""The command that says what a scene or a sweep file may hold, for editors."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import click

from sailviz.cli.outputs import file_at, is_folder
from sailviz.cli.shared import in_one_sentence

NAMES = {"scene": "sailviz.schema.json", "sweep": "sailviz-sweep.schema.json"}


@click.command()
@click.option("--sweep", is_flag=True, help="Of sweep files instead of scene files.")
@click.option(
    "-o",
    "--output",
    metavar="FILE|DIR",
    help="Write it to a file; into a folder that is there, both, under the names that the README knows.",
)
def schema(sweep: bool, output: str | None) -> None:
    """Print the JSON Schema of scene files, for editors that complete and check them.

    An editor that knows TOML by Taplo (Even Better TOML in VS Code) reads it where the first line of a scene says
    "#:schema ./sailviz.schema.json".
    """
    if output is None:
        click.echo(_text("sweep" if sweep else "scene"), nl=False)
        return
    with in_one_sentence():
        if not is_folder(output):
            _write("sweep" if sweep else "scene", output)
        elif sweep:
            raise click.UsageError("a folder gets both schemas: --sweep goes with a file or without -o.")
        else:
            for what, name in NAMES.items():
                _write(what, Path(output) / name)


def _write(what: str, path: str | Path) -> None:
    from sailviz.files import writing

    path = file_at(path, "schema")
    with writing(path, "schema") as part:
        part.write_text(_text(what), encoding="utf-8")
    click.echo(f"{path}; first line of a {what} file beside it: #:schema ./{path.name}")


def _text(what: str) -> str:
    return json.dumps(_schema(what), indent=2, ensure_ascii=False) + "\n"


def _schema(what: str) -> dict[str, Any]:
    if what == "scene":
        from sailviz.scene import schema

        return schema()
    from sailviz.sweeps import schema as of_sweeps

    return of_sweeps()
