"""The parameter row of a Model: one flat float64 array, and who reads which place of it.

Tables stand behind the fixed places; where each begins is written in the row itself.
"""

from __future__ import annotations

MU, J2_STRENGTH, SURFACE_RADIUS, ROTATION = 0, 1, 2, 3  # mu is for gravity alone: gauss_jackson puts a 0 there
STEERING = 4  # three numbers of the steering law
DEVICE = 8  # up to five numbers of the device
PLASMA = (
    14  # profile; of an exponential: reference altitude m, value (N/m or 1/m3), scale height m, ion mass kg, radius m
)
USER_STEERING, USER_FORCE = 20, 21  # addresses of C functions, 0 for none; exact, since addresses stay below 2^53
INTERPOLATION, ROWS = 22, 23  # of the steering table, which begins at TABLE
THIRD_BODY = 24  # mu m3/s2 (0 for none), radius m, angular rate rad/s and initial azimuth rad of its circular orbit
AIR = 28  # kind (below), Cd A m2; of an exponential profile: reference radius m, density kg/m3, scale height m
ZONAL = 34  # strengths of J3 m6/s2 and J4 m7/s2
SUN = 36  # nine numbers of environment.sun
FLUX = 46  # four numbers of environment.solar_level
SHADOW = 50  # a kind of environment.eclipse
HEIGHT = 51  # altitude above the sphere (0) or the ellipsoid (1)
PLASMA_TABLE, AIR_TABLE = 52, 53  # where the tables begin in the row
BRAKE = 54  # ten numbers of the plasma brake, places below
STEER_AS = 64  # the sail for which a primer law steers: its kind, then up to four numbers as from DEVICE on
PRIMER_KIND = 69  # which law of steering.py makes the primer
LOW_ORBIT, PRIMER_LAW = 70, 71  # addresses of plugs, 0 for none: the forces of low_orbit.py, primer_laws.py
CONTROL, CONTROL_TABLE, CONTROL_LAW = 72, 73, 74  # plug of the voltage control, and where its table and law begin
PRIMER_MU = 75  # m3/s2, for the laws that know the orbit
TABLE = 80

NO_AIR, EXPONENTIAL_AIR, TABLED_AIR = range(3)

# Of the brake, from DEVICE on: length m, |V0| V, effective wire radius m, polarity (0 negative, 1 positive), attitude
LENGTH, VOLTAGE, WIRE_RADIUS, POLARITY, ATTITUDE = range(DEVICE, DEVICE + 5)
VERTICAL, TILTED, SPINNING = range(3)  # attitudes
# and from BRAKE on
WIRE_DIAMETER = BRAKE  # m, of all wires together
EFFICIENCY = BRAKE + 1  # of the high-voltage supply
POWER, ECLIPSE_POWER = BRAKE + 2, BRAKE + 3  # W, available in sunlight and in the shadow, inf for no limit
TIP = BRAKE + 4  # kg, mass at the tip and a third of the tether's
SPIN_FACTOR = BRAKE + 5  # mean force of a spinning tether over that of one across the flow
MAGNETIC = BRAKE + 6  # share of the force that is lost where the tether lies along the magnetic field
DENSITY_FACTOR = BRAKE + 7  # by which the plasma is denser than its model
EARTH_ANGLE = BRAKE + 8  # rad, rotation angle of the Earth at the start
PLASMA_ON = BRAKE + 9  # 1 where there is a brake
