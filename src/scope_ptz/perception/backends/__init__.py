"""Perception backends that process pixels, one module each.

Every module in this package that defines ``make(spec: BackendSpec) -> Perception`` is a backend with the module's name. Other
packages add backends with entry points in the group ``scope_ptz.perception`` that refer to such a function. A backend's module is
imported only when the backend is created.
"""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules

from scope_ptz.entry_points import PERCEPTION, call_factory, find, installed, normalised
from scope_ptz.errors import ConfigError, UnknownNameError
from scope_ptz.perception.backends.spec import BackendSpec
from scope_ptz.perception.base import Perception
from scope_ptz.perception.models.tiled_panoramas import TiledPerception

_NOT_BACKENDS = {"spec"}  # modules in this package that define no backend


def backend_names() -> tuple[str, ...]:
    """Return the names of all available backends: the built-in ones and those from installed packages."""
    return tuple(sorted(built_in_backends() | {entry.name for entry in installed(PERCEPTION)}))


def built_in_backends() -> set[str]:
    """Return the names of the backends in this package."""
    return {m.name for m in iter_modules(__path__) if not m.name.startswith("_") and m.name not in _NOT_BACKENDS}


def make_backend(spec: BackendSpec) -> Perception:
    """Create the backend that a spec describes. A built-in backend takes precedence over a plug-in with the same name.

    Raises:
        UnknownNameError: There is no such backend.
        ConfigError: An option is invalid, or a package is missing or broken.
    """
    name = normalised(spec.backend)
    if name in built_in_backends():
        perception = _make_built_in(name, spec)
    elif (entry := find(PERCEPTION, name)) is not None:
        perception = call_factory(entry, Perception, spec)  # type: ignore[type-abstract]
    else:
        raise UnknownNameError("perception backend", spec.backend, backend_names())
    return perception if perception.handles_panoramas else TiledPerception(perception)


def _make_built_in(name: str, spec: BackendSpec) -> Perception:
    try:
        module = import_module(f"{__name__}.{name}")
    except ImportError as error:
        raise ConfigError(f"The perception backend '{name}' cannot be imported: {error}. Install the missing package.") from error
    backend: Perception = module.make(spec)
    return backend
