"""The ids of the environments, and their registration with Gymnasium."""

from __future__ import annotations

from collections.abc import Mapping

import gymnasium

ENVIRONMENTS: Mapping[str, str] = {
    "scope_ptz/Task-v0": "scope_ptz.gym.task_env:ToolTaskEnv",
    "scope_ptz/TaskContinuous-v0": "scope_ptz.gym.task_env:MoveTaskEnv",
    "scope_ptz/Search-v0": "scope_ptz.gym.search_env:SearchEnv",
}
"""The id of each environment and its class. The version increases when the same actions give different observations or rewards.

The environments limit their own steps, because the benchmark's verdict depends on the limit. They therefore need no ``TimeLimit``.
"""


def register_environments() -> None:
    """Register the environments. Existing registrations are left unchanged."""
    for name, entry_point in ENVIRONMENTS.items():
        if name not in gymnasium.registry:
            gymnasium.register(name, entry_point)
