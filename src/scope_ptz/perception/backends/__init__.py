"""Eyes that look at pixels, one file a backend.

A module in this package with a function ``make(spec: BackendSpec) -> Perception`` is a backend of the module's name. Other packages
add theirs as entry points of the group ``scope_ptz.perception``, each naming such a function. Nothing is imported before it is
made.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from importlib.metadata import entry_points
from pkgutil import iter_modules

from scope_ptz.errors import ConfigError, UnknownNameError
from scope_ptz.perception.backends.spec import BackendSpec
from scope_ptz.perception.base import Perception
from scope_ptz.perception.wide import WidePerception

ENTRY_POINTS = "scope_ptz.perception"
_NO_BACKENDS = {"spec"}

Maker = Callable[[BackendSpec], Perception]


def backend_names() -> tuple[str, ...]:
    """Every backend that can be made, built in or installed beside."""
    own = {m.name for m in iter_modules(__path__) if not m.name.startswith("_") and m.name not in _NO_BACKENDS}
    return tuple(sorted(own | {point.name for point in entry_points(group=ENTRY_POINTS)}))


def make_backend(spec: BackendSpec) -> Perception:
    """The perception that a spec describes. Raises ``UnknownNameError`` and ``ConfigError``."""
    name = spec.backend.replace("-", "_")
    if name not in backend_names():
        raise UnknownNameError("perception backend", spec.backend, backend_names())
    eyes = _maker(name)(spec)
    return eyes if eyes.sees_wide else WidePerception(eyes)


def _maker(name: str) -> Maker:
    for point in entry_points(group=ENTRY_POINTS, name=name):
        made: Maker = point.load()
        return made
    try:
        module = import_module(f"{__name__}.{name}")
    except ImportError as error:
        raise ConfigError(f"The perception backend '{name}' lacks a package: {error}.") from error
    maker: Maker = module.make
    return maker
