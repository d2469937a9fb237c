"""Physical and astronomical constants, each once, with its source. SI."""

AU = 149_597_870_700.0  # m, exact: IAU 2012 Resolution B2
DAY = 86_400.0  # s
YEAR = 365.25 * DAY  # s, Julian year (IAU)

MU_SUN = 1.327_124_400_18e20  # m3/s2, heliocentric gravitational constant, JPL DE405
MU_EARTH = 3.986_004_418e14  # m3/s2, WGS 84 / IERS 2010
RADIUS_SUN = 695_700e3  # m, nominal solar radius: IAU 2015 Resolution B3
RADIUS_EARTH = 6_378_137.0  # m, equatorial: WGS 84
FLATTENING_EARTH = 1 / 298.257_223_563  # WGS 84
J2_EARTH = 1.082_626_68e-3  # unnormalised second zonal harmonic: EGM96
J3_EARTH = -2.532_656_49e-6  # third: EGM96
J4_EARTH = -1.619_621_59e-6  # fourth: EGM96
DIPOLE_EARTH = (-1410.3e-9, 4545.5e-9, -29350.0e-9)  # T, g11, h11, g10 of the field's dipole in 2025: IGRF-14
RADIUS_GEOMAGNETIC = 6_371_200.0  # m, reference radius of IGRF
ROTATION_EARTH = 7.292_115_9e-5  # rad/s, sidereal: IERS 2010, to the digits used here

STANDARD_GRAVITY = 9.806_65  # m/s2, exact: CGPM 1901, the g0 of specific impulse
ELEMENTARY_CHARGE = 1.602_176_634e-19  # C, exact: SI 2019
BOLTZMANN = 1.380_649e-23  # J/K, exact: SI 2019
VACUUM_PERMITTIVITY = 8.854_187_8128e-12  # F/m: CODATA 2018
ATOMIC_MASS = 1.660_539_066_60e-27  # kg: CODATA 2018
MASS_ELECTRON = 9.109_383_7015e-31  # kg: CODATA 2018
MASS_PROTON = 1.672_621_923_69e-27  # kg: CODATA 2018

RADIATION_PRESSURE = 4.563e-6  # N/m2 at 1 au: thesis, section 3.1; 0.5 % above the 1361 W/m2 of today over c
SPEED_OF_LIGHT = 299_792_458.0  # m/s: the definition of the metre
GRAVITY_AT_1_AU = MU_SUN / AU**2  # m/s2, the Sun's pull at 1 au, 5.930083519e-3
WIND_POTENTIAL = 1_000.0  # V, potential of the solar-wind ions: thesis, (3.41)
WIND_PRESSURE = 2.0e-9  # Pa, mean solar-wind dynamic pressure at 1 au: thesis, (3.41)
STEFAN_BOLTZMANN = 5.670_374_419e-8  # W/m2/K4: CODATA 2018, exact to its digits
SOLAR_IRRADIANCE = 1_360.96  # W/m2, mean of the PMOD/WRC composite 1980-2023 at 1 au
