"""casadi, which carries IPOPT: loaded where a problem is solved, since it is an extra of 277 MB."""

from __future__ import annotations

from types import ModuleType

from sailviz.errors import SailvizError

NEEDS_EXTRA = "the direct method needs casadi: pip install 'sailviz[direct]'"


class NoCasadiError(SailvizError):
    """The direct method was asked for where its extra is not installed."""


def casadi() -> ModuleType:
    """The module. NoCasadiError, which says what to install, without it."""
    try:
        import casadi as found
    except ImportError:
        raise NoCasadiError(NEEDS_EXTRA) from None
    return found


def there_is_casadi() -> bool:
    """Whether the extra is installed, without loading it."""
    from importlib.util import find_spec

    return find_spec("casadi") is not None
