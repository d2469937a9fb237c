"""Which fixed pitch brings an ideal sail to Venus' distance first? Sweep it, record the fastest flight.

Run it from anywhere: python sweep_pitch.py [fastest.rrd]
"""

import sys

import numpy as np

import sailviz
from sailviz.constants import DAY

scene = sailviz.load_scene("spirals/optical-sail").with_values(
    {
        "title": "Fastest fixed pitch to Venus' distance",
        "device.film": "ideal",
        "event": [{"kind": "radius", "name": "arrival", "radius_au": 0.723332, "stop": True}],
        "expect": [],
    }
)

flights = {}
for pitch in np.arange(20.0, 60.0, 2.5):
    run = sailviz.simulate(scene.with_values({"steering.pitch_deg": float(pitch)}))
    if run.ended == "arrival":
        flights[pitch] = run
        print(f"pitch {pitch:4.1f} deg   {run.time[-1] / DAY:6.1f} d   {len(run)} rows")

best = min(flights, key=lambda pitch: flights[pitch].time[-1])
file = sys.argv[1] if len(sys.argv) > 1 else "fastest.rrd"
sailviz.record(flights[best], file)
print(f"Fastest at {best:g} deg; recorded {file}")
