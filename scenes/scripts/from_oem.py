"""Draw a trajectory from another program: read an orbit ephemeris message and record it.

Run it from anywhere: python from_oem.py [trajectory.oem [recording.rrd]]
The file beside this script was made by: sailviz export displaced.rrd --to oem
"""

import sys
from pathlib import Path

import sailviz
from sailviz.constants import MU_EARTH, MU_SUN
from sailviz.errors import RecordingError
from sailviz.run.oem import read_oem

MU = {"SUN": MU_SUN, "EARTH": MU_EARTH}

source = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).with_name("displaced.oem")
target = sys.argv[2] if len(sys.argv) > 2 else f"{source.stem}.rrd"


def refuse(sentence):
    print(sentence, file=sys.stderr)
    sys.exit(2)


try:
    flight = read_oem(source)
    if flight.center not in MU:
        refuse(f"{source}: sailviz knows no gravitational parameter for {flight.center.title()}")
    # sailviz draws what circles the Sun over the ecliptic of J2000, what circles the Earth over the equator of its date
    flight = flight.in_ecliptic() if flight.center == "SUN" else flight.in_equator_of_date()
    recorded = sailviz.record_trajectory(
        flight.time,
        flight.position,
        flight.velocity,
        target,
        mu=MU[flight.center],
        epoch=flight.utc,
        gaps=flight.without_data,
        title=flight.name.capitalize(),
        about=" ".join([f"Read from **{source.name}**.", *(f"{note[0].upper()}{note[1:]}." for note in flight.notes)]),
    )
except RecordingError as error:
    refuse(error)
for note in (*flight.notes, *recorded.remarks):
    print(note)
print(f"{flight.name}: {recorded.rows} rows round the {flight.center.title()}; recorded {target}")
