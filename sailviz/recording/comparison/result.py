"""What a comparison found, for scripts and in words."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from sailviz.recording.comparison.differences import Difference
from sailviz.words import duration

SHOWN = 8  # columns of the picture that are listed


@dataclass(frozen=True)
class Comparison:
    """The result of `compare`. `quantities` holds every quantity compared, `faults` whatever else differs, in words,
    `notes` what the reader should know, `picture` those columns of the picture that differ.
    """

    a: str
    b: str
    quantities: tuple[Difference, ...]
    faults: tuple[str, ...]
    notes: tuple[str, ...]
    picture: tuple[Difference, ...] = ()
    picture_columns: int = 0  # how many were compared

    @property
    def equal(self) -> bool:
        """Whether nothing differs by more than is allowed."""
        return not self.faults and not self.picture and all(d.equal for d in self.quantities)

    @property
    def different(self) -> tuple[Difference, ...]:
        """The quantities that differ by more than is allowed."""
        return tuple(d for d in self.quantities if not d.equal)

    def __getitem__(self, quantity: str) -> Difference:
        """The difference of one quantity: comparison["/state:position_m"]."""
        for found in (*self.quantities, *self.picture):
            if found.quantity == quantity:
                return found
        raise KeyError(f"{quantity} was not compared; {', '.join(d.quantity for d in self.quantities)} were")

    def table(self) -> str:
        """Every quantity on a line of its own, the worst place of each, aligned."""
        rows: list[tuple[str, ...]] = [("", "quantity", "largest difference", "allowed", "where", "when", "A", "B")]
        rows += [line_of(d) for d in (*self.quantities, *self.picture[:SHOWN])]
        widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
        right = {2, 3}
        return "\n".join(
            "  ".join(
                c.rjust(w) if i in right else c.ljust(w) for i, (c, w) in enumerate(zip(row, widths, strict=True))
            ).rstrip()
            for row in rows
        )

    def verdict(self) -> str:
        """One sentence."""
        if self.equal:
            picture = f", {self.picture_columns} columns of the picture" if self.picture_columns else ""
            return f"Equal: {len(self.quantities)} quantities{picture}."
        parts = []
        if self.different:
            parts.append(f"{len(self.different)} of {len(self.quantities)} quantities")
        if self.picture:
            parts.append(f"{len(self.picture)} of {self.picture_columns} columns of the picture")
        if self.faults:
            parts.append("1 other thing" if len(self.faults) == 1 else f"{len(self.faults)} other things")
        return f"Different: {', '.join(parts)}."

    def __str__(self) -> str:
        lines = [f"A  {self.a}", f"B  {self.b}", *(f"note: {note}" for note in self.notes)]
        lines += [self.table(), *(f"DIFFERENT  {fault}" for fault in self.faults), self.verdict()]
        return "\n".join(lines)

    def to_dict(self) -> dict[str, Any]:
        """Everything, ready for JSON: NaN and infinity become null and "inf"."""

        def told(difference: Difference) -> dict[str, Any]:
            return {key: json_number(value) for key, value in asdict(difference).items()} | {"equal": difference.equal}

        return {
            "equal": self.equal,
            "a": self.a,
            "b": self.b,
            "quantities": [told(d) for d in self.quantities],
            "picture": {"columns": self.picture_columns, "different": [told(d) for d in self.picture]},
            "faults": list(self.faults),
            "notes": list(self.notes),
        }


def json_number(value: Any) -> Any:
    """NaN and infinity, for which JSON has no word, as null and "inf"."""
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else str(value)
    return value


def line_of(d: Difference) -> tuple[str, ...]:
    """One line of the table."""

    def number(value: float | str, digits: int = 3) -> str:
        if isinstance(value, str):
            return value if len(value) < 30 else value[:27] + "..."
        return f"{value:.{digits}g}" if isinstance(value, float) else str(value)

    mark = "ok" if d.equal else "DIFFERENT"
    unit = f" {d.unit}" if d.unit else ""
    if d.row < 0 and d.largest == 0:
        return mark, d.quantity, f"0{unit}", f"{d.allowed:.2g}{unit}", "", "", "", ""
    where = (f"row {d.row}" + (f", {d.component}" if d.component else "")) if d.row >= 0 else ""
    digits = 3
    if isinstance(d.a, float) and d.a and math.isfinite(d.largest) and d.largest:
        digits = min(17, max(3, math.ceil(math.log10(max(abs(d.a), 1e-300) / d.largest)) + 2))
    largest = "not a number" if d.largest == math.inf and d.values else number(d.largest) + unit
    if isinstance(d.a, str | bool):
        largest = "differs"
    when = duration(d.time) if math.isfinite(d.time) else ""
    values = ("", "") if d.equal else (number(d.a, digits), number(d.b, digits))
    return mark, d.quantity, largest, f"{d.allowed:.2g}{unit}", where, when, *values
