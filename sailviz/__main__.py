"""`python -m sailviz`."""

from sailviz.cli import main

main(prog_name="sailviz")
