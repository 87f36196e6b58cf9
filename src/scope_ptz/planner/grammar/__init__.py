"""The built-in planner: a grammar for camera instructions and an interpreter. It needs no model.

``lexing`` splits text into words with their classes, ``parsing`` reads clauses and builds the steps of ``instruction_tree``,
``binding`` resolves the names in the steps, ``consistency`` compares the steps with the instruction, and ``execution`` runs them
against the history.

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
