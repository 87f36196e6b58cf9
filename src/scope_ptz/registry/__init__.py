"""The registry of planner and perception models, with their requirements and the commands for serving them.

The data is in ``data/models.yaml``.
"""

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
