"""The command line: the same verbs as the Python interface.

Exit codes: 0 all went well, 1 an expectation of a scene failed, 2 bad input, 3 the propagation or the recording failed,
130 interrupted. A command is imported when it is asked for, and imports heavy modules when it runs, so that `sailviz
check` answers at once.
"""

from __future__ import annotations

import gc
import os
from importlib import import_module

import click

COMMANDS = {  # name, which is also that of the module -> function there
    "check": "check",
    "compare": "compare",
    "digest": "digest",
    "export": "export",
    "figure": "figure",
    "gallery": "gallery",
    "info": "info",
    "list": "list_scenes",
    "picture": "picture",
    "run": "run",
    "schema": "schema",
    "show": "show",
    "sweep": "sweep",
    "transfer": "transfer",
    "view": "view",
    "web": "web",
}


# Building the sections of a scene makes very many objects that stay: looking for garbage among them again and again,
# and for plugins of pydantic in every installed package, is about a tenth of the time of `check`.
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
gc.set_threshold(200_000, 50, 50)


class Verbs(click.Group):
    """The commands of this folder."""

    def list_commands(self, context: click.Context) -> list[str]:
        """All there are, in the order in which --help tells them."""
        return sorted(COMMANDS)

    def get_command(self, context: click.Context, name: str) -> click.Command | None:
        """The command of that name, imported now; for a name that there is not, all of them, to find the nearest."""
        for known in [name] if name in COMMANDS else COMMANDS:
            if known not in self.commands:
                self.add_command(getattr(import_module(f"sailviz.cli.{known}"), COMMANDS[known]))
        return super().get_command(context, name)


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="sailviz")
def main() -> None:
    """Trajectories of solar sails, electric sails and plasma brakes: computed, recorded, replayed."""
