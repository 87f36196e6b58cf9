"""Which models can plan and which can see, what they need, and how each server is started. Data, not code: ``data/models.yaml``."""

from scope_ptz.registry.entries import Model, Pair, Precision, Role, Server, Serving, Thinking
from scope_ptz.registry.load import Registry, load_registry

__all__ = [
    "Model",
    "Pair",
    "Precision",
    "Registry",
    "Role",
    "Server",
    "Serving",
    "Thinking",
    "load_registry",
]
