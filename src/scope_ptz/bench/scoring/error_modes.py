"""Assign one of the paper's eight error modes to a failed run.

The rules are applied in a fixed order: errors in the agent's actions come first, then perception errors, then reasoning errors.
docs/benchmark.md describes the rules.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

from scope_ptz.bench.answers import plain_words
from scope_ptz.bench.scoring.checks import check_framing
from scope_ptz.bench.scoring.coverage import uncovered_part
from scope_ptz.bench.scoring.episode import Episode, EpisodeCall, Observation
from scope_ptz.bench.scoring.evidence import is_supported_by_tools
from scope_ptz.bench.scoring.misperceptions import (
    CountTruth,
    has_wrong_count,
    has_wrong_reply,
    is_target_clearly_shown,
    is_target_inside,
)
from scope_ptz.bench.scoring.required_calls import matches_required_call, missing_in_any_order, missing_in_order
from scope_ptz.bench.scoring.verdict import Verdict, score_episode, states_value
from scope_ptz.bench.tasks.task import ProgramCall, RequiredCall, Task
from scope_ptz.geometry import Perspective


class ErrorMode(StrEnum):
    """Why a run failed, in the order of precedence."""

    LACK_OF_TOOL_CALL = "lack_of_tool_call"
    TOOL_ROUTING = "tool_routing"
    SCOPE = "scope"
    TOOL_ARGS = "tool_args"
    HALLUCINATION = "hallucination"
    VLM_COUNTING = "vlm_counting"
    VLM_QUERY = "vlm_query"
    REASONING = "reasoning"


_OBSERVING_TOOLS = frozenset({"count_objects", "query_answer"})
"""Tools that only observe."""
_MOVING_TOOLS = frozenset({"adjust_ptz", "go_to_preset", "go_home"})
"""Tools that move the camera without searching for anything."""


@dataclass(frozen=True, slots=True)
class _Case:
    """A failed run with the data that the rules use."""

    task: Task
    episode: Episode
    verdict: Verdict
    truth: CountTruth | None
    exact_perception: bool

    @property
    def attempted_tools(self) -> set[str]:
        """Names of the tools that the agent called, excluding skipped calls."""
        return {call.name for call in self.episode.calls if call.fault != "skipped"}

    @property
    def has_failed_action(self) -> bool:
        """Whether a check other than the answer and outcome checks failed."""
        return any(check.passed is False and check.name not in ("answer", "outcome") for check in self.verdict.checks)

    @property
    def required_tools(self) -> set[str]:
        """Names of the tools that the instruction requires."""
        return {call.tool for call in self.task.behaviour.calls}

    @property
    def needed_tools(self) -> set[str]:
        """Names of the required tools and the tools in the reference program, excluding ``get_presets`` unless it is required."""
        return {call.tool for call in self.task.reference if call.tool != "get_presets"} | self.required_tools

    def replacements(self, name: str) -> frozenset[str]:
        """Return the tools that can replace a tool, including the tool itself.

        The two tools that only observe can replace each other. Tools that move the camera can replace each other if the camera
        reached its target.
        """
        if name in _OBSERVING_TOOLS:
            return _OBSERVING_TOOLS
        missed_target = any(self.verdict.failed(check) for check in ("pose", "coverage", "framing"))
        return _MOVING_TOOLS if name in _MOVING_TOOLS and not missed_target else frozenset({name})

    def missing_tools(self) -> set[str]:
        """Return the needed tools that were not tried. A tool that is not required is omitted if a replacement was tried."""
        untried = self.needed_tools - self.attempted_tools
        return {name for name in untried if name in self.required_tools or not self.replacements(name) & self.attempted_tools}

    def unneeded_tools(self) -> set[str]:
        """Return the tools that were tried but are neither needed nor replacements for needed tools."""
        replaceable = self.needed_tools - self.attempted_tools - self.required_tools
        replacements_used = {other for name in replaceable for other in self.replacements(name)}
        return self.attempted_tools - self.needed_tools - replacements_used - {"get_presets"}


def error_mode(
    task: Task,
    episode: Episode,
    truth: CountTruth | None = None,
    *,
    exact_perception: bool = False,
    verdict: Verdict | None = None,
) -> ErrorMode | None:
    """Return the error mode of a failed run.

    Args:
        task: The task.
        episode: The run.
        truth: Function that returns the true count for an observation. If None, the task's evidence shows whether a count is wrong.
        exact_perception: Whether perception returned the exact ground truth. If so, a wrong or missing answer is always the agent's
            error.
        verdict: The verdict on the run; None to execute the checks.

    Returns:
        The error mode, or None if the run is correct, could not be scored, or failed because of the infrastructure.
    """
    verdict = verdict or score_episode(task, episode)
    if verdict.headline != "incorrect":
        return None
    case = _Case(task, episode, verdict, truth, exact_perception)
    return next((mode for mode, applies in _RULES if applies(case)), ErrorMode.REASONING)


def _lacks_call(case: _Case) -> bool:
    """Return whether a needed tool was not tried, and no unneeded tool was tried in its place."""
    return (case.has_failed_action or not case.episode.calls) and bool(case.missing_tools()) and not case.unneeded_tools()


def _has_wrong_routing(case: _Case) -> bool:
    """Return whether the wrong tools were used.

    This is the case if another tool was tried in place of a needed tool, if a forbidden tool was used, if the number of pictures
    is wrong, or if the required calls were made in the wrong order.
    """
    if case.has_failed_action and case.missing_tools():
        return True
    forbidden = {call.name for call in case.episode.calls if call.succeeded} & set(case.task.behaviour.forbidden.tools)
    if forbidden or case.verdict.failed("pictures"):
        return True
    calls = case.task.behaviour.calls
    is_only_order_wrong = case.task.behaviour.order == "ordered" and missing_in_any_order(calls, case.episode.calls) is None
    return case.verdict.failed("calls") and is_only_order_wrong


def _has_wrong_scope(case: _Case) -> bool:
    """Return whether the agent observed the current view although the task is about the full scene, or vice versa."""
    calls = case.task.behaviour.calls
    if case.verdict.failed("calls") and _missing_call(case, calls, {"view"}) is None:
        return True
    if not case.verdict.failed("answer") and not case.verdict.failed("coverage"):
        return False
    for view in case.task.evidence:
        observations = [
            observation
            for observation in case.episode.observations
            if observation.viewpoint == view.aim.viewpoint and observation.kind in ("count", "query")
        ]
        is_full = view.scope == "full"
        if view.must_look and observations and all(observation.is_panorama != is_full for observation in observations):
            return is_full or case.verdict.failed("answer")
    return False


def _missing_call(case: _Case, calls: tuple[RequiredCall, ...], ignored: set[str]) -> str | None:
    find_missing = missing_in_order if case.task.behaviour.order == "ordered" else missing_in_any_order
    return find_missing(calls, case.episode.calls, ignored)


def _has_wrong_arguments(case: _Case) -> bool:
    """Return whether the right tools were called with wrong arguments or on the wrong target."""
    return case.has_failed_action and not (
        _has_only_failed_perception(case) or _lacks_answer_from_perception(case) or _was_misled_by_perception(case)
    )


def _has_only_failed_perception(case: _Case) -> bool:
    """Return whether every perception call failed, so that wrong arguments cannot be the cause of the failure."""
    return not case.episode.observations and any(call.fault == "perception" for call in case.episode.calls)


def _lacks_answer_from_perception(case: _Case) -> bool:
    """Return whether only coverage and the answer failed, because perception could not answer a question about the right view."""
    if case.exact_perception:
        return False
    wrong = {check.name for check in case.verdict.checks if check.passed is False} - {"answer", "outcome"}
    observations = [replace(observation, known=True) for observation in case.episode.observations]
    return wrong == {"coverage"} and all(
        uncovered_part(view, observations) is None for view in case.task.evidence if view.must_look
    )


def _was_misled_by_perception(case: _Case) -> bool:
    """Return whether the camera missed the target because perception found nothing or the wrong thing for a correct description."""
    required_calls = case.task.behaviour.calls
    if case.exact_perception or not case.has_failed_action:
        return False
    if case.verdict.failed("calls") and _missing_call(case, required_calls, {"found"}) is not None:
        return False
    locators = case.needed_tools & {"zoom_to_object", "track_object"}
    for call in case.episode.calls:
        if call.name not in locators or not call.observations or not is_target_inside(case.task, call.observations[0]):
            continue
        specs = [spec for spec in required_calls if spec.tool == call.name]
        is_correct = (
            all(matches_required_call(spec, call, {"found"}) for spec in specs)
            if specs
            else _matches_reference_description(case.task, call)
        )
        if is_correct and not _reached_target(case, call):
            return True
    return False


def _matches_reference_description(task: Task, call: EpisodeCall) -> bool:
    """Return whether a call describes the same thing as the reference program, possibly in more or fewer words."""
    asked = _described_words(call)
    references = (_described_words(c) for c in task.reference if c.tool == call.name)
    return any(asked <= reference or reference <= asked for reference in references)


def _described_words(call: EpisodeCall | ProgramCall) -> set[str]:
    return set(plain_words(str(call.arguments.get("description", "")))) - {"a", "an", "the"}


def _reached_target(case: _Case, call: EpisodeCall) -> bool:
    """Return whether a search ended with the target framed or, if the task does not require framing, in view."""
    if (call.result or {}).get("found") is False:
        return False
    framing = check_framing(case.task, replace(case.episode, final=call.after))
    return framing.passed is True if framing is not None else is_target_clearly_shown(case.task, _view_after(case.episode, call))


def _view_after(episode: Episode, call: EpisodeCall) -> Observation:
    pose, seen = call.after.pose, call.observations[0].projection
    width = seen.width if isinstance(seen, Perspective) else 1280
    view = Perspective(pose.pan_deg, pose.tilt_deg, episode.optics.hfov_deg(pose.zoom), width, round(width / episode.aspect))
    return replace(call.observations[0], viewpoint=call.after.viewpoint, projection=view)


def _has_hallucination(case: _Case) -> bool:
    """Return whether the answer states something that does not follow from the tool results."""
    if case.episode.outcome != "answered":
        return False
    if _has_only_failed_perception(case):
        return True
    if _lacks_answer_from_perception(case) and not any(observation.known for observation in case.episode.observations):
        return states_value(case.task, case.episode)
    return case.verdict.failed("answer") and not is_supported_by_tools(case.task, case.episode)


def _has_wrong_count(case: _Case) -> bool:
    return not case.exact_perception and case.verdict.failed("answer") and has_wrong_count(case.task, case.episode, case.truth)


def _has_wrong_reading(case: _Case) -> bool:
    if case.exact_perception:
        return False
    answered_wrongly = case.verdict.failed("answer") and has_wrong_reply(case.task, case.episode)
    return _was_misled_by_perception(case) or _lacks_answer_from_perception(case) or answered_wrongly


_RULES: tuple[tuple[ErrorMode, Callable[[_Case], bool]], ...] = (
    (ErrorMode.LACK_OF_TOOL_CALL, _lacks_call),
    (ErrorMode.TOOL_ROUTING, _has_wrong_routing),
    (ErrorMode.SCOPE, _has_wrong_scope),
    (ErrorMode.TOOL_ARGS, _has_wrong_arguments),
    (ErrorMode.HALLUCINATION, _has_hallucination),
    (ErrorMode.VLM_COUNTING, _has_wrong_count),
    (ErrorMode.VLM_QUERY, _has_wrong_reading),
)
"""The rules in order of precedence. The first rule that applies determines the mode. If none applies, it is ``REASONING``."""
