"""What a deorbit is held to: the rules for the end of a mission in low orbit, and what a flight says of them.

Rules, as published: FCC, 47 CFR 25.283(e) and 97.207(g)(1)(vii)(D)(1), Federal Register 89, 65217 (9 August 2024):
re-entry as soon as practicable and within 5 years of the end of mission; ESA, ESSB-ST-U-007 (November 2023): within 5
years; ISO 24113 and the IADC guidelines, earlier practice: within 25 years.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sailviz.constants import RADIUS_EARTH, YEAR
from sailviz.run.arrays import Run
from sailviz.words import duration

DOWN = 200e3  # m over the equatorial radius: from there air ends every flight within days, whatever is deployed
LOW_ORBIT = 2_000e3  # m, to where the rules speak of low orbit
RULES = (
    ("5 years", 5 * YEAR, "FCC 47 CFR 25.283(e) (2024); ESA ESSB-ST-U-007 (2023)"),
    ("25 years", 25 * YEAR, "ISO 24113 and IADC guidelines, earlier practice"),
)
NOT_COVERED = (
    "Not computed: break-up and casualty risk on the ground, the risk of collision on the way down, failures of the "
    "deployment, outgassing and passivation.",
    "One flight says nothing of how likely it is: ESA and ISO 24113 ask for a success of 90 % and more, which is that "
    "of the device and of the craft as well; the failure case is the flight without the device.",
    "This is no certificate: authorities may ask for DAS, DRAMA or STELA, and for the standard ISO 27852 on lifetimes.",
)


@dataclass(frozen=True)
class Descent:
    """How a flight in low orbit ended. time : s flown; down : whether it ended below DOWN; altitude, lowest : m over
    the equatorial radius, at the end and at all; ended : by which event, "" where its time was over."""

    time: float
    down: bool
    altitude: float
    ended: str

    @property
    def words(self) -> str:
        """The sentence that answers."""
        if self.down:
            return f"It is down after {duration(self.time)} (the flight ends {self.altitude / 1e3:,.0f} km high)."
        why = f"it ends by its event {self.ended}" if self.ended else "its time is over"
        return f"It is not down: after {duration(self.time)} {why}, {self.altitude / 1e3:,.0f} km high."

    def verdict(self, limit: float) -> str:
        """Whether a limit, s, is kept."""
        if self.down:
            margin = duration(abs(limit - self.time))
            return f"kept, with {margin} to spare" if self.time <= limit else f"not kept, by {margin}"
        return "not kept" if self.time >= limit else f"open: only {duration(self.time)} were flown"


def descent_of(run: Run) -> Descent:
    """How a flight ended, from its rows: heights over the equatorial radius."""
    heights = np.linalg.norm(run.position[-1:], axis=1) - RADIUS_EARTH
    time = float(run.time[-1] - run.time[0])
    return Descent(time, bool(heights[-1] < DOWN), float(heights[-1]), run.ended)


def rule_rows(descent: Descent) -> tuple[tuple[str, str, str], ...]:
    """A row per rule: its limit, what this flight says of it, and where it is written."""
    return tuple((name, descent.verdict(limit), source) for name, limit, source in RULES)


def shares_within(values: np.ndarray, least: np.ndarray, limit: float) -> tuple[int, int, int]:
    """Of many flights: how many are known to be down within a limit, how many known not to be, how many open.

    values (n,) : time down, s, NaN where the flight was still up; least (n,) : s flown by those, NaN elsewhere.
    """
    kept = int(np.count_nonzero(values <= limit))
    late = int(np.count_nonzero(values > limit) + np.count_nonzero(np.isnan(values) & (least >= limit)))
    return kept, late, len(values) - kept - late
