"""The hybrid planner. The grammar plans the instructions that it understands, and a language model plans the others.

``evidence`` collects words from the user and from perception, ``support`` finds the parts of a call that this evidence does not
support, ``call_words`` describes calls in words, and ``confirmation`` asks the user to confirm unsupported calls.
"""

from scope_ptz.planner.hybrid.planner import HybridPlanner

__all__ = ["HybridPlanner"]
