"""Fastest flights by the direct method: collocation and IPOPT, with limits on the way; needs the extra `direct`."""

from typing import TYPE_CHECKING

from sailviz.lazy import lazily

if TYPE_CHECKING:
    from sailviz.design.direct.costate_fit import Fit as Fit
    from sailviz.design.direct.costate_fit import fit as fit
    from sailviz.design.direct.extra import NoCasadiError as NoCasadiError
    from sailviz.design.direct.extra import there_is_casadi as there_is_casadi
    from sailviz.design.direct.limits import Limits as Limits
    from sailviz.design.direct.polish import polished as polished
    from sailviz.design.direct.polish import structure_of as structure_of
    from sailviz.design.direct.search import DirectFlight as DirectFlight
    from sailviz.design.direct.search import fastest as fastest
    from sailviz.design.direct.search import sail_of as sail_of
    from sailviz.design.direct.transcription import Arc as Arc
    from sailviz.design.direct.transcription import Question as Question

_HOMES = {
    "Arc": "transcription",
    "DirectFlight": "search",
    "Fit": "costate_fit",
    "Limits": "limits",
    "NoCasadiError": "extra",
    "Question": "transcription",
    "fastest": "search",
    "fit": "costate_fit",
    "polished": "polish",
    "sail_of": "search",
    "structure_of": "polish",
    "there_is_casadi": "extra",
}
__getattr__, __dir__, __all__ = lazily(__name__, _HOMES)
