"""How far does the time to Venus' distance scatter when pitch and mass are not quite what was asked for?

Run it from anywhere: python sweep_pitch.py [venus.parquet]
"""

import sys

import sailviz

if __name__ == "__main__":  # the flights go to processes, which read this file too
    found = sailviz.sweep(
        "spirals/optical-sail",
        {"steering.pitch_deg": "normal(35, 0.5)", "device.mass_kg": "normal(250, 2)"},
        draws=200,
        values={
            "event": [{"kind": "radius", "name": "arrival", "radius_au": 0.723332, "stop": True}],
            "expect": [],
        },
        report=["time_d@arrival"],
        record=["median:time_d@arrival"],
        path=sys.argv[1] if len(sys.argv) > 1 else "venus.parquet",
    )
    days = found.table["time_d@arrival"]
    print(f"{days.mean():.1f} d on average, standard deviation {days.std(ddof=1):.1f} d, {found.failed} failed")
    for number, file in found.recordings.items():
        print(f"Recorded flight {number}, the median: {file}")
