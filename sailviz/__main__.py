"""`python -m sailviz`."""

from sailviz.cli import main

if __name__ == "__main__":
    main(prog_name="sailviz")
