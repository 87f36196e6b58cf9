"""The hybrid planner: the grammar plans what it understands, and a language model plans the rest.

``grounds`` collects what the user said and what was seen, ``grounding`` compares a call with it, ``call_words`` names calls in
words, and ``confirmation`` asks the user about calls without grounds.
"""

from scope_ptz.planner.hybrid.planner import HybridPlanner

__all__ = ["HybridPlanner"]
