"""The built-in planner: a grammar for camera instructions and an interpreter. It needs no model.

``lexing`` splits text into lexemes, ``parsing`` builds the steps of ``instruction_tree`` from them, ``binding`` resolves the names
in the steps, and ``execution`` runs the steps against the history.

Names are imported on first use, so that ``understand`` can be used without loading the planner class.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from scope_ptz.planner.grammar.binding.understand import Understanding, understand
    from scope_ptz.planner.grammar.planner import GrammarPlanner, decide

__all__ = ["GrammarPlanner", "Understanding", "decide", "understand"]

_MODULE_OF = {
    "GrammarPlanner": "planner",
    "decide": "planner",
    "Understanding": "binding.understand",
    "understand": "binding.understand",
}


def __getattr__(name: str) -> Any:
    if name not in _MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULE_OF[name]}"), name)
