"""The version of sailviz that is running."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("sailviz")
except PackageNotFoundError:  # run from a folder that was never installed
    __version__ = "0+unknown"
