"""States between the frames in which others give them and GCRF, by ERFA (extra `frames`): the IAU 2006/2000A models.

EME2000 is GCRF turned by the frame bias (0.0231 arcsec); MOD and TOD are of date, with the bias; TEME is that of SGP4,
from the Earth's rotation with GMST82; all realisations of the ITRF, and WGS 84, differ by less than 0.1 m and count as
one. The ITRF needs the Earth's orientation: UT1-UTC and the pole, without which it would be 24 m off at 7000 km.
MOD and TOD of other software may mean the IAU 1976/1980 models: 1.0 m off at 7100 km. Sources: IERS Conventions (2010),
chapter 5; layout of finals2000A by the IERS.
"""

from __future__ import annotations

import re
from datetime import date
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailviz.calendar import DAY, LEAP_SECONDS, since_1970
from sailviz.frames import turn_x

if TYPE_CHECKING:
    from types import ModuleType

Floats = NDArray[np.float64]
Instants = NDArray[np.int64]  # ns of TAI since 1970-01-01

ROTATION = 7.292115146706979e-5  # rad/s, of the Earth: IERS Conventions (2010)
OBLIQUITY = np.radians(84381.448 / 3600)  # of ECLIPJ2000
ARCSECOND = np.pi / 180 / 3600
TT_AHEAD = 32_184_000_000  # ns of TAI
JD_1970 = 2_440_587.5
MJD_1970 = 40_587
FIXED, TURNING = ("GCRF", "EME2000", "ECLIPJ2000"), ("MOD", "TOD", "TEME", "ITRF")
SAME = {"J2000": "EME2000", "ICRF": "GCRF", "ICRF1": "GCRF", "ICRF2": "GCRF", "ICRF3": "GCRF", "WGS84": "ITRF"}
ROUND_THE_SUN = ("EME2000", "J2000", "ICRF", "GCRF", "ECLIPJ2000")
ORBIT_RELATIVE = ("RTN", "RSW", "RIC", "TNW", "NTW", "LVLH", "VVLH", "QSW", "VNC", "PQW", "SEZ")
MODEL = "IAU 2006/2000A models of ERFA"
COLUMNS = {"mjd": (7, 15), "xp": (18, 27), "yp": (37, 46), "ut1": (58, 68)}  # of finals2000A, from 0, ends open
LONGEST_FILE = 100_000_000  # bytes


class EarthOrientation(NamedTuple):
    """The Earth's orientation on days. instants (n,) ns of TAI of 0 h UTC; xp, yp (n,) rad; ut1_tai (n,) s."""

    instants: Instants
    xp: Floats
    yp: Floats
    ut1_tai: Floats

    def at(self, instants: Instants) -> tuple[Floats, Floats, Floats]:
        """(xp, yp rad, UT1-TAI s) at instants, linear between days. ValueError outside of the days there are."""
        if instants.min() < self.instants[0] or instants.max() > self.instants[-1]:
            first, last = (str(np.datetime64(int(edge), "ns"))[:10] for edge in self.instants[[0, -1]])
            raise ValueError(f"the Earth's orientation is known from {first} to {last}, and the flight lies outside")
        day = (instants - self.instants[0]) / DAY
        days = (self.instants - self.instants[0]) / DAY
        xp, yp, ut1 = (np.interp(day, days, values) for values in (self.xp, self.yp, self.ut1_tai))
        return xp, yp, ut1


def known_frame(word: str) -> str:
    """The frame that a message means: one of FIXED or TURNING. ValueError, by name, for any other."""
    name = re.sub(r"[\s_]", "", word.upper())
    name = SAME.get(name, name)
    if name in (*FIXED, *TURNING):
        return name
    if re.fullmatch(r"ITRF-?(\d{2}|\d{4})?", name) or re.fullmatch(r"WGS-?84", name):
        return "ITRF"
    if name in ORBIT_RELATIVE:
        raise ValueError(f"the frame {word} goes along with an orbit, and a state in it says nothing by itself")
    raise ValueError(f"the frame {word} is not known; known: {', '.join((*FIXED, *TURNING))}, and what they are called")


def read_orientation(path: str | Path) -> EarthOrientation:
    """The Earth's orientation from a file finals2000A of the IERS. ValueError, in one sentence, for what is none."""
    if not Path(path).is_file() or Path(path).stat().st_size > LONGEST_FILE:
        raise ValueError(f"{path} is no file of the Earth's orientation (finals2000A)")
    days, rows = [], []
    for line in Path(path).read_text(encoding="ascii", errors="replace").splitlines():
        words = [line[first:last].strip() for first, last in COLUMNS.values()]
        if not all(words):
            continue  # rows of the far future have no numbers yet
        try:
            mjd, *numbers = map(float, words)
        except ValueError:
            raise ValueError(f"{path} is no file of the Earth's orientation (finals2000A): {line[:40]!r}") from None
        days.append(round(mjd))
        rows.append(numbers)
    if len(days) < 2 or np.any(np.diff(days) <= 0) or not np.isfinite(rows).all():
        raise ValueError(f"{path} is no file of the Earth's orientation (finals2000A): days in order were due")
    utc = (np.array(days, np.int64) - MJD_1970) * DAY
    kept = utc >= _steps()[0]
    leap = _leap_seconds(utc[kept])
    xp, yp, ut1 = np.array(rows)[kept].T
    return EarthOrientation(utc[kept] + leap * 10**9, xp * ARCSECOND, yp * ARCSECOND, ut1 - leap)


def shipped_orientation() -> EarthOrientation | None:
    """The one of the package skyfield-data (extra `ephemeris`), None without it."""
    home = find_spec("skyfield_data")
    if home is None or home.origin is None:
        return None
    path = Path(home.origin).parent / "data" / "finals2000A.all"
    return read_orientation(path) if path.is_file() else None


def _steps() -> Instants:
    """ns of UTC labels (k,) from which on each number of leap seconds holds."""
    return np.array([since_1970(date(year, month, 1), 0) for year, month, _ in LEAP_SECONDS], np.int64)


def _leap_seconds(utc: Instants) -> Instants:
    """TAI - UTC (n,) s of labels of UTC (n,) ns."""
    step = np.searchsorted(_steps(), utc, side="right") - 1
    return np.array([offset for _, _, offset in LEAP_SECONDS], np.int64)[np.maximum(step, 0)]


def _utc_less_tai(instants: Instants) -> Floats:
    """UTC - TAI (n,) s at instants."""
    ahead = np.array([offset for _, _, offset in LEAP_SECONDS], np.int64)
    step = np.searchsorted(_steps() + ahead * 10**9, instants, side="right") - 1
    return -ahead[np.maximum(step, 0)].astype(float)


def _erfa() -> ModuleType:
    try:
        import erfa
    except ModuleNotFoundError:
        raise ModuleNotFoundError('frames of date need the extra "frames": pip install "sailviz[frames]"') from None
    found: ModuleType = erfa
    return found


def to_gcrf(
    frame: str, instants: Instants, position: Floats, velocity: Floats, orientation: EarthOrientation | None = None
) -> tuple[Floats, Floats]:
    """States (n, 3) m and m/s in GCRF of states in a frame, at instants (n,).

    orientation : the Earth's, needed for the ITRF. ValueError for a frame that is not known and for the ITRF without
    orientation; ModuleNotFoundError without the extra.
    """
    name, r, v = known_frame(frame), np.asarray(position, float), np.asarray(velocity, float)
    if name == "ITRF":
        pole, spun = _of_the_earth(np.asarray(instants, np.int64), orientation)
        place = _turned(pole, r, back=True)
        omega = np.array([0.0, 0.0, ROTATION])
        moved = _turned(pole, v, back=True) + np.cross(omega, place)
        return _turned(spun, place, back=True), _turned(spun, moved, back=True)
    turn = from_gcrf_matrix(name, instants)
    return _turned(turn, r, back=True), _turned(turn, v, back=True)


def from_gcrf_matrix(frame: str, instants: Instants) -> Floats:
    """R (n, 3, 3) that take vectors of GCRF to a frame at instants (n,); not of the ITRF, in which states turn too."""
    name, count = known_frame(frame), np.shape(instants)
    if name == "GCRF":
        return np.broadcast_to(np.eye(3), (*count, 3, 3))
    erfa, tt = _erfa(), _tt(np.asarray(instants, np.int64))
    if name in ("EME2000", "ECLIPJ2000"):
        bias = np.asarray(erfa.bp00(*tt)[0])
        return bias if name == "EME2000" else np.asarray(turn_x(OBLIQUITY)) @ bias
    if name == "MOD":
        return np.asarray(erfa.pmat06(*tt))
    if name == "TOD":
        return np.asarray(erfa.pnm06a(*tt))
    if name == "TEME":  # UT1 cancels but for 0.2 mm: UTC will do
        ut1 = _ut1(np.asarray(instants, np.int64), _utc_less_tai(np.asarray(instants, np.int64)))
        tirs = _about_z(erfa.era00(*ut1)) @ np.asarray(erfa.c2i06a(*tt))
        return np.swapaxes(_about_z(erfa.gmst82(*ut1)), -1, -2) @ tirs
    raise ValueError("states in the ITRF turn with the Earth: no one matrix takes them there")


def _of_the_earth(instants: Instants, orientation: EarthOrientation | None) -> tuple[Floats, Floats]:
    """R (n, 3, 3) from TIRS to ITRF, and from GCRF to TIRS."""
    erfa = _erfa()
    orientation = shipped_orientation() if orientation is None else orientation
    if orientation is None:
        raise ValueError(
            "the ITRF needs the Earth's orientation, a file finals2000A: it comes with the extra "
            '"ephemeris": pip install "sailviz[ephemeris]"'
        )
    tt = _tt(instants)
    xp, yp, ut1_tai = orientation.at(instants)
    spun = _about_z(erfa.era00(*_ut1(instants, ut1_tai))) @ np.asarray(erfa.c2i06a(*tt))
    return np.asarray(erfa.pom00(xp, yp, erfa.sp00(*tt))), spun


def _tt(instants: Instants) -> tuple[Floats, Floats]:
    """TT (n,) as days and fractions of a Julian date."""
    days, rest = np.divmod(instants + TT_AHEAD, DAY)
    return JD_1970 + days.astype(float), rest / DAY


def _ut1(instants: Instants, ut1_tai: Floats) -> tuple[Floats, Floats]:
    days, rest = np.divmod(instants, DAY)
    return JD_1970 + days.astype(float), (rest * 1e-9 + ut1_tai) / 86_400.0


def _about_z(angle: Floats) -> Floats:
    """R3 (n, 3, 3): what it turns keeps its place while the axes turn by an angle (n,)."""
    c, s = np.cos(angle), np.sin(angle)
    zero, one = np.zeros_like(c), np.ones_like(c)
    return np.stack([np.stack([c, s, zero], -1), np.stack([-s, c, zero], -1), np.stack([zero, zero, one], -1)], -2)


def _turned(turn: Floats, vectors: Floats, back: bool = False) -> Floats:
    """R v, or with back the transpose of R, times v; of each row where there are as many R."""
    found: Floats = np.einsum("...ji,...j->...i" if back else "...ij,...j->...i", turn, vectors)
    return found
