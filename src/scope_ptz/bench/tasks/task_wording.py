"""Describe the expected answer and the required behaviour of tasks in words, for judges and people.

These sentences are part of judge prompts, so changing them may change verdicts.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from scope_ptz.bench.tasks.expected import (
    ActionOnly,
    AnyExpected,
    Choice,
    Description,
    Fact,
    NameSet,
    NoneThere,
    Number,
    Ordering,
    Relation,
    Text,
    YesNo,
)
from scope_ptz.bench.tasks.task import Argument, EvidenceView, RequiredCall, Task
from scope_ptz.bench.tasks.task_facts import TaskFacts

_OUTCOMES = {"answered": "with an answer", "clarification": "with a question back", "refused": "by declining the request"}


def facts_of(task: Task, viewpoint: str) -> TaskFacts:
    """Return the properties of a task for judges and reports. ``viewpoint`` is the viewpoint of the task's preset."""
    return TaskFacts(
        id=task.id,
        dataset=task.dataset,
        stratum=task.stratum,
        scene=task.scene,
        viewpoint=viewpoint,
        preset=task.preset,
        instruction=task.instruction,
        category=task.category,
        scope=task.scope,
        difficulty=task.difficulty,
        expected=expected_in_words(task.expected),
        demands=tuple(demands(task)),
        needs=task.needs,
        pair=task.pair,
        paraphrase_of=task.paraphrase_of,
    )


def expected_in_words(expected: AnyExpected) -> str:
    """Describe an expected answer in a sentence or two, including other accepted wordings."""
    match expected:
        case Number():
            unit = f" ({expected.unit[0]})" if expected.unit else ""
            tolerance = f", give or take {expected.tolerance:g}" if expected.tolerance else ""
            return f"{expected.value:g}{unit}{tolerance}"
        case YesNo():
            wordings = expected.affirms if expected.value else expected.denies
            return f"{'Yes' if expected.value else 'No'}{_alternatives(wordings)}"
        case Choice():
            others = [name for name in expected.options if name != expected.value]
            excluded = f" (not {', '.join(others)})" if others else ""
            return f"{expected.value}{_alternatives(expected.options[expected.value])}{excluded}"
        case Text():
            ocr_note = "; look-alike letters and digits (0/O, 1/I, 5/S, 8/B) count as the same" if expected.ocr else ""
            return f"the text {_join_with_or(expected.accepted)}{ocr_note}"
        case NameSet():
            return "all of these and nothing else, in any order: " + ", ".join(expected.value) if expected.value else "none of them"
        case Ordering():
            return f"in this order, from either end: {', '.join(expected.value)}"
        case Relation():
            return _relation(expected)
        case Description():
            stated = "; ".join(_join_with_or(fact.any_of) for fact in expected.facts)
            return f"a description that states all of: {stated}{_contradictions(expected.contradictions)}"
        case NoneThere():
            return f"that there is none (no {_join_with_or(expected.subject)})"
        case ActionOnly():
            return "no answer is wanted; what the camera did decides"


def demands(task: Task) -> Iterator[str]:
    """Yield the requirements on runs of a task that follow from the instruction, one sentence each."""
    behaviour = task.behaviour
    if behaviour.outcomes != ("answered",):
        yield f"The run must end {_join_with_or([_OUTCOMES[name] for name in behaviour.outcomes], marks='')}."
    if behaviour.calls:
        order = "in this order" if behaviour.order == "ordered" and len(behaviour.calls) > 1 else "in any order"
        calls = "; ".join(call_in_words(call) for call in behaviour.calls)
        yield f"These calls must succeed, {order}, others may come between: {calls}."
    if (final := behaviour.final) is not None:
        yield (
            f"The camera must end at viewpoint {final.viewpoint}, pan {final.pan_deg:g}, tilt {final.tilt_deg:g}, "
            f"zoom {final.zoom:g}x (within {final.tolerance_deg:g} degrees and {final.zoom_share:.0%} of zoom)."
        )
    if behaviour.framing is not None:
        yield f"The camera must end with {behaviour.framing.instance} large and in the middle of the view."
    if behaviour.pictures is not None:
        yield f"Pictures taken with take_image: exactly {behaviour.pictures}."
    if behaviour.forbidden.tools:
        yield f"These tools must not be used: {', '.join(behaviour.forbidden.tools)}."
    if behaviour.forbidden.changes:
        yield f"In the end these must be as they were at the start: {', '.join(behaviour.forbidden.changes)}."
    if any(view.must_look for view in task.evidence):
        where = "; ".join(dict.fromkeys(_evidence_view(view) for view in task.evidence if view.must_look))
        yield f"The answer must rest on what tools reported about: {where}."


def _evidence_view(view: EvidenceView) -> str:
    aim = view.aim
    if view.scope == "full":
        return f"everything around viewpoint {aim.viewpoint}"
    towards = f"pan {aim.pan_deg:g}, tilt {aim.tilt_deg:g}"
    return f"what shows from viewpoint {aim.viewpoint} towards {towards} (in any view that holds it)"


def call_in_words(call: RequiredCall) -> str:
    """Format a required call as text, with the accepted values of its arguments."""
    arguments = ", ".join(f"{name}={_argument(spec)}" for name, spec in call.arguments.items())
    times = f" {call.times} times" if call.times > 1 else ""
    return f"{call.tool}({arguments}){times}"


def _argument(spec: Argument) -> str:
    if spec.mentions:
        return f"<about {_join_with_or(spec.mentions)}>"
    shown = f"{spec.equals:g}" if isinstance(spec.equals, float) else str(spec.equals)
    return f"{shown}±{spec.within:g}" if spec.within else shown


def _relation(expected: Relation) -> str:
    subject, compared = expected.subject[0], expected.object[0]
    if expected.value == "same":
        return f"{subject} and {compared} are the same in this"
    words = expected.forward if expected.value == "forward" else expected.backward
    relation = _join_with_or(words) if words else f"the other way round than {expected.forward[0]}"
    return f"{subject}, compared with {compared}: {relation}"


def _contradictions(contradictions: Sequence[Fact]) -> str:
    return f"; it must not state any of: {', '.join(fact.any_of[0] for fact in contradictions)}" if contradictions else ""


def _alternatives(words: Sequence[str]) -> str:
    return f" (or: {', '.join(words)})" if words else ""


def _join_with_or(words: Sequence[str], marks: str = '"') -> str:
    return " or ".join(f"{marks}{word}{marks}" for word in words)
