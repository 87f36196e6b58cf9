"""The router backend, whose options contain the specs of the backends that it combines."""

from __future__ import annotations

from scope_ptz.errors import ConfigError
from scope_ptz.perception.backends import make_backend
from scope_ptz.perception.backends.spec import BackendSpec, Options
from scope_ptz.perception.base import Perception
from scope_ptz.perception.models.routing import RouterPerception


class RouterOptions(Options):
    """Options for the router.

    Attributes:
        reader: The backend that reads text.
        detector: The backend that locates objects.
        answerer: The backend that answers questions.
        compare: Whether to call two backends concurrently where possible and record how well their results agree.
    """

    reader: BackendSpec | None = None
    detector: BackendSpec | None = None
    answerer: BackendSpec | None = None
    compare: bool = True


def make(spec: BackendSpec) -> Perception:
    """Create the router that a spec describes."""
    options = RouterOptions.of(spec)
    reader, detector, answerer = (
        make_backend(part) if part else None for part in (options.reader, options.detector, options.answerer)
    )
    if reader is None and detector is None and answerer is None:
        raise ConfigError(f"The router '{spec.name}' combines no backends. Name a reader, a detector or an answerer.")
    return RouterPerception(reader=reader, detector=detector, answerer=answerer, compare=options.compare, name=spec.name)
