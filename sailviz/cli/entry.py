"""The command line: the same verbs as the Python interface.

Exit codes: 0 all went well, 1 an expectation of a scene failed, 2 bad input, 3 the propagation or the recording failed,
130 interrupted. Heavy modules are imported by the command that needs them, so that `sailviz check` answers at once.
"""

from __future__ import annotations

import click

from sailviz.cli.check import check
from sailviz.cli.compare import compare
from sailviz.cli.digest import digest
from sailviz.cli.export import export
from sailviz.cli.figure import figure
from sailviz.cli.gallery import gallery
from sailviz.cli.info import info
from sailviz.cli.list import list_scenes
from sailviz.cli.picture import picture
from sailviz.cli.run import run
from sailviz.cli.schema import schema
from sailviz.cli.show import show
from sailviz.cli.sweep import sweep
from sailviz.cli.transfer import transfer
from sailviz.cli.view import view
from sailviz.cli.web import web

COMMANDS = (
    check, compare, digest, export, figure, gallery, info, list_scenes, picture, run, schema, show, sweep, transfer,
    view, web,
)  # fmt: skip


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="sailviz")
def main() -> None:
    """Trajectories of solar sails, electric sails and plasma brakes: computed, recorded, replayed."""


for _command in COMMANDS:
    main.add_command(_command)
