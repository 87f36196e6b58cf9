"""The paper's eight error modes: exactly one for a failed run, by rule, in a published order of precedence.

What the agent did comes before what perception told it, and that before what the agent made of it: whoever looked at the wrong
thing was not misled, and whoever was misled did not reason wrongly. docs/benchmark.md states the rules in words.
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
from scope_ptz.bench.scoring.misperceptions import CountTruth, target_in, target_shown, wrong_counts, wrong_reads
from scope_ptz.bench.scoring.required_calls import call_matches, missing_in_any_order, missing_in_order
from scope_ptz.bench.scoring.verdict import Verdict, claims, score_episode
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


_LOOKERS = frozenset({"count_objects", "query_answer"})
_MOVERS = frozenset({"adjust_ptz", "go_to_preset", "go_home"})


@dataclass(frozen=True, slots=True)
class _Case:
    task: Task
    episode: Episode
    verdict: Verdict
    truth: CountTruth | None

    @property
    def attempted(self) -> set[str]:
        return {call.name for call in self.episode.calls if call.fault != "skipped"}

    @property
    def acted_wrongly(self) -> bool:
        """Something other than the answer or the way in which the run ended is wrong."""
        return any(check.passed is False and check.name not in ("answer", "outcome") for check in self.verdict.checks)

    @property
    def fixed(self) -> set[str]:
        """Tools that the instruction fixes."""
        return {call.tool for call in self.task.behaviour.calls}

    @property
    def needed(self) -> set[str]:
        """Tools that the instruction fixes or the reference uses; listing the presets is never needed unless asked for."""
        return {call.tool for call in self.task.reference if call.tool != "get_presets"} | self.fixed

    def alike(self, name: str) -> frozenset[str]:
        """Tools that do the work of a tool: either of the two that look; any that moves, as long as the camera got there."""
        if name in _LOOKERS:
            return _LOOKERS
        astray = any(self.verdict.failed(check) for check in ("pose", "coverage", "framing"))
        return _MOVERS if name in _MOVERS and not astray else frozenset({name})

    def missing_tools(self) -> set[str]:
        """Needed tools that were never tried, unless one that does their work was and the instruction fixes none."""
        untried = self.needed - self.attempted
        return {name for name in untried if name in self.fixed or not self.alike(name) & self.attempted}

    def strangers(self) -> set[str]:
        """Tools tried that are not needed and do not do the work of one that is."""
        idle = self.needed - self.attempted - self.fixed
        stand_ins = {other for name in idle for other in self.alike(name)}
        return self.attempted - self.needed - stand_ins - {"get_presets"}


def error_mode(task: Task, episode: Episode, truth: CountTruth | None = None) -> ErrorMode | None:
    """The mode of a failed run; None when it did not fail, could not be scored, or was broken by infrastructure.

    ``truth`` tells how many of what was asked really show in the very picture of a look; without it the evidence is asked.
    """
    verdict = score_episode(task, episode)
    if verdict.headline != "incorrect":
        return None
    case = _Case(task, episode, verdict, truth)
    return next((mode for mode, applies in _RULES if applies(case)), ErrorMode.REASONING)


def _lacks_call(case: _Case) -> bool:
    """A tool that is needed was never tried, and no tool that is not needed was tried in its place."""
    return (case.acted_wrongly or not case.episode.calls) and bool(case.missing_tools()) and not case.strangers()


def _routed_wrongly(case: _Case) -> bool:
    """Another tool was tried in place of a needed one; a forbidden one was used; too few or too many pictures; wrong order."""
    if case.acted_wrongly and case.missing_tools():
        return True
    forbidden = {call.name for call in case.episode.calls if call.succeeded} & set(case.task.behaviour.forbidden.tools)
    if forbidden or case.verdict.failed("pictures"):
        return True
    calls = case.task.behaviour.calls
    is_order = case.task.behaviour.order == "ordered" and missing_in_any_order(calls, case.episode.calls) is None
    return case.verdict.failed("calls") and is_order


def _wrong_scope(case: _Case) -> bool:
    """Looked, but only at the current view where all around was asked for, or the other way round."""
    calls = case.task.behaviour.calls
    if case.verdict.failed("calls") and _missing(case, calls, {"view"}) is None:
        return True
    if not case.verdict.failed("answer") and not case.verdict.failed("coverage"):
        return False
    for view in case.task.evidence:
        looks = [look for look in case.episode.looks if look.viewpoint == view.aim.viewpoint and look.how in ("count", "query")]
        wanted = view.scope == "full"
        if view.must_look and looks and all(look.swept != wanted for look in looks):
            return wanted or case.verdict.failed("answer")
    return False


def _missing(case: _Case, calls: tuple[RequiredCall, ...], leave_out: set[str]) -> str | None:
    order = missing_in_order if case.task.behaviour.order == "ordered" else missing_in_any_order
    return order(calls, case.episode.calls, leave_out)


def _wrong_arguments(case: _Case) -> bool:
    """The right tools were called with wrong arguments or at the wrong target: the camera did or saw the wrong thing."""
    return case.acted_wrongly and not (_was_blind(case) or _was_left_unanswered(case) or _was_misled(case))


def _was_blind(case: _Case) -> bool:
    """Every look failed: what is missing was not missed by wrong arguments."""
    return not case.episode.looks and any(call.fault == "perception" for call in case.episode.calls)


def _was_left_unanswered(case: _Case) -> bool:
    """All that is wrong beside the answer is that perception, asked about the right thing in the right view, could not tell."""
    wrong = {check.name for check in case.verdict.checks if check.passed is False} - {"answer", "outcome"}
    looks = [replace(look, known=True) for look in case.episode.looks]
    return wrong == {"coverage"} and all(uncovered_part(view, looks) is None for view in case.task.evidence if view.must_look)


def _was_misled(case: _Case) -> bool:
    """The camera went wrong because perception named the wrong thing or none, though it was asked for the right one."""
    required = case.task.behaviour.calls
    if not case.acted_wrongly or (case.verdict.failed("calls") and _missing(case, required, {"found"}) is not None):
        return False
    wanted = case.needed & {"zoom_to_object", "track_object"}
    for call in case.episode.calls:
        if call.name not in wanted or not call.looks or not target_in(case.task, call.looks[0]):
            continue
        fixed = [spec for spec in required if spec.tool == call.name]
        asked_right = all(call_matches(spec, call, {"found"}) for spec in fixed) if fixed else _asks_as_reference(case.task, call)
        if asked_right and not _got_there(case, call):
            return True
    return False


def _asks_as_reference(task: Task, call: EpisodeCall) -> bool:
    """Whether a call describes what the reference describes, in more or fewer words."""
    asked = _content(call)
    return any(asked <= wanted or wanted <= asked for wanted in (_content(c) for c in task.reference if c.tool == call.name))


def _content(call: EpisodeCall | ProgramCall) -> set[str]:
    return set(plain_words(str(call.arguments.get("description", "")))) - {"a", "an", "the"}


def _got_there(case: _Case, call: EpisodeCall) -> bool:
    """Whether a search found something and left the target framed, or in view where the task does not say how large."""
    if (call.result or {}).get("found") is False:
        return False
    framing = check_framing(case.task, replace(case.episode, final=call.after))
    return framing.passed is True if framing is not None else target_shown(case.task, _view_after(case.episode, call))


def _view_after(episode: Episode, call: EpisodeCall) -> Observation:
    pose, seen = call.after.pose, call.looks[0].projection
    width = seen.width if isinstance(seen, Perspective) else 1280
    view = Perspective(pose.pan_deg, pose.tilt_deg, episode.optics.hfov_deg(pose.zoom), width, round(width / episode.aspect))
    return replace(call.looks[0], viewpoint=call.after.viewpoint, projection=view)


def _made_up(case: _Case) -> bool:
    """The answer claims what no tool said and what cannot be drawn from what tools said."""
    if case.episode.outcome != "answered":
        return False
    if _was_blind(case):
        return True
    if _was_left_unanswered(case) and not any(look.known for look in case.episode.looks):
        return claims(case.task, case.episode)
    return case.verdict.failed("answer") and not is_supported_by_tools(case.task, case.episode)


def _miscounted(case: _Case) -> bool:
    return case.verdict.failed("answer") and wrong_counts(case.task, case.episode, case.truth)


def _misread(case: _Case) -> bool:
    return (
        _was_misled(case) or _was_left_unanswered(case) or (case.verdict.failed("answer") and wrong_reads(case.task, case.episode))
    )


_RULES: tuple[tuple[ErrorMode, Callable[[_Case], bool]], ...] = (
    (ErrorMode.LACK_OF_TOOL_CALL, _lacks_call),
    (ErrorMode.TOOL_ROUTING, _routed_wrongly),
    (ErrorMode.SCOPE, _wrong_scope),
    (ErrorMode.TOOL_ARGS, _wrong_arguments),
    (ErrorMode.HALLUCINATION, _made_up),
    (ErrorMode.VLM_COUNTING, _miscounted),
    (ErrorMode.VLM_QUERY, _misread),
)
