"""A flight or a sweep on paper: one HTML file that holds pictures, numbers, inputs, versions and what they claim.

The page needs no other file, no network and no script, and prints from any browser. Needs Jinja2, which comes with the
extra `report`: pip install "sailviz[report]".
"""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.reports.write import Report as Report
    from sailviz.reports.write import write_report as write_report

_HOMES = {"Report": "write", "write_report": "write"}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
