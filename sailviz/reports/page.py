"""What a page is made of, and the page as HTML. What people wrote in a scene stays text: the template escapes it."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from importlib.resources import files as package_files

from sailviz.errors import RecordingError

TEMPLATE = "page.html"


@dataclass(frozen=True)
class Table:
    """Rows under a head, all words. head : () for a table of names and values, whose first column is the names."""

    rows: tuple[tuple[str, ...], ...]
    head: tuple[str, ...] = ()
    caption: str = ""


@dataclass(frozen=True)
class Picture:
    """A picture in the page. data : PNG; caption : what is seen."""

    data: bytes
    caption: str

    @property
    def source(self) -> str:
        """The picture as an address that holds it."""
        return f"data:image/png;base64,{base64.b64encode(self.data).decode()}"


@dataclass(frozen=True)
class Section:
    """A part of a page under a heading. text : shown letter by letter, such as a scene file."""

    heading: str
    sentences: tuple[str, ...] = ()
    tables: tuple[Table, ...] = ()
    pictures: tuple[Picture, ...] = ()
    text: str = ""


@dataclass(frozen=True)
class Page:
    """A whole report. answer : the sentences that it is read for; sections : in order; footer : what made it, when."""

    title: str
    answer: tuple[str, ...]
    sections: tuple[Section, ...]
    footer: str


def html_of(page: Page) -> str:
    """The page as one HTML document. RecordingError where Jinja2 is not installed."""
    try:
        from jinja2 import Environment, StrictUndefined
    except ImportError:
        raise RecordingError('a report needs Jinja2: pip install "sailviz[report]"') from None
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    text = package_files("sailviz.reports").joinpath(TEMPLATE).read_text(encoding="utf-8")
    return environment.from_string(text).render(page=page)
