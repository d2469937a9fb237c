"""What a judge found of a GTOC13 solution, as lines to read."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sailviz.checks.gtoc13 import rules
from sailviz.checks.gtoc13.judgement import Judgement
from sailviz.checks.gtoc13.rules import Finding
from sailviz.checks.gtoc13.score import Flyby, Wheel, wheels
from sailviz.constants import YEAR
from sailviz.exchange.gtoc13 import CONIC, FLYBY, SAIL

MOST_TOLD = 20  # findings in a table; --json has all


def in_words(found: Judgement) -> str:
    """The verdict, the score, the flybys, and whatever breaks a rule."""
    given = found.solution
    conics, sails, flybys = (sum(arc.kind == kind for arc in given.arcs) for kind in (CONIC, SAIL, FLYBY))
    years = given.time[[0, -1]] / YEAR
    count = len(found.violations)
    verdict = "no violation" if not count else "1 violation" if count == 1 else f"{count:,} violations"
    lines = [
        f"{given.name}: {verdict}, J/c = {found.score:.9f}" + (f" (bonus {found.bonus:g})" if found.bonus > 1 else ""),
        f"{len(given.time):,} rows: {_count(conics, 'conic')}, {_count(sails, 'sail arc')}, "
        f"{_count(flybys, 'flyby')}; year {years[0]:.3f} to {years[1]:.3f}",
    ]
    if found.flybys:
        lines += ["", *_table(("row", "year", "body", "v_inf, km/s", "altitude, radii", "F", "S", "weight", "points"),
                              [_flyby_row(flyby) for flyby in found.flybys])]  # fmt: skip
    wheel = wheels(found.flybys)
    if wheel:
        lines += ["", "Flybys that count, by 30° of longitude about the star",
                  *_table(("body", "flybys", "wheel", "points"), [_wheel_row(each) for each in wheel])]  # fmt: skip
    if found.approaches:
        nearest = min(found.approaches, key=lambda each: each.distance)
        lines += ["", f"Nearest to the star: {nearest.distance / rules.AU:.4f} au in year {nearest.time / YEAR:.3f}"]
    if found.violations:
        lines += ["", "Violations", *_findings(found.violations)]
    if found.notes:
        lines += ["", "Notes", *_findings(found.notes)]
    return "\n".join(lines)


def _count(number: int, what: str) -> str:
    return f"{number:,} {what}" + ("" if number == 1 else "s")


def _flyby_row(flyby: Flyby) -> tuple[str, ...]:
    radii = flyby.altitude / flyby.body.radius if flyby.body.radius else np.nan
    name = f"{flyby.body.number} {flyby.body.name}".strip()
    counted = (f"{flyby.quality:.6f}", f"{flyby.season:.6f}") if flyby.counts else ("-", "-")
    return (
        str(flyby.row + 1), f"{flyby.time / YEAR:.3f}", name, f"{flyby.v_inf / 1e3:.4f}",
        f"{radii:.3f}" if np.isfinite(radii) else "-", *counted, f"{flyby.body.weight:g}", f"{flyby.points:.6f}",
    )  # fmt: skip


def _wheel_row(wheel: Wheel) -> tuple[str, ...]:
    name = f"{wheel.body.number} {wheel.body.name}".strip()
    return name, str(wheel.flybys), wheel.words, f"{wheel.points:.6f}"


def _findings(findings: Sequence[Finding]) -> list[str]:
    rows = [(str(each.row), str(each.line), each.name, _sized(each.size, each.unit), _allowed(each), each.words)
            for each in findings[:MOST_TOLD]]  # fmt: skip
    lines = _table(("row", "line", "rule", "found", "limit", ""), rows, left=(2, 5))
    if len(findings) > MOST_TOLD:
        lines.append(f"and {len(findings) - MOST_TOLD:,} more, all of them with --json")
    return lines


def _sized(size: float, unit: str) -> str:
    return (f"{size:.6g} {unit}".rstrip()) if np.isfinite(size) else "not finite"


def _allowed(finding: Finding) -> str:
    return "" if finding.limit is None else _sized(finding.limit, finding.unit)


def _table(heads: tuple[str, ...], rows: Sequence[tuple[str, ...]], left: tuple[int, ...] = (2,)) -> list[str]:
    widths = [max(len(row[i]) for row in [heads, *rows]) for i in range(len(heads))]
    return [
        "  ".join(cell.ljust(width) if i in left else cell.rjust(width)
                  for i, (cell, width) in enumerate(zip(row, widths, strict=True))).rstrip()
        for row in [heads, *rows]
    ]  # fmt: skip
