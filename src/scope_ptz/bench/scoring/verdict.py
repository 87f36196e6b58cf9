"""All checks of a run together: one headline, fail closed, with what could not be scored and what was not the agent's doing told
apart."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from scope_ptz.bench.answers import ParsedValue, parse_answer
from scope_ptz.bench.scoring.checks import CheckResult, changes, run_checks
from scope_ptz.bench.scoring.episode import Episode
from scope_ptz.bench.tasks.expected import ActionOnly
from scope_ptz.bench.tasks.task import Task
from scope_ptz.errors import ScopeError
from scope_ptz.tools.registry import TOOLS

Headline = Literal["correct", "incorrect", "unscored", "infrastructure"]
MOVERS = TOOLS.moving
AGENTS_OWN_FAILURES = frozenset({"empty", "context-overflow"})
"""Ways in which a planner's server fails that are the model's doing: it said nothing, or filled its context."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """``collateral``: the camera ended elsewhere without being asked; a side metric that decides nothing."""

    task: str
    headline: Headline
    checks: tuple[CheckResult, ...]
    collateral: bool
    reason: str

    def failed(self, name: str) -> bool:
        return any(check.name == name and check.passed is False for check in self.checks)


@dataclass(frozen=True, slots=True)
class Tally:
    """Verdicts counted. ``share`` is the headline: correct among the runs that infrastructure did not break, unscored ones counted
    as not correct. ``low`` and ``high`` bound it: all that is unscored or broken wrong, or all of it right."""

    counts: dict[Headline, int]

    @property
    def total(self) -> int:
        return sum(self.counts.values())

    @property
    def share(self) -> float | None:
        ran = self.total - self.counts["infrastructure"]
        return self.counts["correct"] / ran if ran else None

    @property
    def low(self) -> float | None:
        return self.counts["correct"] / self.total if self.total else None

    @property
    def high(self) -> float | None:
        return 1 - self.counts["incorrect"] / self.total if self.total else None


def tally(verdicts: Iterable[Verdict]) -> Tally:
    """Count verdicts by headline."""
    counted = Counter(verdict.headline for verdict in verdicts)
    every: tuple[Headline, ...] = ("correct", "incorrect", "unscored", "infrastructure")
    return Tally({name: counted[name] for name in every})


def score_episode(task: Task, episode: Episode) -> Verdict:
    """The verdict on a run. Raises ``ScopeError`` when the task has nothing that could be checked."""
    checks = run_checks(task, episode)
    if all(check.name == "outcome" for check in checks) and task.behaviour.outcomes == ("answered",):
        raise ScopeError(f"Task {task.id} has no check.")
    headline, reason = _headline(task, episode, checks)
    return Verdict(task.id, headline, checks, collateral(task, episode), reason)


def _headline(task: Task, episode: Episode, checks: tuple[CheckResult, ...]) -> tuple[Headline, str]:
    if broken := infrastructure(task, episode):
        return "infrastructure", broken
    failed = [f"{check.name}: {check.reason}" for check in checks if check.passed is False]
    if failed:
        return "incorrect", "; ".join(failed)
    unknown = [f"{check.name}: {check.reason}" for check in checks if check.passed is None]
    return ("unscored", "; ".join(unknown)) if unknown else ("correct", "every check passed")


def infrastructure(task: Task, episode: Episode) -> str | None:
    """Why a run says nothing about the agent (it was cut off, the camera or a model server failed); None when it does."""
    if episode.outcome is None:
        return "the run was cut off"
    if episode.outcome in ("camera_error", "cancelled"):
        return f"the run ended {episode.outcome}"
    if episode.outcome == "planner_error" and episode.failure is not None and episode.failure not in AGENTS_OWN_FAILURES:
        return f"the planner's server failed: {episode.failure}"
    blind = any(call.fault == "perception" for call in episode.calls) and not episode.looks
    if blind and any(view.must_look for view in task.evidence) and not claims(task, episode):
        return "perception failed and the agent said no more than it knew"
    return None


def claims(task: Task, episode: Episode) -> bool:
    """Whether the final text claims a value."""
    if isinstance(task.expected, ActionOnly) or episode.outcome != "answered":
        return False
    return isinstance(parse_answer(task.expected, episode.text), ParsedValue)


def collateral(task: Task, episode: Episode) -> bool:
    """Whether the camera ended elsewhere than it began although neither the instruction nor the way to the answer wanted that."""
    behaviour = task.behaviour
    asked = behaviour.final or behaviour.framing or any(call.tool in MOVERS for call in behaviour.calls)
    return not asked and set(task.needs) <= {"sweep"} and bool(changes(episode.start, episode.final))
