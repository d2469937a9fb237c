"""`python -m sailviz`."""

from sailviz.cli.main import main

main(prog_name="sailviz")
