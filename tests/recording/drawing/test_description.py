"""Numbers in the words beside the picture."""

from sailviz.recording.drawing.description import spread


def test_numbers_of_the_scoreboard_are_as_exact_as_their_spread():
    assert spread(-76.4172, 35.57) == "−76 ± 36"
    assert spread(0.22, 0.2416) == "+0.22 ± 0.24"
    assert spread(2.3e-5, 0.0404) == "+0.000 ± 0.040"
