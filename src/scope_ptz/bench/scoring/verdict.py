"""Combine the check results of a run into a verdict.

A run is correct only if every check passes. There are separate verdicts for runs that cannot be scored and for runs with an
infrastructure failure.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from scope_ptz.bench.agents.faults import AGENT_FAULTS
from scope_ptz.bench.answers import ParsedValue, parse_answer
from scope_ptz.bench.scoring.checks import CheckResult, changed_properties, run_checks
from scope_ptz.bench.scoring.episode import Episode
from scope_ptz.bench.tasks.expected import ActionOnly
from scope_ptz.bench.tasks.task import Task
from scope_ptz.errors import ScopeError
from scope_ptz.tools.registry import TOOLS

Headline = Literal["correct", "incorrect", "unscored", "infrastructure"]
"""The possible verdicts. "unscored": a check could not decide; "infrastructure": a failure outside the agent."""
MOVING_TOOLS = TOOLS.moving
"""Names of the tools that can move the camera."""
AGENT_FAILURES = frozenset({"empty", "context-overflow", *AGENT_FAULTS})
"""Kinds of planner failures that count against the agent: empty replies, context overflows, and faults of external agents."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """The verdict on a run.

    Attributes:
        task: The task's id.
        headline: "correct", "incorrect", "unscored" or "infrastructure".
        checks: The results of the checks.
        moved_needlessly: Whether the final pose differs from the start although the task required no move. It does not affect
            the headline.
        reason: The reason for the headline.
    """

    task: str
    headline: Headline
    checks: tuple[CheckResult, ...]
    moved_needlessly: bool
    reason: str

    def failed(self, name: str) -> bool:
        """Return whether a check failed."""
        return any(check.name == name and check.passed is False for check in self.checks)


def score_episode(task: Task, episode: Episode) -> Verdict:
    """Score a run with the checks of its task.

    Raises:
        ScopeError: The task has no checks.
    """
    checks = run_checks(task, episode)
    if all(check.name == "outcome" for check in checks) and task.behaviour.outcomes == ("answered",):
        raise ScopeError(f"Runs of the task {task.id} cannot be scored, because the task defines no check.")
    headline, reason = _headline(task, episode, checks)
    return Verdict(task.id, headline, checks, moved_needlessly(task, episode), reason)


def _headline(task: Task, episode: Episode, checks: tuple[CheckResult, ...]) -> tuple[Headline, str]:
    if failure := infrastructure_failure(task, episode):
        return "infrastructure", failure
    failed = [f"{check.name}: {check.reason}" for check in checks if check.passed is False]
    if failed:
        return "incorrect", "; ".join(failed)
    unknown = [f"{check.name}: {check.reason}" for check in checks if check.passed is None]
    return ("unscored", "; ".join(unknown)) if unknown else ("correct", "every check passed")


def infrastructure_failure(task: Task, episode: Episode) -> str | None:
    """Return the infrastructure failure that prevents a run from being scored; None if there was none.

    Infrastructure failures are interruptions and failures of the camera or a model server. Faults of an external agent are not
    infrastructure failures.
    """
    if episode.outcome is None:
        return "the run was cut off"
    if episode.outcome in ("camera_error", "cancelled"):
        return f"the run ended with the outcome {episode.outcome}"
    if episode.outcome == "planner_error" and episode.failure is not None and episode.failure not in AGENT_FAILURES:
        return f"the planner's server failed: {episode.failure}"
    if episode.outcome == "planner_error" and episode.failure in AGENT_FAULTS:
        return None
    all_failed = any(call.fault == "perception" for call in episode.calls) and not episode.observations
    if all_failed and any(view.must_look for view in task.evidence) and not states_value(task, episode):
        return "perception failed and the agent stated no value"
    return None


def states_value(task: Task, episode: Episode) -> bool:
    """Return whether the final answer states a value."""
    if isinstance(task.expected, ActionOnly) or episode.outcome != "answered":
        return False
    return isinstance(parse_answer(task.expected, episode.answer), ParsedValue)


def moved_needlessly(task: Task, episode: Episode) -> bool:
    """Return whether the final pose differs from the start although neither the instruction nor the answer requires a move."""
    behaviour = task.behaviour
    requires_move = behaviour.final or behaviour.framing or any(call.tool in MOVING_TOOLS for call in behaviour.calls)
    return not requires_move and set(task.needs) <= {"sweep"} and bool(changed_properties(episode.start, episode.final))
