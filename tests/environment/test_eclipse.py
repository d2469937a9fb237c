"""Shadows of the Earth: edges, penumbra, and the share of an orbit that lies in the dark."""

from __future__ import annotations

import numpy as np
import pytest

from sailviz.constants import AU, RADIUS_EARTH, RADIUS_SUN
from sailviz.environment.eclipse import SHADOWS, circular_fraction, conical, cylindrical, sunlit
from sailviz.environment.shadow import lit_share

SUN = np.array([0.6, 0.48, 0.64])  # of length one
ACROSS = np.array([0.8, -0.36, -0.48])  # and square to it


def light(shadow, behind, off, radius=RADIUS_EARTH):
    return shadow.py_func(*(-behind * SUN + off * ACROSS), *SUN, radius)


# pure geometry: arcsin(R / r) / pi
@pytest.mark.parametrize(("altitude", "expected"), [(700e3, 0.35724), (500e3, 0.37788)])
def test_share_of_the_orbit_in_the_shadow_when_the_sun_is_in_its_plane(altitude, expected):
    assert circular_fraction(RADIUS_EARTH + altitude, RADIUS_EARTH) == pytest.approx(expected, abs=5e-6)


@pytest.mark.parametrize("beta", [0.0, 0.3, -0.9, 1.1, 1.12, np.pi / 2])
def test_closed_form_and_shadow_test_agree_around_an_orbit(beta):
    r = RADIUS_EARTH + 700e3
    angle = np.linspace(0, 2 * np.pi, 40_001)[:-1]
    places = r * np.array([np.cos(angle), np.sin(angle), np.zeros_like(angle)])
    sun = np.array([np.cos(beta), 0, np.sin(beta)])
    dark = np.mean([cylindrical.py_func(*place, *sun, RADIUS_EARTH) == 0 for place in places.T])
    assert dark == pytest.approx(circular_fraction(r, RADIUS_EARTH, beta), abs=1e-4)  # steps of the angle


def test_cylinder_is_dark_behind_the_earth_and_nowhere_else():
    assert light(cylindrical, 1e7, 0.999 * RADIUS_EARTH) == 0
    assert light(cylindrical, 1e7, 1.001 * RADIUS_EARTH) == 1
    assert light(cylindrical, -1e7, 0.0) == 1


@pytest.mark.parametrize("behind", [3e6, 7e6, 4.2e7, 4e8])
def test_penumbra_lies_between_the_cones_that_touch_sun_and_earth(behind):
    """Tangent lines: the share leaves 0 and reaches 1 exactly there, without a jump, and grows in between."""
    inner = (RADIUS_EARTH - behind * (RADIUS_SUN - RADIUS_EARTH) / AU) / np.cos(np.arcsin((RADIUS_SUN - 6.4e6) / AU))
    outer = (RADIUS_EARTH + behind * (RADIUS_SUN + RADIUS_EARTH) / AU) / np.cos(np.arcsin((RADIUS_SUN + 6.4e6) / AU))
    width = outer - inner
    assert light(conical, behind, inner - 1e-3 * width) == 0
    assert light(conical, behind, outer + 1e-3 * width) == 1
    shares = [light(conical, behind, inner + f * width) for f in np.linspace(2e-3, 1 - 2e-3, 60)]
    assert np.all(np.diff(shares) > 0)
    assert 0 < shares[0] < 5e-4
    assert 1 - 5e-4 < shares[-1] < 1


def test_half_of_the_disc_shows_where_the_suns_centre_touches_the_limb():
    """The limb is nearly straight against the Sun's disc: 0.27 against 64 degrees of radius."""
    r = RADIUS_EARTH + 700e3
    angle = np.arcsin(RADIUS_EARTH / r)
    angle += r * np.sin(angle) / AU  # the craft sees the Sun from beside the Earth, 9 arcsec off
    place = r * (-np.cos(angle) * SUN + np.sin(angle) * ACROSS)
    assert conical.py_func(*place, *SUN, RADIUS_EARTH) == pytest.approx(0.5, abs=0.001)


def test_beyond_the_umbras_tip_the_earth_leaves_a_ring_of_sun():
    """Areas of the discs: 1 - (b / a)^2 on the axis, 1.1 million km behind a sphere 6400 km in radius."""
    behind = 2e9
    a, b = np.arcsin(RADIUS_SUN / (AU + behind)), np.arcsin(RADIUS_EARTH / behind)
    assert light(conical, behind, 0.0) == pytest.approx(1 - (b / a) ** 2, rel=1e-9)


EARTH, MOON = RADIUS_EARTH, 1737.4e3
OFF = np.radians(8.7)  # as seen from the Earth, at the edge of its shadow


@pytest.mark.parametrize(
    ("radius", "x", "y", "share"),
    [
        (EARTH, -3100, 6385, 0.7857427),
        (EARTH, -42164 * np.cos(OFF), 42164 * np.sin(OFF), 0.4961783),
        (EARTH, -1_500_000, 5000, 0.5047279),
        (MOON, -384_400, 1500, 0.5365585),
        (MOON, -384_400, 0, 0.0505577),
    ],
)
@pytest.mark.parametrize("turn", [0.0, 1.9])
def test_lit_shares_of_low_and_far_places_are_those_of_a_quadrature(radius, x, y, share, turn):
    """The light at 1 au from the body; places in km. The rows agree with a quadrature of the disc to 4e-8 or better."""
    c, s = np.cos(turn), np.sin(turn)
    place = 1e3 * (c * x - s * y), 1e3 * (s * x + c * y), 0.0
    found = lit_share.py_func(*place, AU * c, AU * s, 0.0, radius, RADIUS_SUN)
    assert found == pytest.approx(share, abs=9e-8)


def test_the_sunny_side_is_lit_and_kinds_are_chosen_by_number():
    assert light(conical, -1e7, 0.0) == 1
    place = -1e7 * SUN
    shares = [sunlit.py_func(SHADOWS[kind], *place, *SUN, RADIUS_EARTH) for kind in ("none", "cylindrical", "conical")]
    assert shares == [1, 0, 0]
