"""An orbit of one's own wish: what must the sail do to hold it, and does it?

Here the elevation sways between 7 and 9 degrees once in two revolutions. The design gives pitch, clock and voltage over
time; a scene with these as a steering table flies it. Run it from anywhere: python prescribed_track.py [track.rrd]
"""

import sys

import numpy as np

import sailviz
from sailviz.constants import AU, DAY, MU_SUN
from sailviz.design.displaced.tracks import track

radius, rate = 0.95 * AU, 0.8 * np.sqrt(MU_SUN / (0.95 * AU) ** 3)
time = np.linspace(0, 3 * 365.25 * DAY, 4000)
phase = 0.5 * rate * time
sway = np.radians(1)
elevation = (
    np.radians(8) + sway * np.sin(phase),
    0.5 * rate * sway * np.cos(phase),
    -((0.5 * rate) ** 2) * sway * np.sin(phase),
)
still = np.zeros_like(time)
wanted = track(time, (radius + still, still, still), elevation, (rate * time, rate + still, still), "electric-sail")
if not wanted.feasible.all():
    sys.exit(f"infeasible from day {time[np.argmin(wanted.feasible)] / DAY:.1f} on")

strength = wanted.characteristic_acceleration.max()
scene = sailviz.load_scene(
    {
        "title": "An orbit that nods once in two revolutions",
        "about": "A prescribed track: its design gives pitch, clock angle and voltage over time.",
        "family": "displaced",
        "start": {
            "kind": "cartesian",
            "position_m": wanted.position[0].tolist(),
            "velocity_m_s": wanted.velocity[0].tolist(),
        },
        "device": {"kind": "electric-sail", "characteristic_acceleration_m_s2": float(strength)},
        "steering": {
            "kind": "table",
            "interpolation": "cubic",
            "time_s": time.tolist(),
            "pitch_rad": wanted.pitch.tolist(),
            "clock_rad": np.unwrap(wanted.clock).tolist(),
            "throttle": wanted.throttle.tolist(),
        },
        "propagation": {"duration_yr": 3, "outputs": 4000, "tolerance": 1e-12},
    }
)
run = sailviz.simulate(scene)
miss = np.linalg.norm(run.position - wanted.position, axis=1)
print(f"a_c up to {strength * 1e3:.3f} mm/s2, pitch {np.degrees(wanted.pitch.min()):.1f}", end=" ")
print(f"to {np.degrees(wanted.pitch.max()):.1f} deg; after three years {miss[-1] / 1e3:.3g} km off the track")
file = sys.argv[1] if len(sys.argv) > 1 else "track.rrd"
sailviz.record(run, file)
print(f"Recorded {file}")
