"""A flight or a sweep on paper: one HTML file that holds pictures, numbers, inputs, versions and what they claim.

The page needs no other file, no network and no script, and prints from any browser. Needs Jinja2, which comes with the
extra `report`: pip install "sailviz[report]".
"""

from sailviz.reports.write import write_report

__all__ = ["write_report"]
