"""Gymnasium environments: the benchmark's tasks, and active search.

    import gymnasium
    import scope_ptz.gym

    env = gymnasium.make("scope_ptz/Task-v0", task="scope1-highway-works-counting-002")

Importing this package registers the environments. It needs the ``gym`` extra: ``pip install "scope-ptz[gym]"``.
"""

try:
    import gymnasium as _gymnasium  # noqa: F401 - gives a clearer message than the imports below
except ImportError as _error:
    raise ImportError('scope_ptz.gym needs Gymnasium. Install it with: pip install "scope-ptz[gym]"') from _error

from scope_ptz.gym.move_actions import MoveScale, move_action
from scope_ptz.gym.registration import ENVIRONMENTS, register_environments
from scope_ptz.gym.search_env import SearchEnv
from scope_ptz.gym.search_scores import SearchOutcome, search_score, success_within
from scope_ptz.gym.task_choice import movement_tasks
from scope_ptz.gym.task_env import MoveTaskEnv, ToolTaskEnv
from scope_ptz.gym.tool_actions import finish_action, tool_action

__all__ = [
    "ENVIRONMENTS",
    "MoveScale",
    "MoveTaskEnv",
    "SearchEnv",
    "SearchOutcome",
    "ToolTaskEnv",
    "finish_action",
    "move_action",
    "movement_tasks",
    "register_environments",
    "search_score",
    "success_within",
    "tool_action",
]

register_environments()
