"""A router as a backend: its options name the eyes that it is made of."""

from __future__ import annotations

from scope_ptz.errors import ConfigError
from scope_ptz.perception.backends import make_backend
from scope_ptz.perception.backends.spec import BackendSpec, Options
from scope_ptz.perception.base import Perception
from scope_ptz.perception.models.routing import RouterPerception


class RouterOptions(Options):
    """``reader`` reads text, ``detector`` finds things, ``answerer`` answers questions; ``compare``: ask two where two can, and
    record how far they agree."""

    reader: BackendSpec | None = None
    detector: BackendSpec | None = None
    answerer: BackendSpec | None = None
    compare: bool = True


def make(spec: BackendSpec) -> Perception:
    options = RouterOptions.of(spec)
    reader, detector, answerer = (
        make_backend(part) if part else None for part in (options.reader, options.detector, options.answerer)
    )
    if reader is None and detector is None and answerer is None:
        raise ConfigError(f"The eyes '{spec.name}' are made of nothing. Name a reader, a detector or an answerer.")
    return RouterPerception(reader=reader, detector=detector, answerer=answerer, compare=options.compare, name=spec.name)
