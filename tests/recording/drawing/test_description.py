"""The words beside the picture: their numbers, and the room that they take."""

from sailviz.recording.drawing import blueprint
from sailviz.recording.drawing.cameras import Camera
from sailviz.recording.drawing.description import lines_of, spread
from sailviz.recording.drawing.layout import Layout, Space


def test_numbers_of_the_scoreboard_are_as_exact_as_their_spread():
    assert spread(-76.4172, 35.57) == "−76 ± 36"
    assert spread(0.22, 0.2416) == "+0.22 ± 0.24"
    assert spread(2.3e-5, 0.0404) == "+0.000 ± 0.040"


def test_the_panel_of_the_words_grows_with_their_lines_and_no_further_than_the_flight_allows():
    def share(lines):
        text = "\n".join(["A paragraph of one line.", "", *("- a hint" for _ in range(lines - 1))])
        space = Space(Camera("Flight", "/world", (1.0, 0.0, 0.0)), ("+ /world/**",))
        return blueprint.left(Layout("t", [space], space, words=lines_of(text))).row_shares[1]

    assert [share(n) for n in (2, 5, 7)] == [184, 184, 184]
    assert 184 < share(8) < share(9) <= share(20) == 214


def test_a_line_of_the_panel_wraps_where_it_is_full():
    assert lines_of("word " * 31) == 1
    assert lines_of("word " * 32) == 2
    assert lines_of("**one**\n\n- two\n- three") == 3.6
