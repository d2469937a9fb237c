"""The command line: the same verbs as the Python interface.

Exit codes: those of shared.py. A command is imported when it is asked for, and imports heavy modules when it runs, so
that `sailviz check` answers at once.
"""

from __future__ import annotations

import atexit
import gc
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from typing import Any

import click

from sailviz.cli.shared import INTERRUPTED, UNREAD, bearable, tell

COMMANDS = {  # name, which is also that of the module -> function there
    "check": "check",
    "compare": "compare",
    "deorbit": "deorbit",
    "digest": "digest",
    "export": "export",
    "figure": "figure",
    "gallery": "gallery",
    "gtoc13": "gtoc13",
    "info": "info",
    "list": "list_scenes",
    "picture": "picture",
    "record": "record",
    "report": "report",
    "run": "run",
    "schema": "schema",
    "shape": "shape",
    "show": "show",
    "sweep": "sweep",
    "transfer": "transfer",
    "view": "view",
    "watch": "watch",
    "web": "web",
}


# Importing what a flight needs and building the sections of a scene makes some 200,000 objects that stay: looking for
# garbage among them, and for plugins of pydantic in every installed package, is about a tenth of the time of `check`
# and of a short flight. No matrix here is worth the threads that OpenBLAS starts when numpy is imported: 0.1 s of CPU.
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
gc.set_threshold(400_000, 50, 50)
# And looking through all of them once more when the process ends, where they go anyway, is a fifth of a short flight.
atexit.register(gc.freeze)


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

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        **more: Any,
    ) -> Any:
        """Run a command; as a program of its own, one that ends properly when it is asked to."""
        if not standalone_mode:
            return super().main(args, prog_name, complete_var, standalone_mode=False, **more)
        from sailviz.cli.endings import asked_to_end, printable

        printable()
        with asked_to_end():
            return super().main(args, prog_name, complete_var, standalone_mode=True, **more)

    def make_context(self, *arguments: Any, **more: Any) -> click.Context:
        """Read the command line."""
        with _bearable_messages():
            return super().make_context(*arguments, **more)

    def invoke(self, context: click.Context) -> Any:
        """Run the command that was asked for. What it did not foresee has an exit code of its own."""
        try:
            with _bearable_messages():
                return super().invoke(context)
        except KeyboardInterrupt:
            tell("Interrupted.")
            context.exit(INTERRUPTED)
        except (click.exceptions.Exit, click.ClickException, click.Abort):
            raise
        except BrokenPipeError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # so that Python's last flush fails no more
            context.exit(UNREAD)
        except Exception as error:
            from sailviz.cli.endings import unforeseen

            context.exit(unforeseen(error))


@contextmanager
def _bearable_messages() -> Iterator[None]:
    """Let nobody read thousands of letters that were given by accident."""
    try:
        yield
    except click.ClickException as error:
        if bearable(error.message) == error.message:
            raise
        raise click.UsageError(bearable(error.format_message()), getattr(error, "ctx", None)) from None


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="sailviz")
def main() -> None:
    """Trajectories of solar sails, electric sails and plasma brakes: computed, recorded, replayed."""
