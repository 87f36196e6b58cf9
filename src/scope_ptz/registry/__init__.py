"""Which models can plan and which can see, what they need, and how each server is started. Data, not code: ``data/models.yaml``."""

from scope_ptz.registry.load import Registry, load_registry
from scope_ptz.registry.model_entries import Model, Pair, Precision, Role, Server, Serving, Thinking

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
