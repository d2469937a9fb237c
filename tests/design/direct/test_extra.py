"""Without casadi the direct method says what it needs."""

from __future__ import annotations

import sys

import pytest

from sailviz.design.direct.extra import NoCasadiError, casadi


def test_missing_extra_is_told_in_a_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "casadi", None)
    with pytest.raises(NoCasadiError, match=r"^the direct method needs casadi: pip install 'sailviz\[direct\]'$"):
        casadi()
