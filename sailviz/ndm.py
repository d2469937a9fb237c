"""Navigation data messages of the CCSDS as lines of keywords: those in keyword = value form as they stand, those in XML
(505.0-B) as the lines that say the same, with the line numbers of the XML, so that what reads the one reads the other.

No document type and so no entity of its own is let in: a message needs none, and a small file could grow without end.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple
from xml.parsers import expat

from sailviz.errors import RecordingError

KINDS = ("OEM", "OPM", "OMM", "AEM", "APM")
LONGEST_FILE = 256_000_000  # bytes
DEEPEST = 40  # elements within each other
HEAD = 4096  # bytes of which a file's kind is known
ROWS = {"stateVector": "OEM", "attitudeState": "AEM"}  # elements that are one line of data, and of which message
STATE = {"X": "km", "Y": "km", "Z": "km", "X_DOT": "km/s", "Y_DOT": "km/s", "Z_DOT": "km/s"}
PUSH = {"X_DDOT": "km/s**2", "Y_DDOT": "km/s**2", "Z_DDOT": "km/s**2"}
QUATERNION = ("Q1", "Q2", "Q3", "QC")

Line = tuple[int, str]


class XmlError(ValueError):
    """A message in XML that is none, in one sentence."""


class Message(NamedTuple):
    """One message of a file: its kind and its lines."""

    kind: str
    lines: list[Line]


def lines(path: str | Path, kind: str) -> list[Line]:
    """(line number, text) of the lines of a message that say something. kind : one of KINDS. RecordingError, in one
    sentence, for what is no such message."""
    text = _text(path, kind)
    if text.lstrip().startswith("<"):
        return _of_xml(text, path, kind)
    stripped = [(number, line.strip()) for number, line in enumerate(text.splitlines(), 1)]
    said = [item for item in stripped if item[1] and not re.match(r"COMMENT(\s|$)", item[1], re.IGNORECASE)]
    if not said or not said[0][1].upper().startswith(f"CCSDS_{kind}_VERS"):
        raise RecordingError(f"{path} is not an {kind}: it does not begin with CCSDS_{kind}_VERS")
    return said


def kind_of(path: str | Path) -> str:
    """The kind of message that a file begins as, "" for none and for what cannot be read."""
    try:
        if not Path(path).is_file():
            return ""
        with open(path, "rb") as file:
            head = file.read(HEAD)
    except (OSError, ValueError):
        return ""
    text = head.decode("utf-8", "replace").lstrip("\ufeff").lstrip()
    if text.startswith("<"):
        found = re.search(r"<(?:\w+:)?(oem|opm|omm|aem|apm)\b", text)
        return found.group(1).upper() if found else ""
    said = (line.strip().upper() for line in text.splitlines())
    first = next((line for line in said if line and not re.match(r"COMMENT(\s|$)", line)), "")
    found = re.match(r"CCSDS_(OEM|OPM|OMM|AEM|APM)_VERS", first)
    return found.group(1) if found else ""


def _text(path: str | Path, kind: str) -> str:
    if Path(path).exists() and not Path(path).is_file():  # a pipe or a device may never end
        raise RecordingError(f"cannot read {path}: it is not a regular file")
    try:
        if Path(path).stat().st_size > LONGEST_FILE:
            raise RecordingError(f"{path} is too large for an {kind}")
        return Path(path).read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise RecordingError(f"{path} is not an {kind}: it is not text") from None
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise RecordingError(f"cannot read {path}: {why.lower()}") from None


def _of_xml(text: str, path: str | Path, kind: str) -> list[Line]:
    try:
        found = xml_messages(text)
    except XmlError as error:
        raise RecordingError(f"{path}: {error}") from None
    wanted = [message for message in found if message.kind == kind]
    if not wanted:
        there = ", ".join(dict.fromkeys(message.kind for message in found)) or "no message"
        raise RecordingError(f"{path} is not an {kind}: it is XML with {there}")
    if len(wanted) > 1:
        raise RecordingError(f"{path} holds {len(wanted)} {kind}s, and one is due")
    return wanted[0].lines


def xml_messages(text: str) -> list[Message]:
    """The messages of an XML document, one or several in an <ndm>. XmlError for what is no XML, has a document type,
    or gives a state in other units than the standard's."""
    reader = _Reader()
    try:
        reader.parser.Parse(text.encode("utf-8", "surrogatepass"), True)
    except expat.ExpatError as error:
        raise XmlError(f"this is no XML: {error}") from None
    return reader.messages


class _Reader:
    """Turns elements into lines as they come: leaves into KEY = value [unit], those of a row of data into one line."""

    def __init__(self) -> None:
        self.parser = expat.ParserCreate("utf-8")
        self.parser.buffer_text = True
        self.parser.StartDoctypeDeclHandler = self._refuse
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._said
        self.messages: list[Message] = []
        self._open: list[str] = []
        self._leaf = False
        self._words: list[str] = []
        self._attributes: dict[str, str] = {}
        self._line = 0  # where the leaf, or the row, begins
        self._row: dict[str, str] | None = None
        self._row_line = 0
        self._scalar_first = False

    def _refuse(self, *_: object) -> None:
        raise XmlError("a message in XML has no document type and no entities of its own")

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        name = tag.rsplit(":", 1)[-1]
        self._open.append(name)
        if len(self._open) > DEEPEST:
            raise XmlError(f"line {self.parser.CurrentLineNumber}: elements lie within each other without end")
        self._leaf, self._words, self._attributes = True, [], attributes
        self._line = self.parser.CurrentLineNumber
        if name.upper() in KINDS and name.islower():
            self.messages.append(Message(name.upper(), []))
            self._emit(f"CCSDS_{name.upper()}_VERS = {_plain(attributes.get('version', ''))}")
            self._leaf = self._scalar_first = False
        elif name == "metadata":
            self._emit("META_START")
        elif name == "data" and self._kind == "AEM":
            self._emit("DATA_START")
        elif name == "covarianceMatrix" and self._kind == "OEM":
            self._emit("COVARIANCE_START")
        elif ROWS.get(name) == self._kind:
            self._row, self._row_line = {}, self._line

    def _said(self, text: str) -> None:
        self._words.append(text)

    def _end(self, tag: str) -> None:
        name = self._open.pop()
        if self._leaf and self.messages and not name[:1].islower():  # an empty section is none of the keywords
            self._leaf_ends(name, _plain("".join(self._words)))
        elif name == "metadata":
            self._emit("META_STOP")
        elif name == "data" and self._kind == "AEM":
            self._emit("DATA_STOP")
        elif name == "covarianceMatrix" and self._kind == "OEM":
            self._emit("COVARIANCE_STOP")
        elif ROWS.get(name) == self._kind and self._row is not None:
            self._row_ends()
        self._leaf, self._words = False, []

    def _leaf_ends(self, name: str, value: str) -> None:
        unit = _plain(self._attributes.get("units", ""))
        if name == "COMMENT" or ("covarianceMatrix" in self._open and self._kind == "OEM"):
            return
        if self._row is not None:
            self._check_unit(name, unit)
            if name in self._row:
                raise XmlError(f"line {self._line}: {name} is there twice")
            self._row[name] = value
            return
        if name == "USER_DEFINED":
            name = f"USER_DEFINED_{_plain(self._attributes.get('parameter', ''))}"
        if name == "QUATERNION_TYPE":
            self._scalar_first = value.upper() == "FIRST"
        self._emit(f"{name} = {value}" + (f" [{unit}]" if unit else ""), self._line)

    def _check_unit(self, name: str, unit: str) -> None:
        wanted = (STATE | PUSH).get(name, "deg/s" if name.startswith("ANGVEL_") else "")
        if unit and unit.lower().replace(" ", "") != wanted:
            due = f"[{wanted}] is due" if wanted else "it has none"
            raise XmlError(f"line {self._line}: {name} is in [{unit}], and {due}")

    def _row_ends(self) -> None:
        """The row as one line, its numbers in the order of the keyword form."""
        assert self._row is not None
        row, self._row = self._row, None
        if self._kind == "OEM":
            keys = ["EPOCH", *STATE, *(PUSH if any(key in row for key in PUSH) else ())]
        elif any(key in row for key in QUATERNION):
            order = ("QC", "Q1", "Q2", "Q3") if self._scalar_first else QUATERNION
            keys = ["EPOCH", *order, *(key for key in row if key != "EPOCH" and key not in QUATERNION)]
        else:
            keys = ["EPOCH", *(key for key in row if key != "EPOCH")]
        lacking = [key for key in keys if not row.get(key)]
        if lacking:
            raise XmlError(f"line {self._row_line}: of this row {', '.join(lacking)} is lacking")
        self._emit(" ".join(row[key] for key in keys), self._row_line)

    @property
    def _kind(self) -> str:
        return self.messages[-1].kind if self.messages else ""

    def _emit(self, text: str, line: int | None = None) -> None:
        if self.messages:
            self.messages[-1].lines.append((self.parser.CurrentLineNumber if line is None else line, text))


def _plain(text: str) -> str:
    """On one line, without what would end it."""
    return " ".join(text.split())
